//! Worlds for tests of backends: every kind of shape and placement, still and moving, huge, tiny and far away.

#![allow(dead_code, reason = "each test program uses a part")]

#[path = "solids.rs"]
mod solids;

use crate::rays::Rng;
use glam::{Affine3A, Quat, Vec3};
use solids::{Ellipsoid, Ellipsoids, Ground, Sieve};
use specula::geometry::{Disc, Frustum, Mesh, Pose, Shape, ShapeId, Sphere, Surface, Torus, World};
use specula::math::{Motion, Transform};
use std::sync::Arc;

/// The worlds that backends must agree on.
pub(crate) fn worlds() -> Vec<(&'static str, World)> {
    vec![
        ("soup", soup()),
        ("closed", closed()),
        ("round", round()),
        ("surfaces", surfaces()),
        ("bodies", bodies()),
        ("instanced", instanced()),
        ("nested", nested()),
        ("moving", moving()),
        ("masked", masked()),
        ("filtered", filtered()),
        ("displaced", displaced(Vec3::new(1000.0, -700.0, 300.0), 1.0)),
        ("remote", displaced(Vec3::new(1e6, -7e5, 3e5), 100.0)),
        ("tiny", displaced(Vec3::ZERO, 1e-6)),
        ("huge", displaced(Vec3::ZERO, 1e6)),
        ("boxes", boxes()),
        ("plane", of_mesh(grid(16))),
        ("one", of_mesh(Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).expect("good"))),
        ("overlapping", overlapping()),
        ("mixed", mixed()),
    ]
}

/// Unconnected triangles of all sizes.
fn soup() -> World {
    let mut rng = Rng::new(1);
    let mut positions = Vec::new();
    for _ in 0..600 {
        let (center, size) = (rng.cube(), 0.01 + 0.3 * rng.unit() * rng.unit());
        positions.extend((0..3).map(|_| center + rng.cube() * size));
    }
    let triangles = (0..600).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut world = World::default();
    add(&mut world, Shape::Mesh(Mesh::new(positions, triangles).expect("good")), Pose::World);
    world
}

/// A closed bumpy sphere about the origin.
pub(crate) fn closed() -> World {
    let mut world = World::default();
    add(&mut world, Shape::Mesh(bumpy(24, 16)), Pose::World);
    world
}

/// Spheres and discs, some inside others.
fn round() -> World {
    let mut rng = Rng::new(2);
    let mut world = World::default();
    for _ in 0..40 {
        let sphere = Sphere { center: rng.cube(), radius: 0.02 + 0.2 * rng.unit() };
        add(&mut world, Shape::Sphere(sphere), Pose::World);
        let disc = Disc { center: rng.cube(), normal: rng.direction(), radius: 0.02 + 0.2 * rng.unit() };
        add(&mut world, Shape::Disc(disc), Pose::World);
    }
    world
}

/// Shapes that find their own hits, in place and as instances.
pub(crate) fn surfaces() -> World {
    let mut rng = Rng::new(6);
    let mut world = World::default();
    for _ in 0..12 {
        let balls = (0..3).map(|_| Ellipsoid::random(&mut rng, 0.05, 0.3)).collect();
        let shape = add(&mut world, Shape::Surface(Arc::new(Ellipsoids(balls))), Pose::World);
        world.place(shape, random_map(&mut rng, 0.3, 1.0));
    }
    world
}

/// Cylinders, cones and tori, in place and as instances.
fn bodies() -> World {
    let mut rng = Rng::new(11);
    let mut world = World::default();
    for i in 0..12 {
        let (from, to) = (rng.cube(), rng.cube());
        let [a, b] = [0.05 + 0.2 * rng.unit(), 0.02 + 0.2 * rng.unit()];
        let frustum = |radii, capped| Arc::new(Frustum::new(from, to, radii, capped).expect("a body"));
        let surface: Arc<dyn Surface> = match i % 4 {
            0 => frustum([a, a], true),
            1 => frustum([a, 0.0], true),
            2 => frustum([a, b], false),
            _ => Arc::new(Torus::new(from, to, a + b, 0.9 * b).expect("a ring")),
        };
        let shape = add(&mut world, Shape::Surface(surface), Pose::World);
        world.place(shape, random_map(&mut rng, 0.3, 1.0));
    }
    world
}

/// Every kind of shape, placed with and without transforms, mirrored and stretched ones among them.
pub(crate) fn instanced() -> World {
    let mut rng = Rng::new(4);
    let mut world = World::default();
    let shapes = one_of_each(&mut rng).map(|shape| world.add_shape(shape));
    for i in 0..36 {
        world.place(shapes[i % 4], random_map(&mut rng, 0.05, 0.25));
    }
    for shape in shapes {
        world.place(shape, None);
    }
    world
}

