//! The colour spaces of FLIP: light, opponent channels, perceived difference.
//!
//! Andersson et al., 2020, "FLIP", section 4.1. Everything is over lanes and relative to the white of the display, so the
//! affine constants of YCxCz drop out: filters of sum 1 pass them on unchanged.

use crate::math::Rgb;
use crate::math::lanes::Lanes;

/// Exponent, break and share of section 4.1.3: errors up to 0.4 of the greatest fill [0, 0.95].
const EXPONENT: f32 = 0.7;
const BREAK: f32 = 0.4;
const BELOW_BREAK: f32 = 0.95;

/// X, Y and Z relative to white of linear Rec.709. Each row is that of IEC 61966-2-1 divided by its sum, with white at
/// (0.3127, 0.3290).
const WHITE_RELATIVE: [[f32; 3]; 3] = [
    [0.433_895_4, 0.376_242_37, 0.189_862_24],
    [0.212_636_82, 0.715_183, 0.072_180_2],
    [0.017_752_42, 0.109_465_63, 0.872_781_95],
];

/// The inverse of [`WHITE_RELATIVE`].
const REC_709: [[f32; 3]; 3] = [
    [3.080_342, -1.537_399, -0.542_943],
    [-0.921_178_4, 1.875_93, 0.045_248_41],
    [0.052_881_29, -0.204_011_2, 1.151_129_9],
];

/// A colour as the eye passes it on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Opponent<F> {
    /// Luminance, 1 for white.
    pub(super) y: F,
    /// Red against green: X - Y.
    pub(super) cx: F,
    /// Blue against yellow: Y - Z.
    pub(super) cz: F,
}

impl<F: Lanes> Opponent<F> {
    /// Of linear Rec.709.
    #[inline(always)]
    pub(super) fn of(colour: Rgb<F>) -> Self {
        let [x, y, z] = times(WHITE_RELATIVE, colour.r, colour.g, colour.b);
        Self { y, cx: x - y, cz: y - z }
    }

    /// Linear Rec.709, limited to what a display shows.
    #[inline(always)]
    fn to_display(self) -> Rgb<F> {
        let [r, g, b] = times(REC_709, self.y + self.cx, self.y, self.y - self.cz);
        Rgb::new(r, g, b).clamp(0.0, 1.0)
    }
}

/// A colour as it is perceived: CIELAB with chroma that grows with lightness (the Hunt effect, section 4.1.2).
#[derive(Clone, Copy, Debug)]
pub(super) struct Perceived<F> {
    pub(super) l: F,
    pub(super) a: F,
    pub(super) b: F,
}

impl<F: Lanes> Perceived<F> {
    /// Of blurred opponent channels.
    #[inline(always)]
    pub(super) fn of(blurred: Opponent<F>) -> Self {
        let shown = blurred.to_display();
        let [x, y, z] = times(WHITE_RELATIVE, shown.r, shown.g, shown.b);
        let (x, y, z) = (compressed(x), compressed(y), compressed(z));
        let l = y * 116.0 - 16.0;
        let hunt = l * 0.01;
        Self { l, a: hunt * (x - y) * 500.0, b: hunt * (y - z) * 200.0 }
    }

    /// The distance HyAB (section 4.1.3) to the power 0.7.
    #[inline(always)]
    pub(super) fn distance(self, other: Self) -> F {
        let chroma = ((self.a - other.a).square() + (self.b - other.b).square()).sqrt();
        let distance = (self.l - other.l).abs() + chroma;
        distance.powf(distance.splat(EXPONENT))
    }
}

/// The power of the greatest distance that there is on a display, that of green and blue: about 41.3.
pub(super) fn greatest_distance() -> f32 {
    let perceived = |colour: Rgb<f32>| Perceived::of(Opponent::of(colour));
    perceived(Rgb::new(0.0, 1.0, 0.0)).distance(perceived(Rgb::new(0.0, 0.0, 1.0)))
}

/// The colour error in [0, 1] of a distance, where `greatest` is [`greatest_distance`].
#[inline(always)]
pub(super) fn error<F: Lanes>(distance: F, greatest: f32) -> F {
    let knee = BREAK * greatest;
    let below = distance * (BELOW_BREAK / knee);
    let above = (distance - knee) * ((1.0 - BELOW_BREAK) / (greatest - knee)) + BELOW_BREAK;
    F::select(distance.lt(knee), below, above).min(distance.splat(1.0))
}

/// The function f of CIELAB: a cube root with a straight start. CIE 15:2004, section 8.2.1.
#[inline(always)]
fn compressed<F: Lanes>(t: F) -> F {
    const DELTA: f32 = 6.0 / 29.0;
    let root = t.powf(t.splat(1.0 / 3.0));
    let line = t * (1.0 / (3.0 * DELTA * DELTA)) + 4.0 / 29.0;
    F::select(t.gt(DELTA * DELTA * DELTA), root, line)
}

#[inline(always)]
fn times<F: Lanes>([p, q, r]: [[f32; 3]; 3], x: F, y: F, z: F) -> [F; 3] {
    [x * p[0] + y * p[1] + z * p[2], x * q[0] + y * q[1] + z * q[2], x * r[0] + y * r[1] + z * r[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrices_are_inverse_and_white_is_one() {
        for (i, row) in WHITE_RELATIVE.iter().enumerate() {
            let sum: f32 = row.iter().sum();
            assert!((sum - 1.0).abs() < 1e-6, "row {i}: {sum}");
            for (j, _) in row.iter().enumerate() {
                let entry: f32 = (0..3).map(|k| row[k] * REC_709[k][j]).sum();
                let wanted = if i == j { 1.0 } else { 0.0 };
                assert!((entry - wanted).abs() < 1e-6, "({i}, {j}): {entry}");
            }
        }
    }

    #[test]
    fn greys_have_no_chroma_and_known_lightness() {
        // CIELAB lightness of 18 % grey is 49.5 in every textbook.
        let grey = Perceived::of(Opponent::of(Rgb::gray(0.184_186_f32)));
        assert!((grey.l - 50.0).abs() < 1e-3, "lightness {}", grey.l);
        assert!(grey.a.abs() < 1e-4 && grey.b.abs() < 1e-4, "chroma {}, {}", grey.a, grey.b);
        let white = Perceived::of(Opponent::of(Rgb::<f32>::WHITE));
        let black = Perceived::of(Opponent::of(Rgb::<f32>::BLACK));
        assert!((white.l - 100.0).abs() < 1e-4 && black.l.abs() < 1e-5, "{} and {}", white.l, black.l);
    }

    #[test]
    fn no_two_corners_of_the_display_are_further_apart_than_green_and_blue() {
        let greatest = greatest_distance();
        let corner = |i: u8| {
            let bit = |k: u8| f32::from(i >> k & 1);
            Perceived::of(Opponent::of(Rgb::new(bit(0), bit(1), bit(2))))
        };
        for i in 0..8 {
            for j in 0..8 {
                let distance = corner(i).distance(corner(j));
                assert!(distance <= greatest * 1.000_001, "{i} and {j}: {distance} of {greatest}");
            }
        }
    }

    #[test]
    fn errors_rise_from_zero_to_one_without_a_gap() {
        let greatest = greatest_distance();
        let at = |part: f32| error(part * greatest, greatest);
        assert_eq!(at(0.0).to_bits(), 0.0_f32.to_bits(), "none");
        assert!((at(0.399_999) - 0.95).abs() < 1e-4 && (at(0.400_001) - 0.95).abs() < 1e-4, "at the break");
        assert!((at(1.0) - 1.0).abs() < 1e-6, "greatest");
    }
}
