//! Schlick's surface, from matt to mirror by one number.
//!
//! Schlick 1994 (An Inexpensive BRDF Model for Physically-Based Rendering): a diffuse part, a glossy part and a mirror, shared
//! out by the roughness r so that r = 1 is matt and r = 0 a mirror, all of one colour that whitens towards grazing. His
//! slope distribution is GGX with alpha^2 = r; his masking is replaced by Smith's, since his own makes light near grazing (3 %
//! at r = 0.05). An isotropy p below 1 gives alpha^2 = r / p and r p along the tangents. What his parts do not return is
//! lost: the albedo dips to 0.45 at r = 1/2.

use crate::bsdf::conductor::half_vector;
use crate::bsdf::microfacet::{Distribution, Ggx, SMOOTHEST};
use crate::bsdf::mirror::reflection;
use crate::bsdf::{Branch, BsdfSample, Diffuse, Spread, fresnel};
use crate::math::lanes::{Compare, Lanes, MaskLanes};
use crate::math::{Rgb, Vec3};

/// A surface between matt and mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schlick<F> {
    /// Reflectance straight on, in [0, 1] per channel.
    color: Rgb<F>,
    /// Shares of the diffuse part, the glossy part and the mirror; they add up to 1.
    shares: [F; 3],
    facets: Distribution<F>,
}

impl Spread for Schlick<f32> {
    type Over<F: Lanes> = Schlick<F>;
    #[inline(always)]
    fn spread<F: Lanes>(&self, like: F) -> Schlick<F> {
        let shares = self.shares.map(|share| like.splat(share));
        Schlick { color: self.color.spread(like), shares, facets: self.facets.spread(like) }
    }
}

impl<F: Lanes> Schlick<F> {
    /// The surface of this `color`, `roughness` r in [0, 1] and `isotropy` p in (0, 1].
    #[inline(always)]
    pub fn new(color: Rgb<F>, roughness: F, isotropy: F) -> Self {
        let (zero, one) = (roughness.splat(0.0), roughness.splat(1.0));
        let r = roughness.clamp(0.0, 1.0);
        let glossy = r * (one - r) * 4.0;
        // 1 - 4 r (1 - r).
        let rest = (one - r * 2.0).square();
        let rough = r.ge(0.5);
        let shares = [F::select(rough, rest, zero), glossy, F::select(rough, zero, rest)];
        let alpha_x = (r / isotropy).sqrt().clamp(SMOOTHEST, 1.0);
        let alpha_y = (r * isotropy).sqrt().clamp(SMOOTHEST, 1.0);
        Self { color, shares, facets: Distribution::Ggx(Ggx { alpha_x, alpha_y }) }
    }

    /// Whether it is the same in all directions about the normal. One answer for all lanes.
    #[inline(always)]
    pub fn is_isotropic(&self) -> bool {
        let Distribution::Ggx(Ggx { alpha_x, alpha_y }) = self.facets else { return true };
        Compare::<F>::eq(alpha_x, alpha_y).all()
    }

    /// A direction of the glossy part.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F> {
        let h = self.facets.sample_visible(wo, u2);
        let cos = wo.dot(h);
        let wi = h * (cos * 2.0) - wo;
        let pdf = self.facets.mirrored_pdf(wo, h);
        let weight = self.tint(cos) * (self.shares[1] * self.facets.g2_over_g1(wo, wi));
        let valid = wo.z.gt(0.0) & wi.z.gt(0.0) & cos.gt(0.0) & pdf.gt(0.0) & pdf.is_finite();
        BsdfSample { wi, weight, pdf, valid }
    }

    /// Density of [`Self::sample`] with respect to solid angle.
    #[inline(always)]
    pub fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        let (h, _, lit) = half_vector(wo, wi);
        F::select(lit, self.facets.mirrored_pdf(wo, h), wo.z.splat(0.0))
    }

    /// The glossy part, 1/sr: its share times S D G2 / (4 cos theta_o cos theta_i).
    #[inline(always)]
    pub fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        let (h, cos, lit) = half_vector(wo, wi);
        let f = self.facets.reflected(h, wo, wi);
        self.tint(cos) * F::select(lit, f * self.shares[1], f.splat(0.0))
    }

    /// The diffuse part, 1/sr: its share times S / pi.
    #[inline(always)]
    pub fn diffuse(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        let (_, cos, _) = half_vector(wo, wi);
        Diffuse { reflectance: self.tint(cos) * self.shares[0] }.eval(wo, wi)
    }

    /// About what the glossy part returns.
    #[inline(always)]
    pub(super) fn glossy_share(&self, wo: Vec3<F>) -> F {
        self.tint(wo.z).max_channel() * self.shares[1]
    }

    /// The mirror, with its share.
    #[inline(always)]
    pub fn branch(&self, wo: Vec3<F>) -> Branch<F> {
        let mut branch = reflection(wo, self.tint(wo.z) * self.shares[2]);
        branch.valid = branch.valid & self.shares[2].gt(0.0);
        branch
    }

    /// The colour, whiter towards grazing.
    #[inline(always)]
    fn tint(&self, cos: F) -> Rgb<F> {
        fresnel::schlick_rgb(cos, self.color)
    }
}
