//! Arrays of any width up to 32, left to the compiler to vectorise: the fallback, and the oracle of the intrinsics.

use super::{IntLanes, Isa, Kernel, Lanes, MaskLanes, Select};

/// The token of the array implementation with `N` lanes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Portable<const N: usize>;

/// `N` floats.
#[derive(Clone, Copy, Debug)]
pub struct PortableF32<const N: usize>([f32; N]);

/// `N` unsigned integers.
#[derive(Clone, Copy, Debug)]
pub struct PortableU32<const N: usize>([u32; N]);

/// `N` truth values: all bits of an element set, or none.
#[derive(Clone, Copy, Debug)]
pub struct PortableMask<const N: usize>([u32; N]);

/// `$out[i] = $value` for all i, as a plain loop: closures may be left out of line.
macro_rules! each {
    ($zero:expr, |$i:ident| $value:expr) => {{
        let mut out = [$zero; N];
        for $i in 0..N {
            out[$i] = $value;
        }
        out
    }};
}

#[inline(always)]
const fn ones(x: bool) -> u32 {
    (x as u32).wrapping_neg()
}

impl<const N: usize> Isa for Portable<N> {
    type F = PortableF32<N>;
    type I = PortableU32<N>;
    type M = PortableMask<N>;
    const WIDTH: usize = N;
    const NAME: &'static str = "portable";

    #[inline(always)]
    fn run<K: Kernel<Self>>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        PortableF32([x; N])
    }
    #[inline(always)]
    fn splat_u32(self, x: u32) -> Self::I {
        PortableU32([x; N])
    }
    #[inline(always)]
    fn splat_mask(self, x: bool) -> Self::M {
        PortableMask([ones(x); N])
    }
    #[inline(always)]
    fn load(self, from: &[f32]) -> Self::F {
        let from = &from[..N];
        PortableF32(each!(0.0, |i| from[i]))
    }
    #[inline(always)]
    fn load_u32(self, from: &[u32]) -> Self::I {
        let from = &from[..N];
        PortableU32(each!(0, |i| from[i]))
    }
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "i < N <= 32")]
    fn iota(self) -> Self::I {
        PortableU32(each!(0, |i| i as u32))
    }
    #[inline(always)]
    fn gather(self, table: &[f32], index: Self::I) -> Self::F {
        PortableF32(each!(0.0, |i| table.get(index.0[i] as usize).copied().unwrap_or(0.0)))
    }
    #[inline(always)]
    fn gather_u32(self, table: &[u32], index: Self::I) -> Self::I {
        PortableU32(each!(0, |i| table.get(index.0[i] as usize).copied().unwrap_or(0)))
    }
    #[inline(always)]
    fn gather_rows(self, table: &[[f32; 3]], index: Self::I) -> [Self::F; 3] {
        let row = |i: usize| table.get(index.0[i] as usize).copied().unwrap_or_default();
        [
            PortableF32(each!(0.0, |i| row(i)[0])),
            PortableF32(each!(0.0, |i| row(i)[1])),
            PortableF32(each!(0.0, |i| row(i)[2])),
        ]
    }
    #[inline(always)]
    fn gather_quads(self, table: &[[f32; 4]], index: Self::I) -> [Self::F; 4] {
        let row = |i: usize| table.get(index.0[i] as usize).copied().unwrap_or_default();
        [
            PortableF32(each!(0.0, |i| row(i)[0])),
            PortableF32(each!(0.0, |i| row(i)[1])),
            PortableF32(each!(0.0, |i| row(i)[2])),
            PortableF32(each!(0.0, |i| row(i)[3])),
        ]
    }
    #[inline(always)]
    fn per_lane(self, mut f: impl FnMut(usize) -> f32) -> Self::F {
        PortableF32(each!(0.0, |i| f(i)))
    }
    #[inline(always)]
    fn per_lane_u32(self, mut f: impl FnMut(usize) -> u32) -> Self::I {
        PortableU32(each!(0, |i| f(i)))
    }
}

/// Lane-wise binary methods.
macro_rules! lanewise {
    ($out:ident, $zero:expr, $($name:ident: |$a:ident, $b:ident| $value:expr;)*) => {
        $(#[inline(always)]
        fn $name(self, rhs: Self) -> $out<N> {
            $out(each!($zero, |i| { let ($a, $b) = (self.0[i], rhs.0[i]); $value }))
        })*
    };
}

impl<const N: usize> PortableF32<N> {
    lanewise!(PortableF32, 0.0,
        plus: |a, b| a + b; minus: |a, b| a - b; times: |a, b| a * b; over: |a, b| a / b;
        smaller: |a, b| a.min(b); greater: |a, b| a.max(b););
    lanewise!(PortableMask, 0,
        is_lt: |a, b| ones(a < b); is_le: |a, b| ones(a <= b); is_gt: |a, b| ones(a > b);
        is_ge: |a, b| ones(a >= b););

    #[inline(always)]
    fn is_eq(self, rhs: Self) -> PortableMask<N> {
        PortableMask(each!(0, |i| ones(self.0[i] == rhs.0[i])))
    }
    #[inline(always)]
    fn is_ne(self, rhs: Self) -> PortableMask<N> {
        !self.is_eq(rhs)
    }
    #[inline(always)]
    fn at_most(self, x: f32) -> Self {
        Self(each!(0.0, |i| self.0[i].min(x)))
    }
    #[inline(always)]
    fn at_least(self, x: f32) -> Self {
        Self(each!(0.0, |i| self.0[i].max(x)))
    }
    #[inline(always)]
    fn negated(self) -> Self {
        Self(each!(0.0, |i| -self.0[i]))
    }
}

