//! Rays, hits and shapes.
//!
//! A [`World`] is what can be hit: shapes, and where they are placed. It knows neither materials nor lights; those are
//! attached to placements by the scene.

mod disc;
mod hit;
mod ids;
mod interaction;
mod mesh;
mod ray;
pub mod spawn;
mod sphere;
mod world;

pub use disc::Disc;
pub use hit::Hit;
pub use ids::{PlacementId, ShapeId};
pub use interaction::Interaction;
pub use mesh::{Mesh, MeshError, intersect_triangle};
pub use ray::Ray;
pub use sphere::Sphere;
pub use world::{Placement, Shape, World};
