//! Gathers: the one operation of the lanes that the crate beneath does not have.
//!
//! Single numbers are gathered in hardware; lanes with an index outside the table are masked out, which gives zero, and the
//! instructions do not read for them. Rows of three and four are loaded lane by lane and turned into columns, which takes a load and a
//! shuffle per lane where three gathers take three loads and more on most processors.
#![expect(unsafe_code, reason = "the instructions take a pointer, whose bounds the mask keeps")]

use std::arch::x86_64::{
    __m128, __m128i, _mm_loadu_ps, _mm_maskload_ps, _mm_maskz_loadu_ps, _mm_set_epi32, _mm256_castpd_ps,
    _mm256_castps_pd, _mm256_castsi256_ps, _mm256_mask_i32gather_epi32, _mm256_mask_i32gather_ps,
    _mm256_set_m128, _mm256_setzero_ps, _mm256_setzero_si256, _mm256_unpackhi_pd, _mm256_unpackhi_ps,
    _mm256_unpacklo_pd, _mm256_unpacklo_ps, _mm512_castpd_ps, _mm512_castps_pd, _mm512_castps128_ps512,
    _mm512_insertf32x4, _mm512_mask_i32gather_epi32, _mm512_mask_i32gather_ps, _mm512_setzero_ps,
    _mm512_setzero_si512, _mm512_unpackhi_pd, _mm512_unpackhi_ps, _mm512_unpacklo_pd, _mm512_unpacklo_ps,
};

use fearless_simd::x86::{Avx2, Avx512};
use fearless_simd::{SimdBase, SimdInto, SimdMask, f32x8, f32x16, u32x8, u32x16};

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

/// How many rows of a table signed indices of their numbers reach.
#[inline(always)]
fn rows_reached(table: &[[f32; 3]]) -> u32 {
    reach(table.as_flattened().len()) / 3
}

fearless_simd::kernel!(
    #[inline(always)]
    pub(super) fn eight_rows(isa: Avx2, table: &[[f32; 3]], index: u32x8<Avx2>) -> [f32x8<Avx2>; 3] {
        let rows = rows_reached(table);
        if !index.simd_lt(rows).all_true() {
            let (numbers, first) = (table.as_flattened(), index.min(rows) * 3);
            return [
                eight_f32(isa, numbers, first),
                eight_f32(isa, numbers, first + 1),
                eight_f32(isa, numbers, first + 2),
            ];
        }
        let mut at = [0; 8];
        index.store_slice(&mut at);
        let numbers = table.as_flattened().as_ptr();
        let three: __m128i = _mm_set_epi32(0, -1, -1, -1);
        macro_rules! row {
            ($lane:literal) => {{
                let from = numbers.wrapping_add(3 * at[$lane] as usize);
                // SAFETY: the three numbers that are read are a row of the table.
                let row: __m128 = unsafe { _mm_maskload_ps(from, three) };
                row
            }};
        }
        let [a, b, c, d] = [
            _mm256_set_m128(row!(4), row!(0)),
            _mm256_set_m128(row!(5), row!(1)),
            _mm256_set_m128(row!(6), row!(2)),
            _mm256_set_m128(row!(7), row!(3)),
        ];
        let [ab, cd] =
            [_mm256_castps_pd(_mm256_unpacklo_ps(a, b)), _mm256_castps_pd(_mm256_unpacklo_ps(c, d))];
        let z = [_mm256_castps_pd(_mm256_unpackhi_ps(a, b)), _mm256_castps_pd(_mm256_unpackhi_ps(c, d))];
        [
            _mm256_castpd_ps(_mm256_unpacklo_pd(ab, cd)).simd_into(isa),
            _mm256_castpd_ps(_mm256_unpackhi_pd(ab, cd)).simd_into(isa),
            _mm256_castpd_ps(_mm256_unpacklo_pd(z[0], z[1])).simd_into(isa),
        ]
    }
);

fearless_simd::kernel!(
    #[inline(always)]
    pub(super) fn sixteen_rows(
        isa: Avx512,
        table: &[[f32; 3]],
        index: u32x16<Avx512>,
    ) -> [f32x16<Avx512>; 3] {
        let rows = rows_reached(table);
        if !index.simd_lt(rows).all_true() {
            let (numbers, first) = (table.as_flattened(), index.min(rows) * 3);
            return [
                sixteen_f32(isa, numbers, first),
                sixteen_f32(isa, numbers, first + 1),
                sixteen_f32(isa, numbers, first + 2),
            ];
        }
        let mut at = [0; 16];
        index.store_slice(&mut at);
        let numbers = table.as_flattened().as_ptr();
        macro_rules! row {
            ($lane:literal) => {{
                let from = numbers.wrapping_add(3 * at[$lane] as usize);
                // SAFETY: the three numbers that are read are a row of the table.
                let row: __m128 = unsafe { _mm_maskz_loadu_ps(0b111, from) };
                row
            }};
        }
        macro_rules! every_fourth {
            ($a:literal $b:literal $c:literal $d:literal) => {{
                let lanes = _mm512_insertf32x4::<1>(_mm512_castps128_ps512(row!($a)), row!($b));
                _mm512_insertf32x4::<3>(_mm512_insertf32x4::<2>(lanes, row!($c)), row!($d))
            }};
        }
        let [a, b] = [every_fourth!(0 4 8 12), every_fourth!(1 5 9 13)];
        let [c, d] = [every_fourth!(2 6 10 14), every_fourth!(3 7 11 15)];
        let [ab, cd] =
            [_mm512_castps_pd(_mm512_unpacklo_ps(a, b)), _mm512_castps_pd(_mm512_unpacklo_ps(c, d))];
        let z = [_mm512_castps_pd(_mm512_unpackhi_ps(a, b)), _mm512_castps_pd(_mm512_unpackhi_ps(c, d))];
        [
            _mm512_castpd_ps(_mm512_unpacklo_pd(ab, cd)).simd_into(isa),
            _mm512_castpd_ps(_mm512_unpackhi_pd(ab, cd)).simd_into(isa),
            _mm512_castpd_ps(_mm512_unpacklo_pd(z[0], z[1])).simd_into(isa),
        ]
    }
);