/// Groups within groups.
fn nested() -> World {
    let mut rng = Rng::new(8);
    let mut world = instanced();
    let mut group = std::mem::take(&mut world.placements);
    for level in 0..2 {
        let start = world.placements.len();
        for _ in 0..3 {
            let pose = random_map(&mut rng, 0.4, 0.9).into();
            world.place_group(&group, &pose).expect("invertible");
        }
        if level == 0 {
            group = world.placements.split_off(start);
        }
    }
    world
}

/// Placements and vertices under way, at different numbers of keys; groups of them under way as a whole.
pub(crate) fn moving() -> World {
    let mut rng = Rng::new(9);
    let mut world = World::default();
    let shapes = one_of_each(&mut rng).map(|shape| world.add_shape(shape));
    for (i, keys) in (0..24).zip([2, 3, 7].into_iter().cycle()) {
        world.place(shapes[i % 4], random_motion(&mut rng, keys, 0.1, 0.4));
    }
    for keys in [1, 2, 6] {
        let mesh = bumpy(10, 6);
        let key = |rng: &mut Rng| {
            let by = Transform::new(random_affine(rng, 0.3, 0.6)).expect("invertible");
            (mesh.positions().iter().map(|p| by.point(*p)).collect(), None)
        };
        let later = (0..keys).map(|_| key(&mut rng)).collect();
        let shape = add(&mut world, Shape::Mesh(mesh.clone().with_keys(later).expect("good")), Pose::World);
        world.place(shape, random_map(&mut rng, 0.2, 0.5));
        world.place(shape, random_motion(&mut rng, 3, 0.2, 0.5));
    }
    let group = world.placements[..6].to_vec();
    let pose = random_motion(&mut rng, 3, 0.3, 0.6).into();
    world.place_group(&group, &pose).expect("invertible");
    world
}

/// Placements that some rays do not see.
fn masked() -> World {
    let mut rng = Rng::new(10);
    let mut world = instanced();
    for placement in &mut world.placements {
        placement.mask = match rng.below(4) {
            0 => 0,
            1 => u32::MAX,
            _ => rng.bits(),
        };
    }
    world
}

/// Shapes of which only some hits count, still and under way, and a mesh of which all do.
fn filtered() -> World {
    let mut rng = Rng::new(12);
    let mut world = instanced();
    for (shape, sieve) in (0..).map(ShapeId).zip([Sieve::Odd, Sieve::Leaving, Sieve::Leaving, Sieve::Leaving])
    {
        world.filters.insert(shape, Arc::new(sieve));
        world.place(shape, random_motion(&mut rng, 3, 0.1, 0.3));
    }
    let all = world.add_shape(Shape::Mesh(bumpy(8, 5)));
    world.place(all, random_map(&mut rng, 0.1, 0.3));
    world
}

/// The bumpy sphere elsewhere and of another size.
fn displaced(at: Vec3, size: f32) -> World {
    of_mesh(displaced_mesh(at, size))
}

fn displaced_mesh(at: Vec3, size: f32) -> Mesh {
    let mesh = bumpy(24, 16);
    let positions = mesh.positions().iter().map(|p| *p * size + at).collect();
    Mesh::new(positions, mesh.triangles().to_vec()).expect("good")
}

fn of_mesh(mesh: Mesh) -> World {
    let mut world = World::default();
    add(&mut world, Shape::Mesh(mesh), Pose::World);
    world
}

/// Cubes in rows, whose faces are flat boxes and lie in common planes.
fn boxes() -> World {
    let mut world = World::default();
    for i in 0..27_u16 {
        let at = Vec3::new(f32::from(i % 3), f32::from(i / 3 % 3), f32::from(i / 9)) * 0.5 - 0.75;
        let size = if i % 2 == 0 { 0.5 } else { 0.25 };
        let shape = world.add_shape(Shape::Mesh(cube(at, size)));
        world.place(shape, None);
    }
    world
}

fn cube(at: Vec3, size: f32) -> Mesh {
    let corner = |i: u8| Vec3::new(f32::from(i & 1), f32::from(i >> 1 & 1), f32::from(i >> 2)) * size + at;
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new((0..8).map(corner).collect(), triangles).expect("good")
}

/// A square in the plane y = 0.3.
fn grid(cells: u16) -> Mesh {
    let row = u32::from(cells) + 1;
    let at = |i: u32| (i as f32 / f32::from(cells)) * 2.0 - 1.0;
    let positions = (0..row * row).map(|i| Vec3::new(at(i % row), 0.3, at(i / row))).collect();
    let first = (0..u32::from(cells)).flat_map(|j| (0..u32::from(cells)).map(move |i| j * row + i));
    let triangles = first.flat_map(|i| [[i, i + row, i + 1], [i + 1, i + row, i + row + 1]]).collect();
    Mesh::new(positions, triangles).expect("good")
}

/// The same triangles several times, and larger ones in their plane.
fn overlapping() -> World {
    let corners = [Vec3::new(-1.0, 0.0, -1.0), Vec3::X, Vec3::new(0.5, 0.0, 1.0), Vec3::new(-1.0, 0.0, 1.0)];
    let triangles = [[0, 1, 2], [0, 2, 3], [1, 2, 3]].repeat(20);
    of_mesh(Mesh::new(corners.to_vec(), triangles).expect("good"))
}

