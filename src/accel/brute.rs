//! Tests every primitive: the oracle for all other backends, and of use on scenes of a few triangles.

use crate::accel::Accel;
use crate::geometry::{Hit, PlacementId, Ray, Shape, World, intersect_triangle};
use crate::math::Aabb;
use glam::Vec3;
use std::sync::Arc;

/// A world without a hierarchy.
#[derive(Clone, Debug)]
pub struct Brute {
    world: Arc<World>,
}

impl Brute {
    /// Ready at once.
    #[must_use]
    pub fn new(world: Arc<World>) -> Self {
        Self { world }
    }

    /// The first hit that `better` accepts, replaced by every later one that it accepts too.
    fn search(&self, ray: &Ray, stop_at_first: bool) -> Option<Hit> {
        if !ray.is_traceable() || ray.mask == 0 {
            return None;
        }
        let mut nearest: Option<Hit> = None;
        for (index, placement) in (0..).zip(&self.world.placements) {
            let (o, d) = match &placement.transform {
                None => (ray.o, ray.d),
                Some(t) => (t.inverse_point(ray.o), t.inverse_vector(ray.d)),
            };
            let shape = &self.world.shapes[placement.shape.index()];
            let reach = nearest.map_or(ray.t_max, |hit| hit.t);
            if let Some(found) = nearest_on(shape, o, d, [ray.t_min, reach], stop_at_first) {
                let Found { t, u, v, ng, prim } = found;
                nearest = Some(Hit { t, u, v, ng, prim, placement: PlacementId(index) });
                if stop_at_first {
                    break;
                }
            }
        }
        nearest
    }
}

impl Accel for Brute {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.search(ray, false)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.search(ray, true).is_some()
    }

    fn bounds(&self) -> Aabb {
        self.world.bounds()
    }

    fn bytes(&self) -> usize {
        0
    }
}

/// A hit in the space of a shape.
struct Found {
    t: f32,
    u: f32,
    v: f32,
    ng: Vec3,
    prim: u32,
}

fn nearest_on(shape: &Shape, o: Vec3, d: Vec3, [t_min, mut t_max]: [f32; 2], any: bool) -> Option<Found> {
    match shape {
        Shape::Sphere(sphere) => {
            let t = sphere.intersect(o, d, t_min, t_max)?;
            Some(Found { t, u: 0.0, v: 0.0, ng: o + d * t - sphere.center, prim: 0 })
        }
        Shape::Disc(disc) => {
            let t = disc.intersect(o, d, t_min, t_max)?;
            Some(Found { t, u: 0.0, v: 0.0, ng: disc.normal, prim: 0 })
        }
        Shape::Mesh(mesh) => {
            let mut nearest = None;
            for (prim, indices) in (0..).zip(mesh.triangles().iter()) {
                let corners @ [a, b, c] = indices.map(|i| mesh.positions()[i as usize]);
                let Some([t, u, v]) = intersect_triangle(corners, o, d, t_min, t_max) else { continue };
                t_max = t;
                nearest = Some(Found { t, u, v, ng: (b - a).cross(c - a), prim });
                if any {
                    break;
                }
            }
            nearest
        }
    }
}
