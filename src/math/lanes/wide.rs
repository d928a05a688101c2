//! Eight lanes in AVX2 registers and sixteen in AVX-512 registers, with fused multiply-add.
//!
//! The types are those of the crate `fearless_simd`, whose values carry their token as well; a newtype gives them this
//! folder's vocabulary. The crate finds AVX-512 only where the whole set of Ice Lake is present; earlier processors run
//! AVX2.

use fearless_simd::{Bytes, Level, Select as _, Simd, SimdBase, SimdFloat, SimdInt, SimdMask};

use super::gather;
use super::{IntLanes, Isa, Kernel, Lanes, MaskLanes, Select};

/// Byte tables that reverse the bits of words: the bytes of four words in reverse order, and the halves of a byte, the
/// upper of which becomes the lower.
const BYTES_REVERSED: [u8; 16] = [3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12];
const UPPER_REVERSED: [u8; 16] = [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15];
const LOWER_REVERSED: [u8; 16] = [0, 128, 64, 192, 32, 160, 96, 224, 16, 144, 80, 208, 48, 176, 112, 240];

/// Methods that are one operator or method of the type beneath.
macro_rules! forward {
    ($($name:ident => $out:ident(|$a:ident, $b:ident| $value:expr);)*) => {
        $(#[inline(always)]
        fn $name(self, rhs: Self) -> $out {
            let ($a, $b) = (self.0, rhs.0);
            $out($value)
        })*
    };
}

