//! Flat rectangles, by solid angle where they look large.

use crate::light::area::{Asked, Density, NEAR, SampleArea, SurfacePoint, TINY, length2_alike};
use crate::math::Vec3;
use crate::math::lanes::{Isa, Lanes, MaskLanes};
use crate::sampling::SphericalRectangle;

/// The points `center + s edge_u + t edge_v` with s and t in [-1, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectangleArea {
    center: Vec3<f32>,
    edge_u: Vec3<f32>,
    edge_v: Vec3<f32>,
    normal: Vec3<f32>,
    area: f32,
    seat: Option<Seat>,
}

/// Where a rectangle is, in units of half its diagonal: what it needs to be drawn from by solid angle. Parallelograms have none.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seat {
    /// Unit vectors over half the diagonal.
    x: Vec3<f32>,
    y: Vec3<f32>,
    z: Vec3<f32>,
    /// Half edges.
    half: [f32; 2],
    /// Squared distance up to which the rectangle is near.
    reach2: f32,
}

/// The cosine of the angle between edges up to which they count as being at right angles.
const SQUARE: f32 = 1e-5;

impl RectangleArea {
    /// From the centre and half edges; the normal is along `edge_u` x `edge_v`.
    #[must_use]
    pub fn new(center: glam::Vec3, edge_u: glam::Vec3, edge_v: glam::Vec3) -> Self {
        let across = edge_u.cross(edge_v);
        let normal = across.normalize();
        let seat = Seat::of(edge_u, edge_v, normal);
        let area = 4.0 * across.length();
        let [center, edge_u, edge_v, normal] = [center, edge_u, edge_v, normal].map(Vec3::from);
        Self { center, edge_u, edge_v, normal, area, seat }
    }

    /// The rectangle that two triangles make up, facing the same way; `None` if they make up something else.
    #[must_use]
    pub fn of_triangles(triangles: &[[glam::Vec3; 3]]) -> Option<Self> {
        let &[first, second] = triangles else { return None };
        // The corner that the other one lacks, and those that follow.
        let apart = |own: [glam::Vec3; 3], other: [glam::Vec3; 3]| {
            let lone = (0..3).find(|&i| !other.contains(&own[i]))?;
            Some([0, 1, 2].map(|k| own[(lone + k) % 3]))
        };
        let ([a, b, d], [c, e, f]) = (apart(first, second)?, apart(second, first)?);
        let (u, v) = ((b - a) * 0.5, (d - a) * 0.5);
        let is_closed = e == d && f == b;
        let extent = u.length() + v.length();
        let is_flat = (c - (a + (u + v) * 2.0)).length() <= 2.0 * SQUARE * extent;
        let made = Self::new((b + d) * 0.5, u, v);
        (is_closed && is_flat && made.seat.is_some()).then_some(made)
    }

    pub(super) fn center(&self) -> Vec3<f32> {
        self.center
    }

    /// Half edges.
    pub(super) fn edges(&self) -> [Vec3<f32>; 2] {
        [self.edge_u, self.edge_v]
    }

    pub(super) fn normal(&self) -> Vec3<f32> {
        self.normal
    }

    /// How it looks from a point, and where it is drawn from by that.
    #[inline(always)]
    fn seen<F: Lanes>(&self, from: Vec3<F>) -> Option<(SphericalRectangle<F>, F::Mask)> {
        let seat = match &self.seat {
            Some(seat) => seat,
            None => return None,
        };
        let like = from.x;
        let way = Vec3::splat(like, self.center) - from;
        let is_near = length2_alike(way).lt(seat.reach2);
        if is_near.none() {
            return None;
        }
        let [x, y, z] = [
            way.dot(Vec3::splat(like, seat.x)),
            way.dot(Vec3::splat(like, seat.y)),
            way.dot(Vec3::splat(like, seat.z)),
        ];
        let [u, v] = seat.half;
        let seen = SphericalRectangle::new([x - u, x + u], [y - v, y + v], z);
        Some((seen, is_near & seen.solid_angle().gt(TINY)))
    }
}

impl Seat {
    fn of(edge_u: glam::Vec3, edge_v: glam::Vec3, normal: glam::Vec3) -> Option<Self> {
        let [u, v] = [edge_u.length(), edge_v.length()];
        // Without squares, which over- or underflow earlier.
        let half_diagonal = u.max(v) * (1.0 + (u.min(v) / u.max(v)).powi(2)).sqrt();
        let reach2 = NEAR * half_diagonal * half_diagonal;
        let inverse = half_diagonal.recip();
        let is_square = (edge_u / u).dot(edge_v / v).abs() <= SQUARE;
        if !is_square || !reach2.is_normal() || !inverse.is_normal() {
            return None;
        }
        let [x, y, z] = [edge_u / u, edge_v / v, normal].map(|axis| Vec3::from(axis * inverse));
        Some(Self { x, y, z, half: [u * inverse, v * inverse], reach2 })
    }
}

impl SampleArea for RectangleArea {
    #[inline(always)]
    fn sample<F: Lanes>(&self, asked: Asked<F>, [u, v]: [F; 2]) -> SurfacePoint<F> {
        let like = asked.from.x;
        let (mut s, mut t) = (u * 2.0 - 1.0, v * 2.0 - 1.0);
        let mut pdf = like.splat(1.0 / self.area);
        let mut by_angle = like.isa().splat_mask(false);
        if let Some((seen, is_near)) = self.seen(asked.from) {
            let [x, y] = seen.sample_within([u, v]);
            (s, t) = (F::select(is_near, x, s), F::select(is_near, y, t));
            pdf = F::select(is_near, seen.solid_angle().recip(), pdf);
            by_angle = is_near;
        }
        let p = Vec3::splat(like, self.center)
            + Vec3::splat(like, self.edge_u) * s
            + Vec3::splat(like, self.edge_v) * t;
        SurfacePoint { p, n: Vec3::splat(like, self.normal), pdf, by_angle, radiance: None }
    }

    fn pdf(&self, asked: Asked<f32>, _prim: u32) -> Density {
        match self.seen(asked.from) {
            Some((seen, true)) => Density::Angle(seen.solid_angle().recip()),
            _ => Density::Area(1.0 / self.area),
        }
    }

    fn area(&self) -> f32 {
        self.area
    }
}
