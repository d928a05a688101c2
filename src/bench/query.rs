//! Kinds of query, and backends behind one surface that can be asked in every kind.

use super::rays::{packets, stream};
use crate::accel::{Accel, Active, Coherence, HitStream, Packet, RayPacket, RayStream};
use crate::geometry::{Hit, Ray};
use std::fmt::{self, Display, Formatter};

/// How hits are asked for. Its name as text is what tables show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// One ray a call.
    Single,
    /// Packets of 4, 8 or 16.
    Packet(Width, Coherence),
    /// A thousand rays a call.
    Stream(Coherence),
}

/// Rays in a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// Four.
    Four,
    /// Eight.
    Eight,
    /// Sixteen.
    Sixteen,
}

/// What is asked of each ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The nearest hit.
    Closest,
    /// Whether there is any.
    Any,
}

impl Query {
    /// All kinds.
    pub const ALL: [Self; 9] = {
        use Coherence::{Coherent, Incoherent};
        use Width::{Eight, Four, Sixteen};
        [
            Self::Single,
            Self::Packet(Four, Coherent),
            Self::Packet(Four, Incoherent),
            Self::Packet(Eight, Coherent),
            Self::Packet(Eight, Incoherent),
            Self::Packet(Sixteen, Coherent),
            Self::Packet(Sixteen, Incoherent),
            Self::Stream(Coherent),
            Self::Stream(Incoherent),
        ]
    };

    /// The words by which kinds are chosen, whatever their hint.
    pub const WORDS: [&'static str; 5] = ["single", "packet4", "packet8", "packet16", "stream"];

    /// Its word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Packet(Width::Four, _) => "packet4",
            Self::Packet(Width::Eight, _) => "packet8",
            Self::Packet(Width::Sixteen, _) => "packet16",
            Self::Stream(_) => "stream",
        }
    }

    /// The hint that goes with it.
    #[must_use]
    pub fn coherence(self) -> Option<Coherence> {
        match self {
            Self::Single => None,
            Self::Packet(_, coherence) | Self::Stream(coherence) => Some(coherence),
        }
    }
}

impl Display for Query {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let hint = match self.coherence() {
            None => "",
            Some(Coherence::Coherent) => " coherent",
            Some(Coherence::Incoherent) => " incoherent",
        };
        f.pad(&format!("{}{hint}", self.word()))
    }
}

impl Mode {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Closest, Self::Any];

    /// Its name in tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Closest => "closest",
            Self::Any => "any",
        }
    }
}

/// Rays of one call of a stream, and of one piece of work for a thread.
pub(super) const CHUNK: usize = 1024;

/// Some rays in all forms that queries take.
#[derive(Debug)]
pub(super) struct Chunk {
    pub(super) single: Vec<Ray>,
    four: Vec<RayPacket<4>>,
    eight: Vec<RayPacket<8>>,
    sixteen: Vec<RayPacket<16>>,
    stream: RayStream,
}

impl Chunk {
    pub(super) fn new(rays: &[Ray]) -> Self {
        Self {
            single: rays.to_vec(),
            four: packets(rays),
            eight: packets(rays),
            sixteen: packets(rays),
            stream: stream(rays),
        }
    }
}

/// Room for the answers of streams, kept by a thread.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    hits: HitStream,
    occluded: Vec<bool>,
}

/// A backend that can be asked in every kind.
pub(super) trait Tracer: Send + Sync {
    /// Asks about all rays of a chunk, for the time it takes; the sum keeps answers from being left out.
    fn pass(&self, query: Query, mode: Mode, chunk: &Chunk, scratch: &mut Scratch) -> u64;

    /// The nearest hits.
    fn closest(&self, query: Query, chunk: &Chunk) -> Vec<Option<Hit>>;

    /// Which rays meet anything.
    fn any(&self, query: Query, chunk: &Chunk) -> Vec<bool>;

    /// Bytes of the hierarchy.
    fn bytes(&self) -> usize;
}

