//! Error over samples and time of settings that differ in samples alone.
//!
//! Time is a fixed part and a part for each sample. Variance is followed from one measured number of samples to the next on straight lines in
//! logarithms, and beyond the last ones as between the last two; how fast it falls is the sampler's matter (independent samples: as one over their
//! number; well-placed ones faster). Bias is that of all numbers of samples together, each weighed by how well it is known; what may as well
//! be none counts as none. How well it is known all together does not follow as from independent measurements: their runs have the same seeds and their
//! reference the same noise.

use super::Outcome;
use super::student::Interval;

/// Settings at several numbers of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What is set beside samples, in words; empty where all is as the scene says.
    pub name: String,
    /// The same as keys of the scene file and values.
    pub set: Vec<(String, String)>,
    /// Squared bias in relMSE that counts: 0 where it may as well be none.
    pub bias2: f64,
    /// The same as it was found.
    pub found_bias2: Interval,
    /// Seconds of the processor that a picture takes beside its samples.
    pub fixed_s: f64,
    /// Seconds of the processor that a sample of all pixels takes.
    pub pace_s: f64,
    /// Samples per pixel and variance in relMSE, fewest first.
    noise: Vec<[f64; 2]>,
}

/// How fast variance may fall or must, as an exponent of samples: beyond it, what was measured was chance.
const SLOPES: [f64; 2] = [-2.0, -0.5];

