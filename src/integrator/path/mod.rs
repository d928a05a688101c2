//! Paths: at every surface one way on is chosen and one light is asked.
//!
//! Kajiya 1986 (The Rendering Equation), with next-event estimation and multiple importance sampling (Veach 1997, Robust Monte
//! Carlo Methods, chapters 9 and 10). Paths are followed side by side in batches: all are traced, then all are shaded by one
//! pass over lanes that packs those that go on and queues rays towards lights, which are traced at the end of the pass (a
//! wavefront: Laine, Karras and Aila 2013, Megakernels Considered Harmful). A batch of one path over one lane is the plain
//! path tracer, from the same source.
//!
//! ```text
//! for each edge of the paths:
//!     for each chunk: trace it, shade it, pack those that go on
//!     trace the rays towards lights, add what arrives
//! ```
//!
//! Several paths may begin with the same camera ray and part where it meets a surface. They are that many paths from the start, but the ray
//! is traced once, and the first of them asks lights for all, with weights of one question beside that many ways on (Veach 1997, section 9.2.4).
//!
//! Light that reaches matt surfaces through glass is found by paths that meet the light by chance: rays towards lights end at
//! glass.

mod asking;
mod lights;
mod met;
mod roulette;
mod scattering;
mod surfaces;
mod vertex;
mod wave;

pub use wave::Wave;

use crate::accel::{Accel, Active, Coherence, Packet, RayPacket};
use crate::integrator::{Counters, DIRECT, Stage};
use crate::material::{Crossing, MOST_HIDDEN, Media};
use crate::math::Rgb;
use crate::math::lanes::{Isa, Level, Scalar};
use crate::sampling::{SamplerKind, Vertex};
use crate::scene::Scene;
use lights::Lights;
use surfaces::Surfaces;
use vertex::{Beyond, Chunk, Surroundings};
use wave::Guarded;

/// A path tracer for a scene.
#[derive(Debug)]
pub struct Path {
    lights: Lights,
    surfaces: Surfaces,
    max_depth: u32,
    sampler: SamplerKind,
    seed: u32,
    level: Level,
    /// Whether rays from surface to surface are traced as packets.
    bounces_in_packets: bool,
    /// Paths that go on from what a camera ray meets first.
    ways: u32,
    /// Whether direct light is told apart.
    splits: bool,
    /// The length from which paths may end at random.
    roulette: Option<u32>,
    /// The most luminance of a piece of indirect light.
    limit: Option<f32>,
}

impl Path {
    /// Paths of the scene's depth, with numbers of this kind and seed. Samples are to come pixel by pixel, all of each. Rays from
    /// surface to surface are traced as packets, as those from the camera and towards lights are, or one by one.
    #[must_use]
    pub fn new(
        scene: &Scene,
        (sampler, seed): (SamplerKind, u32),
        (level, bounces_in_packets): (Level, bool),
    ) -> Self {
        let max_depth = scene.render.max_depth;
        let (lights, surfaces) = (Lights::of(scene), Surfaces::of(scene));
        let (roulette, limit) = (scene.render.roulette.value(), scene.render.clamp_indirect.value());
        let splits = false;
        Self {
            lights,
            surfaces,
            max_depth,
            sampler,
            seed,
            level,
            bounces_in_packets,
            ways: scene.render.path_splits,
            splits,
            roulette,
            limit,
        }
    }

    /// Paths of a sample, which have its camera ray in common: numbers are those of as many samples.
    #[must_use]
    pub fn ways(&self) -> u32 {
        self.ways
    }

    /// The same, which tells direct light apart.
    #[must_use]
    pub fn splitting(self, splits: bool) -> Self {
        Self { splits, ..self }
    }

    /// What batches are begun with.
    #[must_use]
    pub fn level(&self) -> Level {
        self.level
    }

    /// What paths are followed with where batches are begun with `level`: one at a time where no instruction set has lanes.
    #[must_use]
    pub fn followed_with(level: Level) -> Level {
        match level {
            Level::Portable(_) => Level::Scalar(Scalar),
            has_lanes => has_lanes,
        }
    }

    /// Camera rays of a packet.
    #[must_use]
    pub fn width(&self) -> u32 {
        u32::try_from(self.level.width()).unwrap_or(1)
    }

