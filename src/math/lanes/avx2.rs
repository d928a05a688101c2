//! Eight lanes in AVX2 registers, with fused multiply-add.
//!
//! Values can only be made from [`Avx2`], which only [`Avx2::detect`] makes. Intrinsics become single instructions
//! when the code around them ends up inside [`Isa::run`]; anywhere else they are calls, slow but sound.
#![expect(unsafe_code, reason = "intrinsics; each is covered by the token that its value was made from")]

#[expect(clippy::wildcard_imports, reason = "the module of intrinsics is the instruction set")]
use std::arch::x86_64::*;

use super::reversal::{BYTES_REVERSED, HIGH_REVERSED, LOW_REVERSED, high_half, low_half};
use super::{IntLanes, Isa, Kernel, Lanes, MaskLanes, Select};

/// Proof that the processor has AVX2, FMA, BMI 1 and 2, LZCNT and POPCNT.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Avx2(());

/// Eight floats.
#[derive(Clone, Copy, Debug)]
pub struct F32x8(__m256);

/// Eight unsigned integers.
#[derive(Clone, Copy, Debug)]
pub struct U32x8(__m256i);

/// Eight truth values: all bits of a lane set, or none.
#[derive(Clone, Copy, Debug)]
pub struct Mask8(__m256);

/// Calls one intrinsic.
macro_rules! avx2 {
    ($call:expr) => {
        // SAFETY: the value or token this is called on exists only where `Avx2::detect` found the instructions.
        unsafe { $call }
    };
}

/// Methods that are one intrinsic of two operands.
macro_rules! binary {
    ($($name:ident => $out:ident($f:expr);)*) => {
        $(#[inline(always)]
        fn $name(self, rhs: Self) -> $out {
            $out(avx2!($f(self.0, rhs.0)))
        })*
    };
}

impl Avx2 {
    /// The token, if this processor and operating system have the instructions.
    #[must_use]
    pub fn detect() -> Option<Self> {
        let there = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        there.then_some(Self(()))
    }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn enter<K: Kernel<Avx2>>(isa: Avx2, kernel: K) -> K::Output {
    kernel.run(isa)
}

impl Isa for Avx2 {
    type F = F32x8;
    type I = U32x8;
    type M = Mask8;
    const WIDTH: usize = 8;
    const NAME: &'static str = "avx2";

