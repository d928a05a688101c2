//! Rays and shapes, points, offsets and transforms: single precision, one at a time. Cylinders, cones and tori find their hits in double
//! precision, as roots of polynomials: `tests/surfaces.rs` holds them against their equations over bodies from 1e-6 to 1e6, grazing and
//! far rays among them.

use super::axes::{above, around, number, place, scale};
use super::big::{Big, along, big, cross, dot, minus};
use super::row::Row;
use glam::{Affine3A, Mat3A, Quat, Vec3};
use specula::geometry::{Disc, Mesh, Points, Sphere, intersect_triangle, spawn};
use specula::math::Transform;

fn vec(a: &[f32]) -> Vec3 {
    Vec3::new(a[0], a[1], a[2])
}

/// A sphere that the ray from `from` along `d` passes at `miss` of its radius, `far` radii away.
fn sphere(from: &[f32], d: Vec3, [radius, far, miss]: [f32; 3]) -> Sphere {
    let aside = d.any_orthonormal_vector();
    Sphere { center: vec(from) + d * (radius * far) + aside * (radius * miss), radius }
}

/// A map that turns, scales and moves.
fn transform(turn: f32, scale: f32, to: Vec3) -> Transform {
    let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), turn * std::f32::consts::TAU);
    Transform::new(Affine3A { matrix3: Mat3A::from_quat(turn) * scale, translation: to.into() })
        .expect("turns and scales have inverses")
}

fn exact(v: Vec3) -> [Big; 3] {
    v.to_array().map(|x| big(f64::from(x)))
}

fn floats(t: &[Big]) -> Vec<f32> {
    t.iter().map(|x| x.to_f64() as f32).collect()
}

/// How far an origin was moved along the normal, and the error's share of that normal.
fn offset(a: &[f32]) -> [f64; 2] {
    let (p, n) = (vec(a), vec(&a[3..6]));
    let error = (p.abs() + a[6]) * 3e-7;
    let moved = Vec3::from(spawn::origin::<f32>(p.into(), error.into(), n.into(), n.into()));
    [(moved.as_dvec3() - p.as_dvec3()).dot(n.as_dvec3()), error.as_dvec3().dot(n.abs().as_dvec3())]
}

/// A thin triangle of that size at those coordinates, and a point's parameters.
fn needle(a: &[f32]) -> ([Vec3; 3], [f32; 2]) {
    let (base, size) = (vec(a), a[3]);
    let corners =
        [base, base + Vec3::new(size, 0.1 * size, 0.0), base + Vec3::new(size, 0.1 * size, 0.01 * size)];
    (corners, [a[4] * 0.5, a[5] * 0.5])
}

fn points(corners: [Vec3; 3], uv: [f32; 2]) -> Points<f32> {
    let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2]]).expect("a triangle");
    mesh.points::<f32>(0, uv, Vec3::Z.into(), false)
}

/// Where the point of `needle` is.
fn place_truth(t: &[Big]) -> [Big; 3] {
    let (corners, [u, v]) = needle(&floats(t));
    let [a, b, c] = corners.map(exact);
    let [u, v] = [u, v].map(|x| big(f64::from(x)));
    [0, 1, 2].map(|k| &a[k] + &u * (&b[k] - &a[k]) + &v * (&c[k] - &a[k]))
}

/// How far along the ray it enters the sphere, both exactly as the floats say; `None` where it misses or nearly so.
fn sphere_truth(t: &[Big]) -> Option<Vec<Big>> {
    let a = floats(t);
    let d = exact(vec(&a[3..6]));
    let sphere = sphere(&a[..3], vec(&a[3..6]), [a[6], 8.0, a[7]]);
    let (center, radius) = (exact(sphere.center), big(f64::from(sphere.radius)));
    let to = minus(&center, &t[..3]);
    let (dd, b) = (dot(&d, &d), dot(&to, &d));
    let c = dot(&to, &to) - radius.square();
    let disc = b.square() - &dd * &c;
    // Aimed at the rim, or so far from the origin that the place of the sphere is rounded away.
    if disc < radius.square() * &dd * 1e-3 || !c.is_positive() || !b.is_positive() {
        return None;
    }
    Some(vec![(b - disc.sqrt()) / dd])
}

