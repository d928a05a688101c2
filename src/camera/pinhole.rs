//! A camera that stands still, with everything sharp unless there is a lens in place of its hole.

use crate::camera::Viewpoint;
use crate::math::Vec3;
use crate::math::lanes::Lanes;
use glam::Vec3 as Point;

/// A pinhole: everything is sharp. It knows the plane that a [`super::Lens`] in its place has in focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole<F = f32> {
    /// Where it stands.
    pub(super) eye: Vec3<F>,
    /// To the middle of the film at unit distance.
    pub(super) forward: Vec3<F>,
    /// Per pixel to the right.
    pub(super) right: Vec3<F>,
    /// Per pixel downwards.
    pub(super) down: Vec3<F>,
    /// The middle of the film in pixels.
    pub(super) middle: [f32; 2],
    /// How far the plane in focus is along the view.
    pub(super) focus: F,
}

impl Pinhole {
    /// A camera at `eye` looking at `at`, with `vfov` radians between the bottom and the top of a film of
    /// `width` x `height` pixels. `up` must not be parallel to the view. In focus is the plane through `at`.
    #[must_use]
    pub fn new([eye, at, up]: [Point; 3], vfov: f32, size: [u32; 2]) -> Self {
        let forward = (at - eye).normalize();
        let right = forward.cross(up).normalize();
        let focus = (at - eye).length();
        Self::with_axes(eye, [right, right.cross(forward), forward], (vfov, focus), size)
    }

    /// A camera with a viewpoint.
    #[must_use]
    pub fn at(viewpoint: &Viewpoint, size: [u32; 2]) -> Self {
        let &Viewpoint { eye, rotation, vfov, focus } = viewpoint;
        let axes = [Point::X, Point::Y, -Point::Z].map(|axis| rotation * axis);
        Self::with_axes(eye, axes, (vfov, focus), size)
    }

    fn with_axes(
        eye: Point,
        [right, up, forward]: [Point; 3],
        (vfov, focus): (f32, f32),
        [width, height]: [u32; 2],
    ) -> Self {
        let [width, height] = [width, height].map(|n| n as f32);
        let pixel = 2.0 * (vfov * 0.5).tan() / height;
        let middle = [width * 0.5, height * 0.5];
        let [right, down] = [(right * pixel).into(), (-up * pixel).into()];
        Self { eye: eye.into(), forward: forward.into(), right, down, middle, focus }
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

    /// The same camera in all lanes.
    #[inline(always)]
    pub(super) fn spread<F: Lanes>(&self, like: F) -> Pinhole<F> {
        Pinhole {
            eye: Vec3::splat(like, self.eye),
            forward: Vec3::splat(like, self.forward),
            right: Vec3::splat(like, self.right),
            down: Vec3::splat(like, self.down),
            middle: self.middle,
            focus: like.splat(self.focus),
        }
    }
}

impl<F: Lanes> Pinhole<F> {
    /// From the eye to a film point in pixels, with the film one metre away along the view.
    #[inline(always)]
    pub(super) fn towards(&self, [x, y]: [F; 2]) -> Vec3<F> {
        self.forward + self.right * (x - self.middle[0]) + self.down * (y - self.middle[1])
    }

    /// A vector across the view, from its parts to the right and upwards in metres.
    #[inline(always)]
    pub(super) fn across(&self, [x, y]: [F; 2]) -> Vec3<F> {
        self.right.normalize() * x - self.down.normalize() * y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corners_span_the_field_of_view() {
        let camera = Pinhole::new([Point::ZERO, -Point::Z, Point::Y], 1.0, [200, 100]);
        let towards = |film| Point::from(camera.towards(film)).normalize();
        let [up, down] = [towards([100.0, 0.0]), towards([100.0, 100.0])];
        assert!((up.angle_between(down) - 1.0).abs() < 1e-5, "vertical field of view");
        assert!(up.y > 0.0 && towards([200.0, 50.0]).x > 0.0, "row 0 is the top, +X is right");
        assert!(towards([100.0, 50.0]).abs_diff_eq(-Point::Z, 1e-7), "middle");
    }
}
