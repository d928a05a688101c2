//! Axis-aligned boxes.

use glam::Vec3;

/// An axis-aligned box; empty when a lower corner exceeds the upper one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower corner.
    pub min: Vec3,
    /// Upper corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box without points, neutral under [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around `points`.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// The smallest box around this one and `point`.
    #[must_use]
    pub fn with(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether no point lies inside.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// The midpoint; meaningless for an empty box.
    #[must_use]
    pub fn center(self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Edge lengths, zero for an empty box.
    #[must_use]
    pub fn size(self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }

    /// Radius of the sphere about the centre that holds the box, zero for an empty box.
    #[must_use]
    pub fn radius(self) -> f32 {
        self.size().length() * 0.5
    }

    /// The eight corners.
    #[must_use]
    pub fn corners(self) -> [Vec3; 8] {
        let [a, b] = [self.min, self.max];
        [
            Vec3::new(a.x, a.y, a.z),
            Vec3::new(b.x, a.y, a.z),
            Vec3::new(a.x, b.y, a.z),
            Vec3::new(b.x, b.y, a.z),
            Vec3::new(a.x, a.y, b.z),
            Vec3::new(b.x, a.y, b.z),
            Vec3::new(a.x, b.y, b.z),
            Vec3::new(b.x, b.y, b.z),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_is_the_hull_of_its_corners() {
        let aabb = Aabb { min: Vec3::new(-1.0, 2.0, 3.0), max: Vec3::new(0.5, 4.0, 8.0) };
        assert_eq!(Aabb::around(aabb.corners()), aabb, "corners lost the box");
        assert_eq!(aabb.union(Aabb::EMPTY), aabb, "empty is not neutral");
        assert!(Aabb::EMPTY.is_empty() && !aabb.is_empty(), "emptiness");
    }
}