    #[inline]
    fn run<K: Kernel<Self>>(self, kernel: K) -> K::Output {
        avx2!(enter(self, kernel))
    }
    #[inline(always)]
    fn splat(self, x: f32) -> F32x8 {
        F32x8(avx2!(_mm256_set1_ps(x)))
    }
    #[inline(always)]
    fn splat_u32(self, x: u32) -> U32x8 {
        U32x8(avx2!(_mm256_set1_epi32(x.cast_signed())))
    }
    #[inline(always)]
    fn splat_mask(self, x: bool) -> Mask8 {
        Mask8(self.splat(f32::from_bits(if x { u32::MAX } else { 0 })).0)
    }
    #[inline(always)]
    fn load(self, from: &[f32]) -> F32x8 {
        let from = &from[..8];
        // SAFETY: `from` has eight elements; the token stands for the instruction.
        F32x8(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }
    #[inline(always)]
    fn load_u32(self, from: &[u32]) -> U32x8 {
        let from = &from[..8];
        // SAFETY: `from` has eight elements; the token stands for the instruction.
        U32x8(unsafe { _mm256_loadu_si256(from.as_ptr().cast()) })
    }
    #[inline(always)]
    fn iota(self) -> U32x8 {
        U32x8(avx2!(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)))
    }
    #[inline(always)]
    fn gather(self, table: &[f32], index: U32x8) -> F32x8 {
        let (zero, inside) = (self.splat(0.0), index.inside(table.len()));
        // SAFETY: only the lanes with an index below the length are read; those fit i32.
        F32x8(unsafe { _mm256_mask_i32gather_ps::<4>(zero.0, table.as_ptr(), index.0, inside.0) })
    }
    #[inline(always)]
    fn gather_u32(self, table: &[u32], index: U32x8) -> U32x8 {
        let (zero, inside) = (self.splat_u32(0), index.inside(table.len()).to_int());
        // SAFETY: only the lanes with an index below the length are read; those fit i32.
        U32x8(unsafe { _mm256_mask_i32gather_epi32::<4>(zero.0, table.as_ptr().cast(), index.0, inside.0) })
    }
    #[inline(always)]
    fn per_lane(self, mut f: impl FnMut(usize) -> f32) -> F32x8 {
        let mut lanes = [0.0; 8];
        for (i, lane) in lanes.iter_mut().enumerate() {
            *lane = f(i);
        }
        self.load(&lanes)
    }
    #[inline(always)]
    fn per_lane_u32(self, mut f: impl FnMut(usize) -> u32) -> U32x8 {
        let mut lanes = [0; 8];
        for (i, lane) in lanes.iter_mut().enumerate() {
            *lane = f(i);
        }
        self.load_u32(&lanes)
    }
}

/// For each mask of eight, which lanes are set, in order.
static SET_LANES: [[u8; 8]; 256] = set_lanes();

const fn set_lanes() -> [[u8; 8]; 256] {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut n) = (0_u8, 0);
        while lane < 8 {
            if mask >> lane & 1 != 0 {
                table[mask][n] = lane;
                n += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
}

impl Mask8 {
    #[inline(always)]
    fn to_int(self) -> U32x8 {
        U32x8(avx2!(_mm256_castps_si256(self.0)))
    }
    /// The permutation that brings the set lanes to the front.
    #[inline(always)]
    fn packing(self) -> __m256i {
        let lanes = u64::from_le_bytes(SET_LANES[(self.bits() & 0xFF) as usize]);
        let lanes = avx2!(_mm_cvtsi64_si128(lanes.cast_signed()));
        avx2!(_mm256_cvtepu8_epi32(lanes))
    }
    binary! {
        and => Mask8(_mm256_and_ps);
        or => Mask8(_mm256_or_ps);
        xor => Mask8(_mm256_xor_ps);
    }
}

impl F32x8 {
    binary! {
        plus => F32x8(_mm256_add_ps);
        minus => F32x8(_mm256_sub_ps);
        times => F32x8(_mm256_mul_ps);
        over => F32x8(_mm256_div_ps);
        is_lt => Mask8(_mm256_cmp_ps::<_CMP_LT_OQ>);
        is_le => Mask8(_mm256_cmp_ps::<_CMP_LE_OQ>);
        is_gt => Mask8(_mm256_cmp_ps::<_CMP_GT_OQ>);
        is_ge => Mask8(_mm256_cmp_ps::<_CMP_GE_OQ>);
        is_eq => Mask8(_mm256_cmp_ps::<_CMP_EQ_OQ>);
        is_ne => Mask8(_mm256_cmp_ps::<_CMP_NEQ_UQ>);
        // The instructions give the right operand if either is NaN.
        smaller_or_right => F32x8(_mm256_min_ps);
        greater_or_right => F32x8(_mm256_max_ps);
        bits_and => F32x8(_mm256_and_ps);
        bits_and_not => F32x8(_mm256_andnot_ps);
        bits_or => F32x8(_mm256_or_ps);
        bits_xor => F32x8(_mm256_xor_ps);
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

impl U32x8 {
    binary! {
        plus => U32x8(_mm256_add_epi32);
        minus => U32x8(_mm256_sub_epi32);
        times => U32x8(_mm256_mullo_epi32);
        and => U32x8(_mm256_and_si256);
        or => U32x8(_mm256_or_si256);
        xor => U32x8(_mm256_xor_si256);
        smaller => U32x8(_mm256_min_epu32);
        greater => U32x8(_mm256_max_epu32);
        equal => U32x8(_mm256_cmpeq_epi32);
        greater_signed => U32x8(_mm256_cmpgt_epi32);
        shuffle_bytes => U32x8(_mm256_shuffle_epi8);
    }
    #[inline(always)]
    fn to_mask(self) -> Mask8 {
        Mask8(F32x8::from_bits(self).0)
    }
    #[inline(always)]
    fn is_eq(self, rhs: Self) -> Mask8 {
        self.equal(rhs).to_mask()
    }
    #[inline(always)]
    fn is_ne(self, rhs: Self) -> Mask8 {
        !self.is_eq(rhs)
    }
    /// There is only a signed comparison: turning the highest bit maps one order to the other.
    #[inline(always)]
    fn is_gt(self, rhs: Self) -> Mask8 {
        (self ^ 0x8000_0000).greater_signed(rhs ^ 0x8000_0000).to_mask()
    }
    #[inline(always)]
    fn is_lt(self, rhs: Self) -> Mask8 {
        rhs.is_gt(self)
    }
    #[inline(always)]
    fn is_ge(self, rhs: Self) -> Mask8 {
        self.greater(rhs).is_eq(self)
    }
    #[inline(always)]
    fn is_le(self, rhs: Self) -> Mask8 {
        self.smaller(rhs).is_eq(self)
    }
    /// The lanes that index a table of length `len`, where a signed index can.
    #[inline(always)]
    fn inside(self, len: usize) -> Mask8 {
        let len = u32::try_from(len.min(i32::MAX as usize)).unwrap_or(0);
        self.is_lt(self.splat(len))
    }
    /// Sixteen bytes, in both halves of the register.
    #[inline(always)]
    fn bytes_twice(self, bytes: [u8; 16]) -> Self {
        let (low, high) = (low_half(bytes), high_half(bytes));
        Self(avx2!(_mm256_setr_epi64x(low, high, low, high)))
    }
}

float_operators!([] F32x8);
int_operators!([] U32x8);
mask_operators!([] Mask8);

impl std::ops::Shl<u32> for U32x8 {
    type Output = Self;
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        let by = avx2!(_mm_cvtsi32_si128(by.cast_signed()));
        Self(avx2!(_mm256_sll_epi32(self.0, by)))
    }
}

impl std::ops::Shr<u32> for U32x8 {
    type Output = Self;
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        let by = avx2!(_mm_cvtsi32_si128(by.cast_signed()));
        Self(avx2!(_mm256_srl_epi32(self.0, by)))
    }
}

impl Select for F32x8 {
    type Mask = Mask8;
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(avx2!(_mm256_blendv_ps(no.0, yes.0, mask.0)))
    }
}

impl Select for U32x8 {
    type Mask = Mask8;
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        F32x8::select(mask, F32x8::from_bits(yes), F32x8::from_bits(no)).to_bits()
    }
}

