//! Where a hierarchy is traversed: in coordinates of its own, of size one, from where a ray enters.
//!
//! The box tests of obvhs are plain single precision: no padding, an absolute smallest parameter of 10^-4 (`CwBvh`), the
//! smallest parameter of a ray ignored. All of that is harmless in coordinates that are made for it:
//!
//! * A [`Frame`] shifts and scales by exact steps, so that the boxes lie about the origin with half an extent between 1/2
//!   and 1. Vertices stay what they are to the last bit: the scale is a power of two, and an axis is shifted only where all
//!   coordinates lie within a factor of two of the shift, so that the difference is exact (Sterbenz 1974, Floating-Point
//!   Computation). A tiny scene and one far from the origin are traced as any other.
//! * A [`Way`] starts where the ray enters the box, found in double precision, at parameter 0. What lies before the ray's
//!   own smallest parameter is behind it. Distances in it are below 4 and its direction is below 2^-19 long, so that
//!   10^-4 in its parameter is 2 * 10^-10, far below rounding.
//! * Every box is padded by [`PADDING`], which is more than all roundings of traversal and triangle test can amount to.
//!
//! How large that is: a slab's parameter `(plane - o) * inv` carries three relative roundings (`gamma(3)`, Ize 2013, Robust
//! BVH Ray Traversal), as if its plane lay off by `3 u |plane - o|`, with `u = 2^-24` and `|plane - o| <= 2`. Wide nodes add
//! `u` times what their quantised offsets and sums amount to, at most 8. The start is rounded by `u` times a coordinate of at most
//! 3; the triangle test sees its corners off by at most `4 u` times a distance of 2. Together below `30 u`: the padding is 32 u.

use crate::geometry::Ray;
use crate::math::Aabb;
use crate::math::float::UNIT_ROUNDOFF;
use glam::{DVec3, Vec3, Vec3A};

/// How far boxes reach beyond what they hold, where half the largest extent of all is between 1/2 and 1.
pub(super) const PADDING: f32 = 32.0 * UNIT_ROUNDOFF;

/// Coordinates in which what a hierarchy holds has about size one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// What is held, in the space of the shape.
    bounds: Aabb,
    center: Vec3,
    /// A power of two.
    scale: f32,
    /// `PADDING`, or what an experiment wants.
    padding: f32,
}

/// A ray in the frame of a hierarchy: `o + d t`, from parameter 0 on.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// Where it starts.
    pub o: Vec3A,
    /// The ray's direction times a power of two; its largest component is from 2^-20 to below 2^-19.
    pub d: Vec3A,
    /// Inverse direction, finite and not zero.
    pub inv: Vec3A,
    /// Where it ends, or infinity.
    pub end: f32,
    /// The ray's parameter at the start.
    t0: f64,
    /// The ray's parameters per one of this way's: a power of two.
    per: f64,
}

/// What direction components are at least, in the traversal of boxes: moves a ray by 2^-38 on its way through a box.
const LEAST: f32 = 1.0 / (1_u64 << 60) as f32;

impl Frame {
    /// The frame for what lies in `bounds`, a finite box.
    pub(super) fn around(bounds: Aabb, padding: f32) -> Self {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (center, half) = ((min + max) * 0.5, (max - min) * 0.5);
        let far = center.abs().cmpge(half * 2.0);
        let center = DVec3::select(far, center, DVec3::ZERO).as_vec3();
        // What has no extent is as large as its coordinates are exact to.
        let least = f64::from(bounds.min.abs().max(bounds.max.abs()).max_element()) * 1e-6;
        let half = half.max_element().max(least).max(1e-35);
        #[expect(clippy::cast_possible_truncation, reason = "a power of two well within range")]
        let scale = power_of_two(-1 - exponent(half)) as f32;
        Self { bounds, center, scale, padding: padding * PADDING }
    }

    /// How far boxes are padded.
    pub(super) fn padding(&self) -> f32 {
        self.padding
    }

