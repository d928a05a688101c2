//! The command `fuzzy`: a saved first pass gives the picture again, and others without a ray.

use assert_cmd::Command;
use specula::image::exr;
use std::path::Path;
use tempfile::TempDir;

/// A ball on a floor, with and without diffuse light of their own; a wall that ends, so that rays escape.
const SCENE: &str = r#"
    [camera]
    from = [0, 0.8, 3]
    at = [0, 0.3, 0]
    vfov_deg = 40
    [film]
    width = 60
    height = 44
    filter = "mitchell"
    [render]
    spp = 3
    max_depth = 4
    glossy = "two-pass"
    [materials]
    floor = { type = "glossy", exponent = 200, reflectance = 0.6, diffuse = 0.1 }
    ball = { type = "phong", exponent = 60, reflectance = [0.8, 0.6, 0.3] }
    wall = { type = "diffuse", reflectance = { checker = [0.8, 0.1], repeat = [12, 6] } }
    [[shapes]]
    type = "rectangle"
    edge_u = [4, 0, 0]
    edge_v = [0, 0, -4]
    material = "floor"
    [[shapes]]
    type = "rectangle"
    center = [0, 0.5, -2]
    edge_u = [1, 0, 0]
    edge_v = [0, 0.5, 0]
    material = "wall"
    [[shapes]]
    type = "sphere"
    center = [0.2, 0.4, 0]
    radius = 0.4
    material = "ball"
    [[lights]]
    type = "environment"
    radiance = 0.6
    [[lights]]
    type = "point"
    position = [1, 2, 2]
    intensity = 9
"#;

fn specula(folder: &TempDir, words: &[&str]) -> std::process::Output {
    let mut command = Command::cargo_bin("specula").expect("built");
    command.current_dir(folder.path()).args(words).arg("-q").output().expect("it runs")
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), SCENE).expect("a scene file");
    folder
}

/// The bits of all colours, and of coverage.
fn bits(folder: &TempDir, file: &str) -> Vec<u32> {
    let picture = exr::read(&folder.path().join(file)).expect("a picture");
    let channel = |name: &str| picture.channel(name).expect("there").to_f32();
    ["R", "G", "B", "A"].iter().flat_map(|name| channel(name)).map(f32::to_bits).collect()
}

fn run(folder: &TempDir, words: &[&str]) {
    let output = specula(folder, words);
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// What a run says that is to fail, with status 2.
fn refused(folder: &TempDir, words: &[&str]) -> String {
    let output = specula(folder, words);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{words:?}: {said}");
    said
}

#[test]
fn a_saved_first_pass_gives_the_picture_again() {
    let folder = folder();
    run(&folder, &["render", "scene.toml", "-o", "whole.exr", "--aov", "gbuffer"]);
    run(&folder, &["fuzzy", "whole.exr", "-o", "again.exr", "-o", "again.png"]);
    assert_eq!(bits(&folder, "whole.exr"), bits(&folder, "again.exr"), "to the bit");
    assert!(folder.path().join("again.png").exists(), "a preview");
    // Without a name, beside it.
    run(&folder, &["fuzzy", "whole.exr", "--roughness", "0.3"]);
    assert!(Path::new(&folder.path().join("whole_fuzzy.exr")).exists(), "named after the file");
}

#[test]
fn another_roughness_is_as_if_it_had_been_rendered() {
    let folder = folder();
    run(&folder, &["render", "scene.toml", "-o", "whole.exr", "--aov", "gbuffer"]);
    let other = ["-D", "materials.floor.exponent=77", "-D", "materials.ball.exponent=77"];
    run(&folder, &[&["render", "scene.toml", "-o", "other.exr"], &other[..]].concat());
    run(&folder, &["fuzzy", "whole.exr", "--exponent", "77", "-o", "again.exr"]);
    let both = || bits(&folder, "other.exr").into_iter().zip(bits(&folder, "again.exr"));
    let apart = both().map(|(a, b)| (f32::from_bits(a) - f32::from_bits(b)).abs());
    // Highlights of lights without a size are of the lobe that was rendered.
    let close = apart.filter(|difference| *difference < 0.02).count();
    assert!(close > both().count() * 95 / 100, "{close} of {}", both().count());
    assert_ne!(bits(&folder, "whole.exr"), bits(&folder, "again.exr"), "another picture");
    run(
        &folder,
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
    let none = bits(&folder, "none.exr").into_iter().map(f32::from_bits);
    assert!(none.clone().all(f32::is_finite), "finite without strength");
    let lit = |file: &str| bits(&folder, file).into_iter().map(f32::from_bits).sum::<f32>();
    assert!(lit("none.exr") < lit("again.exr") - 100.0, "no reflection without strength");
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = folder();
    run(&folder, &["render", "scene.toml", "-o", "plain.exr", "--glossy", "lobe", "--spp", "1"]);
    let said = refused(&folder, &["fuzzy", "plain.exr"]);
    assert!(said.contains("no first pass in it") && said.contains("--aov gbuffer"), "{said}");
    let said = refused(&folder, &["render", "scene.toml", "--glossy", "lobe", "--aov", "gbuffer"]);
    assert!(said.contains("two-pass"), "{said}");
    let said = refused(&folder, &["render", "scene.toml", "-o", "a.part", "-o", "a.png", "--aov", "gbuffer"]);
    assert!(said.contains("`gbuffer` without an EXR file") && said.contains("-o FILE.exr"), "{said}");
    let said = refused(&folder, &["render", "scene.toml", "--integrator", "path"]);
    assert!(said.contains("`path`") && said.contains("whitted"), "{said}");
    let said = refused(&folder, &["render", "scene.toml", "--target-error", "0.1"]);
    assert!(said.contains("target error"), "{said}");
    let said = refused(
        &folder,
        &["render", "scene.toml", "-D", "render.fuzzy.taps=0", "-D", "render.fuzzy.wrong=1"],
    );
    assert!(said.contains("`taps` is 0") && said.contains("`wrong`"), "{said}");
    run(&folder, &["render", "scene.toml", "-o", "whole.exr", "--aov", "gbuffer", "--spp", "1"]);
    let said = refused(&folder, &["fuzzy", "whole.exr", "--lost-mass", "2", "--window", "star"]);
    assert!(said.contains("lost_mass") && said.contains("star"), "{said}");
}

#[test]
fn a_limit_of_time_ends_with_all_pixels_alike() {
    let folder = folder();
    run(
        &folder,
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
    let picture = exr::read(&folder.path().join("timed.exr")).expect("a picture");
    let samples = picture.channel("samples").expect("there").to_f32();
    assert!(samples[0] >= 1.0 && samples[0] < 1e5, "{}", samples[0]);
    assert!(samples.iter().all(|n| n.to_bits() == samples[0].to_bits()), "alike");
    assert_eq!(picture.attribute("specula:ended_by"), Some("time"), "told");
}
