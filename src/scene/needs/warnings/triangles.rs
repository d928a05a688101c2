//! Triangles that are too thin, too small for where they are, or too near to others.
//!
//! Needles and small triangles are counted in one pass. Surfaces that nearly coincide are found by short rays across every
//! triangle, through its middle and near its corners, with a hierarchy over all of them: n log n. Surfaces that overlap at none of
//! these places are not found; meshes that move, and shapes that are no meshes, are left out.
//!
//! Surfaces in one plane coincide where such a place is well inside of the other triangle, so neighbours do not. Most that do are meant, and
//! nobody sees it: a box that stands on a floor, a wall between two blocks. So only those count that the camera sees, past all triangles,
//! and of one shape only those that face the same way: sheets may have two sides. Coincidence that mirrors alone show is not told.

use super::{at, length};
use crate::accel::bvh::{Options, Preset};
use crate::accel::{Accel, Bvh2Accel};
use crate::error::{Place, Problem};
use crate::geometry::{HitFilter, Mesh, Pose, Ray, Shape, ShapeHit, World};
use crate::math::float::gamma;
use crate::scene::Scene;
use glam::{DVec3, Vec3};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::sync::Arc;

/// Longest edge over height from which on a triangle is a needle: beyond it the bound on the error of a plane, by which rays start off
/// it, no longer grows (`geometry/points.rs`).
const NEEDLE: f64 = 1e3;

/// A triangle is coarse whose longest edge has fewer than this many times the error of its corners.
const COARSE: f32 = 16.0;

/// Sine of the greatest angle between triangles that count as parallel: over a triangle's width it is less than the gap.
const PARALLEL: f64 = 1e-3;

/// How far inside of a triangle, as a part of it, is no longer its edge.
const INSIDE: f32 = 1e-3;

/// Triangles looked at, at most.
const MOST: usize = 1 << 25;

/// Barycentric parameters that are looked at across every triangle.
const PROBES: [[f32; 2]; 4] = [[1.0 / 3.0, 1.0 / 3.0], [0.1, 0.1], [0.8, 0.1], [0.1, 0.8]];

/// What is odd about the triangles of a scene.
pub(super) fn of(scene: &Scene, origins: &[Place]) -> Vec<Problem> {
    let Some(soup) = Soup::of(&scene.world) else { return Vec::new() };
    let coincident = soup.coincident(origins, scene.camera.eye(0.0));
    [soup.needles(origins), soup.coarse(origins)].into_iter().chain(coincident).flatten().collect()
}

/// Triangles of all meshes that stand still, in the world.
struct Soup {
    mesh: Mesh,
    /// The same as a shape.
    shape: Shape,
    /// The first triangle of each placement that has any, and the placement.
    starts: Vec<(u32, usize)>,
}

impl Soup {
    fn of(world: &World) -> Option<Self> {
        let (mut positions, mut triangles, mut starts) = (Vec::new(), Vec::<[u32; 3]>::new(), Vec::new());
        for (index, placement) in world.placements.iter().enumerate() {
            let Shape::Mesh(mesh) = &world.shapes[placement.shape.index()] else { continue };
            if mesh.key_count() > 1 || triangles.len() + mesh.triangles().len() > MOST {
                continue;
            }
            let placed = match &placement.pose {
                Pose::World => mesh.clone(),
                Pose::Still(transform) => mesh.transformed(transform),
                Pose::Moving(_) => continue,
            };
            let first = u32::try_from(positions.len()).ok()?;
            starts.push((u32::try_from(triangles.len()).ok()?, index));
            positions.extend_from_slice(placed.positions());
            triangles.extend(placed.triangles().iter().map(|corners| corners.map(|i| i + first)));
        }
        let mesh = Mesh::new(positions, triangles).ok()?;
        let shape = Shape::Mesh(mesh.clone());
        (!starts.is_empty()).then_some(Self { mesh, shape, starts })
    }

    fn count(&self) -> u32 {
        u32::try_from(self.mesh.triangles().len()).unwrap_or(u32::MAX)
    }

