//! Rings.

use crate::geometry::axial::{Axial, AxialRay, single};
use crate::geometry::{Ray, ShapeHit, Surface, SurfacePoint};
use crate::math::roots::{self, Crossing};
use crate::math::{Aabb, Transform};
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The points at one distance from a circle: a ring with a hole, hit from outside and from inside; normals point outwards.
///
/// Surface parameters: u is the angle about the axis, v that about the tube, from its outermost line towards the axis' tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    space: Axial,
    /// Of the circle.
    major: f64,
    /// Of the tube, in major radii.
    tube: f64,
}

impl Torus {
    /// The ring about `axis`, of any length but zero, whose tube of radius `minor` has its middle at distance `major`; `None`
    /// unless 0 < `minor` < `major`: without a hole it would be another surface.
    #[must_use]
    pub fn new(center: Vec3, axis: Vec3, major: f32, minor: f32) -> Option<Self> {
        let space = Axial::new(center.as_dvec3(), axis.as_dvec3())?;
        let sound = minor > 0.0 && minor < major && major.is_finite();
        let (major, minor) = (f64::from(major), f64::from(minor));
        sound.then_some(Self { space, major, tube: minor / major })
    }

    /// The piece of a ray that can meet the ring, by distance from its origin in major radii: between two planes and within
    /// a sphere. `o` is the point of the ray nearest to the centre.
    fn span(&self, o: DVec3, d: DVec3) -> Option<[f64; 2]> {
        // Ends that lie on the ring by rounding would have no sign: a little more does no harm.
        const MORE: f64 = 1.0 + 1e-9;
        let reach = (1.0 + self.tube) * MORE;
        let miss = o.length();
        let half = ((reach - miss) * (reach + miss)).sqrt();
        let planes = [-1.0, 1.0].map(|side| (side * self.tube * MORE - o.z) / d.z);
        // Along the planes one of these is infinite or not a number: then the sphere decides.
        let level = |a: f64, b: f64| if d.z == 0.0 { [-half, half] } else { [a.min(b), a.max(b)] };
        let [low, high] = level(planes[0], planes[1]);
        if d.z == 0.0 && o.z.abs() > self.tube {
            return None;
        }
        let span = [low.max(-half), high.min(half)];
        (half >= 0.0 && span[0] < span[1]).then_some(span)
    }

    /// Bernstein coefficients of (|p|^2 + 1 - tube^2)^2 - 4 (x^2 + y^2) between two points, in major radii: positive
    /// outside (Hanrahan 1989, A survey of ray-surface intersection algorithms, for the implicit form). The coefficients
    /// of a square along a line are the products of its ends.
    fn quartic(&self, p: DVec3, q: DVec3) -> [f64; 5] {
        let rest = (1.0 - self.tube) * (1.0 + self.tube);
        let [g0, g1, g2] = [p.dot(p) + rest, p.dot(q) + rest, q.dot(q) + rest];
        let (p, q) = (p.truncate(), q.truncate());
        let [h0, h1, h2] = [p.dot(p), p.dot(q), q.dot(q)].map(|h| 4.0 * h);
        [
            g0 * g0 - h0,
            g0 * g1 - 0.5 * (h0 + h1),
            (g0 * g2 + 2.0 * g1 * g1) / 3.0 - (h0 + 4.0 * h1 + h2) / 6.0,
            g1 * g2 - 0.5 * (h1 + h2),
            g2 * g2 - h2,
        ]
    }

    /// Squared distance from the circle beyond that of the tube, and its slope along `d`, in major radii. It vanishes where
    /// the quartic does, without being the difference of large numbers.
    fn beyond(&self, p: DVec3, d: DVec3) -> [f64; 2] {
        let out = p.truncate().length();
        let off = DVec2::new(out - 1.0, p.z);
        let out_slope = if out > 0.0 { p.truncate().dot(d.truncate()) / out } else { 0.0 };
        let miss = off.length();
        [(miss - self.tube) * (miss + self.tube), 2.0 * off.dot(DVec2::new(out_slope, d.z))]
    }

    /// Calls `found` with distances in lengths at which the ray crosses the ring, nearest first, until it breaks.
    fn crossings(&self, ray: &AxialRay, mut found: impl FnMut(f64) -> ControlFlow<()>) {
        let (o, d) = (ray.o / self.major, ray.d);
        let Some([low, high]) = self.span(o, d) else { return };
        let quartic = self.quartic(o + d * low, o + d * high);
        let distance = |part: f64| low + (high - low) * part;
        let _ = roots::crossings(quartic, &mut |Crossing { low, high, rises }| {
            let within = Crossing { low: distance(low), high: distance(high), rises };
            let at = roots::refine(within, |t| self.beyond(o + d * t, d));
            found(at * self.major)
        });
    }

    /// The first crossing within the ray's range: its parameter and distance.
    fn first(&self, ray: &AxialRay) -> Option<(f64, f64)> {
        let mut first = None;
        self.crossings(ray, |distance| match ray.parameter(distance) {
            Some(t) => {
                first = Some((t, distance));
                ControlFlow::Break(())
            }
            None => ControlFlow::Continue(()),
        });
        first
    }

