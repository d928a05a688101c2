//! Samplers chosen at run time, without virtual calls.

use super::{BlueNoise, Dim, Independent, OwenSobol, Sampler, Stratified, Vertex};
use crate::math::lanes::IntLanes;

/// A kind of number set, as a user chooses it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SamplerKind {
    /// [`Independent`].
    Independent,
    /// [`OwenSobol`].
    #[default]
    OwenSobol,
    /// [`Stratified`].
    Stratified {
        /// Samples that a pixel gets.
        spp: u32,
    },
    /// [`BlueNoise`].
    BlueNoise {
        /// Samples that a pixel gets.
        spp: u32,
    },
}

impl SamplerKind {
    /// The same for so many times as many samples.
    #[must_use]
    pub fn times(self, ways: u32) -> Self {
        match self {
            Self::Independent | Self::OwenSobol => self,
            Self::Stratified { spp } => Self::Stratified { spp: spp.saturating_mul(ways) },
            Self::BlueNoise { spp } => Self::BlueNoise { spp: spp.saturating_mul(ways) },
        }
    }

    /// The numbers of sample `index` of a pixel.
    #[inline(always)]
    pub fn start<I: IntLanes>(self, seed: u32, pixel: [I; 2], index: I) -> AnySampler<I> {
        match self {
            Self::Independent => AnySampler::Independent(Independent::start(seed, pixel, index)),
            Self::OwenSobol => AnySampler::OwenSobol(OwenSobol::start(seed, pixel, index)),
            Self::Stratified { spp } => AnySampler::Stratified(Stratified::start(seed, pixel, index, spp)),
            Self::BlueNoise { spp } => AnySampler::BlueNoise(BlueNoise::start(seed, pixel, index, spp)),
        }
    }
}

/// A sampler of any kind. The kind is the same for all lanes: asking costs one branch that is always predicted.
#[derive(Clone, Copy, Debug)]
pub enum AnySampler<I> {
    /// Independent random numbers.
    Independent(Independent<I>),
    /// Owen-scrambled Sobol pairs.
    OwenSobol(OwenSobol<I>),
    /// Jittered strata.
    Stratified(Stratified<I>),
    /// Owen-scrambled Sobol pairs in a blue-noise arrangement.
    BlueNoise(BlueNoise<I>),
}

impl<I: IntLanes> Sampler for AnySampler<I> {
    type I = I;

    #[inline(always)]
    fn get_1d(&self, dim: Dim, vertex: Vertex) -> I::F {
        match self {
            Self::Independent(s) => s.get_1d(dim, vertex),
            Self::OwenSobol(s) => s.get_1d(dim, vertex),
            Self::Stratified(s) => s.get_1d(dim, vertex),
            Self::BlueNoise(s) => s.get_1d(dim, vertex),
        }
    }

    #[inline(always)]
    fn get_2d(&self, dim: Dim, vertex: Vertex) -> [I::F; 2] {
        match self {
            Self::Independent(s) => s.get_2d(dim, vertex),
            Self::OwenSobol(s) => s.get_2d(dim, vertex),
            Self::Stratified(s) => s.get_2d(dim, vertex),
            Self::BlueNoise(s) => s.get_2d(dim, vertex),
        }
    }

    #[inline(always)]
    fn split(self, j: u32, k: u32) -> Self {
        match self {
            Self::Independent(s) => Self::Independent(s.split(j, k)),
            Self::OwenSobol(s) => Self::OwenSobol(s.split(j, k)),
            Self::Stratified(s) => Self::Stratified(s.split(j, k)),
            Self::BlueNoise(s) => Self::BlueNoise(s.split(j, k)),
        }
    }

    #[inline(always)]
    fn at_vertices(self, vertices: I) -> Self {
        match self {
            Self::Independent(s) => Self::Independent(s.at_vertices(vertices)),
            Self::OwenSobol(s) => Self::OwenSobol(s.at_vertices(vertices)),
            Self::Stratified(s) => Self::Stratified(s.at_vertices(vertices)),
            Self::BlueNoise(s) => Self::BlueNoise(s.at_vertices(vertices)),
        }
    }
}