    /// The placement that a triangle is of.
    fn placement(&self, triangle: u32) -> Option<usize> {
        let next = self.starts.partition_point(|(first, _)| *first <= triangle);
        Some(self.starts[next.checked_sub(1)?].1)
    }

    /// Where the shape of a triangle was described.
    fn place<'a>(&self, triangle: u32, origins: &'a [Place]) -> Option<&'a Place> {
        origins.get(self.placement(triangle)?)
    }

    /// The triangles of which a number is above a limit: how many, and the one with the greatest.
    fn worst(&self, limit: f64, of: impl Fn(u32) -> f64) -> Option<(usize, u32, f64)> {
        let mut found: Option<(usize, u32, f64)> = None;
        for triangle in 0..self.count() {
            let value = of(triangle);
            if value > limit {
                let (count, worst, most) = found.unwrap_or((0, triangle, value));
                let (worst, most) = if value > most { (triangle, value) } else { (worst, most) };
                found = Some((count + 1, worst, most));
            }
        }
        found
    }

    fn needles(&self, origins: &[Place]) -> Option<Problem> {
        let (count, worst, most) = self.worst(NEEDLE, |triangle| {
            let [a, b, c] = self.mesh.corners(triangle).map(Vec3::as_dvec3);
            let longest = edges([a, b, c]).into_iter().fold(0.0, f64::max);
            let height = (b - a).cross(c - a).length() / longest;
            // What has no area at all is never hit.
            if height > 0.0 { longest / height } else { 0.0 }
        })?;
        let what = format!(
            "{} of {} triangles {}, the worst {most:.0} times longer than high: their planes, and so normals and the starts of \
             rays, are known badly",
            count,
            self.count(),
            if count == 1 { "is a needle" } else { "are needles" },
        );
        Some(
            at(self.place(worst, origins), what)
                .remedy("mesh the surface again with triangles of better shape"),
        )
    }

    fn coarse(&self, origins: &[Place]) -> Option<Problem> {
        let error_over_edge = |triangle: u32| {
            let corners = self.mesh.corners(triangle);
            let longest = edges(corners.map(Vec3::as_dvec3)).into_iter().fold(0.0, f64::max);
            let reach = corners.map(|p| p.abs().max_element()).into_iter().fold(0.0, f32::max);
            if longest > 0.0 { f64::from(gamma(7) * reach) / longest } else { 0.0 }
        };
        let (count, worst, most) = self.worst(f64::from(COARSE).recip(), error_over_edge)?;
        let [a, ..] = self.mesh.corners(worst);
        let error = gamma(7) * a.abs().max_element();
        #[expect(clippy::cast_possible_truncation, reason = "for people")]
        let edge = (f64::from(error) / most) as f32;
        let what = format!(
            "{count} of {} triangles {} too small for where {}: the smallest has edges of {}, while points there are known to {}",
            self.count(),
            if count == 1 { "is" } else { "are" },
            if count == 1 { "it is" } else { "they are" },
            length(edge),
            length(error),
        );
        let remedy = "bring them near the origin of the scene, camera and lights too, or use fewer triangles";
        Some(at(self.place(worst, origins), what).remedy(remedy))
    }

    /// Triangles that coincide with others, and those that nearly do.
    fn coincident(&self, origins: &[Place], eye: Vec3) -> [Option<Problem>; 2] {
        let accel = self.hierarchy(true);
        let meetings = |triangle| PROBES.into_iter().map(move |probe| (triangle, probe));
        let met: Vec<Meeting> = (0..self.count())
            .into_par_iter()
            .flat_map_iter(meetings)
            .filter_map(|(triangle, probe)| self.meeting(&accel, triangle, probe))
            .collect();
        drop(accel);
        let (near, mut same): (Vec<_>, Vec<_>) = met.into_iter().partition(|meeting| meeting.gap > 0.0);
        if !same.is_empty() {
            let accel = self.hierarchy(false);
            same.retain(|meeting| self.is_seen(&accel, meeting, eye));
        }
        [self.same(&by_triangle(same), origins), self.near(&by_triangle(near), origins)]
    }

    /// One over all triangles; in that of `neighbours` rays meet only what coincides, or nearly, with the triangle that they cross.
    fn hierarchy(&self, neighbours: bool) -> Bvh2Accel {
        let mut world = World::default();
        let shape = world.add_shape(self.shape.clone());
        world.place(shape, None);
        if neighbours {
            world.filters.insert(shape, Arc::new(Near { mesh: self.mesh.clone() }));
        }
        Bvh2Accel::build(&Arc::new(world), &Options { preset: Preset::Fastest, ..Options::default() })
    }

    fn same(&self, met: &[Meeting], origins: &[Place]) -> Option<Problem> {
        let &Meeting { triangle, other, probe, .. } = met.first()?;
        let what = format!(
            "{} of {} triangles coincide exactly with others{}, where the camera sees them: which of both a ray meets is left to chance",
            met.len(),
            self.count(),
            self.beside(other, origins),
        );
        let lift = length(self.lift(triangle, probe).1);
        let remedy = format!("take one of both away, or move them apart by more than {lift}");
        Some(at(self.place(triangle, origins), what).remedy(remedy))
    }

    fn near(&self, met: &[Meeting], origins: &[Place]) -> Option<Problem> {
        let &Meeting { triangle, other, .. } = met.first()?;
        let gaps = met.iter().map(|meeting| meeting.gap);
        let [least, most] = gaps.fold([f64::INFINITY, 0.0_f64], |[a, b], gap| [a.min(gap), b.max(gap)]);
        #[expect(clippy::cast_possible_truncation, reason = "for people")]
        let [least, most] = [least as f32, most as f32];
        let lift = self.lift(triangle, PROBES[0]).1;
        let what = format!(
            "{} of {} triangles nearly coincide with others, {} to {} apart{}, where rays start {} off a surface: they pass what \
             lies nearer",
            met.len(),
            self.count(),
            length(least),
            length(most),
            self.beside(other, origins),
            length(lift),
        );
        let remedy =
            format!("make one surface of both, or move them apart by more than {}", length(lift.max(most)));
        Some(at(self.place(triangle, origins), what).remedy(remedy))
    }

    /// Which triangle another one is beside, in brackets.
    fn beside(&self, other: u32, origins: &[Place]) -> String {
        self.place(other, origins).map_or_else(String::new, |place| format!(" (beside {place})"))
    }

    /// A point of a triangle, how far off it rays start, and its normal.
    fn lift(&self, triangle: u32, [u, v]: [f32; 2]) -> (Vec3, f32, Vec3) {
        let [a, b, c] = self.mesh.corners(triangle);
        let hit = ShapeHit { t: 0.0, u, v, ng: (b - a).cross(c - a) };
        let point = self.shape.point(triangle, &Ray::new(a, Vec3::Z), &hit);
        (point.p, point.ng.abs().dot(point.p_error), point.ng)
    }

    /// What coincides, or nearly, with a triangle at one of its places.
    fn meeting(&self, accel: &Bvh2Accel, triangle: u32, probe: [f32; 2]) -> Option<Meeting> {
        let (p, lift, n) = self.lift(triangle, probe);
        // From one side to the other, with room for the rounding of the start.
        let ray = Ray::new(p - n * (1.5 * lift), n).until(3.0 * lift).seeing(triangle + 1);
        if !ray.is_traceable() {
            return None;
        }
        let other = accel.intersect(&ray)?.prim;
        Some(Meeting { triangle, other, probe, gap: gap(&self.mesh, triangle, other) })
    }

    /// Whether the camera sees what coincides, and it is not the other side of the same sheet.
    fn is_seen(&self, accel: &Bvh2Accel, meeting: &Meeting, eye: Vec3) -> bool {
        let &Meeting { triangle, other, probe, .. } = meeting;
        let [own, its] = [triangle, other].map(|it| normal(&self.mesh, it));
        if own.dot(its) <= 0.0 && self.placement(triangle) == self.placement(other) {
            return false;
        }
        let (p, lift, n) = self.lift(triangle, probe);
        let way = eye - p;
        let start = p + n * (1.5 * lift).copysign(way.dot(n));
        let ray = Ray::new(start, eye - start).until(1.0);
        ray.is_traceable() && !accel.occluded(&ray)
    }
}

