//! Whether an answer to a ray is right, beside an oracle in double precision.
//!
//! Single precision cannot but answer otherwise than the oracle where a ray meets an edge or a rim. So an answer is
//! judged by itself: the point it names must lie on the primitive it names and on the ray, and what it passed over
//! must have been met within rounding of its boundary. Otherwise it is wrong.

#![expect(clippy::cast_possible_truncation, reason = "computed in double precision, used in single")]

use crate::accel::{Accel, Brute};
use crate::geometry::{Hit, Ray, Shape, ShapeHit, World};
use glam::Vec3;

/// What an answer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Verdict {
    /// The oracle's own primitive, or a miss where it misses.
    Same,
    /// Another primitive at the same distance: an edge that two share, or surfaces that touch.
    Tie,
    /// A hit that the oracle misses, within rounding of a boundary.
    Extra,
    /// The ray slipped past an edge of a triangle that it meets within rounding.
    Edge,
    /// The same at the rim or silhouette of a round shape.
    Rim,
    /// The same at an end of the ray's range.
    Range,
    /// None of these.
    Wrong,
}

impl Verdict {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 7] =
        [Self::Same, Self::Tie, Self::Extra, Self::Edge, Self::Rim, Self::Range, Self::Wrong];

    /// Whether light would pass where it should not.
    #[must_use]
    pub fn is_leak(self) -> bool {
        matches!(self, Self::Edge | Self::Rim)
    }
}

/// Judges an answer, given the oracle's.
#[must_use]
pub fn judge(world: &World, brute: &Brute, ray: &Ray, oracle: Option<&Hit>, found: Option<&Hit>) -> Verdict {
    let identity = |hit: &Hit| (hit.placement, hit.prim);
    if found.is_some_and(|hit| !Met::new(world, ray, hit).is_consistent()) {
        return Verdict::Wrong;
    }
    if found.map(identity) == oracle.map(identity) {
        return Verdict::Same;
    }
    let mut verdict = Verdict::Extra;
    let mut next = oracle.copied();
    // Everything in front of the answer was passed over.
    while let Some(passed) = next {
        let met = Met::new(world, ray, &passed);
        if let Some(hit) = found
            && hit.t <= passed.t + met.reach()
        {
            let is_tie = verdict == Verdict::Extra && hit.t >= passed.t - met.reach();
            return if is_tie { Verdict::Tie } else { verdict };
        }
        let Some(boundary) = met.boundary() else { return Verdict::Wrong };
        if verdict == Verdict::Extra {
            verdict = boundary;
        }
        let mut rest = *ray;
        // At least one step: all is exact of what starts at the origin and is met there.
        rest.t_min = (passed.t + met.reach()).max(passed.t.next_up());
        next = brute.intersect(&rest);
    }
    verdict
}

/// Whether a ray within rounding of this one misses the primitive that `hit` names: it lies at an edge or a rim.
#[must_use]
pub fn is_at_boundary(world: &World, ray: &Ray, hit: &Hit) -> bool {
    matches!(Met::new(world, ray, hit).boundary(), Some(Verdict::Edge | Verdict::Rim))
}

/// How far two hits on one primitive lie apart along its normal, in parts of the coordinates between which the ray runs.
#[must_use]
pub fn deviation(ray: &Ray, found: &Hit, oracle: &Hit) -> f32 {
    let cos = ray.d.normalize().dot(oracle.ng.normalize_or_zero()).abs();
    let scale = ray.o.length() + ray.at(oracle.t).length();
    (found.t - oracle.t).abs() * ray.d.length() * cos / scale
}

/// A hit with the ray in the space of the shape that was hit.
struct Met<'a> {
    world: &'a World,
    shape: &'a Shape,
    ray: &'a Ray,
    hit: &'a Hit,
    /// The ray in the space of the shape, its direction and the point it names there.
    local: Ray,
    d: Vec3,
    p: Vec3,
    /// How far off a kernel may see the ray: some roundings of the coordinates it adds and subtracts.
    rounding: f32,
    /// Cosine between ray and normal, not zero.
    cos: f32,
}

impl<'a> Met<'a> {
    fn new(world: &'a World, ray: &'a Ray, hit: &'a Hit) -> Self {
        let placement = &world.placements[hit.placement.index()];
        let shape = &world.shapes[placement.shape.index()];
        let far = |o: Vec3, p: Vec3| 8.0 * f32::EPSILON * (o.length() + p.length());
        let p = ray.at(hit.t);
        let (local, stretch) = match placement.pose.at(ray.time) {
            None => (*ray, 0.0),
            Some(t) => {
                let stretch = Vec3::AXES.map(|axis| t.inverse_vector(axis).length()).iter().sum();
                (ray.into_object(&t), stretch)
            }
        };
        let (d, inner) = (local.d, local.at(hit.t));
        let rounding = far(local.o, inner) + far(ray.o, p) * stretch;
        let cos = d.normalize().dot(hit.ng.normalize_or_zero()).abs().max(1e-6);
        Self { world, shape, ray, hit, local, d, p: inner, rounding, cos }
    }

    /// Rounding seen along the surface.
    fn spread(&self) -> f32 {
        2.0 * self.rounding / self.cos
    }

    /// Rounding in the ray's own parameter.
    fn reach(&self) -> f32 {
        2e-5 * self.hit.t + self.spread() / self.d.length()
    }

    /// Whether the hit counts and lies on the primitive that it names, where its parameters say, with the right normal.
    fn is_consistent(&self) -> bool {
        self.counts() && self.is_on_primitive()
    }

