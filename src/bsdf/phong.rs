//! Phong's lobe as a reciprocal BRDF.
//!
//! Beside the fuzzy mirror of [`crate::bsdf::Glossy`], whose samples all weigh the same: these obey reciprocity and pay for
//! it. Directions below the surface are lost.

use crate::bsdf::BsdfSample;
use crate::bsdf::glossy::{below_horizon, raw_lobe, raw_pdf};
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// What the cosine to the power of e is multiplied by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhongScale {
    /// (e + 2) / (2 pi) (Lafortune and Willems 1994, Using the Modified Phong Reflectance Model for Physically Based
    /// Rendering). Darkens with the angle: for e to infinity the albedo is the cosine, not 1.
    Modified,
    /// (e + 2) / (2 pi) over the greater of both cosines (Neumann, Neumann and Szirmay-Kalos 1999, Compact Metallic
    /// Reflectance Models): a mirror for e to infinity. Below e = 1 that would reflect up to 1.085 (e = 0 at 48 degrees,
    /// measured); there it is divided by 1.091 - 0.09 e.
    MaxCosine,
}

/// A reciprocal Phong lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong<F> {
    /// Greatest fraction of the power reflected, in [0, 1].
    pub reflectance: Rgb<F>,
    /// Exponent e in [0, 1e9]: larger is shinier.
    pub exponent: F,
    /// The factor.
    pub scale: PhongScale,
}

impl<F: Lanes> Phong<F> {
    /// A direction of the lobe; those below the surface are not valid.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F> {
        let wi = raw_lobe(wo, u2, self.exponent);
        let pdf = self.pdf(wo, wi);
        let weight = self.reflectance * (self.weight_over_cos(wo, wi) * wi.z.max(0.0));
        BsdfSample { wi, weight, pdf, valid: pdf.gt(0.0) }
    }

    /// (e + 1) / (2 pi) cos^e above the surface: density of [`Self::sample`] with respect to solid angle.
    #[inline(always)]
    pub fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        let pdf = raw_pdf(wo, wi, self.exponent);
        F::select(below_horizon(wo, wi), pdf.splat(0.0), pdf)
    }

    /// The scaled power of the cosine, 1/sr.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        self.reflectance * (self.pdf(wo, wi) * self.weight_over_cos(wo, wi))
    }

    /// Value over density, for a reflectance of 1.
    #[inline(always)]
    fn weight_over_cos(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        // (e + 2) / (e + 1).
        let scale = (self.exponent + 1.0).recip() + 1.0;
        match self.scale {
            PhongScale::Modified => scale,
            PhongScale::MaxCosine => {
                let excess = (self.exponent * -0.09 + 1.091).max(1.0);
                scale / excess / wi.z.max(wo.z).max(1e-30)
            }
        }
    }
}
