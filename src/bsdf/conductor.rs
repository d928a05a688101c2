//! Metals, polished and rough.

use crate::bsdf::microfacet::Distribution;
use crate::bsdf::mirror::reflection;
use crate::bsdf::{Branch, BsdfSample, Metal};
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// A polished metal.
#[derive(Clone, Copy, Debug)]
pub struct Conductor<F> {
    /// How much it reflects.
    pub metal: Metal<F>,
}

impl<F: Lanes> Conductor<F> {
    /// The mirror direction, by Fresnel.
    #[inline(always)]
    pub fn branch(&self, wo: Vec3<F>) -> Branch<F> {
        reflection(wo, self.metal.at(wo.z))
    }
}

/// A rough metal: microfacets; light that bounces among them more than once is lost.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor<F> {
    /// How much each facet reflects.
    pub metal: Metal<F>,
    /// How their normals are spread.
    pub facets: Distribution<F>,
}

impl<F: Lanes> RoughConductor<F> {
    /// A direction mirrored at a visible normal; below-surface ones are not valid: their light is lost.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F> {
        let h = self.facets.sample_visible(wo, u2);
        let cos = wo.dot(h);
        let wi = h * (cos * 2.0) - wo;
        let valid = wo.z.gt(0.0) & wi.z.gt(0.0) & cos.gt(0.0);
        let pdf = self.facets.mirrored_pdf(wo, h);
        let weight = self.metal.at(cos) * self.facets.g2_over_g1(wo, wi);
        BsdfSample { wi, weight, pdf, valid: valid & pdf.gt(0.0) & pdf.is_finite() }
    }

    /// Density of [`Self::sample`] with respect to solid angle: D G1(wo) / (4 cos theta_o) (Heitz 2018, Sampling the GGX
    /// Distribution of Visible Normals, eq. 17).
    #[inline(always)]
    pub fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        let (h, _, lit) = half_vector(wo, wi);
        let pdf = self.facets.mirrored_pdf(wo, h);
        F::select(lit, pdf, pdf.splat(0.0))
    }

    /// F D G2 / (4 cos theta_o cos theta_i).
    #[inline(always)]
    pub fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        let (h, cos, lit) = half_vector(wo, wi);
        let f = self.facets.reflected(h, wo, wi);
        self.metal.at(cos) * F::select(lit, f, f.splat(0.0))
    }
}

/// The normal that mirrors `wo` into `wi`, its cosine with either, and where both lie above the surface and the normal exists.
///
/// The cosine is half the length of the sum of both: as their product with the normal it would lose twice as many digits where
/// they nearly oppose each other.
#[inline(always)]
pub(crate) fn half_vector<F: Lanes>(wo: Vec3<F>, wi: Vec3<F>) -> (Vec3<F>, F, F::Mask) {
    let sum = wo + wi;
    let length2 = sum.length2();
    // Below 1e-6 of length both directions graze and their half vector is rounding noise.
    let exists = length2.gt(1e-12) & wo.z.gt(0.0) & wi.z.gt(0.0);
    let inverse = length2.max(1e-12).rsqrt();
    (sum * inverse, (length2 * inverse * 0.5).min(1.0), exists)
}