    /// Follows all samples of a batch to their ends. `coherence` is that of the camera's rays.
    pub fn follow<A: Accel>(
        &self,
        stage: &Stage<'_, A>,
        wave: &mut Wave,
        coherence: Coherence,
        counters: &mut Counters,
    ) {
        let around = Surroundings {
            scene: stage.scene,
            lights: &self.lights,
            surfaces: &self.surfaces,
            sampler: self.sampler,
            seed: self.seed,
            max_depth: self.max_depth,
            roulette: self.roulette,
            limit: self.limit,
            coherence,
            bounces_in_packets: self.bounces_in_packets,
            ways: self.ways,
            splits: self.splits,
            beam: stage.beam,
        };
        match Self::followed_with(self.level) {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(isa) => follow::<_, _, 16>(isa, &around, stage, wave, counters),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(isa) => follow::<_, _, 8>(isa, &around, stage, wave, counters),
            Level::Portable(_) | Level::Scalar(_) => {
                follow::<_, _, 1>(Scalar, &around, stage, wave, counters);
            }
        }
    }
}

fn follow<A: Accel, S: Isa, const N: usize>(
    isa: S,
    around: &Surroundings<'_>,
    stage: &Stage<'_, A>,
    wave: &mut Wave,
    counters: &mut Counters,
) {
    const { assert!(N == S::WIDTH, "a packet for each chunk of lanes") };
    counters.camera += wave.len() as u64;
    let mut vertex = Vertex::ROOT;
    let mut coherence = around.coherence;
    let mut packet = Packet::<N>::EMPTY;
    let mut beyond = Beyond { eta: [1.0; N], media: [Media::default(); N], changed: 0 };
    if around.ways > 1 {
        see(stage, wave, (&mut packet, coherence));
    }
    for depth in 1..=around.max_depth {
        wave.shadows.rays.len = 0;
        wave.shadows.absorbed = 0;
        // What is met at the third edge has bounced twice.
        wave.slots.limit = around.limit.filter(|_| depth > 2);
        let (len, mut to) = (wave.paths.rays.len, 0);
        for at in (0..len).step_by(N) {
            let count = (len - at).min(N);
            let active = Active::first(count);
            wave.paths.packet(at, &mut packet);
            if depth == 1 && around.ways > 1 {
                for lane in 0..count {
                    packet.set_hit(lane, wave.seen[(at + lane) / wave.ways].as_ref());
                }
            } else if depth == 1 || around.bounces_in_packets {
                stage.accel.intersect_packet(&active, &mut packet, coherence);
            } else {
                for lane in 0..count {
                    let hit = stage.accel.intersect(&packet.ray.get(lane));
                    packet.set_hit(lane, hit.as_ref());
                }
            }
            if around.surfaces.media {
                arrive(
                    stage,
                    wave,
                    (at, count, around.surfaces.absorbs),
                    (&mut packet, &mut beyond),
                    counters,
                );
            }
            let (packet, beyond) = (&packet, &beyond);
            let chunk = Chunk { around, wave, counters, packet, at, count, to, depth, vertex, beyond };
            to += shade(isa, chunk);
        }
        wave.paths.rays.len = to;
        keep_guard(stage, wave, counters);
        if around.splits && depth == DIRECT {
            // Rays towards lights from here are of one edge more.
            wave.slots.direct.clone_from(&wave.slots.sum);
        }
        // Rays towards lights are an edge more.
        wave.slots.limit = around.limit.filter(|_| depth > 1);
        light_up::<A, N>(stage, wave, counters);
        if to == 0 {
            break;
        }
        vertex = vertex.child(0);
        coherence = Coherence::Incoherent;
    }
    if around.limit.is_some() {
        // Each path is a part of its sample.
        counters.clamped += wave.slots.clamped / f64::from(around.ways);
        counters.unclamped += wave.slots.luminance() / f64::from(around.ways);
    }
}

/// Traces each camera ray once, where several paths begin with it.
fn see<A: Accel, const N: usize>(
    stage: &Stage<'_, A>,
    wave: &mut Wave,
    (packet, coherence): (&mut Packet<N>, Coherence),
) {
    let samples = wave.len();
    wave.seen.clear();
    for at in (0..samples).step_by(N) {
        let count = (samples - at).min(N);
        for lane in 0..count {
            packet.ray.set(lane, &wave.paths.rays.get((at + lane) * wave.ways));
        }
        stage.accel.intersect_packet(&Active::first(count), packet, coherence);
        wave.seen.extend((0..count).map(|lane| packet.get_hit(lane)));
    }
}

