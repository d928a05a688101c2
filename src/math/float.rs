//! Facts about single precision that error bounds are made of.

/// Half the distance from 1 to the next larger `f32`: the largest relative error of one rounding.
pub const UNIT_ROUNDOFF: f32 = f32::EPSILON * 0.5;

/// Bound on the relative error of `n` roundings in a row, `n u / (1 - n u)` (Higham 2002, Accuracy and
/// Stability, lemma 3.1).
#[must_use]
pub const fn gamma(n: u16) -> f32 {
    let nu = n as f32 * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gamma_bounds_a_long_sum() {
        let n = 1000_u16;
        let sum = (0..n).fold(0.0_f32, |sum, _| sum + 0.1);
        let exact = f64::from(0.1_f32) * f64::from(n);
        let relative = (f64::from(sum) - exact).abs() / exact;
        assert!(relative < f64::from(gamma(n)), "{relative:e} exceeds the bound");
        assert!(relative > f64::from(gamma(1)), "the sum was exact: the test shows nothing");
    }
}
