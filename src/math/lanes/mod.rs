//! One source, any width: the SIMD vocabulary that all shading is written in.
//!
//! A kernel is generic over [`Lanes`] (values) or [`Isa`] (the token that makes values) and is compiled once per
//! instruction set. One lane is plain `f32`; [`Portable`] is arrays of any width; [`Avx2`] and [`Avx512`] stand
//! on the crate `fearless_simd`. [`Level`] is found once at start and enters the kernels.
//!
//! **A value is the proof.** A wide value can only be made from a token, a token only by run-time detection, so every
//! operation on a value is a safe function.
//!
//! Limits:
//! * Every function of a kernel must be `#[inline(always)]`, and no closure that computes with lanes may be passed to
//!   a function that is not: code left out of line is compiled without the instruction set and costs ten times more.
//! * `mul_add` is fused where the hardware fuses and rounds twice elsewhere: widths agree to rounding, not bit for bit.
//! * On concrete `f32` and `u32` the inherent methods of the standard library win over those here; they mean the same,
//!   but `f32::mul_add` is then a slow library call.
//! * Floats on the left of an operator do not exist: write `-x + 1.0` for one minus x.

#[macro_use]
mod operators;

mod bits;
mod compare;
mod functions;
#[cfg(target_arch = "x86_64")]
mod gather;
mod int;
mod isa;
mod level;
mod portable;
mod scalar;
#[cfg(target_arch = "x86_64")]
mod wide;

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

pub use bits::Bits;
pub use compare::{Compare, MaskLanes, Select};
pub use int::{IntLanes, Wrapping};
pub use isa::{Isa, Kernel};
pub use level::{AnyKernel, Level, LevelError, VARIABLE};
pub use portable::{Portable, PortableF32, PortableMask, PortableU32};
pub use scalar::Scalar;
#[cfg(target_arch = "x86_64")]
pub use wide::{Avx2, Avx512, F32x8, F32x16, Mask8, Mask16, U32x8, U32x16};

/// Lanes of the widest instruction set: room for those of any.
pub const WIDEST: usize = 16;

