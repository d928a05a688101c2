//! How much of a Phong lobe lies below the surface.

use crate::math::lanes::Lanes;

/// Nodes of Gauss and Legendre's rule on [0, 1], and their weights (Abramowitz and Stegun 1964, table 25.4): twelve
/// points, symmetric about the middle.
const NODES: [(f32, f32); 12] = [
    (0.990_780_3, 0.023_587_668),
    (0.952_058_7, 0.053_469_664),
    (0.884_951_34, 0.080_039_166),
    (0.793_659, 0.101_583_71),
    (0.683_915_73, 0.116_746_27),
    (0.562_616_7, 0.124_573_52),
    (0.437_383_3, 0.124_573_52),
    (0.316_084_24, 0.116_746_27),
    (0.206_341_02, 0.101_583_71),
    (0.115_048_66, 0.080_039_166),
    (0.047_941_37, 0.053_469_664),
    (0.009_219_683, 0.023_587_668),
];

/// Standard deviations over root two beyond which nothing of the lobe is left.
const REACH: f32 = 5.5;

/// The fraction, in [0, 1/2], of cos^e about the mirror direction that lies below the surface, seen at the cosine `cos_o` in
/// [0, 1]; `exponent` e >= 0. Within 3e-5.
///
/// Tilting the surface by an angle moves a slice of the lobe through it, which gives
/// P = 1/2 - 1/2 integral of cos^e from 0 to asin(cos_o), over the same to pi/2. Near the upper end the integrand of small
/// exponents is steep; a square takes that away.
#[inline(always)]
pub(crate) fn fraction_below<F: Lanes>(cos_o: F, exponent: F) -> F {
    let reach = exponent.max(1e-6).rsqrt() * REACH;
    let quarter = cos_o.splat(std::f32::consts::FRAC_PI_2);
    let part = integral(cos_o.clamp(0.0, 1.0).asin().min(reach), exponent);
    let whole = integral(quarter.min(reach), exponent);
    (part / whole * -0.5 + 0.5).clamp(0.0, 0.5)
}

/// The integral of cos^e from 0 to `end`.
#[inline(always)]
fn integral<F: Lanes>(end: F, exponent: F) -> F {
    let mut sum = end.splat(0.0);
    for (z, weight) in NODES {
        let half_sin = (end * (0.5 * (1.0 - z * z))).sin();
        let ln_cos = (half_sin.square() * -2.0).max(-1.0).ln_1p().max(-104.0);
        sum += (ln_cos * exponent).exp() * (2.0 * z * weight);
    }
    sum * end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_are_met() {
        for degrees in [0.0_f32, 1.0, 15.0, 45.0, 60.0, 80.0, 89.0, 90.0] {
            let (theta, cos) = (degrees.to_radians(), degrees.to_radians().cos());
            let all_around = fraction_below(cos, 0.0) - theta / std::f32::consts::PI;
            assert!(all_around.abs() < 3e-5, "e = 0 at {degrees}: off by {all_around}");
            let linear = fraction_below(cos, 1.0) - (1.0 - cos) / 2.0;
            assert!(linear.abs() < 3e-5, "e = 1 at {degrees}: off by {linear}");
            // The cubic: (2/3 - x + x^3 / 3) / (4/3) with x the cosine.
            let cubic = fraction_below(cos, 3.0) - 0.75 * (2.0 / 3.0 - cos + cos.powi(3) / 3.0);
            assert!(cubic.abs() < 3e-5, "e = 3 at {degrees}: off by {cubic}");
        }
        for exponent in [0.0, 0.3, 1.0, 1e3, 1e9] {
            let grazing = fraction_below(0.0, exponent);
            assert!((grazing - 0.5).abs() < 1e-6, "e = {exponent}: half of the lobe at grazing: {grazing}");
        }
    }
}
