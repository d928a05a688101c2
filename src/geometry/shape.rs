//! The kinds of shape, and what each of them can be asked, in its own space.

use crate::geometry::{
    Disc, HitFilter, Mesh, Ray, ShapeHit, Sphere, Surface, SurfacePoint, intersect_triangle,
};
use crate::math::Aabb;
use std::sync::Arc;

/// A thing with a surface.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Triangles.
    Mesh(Mesh),
    /// One sphere.
    Sphere(Sphere),
    /// One disc.
    Disc(Disc),
    /// Something that finds its own hits.
    Surface(Arc<dyn Surface>),
}

impl Shape {
    /// A box around the shape, at all moments of the shutter.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Mesh(mesh) => mesh.bounds(),
            Self::Sphere(sphere) => sphere.bounds(),
            Self::Disc(disc) => disc.bounds(),
            Self::Surface(surface) => (0..surface.primitive_count())
                .fold(Aabb::EMPTY, |all, prim| all.union(surface.primitive_bounds(prim))),
        }
    }

    /// A box around a primitive, at all moments of the shutter.
    #[must_use]
    pub fn primitive_bounds(&self, prim: u32) -> Aabb {
        match self {
            Self::Mesh(mesh) => mesh.triangle_bounds(prim),
            Self::Sphere(sphere) => sphere.bounds(),
            Self::Disc(disc) => disc.bounds(),
            Self::Surface(surface) => surface.primitive_bounds(prim),
        }
    }

    /// How many primitives hits may name.
    #[must_use]
    pub fn primitive_count(&self) -> usize {
        match self {
            Self::Mesh(mesh) => mesh.triangles().len(),
            Self::Sphere(_) | Self::Disc(_) => 1,
            Self::Surface(surface) => surface.primitive_count() as usize,
        }
    }

    /// Whether the shape changes by itself while the shutter is open.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        match self {
            Self::Mesh(mesh) => mesh.key_count() > 1,
            Self::Sphere(_) | Self::Disc(_) => false,
            Self::Surface(surface) => surface.is_moving(),
        }
    }

    /// The group of a primitive, by which materials are told apart.
    #[must_use]
    pub fn group(&self, prim: u32) -> u16 {
        if let Self::Mesh(mesh) = self { mesh.group(prim) } else { 0 }
    }

    /// The nearest point of a primitive on a traceable ray in the space of the shape, within the ray's range: exact rather
    /// than fast for triangles, in double precision.
    #[must_use]
    pub fn intersect(&self, prim: u32, ray: &Ray) -> Option<ShapeHit> {
        let &Ray { o, d, t_min, t_max, .. } = ray;
        match self {
            Self::Mesh(mesh) => {
                let corners @ [a, b, c] = mesh.corners_at(prim, ray.time);
                let [t, u, v] = intersect_triangle(corners, o, d, t_min, t_max)?;
                Some(ShapeHit { t, u, v, ng: (b - a).cross(c - a) })
            }
            Self::Sphere(sphere) => {
                let t = sphere.intersect(o, d, t_min, t_max)?;
                Some(ShapeHit { t, u: 0.0, v: 0.0, ng: o + d * t - sphere.center })
            }
            Self::Disc(disc) => {
                let t = disc.intersect(o, d, t_min, t_max)?;
                Some(ShapeHit { t, u: 0.0, v: 0.0, ng: disc.normal })
            }
            Self::Surface(surface) => surface.intersect(prim, ray),
        }
    }

    /// As [`Shape::intersect`], passing over hits that `filter` does not accept.
    #[must_use]
    pub fn intersect_filtered(
        &self,
        prim: u32,
        ray: &Ray,
        filter: Option<&dyn HitFilter>,
    ) -> Option<ShapeHit> {
        let Some(filter) = filter else { return self.intersect(prim, ray) };
        let mut rest = *ray;
        loop {
            let hit = self.intersect(prim, &rest)?;
            if filter.accepts(ray, &hit, prim) {
                return Some(hit);
            }
            // A round primitive may be met again, farther on.
            if hit.t < rest.t_min {
                return None;
            }
            rest.t_min = hit.t.next_up();
            if !rest.is_traceable() {
                return None;
            }
        }
    }

    /// The point that a hit of `ray` names, all in the space of the shape.
    #[must_use]
    pub fn point(&self, prim: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        match self {
            Self::Mesh(mesh) => mesh.point(prim, ray.time, hit),
            Self::Sphere(sphere) => sphere.point(ray.at(hit.t)),
            Self::Disc(disc) => disc.point(ray.at(hit.t)),
            Self::Surface(surface) => surface.point(prim, ray, hit),
        }
    }
}
