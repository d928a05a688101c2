//! Sixteen lanes in AVX-512 registers, with fused multiply-add and mask registers.
//!
//! Values can only be made from [`Avx512`], which only [`Avx512::detect`] makes. Intrinsics become single
//! instructions when the code around them ends up inside [`Isa::run`]; anywhere else they are calls, slow but sound.
#![expect(unsafe_code, reason = "intrinsics; each is covered by the token that its value was made from")]

#[expect(clippy::wildcard_imports, reason = "the module of intrinsics is the instruction set")]
use std::arch::x86_64::*;

use super::reversal::{BYTES_REVERSED, HIGH_REVERSED, LOW_REVERSED, high_half, low_half};
use super::{IntLanes, Isa, Kernel, Lanes, MaskLanes, Select};

/// Proof that the processor has AVX-512 F, BW, DQ and VL, and what [`super::Avx2`] stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Avx512(());

/// Sixteen floats.
#[derive(Clone, Copy, Debug)]
pub struct F32x16(__m512);

/// Sixteen unsigned integers.
#[derive(Clone, Copy, Debug)]
pub struct U32x16(__m512i);

/// Sixteen truth values, one bit each.
#[derive(Clone, Copy, Debug)]
pub struct Mask16(__mmask16);

/// Calls one intrinsic.
macro_rules! avx512 {
    ($call:expr) => {
        // SAFETY: the value or token this is called on exists only where `Avx512::detect` found the instructions.
        unsafe { $call }
    };
}

/// Methods that are one intrinsic of two operands.
macro_rules! binary {
    ($($name:ident => $out:ident($f:expr);)*) => {
        $(#[inline(always)]
        fn $name(self, rhs: Self) -> $out {
            $out(avx512!($f(self.0, rhs.0)))
        })*
    };
}

impl Avx512 {
    /// The token, if this processor and operating system have the instructions.
    #[must_use]
    pub fn detect() -> Option<Self> {
        let there = super::Avx2::detect().is_some()
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        there.then_some(Self(()))
    }
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn enter<K: Kernel<Avx512>>(isa: Avx512, kernel: K) -> K::Output {
    kernel.run(isa)
}

impl Isa for Avx512 {
    type F = F32x16;
    type I = U32x16;
    type M = Mask16;
    const WIDTH: usize = 16;
    const NAME: &'static str = "avx512";

    #[inline]
    fn run<K: Kernel<Self>>(self, kernel: K) -> K::Output {
        avx512!(enter(self, kernel))
    }
    #[inline(always)]
    fn splat(self, x: f32) -> F32x16 {
        F32x16(avx512!(_mm512_set1_ps(x)))
    }
    #[inline(always)]
    fn splat_u32(self, x: u32) -> U32x16 {
        U32x16(avx512!(_mm512_set1_epi32(x.cast_signed())))
    }
    #[inline(always)]
    fn splat_mask(self, x: bool) -> Mask16 {
        Mask16(u16::from(x).wrapping_neg())
    }
    #[inline(always)]
    fn load(self, from: &[f32]) -> F32x16 {
        let from = &from[..16];
        // SAFETY: `from` has sixteen elements; the token stands for the instruction.
        F32x16(unsafe { _mm512_loadu_ps(from.as_ptr()) })
    }
    #[inline(always)]
    fn load_u32(self, from: &[u32]) -> U32x16 {
        let from = &from[..16];
        // SAFETY: `from` has sixteen elements; the token stands for the instruction.
        U32x16(unsafe { _mm512_loadu_si512(from.as_ptr().cast()) })
    }
    #[inline(always)]
    fn iota(self) -> U32x16 {
        U32x16(avx512!(_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)))
    }
    #[inline(always)]
    fn gather(self, table: &[f32], index: U32x16) -> F32x16 {
        let (zero, inside) = (self.splat(0.0), index.inside(table.len()));
        // SAFETY: only the lanes with an index below the length are read; those fit i32.
        F32x16(unsafe { _mm512_mask_i32gather_ps::<4>(zero.0, inside.0, index.0, table.as_ptr()) })
    }
    #[inline(always)]
    fn gather_u32(self, table: &[u32], index: U32x16) -> U32x16 {
        let (zero, inside) = (self.splat_u32(0), index.inside(table.len()));
        // SAFETY: only the lanes with an index below the length are read; those fit i32.
        U32x16(unsafe { _mm512_mask_i32gather_epi32::<4>(zero.0, inside.0, index.0, table.as_ptr().cast()) })
    }
    #[inline(always)]
    fn per_lane(self, mut f: impl FnMut(usize) -> f32) -> F32x16 {
        let mut lanes = [0.0; 16];
        for (i, lane) in lanes.iter_mut().enumerate() {
            *lane = f(i);
        }
        self.load(&lanes)
    }
    #[inline(always)]
    fn per_lane_u32(self, mut f: impl FnMut(usize) -> u32) -> U32x16 {
        let mut lanes = [0; 16];
        for (i, lane) in lanes.iter_mut().enumerate() {
            *lane = f(i);
        }
        self.load_u32(&lanes)
    }
}

