//! The Beckmann distribution of microfacet normals: slopes are Gaussian with variance alpha^2 / 2 along each tangent.
//!
//! Beckmann and Spizzichino 1963; Smith's masking in closed form as in Walter et al. 2007 (Microfacet Models for Refraction)
//! and Heitz 2014 (Understanding the Masking-Shadowing Function).

use crate::math::Vec3;
use crate::math::lanes::Lanes;
use std::f32::consts::{FRAC_1_PI, FRAC_2_SQRT_PI};

/// Half of 1 / sqrt(pi).
const HALF_INVERSE_ROOT_PI: f32 = FRAC_2_SQRT_PI * 0.25;

/// Slopes in standard deviations times root two beyond which no random number of 24 bits reaches.
const STEEPEST: f32 = 4.3;

/// An anisotropic Beckmann surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beckmann<F> {
    /// Roughness along the first tangent.
    pub alpha_x: F,
    /// Roughness along the second tangent.
    pub alpha_y: F,
}

impl<F: Lanes> Beckmann<F> {
    /// The same roughness in all directions.
    #[inline(always)]
    pub fn isotropic(alpha: F) -> Self {
        Self { alpha_x: alpha, alpha_y: alpha }
    }

    /// Area of normals about `h` per solid angle and area of the mean surface, 1/sr:
    /// exp(-((x / a_x)^2 + (y / a_y)^2) / z^2) / (pi a_x a_y z^4) (Walter et al. 2007, eq. 25, for two roughnesses).
    #[inline(always)]
    pub fn d(&self, h: Vec3<F>) -> F {
        // Below a cosine of 0.01 the exponential is zero, and its divisor must not be.
        let z2 = h.z.square().max(1e-4);
        let slope2 = ((h.x / self.alpha_x).square() + (h.y / self.alpha_y).square()) / z2;
        let d = (-slope2).exp() * FRAC_1_PI / (self.alpha_x * self.alpha_y * z2.square());
        F::select(h.z.gt(0.0), d, d.splat(0.0))
    }

    /// |cos| (1 + 2 Lambda) of `w` with Smith's auxiliary function Lambda; the same on both sides of the surface.
    ///
    /// With a = 1 / (alpha tan): Lambda = exp(-a^2) / (2 a sqrt(pi)) - erfc(a) / 2, of which the first is never the smaller
    /// (Walter et al. 2007, 5.3). Times the cosine, a quotient by it is not needed. Within 4e-7 of itself.
    #[inline(always)]
    pub fn stretched(&self, w: Vec3<F>) -> F {
        let slope = ((w.x * self.alpha_x).square() + (w.y * self.alpha_y).square()).sqrt();
        let cos = w.z.abs();
        let a = cos / slope.max(1e-30);
        let gauss = (-a.square()).exp();
        let hidden = slope * gauss * (2.0 * HALF_INVERSE_ROOT_PI) - cos * erfc(a, gauss);
        cos + hidden.max(0.0)
    }

    /// A normal from those that `wo` sees, of density D G1 (wo.h) / wo.z with respect to solid angle.
    ///
    /// The surface is stretched to alpha 1, where the slope across the view is Gaussian and that along it has the density
    /// (x + cot theta) exp(-x^2) (Heitz and d'Eon 2014, Importance Sampling Microfacet-Based BSDFs using the Distribution of
    /// Visible Normals). Its distribution is inverted as W. Jakob proposed in 2014 (An Improved Visible Normal Sampling
    /// Routine for the Beckmann Distribution): by Newton's method in the distribution of the Gaussian, not in the slope.
    #[inline(always)]
    pub fn sample_visible(&self, wo: Vec3<F>, [u, v]: [F; 2]) -> Vec3<F> {
        let (x, y) = (wo.x * self.alpha_x, wo.y * self.alpha_y);
        let across2 = x.mul_add(x, y * y);
        let inverse = across2.max(1e-30).rsqrt();
        let level = across2.lt(1e-30);
        let (cos, sin) =
            (F::select(level, x.splat(1.0), x * inverse), F::select(level, x.splat(0.0), y * inverse));
        let along = visible_slope(across2.sqrt() / wo.z.max(1e-12), u);
        let side = -gauss_quantile(v);
        let slope_x = (cos * along - sin * side) * self.alpha_x;
        let slope_y = (sin * along + cos * side) * self.alpha_y;
        Vec3::new(slope_x, slope_y, u.splat(1.0)).normalize()
    }
}

/// The slope towards a viewer at an angle of this tangent, on a surface of alpha 1.
///
/// In terms of q = erfc(x) / 2 the part of the visible area with greater slopes is proportional to
/// q + tan exp(-x^2) / (2 sqrt(pi)), concave with the derivative 1 + tan x; both are scaled by 1 / (1 + tan) here. Five steps
/// bring it within 2e-7 (measured over all angles).
#[inline(always)]
fn visible_slope<F: Lanes>(tan: F, u: F) -> F {
    let one = u.splat(1.0);
    let level = (tan + 1.0).recip();
    let steep = tan * level;
    // No slope below -cot is seen.
    let lowest = tan.max(1e-12).recip().min(STEEPEST);
    let gauss = (-lowest.square()).exp();
    let most = one - erfc(lowest, gauss) * 0.5;
    let whole = level * most + steep * gauss * HALF_INVERSE_ROOT_PI;
    let goal = (one - u) * whole;
    let mut q = most * (one - u.powf(-steep * 0.5 + 1.0));
    let mut x = gauss_quantile(q);
    for _ in 0..5 {
        let seen = level * q + steep * HALF_INVERSE_ROOT_PI * (-x.square()).exp();
        let slope = level + steep * x;
        q = (q - (seen - goal) / slope.max(1e-7)).max(0.0).min(most);
        x = gauss_quantile(q);
    }
    x
}

