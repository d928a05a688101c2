//! Bias and variance of pictures, told apart.
//!
//! Pictures x_1 .. x_K of one point differ by their seeds alone: each is the point's own mean picture m plus noise. The reference r is the true
//! picture b plus noise of its own, whose variance is known. With <x, y> the mean over pixels and channels of w (x - r) (y - r), w the
//! weight of relMSE:
//!
//! ```text
//! error     E <x, x> - floor = bias^2 + variance          of one picture
//! bias^2    E <x, y> - floor                              of two pictures with different seeds: their noise has no product in the mean
//! variance  E (<x, x> + <y, y>) / 2 - <x, y>              the reference's noise is in both and goes
//! floor     mean of w times the variance of r
//! ```
//!
//! Means over pictures, and over pairs of pictures, estimate these without bias (U-statistics; Hoeffding 1948, "A class of statistics with
//! asymptotically normal distribution"); squares may come out below zero by chance. Intervals are by jackknife over pictures. Products are all
//! that is kept of pictures, so a sweep can be left and gone on with; pairs of pictures that were never in memory together are missing
//! then, and nothing else changes.

use super::student::Interval;
use crate::image::Image;
use crate::measure::RELATIVE_FLOOR;

/// A true picture as it is known, ready for products.
#[derive(Clone, Debug)]
pub struct Measure {
    reference: Vec<[f32; 3]>,
    weights: Vec<[f64; 3]>,
    /// Values that count.
    count: f64,
    /// Of the reference, over those.
    mean: f64,
}

/// Of one picture alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Own {
    /// <x, x>: relMSE, the reference's noise included.
    pub relmse: f64,
    /// Mean of squared differences, the reference's noise included.
    pub mse: f64,
    /// Mean difference by the mean of the reference: how much too bright.
    pub brightness: f64,
}

impl Measure {
    /// Against a reference; pixels of it that are not finite do not count.
    #[must_use]
    pub fn new(reference: &Image) -> Self {
        let values: Vec<[f32; 3]> = reference.pixels().iter().map(|p| [p.r, p.g, p.b]).collect();
        let weights: Vec<[f64; 3]> = values
            .iter()
            .map(|pixel| {
                let counts = pixel.iter().all(|x| x.is_finite());
                pixel.map(|b| if counts { (f64::from(b).powi(2) + RELATIVE_FLOOR).recip() } else { 0.0 })
            })
            .collect();
        let used = || values.iter().zip(&weights).filter(|(_, w)| w[0] > 0.0);
        let count = used().map(|_| 3.0).sum();
        let mean = used().flat_map(|(pixel, _)| pixel.iter().map(|&x| f64::from(x))).sum::<f64>() / count;
        let reference = values.iter().zip(&weights).map(|(p, w)| if w[0] > 0.0 { *p } else { [0.0; 3] });
        Self { reference: reference.collect(), weights, count, mean }
    }

    /// What a picture is by itself.
    ///
    /// # Panics
    /// If it is of another size.
    #[must_use]
    pub fn own(&self, picture: &Image) -> Own {
        let mut own = Own::default();
        for ((pixel, r), w) in self.pixels(picture) {
            for (channel, (x, w)) in pixel.into_iter().zip(w).enumerate() {
                if *w > 0.0 {
                    let difference = f64::from(x) - f64::from(r[channel]);
                    own.relmse += w * difference * difference;
                    own.mse += difference * difference;
                    own.brightness += difference;
                }
            }
        }
        let scale = if self.mean > 0.0 { self.mean.recip() } else { 0.0 };
        Own {
            relmse: own.relmse / self.count,
            mse: own.mse / self.count,
            brightness: own.brightness / self.count * scale,
        }
    }

    /// <x, y> of two pictures.
    ///
    /// # Panics
    /// If one is of another size.
    #[must_use]
    pub fn product(&self, x: &Image, y: &Image) -> f64 {
        let others = y.pixels().iter().map(|p| [p.r, p.g, p.b]);
        let mut sum = 0.0;
        for (((pixel, r), w), other) in self.pixels(x).zip(others) {
            for (channel, w) in w.iter().enumerate().filter(|(_, w)| **w > 0.0) {
                let r = f64::from(r[channel]);
                sum += w * (f64::from(pixel[channel]) - r) * (f64::from(other[channel]) - r);
            }
        }
        sum / self.count
    }