/// The size of what is subtracted: positions, and the way.
fn reach(a: &[f64], way: f64) -> f64 {
    a[..3].iter().fold(way, |m, x| m.max(x.abs()))
}

#[expect(clippy::too_many_lines, reason = "a list")]
pub(crate) fn rows() -> Vec<Row> {
    vec![
        kernel!(scalar "sphere: ray parameter", [place(), around(), scale(), number()], |a| {
                let d = vec(&a[3..6]);
                let hit = sphere(&a[..3], d, [a[6], 8.0, a[7]]).intersect(vec(a), d, 0.0, f32::INFINITY);
                [hit.unwrap_or(-1.0)]
            },
            |t| sphere_truth(t), "4e-6 of the way, and 4e-7 of the coordinates",
            |a, t| 4e-6 * t + 4e-7 * reach(a, 0.0)),
        kernel!(scalar "disc: ray parameter", [place(), above(), scale(), number()], |a| {
            let n = Vec3::new(0.6, 0.0, 0.8);
            let d = -vec(&a[3..6]);
            let disc = Disc { center: vec(a) + d * a[6], normal: n, radius: a[6] * 2.0 };
            [disc.intersect(vec(a), d, 0.0, f32::INFINITY).unwrap_or(-1.0)]
        },
        |t| {
            let a = floats(t);
            let n = Vec3::new(0.6, 0.0, 0.8);
            let d = -vec(&a[3..6]);
            let center = exact(vec(&a) + d * a[6]);
            let across = dot(&exact(d), &exact(n));
            if across.abs() < big(1e-3) {
                return None;
            }
            let way = dot(&minus(&center, &t[..3]), &exact(n)) / &across;
            let at = minus(&along(&t[..3], &way, &exact(d)), &center);
            let inside = dot(&at, &at) < big(f64::from(a[6])).square() * 3.9;
            (inside && way.is_positive()).then(|| vec![way])
        },
        "1e-6 of the way and 3e-7 of the coordinates, over the cosine", |a, t| {
            let cos = (0.6 * a[3] + 0.8 * a[5]).abs();
            (1e-6 * t + 3e-7 * reach(a, a[6])) / cos
        }),
        kernel!(scalar "triangle: ray parameter and coordinates", [place(), above(), scale(), number(), number()], |a| {
                let [o, d, corners] = triangle(a);
                let hit = intersect_triangle(corners, o[0], d[0], 0.0, f32::INFINITY);
                hit.unwrap_or([-1.0; 3])
            },
            |t| triangle_truth(t), "1.5e-7", |_, t| 1.5e-7 * t),
        kernel!(scalar "offset: how far the origin moved, less the error's share of the normal, when too little",
            [place(), around(), scale()], |a| {
                let [way, least] = offset(a);
                [(way - least).min(0.0) as f32]
            },
            |_| Some(vec![big(0.0)]), "1e-6 of the offset", |a, _| 1e-6 * 3e-7 * (reach(a, 0.0) + a[6]) * 2.0),
        kernel!(scalar "offset: how far the origin moved beyond the error's share of the normal",
            [place(), around(), scale()], |a| {
                let [way, least] = offset(a);
                [(way - least) as f32]
            },
            // A rounding and the step to the next number, on each axis by its share of the normal.
            |_| Some(vec![big(0.0)]), "4e-7 of the coordinates", |a, _| 4e-7 * reach(a, 0.0) + 1e-6 * 3e-7 * a[6]),
        kernel!(scalar "points: of a triangle", [place(), scale(), number(), number()], |a| {
                let (corners, [u, v]) = needle(a);
                Vec3::from(points(corners, [u, v]).p).to_array()
            },
            |t| Some(place_truth(t).to_vec()), "3e-7 of the corners", |a, _| 3e-7 * (reach(a, 0.0) + 2.0 * a[3])),
        kernel!(scalar "points: how far beyond the stated error a triangle's point is", [place(), scale(), number(), number()], |a| {
                let (corners, [u, v]) = needle(a);
                let found = points(corners, [u, v]);
                let truth = place_truth(&a.iter().map(|x| big(f64::from(*x))).collect::<Vec<_>>());
                let [p, error] = [found.p, found.p_error].map(|w| Vec3::from(w).to_array().map(f64::from));
                let beyond = |k: usize| (truth[k].to_f64() - p[k]).abs() - error[k];
                [beyond(0).max(beyond(1)).max(beyond(2)).max(0.0) as f32]
            },
            |_| Some(vec![big(0.0)]), "not at all", |_, _| 0.0),
        kernel!(scalar "points: of a sphere, less its radius, within the stated error", [place(), around(), scale()], |a| {
                let sphere = Sphere { center: vec(a), radius: a[6] };
                // A hit is off by some roundings.
                let near = vec(a) + vec(&a[3..6]) * (a[6] * (1.0 + 1e-6));
                let found = sphere.points::<f32>(near.into());
                let (p, error) = (Vec3::from(found.p).as_dvec3(), Vec3::from(found.p_error).as_dvec3());
                // The nearest of the sphere along the normal found.
                let n = Vec3::from(found.ng).as_dvec3().normalize();
                let off = (sphere.center.as_dvec3() + n * f64::from(sphere.radius) - p).abs();
                [(off - error).max_element().max(0.0) as f32]
            },
            |_| Some(vec![big(0.0)]), "not beyond it", |_, _| 0.0),
        kernel!(scalar "transform: point", [place(), number(), scale(), place()], |a| {
                transform(a[3], a[4], vec(&a[5..8])).point(vec(a)).to_array()
            },
            |t| {
                let a = floats(t);
                let map = *transform(a[3], a[4], vec(&a[5..8])).world_from_object();
                Some(image(&map, &t[..3]))
            },
            "3e-7 of the terms", |a, _| 4e-7 * (reach(a, 0.0) * a[4] + reach(&a[5..8], 0.0))),
        kernel!(scalar "transform: there and back", [place(), number(), scale()], |a| {
                let map = transform(a[3], a[4], Vec3::ZERO);
                map.inverse_point(map.point(vec(a))).to_array()
            },
            |t| Some(t[..3].to_vec()), "2e-6", |a, _| 2e-6 * reach(a, 0.0)),
        kernel!(scalar "transform: normal times tangent", [around(), number(), scale()], |a| {
                let map = transform(a[3], a[4], Vec3::ZERO);
                let n = vec(a);
                let tangent = n.any_orthonormal_vector();
                [map.normal(n).normalize().dot(map.vector(tangent).normalize())]
            },
            |_| Some(vec![big(0.0)]), "1e-6", |_, _| 1e-6),
    ]
}

