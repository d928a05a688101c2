//! Distributions of the normals of microfacets.
//!
//! Alpha from 1e-4 to 1: what is smoother is a mirror, since the lobe is then narrower than the rounding of a unit vector.

mod beckmann;
mod ggx;

pub use beckmann::Beckmann;
pub use ggx::Ggx;

use crate::math::Vec3;
use crate::math::lanes::Lanes;

/// Below this roughness a surface is treated as polished.
pub const SMOOTHEST: f32 = 1e-4;

/// How normals are spread; one choice for all lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution<F> {
    /// Long tails: most real surfaces.
    Ggx(Ggx<F>),
    /// Gaussian slopes: no tails.
    Beckmann(Beckmann<F>),
}

impl<F: Lanes> Distribution<F> {
    /// Area of normals about `h` per solid angle and area of the mean surface, 1/sr.
    #[inline(always)]
    pub fn d(&self, h: Vec3<F>) -> F {
        match self {
            Self::Ggx(own) => own.d(h),
            Self::Beckmann(own) => own.d(h),
        }
    }

    /// The tangent of the angle by which normals typically lean, as a mean over both tangents.
    #[inline(always)]
    pub fn lean(&self) -> F {
        let (x, y) = match self {
            Self::Ggx(own) => (own.alpha_x, own.alpha_y),
            Self::Beckmann(own) => (own.alpha_x, own.alpha_y),
        };
        (x + y) * 0.5
    }

    /// |cos| (1 + 2 Lambda) of `w` with Smith's auxiliary function Lambda, which grows without bound towards the horizon where
    /// this does not. The same on both sides of the surface.
    #[inline(always)]
    fn stretched(&self, w: Vec3<F>) -> F {
        match self {
            Self::Ggx(own) => own.stretched(w),
            Self::Beckmann(own) => own.stretched(w),
        }
    }

    /// Fraction of the microfacets facing `w` that `w` sees, in [0, 1]: 1 / (1 + Lambda).
    #[inline(always)]
    pub fn g1(&self, w: Vec3<F>) -> F {
        w.z.abs() * self.g1_over_cos(w)
    }

    /// [`Self::g1`] over the cosine of `w`, which stays finite at the horizon.
    #[inline(always)]
    pub fn g1_over_cos(&self, w: Vec3<F>) -> F {
        (self.stretched(w) + w.z.abs()).max(1e-30).recip() * 2.0
    }

    /// Fraction that both see from the same side, heights correlated, in [0, 1]: 1 / (1 + Lambda(wo) + Lambda(wi)) (Heitz 2014,
    /// eq. 99).
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
    #[inline(always)]
    pub fn sample_visible(&self, wo: Vec3<F>, u2: [F; 2]) -> Vec3<F> {
        match self {
            Self::Ggx(own) => own.sample_visible(wo, u2),
            Self::Beckmann(own) => own.sample_visible(wo, u2),
        }
    }

    /// Density of [`Self::sample_visible`] with respect to solid angle of normals over 4 (wo.h): that of the mirrored direction
    /// (Heitz 2018, Sampling the GGX Distribution of Visible Normals, eq. 17).
    #[inline(always)]
    pub fn mirrored_pdf(&self, wo: Vec3<F>, h: Vec3<F>) -> F {
        self.d(h) * self.g1_over_cos(wo) * 0.25
    }
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
    fn of(facets: &Distribution<F>, wo: Vec3<F>, wi: Vec3<F>) -> Self {
        let (stretched_o, stretched_i) = (facets.stretched(wo), facets.stretched(wi));
        let larger = wo.z.max(wi.z).max(LEAST);
        let (part_o, part_i) = (wo.z / larger, wi.z / larger);
        let sum = stretched_o.mul_add(part_i, stretched_i * part_o).max(1e-30);
        Self { larger, part_i, stretched_o, sum }
    }
}

/// The least positive number.
const LEAST: f32 = f32::from_bits(1);

impl<F> From<Ggx<F>> for Distribution<F> {
    fn from(own: Ggx<F>) -> Self {
        Self::Ggx(own)
    }
}

impl<F> From<Beckmann<F>> for Distribution<F> {
    fn from(own: Beckmann<F>) -> Self {
        Self::Beckmann(own)
    }
}
