//! Hits that box tests lose: how many there are without our care, and that none are left with it.
//!
//! Counted are rays whose nearest hit, found by testing every triangle, is not found through the hierarchy although the same
//! test is made at its leaves. Aimed are rays at edges and corners, axis-parallel ones that lie exactly in the faces of
//! boxes, ones with one zero in their direction, ones that start a thousand sizes away, and ones of anywhere.

#[path = "support/rays.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod rays;
#[path = "support/worlds.rs"]
mod worlds;

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::cwbvh::CwBvh;
use obvhs::ray::RayHit;
use obvhs::triangle::Triangle;
use rayon::prelude::*;
use rays::{Part, Rng};
use specula::accel::Accel;
use specula::accel::bvh::{Binary, BvhAccel, Hierarchy, Options, Wide};
use specula::geometry::{Pose, Ray, Shape, World, intersect_triangle};
use std::sync::Arc;
use std::time::Duration;

const RAYS: usize = 40_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Edge,
    InFace,
    OneZero,
    Far,
    Anywhere,
}

const KINDS: [Kind; 5] = [Kind::Edge, Kind::InFace, Kind::OneZero, Kind::Far, Kind::Anywhere];

fn ray(kind: Kind, world: &World, corners: &[Vec3], rng: &mut Rng) -> Ray {
    let bounds = world.bounds();
    let o = bounds.center() + rng.cube() * bounds.size().max(Vec3::splat(bounds.radius() * 0.1)) * 0.75;
    let target = rays::surface_point(world, rng, 0.0, Part::Edge).0;
    match kind {
        Kind::Edge => Ray::new(o, target - o),
        Kind::InFace => {
            let axis = rng.below(3);
            let mut o_in_face = corners[rng.below(corners.len())];
            o_in_face[(axis + 1) % 3] = target[(axis + 1) % 3];
            o_in_face[axis] = o[axis];
            Ray::new(o_in_face, Vec3::AXES[axis] * if rng.bits() & 1 == 0 { 1.0 } else { -1.0 })
        }
        Kind::OneZero => {
            let mut o = o;
            let axis = rng.below(3);
            o[axis] = target[axis];
            Ray::new(o, target - o)
        }
        Kind::Far => {
            let o = bounds.center() + rng.direction() * bounds.radius() * 1000.0;
            Ray::new(o, target - o)
        }
        Kind::Anywhere => Ray::new(o, rng.direction()),
    }
}

/// What is hit, or whether, by a contestant.
type Nearest<'a> = Box<dyn Fn(&Ray) -> Option<f32> + Sync + 'a>;

/// obvhs with boxes and rays as they come, and an exact test at the leaves.
fn as_it_comes(triangles: &[[Vec3; 3]]) -> [Nearest<'_>; 2] {
    let boxes: Vec<Triangle> = triangles
        .iter()
        .map(|t| {
            let [v0, v1, v2] = t.map(Vec3A::from);
            Triangle { v0, v1, v2 }
        })
        .collect();
    let params = BvhBuildParams::medium_build();
    let bvh2: Bvh2 = obvhs::bvh2::builder::build_bvh2(&boxes, params, &mut Duration::default());
    let cwbvh: CwBvh = obvhs::cwbvh::builder::build_cwbvh(&boxes, params, &mut Duration::default());
    let exact = |ray: &Ray, prim: u32, end: f32| {
        let met = intersect_triangle(triangles[prim as usize], ray.o, ray.d, ray.t_min, end);
        met.map_or(f32::INFINITY, |[t, ..]| t)
    };
    let theirs = |ray: &Ray| obvhs::ray::Ray::new(ray.o.into(), ray.d.into(), ray.t_min, ray.t_max);
    [
        Box::new(move |ray| {
            let mut hit = RayHit::none();
            let found = bvh2
                .ray_traverse(theirs(ray), &mut hit, |r, id| exact(ray, bvh2.primitive_indices[id], r.tmax));
            found.then_some(hit.t)
        }),
        Box::new(move |ray| {
            let mut hit = RayHit::none();
            let found = cwbvh
                .ray_traverse(theirs(ray), &mut hit, |r, id| exact(ray, cwbvh.primitive_indices[id], r.tmax));
            found.then_some(hit.t)
        }),
    ]
}

fn ours<'a, H: Hierarchy + 'a>(world: &Arc<World>, padding: f32) -> Nearest<'a> {
    let accel = BvhAccel::<H>::build(world, &Options { padding, ..Options::default() });
    Box::new(move |ray| {
        let found = accel.intersect(ray).map(|hit| hit.t);
        // Occlusion goes another way through the tree and must agree.
        assert_eq!(accel.occluded(ray), found.is_some(), "{} padded by {padding}: {ray:?}", H::NAME);
        found
    })
}

