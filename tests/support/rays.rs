//! Worlds and rays for tests of backends: every kind of shape and placement, and rays that are hard to answer.

use glam::{Affine3A, Quat, Vec3};
use specula::geometry::{Disc, Mesh, Ray, Shape, Sphere, World};
use specula::math::Transform;

/// A small generator of its own (Steele, Lea, Flood 2014, Fast Splittable Pseudorandom Number Generators), so that the
/// tests do not lean on what other tests check.
pub(crate) struct Rng(u64);

impl Rng {
    /// A sequence per seed.
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 32 random bits.
    pub(crate) fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 32) as u32
    }

    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }

    /// Below `n`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.bits() as usize % n
    }

    /// In the cube from -1 to 1.
    pub(crate) fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    /// Of unit length.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.cube();
            if v.length_squared() > 0.01 && v.length_squared() <= 1.0 {
                return v.normalize();
            }
        }
    }
}

/// The worlds that backends must agree on.
pub(crate) fn worlds() -> Vec<(&'static str, World)> {
    vec![
        ("soup", soup()),
        ("closed", closed()),
        ("round", round()),
        ("instanced", instanced()),
        ("displaced", displaced()),
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
    add(&mut world, Shape::Mesh(Mesh::new(positions, triangles).expect("good")), None);
    world
}

/// A closed bumpy sphere about the origin.
pub(crate) fn closed() -> World {
    let mut world = World::default();
    add(&mut world, Shape::Mesh(bumpy(24, 16)), None);
    world
}

/// Spheres and discs, some inside others.
fn round() -> World {
    let mut rng = Rng::new(2);
    let mut world = World::default();
    for _ in 0..40 {
        let sphere = Sphere { center: rng.cube(), radius: 0.02 + 0.2 * rng.unit() };
        add(&mut world, Shape::Sphere(sphere), None);
        let disc = Disc { center: rng.cube(), normal: rng.direction(), radius: 0.02 + 0.2 * rng.unit() };
        add(&mut world, Shape::Disc(disc), None);
    }
    world
}

/// Every kind of shape, placed with and without transforms, mirrored and stretched ones among them.
pub(crate) fn instanced() -> World {
    let mut rng = Rng::new(4);
    let mut world = World::default();
    let sphere = Sphere { center: Vec3::new(0.2, 0.0, 0.0), radius: 0.7 };
    let disc = Disc { center: Vec3::ZERO, normal: Vec3::new(0.0, 0.6, 0.8), radius: 0.8 };
    let shapes = [Shape::Mesh(bumpy(10, 6)), Shape::Sphere(sphere), Shape::Disc(disc)];
    let shapes = shapes.map(|shape| world.add_shape(shape));
    for i in 0..36 {
        let stretch = Vec3::new(0.05 + 0.2 * rng.unit(), 0.05 + 0.2 * rng.unit(), 0.05 + 0.2 * rng.unit());
        let mirror = if i % 4 == 0 { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
        let turn = Quat::from_axis_angle(rng.direction(), rng.unit() * 6.0);
        let affine = Affine3A::from_scale_rotation_translation(stretch * mirror, turn, rng.cube());
        world.place(shapes[i % 3], Transform::new(affine));
    }
    for shape in shapes {
        world.place(shape, None);
    }
    world
}

/// The bumpy sphere far from the origin: coordinates of 1000 with features of 0.1.
fn displaced() -> World {
    let at = Vec3::new(1000.0, -700.0, 300.0);
    let mesh = bumpy(24, 16);
    let positions = mesh.positions().iter().map(|p| *p + at).collect();
    let mut world = World::default();
    add(&mut world, Shape::Mesh(Mesh::new(positions, mesh.triangles().to_vec()).expect("good")), None);
    world
}

/// A map that turns, stretches and mirrors.
pub(crate) fn skewed() -> Transform {
    let turn = Quat::from_rotation_x(0.7) * Quat::from_rotation_z(-1.1);
    let scale = Vec3::new(-2.0, 0.5, 3.0);
    Transform::new(Affine3A::from_scale_rotation_translation(scale, turn, Vec3::X)).expect("invertible")
}

fn add(world: &mut World, shape: Shape, transform: Option<Transform>) {
    let shape = world.add_shape(shape);
    world.place(shape, transform);
}

/// A sphere of radius about 1 with bumps, closed at seam and poles by shared vertices.
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
            triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            triangles.push([at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]);
        }
    }
    Mesh::new(positions, triangles).expect("good")
}

