//! Affine maps taken apart, so that the way from one to another can be told. Double precision: it is done while scenes are
//! built, and what is put together again shall be what was taken apart.

use glam::{DAffine3, DMat3, DQuat, DVec3};

/// An affine map as a symmetric stretch, perhaps a mirroring at the origin, a rotation and a translation, in this order: the
/// polar decomposition, whose rotation is the nearest one to the map (Shoemake and Duff 1992, Matrix Animation and Polar
/// Decomposition).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polar {
    stretch: DMat3,
    mirrored: bool,
    rotation: DQuat,
    translation: DVec3,
}

/// Steps after which the iteration has met any matrix that can be inverted; ten are usual.
const MOST_STEPS: usize = 100;

impl Polar {
    /// The parts of a map; `None` where it has no finite inverse.
    #[must_use]
    pub fn new(map: &DAffine3) -> Option<Self> {
        let m = map.matrix3;
        let mirrored = m.determinant() < 0.0;
        let rotation = orthogonal(if mirrored { -m } else { m })?;
        let stretch = rotation.transpose() * if mirrored { -m } else { m };
        let stretch = (stretch + stretch.transpose()) * 0.5;
        let rotation = DQuat::from_mat3(&rotation).normalize();
        map.translation.is_finite().then_some(Self {
            stretch,
            mirrored,
            rotation,
            translation: map.translation,
        })
    }

    /// Whether the map turns right hands into left ones.
    #[must_use]
    pub fn is_mirrored(&self) -> bool {
        self.mirrored
    }

    /// The angle in radians, from 0 to pi, by which this map and another are turned against each other.
    #[must_use]
    pub fn angle(&self, other: &Self) -> f64 {
        self.rotation.angle_between(other.rotation)
    }

    /// The map at a part, from 0 to 1, of the way to another of the same handedness: rotations on the shorter arc at constant
    /// speed, stretch and translation linearly. It can be inverted at every moment, as sums of positive stretches are positive.
    #[must_use]
    pub fn between(&self, other: &Self, part: f64) -> DAffine3 {
        let rotation = self.rotation.slerp(other.rotation, part);
        let stretch = self.stretch + (other.stretch - self.stretch) * part;
        let sign = if self.mirrored { -1.0 } else { 1.0 };
        DAffine3 {
            matrix3: DMat3::from_quat(rotation) * (stretch * sign),
            translation: self.translation + (other.translation - self.translation) * part,
        }
    }
}

/// The orthogonal factor of a matrix: Newton's iteration with Higham's scaling (Higham 1986, Computing the Polar
/// Decomposition, section 3), which converges quadratically.
fn orthogonal(m: DMat3) -> Option<DMat3> {
    let norm = |m: &DMat3| m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut q = m * (1.0 / norm(&m));
    for _ in 0..MOST_STEPS {
        let inverse = q.inverse().transpose();
        if !inverse.is_finite() {
            return None;
        }
        let scale = (norm(&inverse) / norm(&q)).sqrt();
        let next = (q * scale + inverse * (1.0 / scale)) * 0.5;
        let change = norm(&(next - q));
        q = next;
        if change < 1e-14 {
            return Some(q);
        }
    }
    q.is_finite().then_some(q)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn skewed(mirror: f64) -> DAffine3 {
        let turn = DQuat::from_rotation_x(0.7) * DQuat::from_rotation_z(-1.1);
        let linear = DMat3::from_quat(turn)
            * DMat3::from_diagonal(DVec3::new(mirror * 2.0, 0.01, 30.0))
            * DMat3::from_rotation_y(2.0);
        DAffine3 { matrix3: linear, translation: DVec3::new(1.0, -2.0, 3.0) }
    }

    #[test]
    fn a_map_is_put_together_again() {
        for mirror in [1.0, -1.0] {
            let map = skewed(mirror);
            let polar = Polar::new(&map).expect("invertible");
            assert_eq!(polar.is_mirrored(), mirror < 0.0, "handedness");
            assert!(polar.between(&polar, 0.3).abs_diff_eq(map, 1e-11), "{map:?} became another");
        }
        let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
        assert!(Polar::new(&flat).is_none(), "flat");
        assert!(Polar::new(&DAffine3::from_scale(DVec3::NAN)).is_none(), "not a number");
    }

    #[test]
    fn halfway_is_half_the_turn_and_the_mean_size() {
        let at = |angle: f64, size: f64| {
            DAffine3::from_scale_rotation_translation(
                DVec3::splat(size),
                DQuat::from_rotation_y(angle),
                DVec3::X * angle,
            )
        };
        let [a, b] = [at(0.2, 1.0), at(2.2, 3.0)].map(|map| Polar::new(&map).expect("invertible"));
        assert!((a.angle(&b) - 2.0).abs() < 1e-12, "angle");
        assert!(a.between(&b, 0.5).abs_diff_eq(at(1.2, 2.0), 1e-12), "half-way");
    }
}
