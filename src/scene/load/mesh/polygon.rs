//! From polygons to triangles.
//!
//! Strictly convex polygons become fans. From others, ears are cut off one by one (`ring`). Corners that stand in line
//! with their neighbours become corners of triangles with area like all others, so that polygons which share them fit
//! together without gaps.
//!
//! Outlines may run along themselves to holes, touch themselves and have corners twice. Polygons that cross themselves
//! have no right answer; they get as many triangles as any other.

use super::ring::Ring;
use glam::{DVec2, DVec3, Vec3};

/// How far from its plane a polygon counts as flat, in parts of its extent. Larger distorts bent polygons, smaller loses
/// exact arithmetic on flat ones.
const FLAT: f64 = 1e-4;

/// Memory that is used again from one polygon to the next.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    flat: Vec<DVec2>,
    ring: Ring,
}

impl Workspace {
    /// Triangles of a polygon, as indices into its corners, turning the way it does; two less than there are corners.
    pub(super) fn triangulate(&mut self, corners: &[Vec3], mut triangle: impl FnMut([usize; 3])) {
        if let Ok(quad) = <[Vec3; 4]>::try_from(corners) {
            return split(quad).into_iter().for_each(triangle);
        }
        let n = corners.len();
        flatten(corners, &mut self.flat);
        let flat = &self.flat;
        let turns_left = |i: usize| turn(flat[(i + n - 1) % n], flat[i], flat[(i + 1) % n]) > 0.0;
        if (0..n).all(turns_left) {
            (2..n).for_each(|i| triangle([0, i - 1, i]));
        } else {
            self.ring.cut(flat, triangle);
        }
    }
}

/// The triangles of a quad. The diagonal leaves from a corner that is not convex, if there is one.
fn split(corners: [Vec3; 4]) -> [[usize; 3]; 2] {
    let [a, b, c, d] = corners.map(|p| p.as_dvec3());
    // Twice the area as a vector.
    let normal = (c - a).cross(d - b);
    let turns_left = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - b).dot(normal) > 0.0;
    if turns_left(a, b, c) && turns_left(c, d, a) { [[0, 1, 2], [0, 2, 3]] } else { [[1, 2, 3], [1, 3, 0]] }
}

/// The corners in the plane that the polygon is most nearly in, turning counter-clockwise as a whole.
fn flatten(corners: &[Vec3], flat: &mut Vec<DVec2>) {
    let origin = corners[0].as_dvec3();
    let points = || corners.iter().map(|p| p.as_dvec3() - origin);
    let normal = normal(points());
    let extent = points().fold(0.0, |extent: f64, p| extent.max(p.abs().max_element()));
    let is_flat = points().all(|p| p.dot(normal).abs() <= FLAT * extent);
    let (x, y) = if is_flat { axes(normal) } else { normal.any_orthonormal_pair() };
    flat.clear();
    flat.extend(points().map(|p| DVec2::new(p.dot(x), p.dot(y))));
}

/// The direction of the area of a polygon whose first corner is the origin (Newell).
fn normal(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let (mut area, mut some, mut before) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
    for p in points {
        let part = before.cross(p);
        area += part;
        if some == DVec3::ZERO {
            some = part;
        }
        before = p;
    }
    // Products of coordinates down to 1e-45 and up to 1e18 are far from the ends of double precision, squares of such
    // products are not.
    let unit = |v: DVec3| (v / v.abs().max_element()).try_normalize();
    unit(area).or_else(|| unit(some)).unwrap_or(DVec3::Z)
}

/// The two axes other than the one that a normal is nearest to, counter-clockwise about it. Leaving a coordinate out
/// keeps the others as they are in single precision: turns in double precision then have the right sign.
fn axes(normal: DVec3) -> (DVec3, DVec3) {
    let size = normal.abs();
    let (x, y, along) = if size.x >= size.y && size.x >= size.z {
        (DVec3::Y, DVec3::Z, normal.x)
    } else if size.y >= size.z {
        (DVec3::Z, DVec3::X, normal.y)
    } else {
        (DVec3::X, DVec3::Y, normal.z)
    };
    if along < 0.0 { (y, x) } else { (x, y) }
}

