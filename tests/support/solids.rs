//! Shapes that find their own hits, and filters, as a user might write them.

use crate::rays::Rng;
use glam::{Vec2, Vec3};
use specula::geometry::{HitFilter, Ray, ShapeHit, Surface, SurfacePoint};
use specula::math::Aabb;

/// An ellipsoid with its axes along those of the space; in double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ellipsoid {
    center: Vec3,
    axes: Vec3,
}

impl Ellipsoid {
    pub(crate) fn random(rng: &mut Rng, least: f32, most: f32) -> Self {
        let mut axis = || least + (most - least) * rng.unit();
        let axes = Vec3::new(axis(), axis(), axis());
        Self { center: rng.cube() * 0.5, axes }
    }

    /// The normal at a point, of any length.
    fn normal(&self, p: Vec3) -> Vec3 {
        (p - self.center) / (self.axes * self.axes)
    }

    fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        let axes = self.axes.as_dvec3();
        let o = (ray.o.as_dvec3() - self.center.as_dvec3()) / axes;
        let d = ray.d.as_dvec3() / axes;
        let mid = -o.dot(d) / d.length_squared();
        let half2 = (1.0 - (o + d * mid).length_squared()) / d.length_squared();
        let half = (half2 >= 0.0).then(|| half2.sqrt())?;
        #[expect(clippy::cast_possible_truncation, reason = "ray parameters are in single precision")]
        let roots = [mid - half, mid + half].map(|t| t as f32);
        let t = roots.into_iter().find(|&t| t >= ray.t_min && t <= ray.t_max)?;
        Some(ShapeHit { t, u: 0.0, v: 0.0, ng: self.normal(ray.at(t)) })
    }
}

/// Several ellipsoids, each a primitive.
#[derive(Clone, Debug)]
pub(crate) struct Ellipsoids(pub(crate) Vec<Ellipsoid>);

impl Surface for Ellipsoids {
    fn primitive_count(&self) -> u32 {
        u32::try_from(self.0.len()).expect("few")
    }

    fn primitive_bounds(&self, prim: u32) -> Aabb {
        let Ellipsoid { center, axes } = self.0[prim as usize];
        let reach = axes * (1.0 + 1e-5);
        Aabb { min: center - reach, max: center + reach }
    }

    fn intersect(&self, prim: u32, ray: &Ray) -> Option<ShapeHit> {
        self.0[prim as usize].intersect(ray)
    }

    fn point(&self, prim: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let ball = self.0[prim as usize];
        let out = (ray.at(hit.t) - ball.center) / ball.axes;
        let p = ball.center + out.normalize() * ball.axes;
        let p_error = (ball.center.abs() + ball.axes) * 1e-6;
        SurfacePoint::smooth(p, p_error, ball.normal(p).normalize(), Vec2::ZERO)
    }
}

/// The plane y = -2, without end.
#[derive(Debug)]
pub(crate) struct Ground;

impl Surface for Ground {
    fn primitive_bounds(&self, _prim: u32) -> Aabb {
        let far = Vec3::new(f32::INFINITY, 0.0, f32::INFINITY);
        Aabb { min: -far - Vec3::Y * 2.0, max: far - Vec3::Y * 2.0 }
    }

    fn intersect(&self, _prim: u32, ray: &Ray) -> Option<ShapeHit> {
        let t = (-2.0 - ray.o.y) / ray.d.y;
        (t >= ray.t_min && t <= ray.t_max).then_some(ShapeHit { t, u: 0.0, v: 0.0, ng: Vec3::Y })
    }

    fn point(&self, _prim: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let p = ray.at(hit.t).with_y(-2.0);
        SurfacePoint::smooth(p, Vec3::splat(1e-6), Vec3::Y, Vec2::ZERO)
    }
}

/// Which hits count.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Sieve {
    /// Those on primitives of odd number.
    Odd,
    /// Those where the ray leaves.
    Leaving,
}

impl HitFilter for Sieve {
    fn accepts(&self, ray: &Ray, hit: &ShapeHit, prim: u32) -> bool {
        match self {
            Self::Odd => prim % 2 == 1,
            Self::Leaving => hit.ng.dot(ray.d) > 0.0,
        }
    }
}
