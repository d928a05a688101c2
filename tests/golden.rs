//! Eight small scenes of different needs against long pictures of our own, `tests/golden`.
//!
//! ```text
//! SPECULA_GOLDEN=1 cargo test --release --test golden   # renders the pictures anew: minutes
//! ```
//!
//! That has a word of its own, lest who records tables (`SPECULA_RECORD`) make references of what is to be tested.
//!
//! A picture holds the mean over 16 384 independent samples of each pixel and the variance of one of them. The tests take a few
//! hundred, by every integrator that should agree, and ask whether the difference is noise: of blocks of 4 by 4 pixels, which are
//! nearly normal where single pixels meet a caustic once in a hundred samples.

#[path = "support/shots.rs"]
mod shots;
#[path = "support/statistics.rs"]
mod statistics;

use shots::{Shot, Verdict};
use specula::image::{Window, exr};
use specula::scene::Scene;
use std::path::{Path, PathBuf};

/// Samples of the pictures that are kept, and their seed.
const LONG: (u32, u32) = (16_384, 77);

/// Samples of a test.
const SHORT: u32 = 256;

/// Settings of `render` that leave the picture as it is.
struct Way {
    name: &'static str,
    settings: &'static [&'static str],
    needs: Needs,
}

/// Which scenes a way has all the light of, and finds it with few samples.
#[derive(Clone, Copy, PartialEq)]
enum Needs {
    /// Any.
    Nothing,
    /// Those without light that is scattered twice: ray trees.
    OneBounce,
    /// Those whose lights are large enough to be met by chance.
    LargeLights,
}

const WAYS: [Way; 13] = [
    Way { name: "single", settings: &["query=\"single\""], needs: Needs::Nothing },
    Way { name: "packet", settings: &["query=\"packet\""], needs: Needs::Nothing },
    Way { name: "stream", settings: &["query=\"stream\""], needs: Needs::Nothing },
    Way { name: "bvh2", settings: &["backend=\"bvh2\""], needs: Needs::Nothing },
    Way { name: "cwbvh", settings: &["backend=\"cwbvh\""], needs: Needs::Nothing },
    Way { name: "sobol", settings: &["sampler=\"sobol\""], needs: Needs::Nothing },
    Way { name: "stratified", settings: &["sampler=\"stratified\""], needs: Needs::Nothing },
    Way { name: "blue noise", settings: &["sampler=\"blue_noise\""], needs: Needs::Nothing },
    Way { name: "lights asked alone", settings: &["direct=\"light\""], needs: Needs::Nothing },
    Way { name: "lobes followed alone", settings: &["direct=\"bsdf\""], needs: Needs::LargeLights },
    Way {
        name: "tree, one by one",
        settings: &["integrator=\"whitted\"", "query=\"single\""],
        needs: Needs::OneBounce,
    },
    Way {
        name: "tree, in streams",
        settings: &["integrator=\"whitted\"", "query=\"stream\""],
        needs: Needs::OneBounce,
    },
    Way { name: "distribution", settings: &["integrator=\"distribution\""], needs: Needs::OneBounce },
];

/// Scenes with what they lack.
const SCENES: [(&str, &[Needs]); 8] = [
    ("glass_and_media", &[Needs::OneBounce]),
    ("glossy_metals", &[Needs::OneBounce, Needs::LargeLights]),
    ("textures_and_reliefs", &[Needs::OneBounce]),
    ("instances_in_motion", &[]),
    ("depth_of_field", &[]),
    ("many_lights", &[Needs::LargeLights]),
    ("environment", &[Needs::LargeLights]),
    ("shining_mesh", &[Needs::OneBounce]),
];

fn file(name: &str, extension: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(format!("{name}.{extension}"))
}

fn scene_with(name: &str, settings: &[&str], (spp, seed): (u32, u32)) -> Scene {
    let own = [format!("spp={spp}"), format!("seed={seed}"), "sampler=\"independent\"".to_owned()];
    let all = own.into_iter().chain(settings.iter().map(|&setting| setting.to_owned()));
    let overrides: Vec<String> = all.map(|setting| format!("render.{setting}")).collect();
    let loaded =
        specula::scene::load(&file(name, "toml"), &overrides).unwrap_or_else(|error| panic!("{error}"));
    specula::scene::build(&loaded.description).unwrap_or_else(|error| panic!("{error}")).scene
}

/// The long picture, rendered anew if asked for, with the variance of one sample.
fn long(name: &str) -> Shot {
    let path = file(name, "exr");
    if std::env::var_os("SPECULA_GOLDEN").is_some() {
        keep(&path, &Shot::of(&scene_with(name, &[], LONG)));
    }
    Shot::read(&path, None)
}

