//! All errors of a picture at once.

use super::flip::{self, Exposures, Viewing, Watch};
use super::{Errors, Metric, Pair};
use crate::error::Result;
use crate::image::Range;

/// How far a picture is from its reference, by every measure there is.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Means; none if no pixel counts.
    pub errors: Option<Errors>,
    /// The mean of `flip_map`; none if no pixel counts.
    pub flip: Option<f64>,
    /// FLIP of each pixel in [0, 1], by row from the top; NaN where a pixel does not count.
    pub flip_map: Vec<f32>,
    /// What FLIP was taken at; none for what a display shows, and where both pictures are black.
    pub exposures: Option<Exposures>,
}

impl Comparison {
    /// That of a pair. Light of a scene is looked at with the exposures of the reference, or of the picture if the
    /// reference is black.
    ///
    /// # Errors
    /// [`Interrupted`](crate::error::Error::Interrupted) if the one who watches says so.
    pub fn of(pair: &Pair, viewing: Viewing, watch: Watch<'_>) -> Result<Self> {
        let pictures = [pair.test(), pair.reference()];
        let exposures = match pair.range() {
            Range::Scene => Exposures::of(pair.reference()).or_else(|| Exposures::of(pair.test())),
            Range::Display => None,
        };
        let mut flip_map = match (pair.range(), &exposures) {
            (Range::Display, _) => flip::displayed(pictures, viewing, watch)?,
            (Range::Scene, Some(exposures)) => flip::exposed(pictures, viewing, exposures, watch)?,
            (Range::Scene, None) => vec![0.0; pair.counts().len()],
        };
        let flip = pair.mean(&flip_map);
        for (error, _) in flip_map.iter_mut().zip(pair.counts()).filter(|(_, counts)| !**counts) {
            *error = f32::NAN;
        }
        Ok(Self { errors: Errors::of(pair), flip, flip_map, exposures })
    }

    /// The number of a metric; none if no pixel counts.
    pub fn value(&self, metric: Metric) -> Option<f64> {
        match metric {
            Metric::Mse => self.errors.map(|errors| errors.mse),
            Metric::Rmse => self.errors.map(|errors| errors.rmse()),
            Metric::RelMse => self.errors.map(|errors| errors.relmse),
            Metric::Flip => self.flip,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Decoded, Image};
    use crate::math::Rgb;
    use crate::math::lanes::Level;
    use crate::render::Silent;

    fn compare(test: &Image, reference: &Image, range: Range) -> Comparison {
        let decoded = |image: &Image| Decoded { range, ..image.clone().into() };
        let pair = Pair::new(decoded(test), decoded(reference), ["a", "b"]).expect("one size");
        let watch = Watch { level: Level::best(), progress: &Silent };
        Comparison::of(&pair, Viewing::default(), watch).expect("nobody interrupts")
    }

    fn gradient(width: u32, height: u32) -> Image {
        let mut image = Image::new(width, height);
        for y in 0..height {
            for x in 0..width {
                let light = |n: u32| f32::from(u16::try_from(n % 97).expect("small")) / 60.0;
                image.set_pixel(x, y, Rgb::new(light(x * 3 + y), light(y * 5), light(x + 40)));
            }
        }
        image
    }

    #[test]
    fn equal_pictures_have_no_error_whatever_they_hold() {
        let mut odd = gradient(40, 30);
        odd.set_pixel(3, 3, Rgb::gray(-2.0));
        odd.set_pixel(4, 3, Rgb::gray(f32::MAX));
        odd.set_pixel(5, 3, Rgb::gray(f32::NAN));
        for image in [gradient(40, 30), odd, Image::new(20, 10)] {
            for range in [Range::Scene, Range::Display] {
                let same = compare(&image, &image, range);
                for metric in Metric::ALL {
                    let value = same.value(metric).expect("pixels").to_bits();
                    assert_eq!(value, 0.0_f64.to_bits(), "{range:?}: {}", metric.word());
                }
            }
        }
    }

    #[test]
    fn a_pixel_that_is_not_finite_changes_nothing_around_it() {
        let reference = gradient(60, 40);
        let mut test = reference.clone();
        test.set_pixel(10, 10, Rgb::gray(0.7));
        let before = compare(&test, &reference, Range::Scene);
        test.set_pixel(50, 30, Rgb::new(0.0, f32::NAN, f32::INFINITY));
        let after = compare(&test, &reference, Range::Scene);
        let at = 30 * 60 + 50;
        assert!(after.flip_map[at].is_nan(), "unknown: {}", after.flip_map[at]);
        for (i, (before, after)) in before.flip_map.iter().zip(&after.flip_map).enumerate() {
            assert!(i == at || before.to_bits() == after.to_bits(), "pixel {i}: {after} after {before}");
        }
        assert!(after.flip > before.flip && after.flip.is_some_and(|mean| mean < 0.1), "{:?}", after.flip);
        let (before, after) = (before.errors.expect("pixels"), after.errors.expect("pixels"));
        assert_eq!((before.pixels, after.pixels), (2400, 2399), "left out");
    }

    #[test]
    fn a_black_reference_is_compared_at_the_exposures_of_the_picture() {
        let mut test = Image::new(30, 20);
        test.set_pixel(7, 7, Rgb::gray(1e-3));
        let comparison = compare(&test, &Image::new(30, 20), Range::Scene);
        assert!(comparison.exposures.is_some(), "those of the picture");
        assert!(comparison.flip.is_some_and(|mean| mean > 0.0 && mean < 1.0), "{:?}", comparison.flip);
        let both = compare(&Image::new(9, 9), &Image::new(9, 9), Range::Scene);
        assert_eq!((both.flip, both.exposures), (Some(0.0), None), "nothing to see");
    }
}
