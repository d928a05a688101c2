//! Vertices in single precision, counted from where that keeps their form.

use super::About;
use crate::math::recentre;
use glam::{DVec3, Vec3};

/// Where positions are counted from, and the positions from there.
pub(in crate::scene::load) fn positions(
    file: impl Iterator<Item = DVec3> + Clone,
    about: About,
) -> (DVec3, Vec<Vec3>) {
    let far = DVec3::splat(f64::INFINITY);
    let (min, max) = file.clone().fold((far, -far), |(min, max), p| (min.min(p), max.max(p)));
    let (middle, size) = ((min + max) * 0.5, (max - min).max_element());
    let origin = match about {
        About::Middle if size >= 0.0 => recentre::beside(middle, size),
        About::Middle | About::Needed => recentre::if_far(middle, size),
    };
    (origin, file.map(|p| (p - origin).as_vec3()).collect())
}
