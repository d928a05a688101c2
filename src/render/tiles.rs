//! A picture in tiles, each the work of one thread at a time.

use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::film::{Film, Filter, FilterSample, Layout, SampleId, Tile};
use crate::geometry::Ray;
use crate::image::Window;
use crate::integrator::{Counters, Integrator, Path, Radiance, Wave, Worker};
use crate::render::Progress;
use crate::render::eye::Eye;
use crate::sampling::{AnySampler, Dim, Sampler, SamplerKind, Vertex};
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
    /// Whether anything moves.
    pub(super) moves: bool,
    pub(super) progress: &'a dyn Progress,
}

/// All samples of the window, on the threads of the current pool.
pub(super) fn trace<A: Accel, E: Engine>(plan: &Plan<'_>, accel: &A, engine: &E) -> Result<(Film, Counters)> {
    let scene = plan.scene;
    let full = [scene.film.width, scene.film.height];
    let eye = Eye::new(scene, accel);
    let sums = Mutex::new((Film::new(full, plan.window, Layout::default()), Counters::default()));
    let total = plan.window.area() as u64 * u64::from(scene.render.spp);
    let done = AtomicU64::new(0);
    let advance = |samples| {
        plan.progress.advance(done.fetch_add(samples, Ordering::Relaxed) + samples, total);
    };
    tiles(plan.window).into_par_iter().try_for_each_init(E::Memory::default, |memory, window| {
        let mut work =
            Work { plan, eye: &eye, tile: Tile::new(window, Layout::default()), advance: &advance };
        let counters = engine.tile(&mut work, memory)?;
        let mut sums = sums.lock().unwrap_or_else(PoisonError::into_inner);
        sums.0.add(&work.tile);
        sums.1 += counters;
        Ok::<(), Error>(())
    })?;
    Ok(sums.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// How the samples of a tile are taken.
pub(super) trait Engine: Sync {
    /// What a thread keeps from tile to tile.
    type Memory: Default;

    /// Takes all samples of a tile, those of each pixel in the order of their indices. Asks often whether to stop.
    fn tile<A: Accel>(&self, work: &mut Work<'_, A>, memory: &mut Self::Memory) -> Result<Counters>;
}

/// A tile to be done.
pub(super) struct Work<'a, A> {
    plan: &'a Plan<'a>,
    eye: &'a Eye<'a, A>,
    tile: Tile,
    /// Is told how many samples have been taken.
    advance: &'a dyn Fn(u64),
}

/// A ray from the camera, and what its light counts.
struct CameraSample {
    weight: f32,
    ray: Ray,
}

impl<A> Work<'_, A> {
    /// All samples, pixel by pixel in the order of their indices.
    fn samples(&self) -> impl Iterator<Item = SampleId> + use<A> {
        let (window, spp) = (self.tile.window(), self.plan.scene.render.spp);
        let rows = window.y0..window.y1;
        rows.flat_map(move |y| {
            (window.x0..window.x1).flat_map(move |x| (0..spp).map(move |index| SampleId { x, y, index }))
        })
    }

    fn start(&self, SampleId { x, y, index }: SampleId) -> AnySampler<u32> {
        self.plan.sampler.start(self.plan.seed, [x, y], index)
    }

    fn camera_sample(&self, id: SampleId, sampler: &AnySampler<u32>) -> CameraSample {
        let scene = self.plan.scene;
        let camera = &scene.camera;
        let FilterSample { offset, weight } =
            self.plan.filter.sample(sampler.get_2d(Dim::Film, Vertex::ROOT));
        let time = if self.plan.moves { sampler.get_1d(Dim::Time, Vertex::ROOT) } else { 0.0 };
        let lens = if camera.has_lens() { sampler.get_2d(Dim::Lens, Vertex::ROOT) } else { [0.5; 2] };
        let ray = camera.ray([center(id.x) + offset[0], center(id.y) + offset[1]], lens, time);
        CameraSample { weight, ray }
    }

    fn add(&mut self, id: SampleId, weight: f32, Radiance { color, alpha }: Radiance) {
        self.tile.add(id, weight, &[color.r, color.g, color.b, alpha]);
    }

    /// Tells of samples taken; fails if somebody wants to stop.
    fn report(&self, samples: u64) -> Result<()> {
        (self.advance)(samples);
        if self.plan.progress.is_cancelled() { Err(Error::Interrupted) } else { Ok(()) }
    }
}

/// One sample after the other.
pub(super) struct OneByOne<'a, I>(pub(super) &'a I);

impl<I: Integrator> Engine for OneByOne<'_, I> {
    type Memory = ();

    fn tile<A: Accel>(&self, work: &mut Work<'_, A>, _memory: &mut ()) -> Result<Counters> {
        let mut worker = Worker::default();
        let spp = work.plan.scene.render.spp;
        for id in work.samples() {
            let sampler = work.start(id);
            let CameraSample { weight, ray } = work.camera_sample(id, &sampler);
            let found = self.0.li(&work.eye.stage(ray.time), &ray, &sampler, &mut worker);
            work.add(id, weight, found);
            if id.index + 1 == spp {
                work.report(u64::from(spp))?;
            }
        }
        Ok(worker.counters)
    }
}

/// Batches of paths side by side.
pub(super) struct InBatches<'a> {
    pub(super) path: &'a Path,
    /// Samples of a batch.
    pub(super) size: usize,
}

/// A batch and what its samples count.
#[derive(Default)]
pub(super) struct Batch {
    wave: Wave,
    weights: Vec<(SampleId, f32)>,
}

impl Engine for InBatches<'_> {
    type Memory = Batch;

    fn tile<A: Accel>(&self, work: &mut Work<'_, A>, batch: &mut Batch) -> Result<Counters> {
        let mut counters = Counters::default();
        batch.clear(self.size);
        for id in work.samples() {
            let sampler = work.start(id);
            let CameraSample { weight, ray } = work.camera_sample(id, &sampler);
            let media = work.eye.stage(ray.time).eye_media;
            batch.wave.push([id.x, id.y], id.index, &ray, media);
            batch.weights.push((id, weight));
            if batch.wave.len() == self.size {
                self.finish(work, batch, &mut counters)?;
            }
        }
        self.finish(work, batch, &mut counters)?;
        Ok(counters)
    }
}

impl InBatches<'_> {
    fn finish<A: Accel>(
        &self,
        work: &mut Work<'_, A>,
        batch: &mut Batch,
        counters: &mut Counters,
    ) -> Result<()> {
        self.path.follow(&work.eye.stage(0.0), &mut batch.wave, counters);
        for (i, &(id, weight)) in batch.weights.iter().enumerate() {
            work.add(id, weight, batch.wave.radiance(i));
        }
        work.report(batch.wave.len() as u64)?;
        batch.clear(self.size);
        Ok(())
    }
}

impl Batch {
    fn clear(&mut self, size: usize) {
        self.wave.clear(size);
        self.weights.clear();
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
