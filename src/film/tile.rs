//! The samples of a part of a picture, summed pixel by pixel.

use super::aov::{Aov, Layout};
use super::shares::{Seen, Shares};
use super::statistics::{NonFinite, SampleId};
use crate::image::Window;
use std::ops::AddAssign;

/// The samples of a rectangle of pixels, summed in double precision.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    pub(super) window: Window,
    pub(super) layout: Layout,
    /// Samples of each pixel.
    pub(super) counts: Vec<u32>,
    /// Sums of weights.
    pub(super) weights: Vec<f64>,
    /// Sums of values, `layout.len()` for each pixel.
    pub(super) plain: Vec<f64>,
    /// Sums of weight times value, likewise.
    pub(super) weighted: Vec<f64>,
    /// Where variance is kept.
    pub(super) squares: Vec<Squares>,
    /// Where numbers of things are kept.
    pub(super) shares: Vec<Shares>,
    pub(super) non_finite: NonFinite,
}

/// Sums of squares of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Squares {
    /// Of weights.
    weights: f64,
    /// Of weights, times radiance.
    once: [f64; 3],
    /// Of weights, times the square of radiance.
    twice: [f64; 3],
}

impl Squares {
    /// All seven sums.
    pub(super) fn to_array(self) -> [f64; 7] {
        let Self { weights, once: [a, b, c], twice: [d, e, f] } = self;
        [weights, a, b, c, d, e, f]
    }

    /// With those seven sums.
    pub(super) fn of_array([weights, a, b, c, d, e, f]: [f64; 7]) -> Self {
        Self { weights, once: [a, b, c], twice: [d, e, f] }
    }

    fn add(&mut self, weight: f64, radiance: &[f32]) {
        let square = weight * weight;
        self.weights += square;
        for (i, &value) in radiance.iter().enumerate().take(3) {
            let value = f64::from(value);
            self.once[i] += square * value;
            self.twice[i] += square * value * value;
        }
    }

    /// The mean of the squares of weight times distance of radiance from `mean`.
    pub(super) fn about(&self, i: usize, mean: f64, count: f64) -> f64 {
        (self.twice[i] - 2.0 * mean * self.once[i] + mean * mean * self.weights) / count
    }
}

impl AddAssign for Squares {
    fn add_assign(&mut self, more: Self) {
        self.weights += more.weights;
        for i in 0..3 {
            self.once[i] += more.once[i];
            self.twice[i] += more.twice[i];
        }
    }
}

impl Tile {
    /// No samples yet in that part of the picture.
    pub fn new(window: Window, layout: Layout) -> Self {
        let (pixels, values) = (window.area(), window.area() * layout.len());
        let squares = if layout.has(Aov::Variance) { pixels } else { 0 };
        let shares = if layout.has_ids() { pixels } else { 0 };
        Self {
            window,
            squares: vec![Squares::default(); squares],
            shares: vec![Shares::default(); shares],
            layout,
            counts: vec![0; pixels],
            weights: vec![0.0; pixels],
            plain: vec![0.0; values],
            weighted: vec![0.0; values],
            non_finite: NonFinite::default(),
        }
    }

    /// Which pixels.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Adds a sample: its filter weight and its values in the order of the layout. Samples of one pixel are to be added in
    /// the order of their indices, for sums that are the same to the last bit. One with a value that is not finite counts
    /// as black and is recorded.
    ///
    /// # Panics
    /// For a pixel outside of the window, or another number of values than the layout says.
    pub fn add(&mut self, sample: SampleId, weight: f32, values: &[f32]) {
        assert_eq!(values.len(), self.layout.len(), "values of a sample");
        let pixel = self.place(sample);
        let weight = f64::from(weight);
        self.counts[pixel] += 1;
        self.weights[pixel] += weight;
        let finite = values.iter().all(|value| value.is_finite());
        if let (Some(squares), Some(at)) = (self.squares.get_mut(pixel), self.layout.offset(Aov::Beauty)) {
            squares.add(weight, if finite { &values[at..at + 3] } else { &[0.0; 3] });
        }
        if !finite {
            self.non_finite.record(sample);
            return;
        }
        let range = pixel * values.len()..(pixel + 1) * values.len();
        let sums = self.plain[range.clone()].iter_mut().zip(&mut self.weighted[range]);
        for ((plain, weighted), &value) in sums.zip(values) {
            *plain += f64::from(value);
            *weighted += weight * f64::from(value);
        }
    }

