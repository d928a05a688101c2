//! A camera that stands still, with everything sharp unless there is a lens in place of its hole.

use crate::camera::Viewpoint;
use crate::geometry::Ray;
use glam::{Vec2, Vec3};

/// A pinhole: everything is sharp. It knows the plane that a [`super::Lens`] in its place has in focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole {
    eye: Vec3,
    /// To the middle of the film at unit distance.
    forward: Vec3,
    /// Per pixel to the right.
    right: Vec3,
    /// Per pixel downwards.
    down: Vec3,
    /// The middle of the film in pixels.
    middle: [f32; 2],
    /// How far the plane in focus is along the view.
    focus: f32,
}

impl Pinhole {
    /// A camera at `eye` looking at `at`, with `vfov` radians between the bottom and the top of a film of
    /// `width` x `height` pixels. `up` must not be parallel to the view. In focus is the plane through `at`.
    #[must_use]
    pub fn new([eye, at, up]: [Vec3; 3], vfov: f32, [width, height]: [u32; 2]) -> Self {
        let focus = (at - eye).length();
        let forward = (at - eye).normalize();
        let right = forward.cross(up).normalize();
        let up = right.cross(forward);
        let [width, height] = [width, height].map(|n| n as f32);
        let pixel = 2.0 * (vfov * 0.5).tan() / height;
        let middle = [width * 0.5, height * 0.5];
        Self { eye, forward, right: right * pixel, down: -up * pixel, middle, focus }
    }

    /// A camera with a viewpoint.
    #[must_use]
    pub fn at(viewpoint: &Viewpoint, [width, height]: [u32; 2]) -> Self {
        let [right, up, back] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| viewpoint.rotation * axis);
        let [width, height] = [width, height].map(|n| n as f32);
        let pixel = 2.0 * (viewpoint.vfov * 0.5).tan() / height;
        let middle = [width * 0.5, height * 0.5];
        let (eye, focus) = (viewpoint.eye, viewpoint.focus);
        Self { eye, forward: -back, right: right * pixel, down: -up * pixel, middle, focus }
    }

    /// The ray through a film point in pixels, from the upper left corner; its direction is a unit vector.
    #[must_use]
    pub fn ray(&self, film: [f32; 2]) -> Ray {
        Ray::new(self.eye, self.towards(film).normalize())
    }

    /// The same camera with another plane in focus, `distance` metres away along the view.
    #[must_use]
    pub fn focused(self, distance: f32) -> Self {
        Self { focus: distance, ..self }
    }

    /// How far away the plane in focus is, in metres along the view.
    #[must_use]
    pub fn focus(&self) -> f32 {
        self.focus
    }

    /// From the eye to a film point in pixels, with the film one metre away along the view.
    pub(super) fn towards(&self, [x, y]: [f32; 2]) -> Vec3 {
        self.forward + self.right * (x - self.middle[0]) + self.down * (y - self.middle[1])
    }

    /// A vector across the view, from its parts to the right and upwards in metres.
    pub(super) fn across(&self, offset: Vec2) -> Vec3 {
        self.right.normalize() * offset.x - self.down.normalize() * offset.y
    }

    /// Where the camera stands.
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        self.eye
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corners_span_the_field_of_view() {
        let camera = Pinhole::new([Vec3::ZERO, -Vec3::Z, Vec3::Y], 1.0, [200, 100]);
        let up = camera.ray([100.0, 0.0]).d;
        let down = camera.ray([100.0, 100.0]).d;
        assert!((up.angle_between(down) - 1.0).abs() < 1e-5, "vertical field of view");
        assert!(up.y > 0.0 && camera.ray([200.0, 50.0]).d.x > 0.0, "row 0 is the top, +X is right");
        assert!(camera.ray([100.0, 50.0]).d.abs_diff_eq(-Vec3::Z, 1e-7), "middle");
    }
}
