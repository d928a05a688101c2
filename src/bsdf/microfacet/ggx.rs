//! The GGX distribution of microfacet normals.
//!
//! Trowbridge and Reitz 1975, named by Walter et al. 2007 (Microfacet Models for Refraction); Smith's masking with
//! correlated heights (Heitz 2014, Understanding the Masking-Shadowing Function).

use crate::math::Vec3;
use crate::math::lanes::Lanes;
use std::f32::consts::FRAC_1_PI;

/// An anisotropic GGX surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx<F> {
    /// Roughness along the first tangent.
    pub alpha_x: F,
    /// Roughness along the second tangent.
    pub alpha_y: F,
}

impl<F: Lanes> Ggx<F> {
    /// The same roughness in all directions.
    #[inline(always)]
    pub fn isotropic(alpha: F) -> Self {
        Self { alpha_x: alpha, alpha_y: alpha }
    }

    /// Area of normals about `h` per solid angle and area of the mean surface, 1/sr.
    ///
    /// 1 / (pi a_x a_y ((x / a_x)^2 + (y / a_y)^2 + z^2)^2) (Walter et al. 2007, eq. 33, for two roughnesses), with the
    /// fractions cleared: no quotient by a small roughness overflows, and no 1 - z^2 cancels.
    #[inline(always)]
    pub fn d(&self, h: Vec3<F>) -> F {
        let (ax, ay) = (self.alpha_x, self.alpha_y);
        let x = h.x * ay;
        let y = h.y * ax;
        let z = h.z * ax * ay;
        let product = ax * ay;
        let e = x.mul_add(x, y.mul_add(y, z * z));
        let d = (product / e).square() * product * FRAC_1_PI;
        F::select(h.z.gt(0.0), d, d.splat(0.0))
    }

    /// sqrt(cos^2 + (slope sin)^2), the length of `w` as the stretched surface has it: cos (1 + 2 Lambda) in terms of Smith's
    /// auxiliary function, which grows without bound towards the horizon where this does not.
    #[inline(always)]
    pub fn stretched(&self, w: Vec3<F>) -> F {
        let slope = (w.x * self.alpha_x).square() + (w.y * self.alpha_y).square();
        w.z.mul_add(w.z, slope).sqrt()
    }

    /// A normal from those that `wo` sees, of density D G1 (wo.h) / wo.z with respect to solid angle.
    ///
    /// The visible normals of a hemisphere are a spherical cap (Dupuy and Benyoub 2023, Sampling Visible GGX Normals
    /// with Spherical Caps); the ellipsoid of GGX is a stretched hemisphere.
    #[inline(always)]
    pub fn sample_visible(&self, wo: Vec3<F>, [u, v]: [F; 2]) -> Vec3<F> {
        let one = u.splat(1.0);
        let stretched = Vec3::new(wo.x * self.alpha_x, wo.y * self.alpha_y, wo.z).normalize();
        // Height above the rim of the cap, which the sum of both vectors has for its own.
        let height = (one - v) * (stretched.z + 1.0);
        // 1 - z^2 as (1 - z)(1 + z), with 1 - z = v (1 + wo.z) and 1 + z = height + sin^2 / (1 + wo.z): of steep slopes, for
        // which both are small, the sum 1 + z itself would leave nothing.
        let sin2 = stretched.x.mul_add(stretched.x, stretched.y * stretched.y);
        let s = (v * (stretched.z + 1.0).mul_add(height, sin2)).sqrt();
        let (sin, cos) = u.sin_cos_turns();
        let (x, y) = (cos.mul_add(s, stretched.x), sin.mul_add(s, stretched.y));
        Vec3::new(x * self.alpha_x, y * self.alpha_y, height.max(1e-30)).normalize()
    }
}