impl Mask16 {
    #[inline(always)]
    fn and(self, rhs: Self) -> Self {
        Self(self.0 & rhs.0)
    }
    #[inline(always)]
    fn or(self, rhs: Self) -> Self {
        Self(self.0 | rhs.0)
    }
    #[inline(always)]
    fn xor(self, rhs: Self) -> Self {
        Self(self.0 ^ rhs.0)
    }
}

impl F32x16 {
    binary! {
        plus => F32x16(_mm512_add_ps);
        minus => F32x16(_mm512_sub_ps);
        times => F32x16(_mm512_mul_ps);
        over => F32x16(_mm512_div_ps);
        is_lt => Mask16(_mm512_cmp_ps_mask::<_CMP_LT_OQ>);
        is_le => Mask16(_mm512_cmp_ps_mask::<_CMP_LE_OQ>);
        is_gt => Mask16(_mm512_cmp_ps_mask::<_CMP_GT_OQ>);
        is_ge => Mask16(_mm512_cmp_ps_mask::<_CMP_GE_OQ>);
        is_eq => Mask16(_mm512_cmp_ps_mask::<_CMP_EQ_OQ>);
        is_ne => Mask16(_mm512_cmp_ps_mask::<_CMP_NEQ_UQ>);
        // The instructions give the right operand if either is NaN.
        smaller_or_right => F32x16(_mm512_min_ps);
        greater_or_right => F32x16(_mm512_max_ps);
        bits_and => F32x16(_mm512_and_ps);
        bits_and_not => F32x16(_mm512_andnot_ps);
        bits_or => F32x16(_mm512_or_ps);
        bits_xor => F32x16(_mm512_xor_ps);
    }
    #[inline(always)]
    fn smaller(self, rhs: Self) -> Self {
        Self::select(rhs.is_ne(rhs), self, self.smaller_or_right(rhs))
    }
    #[inline(always)]
    fn greater(self, rhs: Self) -> Self {
        Self::select(rhs.is_ne(rhs), self, self.greater_or_right(rhs))
    }
    #[inline(always)]
    fn at_most(self, x: f32) -> Self {
        if x.is_nan() { self } else { self.smaller_or_right(self.splat(x)) }
    }
    #[inline(always)]
    fn at_least(self, x: f32) -> Self {
        if x.is_nan() { self } else { self.greater_or_right(self.splat(x)) }
    }
    #[inline(always)]
    fn negated(self) -> Self {
        self.bits_xor(self.splat(-0.0))
    }
}

impl U32x16 {
    binary! {
        plus => U32x16(_mm512_add_epi32);
        minus => U32x16(_mm512_sub_epi32);
        times => U32x16(_mm512_mullo_epi32);
        and => U32x16(_mm512_and_si512);
        or => U32x16(_mm512_or_si512);
        xor => U32x16(_mm512_xor_si512);
        smaller => U32x16(_mm512_min_epu32);
        greater => U32x16(_mm512_max_epu32);
        is_lt => Mask16(_mm512_cmplt_epu32_mask);
        is_le => Mask16(_mm512_cmple_epu32_mask);
        is_gt => Mask16(_mm512_cmpgt_epu32_mask);
        is_ge => Mask16(_mm512_cmpge_epu32_mask);
        is_eq => Mask16(_mm512_cmpeq_epu32_mask);
        is_ne => Mask16(_mm512_cmpneq_epu32_mask);
        shuffle_bytes => U32x16(_mm512_shuffle_epi8);
    }
    /// The lanes that index a table of length `len`, where a signed index can.
    #[inline(always)]
    fn inside(self, len: usize) -> Mask16 {
        let len = u32::try_from(len.min(i32::MAX as usize)).unwrap_or(0);
        self.is_lt(self.splat(len))
    }
    /// Sixteen bytes, in each quarter of the register.
    #[inline(always)]
    fn bytes_four_times(self, bytes: [u8; 16]) -> Self {
        let quarter = avx512!(_mm_set_epi64x(high_half(bytes), low_half(bytes)));
        Self(avx512!(_mm512_broadcast_i32x4(quarter)))
    }
}

float_operators!([] F32x16);
int_operators!([] U32x16);
mask_operators!([] Mask16);

