//! Rays.

use crate::geometry::spawn;
use crate::math::Transform;
use glam::Vec3;

/// The points `o + t d` with `t_min <= t <= t_max`, at one moment of the shutter.
///
/// The layout is that of Embree's single ray, 48 bytes aligned to 16, so that a query copies it in three vector moves.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Origin.
    pub o: Vec3,
    /// Nearest parameter that counts; not negative.
    pub t_min: f32,
    /// Direction, of any length but zero; parameters count in its lengths.
    pub d: Vec3,
    /// Moment within the shutter, in [0, 1].
    pub time: f32,
    /// Farthest parameter that counts.
    pub t_max: f32,
    /// Which geometry the ray can see: that whose mask shares a bit.
    pub mask: u32,
    id: u32,
    flags: u32,
}

impl Ray {
    /// The ray from `o` along `d` without end, at the opening of the shutter, that sees everything.
    #[must_use]
    pub fn new(o: Vec3, d: Vec3) -> Self {
        Self { o, t_min: 0.0, d, time: 0.0, t_max: f32::INFINITY, mask: u32::MAX, id: 0, flags: 0 }
    }

    /// The same ray, ending at `t_max`.
    #[must_use]
    pub fn until(self, t_max: f32) -> Self {
        Self { t_max, ..self }
    }

    /// The same ray, of which nothing counts before `t_min`.
    #[must_use]
    pub fn starting(self, t_min: f32) -> Self {
        Self { t_min, ..self }
    }

    /// The same ray, to which only geometry is visible whose mask shares a bit.
    #[must_use]
    pub fn seeing(self, mask: u32) -> Self {
        Self { mask, ..self }
    }

    /// The ray from the same origin at the same moment that ends just before a point; parameters count from 0 to 1 at the point.
    #[must_use]
    pub fn towards(self, target: Vec3) -> Self {
        Self { d: target - self.o, ..self }.until(spawn::SHADOW_REACH)
    }

    /// The same ray at another moment, in [0, 1].
    #[must_use]
    pub fn at_time(self, time: f32) -> Self {
        Self { time, ..self }
    }

    /// The point at parameter `t`.
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.o + self.d * t
    }

    /// The same ray in the space that `map` leads from; parameters stay as they are.
    #[must_use]
    pub fn into_object(&self, map: &Transform) -> Self {
        Self { o: map.inverse_point(self.o), d: map.inverse_vector(self.d), ..*self }
    }

    /// Whether the ray can be traced: finite origin, finite direction of some length, a range that is not empty.
    /// A query answers "nothing hit" for all others.
    #[must_use]
    pub fn is_traceable(&self) -> bool {
        self.o.is_finite() && self.d.is_finite() && self.d != Vec3::ZERO && self.t_min <= self.t_max
    }
}
