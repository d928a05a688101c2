//! What shapes cost as triangles and as surfaces that find their own hits, in time and memory: height fields, and a ring.
//!
//! `cargo bench --bench shapes -- [--record] [part of a race's name]`.

#![expect(clippy::print_stdout, reason = "a bench tells memory, too")]

#[path = "support/grid.rs"]
mod grid;
#[path = "support/rays.rs"]
mod rays;
#[path = "support/mod.rs"]
mod support;
#[path = "support/terrain.rs"]
mod terrain;

use glam::{Vec2, Vec3};
use grid::Grid;
use rays::record;
use specula::accel::embree::{BuildOptions, EmbreeAccel};
use specula::accel::{Accel, Brute};
use specula::geometry::{HeightField, Mesh, Ray, Shape, Torus, World};
use std::f32::consts::TAU;
use std::sync::Arc;
use support::{Bench, Race};

/// Pixels sampled, along each side of the picture.
const TILES: u32 = 64;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut bench = Bench::new("shapes");
    for count in [256_u32, 1024] {
        let place = |i: u32| i as f32 / (count - 1) as f32 * 2.0 - 1.0;
        let nodes = (0..count).flat_map(|row| (0..count).map(move |column| (column, row)));
        let heights = nodes.map(|(column, row)| terrain::height(place(column), place(row))).collect();
        race(&mut bench, count, &HeightField::new(count, count, heights)?)?;
    }
    race_rings(&mut bench)?;
    bench.finish()?;
    Ok(())
}

fn world_of(shape: Shape) -> World {
    let mut world = World::default();
    let id = world.add_shape(shape);
    world.place(id, None);
    world
}

fn race(bench: &mut Bench, count: u32, field: &HeightField) -> Result<(), Box<dyn std::error::Error>> {
    let mesh = field.mesh(Vec3::ZERO, Vec2::splat(2.0), true)?;
    let mesh_bytes = mesh.bytes();
    let grid = Grid::new(field);
    let grid_bytes = grid.bytes();
    let triangles = world_of(Shape::Mesh(mesh));
    let walked = world_of(Shape::Surface(Arc::new(grid)));
    let embree = EmbreeAccel::build(&triangles, &BuildOptions::default())?;
    let within = EmbreeAccel::build(&walked, &BuildOptions::default())?;
    let alone = Brute::new(Arc::new(walked));
    println!("{count} x {count}: mesh {mesh_bytes} B + hierarchy {} B; grid {grid_bytes} B", embree.bytes());
    let (eye, at) = terrain::view();
    let recorded = record(&triangles, &embree, eye, at, TILES);
    for (name, rays) in [("primary", &recorded.primary.single), ("diffuse", &recorded.diffuse.single)] {
        // All must do the same work: a ray in a thousand may slip by on a seam.
        let counts = [met(&embree, rays), met(&within, rays), met(&alone, rays)];
        assert!(counts[1..].iter().all(|n| n.abs_diff(counts[0]) * 1000 <= rays.len()), "{name}: {counts:?}");
        let race = Race::new(format!("heights {count} {name}"), rays.len(), "rays")
            .with("triangles in Embree", || sum(&embree, rays))
            .with("grid within Embree", || sum(&within, rays))
            .with("grid alone", || sum(&alone, rays));
        bench.run(race);
    }
    Ok(())
}

/// A ring as itself and as triangles, more and fewer.
fn race_rings(bench: &mut Bench) -> Result<(), Box<dyn std::error::Error>> {
    let ring = Torus::new(Vec3::ZERO, Vec3::Y, 1.0, 0.35).ok_or("a ring")?;
    let world = world_of(Shape::Surface(Arc::new(ring)));
    let exact = EmbreeAccel::build(&world, &BuildOptions::default())?;
    let rays = record(&world, &exact, Vec3::new(0.5, 1.8, 2.2), Vec3::ZERO, TILES);
    let coarse = EmbreeAccel::build(&world_of(Shape::Mesh(ring_of(64)?)), &BuildOptions::default())?;
    let fine = EmbreeAccel::build(&world_of(Shape::Mesh(ring_of(512)?)), &BuildOptions::default())?;
    println!("ring: hierarchies {} B, {} B, {} B", exact.bytes(), coarse.bytes(), fine.bytes());
    for (name, rays) in [("primary", &rays.primary.single), ("diffuse", &rays.diffuse.single)] {
        let race = Race::new(format!("ring {name}"), rays.len(), "rays")
            .with("surface", || sum(&exact, rays))
            .with("4 thousand triangles", || sum(&coarse, rays))
            .with("262 thousand triangles", || sum(&fine, rays));
        bench.run(race);
    }
    Ok(())
}

/// The ring in `around` pieces, each of half as many pieces about the tube.
fn ring_of(around: u32) -> Result<Mesh, Box<dyn std::error::Error>> {
    let about = around / 2;
    let angle = |i: u32, n: u32| i as f32 / n as f32 * TAU;
    let nodes = (0..around).flat_map(|i| (0..about).map(move |j| (angle(i, around), angle(j, about))));
    let point = |(u, v): (f32, f32)| {
        let out = 1.0 + 0.35 * v.cos();
        Vec3::new(out * u.sin(), 0.35 * v.sin(), out * u.cos())
    };
    let node = |i: u32, j: u32| (i % around) * about + j % about;
    let cells = (0..around).flat_map(|i| (0..about).map(move |j| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    Ok(Mesh::new(nodes.map(point).collect(), triangles.collect())?)
}

fn met(accel: &impl Accel, rays: &[Ray]) -> usize {
    rays.iter().filter(|ray| accel.occluded(ray)).count()
}

fn sum(accel: &impl Accel, rays: &[Ray]) -> u64 {
    rays.iter().filter_map(|ray| accel.intersect(ray)).map(|hit| u64::from(hit.t.to_bits() >> 16)).sum()
}
