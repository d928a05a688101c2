//! Sums of samples, pixel by pixel, and the pixels made of them.
//!
//! With weights w of mean 1 and values L, a pixel is mean(w L) + (1 - mean(w)) mean(L): the filter's estimate with the
//! weights themselves as control variate. A flat area comes out flat, nothing is divided by weights that may cancel, and
//! for filters whose weights are all 1 it is the mean. Over 20 000 pixels of a tilted edge, stratified, Mitchell filter,
//! the root mean square error was 0.201 at 4 samples and 0.087 at 16; of sum(w L) / sum(w) 0.265 (2 % of the pixels without
//! a value) and 0.097; of mean(w L) 0.235 and 0.104. All are the same in the limit.
//! Owen, 2013, "Monte Carlo theory, methods and examples", section 8.9, for control variates of known mean.

use super::aov::{Aov, Layout};
use super::statistics::{NonFinite, SampleId};
use crate::image::exr::{Channel, Picture, Samples};
use crate::image::{Image, Window};
use crate::math::Rgb;

/// The samples of a rectangle of pixels, summed in double precision.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    window: Window,
    layout: Layout,
    /// Samples of each pixel.
    counts: Vec<u32>,
    /// Sums of weights.
    weights: Vec<f64>,
    /// Sums of values, `layout.len()` for each pixel.
    plain: Vec<f64>,
    /// Sums of weight times value, likewise.
    weighted: Vec<f64>,
    /// Where variance is kept.
    squares: Vec<Squares>,
    non_finite: NonFinite,
}

/// Sums of squares of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Squares {
    /// Of weights.
    weights: f64,
    /// Of weights, times radiance.
    once: [f64; 3],
    /// Of weights, times the square of radiance.
    twice: [f64; 3],
}

impl Squares {
    fn add(&mut self, weight: f64, radiance: &[f32]) {
        let square = weight * weight;
        self.weights += square;
        for (i, &value) in radiance.iter().enumerate().take(3) {
            let value = f64::from(value);
            self.once[i] += square * value;
            self.twice[i] += square * value * value;
        }
    }

    fn merge(&mut self, other: &Self) {
        self.weights += other.weights;
        add_all(&mut self.once, &other.once);
        add_all(&mut self.twice, &other.twice);
    }

    /// The mean of the squares of weight times distance of radiance from `mean`.
    fn about(&self, i: usize, mean: f64, count: f64) -> f64 {
        (self.twice[i] - 2.0 * mean * self.once[i] + mean * mean * self.weights) / count
    }
}

impl Tile {
    /// No samples yet in that part of the picture.
    pub fn new(window: Window, layout: Layout) -> Self {
        let (pixels, values) = (window.area(), window.area() * layout.len());
        let squares = if layout.has(Aov::Variance) { pixels } else { 0 };
        Self {
            window,
            squares: vec![Squares::default(); squares],
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

    /// Takes over `width` pixels of another tile.
    fn copy_row(&mut self, to: usize, other: &Self, from: usize, width: usize) {
        let values = self.layout.len();
        copy(&mut self.counts, to, &other.counts, from, width);
        copy(&mut self.weights, to, &other.weights, from, width);
        copy(&mut self.plain, to * values, &other.plain, from * values, width * values);
        copy(&mut self.weighted, to * values, &other.weighted, from * values, width * values);
        if !self.squares.is_empty() {
            copy(&mut self.squares, to, &other.squares, from, width);
        }
    }

    /// The number of a sample's pixel.
    fn place(&self, sample: SampleId) -> usize {
        assert!(self.window.contains(sample.x, sample.y), "{sample:?} outside of {:?}", self.window);
        let (x, y) = (sample.x - self.window.x0, sample.y - self.window.y0);
        y as usize * self.window.width() as usize + x as usize
    }
}

/// The sums of a whole picture, or of a crop of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    full: [u32; 2],
    sums: Tile,
}

/// How an EXR file stores colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 16-bit floats: half the size, eleven bits.
    Half,
    /// 32-bit floats.
    #[default]
    Float,
}

impl Film {
    /// A film of the part `window` of a picture of `full` width and height.
    pub fn new(full: [u32; 2], window: Window, layout: Layout) -> Self {
        debug_assert!(window.fits(full[0], full[1]), "{window:?} in {full:?}");
        Self { full, sums: Tile::new(window, layout) }
    }