/// x with erfc(x) / 2 = `q` in [0, 1], kept within what 24 bits can tell from the ends: within 6e-8 of `q`.
///
/// M. Giles 2010, Approximating the erfinv function, table 5 (single precision).
#[inline(always)]
fn gauss_quantile<F: Lanes>(q: F) -> F {
    const CENTRE: [f32; 9] = [
        2.810_226_4e-8,
        3.432_739_4e-7,
        -3.523_387_7e-6,
        -4.391_506_5e-6,
        2.185_808_7e-4,
        -1.253_725e-3,
        -4.177_681_6e-3,
        0.246_640_73,
        1.501_409_4,
    ];
    const TAIL: [f32; 9] = [
        -2.002_142_6e-4,
        1.009_505_6e-4,
        1.349_343_2e-3,
        -3.673_428_4e-3,
        5.739_507_7e-3,
        -7.622_461_3e-3,
        9.438_870_5e-3,
        1.001_674,
        2.832_976_8,
    ];
    const LEAST: f32 = 1.0 / 33_554_432.0;
    let q = q.clamp(LEAST, 1.0 - f32::EPSILON / 2.0);
    let w = -(q * (-q + 1.0) * 4.0).ln();
    let polynomial = F::select(w.lt(5.0), horner(w - 2.5, CENTRE), horner(w.max(0.0).sqrt() - 3.0, TAIL));
    polynomial * (-q * 2.0 + 1.0)
}

/// erfc(x) given exp(-x^2), for x >= 0: within 3e-7 (Hastings 1955; Abramowitz and Stegun 1964, eq. 7.1.26).
#[inline(always)]
fn erfc<F: Lanes>(x: F, gauss: F) -> F {
    let t = (x * 0.327_591_1 + 1.0).recip();
    horner(t, [1.061_405_4, -1.453_152, 1.421_413_7, -0.284_496_74, 0.254_829_6, 0.0]) * gauss
}

/// The polynomial with these coefficients, highest power first.
#[inline(always)]
fn horner<F: Lanes, const N: usize>(x: F, coefficients: [f32; N]) -> F {
    let mut sum = x.splat(coefficients[0]);
    for &c in &coefficients[1..] {
        sum = sum.mul_add(x, x.splat(c));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// erfc by Simpson's rule, in double precision.
    fn exact_erfc(x: f64) -> f64 {
        let (steps, end) = (20_000_u32, x.max(0.0) + 8.0);
        let at = |i: u32| {
            let t = x + (end - x) * f64::from(i) / f64::from(steps);
            (-t * t).exp()
        };
        let weight = |i: u32| if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
        let sum: f64 = (0..=steps).map(|i| weight(i) * at(i)).sum();
        sum * (end - x) / f64::from(3 * steps) * 2.0 / std::f64::consts::PI.sqrt()
    }

    #[test]
    fn the_error_function_and_its_inverse_are_close() {
        for i in 0..=400_u16 {
            let x = f32::from(i) * 0.01;
            let found = f64::from(erfc(x, (-x * x).exp()));
            assert!((found - exact_erfc(x.into())).abs() < 3e-7, "erfc({x}): {found}");
        }
        for i in 1..1000_u16 {
            let q = f32::from(i) * 1e-3;
            let back = exact_erfc(gauss_quantile(q).into()) * 0.5;
            assert!((back - f64::from(q)).abs() < 1.2e-7, "{q}: {back}");
        }
    }

    #[test]
    fn visible_slopes_are_found_at_all_angles() {
        for degrees in [0.0_f32, 1.0, 20.0, 45.0, 60.0, 80.0, 89.0, 89.99] {
            let tan = degrees.to_radians().tan();
            let tan64 = f64::from(tan);
            let scale = 1.0 / (1.0 + tan64);
            // The part of the visible area with slopes beyond x, times the scale.
            let beyond = |x: f64| {
                (exact_erfc(x) * 0.5 + tan64 * (-x * x).exp() * 0.5 / std::f64::consts::PI.sqrt()) * scale
            };
            let whole = beyond(-(1.0 / tan64.max(1e-9)).min(6.0));
            for i in 1..200_u16 {
                let u = f32::from(i) / 200.0;
                let x = visible_slope(tan, u);
                let off = beyond(x.into()) - (1.0 - f64::from(u)) * whole;
                assert!(off.abs() < 6e-7, "{degrees} degrees, {u}: slope {x} is off by {off:e}");
            }
            for u in [0.0, 2.0_f32.powi(-24), 1.0 - f32::EPSILON / 2.0] {
                assert!(visible_slope(tan, u).is_finite(), "{degrees} degrees, {u}");
            }
        }
    }
}
