//! Jittered strata over the samples of a pixel, for any number of them.
//!
//! One number: one sample in each of spp strata. Two numbers: one sample in each cell of a grid of about sqrt(spp) columns and
//! rows, and besides in each of as many strata of either axis as there are cells (multi-jittered: Chiu, Shirley, Wang
//! 1994, *Multi-Jittered Sampling*). If spp is not a product of two such numbers, the samples left over make a smaller grid of
//! their own, which costs up to a factor of four in the error. The orders within columns and rows are drawn apart for each
//! of them: with one order for all, as in Kensler 2013, *Correlated Multi-Jittered Sampling*, the error of e^(x+y) was
//! measured to fall as N^-0.76 only.
//!
//! Which sample falls into which stratum is permuted by a hash for every (pixel, vertex, dimension), so purposes are paired
//! at random. The error falls as N^-1 for smooth integrands and as N^-3/4 across an edge. Unlike [`super::OwenSobol`],
//! only whole sets of spp samples are stratified, and all numbers depend on spp.

use super::permute::permute;
use super::{Dim, Sampler, Vertex, hash, hash::seed, pcg};
use crate::math::lanes::{Compare, IntLanes, Isa, Lanes, MaskLanes, Select, Wrapping};

/// The greatest number of strata: finer ones would be thinner than four steps of a number.
const MOST: u32 = 1 << 22;

/// Stratified numbers of one sample per lane.
#[derive(Clone, Copy, Debug)]
pub struct Stratified<I> {
    key: I,
    /// Below the number of strata.
    index: I,
    /// How many strata there are.
    len: u32,
    /// Columns of the grid of pairs.
    columns: u32,
}

/// How many columns are tried that may divide the number of samples, from the square root downwards.
const TRIED: u32 = 16;

/// Columns of a grid of at most `len` cells that is no more than four times as high as wide.
#[inline(always)]
fn columns(len: u32) -> u32 {
    if len.is_power_of_two() {
        return 1 << (len.ilog2() / 2);
    }
    let root = len.isqrt();
    let least = Ord::max(root.div_ceil(2), root.saturating_sub(TRIED));
    (least..=root).rev().find(|columns| len.is_multiple_of(*columns)).unwrap_or(root)
}

impl<I: IntLanes> Stratified<I> {
    /// The numbers of sample `index` of a pixel that gets `spp` samples. Samples from `spp` on make further sets of the same
    /// size; beyond 2^22 samples are more than one set in any case.
    #[inline(always)]
    pub fn start(seed: u32, pixel: [I; 2], index: I, spp: u32) -> Self {
        Self::in_sets(hash::pixel_key(seed, pixel), index, Ord::max(spp, 1))
    }

    /// The sample `index` of the sets of `len` each.
    #[inline(always)]
    fn in_sets(key: I, index: I, len: u32) -> Self {
        let len = Ord::min(len, MOST);
        if Compare::<u32>::lt(index, len).all() {
            return Self { key, index, len, columns: columns(len) };
        }
        let set = index.isa().per_lane_u32(|i| index.extract(i) / len);
        let index = Wrapping::<I>::wrapping_sub(index, Wrapping::<u32>::wrapping_mul(set, len));
        // Nothing for the first set.
        Self { key: key ^ hash::mix(set), index, len, columns: columns(len) }
    }

    #[inline(always)]
    fn key(&self, dim: Dim, vertex: Vertex) -> I {
        self.key ^ dim.salt(vertex)
    }
}

/// A point of stratum `stratum` of `count` equal ones: they share the multiples of 2^-24 among them, and `jitter`
/// chooses among those of the stratum.
#[inline(always)]
fn point<I: IntLanes>(stratum: I, count: u32, jitter: I) -> I::F {
    let low = edge(stratum, count);
    let width = Wrapping::<I>::wrapping_sub(edge(Wrapping::<u32>::wrapping_add(stratum, 1), count), low);
    // Less than the width: the product is at least half a step below it, and steps below it are no coarser.
    let within = (jitter.to_unit() * width.signed_to_float()).to_int();
    Wrapping::<I>::wrapping_add(low, within).signed_to_float() * (1.0 / 16_777_216.0)
}

