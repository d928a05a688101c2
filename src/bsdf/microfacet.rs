//! The GGX distribution of microfacet normals.
//!
//! Trowbridge and Reitz 1975, named by Walter et al. 2007 (Microfacet Models for Refraction); Smith's masking with
//! correlated heights (Heitz 2014, Understanding the Masking-Shadowing Function). Alpha from 1e-4 to 1: what is smoother
//! is a mirror, since the lobe is then narrower than the rounding of a unit vector.

use crate::math::Vec3;
use crate::math::lanes::Lanes;
use std::f32::consts::FRAC_1_PI;

/// Below this roughness a surface is treated as polished.
pub const SMOOTHEST: f32 = 1e-4;

/// An anisotropic GGX surface.
#[derive(Clone, Copy, Debug)]
pub struct Ggx<F> {
    /// Roughness along the first tangent.
    pub alpha_x: F,
    /// Roughness along the second tangent.
    pub alpha_y: F,
}

/// What masking of two directions is made of: G2 = 2 cos_o cos_i / (s_o cos_i + s_i cos_o) with the stretched lengths s. Over the
/// larger cosine, lest products of small ones be lost below the least number.
#[derive(Clone, Copy, Debug)]
struct Both<F> {
    larger: F,
    /// cos_i over the larger cosine.
    part_i: F,
    stretched_o: F,
    /// (s_o cos_i + s_i cos_o) over the larger cosine.
    sum: F,
}

impl<F: Lanes> Both<F> {
    #[inline(always)]
    fn of(ggx: &Ggx<F>, wo: Vec3<F>, wi: Vec3<F>) -> Self {
        let (stretched_o, stretched_i) = (ggx.stretched(wo), ggx.stretched(wi));
        let larger = wo.z.max(wi.z).max(LEAST);
        let (part_o, part_i) = (wo.z / larger, wi.z / larger);
        let sum = stretched_o.mul_add(part_i, stretched_i * part_o).max(1e-30);
        Self { larger, part_i, stretched_o, sum }
    }
}

/// The least positive number.
const LEAST: f32 = f32::from_bits(1);

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
    fn stretched(&self, w: Vec3<F>) -> F {
        let slope = (w.x * self.alpha_x).square() + (w.y * self.alpha_y).square();
        w.z.mul_add(w.z, slope).sqrt()
    }

    /// Fraction of the microfacets facing `w` that `w` sees, in [0, 1]: 1 / (1 + Lambda).
    #[inline(always)]
    pub fn g1(&self, w: Vec3<F>) -> F {
        w.z * self.g1_over_cos(w)
    }

    /// [`Self::g1`] over the cosine of `w`, which stays finite at the horizon.
    #[inline(always)]
    pub fn g1_over_cos(&self, w: Vec3<F>) -> F {
        (self.stretched(w) + w.z).max(1e-30).recip() * 2.0
    }

    /// Fraction that both see, heights correlated, in [0, 1]: 1 / (1 + Lambda(wo) + Lambda(wi)).
    #[inline(always)]
    pub fn g2(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        wo.z.min(wi.z) * 2.0 / Both::of(self, wo, wi).sum
    }

    /// [`Self::g2`] over [`Self::g1`] of `wo`: what is left of a direction mirrored at a visible normal.
    #[inline(always)]
    pub fn g2_over_g1(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        let both = Both::of(self, wo, wi);
        both.part_i * (both.stretched_o + wo.z) / both.sum
    }

    /// D G2 / (4 cos theta_o cos theta_i) with D at the half vector `h`, 1/sr; the greatest float where it is more.
    #[inline(always)]
    pub fn reflected(&self, h: Vec3<F>, wo: Vec3<F>, wi: Vec3<F>) -> F {
        let both = Both::of(self, wo, wi);
        (self.d(h) * 0.5 / both.sum / both.larger).min(f32::MAX)
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
        let z = height - stretched.z;
        // 1 - z^2 as (1 - z)(1 + z), with 1 - z = v (1 + wo.z) exactly.
        let s = (v * (stretched.z + 1.0) * (z + 1.0)).max(0.0).sqrt();
        let (sin, cos) = u.sin_cos_turns();
        let (x, y) = (cos.mul_add(s, stretched.x), sin.mul_add(s, stretched.y));
        Vec3::new(x * self.alpha_x, y * self.alpha_y, height.max(1e-30)).normalize()
    }
}
