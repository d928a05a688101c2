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
//! asymptotically normal distribution"); squares may come out below zero by chance. Intervals are by jackknife over pictures. What the
//! reference's noise r - b does is the same in all pictures, so the jackknife does not see it; it makes error and bias^2 uncertain twice: by its own
//! square about the floor, and by its product with the bias, -2 <m - b, r - b> (`cross`), which is greater as soon as bias^2 is more than half of the
//! floor. Products are all that is kept of pictures, so a sweep can be left and gone on with; pairs of pictures that were never in memory together
//! are missing then, and nothing else changes.

use super::student::Interval;
use crate::image::Image;
use crate::measure::{Errors, RELATIVE_FLOOR};

/// A true picture as it is known, ready for products.
#[derive(Clone, Debug)]
pub struct Measure {
    reference: Vec<[f32; 3]>,
    weights: Vec<[f64; 3]>,
    /// Weights times the standard deviation of the reference's values; zero where that is not known.
    doubts: Vec<[f64; 3]>,
    /// Values that count.
    count: f64,
    /// Of the reference, over those.
    mean: f64,
    /// What the reference's noise is ([`Measure::floor`]).
    floor: [f64; 2],
    /// What the square of <m - b, r - b> is of that noise by itself.
    alone: f64,
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

impl Own {
    /// From errors against a reference of that mean.
    #[must_use]
    pub fn of(errors: &Errors, mean: f64) -> Self {
        let scale = if mean > 0.0 { mean.recip() } else { 0.0 };
        Self { relmse: errors.relmse, mse: errors.mse, brightness: errors.bias * scale }
    }
}

/// Of two pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Product {
    /// <x, y>.
    pub value: f64,
    /// The variance of 2 <m - b, r - b>: of what the reference's noise makes of the bias. Below zero by chance where there is none.
    pub cross: f64,
}

impl Measure {
    /// Against a reference; pixels of it that are not finite do not count. Of its noise the variance of each value may be known, estimated
    /// from so many pictures.
    #[must_use]
    pub fn new(reference: &Image, noise: Option<(&[[f32; 3]], u32)>) -> Self {
        let weight = |pixel: &[f32; 3]| {
            let counts = pixel.iter().all(|x| x.is_finite());
            pixel.map(|b| if counts { (f64::from(b).powi(2) + RELATIVE_FLOOR).recip() } else { 0.0 })
        };
        Self::weighed(reference, noise, weight)
    }

    /// The same with weights of one's own; those of a pixel that does not count are zero.
    fn weighed(
        reference: &Image,
        noise: Option<(&[[f32; 3]], u32)>,
        weight: impl Fn(&[f32; 3]) -> [f64; 3],
    ) -> Self {
        let values: Vec<[f32; 3]> = reference.pixels().iter().map(|p| [p.r, p.g, p.b]).collect();
        let weights: Vec<[f64; 3]> = values.iter().map(weight).collect();
        let used = || values.iter().zip(&weights).filter(|(_, w)| w[0] > 0.0);
        let count = used().map(|_| 3.0).sum();
        let mean = used().flat_map(|(pixel, _)| pixel.iter().map(|&x| f64::from(x))).sum::<f64>() / count;
        let reference = values.iter().zip(&weights).map(|(p, w)| if w[0] > 0.0 { *p } else { [0.0; 3] });
        let mut measure = Self {
            reference: reference.collect(),
            doubts: vec![[0.0; 3]; weights.len()],
            weights,
            count,
            mean,
            floor: [0.0; 2],
            alone: 0.0,
        };
        if let Some((variances, pictures)) = noise {
            measure.know(variances, pictures);
        }
        measure
    }

    /// Takes the reference's noise into account.
    fn know(&mut self, variances: &[[f32; 3]], pictures: u32) {
        let (mut sum, mut squares) = (0.0, 0.0);
        for ((variance, w), doubt) in variances.iter().zip(&self.weights).zip(&mut self.doubts) {
            let weighed = [0, 1, 2].map(|c| w[c] * f64::from(variance[c]));
            let of_pixel: f64 = weighed.iter().sum();
            if of_pixel.is_finite() {
                sum += of_pixel;
                squares += of_pixel * of_pixel;
                *doubt = [0, 1, 2].map(|c| w[c] * f64::from(variance[c]).max(0.0).sqrt());
            }
        }
        // Of the noise itself, and of the variance that was estimated from few pictures.
        let of_estimate = if pictures > 1 { f64::from(pictures - 1).recip() } else { 0.0 };
        self.floor = [sum / self.count, (2.0 * squares * (1.0 + of_estimate)).sqrt() / self.count];
        self.alone = squares / self.count.powi(2);
    }

