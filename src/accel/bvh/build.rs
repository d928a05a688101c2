//! From a world to hierarchies.

use super::hierarchy::Hierarchy;
use super::things::Things;
use super::triangles::Triangles;
use super::{Body, BvhAccel, Item, Options};
use crate::geometry::{Mesh, PlacementId, Pose, Shape, ShapeId, World};
use crate::math::{Aabb, Transform};
use glam::Vec3;
use std::ops::ControlFlow;
use std::sync::Arc;

impl<H: Hierarchy> BvhAccel<H> {
    /// Hierarchies over a world: one for each shape of many primitives, however often it is placed, one for all still
    /// meshes that are placed once in world coordinates, and one over what there is besides. Uses the threads of the current
    /// rayon pool.
    #[must_use]
    pub fn build(world: &Arc<World>, options: &Options) -> Self {
        match Self::build_with(world, options, &|_| ControlFlow::Continue(())) {
            Some(built) => built,
            None => unreachable!("nobody stops it"),
        }
    }

    /// As [`BvhAccel::build`]; `go_on` is told how much of the work is done, from 0 to 1, between one hierarchy and the next,
    /// and may stop it: `None`. obvhs does not stop within one.
    pub fn build_with(
        world: &Arc<World>,
        options: &Options,
        go_on: &dyn Fn(f64) -> ControlFlow<()>,
    ) -> Option<Self> {
        let mut steps =
            Steps { total: world.shapes.iter().map(Shape::primitive_count).sum(), done: 0, go_on };
        let uses = uses(world);
        let merged_ids = merged(world, &uses);
        let mut is_merged = vec![false; world.placements.len()];
        merged_ids.iter().for_each(|(id, _)| is_merged[id.index()] = true);
        let count = merged_ids.iter().map(|(_, mesh)| mesh.triangles().len()).sum();
        let merged = steps.take(count, || Triangles::of_placements(world, &merged_ids, options))?;
        let mut bodies = Vec::with_capacity(world.shapes.len());
        for (id, shape) in (0..).map(ShapeId).zip(&world.shapes) {
            let alone = uses[id.index()].iter().any(|placement| !is_merged[placement.index()]);
            let is_filtered = world.filters.contains_key(&id);
            let count = if alone { shape.primitive_count() } else { 0 };
            bodies.push(
                steps.take(count, || if alone { body(shape, is_filtered, options) } else { Body::Few })?,
            );
        }
        let (items, boxes) = items(world, &is_merged, merged.is_some());
        let outer = Things::build(boxes, options);
        let bounds = world.bounds();
        Some(Self { world: world.clone(), merged, bodies, items, outer, bounds, level: super::isa::level() })
    }
}

/// Work to be done, and who may stop it.
struct Steps<'a> {
    total: usize,
    done: usize,
    go_on: &'a dyn Fn(f64) -> ControlFlow<()>,
}

impl Steps<'_> {
    fn take<T>(&mut self, count: usize, work: impl FnOnce() -> T) -> Option<T> {
        if count > 0 {
            #[expect(clippy::cast_precision_loss, reason = "a share of the work")]
            let part = self.done as f64 / self.total as f64;
            if (self.go_on)(part).is_break() {
                return None;
            }
        }
        self.done += count;
        Some(work())
    }
}

/// Who places each shape.
fn uses(world: &World) -> Vec<Vec<PlacementId>> {
    let mut uses = vec![Vec::new(); world.shapes.len()];
    for (id, placement) in (0..).map(PlacementId).zip(&world.placements) {
        uses[placement.shape.index()].push(id);
    }
    uses
}

/// The meshes that share a hierarchy: still ones, placed once, in world coordinates. A single one needs no company.
fn merged<'a>(world: &'a World, uses: &[Vec<PlacementId>]) -> Vec<(PlacementId, &'a Mesh)> {
    let mut found = Vec::new();
    for (shape, uses) in world.shapes.iter().zip(uses) {
        let (Shape::Mesh(mesh), [id]) = (shape, uses.as_slice()) else { continue };
        if world.placements[id.index()].pose == Pose::World && mesh.key_count() == 1 {
            found.push((*id, mesh));
        }
    }
    if found.len() < 2 { Vec::new() } else { found }
}

fn body<H: Hierarchy>(shape: &Shape, is_filtered: bool, options: &Options) -> Body<H> {
    let many = match shape {
        Shape::Mesh(mesh) => Triangles::of_mesh(mesh, is_filtered, options).map(Body::Triangles),
        Shape::Surface(surface) if surface.primitive_count() > 1 => {
            let boxes = (0..surface.primitive_count()).map(|prim| surface.primitive_bounds(prim)).collect();
            Some(Body::Primitives(Things::build(boxes, options)))
        }
        _ => None,
    };
    many.unwrap_or(Body::Few)
}

/// What the outer hierarchy holds, and boxes around it.
fn items(world: &World, is_merged: &[bool], has_merged: bool) -> (Vec<Item>, Vec<Aabb>) {
    let shapes: Vec<Aabb> = world.shapes.iter().map(Shape::bounds).collect();
    let bounds = world.bounds();
    // Rays are traced from no farther than this; see `BvhAccel::search`.
    let reach = bounds.min.abs().max(bounds.max.abs()) + Vec3::splat(4.0 * bounds.size().length());
    let (mut items, mut boxes) = (Vec::new(), Vec::new());
    if has_merged {
        items.push(Item::Merged);
        boxes.push(Aabb::EMPTY);
    }
    for (id, placement) in (0..).map(PlacementId).zip(&world.placements) {
        let shape = shapes[placement.shape.index()];
        if has_merged && is_merged[id.index()] {
            boxes[0] = boxes[0].union(shape);
        } else {
            items.push(Item::Placed(id));
            boxes.push(placed(&placement.pose, shape, reach));
        }
    }
    (items, boxes)
}

/// The box around a placed box, with room for what is lost where rays are carried into it.
fn placed(pose: &Pose, aabb: Aabb, reach: Vec3) -> Aabb {
    let exact = pose.aabb(aabb);
    if aabb.is_empty() || !reach.is_finite() {
        return exact;
    }
    let corner = aabb.min.abs().max(aabb.max.abs());
    let error = |map: &Transform| map.point_error(corner, Vec3::ZERO) + map.inverse_point_error(reach) * 2.0;
    let error = match pose {
        Pose::World => Vec3::ZERO,
        Pose::Still(map) => error(map),
        Pose::Moving(motion) => {
            // Moments between keys are of the order of these.
            #[expect(clippy::cast_precision_loss, reason = "few keys")]
            let moments = (0..=4 * motion.keys().len()).map(|i| i as f32 / (4 * motion.keys().len()) as f32);
            moments.map(|time| error(&motion.at(time))).fold(Vec3::ZERO, Vec3::max) * 2.0
        }
    };
    Aabb { min: exact.min - error, max: exact.max + error }
}