fn image(map: &Affine3A, p: &[Big]) -> Vec<Big> {
    let [x, y, z] =
        [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis].map(|axis| exact(axis.into()));
    let moved = exact(map.translation.into());
    along(&along(&along(&moved, &p[0], &x), &p[1], &y), &p[2], &z)
}

/// Origin, direction and corners of a ray that meets a triangle of that size at those coordinates.
fn triangle(a: &[f32]) -> [[Vec3; 3]; 3] {
    let (base, d, size) = (vec(a), -vec(&a[3..6]), a[6]);
    let corners = [base, base + Vec3::new(size, 0.0, 0.0), base + Vec3::new(0.0, size, size * 0.5)];
    let (u, v) = (a[7] * 0.5, a[8] * 0.4);
    let p = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
    [[p - d * (size * 4.0); 3], [d; 3], corners]
}

fn triangle_truth(t: &[Big]) -> Option<Vec<Big>> {
    let [o, d, corners] = triangle(&floats(t));
    let (o, d) = (exact(o[0]), exact(d[0]));
    let [a, b, c] = corners.map(exact);
    let (ab, ac, ao) = (minus(&b, &a), minus(&c, &a), minus(&o, &a));
    // Cramer's rule.
    let n = cross(&ab, &ac);
    let det = -dot(&d, &n);
    if det.abs() <= dot(&n, &n).sqrt() * 1e-3 {
        return None;
    }
    let side = cross(&ao, &d);
    let (u, v, way) = (dot(&ac, &side) / &det, -dot(&ab, &side) / &det, dot(&ao, &n) / &det);
    let inside = u > big(1e-3) && v > big(1e-3) && &u + &v < big(0.999) && way.is_positive();
    inside.then(|| vec![way, u, v])
}
