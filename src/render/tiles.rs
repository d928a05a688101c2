//! A picture in tiles, each the work of one thread at a time.

use crate::accel::{Accel, Coherence, HitStream, RayStream};
use crate::error::{Error, Result};
use crate::film::{Aov, Film, Filter, Layout, Names, SampleId, Seen, Tile};
use crate::geometry::Ray;
use crate::image::Window;
use crate::integrator::{CameraRay, Counters, Deferred, Features, Integrator, Path, Radiance, Wave, Worker};
use crate::render::course::Course;
use crate::render::eye::Eye;
use crate::render::keeping::{Pieces, Running, longest};
use crate::render::samples::{Begin, CameraSamples, Cursor};
use crate::render::schedule::{PACKET, Pass};
use crate::render::{Ended, Estimate, Keeper, Limits, Phase, Progress, State};
use crate::sampling::SamplerKind;
use crate::scene::Scene;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

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
    /// What is kept of samples.
    pub(super) layout: Layout,
    /// How many samples a pixel of the whole picture gets at most.
    pub(super) most: u32,
    /// Which of them are taken here.
    pub(super) samples: Range<u32>,
    pub(super) limits: Limits,
    /// Since when time counts.
    pub(super) start: Instant,
    pub(super) progress: &'a dyn Progress,
    /// Whether what fuzzy reflections are filtered from is kept.
    pub(super) first_pass: bool,
    /// Who keeps copies.
    pub(super) keeper: Option<&'a dyn Keeper>,
    /// From where it goes on, once.
    pub(super) begin: Mutex<Option<State>>,
}

impl Plan<'_> {
    /// Nothing taken yet.
    pub(super) fn state(&self) -> State {
        let scene = self.scene;
        let names = if self.layout.has_ids() { scene.names.clone() } else { Names::default() };
        let full = [scene.film.width, scene.film.height];
        State {
            film: Film::new(full, self.window, self.layout.clone()).named(names),
            counters: Counters::default(),
            course: Course::new(&self.limits, self.start, (&tiles(self.window), &self.samples)),
            pass: None,
            spent: Phase::default(),
            filtering: Phase::default(),
        }
    }

    /// From where it goes on.
    pub(super) fn begin(&self) -> State {
        let mut begin = self.begin.lock().unwrap_or_else(PoisonError::into_inner);
        begin.take().unwrap_or_else(|| self.state())
    }
}

/// All that tracing gives.
pub(super) struct Traced {
    pub(super) film: Film,
    pub(super) counters: Counters,
    pub(super) ended: Ended,
    pub(super) estimate: Option<Estimate>,
    /// How long tracing took in all runs.
    pub(super) spent: Phase,
}

/// The samples of the window, on the threads of the current pool.
pub(super) fn trace<A: Accel, E: Engine>(plan: &Plan<'_>, accel: &A, engine: &E) -> Result<Traced> {
    let eye = Eye::new(plan.scene, accel, plan.most);
    let tiles = tiles(plan.window);
    let running = Running::new(plan.begin());
    running.kept(plan.keeper, || {
        while let Some((pass, before, total)) = next(plan, &running) {
            let begin = Instant::now();
            take((plan, &eye, engine), (&tiles, &pass), &running, total)?;
            let mut running = running.locked();
            let State { film, course, pass: done, .. } = &mut running.state;
            course.passed(&pass, before + begin.elapsed().as_secs_f64(), (&tiles, film));
            *done = None;
        }
        Ok(())
    })?;
    let State { film, counters, course, spent, .. } = running.into_state();
    let (ended, estimate) = (course.ended(), course.estimate(&film));
    Ok(Traced { film, counters, ended, estimate, spent })
}

/// The pass that is under way, or the next one, if there is one; how many seconds it has taken, and how many samples are expected in all.
fn next(plan: &Plan<'_>, running: &Running) -> Option<(Pass, f64, u64)> {
    let mut running = running.locked();
    running.since = Instant::now();
    let state = &mut running.state;
    if state.pass.is_none() {
        let pass = state.course.next()?;
        // One that begins with the first sample begins anew.
        if pass.shares.iter().any(|(_, samples)| samples.start == plan.samples.start) {
            let State { film, counters, .. } = plan.state();
            (state.film, state.counters) = (film, counters);
        }
        state.pass = Some((pass, 0.0));
    }
    let (pass, seconds) = state.pass.clone()?;
    let total = state.course.forecast(&pass);
    Some((pass, seconds, total))
}

