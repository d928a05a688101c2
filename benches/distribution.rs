//! What splitting costs and what it brings: CPU time and error of the ray tree with N shadow rays and N glossy rays at the first
//! hit, at equal camera samples.
//!
//! `cargo bench --bench distribution [-- part of a scene's name]` prints a table for each scene. Gain is 1 / (time x MSE) over that of
//! one ray of each kind at as many camera samples: above 1, splitting reaches the same error sooner.

#![expect(clippy::print_stdout, reason = "a bench prints its results")]

#[path = "support/pictures.rs"]
mod pictures;

use pictures::{errors, file_of, rendered, scene_of};
use specula::bench::race::interleave;
use specula::error::Result;
use specula::image::Image;

/// A film as wide as this, and 9/16 as high.
const WIDTH: u32 = 160;

/// Camera samples of the reference, each split into four; its own error is that of some 2000 samples.
const REFERENCE: u32 = 512;

/// Renderings of each kind with different seeds, whose times and squared errors are averaged.
const SEEDS: usize = 4;

/// Rays of each kind at the first hit.
const RAYS: [u32; 5] = [1, 2, 4, 8, 16];

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    // Under `cargo test --benches` it only shows that it runs.
    let is_bench = words.iter().any(|word| word == "--bench");
    let filter = words.iter().find(|word| !word.starts_with("--"));
    for name in ["soft_shadows", "depth_of_field", "motion_blur"] {
        if filter.is_none_or(|part| name.contains(part.as_str())) {
            table(name, is_bench)?;
        }
    }
    Ok(())
}

fn table(name: &str, is_bench: bool) -> Result<()> {
    let (truth, _) = picture(name, [if is_bench { REFERENCE } else { 1 }, 4], 1000)?;
    println!("{name}, {WIDTH} x {}", WIDTH * 9 / 16);
    println!("| camera samples | N | CPU s | RMSE | gain |\n|---|---|---|---|---|");
    for spp in if is_bench { &[4, 16, 64][..] } else { &[1] } {
        let mut single = None;
        let mut turns = 0;
        let found = interleave(RAYS.len(), SEEDS, |turn| -> Result<[f64; 2]> {
            let seed = turns / RAYS.len() as u64;
            turns += 1;
            let (found, time) = picture(name, [*spp, RAYS[turn]], seed)?;
            Ok([time, errors(&found, &truth)?.mse])
        })?;
        for (n, runs) in RAYS.into_iter().zip(found) {
            let mean = |i: usize| runs.iter().map(|run| run[i]).sum::<f64>() / SEEDS as f64;
            let (seconds, mse) = (mean(0), mean(1));
            let cost = seconds * mse;
            let gain = *single.get_or_insert(cost) / cost;
            println!("| {spp} | {n} | {seconds:.3} | {:.5} | {gain:.2} |", mse.sqrt());
        }
    }
    Ok(())
}

/// A picture, and the CPU seconds of its rays.
fn picture(name: &str, [spp, n]: [u32; 2], seed: u64) -> Result<(Image, f64)> {
    let keys = [
        ("render.spp", spp.to_string()),
        ("render.light_samples", n.to_string()),
        ("render.glossy_samples", n.to_string()),
        ("render.seed", seed.to_string()),
    ];
    let rendered = rendered(&scene_of(&file_of(name), WIDTH, &keys)?)?;
    Ok((rendered.film.image(), rendered.statistics.render.cpu.as_secs_f64()))
}
