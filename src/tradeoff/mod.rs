//! What accuracy costs: settings of a scene beside each other, their error against their time.
//!
//! A [`Subject`] is a scene that is rendered under other settings. [`knobs`] lists what can be turned, [`design`] says at which
//! points, [`runs`] renders each of them several times with different seeds, pass by pass, and compares every picture with a
//! [`Reference`]; [`kept`] writes each run to a file, so that a sweep that was stopped goes on. [`moments`] tells bias and variance apart;
//! an [`Outcome`] is all that is known of a point. From outcomes follow the [`front`] of those that nothing beats, [`curve`]s of error
//! over samples, and what to [`recommend`] for an error that is asked for. A [`Report`] shows all of it.
//!
//! What was measured is used by [`presets`], over scenes that ship, and by budgets, from a file of runs; a [`pilot`] finds what a scene has of its own.
//!
//! Errors are relMSE (`measure::error`), the mean over pixels and channels of squared differences by b^2 + 0.01, b the reference; times
//! are seconds of the processor that tracing takes, building hierarchies and reading files left out; intervals are those that hold the
//! true value with a probability of 95 %.

pub mod curve;
pub mod design;
pub mod front;
pub mod kept;
pub mod knobs;
pub mod moments;
mod outcome;
pub mod pilot;
pub mod presets;
pub mod recommend;
mod reference;
pub mod report;
pub mod runs;
pub mod student;
mod subject;

pub use outcome::{Outcome, outcomes, outcomes_kept};
pub use reference::{Origin, Reference};
pub use report::Report;
pub use runs::compared;
pub(crate) use subject::said;
pub use subject::{Subject, settings_of};
