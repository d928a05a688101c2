//! Numbers, vectors over lanes, frames and transforms.

pub mod aabb;
pub mod float;
pub mod frame;
pub mod lanes;
pub mod motion;
pub mod polar;
pub mod recentre;
pub mod rgb;
pub mod roots;
pub mod transform;
pub mod vec3;

pub use aabb::Aabb;
pub use frame::Frame;
pub use motion::Motion;
pub use polar::Polar;
pub use rgb::Rgb;
pub use transform::Transform;
pub use vec3::Vec3;
