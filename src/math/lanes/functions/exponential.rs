//! e^x and e^x - 1: x = k ln 2 + r with |r| <= ln 2 / 2, a polynomial in r, and k added to the exponent
//! (W. J. Cody and W. Waite 1980, Software Manual for the Elementary Functions, chapter 6).

use std::f32::consts::LOG2_E;

use super::{LN_2_HIGH, LN_2_LOW, Lanes, ROUNDER, polynomial, scale_by_power};
use crate::math::lanes::Wrapping;

/// (e^r - 1 - r) / r^2 for |r| <= ln 2 / 2; leaves 3e-9 in e^r.
const EXP: [f32; 5] = [0.499_999_9, 0.166_665_21, 0.041_668_963, 0.008_368_672, 0.001_378_248];

/// The same, but leaves 5e-10 in e^r - 1.
const EXP_M1: [f32; 6] = [0.5, 0.166_666_66, 0.041_666_478, 0.008_333_567, 0.001_393_369_2, 0.000_197_432_98];

/// The least argument with a result of at least 2^-126.
const LEAST: f32 = -87.336_54;

/// The greatest argument with a finite result.
const GREATEST: f32 = 88.722_83;

/// r with x = k ln 2 + r, and k << 23 modulo 2^32.
#[inline(always)]
fn reduce<F: Lanes>(x: F) -> (F, F::Int) {
    let rounded = x.mul_add(x.splat(LOG2_E), x.splat(ROUNDER));
    let k = rounded - ROUNDER;
    let r = k.mul_add(x.splat(-LN_2_HIGH), x);
    (k.mul_add(x.splat(-LN_2_LOW), r), rounded.to_bits() << 23)
}

#[inline(always)]
pub(in super::super) fn exp<F: Lanes>(x: F) -> F {
    let (r, power) = reduce(x);
    let value = r.square().mul_add(polynomial(r, EXP), r) + 1.0;
    limited(x, scale_by_power(value, power), LEAST, GREATEST)
}

/// e^(x + low), where `low` is at most an ulp of x. Zero below and infinite above what is a little inside the range
/// of floats, lest `low` carry the result out of it.
#[inline(always)]
pub(super) fn exp_of_sum<F: Lanes>(x: F, low: F) -> F {
    let (r, power) = reduce(x);
    let r = r + low;
    let value = r.square().mul_add(polynomial(r, EXP), r) + 1.0;
    limited(x, scale_by_power(value, power), -87.336, 88.7228)
}

/// `value`, but zero where x < `least`, infinite where x > `greatest`, and NaN where x is.
#[inline(always)]
fn limited<F: Lanes>(x: F, value: F, least: f32, greatest: f32) -> F {
    let value = F::select(x.le(greatest), value, x * f32::MAX);
    F::select(x.lt(least), x.splat(0.0), value)
}

/// 2^k (e^r - 1) + (2^k - 1), computed at half its size because 2^128 is not a float.
#[inline(always)]
pub(in super::super) fn exp_m1<F: Lanes>(x: F) -> F {
    // Selections rather than limits, which would swallow NaN.
    let x = F::select(x.lt(-25.0), x.splat(-25.0), x);
    let x = F::select(x.gt(89.0), x.splat(89.0), x);
    let (r, power) = reduce(x);
    let value = r.square().mul_add(polynomial(r, EXP_M1), r);
    let half_power = F::from_bits(power.wrapping_add(126 << 23));
    value.mul_add(half_power, half_power - 0.5) * 2.0
}
