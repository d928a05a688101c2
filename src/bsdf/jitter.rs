//! A mirror whose normal trembles: the introductory lecture's other way to a glossy surface.

use crate::bsdf::BsdfSample;
use crate::bsdf::conductor::half_vector;
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};
use crate::sampling::warp;
use std::f32::consts::TAU;

/// A mirror whose normals are spread.
///
/// Normals of density cos^m about the true one mirror the view. Near normal incidence the lobe is that of
/// [`crate::bsdf::Glossy`] with e = (m - 3) / 4; at grazing it is stretched, twice as wide in the plane of incidence as the
/// normals and narrower across it. Every sample weighs the same; what falls below the surface is lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jitter<F> {
    /// Fraction of the power reflected, in [0, 1], the same at every angle.
    pub reflectance: Rgb<F>,
    /// Exponent m of the normals, in [0, 1e9].
    pub exponent: F,
}

impl<F: Lanes> Jitter<F> {
    /// The view mirrored at a normal; not valid where it falls below the surface or the normal turns away.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F> {
        let h = warp::power_cosine(u2, self.exponent);
        let cos = wo.dot(h);
        let wi = h * (cos * 2.0) - wo;
        let pdf = self.density(h, cos);
        let valid = wo.z.gt(0.0) & wi.z.gt(0.0) & cos.gt(0.0) & pdf.gt(0.0);
        BsdfSample { wi, weight: self.reflectance, pdf, valid }
    }

    /// (m + 1) / (2 pi) cos^m / (4 wo.h): density of [`Self::sample`] with respect to solid angle.
    #[inline(always)]
    pub fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        let (h, cos, lit) = half_vector(wo, wi);
        F::select(lit, self.density(h, cos), wo.z.splat(0.0))
    }

    /// reflectance pdf / cos theta_i, so that every sample weighs the same.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        self.reflectance * (self.pdf(wo, wi) / wi.z.max(1e-30))
    }

    #[inline(always)]
    fn density(&self, h: Vec3<F>, cos: F) -> F {
        let power = warp::power_of_cosine(h, self.exponent);
        (self.exponent + 1.0) * power / (cos.max(1e-30) * (4.0 * TAU))
    }
}
