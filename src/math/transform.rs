//! Affine maps kept with their inverses.
//!
//! Single precision; what a map adds to the error of a point is bounded by [`Transform::point_error`].

use crate::math::Aabb;
use crate::math::float::gamma;
use glam::{Affine3A, Mat3A, Vec3, Vec3A};

/// An invertible affine map from object to world, and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    world_from_object: Affine3A,
    object_from_world: Affine3A,
}

impl Transform {
    /// The map that moves nothing.
    pub const IDENTITY: Self =
        Self { world_from_object: Affine3A::IDENTITY, object_from_world: Affine3A::IDENTITY };

    /// The map and its inverse; `None` where single precision finds no finite inverse.
    #[must_use]
    pub fn new(world_from_object: Affine3A) -> Option<Self> {
        let determinant = world_from_object.matrix3.determinant();
        if determinant == 0.0 || !world_from_object.is_finite() {
            return None;
        }
        let object_from_world = world_from_object.inverse();
        object_from_world.is_finite().then_some(Self { world_from_object, object_from_world })
    }

    /// The matrix from object to world.
    #[must_use]
    pub fn world_from_object(&self) -> &Affine3A {
        &self.world_from_object
    }

    /// The matrix from world to object.
    #[must_use]
    pub fn object_from_world(&self) -> &Affine3A {
        &self.object_from_world
    }

    /// Whether nothing moves.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        self.world_from_object == Affine3A::IDENTITY
    }

    /// A point of the object in the world.
    #[must_use]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.world_from_object.transform_point3(p)
    }

    /// A direction or difference of the object in the world; its length changes with the scale.
    #[must_use]
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.world_from_object.transform_vector3(v)
    }

    /// A normal of the object in the world, not normalised: the inverse transpose, which keeps outward normals
    /// outward under mirrored maps too.
    #[must_use]
    pub fn normal(&self, n: Vec3) -> Vec3 {
        Vec3::from(self.object_from_world.matrix3.transpose() * Vec3A::from(n))
    }

    /// A point of the world in the object.
    #[must_use]
    pub fn inverse_point(&self, p: Vec3) -> Vec3 {
        self.object_from_world.transform_point3(p)
    }

    /// A direction of the world in the object, not normalised, so that ray parameters stay as they are.
    #[must_use]
    pub fn inverse_vector(&self, v: Vec3) -> Vec3 {
        self.object_from_world.transform_vector3(v)
    }

    /// Bound on the absolute error per axis of `point(p)` where `p` is off by at most `error` per axis (Pharr,
    /// Jakob, Humphreys 2023, Physically Based Rendering, section 6.8.6).
    #[must_use]
    pub fn point_error(&self, p: Vec3, error: Vec3) -> Vec3 {
        let m = absolute(&self.world_from_object.matrix3);
        let t = Vec3::from(self.world_from_object.translation.abs());
        let carried = Vec3::from(m * Vec3A::from(error)) * (1.0 + gamma(3));
        let rounded = (Vec3::from(m * Vec3A::from(p.abs())) + t) * gamma(3);
        carried + rounded
    }

    /// Bound on the absolute error per axis, in the world, of carrying the world's point `p` into the object: what a backend
    /// gets wrong about a ray that starts at `p` when it meets an instance.
    #[must_use]
    pub fn inverse_point_error(&self, p: Vec3) -> Vec3 {
        let m = absolute(&self.object_from_world.matrix3);
        let t = Vec3::from(self.object_from_world.translation.abs());
        let rounded = (Vec3::from(m * Vec3A::from(p.abs())) + t) * gamma(4);
        Vec3::from(absolute(&self.world_from_object.matrix3) * Vec3A::from(rounded))
    }

    /// The box around the image of a box.
    #[must_use]
    pub fn aabb(&self, aabb: Aabb) -> Aabb {
        if aabb.is_empty() { aabb } else { Aabb::around(aabb.corners().map(|p| self.point(p))) }
    }
}

fn absolute(m: &Mat3A) -> Mat3A {
    Mat3A::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    fn skewed() -> Transform {
        let affine = Affine3A::from_scale_rotation_translation(
            Vec3::new(-2.0, 0.5, 3.0),
            Quat::from_rotation_x(0.7) * Quat::from_rotation_z(-1.1),
            Vec3::new(10.0, -20.0, 30.0),
        );
        Transform::new(affine).expect("invertible")
    }

    #[test]
    fn there_and_back() {
        let t = skewed();
        let p = Vec3::new(0.3, -4.0, 2.0);
        assert!(t.inverse_point(t.point(p)).abs_diff_eq(p, 1e-5), "point");
        assert!(t.inverse_vector(t.vector(p)).abs_diff_eq(p, 1e-5), "vector");
    }

    #[test]
    fn normals_stay_perpendicular_and_outward() {
        let t = skewed();
        let (u, v) = (Vec3::new(1.0, 2.0, 0.5), Vec3::new(-0.3, 1.0, 4.0));
        let n = t.normal(u.cross(v)).normalize();
        assert!(n.dot(t.vector(u).normalize()).abs() < 1e-6, "not perpendicular");
        let outside = t.point(u.cross(v)) - t.point(Vec3::ZERO);
        assert!(n.dot(outside) > 0.0, "a mirrored map turned the normal inside");
    }

    #[test]
    fn singular_maps_are_refused() {
        assert!(Transform::new(Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0))).is_none(), "flat");
        assert!(Transform::new(Affine3A::from_scale(Vec3::splat(f32::NAN))).is_none(), "nan");
    }

    #[test]
    fn the_error_bound_holds_against_double_precision() {
        let t = skewed();
        let m = t.world_from_object().matrix3.as_dmat3();
        let shift = Vec3::from(t.world_from_object().translation).as_dvec3();
        for i in 0..1000_u16 {
            let a = f32::from(i);
            let p = Vec3::new((a * 0.37).sin() * 50.0, (a * 1.3).cos() * 0.01, (a * 0.11).sin() * 900.0);
            let exact = m * p.as_dvec3() + shift;
            let off = (t.point(p).as_dvec3() - exact).abs();
            let bound = t.point_error(p, Vec3::ZERO).as_dvec3();
            assert!(off.cmple(bound).all(), "{p}: {off} exceeds {bound}");
        }
    }
}
