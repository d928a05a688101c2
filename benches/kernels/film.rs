//! Samples added to a tile of the film, which sums in double precision without lanes.

use crate::support::Race;
use specula::film::{Aov, Layout, SampleId, Tile};
use specula::image::Window;
use specula::sampling::pcg::pcg3d;
use std::hint::black_box;

/// Pixels of a tile along each side.
const EDGE: u32 = 32;

/// Samples of a pass, in whole tiles.
const SAMPLES: u32 = 1 << 18;

/// One by one against a call per pixel, with `spp` samples in each.
pub(crate) fn race(spp: u32) -> Race<'static> {
    let samples: Vec<(f32, [f32; 4])> = (0..spp)
        .map(|i| {
            let [r, g, b] = pcg3d([i, 1, 2]).map(|bits| (bits >> 8) as f32 / 16_777_216.0);
            (0.5 + r, [r, g, b, 1.0])
        })
        .collect();
    let window = Window { x0: 0, y0: 0, x1: EDGE, y1: EDGE };
    let tile = move || Tile::new(window, Layout::new([Aov::Beauty, Aov::Alpha]));
    let pixels = move || {
        let tiles = SAMPLES / spp / (EDGE * EDGE);
        (0..tiles * EDGE * EDGE).map(|i| SampleId { x: i % EDGE, y: i / EDGE % EDGE, index: 0 })
    };
    let (weights, values): (Vec<f32>, Vec<[f32; 4]>) = samples.iter().copied().unzip();
    let (mut one, mut many) = (tile(), tile());
    Race::new(format!("film with runs of {spp}"), SAMPLES as usize, "samples")
        .with("add", move || {
            for first in pixels() {
                for (index, (weight, values)) in (0..).zip(black_box(&samples)) {
                    one.add(SampleId { index, ..first }, *weight, values);
                }
            }
            one.window().area() as u64
        })
        .with("add_run", move || {
            for first in pixels() {
                many.add_run(first, black_box(&weights), black_box(values.as_flattened()));
            }
            many.window().area() as u64
        })
}