    /// The mean of the reference over pixels that count.
    #[must_use]
    pub const fn mean(&self) -> f64 {
        self.mean
    }

    /// <x, y> of two pictures, and what the reference's noise may add to it by their bias: that of a pixel is one for all of its channels, that of
    /// others independent.
    ///
    /// # Panics
    /// If one is of another size.
    #[must_use]
    pub fn product(&self, x: &Image, y: &Image) -> Product {
        let (mut sum, mut cross) = (0.0, 0.0);
        for (i, (p, q)) in self.pixels(x).zip(self.pixels(y)).enumerate() {
            let (w, doubt) = (&self.weights[i], &self.doubts[i]);
            // Pixels of a picture that are not finite are left out of its error, too.
            if w[0] > 0.0 && p.iter().chain(&q).all(|x| x.is_finite()) {
                sum += [0, 1, 2].map(|c| w[c] * p[c] * q[c]).iter().sum::<f64>();
                let of = |difference: [f64; 3]| (0..3).map(|c| doubt[c] * difference[c]).sum::<f64>();
                cross += of(p) * of(q);
            }
        }
        // The differences have the reference's own noise, too, whose square does not belong to the bias.
        Product { value: sum / self.count, cross: 4.0 * (cross / self.count.powi(2) - self.alone) }
    }

    /// The mean of variances of the reference, weighed as errors are, and the standard deviation of the mean of squares of its noise
    /// about that, pixels being independent and their channels not: three for each pixel. Zero where the noise is not known.
    #[must_use]
    pub const fn floor(&self) -> [f64; 2] {
        self.floor
    }

