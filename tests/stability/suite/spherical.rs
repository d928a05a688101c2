//! Rectangles and triangles by solid angle, against the formulas as published: angles of spherical polygons, which cancel. One at a time:
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

/// What Urena, Fajardo and King 2013 draw with: the ends along x and y, the distance, cosines of two normals of edges, k, and the
/// solid angle.
struct Rectangle {
    x: [Big; 2],
    y: [Big; 2],
    z: Big,
    b: [Big; 2],
    k: Big,
    solid_angle: Big,
}

impl Rectangle {
    fn new(t: &[Big]) -> Self {
        let (x, y, z) = (ends(&t[0], &t[1]), ends(&t[2], &t[3]), -&t[4]);
        let corner = |i: usize, j: usize| [x[i].clone(), y[j].clone(), z.clone()];
        let way = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        let n = [0, 1, 2, 3].map(|i| unit(&cross(&way[i], &way[(i + 1) % 4])));
        let g = [0, 1, 2, 3].map(|i| (-dot(&n[i], &n[(i + 1) % 4])).acos());
        let k = pi() * 2.0 - &g[2] - &g[3];
        let solid_angle = &g[0] + &g[1] - &k;
        let b = [n[0][2].clone(), n[2][2].clone()];
        Self { x, y, z, b, k, solid_angle }
    }

    /// The point for a pair of numbers.
    fn at(&self, u: &Big, v: &Big) -> [Big; 2] {
        let [sin, cos] = ((u * &self.solid_angle + &self.k) / (pi() * 2.0)).sin_cos_turns();
        // Zero straight below the point, where the tangent is infinite.
        let sin = if sin == big(0.0) { big(1e-60) } else { sin };
        let fu = (cos * &self.b[0] - &self.b[1]) / sin;
        let cu = big(1.0) / (fu.square() + self.b[0].square()).sqrt();
        let cu = if fu.is_positive() { cu } else { -cu };
        let x = -(&cu * &self.z) / (big(1.0) - cu.square()).sqrt();
        let x = x.max(&self.x[0]).min(&self.x[1]);
        let d2 = x.square() + self.z.square();
        let [h0, h1] = [0, 1].map(|i| &self.y[i] / (&d2 + self.y[i].square()).sqrt());
        let h = &h0 + v * (h1 - &h0);
        let y = &h * d2.sqrt() / (big(1.0) - h.square()).sqrt();
        [x, y.max(&self.y[0]).min(&self.y[1])]
    }
}

/// From -1 to 1 between two ends.
fn within(x: &Big, ends: &[Big; 2]) -> Big {
    (x * 2.0 - &ends[0] - &ends[1]) / (&ends[1] - &ends[0])
}

/// How far a fraction of an edge is off where its ends are rounded.
fn rounded_ends(from: f64, size: f64) -> f64 {
    1.2e-7 * (from.abs() + size) / size
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
            |t| Some(vec![Rectangle::new(t).solid_angle]),
            "2e-6, and the rounding of the ends",
            |a, s| s * (2e-6 + rounded_ends(a[0], a[1]) + rounded_ends(a[2], a[3]))),
        kernel!(scalar "rectangle: point by solid angle, as fractions of the edges",
            [end(), size(), end(), size(), distance(), few_numbers(), few_numbers()],
            |a| rectangle(a).sample_within([a[5], a[6]]),
            |t| {
                let rectangle = Rectangle::new(t);
                let [x, y] = rectangle.at(&t[5], &t[6]);
                Some(vec![within(&x, &rectangle.x), within(&y, &rectangle.y)])
            },
            "1e-5, and the rounding of the ends",
            |a, _| 1e-5 + 4.0 * (rounded_ends(a[0], a[1]) + rounded_ends(a[2], a[3]))),
        kernel!(scalar "triangle: solid angle", [end(), end(), distance(), size()],
            |a| [triangle(a).solid_angle()],
            |t| Some(vec![Triangle::new(t).solid_angle]),
            "2e-6", |_, s| 2e-6 * s),
        kernel!(scalar "triangle: barycentric coordinates by solid angle",
            [end(), end(), distance(), size(), few_numbers(), few_numbers()],
            |a| triangle(a).sample([a[4], a[5]]),
            |t| Triangle::new(t).at(&t[4], &t[5]),
            "1e-5, and the rounding of the corners over the size",
            |a, _| 1e-5 + 1e-6 * (a[0].abs().max(a[1].abs()).max(a[2]) + a[3]) / a[3]),
    ]
}
