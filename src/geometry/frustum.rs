//! Cylinders, cones, and cones without their tips.

use crate::geometry::axial::{Axial, AxialRay, single};
use crate::geometry::{Ray, ShapeHit, Surface, SurfacePoint};
use crate::math::{Aabb, Transform, roots};
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::sync::Arc;

/// What lies between two circles about one axis: a cylinder if they are alike, a cone if one is a point. Closed by caps or
/// open; hit from outside and from inside; normals point outwards.
///
/// Surface parameters: u is the angle about the axis; v runs from 0 at the first circle to 1 at the second, and on over the
/// caps, to -1 in the middle of the first and to 2 in the middle of the second. At the tip of a cone the normal is that
/// of a side by it, or the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// About the middle of the axis.
    space: Axial,
    half: f64,
    /// At the first circle and at the second.
    radii: [f64; 2],
    capped: bool,
}

/// A piece of the surface, as hits name it by `v`.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    FirstCap,
    Side,
    SecondCap,
}

impl Part {
    fn of(v: f32) -> Self {
        if v < 0.0 {
            Self::FirstCap
        } else if v > 1.0 {
            Self::SecondCap
        } else {
            Self::Side
        }
    }

    /// The v of its middle.
    fn v(self) -> f32 {
        match self {
            Self::FirstCap => -0.5,
            Self::Side => 0.5,
            Self::SecondCap => 1.5,
        }
    }
}

impl Frustum {
    /// The surface between circles about `from` and `to` with radii of which one at least is positive, none negative; `None`
    /// otherwise, and where the two points are one.
    #[must_use]
    pub fn new(from: Vec3, to: Vec3, radii: [f32; 2], capped: bool) -> Option<Self> {
        let (from, to) = (from.as_dvec3(), to.as_dvec3());
        let sound = radii.iter().all(|radius| radius.is_finite() && *radius >= 0.0)
            && radii.iter().any(|radius| *radius > 0.0);
        let space = Axial::new((from + to) * 0.5, to - from)?;
        let half = (to - from).length() * 0.5;
        sound.then_some(Self { space, half, radii: radii.map(f64::from), capped })
    }

    /// The cylinder about the line between two points.
    #[must_use]
    pub fn cylinder(from: Vec3, to: Vec3, radius: f32, capped: bool) -> Option<Self> {
        Self::new(from, to, [radius; 2], capped)
    }

    /// How much the radius grows per height.
    fn slope(&self) -> f64 {
        (self.radii[1] - self.radii[0]) / (2.0 * self.half)
    }

    /// The radius in the middle of the axis.
    fn middle(&self) -> f64 {
        0.5 * (self.radii[0] + self.radii[1])
    }

    /// Distances at which a ray crosses the surface, in no order; some are no numbers, some cross nothing.
    ///
    /// The side is where |p + t q|^2 = (r + t s)^2, with p and q across the axis, r and s the radius at the ray's origin and
    /// how fast it changes along the ray. Half the discriminant is |r q - s p|^2 - (p x q)^2: a difference of two
    /// lengths, each of them exact to rounding, where that of the textbook cancels. Heights between the circles leave out
    /// the cone's other half.
    fn crossings(&self, ray: &AxialRay) -> [(f64, Part); 4] {
        let AxialRay { o, d, .. } = *ray;
        let (p, q) = (o.truncate(), d.truncate());
        let (r, s) = (self.middle() + self.slope() * o.z, self.slope() * d.z);
        let (reach, miss) = ((q * r - p * s).length(), p.perp_dot(q).abs());
        let discriminant = (reach - miss) * (reach + miss);
        let (q_length, p_length) = (q.length(), p.length());
        let a = (q_length - s) * (q_length + s);
        let c = (p_length - r) * (p_length + r);
        let [first, second] = roots::quadratic(a, p.dot(q) - r * s, c, discriminant);
        let cap = |height: f64| if self.capped { (height - o.z) / d.z } else { f64::NAN };
        [
            (first, Part::Side),
            (second, Part::Side),
            (cap(-self.half), Part::FirstCap),
            (cap(self.half), Part::SecondCap),
        ]
    }

