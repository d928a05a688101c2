//! Worlds that are hard on hierarchies of boxes.

use crate::rays::{self, Rng};
use glam::{Affine3A, Quat, Vec2, Vec3};
use specula::geometry::{HitFilter, Mesh, Pose, Ray, Shape, ShapeHit, Sphere, Surface, SurfacePoint, World};
use specula::math::{Aabb, Motion, Transform};
use std::sync::Arc;

/// Worlds that stand still.
pub(crate) fn still() -> Vec<(&'static str, World)> {
    vec![
        ("tiny", of_mesh(scaled(1e-6, Vec3::ZERO))),
        ("far", of_mesh(scaled(100.0, Vec3::new(1e6, -1e6, 5e5)))),
        ("tiny and far", of_mesh(scaled(1e-3, Vec3::new(1.0, 0.0, -2.0)))),
        ("huge", of_mesh(scaled(1e12, Vec3::ZERO))),
        ("boxes", boxes()),
        ("flat", of_mesh(grid(16))),
        ("one", of_mesh(Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).expect("good"))),
        ("overlapping", overlapping()),
        ("mixed sizes", mixed()),
    ]
}

/// Worlds whose meshes or poses move, with 2 to 7 keys.
pub(crate) fn moving() -> Vec<(String, World)> {
    let mut worlds = Vec::new();
    for keys in [2, 3, 5, 7] {
        worlds.push((format!("mesh {keys} keys"), of_mesh(shaking(keys))));
        worlds.push((format!("pose {keys} keys"), sliding(keys)));
    }
    worlds
}

/// Worlds of user surfaces, masks and filters.
pub(crate) fn special() -> Vec<(&'static str, World)> {
    vec![("surfaces", surfaces()), ("masked", masked()), ("filtered", filtered())]
}

/// Small meshes by the thousand.
pub(crate) fn many(count: usize) -> World {
    let mut rng = Rng::new(21);
    let mut world = World::default();
    let shape = world.add_shape(Shape::Mesh(tetrahedron()));
    for _ in 0..count {
        world.place(shape, somewhere(&mut rng, 0.02));
    }
    world
}

fn tetrahedron() -> Mesh {
    let corners =
        vec![Vec3::ONE, Vec3::new(1.0, -1.0, -1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::new(-1.0, -1.0, 1.0)];
    Mesh::new(corners, vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]).expect("good")
}

fn somewhere(rng: &mut Rng, size: f32) -> Pose {
    let turn = Quat::from_axis_angle(rng.direction(), rng.unit() * 6.0);
    let scale = Vec3::splat(size * (0.2 + rng.unit()));
    let map = Affine3A::from_scale_rotation_translation(scale, turn, rng.cube());
    Transform::new(map).expect("invertible").into()
}

fn of_mesh(mesh: Mesh) -> World {
    let mut world = World::default();
    let shape = world.add_shape(Shape::Mesh(mesh));
    world.place(shape, None);
    world
}

fn bumpy() -> Mesh {
    let world = rays::closed();
    let Shape::Mesh(mesh) = &world.shapes[0] else { unreachable!("a mesh") };
    mesh.clone()
}