impl MaskLanes for Mask8 {
    #[inline(always)]
    fn splat(self, x: bool) -> Self {
        Avx2(()).splat_mask(x)
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        avx2!(_mm256_movemask_ps(self.0)).cast_unsigned()
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.bits() == 0xFF
    }
}

impl Lanes for F32x8 {
    type Isa = Avx2;
    type Int = U32x8;
    const WIDTH: usize = 8;
    const FUSED: bool = true;

    #[inline(always)]
    fn isa(self) -> Avx2 {
        Avx2(())
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self {
        self.isa().splat(x)
    }
    #[inline(always)]
    fn to_bits(self) -> U32x8 {
        U32x8(avx2!(_mm256_castps_si256(self.0)))
    }
    #[inline(always)]
    fn from_bits(bits: U32x8) -> Self {
        Self(avx2!(_mm256_castsi256_ps(bits.0)))
    }
    #[inline(always)]
    fn to_int(self) -> U32x8 {
        U32x8(avx2!(_mm256_cvttps_epi32(self.0)))
    }
    #[inline(always)]
    fn extract(self, i: usize) -> f32 {
        let mut lanes = [0.0; 8];
        self.store(&mut lanes);
        lanes[i]
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        let to = &mut to[..8];
        // SAFETY: `to` has eight elements; the value stands for the instruction.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn compress(self, mask: Mask8) -> Self {
        let packing = mask.packing();
        Self(avx2!(_mm256_permutevar8x32_ps(self.0, packing)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.splat(-0.0).bits_and_not(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(avx2!(_mm256_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(avx2!(_mm256_floor_ps(self.0)))
    }
    #[inline(always)]
    fn round_ties_even(self) -> Self {
        Self(avx2!(_mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(avx2!(_mm256_fmadd_ps(self.0, b.0, c.0)))
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
    fn is_finite(self) -> Mask8 {
        self.abs().is_lt(self.splat(f32::INFINITY))
    }
}

impl IntLanes for U32x8 {
    type F = F32x8;
    type Isa = Avx2;
    const WIDTH: usize = 8;

    #[inline(always)]
    fn isa(self) -> Avx2 {
        Avx2(())
    }
    #[inline(always)]
    fn splat(self, x: u32) -> Self {
        self.isa().splat_u32(x)
    }
    /// The bytes are reversed by one shuffle; the bits of each by looking up its halves.
    #[inline(always)]
    fn reverse_bits(self) -> Self {
        let bytes = self.shuffle_bytes(self.bytes_twice(BYTES_REVERSED));
        let low = self.bytes_twice(LOW_REVERSED).shuffle_bytes(bytes & 0x0F0F_0F0F);
        let high = self.bytes_twice(HIGH_REVERSED).shuffle_bytes((bytes >> 4) & 0x0F0F_0F0F);
        low | high
    }
    #[inline(always)]
    fn signed_to_float(self) -> F32x8 {
        F32x8(avx2!(_mm256_cvtepi32_ps(self.0)))
    }
    #[inline(always)]
    fn extract(self, i: usize) -> u32 {
        let mut lanes = [0; 8];
        self.store(&mut lanes);
        lanes[i]
    }
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        let to = &mut to[..8];
        // SAFETY: `to` has eight elements; the value stands for the instruction.
        unsafe { _mm256_storeu_si256(to.as_mut_ptr().cast(), self.0) }
    }
    #[inline(always)]
    fn compress(self, mask: Mask8) -> Self {
        let packing = mask.packing();
        Self(avx2!(_mm256_permutevar8x32_epi32(self.0, packing)))
    }
}
