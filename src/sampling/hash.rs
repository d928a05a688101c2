//! Integer hashing, any width: mixing of identities into keys.
//!
//! Not cryptographic. Every bit of the result depends on every bit of the argument, low bits included, which the
//! scrambling of [`super::owen`] relies on.

use crate::math::lanes::{IntLanes, Wrapping};

/// A bijection of 32 bits whose output bits flip with probability close to one half for each input bit; 0 gives 0.
///
/// Two rounds of xorshift-multiply with constants found by search: Wellons 2018, *Prospecting for Hash Functions*
/// (`lowbias32`).
#[inline(always)]
pub fn mix<I: IntLanes>(x: I) -> I {
    let x = Wrapping::<u32>::wrapping_mul(x ^ (x >> 16), 0x7feb_352d);
    let x = Wrapping::<u32>::wrapping_mul(x ^ (x >> 15), 0x846c_a68b);
    x ^ (x >> 16)
}

/// A key made of a key and one more identity; a bijection of either while the other is fixed.
#[inline(always)]
pub fn combine<I: IntLanes>(key: I, id: I) -> I {
    // The odd constant keeps (0, 0) from giving 0, which would make a chain of first children stand still.
    mix(Wrapping::<u32>::wrapping_add(key ^ id, GOLDEN))
}

/// The key of a pixel, for a seed.
#[inline(always)]
pub fn pixel_key<I: IntLanes>(seed: u32, [x, y]: [I; 2]) -> I {
    combine(combine(x.splat(mix(seed)), x), y)
}

/// Seed `n` of a key.
#[inline(always)]
pub(super) fn seed<I: IntLanes>(key: I, n: u32) -> I {
    mix(Wrapping::<u32>::wrapping_add(key, GOLDEN.wrapping_mul(n)))
}

/// 2^32 divided by the golden ratio, rounded to odd: steps that spread well.
pub(super) const GOLDEN: u32 = 0x9e37_79b9;

#[cfg(test)]
mod tests {
    use super::*;

    /// For each input bit, how often each output bit flips, as the greatest distance from one half.
    #[test]
    fn one_bit_in_flips_half_of_the_bits_out() {
        const N: u32 = 4096;
        let mut worst = 0.0_f64;
        for bit in 0..32 {
            let mut flips = [0_u32; 32];
            for i in 0..N {
                let x = combine(i, 7_u32).wrapping_mul(2_654_435_761);
                let change = mix(x) ^ mix(x ^ (1 << bit));
                for (out, count) in flips.iter_mut().enumerate() {
                    *count += change >> out & 1;
                }
            }
            for count in flips {
                worst = worst.max((f64::from(count) / f64::from(N) - 0.5).abs());
            }
        }
        // Standard deviation 1/128; 5.2 of them for the greatest of 1024 at a significance of 2e-4, plus a bias of
        // 0.005, twice what the author of the constants reports for single bits.
        assert!(worst < 5.2 / 128.0 + 0.005, "worst bias {worst}");
    }
}
