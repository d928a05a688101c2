//! Permutations of 0..n by hashing, any n, any width: shuffles without a table.
//!
//! Kensler 2013, *Correlated Multi-Jittered Sampling*, section 4: a keyed bijection of the next power of two is walked until
//! it lands below n, which permutes the numbers below n (Black and Rogaway 2002, *Ciphers with Arbitrary Finite
//! Domains*). The bijection is our own: multiplications by odd numbers alternate with xorshifts by half of the bits, keys
//! from a congruential generator.
//!
//! Cheapest where n is a power of two: nothing is walked twice.

use super::hash;
use crate::math::lanes::{Compare, IntLanes, MaskLanes, Wrapping};

/// Rounds of the bijection. With four, some orders of four numbers are off their share by a quarter; with six by a tenth, and
/// longer ones show nothing.
const ROUNDS: u32 = 6;

/// Where a permutation of 0..`len` that is drawn by `seed` sends `index`, for `index` < `len`.
///
/// `seed` should be mixed in all bits.
#[inline(always)]
pub fn permute<I: IntLanes>(index: I, len: u32, seed: I) -> I {
    if len <= 1 {
        return index.splat(0);
    }
    let bits = 32 - (len - 1).leading_zeros();
    let mut x = bijection(index, bits, seed);
    if !len.is_power_of_two() {
        // Lanes that have arrived wait for the others; each needs fewer than two turns on average.
        loop {
            let outside = Compare::<u32>::ge(x, len);
            if outside.none() {
                break;
            }
            x = I::select(outside, bijection(x, bits, seed), x);
        }
    }
    x
}

/// A bijection of the numbers of that many bits.
#[inline(always)]
fn bijection<I: IntLanes>(x: I, bits: u32, seed: I) -> I {
    let mask = u32::MAX >> (32 - bits);
    let half = bits.div_ceil(2);
    let mut key = seed;
    let mut x = x;
    for _ in 0..ROUNDS {
        key = Wrapping::<u32>::wrapping_mul(key, 0x915f_77f5);
        key = Wrapping::<u32>::wrapping_add(key, hash::GOLDEN);
        // The upper bits of the key are the better ones; two halves of it are taken.
        x = Wrapping::<I>::wrapping_mul(x, (key >> 11) | 1);
        x = Wrapping::<I>::wrapping_add(x, key >> 17) & mask;
        x = x ^ (x >> half);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    fn seed(i: u32) -> u32 {
        hash::mix(i.wrapping_mul(hash::GOLDEN) ^ 0x1234_5678)
    }

    fn order(len: u32, seed: u32) -> Vec<u32> {
        (0..len).map(|i| permute(i, len, seed)).collect()
    }

    #[test]
    fn every_length_is_permuted() {
        for len in (1..200).chain([255, 256, 257, 1000, 4095, 4096, 5000]) {
            for trial in 0..20 {
                let mut all = order(len, seed(trial));
                all.sort_unstable();
                assert!(all.into_iter().eq(0..len), "length {len}, trial {trial}");
            }
        }
    }

    /// All orders of few numbers are about equally frequent: none is off by more than a fifth of its share, of which a
    /// tenth is five standard deviations of the sampling.
    #[test]
    fn orders_of_few_numbers_are_equally_frequent() {
        for (len, orders) in [(2, 2), (3, 6), (4, 24), (5, 120)] {
            let mut counts = HashMap::new();
            let trials = 2500 * orders;
            for trial in 0..trials {
                *counts.entry(order(len, seed(trial))).or_insert(0_u32) += 1;
            }
            assert_eq!(counts.len(), orders as usize, "orders of {len}");
            for (order, count) in counts {
                let share = f64::from(count * orders) / f64::from(trials);
                assert!((share - 1.0).abs() < 0.2, "{order:?}: {share} of its share");
            }
        }
    }

    /// Each place goes to each place, and neighbours to each distance, equally often.
    #[test]
    fn places_and_distances_are_uniform() {
        const TRIALS: u32 = 100_000;
        for len in [6, 7, 8, 16, 25] {
            let n = len as usize;
            let (mut places, mut distances) = (vec![0_u32; n * n], vec![0_u32; n * n]);
            for trial in 0..TRIALS {
                let order = order(len, seed(trial));
                for i in 0..n {
                    let (here, next) = (order[i], order[(i + 1) % n]);
                    places[i * n + here as usize] += 1;
                    distances[i * n + ((next + len - here) % len) as usize] += 1;
                }
            }
            for (what, counts, others) in [("place", places, len), ("distance", distances, len - 1)] {
                for (cell, count) in counts.into_iter().enumerate() {
                    let impossible = what == "distance" && cell % n == 0;
                    let expected = if impossible { 0.0 } else { f64::from(TRIALS) / f64::from(others) };
                    // Five standard deviations and a bias of two per cent.
                    let tolerance = 5.0 * expected.sqrt() + 0.02 * expected;
                    let error = (f64::from(count) - expected).abs();
                    assert!(error <= tolerance, "length {len}, {what} {cell}: {count}, not {expected}");
                }
            }
        }
    }
}
