//! x^y = e^(y ln x), with ln x and its product with y as sums of two floats.

use super::exponential::exp_of_sum;
use super::logarithm::{LN, decompose, limited};
use super::{LN_2_HIGH, LN_2_LOW, Lanes, fast_two_sum, polynomial, two_product};

#[inline(always)]
pub(in super::super) fn powf<F: Lanes>(x: F, y: F) -> F {
    let (high, low) = ln_as_sum(x);
    let (product, lost) = two_product(y, limited(x, high));
    let value = exp_of_sum(product, y.mul_add(low, lost));
    F::select(y.eq(0.0) | x.eq(1.0), x.splat(1.0), value)
}

/// ln x for normal x as a float and what it lacks, the smaller by twenty-four bits: k ln 2 + f - f^2 / 2 + f^3 q(f), of
/// which only f^3 q(f) is rounded to one float.
#[inline(always)]
fn ln_as_sum<F: Lanes>(x: F) -> (F, F) {
    let (f, k) = decompose(x);
    let (square, square_lost) = two_product(f, f);
    let cubic = square * f * polynomial(f, tail(LN));
    let (near_one, near_one_lost) = fast_two_sum(f, square * -0.5);
    let (sum, sum_lost) = fast_two_sum(k * LN_2_HIGH, near_one);
    let low = k.mul_add(x.splat(LN_2_LOW), square_lost.mul_add(x.splat(-0.5), near_one_lost + sum_lost));
    fast_two_sum(sum, low + cubic)
}

/// The coefficients of f^3 and above.
const fn tail(c: [f32; 9]) -> [f32; 8] {
    [c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8]]
}
