//! Errors as means over pixels and channels.
//!
//! Of linear light, whatever the file; PNG bytes are decoded first. With a for the picture and b for the reference:
//!
//! ```text
//! bias    mean(a - b)                 how much too bright; noise averages out
//! mae     mean |a - b|
//! mse     mean (a - b)^2              rmse its square root
//! relmse  mean (a - b)^2 / (b^2 + 0.01)
//! ```

use rayon::iter::{IndexedParallelIterator as _, ParallelIterator as _};
use rayon::slice::ParallelSlice as _;

use super::Pair;
use crate::film::RELATIVE_FLOOR;
use crate::math::Rgb;

/// One number that says how far a picture is from its reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Metric {
    /// Mean squared error.
    Mse,
    /// Its square root.
    Rmse,
    /// Mean squared error relative to the reference.
    RelMse,
    /// Mean of what an eye would notice.
    Flip,
}

impl Metric {
    /// All there are.
    pub const ALL: [Self; 4] = [Self::Mse, Self::Rmse, Self::RelMse, Self::Flip];

    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Mse => "mse",
            Self::Rmse => "rmse",
            Self::RelMse => "relmse",
            Self::Flip => "flip",
        }
    }

    /// The metric of that word.
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|metric| metric.word() == word)
    }
}

/// How far a picture is from its reference, over the pixels that count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// How many pixels count, at least one.
    pub pixels: u64,
    /// Mean difference: positive if the picture is too bright.
    pub bias: f64,
    /// Mean magnitude of the difference.
    pub mae: f64,
    /// Mean squared error.
    pub mse: f64,
    /// Mean squared error relative to the squared reference and [`RELATIVE_FLOOR`].
    pub relmse: f64,
    /// The pixel that is furthest off.
    pub largest: Largest,
}

/// The pixel with the greatest difference in any channel; the first one of several.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Largest {
    /// That difference, without sign.
    pub error: f64,
    /// Column and row in the whole picture.
    pub pixel: [u32; 2],
}

impl Errors {
    /// Those of a pair; none if no pixel counts.
    pub fn of(pair: &Pair) -> Option<Self> {
        let width = pair.window().width() as usize;
        let rows = pair.test().pixels().par_chunks(width).zip(pair.reference().pixels().par_chunks(width));
        let rows: Vec<Sums> = rows
            .zip(pair.counts().par_chunks(width))
            .map(|((test, reference), counts)| Sums::of(test, reference, counts))
            .collect();
        let mut total = Sums::default();
        for (row, sums) in (pair.window().y0..).zip(&rows) {
            total.add(sums, pair.window().x0, row);
        }
        total.means()
    }

    /// Root of the mean squared error.
    pub fn rmse(&self) -> f64 {
        self.mse.sqrt()
    }
}

/// Sums over pixels and channels.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    pixels: u64,
    difference: f64,
    magnitude: f64,
    square: f64,
    relative: f64,
    largest: Option<Largest>,
}

impl Sums {
    /// Over a row; columns count from its first pixel.
    fn of(test: &[Rgb<f32>], reference: &[Rgb<f32>], counts: &[bool]) -> Self {
        let mut sums = Self::default();
        for (column, ((&a, &b), _)) in
            (0..).zip(test.iter().zip(reference).zip(counts)).filter(|(_, (_, c))| **c)
        {
            let error = sums.add_pixel(a.into(), b.into());
            if sums.largest.is_none_or(|largest| error > largest.error) {
                sums.largest = Some(Largest { error, pixel: [column, 0] });
            }
        }
        sums
    }

    /// The greatest difference of the pixel.
    fn add_pixel(&mut self, a: [f32; 3], b: [f32; 3]) -> f64 {
        self.pixels += 1;
        let mut greatest = 0.0_f64;
        for (a, b) in a.into_iter().zip(b) {
            let (a, b) = (f64::from(a), f64::from(b));
            let difference = a - b;
            self.difference += difference;
            self.magnitude += difference.abs();
            self.square += difference * difference;
            self.relative += difference * difference / (b * b + RELATIVE_FLOOR);
            greatest = greatest.max(difference.abs());
        }
        greatest
    }

