//! What splitting costs and what it brings: CPU time and error of the ray tree with N shadow rays and N glossy rays at the first
//! hit, at equal camera samples and at equal time.
//!
//! `cargo bench --bench distribution [-- part of a scene's name]` prints a table for each scene. Gain is 1 / (time x MSE) over that of
//! one ray of each kind at as many camera samples: above 1, splitting reaches the same error sooner.

#![expect(clippy::print_stdout, reason = "a bench prints its results")]

use specula::film::{Aov, Film};
use specula::render::{Settings, Silent, render};
use specula::scene;
use std::num::NonZeroUsize;
use std::path::Path;

/// A film as wide as this, and 9/16 as high.
const WIDTH: u32 = 160;

/// Camera samples of the reference, each split into four; its own error is that of some 2000 samples.
const REFERENCE: u32 = 512;

/// Renderings of each kind with different seeds, whose times and squared errors are averaged.
const SEEDS: u64 = 4;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    // Under `cargo test` it only shows that it runs.
    let is_bench = words.iter().any(|word| word == "--bench");
    let filter = words.iter().find(|word| !word.starts_with("--"));
    for name in ["soft_shadows", "depth_of_field", "motion_blur"] {
        if filter.is_none_or(|part| name.contains(part.as_str())) {
            table(name, is_bench)?;
        }
    }
    Ok(())
}

fn table(name: &str, is_bench: bool) -> Result<(), Box<dyn std::error::Error>> {
    let (truth, _) = picture(name, [if is_bench { REFERENCE } else { 1 }, 4], 1000)?;
    println!("{name}, {WIDTH} x {}", WIDTH * 9 / 16);
    println!("| camera samples | N | CPU s | RMSE | gain |\n|---|---|---|---|---|");
    for spp in if is_bench { &[4, 16, 64][..] } else { &[1] } {
        let mut single = None;
        for n in [1, 2, 4, 8, 16] {
            let (mut seconds, mut mse) = (0.0, 0.0);
            for seed in 0..SEEDS {
                let (found, time) = picture(name, [*spp, n], seed)?;
                seconds += time / SEEDS as f64;
                mse += mean_square(&found, &truth) / SEEDS as f64;
            }
            let cost = seconds * mse;
            let gain = *single.get_or_insert(cost) / cost;
            println!("| {spp} | {n} | {seconds:.3} | {:.5} | {gain:.2} |", mse.sqrt());
        }
    }
    Ok(())
}

/// Red, green and blue, each row by row.
type Colors = Vec<Vec<f32>>;

/// The colour channels of a picture, and the CPU seconds of its rays.
fn picture(name: &str, [spp, n]: [u32; 2], seed: u64) -> Result<(Colors, f64), Box<dyn std::error::Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("toml");
    let keys = [
        ("film.width", u64::from(WIDTH)),
        ("film.height", u64::from(WIDTH * 9 / 16)),
        ("render.spp", spp.into()),
        ("render.light_samples", n.into()),
        ("render.glossy_samples", n.into()),
        ("render.seed", seed),
    ];
    let overrides = keys.map(|(key, value)| format!("{key}={value}"));
    let scene = scene::build(&scene::load(&path, &overrides)?.description)?.scene;
    let rendered = render(&scene, &Settings { threads: NonZeroUsize::new(1), crop: None }, &Silent)?;
    Ok((colors(&rendered.film), rendered.statistics.render.cpu.as_secs_f64()))
}

fn colors(film: &Film) -> Colors {
    film.channels(Aov::Beauty).map_or_else(Vec::new, |channels| channels.into_iter().take(3).collect())
}

fn mean_square(a: &[Vec<f32>], b: &[Vec<f32>]) -> f64 {
    let pairs = || a.iter().flatten().zip(b.iter().flatten());
    pairs().map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / pairs().count() as f64
}