    /// Whether a crossing lies on the surface; false for what is not finite.
    fn holds(&self, p: DVec3, part: Part) -> bool {
        match part {
            Part::Side => p.z.abs() <= self.half,
            Part::FirstCap => p.truncate().length_squared() <= self.radii[0] * self.radii[0],
            Part::SecondCap => p.truncate().length_squared() <= self.radii[1] * self.radii[1],
        }
    }

    /// The parameter of a crossing that lies on the surface and counts.
    fn parameter(&self, ray: &AxialRay, (distance, part): (f64, Part)) -> Option<f64> {
        let t = ray.parameter(distance)?;
        self.holds(ray.at(distance), part).then_some(t)
    }

    /// The point of a part nearest to `p`, and the unit normal there.
    fn project(&self, p: DVec3, part: Part) -> (DVec3, DVec3) {
        let across = p.truncate();
        let cap = |height: f64, radius: f64| {
            (across.clamp_length_max(radius).extend(height), DVec3::Z * height.signum())
        };
        match part {
            Part::FirstCap => cap(-self.half, self.radii[0]),
            Part::SecondCap => cap(self.half, self.radii[1]),
            Part::Side => {
                let Some(out) = across.try_normalize() else { return self.on_axis(p.z) };
                // The straight line from circle to circle, in the plane of the axis and the point.
                let (foot, up) = (
                    DVec2::new(self.radii[0], -self.half),
                    DVec2::new(self.radii[1] - self.radii[0], 2.0 * self.half),
                );
                let near = DVec2::new(across.length(), p.z) - foot;
                let along = (near.dot(up) / up.length_squared()).clamp(0.0, 1.0);
                let q = foot + up * along;
                let n = DVec2::new(up.y, -up.x).normalize();
                ((out * q.x).extend(q.y), (out * n.x).extend(n.y))
            }
        }
    }

    /// The tip, or what the side's points on the axis are by rounding.
    fn on_axis(&self, z: f64) -> (DVec3, DVec3) {
        let z = z.clamp(-self.half, self.half);
        let pointed = if self.slope() > 0.0 { -DVec3::Z } else { DVec3::Z };
        let radius = (self.middle() + self.slope() * z).max(0.0);
        (DVec3::new(radius, 0.0, z), pointed)
    }

    /// The gradient of the side, or the normal of a cap, at a point close to it.
    fn normal(&self, p: DVec3, part: Part) -> DVec3 {
        self.project(p, part).1
    }

    fn uv(&self, p: DVec3, part: Part) -> Vec2 {
        let inwards = |radius: f64| (1.0 - p.truncate().length() / radius).clamp(0.0, 1.0);
        let v = match part {
            Part::Side => (0.5 + 0.5 * p.z / self.half).clamp(0.0, 1.0),
            Part::FirstCap => -inwards(self.radii[0]),
            Part::SecondCap => 1.0 + inwards(self.radii[1]),
        };
        let angle = (p.y.atan2(p.x) / std::f64::consts::TAU).rem_euclid(1.0);
        DVec2::new(angle, v).as_vec2()
    }
}

impl Surface for Frustum {
    fn primitive_bounds(&self, _: u32) -> Aabb {
        let (reach, up) = (self.space.reach_of_circle(), self.space.axis() * self.half);
        let [first, second] = self.radii.map(|radius| reach * radius);
        self.space.aabb((-up - first).min(up - second), (first - up).max(up + second))
    }

    /// A hit's `v` tells the part, as the surface parameter does; its `u` is 0.
    fn intersect(&self, _: u32, ray: &Ray) -> Option<ShapeHit> {
        let local = self.space.ray(ray)?;
        let crossings = self.crossings(&local).into_iter();
        let met = crossings.filter_map(|crossing| Some((self.parameter(&local, crossing)?, crossing)));
        let (t, (distance, part)) = met.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
        let ng = self.space.outward(self.normal(local.at(distance), part));
        Some(ShapeHit { t: single(t), u: 0.0, v: part.v(), ng })
    }

    fn occludes(&self, _: u32, ray: &Ray) -> bool {
        let meets = |local| self.crossings(&local).into_iter().any(|it| self.parameter(&local, it).is_some());
        self.space.ray(ray).is_some_and(meets)
    }

