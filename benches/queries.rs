//! What safe queries cost beside the same calls made directly, and what packets and streams gain over single rays.
//!
//! Recorded camera, shadow and diffuse-bounce rays on the dragon (100 k triangles, where its file is found) and on a
//! landscape of a million triangles, in one thread. `cargo bench --bench queries -- [--record] [part of a race's name]`.

#[path = "support/direct.rs"]
mod direct;
#[path = "support/models.rs"]
mod models;
#[path = "support/rays.rs"]
mod rays;
#[path = "support/mod.rs"]
mod support;
#[path = "support/terrain.rs"]
mod terrain;

use direct::{Direct, DirectStream, sum_of};
use glam::Vec3;
use models::model;
use rays::{Rays, Recorded, record};
use specula::accel::embree::{BuildOptions, EmbreeAccel};
use specula::accel::{Accel, Active, Coherence, HitStream, Packet, RayPacket};
use specula::geometry::{Mesh, Shape, World};
use support::{Bench, Race};

/// Pixels sampled, along each side of the picture.
const TILES: u32 = 96;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut bench = Bench::new("queries");
    on_mesh(&mut bench, "terrain", terrain::terrain(708), Some(terrain::view()))?;
    if let Some(mesh) = model("dragon") {
        on_mesh(&mut bench, "dragon", mesh, None)?;
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
    let mut world = World::default();
    let shape = world.add_shape(Shape::Mesh(mesh));
    world.place(shape, None);
    let accel = EmbreeAccel::build(&world, &BuildOptions::default())?;
    let bounds = world.bounds();
    let outside = bounds.center() + Vec3::new(0.4, 0.5, 1.0).normalize() * bounds.radius() * 2.4;
    let (eye, at) = view.unwrap_or((outside, bounds.center()));
    let Recorded { primary, shadow, diffuse } = record(&world, &accel, eye, at, TILES);
    let coherent = Coherence::Coherent;
    let incoherent = Coherence::Incoherent;

    safety(bench, &format!("{name} primary"), &accel, &primary, coherent);
    safety(bench, &format!("{name} diffuse"), &accel, &diffuse, incoherent);
    safety_of_occlusion(bench, &format!("{name} shadow"), &accel, &shadow, coherent);
    kinds(bench, &format!("{name} primary"), &accel, &primary);
    kinds(bench, &format!("{name} diffuse"), &accel, &diffuse);
    kinds_of_occlusion(bench, &format!("{name} shadow"), &accel, &shadow);
    Ok(())
}

/// Closest hits: direct calls against ours.
fn safety(bench: &mut Bench, name: &str, accel: &EmbreeAccel, rays: &Rays, coherence: Coherence) {
    let direct = Direct::new(accel.scene().address());
    let width = accel.device().native_width();
    let coherent = coherence == Coherence::Coherent;
    let race = |what: &str| Race::new(format!("{name} safety {what}"), rays.single.len(), "rays");
    bench.run(
        race("single")
            .with("direct", || direct.intersect(&rays.single))
            .with("specula", || single(accel, rays)),
    );
    let packets = rays.packets::<4>();
    bench.run(
        race("packet 4")
            .with("direct", || direct.intersect4(&packets, coherent))
            .with("specula", || packet(accel, &packets, coherence)),
    );
    let packets = rays.packets::<8>();
    bench.run(
        race("packet 8")
            .with("direct", || direct.intersect8(&packets, coherent))
            .with("specula", || packet(accel, &packets, coherence)),
    );
    let packets = rays.packets::<16>();
    bench.run(
        race("packet 16")
            .with("direct", || direct.intersect16(&packets, coherent))
            .with("specula", || packet(accel, &packets, coherence)),
    );
    let mut buffers = DirectStream::new(&rays.single);
    let mut hits = HitStream::default();
    bench.run(
        race("stream")
            .with("direct", || direct.stream(&mut buffers, width, coherent))
            .with("specula", || stream(accel, rays, &mut hits, coherence)),
    );
}

