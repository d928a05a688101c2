//! The command `fuzzy`: a saved first pass gives the picture again, and others without a ray.

use crate::desk::Desk;
use crate::edge::ball_on_floor;
use specula::image::exr;

fn desk() -> Desk {
    let desk = Desk::new();
    std::fs::write(desk.path("scene.toml"), ball_on_floor("glossy = \"two-pass\"")).expect("a scene file");
    desk
}

/// The bits of all colours, and of coverage.
fn bits(desk: &Desk, file: &str) -> Vec<u32> {
    let picture = exr::read(&desk.path(file)).expect("a picture");
    let channel = |name: &str| picture.channel(name).expect("there").to_f32();
    ["R", "G", "B", "A"].iter().flat_map(|name| channel(name)).map(f32::to_bits).collect()
}

fn run(desk: &Desk, words: &[&str]) {
    let (status, _, said) = desk.run(&[words, &["-q"]].concat());
    assert_eq!(status, 0, "{words:?}: {said}");
}

/// What a run says that is to fail, with status 2.
fn refused(desk: &Desk, words: &[&str]) -> String {
    let (status, _, said) = desk.run(&[words, &["-q"]].concat());
    assert_eq!(status, 2, "{words:?}: {said}");
    said
}

#[test]
fn a_saved_first_pass_gives_the_picture_again() {
    let desk = desk();
    run(&desk, &["render", "scene.toml", "-o", "whole.exr", "--aov", "gbuffer"]);
    run(&desk, &["fuzzy", "whole.exr", "-o", "again.exr", "-o", "again.png"]);
    assert_eq!(bits(&desk, "whole.exr"), bits(&desk, "again.exr"), "to the bit");
    assert!(desk.path("again.png").exists(), "a preview");
    // Without a name, beside it.
    run(&desk, &["fuzzy", "whole.exr", "--roughness", "0.3"]);
    assert!(desk.path("whole_fuzzy.exr").exists(), "named after the file");
}

#[test]
fn another_roughness_is_as_if_it_had_been_rendered() {
    let desk = desk();
    run(&desk, &["render", "scene.toml", "-o", "whole.exr", "--aov", "gbuffer"]);
    let other = ["-D", "materials.floor.exponent=77", "-D", "materials.ball.exponent=77"];
    run(&desk, &[&["render", "scene.toml", "-o", "other.exr"], &other[..]].concat());
    run(&desk, &["fuzzy", "whole.exr", "--exponent", "77", "-o", "again.exr"]);
    let both = || bits(&desk, "other.exr").into_iter().zip(bits(&desk, "again.exr"));
    let apart = both().map(|(a, b)| (f32::from_bits(a) - f32::from_bits(b)).abs());
    // Highlights of lights without a size are of the lobe that was rendered.
    let close = apart.filter(|difference| *difference < 0.02).count();
    assert!(close > both().count() * 95 / 100, "{close} of {}", both().count());
    assert_ne!(bits(&desk, "whole.exr"), bits(&desk, "again.exr"), "another picture");
    run(
        &desk,
        &[
            "fuzzy",
            "whole.exr",
            "--exponent",
            "77",
            "--weighting",
            "shininess",
            "--strength",
            "0",
            "-o",
            "none.exr",
        ],
    );
    let none = bits(&desk, "none.exr").into_iter().map(f32::from_bits);
    assert!(none.clone().all(f32::is_finite), "finite without strength");
    let lit = |file: &str| bits(&desk, file).into_iter().map(f32::from_bits).sum::<f32>();
    assert!(lit("none.exr") < lit("again.exr") - 100.0, "no reflection without strength");
}

#[test]
fn what_cannot_be_is_refused() {
    let desk = desk();
    run(&desk, &["render", "scene.toml", "-o", "plain.exr", "--glossy", "lobe", "--spp", "1"]);
    let said = refused(&desk, &["fuzzy", "plain.exr"]);
    assert!(said.contains("no first pass in it") && said.contains("--aov gbuffer"), "{said}");
    let said = refused(&desk, &["render", "scene.toml", "--glossy", "lobe", "--aov", "gbuffer"]);
    assert!(said.contains("two-pass"), "{said}");
    let said = refused(&desk, &["render", "scene.toml", "-o", "a.part", "-o", "a.png", "--aov", "gbuffer"]);
    assert!(said.contains("`gbuffer` without an EXR file") && said.contains("-o FILE.exr"), "{said}");
    let said = refused(&desk, &["render", "scene.toml", "--integrator", "path"]);
    assert!(said.contains("`path`") && said.contains("whitted"), "{said}");
    let said = refused(&desk, &["render", "scene.toml", "--target-error", "0.1"]);
    assert!(said.contains("target error"), "{said}");
    let said =
        refused(&desk, &["render", "scene.toml", "-D", "render.fuzzy.taps=0", "-D", "render.fuzzy.wrong=1"]);
    assert!(said.contains("`taps` is 0") && said.contains("`wrong`"), "{said}");
    run(&desk, &["render", "scene.toml", "-o", "whole.exr", "--aov", "gbuffer", "--spp", "1"]);
    let said = refused(&desk, &["fuzzy", "whole.exr", "--lost-mass", "2", "--window", "star"]);
    assert!(said.contains("lost_mass") && said.contains("star"), "{said}");
    let said = refused(&desk, &["fuzzy", "whole.exr", "--exponent", "9", "-o", "./whole.exr"]);
    assert!(said.contains("`./whole.exr` is read and would be overwritten"), "{said}");
    run(&desk, &["fuzzy", "whole.exr", "-o", "again.exr"]);
    assert_eq!(bits(&desk, "whole.exr"), bits(&desk, "again.exr"), "the first pass is there as before");
}

#[test]
fn a_limit_of_time_ends_with_all_pixels_alike() {
    let desk = desk();
    run(
        &desk,
        &[
            "render",
            "scene.toml",
            "-o",
            "timed.exr",
            "--time-limit",
            "1s",
            "--spp",
            "100000",
            "--aov",
            "samples",
        ],
    );
    let picture = exr::read(&desk.path("timed.exr")).expect("a picture");
    let samples = picture.channel("samples").expect("there").to_f32();
    assert!(samples[0] >= 1.0 && samples[0] < 1e5, "{}", samples[0]);
    assert!(samples.iter().all(|n| n.to_bits() == samples[0].to_bits()), "alike");
    assert_eq!(picture.attribute("specula:ended_by"), Some("time"), "told");
}
