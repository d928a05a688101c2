//! Shapes that find their own hits, meshes that move, and filters, for tests of backends.

#![allow(dead_code, reason = "each test program uses a part")]

use crate::random::Random;
use glam::{Affine3A, DVec3, Quat, Vec2, Vec3};
use specula::geometry::{HitFilter, Mesh, Pose, Ray, ShapeHit, Surface, SurfacePoint};
use specula::math::{Aabb, Motion, Transform};

/// Ellipsoids with axes along those of the space, one a primitive; met in double precision. Their parameters are two
/// components of the normal.
#[derive(Clone, Debug)]
pub(crate) struct Ellipsoids(pub(crate) Vec<(Vec3, Vec3)>);

impl Ellipsoids {
    /// One, about the origin.
    pub(crate) fn one() -> Self {
        Self(vec![(Vec3::ZERO, Vec3::new(1.0, 0.5, 0.75))])
    }

    /// Many small ones.
    pub(crate) fn heap(count: usize) -> Self {
        let mut random = Random::new(11);
        let mut triple = || Vec3::from(random.triple());
        Self((0..count).map(|_| (triple() * 2.0 - 1.0, triple() * 0.2 + 0.03)).collect())
    }

    fn normal(&self, prim: u32, p: DVec3) -> DVec3 {
        let (center, radii) = self.0[prim as usize];
        let r2 = radii.as_dvec3() * radii.as_dvec3();
        ((p - center.as_dvec3()) / r2).normalize_or(DVec3::Z)
    }
}

impl Surface for Ellipsoids {
    fn primitive_count(&self) -> u32 {
        u32::try_from(self.0.len()).expect("few")
    }

    fn primitive_bounds(&self, prim: u32) -> Aabb {
        let (center, radii) = self.0[prim as usize];
        let reach = radii * 1.001;
        Aabb { min: center - reach, max: center + reach }
    }

    fn intersect(&self, prim: u32, ray: &Ray) -> Option<ShapeHit> {
        let (center, radii) = self.0[prim as usize];
        let (o, d) = ((ray.o - center).as_dvec3() / radii.as_dvec3(), ray.d.as_dvec3() / radii.as_dvec3());
        let (a, b, c) = (d.dot(d), o.dot(d), o.dot(o) - 1.0);
        let root = (b * b - a * c).sqrt();
        #[expect(clippy::cast_possible_truncation, reason = "rounded")]
        let t = [-b - root, -b + root].map(|t| (t / a) as f32);
        let t = t.into_iter().find(|t| (ray.t_min..=ray.t_max).contains(t))?;
        let n = self.normal(prim, ray.o.as_dvec3() + ray.d.as_dvec3() * f64::from(t)).as_vec3();
        Some(ShapeHit { t, u: n.x, v: n.y, ng: n })
    }

    fn point(&self, prim: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let (center, radii) = self.0[prim as usize];
        let out = (ray.at(hit.t) - center) / radii;
        let p = center + out.normalize_or(Vec3::Z) * radii;
        let n = self.normal(prim, p.as_dvec3()).as_vec3();
        let p_error = (center.abs() + radii) * 1e-6;
        SurfacePoint::smooth(p, p_error, n, Vec2::new(hit.u, hit.v))
    }
}

/// Lets through what falls on the dark squares of a board of solid cells.
#[derive(Debug)]
pub(crate) struct Cells(pub(crate) f32);

impl HitFilter for Cells {
    fn accepts(&self, ray: &Ray, hit: &ShapeHit, _prim: u32) -> bool {
        // Flat things through the origin must not lie between cells.
        let cell = (ray.at(hit.t) / self.0 + Vec3::new(0.31, 0.43, 0.57)).floor();
        (cell.x + cell.y + cell.z).rem_euclid(2.0) < 0.5
    }
}

/// Lets through what falls on the dark squares of a board over a triangle's own parameters.
#[derive(Debug)]
pub(crate) struct Board(pub(crate) f32);

impl HitFilter for Board {
    fn accepts(&self, _ray: &Ray, hit: &ShapeHit, prim: u32) -> bool {
        let square = (Vec2::new(hit.u, hit.v) * self.0).floor();
        (square.x + square.y + (prim % 5) as f32).rem_euclid(2.0) < 0.5
    }
}

