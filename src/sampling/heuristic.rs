//! Weights that combine sampling strategies (multiple importance sampling).
//!
//! Veach and Guibas 1995, *Optimally Combining Sampling Techniques for Monte Carlo Rendering*. Densities must have the same
//! measure and include the number of samples: n p. A specular lobe or a point light has no partner: its weight is 1
//! and none of these is called.

use crate::math::lanes::{Compare, Lanes};

/// p^2 / (p^2 + other^2): the power heuristic with exponent 2. Finite for all densities from 0 to infinity, since nothing
/// is squared before it is divided by the larger one.
#[inline(always)]
pub fn power<F: Lanes>(p: F, other: F) -> F {
    let (one, smaller) = (p.splat(1.0), ratio(p, other).square());
    F::select(Compare::<F>::ge(p, other), one, smaller) / (smaller + 1.0)
}

/// The smaller density over the larger one; 1 where they are equal, zero and infinity included.
#[inline(always)]
fn ratio<F: Lanes>(p: F, other: F) -> F {
    let one = p.splat(1.0);
    let (small, large) = (Compare::<F>::min(p, other), Compare::<F>::max(p, other));
    F::select(Compare::<F>::eq(small, large), one, small / large)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_partners_add_up_to_one() {
        let densities = [0.0, 1e-45, 1e-38, 1e-20, 0.3, 1.0, 7.0, 1e19, 1e38, f32::MAX, f32::INFINITY];
        for p in densities {
            for q in densities {
                let sum = power(p, q) + power(q, p);
                assert!((sum - 1.0_f32).abs() < 2e-7, "{p} and {q}: {sum}");
            }
        }
    }

    #[test]
    fn weights_are_those_of_the_definition() {
        for (p, q) in [(1.0_f32, 3.0), (0.25, 0.5), (100.0, 1.0), (5.0, 0.0)] {
            let w = p * p / (p * p + q * q);
            assert!((power(p, q) - w).abs() < 2e-7, "power of {p} and {q}");
        }
        assert!(power(0.0_f32, 2.0) == 0.0, "what cannot be sampled has no weight");
    }
}
