//! Lambert's lobe.

use crate::bsdf::BsdfSample;
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};
use crate::sampling::warp;
use std::f32::consts::FRAC_1_PI;

/// The same radiance in all directions of the hemisphere.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse<F> {
    /// Fraction of the power reflected, in [0, 1].
    pub reflectance: Rgb<F>,
}

impl<F: Lanes> Diffuse<F> {
    /// A direction of density cos / pi.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F> {
        let wi = warp::cosine_hemisphere(u2);
        let pdf = wi.z * FRAC_1_PI;
        BsdfSample { wi, weight: self.reflectance, pdf, valid: wo.z.gt(0.0) & wi.z.gt(0.0) }
    }

    /// cos / pi: density of [`Self::sample`] with respect to solid angle.
    #[inline(always)]
    pub fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        F::select(wo.z.gt(0.0), wi.z.max(0.0) * FRAC_1_PI, wi.z.splat(0.0))
    }

    /// reflectance / pi on the lit side.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        let above = wo.z.gt(0.0) & wi.z.gt(0.0);
        self.reflectance * F::select(above, wi.z.splat(FRAC_1_PI), wi.z.splat(0.0))
    }
}