    /// Adds a row whose first pixel is at `x` and `y`.
    fn add(&mut self, row: &Self, x: u32, y: u32) {
        self.pixels += row.pixels;
        self.difference += row.difference;
        self.magnitude += row.magnitude;
        self.square += row.square;
        self.relative += row.relative;
        if let Some(Largest { error, pixel: [column, _] }) = row.largest
            && self.largest.is_none_or(|largest| error > largest.error)
        {
            self.largest = Some(Largest { error, pixel: [x + column, y] });
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 pixels")]
    fn means(&self) -> Option<Errors> {
        let largest = self.largest?;
        let count = 3.0 * self.pixels as f64;
        Some(Errors {
            pixels: self.pixels,
            bias: self.difference / count,
            mae: self.magnitude / count,
            mse: self.square / count,
            relmse: self.relative / count,
            largest,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Decoded, Image, Window};

    /// Two pictures of that width that lie at (10, 20) in a larger one.
    fn pair(width: u32, test: &[Rgb<f32>], reference: &[Rgb<f32>]) -> Pair {
        let height = u32::try_from(test.len()).expect("few") / width;
        let decoded = |pixels: &[Rgb<f32>]| Decoded {
            window: Window { x0: 10, y0: 20, x1: 10 + width, y1: 20 + height },
            full: [100, 100],
            ..Image::from_pixels(width, height, pixels.to_vec()).expect("whole rows").into()
        };
        Pair::new(decoded(test), decoded(reference), ["a", "b"]).expect("one size")
    }

    fn near(what: &str, found: f64, wanted: f64) {
        assert!((found - wanted).abs() <= 1e-12 * wanted.abs(), "{what}: {found} instead of {wanted}");
    }

    #[test]
    fn a_constant_difference_has_known_errors() {
        let errors = Errors::of(&pair(5, &[Rgb::gray(1.5); 10], &[Rgb::gray(2.0); 10])).expect("pixels");
        near("bias", errors.bias, -0.5);
        near("mae", errors.mae, 0.5);
        near("mse", errors.mse, 0.25);
        near("rmse", errors.rmse(), 0.5);
        near("relmse", errors.relmse, 0.25 / 4.01);
        assert_eq!(errors.pixels, 10, "pixels");
        assert_eq!(errors.largest, Largest { error: 0.5, pixel: [10, 20] }, "the first of equals");
    }

    #[test]
    fn channels_count_alike_and_signs_cancel_in_the_bias_only() {
        let test = [Rgb::new(1.0, 0.0, 0.0), Rgb::new(0.0, -1.0, 3.0)];
        let errors = Errors::of(&pair(1, &test, &[Rgb::BLACK; 2])).expect("pixels");
        near("bias", errors.bias, 3.0 / 6.0);
        near("mae", errors.mae, 5.0 / 6.0);
        near("mse", errors.mse, 11.0 / 6.0);
        near("relmse against black", errors.relmse, 1100.0 / 6.0);
        assert_eq!(errors.largest, Largest { error: 3.0, pixel: [10, 21] }, "in the second row");
    }

    #[test]
    fn equal_pictures_have_no_error_at_all() {
        let pixels: Vec<_> = (0..60_u16).map(|i| Rgb::gray(f32::from(i) * 0.37 - 3.0)).collect();
        let errors = Errors::of(&pair(6, &pixels, &pixels)).expect("pixels");
        let all = [errors.bias, errors.mae, errors.mse, errors.rmse(), errors.relmse, errors.largest.error];
        assert!(all.iter().all(|e| e.to_bits() == 0), "{errors:?}");
    }

    #[test]
    fn what_is_not_finite_is_left_out_and_huge_numbers_do_not_overflow() {
        let test = [Rgb::gray(f32::NAN), Rgb::gray(f32::MAX), Rgb::gray(f32::INFINITY)];
        let errors = Errors::of(&pair(3, &test, &[Rgb::BLACK; 3])).expect("a pixel");
        near("mse", errors.mse, f64::from(f32::MAX).powi(2));
        assert_eq!((errors.pixels, errors.largest.pixel), (1, [11, 20]), "the one that counts");
        assert_eq!(Errors::of(&pair(1, &test[..1], &test[..1])), None, "no pixel");
    }

    #[test]
    fn words_are_unique() {
        for metric in Metric::ALL {
            assert_eq!(Metric::of(metric.word()), Some(metric), "{metric:?}");
        }
    }
}
