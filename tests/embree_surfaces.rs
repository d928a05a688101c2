//! What Embree calls back for, and what moves, is masked or is held as quads, against the oracle that tests each
//! primitive: every kind of query, several instruction sets.

#[path = "support/queries.rs"]
mod queries;
#[path = "support/random.rs"]
mod random;
#[path = "support/surfaces.rs"]
mod surfaces;
#[path = "support/verdict.rs"]
mod verdict;

use glam::Vec3;
use queries::{Answers, Kind};
use random::Random;
use specula::accel::Brute;
use specula::accel::embree::{BuildOptions, Config, EmbreeAccel, Isa, SceneOptions};
use specula::geometry::{Disc, Hit, HitFilter, Pose, Ray, Shape, ShapeId, Sphere, World};
use std::sync::Arc;
use surfaces::{Board, Cells, Ellipsoids, breathing, rays_into, skewed, tumbling};
use verdict::{Verdict, judge};

fn backends(world: &World) -> Vec<(&'static str, EmbreeAccel)> {
    let build = |max_isa, scene| {
        let device = Config { max_isa, ..Config::default() };
        EmbreeAccel::build(world, &BuildOptions { device, scene }).expect("built")
    };
    let fast = SceneOptions::default();
    let quads = SceneOptions { quads: true, ..fast };
    let robust = SceneOptions { robust: true, ..quads };
    vec![
        ("plain", build(None, fast)),
        ("quads", build(None, quads)),
        ("robust quads", build(None, robust)),
        ("avx robust quads", build(Some(Isa::Avx), robust)),
        ("sse2", build(Some(Isa::Sse2), fast)),
        ("sse2 compact quads", build(Some(Isa::Sse2), SceneOptions { compact: true, ..quads })),
    ]
}

/// Asks everything and compares with the oracle: all answers but a few must be the oracle's own, and occlusion must say
/// what the hit says. Every answer must be right to within rounding, but in worlds with filters, whose borders the judge
/// does not know.
fn agree(name: &str, world: World, rays: &[Ray]) {
    let judging = world.filters.is_empty();
    let world = Arc::new(world);
    let brute = Brute::new(world.clone());
    let oracle = Kind::Single.hits(&brute, rays);
    let hit = oracle.iter().flatten().count();
    assert!(hit * 10 > rays.len() && hit < rays.len(), "{name}: {hit} of {} rays hit", rays.len());
    for (backend, accel) in backends(&world) {
        let mut judged: Vec<(usize, Option<Hit>)> = Vec::new();
        for kind in Kind::all() {
            let Answers { hits, occluded } = kind.answers(&accel, rays);
            let (mut differ, mut unlike) = (0, 0);
            for (i, found) in hits.iter().enumerate() {
                let identity = |hit: &Hit| (hit.placement, hit.prim);
                differ += usize::from(oracle[i].as_ref().map(identity) != found.as_ref().map(identity));
                unlike += usize::from(occluded[i] != found.is_some());
                if judging && !judged.contains(&(i, *found)) && oracle[i] != *found {
                    let verdict = judge(&world, &brute, &rays[i], oracle[i].as_ref(), found.as_ref());
                    assert_ne!(
                        verdict,
                        Verdict::Wrong,
                        "{name}, {backend}, {kind:?}: {:?}: {found:?}, not {:?}",
                        rays[i],
                        oracle[i]
                    );
                    judged.push((i, *found));
                    judged = judged.split_off(judged.len().saturating_sub(64));
                }
            }
            let allowed = 1 + rays.len() / 400;
            assert!(differ <= allowed, "{name}, {backend}, {kind:?}: {differ} of {} differ", rays.len());
            assert!(unlike <= allowed, "{name}, {backend}, {kind:?}: {unlike} occluded otherwise than hit");
        }
    }
}

fn surface(world: &mut World, surface: Ellipsoids) -> ShapeId {
    world.add_shape(Shape::Surface(Arc::new(surface)))
}