    /// Whether the ray sees the placement, and its filter lets the hit count; what a filter says of a ray along the
    /// surface is left to chance.
    fn counts(&self) -> bool {
        let Hit { t, u, v, ng, prim, placement } = *self.hit;
        let placement = &self.world.placements[placement.index()];
        let filter = self.world.filters.get(&placement.shape);
        let accepted = filter.is_none_or(|f| f.accepts(&self.local, &ShapeHit { t, u, v, ng }, prim));
        placement.mask & self.ray.mask != 0 && (accepted || self.cos < 1e-2)
    }

    fn is_on_primitive(&self) -> bool {
        let off = |n: Vec3| self.hit.ng.normalize_or_zero().dot(n) < 0.999;
        let slack = self.spread() + 2e-5 * self.hit.t * self.d.length();
        match self.shape {
            Shape::Mesh(mesh) => {
                let [a, b, c] = mesh.corners_at(self.hit.prim, self.ray.time);
                let (e1, e2) = (b - a, c - a);
                let (u, v) = (self.hit.u.clamp(0.0, 1.0), self.hit.v.clamp(0.0, 1.0));
                let named = a + e1 * u + e2 * v;
                let inside = u + v <= 1.0 + 1e-5 + self.spread() / e1.length().min(e2.length());
                let across = e1.as_dvec3().cross(e2.as_dvec3());
                let n = across.normalize_or_zero().as_vec3();
                // Kernels that take the origin from the corners first know the normal no better than those differences.
                let height = across.length() as f32 / e1.length().max(e2.length());
                // On the diagonal of a quad either half may be named, and the other's normal told.
                let on_edge = u.min(v).min(1.0 - u - v) < 1e-5;
                let is_known = self.rounding < 1e-2 * height && !on_edge;
                // Parameters are known to their own rounding, which large triangles make much of.
                let slack = slack + f32::EPSILON * (a.length() + e1.length() + e2.length());
                inside && (named - self.p).length() <= slack && (!is_known || !off(n))
            }
            Shape::Sphere(s) => {
                let out = self.p - s.center;
                let is_known = self.rounding < 1e-2 * s.radius;
                (out.length() - s.radius).abs() <= 4.0 * self.rounding
                    && (!is_known || !off(out.normalize_or_zero()))
            }
            Shape::Disc(s) => {
                let out = self.p - s.center;
                out.dot(s.normal).abs() <= 4.0 * self.rounding
                    && out.length() <= s.radius + self.spread()
                    && !off(s.normal)
            }
            Shape::Surface(s) => {
                let Hit { t, u, v, ng, prim, .. } = *self.hit;
                let point = s.point(prim, &self.local, &ShapeHit { t, u, v, ng });
                let is_known = self.rounding < 1e-2 * s.primitive_bounds(prim).size().min_element();
                (point.p - self.p).length() <= point.p_error.length() + slack && (!is_known || !off(point.ng))
            }
        }
    }

    /// What a ray within rounding of this one would have slipped past, missing the primitive; `None` if every such ray
    /// meets it.
    fn boundary(&self) -> Option<Verdict> {
        let ends = [self.ray.t_min, self.ray.t_max];
        if ends.iter().any(|end| (self.hit.t - end).abs() <= self.reach()) {
            return Some(Verdict::Range);
        }
        let (is_near, boundary) = match self.shape {
            Shape::Mesh(mesh) => {
                let [a, b, c] = mesh.corners_at(self.hit.prim, self.ray.time);
                let area2 = (b - a).as_dvec3().cross((c - a).as_dvec3()).length() as f32;
                let (u, v) = (self.hit.u, self.hit.v);
                let heights = [c - b, c - a, b - a].map(|edge| area2 / edge.length());
                let margin = (heights[0] * (1.0 - u - v)).min(heights[1] * u).min(heights[2] * v);
                (margin <= self.spread(), Verdict::Edge)
            }
            // How far the ray dips below the silhouette, seen along it.
            Shape::Sphere(s) => (s.radius * self.cos * self.cos * 0.5 <= 4.0 * self.rounding, Verdict::Rim),
            Shape::Disc(s) => (s.radius - (self.p - s.center).length() <= self.spread(), Verdict::Rim),
            Shape::Surface(_) => (self.is_met_by_chance(), Verdict::Rim),
        };
        is_near.then_some(boundary)
    }

    /// Whether some ray beside this one, at the distance of rounding, misses the primitive or meets it elsewhere.
    fn is_met_by_chance(&self) -> bool {
        let across = self.d.normalize().any_orthonormal_pair();
        let ways = [across.0, across.1, -across.0, -across.1];
        ways.into_iter().any(|way| {
            let mut beside = self.local;
            beside.o += way * 4.0 * self.rounding;
            let met = self.shape.intersect(self.hit.prim, &beside);
            met.is_none_or(|near| (near.t - self.hit.t).abs() > self.reach())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use std::sync::Arc;

    /// Nothing is rounded where all is zero.
    #[test]
    fn rays_that_start_at_the_origin_on_a_surface_are_judged() {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let mut world = World::default();
        let id = world.add_shape(Shape::Mesh(Mesh::new(corners.into(), vec![[0, 1, 2]]).expect("a mesh")));
        world.place(id, None);
        let world = Arc::new(world);
        let brute = Brute::new(world.clone());
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        let oracle = brute.intersect(&ray);
        assert!(oracle.is_some_and(|hit| hit.t.to_bits() == 0), "{oracle:?}");
        assert_eq!(judge(&world, &brute, &ray, oracle.as_ref(), oracle.as_ref()), Verdict::Same);
        assert_eq!(judge(&world, &brute, &ray, oracle.as_ref(), None), Verdict::Range);
    }
}
