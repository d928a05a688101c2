//! Owen-scrambled Sobol pairs, arranged over the picture so that the errors of neighbouring pixels cancel.
//!
//! Pixels are put in an order in which neighbours are near each other, and consecutive pixels get consecutive runs of one
//! sequence: Ahmed and Wonka 2020, *Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical
//! Ordering of Pixels*. The order is that of a quadtree whose nodes permute their children at random, each its own
//! way and again for every purpose. Two, four, sixteen pixels then hold a stratified set together, and the error lacks low
//! frequencies: at viewing distance, or after a denoiser, there is less noise. Each pixel for itself has a set as good
//! as [`super::OwenSobol`]'s, and no better.
//!
//! No table, any width. Where the paper walks down the tree, all levels are permuted here at once: in a word with four bits
//! for each level, the two that hold no coordinate turn into random bits that depend on the levels above alone when the
//! word is Owen-scrambled.
//!
//! Trees span 256 x 256 pixels, with scramblings of their own: coarser levels have nothing left to gain.
//! All numbers depend on spp. With spp a power of two, sets join without gaps.

use super::{Dim, Sampler, Vertex, hash, hash::seed, owen, sobol};
use crate::math::lanes::IntLanes;

/// Levels of a quadtree: four bits each fill a word.
const LEVELS: u32 = 8;

/// The lowest of the four bits of every level.
const LOWEST: u32 = 0x1111_1111;

/// Blue-noise numbers of one sample per lane.
#[derive(Clone, Copy, Debug)]
pub struct BlueNoise<I> {
    /// Of the tree, the vertex and further sets.
    key: I,
    /// The way from the root to the pixel, x in bit 0 and y in bit 1 of the four bits of a level.
    path: I,
    index: I,
    /// The samples of a pixel that make a set, as a power of two.
    log2_set: u32,
}

impl<I: IntLanes> BlueNoise<I> {
    /// The numbers of sample `index` of a pixel that gets `spp` samples. Samples beyond the next power of two make
    /// further sets.
    #[inline(always)]
    pub fn start(seed: u32, [x, y]: [I; 2], index: I, spp: u32) -> Self {
        let log2_set = ceil_log2(spp).min(30);
        let set = index >> log2_set;
        // Nothing for the first set.
        let key = hash::pixel_key(seed, [x >> LEVELS, y >> LEVELS]) ^ hash::mix(set);
        Self { key, path: spread(x) | (spread(y) << 1), index: index ^ (set << log2_set), log2_set }
    }

    /// Where in the sequence of a purpose the sample stands, and the key of that sequence. `key` is the same in all pixels
    /// of a tree.
    #[inline(always)]
    fn place(&self, key: I) -> (I, I) {
        let within = owen::shuffle(self.index, seed(key ^ hash::mix(self.path), 1));
        let within = within & ((1 << self.log2_set) - 1);
        let pixel = gather(permuted(self.path, seed(key, 2), seed(key, 3)));
        let place = (pixel << self.log2_set) | within;
        let lost = (2 * LEVELS + self.log2_set).saturating_sub(32);
        if lost == 0 {
            return (place, key);
        }
        // Too many samples for one sequence: each subtree has its own.
        (place, key ^ hash::mix(pixel >> (2 * LEVELS - lost)))
    }
}

/// The least m with 2^m >= n.
#[inline(always)]
fn ceil_log2(n: u32) -> u32 {
    32 - n.max(1).wrapping_sub(1).leading_zeros()
}

/// The low eight bits, four places apart.
#[inline(always)]
fn spread<I: IntLanes>(x: I) -> I {
    let x = x & 0xff;
    let x = (x | (x << 12)) & 0x000f_000f;
    let x = (x | (x << 6)) & 0x0303_0303;
    (x | (x << 3)) & LOWEST
}

/// The low two of every four bits, next to each other.
#[inline(always)]
fn gather<I: IntLanes>(x: I) -> I {
    let x = (x | (x >> 2)) & 0x0f0f_0f0f;
    let x = (x | (x >> 4)) & 0x00ff_00ff;
    (x | (x >> 8)) & 0xffff
}

/// The way from the root after every node has permuted its children, in any of the 24 orders.
///
/// First, which children are paired: by rows (3 of 8), by columns (3 of 8) or across (2 of 8). Then which pair is first, and
/// in each pair which child.
#[inline(always)]
fn permuted<I: IntLanes>(path: I, seed_a: I, seed_b: I) -> I {
    let (a, b) = (flips(path, seed_a), flips(path, seed_b));
    let [a1, a2, a3] = [a >> 1, a >> 2, a >> 3];
    let [b2, b3] = [b >> 2, b >> 3];
    let (x, y) = (path & LOWEST, (path >> 1) & LOWEST);
    // Of the eight settings of three bits: 1, 2, 3 columns; 4, 5 across.
    let columns = !a3 & (a1 | a2);
    let across = a3 & !a2;
    let swap = (x ^ y) & columns;
    let high = y ^ swap ^ (x & across);
    let low = x ^ swap;
    let low = low ^ b2 ^ (high & b3);
    let high = high ^ (b >> 1);
    (low & LOWEST) | ((high & LOWEST) << 1)
}

/// Random bits, each a function of the bits of the path above it: for bits 1 to 3 of a level, of the levels above.
#[inline(always)]
fn flips<I: IntLanes>(path: I, seed: I) -> I {
    owen::shuffle(path, seed) ^ path
}

impl<I: IntLanes> Sampler for BlueNoise<I> {
    type I = I;

    #[inline(always)]
    fn get_1d(&self, dim: Dim, vertex: Vertex) -> I::F {
        // Another key than that of the pair, which must not share its order of pixels.
        let (place, key) = self.place(self.key ^ dim.salt(vertex) ^ hash::GOLDEN);
        owen::scramble_rev(place, seed(key, 4)).reverse_bits().to_unit()
    }

    #[inline(always)]
    fn get_2d(&self, dim: Dim, vertex: Vertex) -> [I::F; 2] {
        let (place, key) = self.place(self.key ^ dim.salt(vertex));
        let [x_rev, y_rev] = sobol::sobol_2d_rev(place);
        let x = owen::scramble_rev(x_rev, seed(key, 4)).reverse_bits();
        let y = owen::scramble_rev(y_rev, seed(key, 5)).reverse_bits();
        [x.to_unit(), y.to_unit()]
    }

    #[inline(always)]
    fn split(self, j: u32, k: u32) -> Self {
        let log2_set = (self.log2_set + ceil_log2(k)).min(30);
        Self { index: super::split_index(self.index, j, k), log2_set, ..self }
    }

    #[inline(always)]
    fn at_vertices(self, vertices: I) -> Self {
        Self { key: self.key ^ vertices, ..self }
    }
}