/// A small thing on a large plane.
fn mixed() -> World {
    let mut world = of_mesh(displaced_mesh(Vec3::new(3.0, 0.01, -2.0), 0.01));
    let plane = [
        Vec3::new(-1e3, 0.0, -1e3),
        Vec3::new(1e3, 0.0, -1e3),
        Vec3::new(1e3, 0.0, 1e3),
        Vec3::new(-1e3, 0.0, 1e3),
    ];
    let shape =
        world.add_shape(Shape::Mesh(Mesh::new(plane.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).expect("good")));
    world.place(shape, None);
    world
}

/// Small meshes by the thousand.
pub(crate) fn many(count: usize) -> World {
    let mut rng = Rng::new(21);
    let mut world = World::default();
    let shape = world.add_shape(Shape::Mesh(cube(Vec3::splat(-0.5), 1.0)));
    for _ in 0..count {
        world.place(shape, random_map(&mut rng, 0.005, 0.02));
    }
    world
}

/// A map that turns, stretches and mirrors.
pub(crate) fn skewed() -> Transform {
    let turn = Quat::from_rotation_x(0.7) * Quat::from_rotation_z(-1.1);
    let scale = Vec3::new(-2.0, 0.5, 3.0);
    Transform::new(Affine3A::from_scale_rotation_translation(scale, turn, Vec3::X)).expect("invertible")
}

fn random_affine(rng: &mut Rng, least: f32, most: f32) -> Affine3A {
    let mut stretch = || least + (most - least) * rng.unit();
    let stretch = Vec3::new(stretch(), stretch(), stretch());
    let turn = Quat::from_axis_angle(rng.direction(), rng.unit() * 6.0);
    Affine3A::from_scale_rotation_translation(stretch, turn, rng.cube())
}

/// A map that turns, stretches and sometimes mirrors.
fn random_map(rng: &mut Rng, least: f32, most: f32) -> Option<Transform> {
    let mirror = Vec3::new(if rng.below(4) == 0 { -1.0 } else { 1.0 }, 1.0, 1.0);
    Transform::new(random_affine(rng, least, most) * Affine3A::from_scale(mirror))
}

/// A way through maps whose turns are small enough to stay invertible.
fn random_motion(rng: &mut Rng, keys: u16, least: f32, most: f32) -> Motion {
    let start = random_affine(rng, least, most);
    let (axis, along) = (rng.direction(), rng.cube() * 0.3);
    let key = |i: u16| {
        let part = f32::from(i) / f32::from(keys - 1);
        Affine3A::from_translation(along * part) * start * Affine3A::from_axis_angle(axis, part * 1.2)
    };
    Motion::new(&(0..keys).map(key).collect::<Vec<_>>()).expect("invertible")
}

fn add(world: &mut World, shape: Shape, pose: Pose) -> ShapeId {
    let shape = world.add_shape(shape);
    world.place(shape, pose);
    shape
}

fn one_of_each(rng: &mut Rng) -> [Shape; 4] {
    let sphere = Sphere { center: Vec3::new(0.2, 0.0, 0.0), radius: 0.7 };
    let disc = Disc { center: Vec3::ZERO, normal: Vec3::new(0.0, 0.6, 0.8), radius: 0.8 };
    let balls = (0..2).map(|_| Ellipsoid::random(rng, 0.2, 0.7)).collect();
    let surface = Shape::Surface(Arc::new(Ellipsoids(balls)));
    [Shape::Mesh(bumpy(10, 6)), Shape::Sphere(sphere), Shape::Disc(disc), surface]
}

/// A sphere of radius about 1 with bumps, closed at seam and poles by shared vertices; but for its poles in quads.
fn bumpy(around: u16, up: u16) -> Mesh {
    let mut positions = vec![Vec3::Z, -Vec3::Z];
    for j in 1..up {
        let theta = std::f32::consts::PI * f32::from(j) / f32::from(up);
        for i in 0..around {
            let phi = std::f32::consts::TAU * f32::from(i) / f32::from(around);
            let r = 1.0 + 0.1 * (5.0 * phi).sin() * (7.0 * theta).sin();
            positions.push(Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()) * r);
        }
    }
    let at = |i: u16, j: u16| 2 + u32::from(j - 1) * u32::from(around) + u32::from(i % around);
    let mut triangles = Vec::new();
    for i in 0..around {
        triangles.push([0, at(i, 1), at(i + 1, 1)]);
        triangles.push([1, at(i + 1, up - 1), at(i, up - 1)]);
        for j in 1..up - 1 {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh::new(positions, triangles).expect("good")
}

/// A world with something infinite in it; rays cannot be aimed by its bounds.
pub(crate) fn grounded() -> World {
    let mut world = surfaces();
    add(&mut world, Shape::Surface(Arc::new(Ground)), Pose::World);
    world
}
