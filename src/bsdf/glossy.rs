//! The Phong lobe about the mirror direction.
//!
//! Directions are drawn from cos^e about the mirror direction r; those below the surface are turned by half a turn
//! about r, which always brings them above it (E. Shaffer, Glossy Reflection, after Suffern 2007, Ray Tracing from the
//! Ground Up, chapter 25). Every sample has the same weight, so a glossy sphere in a uniform surround is uniform, and
//! for e to infinity the lobe is a mirror; the price is that the lobe is not reciprocal.
//!
//! The half turn bends the shape of the lobe, not its total: where a part P of the lobe lies below, P (1 - 2 P) / (1 - P) of the
//! power, at most 0.172, lies elsewhere than in the lobe cut off at the surface and brought back to 1, all of it on the
//! far side of one plane, where the density is doubled (`tests/glossy_bias.rs` has the table). A small bright light that
//! crosses the plane shows as a faint line. Both that lobe and the one merely cut off are there for comparison.

use crate::bsdf::BsdfSample;
use crate::bsdf::mirror::mirrored;
use crate::bsdf::truncation::fraction_below;
use crate::math::lanes::{IntLanes, Lanes, MaskLanes, Select};
use crate::math::{Frame, Rgb, Vec3};
use crate::sampling::{pcg, warp};
use std::f32::consts::TAU;

/// What becomes of directions below the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Below {
    /// They are turned by half a turn about the mirror direction.
    #[default]
    ThroughR,
    /// They count as black, which darkens the rim: up to half of the light is lost there.
    Discard,
    /// Others are drawn until one lies above: the lobe cut off at the surface and brought back to 1. Two evaluations of an
    /// integral per density.
    Rejection,
}

/// Draws after which a direction that is still below is turned: at least half lie above, so one in 10^7 is.
const MOST_DRAWS: u32 = 24;

/// A fuzzy mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glossy<F> {
    /// Fraction of the power reflected, in [0, 1], the same at every angle.
    pub reflectance: Rgb<F>,
    /// Exponent e in [0, 1e9]: larger is shinier.
    pub exponent: F,
    /// What becomes of directions below the surface.
    pub below: Below,
}

impl<F: Lanes> Glossy<F> {
    /// A lobe whose directions below the surface are turned about the mirror direction.
    #[inline(always)]
    pub fn new(reflectance: Rgb<F>, exponent: F) -> Self {
        Self { reflectance, exponent, below: Below::ThroughR }
    }

    /// A direction of the lobe.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F> {
        let r = mirrored(wo);
        let about = Frame::about(r);
        let s = warp::power_cosine(u2, self.exponent);
        let w = about.to_world(s);
        let wi = match self.below {
            Below::ThroughR => above_by_turning(about, s, w),
            Below::Discard => w,
            Below::Rejection => self.redrawn(about, s, w, u2),
        };
        let pdf = self.pdf(wo, wi);
        BsdfSample { wi, weight: self.reflectance, pdf, valid: wo.z.gt(0.0) & wi.z.gt(0.0) & pdf.gt(0.0) }
    }

    /// Density of [`Self::sample`] with respect to solid angle: (e + 1) / (2 pi) cos^e, doubled where the direction
    /// half a turn away lies below the surface and is turned.
    #[inline(always)]
    pub fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        let density = raw_pdf(wo, wi, self.exponent);
        let density = match self.below {
            Below::ThroughR => {
                let twin_below = (mirrored(wo).dot(wi) * 2.0 * wo.z - wi.z).lt(0.0);
                F::select(twin_below, density * 2.0, density)
            }
            Below::Discard => density,
            Below::Rejection => density / (-fraction_below(wo.z, self.exponent) + 1.0),
        };
        F::select(below_horizon(wo, wi), density.splat(0.0), density)
    }

    /// reflectance pdf / cos theta_i, so that every sample weighs the same.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        self.reflectance * (self.pdf(wo, wi) / wi.z.max(1e-30))
    }

    /// The first of a series of directions that lies above. The later ones come from hashes of the numbers.
    #[inline(always)]
    fn redrawn(&self, about: Frame<F>, s: Vec3<F>, w: Vec3<F>, [u, v]: [F; 2]) -> Vec3<F> {
        let (mut s, mut w) = (s, w);
        let mut bits = [u.to_bits(), v.to_bits()];
        for _ in 0..MOST_DRAWS {
            let below = w.z.le(0.0);
            if below.none() {
                break;
            }
            bits = pcg::pcg2d(bits);
            let next = warp::power_cosine([bits[0].to_unit(), bits[1].to_unit()], self.exponent);
            s = Vec3::select(below, next, s);
            w = Vec3::select(below, about.to_world(next), w);
        }
        above_by_turning(about, s, w)
    }
}

/// `w`, which is `s` in the frame, or the direction half a turn about the frame's z away where `w` lies below.
#[inline(always)]
fn above_by_turning<F: Lanes>(about: Frame<F>, s: Vec3<F>, w: Vec3<F>) -> Vec3<F> {
    let turned = about.to_world(Vec3::new(-s.x, -s.y, s.z));
    Vec3::select(w.z.lt(0.0), turned, w)
}

/// A direction of density [`raw_pdf`], above the surface or not.
#[inline(always)]
pub(crate) fn raw_lobe<F: Lanes>(wo: Vec3<F>, u2: [F; 2], exponent: F) -> Vec3<F> {
    Frame::about(mirrored(wo)).to_world(warp::power_cosine(u2, exponent))
}

/// (e + 1) / (2 pi) cos^e about the mirror direction, on both sides of the surface; meant where [`below_horizon`] is not.
#[inline(always)]
pub(crate) fn raw_pdf<F: Lanes>(wo: Vec3<F>, wi: Vec3<F>, exponent: F) -> F {
    // The cosine of a narrow lobe through the chord: 1 - cos would cancel.
    let half_chord2 = (mirrored(wo) - wi).length2() * 0.5;
    // At a right angle the logarithm is infinite, and e = 0 must still give 1.
    let power = ((-half_chord2).max(-1.0).ln_1p().max(-104.0) * exponent).exp();
    (exponent + 1.0) * power * (1.0 / TAU)
}

/// Where either direction lies below the surface, or `wi` beyond a right angle from the mirror direction.
#[inline(always)]
pub(crate) fn below_horizon<F: Lanes>(wo: Vec3<F>, wi: Vec3<F>) -> F::Mask {
    wo.z.le(0.0) | wi.z.le(0.0) | mirrored(wo).dot(wi).le(0.0)
}