/// The samples of a pass that are not there yet, added to what there is; `total` samples are expected in all.
fn take<A: Accel, E: Engine>(
    (plan, eye, engine): (&Plan<'_>, &Eye<'_, A>, &E),
    (tiles, pass): (&[Window], &Pass),
    running: &Running,
    total: u64,
) -> Result<()> {
    let done = AtomicU64::new(running.locked().state.film.samples());
    let advance = |samples| {
        plan.progress.advance(done.fetch_add(samples, Ordering::Relaxed) + samples, total);
    };
    let plain = plan.layout == Layout::default();
    let longest = longest(plan.keeper, plan.progress);
    let one = |memory: &mut E::Memory, window, all: &Range<u32>| -> Result<()> {
        let there = plan.samples.start + running.locked().state.film.taken(window);
        for samples in Pieces::new(there.max(all.start)..all.end, longest) {
            let tile = running.locked().state.film.part(window);
            let coherent = pass.coherent;
            let mut work =
                Work { plan, eye, tile, samples, all: all.clone(), coherent, plain, advance: &advance };
            let counters = engine.tile(&mut work, memory)?;
            let mut running = running.locked();
            running.state.film.put(&work.tile);
            running.state.counters += counters;
            drop(running);
            plan.progress.show(&work.tile);
        }
        Ok(())
    };
    // Each thread takes the next tile when it is done with one. (An iterator of rayon's would deal out runs of tiles beforehand, and the
    // last run keeps others waiting.)
    let next = AtomicUsize::new(0);
    let ended = rayon::broadcast(|_| -> Result<()> {
        let mut memory = E::Memory::default();
        while let Some((tile, samples)) = pass.shares.get(next.fetch_add(1, Ordering::Relaxed)) {
            one(&mut memory, tiles[*tile], samples)
                .inspect_err(|_| next.store(pass.shares.len(), Ordering::Relaxed))?;
        }
        Ok(())
    });
    ended.into_iter().collect::<Result<()>>()
}

/// How the samples of a tile are taken.
pub(super) trait Engine: Sync {
    /// What a thread keeps from tile to tile.
    type Memory: Default;

    /// Takes the samples of a tile that are asked for, those of each pixel in the order of their indices. Asks often whether to stop.
    fn tile<A: Accel>(&self, work: &mut Work<'_, A>, memory: &mut Self::Memory) -> Result<Counters>;
}

/// A tile to be done.
pub(super) struct Work<'a, A> {
    plan: &'a Plan<'a>,
    eye: &'a Eye<'a, A>,
    tile: Tile,
    /// Which samples of each pixel.
    samples: Range<u32>,
    /// Those of the pass, of which these are a piece.
    all: Range<u32>,
    /// Whether camera rays may be traced in packets that hold one pixel's only.
    coherent: bool,
    /// Whether nothing is kept but the picture and its coverage.
    plain: bool,
    /// Is told how many samples have been taken.
    advance: &'a dyn Fn(u64),
}

impl<A> Work<'_, A> {
    /// How camera rays of packets of `width` are traced. What a coherent packet hits on an edge may depend on its company: never on
    /// that of other pixels, which may be missing from a crop.
    fn coherence(&self, width: u32) -> Coherence {
        let Range { start, end } = self.all;
        let whole = [start, end, self.plan.most].into_iter().all(|samples| samples.is_multiple_of(width));
        let whole = self.coherent && whole;
        if whole { Coherence::Coherent } else { Coherence::Incoherent }
    }

    /// Goes through the samples.
    fn cursor(&self) -> Cursor {
        Cursor::new(self.tile.window(), self.samples.clone())
    }

    /// Adds samples of one pixel, `first` and those that follow, with what each has brought home. `values` is scratch.
    fn add(
        &mut self,
        first: SampleId,
        weights: &[f32],
        found: impl Iterator<Item = Radiance>,
        values: &mut Vec<f32>,
    ) where
        A: Accel,
    {
        values.clear();
        let samples = (first.index..).zip(found).take(weights.len());
        if self.plain {
            for (_, Radiance { color, alpha, .. }) in samples {
                values.extend_from_slice(&[color.r, color.g, color.b, alpha]);
            }
        } else {
            let mut weights = weights.iter();
            samples.for_each(|(index, radiance)| {
                let id = SampleId { index, ..first };
                let features = self.features(id);
                outputs(&self.plan.layout, radiance, features.as_ref(), values);
                let weight = weights.next().copied().unwrap_or(0.0);
                if let Some(it) = features {
                    let (object, material) = (it.object.0, it.material.0);
                    self.tile.see(id, weight, Seen { object, material, depth: it.depth });
                }
            });
        }
        self.tile.add_run(first, weights, values);
    }

    /// What the camera ray of a sample sees, if anybody asks.
    fn features(&self, SampleId { x, y, index }: SampleId) -> Option<Features>
    where
        A: Accel,
    {
        let plan = self.plan;
        if !plan.layout.has_features() {
            return None;
        }
        let CameraSamples { o, d, time, .. } = plan.camera_samples([x, y], &plan.start([x, y], index));
        let ray = Ray::new(o.into(), d.into()).at_time(time);
        let camera = CameraRay { ray, found: None };
        Features::of(&self.eye.stage(time), &camera, plan.layout.has_colours())
    }

    /// Tells of samples taken; fails if somebody wants to stop.
    fn report(&self, samples: u64) -> Result<()> {
        (self.advance)(samples);
        if self.plan.progress.is_cancelled() { Err(Error::Interrupted) } else { Ok(()) }
    }
}

