//! How wide rays are, for pictures on surfaces: cones about them.
//!
//! Akenine-Moeller, Crassin, Boksansky, Belcour, Panteleev and Wright 2021 (Improved Shader and Texture Level of Detail Using Ray
//! Cones): a cone has a width where it starts and spreads by an angle; where it meets a surface it is as wide as both make it, over
//! the cosine with the normal. Curvature is left out: mirrors are taken to be flat.
//!
//! A cone is that of one sample, not of a pixel: samples cover the pixel together, so each is narrower by the root of
//! their number, as is what a lobe spreads, whose width is that of the solid angle 1/pdf. Eight times narrower is enough, as with
//! differentials (Pharr, Jakob and Humphreys 2023, Physically Based Rendering, 10.1).

use crate::geometry::Interaction;
use crate::math::lanes::Lanes;
use crate::scene::Scene;
use crate::texture::Spot;
use std::f32::consts::PI;

/// Narrower than this part of a pixel samples need not be.
const NARROWEST: f32 = 0.125;

/// Cosines below count as this one: a ray along a surface would see nothing but its mean.
const LEAST_COSINE: f32 = 0.02;

/// Cones that have met diffuse surfaces may be this wide, in radians.
const WIDEST: f32 = 1.0;

/// What all cones of a picture have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    /// The angle by which rays from the camera spread.
    spread: f32,
    /// The part of a pixel or of a lobe that one sample stands for, in width.
    part: f32,
}

/// The cone about a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone<F> {
    /// Its width where it starts.
    pub(super) width: F,
    /// By how much it grows with each metre.
    pub(super) spread: F,
}

impl Beam {
    /// That of the camera, for so many samples of a pixel; `None` where no surface shows a picture.
    pub(super) fn of(scene: &Scene, spp: u32) -> Option<Self> {
        if !scene.has_images() {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "few samples count")]
        let part = (spp as f32).sqrt().recip().max(NARROWEST);
        let spread = scene.camera.pixel_angle([scene.film.width, scene.film.height]) * part;
        Some(Self { spread, part })
    }

    /// A ray from the camera.
    pub(super) fn start<F: Lanes>(self, like: F) -> Cone<F> {
        Cone { width: like.splat(0.0), spread: like.splat(self.spread) }
    }

    /// What goes on from the end of a cone, in a direction drawn with this density per solid angle; not positive where
    /// there was no other.
    #[inline(always)]
    pub(super) fn scattered<F: Lanes>(self, cone: Cone<F>, length: F, pdf: F) -> Cone<F> {
        let lobe = (pdf.max(1e-12) * PI).rsqrt() * self.part;
        let spread = F::select(pdf.gt(0.0), (cone.spread + lobe).min(WIDEST), cone.spread);
        Cone { width: cone.width_at(length), spread }
    }
}

impl Cone<f32> {
    /// About a ray of which nobody asks how wide it is.
    pub(super) const NONE: Self = Self { width: 0.0, spread: 0.0 };

    /// What surfaces are asked at the end of the cone.
    pub(super) fn spot(self, scene: &Scene, it: &Interaction, length: f32) -> Spot<f32> {
        let density = scene.world.grain(it).map_or(0.0, |grain| grain.density());
        Spot { uv: it.uv.into(), footprint: self.footprint(length, it.wo.dot(it.ng), density) }
    }
}

impl<F: Lanes> Cone<F> {
    /// Its width after some metres.
    #[inline(always)]
    pub(super) fn width_at(self, length: F) -> F {
        self.width + self.spread * length
    }

    /// Its width on a surface after some metres, in surface parameters of which there are `density` to a metre.
    #[inline(always)]
    pub(super) fn footprint(self, length: F, cos: F, density: F) -> F {
        self.width_at(length) * density / cos.abs().max(LEAST_COSINE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cones_grow_with_the_way_and_with_lobes() {
        let beam = Beam { spread: 1e-3, part: 0.5 };
        let cone = beam.start(0.0_f32);
        assert!((cone.footprint(10.0, -0.5, 3.0) - 0.06).abs() < 1e-6, "10 m, 60 degrees: 20 mm");
        let mirrored = beam.scattered(cone, 10.0, 0.0);
        assert!((mirrored.width_at(10.0) - 0.02).abs() < 1e-6, "mirrors spread nothing");
        let matt = beam.scattered(cone, 10.0, 1.0 / PI);
        assert!((matt.spread - 0.501).abs() < 1e-5, "half a radian: {matt:?}");
    }
}
