//! Flat round discs.

use crate::geometry::SurfacePoint;
use crate::geometry::surface::ROUND_ROUNDINGS;
use crate::math::Aabb;
use crate::math::float::UNIT_ROUNDOFF;
use glam::{Vec2, Vec3};

/// A disc, hit from both sides; its normal is the outward one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Centre.
    pub center: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// Radius, positive.
    pub radius: f32,
}

impl Disc {
    /// A box around the disc.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let n2 = self.normal * self.normal;
        let reach = self.radius * (Vec3::ONE - n2).max(Vec3::ZERO).map(f32::sqrt);
        Aabb { min: self.center - reach, max: self.center + reach }
    }

    /// Ray parameter of the hit in `[t_min, t_max]`, if any; `d` need not be a unit vector.
    #[must_use]
    pub fn intersect(&self, o: Vec3, d: Vec3, t_min: f32, t_max: f32) -> Option<f32> {
        let across = d.dot(self.normal);
        if across == 0.0 {
            return None;
        }
        let t = (self.center - o).dot(self.normal) / across;
        let inside = (o + d * t - self.center).length_squared() <= self.radius * self.radius;
        (t >= t_min && t <= t_max && inside).then_some(t)
    }

    /// The point of the disc nearest to `p`'s projection on its plane: cures the error that `t` carries.
    #[must_use]
    pub fn project(&self, p: Vec3) -> Vec3 {
        p - self.normal * (p - self.center).dot(self.normal)
    }

    /// The point of the disc nearest to `near`; its parameters are angle and distance from the centre.
    pub(super) fn point(&self, near: Vec3) -> SurfacePoint {
        let p = self.project(near);
        let p_error = (self.center.abs() + self.radius) * (ROUND_ROUNDINGS * UNIT_ROUNDOFF);
        let (x, y) = self.normal.any_orthonormal_pair();
        let out = (p - self.center) / self.radius;
        let angle = out.dot(y).atan2(out.dot(x)) / std::f32::consts::TAU;
        SurfacePoint::smooth(p, p_error, self.normal, Vec2::new(angle.rem_euclid(1.0), out.length()))
    }
}