/// Where a stratum begins, in steps of 2^-24.
#[inline(always)]
fn edge<I: IntLanes>(stratum: I, count: u32) -> I {
    #[expect(clippy::cast_precision_loss, reason = "not more than 2^22")]
    let count = count as f32;
    (stratum.signed_to_float() * 16_777_216.0 / count).to_int()
}

/// The strata of x and y that the sample in cell `cell` of a grid of columns and rows has for itself.
#[inline(always)]
fn strata<I: IntLanes>(cell: I, [columns, rows]: [u32; 2], seed: I) -> [I; 2] {
    #[expect(clippy::cast_precision_loss, reason = "not more than 2^11")]
    let width = columns as f32;
    // Exact: both are whole and below 2^24.
    let row = (cell.signed_to_float() / width).to_int();
    let in_row = Wrapping::<I>::wrapping_sub(cell, Wrapping::<u32>::wrapping_mul(row, columns));
    let column = permute(in_row, columns, hash::combine(seed, row));
    let in_column = permute(row, rows, hash::combine(!seed, column));
    [Wrapping::<I>::wrapping_add(Wrapping::<u32>::wrapping_mul(column, rows), in_column), cell]
}

impl<I: IntLanes> Sampler for Stratified<I> {
    type I = I;

    #[inline(always)]
    fn get_1d(&self, dim: Dim, vertex: Vertex) -> I::F {
        let key = self.key(dim, vertex);
        let stratum = permute(self.index, self.len, seed(key, 1));
        point(stratum, self.len, hash::combine(key, self.index))
    }

    #[inline(always)]
    fn get_2d(&self, dim: Dim, vertex: Vertex) -> [I::F; 2] {
        let key = self.key(dim, vertex);
        let [_, jx, jy] = pcg::pcg3d([key, self.index, key.splat(hash::GOLDEN)]);
        let (mut cell, mut left) = (permute(self.index, self.len, seed(key, 2)), self.len);
        let mut pair = [jx.to_unit(), jy.to_unit()];
        let (mut order, mut width) = (seed(key, 3), self.columns);
        loop {
            let grid = [width, left / width];
            let cells = grid[0] * grid[1];
            let here = Compare::<u32>::lt(cell, cells);
            let [x, y] = strata(I::select(here, cell, cell.splat(0)), grid, order);
            pair[0] = I::F::select(here, point(x, cells, jx), pair[0]);
            pair[1] = I::F::select(here, point(y, cells, jy), pair[1]);
            left -= cells;
            if left == 0 {
                return pair;
            }
            cell = Wrapping::<u32>::wrapping_sub(cell, cells);
            // Lanes that are done must stay out of the smaller grids.
            cell = I::select(here, cell.splat(u32::MAX), cell);
            (order, width) = (hash::mix(order), columns(left));
        }
    }

    #[inline(always)]
    fn split(self, j: u32, k: u32) -> Self {
        let index = super::split_index(self.index, j, k);
        Self::in_sets(self.key, index, self.len.saturating_mul(k))
    }

    #[inline(always)]
    fn at_vertices(self, vertices: I) -> Self {
        Self { key: self.key ^ vertices, ..self }
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "numbers are multiples of 2^-24")]
mod tests {
    use super::*;

    #[test]
    fn strata_share_all_numbers_among_them() {
        for count in [1, 2, 3, 7, 10, 64, 100, 4095, 1 << 20, 1 << 22] {
            let end = |stratum| point(stratum, count, u32::MAX) * 16_777_216.0;
            assert!(point(0_u32, count, 0_u32) == 0.0, "the first number of {count}");
            assert!(end(count - 1) == 16_777_215.0, "the last number of {count}");
            for stratum in (0..count - 1).step_by(1 + count as usize / 1000) {
                let next = point(stratum + 1, count, 0_u32) * 16_777_216.0;
                assert!(end(stratum) + 1.0 == next, "{count}, stratum {stratum}: {} {next}", end(stratum));
            }
        }
    }
}
