//! How much of a whole picture is traversal: the time in which Embree answers the very rays of the picture, replayed from memory
//! in the best way for each class, over the time of the picture.
//!
//! One thread, CPU time. `cargo bench --bench traversal -- [--record]` also writes `benches/record/traversal.csv`;
//! `SPECULA_ISA=avx2` and so on limits the instruction sets of shading and of Embree.

#![expect(clippy::print_stdout, reason = "a bench prints its tables")]

#[path = "../tests/support/peers.rs"]
mod peers;
#[path = "support/places.rs"]
mod places;
#[path = "support/record.rs"]
mod record;
#[path = "support/terrain.rs"]
mod terrain;

use cpu_time::ProcessTime;
use specula::accel::embree::EmbreeAccel;
use specula::accel::{Accel, Active, Coherence, Packet, RayPacket};
use specula::bench::race::{Spread, interleave};
use specula::geometry::{Hit, Ray};
use specula::math::Aabb;
use specula::render::{Settings, Silent, render_on};
use specula::scene::Scene;
use std::convert::Infallible;
use std::fmt::Write as _;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::sync::{Mutex, PoisonError};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Rays of a picture, by how it asked.
#[derive(Default)]
struct Log {
    /// In coherent packets.
    camera: Vec<Ray>,
    /// In other packets.
    bounces: Vec<Ray>,
    /// One by one.
    single: Vec<Ray>,
    /// Whether anything is in the way.
    shadows: Vec<Ray>,
}

/// Writes down the rays that it passes on.
struct Recorder<'a> {
    embree: &'a EmbreeAccel,
    log: Mutex<Log>,
}

impl Recorder<'_> {
    fn note(&self, write: impl FnOnce(&mut Log)) {
        write(&mut self.log.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Accel for Recorder<'_> {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.note(|log| log.single.push(*ray));
        self.embree.intersect(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.note(|log| log.shadows.push(*ray));
        self.embree.occluded(ray)
    }

    fn intersect_packet<const N: usize>(
        &self,
        active: &Active<N>,
        packet: &mut Packet<N>,
        coherence: Coherence,
    ) {
        self.note(|log| {
            let list = if coherence == Coherence::Coherent { &mut log.camera } else { &mut log.bounces };
            list.extend(active.lanes().map(|lane| packet.ray.get(lane)));
        });
        self.embree.intersect_packet(active, packet, coherence);
    }

    fn occluded_packet<const N: usize>(
        &self,
        active: &Active<N>,
        rays: &mut RayPacket<N>,
        coherence: Coherence,
    ) {
        self.note(|log| log.shadows.extend(active.lanes().map(|lane| rays.get(lane))));
        self.embree.occluded_packet(active, rays, coherence);
    }

    fn bounds(&self) -> Aabb {
        self.embree.bounds()
    }

    fn bytes(&self) -> usize {
        self.embree.bytes()
    }
}

/// A way to replay rays; what it returns keeps it from being left out.
type Way<'a> = (&'static str, Box<dyn Fn() -> u64 + 'a>);

fn packets<const N: usize>(rays: &[Ray]) -> Vec<(Active<N>, RayPacket<N>)> {
    let packet = |rays: &[Ray]| {
        let mut packet = RayPacket::EMPTY;
        rays.iter().enumerate().for_each(|(lane, ray)| packet.set(lane, ray));
        (Active::first(rays.len()), packet)
    };
    rays.chunks(N).map(packet).collect()
}

fn closest<'a, const N: usize>(
    embree: &'a EmbreeAccel,
    rays: &[Ray],
    coherence: Coherence,
) -> Box<dyn Fn() -> u64 + 'a> {
    let packets = packets::<N>(rays);
    Box::new(move || {
        let mut found = 0;
        let mut packet = Packet::EMPTY;
        for (active, rays) in &packets {
            packet.ray = *rays;
            embree.intersect_packet(active, &mut packet, coherence);
            found += u64::from(packet.hit.prim[0]);
        }
        found
    })
}

fn any<'a, const N: usize>(
    embree: &'a EmbreeAccel,
    rays: &[Ray],
    coherence: Coherence,
) -> Box<dyn Fn() -> u64 + 'a> {
    let packets = packets::<N>(rays);
    Box::new(move || {
        let mut found = 0;
        for (active, rays) in &packets {
            let mut rays = *rays;
            embree.occluded_packet(active, &mut rays, coherence);
            found += u64::from(rays.t_max[0].to_bits());
        }
        found
    })
}

