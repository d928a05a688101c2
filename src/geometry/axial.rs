//! The space of a shape about an axis, in double precision.
//!
//! Ray and shape are given in single precision and taken as exact. A ray is carried into the space of the axis after its
//! origin was moved close to the shape: what counts from there on is the size of the shape, not how far away the ray
//! began (Haines et al. 2019, Precision Improvements for Ray/Sphere Intersection, for the same idea).

use crate::geometry::Ray;
use crate::math::float::UNIT_ROUNDOFF;
use crate::math::{Aabb, Transform};
use glam::{DMat3, DVec3, Vec3};

/// An origin, and three directions at right angles of which z is the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axial {
    pub(super) origin: DVec3,
    /// Columns x, y, z: from the space of the axis to that of the shape.
    directions: DMat3,
}

/// A ray in the space of an axis. It starts where it is nearest to the origin of that space.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxialRay {
    /// The point nearest to the origin.
    pub(super) o: DVec3,
    /// Unit direction.
    pub(super) d: DVec3,
    /// The ray's own parameter at `o`.
    t: f64,
    /// The ray's own parameter per length.
    per_length: f64,
    /// What counts of the ray, in its own parameter.
    range: [f64; 2],
}

impl AxialRay {
    /// The ray's own parameter at a distance from `o`, if it counts.
    pub(super) fn parameter(&self, distance: f64) -> Option<f64> {
        let t = self.t + distance * self.per_length;
        (t >= self.range[0] && t <= self.range[1]).then_some(t)
    }

    /// The point at a distance from `o`.
    pub(super) fn at(&self, distance: f64) -> DVec3 {
        self.o + self.d * distance
    }
}

/// The parameter as rays have it. Rounding keeps order, so it stays within the range of the ray.
#[expect(clippy::cast_possible_truncation, reason = "rounding is what is asked for")]
pub(super) fn single(t: f64) -> f32 {
    t as f32
}

impl Axial {
    /// The space about `axis` of any length but zero; what is "x" in it depends on the axis alone.
    pub(super) fn new(origin: DVec3, axis: DVec3) -> Option<Self> {
        let z = axis.try_normalize()?;
        let (x, y) = z.any_orthonormal_pair();
        origin.is_finite().then_some(Self { origin, directions: DMat3::from_cols(x, y, z) })
    }

    pub(super) fn axis(&self) -> DVec3 {
        self.directions.z_axis
    }

    /// How far a circle about the axis reaches along each axis of the shape's space, per radius.
    pub(super) fn reach_of_circle(&self) -> DVec3 {
        let [x, y, z] = (self.axis() * self.axis()).to_array();
        DVec3::new((y + z).sqrt(), (x + z).sqrt(), (x + y).sqrt())
    }

    /// The space that this one is carried to by a map that keeps angles: with the other hand where the map mirrors.
    pub(super) fn carried(&self, map: &Transform) -> Option<Self> {
        let matrix = map.world_from_object().matrix3.as_dmat3();
        let shift = Vec3::from(map.world_from_object().translation).as_dvec3();
        let z = (matrix * self.axis()).try_normalize()?;
        let x = (matrix * self.directions.x_axis).reject_from_normalized(z).try_normalize()?;
        let y = z.cross(x) * (matrix.determinant() * self.directions.determinant()).signum();
        let origin = matrix * self.origin + shift;
        origin.is_finite().then_some(Self { origin, directions: DMat3::from_cols(x, y, z) })
    }

    /// The ray in this space; `None` where it begins too far away for its parameters to count.
    pub(super) fn ray(&self, ray: &Ray) -> Option<AxialRay> {
        let (to_origin, d) = (self.origin - ray.o.as_dvec3(), ray.d.as_dvec3());
        let length = d.length();
        // A parameter in single precision: its products with the direction are exact, so the shift is, too.
        let rough = f64::from(single(to_origin.dot(d) / (length * length)));
        if !rough.is_finite() {
            return None;
        }
        let back = self.directions.transpose();
        let (o, d) = (back * (d * rough - to_origin), back * (d / length));
        let rest = -o.dot(d);
        Some(AxialRay {
            o: o + d * rest,
            d,
            t: rough + rest / length,
            per_length: length.recip(),
            range: [ray.t_min.into(), ray.t_max.into()],
        })
    }

    /// The point of a ray at its parameter `t`, in this space.
    pub(super) fn point_of(&self, ray: &Ray, t: f32) -> DVec3 {
        let p = ray.d.as_dvec3() * f64::from(t) + (ray.o.as_dvec3() - self.origin);
        self.directions.transpose() * p
    }

    /// A direction of this space in that of the shape.
    pub(super) fn outward(&self, n: DVec3) -> Vec3 {
        (self.directions * n).as_vec3()
    }

    /// A point of this space in that of the shape, and the bound on its error: intersection in double precision adds
    /// nothing to the rounding of the point that is worth a bound.
    pub(super) fn outside(&self, p: DVec3) -> (Vec3, Vec3) {
        let p = (self.origin + self.directions * p).as_vec3();
        (p, p.abs() * UNIT_ROUNDOFF * ROUNDING_AND_A_HALF + f32::MIN_POSITIVE)
    }

    /// The box about the origin that reaches `low` and `high`, rounded outwards.
    pub(super) fn aabb(&self, low: DVec3, high: DVec3) -> Aabb {
        // Far above the rounding of doubles, far below that of singles.
        let slack = (self.origin.abs() + low.abs().max(high.abs())) * 1e-14;
        let (low, high) = (self.origin + low - slack, self.origin + high + slack);
        Aabb { min: low.as_vec3().map(f32::next_down), max: high.as_vec3().map(f32::next_up) }
    }
}

/// Roundings in the error bound of a point: the one to single precision, and half a one so that what the bound is
/// multiplied with may round, too.
const ROUNDING_AND_A_HALF: f32 = 1.5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_rays_are_carried_without_loss() {
        let space = Axial::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 1.0, 0.5)).expect("an axis");
        let from = Vec3::new(3e6, -1e6, 2e6);
        let ray = Ray::new(from, (Vec3::new(1.0, 2.0, 3.0) - from) * 0.01);
        let local = space.ray(&ray).expect("a ray");
        // The line's distance from the origin, by exact products.
        let d = ray.d.as_dvec3();
        let distance = (space.origin - from.as_dvec3()).cross(d).length() / d.length();
        assert!((local.o.length() - distance).abs() < 1e-9, "{} for {distance}", local.o.length());
        assert!((local.parameter(0.0).expect("counts") - 100.0).abs() < 1e-4, "parameter");
        assert!(local.o.dot(local.d).abs() < 1e-9, "not the nearest point");
    }

    #[test]
    fn carried_spaces_keep_their_x() {
        let space = Axial::new(DVec3::X, DVec3::Y).expect("an axis");
        let map = Transform::new(glam::Affine3A::from_rotation_y(0.5)).expect("a turn");
        let turned = space.carried(&map).expect("a space");
        let x = map.vector(space.outward(DVec3::X));
        assert!(turned.outward(DVec3::X).abs_diff_eq(x, 1e-6), "x was lost");
        assert!(turned.outward(DVec3::Z).abs_diff_eq(Vec3::Y, 1e-6), "axis");
    }
}
