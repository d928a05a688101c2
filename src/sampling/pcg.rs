//! Hashes of two and three numbers to as many, any width: what independent random numbers are made of.
//!
//! Jarzynski and Olano 2020, *Hash Functions for GPU Rendering*: rounds of the linear congruential generator that PCG
//! permutes (O'Neill 2014, *PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms*), the
//! components multiplied into each other between. No table, no shift by a variable amount: cheap in lanes.
//! The upper bits are the better ones.

use crate::math::lanes::{IntLanes, Wrapping};

const MULTIPLIER: u32 = 1_664_525;
const INCREMENT: u32 = 1_013_904_223;

#[inline(always)]
fn step<I: IntLanes>(x: I) -> I {
    let x = Wrapping::<u32>::wrapping_mul(x, MULTIPLIER);
    Wrapping::<u32>::wrapping_add(x, INCREMENT)
}

#[inline(always)]
fn add_product<I: IntLanes>(x: I, a: I, b: I) -> I {
    Wrapping::<I>::wrapping_add(x, Wrapping::<I>::wrapping_mul(a, b))
}

#[inline(always)]
fn fold<I: IntLanes>(x: I) -> I {
    x ^ (x >> 16)
}

/// Three hashes of three numbers (`pcg3d` of the paper); a bijection.
#[inline(always)]
pub fn pcg3d<I: IntLanes>([x, y, z]: [I; 3]) -> [I; 3] {
    let [x, y, z] = products([step(x), step(y), step(z)]);
    products([fold(x), fold(y), fold(z)])
}

#[inline(always)]
fn products<I: IntLanes>([x, y, z]: [I; 3]) -> [I; 3] {
    let x = add_product(x, y, z);
    let y = add_product(y, z, x);
    let z = add_product(z, x, y);
    [x, y, z]
}

/// Two hashes of two numbers (`pcg2d` of the paper); a bijection.
#[inline(always)]
pub fn pcg2d<I: IntLanes>([x, y]: [I; 2]) -> [I; 2] {
    let [x, y] = scaled_sums([step(x), step(y)]);
    let [x, y] = scaled_sums([fold(x), fold(y)]);
    [fold(x), fold(y)]
}

#[inline(always)]
fn scaled_sums<I: IntLanes>([x, y]: [I; 2]) -> [I; 2] {
    let x = Wrapping::<I>::wrapping_add(x, Wrapping::<u32>::wrapping_mul(y, MULTIPLIER));
    let y = Wrapping::<I>::wrapping_add(y, Wrapping::<u32>::wrapping_mul(x, MULTIPLIER));
    [x, y]
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn hashes_do_not_collide() {
        let range = 0..40_u32;
        let mut two = HashSet::new();
        let mut three = HashSet::new();
        for x in range.clone() {
            for y in range.clone() {
                assert!(two.insert(pcg2d([x, y])), "pcg2d({x}, {y})");
                for z in range.clone() {
                    assert!(three.insert(pcg3d([x, y, z])), "pcg3d({x}, {y}, {z})");
                }
            }
        }
    }
}