    /// The mean of variances of the reference, weighed as errors are, and the standard deviation of the mean of squares of its noise
    /// about that, pixels being independent and their channels not: three for each pixel, estimated from so many pictures.
    #[must_use]
    pub fn floor(&self, variances: &[[f32; 3]], pictures: u32) -> [f64; 2] {
        let (mut sum, mut squares) = (0.0, 0.0);
        for (variance, w) in variances.iter().zip(&self.weights) {
            let of_pixel: f64 = variance.iter().zip(w).map(|(&v, w)| w * f64::from(v)).sum();
            if of_pixel.is_finite() {
                sum += of_pixel;
                squares += of_pixel * of_pixel;
            }
        }
        // Of the noise itself, and of the variance that was estimated from few pictures.
        let of_estimate = if pictures > 1 { f64::from(pictures - 1).recip() } else { 0.0 };
        [sum / self.count, (2.0 * squares * (1.0 + of_estimate)).sqrt() / self.count]
    }

    fn pixels<'a>(
        &'a self,
        picture: &'a Image,
    ) -> impl Iterator<Item = (([f32; 3], &'a [f32; 3]), &'a [f64; 3])> {
        assert_eq!(picture.pixels().len(), self.reference.len(), "pictures of one size");
        picture.pixels().iter().map(|p| [p.r, p.g, p.b]).zip(&self.reference).zip(&self.weights)
    }
}

/// What there is to know of a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// relMSE of one picture: bias and variance together.
    pub error: Interval,
    /// The part that no number of samples takes away, squared; below zero by chance where there is none. Unknown without a pair.
    pub bias2: Option<Interval>,
    /// The part that is noise. Unknown without a pair.
    pub variance: Option<Interval>,
}

