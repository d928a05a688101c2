//! Other renderers agree: converged pictures of two scenes by Mitsuba, `shared/data/peer-scenes`.

#[path = "support/peers.rs"]
mod peers;
#[path = "support/scene.rs"]
mod scene;

use scene::scene_of;
use specula::image::{self, Decoded, Image};
use specula::render::{Settings, Silent, render};

/// Side of the pictures.
const SIZE: u32 = 256;

#[test]
fn pictures_agree_with_those_of_mitsuba() {
    let Some(folder) = peers::folder() else { return };
    for name in ["cornell", "glossyrow"] {
        let Decoded { image: reference, .. } =
            image::read(&folder.join(name).join("reference.exr")).expect("a reference");
        for query in ["single", "stream"] {
            // Another set of numbers for each, lest one be tested twice.
            let settings =
                format!("integrator = \"path\"\nquery = \"{query}\"\nspp = 16\nseed = {}", query.len());
            let scene = scene_of(&peers::scene_file(&folder, name, &settings, SIZE));
            let film = render(&scene, &Settings::default(), &Silent).expect("a picture").film;
            compare(&format!("{name}, {query}"), &film.image(), &reference);
        }
    }
}

/// Means of blocks of pixels agree within their noise, which is estimated from the block's own differences.
#[expect(clippy::print_stdout, reason = "tells what was found")]
fn compare(what: &str, ours: &Image, reference: &Image) {
    const BLOCKS: usize = 8;
    let side = SIZE as usize / BLOCKS;
    let count = (side * side) as f64;
    let (mut worst, mut sum, mut variance) = (0.0_f64, 0.0, 0.0);
    for block in 0..BLOCKS * BLOCKS {
        let (x0, y0) = (block % BLOCKS * side, block / BLOCKS * side);
        let differences = (y0..y0 + side).flat_map(|y| (x0..x0 + side).map(move |x| y * SIZE as usize + x));
        let differences: Vec<f64> = differences
            .map(|at| {
                let (a, b) = (ours.pixels()[at], reference.pixels()[at]);
                f64::from(a.r - b.r) + f64::from(a.g - b.g) + f64::from(a.b - b.b)
            })
            .collect();
        let mean = differences.iter().sum::<f64>() / count;
        let square = differences.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / (count - 1.0);
        // The reference has noise, too, and what of it is of single precision.
        worst = worst.max(mean.abs() / (square / count).sqrt().max(1e-4));
        sum += mean;
        variance += square / count;
    }
    let deviations = sum.abs() / variance.sqrt();
    println!(
        "{what}: the mean is {deviations:.2} deviations off, the worst of {} blocks {worst:.2}",
        BLOCKS * BLOCKS
    );
    // 64 blocks by 4 pictures: beyond 4.5 deviations once in 570 runs, and numbers are the same in every run.
    assert!(worst < 4.5, "{what}: a block is {worst} deviations off");
    assert!(deviations < 3.5, "{what}: the picture is {deviations} deviations off");
}