fn scaled(size: f32, at: Vec3) -> Mesh {
    let mesh = bumpy();
    let positions = mesh.positions().iter().map(|p| *p * size + at).collect();
    Mesh::new(positions, mesh.triangles().to_vec()).expect("good")
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
    let mut world = of_mesh(scaled(0.01, Vec3::new(3.0, 0.01, -2.0)));
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

fn shaking(keys: u8) -> Mesh {
    let mesh = bumpy();
    let at = |key: u8| {
        let shift = Vec3::new(f32::from(key) * 0.3, (f32::from(key) * 2.0).sin() * 0.2, 0.0);
        mesh.positions().iter().map(|p| *p * (1.0 + 0.1 * f32::from(key)) + shift).collect()
    };
    mesh.clone().with_keys((1..keys).map(|key| (at(key), None)).collect()).expect("good")
}

fn sliding(keys: u8) -> World {
    let mut rng = Rng::new(23);
    let mut world = World::default();
    let ball = Sphere { center: Vec3::X * 0.2, radius: 0.7 };
    let shapes = [Shape::Mesh(bumpy()), Shape::Sphere(ball), Shape::Mesh(shaking(keys))];
    let shapes = shapes.map(|shape| world.add_shape(shape));
    for i in 0..30 {
        let (axis, at, way) = (rng.direction(), rng.cube(), rng.cube() * 0.2);
        let size = Vec3::splat(0.05 + 0.2 * rng.unit());
        let key = |key: u8| {
            let turn = Quat::from_axis_angle(axis, f32::from(key) * 0.4);
            Affine3A::from_scale_rotation_translation(size, turn, at + way * f32::from(key))
        };
        let motion = Motion::new(&(0..keys).map(key).collect::<Vec<_>>()).expect("invertible");
        world.place(shapes[i % 3], motion);
    }
    world
}

/// Boxes that find their own hits, many in one surface.
#[derive(Debug)]
struct Cells(Vec<Aabb>);

impl Cells {
    fn sides(aabb: &Aabb, ray: &Ray) -> impl Iterator<Item = (f32, Vec3)> {
        let (aabb, ray) = (*aabb, *ray);
        let plane = move |(axis, upper): (usize, bool)| {
            let at = if upper { aabb.max[axis] } else { aabb.min[axis] };
            let t = (at - ray.o[axis]) / ray.d[axis];
            let mut p = ray.at(t);
            p[axis] = at;
            let inside = p.cmpge(aabb.min).all() && p.cmple(aabb.max).all();
            let n = Vec3::AXES[axis] * if upper { 1.0 } else { -1.0 };
            (inside && t >= ray.t_min && t <= ray.t_max).then_some((t, n))
        };
        (0..3).flat_map(|axis| [(axis, false), (axis, true)]).filter_map(plane)
    }
}

impl Surface for Cells {
    fn primitive_count(&self) -> u32 {
        u32::try_from(self.0.len()).expect("few")
    }

    fn primitive_bounds(&self, prim: u32) -> Aabb {
        self.0[prim as usize]
    }

    fn intersect(&self, prim: u32, ray: &Ray) -> Option<ShapeHit> {
        let sides = Self::sides(&self.0[prim as usize], ray);
        let (t, ng) = sides.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(ShapeHit { t, u: 0.0, v: 0.0, ng })
    }

    fn point(&self, prim: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let aabb = self.0[prim as usize];
        let p = ray.at(hit.t).clamp(aabb.min, aabb.max);
        SurfacePoint::smooth(p, Vec3::splat(1e-6), hit.ng, Vec2::ZERO)
    }
}

/// The plane y = -2, without end.
#[derive(Debug)]
struct Ground;

impl Surface for Ground {
    fn primitive_bounds(&self, _prim: u32) -> Aabb {
        let far = Vec3::new(f32::INFINITY, 0.0, f32::INFINITY);
        Aabb { min: -far - Vec3::Y * 2.0, max: far - Vec3::Y * 2.0 }
    }

    fn intersect(&self, _prim: u32, ray: &Ray) -> Option<ShapeHit> {
        let t = (-2.0 - ray.o.y) / ray.d.y;
        (t >= ray.t_min && t <= ray.t_max).then_some(ShapeHit { t, u: 0.0, v: 0.0, ng: Vec3::Y })
    }

    fn point(&self, _prim: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let p = ray.at(hit.t).with_y(-2.0);
        SurfacePoint::smooth(p, Vec3::splat(1e-6), Vec3::Y, Vec2::ZERO)
    }
}

fn surfaces() -> World {
    let mut rng = Rng::new(27);
    let mut world = rays::closed();
    let cell = |rng: &mut Rng| {
        let min = rng.cube();
        Aabb { min, max: min + Vec3::new(0.02 + rng.unit() * 0.3, 0.05, 0.02 + rng.unit() * 0.2) }
    };
    let many = world.add_shape(Shape::Surface(Arc::new(Cells((0..200).map(|_| cell(&mut rng)).collect()))));
    let one = world.add_shape(Shape::Surface(Arc::new(Cells(vec![cell(&mut rng)]))));
    world.place(many, None);
    for _ in 0..20 {
        world.place(many, somewhere(&mut rng, 0.2));
        world.place(one, somewhere(&mut rng, 0.5));
    }
    world
}

/// A world with something infinite in it; rays cannot be aimed by its bounds.
pub(crate) fn grounded() -> World {
    let mut world = surfaces();
    let ground = world.add_shape(Shape::Surface(Arc::new(Ground)));
    world.place(ground, None);
    world
}

fn masked() -> World {
    let mut rng = Rng::new(29);
    let mut world = boxes();
    let shape = world.add_shape(Shape::Mesh(tetrahedron()));
    for _ in 0..100 {
        world.place(shape, somewhere(&mut rng, 0.2));
    }
    for (i, placement) in world.placements.iter_mut().enumerate() {
        placement.mask = if i % 5 == 0 { u32::MAX } else { 1 << (i % 32) };
    }
    world
}

/// Lets every other stripe count.
#[derive(Debug)]
struct Stripes;

impl HitFilter for Stripes {
    fn accepts(&self, _ray: &Ray, hit: &ShapeHit, prim: u32) -> bool {
        ((hit.u + hit.v) * 6.0 + prim as f32).rem_euclid(2.0) < 1.0
    }
}

fn filtered() -> World {
    let mut rng = Rng::new(31);
    let mut world = boxes();
    let shapes = [Shape::Mesh(tetrahedron()), Shape::Mesh(shaking(3)), Shape::Mesh(bumpy())];
    for shape in shapes.map(|shape| world.add_shape(shape)) {
        for _ in 0..20 {
            world.place(shape, somewhere(&mut rng, 0.2));
        }
    }
    let stripes: Arc<dyn HitFilter> = Arc::new(Stripes);
    world.filters = world.placements.iter().step_by(2).map(|p| (p.shape, stripes.clone())).collect();
    world
}