    fn point(&self, _: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let part = Part::of(hit.v);
        let (p, n) = self.project(self.space.point_of(ray, hit.t), part);
        let uv = self.uv(p, part);
        let (p, p_error) = self.space.outside(p);
        SurfacePoint::smooth(p, p_error, self.space.outward(n), uv)
    }

    fn scaled(&self, map: &Transform, factor: f32) -> Option<Arc<dyn Surface>> {
        let factor = f64::from(factor);
        let space = self.space.carried(map)?;
        Some(Arc::new(Self {
            space,
            half: self.half * factor,
            radii: self.radii.map(|r| r * factor),
            ..*self
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(shape: &Frustum, o: Vec3, d: Vec3) -> Option<(f32, SurfacePoint)> {
        let ray = Ray::new(o, d);
        let hit = shape.intersect(0, &ray)?;
        assert!(shape.occludes(0, &ray), "a hit that does not occlude");
        Some((hit.t, shape.point(0, &ray, &hit)))
    }

    #[test]
    fn cylinders_are_hit_on_side_and_caps_from_both_sides() {
        let closed = Frustum::cylinder(Vec3::ZERO, Vec3::Y * 2.0, 1.0, true).expect("a cylinder");
        let (t, point) = hit(&closed, Vec3::new(5.0, 1.0, 0.0), -Vec3::X * 2.0).expect("the side");
        assert!((t - 2.0).abs() < 1e-6 && point.ng.abs_diff_eq(Vec3::X, 1e-6), "{t} {point:?}");
        assert!((point.uv.y - 0.5).abs() < 1e-6, "halfway up: {point:?}");
        let (t, point) = hit(&closed, Vec3::new(0.5, 5.0, 0.0), -Vec3::Y).expect("the lid");
        assert!((t - 3.0).abs() < 1e-6 && point.ng.abs_diff_eq(Vec3::Y, 1e-6), "{t} {point:?}");
        assert!((point.uv.y - 1.5).abs() < 1e-6, "half a radius in: {point:?}");
        let (t, point) = hit(&closed, Vec3::Y, -Vec3::Y).expect("the bottom from inside");
        assert!((t - 1.0).abs() < 1e-6 && point.ng.abs_diff_eq(-Vec3::Y, 1e-6), "{t} {point:?}");
        let open = Frustum::cylinder(Vec3::ZERO, Vec3::Y * 2.0, 1.0, false).expect("a cylinder");
        assert!(hit(&open, Vec3::new(0.5, 5.0, 0.0), -Vec3::Y).is_none(), "there is no lid");
    }

    #[test]
    fn the_tip_of_a_cone_is_a_point_with_a_normal() {
        let cone = Frustum::new(Vec3::ZERO, Vec3::Y, [1.0, 0.0], true).expect("a cone");
        let (t, point) = hit(&cone, Vec3::Y * 3.0, -Vec3::Y).expect("the tip");
        assert!((t - 2.0).abs() < 1e-6 && point.p.abs_diff_eq(Vec3::Y, 1e-6), "{t} {point:?}");
        assert!(point.ng.is_normalized() && point.uv.is_finite(), "{point:?}");
        assert!(hit(&cone, Vec3::new(-3.0, 1.5, 0.0), Vec3::X).is_none(), "the other half of the cone");
        // Along a side: the ray leaves through the tip.
        let along = Vec3::new(-1.0, 1.0, 0.0);
        let (t, point) = hit(&cone, Vec3::new(1.0, 0.0, 0.0) - along * 0.5, along).expect("along the side");
        assert!(t.is_finite() && point.ng.is_normalized(), "{t} {point:?}");
    }

    #[test]
    fn bodies_that_are_none_are_refused() {
        assert!(Frustum::cylinder(Vec3::ONE, Vec3::ONE, 1.0, true).is_none(), "no axis");
        assert!(Frustum::new(Vec3::ZERO, Vec3::Y, [0.0; 2], true).is_none(), "a line");
        assert!(Frustum::new(Vec3::ZERO, Vec3::Y, [1.0, -1.0], true).is_none(), "negative");
        assert!(Frustum::cylinder(Vec3::ZERO, Vec3::Y, f32::NAN, true).is_none(), "not a number");
    }
}
