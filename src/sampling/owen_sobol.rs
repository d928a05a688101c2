//! Owen-scrambled Sobol pairs, padded: the set of choice.
//!
//! Each (pixel, vertex, dimension) has the (0,2)-sequence of [`super::sobol`] for itself, shuffled and scrambled by seeds of
//! its own (Burley 2020, *Practical Hash-based Owen Scrambling*, section 3: padding). Within one purpose the samples of a
//! pixel are stratified in both coordinates. The error falls as N^-3/2 (log N)^1/2 for smooth integrands of two variables
//! and as N^-3/4 across an edge, for N a power of two; other N are correct and a little worse. No table, no state, any
//! width.
//!
//! Across purposes the samples of one pixel are paired at random, though not quite as independent numbers are: the two
//! samples of an aligned pair fall into opposite halves for every purpose, which doubles the variance of the coarsest
//! interaction of two purposes and raises that of finer ones less. It is the price of shuffles that keep every
//! prefix stratified.

use super::{Dim, Sampler, Vertex, hash, hash::seed, owen, sobol};
use crate::math::lanes::IntLanes;

/// Owen-scrambled Sobol numbers of one sample per lane.
#[derive(Clone, Copy, Debug)]
pub struct OwenSobol<I> {
    key: I,
    index: I,
}

impl<I: IntLanes> OwenSobol<I> {
    /// The numbers of sample `index` of a pixel.
    #[inline(always)]
    pub fn start(seed: u32, pixel: [I; 2], index: I) -> Self {
        Self { key: hash::pixel_key(seed, pixel), index }
    }

    /// A key for each dimension at each vertex of each pixel.
    #[inline(always)]
    fn key(&self, dim: Dim, vertex: Vertex) -> I {
        self.key ^ dim.salt(vertex)
    }
}

impl<I: IntLanes> Sampler for OwenSobol<I> {
    type I = I;

    #[inline(always)]
    fn get_1d(&self, dim: Dim, vertex: Vertex) -> I::F {
        let key = self.key(dim, vertex);
        let index = owen::shuffle(self.index, seed(key, 4));
        owen::scramble_rev(index, seed(key, 5)).reverse_bits().to_unit()
    }

    #[inline(always)]
    fn get_2d(&self, dim: Dim, vertex: Vertex) -> [I::F; 2] {
        let key = self.key(dim, vertex);
        let [x_rev, y_rev] = sobol::sobol_2d_rev(owen::shuffle(self.index, seed(key, 1)));
        let x = owen::scramble_rev(x_rev, seed(key, 2)).reverse_bits();
        let y = owen::scramble_rev(y_rev, seed(key, 3)).reverse_bits();
        [x.to_unit(), y.to_unit()]
    }

    #[inline(always)]
    fn split(self, j: u32, k: u32) -> Self {
        Self { index: super::split_index(self.index, j, k), ..self }
    }

    #[inline(always)]
    fn at_vertices(self, vertices: I) -> Self {
        Self { key: self.key ^ vertices, ..self }
    }
}
