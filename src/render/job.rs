//! What a rendering is told, and what it tells.

use crate::film::{Film, Layout, Tile};
use crate::image::Window;
use crate::integrator::Counters;
use crate::post::GBuffer;
use crate::render::{Ended, Estimate, Limits, Slice};
use cpu_time::ProcessTime;
use std::num::NonZeroUsize;
use std::ops::AddAssign;
use std::time::{Duration, Instant};

/// What the scene does not say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// How many threads; all processors if absent.
    pub threads: Option<NonZeroUsize>,
    /// The part of the picture to render; all of it if absent.
    pub crop: Option<Window>,
    /// What is kept of samples.
    pub layout: Layout,
    /// What ends the picture before it has all samples.
    pub limits: Limits,
    /// Whether what fuzzy reflections are filtered from is kept.
    pub first_pass: bool,
    /// Some of the samples of every pixel; all of them if absent. Not with a limit.
    pub slice: Option<Slice>,
}

/// Somebody who watches, and may stop it. Called from several threads at once.
pub trait Progress: Sync {
    /// `done` of `total` samples have been taken.
    fn advance(&self, done: u64, total: u64);

    /// Whether to stop.
    fn is_cancelled(&self) -> bool;

    /// How old what is shown may be; nobody looks at the picture if absent. No pixel depends on it.
    fn looks_every(&self) -> Option<Duration> {
        None
    }

    /// Is shown a part of the picture as it is now. Must not wait.
    fn show(&self, _part: &Tile) {}
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn advance(&self, _done: u64, _total: u64) {}

    fn is_cancelled(&self) -> bool {
        false
    }
}

/// How long something took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Phase {
    /// By the clock.
    pub wall: Duration,
    /// Of the processors, all threads together.
    pub cpu: Duration,
}

impl Phase {
    /// `work`'s answer, and how long it took.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, Self) {
        let (wall, cpu) = (Instant::now(), ProcessTime::now());
        let answer = work();
        (answer, Self { wall: wall.elapsed(), cpu: cpu.elapsed() })
    }
}

impl AddAssign for Phase {
    fn add_assign(&mut self, other: Self) {
        self.wall += other.wall;
        self.cpu += other.cpu;
    }
}

/// How a rendering went.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Rays and cuts.
    pub counters: Counters,
    /// The first sample of each pixel: 0, unless it is a later slice.
    pub first: u32,
    /// Camera samples taken.
    pub samples: u64,
    /// What ended the picture.
    pub ended: Ended,
    /// How far the picture is from an endless one; where that was asked for and could be estimated ([`Limits`] says when).
    pub estimate: Option<Estimate>,
    /// Building the hierarchy.
    pub build: Phase,
    /// Tracing, and filtering where pictures are filtered.
    pub render: Phase,
    /// Filtering alone.
    pub filter: Phase,
    /// Bytes of the hierarchy.
    pub hierarchy_bytes: usize,
    /// The backend, with its version.
    pub backend: String,
    /// The instruction set that the backend uses.
    pub isa: String,
    /// How many threads there were.
    pub threads: usize,
}

/// A picture, and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The sums.
    pub film: Film,
    /// What fuzzy reflections were filtered from, sample by sample, if it was to be kept.
    pub first_pass: Vec<GBuffer>,
    /// How it went.
    pub statistics: Statistics,
}
