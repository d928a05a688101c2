//! Spherical lights, sampled by solid angle.

use crate::light::{LightSample, Reference};
use crate::math::lanes::Lanes;
use crate::math::{Frame, Rgb, Vec3};
use crate::sampling::warp;
use std::f32::consts::PI;

/// One minus the cosine of the half angle of a cone of all directions.
const ALL: f32 = 2.0;

/// A sphere that shines outwards, or on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereLight {
    /// Centre.
    pub center: Vec3<f32>,
    /// Radius, m.
    pub radius: f32,
    /// Emitted radiance.
    pub radiance: Rgb<f32>,
    /// Whether it shines inwards, too.
    pub two_sided: bool,
}

impl SphereLight {
    /// A direction drawn uniformly from the cone that the sphere fills; from within, of all directions, or none where it is dark there.
    #[inline(always)]
    pub(super) fn sample<F: Lanes>(&self, at: Reference<F>, u2: [F; 2]) -> LightSample<F> {
        let like = at.p.x;
        let (way, distance2, one_minus_cos) = self.cone(at.p);
        let outside = distance2.gt(self.radius * self.radius);
        let up = Vec3::new(like.splat(0.0), like.splat(0.0), like.splat(1.0));
        let axis = way.normalize_or(up);
        let one_minus_cos = F::select(outside, one_minus_cos, like.splat(ALL));
        let wi = Frame::about(axis).to_world(warp::cone(u2, one_minus_cos));
        // The near crossing, and from within the only one, through the distance of the ray from the centre rather than differences of squares.
        let mid = way.dot(wi);
        let off2 = (way - wi * mid).length2();
        let half_chord = (-off2 + self.radius * self.radius).max(0.0).sqrt();
        let p = at.p + wi * (mid - F::select(outside, half_chord, -half_chord));
        let pdf = warp::cone_pdf(one_minus_cos);
        let shines = if self.two_sided { outside | !outside } else { outside };
        let valid = shines & wi.dot(at.n).gt(0.0) & pdf.is_finite();
        LightSample { wi, p, li: Rgb::splat(like, self.radiance), pdf, valid }
    }

    /// The density of every direction that meets the sphere on a side that shines.
    pub(super) fn pdf(&self, at: Reference<f32>) -> f32 {
        let (_, distance2, one_minus_cos) = self.cone(at.p);
        if distance2 > self.radius * self.radius {
            return warp::cone_pdf(one_minus_cos);
        }
        if self.two_sided { warp::cone_pdf(ALL) } else { 0.0 }
    }

    /// The way to the centre, its squared length, and one minus the cosine of the half angle that the sphere fills.
    #[inline(always)]
    fn cone<F: Lanes>(&self, p: Vec3<F>) -> (Vec3<F>, F, F) {
        let way = Vec3::splat(p.x, self.center) - p;
        let distance2 = way.length2();
        let sin2 = (p.x.splat(self.radius * self.radius) / distance2.max(1e-30)).min(1.0);
        (way, distance2, warp::one_minus_cos_of_sin2(sin2))
    }

    pub(super) fn power(&self) -> f32 {
        let sides = if self.two_sided { 2.0 } else { 1.0 };
        self.radiance.luminance() * PI * 4.0 * PI * self.radius * self.radius * sides
    }
}