fn ways<'a>(embree: &'a EmbreeAccel, rays: &'a [Ray], shadows: bool) -> Vec<Way<'a>> {
    use Coherence::{Coherent, Incoherent};
    if shadows {
        return vec![
            ("single", Box::new(move || rays.iter().map(|ray| u64::from(embree.occluded(ray))).sum())),
            ("packet8 incoherent", any::<8>(embree, rays, Incoherent)),
            ("packet8 coherent", any::<8>(embree, rays, Coherent)),
            ("packet16 incoherent", any::<16>(embree, rays, Incoherent)),
            ("packet16 coherent", any::<16>(embree, rays, Coherent)),
        ];
    }
    vec![
        (
            "single",
            Box::new(move || {
                rays.iter().filter_map(|ray| embree.intersect(ray)).map(|hit| u64::from(hit.prim)).sum()
            }),
        ),
        ("packet8 incoherent", closest::<8>(embree, rays, Incoherent)),
        ("packet8 coherent", closest::<8>(embree, rays, Coherent)),
        ("packet16 incoherent", closest::<16>(embree, rays, Incoherent)),
        ("packet16 coherent", closest::<16>(embree, rays, Coherent)),
    ]
}

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let has = |flag: &str| words.iter().any(|word| word == flag);
    let passes = if has("--bench") { 7 } else { 1 };
    let mut csv = String::from("scene,class,rays,best way,replay_s,picture_s,share\n");
    for (name, scene) in [
        ("closed box", places::peer("cornell", PATHS, 128)?),
        ("glossy balls", places::peer("glossyrow", PATHS, 192)?),
        ("landscape of 1 M triangles", Some(places::landscape(708, FIVE, 128)?)),
        ("furnished room", places::interior(FIVE, 128)?),
    ] {
        if let Some(scene) = scene {
            measure(name, &scene, passes, &mut csv)?;
        }
    }
    if has("--record") {
        record::record("traversal", passes, &csv)?;
    }
    Ok(())
}

/// Of scenes that bring their own depth.
const PATHS: &str = "integrator = \"path\"\nspp = 16";

const FIVE: &str = "integrator = \"path\"\nspp = 16\nmax_depth = 5";

fn measure(name: &str, scene: &Scene, passes: usize, csv: &mut String) -> Result<()> {
    let embree = EmbreeAccel::build(&scene.world, &places::embree()).expect("Embree builds");
    let settings = Settings { threads: NonZeroUsize::new(1), ..Settings::default() };
    let recorder = Recorder { embree: &embree, log: Mutex::default() };
    render_on(scene, &settings, &recorder, &Silent)?;
    let Log { camera, bounces, single, shadows } =
        recorder.log.into_inner().unwrap_or_else(PoisonError::into_inner);
    let classes = [
        ("camera", camera, false),
        ("bounces", bounces, false),
        ("single", single, false),
        ("shadow", shadows, true),
    ];
    let classes: Vec<_> = classes.into_iter().filter(|(_, rays, _)| !rays.is_empty()).collect();
    let all: Vec<(usize, Way<'_>)> = classes
        .iter()
        .enumerate()
        .flat_map(|(i, (_, rays, shadows))| {
            ways(&embree, rays, *shadows).into_iter().map(move |way| (i, way))
        })
        .collect();
    // The picture runs in the same passes as the replays.
    let Ok(seconds) = interleave(all.len() + 1, passes, |turn| {
        let start = ProcessTime::now();
        match all.get(turn) {
            Some((_, (_, replay))) => _ = black_box(replay()),
            None => _ = black_box(render_on(scene, &settings, &embree, &Silent).expect("a picture")),
        }
        Ok::<_, Infallible>(start.elapsed().as_secs_f64())
    });
    let medians: Vec<f64> = seconds.iter().map(|times| Spread::of(times.iter().copied()).median).collect();
    let picture = medians[all.len()];
    println!("\n{name}: picture {picture:.3} s");
    let mut sum = 0.0;
    for (i, (class, rays, _)) in classes.iter().enumerate() {
        let own = || all.iter().zip(&medians).filter(|((class, _), _)| *class == i);
        let best = own().min_by(|a, b| a.1.total_cmp(b.1));
        let Some(((_, (way, _)), time)) = best else { continue };
        sum += time;
        let rates =
            own().map(|((_, (way, _)), time)| format!("{way} {:.2}", rays.len() as f64 / time * 1e-6));
        let rates: Vec<String> = rates.collect();
        println!("  {class:8} {:9} rays  {time:.3} s  {way}  (M/s: {})", rays.len(), rates.join(", "));
        writeln!(csv, "{name},{class},{},{way},{time:.4},{picture:.4},", rays.len()).expect("memory");
    }
    println!("  share of traversal: {:.3}", sum / picture);
    writeln!(csv, "{name},all,,,{sum:.4},{picture:.4},{:.3}", sum / picture).expect("memory");
    Ok(())
}
