//! The fast test of a ray and a triangle.
//!
//! The corners are sheared so that the ray runs along one axis, and three areas say on which side of each edge it passes
//! (Woop, Benthin, Wald 2013, Watertight Ray/Triangle Intersection). Neighbours see a shared edge with the same corners and
//! so with the same area but for its sign: no ray slips between them. Where an area is zero, double precision, in which
//! products are exact, decides. It also says where a triangle is met: areas of long thin ones are differences of large products,
//! and in single precision a ray would meet what it has just left.
//!
//! One row per axis holds that coordinate of all three corners: choosing the axes by the ray is choosing rows, and the
//! three areas are one product of vectors.

use super::frame::Way;
use glam::{DVec3, Vec3, Vec3A, Vec3Swizzles};

/// Corners, a row per axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners([Vec3A; 3]);

/// A ray, as the test wants it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shear {
    /// The axis along which the ray mostly runs comes last.
    axes: [usize; 3],
    /// Where the ray starts, along those axes.
    o: [f32; 3],
    /// How the other two coordinates change with the last.
    slope: [f32; 2],
    /// How the way's parameter changes with the last coordinate.
    advance: f32,
}

/// Where a way meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    /// The way's parameter.
    pub(super) t: f32,
    /// Weight of the second corner.
    pub(super) u: f32,
    /// Weight of the third corner.
    pub(super) v: f32,
}

impl Corners {
    pub(super) fn new([a, b, c]: [Vec3A; 3]) -> Self {
        Self([Vec3A::new(a.x, b.x, c.x), Vec3A::new(a.y, b.y, c.y), Vec3A::new(a.z, b.z, c.z)])
    }

    /// On straight lines from these corners to others.
    #[inline(always)]
    pub(super) fn towards(&self, later: &Self, part: f32) -> Self {
        let mix = |row: usize| self.0[row] * (1.0 - part) + later.0[row] * part;
        Self([mix(0), mix(1), mix(2)])
    }

    /// The cross product of the edges from the first corner to the second and the third.
    pub(super) fn normal(&self) -> Vec3 {
        let corner = |i: usize| Vec3::new(self.0[0][i], self.0[1][i], self.0[2][i]);
        let [a, b, c] = [corner(0), corner(1), corner(2)];
        (b - a).cross(c - a)
    }

    /// Where the way meets the triangle, if it does; both sides count, and so does what lies behind.
    #[inline(always)]
    pub(super) fn meet(&self, ray: &Shear) -> Option<Met> {
        let [ax, ay, az] = ray.axes;
        let z = self.0[az] - ray.o[2];
        let x = self.0[ax] - ray.o[0] - z * ray.slope[0];
        let y = self.0[ay] - ray.o[1] - z * ray.slope[1];
        let areas = x.zxy() * y.yzx() - y.zxy() * x.yzx();
        let (below, above) = (areas.cmplt(Vec3A::ZERO).bitmask(), areas.cmpgt(Vec3A::ZERO).bitmask());
        if below != 0 && above != 0 {
            return None;
        }
        let areas = exact(x, y);
        if below | above != 7 && areas.cmplt(DVec3::ZERO).any() && areas.cmpgt(DVec3::ZERO).any() {
            return None;
        }
        let total = areas.element_sum();
        if total == 0.0 {
            return None;
        }
        let weights = areas / total;
        #[expect(clippy::cast_possible_truncation, reason = "computed in double precision, told in single")]
        let [z, u, v] =
            [weights.dot(Vec3::from(z).as_dvec3()), weights.y, weights.z].map(|value| value as f32);
        Some(Met { t: z * ray.advance, u, v })
    }
}

/// The areas without cancellation.
fn exact(x: Vec3A, y: Vec3A) -> DVec3 {
    let (x, y) = (Vec3::from(x).as_dvec3(), Vec3::from(y).as_dvec3());
    x.zxy() * y.yzx() - y.zxy() * x.yzx()
}

impl Shear {
    #[inline(always)]
    pub(super) fn new(way: &Way) -> Self {
        let d = way.d;
        let size = d.abs();
        let last = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let axes = [(last + 1) % 3, (last + 2) % 3, last];
        let advance = 1.0 / d[last];
        Self {
            axes,
            o: axes.map(|axis| way.o[axis]),
            slope: [d[axes[0]] * advance, d[axes[1]] * advance],
            advance,
        }
    }
}
