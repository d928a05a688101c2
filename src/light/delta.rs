//! Lights that a ray cannot meet by chance: points and parallel light.

use crate::light::{LightSample, Reference};
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};
use std::f32::consts::{PI, TAU};

/// A point that shines alike in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where.
    pub position: Vec3<f32>,
    /// Power per solid angle, W/sr.
    pub intensity: Rgb<f32>,
}

impl Point {
    #[inline(always)]
    pub(super) fn sample<F: Lanes>(&self, at: Reference<F>) -> LightSample<F> {
        from_point(self.position, self.intensity, at)
    }

    pub(super) fn power(&self) -> f32 {
        self.intensity.luminance() * 2.0 * TAU
    }
}

/// A point that shines into a cone, fading towards its rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Where.
    pub position: Vec3<f32>,
    /// Unit direction of the axis.
    pub axis: Vec3<f32>,
    /// Power per solid angle within the inner cone, W/sr.
    pub intensity: Rgb<f32>,
    /// One less the cosine of the half angle beyond which there is no light: cosines of narrow cones are 1.
    pub versine_outer: f32,
    /// One less the cosine of the half angle up to which there is full light.
    pub versine_inner: f32,
}

impl Spot {
    #[inline(always)]
    pub(super) fn sample<F: Lanes>(&self, at: Reference<F>) -> LightSample<F> {
        let mut sample = from_point(self.position, self.intensity, at);
        // The square of the chord between unit vectors is twice that.
        let versine = (sample.wi + Vec3::splat(at.p.x, self.axis)).length2() * 0.5;
        let width = (self.versine_outer - self.versine_inner).max(self.versine_outer * 1e-6);
        let t = ((-versine + self.versine_outer) / width).clamp(0.0, 1.0);
        let fade = t * t * (-t * 2.0 + 3.0);
        sample.li *= fade;
        sample.valid = sample.valid & fade.gt(0.0);
        sample
    }

    /// The smooth fade from the inner to the outer cosine passes on half of what lies between.
    pub(super) fn power(&self) -> f32 {
        self.intensity.luminance() * PI * (self.versine_inner + self.versine_outer)
    }
}

/// Parallel light from infinitely far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// Unit direction in which the light travels.
    pub direction: Vec3<f32>,
    /// Power per area facing it, W/m^2.
    pub irradiance: Rgb<f32>,
}

impl Directional {
    #[inline(always)]
    pub(super) fn sample<F: Lanes>(&self, at: Reference<F>) -> LightSample<F> {
        let like = at.p.x;
        let wi = Vec3::splat(like, -self.direction);
        let li = Rgb::splat(like, self.irradiance);
        LightSample { wi, p: at.p, li, pdf: like.splat(1.0), valid: wi.dot(at.n).gt(0.0) }
    }
}

#[inline(always)]
fn from_point<F: Lanes>(position: Vec3<f32>, intensity: Rgb<f32>, at: Reference<F>) -> LightSample<F> {
    let like = at.p.x;
    let p = Vec3::splat(like, position);
    let way = p - at.p;
    let distance2 = way.length2();
    let wi = way * distance2.max(1e-30).rsqrt();
    let li = Rgb::splat(like, intensity) / distance2.max(1e-30);
    LightSample { wi, p, li, pdf: like.splat(1.0), valid: distance2.gt(0.0) & wi.dot(at.n).gt(0.0) }
}

/// Between what a spot fades, as [`Spot::versine_outer`] and [`Spot::versine_inner`]: half angle of the whole cone in radians, and the fraction of it that
/// fades.
#[must_use]
pub fn spot_versines(angle: f32, softness: f32) -> [f32; 2] {
    let angle = angle.clamp(0.0, PI);
    [angle, angle * (1.0 - softness.clamp(0.0, 1.0))].map(|angle| 2.0 * (0.5 * angle).sin().powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn below() -> Reference<f32> {
        Reference { p: Vec3::new(0.0, 0.0, 0.0), n: Vec3::new(0.0, 1.0, 0.0) }
    }

    #[test]
    fn a_point_falls_off_with_the_square_of_distance() {
        let light = Point { position: Vec3::new(0.0, 3.0, 0.0), intensity: Rgb::gray(18.0) };
        let sample = light.sample(below());
        assert!((sample.li.r - 2.0).abs() < 1e-5, "{sample:?}");
        assert!(sample.valid, "in front");
    }

    #[test]
    fn a_spot_is_full_inside_and_dark_outside() {
        let [versine_outer, versine_inner] = spot_versines(0.5, 0.2);
        let at = |x: f32| {
            let axis = Vec3::new(0.0, -1.0, 0.0);
            let position = Vec3::new(x, 1.0, 0.0);
            let light = Spot { position, axis, intensity: Rgb::WHITE, versine_outer, versine_inner };
            let sample = light.sample(below());
            if sample.valid { sample.li.r * (1.0 + x * x) } else { 0.0 }
        };
        assert!((at(0.3_f32.tan()) - 1.0).abs() < 1e-5, "inner cone");
        assert!(at(0.45_f32.tan()) > 0.1 && at(0.45_f32.tan()) < 0.9, "fading");
        assert!(at(0.51_f32.tan()) == 0.0, "outside");
    }

    /// The cosines of this cone are 1 in single precision.
    #[test]
    fn a_beam_narrower_than_cosines_tell_shines() {
        let angle = 1e-4_f32;
        let [versine_outer, versine_inner] = spot_versines(angle, 0.5);
        let axis = Vec3::new(0.0, -1.0, 0.0);
        let at = |x: f32| {
            let position = Vec3::new(x, 1000.0, 0.0);
            let light = Spot { position, axis, intensity: Rgb::gray(1e6), versine_outer, versine_inner };
            let sample = light.sample(below());
            (if sample.valid { sample.li.r } else { 0.0 }, light.power())
        };
        let power = 1e6 * PI * angle * angle * 0.5 * (1.0 + 0.25);
        assert!((at(0.0).1 / power - 1.0).abs() < 1e-4, "{} W, not {power}", at(0.0).1);
        let lit = [0.0, 0.045, 0.075, 0.102].map(|x| at(x).0);
        assert!((lit[0] - 1.0).abs() < 1e-4 && (lit[1] - 1.0).abs() < 1e-3, "{lit:?}");
        assert!(lit[2] > 0.1 && lit[2] < 0.9 && lit[3] == 0.0, "{lit:?}");
    }
}
