//! Rectangles and triangles by solid angle, against the formulas as published: angles of spherical polygons, which cancel. One at a time, and
//! of rectangles the solid angle alone: `tests/light_laws.rs` has where their points fall;
//! `tests/lanes_agree` has lights that draw by them at every width.

use super::axes::{Axis, of};
use super::big::{Big, big, cross, dot, pi, unit};
use super::row::Row;
use specula::math::Vec3;
use specula::sampling::{SphericalRectangle, SphericalTriangle};

/// The nearer end of an edge.
fn end() -> Axis {
    of(&[-2.0, -0.5, 0.0, 0.75], |random| vec![random.unit() * 4.0 - 2.0])
}

/// The length of an edge.
fn size() -> Axis {
    of(&[1e-3, 0.125, 1.0], |random| vec![random.logarithmic(1e-3, 2.0)])
}

/// The distance of the plane.
fn distance() -> Axis {
    of(&[1e-3, 0.125, 1.0, 4.0], |random| vec![random.logarithmic(1e-3, 4.0)])
}

/// Few numbers, for grids of many axes.
fn few_numbers() -> Axis {
    of(&[0.0, 0.125, 0.5, 0.9375], |random| vec![random.unit()])
}

/// Both ends of an edge, the second as rounded.
fn ends(from: &Big, size: &Big) -> [Big; 2] {
    [from.clone(), big(f64::from(from.to_f32() + size.to_f32()))]
}

/// The solid angle of a rectangle: the sum of the angles of its corners, seen as a spherical polygon, less two right angles for each
/// beyond two.
fn solid_angle_of_rectangle(t: &[Big]) -> Big {
    let (x, y) = (ends(&t[0], &t[1]), ends(&t[2], &t[3]));
    let corner = |i: usize, j: usize| [x[i].clone(), y[j].clone(), -&t[4]];
    let way = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
    let n = [0, 1, 2, 3].map(|i| unit(&cross(&way[i], &way[(i + 1) % 4])));
    let angles = [0, 1, 2, 3].map(|i| (-dot(&n[i], &n[(i + 1) % 4])).acos());
    angles.iter().fold(pi() * -2.0, |sum, angle| sum + angle)
}

/// How far a fraction of an edge is off where its ends are rounded.
fn rounded_ends(from: f64, size: f64) -> f64 {
    1.2e-7 * (from.abs() + size) / size
}

/// How far the corners of a triangle are, about.
fn reach(a: &[f64]) -> f64 {
    a[0].abs().max(a[1].abs()).max(a[2]) + a[3]
}

/// By how much unit vectors to the corners are turned by rounding, beside the angle that the plane's distance fills.
fn rounded_ways(a: &[f64]) -> f64 {
    6e-8 * reach(a) / a[2]
}

/// The corners of a triangle as they are seen: as floats.
fn corners(a: [f32; 4]) -> [[f32; 3]; 3] {
    let [x, y, z, size] = a;
    [[x, y, z], [x + size, y, z], [x, y + size, z]]
}

/// Arcs and angles of the triangle.
struct Triangle {
    /// Unit vectors to the corners.
    w: [Vec<Big>; 3],
    ways: [Vec<Big>; 3],
    /// The angle at the first corner.
    alpha: Big,
    solid_angle: Big,
}

impl Triangle {
    fn new(t: &[Big]) -> Self {
        let floats = [0, 1, 2, 3].map(|i| t[i].to_f32());
        let ways = corners(floats).map(|way| way.map(|x| big(f64::from(x))).to_vec());
        let w = ways.clone().map(|way| unit(&way));
        let n = [0, 1, 2].map(|i| unit(&cross(&w[i], &w[(i + 1) % 3])));
        // The angle at corner i lies between the edges that leave it.
        let angle = [0, 1, 2].map(|i| (-dot(&n[i], &n[(i + 2) % 3])).acos());
        let solid_angle = &angle[0] + &angle[1] + &angle[2] - pi();
        Self { w, ways, alpha: angle[0].clone(), solid_angle }
    }

