//! Frosted glass: microfacets that reflect and refract.
//!
//! Walter, Marschner, Li and Torrance 2007 (Microfacet Models for Refraction through Rough Surfaces), with visible normals.
//! Light that bounces among facets more than once is lost. Reflection masks with correlated heights, transmission with
//! independent ones, as in that paper: what sees out from one side of a surface is not what is seen from the other.
//!
//! Reflection and transmission are two lobes, each with a density of its own, because a ray tree follows both.

use crate::bsdf::conductor::half_vector;
use crate::bsdf::microfacet::Distribution;
use crate::bsdf::{BsdfSample, Glass};
use crate::math::lanes::{Lanes, Select};
use crate::math::{Rgb, Vec3};

/// A rough interface between two transparent media.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric<F> {
    /// How much each facet reflects; its `eta` is the far side's index over the near side's, as seen by wo.
    pub glass: Glass<F>,
    /// How their normals are spread.
    pub facets: Distribution<F>,
}

impl<F: Lanes> RoughDielectric<F> {
    /// A direction mirrored at a visible normal, and one refracted at the same normal. The first is not valid below the
    /// surface, the second not above and not under total internal reflection. Between equal media the second goes straight on.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> [BsdfSample<F>; 2] {
        let h = self.facets.sample_visible(wo, u2);
        let c = wo.dot(h);
        let at = self.glass.at(c);
        let facing = wo.z.gt(0.0) & c.gt(0.0);
        let wi = h * (c * 2.0) - wo;
        let pdf = self.facets.mirrored_pdf(wo, h);
        let weight = Rgb::gray(at.reflectance * self.facets.g2_over_g1(wo, wi));
        let valid = facing & wi.z.gt(0.0) & pdf.gt(0.0) & pdf.is_finite() & at.reflectance.gt(0.0);
        let mirrored = BsdfSample { wi, weight, pdf, valid };
        let eta = self.glass.eta();
        let inverse = eta.recip();
        let wi = (h * (c * inverse - at.cos_t) - wo * inverse).normalize();
        // c - eta cos_t, which cancels for near-matched media, as a quotient: eta^2 cos_t^2 = eta^2 - 1 + c^2.
        let denominator = (eta - 1.0) * (eta + 1.0) / (c + eta * at.cos_t);
        let stretch = eta.square() * at.cos_t / denominator.square().max(NARROWEST);
        // Between equal media there is nothing to be spread or masked by: all light goes straight on.
        let matched = eta.eq(1.0);
        let pdf = F::select(matched, eta.splat(1.0 / NARROWEST), pdf * 4.0 * c * stretch);
        let seen = F::select(matched, eta.splat(1.0), self.facets.g1(wi));
        let weight = Rgb::gray((-at.reflectance + 1.0) * seen * inverse.square());
        let valid = facing & wi.z.lt(0.0) & !at.total & pdf.gt(0.0) & pdf.is_finite();
        [mirrored, BsdfSample { wi, weight, pdf, valid }]
    }

    /// Density of the lobe that `wi` belongs to, reflection above and transmission below, with respect to solid angle.
    ///
    /// Below: D G1(wo) (wo.h) / wo.z times eta^2 |wi.h| / (wo.h + eta wi.h)^2 (Walter et al. 2007, eq. 17).
    #[inline(always)]
    pub fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        let (h, _, lit) = half_vector(wo, wi);
        let above = self.facets.mirrored_pdf(wo, h);
        let Through { h, cos_o, cos_i, denominator2, lit: crossed } = self.through(wo, wi);
        let stretch = self.glass.eta().square() * cos_i / denominator2;
        let below = self.facets.mirrored_pdf(wo, h) * 4.0 * cos_o * stretch;
        let zero = wo.z.splat(0.0);
        F::select(lit, above, F::select(crossed, below, zero))
    }

    /// F D G2 / (4 cos theta_o cos theta_i) above; below
    /// (1 - F) D G1(wo) G1(wi) (wo.h) |wi.h| / (wo.z |wi.z| (wo.h + eta wi.h)^2) (Walter et al. 2007, eqs. 20 and 21), in
    /// which radiance grows with the square of the index.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        let (h, cos, lit) = half_vector(wo, wi);
        let above = self.glass.at(cos).reflectance * self.facets.reflected(h, wo, wi);
        let Through { h, cos_o, cos_i, denominator2, lit: crossed } = self.through(wo, wi);
        let facets = self.facets.d(h) * self.facets.g1_over_cos(wo) * self.facets.g1_over_cos(wi);
        let geometry = cos_o * cos_i / denominator2;
        let below = (-self.glass.at(cos_o).reflectance + 1.0) * facets * geometry;
        Rgb::gray(F::select(lit, above, F::select(crossed, below, wo.z.splat(0.0))))
    }

    /// The facet that refracts `wi` to `wo`.
    #[inline(always)]
    fn through(&self, wo: Vec3<F>, wi: Vec3<F>) -> Through<F> {
        let eta = self.glass.eta();
        // wo + eta wi, arranged so that near-matched media keep what their directions know.
        let sum = wo + wi + wi * (eta - 1.0);
        let length2 = sum.length2();
        let h = sum * length2.max(NARROWEST).rsqrt();
        let h = Vec3::select(h.z.lt(0.0), -h, h);
        let (cos_o, cos_i) = (wo.dot(h), -wi.dot(h));
        let lit = wo.z.gt(0.0) & wi.z.lt(0.0) & cos_o.gt(0.0) & cos_i.gt(0.0) & length2.gt(NARROWEST);
        Through { h, cos_o, cos_i, denominator2: length2.max(NARROWEST), lit }
    }
}

/// Where the square of wo.h + eta wi.h is less, media are so nearly matched that refraction turns light by less than its direction
/// is rounded by: what goes through is then one direction, of a great density, that no other light meets.
const NARROWEST: f32 = 1e-14;

/// A facet that light goes through.
struct Through<F: Lanes> {
    h: Vec3<F>,
    cos_o: F,
    /// With the other side of the facet.
    cos_i: F,
    /// (wo.h + eta wi.h)^2.
    denominator2: F,
    /// Where there is such a facet.
    lit: F::Mask,
}
