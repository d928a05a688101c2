//! Rates, build times and sizes of the backends: Embree with single rays, `bvh2` and `cwbvh`.
//!
//! The dragon and Sponza, where their files are found, and a landscape of a million triangles; camera rays, shadow rays as
//! any hits and diffuse bounces, in one thread. `cargo bench --bench backends -- [--record] [part of a race's name]`.

#![expect(clippy::print_stdout, reason = "a bench prints its tables")]

#[path = "support/models.rs"]
mod models;
#[path = "support/rays.rs"]
mod rays;
#[path = "support/mod.rs"]
mod support;
#[path = "support/terrain.rs"]
mod terrain;

use glam::Vec3;
use models::model;
use rays::{Recorded, record};
use specula::accel::bvh::{Options, Preset};
use specula::accel::embree::{BuildOptions, EmbreeAccel};
use specula::accel::{Accel, Bvh2Accel, CwBvhAccel};
use specula::geometry::{Mesh, Ray, Shape, World};
use specula::render::Phase;
use std::sync::Arc;
use support::{Bench, Race};

/// Pixels sampled, along each side of the picture.
const TILES: u32 = 96;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut bench = Bench::new("backends");
    on_mesh(&mut bench, "terrain", terrain::terrain(708), Some(terrain::view()))?;
    if let Some(mesh) = model("dragon") {
        on_mesh(&mut bench, "dragon", mesh, None)?;
    }
    if let Some(mesh) = model("sponza") {
        let bounds = mesh.bounds();
        let eye = bounds.center() - Vec3::X * bounds.size().x * 0.3;
        on_mesh(&mut bench, "sponza", mesh, Some((eye, bounds.center() + Vec3::Y * 0.1)))?;
    }
    bench.finish()?;
    Ok(())
}

fn on_mesh(
    bench: &mut Bench,
    name: &str,
    mesh: Mesh,
    view: Option<(Vec3, Vec3)>,
) -> Result<(), Box<dyn std::error::Error>> {
    let kinds = ["primary", "shadow", "diffuse"].map(|kind| format!("{name} {kind}"));
    if !kinds.iter().any(|race| bench.wants(race)) {
        return Ok(());
    }
    let triangles = mesh.triangles().len();
    let mut world = World::default();
    let shape = world.add_shape(Shape::Mesh(mesh));
    world.place(shape, None);
    let world = Arc::new(world);
    println!("\n{name}: {triangles} triangles");
    let embree = told("embree", triangles, || EmbreeAccel::build(&world, &BuildOptions::default()).ok());
    let embree = embree.ok_or("Embree does not build")?;
    for preset in Preset::ALL {
        let options = Options { preset, ..Options::default() };
        told(&format!("bvh2 {preset:?}"), triangles, || Some(Bvh2Accel::build(&world, &options)));
        told(&format!("cwbvh {preset:?}"), triangles, || Some(CwBvhAccel::build(&world, &options)));
    }
    let options = Options::default();
    let (bvh2, cwbvh) = (Bvh2Accel::build(&world, &options), CwBvhAccel::build(&world, &options));
    let bounds = world.bounds();
    let outside = bounds.center() + Vec3::new(0.4, 0.5, 1.0).normalize() * bounds.radius() * 2.4;
    let (eye, at) = view.unwrap_or((outside, bounds.center()));
    let Recorded { primary, shadow, diffuse } = record(&world, &embree, eye, at, TILES);
    let [primary_name, shadow_name, diffuse_name] = kinds;
    for (name, rays) in [(primary_name, &primary.single), (diffuse_name, &diffuse.single)] {
        bench.run(
            Race::new(name, rays.len(), "rays")
                .with("embree", || closest(&embree, rays))
                .with("bvh2", || closest(&bvh2, rays))
                .with("cwbvh", || closest(&cwbvh, rays)),
        );
    }
    let rays = &shadow.single;
    bench.run(
        Race::new(shadow_name, rays.len(), "rays")
            .with("embree", || any(&embree, rays))
            .with("bvh2", || any(&bvh2, rays))
            .with("cwbvh", || any(&cwbvh, rays)),
    );
    Ok(())
}

/// Builds, and prints how long that took and what it holds.
fn told<A: Accel>(name: &str, triangles: usize, build: impl Fn() -> Option<A>) -> Option<A> {
    let (accel, Phase { wall, cpu }) = Phase::of(build);
    let accel = accel?;
    let bytes = accel.bytes() as f64 / triangles as f64;
    println!(
        "  build {name:16} {:7.3} s CPU {:7.3} s wall {bytes:6.1} bytes a triangle",
        cpu.as_secs_f64(),
        wall.as_secs_f64()
    );
    Some(accel)
}

fn closest(accel: &impl Accel, rays: &[Ray]) -> u64 {
    let hits = rays.iter().filter_map(|ray| accel.intersect(ray));
    hits.fold(0, |sum, hit| sum + u64::from(hit.t.to_bits() ^ hit.prim))
}

fn any(accel: &impl Accel, rays: &[Ray]) -> u64 {
    rays.iter().fold(0, |sum, ray| sum + u64::from(accel.occluded(ray)))
}
