//! Numbers, vectors over lanes, frames and transforms.

pub mod aabb;
pub mod float;
pub mod lanes;
pub mod transform;

pub use aabb::Aabb;
pub use transform::Transform;
