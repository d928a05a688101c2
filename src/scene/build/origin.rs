//! Where the scene is counted from.
//!
//! Places are double precision in scene files and single precision in a frozen scene. Where the camera stands far from the
//! origin, beside what it looks at, everything is counted from a point near it before it is rounded: shapes are made about
//! their own middle and carried from there, in double precision, to where the camera sees them.

use crate::math::recentre;
use crate::scene::description::Camera;
use glam::{DVec3, Vec3};

/// What is taken from all places of a scene; zero where single precision knows them well enough without.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Origin(pub(super) DVec3);

impl Origin {
    /// Near the camera if it is far from the origin beside its distance from what it looks at.
    pub(super) fn of(camera: &Camera) -> Self {
        let Camera::Perspective { from, at, keys, .. } = camera;
        let first = keys.first();
        let from = first.and_then(|key| key.from).unwrap_or(*from);
        let at = first.and_then(|key| key.at).unwrap_or(*at);
        Self(recentre::if_far(from, from.distance(at)))
    }

    /// Whether anything is moved.
    pub(super) fn is_moved(self) -> bool {
        self.0 != DVec3::ZERO
    }

    /// A place of the scene file in the frozen scene.
    pub(super) fn place(self, p: DVec3) -> Vec3 {
        (p - self.0).as_vec3()
    }

    /// Where a shape about `middle` is made: its coordinates count from there until it is carried to its place.
    pub(super) fn own(self, middle: DVec3) -> DVec3 {
        if self.is_moved() { middle } else { DVec3::ZERO }
    }
}
