//! From where the scene is seen.

use super::Located;
use crate::scene::load::check;
use crate::scene::record::{record, tagged};
use glam::{DVec3, Vec3};

tagged! {
    /// From where and how the scene is seen.
    pub enum Camera by tag_or("perspective") checked by check::camera {
        /// A pinhole, or a thin lens in its place.
        "perspective" => Perspective {
            /// Where the camera stands.
            from: DVec3 = DVec3::new(0.0, 1.6, 4.6), unit("m");
            /// The point in the middle of the picture.
            at: DVec3 = DVec3::new(0.0, 0.35, 0.0), unit("m");
            /// The direction that points up in the picture; any length, not along the view.
            up: Vec3 = Vec3::Y, nonzero();
            /// Angle of view from the bottom to the top of the picture.
            vfov_deg: f32 = 50.0, unit("degrees"), above(0.0), below(180.0);
            /// Radius of the lens, that is focal length / (2 f-number); 0 is a pinhole, with everything sharp.
            lens_radius: f32 = 0.0, unit("m"), min(0.0);
            /// How far away the plane in focus is, along the view; absent: the plane through `at`.
            focus_distance: Option<f32>, unit("m"), above(0.0);
            /// Corners of the iris, which lie on the circle of `lens_radius`; 0 for a round one, else 3 or more.
            blades: u32 = 0, min(0.0), max(1000.0);
            /// Turns the iris, counter-clockwise seen from behind the camera; at 0 one of its corners is on top.
            blade_rotation_deg: f32 = 0.0, unit("degrees");
            /// When the shutter opens: what moves is seen where it is from then on.
            shutter_open_s: f64 = 0.0, unit("s");
            /// When the shutter closes; at the moment it opens, nothing is blurred.
            shutter_close_s: f64 = 0.0, unit("s");
            /// Frames of a sequence in a second: for frame F the shutter opens and closes F / `fps` later.
            fps: f64 = 24.0, unit("1/s"), above(0.0);
            /// Views at two or more moments, in the order of time: between them the camera moves on straight lines and turns
            /// on the shorter way, before the first and after the last it stands still.
            keys: Vec<Located<CameraKey>> = vec![];
        }
    }
}

impl Camera {
    /// When a frame of a sequence begins, in seconds.
    #[must_use]
    pub fn frame_s(&self, frame: i32) -> f64 {
        let Self::Perspective { fps, .. } = self;
        f64::from(frame) / fps
    }

    /// The same camera with the shutter open as late as for a frame of a sequence.
    #[must_use]
    pub fn at_frame(mut self, frame: i32) -> Self {
        let later = self.frame_s(frame);
        let Self::Perspective { shutter_open_s, shutter_close_s, .. } = &mut self;
        *shutter_open_s += later;
        *shutter_close_s += later;
        self
    }
}

record! {
    /// How a moving camera sees the scene at one moment.
    pub struct CameraKey {
        /// When.
        time_s: f64, unit("s");
        /// Where the camera stands; absent: the camera's own `from`.
        from: Option<DVec3>, unit("m");
        /// The point in the middle of the picture; absent: the camera's own `at`.
        at: Option<DVec3>, unit("m");
        /// The direction that points up in the picture; absent: the camera's own `up`.
        up: Option<Vec3>, nonzero();
        /// Angle of view from the bottom to the top of the picture; absent: the camera's own.
        vfov_deg: Option<f32>, unit("degrees"), above(0.0), below(180.0);
        /// How far away the plane in focus is, along the view; absent: the camera's own, or the plane through this key's `at`.
        focus_distance: Option<f32>, unit("m"), above(0.0);
    }
}
