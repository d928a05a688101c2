//! Rays and worlds at the limits of what can be asked: rays that are none, of any numbers and of any length; worlds
//! without anything in them; groups placed again. All backends, every kind of query.

#[path = "support/ask.rs"]
mod ask;
#[path = "support/queries.rs"]
mod queries;
#[path = "support/rays.rs"]
mod rays;
#[path = "support/worlds.rs"]
mod worlds;

use ask::{all_kinds, backends};
use glam::Vec3;
use rays::{Aim, Part, Rng};
use specula::accel::{Accel, Brute};
use specula::geometry::{Mesh, Pose, Ray, Shape, World};
use specula::math::Aabb;
use std::sync::Arc;
use worlds::worlds;

#[test]
fn kinds_without_kernels_agree_with_single_rays() {
    let world = Arc::new(worlds::instanced());
    let rays = Aim::Anywhere.rays(&world, 500);
    let all = all_kinds(&Brute::new(world), &rays);
    for answers in &all {
        assert_eq!(answers.hits, all[0].hits, "{}", answers.kind);
        assert_eq!(answers.occluded, all[0].occluded, "{}", answers.kind);
    }
}

#[test]
fn rays_that_cannot_be_traced_hit_nothing() {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let mut bad_rays = Vec::new();
    for good in Aim::ALL.iter().flat_map(|aim| aim.rays(&worlds::instanced(), 40)) {
        for (axis, value) in (0..3).flat_map(|axis| bad.map(|value| (axis, value))) {
            let mut ray = good;
            ray.o[axis] = value;
            bad_rays.push(ray);
            let mut ray = good;
            ray.d[axis] = value;
            bad_rays.push(ray);
            ray.o[(axis + 1) % 3] = value;
            bad_rays.push(ray);
        }
        bad_rays.push(rays::changed(good, |ray| ray.d = Vec3::ZERO));
        bad_rays.push(rays::changed(good, |ray| ray.d = -Vec3::ZERO));
        bad_rays.push(rays::changed(good, |ray| (ray.t_min, ray.t_max) = (2.0, 1.0)));
        bad_rays.push(rays::changed(good, |ray| ray.t_max = -1.0));
        bad_rays.push(rays::changed(good, |ray| ray.t_max = f32::NEG_INFINITY));
        bad_rays.push(rays::changed(good, |ray| ray.t_max = f32::NAN));
        bad_rays.push(rays::changed(good, |ray| ray.t_min = f32::NAN));
        bad_rays.push(rays::changed(good, |ray| ray.mask = 0));
    }
    let mut checked = 0;
    for (name, world) in worlds() {
        let world = Arc::new(world);
        let mut all = all_kinds(&Brute::new(world.clone()), &bad_rays);
        all.extend(backends(&world).iter().flat_map(|backend| backend.ask(&bad_rays)));
        for answers in &all {
            for (i, ray) in bad_rays.iter().enumerate() {
                assert_eq!(answers.hits[i], None, "{name}, {}: {ray:?}", answers.kind);
                assert!(!answers.occluded[i], "{name}, {}: {ray:?}", answers.kind);
                checked += 1;
            }
        }
    }
    println!("{checked} rays that cannot be traced hit nothing");
}

/// A ray of random bits, or of coordinates of any magnitude that is not a fault in itself.
fn wild(rng: &mut Rng) -> Ray {
    let mut number = |signed: bool| match rng.bits() % 4 {
        0 => f32::from_bits(rng.bits()),
        1 => 0.0,
        _ => {
            let size = 10_f32.powf(rng.unit() * 63.0 - 45.0);
            if signed && rng.bits() & 1 == 0 { -size } else { size }
        }
    };
    let (o, d) = ([number(true), number(true), number(true)], [number(true), number(true), number(true)]);
    let (t_min, t_max) = (number(false), number(false));
    let ray = Ray::new(Vec3::from(o), Vec3::from(d)).until(t_max);
    rays::changed(ray, |ray| ray.t_min = t_min)
}

