//! Random numbers with named dimensions, warps of the square, and tables to draw from.
//!
//! The law of this folder: a number depends on (seed, pixel, sample index, [`Vertex`], [`Dim`]) alone, never on the
//! order in which numbers are asked for, on threads, or on what else a scene contains. Asking again gives the same number.
//!
//! Everything that shading calls is generic over lanes ([`crate::math::lanes`]): one value per lane, each lane with
//! its own pixel and index.

mod any;
mod blue_noise;
mod cumulative;
mod dims;
pub mod hash;
pub mod heuristic;
mod independent;
pub mod owen;
mod owen_sobol;
pub mod pcg;
pub mod permute;
pub mod sobol;
mod spherical;
mod stratified;
mod table1d;
mod table2d;
pub mod warp;

use std::fmt::Debug;

pub use any::{AnySampler, SamplerKind};
pub use blue_noise::BlueNoise;
pub use dims::{Dim, Vertex};
pub use independent::Independent;
pub use owen_sobol::OwenSobol;
pub use spherical::{SphericalRectangle, SphericalTriangle};
pub use stratified::Stratified;
pub use table1d::{Pick, Picks, Table1d, TableError};
pub use table2d::{Picks2d, Table2d};

use crate::math::lanes::{IntLanes, Wrapping};

/// The numbers of one sample of one pixel per lane: multiples of 2^-24 in [0, 1), never 1.
///
/// Made by [`SamplerKind::start`], or by the `start` of an implementation where its kind is fixed at compile time.
pub trait Sampler: Copy + Debug {
    /// Pixel coordinates, indices and random bits.
    type I: IntLanes;

    /// One number.
    fn get_1d(&self, dim: Dim, vertex: Vertex) -> <Self::I as IntLanes>::F;

    /// Two numbers, stratified together where the set is. Independent of `get_1d` of the same dimension.
    fn get_2d(&self, dim: Dim, vertex: Vertex) -> [<Self::I as IntLanes>::F; 2];

    /// The sampler of sub-sample `j` of `k` where a sample is split: index * k + j in place of the index, so that the
    /// sub-samples of all samples of the pixel are one set of the same quality.
    ///
    /// `k` must be the same for all samples of a pixel. Numbers below the split come from the unsplit sampler at
    /// `vertex.child(j)`.
    #[must_use]
    fn split(self, j: u32, k: u32) -> Self;

    /// The sampler of a walk that is at a vertex of its own in each lane: `vertices` holds [`Vertex::id`] of each.
    /// Ask it at [`Vertex::ROOT`].
    #[must_use]
    fn at_vertices(self, vertices: Self::I) -> Self;

    /// Number `j` of `k` where a sample is split; see [`Sampler::split`].
    #[inline(always)]
    fn get_1d_split(&self, dim: Dim, vertex: Vertex, j: u32, k: u32) -> <Self::I as IntLanes>::F {
        self.split(j, k).get_1d(dim, vertex)
    }

    /// Pair `j` of `k` where a sample is split; see [`Sampler::split`].
    #[inline(always)]
    fn get_2d_split(&self, dim: Dim, vertex: Vertex, j: u32, k: u32) -> [<Self::I as IntLanes>::F; 2] {
        self.split(j, k).get_2d(dim, vertex)
    }
}

/// index * k + j.
#[inline(always)]
fn split_index<I: IntLanes>(index: I, j: u32, k: u32) -> I {
    Wrapping::<u32>::wrapping_add(Wrapping::<u32>::wrapping_mul(index, k), j)
}
