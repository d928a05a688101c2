//! ln x and ln(1 + x): x = 2^k (1 + f) with 1 + f between the square roots of 1/2 and 2, and a polynomial in f.

use super::{LN_2_HIGH, LN_2_LOW, Lanes, polynomial};
use crate::math::lanes::{IntLanes, Wrapping};

/// (ln(1 + f) - f) / f^2; leaves 8e-9 in ln(1 + f).
const LN: [f32; 9] = [
    -0.5,
    0.333_333_73,
    -0.250_008_4,
    0.199_989_9,
    -0.166_212_07,
    0.142_389_07,
    -0.132_123_56,
    0.125_658_9,
    -0.072_860_21,
];

/// The bits of one, and of the square root of one half.
const ONE: u32 = 0x3F80_0000;
const SQRT_HALF: u32 = 0x3F35_04F3;

/// k + 127 with x = 2^k (1 + f), for normal x > 0.
#[inline(always)]
fn biased_exponent<F: Lanes>(x: F) -> F::Int {
    x.to_bits().wrapping_add(ONE - SQRT_HALF) >> 23
}

/// f and k with x = 2^k (1 + f), for normal x > 0.
#[inline(always)]
pub(super) fn decompose<F: Lanes>(x: F) -> (F, F) {
    let biased = biased_exponent(x);
    let significand = F::from_bits(x.to_bits().wrapping_sub(biased << 23).wrapping_add(ONE));
    (significand - 1.0, biased.signed_to_float() - 127.0)
}

/// ln(2^k (1 + f)).
#[inline(always)]
fn recompose<F: Lanes>(f: F, k: F) -> F {
    let near_one = f.square().mul_add(polynomial(f, LN), f);
    k.mul_add(f.splat(LN_2_HIGH), k.mul_add(f.splat(LN_2_LOW), near_one))
}

/// `value` where x is positive and finite; the limits elsewhere, and NaN below zero.
#[inline(always)]
pub(super) fn limited<F: Lanes>(x: F, value: F) -> F {
    let value = F::select(x.lt(f32::INFINITY), value, x);
    let tiny = F::select(x.lt(0.0), x.splat(f32::NAN), x.splat(f32::NEG_INFINITY));
    F::select(x.lt(f32::MIN_POSITIVE), tiny, value)
}

#[inline(always)]
pub(in super::super) fn ln<F: Lanes>(x: F) -> F {
    let (f, k) = decompose(x);
    limited(x, recompose(f, k))
}

/// The exponent is taken from the rounded 1 + x, but f from x itself: (1 + x) / 2^k - 1 = x / 2^k + (1 / 2^k - 1),
/// which is rounded once. 4 / 2^k stands in for 1 / 2^k, which need not be a normal float.
#[inline(always)]
pub(in super::super) fn ln_1p<F: Lanes>(x: F) -> F {
    let sum = x + 1.0;
    let biased = biased_exponent(sum);
    let k = biased.signed_to_float() - 127.0;
    let four_over_power = F::from_bits(x.to_bits().splat(256).wrapping_sub(biased) << 23);
    let rest = four_over_power.mul_add(x.splat(0.25), x.splat(-1.0));
    let f = (x * four_over_power).mul_add(x.splat(0.25), rest);
    limited(sum, recompose(f, k))
}
