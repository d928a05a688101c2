//! From a film point to a ray.

mod moving;
mod pinhole;
mod viewpoint;

pub use moving::MovingPinhole;
pub use pinhole::Pinhole;
pub use viewpoint::Viewpoint;

use crate::geometry::Ray;
use glam::Vec3;

/// Where pictures are taken from.
#[derive(Clone, Debug, PartialEq)]
pub enum Camera {
    /// A pinhole that stays while the shutter is open.
    Still(Pinhole),
    /// A pinhole that moves meanwhile.
    Moving(MovingPinhole),
}

impl Camera {
    /// The ray through a film point in pixels, from the upper left corner, at a moment of the shutter in [0, 1]; its direction
    /// is a unit vector.
    #[must_use]
    pub fn ray(&self, film: [f32; 2], time: f32) -> Ray {
        let ray = match self {
            Self::Still(camera) => camera.ray(film),
            Self::Moving(camera) => camera.at(time).ray(film),
        };
        ray.at_time(time)
    }

    /// Where the camera stands at a moment of the shutter, in [0, 1].
    #[must_use]
    pub fn eye(&self, time: f32) -> Vec3 {
        match self {
            Self::Still(camera) => camera.eye(),
            Self::Moving(camera) => camera.at(time).eye(),
        }
    }

    /// Whether it moves while the shutter is open.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        matches!(self, Self::Moving(_))
    }
}
