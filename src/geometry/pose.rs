//! Where a shape is placed, and how it moves there.

use crate::geometry::Ray;
use crate::math::{Aabb, Motion, Transform, motion};
use glam::Affine3A;
use std::borrow::Cow;

/// How a shape comes to its place in the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Pose {
    /// It is given in world coordinates, which costs a backend no instance.
    #[default]
    World,
    /// By one map at all times.
    Still(Transform),
    /// By a map that changes while the shutter is open.
    Moving(Motion),
}

impl From<Option<Transform>> for Pose {
    fn from(transform: Option<Transform>) -> Self {
        transform.map_or(Self::World, Self::from)
    }
}

impl From<Transform> for Pose {
    fn from(transform: Transform) -> Self {
        if transform.is_identity() { Self::World } else { Self::Still(transform) }
    }
}

impl From<Motion> for Pose {
    fn from(motion: Motion) -> Self {
        // What does not move is cheaper.
        let [first, rest @ ..] = motion.keys() else { return Self::World };
        if rest.iter().all(|key| key == first) { Self::from(motion.at(0.0)) } else { Self::Moving(motion) }
    }
}

impl Pose {
    /// The map at a moment of the shutter, in [0, 1]; none where it moves nothing.
    #[must_use]
    pub fn at(&self, time: f32) -> Option<Cow<'_, Transform>> {
        match self {
            Self::World => None,
            Self::Still(transform) => Some(Cow::Borrowed(transform)),
            Self::Moving(motion) => Some(Cow::Owned(motion.at(time))),
        }
    }

    /// The ray in the space of the shape; parameters stay as they are.
    #[must_use]
    pub fn object_ray(&self, ray: &Ray) -> Ray {
        self.at(ray.time).map_or(*ray, |map| ray.into_object(&map))
    }

    /// A box around what is in `aabb`, at all moments.
    #[must_use]
    pub fn aabb(&self, aabb: Aabb) -> Aabb {
        match self {
            Self::World => aabb,
            Self::Still(transform) => transform.aabb(aabb),
            Self::Moving(motion) => motion.aabb(aabb),
        }
    }

    /// The maps at equal steps from the opening of the shutter to its closing; one where nothing moves.
    #[must_use]
    pub fn keys(&self) -> Cow<'_, [Affine3A]> {
        match self {
            Self::World => Cow::Owned(vec![Affine3A::IDENTITY]),
            Self::Still(transform) => Cow::Owned(vec![*transform.world_from_object()]),
            Self::Moving(motion) => Cow::Borrowed(motion.keys()),
        }
    }

    /// This pose within something that is itself placed by `outer`: an instance within an instance. `None` if single
    /// precision finds no inverse.
    ///
    /// Where both move, the product of two linear ways is not linear: it is followed at eight times as many keys, as far
    /// as [`motion::MOST_KEYS`], which leaves 1/64 of the deviation from a straight way.
    #[must_use]
    pub fn within(&self, outer: &Self) -> Option<Self> {
        const FINER: usize = 8;
        let (own, outer) = match (self, outer) {
            (own, Self::World) => return Some(own.clone()),
            (Self::World, outer) => return Some(outer.clone()),
            (Self::Still(own), Self::Still(outer)) => {
                return Transform::new(*outer.world_from_object() * *own.world_from_object()).map(Self::from);
            }
            (own, outer) => (own, outer),
        };
        let steps = |pose: &Self| pose.keys().len() - 1;
        let product = |at: f32| {
            let [own, outer] =
                [own, outer].map(|pose| pose.at(at).map_or(Affine3A::IDENTITY, |t| *t.world_from_object()));
            outer * own
        };
        let steps = match (steps(own), steps(outer)) {
            (steps, 0) | (0, steps) => steps,
            (a, b) => (least_common_multiple(a, b) * FINER).min(motion::MOST_KEYS - 1),
        };
        #[expect(clippy::cast_precision_loss, reason = "few keys")]
        let keys: Vec<Affine3A> = (0..=steps).map(|i| product(i as f32 / steps as f32)).collect();
        Motion::new(&keys).map(Self::from)
    }
}

fn least_common_multiple(a: usize, b: usize) -> usize {
    let (mut greatest, mut rest) = (a, b);
    while rest != 0 {
        (greatest, rest) = (rest, greatest % rest);
    }
    a / greatest * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn turning(angle: f32) -> Pose {
        let keys = [0.0, 0.5, 1.0].map(|part| Affine3A::from_rotation_y(angle * part));
        Motion::new(&keys).expect("invertible").into()
    }

    fn at(pose: &Pose, time: f32, p: Vec3) -> Vec3 {
        pose.at(time).map_or(p, |t| t.point(p))
    }

    #[test]
    fn a_pose_within_another_is_their_product() {
        let shift = Transform::new(Affine3A::from_translation(Vec3::X * 3.0)).expect("invertible");
        let slide = [Vec3::ZERO, Vec3::Y, Vec3::Z, Vec3::ONE].map(Affine3A::from_translation);
        let slide = Pose::from(Motion::new(&slide).expect("invertible"));
        let poses = [Pose::World, Pose::Still(shift), turning(1.0), slide];
        for (own, outer) in poses.iter().flat_map(|own| poses.iter().map(move |outer| (own, outer))) {
            let both = own.within(outer).expect("invertible");
            let is_exact = !matches!((own, outer), (Pose::Moving(_), Pose::Moving(_)));
            for i in 0..=24_u8 {
                let (time, p) = (f32::from(i) / 24.0, Vec3::new(0.3, -1.0, 2.0));
                let (found, wanted) = (at(&both, time, p), at(outer, time, at(own, time, p)));
                let allowed = if is_exact { 1e-5 } else { 2e-3 };
                assert!(
                    found.abs_diff_eq(wanted, allowed),
                    "{own:?} in {outer:?} at {time}: {found} {wanted}"
                );
            }
        }
    }

    #[test]
    fn what_stands_still_is_told_so() {
        let still = Motion::new(&[Affine3A::from_rotation_x(1.0); 3]).expect("invertible");
        assert!(matches!(Pose::from(still), Pose::Still(_)), "equal keys");
        let nowhere = Motion::new(&[Affine3A::IDENTITY; 2]).expect("invertible");
        assert_eq!(Pose::from(nowhere), Pose::World, "keys that move nothing");
    }
}
