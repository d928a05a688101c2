//! What was found of a scene.

use super::agreement::Tally;
use super::contestant::Contestant;
use super::query::{Mode, Query};
use super::race::Spread;

/// All that was found of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The scene as the user named it.
    pub scene: String,
    /// Its primitives, each instance counted.
    pub primitives: usize,
    /// Where its rays were read from; absent if they were recorded now.
    pub replayed: Option<String>,
    /// The classes of rays.
    pub fields: Vec<Field>,
    /// The hierarchies.
    pub buildings: Vec<Building>,
    /// How fast each is, in each kind of query, for each class.
    pub rates: Vec<Rate>,
    /// Whose answers differ; in the order of the rates.
    pub agreements: Vec<Agreement>,
}

/// Rays of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Their name.
    pub class: String,
    /// How many there are.
    pub rays: usize,
    /// How many hit anything.
    pub hits: usize,
}

/// A hierarchy.
#[derive(Clone, Debug, PartialEq)]
pub struct Building {
    /// What it is.
    pub contestant: Contestant,
    /// The library, with its version.
    pub version: String,
    /// The instruction set that queries use.
    pub isa: String,
    /// Bytes that it holds beyond the shapes.
    pub bytes: usize,
    /// How long the build takes: on one thread, and on all if these are more.
    pub times: Vec<BuildTime>,
}

/// How long a build takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildTime {
    /// On so many threads.
    pub threads: usize,
    /// Seconds of CPU, all threads together.
    pub cpu_s: Spread,
    /// Seconds by the clock.
    pub wall_s: Spread,
    /// How often it was built.
    pub builds: usize,
}

/// How fast rays are answered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// Place in [`Outcome::buildings`].
    pub building: usize,
    /// How it was asked.
    pub query: Query,
    /// What was asked.
    pub mode: Mode,
    /// Place in [`Outcome::fields`].
    pub field: usize,
    /// On how many threads.
    pub threads: usize,
    /// Rays per second of CPU, all threads together.
    pub per_cpu_s: Spread,
    /// Rays per second by the clock.
    pub per_s: Spread,
    /// Nanoseconds of CPU for a ray.
    pub ns: Spread,
    /// Speed per second of CPU, relative to the first of the race on as many threads in the same pass.
    pub ratio: Spread,
    /// Speed by the clock, relative to one thread in the same pass; absent on one thread.
    pub scaling: Option<Spread>,
}

/// Whose answers differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Agreement {
    /// Place in [`Outcome::buildings`].
    pub building: usize,
    /// How it was asked.
    pub query: Query,
    /// What was asked.
    pub mode: Mode,
    /// Place in [`Outcome::fields`].
    pub field: usize,
    /// How many answers differ from the truth, by reason.
    pub tally: Tally,
}