/// Both surfaces, plain, instanced, mirrored and moving, with two meshes among them.
fn mixed() -> World {
    let mut world = World::default();
    let mut random = Random::new(3);
    let shapes = [
        surface(&mut world, Ellipsoids::one()),
        surface(&mut world, Ellipsoids::heap(30)),
        world.add_shape(Shape::Mesh(breathing(0.8, 1, 0.0))),
        world.add_shape(Shape::Mesh(breathing(0.8, 3, 0.3))),
    ];
    for i in 0..24 {
        let pose = match i % 3 {
            0 => tumbling(&mut random, i % 2 == 0, 2 + i % 5),
            _ => skewed(&mut random, i % 2 == 0),
        };
        world.place(shapes[i % 4], pose);
    }
    world.place(shapes[1], None);
    world
}

#[test]
fn surfaces_agree_with_the_oracle() {
    let world = mixed();
    let rays = rays_into(world.bounds(), 3000, 1);
    agree("mixed", world, &rays);
}

#[test]
fn surfaces_that_are_not_instanced_answer_bit_for_bit() {
    let mut world = World::default();
    for shape in [Ellipsoids::one(), Ellipsoids::heap(50)] {
        let shape = surface(&mut world, shape);
        world.place(shape, None);
    }
    let rays = rays_into(world.bounds(), 2000, 2);
    let wanted = Kind::Single.answers(&Brute::new(Arc::new(world.clone())), &rays);
    for (backend, accel) in backends(&world) {
        for kind in Kind::all() {
            assert_eq!(kind.answers(&accel, &rays), wanted, "{backend}, {kind:?}");
        }
    }
}

#[test]
fn meshes_and_instances_move_as_they_should() {
    for keys in [2, 3, 7] {
        let mut random = Random::new(21);
        let mut mesh = World::default();
        let shape = mesh.add_shape(Shape::Mesh(breathing(1.0, keys, 0.7)));
        mesh.place(shape, None);
        let mut still = World::default();
        let shape = still.add_shape(Shape::Mesh(breathing(1.0, 1, 0.0)));
        let mut both = World::default();
        let moving = both.add_shape(Shape::Mesh(breathing(1.0, 9 - keys, 0.5)));
        for i in 0..12 {
            let pose = tumbling(&mut random, i % 3 == 0, keys);
            still.place(shape, pose.clone());
            both.place(moving, if i % 4 == 0 { skewed(&mut random, i == 4) } else { pose });
        }
        for (what, world) in [("mesh", mesh), ("instances", still), ("both", both)] {
            assert!(world.is_moving(), "{what} moves");
            let rays = rays_into(world.bounds(), 1500, 4);
            agree(&format!("{what}, {keys} keys"), world, &rays);
        }
    }
}

#[test]
fn moments_that_are_none_are_survived() {
    let world = mixed();
    let mut rays = rays_into(world.bounds(), 800, 5);
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 2.0, 1e30, -1e30, f32::MIN_POSITIVE];
    rays.iter_mut().enumerate().for_each(|(i, ray)| ray.time = odd[i % odd.len()]);
    for (backend, accel) in backends(&world) {
        for kind in Kind::all() {
            let answers = kind.answers(&accel, &rays);
            for hit in answers.hits.iter().flatten() {
                assert!(hit.placement.index() < world.placements.len(), "{backend}, {kind:?}: {hit:?}");
                assert!(
                    (hit.prim as usize) < world.shape_of(hit.placement).primitive_count(),
                    "{backend}, {kind:?}: {hit:?}"
                );
            }
        }
    }
}

#[test]
fn filters_pass_over_what_does_not_count() {
    let mut random = Random::new(8);
    let mut world = World::default();
    let filtered: [(Shape, Arc<dyn HitFilter>); 5] = [
        (Shape::Mesh(breathing(0.8, 1, 0.0)), Arc::new(Board(3.0))),
        (Shape::Mesh(breathing(0.8, 2, 0.2)), Arc::new(Cells(0.31))),
        (Shape::Sphere(Sphere { center: Vec3::ZERO, radius: 0.7 }), Arc::new(Cells(0.31))),
        (Shape::Disc(Disc { center: Vec3::ZERO, normal: Vec3::Z, radius: 0.9 }), Arc::new(Cells(0.27))),
        (Shape::Surface(Arc::new(Ellipsoids::heap(20))), Arc::new(Cells(0.1))),
    ];
    for (shape, filter) in filtered {
        let shape = world.add_shape(shape);
        world.filters.insert(shape, filter);
        for i in 0..3 {
            world.place(shape, skewed(&mut random, i == 0));
        }
        world.place(shape, tumbling(&mut random, false, 3));
    }
    // One of each kind without an instance, and one that is not filtered.
    for shape in 0..5 {
        world.place(ShapeId(shape), None);
    }
    let plain = world.add_shape(Shape::Mesh(breathing(0.3, 1, 0.0)));
    world.place(plain, None);

    let rays = rays_into(world.bounds(), 3000, 6);
    let brute = |world: World| Kind::Single.hits(&Brute::new(Arc::new(world)), &rays);
    let unfiltered = World { filters: Default::default(), ..world.clone() };
    let (with, without) = (brute(world.clone()), brute(unfiltered));
    let changed = with.iter().zip(&without).filter(|(a, b)| a != b).count();
    assert!(changed * 10 > rays.len(), "filters change {changed} answers of {}", rays.len());
    agree("filtered", world, &rays);
}