impl Moments {
    /// From <x, x> of each picture and <x, y> of pairs of them, the reference's noise and how uncertain that is ([`Measure::floor`]).
    #[must_use]
    pub fn of(own: &[f64], pairs: &[(usize, usize, f64)], [floor, doubt]: [f64; 2]) -> Self {
        let errors: Vec<f64> = own.iter().map(|x| x - floor).collect();
        // Only pictures that are part of a pair have a say in what pairs tell.
        let paired: Vec<usize> =
            (0..own.len()).filter(|i| pairs.iter().any(|&(a, b, _)| a == *i || b == *i)).collect();
        let over = |of: &dyn Fn(&(usize, usize, f64)) -> f64| {
            let mean = |without: Option<usize>| {
                let rest: Vec<f64> = pairs
                    .iter()
                    .filter(|&&(a, b, _)| without.is_none_or(|i| a != i && b != i))
                    .map(of)
                    .collect();
                #[expect(clippy::cast_precision_loss, reason = "few pairs")]
                let count = rest.len() as f64;
                (count > 0.0).then(|| rest.iter().sum::<f64>() / count)
            };
            let without = |i: usize| mean(Some(paired[i]));
            mean(None).map(|value| Interval::of_jackknife(value, paired.len(), without))
        };
        Self {
            error: Interval::of_mean(&errors).widened(doubt),
            bias2: over(&|&(_, _, product)| product - floor).map(|interval| interval.widened(doubt)),
            variance: over(&|&(a, b, product)| (own[a] + own[b]) / 2.0 - product),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::sampling::hash;

    /// A number that looks random, about normal, of mean 0 and variance 1: a sum of twelve uniform ones, less their mean.
    fn normal(key: u32) -> f32 {
        (0..12_u32)
            .map(|i| (hash::mix(hash::combine(hash::mix(key), i)) >> 8) as f32 / 16_777_216.0)
            .sum::<f32>()
            - 6.0
    }

    const SIDE: u32 = 16;

    /// A picture of gray 1, too bright by `bias` and with noise of deviation `sigma`.
    fn picture(bias: f32, sigma: f32, seed: u32) -> Image {
        let pixels = (0..SIDE * SIDE).map(|i| {
            let noise = |channel| sigma * normal(hash::combine(hash::combine(hash::mix(seed), i), channel));
            Rgb::new(1.0 + bias + noise(0), 1.0 + bias + noise(1), 1.0 + bias + noise(2))
        });
        Image::from_pixels(SIDE, SIDE, pixels.collect()).expect("a square")
    }

    fn moments(
        measure: &Measure,
        pictures: &[Image],
        floor: [f64; 2],
        is_wanted: impl Fn(usize, usize) -> bool,
    ) -> Moments {
        let own: Vec<f64> = pictures.iter().map(|x| measure.own(x).relmse).collect();
        let mut pairs = Vec::new();
        for b in 1..pictures.len() {
            for a in (0..b).filter(|&a| is_wanted(a, b)) {
                pairs.push((a, b, measure.product(&pictures[a], &pictures[b])));
            }
        }
        Moments::of(&own, &pairs, floor)
    }

    #[test]
    fn a_known_bias_and_variance_come_out_within_their_intervals() {
        let (bias, sigma, deviation) = (0.05_f32, 0.2_f32, 0.04_f32);
        let weight = 1.0 / 1.01;
        let wanted = [weight * f64::from(bias).powi(2), weight * f64::from(sigma).powi(2)];
        let (mut inside, mut sums, trials) = ([0_u32; 3], [0.0; 2], 200_u32);
        for trial in 0..trials {
            // A reference with noise of its own, whose variance is known.
            let reference = picture(0.0, deviation, 5_000_000 + trial);
            let mut measure = Measure::new(&reference);
            // Weights of the true picture, lest the test be about those.
            measure.weights.iter_mut().for_each(|w| *w = [weight; 3]);
            let floor = weight * f64::from(deviation).powi(2);
            let doubt = floor * (2.0 / f64::from(3 * SIDE * SIDE)).sqrt();
            let pictures: Vec<Image> = (0..5).map(|k| picture(bias, sigma, 100 * trial + k)).collect();
            let found = moments(&measure, &pictures, [floor, doubt], |_, _| true);
            let both = [found.bias2, found.variance].map(|interval| interval.expect("pairs"));
            for (i, (interval, wanted)) in both.iter().zip(wanted).enumerate() {
                sums[i] += interval.value / f64::from(trials);
                inside[i] += u32::from((interval.value - wanted).abs() <= interval.half.expect("known"));
            }
            let error = found.error;
            inside[2] += u32::from((error.value - wanted[0] - wanted[1]).abs() <= error.half.expect("known"));
        }
        for (name, mean, wanted) in [("bias^2", sums[0], wanted[0]), ("variance", sums[1], wanted[1])] {
            assert!((mean / wanted - 1.0).abs() < 0.03, "{name}: {mean} in the mean, not {wanted}");
        }
        // 95 % are to be inside; 88 % are 5 standard deviations fewer. What makes the intervals of squares too short in one of ten thousand
        // cases shows here.
        for (name, inside) in ["bias^2", "variance", "error"].into_iter().zip(inside) {
            assert!(inside >= trials * 88 / 100, "{name}: {inside} of {trials} intervals hold the truth");
        }
    }

    #[test]
    fn without_bias_none_is_found_and_without_noise_none() {
        let measure = Measure::new(&picture(0.0, 0.0, 0));
        let noisy: Vec<Image> = (1..7).map(|k| picture(0.0, 0.3, k)).collect();
        let found = moments(&measure, &noisy, [0.0; 2], |_, _| true);
        assert!(found.bias2.is_some_and(|bias| bias.may_be_zero()), "{found:?}");
        let plain = vec![picture(0.25, 0.0, 0); 4];
        let found = moments(&measure, &plain, [0.0; 2], |_, _| true);
        let bias = found.bias2.expect("pairs");
        assert!(
            (bias.value - 0.0625 / 1.01).abs() < 1e-6 && bias.half.is_some_and(|half| half < 1e-9),
            "{bias:?}"
        );
        assert!(found.variance.is_some_and(|variance| variance.value.abs() < 1e-9), "{found:?}");
        assert!((measure.own(&plain[0]).brightness - 0.25).abs() < 1e-6, "a quarter too bright");
    }

    #[test]
    fn missing_pairs_change_no_mean() {
        let measure = Measure::new(&picture(0.0, 0.0, 0));
        let mut sums = [0.0; 2];
        for trial in 0..50 {
            let pictures: Vec<Image> = (0..4).map(|k| picture(0.1, 0.2, 1000 + 10 * trial + k)).collect();
            // As if the sweep had been left between the second and the third.
            let found = moments(&measure, &pictures, [0.0; 2], |a, b| b < 2 || a >= 2);
            let [bias, variance] = [found.bias2, found.variance].map(|interval| interval.expect("pairs"));
            assert!(bias.half.is_some() && variance.half.is_some(), "{found:?}");
            sums[0] += bias.value / 50.0;
            sums[1] += variance.value / 50.0;
        }
        assert!((sums[0] / (0.01 / 1.01) - 1.0).abs() < 0.05, "bias^2: {}", sums[0]);
        assert!((sums[1] / (0.04 / 1.01) - 1.0).abs() < 0.03, "variance: {}", sums[1]);
        let one = moments(&measure, &[picture(0.1, 0.2, 1)], [0.0; 2], |_, _| true);
        assert_eq!((one.bias2, one.variance, one.error.half), (None, None, None), "of one picture");
    }

    #[test]
    fn pixels_that_are_not_finite_do_not_count() {
        let mut reference = picture(0.0, 0.0, 0);
        reference.set_pixel(3, 3, Rgb::new(1.0, f32::NAN, 1.0));
        let measure = Measure::new(&reference);
        let own = measure.own(&picture(0.5, 0.0, 0));
        assert!((own.mse - 0.25).abs() < 1e-6 && (own.relmse - 0.25 / 1.01).abs() < 1e-6, "{own:?}");
    }
}
