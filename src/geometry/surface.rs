//! Shapes that find their own hits.

use crate::geometry::Ray;
use crate::math::{Aabb, Transform};
use glam::{Vec2, Vec3};
use std::fmt;
use std::sync::Arc;

/// A shape that intersects rays itself, one primitive at a time: what triangles would approximate badly or at great
/// length. All in the space of the shape.
///
/// A backend asks for the boxes once, when it builds, and calls [`Surface::intersect`] from many threads. Answers must
/// not depend on anything but the arguments. A panic in one comes out of the query that asked.
pub trait Surface: fmt::Debug + Send + Sync {
    /// How many primitives hits may name.
    fn primitive_count(&self) -> u32 {
        1
    }

    /// Whether it changes by itself while the shutter is open.
    fn is_moving(&self) -> bool {
        false
    }

    /// A box around a primitive at all moments of the shutter; too small a one loses hits. An empty one is never hit.
    fn primitive_bounds(&self, prim: u32) -> Aabb;

    /// The nearest point of a primitive on a traceable ray, within the ray's range; its direction has any length.
    fn intersect(&self, prim: u32, ray: &Ray) -> Option<ShapeHit>;

    /// Whether a primitive lies on a traceable ray, within the ray's range.
    fn occludes(&self, prim: u32, ray: &Ray) -> bool {
        self.intersect(prim, ray).is_some()
    }

    /// The point that a hit of `ray` names. `ray.at(hit.t)` is off by the rounding of a parameter that may be large: bring
    /// it back to the surface.
    fn point(&self, prim: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint;

    /// The same carried by a map that keeps angles and scales all lengths by `factor`, which is positive; `None` where it
    /// must be placed as an instance instead.
    fn scaled(&self, map: &Transform, factor: f32) -> Option<Arc<dyn Surface>> {
        let _ = (map, factor);
        None
    }
}

/// Roundings that an intersection test spends on a point near a round surface; see `tests/spawn.rs`.
pub(super) const ROUND_ROUNDINGS: f32 = 8.0;

/// A hit in the space of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeHit {
    /// Ray parameter.
    pub t: f32,
    /// First surface parameter, as [`crate::geometry::Hit::u`].
    pub u: f32,
    /// Second surface parameter, as [`crate::geometry::Hit::v`].
    pub v: f32,
    /// Outward normal, not normalised.
    pub ng: Vec3,
}

/// A point of a surface, in the space of its shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point.
    pub p: Vec3,
    /// Bound on the error of `p` per axis, including what an intersection test near it may get wrong: too small a one
    /// lets rays that leave the surface hit it at once.
    pub p_error: Vec3,
    /// Unit geometric normal, outward.
    pub ng: Vec3,
    /// Unit shading normal, on the side of `ng`.
    pub ns: Vec3,
    /// Surface parameters for textures.
    pub uv: Vec2,
    /// From the point to the smooth surface that shading normals stand for, where that lies outside, and where it lies inside;
    /// zero where it does not.
    pub lift: [Vec3; 2],
}

impl SurfacePoint {
    /// A point of a smooth surface, which is shaded with its true normal.
    #[must_use]
    pub fn smooth(p: Vec3, p_error: Vec3, n: Vec3, uv: Vec2) -> Self {
        Self { p, p_error, ng: n, ns: n, uv, lift: [Vec3::ZERO; 2] }
    }

    /// The point in the space that `map` leads to.
    pub(super) fn transformed(self, map: &Transform) -> Self {
        let p = map.point(self.p);
        Self {
            p,
            p_error: map.point_error(self.p, self.p_error) + map.inverse_point_error(p),
            ng: map.normal(self.ng).normalize_or(self.ng),
            ns: map.normal(self.ns).normalize_or(self.ns),
            uv: self.uv,
            lift: self.lift.map(|lift| map.vector(lift)),
        }
    }
}

/// Decides which hits count: how leaves are cut out of triangles by a texture, for example.
///
/// Called from many threads, in any order, more than once for one hit. A panic comes out of the query that asked.
pub trait HitFilter: fmt::Debug + Send + Sync {
    /// Whether a hit counts; if not, the ray goes on as if it were not there. `ray` is in the space of the shape and ends
    /// anywhere from the hit on.
    fn accepts(&self, ray: &Ray, hit: &ShapeHit, prim: u32) -> bool;
}