#[test]
fn masks_decide_who_is_seen() {
    let mut random = Random::new(9);
    let mut world = World::default();
    let shapes = [
        world.add_shape(Shape::Mesh(breathing(0.8, 1, 0.0))),
        world.add_shape(Shape::Sphere(Sphere { center: Vec3::ZERO, radius: 0.7 })),
        world.add_shape(Shape::Disc(Disc { center: Vec3::ZERO, normal: Vec3::Z, radius: 0.9 })),
        surface(&mut world, Ellipsoids::heap(20)),
    ];
    for i in 0..32_usize {
        let pose = if i < 4 { Pose::World } else { skewed(&mut random, i % 2 == 0) };
        let id = world.place(shapes[i % 4], pose);
        world.placements[id.index()].mask = [1, 2, 1 << 31, 0, u32::MAX, 3][i % 6];
    }
    let mut rays = rays_into(world.bounds(), 2400, 7);
    let masks = [1, 2, 1 << 31, 4, u32::MAX, 0];
    rays.iter_mut().enumerate().for_each(|(i, ray)| ray.mask = masks[i % masks.len()]);
    let seen = |mask: u32| world.placements.iter().filter(|placement| placement.mask & mask != 0).count();
    assert!(
        seen(4) > 0 && seen(4) < seen(1) && seen(1) < seen(u32::MAX) && seen(u32::MAX) < 32,
        "masks differ"
    );
    agree("masked", world, &rays);
}

#[test]
fn quads_name_triangles_with_their_parameters() {
    let mut random = Random::new(10);
    let mut world = World::default();
    let shape = world.add_shape(Shape::Mesh(breathing(1.0, 1, 0.0)));
    world.place(shape, None);
    for i in 0..4 {
        world.place(shape, skewed(&mut random, i % 2 == 0));
    }
    let rays = rays_into(world.bounds(), 4000, 8);
    let oracle = Kind::Single.hits(&Brute::new(Arc::new(world.clone())), &rays);
    let scene = SceneOptions { quads: true, ..SceneOptions::default() };
    for max_isa in [None, Some(Isa::Avx), Some(Isa::Sse2)] {
        let device = Config { max_isa, ..Config::default() };
        let accel = EmbreeAccel::build(&world, &BuildOptions { device, scene }).expect("built");
        for kind in Kind::all() {
            let found = kind.hits(&accel, &rays);
            let same = |(a, b): &(&Hit, &Hit)| (a.placement, a.prim) == (b.placement, b.prim);
            let pairs = oracle.iter().zip(&found).filter_map(|(a, b)| a.as_ref().zip(b.as_ref()));
            let mut compared = 0;
            for (wanted, found) in pairs.filter(same) {
                let near = |a: f32, b: f32| (a - b).abs() <= 2e-5 / wanted.ng.length().min(1.0);
                let sees = near(wanted.u, found.u) && near(wanted.v, found.v);
                assert!(sees, "{max_isa:?}, {kind:?}: {found:?}, not {wanted:?}");
                assert!(found.u >= 0.0 && found.v >= 0.0, "{max_isa:?}, {kind:?}: {found:?}");
                let size = wanted.ng.length();
                assert!((wanted.ng - found.ng).length() < 1e-3 * size, "{kind:?}: {found:?}, not {wanted:?}");
                compared += 1;
            }
            let hit = oracle.iter().flatten().count();
            assert!(compared + 1 + rays.len() / 400 > hit, "{kind:?}: {compared} of {hit} hits agree");
        }
    }
}
