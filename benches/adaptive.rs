//! Whether pictures that end by their error are as good as asked for, and what they cost beside the same number of samples everywhere.
//! `cargo bench --bench adaptive -- [--record] [part of a scene's name]`.
//!
//! For each scene and target, pictures with different seeds against one reference:
//!
//! ```text
//! told        error that the picture itself tells, over the target: mean
//! true        relMSE against the reference, over the target: mean and greatest
//! below       part of the pictures whose true error is below the target
//! spp         samples per pixel: mean, and of the pixels with most
//! samples     how many times as many samples the same error takes if all pixels get as many: what a picture of the mean number has for an
//!             error, over the true error (the error falls as 1 / N)
//! cpu         the same in CPU seconds of rendering
//! ```

#![expect(clippy::print_stdout, reason = "a bench prints its results")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "numbers of samples"
)]

#[path = "../tests/support/noisy.rs"]
mod noisy;
#[path = "../tests/support/pictures.rs"]
mod pictures;
#[path = "../tests/support/scene.rs"]
mod scene;

use noisy::{ALL, Noisy};
use pictures::relmse;
use scene::scene_of;
use specula::film::Film;
use specula::render::{Limits, Rendered, Settings, Silent, render};
use std::fmt::Write as _;

const RECORD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/record/adaptive.csv");

/// How large and how many pictures are.
struct Scale {
    size: [u32; 2],
    runs: u32,
    /// Samples of references over those that the target takes, about.
    reference: u32,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    // Under `cargo test --benches` it only shows that it runs.
    let scale = if std::env::args().any(|word| word == "--bench") {
        Scale { size: [80, 60], runs: 40, reference: 8192 }
    } else {
        Scale { size: [32, 16], runs: 2, reference: 256 }
    };
    let wanted = |noisy: &&Noisy| {
        let parts: Vec<_> = words.iter().filter(|word| !word.starts_with('-')).collect();
        parts.is_empty() || parts.iter().any(|part| noisy.name.contains(part.as_str()))
    };
    let mut table =
        "scene,target,runs,told_mean,true_mean,true_max,below,spp_mean,spp_max,samples,cpu\n".to_owned();
    print!("{table}");
    for noisy in ALL.iter().filter(wanted) {
        let reference = picture(noisy, &scale, "seed = 4711", scale.reference, None).film;
        for target in [2.0 * noisy.target, noisy.target] {
            let row = row(noisy, &scale, target, &reference)?;
            print!("{row}");
            table += &row;
        }
    }
    if words.iter().any(|word| word == "--record") {
        std::fs::write(RECORD, table)?;
    }
    Ok(())
}

fn picture(noisy: &Noisy, scale: &Scale, settings: &str, spp: u32, target: Option<f64>) -> Rendered {
    let scene = scene_of(&noisy.text(scale.size, &format!("{settings}\nspp = {spp}")));
    let limits = Limits { error: target, ..Limits::default() };
    render(&scene, &Settings { limits, ..Settings::default() }, &Silent).expect("a picture")
}

/// The pictures of a scene that end at a target.
fn row(noisy: &Noisy, scale: &Scale, target: f64, reference: &Film) -> Result<String, std::fmt::Error> {
    let runs = f64::from(scale.runs);
    let (mut told, mut errors, mut spp, mut most) = (0.0, Vec::new(), 0.0, 0);
    let (mut even, mut cpu) = (0.0, [0.0; 2]);
    for seed in 0..scale.runs {
        let seed = format!("seed = {seed}");
        let ended = picture(noisy, scale, &seed, 1 << 16, Some(target));
        let mean = ended.film.samples() as f64 / ended.film.window().area() as f64;
        told += ended.statistics.estimate.map_or(0.0, |estimate| estimate.error) / target / runs;
        errors.push(relmse(ended.film.image(), reference.image()) / target);
        spp += mean / runs;
        most = most.max(ended.film.samples_of_pixels()[1]);
        let same = picture(noisy, scale, &seed, mean.round() as u32, None);
        even += relmse(same.film.image(), reference.image()) / target / runs;
        cpu[0] += ended.statistics.render.cpu.as_secs_f64();
        cpu[1] += same.statistics.render.cpu.as_secs_f64();
    }
    let mean = errors.iter().sum::<f64>() / runs;
    let largest = errors.iter().copied().fold(0.0, f64::max);
    let below = errors.iter().filter(|error| **error <= 1.0).count() as f64 / runs;
    let samples = even / mean;
    let mut row = String::new();
    writeln!(
        row,
        "{},{target},{},{told:.3},{mean:.3},{largest:.3},{below:.3},{spp:.1},{most},{samples:.2},{:.2}",
        noisy.name,
        scale.runs,
        samples * cpu[1] / cpu[0]
    )?;
    Ok(row)
}