impl<const N: usize> PortableU32<N> {
    lanewise!(PortableU32, 0,
        plus: |a, b| a.wrapping_add(b); minus: |a, b| a.wrapping_sub(b); times: |a, b| a.wrapping_mul(b);
        and: |a, b| a & b; or: |a, b| a | b; xor: |a, b| a ^ b;
        smaller: |a, b| a.min(b); greater: |a, b| a.max(b););
    lanewise!(PortableMask, 0,
        is_lt: |a, b| ones(a < b); is_le: |a, b| ones(a <= b); is_gt: |a, b| ones(a > b);
        is_ge: |a, b| ones(a >= b); is_eq: |a, b| ones(a == b); is_ne: |a, b| ones(a != b););
}

impl<const N: usize> PortableMask<N> {
    lanewise!(PortableMask, 0, and: |a, b| a & b; or: |a, b| a | b; xor: |a, b| a ^ b;);
}

float_operators!([const N: usize] PortableF32<N>);
int_operators!([const N: usize] PortableU32<N>);
mask_operators!([const N: usize] PortableMask<N>);

impl<const N: usize> std::ops::Shl<u32> for PortableU32<N> {
    type Output = Self;
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        Self(each!(0, |i| self.0[i] << by))
    }
}

impl<const N: usize> std::ops::Shr<u32> for PortableU32<N> {
    type Output = Self;
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        Self(each!(0, |i| self.0[i] >> by))
    }
}

impl<const N: usize> Select for PortableF32<N> {
    type Mask = PortableMask<N>;
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(each!(0.0, |i| if mask.0[i] != 0 { yes.0[i] } else { no.0[i] }))
    }
}

impl<const N: usize> Select for PortableU32<N> {
    type Mask = PortableMask<N>;
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(each!(0, |i| if mask.0[i] != 0 { yes.0[i] } else { no.0[i] }))
    }
}

impl<const N: usize> MaskLanes for PortableMask<N> {
    #[inline(always)]
    fn splat(self, x: bool) -> Self {
        Self([ones(x); N])
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        let mut bits = 0;
        for i in 0..N {
            bits |= (self.0[i] & 1) << i;
        }
        bits
    }
    #[inline(always)]
    fn any(self) -> bool {
        let mut any = 0;
        for i in 0..N {
            any |= self.0[i];
        }
        any != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        let mut all = u32::MAX;
        for i in 0..N {
            all &= self.0[i];
        }
        all != 0
    }
}

impl<const N: usize> Lanes for PortableF32<N> {
    type Isa = Portable<N>;
    type Int = PortableU32<N>;
    const WIDTH: usize = N;
    const FUSED: bool = false;

    #[inline(always)]
    fn isa(self) -> Portable<N> {
        Portable
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self {
        Self([x; N])
    }
    #[inline(always)]
    fn to_bits(self) -> PortableU32<N> {
        PortableU32(each!(0, |i| self.0[i].to_bits()))
    }
    #[inline(always)]
    fn from_bits(bits: PortableU32<N>) -> Self {
        Self(each!(0.0, |i| f32::from_bits(bits.0[i])))
    }
    #[inline(always)]
    fn to_int(self) -> PortableU32<N> {
        PortableU32(each!(0, |i| Lanes::to_int(self.0[i])))
    }
    #[inline(always)]
    fn extract(self, i: usize) -> f32 {
        self.0[i]
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[..N].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn compress(self, mask: PortableMask<N>) -> Self {
        let mut out = [0.0; N];
        let mut n = 0;
        for i in 0..N {
            // Written whether kept or not: no branch, and `n <= i` keeps it in bounds.
            out[n] = self.0[i];
            n += (mask.0[i] & 1) as usize;
        }
        Self(out)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(each!(0.0, |i| self.0[i].abs()))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(each!(0.0, |i| self.0[i].sqrt()))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(each!(0.0, |i| self.0[i].floor()))
    }
    #[inline(always)]
    fn round_ties_even(self) -> Self {
        Self(each!(0.0, |i| self.0[i].round_ties_even()))
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(each!(0.0, |i| self.0[i] * b.0[i] + c.0[i]))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self(each!(0.0, |i| self.0[i].copysign(sign.0[i])))
    }
    #[inline(always)]
    fn flip_sign(self, sign: Self) -> Self {
        Self(each!(0.0, |i| self.0[i].flip_sign(sign.0[i])))
    }
    #[inline(always)]
    fn is_finite(self) -> PortableMask<N> {
        PortableMask(each!(0, |i| ones(self.0[i].is_finite())))
    }
}

impl<const N: usize> IntLanes for PortableU32<N> {
    type F = PortableF32<N>;
    type Isa = Portable<N>;
    const WIDTH: usize = N;

    #[inline(always)]
    fn isa(self) -> Portable<N> {
        Portable
    }
    #[inline(always)]
    fn splat(self, x: u32) -> Self {
        Self([x; N])
    }
    #[inline(always)]
    fn reverse_bits(self) -> Self {
        Self(each!(0, |i| self.0[i].reverse_bits()))
    }
    #[inline(always)]
    fn signed_to_float(self) -> PortableF32<N> {
        PortableF32(each!(0.0, |i| self.0[i].cast_signed() as f32))
    }
    #[inline(always)]
    fn extract(self, i: usize) -> u32 {
        self.0[i]
    }
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        to[..N].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn compress(self, mask: PortableMask<N>) -> Self {
        let mut out = [0; N];
        let mut n = 0;
        for i in 0..N {
            // Written whether kept or not: no branch, and `n <= i` keeps it in bounds.
            out[n] = self.0[i];
            n += (mask.0[i] & 1) as usize;
        }
        Self(out)
    }
}