/// A picture of so many samples against a long one, by blocks. Where a pixel's own samples missed what is rare they tell too little of
/// their noise: it is at least that of the long picture's samples.
fn compare(found: &Shot, long: &Shot, spp: u32) -> Verdict {
    const BLOCK: usize = 4;
    // The rounding of halves.
    const HALF: f64 = 5e-4;
    let (mut found, mut long) = (found.clone(), long.clone());
    for (own, of_sample) in found.variance.iter_mut().flatten().zip(long.variance.iter_mut().flatten()) {
        *own = own.max(*of_sample / f64::from(spp));
        *of_sample /= f64::from(LONG.0);
    }
    Verdict::of(&found.blocks(BLOCK), &long.blocks(BLOCK).doubted(HALF))
}

/// Halves: their rounding is far less than the noise of a test.
#[expect(clippy::cast_possible_truncation, reason = "numbers of a picture")]
fn keep(path: &Path, shot: &Shot) {
    let size = shot.size.map(|n| u32::try_from(n).expect("small"));
    let mut channels = Vec::new();
    for (c, letter) in ["R", "G", "B"].into_iter().enumerate() {
        let of = |values: &[[f64; 3]], factor: f64| {
            exr::Samples::Half(values.iter().map(|value| (value[c] * factor) as f32).collect())
        };
        channels.push(exr::Channel { name: letter.to_owned(), samples: of(&shot.mean, 1.0) });
        let samples = of(&shot.variance, f64::from(LONG.0));
        channels.push(exr::Channel { name: format!("variance.{letter}"), samples });
    }
    let window = Window::whole(size[0], size[1]);
    let picture = exr::Picture { full: size, window, channels, attributes: Vec::new(), warnings: Vec::new() };
    exr::write(path, picture).expect("written");
}

#[expect(clippy::print_stdout, reason = "tells what was found")]
fn check(name: &str) {
    let reference = long(name);
    let lacks = SCENES.iter().find(|(scene, _)| *scene == name).expect("a scene").1;
    let mut failed = Vec::new();
    for (seed, way) in (1..).zip(&WAYS).filter(|(_, way)| !lacks.contains(&way.needs)) {
        // Numbers of its own for each way, lest one set be tested again and again.
        let found = Shot::of(&scene_with(name, way.settings, (SHORT, seed)));
        let verdict = compare(&found, &reference, SHORT);
        let Verdict { beyond, worst, square, bias, bias_deviations, .. } = verdict;
        println!(
            "{name}, {}: mean {:+.3} % or {bias_deviations:.1} deviations off, {beyond} blocks beyond, the worst by {worst:.1}, \
             mean square {square:.2}",
            way.name,
            bias * 100.0
        );
        // Ninety pictures. One in a hundred has a block beyond the limit by chance, which may be three numbers, one in 20 000 two. Means
        // are 3.5 deviations off, which are an upper bound, once in 2000. Squares average to 1, to less for samplers better than
        // independent; of 192 numbers that go by threes they are beyond 1.6 about once in 10 000.
        if beyond > 3 || worst > 6.0 || bias_deviations > 3.5 || square > 1.6 {
            failed.push(format!("{}: {verdict:?}", way.name));
        }
    }
    assert!(failed.is_empty(), "{name}: {failed:#?}");
}

#[test]
fn glass_and_media() {
    check("glass_and_media");
}

#[test]
fn glossy_metals() {
    check("glossy_metals");
}

#[test]
fn textures_and_reliefs() {
    check("textures_and_reliefs");
}

#[test]
fn instances_in_motion() {
    check("instances_in_motion");
}

#[test]
fn depth_of_field() {
    check("depth_of_field");
}

#[test]
fn many_lights() {
    check("many_lights");
}

#[test]
fn environment() {
    check("environment");
}

#[test]
fn shining_mesh() {
    check("shining_mesh");
}

/// The tests would see an error: with a hundredth less light the pictures are not the same.
#[test]
fn a_hundredth_less_light_is_noticed() {
    let reference = long("environment");
    let mut darker = Shot::of(&scene_with("environment", &[], (4096, 5)));
    assert!(compare(&darker, &reference, 4096).bias_deviations < 3.5, "as it is");
    darker.mean.iter_mut().flatten().for_each(|value| *value *= 0.99);
    let verdict = compare(&darker, &reference, 4096);
    assert!(verdict.bias_deviations > 5.0, "{verdict:?}");
}
