//! The transcendental functions, written once over [`Lanes`]: every width computes the same formulas.
//!
//! The methods of [`Lanes`] that call these state each one's domain and largest error, which `tests/functions.rs`
//! asserts against `f64`. One ulp is the distance of the neighbouring floats at the true value. Polynomials are minimax
//! fits made for this file (Remez exchange, then a lattice search for coefficients that are floats); each table states
//! the relative error that the fit leaves in its function.
//!
//! Arguments and results below 2^-126 count as zero, as they do for a thread that flushes denormals.

mod arc;
mod circular;
mod exponential;
mod logarithm;
mod power;

pub(super) use arc::{acos, asin, atan2};
pub(super) use circular::{sin_cos, sin_cos_turns};
pub(super) use exponential::{exp, exp_m1};
pub(super) use logarithm::{ln, ln_1p};
pub(super) use power::powf;

use super::{Lanes, Wrapping};

/// 1.5 * 2^23. Adding it to |x| < 2^22 rounds x to an integer, which the low bits of the sum then hold.
const ROUNDER: f32 = 12_582_912.0;

/// ln 2 in sixteen bits, so that products with exponents are exact, and what is missing.
const LN_2_HIGH: f32 = 0.693_145_75;
const LN_2_LOW: f32 = 1.428_606_8e-6;

/// c0 + c1 x + c2 x^2 + ..., by Horner's rule.
#[inline(always)]
fn polynomial<F: Lanes, const N: usize>(x: F, c: [f32; N]) -> F {
    let mut p = x.splat(c[N - 1]);
    for i in (0..N - 1).rev() {
        p = p.mul_add(x, x.splat(c[i]));
    }
    p
}

/// The sum of a and b, rounded, and what rounding lost, exactly, provided |a| >= |b| or a = 0 (T. J. Dekker 1971,
/// A Floating-Point Technique for Extending the Available Precision).
#[inline(always)]
fn fast_two_sum<F: Lanes>(a: F, b: F) -> (F, F) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// The product of a and b, rounded, and what rounding lost, exactly: in halves of twelve bits where nothing is fused.
#[inline(always)]
fn two_product<F: Lanes>(a: F, b: F) -> (F, F) {
    let product = a * b;
    if F::FUSED {
        return (product, a.mul_add(b, -product));
    }
    let (a_high, b_high) = (upper_half(a), upper_half(b));
    let (a_low, b_low) = (a - a_high, b - b_high);
    let lost = a_high.mul_add(b_high, -product);
    let lost = a_high.mul_add(b_low, lost);
    let lost = a_low.mul_add(b_high, lost);
    (product, a_low.mul_add(b_low, lost))
}

/// The upper twelve bits of the significand.
#[inline(always)]
fn upper_half<F: Lanes>(x: F) -> F {
    F::from_bits(x.to_bits() & 0xFFFF_F000)
}

/// `x` times 2^k for normal results; `shifted` is k << 23 modulo 2^32.
#[inline(always)]
fn scale_by_power<F: Lanes>(x: F, shifted: F::Int) -> F {
    F::from_bits(x.to_bits().wrapping_add(shifted))
}