/// A triangle at a place of which there is another one.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    triangle: u32,
    other: u32,
    /// Where, as barycentric parameters.
    probe: [f32; 2],
    /// How far apart their planes are; zero where they are one.
    gap: f64,
}

/// The first meeting of each triangle.
fn by_triangle(mut met: Vec<Meeting>) -> Vec<Meeting> {
    met.dedup_by_key(|meeting| meeting.triangle);
    met
}

/// Accepts only triangles that coincide, or nearly, with the one whose number, from 1, is the mask of the ray.
#[derive(Debug)]
struct Near {
    mesh: Mesh,
}

impl HitFilter for Near {
    fn accepts(&self, ray: &Ray, hit: &ShapeHit, prim: u32) -> bool {
        let own = ray.mask - 1;
        if own == prim {
            return false;
        }
        let [n, other] = [own, prim].map(|triangle| normal(&self.mesh, triangle));
        if n.cross(other).length() >= PARALLEL {
            return false;
        }
        let gap = gap(&self.mesh, own, prim);
        if gap > 0.0 { gap <= f64::from(ray.t_max / 3.0) } else { is_inside(hit) && n.dot(other).abs() > 0.5 }
    }
}

/// Whether a hit is well inside of its triangle.
fn is_inside(hit: &ShapeHit) -> bool {
    hit.u.min(hit.v).min(1.0 - hit.u - hit.v) > INSIDE
}

