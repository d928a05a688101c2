//! The scenes of this repository: all load, build and give pictures without a complaint, and the ball of `through_r` shows what its first
//! lines promise.

#[path = "support/scene.rs"]
mod support;

use specula::film::Aov;
use specula::scene::{self, Scene};
use std::path::{Path, PathBuf};
use support::film;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// A scene file with some values replaced; what is warned of is a failure.
fn read(path: &Path, settings: &[String]) -> Scene {
    let name = path.display();
    let loaded = support::loaded(path, settings);
    assert_eq!(loaded.warnings, [], "{name}");
    let built = scene::build(&loaded.description).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(built.warnings, [], "{name}");
    built.scene
}

#[test]
fn every_scene_gives_a_picture() {
    let entries = std::fs::read_dir(folder()).expect("scenes");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    assert!(files.len() >= 20, "{} scenes", files.len());
    for path in files {
        let name = path.display();
        let [width, height] = {
            let whole = read(&path, &[]).film;
            [whole.width, whole.height]
        };
        // 32 pixels wide, of the same shape.
        let small = [format!("film.width={}", 32), format!("film.height={}", (32 * height).div_ceil(width))];
        let scene = read(&path, &[&small[..], &["render.spp=4".to_owned()]].concat());
        let image = film(&scene).image();
        let sum: f64 = image.pixels().iter().map(|pixel| f64::from(pixel.luminance())).sum();
        let mean = sum / image.pixels().len() as f64;
        println!("{name}: a mean of {mean:.3}");
        assert!(mean > 0.01 && mean < 100.0, "{name}: a mean of {mean}");
    }
}

const SIDE: u32 = 48;

/// The values of the pixels that the ball of `through_r` fills, each with the cosine that its middle is seen at.
fn ball(below: &str, samples: u32) -> Vec<(f64, f64)> {
    let settings = [
        format!("film.width={SIDE}"),
        format!("film.height={SIDE}"),
        format!("render.spp={samples}"),
        format!("materials.ball.below={below}"),
    ];
    let film = film(&read(&folder().join("through_r.toml"), &settings));
    let channels = film.channels(Aov::Beauty).expect("kept");
    let mut seen = Vec::new();
    for (i, &value) in channels[0].iter().enumerate() {
        // The camera is four radii away, and the picture 36 degrees high.
        let middle = |k: usize| (k as f64 + 0.5) / f64::from(SIDE) * 2.0 - 1.0;
        let (x, y) = (middle(i % SIDE as usize), middle(i / SIDE as usize));
        let tan = |at: f64| at * 18.0_f64.to_radians().tan();
        let corner = |at: f64| at.abs() + 1.0 / f64::from(SIDE);
        let passes = |x: f64, y: f64| {
            let tan2 = tan(x).powi(2) + tan(y).powi(2);
            4.0 * (tan2 / (1.0 + tan2)).sqrt()
        };
        if passes(corner(x), corner(y)) < 1.0 {
            seen.push((f64::from(value), (1.0 - passes(x, y).powi(2)).sqrt()));
        }
    }
    seen
}

#[test]
fn the_ball_is_one_value_where_directions_turn_through_r_and_dark_at_its_rim_where_they_are_lost() {
    let constant = ball("through_r", 16);
    assert!(constant.len() > 1000, "{} pixels of the ball", constant.len());
    let first = constant[0].0;
    assert!((first - 0.8).abs() < 1e-6, "{first}");
    for (value, cos) in &constant {
        assert!(value.to_bits() == first.to_bits(), "{value} at a cosine of {cos}, elsewhere {first}");
    }
    // A cosine lobe about a direction at the angle t from the normal has (1 + cos t) / 2 of itself above the surface.
    let lost = ball("discard", 256);
    let mut sum = 0.0;
    for (value, cos) in &lost {
        let exact = 0.8 * (1.0 + cos) / 2.0;
        sum += value - exact;
        // Five standard deviations of independent samples, and the width of a pixel.
        let part = exact / 0.8;
        let sigma = 0.8 * (part * (1.0 - part) / 256.0).sqrt();
        assert!((value - exact).abs() < 5.0 * sigma + 0.02, "{value} for {exact}");
    }
    let mean = sum / lost.len() as f64;
    assert!(mean.abs() < 2e-3, "off by {mean} on average");
    let darkest = lost.iter().map(|(value, _)| *value).fold(1.0, f64::min);
    assert!(darkest < 0.56, "a dark rim: {darkest}");
}
