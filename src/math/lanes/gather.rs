//! Gathers in hardware: the one operation of the lanes that the crate beneath does not have.
//!
//! Lanes with an index outside the table are masked out, which gives zero, and the instructions do not read for them.
#![expect(unsafe_code, reason = "the instructions take a pointer, whose bounds the mask keeps")]

use std::arch::x86_64::{
    _mm256_castsi256_ps, _mm256_mask_i32gather_epi32, _mm256_mask_i32gather_ps, _mm256_setzero_ps,
    _mm256_setzero_si256, _mm512_mask_i32gather_epi32, _mm512_mask_i32gather_ps, _mm512_setzero_ps,
    _mm512_setzero_si512,
};

use fearless_simd::x86::{Avx2, Avx512};
use fearless_simd::{SimdBase, SimdInto, f32x8, f32x16, u32x8, u32x16};

/// How much of a table of that length signed indices reach.
#[inline(always)]
fn reach(len: usize) -> u32 {
    u32::try_from(len.min(i32::MAX as usize)).unwrap_or(0)
}

fearless_simd::kernel!(
    #[inline(always)]
    pub(super) fn eight_f32(isa: Avx2, table: &[f32], index: u32x8<Avx2>) -> f32x8<Avx2> {
        let (zero, table_start) = (_mm256_setzero_ps(), table.as_ptr());
        let inside = _mm256_castsi256_ps(index.simd_lt(reach(table.len())).into());
        // SAFETY: only lanes with an index inside the table are read.
        let lanes = unsafe { _mm256_mask_i32gather_ps::<4>(zero, table_start, index.into(), inside) };
        lanes.simd_into(isa)
    }
);

fearless_simd::kernel!(
    #[inline(always)]
    pub(super) fn eight_u32(isa: Avx2, table: &[u32], index: u32x8<Avx2>) -> u32x8<Avx2> {
        let (zero, table_start) = (_mm256_setzero_si256(), table.as_ptr().cast());
        let inside = index.simd_lt(reach(table.len())).into();
        // SAFETY: only lanes with an index inside the table are read.
        let lanes = unsafe { _mm256_mask_i32gather_epi32::<4>(zero, table_start, index.into(), inside) };
        lanes.simd_into(isa)
    }
);

fearless_simd::kernel!(
    #[inline(always)]
    pub(super) fn sixteen_f32(isa: Avx512, table: &[f32], index: u32x16<Avx512>) -> f32x16<Avx512> {
        let (zero, table_start) = (_mm512_setzero_ps(), table.as_ptr());
        let inside = index.simd_lt(reach(table.len())).into();
        // SAFETY: only lanes with an index inside the table are read.
        let lanes = unsafe { _mm512_mask_i32gather_ps::<4>(zero, inside, index.into(), table_start) };
        lanes.simd_into(isa)
    }
);

fearless_simd::kernel!(
    #[inline(always)]
    pub(super) fn sixteen_u32(isa: Avx512, table: &[u32], index: u32x16<Avx512>) -> u32x16<Avx512> {
        let (zero, table_start) = (_mm512_setzero_si512(), table.as_ptr().cast());
        let inside = index.simd_lt(reach(table.len())).into();
        // SAFETY: only lanes with an index inside the table are read.
        let lanes = unsafe { _mm512_mask_i32gather_epi32::<4>(zero, inside, index.into(), table_start) };
        lanes.simd_into(isa)
    }
);