/// How far the corners of a triangle are from the plane of another, at most.
fn gap(mesh: &Mesh, triangle: u32, other: u32) -> f64 {
    let n = normal(mesh, other);
    let [on, ..] = mesh.corners(other).map(Vec3::as_dvec3);
    mesh.corners(triangle).into_iter().map(|p| (p.as_dvec3() - on).dot(n).abs()).fold(0.0, f64::max)
}

fn normal(mesh: &Mesh, triangle: u32) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle).map(Vec3::as_dvec3);
    (b - a).cross(c - a).normalize_or_zero()
}

fn edges([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    [(b - a).length(), (c - b).length(), (a - c).length()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world(meshes: &[Vec<[Vec3; 3]>]) -> World {
        let mut world = World::default();
        for triangles in meshes {
            let positions = triangles.concat();
            let indices = (0..u32::try_from(positions.len()).expect("few")).collect::<Vec<_>>();
            let indices = indices.chunks(3).map(|i| [i[0], i[1], i[2]]).collect();
            let shape = world.add_shape(Shape::Mesh(Mesh::new(positions, indices).expect("a mesh")));
            world.place(shape, None);
        }
        world
    }

    fn places() -> Vec<Place> {
        ["a", "b"].map(|name| Place::file(std::path::Path::new(name))).into()
    }

    /// A right triangle in the plane `z = height`, with legs of `size` from `at` on.
    fn flat(at: Vec3, size: f32) -> [Vec3; 3] {
        [at, at + Vec3::X * size, at + Vec3::Y * size]
    }

    /// Above the flat triangles.
    const EYE: Vec3 = Vec3::new(0.3, 0.2, 5.0);

    fn told(problem: Option<Problem>) -> String {
        problem.map(|problem| problem.to_string()).unwrap_or_default()
    }

    #[test]
    fn needles_are_counted_and_the_worst_is_named() {
        let needle = |height: f32| [Vec3::ZERO, Vec3::X, Vec3::new(0.5, height, 0.0)];
        let good = Soup::of(&world(&[vec![flat(Vec3::ZERO, 1.0), needle(2e-3)]])).expect("triangles");
        assert_eq!(good.needles(&places()), None, "no needle");
        let bad = [vec![flat(Vec3::ZERO, 1.0), needle(9e-4)], vec![needle(1e-4), needle(0.0)]];
        let told = told(Soup::of(&world(&bad)).expect("triangles").needles(&places()));
        assert!(told.starts_with("b: 2 of 4 triangles are needles, the worst 10000 times longer"), "{told}");
    }

    #[test]
    fn small_triangles_far_out_are_told() {
        let of =
            |at: Vec3, size| Soup::of(&world(&[vec![flat(at, size)]])).expect("triangles").coarse(&places());
        assert_eq!(of(Vec3::X * 100.0, 1e-2), None, "a centimetre at a hundred metres");
        assert_eq!(of(Vec3::ZERO, 1e-7), None, "however small at home");
        let told = told(of(Vec3::X * 100.0, 1e-4));
        assert!(told.starts_with("a: 1 of 1 triangles is too small for where it is: the smallest"), "{told}");
        assert!(told.contains("141 um") || told.contains("0.14 mm"), "its longest edge: {told}");
    }

    #[test]
    fn surfaces_closer_than_rays_start_off_them_are_told() {
        let of = |gap: f32| {
            let upper = flat(Vec3::new(0.1, 0.1, 1.0 + gap), 0.3);
            let soup = Soup::of(&world(&[vec![flat(Vec3::Z, 1.0)], vec![upper]])).expect("triangles");
            let [same, near] = soup.coincident(&places(), EYE);
            assert_eq!(same, None, "planes of their own");
            near
        };
        assert_eq!(of(1e-4), None, "far enough");
        let problem = of(2.0 * f32::EPSILON);
        let told = told(problem);
        assert!(
            told.contains("of 2 triangles nearly coincide with others, 0.24 um to 0.24 um apart"),
            "{told}"
        );
        assert!(told.starts_with("b: 1 ") || told.starts_with("a: 2 "), "places: {told}");
    }

    #[test]
    fn neighbours_that_share_an_edge_do_not_coincide() {
        let quad = vec![flat(Vec3::ZERO, 1.0), [Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]];
        let folded = vec![flat(Vec3::ZERO, 1.0), [Vec3::ZERO, Vec3::Y, Vec3::new(1.0, 0.0, 0.5)]];
        for mesh in [quad, folded] {
            let soup = Soup::of(&world(&[mesh])).expect("triangles");
            assert_eq!(soup.coincident(&places(), EYE), [None, None], "neighbours");
        }
    }

    #[test]
    fn surfaces_in_one_plane_that_the_camera_sees_are_told() {
        let (floor, rug) = (flat(Vec3::ZERO, 1.0), flat(Vec3::new(0.1, 0.1, 0.0), 0.3));
        let turned = |[a, b, c]: [Vec3; 3]| [a, c, b];
        let of = |meshes: &[Vec<[Vec3; 3]>]| {
            let [same, near] = Soup::of(&world(meshes)).expect("triangles").coincident(&places(), EYE);
            assert_eq!(near, None, "one plane");
            told(same)
        };
        for rug in [rug, turned(rug)] {
            let told = of(&[vec![floor], vec![rug]]);
            assert!(
                told.starts_with("b: 1 of 2 triangles coincide exactly with others (beside a)"),
                "{told}"
            );
            assert!(told.contains("; take one of both away"), "{told}");
        }
        let twice = of(&[vec![floor], vec![floor]]);
        assert!(twice.starts_with("a: 2 of 2 triangles coincide exactly with others (beside b)"), "{twice}");
        assert_eq!(of(&[vec![floor, turned(floor)]]), "", "both sides of a sheet");
        // What stands on the floor hides its own bottom.
        let lid = flat(Vec3::new(-2.0, -2.0, 1.0), 9.0);
        assert_eq!(of(&[vec![floor], vec![rug, lid]]), "", "unseen");
        let beside = [Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        assert_eq!(of(&[vec![floor], vec![beside]]), "", "tiles of one floor");
    }
}
