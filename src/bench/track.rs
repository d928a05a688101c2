//! A scene made ready, and races on it.

use super::agreement::{self, Entry};
use super::contestant::{Built, Contestant};
use super::file::Recording;
use super::outcome::{Agreement, BuildTime, Building, Field, Outcome, Rate};
use super::query::{CHUNK, Chunk, Mode, Query};
use super::race::{Spread, interleave};
use super::rays::{Class, RaySet};
use super::record::{Stand, record};
use super::workers::Workers;
use crate::accel::bvh::Options;
use crate::accel::{Brute, Bvh2Accel};
use crate::error::{Error, Result};
use crate::render::{Phase, Progress};
use crate::scene::Scene;
use std::time::Duration;

/// What is to be raced, and how long.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The hierarchies. [`Contestant::Brute`] is left out of scenes that are too large for it, unless it is asked for.
    pub contestants: Vec<Contestant>,
    /// Whether `Brute` runs whatever it takes.
    pub brute: bool,
    /// Kinds of query.
    pub queries: Vec<Query>,
    /// Whether each contestant runs all of these, and not only those among [`Contestant::queries`].
    pub all_queries: bool,
    /// The classes of rays to record.
    pub classes: Vec<Class>,
    /// Rays of each class.
    pub rays: usize,
    /// Passes that count.
    pub passes: usize,
    /// Threads of the passes that are not on one.
    pub threads: usize,
}

/// Somebody who watches.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Is told how many rays have been traced, and may stop it.
    pub progress: &'a dyn Progress,
    /// Is told what begins.
    pub say: &'a dyn Fn(&str),
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch").finish_non_exhaustive()
    }
}

impl Watch<'_> {
    fn check(&self) -> Result<()> {
        if self.progress.is_cancelled() { Err(Error::Interrupted) } else { Ok(()) }
    }
}

/// A scene made ready.
#[derive(Debug)]
pub struct Track<'a> {
    scene: &'a Scene,
    /// Finds what recorded rays meet: it loses no hit, and answers alike on all machines. A witness beside the contestants.
    witness: Bvh2Accel,
}

/// Primitive tests of a pass that `Brute` may take where nobody asked for it.
const MOST_BRUTE_TESTS: usize = 1 << 22;

/// A build is repeated until all of its builds took this long, or there are as many as passes.
const ENOUGH_BUILDING: Duration = Duration::from_millis(500);

/// One who runs: a hierarchy, a kind of query, and threads.
struct Runner {
    building: usize,
    query: Query,
    workers: usize,
}

