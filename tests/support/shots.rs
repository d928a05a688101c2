//! Pictures with what is known of their noise, and tests of one against another.

#![allow(dead_code, reason = "each test program uses a part")]

use crate::statistics::chi_square_tail;
use specula::film::{Aov, Film, Layout};
use specula::image::exr;
use specula::render::{Settings, Silent, render};
use specula::scene::Scene;
use std::path::Path;

/// A picture: per pixel and channel a mean and the variance of that mean.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shot {
    pub(crate) size: [usize; 2],
    pub(crate) mean: Vec<[f64; 3]>,
    pub(crate) variance: Vec<[f64; 3]>,
}

/// What of a pixel is of single precision, as a part of its value.
const ROUNDING: f64 = 2e-6;

impl Shot {
    /// A rendering with the settings of the scene. The variance is that of independent samples: of better ones a bound.
    pub(crate) fn of(scene: &Scene) -> Self {
        let settings = Settings { layout: Layout::with([Aov::Variance]), ..Settings::default() };
        let film = render(scene, &settings, &Silent).expect("a picture").film;
        assert_eq!(film.non_finite().count(), 0, "samples that are not finite");
        let channels = |aov| rows(&film.channels(aov).expect("kept"));
        Self { size: size_of(&film), mean: channels(Aov::Beauty), variance: channels(Aov::Variance) }
    }

    /// A picture from a file, with that of its variance from layer `variance`, or from another file.
    pub(crate) fn read(file: &Path, variance: Option<&Path>) -> Self {
        let picture = exr::read(file).expect("a picture");
        let layer = |picture: &exr::Picture, names: [&str; 3]| {
            rows(&names.map(|name| picture.channel(name).expect("a channel").to_f32()))
        };
        let size = [picture.window.width() as usize, picture.window.height() as usize];
        let mean = layer(&picture, ["R", "G", "B"]);
        let variance = match variance {
            Some(file) => layer(&exr::read(file).expect("a picture"), ["R", "G", "B"]),
            None if picture.channel("variance.R").is_some() => {
                layer(&picture, ["variance.R", "variance.G", "variance.B"])
            }
            None => vec![[0.0; 3]; mean.len()],
        };
        Self { size, mean, variance }
    }

    /// The mean over all pixels, and its standard error, of a channel.
    pub(crate) fn mean_of(&self, channel: usize) -> [f64; 2] {
        let count = self.mean.len() as f64;
        let sum = |values: &[[f64; 3]]| values.iter().map(|value| value[channel]).sum::<f64>();
        [sum(&self.mean) / count, sum(&self.variance).sqrt() / count]
    }

    /// Means of squares of pixels; what is left over at the right and below is dropped.
    pub(crate) fn blocks(&self, side: usize) -> Self {
        let [width, height] = self.size.map(|n| n / side);
        let area = (side * side) as f64;
        let (mut mean, mut variance) = (vec![[0.0; 3]; width * height], vec![[0.0; 3]; width * height]);
        for y in 0..height * side {
            for x in 0..width * side {
                let (to, from) = (y / side * width + x / side, y * self.size[0] + x);
                for channel in 0..3 {
                    mean[to][channel] += self.mean[from][channel] / area;
                    variance[to][channel] += self.variance[from][channel] / (area * area);
                }
            }
        }
        Self { size: [width, height], mean, variance }
    }

    /// The same, trusted to this part of each value only.
    pub(crate) fn doubted(mut self, part: f64) -> Self {
        for (variance, mean) in self.variance.iter_mut().flatten().zip(self.mean.iter().flatten()) {
            *variance += (part * mean).powi(2);
        }
        self
    }

    /// The same without some pixels.
    pub(crate) fn without(&self, dropped: &[bool]) -> Self {
        let kept = |values: &[[f64; 3]]| -> Vec<[f64; 3]> {
            values.iter().zip(dropped).filter(|(_, dropped)| !**dropped).map(|(value, _)| *value).collect()
        };
        let mean = kept(&self.mean);
        Self { size: [mean.len(), 1], variance: kept(&self.variance), mean }
    }
}