/// Positive where the way from `a` by `b` to `c` turns left: twice the area of the triangle.
pub(super) fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    fn at(points: &[(f32, f32)]) -> Vec<Vec3> {
        points.iter().map(|&(x, y)| Vec3::new(x, y, 5.0)).collect()
    }

    /// Twice the area about +z, of a polygon or of triangles.
    fn doubled(corners: &[Vec3]) -> f64 {
        let p = |i: usize| corners[i % corners.len()].as_dvec3() - corners[0].as_dvec3();
        (0..corners.len()).map(|i| p(i).cross(p(i + 1)).z).sum()
    }

    /// Triangles of a polygon in a plane of constant z: as many as there should be, none turned over, none without area
    /// unless the polygon touches itself, and together as large as the polygon.
    fn check(name: &str, corners: &[Vec3]) {
        let touches = name.contains("touch");
        let (mut count, mut sum, mut used) = (0, 0.0, vec![touches; corners.len()]);
        Workspace::default().triangulate(corners, |triangle| {
            count += 1;
            triangle.iter().for_each(|&i| used[i] = true);
            let doubled = doubled(&triangle.map(|i| corners[i]));
            assert!(
                doubled > 0.0 || (touches && doubled == 0.0),
                "{name}: {triangle:?} has the doubled area {doubled}"
            );
            sum += doubled;
        });
        let whole = doubled(corners);
        assert_eq!(count, corners.len() - 2, "{name}: triangles");
        assert!((sum - whole).abs() <= 1e-10 * whole, "{name}: {sum}, not {whole}");
        assert!(used.iter().all(|&used| used), "{name}: a corner is in no triangle");
    }

    /// Whatever is done to a polygon that does not change what it covers.
    fn check_all_ways(name: &str, corners: &[Vec3]) {
        let mut corners = corners.to_vec();
        for start in 0..corners.len().min(7) {
            check(&format!("{name} from {start}"), &corners);
            corners.rotate_left(1);
        }
        let turned = Quat::from_axis_angle(Vec3::new(1.0, 2.0, -0.5).normalize(), 2.5);
        let moved: Vec<Vec3> = corners.iter().map(|p| turned * *p).collect();
        let normal = turned * Vec3::Z;
        let (mut sum, mut count) = (0.0, 0);
        Workspace::default().triangulate(&moved, |triangle| {
            let [a, b, c] = triangle.map(|i| moved[i].as_dvec3());
            sum += (b - a).cross(c - a).dot(normal.as_dvec3());
            count += 1;
        });
        let whole = doubled(&corners);
        assert_eq!(count, corners.len() - 2, "{name} turned: triangles");
        assert!((sum - whole).abs() <= 1e-4 * whole, "{name} turned: {sum}, not {whole}");
    }

    #[test]
    #[expect(clippy::too_many_lines, reason = "a table")]
    fn small_polygons_are_covered_once() {
        let cases: &[(&str, &[(f32, f32)])] = &[
            ("a square", &[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]),
            ("an arrow", &[(0.0, 0.0), (2.0, -1.0), (1.0, 0.0), (2.0, 1.0)]),
            ("a quad with a corner in line", &[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 2.0)]),
            (
                "a square with corners in line on every side",
                &[(0., 0.), (1., 0.), (2., 0.), (3., 0.), (3., 3.), (2., 3.), (1., 3.), (0., 3.), (0., 1.)],
            ),
            (
                "a triangle with corners in line",
                &[(0., 0.), (2., 0.), (4., 0.), (2., 2.), (0., 4.), (0., 2.)],
            ),
            (
                "two notches",
                &[
                    (0., 0.),
                    (5., 0.),
                    (5., 2.),
                    (4., 2.),
                    (4., 1.),
                    (3., 1.),
                    (3., 2.),
                    (2., 2.),
                    (2., 1.),
                    (1., 1.),
                    (1., 2.),
                    (0., 2.),
                ],
            ),
            (
                "a square with a square hole, by a bridge",
                &[
                    (0., 0.),
                    (4., 0.),
                    (4., 4.),
                    (0., 4.),
                    (0., 0.),
                    (1., 1.),
                    (1., 3.),
                    (3., 3.),
                    (3., 1.),
                    (1., 1.),
                ],
            ),
            (
                "two holes by bridges from one corner",
                &[
                    (0., 0.),
                    (9., 0.),
                    (9., 4.),
                    (0., 4.),
                    (0., 0.),
                    (1., 1.),
                    (1., 3.),
                    (3., 3.),
                    (3., 1.),
                    (1., 1.),
                    (0., 0.),
                    (5., 1.),
                    (5., 3.),
                    (7., 3.),
                    (7., 1.),
                    (5., 1.),
                ],
            ),
            (
                "two squares that touch at a corner",
                &[(0., 0.), (2., 0.), (2., 2.), (4., 2.), (4., 4.), (2., 4.), (2., 2.), (0., 2.)],
            ),
            (
                "a square with a hole that touches its corner",
                &[(0., 0.), (4., 0.), (4., 4.), (0., 4.), (0., 0.), (1., 2.), (2., 2.), (2., 1.)],
            ),
            (
                "a square whose side a hole touches",
                &[(0., 0.), (2., 0.), (1., 1.), (2., 2.), (3., 1.), (2., 0.), (4., 0.), (4., 4.), (0., 4.)],
            ),
            (
                "a square with a slit and corners twice, which touches itself",
                &[(0., 0.), (0., 0.), (4., 0.), (4., 4.), (2., 2.), (4., 4.), (0., 4.), (0., 4.), (0., 0.)],
            ),
        ];
        for (name, points) in cases {
            check_all_ways(name, &at(points));
        }
    }

    /// A generator of numbers in [0, 1) (Knuth 1997, The Art of Computer Programming 2, section 3.3.4).
    fn random(state: &mut u64) -> f32 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f32::from(u16::try_from(*state >> 48).expect("16 bits")) / 65536.0
    }

    #[test]
    fn ragged_stars_are_covered_once() {
        let mut state = 1;
        for n in (5..60).chain([500, 1001, 5000]) {
            for _ in 0..3 {
                let star: Vec<Vec3> = (0..n)
                    .map(|i| {
                        let radius = 0.1 + random(&mut state);
                        let (y, x) = (i as f32 / n as f32 * std::f32::consts::TAU).sin_cos();
                        Vec3::new(x * radius, y * radius, -3.0)
                    })
                    .collect();
                check_all_ways(&format!("a star of {n}"), &star);
            }
        }
    }

    #[test]
    fn long_outlines_are_covered_once_and_soon() {
        let n = 50_000;
        let comb = |turn: fn(f32, f32) -> Vec3| -> Vec<Vec3> {
            let teeth = (0..n).map(|i| turn((n - i) as f32, if i % 2 == 0 { 1000.0 } else { 1.0 }));
            [turn(0.0, 0.0), turn(n as f32 + 1.0, 0.0)].into_iter().chain(teeth).collect()
        };
        let spiral: Vec<Vec3> = (0..n)
            .map(|i| (i as f32, 1.0))
            .chain((0..n).rev().map(|i| (i as f32, 0.0)))
            .map(|(i, outer)| {
                let (radius, angle) = (100.0 + i * 0.01 + outer * 0.3, i * std::f32::consts::TAU / 60.0);
                Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
            })
            .collect();
        // The spiral as written turns about its inside.
        let spiral = if doubled(&spiral) > 0.0 { spiral } else { spiral.into_iter().rev().collect() };
        let round: Vec<Vec3> = (0..n)
            .map(|i| {
                let (y, x) = (i as f32 / n as f32 * std::f32::consts::TAU).sin_cos();
                Vec3::new(x, y, 0.0) * if i % 3 == 0 { 1000.0 } else { 1001.0 }
            })
            .collect();
        for (name, corners) in [
            ("a comb upwards", comb(|x, y| Vec3::new(x, y, 0.0))),
            ("a comb sidewards", comb(|x, y| Vec3::new(-y, x, 0.0))),
            ("a slanted comb", comb(|x, y| Vec3::new(x - y, x + y, 0.0))),
            ("a spiral", spiral),
            ("a gear", round),
        ] {
            let start = cpu_time::ThreadTime::now();
            check(name, &corners);
            let took = start.elapsed();
            assert!(took.as_secs_f32() < 5.0, "{name} took {took:?}");
        }
    }

    /// No right answer, but an answer, and soon.
    #[test]
    fn tangles_are_cut_into_as_many_triangles() {
        let mut state = 1;
        let mut tangle = |n: usize, steps: f32| -> Vec<Vec3> {
            let mut coordinate = || (random(&mut state) * steps).floor();
            (0..n).map(|_| Vec3::new(coordinate(), coordinate(), coordinate())).collect()
        };
        let bow = at(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]);
        let line = at(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (1.5, 0.0)]);
        let mut cases = vec![bow, line, vec![Vec3::ONE; 9]];
        for n in 3..50 {
            cases.extend([tangle(n, 3.0), tangle(n, 1e6)]);
        }
        cases.extend([tangle(1000, 10.0), tangle(30_000, 10.0), tangle(30_000, 1e6)]);
        for corners in cases {
            let start = cpu_time::ThreadTime::now();
            let mut count = 0;
            Workspace::default().triangulate(&corners, |_| count += 1);
            assert_eq!(count, corners.len() - 2, "{corners:?}");
            let took = start.elapsed();
            assert!(took.as_secs_f32() < 10.0, "{} corners took {took:?}", corners.len());
        }
    }

    #[test]
    fn size_and_place_do_not_matter() {
        let arrow = at(&[(2.0, -1.0), (1.0, 0.0), (2.0, 1.0), (0.0, 0.0), (1.0, -0.5)]);
        for (scale, offset) in [(1e-38, 0.0), (1e-20, 0.0), (1.0, 1e5), (1e17, 0.0), (1e17, 5e17)] {
            let moved: Vec<Vec3> = arrow.iter().map(|p| *p * scale + offset).collect();
            check(&format!("scaled by {scale}, moved by {offset}"), &moved);
        }
    }
}
