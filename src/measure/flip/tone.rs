//! From scene light to a display: the exposures of HDR-FLIP.
//!
//! One exposure shows only a part of what a picture holds. HDR-FLIP goes from the darkest exposure that shows anything of
//! the highlights to the one that makes half of the picture bright, in steps of at most one stop, and takes the greatest
//! error. Andersson et al., 2021, "Visualizing errors in rendered high dynamic range images", section 4.

use crate::image::Image;
use crate::math::Rgb;
use crate::math::lanes::Lanes;

/// The curve (a x^2 + b x) / (c x^2 + d x + e) that the paper takes: the fit of the ACES reference rendering by
/// Narkowicz, 2015, "ACES filmic tone mapping curve", without its exposure of 0.6^-1.
const CURVE: [f32; 5] = [0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14];

/// What counts as bright on the display: section 4.1.
const BRIGHT: f64 = 0.85;

/// Far above the 12 where the curve reaches white, and far below where squares overflow.
const BRIGHTEST: f32 = 1e4;

/// How light becomes what a display shows, in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tone {
    /// As it is, cut at 0 and 1.
    Clip,
    /// Multiplied by this, then through the curve; negative light is black.
    Curve(f32),
}

impl Tone {
    #[inline(always)]
    pub(super) fn apply<F: Lanes>(self, light: Rgb<F>) -> Rgb<F> {
        match self {
            Self::Clip => light.clamp(0.0, 1.0),
            Self::Curve(gain) => {
                Rgb::new(curve(light.r * gain), curve(light.g * gain), curve(light.b * gain))
            }
        }
    }
}

#[inline(always)]
fn curve<F: Lanes>(x: F) -> F {
    let [a, b, c, d, e] = CURVE;
    let x = x.clamp(0.0, BRIGHTEST);
    (x * (x * a + b) / (x * (x * c + d) + e)).min(x.splat(1.0))
}

/// The exposures that two pictures are compared at, evenly spaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The first: light is multiplied by 2 to this power.
    pub start: f64,
    /// The last.
    pub stop: f64,
    /// How many, at least 2.
    pub count: u32,
}

impl Exposures {
    /// Those that bring first the greatest, last the median luminance of `reference` to 0.85 of the display's white.
    ///
    /// None if no pixel of it is above zero. Where most of it is black (the paper leaves that open) the median is that of
    /// the pixels above zero.
    pub fn of(reference: &Image) -> Option<Self> {
        let mut luminances: Vec<f32> =
            reference.pixels().iter().map(|p| p.luminance()).map(|y| if y > 0.0 { y } else { 0.0 }).collect();
        let greatest = luminances.iter().copied().fold(0.0, f32::max);
        let mut median = middle(&mut luminances)?;
        if median <= 0.0 {
            luminances.retain(|&y| y > 0.0);
            median = middle(&mut luminances)?;
        }
        let bright = bright();
        let start = (bright / f64::from(greatest)).log2();
        let stop = (bright / f64::from(median)).log2();
        // The number of stops in one step: the difference of two logarithms may be a little above a whole number.
        let stops = (f64::from(greatest) / f64::from(median)).log2();
        Some(Self { start, stop, count: whole(stops).max(2) })
    }

    /// How light is brought to a display at each of them.
    pub(super) fn tones(&self) -> Vec<Tone> {
        let step = (self.stop - self.start) / f64::from(self.count - 1);
        (0..self.count).map(|i| Tone::Curve(gain(self.start + f64::from(i) * step))).collect()
    }
}

/// Light that the curve brings to [`BRIGHT`]: a root of a quadratic.
fn bright() -> f64 {
    let [a, b, c, d, e] = CURVE.map(f64::from);
    let (p, q, r) = (a - BRIGHT * c, b - BRIGHT * d, -BRIGHT * e);
    (-q + (q * q - 4.0 * p * r).sqrt()) / (2.0 * p)
}

/// The upper median.
fn middle(values: &mut [f32]) -> Option<f32> {
    let half = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(half, f32::total_cmp).1)
}

#[expect(clippy::cast_possible_truncation, reason = "a cast gives infinity, which the curve takes for white")]
fn gain(exposure: f64) -> f32 {
    exposure.exp2() as f32
}

/// Rounded up; there are at most 277 stops between two floats.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative; a cast saturates")]
fn whole(x: f64) -> u32 {
    x.ceil() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn greys(values: &[f32]) -> Image {
        let pixels = values.iter().map(|&x| Rgb::gray(x)).collect();
        Image::from_pixels(u32::try_from(values.len()).expect("few"), 1, pixels).expect("one row")
    }

    #[test]
    fn the_curve_rises_to_white_and_takes_any_light() {
        let mut last = 0.0;
        for i in 0..2000_u16 {
            let y = curve(f32::from(i) * 0.01);
            assert!(y >= last && y <= 1.0, "at {i}: {y} after {last}");
            last = y;
        }
        assert!((last - 1.0).abs() < 1e-6, "ends at {last}");
        for (x, wanted) in [(f32::MAX, 1.0), (f32::INFINITY, 1.0), (-3.0, 0.0), (f32::MIN, 0.0)] {
            assert!((curve(x) - wanted).abs() < 1e-6, "{x}: {}", curve(x));
        }
    }

    #[test]
    fn the_first_and_last_exposure_show_the_greatest_and_the_middle_as_bright() {
        let exposures = Exposures::of(&greys(&[0.1, 0.4, 100.0, 0.01, 0.3])).expect("light");
        let shown = |light: f32, exposure: f64| f64::from(curve(light * gain(exposure)));
        assert!((shown(100.0, exposures.start) - BRIGHT).abs() < 1e-5, "greatest: {exposures:?}");
        assert!((shown(0.3, exposures.stop) - BRIGHT).abs() < 1e-5, "middle: {exposures:?}");
        assert_eq!(exposures.count, 9, "log2(100 / 0.3) = 8.4");
    }

    #[test]
    fn black_has_no_exposure_and_a_black_half_does_not_count() {
        assert_eq!(Exposures::of(&greys(&[0.0, -1.0])), None, "no light");
        let some = Exposures::of(&greys(&[0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 4.0])).expect("light");
        assert_eq!(some, Exposures::of(&greys(&[1.0, 2.0, 4.0])).expect("light"), "of what is lit");
        assert_eq!(Exposures::of(&greys(&[1.0; 4])).map(|e| e.count), Some(2), "at least two");
    }

    #[test]
    fn the_widest_range_of_floats_has_a_few_hundred_exposures() {
        let tiny = f32::from_bits(1);
        let exposures = Exposures::of(&greys(&[f32::MAX, tiny, tiny])).expect("light");
        assert_eq!(exposures.count, 277, "{exposures:?}");
        assert_eq!(exposures.tones().len(), 277, "one each");
    }
}
