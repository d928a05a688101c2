//! Where a ray that leaves a surface starts.
//!
//! The origin is moved off the surface by the bound on the error of the point, not by a global epsilon (Pharr, Jakob,
//! Humphreys 2023, Physically Based Rendering, section 6.8.7). Too small a bound lets a ray hit the surface it leaves;
//! too large a one leaks light through thin walls.

use crate::geometry::Ray;
use glam::Vec3;

/// A point on the side of the surface that `d` leaves to, outside the box of half width `p_error` about `p`.
#[must_use]
pub fn origin(p: Vec3, p_error: Vec3, ng: Vec3, d: Vec3) -> Vec3 {
    let distance = ng.abs().dot(p_error);
    let offset = if d.dot(ng) < 0.0 { -ng * distance } else { ng * distance };
    let moved = p + offset;
    Vec3::new(round_away(moved.x, offset.x), round_away(moved.y, offset.y), round_away(moved.z, offset.z))
}

/// The ray from a surface point along `d`.
#[must_use]
pub fn ray(p: Vec3, p_error: Vec3, ng: Vec3, d: Vec3) -> Ray {
    Ray::new(origin(p, p_error, ng, d), d)
}

/// How much of the way to a target a shadow ray covers: the rest is left to the error of the target's position.
/// Larger lets the target shadow itself; smaller misses occluders that touch the light.
pub const SHADOW_REACH: f32 = 1.0 - 1e-4;

fn round_away(x: f32, offset: f32) -> f32 {
    if offset > 0.0 {
        x.next_up()
    } else if offset < 0.0 {
        x.next_down()
    } else {
        x
    }
}
