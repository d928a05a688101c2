//! What a query answers.

use crate::geometry::PlacementId;
use glam::Vec3;

/// Where a ray meets a primitive, as the backend found it; [`crate::geometry::World::interaction`] makes a point to
/// shade of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter.
    pub t: f32,
    /// First surface parameter: the weight of the second vertex of a triangle; zero on spheres and discs.
    pub u: f32,
    /// Second surface parameter: the weight of the third vertex of a triangle; zero on spheres and discs.
    pub v: f32,
    /// Geometric normal in the space of the shape, outward by winding, not normalised.
    pub ng: Vec3,
    /// Which primitive of the shape.
    pub prim: u32,
    /// Which placement.
    pub placement: PlacementId,
}
