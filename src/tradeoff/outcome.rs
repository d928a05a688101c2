//! All that is known of a point.

use super::kept::{Kept, Run};
use super::knobs::Knob;
use super::moments::{Moments, Product};
use super::runs::Point;
use super::student::Interval;

/// A point and its figures.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Which.
    pub point: Point,
    /// How often it was rendered.
    pub runs: usize,
    /// Seconds of the processor that tracing takes.
    pub cpu_s: Interval,
    /// Seconds of the processor that building the hierarchy takes; one may have served several runs.
    pub build_cpu_s: Interval,
    /// Error, squared bias and variance, in relMSE.
    pub moments: Moments,
    /// Mean squared error, the reference's noise included.
    pub mse: Interval,
    /// What an eye would notice, from 0 to 1.
    pub flip: Interval,
    /// How much too bright, as a part of all light.
    pub brightness: Interval,
    /// Rays of a picture.
    pub rays: f64,
}

/// The points that were rendered at all, each with what its runs say; the reference's noise and its doubt are those of
/// [`super::moments::Measure::floor`].
#[must_use]
pub fn outcomes(points: &[Point], runs: &[Run], floor: [f64; 2]) -> Vec<Outcome> {
    points.iter().filter_map(|point| outcome(point, runs, floor)).collect()
}

/// The outcomes of a file of runs, in the order of their first runs.
#[must_use]
pub fn outcomes_kept(kept: &Kept) -> Vec<Outcome> {
    let mut points: Vec<Point> = Vec::new();
    for run in kept.runs.iter().filter(|run| run.number == 0) {
        let knob = |key: &str| {
            Knob::ALL.iter().find(|knob| knob.key == key).map_or(key, |knob| knob.name).to_owned()
        };
        let set = run.set.iter().map(|(key, value)| [knob(key), key.clone(), value.clone()]).collect();
        points.push(Point { key: run.point.clone(), set, spp: run.spp });
    }
    let noise = &kept.head["reference"]["noise"];
    outcomes(&points, &kept.runs, [0, 1].map(|i| noise[i].as_f64().unwrap_or(0.0)))
}

fn outcome(point: &Point, runs: &[Run], floor: [f64; 2]) -> Option<Outcome> {
    let mut runs: Vec<&Run> = runs.iter().filter(|run| run.point == point.key).collect();
    runs.sort_by_key(|run| run.number);
    runs.dedup_by_key(|run| run.number);
    if runs.is_empty() {
        return None;
    }
    let own: Vec<f64> = runs.iter().map(|run| run.own.relmse).collect();
    let place = |number: u32| runs.iter().position(|run| run.number == number);
    let pairs: Vec<(usize, usize, Product)> = runs
        .iter()
        .enumerate()
        .flat_map(|(b, run)| run.products.iter().map(move |&(number, product)| (number, b, product)))
        .filter_map(|(number, b, product)| Some((place(number)?, b, product)))
        .collect();
    // Runs on one hierarchy share its time, which was measured once.
    let mut builds: Vec<f64> = runs.iter().map(|run| run.build_cpu_s).collect();
    builds.sort_by(f64::total_cmp);
    builds.dedup_by_key(|seconds| seconds.to_bits());
    let mean =
        |of: &dyn Fn(&Run) -> f64| Interval::of_mean(&runs.iter().map(|run| of(run)).collect::<Vec<_>>());
    Some(Outcome {
        point: point.clone(),
        runs: runs.len(),
        cpu_s: mean(&|run| run.cpu_s),
        build_cpu_s: Interval::of_mean(&builds),
        moments: Moments::of(&own, &pairs, floor),
        mse: mean(&|run| run.own.mse),
        flip: mean(&|run| run.flip),
        brightness: mean(&|run| run.own.brightness),
        rays: mean(&|run| run.rays).value,
    })
}

impl Outcome {
    /// The error, zero where the reference is too coarse to tell one.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.moments.error.value.max(0.0)
    }

    /// One over error times time, the more the better: what more samples do for the error they undo by their time, where the error falls as
    /// one over their number. `None` where there is no error.
    #[must_use]
    pub fn efficiency(&self) -> Option<f64> {
        let product = self.error() * self.cpu_s.value;
        (product > 0.0).then(|| product.recip())
    }
}
