//! What each knob of shading costs and what it brings: speed and error of whole pictures, in one table.
//!
//! Races: models of reflectance, on glass and on metal; what becomes of directions of a Phong lobe below the surface, for
//! several exponents; how many rays are sent at the first hits, at as many shadow and glossy rays altogether.
//! `cargo bench --bench knobs -- [--record] [part of a race's name]`.
//!
//! Errors of a contestant, over all pixels and channels of a picture of linear light:
//!
//! ```text
//! rmse        of the picture that is timed, against a reference of many samples: noise and the model's error
//! noise       of the picture that is timed, about its own mean: from two pictures with different seeds
//! model_rmse, model_relmse, model_bias
//!             the model's error alone: at many samples, against the first contestant with the same random numbers
//! floor       what noise leaves in model_rmse at most, were the random numbers not the same
//! ```

#[path = "support/pictures.rs"]
mod pictures;
#[path = "support/mod.rs"]
mod support;

use pictures::{errors, file_of, rendered, scene_of};
use specula::error::Result;
use specula::image::Image;
use specula::scene::Scene;
use std::io::Write as _;
use std::path::PathBuf;
use support::{Bench, Figure, Race};

/// Pictures are as wide as this, and 9/16 as high.
const WIDTH: u32 = 80;

/// Samples per pixel where every way on is followed and little is left to chance: of what is timed, and of references.
const OF_TREES: [u32; 2] = [2, 32];

/// The same where directions are drawn.
const OF_LOBES: [u32; 2] = [16, 256];

/// Keys of a scene file, and what they are set to.
type Keys<'a> = Vec<(&'a str, String)>;

/// A value of the knob: its name, the samples per pixel at which it is timed, and its keys.
type Position<'a> = (String, u32, Keys<'a>);

/// A knob on a scene.
struct Knob<'a> {
    name: String,
    scene: PathBuf,
    positions: Vec<Position<'a>>,
    /// Samples per pixel of the reference.
    many: u32,
    /// Whether positions differ in more than noise.
    is_model: bool,
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let mut bench = Bench::new("knobs");
    // Under `cargo test --benches` it only shows that it runs.
    let scale = if std::env::args().any(|word| word == "--bench") { 1 } else { 16 };
    let mut ball = tempfile::Builder::new().suffix(".toml").tempfile()?;
    ball.write_all(BALL.as_bytes())?;
    let matt = ["materials.floor.fresnel", "materials.shelf.fresnel"];
    let model = |name: String, scene: PathBuf, positions, [_, many]: [u32; 2]| Knob {
        name,
        scene,
        positions,
        many,
        is_model: true,
    };
    let mut knobs = vec![
        model("fresnel on glass".to_owned(), file_of("ray_tree"), fresnel(&[]), OF_TREES),
        model("fresnel on metal".to_owned(), file_of("metals"), fresnel(&matt), OF_TREES),
    ];
    for exponent in [1, 10, 100, 1000] {
        let name = format!("below the surface e = {exponent}");
        knobs.push(model(name, ball.path().to_owned(), below(exponent), OF_LOBES));
    }
    let (name, scene) = ("splitting".to_owned(), file_of("soft_shadows"));
    knobs.push(Knob { name, scene, positions: splitting(), many: 512, is_model: false });
    for knob in knobs.iter().filter(|knob| bench.wants(&knob.name)).collect::<Vec<_>>() {
        race(&mut bench, knob, scale)?;
    }
    bench.finish()?;
    Ok(())
}

/// The models of reflectance; those materials that `exact` names keep Fresnel's equations.
fn fresnel<'a>(exact: &[&'a str]) -> Vec<Position<'a>> {
    let position = |model: &str| {
        let kept = exact.iter().map(|&key| (key, "exact".to_owned()));
        let keys = [("render.fresnel", model.to_owned())].into_iter().chain(kept).collect();
        (model.to_owned(), OF_TREES[0], keys)
    };
    ["exact", "schlick", "f82", "constant"].map(position).into()
}

/// A ball on a floor of tiles, under a lamp and a sky: bright, dark and narrow things to be mirrored at every angle.
const BALL: &str = r#"
    [camera]
    from = [0.0, 1.4, 4.5]
    at = [0.0, 0.95, 0.0]
    vfov_deg = 26.0
    [film]
    filter = "box"
    [render]
    max_depth = 4
    [materials.floor]
    type = "diffuse"
    reflectance = { checker = [0.15, 0.75], repeat = [20, 20] }
    [materials.ball]
    type = "glossy"
    [[shapes]]
    type = "rectangle"
    edge_u = [10.0, 0.0, 0.0]
    edge_v = [0.0, 0.0, -10.0]
    material = "floor"
    [[shapes]]
    type = "sphere"
    center = [0.0, 1.0, 0.0]
    material = "ball"
    [[lights]]
    type = "rectangle"
    center = [-2.0, 3.5, 1.0]
    edge_u = [0.8, 0.0, 0.4]
    edge_v = [0.3, 0.5, -0.6]
    radiance = 8.0
    [[lights]]
    type = "environment"
    radiance = 0.3