impl std::ops::Shl<u32> for U32x16 {
    type Output = Self;
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        let by = avx512!(_mm_cvtsi32_si128(by.cast_signed()));
        Self(avx512!(_mm512_sll_epi32(self.0, by)))
    }
}

impl std::ops::Shr<u32> for U32x16 {
    type Output = Self;
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        let by = avx512!(_mm_cvtsi32_si128(by.cast_signed()));
        Self(avx512!(_mm512_srl_epi32(self.0, by)))
    }
}

impl Select for F32x16 {
    type Mask = Mask16;
    #[inline(always)]
    fn select(mask: Mask16, yes: Self, no: Self) -> Self {
        Self(avx512!(_mm512_mask_blend_ps(mask.0, no.0, yes.0)))
    }
}

impl Select for U32x16 {
    type Mask = Mask16;
    #[inline(always)]
    fn select(mask: Mask16, yes: Self, no: Self) -> Self {
        Self(avx512!(_mm512_mask_blend_epi32(mask.0, no.0, yes.0)))
    }
}

impl MaskLanes for Mask16 {
    #[inline(always)]
    fn splat(self, x: bool) -> Self {
        Avx512(()).splat_mask(x)
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self.0)
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.0 == u16::MAX
    }
}

impl Lanes for F32x16 {
    type Isa = Avx512;
    type Int = U32x16;
    const WIDTH: usize = 16;
    const FUSED: bool = true;

    #[inline(always)]
    fn isa(self) -> Avx512 {
        Avx512(())
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self {
        self.isa().splat(x)
    }
    #[inline(always)]
    fn to_bits(self) -> U32x16 {
        U32x16(avx512!(_mm512_castps_si512(self.0)))
    }
    #[inline(always)]
    fn from_bits(bits: U32x16) -> Self {
        Self(avx512!(_mm512_castsi512_ps(bits.0)))
    }
    #[inline(always)]
    fn to_int(self) -> U32x16 {
        U32x16(avx512!(_mm512_cvttps_epi32(self.0)))
    }
    #[inline(always)]
    fn extract(self, i: usize) -> f32 {
        let mut lanes = [0.0; 16];
        self.store(&mut lanes);
        lanes[i]
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        let to = &mut to[..16];
        // SAFETY: `to` has sixteen elements; the value stands for the instruction.
        unsafe { _mm512_storeu_ps(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn compress(self, mask: Mask16) -> Self {
        Self(avx512!(_mm512_maskz_compress_ps(mask.0, self.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.splat(-0.0).bits_and_not(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(avx512!(_mm512_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(avx512!(_mm512_roundscale_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn round_ties_even(self) -> Self {
        Self(avx512!(_mm512_roundscale_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(avx512!(_mm512_fmadd_ps(self.0, b.0, c.0)))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.abs().bits_or(sign.bits_and(self.splat(-0.0)))
    }
    #[inline(always)]
    fn flip_sign(self, sign: Self) -> Self {
        self.bits_xor(sign.bits_and(self.splat(-0.0)))
    }
    #[inline(always)]
    fn is_finite(self) -> Mask16 {
        self.abs().is_lt(self.splat(f32::INFINITY))
    }
}

impl IntLanes for U32x16 {
    type F = F32x16;
    type Isa = Avx512;
    const WIDTH: usize = 16;

    #[inline(always)]
    fn isa(self) -> Avx512 {
        Avx512(())
    }
    #[inline(always)]
    fn splat(self, x: u32) -> Self {
        self.isa().splat_u32(x)
    }
    /// The bytes are reversed by one shuffle; the bits of each by looking up its halves.
    #[inline(always)]
    fn reverse_bits(self) -> Self {
        let bytes = self.shuffle_bytes(self.bytes_four_times(BYTES_REVERSED));
        let low = self.bytes_four_times(LOW_REVERSED).shuffle_bytes(bytes & 0x0F0F_0F0F);
        let high = self.bytes_four_times(HIGH_REVERSED).shuffle_bytes((bytes >> 4) & 0x0F0F_0F0F);
        low | high
    }
    #[inline(always)]
    fn signed_to_float(self) -> F32x16 {
        F32x16(avx512!(_mm512_cvtepi32_ps(self.0)))
    }
    #[inline(always)]
    fn extract(self, i: usize) -> u32 {
        let mut lanes = [0; 16];
        self.store(&mut lanes);
        lanes[i]
    }
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        let to = &mut to[..16];
        // SAFETY: `to` has sixteen elements; the value stands for the instruction.
        unsafe { _mm512_storeu_si512(to.as_mut_ptr().cast(), self.0) }
    }
    #[inline(always)]
    fn compress(self, mask: Mask16) -> Self {
        Self(avx512!(_mm512_maskz_compress_epi32(mask.0, self.0)))
    }
}