fn rows(channels: &[Vec<f32>]) -> Vec<[f64; 3]> {
    (0..channels[0].len()).map(|i| [0, 1, 2].map(|c| f64::from(channels[c][i]))).collect()
}

fn size_of(film: &Film) -> [usize; 2] {
    [film.window().width() as usize, film.window().height() as usize]
}

/// How two pictures of the same differ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Verdict {
    /// Numbers that were compared: pixels times channels.
    pub(crate) count: usize,
    /// How many are apart by more than one in `count` would be once in a hundred comparisons of pictures.
    pub(crate) beyond: usize,
    /// The furthest apart, in standard deviations.
    pub(crate) worst: f64,
    /// The mean square of distances in standard deviations: 1 where all of the difference is noise.
    pub(crate) square: f64,
    /// Difference of the means over all, as a part of the reference.
    pub(crate) bias: f64,
    /// The same in its standard deviations.
    pub(crate) bias_deviations: f64,
    /// Root mean square difference less what noise makes of it, as a part of the mean of the reference; negative where noise
    /// is more than all there is.
    pub(crate) rmse: f64,
}

/// Part of the comparisons of whole pictures that fail by chance at one pixel or more.
pub(crate) const SIGNIFICANCE: f64 = 0.01;

impl Verdict {
    /// Of a picture against a reference, all channels together, where either shows anything.
    pub(crate) fn of(found: &Shot, reference: &Shot) -> Self {
        assert_eq!(found.mean.len(), reference.mean.len(), "pictures of the same size");
        let is_lit = |&pixel: &usize| {
            [found, reference].iter().any(|shot| shot.mean[pixel].iter().any(|value| value.abs() > 1e-12))
        };
        let pixels: Vec<usize> = (0..found.mean.len()).filter(is_lit).collect();
        let count = pixels.len() * 3;
        let (mut worst, mut square, mut beyond) = (0.0_f64, 0.0, 0);
        let (mut sum, mut total, mut noise, mut squares) = (0.0, 0.0, 0.0, 0.0);
        let limit = limit(count);
        for pixel in pixels {
            // Channels of a pixel share their noise: the variance of their sum is at most the square of the sum of deviations.
            let mut deviations = 0.0;
            for channel in 0..3 {
                let [a, b] = [found, reference].map(|shot| shot.mean[pixel][channel]);
                let own = [found, reference].map(|shot| shot.variance[pixel][channel].max(0.0));
                let variance = own[0] + own[1] + (ROUNDING * b).powi(2) + 1e-14;
                let z = (a - b).abs() / variance.sqrt();
                worst = worst.max(z);
                beyond += usize::from(z > limit);
                square += z * z;
                sum += a - b;
                total += b;
                squares += (a - b).powi(2) - variance;
                deviations += variance.sqrt();
            }
            noise += deviations * deviations;
        }
        let n = count as f64;
        let root = |x: f64| x.signum() * x.abs().sqrt();
        Self {
            count,
            beyond,
            worst,
            square: square / n,
            bias: sum / total,
            bias_deviations: sum.abs() / noise.sqrt(),
            rmse: root(squares / n) / (total / n),
        }
    }
}

/// Standard deviations that one of so many numbers exceeds with a probability of [`SIGNIFICANCE`], on two sides (Sidak 1967).
pub(crate) fn limit(count: usize) -> f64 {
    let alpha = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / count as f64);
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if chi_square_tail(middle * middle, 1) > alpha { low = middle } else { high = middle }
    }
    high
}

#[test]
fn limits_are_those_of_the_normal_distribution() {
    // One number: 2.5758; 6912 of them: alpha = 1.454e-6, 4.817 (from the inverse of the error function).
    assert!((limit(1) - 2.5758).abs() < 1e-3, "{}", limit(1));
    assert!((limit(6912) - 4.817).abs() < 2e-3, "{}", limit(6912));
}