/// Out of line, for it is the same for all backends.
#[inline(never)]
fn shade<S: Isa, const N: usize>(isa: S, chunk: Chunk<'_, N>) -> usize {
    isa.run(chunk)
}

/// Drops what starts from where something stands in the way.
fn keep_guard<A: Accel>(stage: &Stage<'_, A>, wave: &mut Wave, counters: &mut Counters) {
    let Wave { paths, shadows, guards, .. } = wave;
    counters.shadow += guards.0.len() as u64;
    for (guard, guarded) in guards.0.drain(..) {
        if stage.accel.occluded(&guard) {
            match guarded {
                Guarded::Path(i) => paths.absorb(i, Rgb::BLACK),
                Guarded::Shadow(i) => shadows.light.scale(i, [0.0; 3]),
            }
        }
    }
}

/// Traces the rays towards lights, and adds what arrives.
fn light_up<A: Accel, const N: usize>(stage: &Stage<'_, A>, wave: &mut Wave, counters: &mut Counters) {
    let Wave { shadows, slots, .. } = wave;
    counters.shadow += shadows.rays.len as u64;
    let mut packet = RayPacket::<N>::EMPTY;
    for at in (0..shadows.rays.len).step_by(N) {
        let count = (shadows.rays.len - at).min(N);
        shadows.packet(at, &mut packet);
        stage.accel.occluded_packet(&Active::first(count), &mut packet, Coherence::Incoherent);
        for (lane, end) in packet.t_max.iter().enumerate().take(count) {
            if *end >= 0.0 {
                let [r, g, b] = shadows.light.get(at + lane);
                slots.bring(shadows.rays.slot.all()[at + lane], Rgb::new(r, g, b));
            }
        }
    }
}

/// What media make of the hits of a chunk: what the way absorbs goes into the paths' weights, surfaces that overlapping
/// media hide are passed, and what lies behind the others is noted, with its index over that before it.
fn arrive<A: Accel, const N: usize>(
    stage: &Stage<'_, A>,
    wave: &mut Wave,
    (at, count, absorbs): (usize, usize, bool),
    (packet, beyond): (&mut Packet<N>, &mut Beyond<N>),
    counters: &mut Counters,
) {
    let scene = stage.scene;
    *beyond = Beyond { eta: [1.0; N], changed: 0, ..*beyond };
    for lane in 0..count {
        let slot = wave.paths.rays.slot.all()[at + lane] as usize;
        let mut ray = packet.ray.get(lane).until(f32::INFINITY);
        let mut start = ray.o;
        let mut hidden = 0;
        loop {
            let media = wave.slots.media[slot];
            let inside = media.current().filter(|_| absorbs);
            let Some(hit) = packet.get_hit(lane) else {
                if inside.is_some() {
                    wave.paths.absorb(at + lane, scene.absorbed(inside, f32::INFINITY));
                }
                break;
            };
            let id = scene.material_of(hit.placement, hit.prim);
            let material = &scene.materials[id.index()];
            let medium = material.medium();
            if inside.is_none() && medium.is_none() {
                break;
            }
            if inside.is_some() {
                let length = scene.world.interaction(&ray, &hit).p.distance(start);
                wave.paths.absorb(at + lane, scene.absorbed(inside, length));
            }
            let Some(medium) = medium else { break };
            let front = scene.world.is_front(&ray, &hit);
            let past = match media.cross((id, medium), front, material.is_interface()) {
                Crossing::Interface { eta, beyond: past } => {
                    beyond.set(lane, eta, past);
                    break;
                }
                Crossing::Hidden { beyond: past } => past,
            };
            hidden += 1;
            if hidden == MOST_HIDDEN {
                wave.paths.absorb(at + lane, Rgb::BLACK);
                break;
            }
            wave.slots.media[slot] = past;
            // Rays towards lights end here, so that nothing is left to share.
            wave.paths.forget_density(at + lane);
            let it = scene.world.interaction(&ray, &hit);
            ray = it.spawn(ray.d);
            start = it.p;
            counters.hidden += 1;
            packet.ray.set(lane, &ray);
            let next = stage.accel.intersect(&ray);
            packet.set_hit(lane, next.as_ref());
        }
    }
}
