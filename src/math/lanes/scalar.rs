//! One lane: plain `f32`, `u32` and `bool`. The ray tree, the unit tests and the oracles run on it.

use super::{Compare, IntLanes, Isa, Kernel, Lanes, MaskLanes, Select, Wrapping};

/// The token of the width-1 implementation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scalar;

impl Isa for Scalar {
    type F = f32;
    type I = u32;
    type M = bool;
    const WIDTH: usize = 1;
    const NAME: &'static str = "scalar";

    #[inline(always)]
    fn run<K: Kernel<Self>>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
    #[inline(always)]
    fn splat(self, x: f32) -> f32 {
        x
    }
    #[inline(always)]
    fn splat_u32(self, x: u32) -> u32 {
        x
    }
    #[inline(always)]
    fn splat_mask(self, x: bool) -> bool {
        x
    }
    #[inline(always)]
    fn load(self, from: &[f32]) -> f32 {
        from[0]
    }
    #[inline(always)]
    fn load_u32(self, from: &[u32]) -> u32 {
        from[0]
    }
    #[inline(always)]
    fn iota(self) -> u32 {
        0
    }
    #[inline(always)]
    fn gather(self, table: &[f32], index: u32) -> f32 {
        table.get(index as usize).copied().unwrap_or(0.0)
    }
    #[inline(always)]
    fn gather_u32(self, table: &[u32], index: u32) -> u32 {
        table.get(index as usize).copied().unwrap_or(0)
    }
    #[inline(always)]
    fn gather_rows(self, table: &[[f32; 3]], index: u32) -> [f32; 3] {
        table.get(index as usize).copied().unwrap_or_default()
    }
    #[inline(always)]
    fn gather_quads(self, table: &[[f32; 4]], index: u32) -> [f32; 4] {
        table.get(index as usize).copied().unwrap_or_default()
    }
    #[inline(always)]
    fn per_lane(self, mut f: impl FnMut(usize) -> f32) -> f32 {
        f(0)
    }
    #[inline(always)]
    fn per_lane_u32(self, mut f: impl FnMut(usize) -> u32) -> u32 {
        f(0)
    }
}

impl MaskLanes for bool {
    #[inline(always)]
    fn splat(self, x: bool) -> Self {
        x
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
}

macro_rules! scalar_compare {
    ($t:ty, $min:path, $max:path) => {
        impl Select for $t {
            type Mask = bool;
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
        }
        impl Compare for $t {
            #[inline(always)]
            fn lt(self, rhs: Self) -> bool {
                self < rhs
            }
            #[inline(always)]
            fn le(self, rhs: Self) -> bool {
                self <= rhs
            }
            #[inline(always)]
            fn gt(self, rhs: Self) -> bool {
                self > rhs
            }
            #[inline(always)]
            fn ge(self, rhs: Self) -> bool {
                self >= rhs
            }
            #[inline(always)]
            fn eq(self, rhs: Self) -> bool {
                self == rhs
            }
            #[inline(always)]
            fn ne(self, rhs: Self) -> bool {
                self != rhs
            }
            #[inline(always)]
            fn min(self, rhs: Self) -> Self {
                $min(self, rhs)
            }
            #[inline(always)]
            fn max(self, rhs: Self) -> Self {
                $max(self, rhs)
            }
        }
    };
}
scalar_compare!(f32, f32::min, f32::max);
scalar_compare!(u32, Ord::min, Ord::max);

impl Wrapping for u32 {
    #[inline(always)]
    fn wrapping_add(self, rhs: Self) -> Self {
        self.wrapping_add(rhs)
    }
    #[inline(always)]
    fn wrapping_sub(self, rhs: Self) -> Self {
        self.wrapping_sub(rhs)
    }
    #[inline(always)]
    fn wrapping_mul(self, rhs: Self) -> Self {
        self.wrapping_mul(rhs)
    }
}

impl Lanes for f32 {
    type Isa = Scalar;
    type Int = u32;
    const WIDTH: usize = 1;
    const FUSED: bool = false;

    #[inline(always)]
    fn isa(self) -> Scalar {
        Scalar
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self {
        x
    }
    #[inline(always)]
    fn to_bits(self) -> u32 {
        self.to_bits()
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self::from_bits(bits)
    }
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "unspecified outside the range of i32")]
    fn to_int(self) -> u32 {
        (self as i32).cast_unsigned()
    }
    #[inline(always)]
    fn extract(self, i: usize) -> f32 {
        [self][i]
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[0] = self;
    }
    #[inline(always)]
    fn compress(self, _mask: bool) -> Self {
        self
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.floor()
    }
    #[inline(always)]
    fn round_ties_even(self) -> Self {
        self.round_ties_even()
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.copysign(sign)
    }
    #[inline(always)]
    fn flip_sign(self, sign: Self) -> Self {
        Self::from_bits(self.to_bits() ^ (sign.to_bits() & 0x8000_0000))
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.is_finite()
    }
}

impl IntLanes for u32 {
    type F = f32;
    type Isa = Scalar;
    const WIDTH: usize = 1;

    #[inline(always)]
    fn isa(self) -> Scalar {
        Scalar
    }
    #[inline(always)]
    fn splat(self, x: u32) -> Self {
        x
    }
    #[inline(always)]
    fn reverse_bits(self) -> Self {
        self.reverse_bits()
    }
    #[inline(always)]
    fn signed_to_float(self) -> f32 {
        self.cast_signed() as f32
    }
    #[inline(always)]
    fn extract(self, i: usize) -> u32 {
        [self][i]
    }
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        to[0] = self;
    }
    #[inline(always)]
    fn compress(self, _mask: bool) -> Self {
        self
    }
}