/// The values that are kept of a sample, in the order of the layout.
pub(super) fn outputs(
    layout: &Layout,
    radiance: Radiance,
    features: Option<&Features>,
    values: &mut Vec<f32>,
) {
    for aov in layout.aovs() {
        // What is not finite here is no reason to drop the light.
        let finite = |value: f32| if value.is_finite() { value } else { 0.0 };
        let of = |value: fn(&Features) -> [f32; 3]| features.map_or([0.0; 3], value).map(finite);
        match aov {
            Aov::Beauty => values.extend([radiance.color.r, radiance.color.g, radiance.color.b]),
            Aov::Direct => values.extend([radiance.direct.r, radiance.direct.g, radiance.direct.b]),
            Aov::Indirect => {
                let rest = radiance.color - radiance.direct;
                values.extend([rest.r, rest.g, rest.b]);
            }
            Aov::Alpha => values.push(radiance.alpha),
            Aov::Albedo => values.extend(of(|it| [it.albedo.r, it.albedo.g, it.albedo.b])),
            Aov::Normal => values.extend(of(|it| it.normal.to_array())),
            Aov::GeometricNormal => values.extend(of(|it| it.geometric_normal.to_array())),
            Aov::Depth => values.push(features.map_or(0.0, |it| finite(it.depth))),
            Aov::Position => values.extend(of(|it| it.position.to_array())),
            Aov::Uv => values.extend(features.map_or([0.0; 2], |it| it.uv.to_array().map(finite))),
            Aov::Variance
            | Aov::Samples
            | Aov::ObjectId
            | Aov::MaterialId
            | Aov::CryptoObject
            | Aov::CryptoMaterial => {}
        }
    }
}

/// One sample after the other.
pub(super) struct OneByOne<'a, I>(pub(super) &'a I);

impl<I: Integrator> Engine for OneByOne<'_, I> {
    type Memory = ();

    fn tile<A: Accel>(&self, work: &mut Work<'_, A>, _memory: &mut ()) -> Result<Counters> {
        let (mut worker, mut values) = (Worker::default(), Vec::new());
        let (plan, samples) = (work.plan, work.samples.clone());
        for id in work.cursor() {
            let pixel = [id.x, id.y];
            let sampler = plan.start(pixel, id.index);
            let CameraSamples { weight, o, d, time } = plan.camera_samples(pixel, &sampler);
            let camera = CameraRay { ray: Ray::new(o.into(), d.into()).at_time(time), found: None };
            let found = self.0.li(&work.eye.stage(time), &camera, &sampler, &mut worker);
            work.add(id, &[weight], [found].into_iter(), &mut values);
            if id.index + 1 == samples.end {
                work.report(samples.len() as u64)?;
            }
        }
        Ok(worker.counters)
    }
}

/// Camera rays of many samples together, and what is deferred of their light together; the rest one sample after the other.
pub(super) struct InStreams<'a, I> {
    pub(super) integrator: &'a I,
    /// Samples that are taken together.
    pub(super) size: u32,
}

/// Samples that are taken together.
#[derive(Default)]
pub(super) struct Together {
    runs: Vec<(SampleId, u32)>,
    rays: RayStream,
    hits: HitStream,
    weights: Vec<f32>,
    found: Vec<Radiance>,
    values: Vec<f32>,
}

