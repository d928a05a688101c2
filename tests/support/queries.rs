//! One set of rays through every kind of query.

#![allow(dead_code, reason = "each test program uses a part")]

use specula::accel::{Accel, Active, Coherence, HitStream, Packet, RayPacket, RayStream};
use specula::geometry::{Hit, Ray};
use std::fmt::{self, Display, Formatter};

/// A kind of query. Its name as text is that of its call and hint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Single,
    Packet(usize, Coherence),
    Stream(Coherence),
}

/// What the rays hit, and whether they are occluded.
#[derive(Debug, PartialEq)]
pub(crate) struct Answers {
    pub(crate) kind: Kind,
    pub(crate) hits: Vec<Option<Hit>>,
    pub(crate) occluded: Vec<bool>,
}

impl Kind {
    /// Every kind: packets of each width with kernels and of one without, both hints.
    pub(crate) fn all() -> Vec<Self> {
        let mut all = vec![Self::Single];
        for coherence in [Coherence::Coherent, Coherence::Incoherent] {
            all.extend([4, 8, 16].map(|width| Self::Packet(width, coherence)));
            all.push(Self::Stream(coherence));
        }
        all.push(Self::Packet(3, Coherence::Incoherent));
        all
    }

    /// The nearest hits.
    pub(crate) fn hits(self, accel: &impl Accel, rays: &[Ray]) -> Vec<Option<Hit>> {
        match self {
            Self::Single => rays.iter().map(|ray| accel.intersect(ray)).collect(),
            Self::Packet(3, coherence) => packets::<3>(accel, rays, coherence),
            Self::Packet(4, coherence) => packets::<4>(accel, rays, coherence),
            Self::Packet(8, coherence) => packets::<8>(accel, rays, coherence),
            Self::Packet(_, coherence) => packets::<16>(accel, rays, coherence),
            Self::Stream(coherence) => {
                // Answers of an earlier, longer stream must not shine through.
                let mut hits = HitStream::default();
                hits.resize(rays.len() + 5);
                accel.intersect_stream(&stream(rays), &mut hits, coherence);
                assert_eq!(hits.len(), rays.len(), "one answer a ray");
                (0..rays.len()).map(|i| hits.get(i)).collect()
            }
        }
    }

    /// Which rays meet anything.
    pub(crate) fn occluded(self, accel: &impl Accel, rays: &[Ray]) -> Vec<bool> {
        match self {
            Self::Single => rays.iter().map(|ray| accel.occluded(ray)).collect(),
            Self::Packet(3, coherence) => occluded_packets::<3>(accel, rays, coherence),
            Self::Packet(4, coherence) => occluded_packets::<4>(accel, rays, coherence),
            Self::Packet(8, coherence) => occluded_packets::<8>(accel, rays, coherence),
            Self::Packet(_, coherence) => occluded_packets::<16>(accel, rays, coherence),
            Self::Stream(coherence) => {
                let mut occluded = vec![true; 3];
                accel.occluded_stream(&stream(rays), &mut occluded, coherence);
                occluded
            }
        }
    }

    /// Both.
    pub(crate) fn answers(self, accel: &impl Accel, rays: &[Ray]) -> Answers {
        Answers { kind: self, hits: self.hits(accel, rays), occluded: self.occluded(accel, rays) }
    }
}

impl Display for Kind {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Single => f.write_str("single"),
            Self::Packet(width, coherence) => write!(f, "packet {width} {coherence:?}"),
            Self::Stream(coherence) => write!(f, "stream {coherence:?}"),
        }
    }
}

fn stream(rays: &[Ray]) -> RayStream {
    let mut stream = RayStream::default();
    stream.extend(rays);
    stream
}

fn packet<const N: usize>(rays: &[Ray]) -> RayPacket<N> {
    let mut packet = RayPacket::EMPTY;
    rays.iter().enumerate().for_each(|(lane, ray)| packet.set(lane, ray));
    packet
}

/// The lanes in two lots, so that packets are traced with holes in them; another pattern for each packet.
fn lots<const N: usize>(len: usize, number: usize) -> [Active<N>; 2] {
    let filled = (1_u32 << len) - 1;
    let some = [0b0101_1011_0110_1101, 0xffff, 0b1000_0000_0001, 0b0011_1100_1111_0000][number % 4] & filled;
    [Active::from_bits(some), Active::from_bits(filled & !some)]
}

fn packets<const N: usize>(accel: &impl Accel, rays: &[Ray], coherence: Coherence) -> Vec<Option<Hit>> {
    let mut hits = Vec::with_capacity(rays.len());
    for (number, chunk) in rays.chunks(N).enumerate() {
        let mut both = Packet::<N> { ray: packet(chunk), ..Packet::EMPTY };
        for active in lots(chunk.len(), number) {
            let before = both;
            accel.intersect_packet(&active, &mut both, coherence);
            let marks = |packet: &Packet<N>, lane: usize| {
                (packet.ray.t_max[lane].to_bits(), packet.hit.geometry[lane], packet.hit.prim[lane])
            };
            for lane in (0..N).filter(|&lane| !active.contains(lane)) {
                assert_eq!(marks(&both, lane), marks(&before, lane), "an inactive lane has changed");
            }
        }
        hits.extend((0..chunk.len()).map(|lane| both.get_hit(lane)));
    }
    hits
}

fn occluded_packets<const N: usize>(accel: &impl Accel, rays: &[Ray], coherence: Coherence) -> Vec<bool> {
    let mut occluded = Vec::with_capacity(rays.len());
    for (number, chunk) in rays.chunks(N).enumerate() {
        let mut shadow = packet::<N>(chunk);
        for active in lots(chunk.len(), number) {
            accel.occluded_packet(&active, &mut shadow, coherence);
        }
        occluded.extend(chunk.iter().zip(&shadow.t_max).map(|(ray, &after)| after < ray.t_max));
    }
    occluded
}