impl Curve {
    /// The curves of outcomes, in the order of their first ones. Outcomes without a variance have no curve.
    #[must_use]
    pub fn all(outcomes: &[Outcome]) -> Vec<Self> {
        let mut names: Vec<String> = Vec::new();
        for outcome in outcomes {
            let name = outcome.point.curve();
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names.iter().filter_map(|name| Self::of(name, outcomes)).collect()
    }

    fn of(name: &str, outcomes: &[Outcome]) -> Option<Self> {
        let mut own: Vec<&Outcome> = outcomes.iter().filter(|it| it.point.curve() == name).collect();
        own.sort_by_key(|it| it.point.spp);
        let spp = |it: &Outcome| f64::from(it.point.spp);
        let noise: Vec<[f64; 2]> =
            own.iter().filter_map(|it| Some([spp(it), it.moments.variance?.value.max(0.0)])).collect();
        let (first, last) = (own.first()?, own.last()?);
        let ends = [first, last].map(|it| [spp(it), it.cpu_s.value]);
        let (fixed_s, pace_s) = line(ends);
        let set = first.point.set.iter().filter(|[knob, ..]| knob != super::design::SAMPLES);
        let set = set.map(|[_, key, value]| (key.clone(), value.clone())).collect();
        (!noise.is_empty())
            .then(|| Self::measured(name.to_owned(), set, (bias2(&own), fixed_s, pace_s), noise))
    }

    /// A curve by its figures: squared bias as it was found, fixed part and pace, and samples with variances, fewest first, at least one.
    #[must_use]
    pub fn measured(
        name: String,
        set: Vec<(String, String)>,
        (found_bias2, fixed_s, pace_s): (Interval, f64, f64),
        noise: Vec<[f64; 2]>,
    ) -> Self {
        debug_assert!(!noise.is_empty(), "a curve of nothing");
        let bias2 = if found_bias2.may_be_zero() { 0.0 } else { found_bias2.value.max(0.0) };
        Self { name, set, bias2, found_bias2, fixed_s, pace_s, noise }
    }

    /// The most that squared bias may be: the end of its interval. `None` where that is not known.
    #[must_use]
    pub fn most_bias2(&self) -> Option<f64> {
        self.found_bias2.half.map(|half| self.found_bias2.value.max(0.0) + half)
    }

    /// Samples per pixel and variance in relMSE, fewest first.
    #[must_use]
    pub fn noise(&self) -> &[[f64; 2]] {
        &self.noise
    }

    /// With which power of samples variance falls at the most samples.
    #[must_use]
    pub fn slope(&self) -> f64 {
        let [a, b] = self.around(|_| false);
        slope(a, b)
    }

    /// The same settings for a picture of so many times the pixels.
    #[must_use]
    pub fn larger(self, times: f64) -> Self {
        Self { fixed_s: self.fixed_s * times, pace_s: self.pace_s * times, ..self }
    }

    /// Seconds of the processor that so many samples per pixel take.
    #[must_use]
    pub fn time(&self, spp: f64) -> f64 {
        self.fixed_s + self.pace_s * spp
    }

    /// How many samples per pixel there are in a time; less than one where there is none.
    #[must_use]
    pub fn samples_in(&self, seconds: f64) -> f64 {
        ((seconds - self.fixed_s) / self.pace_s).max(0.0)
    }

    /// Variance at so many samples per pixel.
    #[must_use]
    pub fn variance(&self, spp: f64) -> f64 {
        let [a, b] = self.around(|[at, _]| at >= spp);
        let slope = slope(a, b);
        b[1] * (spp / b[0]).powf(slope)
    }

    /// relMSE at so many samples per pixel.
    #[must_use]
    pub fn error(&self, spp: f64) -> f64 {
        self.bias2 + self.variance(spp)
    }

    /// How many samples per pixel bring the relMSE down to `error`; `None` where bias alone is as large.
    #[must_use]
    pub fn samples_for(&self, error: f64) -> Option<f64> {
        let wanted = error - self.bias2;
        if wanted <= 0.0 {
            return None;
        }
        let [a, b] = self.around(|[_, variance]| variance <= wanted);
        if b[1] <= 0.0 {
            // No way down to nothing is known: the fewest that were measured and are enough, or one where there is no noise at all.
            return Some(if a[1] <= 0.0 {
                1.0
            } else if a[1] <= wanted {
                a[0]
            } else {
                b[0]
            });
        }
        Some((b[0] * (wanted / b[1]).powf(slope(a, b).recip())).max(1.0))
    }

    /// The two neighbours, fewest samples first, of which the second is the first that `is_beyond`, or else the last of all; twice the same
    /// where there is only one.
    fn around(&self, is_beyond: impl Fn([f64; 2]) -> bool) -> [[f64; 2]; 2] {
        let last = self.noise.len() - 1;
        let second = self.noise.iter().position(|&at| is_beyond(at)).unwrap_or(last).clamp(last.min(1), last);
        [self.noise[second.saturating_sub(1)], self.noise[second]]
    }
}

/// How variance goes with samples between two numbers of them, as an exponent.
fn slope(a: [f64; 2], b: [f64; 2]) -> f64 {
    let slope = (b[1] / a[1]).ln() / (b[0] / a[0]).ln();
    if slope.is_finite() { slope.clamp(SLOPES[0], SLOPES[1]) } else { -1.0 }
}

/// Fixed part and pace of a line through two points of samples and time; neither below zero, and a pace that is more than nothing.
fn line([[n0, t0], [n1, t1]]: [[f64; 2]; 2]) -> (f64, f64) {
    const LEAST: f64 = 1e-12;
    let through_origin = (0.0, (t1 / n1).max(LEAST));
    if n1 <= n0 {
        return through_origin;
    }
    let pace = (t1 - t0) / (n1 - n0);
    let fixed = t0 - pace * n0;
    if pace > 0.0 && fixed >= 0.0 { (fixed, pace.max(LEAST)) } else { through_origin }
}

/// Half of the interval of an outcome's bias by the seeds of its runs. Of one pair there is no such; then the variance, which a product of two noises is
/// not above (Cauchy and Schwarz).
fn by_seeds(outcome: &Outcome) -> Option<f64> {
    let variance = || outcome.moments.variance.map(|variance| variance.value.max(0.0));
    outcome.moments.by_seeds.or_else(variance)
}

/// The bias that is found of settings, and how well it is known.
fn bias2(outcomes: &[&Outcome]) -> Interval {
    const LEAST: f64 = 1e-12;
    let known = outcomes.iter().filter_map(|it| Some((it.moments.bias2?.value, by_seeds(it)?.max(LEAST))));
    let known: Vec<(f64, f64)> = known.collect();
    let weights: f64 = known.iter().map(|(_, half)| half.powi(-2)).sum();
    if weights <= 0.0 {
        return Interval::default();
    }
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| {
        known.iter().map(|it| of(it) * it.1.powi(-2)).sum::<f64>() / weights
    };
    // The deviation of a sum is that of its parts together where they go together; it is never more.
    let found = Interval { value: mean(&|it| it.0), half: Some(mean(&|it| it.1)) };
    found.widened(outcomes.iter().map(|it| it.moments.by_reference).fold(0.0, f64::max))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::tradeoff::moments::Moments;
    use crate::tradeoff::runs::Point;
    use crate::tradeoff::student::Interval;

    /// An outcome of a setting at so many samples.
    pub(in crate::tradeoff) fn outcome(name: &str, spp: u32, [cpu_s, bias2, variance]: [f64; 3]) -> Outcome {
        let interval = |value: f64| Interval { value, half: Some(value * 0.05) };
        let mut set = vec![["spp".to_owned(), "render.spp".to_owned(), spp.to_string()]];
        if !name.is_empty() {
            set.push([name.to_owned(), format!("render.{name}"), "1".to_owned()]);
        }
        Outcome {
            point: Point { key: format!("{name} {spp}"), set, spp },
            runs: 4,
            cpu_s: interval(cpu_s),
            build_cpu_s: interval(0.0),
            moments: Moments {
                error: interval(bias2 + variance),
                bias2: Some(interval(bias2)),
                variance: Some(interval(variance)),
                by_seeds: interval(bias2).half,
                by_reference: 0.0,
            },
            mse: interval(variance),
            flip: interval(0.1),
            brightness: interval(0.0),
            rays: 1e6,
        }
    }

    fn near(what: &str, found: f64, wanted: f64) {
        assert!((found / wanted - 1.0).abs() < 1e-9, "{what}: {found}, not {wanted}");
    }

    #[test]
    fn a_curve_goes_through_what_was_measured_and_on() {
        // Half a second and a tenth for each sample; variance as one over samples to the power of 1.5.
        let at = |spp: u32| {
            let n = f64::from(spp);
            outcome("", spp, [0.5 + 0.1 * n, 1e-5, 0.1 * n.powf(-1.5)])
        };
        let curves = Curve::all(&[at(64), at(4), at(16)]);
        let [curve] = &curves[..] else { panic!("{curves:?}") };
        for spp in [1.0, 4.0, 9.0, 64.0, 1000.0_f64] {
            near("time", curve.time(spp), 0.5 + 0.1 * spp);
            near("error", curve.error(spp), 1e-5 + 0.1 * spp.powf(-1.5));
            near("samples", curve.samples_for(curve.error(spp)).expect("reached"), spp);
            near("samples in", curve.samples_in(curve.time(spp)), spp);
        }
        assert_eq!(curve.samples_for(0.9e-5), None, "bias is as large");
    }

    #[test]
    fn what_may_be_none_is_none_and_one_number_of_samples_is_enough() {
        let mut one = outcome("a", 8, [2.0, 1e-4, 1e-2]);
        one.moments.by_seeds = Some(2e-4);
        let curves = Curve::all(&[one]);
        near("the most bias", curves[0].most_bias2().expect("known"), 3e-4);
        near("error", curves[0].error(16.0), 5e-3);
        near("time", curves[0].time(16.0), 4.0);
        assert_eq!((curves[0].name.as_str(), curves[0].set.len()), ("a = 1", 1), "named");
    }

    /// The curve of outcomes at three numbers of samples with that bias.
    fn biased(bias2: f64, by_seeds: Option<f64>, by_reference: f64) -> Curve {
        let outcomes = [4, 16, 64].map(|spp| {
            let mut it = outcome("", spp, [1.0, bias2, 1e-2 / f64::from(spp)]);
            (it.moments.by_seeds, it.moments.by_reference) = (by_seeds, by_reference);
            it
        });
        Curve::all(&outcomes).remove(0)
    }

    #[test]
    fn what_numbers_of_samples_have_in_common_does_not_average_out() {
        let shared = biased(1.5e-4, Some(1e-6), 1e-4);
        assert!(shared.bias2.abs() < 1e-12, "the reference is as far off: {shared:?}");
        near("the most", shared.most_bias2().expect("known"), 1.5e-4 + 1e-6_f64.hypot(1.96e-4));
        let seeds = biased(1.5e-4, Some(2e-4), 0.0);
        assert!(seeds.bias2.abs() < 1e-12, "the seeds are the same: {seeds:?}");
        near("bias", biased(2.5e-4, Some(1e-4), 1e-4).bias2, 2.5e-4);
    }

    #[test]
    fn the_product_of_one_pair_is_chance_unless_it_is_more_than_variance() {
        // At 64 samples the variance is 1.6e-4, and most of what is known.
        let small = biased(1e-4, None, 0.0);
        assert!(small.bias2.abs() < 1e-12, "chance: {small:?}");
        let large = biased(1e-2, None, 0.0);
        near("bias", large.bias2, 1e-2);
    }

    #[test]
    fn without_noise_nothing_divides_by_it() {
        let curves = Curve::all(&[outcome("", 1, [1.0, 0.0, 0.0]), outcome("", 4, [4.0, 0.0, 0.0])]);
        assert!(curves[0].error(2.0).abs() < 1e-12, "{curves:?}");
        let one = |spp: Option<f64>| spp.is_some_and(|spp| (spp - 1.0).abs() < 1e-12);
        assert!(one(curves[0].samples_for(1e-3)), "{curves:?}");
        let quiet =
            |noise| Curve::measured(String::new(), Vec::new(), (Interval::default(), 0.0, 1.0), noise);
        assert!(one(quiet(vec![[16.0, 0.0], [1024.0, 0.0]]).samples_for(1e-3)), "as a first look tells it");
        let quiet = quiet(vec![[4.0, 1e-2], [16.0, 0.0]]);
        assert_eq!(
            [1e-1, 1e-3].map(|error| quiet.samples_for(error)),
            [Some(4.0), Some(16.0)],
            "as measured"
        );
    }
}
