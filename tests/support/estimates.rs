//! Means of random numbers with their standard errors.

#![allow(dead_code, reason = "each test program uses a part")]

/// Standard errors beyond which an estimate is wrong. A test program that makes at most 200 comparisons fails by chance with
/// probability below 1e-3: 5e-6 for each of them, on two sides (Bonferroni 1936), of a normal distribution.
pub(crate) const LIMIT: f64 = 4.57;

/// The mean of independent numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimate {
    pub(crate) mean: f64,
    /// Variance of one of the numbers.
    pub(crate) variance: f64,
    /// Standard error of the mean.
    pub(crate) error: f64,
}

impl Estimate {
    /// Of the numbers of an iterator, two or more.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
        for value in values {
            n += 1.0;
            let off = value - mean;
            mean += off / n;
            squares += off * (value - mean);
        }
        let variance = squares / (n - 1.0);
        Self { mean, variance, error: (variance / n).sqrt() }
    }

    /// How many standard errors it is off.
    pub(crate) fn off(&self, truth: f64) -> f64 {
        (self.mean - truth).abs() / self.error.max(1e-6 * truth.abs())
    }

    /// How many standard errors two independent estimates of the same are apart.
    pub(crate) fn apart(&self, other: &Self) -> f64 {
        (self.mean - other.mean).abs() / self.error.hypot(other.error)
    }
}
