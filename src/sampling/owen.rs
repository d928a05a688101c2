//! Owen scrambling by hashing: nested uniform random permutations of the binary digits, any width.
//!
//! Owen 1997, *Scrambled Net Variance for Integrals of Smooth Functions*: whether a digit flips is drawn at random for each
//! setting of the digits before it; elementary intervals keep their points, and the error for smooth integrands falls as
//! N^-3/2. Laine and Karras 2011, *Stratified Sampling for Stochastic Transparency*: a hash in which information flows
//! upwards only, applied to the reversed bits, is such a permutation. Burley 2020, *Practical Hash-based Owen Scrambling*:
//! use of it, also on the index.
//!
//! The permutation is an approximation: 2^32 seeds, and later digits are better mixed than the first few. Seeds must be
//! well mixed in all bits ([`super::hash::mix`]): bit 0 of the seed alone decides about the first digit.

use crate::math::lanes::{IntLanes, Wrapping};

/// The reversed fraction with its digits permuted.
///
/// The hash of Vegdahl 2021, *Building a Better LK Hash*, in its corrected form: even multipliers and one odd one taken
/// from the seed.
#[inline(always)]
pub fn scramble_rev<I: IntLanes>(x_rev: I, seed: I) -> I {
    let x = xor_times(x_rev, 0x3d20_adea);
    let x = Wrapping::<I>::wrapping_add(x, seed);
    let x = Wrapping::<I>::wrapping_mul(x, (seed >> 16) | 1);
    xor_times(xor_times(x, 0x0552_6c56), 0x53a2_2864)
}

/// x xor x * even: bit b changes by the bits below it.
#[inline(always)]
fn xor_times<I: IntLanes>(x: I, even: u32) -> I {
    x ^ Wrapping::<u32>::wrapping_mul(x, even)
}

/// Another order of a sequence: indices permuted such that aligned blocks of 2^m stay together for every m.
///
/// All 32 digits take part, so no number of samples has to be known in advance, and a prefix of 2^m samples is an
/// aligned block.
#[inline(always)]
pub fn shuffle<I: IntLanes>(index: I, seed: I) -> I {
    scramble_rev(index.reverse_bits(), seed).reverse_bits()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::super::hash;
    use super::*;

    #[test]
    fn a_digit_depends_on_the_digits_before_it_only() {
        for seed in (0..64_u32).map(|i| hash::mix(i + 1)) {
            for x in (0..64_u32).map(|i| hash::mix(i + 1000)) {
                for digit in 0..32 {
                    let change = scramble_rev(x, seed) ^ scramble_rev(x ^ (1 << digit), seed);
                    assert_eq!(change.trailing_zeros(), digit, "x {x:#x}, seed {seed:#x}, digit {digit}");
                }
            }
        }
    }

    #[test]
    fn prefixes_stay_aligned_blocks() {
        for seed in (0..100_u32).map(hash::mix) {
            for m in 0..8 {
                let blocks: HashSet<_> = (0..1_u32 << m).map(|i| shuffle(i, seed) >> m).collect();
                let within: HashSet<_> = (0..1_u32 << m).map(|i| shuffle(i, seed) % (1 << m)).collect();
                assert_eq!((blocks.len(), within.len()), (1, 1 << m), "seed {seed:#x}, m {m}");
            }
        }
    }
}