/// Rays whose nearest hit is lost.
fn lost(rays: &[Ray], wanted: &[Option<f32>], found: &Nearest<'_>) -> usize {
    let is_lost = |(ray, wanted): (&Ray, &Option<f32>)| {
        wanted.is_some_and(|t| found(ray).is_none_or(|found| found > t + t.abs() * 1e-5))
    };
    rays.par_iter().zip(wanted).filter(|&pair| is_lost(pair)).count()
}

/// Whether a world is of meshes that stay where they are given, seen by all rays.
fn is_plain(world: &World) -> bool {
    let plain = |shape: &Shape| matches!(shape, Shape::Mesh(mesh) if mesh.key_count() == 1);
    let seen = world.placements.iter().all(|p| p.pose == Pose::World && p.mask == u32::MAX);
    seen && world.filters.is_empty() && world.shapes.iter().all(plain)
}

fn triangles(world: &World) -> Vec<[Vec3; 3]> {
    let of = |shape: &Shape| {
        let Shape::Mesh(mesh) = shape else { unreachable!("meshes") };
        (0..mesh.triangles().len()).map(|i| mesh.corners(u32::try_from(i).expect("few"))).collect::<Vec<_>>()
    };
    world.placements.iter().flat_map(|placement| of(&world.shapes[placement.shape.index()])).collect()
}

#[test]
fn no_hit_is_lost_by_boxes() {
    let worlds = worlds::worlds().into_iter().filter(|(_, world)| is_plain(world));
    let names = ["bvh2 raw", "cwbvh raw", "bvh2 0", "bvh2 1/8", "bvh2 1", "cwbvh 0", "cwbvh 1/8", "cwbvh 1"];
    println!("{:14} {:9} {:>7} {:>7}  lost by {names:?}", "world", "rays", "count", "hit");
    let mut totals = [0; 8];
    let mut total_hits = 0;
    // Of rays of anywhere, which are aimed at nothing.
    let (mut unaimed, mut unaimed_hits) = ([0; 8], 0);
    for (name, world) in worlds {
        let world = Arc::new(world);
        let triangles = triangles(&world);
        let all = ours::<Binary>(&world, 1e7);
        let exact: Nearest<'_> = Box::new(|ray| {
            let hit =
                |t: &[Vec3; 3]| intersect_triangle(*t, ray.o, ray.d, ray.t_min, ray.t_max).map(|[t, ..]| t);
            triangles.iter().filter_map(hit).min_by(f32::total_cmp)
        });
        let raw = as_it_comes(&triangles);
        let padded = [
            ours::<Binary>(&world, 0.0),
            ours::<Binary>(&world, 0.125),
            ours::<Binary>(&world, 1.0),
            ours::<Wide>(&world, 0.0),
            ours::<Wide>(&world, 0.125),
            ours::<Wide>(&world, 1.0),
        ];
        let corners: Vec<Vec3> = triangles.iter().flatten().copied().collect();
        for kind in KINDS {
            let mut rng = Rng::new(kind as u64 + 40);
            let rays: Vec<Ray> = (0..RAYS).map(|_| ray(kind, &world, &corners, &mut rng)).collect();
            let rays: Vec<Ray> = rays.into_iter().filter(Ray::is_traceable).collect();
            let by_test: Vec<Option<f32>> = rays.par_iter().map(&*exact).collect();
            let by_fast_test: Vec<Option<f32>> = rays.par_iter().map(&*all).collect();
            let counts = raw.iter().map(|found| lost(&rays, &by_test, found));
            let counts: Vec<usize> =
                counts.chain(padded.iter().map(|found| lost(&rays, &by_fast_test, found))).collect();
            let hits = by_test.iter().flatten().count();
            println!("{name:14} {:9} {:7} {hits:7}  {counts:?}", format!("{kind:?}"), rays.len());
            total_hits += hits;
            for (total, count) in totals.iter_mut().zip(&counts) {
                *total += count;
            }
            if kind == Kind::Anywhere {
                unaimed_hits += hits;
                for (total, count) in unaimed.iter_mut().zip(&counts) {
                    *total += count;
                }
            }
            // With all of the padding, and with an eighth of it.
            for i in [3, 4, 6, 7] {
                assert_eq!(counts[i], 0, "{name}, {kind:?}: hits lost by {}", names[i]);
            }
        }
    }
    println!("of {total_hits} hits {totals:?} are lost by {names:?}");
    println!("of {unaimed_hits} hits of rays that are not aimed {unaimed:?}");
    assert!(unaimed_hits > 50_000 && unaimed[0] * 10_000 < unaimed_hits, "as they come: {unaimed:?}");
    assert_eq!(unaimed[2..], [0; 6], "in frames of their own, padded or not");
    assert!(totals[..2].iter().all(|&lost| lost > 0), "nothing to be cured: the test shows nothing");
}
