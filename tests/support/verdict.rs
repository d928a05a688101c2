//! Whether an answer to a ray is right, beside an oracle in double precision.
//!
//! Single precision cannot but answer otherwise than the oracle where a ray meets an edge or a rim. So an answer is
//! judged by itself: the point it names must lie on the primitive it names and on the ray, and what it passed over
//! must have been met within rounding of its boundary. The first is an error otherwise; the second is a leak, which
//! a kernel may have but a good one seldom has.

use glam::Vec3;
use specula::accel::{Accel, Brute};
use specula::geometry::{Hit, Ray, Shape, ShapeHit, World};

/// What an answer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Right, to within rounding.
    Right,
    /// The ray slipped past a boundary that it meets within rounding.
    Leak,
    /// Neither.
    Wrong,
}

/// Judges an answer, given the oracle's.
pub(crate) fn judge(
    world: &World,
    brute: &Brute,
    ray: &Ray,
    oracle: Option<&Hit>,
    found: Option<&Hit>,
) -> Verdict {
    if found.is_some_and(|hit| !Met::new(world, ray, hit).is_consistent()) {
        return Verdict::Wrong;
    }
    let mut verdict = Verdict::Right;
    let mut next = oracle.copied();
    // Everything in front of the answer was passed over.
    while let Some(passed) = next {
        let met = Met::new(world, ray, &passed);
        if found.is_some_and(|hit| hit.t <= passed.t + met.reach()) {
            return verdict;
        }
        if !met.is_marginal() {
            return Verdict::Wrong;
        }
        verdict = Verdict::Leak;
        let mut rest = *ray;
        rest.t_min = passed.t + met.reach();
        next = brute.intersect(&rest);
    }
    verdict
}

/// A hit with the ray in the space of the shape that was hit.
struct Met<'a> {
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
        Self { shape, ray, hit, local, d, p: inner, rounding, cos }
    }

    /// Rounding seen along the surface.
    fn spread(&self) -> f32 {
        2.0 * self.rounding / self.cos
    }

    /// Rounding in the ray's own parameter.
    fn reach(&self) -> f32 {
        2e-5 * self.hit.t + self.spread() / self.d.length()
    }

    /// Whether the hit lies on the primitive that it names, where its parameters say, with the right normal.
    fn is_consistent(&self) -> bool {
        let off = |n: Vec3| self.hit.ng.normalize_or_zero().dot(n) < 0.999;
        match self.shape {
            Shape::Mesh(mesh) => {
                let [a, b, c] = mesh.corners_at(self.hit.prim, self.ray.time);
                let (e1, e2) = (b - a, c - a);
                let (u, v) = (self.hit.u.clamp(0.0, 1.0), self.hit.v.clamp(0.0, 1.0));
                let named = a + e1 * u + e2 * v;
                let slack = self.spread() + 2e-5 * self.hit.t * self.d.length();
                let inside = u + v <= 1.0 + 1e-5 + self.spread() / e1.length().min(e2.length());
                inside && (named - self.p).length() <= slack && !off(e1.cross(e2).normalize_or_zero())
            }
            Shape::Sphere(s) => {
                let out = self.p - s.center;
                (out.length() - s.radius).abs() <= 4.0 * self.rounding && !off(out.normalize_or_zero())
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
                let slack = point.p_error.length() + self.spread() + 2e-5 * t * self.d.length();
                (point.p - self.p).length() <= slack && !off(point.ng)
            }
        }
    }

    /// Whether a ray within rounding of this one would have missed the primitive, or met it out of range.
    fn is_marginal(&self) -> bool {
        let ends = [self.ray.t_min, self.ray.t_max];
        if ends.iter().any(|end| (self.hit.t - end).abs() <= self.reach()) {
            return true;
        }
        let margin = match self.shape {
            Shape::Mesh(mesh) => {
                let [a, b, c] = mesh.corners_at(self.hit.prim, self.ray.time);
                let area2 = (b - a).cross(c - a).length();
                let (u, v) = (self.hit.u, self.hit.v);
                let heights = [c - b, c - a, b - a].map(|edge| area2 / edge.length());
                (heights[0] * (1.0 - u - v)).min(heights[1] * u).min(heights[2] * v)
            }
            // How far the ray dips below the silhouette, seen along it.
            Shape::Sphere(s) => return s.radius * self.cos * self.cos * 0.5 <= 4.0 * self.rounding,
            Shape::Disc(s) => s.radius - (self.p - s.center).length(),
            Shape::Surface(_) => return self.is_met_by_chance(),
        };
        margin <= self.spread()
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
