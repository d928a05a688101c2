//! FLIP: how different two pictures look when one is shown in place of the other.
//!
//! Between pictures as displays show them: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, 2020, "FLIP:
//! A difference evaluator for alternating images". Between pictures of scene light, at all exposures that show anything of
//! the reference: Andersson, Nilsson, Shirley, Akenine-Möller, 2021, "Visualizing errors in rendered high dynamic range
//! images". Single precision; agrees with the authors' implementation (`tests/flip.rs`). Errors do not depend on threads.
//!
//! Limits: light must be finite; negative light counts as black.

mod colour;
mod filter;
mod sight;
mod tile;
mod tone;

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};

use self::filter::Filters;
use self::tile::Tile;
use self::tone::Tone;
use crate::error::{Error, Result};
use crate::image::Image;
use crate::math::lanes::Level;
use crate::render::Progress;

pub use tone::Exposures;

/// Where the viewer sits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewing {
    /// Pixels in one degree of the visual field, from 1 to 1000.
    pub pixels_per_degree: f64,
}

impl Viewing {
    /// Least and greatest [`Viewing::pixels_per_degree`]: beyond them filters have one pixel, or hundreds.
    pub const RANGE: std::ops::RangeInclusive<f64> = 1.0..=1000.0;
}

impl Default for Viewing {
    /// A display 0.7 m away that shows 3840 pixels on 0.7 m, as in the paper.
    fn default() -> Self {
        Self { pixels_per_degree: 0.7 * 3840.0 / 0.7 * std::f64::consts::PI / 180.0 }
    }
}

/// The error of each pixel in [0, 1], by row from the top, between pictures of one size as displays show them: linear
/// light in [0, 1], cut to that. Symmetric.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` says so.
///
/// # Panics
/// If the sizes differ.
pub fn displayed(pictures: [&Image; 2], viewing: Viewing, watch: Watch<'_>) -> Result<Vec<f32>> {
    errors(pictures, viewing, &[Tone::Clip], watch)
}

/// The error of each pixel in [0, 1], by row from the top, between pictures of scene light of one size: the greatest at
/// any of the exposures.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` says so.
///
/// # Panics
/// If the sizes differ.
pub fn exposed(
    pictures: [&Image; 2],
    viewing: Viewing,
    exposures: &Exposures,
    watch: Watch<'_>,
) -> Result<Vec<f32>> {
    errors(pictures, viewing, &exposures.tones(), watch)
}

/// With which lanes to compute, and who is told how far it is.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// The instruction set.
    pub level: Level,
    /// Told pixels; may stop it.
    pub progress: &'a dyn Progress,
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch").field("level", &self.level).finish_non_exhaustive()
    }
}

fn errors(pictures: [&Image; 2], viewing: Viewing, tones: &[Tone], watch: Watch<'_>) -> Result<Vec<f32>> {
    let [width, height] = [pictures[0].width(), pictures[0].height()].map(|n| n as usize);
    assert_eq!([pictures[1].width(), pictures[1].height()].map(|n| n as usize), [width, height], "sizes");
    let filters = Filters::new(viewing.pixels_per_degree);
    let total = (width * height) as u64;
    let done = AtomicU64::new(0);
    let tiles: Result<Vec<_>> = origins(width, height)
        .into_par_iter()
        .map(|origin| {
            if watch.progress.is_cancelled() {
                return Err(Error::Interrupted);
            }
            let tile = Tile::new(pictures, origin, &filters, tones);
            let errors = watch.level.run(&tile);
            let pixels = (tile.columns().min(width - origin[0]) * tile.rows()) as u64;
            watch.progress.advance(done.fetch_add(pixels, Ordering::Relaxed) + pixels, total);
            Ok((origin, tile.columns(), errors))
        })
        .collect();
    let mut map = vec![0.0; width * height];
    for ([x, y], columns, errors) in tiles? {
        let inside = columns.min(width - x);
        for (row, errors) in errors.chunks_exact(columns).enumerate() {
            map[(y + row) * width + x..][..inside].copy_from_slice(&errors[..inside]);
        }
    }
    Ok(map)
}

/// The first pixels of all tiles.
fn origins(width: usize, height: usize) -> Vec<[usize; 2]> {
    let [columns, rows] = tile::SIDES;
    (0..height).step_by(rows).flat_map(|y| (0..width).step_by(columns).map(move |x| [x, y])).collect()
}