/// A bumpy sphere of radius about `size` whose faces are quads, triangles at the poles, with `keys` keys: it breathes,
/// and drifts along x by `drift`.
pub(crate) fn breathing(size: f32, keys: usize, drift: f32) -> Mesh {
    const AROUND: u16 = 16;
    const UP: u16 = 10;
    let positions = |key: usize| {
        let part = if keys > 1 { key as f32 / (keys - 1) as f32 } else { 0.0 };
        let breath = 1.0 + 0.3 * (part * 9.0).sin();
        let shift = Vec3::X * (drift * part);
        let mut all = vec![Vec3::Z * size + shift, -Vec3::Z * size + shift];
        for j in 1..UP {
            let theta = std::f32::consts::PI * f32::from(j) / f32::from(UP);
            for i in 0..AROUND {
                let phi = std::f32::consts::TAU * f32::from(i) / f32::from(AROUND);
                let r = size * (1.0 + 0.1 * breath * (5.0 * phi).sin() * (7.0 * theta).sin());
                let p = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
                all.push(p * r * Vec3::new(breath, 1.0, 1.0) + shift);
            }
        }
        all
    };
    let at = |i: u16, j: u16| 2 + u32::from((j - 1) * AROUND + i % AROUND);
    let mut triangles = Vec::new();
    let mut face = |corners: &[u32]| {
        triangles.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
    };
    for i in 0..AROUND {
        face(&[0, at(i, 1), at(i + 1, 1)]);
        (1..UP - 1).for_each(|j| face(&[at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]));
        face(&[1, at(i + 1, UP - 1), at(i, UP - 1)]);
    }
    let mesh = Mesh::new(positions(0), triangles).expect("good");
    mesh.with_keys((1..keys).map(|key| (positions(key), None)).collect()).expect("good")
}

/// A still pose that turns and stretches; mirrored if asked for.
pub(crate) fn skewed(random: &mut Random, mirrored: bool) -> Pose {
    Transform::new(skew(random, mirrored)).expect("invertible").into()
}

/// A pose through `keys` keys, each a little way from the one before.
pub(crate) fn tumbling(random: &mut Random, mirrored: bool, keys: usize) -> Pose {
    let start = skew(random, mirrored);
    let axis = direction(random);
    let keys: Vec<Affine3A> = (0..keys)
        .map(|key| {
            let part = key as f32;
            Affine3A::from_translation(Vec3::new(0.1, -0.07, 0.05) * part * (1.0 + part * 0.1))
                * Affine3A::from_axis_angle(axis, 0.2 * part)
                * start
        })
        .collect();
    Motion::new(&keys).expect("invertible at all times").into()
}

fn skew(random: &mut Random, mirrored: bool) -> Affine3A {
    let stretch = Vec3::from(random.triple()) * 0.2 + 0.1;
    let mirror = if mirrored { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
    let turn = Quat::from_axis_angle(direction(random), random.unit() * 6.0);
    Affine3A::from_scale_rotation_translation(stretch * mirror, turn, Vec3::from(random.triple()) * 2.4 - 1.2)
}

fn direction(random: &mut Random) -> Vec3 {
    let d = random.direction();
    Vec3::new(d.x, d.y, d.z)
}

/// Rays from around a box into it, at moments of the whole shutter, keys and ends among them; some of limited range.
pub(crate) fn rays_into(bounds: Aabb, count: usize, seed: u32) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let radius = bounds.radius();
    (0..count)
        .map(|i| {
            let mut inside =
                |reach: f32| bounds.center() + (Vec3::from(random.triple()) - 0.5) * bounds.size() * reach;
            let (o, target) = (inside(1.5), inside(0.9));
            let [a, b, c] = random.triple();
            let time = if i % 3 == 0 { (a * 13.0).floor() / 12.0 } else { a };
            let mut ray = Ray::new(o, (target - o).normalize() * (0.5 + b)).at_time(time);
            match i % 5 {
                0 => ray.t_max = radius * c * 2.0,
                1 => ray.t_min = radius * c * 0.5,
                _ => {}
            }
            ray
        })
        .collect()
}
