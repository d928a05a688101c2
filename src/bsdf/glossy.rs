//! The Phong lobe about the mirror direction.
//!
//! Directions are drawn from cos^e about the mirror direction r; those below the surface are turned by half a turn
//! about r, which always brings them above it (E. Shaffer, Glossy Reflection, after Suffern 2007, Ray Tracing from the
//! Ground Up, chapter 25). Every sample has the same weight, so a glossy sphere in a uniform surround is uniform, and
//! for e to infinity the lobe is a mirror; the price is that the lobe is not reciprocal.

use crate::bsdf::BsdfSample;
use crate::bsdf::mirror::mirrored;
use crate::math::lanes::{Lanes, Select};
use crate::math::{Frame, Rgb, Vec3};
use crate::sampling::warp;
use std::f32::consts::TAU;

/// A fuzzy mirror.
#[derive(Clone, Copy, Debug)]
pub struct Glossy<F> {
    /// Fraction of the power reflected, in [0, 1], the same at every angle.
    pub reflectance: Rgb<F>,
    /// Exponent e in [0, 1e9]: larger is shinier.
    pub exponent: F,
}

impl<F: Lanes> Glossy<F> {
    /// A direction of the lobe, reflected through r where it fell below the surface.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F> {
        let r = mirrored(wo);
        let about = Frame::about(r);
        let s = warp::power_cosine(u2, self.exponent);
        let w = about.to_world(s);
        let turned = about.to_world(Vec3::new(-s.x, -s.y, s.z));
        let wi = Vec3::select(w.z.lt(0.0), turned, w);
        let pdf = self.pdf(wo, wi);
        BsdfSample { wi, weight: self.reflectance, pdf, valid: wo.z.gt(0.0) & wi.z.gt(0.0) & pdf.gt(0.0) }
    }

    /// Density of [`Self::sample`] with respect to solid angle: (e + 1) / (2 pi) cos^e, doubled where the direction
    /// half a turn away lies below the surface.
    #[inline(always)]
    pub fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        let zero = wo.z.splat(0.0);
        let r = mirrored(wo);
        let cos = r.dot(wi);
        // The cosine of a narrow lobe through the chord: 1 - cos would cancel.
        let half_chord2 = (r - wi).length2() * 0.5;
        // At a right angle the logarithm is infinite, and e = 0 must still give 1.
        let power = ((-half_chord2).max(-1.0).ln_1p().max(-104.0) * self.exponent).exp();
        let density = (self.exponent + 1.0) * power * (1.0 / TAU);
        let twin_below = (cos * 2.0 * wo.z - wi.z).lt(0.0);
        let density = F::select(twin_below, density * 2.0, density);
        F::select(wo.z.gt(0.0) & wi.z.gt(0.0) & cos.gt(0.0), density, zero)
    }

    /// reflectance pdf / cos theta_i, so that every sample weighs the same.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        self.reflectance * (self.pdf(wo, wi) / wi.z.max(1e-30))
    }
}
