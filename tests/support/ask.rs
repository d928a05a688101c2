//! Every way of asking a backend, and the backends that there are.

use crate::rays::Rng;
use specula::accel::bvh::Options;
use specula::accel::embree::{BuildOptions, Config, EmbreeAccel, Isa, Quality, SceneOptions};
use specula::accel::{
    Accel, Active, Bvh2Accel, Coherence, CwBvhAccel, HitStream, Packet, RayPacket, RayStream,
};
use specula::geometry::{Hit, Ray, World};
use specula::math::Aabb;
use std::sync::Arc;

/// Answers to rays by every kind of query.
type Ask = Box<dyn Fn(&[Ray]) -> Vec<Answers>>;

/// A backend built from a world.
pub(crate) struct Backend {
    pub(crate) name: &'static str,
    pub(crate) bounds: Aabb,
    ask: Ask,
}

impl Backend {
    fn new<A: Accel + 'static>(name: &'static str, accel: A) -> Self {
        Self { name, bounds: accel.bounds(), ask: Box::new(move |rays| all_kinds(&accel, rays)) }
    }

    /// The answers to `rays` by every kind of query.
    pub(crate) fn ask(&self, rays: &[Ray]) -> Vec<Answers> {
        (self.ask)(rays)
    }
}

/// All backends but the oracle, in all ways of building them that change what they do with a ray.
pub(crate) fn backends(world: &Arc<World>) -> Vec<Backend> {
    let embree = |name, max_isa, scene| {
        let device = Config { max_isa, ..Config::default() };
        Backend::new(name, EmbreeAccel::build(world, &BuildOptions { device, scene }).expect("built"))
    };
    let fast = SceneOptions::default();
    let robust = SceneOptions { robust: true, ..fast };
    vec![
        embree("embree", None, fast),
        embree("embree robust", None, robust),
        embree("embree compact", None, SceneOptions { compact: true, ..fast }),
        embree("embree high", None, SceneOptions { quality: Quality::High, ..fast }),
        embree("embree sse2", Some(Isa::Sse2), fast),
        embree("embree sse2 robust", Some(Isa::Sse2), robust),
        embree("embree avx robust", Some(Isa::Avx), robust),
        embree("embree quads", None, SceneOptions { quads: true, ..fast }),
        Backend::new("bvh2", Bvh2Accel::build(world, &Options::default())),
        Backend::new("cwbvh", CwBvhAccel::build(world, &Options::default())),
    ]
}

/// One way of asking, and what it found.
pub(crate) struct Answers {
    pub(crate) kind: String,
    pub(crate) hits: Vec<Option<Hit>>,
    pub(crate) occluded: Vec<bool>,
}

/// Single rays, packets of every width with kernels and of one without, streams; with both hints.
pub(crate) fn all_kinds<A: Accel>(accel: &A, rays: &[Ray]) -> Vec<Answers> {
    let hits = rays.iter().map(|ray| accel.intersect(ray)).collect();
    let occluded = rays.iter().map(|ray| accel.occluded(ray)).collect();
    let mut all = vec![Answers { kind: "single".to_owned(), hits, occluded }];
    for coherence in [Coherence::Coherent, Coherence::Incoherent] {
        all.push(packets::<A, 4>(accel, rays, coherence));
        all.push(packets::<A, 8>(accel, rays, coherence));
        all.push(packets::<A, 16>(accel, rays, coherence));
        all.push(stream(accel, rays, coherence));
    }
    // A width that no backend has kernels for.
    all.push(packets::<A, 3>(accel, rays, Coherence::Incoherent));
    all
}

/// Packets with some lanes switched off in turn, so that each ray is traced in the end.
fn packets<A: Accel, const N: usize>(accel: &A, rays: &[Ray], coherence: Coherence) -> Answers {
    let mut rng = Rng::new(7);
    let mut hits = Vec::with_capacity(rays.len());
    let mut occluded = Vec::with_capacity(rays.len());
    for chunk in rays.chunks(N) {
        let mut packet = Packet::<N>::EMPTY;
        chunk.iter().enumerate().for_each(|(lane, ray)| packet.ray.set(lane, ray));
        let mut shadow: RayPacket<N> = packet.ray;
        let filled = (1_u32 << chunk.len()) - 1;
        let some = rng.bits() & filled;
        for active in [Active::from_bits(some), Active::from_bits(filled & !some)] {
            let before = packet;
            accel.intersect_packet(&active, &mut packet, coherence);
            for lane in (0..N).filter(|&lane| !active.contains(lane)) {
                let [now, then] =
                    [&packet, &before].map(|p| (p.ray.t_max[lane].to_bits(), p.hit.geometry[lane]));
                assert_eq!(now, then, "an inactive lane has changed");
            }
            accel.occluded_packet(&active, &mut shadow, coherence);
        }
        hits.extend((0..chunk.len()).map(|lane| packet.get_hit(lane)));
        occluded.extend((0..chunk.len()).map(|lane| shadow.t_max[lane] < chunk[lane].t_max));
    }
    Answers { kind: format!("packet {N} {coherence:?}"), hits, occluded }
}

fn stream<A: Accel>(accel: &A, rays: &[Ray], coherence: Coherence) -> Answers {
    let mut input = RayStream::default();
    input.extend(rays);
    // Answers of an earlier, longer stream must not shine through.
    let mut output = HitStream::default();
    output.resize(rays.len() + 5);
    accel.intersect_stream(&input, &mut output, coherence);
    assert_eq!(output.len(), rays.len(), "one answer a ray");
    let mut occluded = vec![true; 3];
    accel.occluded_stream(&input, &mut occluded, coherence);
    let hits = (0..rays.len()).map(|i| output.get(i)).collect();
    Answers { kind: format!("stream {coherence:?}"), hits, occluded }
}
