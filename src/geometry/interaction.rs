//! The resolved point on a surface.

use crate::geometry::{Hit, PlacementId, Pose, Ray, Shape, ShapeHit, SurfacePoint, World, spawn};
use glam::{Vec2, Vec3};

/// A point on a surface, ready to be shaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interaction {
    /// The point, recomputed from surface parameters: its error does not grow with the length of the ray.
    pub p: Vec3,
    /// Bound on the error of `p` per axis, including what an intersection test near it may get wrong.
    pub p_error: Vec3,
    /// Unit direction towards where the ray came from.
    pub wo: Vec3,
    /// Unit geometric normal, outward.
    pub ng: Vec3,
    /// Unit shading normal, on the side of `ng`.
    pub ns: Vec3,
    /// Surface parameters: those of the mesh's file, else barycentric; longitude and latitude on a sphere.
    pub uv: Vec2,
    /// From the point to the smooth surface that `ns` stands for, where that lies on the side of `ng`, and where it lies on the
    /// other; zero where it does not.
    pub lift: [Vec3; 2],
    /// Ray parameter of the hit.
    pub t: f32,
    /// Moment within the shutter, in [0, 1].
    pub time: f32,
    /// What was hit.
    pub placement: PlacementId,
    /// Which of its primitives.
    pub prim: u32,
    /// The group of that primitive.
    pub group: u16,
}

impl Interaction {
    /// Whether the ray came from outside.
    #[must_use]
    pub fn is_front(&self) -> bool {
        self.wo.dot(self.ng) > 0.0
    }

    /// The ray that leaves along `d`, at the same moment.
    #[must_use]
    pub fn spawn(&self, d: Vec3) -> Ray {
        spawn::ray(self.p, self.p_error, self.ng, d).at_time(self.time)
    }

    /// The ray towards a point that ends just before it; parameters count from 0 at the start to 1 at the point.
    #[must_use]
    pub fn spawn_to(&self, target: Vec3) -> Ray {
        self.spawn(target - self.p).towards(target)
    }
}

impl World {
    /// Whether `ray` met the surface of `hit` from outside, as [`Interaction::is_front`] of the whole point.
    #[must_use]
    pub fn is_front(&self, ray: &Ray, hit: &Hit) -> bool {
        let placement = &self.placements[hit.placement.index()];
        match (self.shape_of(hit.placement), &placement.pose) {
            (Shape::Sphere(sphere), Pose::World) => ray.d.dot(sphere.project(ray.at(hit.t)).1) < 0.0,
            _ => self.interaction(ray, hit).is_front(),
        }
    }

    /// The point that `hit` of `ray` names, in world space.
    #[must_use]
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> Interaction {
        let placement = &self.placements[hit.placement.index()];
        let shape = &self.shapes[placement.shape.index()];
        let Hit { t, u, v, ng, prim, .. } = *hit;
        let at = |ray: &Ray| shape.point(prim, ray, &ShapeHit { t, u, v, ng });
        let point = match placement.pose.at(ray.time) {
            None => at(ray),
            Some(map) => at(&ray.into_object(&map)).transformed(&map),
        };
        let SurfacePoint { p, p_error, ng, ns, uv, lift } = point;
        Interaction {
            p,
            p_error,
            wo: -ray.d.normalize(),
            ng,
            ns: if ns.dot(ng) < 0.0 { -ns } else { ns },
            uv,
            lift,
            t,
            time: ray.time,
            placement: hit.placement,
            prim,
            group: shape.group(prim),
        }
    }
}