    /// Differences from the reference.
    fn pixels<'a>(&'a self, picture: &'a Image) -> impl Iterator<Item = [f64; 3]> + 'a {
        assert_eq!(picture.pixels().len(), self.reference.len(), "pictures of one size");
        let values = picture.pixels().iter().map(|p| [p.r, p.g, p.b]);
        values.zip(&self.reference).map(|(p, r)| [0, 1, 2].map(|c| f64::from(p[c]) - f64::from(r[c])))
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
    /// Half of the interval of `bias2` by the seeds of the runs alone; unknown where there are too few.
    pub by_seeds: Option<f64>,
    /// The standard deviation that the reference's noise adds to error and `bias2`: the same noise in all points that are compared with it.
    pub by_reference: f64,
}

impl Moments {
    /// From <x, x> of each picture and products of pairs of them, the reference's noise and how uncertain that is ([`Measure::floor`]).
    #[must_use]
    pub fn of(own: &[f64], pairs: &[(usize, usize, Product)], [floor, doubt]: [f64; 2]) -> Self {
        let errors: Vec<f64> = own.iter().map(|x| x - floor).collect();
        // Only pictures that are part of a pair have a say in what pairs tell.
        let paired: Vec<usize> =
            (0..own.len()).filter(|i| pairs.iter().any(|&(a, b, _)| a == *i || b == *i)).collect();
        let mean = |of: &dyn Fn(&(usize, usize, Product)) -> f64, without: Option<usize>| {
            let rest: Vec<f64> =
                pairs.iter().filter(|&&(a, b, _)| without.is_none_or(|i| a != i && b != i)).map(of).collect();
            #[expect(clippy::cast_precision_loss, reason = "few pairs")]
            let count = rest.len() as f64;
            (count > 0.0).then(|| rest.iter().sum::<f64>() / count)
        };
        let over = |of: &dyn Fn(&(usize, usize, Product)) -> f64| {
            let without = |i: usize| mean(of, Some(paired[i]));
            mean(of, None).map(|value| Interval::of_jackknife(value, paired.len(), without))
        };
        let cross = mean(&|(_, _, product)| product.cross, None).unwrap_or(0.0).max(0.0);
        let by_reference = doubt.hypot(cross.sqrt());
        let bias2 = over(&|(_, _, product)| product.value - floor);
        Self {
            error: Interval::of_mean(&errors).widened(by_reference),
            bias2: bias2.map(|interval| interval.widened(by_reference)),
            variance: over(&|&(a, b, product)| (own[a] + own[b]) / 2.0 - product.value),
            by_seeds: bias2.and_then(|interval| interval.half),
            by_reference,
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
        let own: Vec<f64> = pictures.iter().map(|x| measure.product(x, x).value).collect();
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
            // Weights of the true picture, lest the test be about those.
            let measure = Measure::weighed(&reference, None, |_| [weight; 3]);
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
        // 95 % are to be inside; 88 % are 4.5 standard deviations fewer. What makes the intervals of squares too short in one of ten thousand
        // cases shows here.
        for (name, inside) in ["bias^2", "variance", "error"].into_iter().zip(inside) {
            assert!(inside >= trials * 88 / 100, "{name}: {inside} of {trials} intervals hold the truth");
        }
    }

    #[test]
    fn without_bias_none_is_found_and_without_noise_none() {
        let measure = Measure::new(&picture(0.0, 0.0, 0), None);
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
    }

    #[test]
    fn missing_pairs_change_no_mean() {
        let measure = Measure::new(&picture(0.0, 0.0, 0), None);
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

    /// A gray picture whose channels have the same noise.
    fn gray(bias: f32, sigma: f32, seed: u32) -> Image {
        let of = |i| Rgb::gray(1.0 + bias + sigma * normal(hash::combine(hash::mix(seed), i)));
        Image::from_pixels(SIDE, SIDE, (0..SIDE * SIDE).map(of).collect()).expect("a square")
    }

    #[test]
    fn the_references_noise_counts_with_the_bias_that_it_meets() {
        let (bias, sigma, deviation) = (0.5_f32, 0.02_f32, 0.04_f32);
        let weight = 1.0 / 1.01;
        let wanted = weight * f64::from(bias).powi(2);
        let variances = vec![[deviation * deviation; 3]; (SIDE * SIDE) as usize];
        let (mut inside, mut by_seeds, mut squares, mut halves, trials) = (0, 0, 0.0, 0.0, 200_u32);
        for trial in 0..trials {
            let reference = gray(0.0, deviation, 5_000_000 + trial);
            let measure = Measure::weighed(&reference, Some((&variances[..], 0)), |_| [weight; 3]);
            let pictures: Vec<Image> = (0..5).map(|k| gray(bias, sigma, 100 * trial + k)).collect();
            let found = moments(&measure, &pictures, measure.floor(), |_, _| true);
            let bias2 = found.bias2.expect("pairs");
            let (off, half) = ((bias2.value - wanted).abs(), bias2.half.expect("known"));
            inside += u32::from(off <= half);
            by_seeds += u32::from(off <= found.by_seeds.expect("known"));
            squares += off * off / f64::from(trials);
            halves += half / f64::from(trials);
        }
        // As above; and no wider than they must be.
        assert!(inside >= trials * 88 / 100, "{inside} of {trials} intervals hold the truth");
        assert!(by_seeds < trials * 3 / 4, "the seeds of runs know nothing of it: {by_seeds} of {trials}");
        assert!(halves < 1.4 * 1.96 * squares.sqrt(), "half {halves}, deviation {}", squares.sqrt());
    }

    #[test]
    fn pixels_that_are_not_finite_do_not_count() {
        let mut reference = picture(0.0, 0.0, 0);
        reference.set_pixel(3, 3, Rgb::new(1.0, f32::NAN, 1.0));
        let unknown = vec![[f32::NAN; 3]; (SIDE * SIDE) as usize];
        let measure = Measure::new(&reference, Some((&unknown[..], 4)));
        let bright = picture(0.5, 0.0, 0);
        let product = measure.product(&bright, &bright);
        assert!((product.value - 0.25 / 1.01).abs() < 1e-6 && product.cross.abs() < 1e-12, "{product:?}");
        assert!(measure.floor().iter().all(|x| x.to_bits() == 0), "nothing is known of its noise");
        let mut torn = bright.clone();
        torn.set_pixel(5, 5, Rgb::gray(f32::INFINITY));
        let product = measure.product(&torn, &bright);
        assert!(
            (product.value / (0.25 / 1.01) - 1.0).abs() < 0.01 && product.cross.abs() < 1e-12,
            "{product:?}"
        );
    }

    #[test]
    fn brightness_is_a_part_of_all_light() {
        let largest = crate::measure::Largest::default();
        let errors = Errors { pixels: 1, bias: 0.5, mae: 0.5, mse: 0.25, relmse: 0.1, largest };
        assert_eq!(Own::of(&errors, 2.0), Own { relmse: 0.1, mse: 0.25, brightness: 0.25 }, "a quarter");
        assert_eq!(Own::of(&errors, 0.0).brightness.to_bits(), 0, "of black");
    }
}