"#;

/// What becomes of what falls below; the reference, which only leaves it out and brings the rest back to 1, comes first.
fn below(exponent: u32) -> Vec<Position<'static>> {
    let glossy = |below: &str| {
        let keys = vec![
            ("materials.ball.exponent", exponent.to_string()),
            ("materials.ball.below", below.to_owned()),
        ];
        (below.to_owned(), OF_LOBES[0], keys)
    };
    let trembling = vec![
        ("materials.ball.type", "jitter".to_owned()),
        // As sharp where the ball is seen straight on.
        ("materials.ball.exponent", (4 * exponent + 3).to_string()),
    ];
    let [rejection, through_r, discard] = ["rejection", "through_r", "discard"].map(glossy);
    vec![rejection, through_r, discard, ("jitter".to_owned(), OF_LOBES[0], trembling)]
}

/// Samples per pixel, shadow rays and glossy rays, and how many hits split; but for the last ones with equal products.
fn splitting() -> Vec<Position<'static>> {
    let positions = [
        [32, 1, 1, 0],
        [16, 2, 2, 1],
        [8, 4, 4, 1],
        [4, 8, 8, 1],
        [2, 16, 16, 1],
        [8, 4, 4, 2],
        [8, 4, 1, 1],
        [8, 1, 4, 1],
    ];
    let position = |[spp, lights, glossy, hits]: [u32; 4]| {
        let keys = vec![
            ("render.light_samples", lights.to_string()),
            ("render.glossy_samples", glossy.to_string()),
            ("render.split_depth", hits.to_string()),
        ];
        (format!("{spp} spp x {lights} shadow {glossy} glossy at {hits} hits"), spp, keys)
    };
    positions.map(position).into()
}

/// A race of the positions of a knob, over pictures with samples divided by `scale`.
fn race(bench: &mut Bench, knob: &Knob<'_>, scale: u32) -> Result<()> {
    let scene = |keys: &Keys<'_>, spp: u32, seed: u32| {
        let more = [("render.spp", (spp / scale).max(1).to_string()), ("render.seed", seed.to_string())];
        scene_of(&knob.scene, WIDTH, &keys.iter().cloned().chain(more).collect::<Vec<_>>())
    };
    let picture = |keys: &Keys<'_>, spp, seed| -> Result<Image> {
        Ok(rendered(&scene(keys, spp, seed)?)?.film.image())
    };
    let reference = picture(&knob.positions[0].2, knob.many, 1000)?;
    let mut race = Race::new(&knob.name, (WIDTH * (WIDTH * 9 / 16)) as usize, "pixels");
    for (position, spp, keys) in &knob.positions {
        let pictures = [picture(keys, *spp, 1)?, picture(keys, *spp, 2)?];
        let model = if knob.is_model { Some(picture(keys, knob.many, 1000)?) } else { None };
        let more = f64::from(knob.many) / f64::from(*spp);
        let figures = figures(&pictures, &reference, model.as_ref(), more)?;
        let scene: Scene = scene(keys, *spp, 1)?;
        let pass = move || rendered(&scene).expect("a picture").statistics.counters.rays();
        race = race.with(position, pass).knowing(figures);
    }
    bench.run(race);
    Ok(())
}

/// What is wrong with two pictures of different noise, and with one of its `model` at `more` times the samples.
fn figures(pair: &[Image; 2], reference: &Image, model: Option<&Image>, more: f64) -> Result<Vec<Figure>> {
    let total = [errors(&pair[0], reference)?.mse, errors(&pair[1], reference)?.mse];
    let noise = (errors(&pair[0], &pair[1])?.mse / 2.0).sqrt();
    let of_model = model.map(|model| errors(model, reference)).transpose()?;
    Ok(vec![
        ("rmse", Some(f64::midpoint(total[0], total[1]).sqrt())),
        ("noise", Some(noise)),
        ("model_rmse", of_model.map(|errors| errors.rmse())),
        ("model_relmse", of_model.map(|errors| errors.relmse)),
        ("model_bias", of_model.map(|errors| errors.bias)),
        ("floor", of_model.map(|_| noise * (2.0 / more).sqrt())),
    ])
}