/// The token, the types and all their operations for one instruction set.
macro_rules! backend {
    (
        $isa:ident = $name:literal, $width:literal lanes, found by $found:ident;
        $float:ident = $f32:ident; $int:ident = $u32:ident, $i32:ident, $u8:ident; $mask:ident = $mask32:ident;
        gather $gather_f32:ident, $gather_u32:ident, $gather_rows:ident, $gather_quads:ident
    ) => {
        #[doc = concat!("Proof that the processor has what the level `", $name, "` needs.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $isa(fearless_simd::$isa);

        #[doc = concat!(stringify!($width), " floats.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $float(fearless_simd::$f32<fearless_simd::$isa>);

        #[doc = concat!(stringify!($width), " unsigned integers.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $int(fearless_simd::$u32<fearless_simd::$isa>);

        #[doc = concat!(stringify!($width), " truth values.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $mask(fearless_simd::$mask32<fearless_simd::$isa>);

        impl $isa {
            /// The token, if this processor and operating system have the instructions.
            #[must_use]
            pub fn detect() -> Option<Self> {
                Level::new().$found().map(Self)
            }
        }

        impl Isa for $isa {
            type F = $float;
            type I = $int;
            type M = $mask;
            const WIDTH: usize = $width;
            const NAME: &'static str = $name;

            #[inline]
            fn run<K: Kernel<Self>>(self, kernel: K) -> K::Output {
                self.0.vectorize(
                    #[inline(always)]
                    || kernel.run(self),
                )
            }
            #[inline(always)]
            fn splat(self, x: f32) -> $float {
                $float(SimdBase::splat(self.0, x))
            }
            #[inline(always)]
            fn splat_u32(self, x: u32) -> $int {
                $int(SimdBase::splat(self.0, x))
            }
            #[inline(always)]
            fn splat_mask(self, x: bool) -> $mask {
                $mask(SimdMask::splat(self.0, x))
            }
            #[inline(always)]
            fn load(self, from: &[f32]) -> $float {
                $float(SimdBase::from_slice(self.0, &from[..$width]))
            }
            #[inline(always)]
            fn load_u32(self, from: &[u32]) -> $int {
                $int(SimdBase::from_slice(self.0, &from[..$width]))
            }
            #[inline(always)]
            fn iota(self) -> $int {
                const COUNT: [u32; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
                self.load_u32(&COUNT)
            }
            #[inline(always)]
            fn gather(self, table: &[f32], index: $int) -> $float {
                $float(gather::$gather_f32(self.0, table, index.0))
            }
            #[inline(always)]
            fn gather_u32(self, table: &[u32], index: $int) -> $int {
                $int(gather::$gather_u32(self.0, table, index.0))
            }
            #[inline(always)]
            fn gather_rows(self, table: &[[f32; 3]], index: $int) -> [$float; 3] {
                let [a, b, c] = gather::$gather_rows(self.0, table, index.0);
                [$float(a), $float(b), $float(c)]
            }
            #[inline(always)]
            fn gather_quads(self, table: &[[f32; 4]], index: $int) -> [$float; 4] {
                let [a, b, c, d] = gather::$gather_quads(self.0, table, index.0);
                [$float(a), $float(b), $float(c), $float(d)]
            }
            #[inline(always)]
            fn per_lane(self, mut f: impl FnMut(usize) -> f32) -> $float {
                let mut lanes = [0.0; $width];
                for (i, lane) in lanes.iter_mut().enumerate() {
                    *lane = f(i);
                }
                self.load(&lanes)
            }
            #[inline(always)]
            fn per_lane_u32(self, mut f: impl FnMut(usize) -> u32) -> $int {
                let mut lanes = [0; $width];
                for (i, lane) in lanes.iter_mut().enumerate() {
                    *lane = f(i);
                }
                self.load_u32(&lanes)
            }
        }

        impl $mask {
            forward! {
                and => $mask(|a, b| a & b);
                or => $mask(|a, b| a | b);
                xor => $mask(|a, b| a ^ b);
            }
        }

        impl $float {
            forward! {
                plus => $float(|a, b| a + b);
                minus => $float(|a, b| a - b);
                times => $float(|a, b| a * b);
                over => $float(|a, b| a / b);
                is_lt => $mask(|a, b| a.simd_lt(b));
                is_le => $mask(|a, b| a.simd_le(b));
                is_gt => $mask(|a, b| a.simd_gt(b));
                is_ge => $mask(|a, b| a.simd_ge(b));
                is_eq => $mask(|a, b| a.simd_eq(b));
                is_ne => $mask(|a, b| a.simd_ne(b));
                smaller => $float(|a, b| a.min_precise(b));
                greater => $float(|a, b| a.max_precise(b));
            }
            /// The instruction gives the right operand if either is NaN.
            #[inline(always)]
            fn at_most(self, x: f32) -> Self {
                if x.is_nan() { self } else { Self(self.0.min(x)) }
            }
            #[inline(always)]
            fn at_least(self, x: f32) -> Self {
                if x.is_nan() { self } else { Self(self.0.max(x)) }
            }
            #[inline(always)]
            fn negated(self) -> Self {
                Self(-self.0)
            }
        }

        impl $int {
            forward! {
                plus => $int(|a, b| a + b);
                minus => $int(|a, b| a - b);
                times => $int(|a, b| a * b);
                and => $int(|a, b| a & b);
                or => $int(|a, b| a | b);
                xor => $int(|a, b| a ^ b);
                is_lt => $mask(|a, b| a.simd_lt(b));
                is_le => $mask(|a, b| a.simd_le(b));
                is_gt => $mask(|a, b| a.simd_gt(b));
                is_ge => $mask(|a, b| a.simd_ge(b));
                is_eq => $mask(|a, b| a.simd_eq(b));
                is_ne => $mask(|a, b| a.simd_ne(b));
                smaller => $int(|a, b| a.min(b));
                greater => $int(|a, b| a.max(b));
            }
            /// Sixteen bytes, repeated.
            #[inline(always)]
            fn repeated(self, bytes: [u8; 16]) -> fearless_simd::$u8<fearless_simd::$isa> {
                SimdBase::block_splat(SimdBase::from_slice(self.isa().0, &bytes))
            }
        }

        float_operators!([] $float);
        int_operators!([] $int);
        mask_operators!([] $mask);

        impl std::ops::Shl<u32> for $int {
            type Output = Self;
            #[inline(always)]
            fn shl(self, by: u32) -> Self {
                Self(self.0 << by)
            }
        }

        impl std::ops::Shr<u32> for $int {
            type Output = Self;
            #[inline(always)]
            fn shr(self, by: u32) -> Self {
                Self(self.0 >> by)
            }
        }

        impl Select for $float {
            type Mask = $mask;
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                Self(mask.0.select(yes.0, no.0))
            }
        }

        impl Select for $int {
            type Mask = $mask;
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                Self(mask.0.select(yes.0, no.0))
            }
        }

        impl MaskLanes for $mask {
            #[inline(always)]
            fn splat(self, x: bool) -> Self {
                Self(SimdMask::splat(fearless_simd::ExtractToken::token(&self.0), x))
            }
            #[inline(always)]
            #[expect(clippy::cast_possible_truncation, reason = "at most sixteen bits are set")]
            fn bits(self) -> u32 {
                self.0.to_bitmask() as u32
            }
            #[inline(always)]
            fn any(self) -> bool {
                self.0.any_true()
            }
            #[inline(always)]
            fn all(self) -> bool {
                self.0.all_true()
            }
        }

        impl Lanes for $float {
            type Isa = $isa;
            type Int = $int;
            const WIDTH: usize = $width;
            const FUSED: bool = true;

            #[inline(always)]
            fn isa(self) -> $isa {
                $isa(fearless_simd::ExtractToken::token(&self.0))
            }
            #[inline(always)]
            fn splat(self, x: f32) -> Self {
                self.isa().splat(x)
            }
            #[inline(always)]
            fn to_bits(self) -> $int {
                $int(self.0.bitcast())
            }
            #[inline(always)]
            fn from_bits(bits: $int) -> Self {
                Self(bits.0.bitcast())
            }
            #[inline(always)]
            fn to_int(self) -> $int {
                let signed: fearless_simd::$i32<_> = self.0.to_int();
                $int(signed.bitcast())
            }
            #[inline(always)]
            fn extract(self, i: usize) -> f32 {
                self.0[i]
            }
            #[inline(always)]
            fn store(self, to: &mut [f32]) {
                self.0.store_slice(&mut to[..$width]);
            }
            #[inline(always)]
            fn compress(self, mask: $mask) -> Self {
                Self(self.0.compress(mask.0))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self(self.0.abs())
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }
            #[inline(always)]
            fn floor(self) -> Self {
                Self(self.0.floor())
            }
            #[inline(always)]
            fn round_ties_even(self) -> Self {
                Self(self.0.round_ties_even())
            }
            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                Self(self.0.mul_add(b.0, c.0))
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                Self(self.0.copysign(sign.0))
            }
            #[inline(always)]
            fn flip_sign(self, sign: Self) -> Self {
                Self::from_bits(self.to_bits() ^ (sign.to_bits() & 0x8000_0000))
            }
            #[inline(always)]
            fn is_finite(self) -> $mask {
                self.abs().is_lt(self.splat(f32::INFINITY))
            }
        }

        impl IntLanes for $int {
            type F = $float;
            type Isa = $isa;
            const WIDTH: usize = $width;

            #[inline(always)]
            fn isa(self) -> $isa {
                $isa(fearless_simd::ExtractToken::token(&self.0))
            }
            #[inline(always)]
            fn splat(self, x: u32) -> Self {
                self.isa().splat_u32(x)
            }
            /// The bytes are reversed by one shuffle; the bits of each by looking up its halves.
            #[inline(always)]
            fn reverse_bits(self) -> Self {
                let bytes: fearless_simd::$u8<_> = self.0.bitcast();
                let bytes = bytes.swizzle_dyn_within_blocks(self.repeated(BYTES_REVERSED));
                let lower = self.repeated(LOWER_REVERSED).swizzle_dyn_within_blocks(bytes & 0x0F);
                let upper = self.repeated(UPPER_REVERSED).swizzle_dyn_within_blocks(bytes >> 4);
                Self((lower | upper).bitcast())
            }
            #[inline(always)]
            fn signed_to_float(self) -> $float {
                let signed: fearless_simd::$i32<_> = self.0.bitcast();
                $float(signed.to_float())
            }
            #[inline(always)]
            fn extract(self, i: usize) -> u32 {
                self.0[i]
            }
            #[inline(always)]
            fn store(self, to: &mut [u32]) {
                self.0.store_slice(&mut to[..$width]);
            }
            #[inline(always)]
            fn compress(self, mask: $mask) -> Self {
                Self(self.0.compress(mask.0))
            }
        }
    };
}

backend!(
    Avx2 = "avx2", 8 lanes, found by as_avx2;
    F32x8 = f32x8; U32x8 = u32x8, i32x8, u8x32; Mask8 = mask32x8;
    gather eight_f32, eight_u32, eight_rows, eight_quads
);
backend!(
    Avx512 = "avx512", 16 lanes, found by as_avx512;
    F32x16 = f32x16; U32x16 = u32x16, i32x16, u8x64; Mask16 = mask32x16;
    gather sixteen_f32, sixteen_u32, sixteen_rows, sixteen_quads
);
