//! Lights with a surface.
//!
//! A point of the surface is drawn uniformly, by area or, where the surface looks large, by solid angle. By area the density 1/A becomes
//! d^2 / (A cos) per solid angle, which differs over the light as it is near; by solid angle it is the same all over. Which of the two it
//! is depends on the reference point alone, so that both strategies of a path know the same density.

use crate::light::{Emitter, LightSample, Reference};
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};
use std::f32::consts::PI;

/// A point drawn from a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<F: Lanes> {
    /// Where.
    pub p: Vec3<F>,
    /// Unit normal.
    pub n: Vec3<F>,
    /// Density: with respect to solid angle as seen from the reference point where `by_angle` is set, elsewhere with respect to area, 1/m^2.
    pub pdf: F,
    /// Where the point was drawn by solid angle.
    pub by_angle: F::Mask,
    /// Radiance there, where it is not the same everywhere.
    pub radiance: Option<Rgb<F>>,
}

/// From where a surface is asked, and for which part of it.
#[derive(Clone, Copy, Debug)]
pub struct Asked<F: Lanes> {
    /// The reference point.
    pub from: Vec3<F>,
    /// Whether the back of the surface counts.
    pub two_sided: bool,
    /// The primitive that was chosen beforehand; all of the surface if none was.
    pub part: Option<F::Int>,
}

/// A density, and what it is with respect to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Area, 1/m^2.
    Area(f32),
    /// Solid angle as seen from the reference point, 1/sr.
    Angle(f32),
}

/// A surface that points are drawn from uniformly, by area or by solid angle.
pub trait SampleArea {
    /// A point of the surface.
    fn sample<F: Lanes>(&self, asked: Asked<F>, u2: [F; 2]) -> SurfacePoint<F>;

    /// Density of [`Self::sample`] on primitive `prim`.
    fn pdf(&self, asked: Asked<f32>, prim: u32) -> Density;

    /// Area, m^2.
    fn area(&self) -> f32;
}

/// Squared distance in squared radii of a surface up to which it looks large: see `benches/record/lights.md`.
pub(super) const NEAR: f32 = 36.0;

/// Below this solid angle, in sr, nothing depends on how points are drawn.
pub(super) const TINY: f32 = 1e-5;

/// The squared length, rounded alike at all widths.
#[inline(always)]
pub(super) fn length2_alike<F: Lanes>(v: Vec3<F>) -> F {
    v.x * v.x + v.y * v.y + v.z * v.z
}

/// A surface that shines.
#[derive(Clone, Debug)]
pub struct Area<S> {
    /// The surface.
    pub surface: S,
    /// Emitted radiance; its mean where the surface says that it is not the same everywhere.
    pub radiance: Rgb<f32>,
    /// Whether the back shines too.
    pub two_sided: bool,
}

impl<S: SampleArea> Area<S> {
    #[inline(always)]
    pub(super) fn sample<F: Lanes>(
        &self,
        at: Reference<F>,
        part: Option<F::Int>,
        u2: [F; 2],
    ) -> LightSample<F> {
        let like = at.p.x;
        let asked = Asked { from: at.p, two_sided: self.two_sided, part };
        let SurfacePoint { p, n, pdf, by_angle, radiance } = self.surface.sample(asked, u2);
        let way = p - at.p;
        let distance2 = way.length2();
        let wi = way * distance2.max(1e-30).rsqrt();
        let facing = -wi.dot(n);
        let cos = if self.two_sided { facing.abs() } else { facing };
        let pdf = F::select(by_angle, pdf, distance2 * pdf / cos.max(1e-30));
        let valid = cos.gt(0.0) & distance2.gt(0.0) & wi.dot(at.n).gt(0.0) & pdf.is_finite();
        let li = match radiance {
            Some(own) => own,
            None => Rgb::splat(like, self.radiance),
        };
        LightSample { wi, p, li, pdf, valid }
    }

    /// Of the primitive that was met, if it was chosen beforehand (`is_part`).
    pub(super) fn pdf(&self, at: Reference<f32>, wi: Vec3<f32>, emitter: &Emitter, is_part: bool) -> f32 {
        let facing = -wi.dot(emitter.ng.into());
        let cos = if self.two_sided { facing.abs() } else { facing };
        if cos <= 0.0 {
            return 0.0;
        }
        let part = if is_part { Some(emitter.prim) } else { None };
        let asked = Asked { from: at.p, two_sided: self.two_sided, part };
        match self.surface.pdf(asked, emitter.prim) {
            Density::Angle(pdf) => pdf,
            Density::Area(pdf) => (Vec3::from(emitter.p) - at.p).length2() * pdf / cos,
        }
    }

    /// Luminous intensity in the brightest direction, were all of it to face there.
    pub(super) fn intensity(&self) -> f32 {
        self.radiance.luminance() * self.surface.area()
    }

    pub(super) fn power(&self) -> f32 {
        let sides = if self.two_sided { 2.0 } else { 1.0 };
        self.radiance.luminance() * PI * self.surface.area() * sides
    }
}
