//! Sine and cosine: the angle reduced to |r| <= pi / 4 around a multiple of a right angle, a polynomial for each, and
//! the quadrant from the multiple's two low bits.

use std::f32::consts::FRAC_2_PI;

use super::{Lanes, ROUNDER, fast_two_sum, polynomial, two_product};
use crate::math::lanes::{Compare, Wrapping};

/// (sin r / r - 1) / r^2 in r^2; leaves 4e-9 in sin r.
const SIN: [f32; 3] = [-0.166_666_55, 0.008_332_189, -0.000_195_182_8];

/// (cos r - 1 + r^2 / 2) / r^4 in r^2; leaves 2e-10 in cos r.
const COS: [f32; 3] = [0.041_666_646, -0.001_388_731, 2.443_232_7e-5];

/// pi / 2 in four parts, the first three of eleven bits: their products with integers up to 2^13 are exact.
const RIGHT_ANGLE: [f32; 4] = [1.570_312_5, 0.000_483_751_3, 7.549_533_6e-8, 2.563_344e-12];

/// 2^13 right angles, beyond which the reduction is inexact.
const LARGEST: f32 = 12_867.0;

/// 2 pi and what is missing.
const TURN_HIGH: f32 = std::f32::consts::TAU;
const TURN_LOW: f32 = -1.748_455_5e-7;

#[inline(always)]
pub(in super::super) fn sin_cos<F: Lanes>(x: F) -> (F, F) {
    // Zero, or NaN for what is not finite.
    let x = F::select(x.abs().le(LARGEST), x, x * 0.0);
    let rounded = x.mul_add(x.splat(FRAC_2_PI), x.splat(ROUNDER));
    let k = rounded - ROUNDER;
    let r = k.mul_add(x.splat(-RIGHT_ANGLE[0]), x);
    let r = k.mul_add(x.splat(-RIGHT_ANGLE[1]), r);
    let (r, low) = fast_two_sum(r, k * -RIGHT_ANGLE[2]);
    let low = k.mul_add(x.splat(-RIGHT_ANGLE[3]), low);
    in_quadrant(r, low, rounded.to_bits())
}

#[inline(always)]
pub(in super::super) fn sin_cos_turns<F: Lanes>(x: F) -> (F, F) {
    let rounded = x.mul_add(x.splat(4.0), x.splat(ROUNDER));
    let turns = (rounded - ROUNDER).mul_add(x.splat(-0.25), x);
    // Arguments of 2^22 and above are whole turns, or nearly so, or not finite.
    let turns = F::select(turns.abs().le(0.25), turns, x * 0.0);
    let (r, lost) = two_product(turns, x.splat(TURN_HIGH));
    in_quadrant(r, turns.mul_add(x.splat(TURN_LOW), lost), rounded.to_bits())
}

/// Sine and cosine of r + low plus as many right angles as the two low bits of `quadrant` say.
#[inline(always)]
fn in_quadrant<F: Lanes>(r: F, low: F, quadrant: F::Int) -> (F, F) {
    let square = r.square();
    let sin = (square * r).mul_add(polynomial(square, SIN), low) + r;
    let half = square * 0.5;
    let near = -half + 1.0;
    let rest = r.mul_add(-low, (-near + 1.0) - half);
    let cos = square.square().mul_add(polynomial(square, COS), rest) + near;
    let odd = (quadrant & 1).ne(0);
    let sin_sign = (quadrant & 2) << 30;
    let cos_sign = (quadrant.wrapping_add(1) & 2) << 30;
    let (s, c) = (F::select(odd, cos, sin), F::select(odd, sin, cos));
    (F::from_bits(s.to_bits() ^ sin_sign), F::from_bits(c.to_bits() ^ cos_sign))
}