/// Float lanes: [`Isa::WIDTH`] numbers of type `f32` that are computed with together.
///
/// Every operator and comparison also takes an `f32` on the right, meaning the same number in all lanes.
pub trait Lanes:
    Select
    + Debug
    + Send
    + Sync
    + 'static
    + Neg<Output = Self>
    + Add<Self, Output = Self>
    + Add<f32, Output = Self>
    + Sub<Self, Output = Self>
    + Sub<f32, Output = Self>
    + Mul<Self, Output = Self>
    + Mul<f32, Output = Self>
    + Div<Self, Output = Self>
    + Div<f32, Output = Self>
    + AddAssign<Self>
    + AddAssign<f32>
    + SubAssign<Self>
    + SubAssign<f32>
    + MulAssign<Self>
    + MulAssign<f32>
    + DivAssign<Self>
    + DivAssign<f32>
    + Compare<Self>
    + Compare<f32>
{
    /// The token that makes values of this kind.
    type Isa: Isa<F = Self, I = Self::Int, M = Self::Mask>;
    /// Unsigned integers of the same width.
    type Int: IntLanes<F = Self, Isa = Self::Isa, Mask = Self::Mask>;
    /// The number of lanes.
    const WIDTH: usize;
    /// Whether `mul_add` rounds once.
    const FUSED: bool;

    /// The token this value was made with.
    fn isa(self) -> Self::Isa;
    /// `x` in all lanes: another value of the same kind.
    fn splat(self, x: f32) -> Self;
    /// The bits of the IEEE 754 representation.
    fn to_bits(self) -> Self::Int;
    /// The numbers with the bits given.
    fn from_bits(bits: Self::Int) -> Self;
    /// Rounded towards zero, in two's complement; unspecified for |x| >= 2^31 and NaN.
    fn to_int(self) -> Self::Int;
    /// Lane `i`. Slow; for tests and rare cases.
    ///
    /// # Panics
    /// If `i >= WIDTH`.
    fn extract(self, i: usize) -> f32;
    /// Writes all lanes to the first `WIDTH` elements.
    ///
    /// # Panics
    /// If `to` is shorter than `WIDTH`.
    fn store(self, to: &mut [f32]);
    /// The lanes that are set in `mask`, packed to the front in order; what follows them is unspecified.
    fn compress(self, mask: Self::Mask) -> Self;

    /// The magnitude.
    fn abs(self) -> Self;
    /// The square root, correctly rounded; NaN below zero.
    fn sqrt(self) -> Self;
    /// The greatest integer not above.
    fn floor(self) -> Self;
    /// The nearest integer; halves go to the even one.
    fn round_ties_even(self) -> Self;
    /// `self * b + c`: rounded once where the hardware fuses, twice elsewhere.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// The magnitude of `self` with the sign of `sign`, its zero included.
    fn copysign(self, sign: Self) -> Self;
    /// `self`, negated where `sign` is negative or minus zero.
    fn flip_sign(self, sign: Self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> Self::Mask;

    /// 1 / x, correctly rounded.
    #[inline(always)]
    fn recip(self) -> Self {
        self.splat(1.0) / self
    }
    /// 1 / sqrt(x), within 1.5 ulp.
    #[inline(always)]
    fn rsqrt(self) -> Self {
        self.splat(1.0) / self.sqrt()
    }
    /// `self` limited to [`low`, `high`]; NaN gives `low`.
    #[inline(always)]
    fn clamp(self, low: f32, high: f32) -> Self {
        self.max(low).min(high)
    }
    /// x^2.
    #[inline(always)]
    fn square(self) -> Self {
        self * self
    }
    /// x^5.
    #[inline(always)]
    fn pow5(self) -> Self {
        self.square().square() * self
    }
    /// `self` at `t` = 0, `to` at 1.
    #[inline(always)]
    fn lerp(self, to: Self, t: Self) -> Self {
        t.mul_add(to - self, self)
    }

    /// `f` of each lane, one at a time. Slow; `f` must not compute with lanes.
    #[inline(always)]
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        self.isa().per_lane(|i| f(self.extract(i)))
    }
    /// e^x within 1.1 ulp. Below -87.33654, where results would be less than 2^-126, zero; from 88.72284 infinite.
    #[inline(always)]
    fn exp(self) -> Self {
        functions::exp(self)
    }
    /// e^x - 1 within 1.5 ulp, near zero too; from 88.72284 infinite. Minus zero gives plus zero.
    #[inline(always)]
    fn exp_m1(self) -> Self {
        functions::exp_m1(self)
    }
    /// The natural logarithm within 1 ulp; minus infinity below 2^-126, NaN below zero.
    #[inline(always)]
    fn ln(self) -> Self {
        functions::ln(self)
    }
    /// ln(1 + x) within 1.6 ulp, near zero too; minus infinity at -1, NaN below. Minus zero gives plus zero.
    #[inline(always)]
    fn ln_1p(self) -> Self {
        functions::ln_1p(self)
    }
    /// x^y within 1.4 ulp if the result is in [1e-5, 1e5], 2.6 ulp elsewhere; infinite from 3.402e38, zero below 2^-126.
    /// x^0 and 1^y are 1 for all x and y; otherwise NaN for x < 0, even for whole y. x below 2^-126 counts as zero.
    #[inline(always)]
    fn powf(self, y: Self) -> Self {
        functions::powf(self, y)
    }
    /// The sine of x radians; see [`Lanes::sin_cos`].
    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    /// The cosine of x radians; see [`Lanes::sin_cos`].
    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    /// Sine and cosine of x radians, each within 1 ulp for |x| <= 12867. Greater arguments count as zero; infinities give NaN.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        functions::sin_cos(self)
    }
    /// Sine and cosine of x turns, that is of 2 pi x, within 1.1 ulp: the cheapest for directions around an axis.
    #[inline(always)]
    fn sin_cos_turns(self) -> (Self, Self) {
        functions::sin_cos_turns(self)
    }
    /// The arc sine in [-pi/2, pi/2], within 1.9 ulp; NaN for |x| > 1.
    #[inline(always)]
    fn asin(self) -> Self {
        functions::asin(self)
    }
    /// The arc cosine in [0, pi], within 1.3 ulp; NaN for |x| > 1.
    #[inline(always)]
    fn acos(self) -> Self {
        functions::acos(self)
    }
    /// The arc tangent in [-pi/2, pi/2], within 1.4 ulp.
    #[inline(always)]
    fn atan(self) -> Self {
        functions::atan2(self, self.splat(1.0))
    }
    /// The angle of the point (`x`, `self`) from the x axis in [-pi, pi], within 1.6 ulp. The signs of zeros count as in
    /// IEEE 754; magnitudes below 2^-126 count as zero, |x| and |y| must not both exceed 1.7e38, two infinities give NaN.
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        functions::atan2(self, x)
    }
}
