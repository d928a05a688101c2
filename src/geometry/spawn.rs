//! Where a ray that leaves a surface starts.
//!
//! The origin is moved off the surface by the bound on the error of the point, not by a global epsilon (Pharr, Jakob,
//! Humphreys 2023, Physically Based Rendering, section 6.8.7). Too small a bound lets a ray hit the surface it leaves;
//! too large a one leaks light through thin walls.

use crate::geometry::Ray;
use crate::math::Vec3;
use crate::math::lanes::{Lanes, Wrapping};

/// A point on the side of the surface that `d` leaves to, outside the box of half width `p_error` about `p`.
#[inline(always)]
pub fn origin<F: Lanes>(p: Vec3<F>, p_error: Vec3<F>, ng: Vec3<F>, d: Vec3<F>) -> Vec3<F> {
    let distance = ng.abs().dot(p_error);
    let offset = ng * F::select(d.dot(ng).lt(0.0), -distance, distance);
    let moved = p + offset;
    Vec3::new(round_away(moved.x, offset.x), round_away(moved.y, offset.y), round_away(moved.z, offset.z))
}

/// The ray from a surface point along `d`.
#[must_use]
pub fn ray(p: glam::Vec3, p_error: glam::Vec3, ng: glam::Vec3, d: glam::Vec3) -> Ray {
    let o = origin::<f32>(p.into(), p_error.into(), ng.into(), d.into());
    Ray::new(o.into(), d)
}

/// How much of the way to a target a shadow ray covers: the rest is left to the error of the target's position.
/// Larger lets the target shadow itself; smaller misses occluders that touch the light.
pub const SHADOW_REACH: f32 = 1.0 - 1e-4;

/// The next number after `x` in the direction of `offset`; `x` itself where that is zero.
#[inline(always)]
fn round_away<F: Lanes>(x: F, offset: F) -> F {
    let (up, down) = (offset.gt(0.0), offset.lt(0.0));
    let (above, below) = (x.gt(0.0), x.lt(0.0));
    let bits = x.to_bits();
    let larger = F::from_bits(Wrapping::<u32>::wrapping_add(bits, 1));
    let smaller = F::from_bits(Wrapping::<u32>::wrapping_sub(bits, 1));
    let least = x.splat(f32::from_bits(1)).copysign(offset);
    let away = F::select((above & up) | (below & down), larger, smaller);
    F::select(above | below, F::select(up | down, away, x), F::select(up | down, least, x))
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "neighbouring numbers")]
mod tests {
    use super::*;

    #[test]
    fn numbers_move_by_one_step() {
        for x in [1.0_f32, -1.0, 0.0, -0.0, 1e-45, -1e-45, 1e30, -1e30, f32::MIN_POSITIVE] {
            assert_eq!(round_away(x, 1.0), x.next_up(), "{x} up");
            assert_eq!(round_away(x, -1e-30), x.next_down(), "{x} down");
            assert_eq!(round_away(x, 0.0), x, "{x} stays");
        }
    }
}
