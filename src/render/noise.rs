//! How far a picture is from what it would be with endless samples: an estimate from its own samples.
//!
//! The error is relMSE, as `specula diff` measures it: the mean over pixels and channels of (a - b)^2 / (b^2 + 0.01), with b the endless
//! picture. A pixel's value H of its first m samples and its value A of all n vary by s/m and s/n; A - H then has the variance
//! s/m - s/n = (s/n) (n - m)/m, so (A - H)^2 m/(n - m) is an estimate of the error of A without knowing s (m = n/2 are the two halves of
//! Dammertz, Hanika, Keller, Lensch 2010, "A hierarchical automatic stopping condition for Monte Carlo global illumination").
//!
//! Where it errs, and on which side:
//! * Samples of one sequence fill each other's gaps: both parts together are better than s/n says, and the estimate is too large.
//!   Variances of single samples would be too large by far more.
//! * Light that comes once in many samples makes single pixels bright. Divided by the square of the same pixel such
//!   an error would seem small; so b is what the early or what the late samples say, whichever is less. Too large by a fifth where the parts
//!   stray by a tenth.
//! * An estimate of few pixels that matter is itself uncertain. [`Noise::factor`] says by how much the true error may be
//!   larger: the estimate and the error of the picture are sums of squares of as many degrees of freedom, their quotient has
//!   Fisher's distribution.
//! * Light that no sample has found at all is not in any estimate.

use crate::film::RELATIVE_FLOOR;
use std::ops::AddAssign;

/// Radiance of pixels.
pub(super) type Values = Vec<[f32; 3]>;

/// The quantile of the normal distribution that 95 % are below.
const ONE_SIDED_95: f64 = 1.645;

/// The errors of some pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Noise {
    /// How many.
    pub(super) pixels: f64,
    /// The sum over pixels of their mean over channels.
    pub(super) sum: f64,
    /// The sum of the squares of the same.
    pub(super) squares: f64,
}

impl Noise {
    /// Of pixels: what they are now, with `taken` samples, and what they were with the first `early`.
    pub(super) fn of(now: &Values, before: &Values, [early, taken]: [u32; 2]) -> Self {
        let [early, taken] = [early, taken].map(f64::from);
        let late = taken - early;
        let mut noise = Self::default();
        for (a, h) in now.iter().zip(before) {
            let mut error = 0.0;
            for (a, h) in a.iter().zip(h).map(|(&a, &h)| (f64::from(a), f64::from(h))) {
                let of_late = (taken * a - early * h) / late;
                let b = h.abs().min(of_late.abs());
                error += (a - h) * (a - h) * early / late / (b * b + RELATIVE_FLOOR) / 3.0;
            }
            noise += Self { pixels: 1.0, sum: error, squares: error * error };
        }
        noise
    }

    /// The mean over pixels; 0 of none.
    pub(super) fn mean(&self) -> f64 {
        if self.pixels > 0.0 { self.sum / self.pixels } else { 0.0 }
    }

    /// By what the mean is to be multiplied for the true error to be below in 95 of 100 pictures.
    ///
    /// Each pixel's estimate is a square of a number that is about normal, of one degree of freedom; their sum has as many as equal ones
    /// would need for the same spread (Satterthwaite 1946, "An approximate distribution of estimates of variance components"):
    /// (sum w)^2 / sum w^2, and the mean of an estimate's square is 3 w^2. The quantile is that of Fisher's distribution (Abramowitz
    /// and Stegun 1964, 26.6.16, for equal degrees).
    pub(super) fn factor(&self) -> f64 {
        if self.squares <= 0.0 {
            return 1.0;
        }
        let degrees = 3.0 * self.sum * self.sum / self.squares;
        let h = (degrees - 1.0).max(0.5);
        let lambda = (ONE_SIDED_95 * ONE_SIDED_95 - 3.0) / 6.0;
        (2.0 * ONE_SIDED_95 * (h + lambda).sqrt() / h).exp()
    }

    /// What the true error is below of in 95 of 100 pictures.
    pub(super) fn bound(&self) -> f64 {
        self.mean() * self.factor()
    }
}

impl AddAssign for Noise {
    fn add_assign(&mut self, other: Self) {
        self.pixels += other.pixels;
        self.sum += other.sum;
        self.squares += other.squares;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that look random, of mean 0 and variance 1/12.
    fn random(key: u32) -> f32 {
        let mut x = key.wrapping_mul(0x9e37_79b9);
        for factor in [0x85eb_ca6b, 0xc2b2_ae35] {
            x = (x ^ (x >> 15)).wrapping_mul(factor);
        }
        ((x ^ (x >> 16)) >> 8) as f32 / (1 << 24) as f32 - 0.5
    }

    #[test]
    fn parts_of_any_size_tell_the_same_error() {
        // A gray of 1 with independent samples of variance s: the error is s / n / 1.01.
        let pixels = 64 * 64;
        for [early, taken] in [[16, 32], [32, 48], [32, 40], [8, 16]] {
            let mean =
                |pixel: u32, n: u32| 1.0 + (0..n).map(|i| random(pixel * 64 + i)).sum::<f32>() / n as f32;
            let values = |n: u32| -> Values { (0..pixels).map(|pixel| [mean(pixel, n); 3]).collect() };
            let noise = Noise::of(&values(taken), &values(early), [early, taken]);
            let expected = 1.0 / 12.0 / f64::from(taken) / 1.01;
            let ratio = noise.mean() / expected;
            // Spread of the estimate: sqrt(2 / pixels) = 2.2 %; the smaller part adds 1.6 times the distance of both, on average.
            assert!((0.95..1.35).contains(&ratio), "{early} of {taken}: {ratio}");
            assert!((1.02..1.08).contains(&noise.factor()), "{early} of {taken}: {}", noise.factor());
        }
    }

    #[test]
    fn few_pixels_that_matter_are_less_certain() {
        let noise = |pixels: f64, seen: f64| Noise { pixels, sum: seen, squares: 3.0 * seen };
        // Tables of Fisher's distribution, 5 %: 10 and 10 degrees 2.98, 120 and 120 1.35.
        for (degrees, expected) in [(10.0, 2.98), (120.0, 1.35)] {
            let factor = noise(1000.0, degrees).factor();
            assert!((factor / expected - 1.0).abs() < 0.02, "{degrees}: {factor} for {expected}");
        }
        assert!(noise(1000.0, 1.0).factor() > 20.0, "one");
        assert!((noise(1000.0, 0.0).factor() - 1.0).abs() < 1e-9, "without noise");
    }

    #[test]
    fn a_lone_bright_pixel_does_not_hide_its_error() {
        let dark: Values = vec![[0.0; 3]; 256];
        let bright = |pixel: usize, value: f32| {
            let mut values = dark.clone();
            values[pixel] = [value; 3];
            values
        };
        // One sample of 16 * 50, among the late ones and among the early ones.
        let late = Noise::of(&bright(100, 25.0), &dark, [16, 32]);
        let early = Noise::of(&bright(100, 25.0), &bright(100, 50.0), [16, 32]);
        assert!((late.mean() / (625.0 / 0.01 / 256.0) - 1.0).abs() < 1e-6, "{}", late.mean());
        assert!((early.mean() / late.mean() - 1.0).abs() < 1e-6, "{}", early.mean());
        assert!(Noise::of(&bright(1, 50.0), &bright(1, 49.0), [16, 32]).mean() < 1e-5, "twice the same");
    }
}