impl<'a> Track<'a> {
    /// Makes a scene ready.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, witness: Bvh2Accel::build(&scene.world, &Options::default()) }
    }

    /// Rays of the scene's own camera and lights.
    #[must_use]
    pub fn record(&self, settings: &Settings) -> Recording {
        let sets = record(&Stand::of(self.scene), &self.witness, &settings.classes, settings.rays);
        let primitives = self.scene.world.primitive_count() as u64;
        Recording { primitives, origin: self.scene.origin, sets }
    }

    /// Builds all hierarchies and races them, class by class. Fails if a backend gives up or somebody stops it.
    pub fn run(&self, sets: &[RaySet], settings: &Settings, watch: Watch<'_>) -> Result<Outcome> {
        let all = settings.threads.max(1);
        let mut workers = vec![Workers::new(1)?];
        if all > 1 {
            workers.push(Workers::new(all)?);
        }
        let primitives = self.scene.world.primitive_count();
        let rays = sets.iter().map(|set| set.rays.len()).max().unwrap_or(0);
        let fits = |contestant: &&Contestant| {
            **contestant != Contestant::Brute
                || settings.brute
                || primitives.saturating_mul(rays) <= MOST_BRUTE_TESTS
        };
        let contestants: Vec<Contestant> = settings.contestants.iter().filter(fits).copied().collect();
        let (buildings, built) = self.build_all(&contestants, &workers, settings.passes, watch)?;
        let mut outcome = Outcome {
            scene: String::new(),
            primitives,
            replayed: None,
            fields: Vec::new(),
            buildings,
            rates: Vec::new(),
            agreements: Vec::new(),
        };
        let mut race =
            Race { track: self, settings, watch, workers: &workers, built: &built, done: 0, total: 0 };
        let per_ray = Mode::ALL.len() * race.runners(&outcome.buildings).len() * (settings.passes + 1);
        race.total = sets.iter().map(|set| (set.rays.len() * per_ray) as u64).sum();
        for set in sets {
            race.class(set, &mut outcome)?;
        }
        Ok(outcome)
    }

    /// Builds all, on each number of threads; those of the last one race. Numbers of threads one after the other, for Embree
    /// builds on as many threads as any of its devices may use.
    fn build_all(
        &self,
        contestants: &[Contestant],
        workers: &[Workers],
        most: usize,
        watch: Watch<'_>,
    ) -> Result<(Vec<Building>, Vec<Built>)> {
        let mut times: Vec<Vec<BuildTime>> = vec![Vec::new(); contestants.len()];
        let mut racing = Vec::new();
        for (i, workers_now) in workers.iter().enumerate() {
            for (contestant, times) in contestants.iter().zip(&mut times) {
                let (time, built) = self.build(*contestant, workers_now, most, watch)?;
                times.push(time);
                if i + 1 == workers.len() {
                    racing.push(built);
                }
            }
        }
        let building = |((&contestant, times), built): ((&Contestant, _), &Built)| {
            let (version, isa, bytes) = (built.version.clone(), built.isa.clone(), built.tracer.bytes());
            Building { contestant, version, isa, bytes, times }
        };
        Ok((contestants.iter().zip(times).zip(&racing).map(building).collect(), racing))
    }

    /// Builds some times over; the last one is kept.
    fn build(
        &self,
        contestant: Contestant,
        workers: &Workers,
        most: usize,
        watch: Watch<'_>,
    ) -> Result<(BuildTime, Built)> {
        let threads = workers.threads();
        (watch.say)(&format!("building {}, threads: {threads}", contestant.name()));
        let is_cancelled = || watch.progress.is_cancelled();
        let mut phases: Vec<Phase> = Vec::new();
        loop {
            let (built, phase) = Phase::of(|| {
                workers.pool().install(|| contestant.build(&self.scene.world, threads, &is_cancelled))
            });
            let built = built?;
            phases.push(phase);
            watch.check()?;
            let spent: Duration = phases.iter().map(|phase| phase.wall).sum();
            if phases.len() >= most || spent >= ENOUGH_BUILDING {
                let cpu_s = Spread::of(phases.iter().map(|phase| phase.cpu.as_secs_f64()));
                let wall_s = Spread::of(phases.iter().map(|phase| phase.wall.as_secs_f64()));
                return Ok((BuildTime { threads, cpu_s, wall_s, builds: phases.len() }, built));
            }
        }
    }
}

/// Races under way.
struct Race<'a> {
    track: &'a Track<'a>,
    settings: &'a Settings,
    watch: Watch<'a>,
    workers: &'a [Workers],
    built: &'a [Built],
    /// Rays traced, and to be traced.
    done: u64,
    total: u64,
}

