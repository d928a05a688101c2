//! Tokens: proofs that an instruction set is there, and makers of values.

use std::fmt::Debug;

use super::{IntLanes, Lanes, MaskLanes};

/// A token whose existence proves that its instruction set may be used. Makes values and enters kernels.
pub trait Isa: Copy + Debug + Send + Sync + 'static {
    /// Float lanes.
    type F: Lanes<Isa = Self, Int = Self::I, Mask = Self::M>;
    /// Unsigned integer lanes.
    type I: IntLanes<F = Self::F, Isa = Self, Mask = Self::M>;
    /// Masks.
    type M: MaskLanes;
    /// The number of lanes.
    const WIDTH: usize;
    /// A short name, for reports.
    const NAME: &'static str;

    /// Runs a kernel compiled for this instruction set.
    fn run<K: Kernel<Self>>(self, kernel: K) -> K::Output;

    /// `x` in all lanes.
    fn splat(self, x: f32) -> Self::F;
    /// `x` in all lanes.
    fn splat_u32(self, x: u32) -> Self::I;
    /// `x` in all lanes.
    fn splat_mask(self, x: bool) -> Self::M;
    /// The first `WIDTH` elements.
    ///
    /// # Panics
    /// If `from` is shorter than `WIDTH`.
    fn load(self, from: &[f32]) -> Self::F;
    /// The first `WIDTH` elements.
    ///
    /// # Panics
    /// If `from` is shorter than `WIDTH`.
    fn load_u32(self, from: &[u32]) -> Self::I;
    /// 0, 1, 2, ...
    fn iota(self) -> Self::I;
    /// `table[index]` in each lane; zero where the index is outside the table.
    fn gather(self, table: &[f32], index: Self::I) -> Self::F;
    /// `table[index]` in each lane; zero where the index is outside the table.
    fn gather_u32(self, table: &[u32], index: Self::I) -> Self::I;
    /// The row `table[index]` of each lane, as columns; zeros where the index is outside the table.
    fn gather_rows(self, table: &[[f32; 3]], index: Self::I) -> [Self::F; 3];
    /// The row `table[index]` of each lane, as columns; zeros where the index is outside the table.
    fn gather_quads(self, table: &[[f32; 4]], index: Self::I) -> [Self::F; 4];
    /// `f(i)` in lane i. Slow; `f` must not compute with lanes.
    fn per_lane(self, f: impl FnMut(usize) -> f32) -> Self::F;
    /// `f(i)` in lane i. Slow; `f` must not compute with lanes.
    fn per_lane_u32(self, f: impl FnMut(usize) -> u32) -> Self::I;

    /// The row `table[index]` of each lane, as columns; as [`Self::gather_rows`].
    #[inline(always)]
    fn gather_rows_u32(self, table: &[[u32; 3]], index: Self::I) -> [Self::I; 3] {
        let [a, b, c] = self.gather_rows(bytemuck::cast_slice(table), index);
        [a.to_bits(), b.to_bits(), c.to_bits()]
    }

    /// True in the first `n` lanes.
    #[inline(always)]
    fn first(self, n: usize) -> Self::M {
        let n = u32::try_from(n).unwrap_or(u32::MAX);
        super::Compare::lt(self.iota(), n)
    }
    /// As many elements as there are up to `WIDTH`, then zeros.
    #[inline(always)]
    fn load_partial(self, from: &[f32]) -> Self::F {
        if from.len() >= Self::WIDTH {
            return self.load(from);
        }
        self.per_lane(|i| from.get(i).copied().unwrap_or(0.0))
    }
    /// As many elements as there are up to `WIDTH`, then zeros.
    #[inline(always)]
    fn load_partial_u32(self, from: &[u32]) -> Self::I {
        if from.len() >= Self::WIDTH {
            return self.load_u32(from);
        }
        self.per_lane_u32(|i| from.get(i).copied().unwrap_or(0))
    }
}

/// Work that is compiled once per instruction set.
///
/// `run` and everything that it calls with lanes must be `#[inline(always)]`.
pub trait Kernel<S: Isa> {
    /// What the work gives.
    type Output;
    /// Does the work.
    fn run(self, isa: S) -> Self::Output;
}