impl<I: Integrator> Engine for InStreams<'_, I> {
    type Memory = Together;

    fn tile<A: Accel>(&self, work: &mut Work<'_, A>, memory: &mut Together) -> Result<Counters> {
        let mut worker = Worker { deferred: Some(Deferred::default()), ..Worker::default() };
        let mut cursor = work.cursor();
        loop {
            memory.runs.clear();
            memory.runs.extend(cursor.runs(self.size));
            if memory.runs.is_empty() {
                return Ok(worker.counters);
            }
            self.samples(work, memory, &mut worker);
            work.report(memory.found.len() as u64)?;
        }
    }
}

impl<I: Integrator> InStreams<'_, I> {
    fn samples<A: Accel>(&self, work: &mut Work<'_, A>, memory: &mut Together, worker: &mut Worker) {
        let Together { runs, rays, hits, weights, found, values } = memory;
        let (plan, accel) = (work.plan, work.eye.stage(0.0).accel);
        let ids = |&(first, count): &(SampleId, u32)| {
            (first.index..first.index + count).map(move |index| SampleId { index, ..first })
        };
        rays.clear();
        weights.clear();
        for SampleId { x, y, index } in runs.iter().flat_map(ids) {
            let sampler = plan.start([x, y], index);
            let CameraSamples { weight, o, d, time } = plan.camera_samples([x, y], &sampler);
            rays.push(&Ray::new(o.into(), d.into()).at_time(time));
            weights.push(weight);
        }
        accel.intersect_stream(rays, hits, work.coherence(PACKET));
        found.clear();
        for (i, SampleId { x, y, index }) in runs.iter().flat_map(ids).enumerate() {
            if let Some(deferred) = &mut worker.deferred {
                deferred.begin(i);
            }
            let camera = CameraRay { ray: rays.get(i), found: Some(hits.get(i)) };
            let stage = work.eye.stage(camera.ray.time);
            found.push(self.integrator.li(&stage, &camera, &plan.start([x, y], index), worker));
        }
        if let Some(deferred) = &mut worker.deferred {
            deferred.arrive(accel, found);
        }
        let mut at = 0;
        for &(first, count) in &*runs {
            let samples = at..at + count as usize;
            work.add(first, &weights[samples.clone()], found[samples.clone()].iter().copied(), values);
            at = samples.end;
        }
    }
}

/// Batches of paths side by side.
pub(super) struct InBatches<'a> {
    pub(super) path: &'a Path,
    /// Samples of a batch.
    pub(super) size: u32,
}

/// A batch and what its samples count.
#[derive(Default)]
pub(super) struct Batch {
    /// Samples of a pixel each, by their first.
    runs: Vec<(SampleId, u32)>,
    wave: Wave,
    weights: Vec<f32>,
    values: Vec<f32>,
}

impl Engine for InBatches<'_> {
    type Memory = Batch;

    fn tile<A: Accel>(&self, work: &mut Work<'_, A>, batch: &mut Batch) -> Result<Counters> {
        let mut counters = Counters::default();
        let mut cursor = work.cursor();
        loop {
            batch.runs.clear();
            batch.runs.extend(cursor.runs(self.size));
            if batch.runs.is_empty() {
                return Ok(counters);
            }
            self.trace(work, batch, &mut counters);
            work.report(batch.wave.len() as u64)?;
        }
    }
}

impl InBatches<'_> {
    fn trace<A: Accel>(&self, work: &mut Work<'_, A>, batch: &mut Batch, counters: &mut Counters) {
        let Batch { runs, wave, weights, values } = batch;
        let ways = self.path.ways();
        self.path.level().run(Begin { plan: work.plan, runs, ways, wave, weights });
        if work.plan.scene.has_media() {
            wave.set_media(|time| work.eye.stage(time).eye_media);
        }
        let coherence = work.coherence(self.path.width());
        self.path.follow(&work.eye.stage(0.0), wave, coherence, counters);
        let mut at = 0;
        for &(first, count) in &*runs {
            let samples = at..at + count as usize;
            work.add(first, &weights[samples.clone()], samples.clone().map(|i| wave.radiance(i)), values);
            at = samples.end;
        }
    }
}

/// The tiles of a window by rows, the last ones of a row or column narrower.
pub(super) fn tiles(window: Window) -> Vec<Window> {
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