/// How many rows of four of a table signed indices of their numbers reach.
#[inline(always)]
fn quads_reached(table: &[[f32; 4]]) -> u32 {
    reach(table.as_flattened().len()) / 4
}

fearless_simd::kernel!(
    #[inline(always)]
    pub(super) fn eight_quads(isa: Avx2, table: &[[f32; 4]], index: u32x8<Avx2>) -> [f32x8<Avx2>; 4] {
        let rows = quads_reached(table);
        if !index.simd_lt(rows).all_true() {
            let (numbers, first) = (table.as_flattened(), index.min(rows) * 4);
            return [
                eight_f32(isa, numbers, first),
                eight_f32(isa, numbers, first + 1),
                eight_f32(isa, numbers, first + 2),
                eight_f32(isa, numbers, first + 3),
            ];
        }
        let mut at = [0; 8];
        index.store_slice(&mut at);
        let numbers = table.as_flattened().as_ptr();
        macro_rules! row {
            ($lane:literal) => {{
                let from = numbers.wrapping_add(4 * at[$lane] as usize);
                // SAFETY: the four numbers that are read are a row of the table.
                let row: __m128 = unsafe { _mm_loadu_ps(from) };
                row
            }};
        }
        let [a, b, c, d] = [
            _mm256_set_m128(row!(4), row!(0)),
            _mm256_set_m128(row!(5), row!(1)),
            _mm256_set_m128(row!(6), row!(2)),
            _mm256_set_m128(row!(7), row!(3)),
        ];
        let xy = [_mm256_castps_pd(_mm256_unpacklo_ps(a, b)), _mm256_castps_pd(_mm256_unpacklo_ps(c, d))];
        let zw = [_mm256_castps_pd(_mm256_unpackhi_ps(a, b)), _mm256_castps_pd(_mm256_unpackhi_ps(c, d))];
        [
            _mm256_castpd_ps(_mm256_unpacklo_pd(xy[0], xy[1])).simd_into(isa),
            _mm256_castpd_ps(_mm256_unpackhi_pd(xy[0], xy[1])).simd_into(isa),
            _mm256_castpd_ps(_mm256_unpacklo_pd(zw[0], zw[1])).simd_into(isa),
            _mm256_castpd_ps(_mm256_unpackhi_pd(zw[0], zw[1])).simd_into(isa),
        ]
    }
);

fearless_simd::kernel!(
    #[inline(always)]
    pub(super) fn sixteen_quads(
        isa: Avx512,
        table: &[[f32; 4]],
        index: u32x16<Avx512>,
    ) -> [f32x16<Avx512>; 4] {
        let rows = quads_reached(table);
        if !index.simd_lt(rows).all_true() {
            let (numbers, first) = (table.as_flattened(), index.min(rows) * 4);
            return [
                sixteen_f32(isa, numbers, first),
                sixteen_f32(isa, numbers, first + 1),
                sixteen_f32(isa, numbers, first + 2),
                sixteen_f32(isa, numbers, first + 3),
            ];
        }
        let mut at = [0; 16];
        index.store_slice(&mut at);
        let numbers = table.as_flattened().as_ptr();
        macro_rules! row {
            ($lane:literal) => {{
                let from = numbers.wrapping_add(4 * at[$lane] as usize);
                // SAFETY: the four numbers that are read are a row of the table.
                let row: __m128 = unsafe { _mm_loadu_ps(from) };
                row
            }};
        }
        macro_rules! every_fourth {
            ($a:literal $b:literal $c:literal $d:literal) => {{
                let lanes = _mm512_insertf32x4::<1>(_mm512_castps128_ps512(row!($a)), row!($b));
                _mm512_insertf32x4::<3>(_mm512_insertf32x4::<2>(lanes, row!($c)), row!($d))
            }};
        }
        let [a, b] = [every_fourth!(0 4 8 12), every_fourth!(1 5 9 13)];
        let [c, d] = [every_fourth!(2 6 10 14), every_fourth!(3 7 11 15)];
        let xy = [_mm512_castps_pd(_mm512_unpacklo_ps(a, b)), _mm512_castps_pd(_mm512_unpacklo_ps(c, d))];
        let zw = [_mm512_castps_pd(_mm512_unpackhi_ps(a, b)), _mm512_castps_pd(_mm512_unpackhi_ps(c, d))];
        [
            _mm512_castpd_ps(_mm512_unpacklo_pd(xy[0], xy[1])).simd_into(isa),
            _mm512_castpd_ps(_mm512_unpackhi_pd(xy[0], xy[1])).simd_into(isa),
            _mm512_castpd_ps(_mm512_unpacklo_pd(zw[0], zw[1])).simd_into(isa),
            _mm512_castpd_ps(_mm512_unpackhi_pd(zw[0], zw[1])).simd_into(isa),
        ]
    }
);
