//! Embree's own spheres and discs beside the same as user geometry: their speed, and their error far away.

use crate::support::Bench;
use crate::{Accel as _, race_all, record};
use glam::{DVec3, Vec2, Vec3};
use specula::accel::embree::{
    BuildOptions, Committed, Config, Device, EmbreeAccel, EmbreeError, Geometry, Scene, SceneOptions,
    UserShape,
};
use specula::geometry::{Disc, Ray, Shape, ShapeHit, Sphere, Surface, SurfacePoint, World};
use specula::math::Aabb;
use specula::sampling::pcg::pcg3d;
use std::sync::Arc;

/// Round things of one kind, as primitives of one surface.
#[derive(Debug)]
struct Heap(Vec<Shape>);

impl Surface for Heap {
    fn primitive_count(&self) -> u32 {
        u32::try_from(self.0.len()).expect("few")
    }

    fn primitive_bounds(&self, prim: u32) -> Aabb {
        self.0[prim as usize].bounds()
    }

    fn intersect(&self, prim: u32, ray: &Ray) -> Option<ShapeHit> {
        self.0[prim as usize].intersect(0, ray)
    }

    fn point(&self, _prim: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        SurfacePoint::smooth(ray.at(hit.t), Vec3::ZERO, hit.ng.normalize(), Vec2::ZERO)
    }
}

/// Three numbers in [0, 1).
fn random(index: u32, seed: u32) -> Vec3 {
    Vec3::from(pcg3d([index, seed, 5]).map(|h| (h >> 8) as f32 / 16_777_216.0))
}

fn spheres(count: u32) -> Vec<Sphere> {
    let radius = 0.5 / (count as f32).cbrt();
    (0..count).map(|i| Sphere { center: random(i, 0), radius: radius * (0.3 + random(i, 1).x) }).collect()
}

fn discs(count: u32) -> Vec<Disc> {
    let spheres = spheres(count).into_iter().zip(0..);
    let normal = |i| (random(i, 2) - 0.5).normalize_or(Vec3::Y);
    spheres.map(|(s, i)| Disc { center: s.center, normal: normal(i), radius: s.radius }).collect()
}

/// A world with a placement for each.
fn placed(shapes: impl Iterator<Item = Shape>) -> World {
    let mut world = World::default();
    for shape in shapes {
        let shape = world.add_shape(shape);
        world.place(shape, None);
    }
    world
}

fn build(world: &World) -> Result<EmbreeAccel, EmbreeError> {
    EmbreeAccel::build(world, &BuildOptions::default())
}

/// A scene of one geometry.
fn alone(device: &Device, geometry: Geometry) -> Result<Scene<Committed>, EmbreeError> {
    let mut scene = Scene::new(device, SceneOptions::default())?;
    scene.attach(0, geometry)?;
    scene.commit()
}

/// One and ten thousand of each kind: each a geometry, and all in one.
pub(crate) fn compare(bench: &mut Bench) -> Result<(), Box<dyn std::error::Error>> {
    for count in [1, 10_000] {
        let (spheres, discs) = (spheres(count), discs(count));
        let device = Device::new(Config::default())?;
        let own = alone(&device, Geometry::spheres(&device, &spheres)?)?;
        let shapes = spheres.into_iter().map(Shape::Sphere).collect();
        of_kind(bench, &format!("{count} spheres"), shapes, &own, &device)?;
        let own = alone(&device, Geometry::discs(&device, &discs)?)?;
        let shapes = discs.into_iter().map(Shape::Disc).collect();
        of_kind(bench, &format!("{count} discs"), shapes, &own, &device)?;
    }
    Ok(())
}

fn of_kind(
    bench: &mut Bench,
    name: &str,
    shapes: Vec<Shape>,
    own: &Scene<Committed>,
    device: &Device,
) -> Result<(), Box<dyn std::error::Error>> {
    let world = placed(shapes.iter().cloned());
    let each_user = |shape: &Shape| Shape::Surface(Arc::new(Heap(vec![shape.clone()])));
    let (own_each, user_each) = (build(&world)?, build(&placed(shapes.iter().map(each_user)))?);
    let heap = UserShape::new(Shape::Surface(Arc::new(Heap(shapes))), None);
    let user = alone(device, Geometry::surface(device, heap)?)?;
    println!("{name}: {} bytes as placements, {} as user geometry", own_each.bytes(), user_each.bytes());
    let eye = Vec3::new(0.9, 1.1, 2.4);
    let rays = record(&world, &own_each, eye, Vec3::splat(0.5), 48);
    let contestants = [
        ("own each", own_each.scene()),
        ("user each", user_each.scene()),
        ("own in one", own),
        ("user in one", &user),
    ];
    race_all(bench, name, &rays, &contestants);
    Ok(())
}

/// Prints the errors of the ray parameter, for a sphere of radius one at growing distances, against double precision.
pub(crate) fn print_errors() -> Result<(), Box<dyn std::error::Error>> {
    println!("\nerrors of t at a sphere of radius 1, largest of 10000 rays; and wrong hits or misses");
    for distance in [3.0_f32, 10.0, 1e3, 1e4, 1e5, 1e6] {
        let sphere = Sphere { center: Vec3::new(0.36, 0.48, 0.8) * distance, radius: 1.0 };
        let own = build(&placed([Shape::Sphere(sphere)].into_iter()))?;
        let user = Shape::Surface(Arc::new(Heap(vec![Shape::Sphere(sphere)])));
        let user = build(&placed([user].into_iter()))?;
        let [own, user] = [own.scene(), user.scene()].map(|scene| error(scene, &sphere));
        println!("  distance {distance:9}: own {own:?}, user geometry {user:?}");
    }
    Ok(())
}

/// The largest error, and how often hit and miss are mistaken.
fn error(scene: &Scene<Committed>, sphere: &Sphere) -> (f64, usize) {
    let mut largest = 0.0_f64;
    let mut mistaken = 0;
    for i in 0..10_000 {
        let target = sphere.center + (random(i, 3) * 2.0 - 1.0) * 1.1 * sphere.radius;
        let ray = Ray::new(Vec3::ZERO, target.normalize());
        let exact = exact(&ray, sphere);
        match (scene.intersect(&ray), exact) {
            (Some(hit), Some(t)) => largest = largest.max((f64::from(hit.t) - t).abs()),
            (None, None) => {}
            _ => mistaken += 1,
        }
    }
    (largest, mistaken)
}

fn exact(ray: &Ray, sphere: &Sphere) -> Option<f64> {
    let (o, d): (DVec3, DVec3) = ((ray.o - sphere.center).as_dvec3(), ray.d.as_dvec3());
    let (a, b, c) = (d.dot(d), o.dot(d), o.dot(o) - f64::from(sphere.radius).powi(2));
    let root = (b * b - a * c).sqrt();
    [-b - root, -b + root].into_iter().map(|t| t / a).find(|&t| t >= 0.0)
}
