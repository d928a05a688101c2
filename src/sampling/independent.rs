//! Independent random numbers: the plain Monte Carlo estimator, whose error falls as N^-1/2 whatever the integrand.
//!
//! Stateless: a hash of pixel, sample index, vertex and dimension.

use super::{Dim, Sampler, Vertex, hash, pcg};
use crate::math::lanes::IntLanes;

/// Independent numbers of one sample per lane.
#[derive(Clone, Copy, Debug)]
pub struct Independent<I> {
    key: I,
    index: I,
}

impl<I: IntLanes> Independent<I> {
    /// The numbers of sample `index` of a pixel.
    #[inline(always)]
    pub fn start(seed: u32, pixel: [I; 2], index: I) -> Self {
        Self { key: hash::pixel_key(seed, pixel), index }
    }

    #[inline(always)]
    fn bits(&self, dim: Dim, vertex: Vertex) -> [I; 3] {
        pcg::pcg3d([self.key ^ dim.salt(vertex), self.index, self.key.splat(hash::GOLDEN)])
    }
}

impl<I: IntLanes> Sampler for Independent<I> {
    type I = I;

    #[inline(always)]
    fn get_1d(&self, dim: Dim, vertex: Vertex) -> I::F {
        self.bits(dim, vertex)[2].to_unit()
    }

    #[inline(always)]
    fn get_2d(&self, dim: Dim, vertex: Vertex) -> [I::F; 2] {
        let [x, y, _] = self.bits(dim, vertex);
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
