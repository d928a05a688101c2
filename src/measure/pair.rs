//! A picture and its reference, checked to belong together.
//!
//! A pixel that is not finite in either has no error: it is counted, and left out of all that follows. So that filters do
//! not spread it, it is replaced in both pictures by the same colour.

use crate::error::{Problem, Result};
use crate::image::{Decoded, Image, Range, Window};
use crate::math::Rgb;

/// A picture and its reference: of one size and range, all of their light finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    test: Image,
    reference: Image,
    /// Whether the pixel is to be compared.
    counts: Vec<bool>,
    range: Range,
    window: Window,
    full: [u32; 2],
    non_finite: [u64; 2],
}

impl Pair {
    /// `test` against `reference`; their names are for messages. Alpha is ignored.
    ///
    /// # Errors
    /// A [`Problem`] if their sizes, windows or ranges differ.
    pub fn new(test: Decoded, reference: Decoded, names: [&str; 2]) -> Result<Self> {
        check(&test, &reference, names)?;
        let Decoded { range, window, full, .. } = reference;
        let (mut test, mut reference) = (test.image, reference.image);
        let mut non_finite = [0, 0];
        let pixels = test.pixels_mut().iter_mut().zip(reference.pixels_mut());
        let counts = pixels.map(|(a, b)| keep_finite(a, b, &mut non_finite)).collect();
        Ok(Self { test, reference, counts, range, window, full, non_finite })
    }

    /// The picture that is judged; zero or the reference's colour where a pixel does not count.
    pub fn test(&self) -> &Image {
        &self.test
    }

    /// The picture that it should be.
    pub fn reference(&self) -> &Image {
        &self.reference
    }

    /// Whether each pixel counts: it is finite in both.
    pub fn counts(&self) -> &[bool] {
        &self.counts
    }

    /// What the numbers of both stand for.
    pub fn range(&self) -> Range {
        self.range
    }

    /// Where both lie in the whole picture.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Width and height of the whole picture.
    pub fn full(&self) -> [u32; 2] {
        self.full
    }

    /// How many pixels of the picture and of the reference are not finite.
    pub fn non_finite(&self) -> [u64; 2] {
        self.non_finite
    }

    /// The mean of a number for each pixel over those that count; none if none does.
    ///
    /// # Panics
    /// If there is not one number for each pixel.
    pub fn mean(&self, values: &[f32]) -> Option<f64> {
        assert_eq!(values.len(), self.counts.len(), "one number for each pixel");
        let counted = values.iter().zip(&self.counts).filter(|(_, counts)| **counts);
        let (sum, count) =
            counted.fold((0.0, 0_u32), |(sum, count), (&value, _)| (sum + f64::from(value), count + 1));
        (count > 0).then(|| sum / f64::from(count))
    }
}

/// Whether both are finite; else they are counted and made equal.
fn keep_finite(a: &mut Rgb<f32>, b: &mut Rgb<f32>, non_finite: &mut [u64; 2]) -> bool {
    let finite = [a.is_finite(), b.is_finite()];
    non_finite[0] += u64::from(!finite[0]);
    non_finite[1] += u64::from(!finite[1]);
    match finite {
        [true, true] => return true,
        [false, true] => *a = *b,
        [true, false] => *b = *a,
        [false, false] => (*a, *b) = (Rgb::BLACK, Rgb::BLACK),
    }
    false
}

/// Refuses pictures that do not belong together.
fn check(test: &Decoded, reference: &Decoded, [a, b]: [&str; 2]) -> Result<()> {
    let refuse = |what: String, remedy: &str| {
        Err(Problem::new(format!("cannot compare: {what}")).remedy(remedy).into())
    };
    if test.range != reference.range {
        let [a, b] = [(a, test.range), (b, reference.range)].map(|(name, range)| match range {
            Range::Scene => format!("`{name}` holds light of a scene"),
            Range::Display => format!("`{name}` holds what a display shows"),
        });
        let remedy =
            "a preview has lost what exposure and tone curve did; compare two .exr or .hdr, or two .png";
        return refuse(format!("{a}, {b}"), remedy);
    }
    if test.full != reference.full {
        let [a, b] = [(a, test.full), (b, reference.full)]
            .map(|(name, [width, height])| format!("`{name}` has {width} by {height} pixels"));
        return refuse(format!("{a}, {b}"), "render both at one size");
    }
    if test.window != reference.window {
        let [a, b] = [(a, test.window), (b, reference.window)].map(|(name, window)| {
            let Window { x0, y0, x1, y1 } = window;
            format!("`{name}` holds the pixels {x0},{y0},{x1},{y1}")
        });
        return refuse(format!("{a}, {b}"), "render both with the same crop, or none");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(pixels: &[Rgb<f32>]) -> Decoded {
        let width = u32::try_from(pixels.len()).expect("few");
        Image::from_pixels(width, 1, pixels.to_vec()).expect("one row").into()
    }

    #[test]
    fn pixels_that_are_not_finite_are_counted_and_made_equal() {
        let (odd, plain) = (Rgb::new(1.0, f32::NAN, 0.0), Rgb::new(1.0, 2.0, 3.0));
        let infinite = Rgb::new(f32::INFINITY, 0.0, 0.0);
        let test = decoded(&[plain, odd, plain, infinite]);
        let reference = decoded(&[plain, plain, infinite, odd]);
        let pair = Pair::new(test, reference, ["a", "b"]).expect("one size");
        assert_eq!(pair.counts(), [true, false, false, false], "which count");
        assert_eq!(pair.non_finite(), [2, 2], "how many do not");
        assert_eq!(pair.test(), pair.reference(), "no difference where none is known");
        assert_eq!(pair.test().pixels(), [plain, plain, plain, Rgb::BLACK], "colours");
        assert_eq!(pair.mean(&[0.5, 9.0, 9.0, 9.0]), Some(0.5), "left out of means");
    }

    #[test]
    fn no_pixel_has_no_mean() {
        let nan = decoded(&[Rgb::gray(f32::NAN)]);
        let pair = Pair::new(nan.clone(), nan, ["a", "b"]).expect("one size");
        assert_eq!(pair.mean(&[0.0]), None, "nothing counts");
    }

    #[test]
    fn what_does_not_belong_together_is_refused_and_both_are_named() {
        let plain = decoded(&[Rgb::WHITE; 6]);
        let wide = decoded(&[Rgb::WHITE; 7]);
        let moved = Decoded { window: Window { x0: 1, y0: 0, x1: 7, y1: 1 }, full: [7, 1], ..plain.clone() };
        let still = Decoded { window: Window::whole(6, 1), full: [7, 1], ..plain.clone() };
        let shown = Decoded { range: Range::Display, ..plain.clone() };
        let message = |a: &Decoded, b: &Decoded| {
            Pair::new(a.clone(), b.clone(), ["a.exr", "b.exr"]).expect_err("refused").to_string()
        };
        let sizes = message(&plain, &wide);
        assert!(sizes.contains("`a.exr` has 6 by 1 pixels, `b.exr` has 7 by 1 pixels; "), "{sizes}");
        let windows = message(&moved, &still);
        assert!(windows.contains("pixels 1,0,7,1, `b.exr` holds the pixels 0,0,6,1; "), "{windows}");
        let ranges = message(&shown, &plain);
        assert!(
            ranges.contains("`a.exr` holds what a display shows, `b.exr` holds light of a scene; "),
            "{ranges}"
        );
        assert!(Pair::new(moved.clone(), moved, ["a", "b"]).is_ok(), "the same crop");
    }
}