/// How rays are aimed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aim {
    /// From anywhere about the world to anywhere, some of limited range.
    Anywhere,
    /// Along an axis, with zeros in the direction.
    Axis,
    /// At edges, corners and rims.
    Edge,
    /// Nearly along the surface.
    Grazing,
    /// From a thousand times the size of the world.
    Far,
}

impl Aim {
    pub(crate) const ALL: [Self; 5] = [Self::Anywhere, Self::Axis, Self::Edge, Self::Grazing, Self::Far];

    /// `count` rays, the same every time.
    pub(crate) fn rays(self, world: &World, count: usize) -> Vec<Ray> {
        let mut rng = Rng::new(self as u64 + 100);
        (0..count).map(|_| self.ray(world, &mut rng)).collect()
    }

    fn ray(self, world: &World, rng: &mut Rng) -> Ray {
        let bounds = world.bounds();
        let (center, radius) = (bounds.center(), bounds.radius());
        let o = center + rng.cube() * bounds.size() * 0.75;
        match self {
            Self::Anywhere => {
                let ray = Ray::new(o, rng.direction() * (0.5 + rng.unit()));
                match rng.below(4) {
                    0 => ray.until(radius * rng.unit()),
                    1 => changed(ray, |ray| ray.t_min = radius * 0.3 * rng.unit()),
                    _ => ray,
                }
            }
            Self::Axis => {
                let sign = if rng.bits() & 1 == 0 { 1.0 } else { -1.0 };
                Ray::new(o, Vec3::AXES[rng.below(3)] * sign)
            }
            Self::Edge => Ray::new(o, edge_point(world, rng) - o),
            Self::Grazing => {
                let (p, n) = surface_point(world, rng, false);
                let along = n.cross(rng.direction()).normalize_or(Vec3::X);
                let d = along - n * (1e-3 * rng.unit());
                Ray::new(p - d * radius * rng.unit(), d)
            }
            Self::Far => {
                let o = center + rng.direction() * radius * 1000.0;
                Ray::new(o, center + rng.cube() * bounds.size() * 0.5 - o)
            }
        }
    }
}

/// A point on an edge, corner or rim.
pub(crate) fn edge_point(world: &World, rng: &mut Rng) -> Vec3 {
    surface_point(world, rng, true).0
}

/// A point of a surface and its normal, in the world; on an edge if asked for.
fn surface_point(world: &World, rng: &mut Rng, edge: bool) -> (Vec3, Vec3) {
    let placement = &world.placements[rng.below(world.placements.len())];
    let (p, n) = match &world.shapes[placement.shape.index()] {
        Shape::Mesh(mesh) => {
            let triangle = rng.below(mesh.triangles().len());
            let [a, b, c] = mesh.corners(u32::try_from(triangle).expect("few triangles"));
            let (u, v) = match (edge, rng.below(3)) {
                (true, 0) => (0.0, 0.0),
                (true, _) => (rng.unit(), 0.0),
                (false, _) => (rng.unit() * 0.5, rng.unit() * 0.5),
            };
            (a + (b - a) * u + (c - a) * v, (b - a).cross(c - a).normalize_or(Vec3::Z))
        }
        Shape::Sphere(sphere) => {
            let n = rng.direction();
            (sphere.center + n * sphere.radius, n)
        }
        Shape::Disc(disc) => {
            let rim = disc.normal.cross(rng.direction()).normalize_or(Vec3::X);
            let out = if edge { 1.0 } else { rng.unit() };
            (disc.center + rim * disc.radius * out, disc.normal)
        }
        Shape::Surface(_) => unreachable!("no world here has one"),
    };
    match placement.pose.at(0.0) {
        None => (p, n),
        Some(t) => (t.point(p), t.normal(n).normalize_or(Vec3::Z)),
    }
}

/// The ray with something else about it.
pub(crate) fn changed(mut ray: Ray, change: impl FnOnce(&mut Ray)) -> Ray {
    change(&mut ray);
    ray
}