impl Race<'_> {
    /// Everyone who runs, those on one thread first.
    fn runners(&self, buildings: &[Building]) -> Vec<Runner> {
        let entries = buildings.iter().enumerate().flat_map(|(building, it)| {
            let has = |query: &&Query| self.settings.all_queries || it.contestant.queries().contains(query);
            self.settings.queries.iter().filter(has).map(move |&query| (building, query))
        });
        let entries: Vec<(usize, Query)> = entries.collect();
        let on = |workers| entries.iter().map(move |&(building, query)| Runner { building, query, workers });
        (0..self.workers.len()).flat_map(on).collect()
    }

    /// All races with rays of a class.
    fn class(&mut self, set: &RaySet, outcome: &mut Outcome) -> Result<()> {
        let chunks: Vec<Chunk> = set.rays.chunks(CHUNK).map(Chunk::new).collect();
        let runners = self.runners(&outcome.buildings);
        let field = outcome.fields.len();
        (self.watch.say)(&format!("{} rays: comparing answers", set.name));
        self.compare(&chunks, &runners, field, outcome)?;
        outcome.fields.push(Field {
            class: set.name.clone(),
            rays: set.rays.len(),
            hits: self.hits(&chunks),
        });
        for mode in Mode::ALL {
            (self.watch.say)(&format!("{} rays: {} hits", set.name, mode.word()));
            let found = self.race(&chunks, set.rays.len() as u64, mode, &runners)?;
            outcome.rates.extend(rates(&runners, &found, self.workers, (set.rays.len(), mode, field)));
        }
        Ok(())
    }

    fn hits(&self, chunks: &[Chunk]) -> usize {
        use crate::accel::Accel as _;
        chunks.iter().flat_map(|chunk| &chunk.single).filter(|ray| self.track.witness.occluded(ray)).count()
    }

    /// Counts whose answers differ.
    fn compare(
        &self,
        chunks: &[Chunk],
        runners: &[Runner],
        field: usize,
        outcome: &mut Outcome,
    ) -> Result<()> {
        // On one thread or on all, answers are the same.
        let single: Vec<&Runner> = runners.iter().filter(|runner| runner.workers == 0).collect();
        let witness: Entry<'_> = (&self.track.witness, Query::Single);
        let asked = single.iter().map(|runner| (&*self.built[runner.building].tracer, runner.query));
        let entries: Vec<Entry<'_>> = std::iter::once(witness).chain(asked).collect();
        let world = &self.track.scene.world;
        let brute = Brute::new(world.clone());
        let pool = self.workers[self.workers.len() - 1].pool();
        let progress = self.watch.progress;
        let stop = || if progress.is_cancelled() { Err(Error::Interrupted) } else { Ok(()) };
        let tallies = pool.install(|| agreement::tally(world, &brute, &entries, chunks, &stop))?;
        for (i, mode) in Mode::ALL.into_iter().enumerate() {
            outcome.agreements.extend(single.iter().zip(&tallies).map(|(runner, tallies)| {
                let Runner { building, query, .. } = **runner;
                Agreement { building, query, mode, field, tally: tallies[i] }
            }));
        }
        Ok(())
    }

    /// The times of each runner, pass by pass.
    fn race(
        &mut self,
        chunks: &[Chunk],
        rays: u64,
        mode: Mode,
        runners: &[Runner],
    ) -> Result<Vec<Vec<Phase>>> {
        interleave(runners.len(), self.settings.passes, |turn| {
            let Runner { building, query, workers } = runners[turn];
            let (tracer, workers) = (&*self.built[building].tracer, &self.workers[workers]);
            let work = |i: usize, scratch: &mut _| tracer.pass(query, mode, &chunks[i], scratch);
            // Others have filled the caches meanwhile; whoever follows one with the same hierarchy would find them warm.
            let phase = workers.time(chunks.len(), chunks.len(), &work);
            self.done += rays;
            self.watch.progress.advance(self.done, self.total);
            self.watch.check().map(|()| phase)
        })
    }
}

/// What the times of a race mean.
#[expect(clippy::cast_precision_loss, reason = "counts of rays")]
fn rates(
    runners: &[Runner],
    found: &[Vec<Phase>],
    workers: &[Workers],
    (rays, mode, field): (usize, Mode, usize),
) -> Vec<Rate> {
    let rays = rays as f64;
    // No time at all is what a clock of coarse steps shows of very few rays.
    let cpu = |phase: &Phase| phase.cpu.as_secs_f64().max(1e-9);
    let wall = |phase: &Phase| phase.wall.as_secs_f64().max(1e-9);
    let per_workers = runners.len() / workers.len();
    let rate = |(i, runner): (usize, &Runner)| {
        let own = &found[i];
        let beside = |other: usize, time: fn(&Phase) -> f64| {
            Spread::of(
                found[other].iter().zip(own).map(|(other, own)| time(other).max(1e-9) / time(own).max(1e-9)),
            )
        };
        let alone = i % per_workers;
        Rate {
            building: runner.building,
            query: runner.query,
            mode,
            field,
            threads: workers[runner.workers].threads(),
            per_cpu_s: Spread::of(own.iter().map(|phase| rays / cpu(phase))),
            per_s: Spread::of(own.iter().map(|phase| rays / wall(phase))),
            ns: Spread::of(own.iter().map(|phase| cpu(phase) * 1e9 / rays)),
            ratio: beside(i - alone, |phase| phase.cpu.as_secs_f64()),
            scaling: (runner.workers > 0).then(|| beside(alone, |phase| phase.wall.as_secs_f64())),
        }
    };
    runners.iter().enumerate().map(rate).collect()
}
