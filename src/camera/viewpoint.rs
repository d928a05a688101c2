//! How a camera stands in the world, in a form that goes from one to another.

use glam::{Mat3, Quat, Vec3};

/// Place, direction, angle of view, and the plane in focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Where the camera stands.
    pub eye: Vec3,
    /// From camera to world; the camera looks along -Z, with +X to the right and +Y up.
    pub rotation: Quat,
    /// The angle of view from the bottom to the top of the film, in radians.
    pub vfov: f32,
    /// How far away the plane in focus is along the view, in metres; without a lens it means nothing.
    pub focus: f32,
}

impl Viewpoint {
    /// At `eye`, looking at `at`, which is in focus; `up` must not be parallel to the view. `vfov` in radians.
    #[must_use]
    pub fn new([eye, at, up]: [Vec3; 3], vfov: f32) -> Self {
        let back = (eye - at).normalize();
        let right = up.cross(back).normalize();
        let rotation = Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back)).normalize();
        Self { eye, rotation, vfov, focus: (at - eye).length() }
    }

    /// At a part, from 0 to 1, of the way to another: places, angles of view and focus linearly, directions on the shorter arc
    /// at constant speed (Shoemake 1985, Animating Rotation with Quaternion Curves).
    #[must_use]
    pub fn between(&self, other: &Self, part: f32) -> Self {
        // What does not change keeps its bits.
        let turns = self.rotation != other.rotation;
        Self {
            eye: self.eye + (other.eye - self.eye) * part,
            rotation: if turns { self.rotation.slerp(other.rotation, part) } else { self.rotation },
            vfov: self.vfov + (other.vfov - self.vfov) * part,
            focus: self.focus + (other.focus - self.focus) * part,
        }
    }
}
