//! Everything that can be hit.

use crate::geometry::{Disc, Mesh, PlacementId, ShapeId, Sphere};
use crate::math::{Aabb, Transform};

/// A thing with a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Triangles.
    Mesh(Mesh),
    /// One sphere.
    Sphere(Sphere),
    /// One disc.
    Disc(Disc),
}

impl Shape {
    /// A box around the shape.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Mesh(mesh) => mesh.bounds(),
            Self::Sphere(sphere) => sphere.bounds(),
            Self::Disc(disc) => disc.bounds(),
        }
    }

    /// How many primitives hits may name.
    #[must_use]
    pub fn primitive_count(&self) -> usize {
        match self {
            Self::Mesh(mesh) => mesh.triangles().len(),
            Self::Sphere(_) | Self::Disc(_) => 1,
        }
    }
}

/// A shape in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Which shape.
    pub shape: ShapeId,
    /// Where; absent where the shape is given in world coordinates, which costs a backend no instance.
    pub transform: Option<Transform>,
}

/// Shapes, and where they are placed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct World {
    /// The shapes, named by [`ShapeId`].
    pub shapes: Vec<Shape>,
    /// The placements, named by [`PlacementId`].
    pub placements: Vec<Placement>,
}

impl World {
    /// Adds a shape.
    ///
    /// # Panics
    /// Beyond 2^32 shapes.
    pub fn add_shape(&mut self, shape: Shape) -> ShapeId {
        let id = u32::try_from(self.shapes.len()).expect("fewer than 2^32 shapes");
        self.shapes.push(shape);
        ShapeId(id)
    }

    /// Places a shape.
    ///
    /// # Panics
    /// Beyond 2^32 placements.
    pub fn place(&mut self, shape: ShapeId, transform: Option<Transform>) -> PlacementId {
        let id = u32::try_from(self.placements.len()).expect("fewer than 2^32 placements");
        self.placements.push(Placement { shape, transform: transform.filter(|t| !t.is_identity()) });
        PlacementId(id)
    }

    /// The shape of a placement.
    #[must_use]
    pub fn shape_of(&self, placement: PlacementId) -> &Shape {
        &self.shapes[self.placements[placement.index()].shape.index()]
    }

    /// A box around everything.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.placements.iter().fold(Aabb::EMPTY, |all, placement| {
            let own = self.shapes[placement.shape.index()].bounds();
            all.union(placement.transform.map_or(own, |t| t.aabb(own)))
        })
    }

    /// How many primitives there are, each instance counted.
    #[must_use]
    pub fn primitive_count(&self) -> usize {
        self.placements.iter().map(|placement| self.shapes[placement.shape.index()].primitive_count()).sum()
    }
}
