//! Tests every primitive: the oracle for all other backends, and of use on scenes of a few triangles.

use crate::accel::Accel;
use crate::geometry::{Hit, PlacementId, Ray, ShapeHit, World};
use crate::math::Aabb;
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

    /// The nearest hit, or any.
    fn search(&self, ray: &Ray, any: bool) -> Option<Hit> {
        if !ray.is_traceable() {
            return None;
        }
        let mut nearest: Option<Hit> = None;
        let mut rest = *ray;
        for (index, placement) in (0..).zip(&self.world.placements) {
            if placement.mask & ray.mask == 0 {
                continue;
            }
            let shape = &self.world.shapes[placement.shape.index()];
            let filter = self.world.filters.get(&placement.shape).map(AsRef::as_ref);
            let mut local = placement.pose.object_ray(&rest);
            for prim in (0..).take(shape.primitive_count()) {
                let Some(ShapeHit { t, u, v, ng }) = shape.intersect_filtered(prim, &local, filter) else {
                    continue;
                };
                nearest = Some(Hit { t, u, v, ng, prim, placement: PlacementId(index) });
                if any {
                    return nearest;
                }
                (local.t_max, rest.t_max) = (t, t);
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
