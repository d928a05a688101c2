//! Everything that can be hit.

use crate::geometry::{HitFilter, PlacementId, Pose, Shape, ShapeId, count};
use crate::math::Aabb;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A shape in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// Which shape.
    pub shape: ShapeId,
    /// Where.
    pub pose: Pose,
    /// Which rays see it: those whose mask shares a bit.
    pub mask: u32,
}

/// Shapes, and where they are placed.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// The shapes, named by [`ShapeId`].
    pub shapes: Vec<Shape>,
    /// The placements, named by [`PlacementId`].
    pub placements: Vec<Placement>,
    /// What decides which hits on a shape count, where not all do.
    pub filters: BTreeMap<ShapeId, Arc<dyn HitFilter>>,
}

impl World {
    /// Adds a shape.
    ///
    /// # Panics
    /// Beyond 2^32 shapes.
    pub fn add_shape(&mut self, shape: Shape) -> ShapeId {
        let id = count(self.shapes.len());
        self.shapes.push(shape);
        ShapeId(id)
    }

    /// Places a shape, to be seen by every ray.
    ///
    /// # Panics
    /// Beyond 2^32 placements.
    pub fn place(&mut self, shape: ShapeId, pose: impl Into<Pose>) -> PlacementId {
        let id = count(self.placements.len());
        self.placements.push(Placement { shape, pose: pose.into(), mask: u32::MAX });
        PlacementId(id)
    }

    /// Places what a group of placements shows once more, as a whole: an instance of instances. Backends know one level of
    /// instances, so each member is placed by the product of both poses; `None`, and nothing placed, where one of the
    /// products has no inverse.
    ///
    /// # Panics
    /// Beyond 2^32 placements.
    pub fn place_group(&mut self, group: &[Placement], pose: &Pose) -> Option<Vec<PlacementId>> {
        let poses: Option<Vec<Pose>> = group.iter().map(|member| member.pose.within(pose)).collect();
        let placed = group.iter().zip(poses?).map(|(member, pose)| {
            let id = self.place(member.shape, pose);
            self.placements[id.index()].mask = member.mask;
            id
        });
        Some(placed.collect())
    }

    /// The shape of a placement.
    #[must_use]
    pub fn shape_of(&self, placement: PlacementId) -> &Shape {
        &self.shapes[self.placements[placement.index()].shape.index()]
    }

    /// A box around everything, at all moments of the shutter.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.placements.iter().fold(Aabb::EMPTY, |all, placement| {
            all.union(placement.pose.aabb(self.shapes[placement.shape.index()].bounds()))
        })
    }

    /// How many primitives there are, each instance counted.
    #[must_use]
    pub fn primitive_count(&self) -> usize {
        self.placements.iter().map(|placement| self.shapes[placement.shape.index()].primitive_count()).sum()
    }

    /// Whether anything moves while the shutter is open.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.placements.iter().any(|placement| {
            matches!(placement.pose, Pose::Moving(_)) || self.shapes[placement.shape.index()].is_moving()
        })
    }
}
