//! Outcomes shown: as a table for people ([`Report::table`]), as JSON and CSV for programs ([`Report::json`], [`Report::csv`]), and as one page
//! with plots and pictures ([`Report::page`]).

mod csv;
mod json;
mod page;
mod pictures;
mod plot;
mod table;

use super::design::{Axis, SAMPLES};
use super::front::front;
use super::recommend::Recommendation;
use super::{Outcome, Reference};
use crate::bench::machine::Machine;
use crate::image::Image;
use crate::image::tone::Development;
use serde_json::Value;

/// A sweep, and what came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The scene file, as the user named it.
    pub scene: String,
    /// What was replaced for all points.
    pub overrides: Vec<String>,
    /// Tables `film` and `render` of the scene, as they are where nothing is set.
    pub settings: Value,
    /// The seed of the first run.
    pub seed: u64,
    /// Columns and rows.
    pub size: [u32; 2],
    /// How points were chosen, in words.
    pub design: String,
    /// What was turned.
    pub axes: Vec<Axis>,
    /// Knobs that were not turned, and why.
    pub idle: Vec<(&'static str, &'static str)>,
    /// How often each point was rendered.
    pub runs: u32,
    /// Threads; all processors if absent.
    pub threads: Option<usize>,
    /// What points were compared with.
    pub reference: Reference,
    /// Where, at the start.
    pub machine: Machine,
    /// Programs that wanted to run, averaged over the minute before the end.
    pub load_after: Option<f64>,
    /// The points.
    pub outcomes: Vec<Outcome>,
    /// What to take for errors that were asked for.
    pub recommendations: Vec<Recommendation>,
    /// Pictures of some points.
    pub pictures: Vec<Shown>,
    /// How the scene wants to be shown.
    pub development: Development,
}

/// A picture of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// The point in words.
    pub name: String,
    /// The picture of its first run.
    pub picture: Image,
    /// What an eye would notice, for each pixel.
    pub flip: Vec<f32>,
}

/// What every number means, under every table.
const NOTES: [&str; 6] = [
    "relMSE is the mean of (a - b)^2 / (b^2 + 0.01) over pixels and channels, b the reference, of one picture: bias^2, which no number of samples \
     takes away, and variance. The reference's own noise is taken out of relMSE and bias^2.",
    "Intervals hold the true value with a probability of 95 %, by Student's t over runs with different seeds, those of squares by jackknife; a bias^2 \
     within its interval of zero may be none.",
    "CPU s are seconds of the processor that tracing takes, all threads together; reading the scene and building hierarchies are left out. \
     Of one machine: ratios carry over to others, seconds do not.",
    "FLIP is the mean of what an eye would notice, from 0 to 1; brightness the mean difference by the mean of the reference.",
    "* marks the front: nothing else is both quicker and nearer.",
    "Recommendations follow measured curves between their points, and lines in logarithms beyond.",
];

impl Report {
    /// The numbers of the outcomes that nothing beats, the quickest first.
    #[must_use]
    pub fn front(&self) -> Vec<usize> {
        front(&self.outcomes.iter().map(|it| [it.cpu_s.value, it.error()]).collect::<Vec<_>>())
    }

    /// The outcomes at a value of a knob; `None` where it is not set. Those where nothing else is set but samples, if there are any.
    fn at<'a>(&'a self, knob: &str, value: Option<&str>) -> Vec<&'a Outcome> {
        let set = |it: &Outcome| {
            it.point.set.iter().find(|[name, ..]| name == knob).map(|[_, _, value]| value.clone())
        };
        let own: Vec<&Outcome> = self.outcomes.iter().filter(|it| set(it).as_deref() == value).collect();
        let is_alone = |it: &&Outcome| it.point.set.iter().all(|[name, ..]| name == knob || name == SAMPLES);
        let alone: Vec<&Outcome> = own.iter().copied().filter(is_alone).collect();
        if alone.is_empty() { own } else { alone }
    }
}

/// Three or so digits, as decimals where that is short.
fn number(x: f64) -> String {
    let magnitude = x.abs();
    if magnitude == 0.0 {
        "0".to_owned()
    } else if !(1e-2..1e5).contains(&magnitude) {
        format!("{x:.2e}")
    } else if magnitude >= 100.0 {
        format!("{x:.0}")
    } else if magnitude >= 1.0 {
        format!("{x:.2}")
    } else {
        format!("{x:.4}")
    }
}

/// A value with its interval.
fn interval(it: super::student::Interval) -> String {
    it.half.map_or_else(|| number(it.value), |half| format!("{} ±{}", number(it.value), short(half)))
}

/// Two digits.
fn short(x: f64) -> String {
    if x == 0.0 || !(1e-2..1e4).contains(&x) { format!("{x:.1e}") } else { format!("{x:.2}") }
}
