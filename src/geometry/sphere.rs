//! Spheres.

use crate::geometry::SurfacePoint;
use crate::geometry::surface::ROUND_ROUNDINGS;
use crate::math::Aabb;
use crate::math::float::UNIT_ROUNDOFF;
use glam::{Vec2, Vec3};

/// A sphere, hit from outside and from inside; normals point outwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub center: Vec3,
    /// Radius, positive.
    pub radius: f32,
}

impl Sphere {
    /// A box around the sphere.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb { min: self.center - self.radius, max: self.center + self.radius }
    }

    /// Nearest ray parameter in `[t_min, t_max]` where the ray crosses the surface; `d` need not be a unit vector.
    ///
    /// The distance of the ray from the centre is found by subtracting vectors, not squares, which keeps small
    /// spheres far away from drowning in rounding (Haines et al. 2019, Precision Improvements for Ray/Sphere
    /// Intersection).
    #[must_use]
    pub fn intersect(&self, o: Vec3, d: Vec3, t_min: f32, t_max: f32) -> Option<f32> {
        let to_center = self.center - o;
        let d2 = d.length_squared();
        let t_mid = to_center.dot(d) / d2;
        let off = to_center - d * t_mid;
        let half_chord2 = self.radius * self.radius - off.length_squared();
        if half_chord2.is_nan() || half_chord2 < 0.0 {
            return None;
        }
        let half = (half_chord2 / d2).sqrt();
        [t_mid - half, t_mid + half].into_iter().find(|&t| t >= t_min && t <= t_max)
    }

    /// The point of the surface nearest to `p`, and the unit normal there: cures the error that `t` carries.
    #[must_use]
    pub fn project(&self, p: Vec3) -> (Vec3, Vec3) {
        let n = (p - self.center).normalize_or(Vec3::Z);
        (self.center + n * self.radius, n)
    }

    /// Bound on the error of all points.
    pub(super) fn error(&self) -> Vec3 {
        (self.center.abs() + self.radius) * (ROUND_ROUNDINGS * UNIT_ROUNDOFF)
    }

    /// The point of the surface nearest to `near`; its parameters are longitude and latitude.
    pub(super) fn point(&self, near: Vec3) -> SurfacePoint {
        let (p, n) = self.project(near);
        let p_error = self.error();
        let longitude = n.y.atan2(n.x) / std::f32::consts::TAU;
        let latitude = n.z.clamp(-1.0, 1.0).acos() / std::f32::consts::PI;
        SurfacePoint::smooth(p, p_error, n, Vec2::new(longitude.rem_euclid(1.0), latitude))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_small_and_inside() {
        let s = Sphere { center: Vec3::new(0.0, 0.0, 1e4), radius: 1.0 };
        let t = s.intersect(Vec3::ZERO, Vec3::Z, 0.0, f32::INFINITY).expect("in front");
        assert!((t - 9999.0).abs() <= 1e-3, "far: {t}");
        let t = s.intersect(s.center, Vec3::X * 0.5, 0.0, f32::INFINITY).expect("inside");
        assert!((t - 2.0).abs() < 1e-6, "inside, direction of half a unit: {t}");
        assert!(s.intersect(Vec3::ZERO, -Vec3::Z, 0.0, f32::INFINITY).is_none(), "behind");
    }
}