    /// Arvo 1995, with the corners named so that the first number moves along the edge between the first and the last: barycentric
    /// coordinates.
    fn at(&self, u: &Big, v: &Big) -> Option<Vec<Big>> {
        let [a, b, c] = &self.w;
        let turns = |angle: &Big| (angle / (pi() * 2.0)).sin_cos_turns();
        let [sin_alpha, cos_alpha] = turns(&self.alpha);
        let [s, t] = turns(&(u * &self.solid_angle - &self.alpha));
        let (p, q) = (&t - &cos_alpha, &s + &sin_alpha * dot(a, b));
        let below = (&q * &s + &p * &t) * &sin_alpha;
        let cos =
            if below.abs() > big(1e-45) { ((&q * &t - &p * &s) * &cos_alpha - &q) / below } else { big(1.0) };
        let cos = cos.min(&big(1.0)).max(&big(-1.0));
        let towards = |from: &[Big], to: &[Big], cos: &Big| -> Vec<Big> {
            let along = dot(from, to);
            let aside = unit(&(0..3).map(|i| &to[i] - &along * &from[i]).collect::<Vec<_>>());
            let sin = (big(1.0) - cos.square()).sqrt();
            (0..3).map(|i| cos * &from[i] + &sin * &aside[i]).collect()
        };
        let d = towards(a, c, &cos);
        let d_from_b = dot(&d, b);
        let direction = towards(b, &d, &(big(1.0) - v * (big(1.0) - d_from_b)));
        // Shares of the ways that add up to that direction, by Cramer's rule.
        let [wa, wb, wc] = &self.ways;
        let shares = [cross(wb, wc), cross(wc, wa), cross(wa, wb)].map(|n| dot(&direction, &n));
        let sum = &shares[0] + &shares[1] + &shares[2];
        Some(shares.iter().map(|share| share / &sum).collect())
    }
}

/// What rounding makes of the sums of van Oosterom and Strackee for both halves of the rectangle, relative to them: their parts cancel where
/// an edge passes close by.
fn rounded_sums(a: &[f64]) -> f64 {
    let [x0, dx, y0, dy, z] = [0, 1, 2, 3, 4].map(|i| a[i]);
    let (x1, y1, z2) = (x0 + dx, y0 + dy, z * z);
    let r = |x: f64, y: f64| (x * x + y * y + z2).sqrt();
    let half = |[px, py]: [f64; 2]| {
        let (first, last) = (r(x0, y0), r(x1, y1));
        let between = r(px, py);
        let parts = [
            first * between * last,
            (x0 * px + y0 * py + z2) * last,
            (px * x1 + py * y1 + z2) * first,
            (x0 * x1 + y0 * y1 + z2) * between,
        ];
        parts.map(f64::abs).iter().sum::<f64>() / parts.iter().sum::<f64>().abs()
    };
    2e-7 * f64::max(half([x1, y0]), half([x0, y1]))
}

/// The rectangle of ends, lengths and distance.
fn rectangle(a: &[f32]) -> SphericalRectangle<f32> {
    SphericalRectangle::new([a[0], a[0] + a[1]], [a[2], a[2] + a[3]], a[4])
}

/// The triangle of a corner and a size.
fn triangle(a: &[f32]) -> SphericalTriangle<f32> {
    let [x, y, z, s] = [a[0], a[1], a[2], a[3]];
    let ways = [Vec3::new(x, y, z), Vec3::new(x + s, y, z), Vec3::new(x, y + s, z)];
    SphericalTriangle::new(ways, z * (ways[1].x - x) * (ways[2].y - y))
}

pub(crate) fn rows() -> Vec<Row> {
    vec![
        kernel!(scalar "rectangle: solid angle", [end(), size(), end(), size(), distance()],
            |a| [rectangle(a).solid_angle()],
            |t| Some(vec![solid_angle_of_rectangle(t)]),
            "2e-6, the rounding of the ends, and of the sums that half angles are quotients of",
            |a, s| s * (2e-6 + rounded_ends(a[0], a[1]) + rounded_ends(a[2], a[3]) + rounded_sums(a))),
        kernel!(scalar "triangle: solid angle", [end(), end(), distance(), size()],
            |a| [triangle(a).solid_angle()],
            |t| Some(vec![Triangle::new(t).solid_angle]),
            "2e-6, and the rounding of the ways over the distance of the plane",
            |a, s| s * (2e-6 + rounded_ways(a))),
        kernel!(scalar "triangle: barycentric coordinates by solid angle",
            [end(), end(), distance(), size(), few_numbers(), few_numbers()],
            |a| triangle(a).sample([a[4], a[5]]),
            |t| Triangle::new(t).at(&t[4], &t[5]),
            "1e-5, and four times the rounding of the ways over the distance of the plane and over the size",
            |a, _| 1e-5 + 4.0 * rounded_ways(a) + 1e-6 * reach(a) / a[3]),
    ]
}