    /// A point of the box, exactly.
    pub(super) fn point(&self, p: Vec3) -> Vec3A {
        Vec3A::from(p - self.center) * self.scale
    }

    /// What a normal made of edges must be multiplied by to be that of the shape's space.
    pub(super) fn normal_scale(&self) -> f32 {
        let inverse = 1.0 / self.scale;
        inverse * inverse
    }

    /// A box within the bounds, padded.
    pub(super) fn aabb(&self, aabb: Aabb) -> obvhs::aabb::Aabb {
        obvhs::aabb::Aabb {
            min: self.point(aabb.min) - self.padding,
            max: self.point(aabb.max) + self.padding,
        }
    }

    /// The part of a traceable ray within the bounds; none where it passes by.
    #[inline(always)]
    pub(super) fn enter(&self, ray: &Ray) -> Option<Way> {
        let inside = ray.o.cmpge(self.bounds.min) & ray.o.cmple(self.bounds.max);
        let (o, t0) =
            if ray.t_min == 0.0 && inside.all() { (self.point(ray.o), 0.0) } else { self.approach(ray)? };
        // The largest component becomes 2^-20 or a little more.
        let scaled = power_of_two(-20 - exponent(f64::from(ray.d.abs().max_element())));
        let d = (ray.d.as_dvec3() * scaled).as_vec3a();
        let nudged = Vec3A::select(d.abs().cmplt(Vec3A::splat(LEAST)), Vec3A::splat(LEAST).copysign(d), d);
        let mut way = Way { o, d, inv: nudged.recip(), t0, per: scaled / f64::from(self.scale), end: 0.0 };
        way.end = way.local(ray.t_max);
        Some(way)
    }

    /// Where the ray enters the padded box, and at which parameter, no less than its smallest.
    fn approach(&self, ray: &Ray) -> Option<(Vec3A, f64)> {
        // Not zero, so that no infinity times zero arises.
        const STEEP: DVec3 = DVec3::splat(1e-300);
        let (center, scale) = (self.center.as_dvec3(), f64::from(self.scale));
        let o = (ray.o.as_dvec3() - center) * scale;
        let d = ray.d.as_dvec3() * scale;
        let inv = DVec3::select(d.abs().cmplt(STEEP), STEEP.copysign(d), d).recip();
        let padding = f64::from(PADDING);
        let low = (self.bounds.min.as_dvec3() - center) * scale - padding;
        let high = (self.bounds.max.as_dvec3() - center) * scale + padding;
        let (a, b) = ((low - o) * inv, (high - o) * inv);
        let t0 = a.min(b).max_element().max(f64::from(ray.t_min));
        if t0 > a.max(b).min_element() || t0 > f64::from(ray.t_max) {
            return None;
        }
        Some(((o + d * t0).as_vec3a(), t0))
    }
}

impl Way {
    /// The ray's parameter where this way starts.
    pub(super) fn start(&self) -> f64 {
        self.t0
    }

    /// The ray's parameter at one of this way's.
    #[inline(always)]
    pub(super) fn t(&self, local: f32) -> f32 {
        #[expect(clippy::cast_possible_truncation, reason = "the answer is single precision")]
        let t = (f64::from(local) * self.per + self.t0) as f32;
        t
    }

    /// No less than this way's parameter at one of the ray's, and hardly more.
    #[inline(always)]
    pub(super) fn local(&self, t: f32) -> f32 {
        #[expect(clippy::cast_possible_truncation, reason = "widened after rounding")]
        let local = ((f64::from(t) - self.t0) / self.per) as f32;
        local + local.abs() * (4.0 * UNIT_ROUNDOFF) + f32::MIN_POSITIVE
    }
}

/// The exponent of a positive number's largest power of two.
fn exponent(x: f64) -> i32 {
    i32::try_from(x.to_bits() >> 52).expect("positive") - 1023
}

/// 2^`exponent`, which lies within the normal numbers.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(u64::from((1023 + exponent).cast_unsigned()) << 52)
}
