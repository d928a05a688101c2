//! Rays, hits and shapes.
//!
//! A [`World`] is what can be hit: shapes, and where they are placed. It knows neither materials nor lights; those are
//! attached to placements by the scene.

mod axial;
mod disc;
mod frustum;
mod height_field;
mod hit;
mod ids;
mod interaction;
mod mesh;
mod points;
mod pose;
mod ray;
mod shape;
pub mod spawn;
mod sphere;
mod surface;
mod tangent;
mod torus;
mod triangle;
mod world;

pub use disc::Disc;
pub use frustum::Frustum;
pub use height_field::{HeightField, HeightFieldError};
pub use hit::Hit;
pub use ids::{PlacementId, ShapeId};
pub use interaction::Interaction;
pub use mesh::{Mesh, MeshError};
pub use points::Points;
pub use pose::Pose;
pub use ray::Ray;
pub use shape::Shape;
pub use sphere::Sphere;
pub use surface::{HitFilter, ShapeHit, Surface, SurfacePoint};
pub use tangent::Grain;
pub use torus::Torus;
pub use triangle::intersect_triangle;
pub use world::{Placement, World};

/// A number of things as an identifier counts them.
///
/// # Panics
/// Beyond 2^32 of them.
fn count(len: usize) -> u32 {
    u32::try_from(len).expect("fewer than 2^32 of a kind")
}