    /// The point of the ring nearest to `p`, and the unit normal there.
    fn project(&self, p: DVec3) -> (DVec3, DVec3) {
        let middle = p.truncate().normalize_or(DVec2::X).extend(0.0) * self.major;
        let n = (p - middle).normalize_or(DVec3::Z);
        (middle + n * (self.tube * self.major), n)
    }

    fn uv(n: DVec3, p: DVec3) -> Vec2 {
        let out = p.truncate().normalize_or(DVec2::X);
        let angles = DVec2::new(p.y.atan2(p.x), n.z.atan2(n.truncate().dot(out)));
        (angles / std::f64::consts::TAU).map(|angle| angle.rem_euclid(1.0)).as_vec2()
    }
}

impl Surface for Torus {
    fn primitive_bounds(&self, _: u32) -> Aabb {
        let reach = (self.space.reach_of_circle() + self.tube) * self.major;
        self.space.aabb(-reach, reach)
    }

    /// A hit's `u` and `v` are 0.
    fn intersect(&self, _: u32, ray: &Ray) -> Option<ShapeHit> {
        let local = self.space.ray(ray)?;
        let (t, distance) = self.first(&local)?;
        let ng = self.space.outward(self.project(local.at(distance)).1);
        Some(ShapeHit { t: single(t), u: 0.0, v: 0.0, ng })
    }

    fn occludes(&self, _: u32, ray: &Ray) -> bool {
        self.space.ray(ray).is_some_and(|local| self.first(&local).is_some())
    }

    fn point(&self, _: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let (p, n) = self.project(self.space.point_of(ray, hit.t));
        let uv = Self::uv(n, p);
        let (p, p_error) = self.space.outside(p);
        SurfacePoint::smooth(p, p_error, self.space.outward(n), uv)
    }

    fn scaled(&self, map: &Transform, factor: f32) -> Option<Arc<dyn Surface>> {
        let space = self.space.carried(map)?;
        Some(Arc::new(Self { space, major: self.major * f64::from(factor), ..*self }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All hits along a ray: parameters and outward normals.
    fn hits(torus: &Torus, o: Vec3, d: Vec3) -> Vec<(f32, Vec3)> {
        let mut ray = Ray::new(o, d);
        let mut all = vec![];
        while let Some(hit) = torus.intersect(0, &ray) {
            all.push((hit.t, torus.point(0, &ray, &hit).ng));
            ray.t_min = hit.t.next_up();
        }
        all
    }

    #[test]
    fn a_ray_crosses_up_to_four_times() {
        let ring = Torus::new(Vec3::ZERO, Vec3::Y, 2.0, 0.5).expect("a ring");
        let found = hits(&ring, Vec3::new(-5.0, 0.0, 0.0), Vec3::X * 0.5);
        let expected = [(5.0, -Vec3::X), (7.0, Vec3::X), (13.0, -Vec3::X), (15.0, Vec3::X)];
        assert_eq!(found.len(), 4, "{found:?}");
        for ((t, n), (t_expected, n_expected)) in found.iter().zip(expected) {
            assert!((t - t_expected).abs() < 1e-5 && n.abs_diff_eq(n_expected, 1e-6), "{found:?}");
        }
        assert!(hits(&ring, Vec3::Y * 3.0, -Vec3::Y).is_empty(), "through the hole, along the axis");
        assert!(hits(&ring, Vec3::new(1.4, 3.0, 0.0), -Vec3::Y).is_empty(), "through the hole");
        assert_eq!(hits(&ring, Vec3::new(2.0, 3.0, 0.0), -Vec3::Y).len(), 2, "through the tube");
        assert_eq!(hits(&ring, Vec3::new(2.0, 0.0, 0.0), Vec3::Y).len(), 1, "from inside the tube");
    }

    #[test]
    fn level_rays_cross_or_miss() {
        let ring = Torus::new(Vec3::ZERO, Vec3::Z, 2.0, 0.5).expect("a ring");
        assert_eq!(hits(&ring, Vec3::new(-9.0, 0.0, 0.499), Vec3::X).len(), 4, "just below the top");
        assert!(hits(&ring, Vec3::new(-9.0, 0.0, 0.501), Vec3::X).is_empty(), "just above");
        assert_eq!(hits(&ring, Vec3::new(-9.0, 1.499, 0.0), Vec3::X).len(), 4, "through the hole");
        assert_eq!(hits(&ring, Vec3::new(-9.0, 1.501, 0.0), Vec3::X).len(), 2, "beside the hole");
    }

    #[test]
    fn rings_without_a_hole_are_refused() {
        for (major, minor) in [(1.0, 1.0), (1.0, 2.0), (1.0, 0.0), (f32::INFINITY, 1.0), (1.0, f32::NAN)] {
            assert!(Torus::new(Vec3::ZERO, Vec3::Z, major, minor).is_none(), "{major} {minor}");
        }
        assert!(Torus::new(Vec3::ZERO, Vec3::ZERO, 2.0, 1.0).is_none(), "no axis");
    }
}