/// Any hits: direct calls against ours.
fn safety_of_occlusion(
    bench: &mut Bench,
    name: &str,
    accel: &EmbreeAccel,
    rays: &Rays,
    coherence: Coherence,
) {
    let direct = Direct::new(accel.scene().address());
    let coherent = coherence == Coherence::Coherent;
    let race = |what: &str| Race::new(format!("{name} safety {what}"), rays.single.len(), "rays");
    bench.run(
        race("single")
            .with("direct", || direct.occluded(&rays.single))
            .with("specula", || single_occluded(accel, rays)),
    );
    let packets = rays.packets::<4>();
    bench.run(
        race("packet 4")
            .with("direct", || direct.occluded4(&packets, coherent))
            .with("specula", || packet_occluded(accel, &packets, coherence)),
    );
    let packets = rays.packets::<8>();
    bench.run(
        race("packet 8")
            .with("direct", || direct.occluded8(&packets, coherent))
            .with("specula", || packet_occluded(accel, &packets, coherence)),
    );
    let packets = rays.packets::<16>();
    bench.run(
        race("packet 16")
            .with("direct", || direct.occluded16(&packets, coherent))
            .with("specula", || packet_occluded(accel, &packets, coherence)),
    );
}

/// Closest hits: every kind of query against single rays.
fn kinds(bench: &mut Bench, name: &str, accel: &EmbreeAccel, rays: &Rays) {
    let (p4, p8, p16) = (rays.packets::<4>(), rays.packets::<8>(), rays.packets::<16>());
    let mut race = Race::new(format!("{name} kinds"), rays.single.len(), "rays");
    race = race.with("single", || single(accel, rays));
    for coherence in [Coherence::Coherent, Coherence::Incoherent] {
        let (p4, p8, p16) = (&p4, &p8, &p16);
        let mut hits = HitStream::default();
        race = race
            .with(format!("packet 4 {coherence:?}"), move || packet(accel, p4, coherence))
            .with(format!("packet 8 {coherence:?}"), move || packet(accel, p8, coherence))
            .with(format!("packet 16 {coherence:?}"), move || packet(accel, p16, coherence))
            .with(format!("stream {coherence:?}"), move || stream(accel, rays, &mut hits, coherence));
    }
    bench.run(race);
}

/// Any hits: every kind of query against single rays.
fn kinds_of_occlusion(bench: &mut Bench, name: &str, accel: &EmbreeAccel, rays: &Rays) {
    let (p4, p8, p16) = (rays.packets::<4>(), rays.packets::<8>(), rays.packets::<16>());
    let mut race = Race::new(format!("{name} kinds"), rays.single.len(), "rays");
    race = race.with("single", || single_occluded(accel, rays));
    for coherence in [Coherence::Coherent, Coherence::Incoherent] {
        let (p4, p8, p16) = (&p4, &p8, &p16);
        let mut occluded = Vec::new();
        race = race
            .with(format!("packet 4 {coherence:?}"), move || packet_occluded(accel, p4, coherence))
            .with(format!("packet 8 {coherence:?}"), move || packet_occluded(accel, p8, coherence))
            .with(format!("packet 16 {coherence:?}"), move || packet_occluded(accel, p16, coherence))
            .with(format!("stream {coherence:?}"), move || {
                accel.occluded_stream(&rays.stream, &mut occluded, coherence);
                occluded.iter().filter(|&&found| found).count() as u64
            });
    }
    bench.run(race);
}

fn single(accel: &EmbreeAccel, rays: &Rays) -> u64 {
    let hits = rays.single.iter().filter_map(|ray| accel.intersect(ray));
    hits.fold(0, |sum, hit| sum + u64::from(hit.t.to_bits() ^ hit.prim))
}

fn single_occluded(accel: &EmbreeAccel, rays: &Rays) -> u64 {
    rays.single.iter().fold(0, |sum, ray| sum + u64::from(accel.occluded(ray)))
}

fn packet<const N: usize>(accel: &EmbreeAccel, packets: &[RayPacket<N>], coherence: Coherence) -> u64 {
    // A query presets the identifiers by itself: one packet serves for all.
    let mut packet = Packet::EMPTY;
    packets.iter().fold(0, |sum, ray| {
        packet.ray = *ray;
        accel.intersect_packet(&Active::ALL, &mut packet, coherence);
        sum + sum_of(&packet.ray.t_max, &packet.hit.geometry)
    })
}

fn packet_occluded<const N: usize>(
    accel: &EmbreeAccel,
    packets: &[RayPacket<N>],
    coherence: Coherence,
) -> u64 {
    packets.iter().fold(0, |sum, ray| {
        let mut packet = *ray;
        accel.occluded_packet(&Active::ALL, &mut packet, coherence);
        sum + packet.t_max.iter().filter(|&&t| t < 0.0).count() as u64
    })
}

fn stream(accel: &EmbreeAccel, rays: &Rays, hits: &mut HitStream, coherence: Coherence) -> u64 {
    accel.intersect_stream(&rays.stream, hits, coherence);
    (0..hits.len()).filter(|&i| hits.is_hit(i)).count() as u64
}