#[test]
fn rays_of_any_numbers_are_survived() {
    let mut rng = Rng::new(5);
    let rays: Vec<Ray> = (0..20_000).map(|_| wild(&mut rng)).collect();
    let traceable = rays.iter().filter(|ray| ray.is_traceable()).count();
    for (name, world) in worlds() {
        let world = Arc::new(world);
        for backend in backends(&world) {
            for answers in backend.ask(&rays) {
                let hits = rays.iter().zip(&answers.hits).filter(|(_, hit)| hit.is_some());
                for (ray, hit) in hits {
                    assert!(
                        ray.is_traceable(),
                        "{name}, {}, {}: {ray:?} hits {hit:?}",
                        backend.name,
                        answers.kind
                    );
                }
            }
        }
    }
    println!("{traceable} of {} wild rays can be traced", rays.len());
}

#[test]
fn a_closed_robust_mesh_lets_next_to_nothing_out() {
    let world = Arc::new(worlds::closed());
    let mut rng = Rng::new(3);
    let rays: Vec<Ray> = (0..50_000)
        .map(|_| {
            let o = rng.direction() * 0.3;
            Ray::new(o, rays::surface_point(&world, &mut rng, 0.0, Part::Edge).0 - o)
        })
        .collect();
    for backend in backends(&world) {
        let name = backend.name;
        for answers in backend.ask(&rays) {
            let lost = answers.hits.iter().filter(|hit| hit.is_none()).count();
            println!("{name}, {}: {lost} of {} rays at edges and corners lost", answers.kind, rays.len());
            // Without the flag one in ten of these goes lost; with it one in 10^4, for it is not quite watertight.
            assert!(!name.ends_with("robust") || lost <= 10, "{}: {lost} lost", answers.kind);
        }
    }
}

/// How long a direction must be for each backend to find what lies ahead, in a world a millionth of a unit wide.
#[test]
fn short_directions_find_what_is_ahead() {
    let world = worlds().into_iter().find(|(name, _)| *name == "tiny").expect("there");
    let world = Arc::new(world.1);
    let rays = Aim::Anywhere.rays(&world, 2000);
    let rays: Vec<Ray> =
        rays.iter().map(|ray| Ray::new(ray.o, rays::about_unit(ray.d)).at_time(ray.time)).collect();
    let hits = Brute::new(world.clone());
    let hits = rays.iter().filter(|ray| hits.intersect(ray).is_some()).count();
    for backend in backends(&world) {
        for length in [1.0_f32, 1e-2, 1e-4, 1e-6, 1e-8] {
            let short: Vec<Ray> = rays.iter().map(|ray| Ray::new(ray.o, ray.d * length)).collect();
            let found = backend.ask(&short).into_iter().map(|a| a.hits.iter().flatten().count());
            let (least, most) = found.fold((usize::MAX, 0), |(a, b), n| (a.min(n), b.max(n)));
            println!("{}: directions of {length:e}: {least} to {most} of {hits} hits", backend.name);
            let is_known_limit = backend.name.ends_with("robust") && length < 1e-4;
            assert!(
                is_known_limit || least.abs_diff(hits) <= 2,
                "{}: {length:e}: {least} of {hits}",
                backend.name
            );
        }
    }
}

#[test]
fn a_group_placed_again_is_hit_as_through_two_levels() {
    let inner = worlds::instanced();
    let mut outer = inner.clone();
    let group = std::mem::take(&mut outer.placements);
    let slide = [Vec3::ZERO, Vec3::new(0.5, 0.2, -0.3), Vec3::ONE].map(glam::Affine3A::from_translation);
    let slide = specula::math::Motion::new(&slide).expect("invertible");
    let poses = [Pose::Still(worlds::skewed()), Pose::World, Pose::Moving(slide)];
    for pose in &poses {
        outer.place_group(&group, pose).expect("invertible");
    }
    let inner = Brute::new(Arc::new(inner));
    let rays = Aim::Anywhere.rays(&outer, 2000);
    let flat = Brute::new(Arc::new(outer));
    let (mut hits, mut differ) = (0, 0);
    for ray in &rays {
        let through = |pose: &Pose| inner.intersect(&pose.object_ray(ray));
        let found = (0..).zip(&poses).filter_map(|(i, pose)| Some((i, through(pose)?)));
        let nearest = found.min_by(|(_, a), (_, b)| a.t.total_cmp(&b.t));
        let one = flat.intersect(ray);
        hits += usize::from(one.is_some());
        let size = u32::try_from(group.len()).expect("few");
        let same = match (&nearest, &one) {
            (None, None) => true,
            (Some((i, a)), Some(b)) => {
                (a.placement.0 + i * size, a.prim) == (b.placement.0, b.prim)
                    && (a.t - b.t).abs() <= 2e-5 * b.t
            }
            _ => false,
        };
        differ += usize::from(!same);
    }
    assert!(hits > 100 && differ <= 1, "{differ} of {} rays differ, {hits} hit", rays.len());
}

