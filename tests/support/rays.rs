//! Rays for tests of backends, some of them hard to answer.

use glam::Vec3;
use specula::geometry::{Ray, Shape, World};

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

/// How rays are aimed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aim {
    /// From anywhere about the world to anywhere, some of limited range.
    Anywhere,
    /// Along an axis, with zeros in the direction.
    Axis,
    /// At edges and rims.
    Edge,
    /// Exactly at corners.
    Vertex,
    /// Nearly along the surface.
    Grazing,
    /// From a thousand times the size of the world.
    Far,
    /// From a million times the size of the world.
    Farthest,
}

impl Aim {
    pub(crate) const ALL: [Self; 7] =
        [Self::Anywhere, Self::Axis, Self::Edge, Self::Vertex, Self::Grazing, Self::Far, Self::Farthest];

    /// `count` rays, the same every time.
    pub(crate) fn rays(self, world: &World, count: usize) -> Vec<Ray> {
        let mut rng = Rng::new(self as u64 + 100);
        (0..count).map(|_| self.ray(world, &mut rng)).collect()
    }

    fn ray(self, world: &World, rng: &mut Rng) -> Ray {
        let bounds = world.bounds();
        let (center, radius) = (bounds.center(), bounds.radius());
        // Flat worlds are looked at from outside too.
        let o = center + rng.cube() * bounds.size().max(Vec3::splat(radius * 0.2)) * 0.75;
        let time = rng.unit();
        let far = |rng: &mut Rng, times: f32| {
            let o = center + rng.direction() * radius * times;
            Ray::new(o, center + rng.cube() * bounds.size() * 0.5 - o)
        };
        let mut ray = match self {
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
            Self::Edge => Ray::new(o, surface_point(world, rng, time, Part::Edge).0 - o),
            Self::Vertex => Ray::new(o, surface_point(world, rng, time, Part::Corner).0 - o),
            Self::Grazing => {
                let (p, n) = surface_point(world, rng, time, Part::Inside);
                let along = n.cross(rng.direction()).normalize_or(Vec3::X);
                let d = along - n * (1e-3 * rng.unit());
                Ray::new(p - d * radius * rng.unit(), d)
            }
            Self::Far => far(rng, 1e3),
            Self::Farthest => far(rng, 1e6),
        };
        if matches!(self, Self::Edge | Self::Vertex | Self::Far | Self::Farthest) {
            ray.d = about_unit(ray.d);
        }
        if rng.below(4) == 0 {
            ray.mask = rng.bits();
        }
        ray.at_time(time)
    }
}

/// The direction with a length from 0.7 to 1.5, exactly the same way.
pub(crate) fn about_unit(d: Vec3) -> Vec3 {
    d * (-d.length().log2().round()).exp2()
}

/// Where on a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Anywhere within.
    Inside,
    /// On an edge or rim.
    Edge,
    /// At a corner; on an edge or rim of what has none.
    Corner,
}

/// A point of a surface at a moment of the shutter, and the normal there.
pub(crate) fn surface_point(world: &World, rng: &mut Rng, time: f32, part: Part) -> (Vec3, Vec3) {
    let placement = &world.placements[rng.below(world.placements.len())];
    let (p, n) = match &world.shapes[placement.shape.index()] {
        Shape::Mesh(mesh) => {
            let triangle = rng.below(mesh.triangles().len());
            let [a, b, c] = mesh.corners_at(u32::try_from(triangle).expect("few triangles"), time);
            let (u, v) = match part {
                Part::Corner => (0.0, 0.0),
                Part::Edge => (rng.unit(), 0.0),
                Part::Inside => (rng.unit() * 0.5, rng.unit() * 0.5),
            };
            (a + (b - a) * u + (c - a) * v, (b - a).cross(c - a).normalize_or(Vec3::Z))
        }
        Shape::Sphere(sphere) => {
            let n = rng.direction();
            (sphere.center + n * sphere.radius, n)
        }
        Shape::Disc(disc) => {
            let rim = disc.normal.cross(rng.direction()).normalize_or(Vec3::X);
            let out = if part == Part::Inside { rng.unit() } else { 1.0 };
            (disc.center + rim * disc.radius * out, disc.normal)
        }
        shape @ Shape::Surface(_) => {
            // A ray finds one; not every ray does, for there may be holes.
            let prim = u32::try_from(rng.below(shape.primitive_count())).expect("few");
            let bounds = shape.primitive_bounds(prim);
            let (ray, hit) = loop {
                let target = bounds.center() + rng.cube() * bounds.size() * 0.5;
                let inwards = rng.direction() * bounds.radius() * 3.0;
                let ray = Ray::new(target - inwards, inwards);
                if let Some(hit) = shape.intersect(prim, &ray) {
                    break (ray, hit);
                }
            };
            let point = shape.point(prim, &ray, &hit);
            (point.p, point.ng)
        }
    };
    match placement.pose.at(time) {
        None => (p, n),
        Some(t) => (t.point(p), t.normal(n).normalize_or(Vec3::Z)),
    }
}

/// The ray with something else about it.
pub(crate) fn changed(mut ray: Ray, change: impl FnOnce(&mut Ray)) -> Ray {
    change(&mut ray);
    ray
}