    /// Adds samples of one pixel, from `first` on, their values one after the other: the same as [`Tile::add`] for each, and
    /// faster where nothing but picture and coverage is kept.
    ///
    /// # Panics
    /// For a pixel outside of the window, or another number of values than the layout says.
    pub fn add_run(&mut self, first: SampleId, weights: &[f32], values: &[f32]) {
        const N: usize = 4;
        let len = self.layout.len();
        assert_eq!(values.len(), weights.len() * len, "values of samples");
        if len != N || !self.squares.is_empty() {
            for ((index, &weight), values) in (first.index..).zip(weights).zip(values.chunks_exact(len)) {
                self.add(SampleId { index, ..first }, weight, values);
            }
            return;
        }
        let pixel = self.place(first);
        let range = pixel * N..(pixel + 1) * N;
        let (mut plain, mut weighted) = ([0.0; N], [0.0; N]);
        plain.copy_from_slice(&self.plain[range.clone()]);
        weighted.copy_from_slice(&self.weighted[range.clone()]);
        for ((index, &weight), values) in (first.index..).zip(weights).zip(values.as_chunks::<N>().0) {
            let weight = f64::from(weight);
            self.counts[pixel] += 1;
            self.weights[pixel] += weight;
            if !values.iter().all(|value| value.is_finite()) {
                self.non_finite.record(SampleId { index, ..first });
                continue;
            }
            for i in 0..N {
                plain[i] += f64::from(values[i]);
                weighted[i] += weight * f64::from(values[i]);
            }
        }
        self.plain[range.clone()].copy_from_slice(&plain);
        self.weighted[range].copy_from_slice(&weighted);
    }

    /// Notes what a sample of that filter weight shows, where numbers of things are kept. To be told once for each sample that shows
    /// something, in their order.
    ///
    /// # Panics
    /// For a pixel outside of the window.
    pub fn see(&mut self, sample: SampleId, weight: f32, seen: Seen) {
        let pixel = self.place(sample);
        if let Some(shares) = self.shares.get_mut(pixel) {
            shares.add(weight.into(), seen);
        }
    }

    /// Takes over `width` pixels of another tile.
    pub(super) fn copy_row(&mut self, to: usize, other: &Self, from: usize, width: usize) {
        let values = self.layout.len();
        copy(&mut self.counts, to, &other.counts, from, width);
        copy(&mut self.weights, to, &other.weights, from, width);
        copy(&mut self.plain, to * values, &other.plain, from * values, width * values);
        copy(&mut self.weighted, to * values, &other.weighted, from * values, width * values);
        if !self.squares.is_empty() {
            copy(&mut self.squares, to, &other.squares, from, width);
        }
        if !self.shares.is_empty() {
            self.shares[to..to + width].clone_from_slice(&other.shares[from..from + width]);
        }
    }

    /// Value number `value` of a pixel; zero where there are no samples.
    #[expect(clippy::cast_possible_truncation, reason = "sums are rounded to the precision of pictures")]
    pub(super) fn value(&self, pixel: usize, value: usize) -> f32 {
        if self.counts[pixel] == 0 {
            return 0.0;
        }
        let (count, at) = (f64::from(self.counts[pixel]), pixel * self.layout.len() + value);
        let (weighted, plain) = (self.weighted[at] / count, self.plain[at] / count);
        (weighted + (1.0 - self.weights[pixel] / count) * plain) as f32
    }

    /// Radiance and coverage of each pixel by row, as files have them; black where there are no samples, all covered where that is not kept.
    pub fn shown(&self) -> Vec<[f32; 4]> {
        let [beauty, alpha] = [Aov::Beauty, Aov::Alpha].map(|aov| self.layout.offset(aov));
        let shown = |pixel: usize| {
            let [r, g, b] = [0, 1, 2].map(|i| beauty.map_or(0.0, |at| self.value(pixel, at + i)));
            [r, g, b, alpha.map_or(1.0, |at| self.value(pixel, at).clamp(0.0, 1.0))]
        };
        (0..self.counts.len()).map(shown).collect()
    }

    /// The number of a sample's pixel.
    fn place(&self, sample: SampleId) -> usize {
        assert!(self.window.contains(sample.x, sample.y), "{sample:?} outside of {:?}", self.window);
        let (x, y) = (sample.x - self.window.x0, sample.y - self.window.y0);
        y as usize * self.window.width() as usize + x as usize
    }
}

/// Takes over `len` values, from one place to another.
fn copy<T: Copy>(to: &mut [T], at: usize, from: &[T], start: usize, len: usize) {
    to[at..at + len].copy_from_slice(&from[start..start + len]);
}
