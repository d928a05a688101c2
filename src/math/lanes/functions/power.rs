//! x^y = e^(y ln x), with ln x and its product with y as sums of two floats.

use super::exponential::exp_of_sum;
use super::logarithm::{decompose, limited};
use super::{LN_2_HIGH, LN_2_LOW, Lanes, fast_two_sum, polynomial, two_product};

/// (2 artanh s - 2 s) / s^3 in s^2, for |s| <= tan^2(pi / 16); leaves 3e-11 in artanh s.
const ARTANH: [f32; 4] = [0.666_666_6, 0.400_009_75, 0.284_984_9, 0.242_861_06];

#[inline(always)]
pub(in super::super) fn powf<F: Lanes>(x: F, y: F) -> F {
    let (high, low) = ln_as_sum(x);
    let (product, lost) = two_product(y, limited(x, high));
    let value = exp_of_sum(product, y.mul_add(low, lost));
    F::select(y.eq(0.0) | x.eq(1.0), x.splat(1.0), value)
}

/// ln x for normal x as a float and what it lacks, together good to thirty bits: k ln 2 + ln(1 + f), where
/// ln(1 + f) = 2 artanh s with s = f / (2 + f) is so nearly 2 s that only s must be known beyond a float.
#[inline(always)]
fn ln_as_sum<F: Lanes>(x: F) -> (F, F) {
    let (f, k) = decompose(x);
    let (s, s_low) = quotient_as_sum(f, f + 2.0);
    let square = s.square();
    let tail = s * square * polynomial(square, ARTANH);
    let (sum, lost) = fast_two_sum(k * LN_2_HIGH, s * 2.0);
    let slope = square * 2.0 + 2.0;
    let low = k.mul_add(x.splat(LN_2_LOW), s_low.mul_add(slope, lost));
    fast_two_sum(sum, low + tail)
}

/// f / (2 + f) as a float and what it lacks, where `d` is 2 + f rounded.
#[inline(always)]
fn quotient_as_sum<F: Lanes>(f: F, d: F) -> (F, F) {
    let d_low = f - (d - 2.0);
    let inverse = d.recip();
    let quotient = f * inverse;
    let (product, lost) = two_product(quotient, d);
    let rest = quotient.mul_add(-d_low, (f - product) - lost);
    (quotient, rest * inverse)
}
