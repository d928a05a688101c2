//! From scene-linear light to the bytes of a preview: exposure, a tone curve, the sRGB transfer function.
//!
//! All three work on each channel alone and alike, so grey stays grey. Saturated highlights bleach towards white under
//! [`Curve::Filmic`], as film does, and clip by channel under [`Curve::Clip`].

use crate::math::Rgb;

/// How light beyond the display's range is brought into it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curve {
    /// The value itself, cut at 1.
    Clip,
    /// A curve with a toe and a long shoulder: 0.18 stays 0.18, white is reached at 10.
    #[default]
    Filmic,
}

impl Curve {
    /// Display light in [0, 1] of scene light `x`; negative and NaN give 0. Monotone.
    pub fn apply(self, x: f32) -> f32 {
        match self {
            Self::Clip => x.clamp(0.0, 1.0).max(0.0),
            Self::Filmic => filmic(x),
        }
    }
}

/// The rational fit of the ACES reference rendering by Narkowicz, 2015, "ACES filmic tone mapping curve", with its input
/// scaled so that middle grey, 0.18, maps to itself: 0.72318 solves f(0.18 s) = 0.18. The published curve alone would
/// brighten middle grey to 0.27.
fn filmic(x: f32) -> f32 {
    const MIDDLE_GREY_SCALE: f32 = 0.723_18;
    // Far above white, where the squares would overflow, the curve is flat.
    let x = (x * MIDDLE_GREY_SCALE).clamp(0.0, 1e4).max(0.0);
    let y = (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
    y.min(1.0)
}

/// The encoded value in [0, 1] of display light `x` in [0, 1]: IEC 61966-2-1:1999, the exact two-part function.
pub fn srgb_from_linear(x: f32) -> f32 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

/// Display light in [0, 1] of an encoded value in [0, 1]: the inverse of [`srgb_from_linear`].
pub fn linear_from_srgb(x: f32) -> f32 {
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// What happens to a picture on its way to a display.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Development {
    /// Light is multiplied by 2 to this power.
    pub exposure_ev: f32,
    /// What follows.
    pub curve: Curve,
}

impl Development {
    /// The three bytes of a pixel, rounded to nearest.
    pub fn bytes(self, colour: Rgb<f32>) -> [u8; 3] {
        let gain = self.exposure_ev.exp2();
        [colour.r, colour.g, colour.b].map(|x| byte(srgb_from_linear(self.curve.apply(x * gain))))
    }
}

/// 255 times `x`, rounded.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "x is in [0, 1]; a cast saturates"
)]
fn byte(x: f32) -> u8 {
    (x * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_matches_the_standard_and_its_inverse() {
        // Encoded 8-bit values whose light is tabulated in many places: 188 is half, 118 is close to middle grey.
        assert_eq!(byte(srgb_from_linear(0.5)), 188, "half");
        assert_eq!(byte(srgb_from_linear(0.18)), 118, "middle grey");
        assert_eq!(byte(srgb_from_linear(0.003)), 10, "in the linear part");
        for i in 0..=255_u8 {
            let x = f32::from(i) / 255.0;
            assert_eq!(byte(srgb_from_linear(linear_from_srgb(x))), i, "there and back");
        }
    }

    #[test]
    fn middle_grey_and_neutrals_stay_under_the_filmic_curve() {
        assert!(
            (Curve::Filmic.apply(0.18) - 0.18).abs() < 1e-5,
            "middle grey: {}",
            Curve::Filmic.apply(0.18)
        );
        let development = Development { exposure_ev: 1.0, curve: Curve::Filmic };
        for x in [0.001, 0.1, 0.7, 3.0, 50.0] {
            let [r, g, b] = development.bytes(Rgb::gray(x));
            assert!(r == g && g == b, "grey {x} became {r} {g} {b}");
        }
    }

    #[test]
    fn curves_rise_from_zero_to_one() {
        for curve in [Curve::Clip, Curve::Filmic] {
            let mut last = 0.0;
            for i in 0..4000_u16 {
                let y = curve.apply(f32::from(i) * 0.005);
                assert!(y >= last && y <= 1.0, "{curve:?} at {i}: {y} after {last}");
                last = y;
            }
            assert!(last > 0.9999, "{curve:?} ends at {last}");
        }
    }

    #[test]
    fn nothing_that_is_not_a_number_reaches_a_byte() {
        for curve in [Curve::Clip, Curve::Filmic] {
            let development = Development { exposure_ev: 0.0, curve };
            let bytes = |x| development.bytes(Rgb::gray(x))[0];
            assert_eq!(bytes(f32::NAN), 0, "{curve:?}: NaN");
            assert_eq!(bytes(-1.0), 0, "{curve:?}: negative");
            assert_eq!(bytes(f32::INFINITY), 255, "{curve:?}: infinite");
            assert_eq!(bytes(f32::MAX), 255, "{curve:?}: huge");
        }
    }

    #[test]
    fn one_stop_doubles_the_light() {
        let dark = Development { exposure_ev: 1.0, curve: Curve::Clip };
        let plain = Development { exposure_ev: 0.0, curve: Curve::Clip };
        assert_eq!(dark.bytes(Rgb::gray(0.2)), plain.bytes(Rgb::gray(0.4)), "one stop");
    }
}
