//! Affine maps that change while the shutter is open.

use crate::math::{Aabb, Transform};
use glam::{Affine3A, Mat3A};
use std::sync::Arc;

/// Affine maps at equal steps from the opening of the shutter (0) to its closing (1); in between, every element of the
/// matrix is interpolated linearly, as hierarchies over moving things assume.
///
/// A turn by angle `a` between two neighbouring keys shrinks the shape by `1 - cos(a/2)` half-way: give turns more keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    keys: Arc<[Affine3A]>,
}

/// As many keys as Embree takes.
pub const MOST_KEYS: usize = 129;

impl Motion {
    /// The motion through `keys`, from 2 to [`MOST_KEYS`]. `None` if their number is another or if the map
    /// cannot be inverted at some moment, as where it mirrors at one key and does not at the next.
    #[must_use]
    pub fn new(keys: &[Affine3A]) -> Option<Self> {
        if !(2..=MOST_KEYS).contains(&keys.len()) {
            return None;
        }
        let motion = Self { keys: keys.into() };
        let invertible = keys.windows(2).all(|pair| stays_invertible(&pair[0], &pair[1]));
        (invertible && keys.iter().all(|key| Transform::new(*key).is_some())).then_some(motion)
    }

    /// The keys.
    #[must_use]
    pub fn keys(&self) -> &[Affine3A] {
        &self.keys
    }

    /// The map at a moment of the shutter; outside of [0, 1] that of the nearer end.
    #[must_use]
    pub fn at(&self, time: f32) -> Transform {
        let (first, part) = step(time, self.keys.len());
        let (a, b) = (&self.keys[first], &self.keys[first + 1]);
        // Invertible at every moment, as was checked; at worst by rounding, the nearer key stands in.
        Transform::new(between(a, b, part)).or_else(|| Transform::new(*a)).unwrap_or(Transform::IDENTITY)
    }

    /// A box around the images of a box at all moments.
    #[must_use]
    pub fn aabb(&self, aabb: Aabb) -> Aabb {
        // A point moves on a straight line from key to key.
        self.keys
            .iter()
            .filter_map(|key| Transform::new(*key))
            .fold(Aabb::EMPTY, |all, t| all.union(t.aabb(aabb)))
    }
}

/// The step of a row of `count` keys at equal distances that holds a moment in [0, 1], and the part of it that has passed.
#[must_use]
pub fn step(time: f32, count: usize) -> (usize, f32) {
    let last = count.saturating_sub(2);
    #[expect(clippy::cast_precision_loss, reason = "few keys")]
    let at = time.clamp(0.0, 1.0) * (count.max(2) - 1) as f32;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "not negative; NaN becomes 0"
    )]
    let first = (at as usize).min(last);
    #[expect(clippy::cast_precision_loss, reason = "few keys")]
    let part = at - first as f32;
    (first, if part.is_nan() { 0.0 } else { part })
}

fn between(a: &Affine3A, b: &Affine3A, part: f32) -> Affine3A {
    let (m, n) = (&a.matrix3, &b.matrix3);
    let mix = |p: glam::Vec3A, q: glam::Vec3A| p * (1.0 - part) + q * part;
    Affine3A {
        matrix3: Mat3A::from_cols(mix(m.x_axis, n.x_axis), mix(m.y_axis, n.y_axis), mix(m.z_axis, n.z_axis)),
        translation: mix(a.translation, b.translation),
    }
}

/// Whether the determinant keeps its sign all the way. It is a cubic in the part of the way, which is bounded below by its
/// Bernstein coefficients on pieces short enough.
fn stays_invertible(a: &Affine3A, b: &Affine3A) -> bool {
    const PIECES: u16 = 16;
    let determinant = |part: f32| f64::from(between(a, b, part).matrix3.determinant());
    let sign = determinant(0.0).signum();
    (0..PIECES).all(|i| {
        let at = |third: f32| sign * determinant((f32::from(i) + third / 3.0) / f32::from(PIECES));
        let [d0, d1, d2, d3] = [at(0.0), at(1.0), at(2.0), at(3.0)];
        // The inner Bernstein coefficients of the cubic through four equidistant values.
        let b1 = (-5.0 * d0 + 18.0 * d1 - 9.0 * d2 + 2.0 * d3) / 6.0;
        let b2 = (2.0 * d0 - 9.0 * d1 + 18.0 * d2 - 5.0 * d3) / 6.0;
        [d0, b1, b2, d3].into_iter().all(|coefficient| coefficient > 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn moments_fall_between_the_right_keys() {
        let keys = [0.0, 2.0, 3.0].map(|x| Affine3A::from_translation(Vec3::X * x));
        let motion = Motion::new(&keys).expect("invertible");
        for (time, x) in
            [(0.0, 0.0), (0.25, 1.0), (0.5, 2.0), (0.75, 2.5), (1.0, 3.0), (-1.0, 0.0), (9.0, 3.0)]
        {
            let p = motion.at(time).point(Vec3::ZERO);
            assert!(p.abs_diff_eq(Vec3::X * x, 1e-6), "{p} at {time}");
        }
        assert!(motion.at(f32::NAN).point(Vec3::ZERO).is_finite(), "a moment that is not a number");
    }

    #[test]
    fn motions_through_a_flat_moment_are_refused() {
        let turn = |angle: f32| Affine3A::from_rotation_z(angle);
        let half = std::f32::consts::PI;
        assert!(Motion::new(&[turn(0.0), turn(half)]).is_none(), "half a turn passes through nothing");
        assert!(
            Motion::new(&[turn(0.0), turn(half * 0.5), turn(half)]).is_some(),
            "in two steps it does not"
        );
        let mirror = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
        assert!(Motion::new(&[turn(0.0), mirror]).is_none(), "mirrored on the way");
        assert!(Motion::new(&[turn(0.0)]).is_none(), "one key is no motion");
    }
}