impl<A: Accel> Tracer for A {
    fn pass(&self, query: Query, mode: Mode, chunk: &Chunk, scratch: &mut Scratch) -> u64 {
        match (query, mode) {
            (Query::Single, Mode::Closest) => {
                let hits = chunk.single.iter().filter_map(|ray| self.intersect(ray));
                hits.fold(0, |sum, hit| sum + u64::from(hit.t.to_bits() ^ hit.prim))
            }
            (Query::Single, Mode::Any) => count(chunk.single.iter().map(|ray| self.occluded(ray))),
            (Query::Packet(Width::Four, hint), mode) => packet_pass(self, &chunk.four, mode, hint),
            (Query::Packet(Width::Eight, hint), mode) => packet_pass(self, &chunk.eight, mode, hint),
            (Query::Packet(Width::Sixteen, hint), mode) => packet_pass(self, &chunk.sixteen, mode, hint),
            (Query::Stream(hint), Mode::Closest) => {
                self.intersect_stream(&chunk.stream, &mut scratch.hits, hint);
                count((0..scratch.hits.len()).map(|i| scratch.hits.is_hit(i)))
            }
            (Query::Stream(hint), Mode::Any) => {
                self.occluded_stream(&chunk.stream, &mut scratch.occluded, hint);
                count(scratch.occluded.iter().copied())
            }
        }
    }

    fn closest(&self, query: Query, chunk: &Chunk) -> Vec<Option<Hit>> {
        match query {
            Query::Single => chunk.single.iter().map(|ray| self.intersect(ray)).collect(),
            Query::Packet(Width::Four, hint) => packet_hits(self, chunk, &chunk.four, hint),
            Query::Packet(Width::Eight, hint) => packet_hits(self, chunk, &chunk.eight, hint),
            Query::Packet(Width::Sixteen, hint) => packet_hits(self, chunk, &chunk.sixteen, hint),
            Query::Stream(hint) => {
                let mut hits = HitStream::default();
                self.intersect_stream(&chunk.stream, &mut hits, hint);
                (0..hits.len()).map(|i| hits.get(i)).collect()
            }
        }
    }

    fn any(&self, query: Query, chunk: &Chunk) -> Vec<bool> {
        match query {
            Query::Single => chunk.single.iter().map(|ray| self.occluded(ray)).collect(),
            Query::Packet(Width::Four, hint) => packet_occluded(self, chunk, &chunk.four, hint),
            Query::Packet(Width::Eight, hint) => packet_occluded(self, chunk, &chunk.eight, hint),
            Query::Packet(Width::Sixteen, hint) => packet_occluded(self, chunk, &chunk.sixteen, hint),
            Query::Stream(hint) => {
                let mut occluded = Vec::new();
                self.occluded_stream(&chunk.stream, &mut occluded, hint);
                occluded
            }
        }
    }

    fn bytes(&self) -> usize {
        Accel::bytes(self)
    }
}

fn count(found: impl Iterator<Item = bool>) -> u64 {
    found.fold(0, |sum, found| sum + u64::from(found))
}

/// All lanes take part: those without a ray hold one that hits nothing. A query presets identifiers by itself, so that
/// one packet serves for all; rays are copied into it, as whoever traces on would do.
fn packet_pass<const N: usize>(
    accel: &impl Accel,
    packets: &[RayPacket<N>],
    mode: Mode,
    hint: Coherence,
) -> u64 {
    let mut packet = Packet::<N>::EMPTY;
    packets.iter().fold(0, |sum, rays| {
        packet.ray = *rays;
        match mode {
            Mode::Closest => accel.intersect_packet(&Active::ALL, &mut packet, hint),
            Mode::Any => accel.occluded_packet(&Active::ALL, &mut packet.ray, hint),
        }
        packet.ray.t_max.iter().fold(sum, |sum, t| sum + u64::from(t.to_bits()))
    })
}

fn packet_hits<const N: usize>(
    accel: &impl Accel,
    chunk: &Chunk,
    packets: &[RayPacket<N>],
    hint: Coherence,
) -> Vec<Option<Hit>> {
    let mut hits = Vec::with_capacity(chunk.single.len());
    for (rays, single) in packets.iter().zip(chunk.single.chunks(N)) {
        let mut packet = Packet::<N> { ray: *rays, ..Packet::EMPTY };
        accel.intersect_packet(&Active::ALL, &mut packet, hint);
        hits.extend((0..single.len()).map(|lane| packet.get_hit(lane)));
    }
    hits
}

fn packet_occluded<const N: usize>(
    accel: &impl Accel,
    chunk: &Chunk,
    packets: &[RayPacket<N>],
    hint: Coherence,
) -> Vec<bool> {
    let mut occluded = Vec::with_capacity(chunk.single.len());
    for (rays, single) in packets.iter().zip(chunk.single.chunks(N)) {
        let mut after = *rays;
        accel.occluded_packet(&Active::ALL, &mut after, hint);
        occluded.extend(single.iter().zip(after.t_max).map(|(ray, end)| end < ray.t_max));
    }
    occluded
}