    /// Width and height of the whole picture.
    pub fn full(&self) -> [u32; 2] {
        self.full
    }

    /// The pixels that are there.
    pub fn window(&self) -> Window {
        self.sums.window
    }

    /// What is kept of each sample.
    pub fn layout(&self) -> &Layout {
        &self.sums.layout
    }

    /// Samples that were dropped.
    pub fn non_finite(&self) -> &NonFinite {
        &self.sums.non_finite
    }

    /// Samples taken, dropped ones included.
    pub fn samples(&self) -> u64 {
        self.sums.counts.iter().map(|&count| u64::from(count)).sum()
    }

    /// The samples of the pixel that has fewest, and of that which has most.
    pub fn samples_of_pixels(&self) -> [u32; 2] {
        let counts = || self.sums.counts.iter().copied();
        [counts().min().unwrap_or(0), counts().max().unwrap_or(0)]
    }

    /// The sums of a part, for more samples to be added to them: then the sums are to the bit those of all samples added in one
    /// go. What was dropped stays with the film.
    ///
    /// # Panics
    /// If the part reaches beyond the film.
    pub fn part(&self, window: Window) -> Tile {
        let mut tile = Tile::new(window, self.sums.layout.clone());
        for (here, there, width) in self.rows(window) {
            tile.copy_row(there, &self.sums, here, width);
        }
        tile
    }

    /// Puts back a part to which samples have been added.
    ///
    /// # Panics
    /// If the part reaches beyond the film or has another layout.
    pub fn put(&mut self, tile: &Tile) {
        assert_eq!(self.sums.layout, tile.layout, "layout of a tile");
        for (here, there, width) in self.rows(tile.window) {
            self.sums.copy_row(here, tile, there, width);
        }
        self.sums.non_finite.merge(&tile.non_finite);
    }

    /// Where each row of a part begins in the film and in the part, and how long it is.
    fn rows(&self, part: Window) -> impl Iterator<Item = (usize, usize, usize)> + use<> {
        let whole = self.sums.window;
        assert!(
            whole.x0 <= part.x0 && whole.y0 <= part.y0 && part.fits(whole.x1, whole.y1),
            "tile {part:?} beyond film {whole:?}"
        );
        let (width, stride) = (part.width() as usize, whole.width() as usize);
        (0..part.height() as usize).map(move |row| {
            let here = (row + (part.y0 - whole.y0) as usize) * stride + (part.x0 - whole.x0) as usize;
            (here, row * width, width)
        })
    }

    /// Adds the sums of a tile. Bit for bit the same in whatever order tiles come, as long as no two share a pixel.
    ///
    /// # Panics
    /// If the tile reaches beyond the film or has another layout.
    pub fn add(&mut self, tile: &Tile) {
        assert_eq!(self.sums.layout, tile.layout, "layout of a tile");
        let values = tile.layout.len();
        for (target, source, width) in self.rows(tile.window) {
            add_all(&mut self.sums.counts[target..target + width], &tile.counts[source..source + width]);
            add_all(&mut self.sums.weights[target..target + width], &tile.weights[source..source + width]);
            if !tile.squares.is_empty() {
                let squares = &tile.squares[source..source + width];
                self.sums.squares[target..target + width]
                    .iter_mut()
                    .zip(squares)
                    .for_each(|(a, b)| a.merge(b));
            }
            let (target, source, width) = (target * values, source * values, width * values);
            add_all(&mut self.sums.plain[target..target + width], &tile.plain[source..source + width]);
            add_all(&mut self.sums.weighted[target..target + width], &tile.weighted[source..source + width]);
        }
        self.sums.non_finite.merge(&tile.non_finite);
    }

    /// Value number `value` of each pixel by row; zero where there are no samples.
    #[expect(clippy::cast_possible_truncation, reason = "sums are rounded to the precision of pictures")]
    fn resolve(&self, value: usize) -> Vec<f32> {
        let (sums, step) = (&self.sums, self.sums.layout.len());
        let pixels = sums.counts.iter().zip(&sums.weights).enumerate();
        let resolved = pixels.map(|(pixel, (&count, &weight))| {
            if count == 0 {
                return 0.0;
            }
            let (count, at) = (f64::from(count), pixel * step + value);
            let (weighted, plain) = (sums.weighted[at] / count, sums.plain[at] / count);
            (weighted + (1.0 - weight / count) * plain) as f32
        });
        resolved.collect()
    }

