//! Backends beside each other: the same recorded rays through every one, in every kind of query.
//!
//! A [`Track`] is a scene made ready. It records rays ([`record`]), which may go to files and come from them ([`mod@file`]), and runs
//! [`Contestant`]s on them: how long each build takes and what it holds, how fast each [`Query`] is answered for rays of each
//! [`Class`], and whose answers differ and why ([`agreement`], judged by [`verdict`]). An [`Outcome`] is all that was found
//! of a scene; a [`Report`] shows outcomes as text, JSON and a page.
//!
//! Fairness: contestants run in turn within each pass ([`race`]), each on caches that its own pass has warmed, and their speed is told in time of the
//! processor, which other programs disturb less than the clock.

pub mod agreement;
mod contestant;
pub mod file;
pub mod machine;
mod outcome;
mod query;
pub mod race;
mod rays;
pub mod record;
pub mod report;
mod track;
pub mod verdict;
mod workers;

pub use contestant::Contestant;
pub use outcome::{Agreement, BuildTime, Building, Field, Outcome, Rate};
pub use query::{Mode, Query, Width};
pub use rays::{Class, RaySet};
pub use report::Report;
pub use track::{Settings, Track, Watch};
