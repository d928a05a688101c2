//! Intervals of a few measurements, and of statistics of them.

use statrs::distribution::{ContinuousCDF as _, StudentsT};

/// A value, and how far the true one may be from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interval {
    /// What was found.
    pub value: f64,
    /// The true value is within this of it with a probability of 95 %; unknown where there are too few measurements.
    pub half: Option<f64>,
}

impl Interval {
    /// The mean of independent measurements of one thing; zero of none.
    #[must_use]
    pub fn of_mean(values: &[f64]) -> Self {
        let n = count(values.len());
        if values.is_empty() {
            return Self::default();
        }
        let mean = values.iter().sum::<f64>() / n;
        let squares = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        let half = quantile(n - 1.0).map(|t| t * (squares / (n - 1.0) / n).sqrt());
        Self { value: mean, half }
    }

    /// A statistic of `n` measurements by jackknife: `without(i)` is what it is without the i-th. Unknown half where any of those is.
    ///
    /// Of U-statistics the jackknife's variance is consistent: Arvesen 1969, "Jackknifing U-statistics".
    #[must_use]
    pub fn of_jackknife(value: f64, n: usize, without: impl Fn(usize) -> Option<f64>) -> Self {
        let rest: Option<Vec<f64>> = (0..n).map(without).collect();
        let half = rest.filter(|_| n > 1).and_then(|rest| {
            let n = count(n);
            let mean = rest.iter().sum::<f64>() / n;
            let squares = rest.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            Some(quantile(n - 1.0)? * ((n - 1.0) / n * squares).sqrt())
        });
        Self { value, half }
    }

    /// The same where something else makes the value uncertain, too, by a standard deviation of `doubt`.
    #[must_use]
    pub fn widened(self, doubt: f64) -> Self {
        Self { half: self.half.map(|half| half.hypot(1.96 * doubt)), ..self }
    }

    /// Whether it reaches down to zero: the value may as well be none. Where nothing is known it may.
    #[must_use]
    pub fn may_be_zero(&self) -> bool {
        self.half.is_none_or(|half| self.value.abs() <= half)
    }
}

/// What Student's t is below of with a probability of 97.5 %, at so many degrees of freedom; `None` below one.
fn quantile(degrees: f64) -> Option<f64> {
    if degrees < 1.0 {
        return None;
    }
    StudentsT::new(0.0, 1.0, degrees).ok().map(|student| student.inverse_cdf(0.975))
}

#[expect(clippy::cast_precision_loss, reason = "few measurements")]
fn count(n: usize) -> f64 {
    n as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // Abramowitz and Stegun 1964, table 26.10.
        for (degrees, t) in [(1.0, 12.706), (2.0, 4.303), (4.0, 2.776), (9.0, 2.262), (120.0, 1.980)] {
            let found = quantile(degrees).expect("a degree");
            assert!((found - t).abs() < 6e-4, "{degrees}: {found}, not {t}");
        }
        assert_eq!(quantile(0.0), None, "of one measurement");
    }

    #[test]
    fn means_have_intervals_from_two_measurements_on() {
        assert_eq!(Interval::of_mean(&[]), Interval::default(), "of none");
        assert_eq!(Interval::of_mean(&[3.0]), Interval { value: 3.0, half: None }, "of one");
        let three = Interval::of_mean(&[1.0, 2.0, 3.0]);
        let half = three.half.expect("known");
        assert!(
            (three.value - 2.0).abs() < 1e-12 && (half - 4.3027 / 3.0_f64.sqrt()).abs() < 1e-3,
            "{three:?}"
        );
        assert!(!three.may_be_zero() || half > 2.0, "{three:?}");
    }

    #[test]
    fn the_jackknife_of_a_mean_is_that_of_the_formula() {
        let values = [1.0, 4.0, 2.0, 8.0];
        let total: f64 = values.iter().sum();
        let jackknife = Interval::of_jackknife(total / 4.0, 4, |i| Some((total - values[i]) / 3.0));
        let plain = Interval::of_mean(&values);
        let halves = [jackknife, plain].map(|interval| interval.half.expect("known"));
        assert!((halves[0] - halves[1]).abs() < 1e-12, "{halves:?}");
        assert_eq!(Interval::of_jackknife(1.0, 4, |_| None).half, None, "unknown");
    }
}
