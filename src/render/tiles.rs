//! A picture in tiles, each the work of one thread at a time.

use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::film::{Film, Filter, FilterSample, Layout, SampleId, Tile};
use crate::image::Window;
use crate::integrator::{Counters, Integrator, Worker};
use crate::render::Progress;
use crate::render::eye::Eye;
use crate::sampling::{Dim, Sampler, SamplerKind, Vertex};
use crate::scene::Scene;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Pixels along the edge of a tile: large enough that starting one costs nothing, small enough that the last ones do
/// not keep threads waiting.
const EDGE: u32 = 16;

/// What every tile needs.
pub(super) struct Plan<'a> {
    pub(super) scene: &'a Scene,
    pub(super) window: Window,
    pub(super) filter: Filter,
    pub(super) sampler: SamplerKind,
    pub(super) seed: u32,
    pub(super) progress: &'a dyn Progress,
}

/// All samples of the window, on the threads of the current pool.
pub(super) fn trace<A: Accel, I: Integrator>(
    plan: &Plan<'_>,
    accel: &A,
    integrator: &I,
) -> Result<(Film, Counters)> {
    let scene = plan.scene;
    let full = [scene.film.width, scene.film.height];
    let eye = Eye::new(scene, accel);
    let sums = Mutex::new((Film::new(full, plan.window, Layout::default()), Counters::default()));
    let total = plan.window.area() as u64 * u64::from(scene.render.spp);
    let done = AtomicU64::new(0);
    tiles(plan.window).into_par_iter().try_for_each(|window| -> Result<()> {
        let advance = |samples| {
            plan.progress.advance(done.fetch_add(samples, Ordering::Relaxed) + samples, total);
        };
        let (tile, counters) = plan.tile(window, &eye, integrator, &advance)?;
        let mut sums = sums.lock().unwrap_or_else(PoisonError::into_inner);
        sums.0.add(&tile);
        sums.1 += counters;
        Ok(())
    })?;
    Ok(sums.into_inner().unwrap_or_else(PoisonError::into_inner))
}

impl Plan<'_> {
    /// All samples of a tile; `advance` is told their number row by row, and each pixel asks whether to stop: at many
    /// samples a tile takes minutes.
    fn tile<A: Accel, I: Integrator>(
        &self,
        window: Window,
        eye: &Eye<'_, A>,
        integrator: &I,
        advance: &dyn Fn(u64),
    ) -> Result<(Tile, Counters)> {
        let mut tile = Tile::new(window, Layout::default());
        let mut worker = Worker::default();
        let camera = &self.scene.camera;
        let moves = self.scene.is_moving();
        let has_lens = camera.has_lens();
        for y in window.y0..window.y1 {
            for x in window.x0..window.x1 {
                if self.progress.is_cancelled() {
                    return Err(Error::Interrupted);
                }
                for index in 0..self.scene.render.spp {
                    let sampler = self.sampler.start(self.seed, [x, y], index);
                    let FilterSample { offset, weight } =
                        self.filter.sample(sampler.get_2d(Dim::Film, Vertex::ROOT));
                    let time = if moves { sampler.get_1d(Dim::Time, Vertex::ROOT) } else { 0.0 };
                    let lens = if has_lens { sampler.get_2d(Dim::Lens, Vertex::ROOT) } else { [0.5; 2] };
                    let ray = camera.ray([center(x) + offset[0], center(y) + offset[1]], lens, time);
                    let found = integrator.li(&eye.stage(time), &ray, &sampler, &mut worker);
                    let color = found.color;
                    tile.add(SampleId { x, y, index }, weight, &[color.r, color.g, color.b, found.alpha]);
                }
            }
            advance(u64::from(window.width()) * u64::from(self.scene.render.spp));
        }
        Ok((tile, worker.counters))
    }
}

/// The middle of a column or row.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^24 columns and rows")]
fn center(pixel: u32) -> f32 {
    pixel as f32 + 0.5
}

/// The tiles of a window by rows, the last ones of a row or column narrower.
fn tiles(window: Window) -> Vec<Window> {
    let starts = |from: u32, to: u32| (from..to).step_by(EDGE as usize);
    let rows = starts(window.y0, window.y1);
    rows.flat_map(|y0| {
        starts(window.x0, window.x1).map(move |x0| {
            let (x1, y1) = ((x0 + EDGE).min(window.x1), (y0 + EDGE).min(window.y1));
            Window { x0, y0, x1, y1 }
        })
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_a_window_once() {
        let window = Window { x0: 3, y0: 5, x1: 50, y1: 37 };
        let tiles = tiles(window);
        let area: usize = tiles.iter().map(|tile| tile.area()).sum();
        assert_eq!(area, window.area(), "area");
        for y in window.y0..window.y1 {
            for x in window.x0..window.x1 {
                let owners = tiles.iter().filter(|tile| tile.contains(x, y)).count();
                assert_eq!(owners, 1, "pixel {x}, {y}");
            }
        }
    }
}
