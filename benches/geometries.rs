//! Which of Embree's kinds of geometry serves best: quads or pairs of triangles, its own spheres and discs or ones that
//! are asked for their hits.
//!
//! One thread. `cargo bench --bench geometries -- [--record] [part of a race's name]`.

#![expect(clippy::print_stdout, reason = "a bench prints its results")]

#[path = "support/models.rs"]
mod models;
#[path = "support/quads.rs"]
mod quads;
#[path = "support/rays.rs"]
mod rays;
#[path = "support/round.rs"]
mod round;
#[path = "support/mod.rs"]
mod support;

use rays::{Rays, Recorded, record};
use specula::accel::embree::{Committed, Scene};
use specula::accel::{Accel, Active, Coherence, Packet, RayPacket};
use support::{Bench, Race};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut bench = Bench::new("geometries");
    for (file, view) in [("sponza", quads::inside as quads::View), ("sword-quad-dominant", quads::outside)] {
        if let Some(mesh) = models::model(file) {
            quads::compare(&mut bench, file, mesh, view)?;
        }
    }
    round::compare(&mut bench)?;
    round::print_errors()?;
    bench.finish()?;
    Ok(())
}

/// A contestant: a name, and a scene that holds the same things as the others' in its own way.
type Contestant<'a> = (&'static str, &'a Scene<Committed>);

/// Closest hits of camera rays and of bounces, any hits of shadow rays; one by one and in packets of eight.
fn race_all(bench: &mut Bench, name: &str, rays: &Recorded, contestants: &[Contestant<'_>]) {
    let kinds = [
        ("primary", &rays.primary, Coherence::Coherent),
        ("shadow", &rays.shadow, Coherence::Coherent),
        ("diffuse", &rays.diffuse, Coherence::Incoherent),
    ];
    for (kind, rays, coherence) in kinds {
        let any = kind == "shadow";
        let packets = rays.packets::<8>();
        let race = |how: &str| Race::new(format!("{name} {kind} {how}"), rays.single.len(), "rays");
        let mut single = race("single");
        let mut packet = race("packet 8");
        for &(contestant, scene) in contestants {
            single = single.with(contestant, move || singly(scene, rays, any));
            let packets = &packets;
            packet = packet.with(contestant, move || in_packets(scene, packets, any, coherence));
        }
        bench.run(single);
        bench.run(packet);
    }
}

fn singly(scene: &Scene<Committed>, rays: &Rays, any: bool) -> u64 {
    let found = |ray| {
        if any { scene.occluded(ray) } else { scene.intersect(ray).is_some() }
    };
    rays.single.iter().filter(|ray| found(ray)).count() as u64
}

fn in_packets(scene: &Scene<Committed>, packets: &[RayPacket<8>], any: bool, coherence: Coherence) -> u64 {
    let mut packet = Packet::<8>::EMPTY;
    packets.iter().fold(0, |sum, rays| {
        packet.ray = *rays;
        if any {
            scene.occluded_packet(&Active::ALL, &mut packet.ray, coherence);
            return sum + packet.ray.t_max.iter().filter(|&&t| t < 0.0).count() as u64;
        }
        scene.intersect_packet(&Active::ALL, &mut packet, coherence);
        sum + packet.hit.geometry.iter().filter(|&&geometry| geometry != u32::MAX).count() as u64
    })
}