#[test]
fn empty_and_degenerate_worlds_are_never_hit() {
    let line = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0], vec![[0, 1, 2], [0, 0, 0], [1, 1, 2]]);
    let none = Mesh::new(vec![Vec3::ZERO], vec![]);
    let mut flat = World::default();
    for mesh in [line.expect("good"), none.expect("good")] {
        let shape = flat.add_shape(Shape::Mesh(mesh));
        flat.place(shape, None);
        flat.place(shape, Some(worlds::skewed()));
    }
    let mut rays = Aim::Anywhere.rays(&worlds::closed(), 2000);
    rays.extend((0..2000_u16).map(|i| {
        let target = Vec3::X * (f32::from(i) / 1000.0);
        Ray::new(
            Vec3::new(1.0, f32::from(i % 7) - 3.0, 2.0),
            target - Vec3::new(1.0, f32::from(i % 7) - 3.0, 2.0),
        )
    }));
    rays.push(Ray::new(-Vec3::X, Vec3::X));
    for world in [World::default(), flat] {
        let world = Arc::new(world);
        for backend in backends(&world) {
            for answers in backend.ask(&rays) {
                assert!(answers.hits.iter().all(Option::is_none), "{}, {}: hit", backend.name, answers.kind);
                assert!(!answers.occluded.contains(&true), "{}, {}: occluded", backend.name, answers.kind);
            }
        }
    }
}

#[test]
fn bounds_hold_whatever_is_hit() {
    for (name, world) in worlds() {
        let world = Arc::new(world);
        let brute = Brute::new(world.clone());
        let rays = Aim::Anywhere.rays(&world, 2000);
        let points: Vec<Vec3> = rays.iter().filter_map(|ray| Some(ray.at(brute.intersect(ray)?.t))).collect();
        assert!(!points.is_empty() || name == "masked", "{name}: nothing was hit");
        for backend in backends(&world) {
            let Aabb { min, max } = backend.bounds;
            let slack = 1e-5 * (max - min).max_element() + 1e-6 * max.abs().max(min.abs()).max_element();
            let holds = |p: &Vec3| p.cmpge(min - slack).all() && p.cmple(max + slack).all();
            assert!(points.iter().all(holds), "{name}, {}: {:?} is too small", backend.name, backend.bounds);
        }
    }
}

#[test]
fn moments_that_are_none_are_survived() {
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 2.0, 1e30, -1e30, f32::MIN_POSITIVE];
    let world = Arc::new(worlds::moving());
    let mut rays = Aim::Anywhere.rays(&world, 2000);
    rays.iter_mut().enumerate().for_each(|(i, ray)| ray.time = odd[i % odd.len()]);
    for backend in backends(&world) {
        for answers in backend.ask(&rays) {
            for hit in answers.hits.iter().flatten() {
                let is_there = hit.placement.index() < world.placements.len()
                    && (hit.prim as usize) < world.shape_of(hit.placement).primitive_count();
                assert!(is_there, "{}, {}: {hit:?}", backend.name, answers.kind);
            }
        }
    }
}

#[test]
fn surfaces_that_are_not_instanced_answer_bit_for_bit() {
    let mut world = worlds::surfaces();
    world.placements.retain(|placement| placement.pose == Pose::World);
    let world = Arc::new(world);
    let rays = Aim::Anywhere.rays(&world, 2000);
    let wanted = all_kinds(&Brute::new(world.clone()), &rays);
    for backend in backends(&world) {
        for (found, wanted) in backend.ask(&rays).iter().zip(&wanted) {
            assert_eq!(found, wanted, "{}", backend.name);
        }
    }
}
