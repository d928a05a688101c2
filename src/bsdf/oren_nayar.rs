//! Rough matt surfaces: plaster, clay, the moon.
//!
//! Oren and Nayar 1994 (Generalization of Lambert's Reflectance Model) in the energy-preserving form of Portsmouth, Kutz and
//! Hill 2025 (EON: A Practical Energy-Preserving Rough Diffuse BRDF): Fujii's variant of the qualitative model, which has no
//! dark ring, and a second, reciprocal lobe for the light that bounces between slopes. A white surface reflects exactly
//! everything at every roughness and angle.

use crate::bsdf::{BsdfSample, Diffuse};
use crate::math::lanes::{Lanes, Select};
use crate::math::{Rgb, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};

/// Fujii's constant: 1/2 - 2 / (3 pi).
const FLATTENING: f32 = 0.5 - 2.0 / (3.0 * PI);

/// The cosine-weighted mean of the geometric term, over pi: 2/3 - 28 / (15 pi).
const MEAN: f32 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

/// A rough matt surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrenNayar<F> {
    /// Reflectance of the slopes, in [0, 1] per channel.
    pub reflectance: Rgb<F>,
    /// From 0, which is Lambert's lobe, to 1.
    pub roughness: F,
}

impl<F: Lanes> OrenNayar<F> {
    /// A direction of density cos / pi.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F> {
        let matt = Diffuse { reflectance: self.reflectance }.sample(wo, u2);
        let weight = self.eval(wo, matt.wi).scale(PI);
        BsdfSample { weight, ..matt }
    }

    /// cos / pi: density of [`Self::sample`] with respect to solid angle.
    #[inline(always)]
    pub fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        Diffuse { reflectance: self.reflectance }.pdf(wo, wi)
    }

    /// The single and the multiple bounce, 1/sr.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        let (zero, one) = (wo.z.splat(0.0), wo.z.splat(1.0));
        let lit = wo.z.gt(0.0) & wi.z.gt(0.0);
        let plain = (self.roughness * FLATTENING + 1.0).recip();
        let rough = self.roughness * plain;
        // The part of wo and wi that runs along the surface: positive where light comes from the viewer's side.
        let s = wo.x.mul_add(wi.x, wo.y * wi.y);
        let t = F::select(s.gt(0.0), wo.z.max(wi.z).max(1e-30), one);
        let single = rough.mul_add(s / t, plain);
        let mean = rough.mul_add(rough.splat(MEAN), plain);
        let lost = (one - self.albedo(wo.z)).max(0.0) * (one - self.albedo(wi.z)).max(0.0);
        let again = lost / (one - mean).max(1e-7);
        let rho = self.reflectance;
        let white = Rgb::gray(one);
        let bounced = rho * rho * mean / (white - rho * (one - mean));
        let f = (rho * single.max(0.0) + bounced * again).scale(FRAC_1_PI);
        Rgb::select(lit, f, Rgb::gray(zero))
    }

    /// What the first bounce reflects of light at this cosine, for slopes that reflect everything.
    #[inline(always)]
    fn albedo(&self, cos: F) -> F {
        let plain = (self.roughness * FLATTENING + 1.0).recip();
        let c = cos.clamp(0.0, 1.0);
        let s = ((-c + 1.0) * (c + 1.0)).sqrt();
        // (s / c)(1 - s^3) as c s (1 + s + s^2) / (1 + s): finite at grazing.
        let far = c * s * (s * (s + 1.0) + 1.0) / (s + 1.0);
        let g = s * (c.acos() - s * c) + (far - s) * (2.0 / 3.0);
        (self.roughness * plain).mul_add(g * FRAC_1_PI, plain)
    }
}
