//! The first two dimensions of Sobol's sequence: a (0,2)-sequence in base 2.
//!
//! Every aligned run of 2^m points has exactly one point in each elementary interval of area 2^-m (Sobol 1967, *On the
//! distribution of points in a cube*; Niederreiter 1987, *Point sets and sequences with small discrepancy*). Higher
//! dimensions are not here: pairs made of these two, each with its own shuffle and scrambling, serve all dimensions
//! (see [`super::OwenSobol`]).
//!
//! Coordinates are 32-bit fractions with the bits reversed (`_rev`): bit 0 is the half, bit 1 the quarter. This is the
//! order that [`super::owen`] scrambles in. Reversed, the first dimension (van der Corput's) is the index itself. The
//! second one's direction numbers form the upper triangular matrix of binomial coefficients modulo 2, which is the fifth
//! Kronecker power of ((1, 1), (0, 1)): five steps, no table, and no loop over the bits of the index.

use crate::math::lanes::IntLanes;

/// Coordinates of point `index`, reversed.
#[inline(always)]
pub fn sobol_2d_rev<I: IntLanes>(index: I) -> [I; 2] {
    [index, second_rev(index)]
}

/// Bit r is the parity of the index bits i whose binary digits include those of r: C(i, r) mod 2 by Lucas' theorem.
#[inline(always)]
fn second_rev<I: IntLanes>(index: I) -> I {
    let x = index ^ ((index >> 1) & 0x5555_5555);
    let x = x ^ ((x >> 2) & 0x3333_3333);
    let x = x ^ ((x >> 4) & 0x0f0f_0f0f);
    let x = x ^ ((x >> 8) & 0x00ff_00ff);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Direction numbers of the polynomial x + 1 by the recurrence of Bratley and Fox 1988, *Algorithm 659*:
    /// v_i = v_(i-1) xor v_(i-1) / 2, as fractions of 2^32.
    #[test]
    fn the_second_dimension_has_the_published_direction_numbers() {
        let mut v = 1_u32 << 31;
        for bit in 0..32 {
            assert_eq!(second_rev(1_u32 << bit).reverse_bits(), v, "direction number {bit}");
            v ^= v >> 1;
        }
    }

    #[test]
    fn the_second_dimension_is_linear() {
        for i in 0..500_u32 {
            let (a, b) = (i.wrapping_mul(2_654_435_761), i.wrapping_mul(i).wrapping_mul(0x9e37_79b9));
            assert_eq!(second_rev(a ^ b), second_rev(a) ^ second_rev(b), "{a:#x} and {b:#x}");
        }
    }
}
