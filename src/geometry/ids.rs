//! Indices that cannot be mixed up.

/// Which shape of a [`crate::geometry::World`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ShapeId(pub u32);

/// Which placement of a [`crate::geometry::World`]: the identity of whatever a ray hits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PlacementId(pub u32);

impl ShapeId {
    /// The place in the world's list.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl PlacementId {
    /// The place in the world's list.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}
