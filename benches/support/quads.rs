//! Quads beside pairs of triangles, on files whose faces are mostly quads.

use crate::support::{Bench, Race};
use crate::{Accel as _, Recorded, race_all, record};
use glam::Vec3;
use specula::accel::embree::{BuildOptions, EmbreeAccel, SceneOptions};
use specula::geometry::{Mesh, Shape, World};
use specula::math::Aabb;
use std::sync::Arc;

/// Where the camera stands and what it looks at.
pub(crate) type View = fn(Aabb) -> (Vec3, Vec3);

/// From one end of a building to the other.
pub(crate) fn inside(bounds: Aabb) -> (Vec3, Vec3) {
    let (center, size) = (bounds.center(), bounds.size());
    (center + size * Vec3::new(0.3, -0.2, 0.02), center - size * Vec3::new(0.3, 0.15, 0.0))
}

/// All of it.
pub(crate) fn outside(bounds: Aabb) -> (Vec3, Vec3) {
    let away = Vec3::new(0.4, 0.5, 1.0).normalize() * bounds.radius() * 2.0;
    (bounds.center() + away, bounds.center())
}

/// Builds and queries.
pub(crate) fn compare(
    bench: &mut Bench,
    name: &str,
    mesh: Mesh,
    view: View,
) -> Result<(), Box<dyn std::error::Error>> {
    let triangles = mesh.triangles().len();
    let mut world = World::default();
    let shape = world.add_shape(Shape::Mesh(mesh));
    world.place(shape, None);
    let world = Arc::new(world);
    let build = |quads| {
        let scene = SceneOptions { quads, ..SceneOptions::default() };
        EmbreeAccel::build(&world, &BuildOptions { scene, ..BuildOptions::default() })
    };
    let (pairs, quads) = (build(false)?, build(true)?);
    for (what, accel) in [("triangles", &pairs), ("quads", &quads)] {
        println!("{name}: {what}: {} bytes, {} a triangle", accel.bytes(), accel.bytes() / triangles);
    }
    let race = Race::new(format!("{name} build"), triangles, "triangles");
    let pass = |quads| move || build(quads).expect("Embree builds").bytes() as u64;
    bench.run(race.with("triangles", pass(false)).with("quads", pass(true)));
    let (eye, at) = view(world.bounds());
    let rays: Recorded = record(&world, &pairs, eye, at, 64);
    race_all(bench, name, &rays, &[("triangles", pairs.scene()), ("quads", quads.scene())]);
    Ok(())
}