    /// Value number `value` of each pixel by row as a mean over the samples that hit something, unfiltered; zero where none did.
    #[expect(clippy::cast_possible_truncation, reason = "sums are rounded to the precision of pictures")]
    fn of_hits(&self, value: usize) -> Vec<f32> {
        let (sums, step) = (&self.sums, self.sums.layout.len());
        let alpha = sums.layout.offset(Aov::Alpha);
        let of = |pixel: usize| {
            let hits = alpha.map_or(f64::from(sums.counts[pixel]), |alpha| sums.plain[pixel * step + alpha]);
            if hits > 0.0 { (sums.plain[pixel * step + value] / hits) as f32 } else { 0.0 }
        };
        (0..sums.counts.len()).map(of).collect()
    }

    /// The variance of each pixel's radiance, channel `i`; zero of a single sample, which says nothing.
    #[expect(clippy::cast_possible_truncation, reason = "sums are rounded to the precision of pictures")]
    fn variance(&self, i: usize) -> Vec<f32> {
        let (sums, step) = (&self.sums, self.sums.layout.len());
        let Some(offset) = sums.layout.offset(Aov::Beauty) else { return vec![0.0; sums.counts.len()] };
        let of = |pixel: usize| {
            let (count, at) = (f64::from(sums.counts[pixel]), pixel * step + offset + i);
            if count < 2.0 {
                return 0.0;
            }
            // Weights times distances from the plain mean: what the estimate varies by.
            let mean = sums.plain[at] / count;
            let first = (sums.weighted[at] - mean * sums.weights[pixel]) / count;
            let second = sums.squares.get(pixel).map_or(0.0, |squares| squares.about(i, mean, count));
            ((second - first * first).max(0.0) / (count - 1.0)) as f32
        };
        (0..sums.counts.len()).map(of).collect()
    }

    /// The channels of an output; none if it is not kept.
    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^24 samples a pixel")]
    pub fn channels(&self, aov: Aov) -> Option<Vec<Vec<f32>>> {
        let offset = self.sums.layout.offset(aov)?;
        let channels = 0..aov.channels().len();
        let mut channels: Vec<_> = match aov {
            Aov::Variance => channels.map(|channel| self.variance(channel)).collect(),
            Aov::Samples => vec![self.sums.counts.iter().map(|&count| count as f32).collect()],
            _ if aov.is_of_hits() => channels.map(|channel| self.of_hits(offset + channel)).collect(),
            _ => channels.map(|channel| self.resolve(offset + channel)).collect(),
        };
        if aov.is_fraction() {
            channels.iter_mut().flatten().for_each(|x| *x = x.clamp(0.0, 1.0));
        }
        Some(channels)
    }

    /// The picture; black if it is not kept.
    pub fn image(&self) -> Image {
        let (width, height) = (self.window().width(), self.window().height());
        let mut image = Image::new(width, height);
        if let Some([r, g, b]) = self.channels(Aov::Beauty).as_deref() {
            let colours = r.iter().zip(g).zip(b).map(|((&r, &g), &b)| Rgb::new(r, g, b));
            image.pixels_mut().iter_mut().zip(colours).for_each(|(pixel, colour)| *pixel = colour);
        }
        image
    }

    /// All that is kept, for an EXR file with that metadata.
    pub fn picture(&self, precision: Precision, attributes: Vec<(String, String)>) -> Picture {
        let channels = self.sums.layout.aovs().iter().flat_map(|&aov| {
            aov.channels().iter().zip(self.channels(aov).into_iter().flatten()).map(|(name, values)| {
                Channel {
                    name: (*name).to_owned(),
                    samples: match precision {
                        Precision::Half => Samples::Half(values),
                        Precision::Float => Samples::Float(values),
                    },
                }
            })
        });
        let channels = channels.collect();
        Picture { full: self.full, window: self.window(), channels, attributes, warnings: Vec::new() }
    }
}

/// Takes over `len` values, from one place to another.
fn copy<T: Copy>(to: &mut [T], at: usize, from: &[T], start: usize, len: usize) {
    to[at..at + len].copy_from_slice(&from[start..start + len]);
}

/// Adds each of `terms` to its sum.
fn add_all<T: Copy + std::ops::AddAssign>(sums: &mut [T], terms: &[T]) {
    sums.iter_mut().zip(terms).for_each(|(sum, &term)| *sum += term);
}

#[cfg(test)]
#[path = "sums_tests.rs"]
mod tests;
