//! Recorded rays, and the forms in which queries take them.

use crate::accel::{RayPacket, RayStream};
use crate::geometry::Ray;

/// What rays are for, which is how they lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Class {
    /// From the camera, sixteen in turn through each of many pixels all over the picture.
    Primary,
    /// From what the camera sees to a point of a light, ending just before it.
    Shadow,
    /// From what the camera sees, mirrored at the shading normal.
    Specular,
    /// A diffuse bounce, from the first to the fourth.
    Diffuse(u8),
    /// From any point of the scene's box to any other.
    Random,
}

impl Class {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Primary,
        Self::Shadow,
        Self::Specular,
        Self::Diffuse(1),
        Self::Diffuse(2),
        Self::Diffuse(3),
        Self::Diffuse(4),
        Self::Random,
    ];

    /// Its name on the command line, in files and tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Specular => "specular",
            Self::Diffuse(1) => "diffuse1",
            Self::Diffuse(2) => "diffuse2",
            Self::Diffuse(3) => "diffuse3",
            Self::Diffuse(_) => "diffuse4",
            Self::Random => "random",
        }
    }
}

/// Rays of one class, in the order in which they are asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RaySet {
    /// What they are called: [`Class::word`], or what the author of a file chose.
    pub name: String,
    /// The rays.
    pub rays: Vec<Ray>,
}

impl RaySet {
    /// The rays in packets of `N`; the last one may hold fewer, its other lanes hit nothing.
    #[must_use]
    pub fn packets<const N: usize>(&self) -> Vec<RayPacket<N>> {
        packets(&self.rays)
    }

    /// The rays as one stream.
    #[must_use]
    pub fn stream(&self) -> RayStream {
        stream(&self.rays)
    }
}

pub(super) fn packets<const N: usize>(rays: &[Ray]) -> Vec<RayPacket<N>> {
    let packet = |rays: &[Ray]| {
        let mut packet = RayPacket::EMPTY;
        rays.iter().enumerate().for_each(|(lane, ray)| packet.set(lane, ray));
        packet
    };
    rays.chunks(N).map(packet).collect()
}

pub(super) fn stream(rays: &[Ray]) -> RayStream {
    let mut stream = RayStream::default();
    stream.extend(rays);
    stream
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn the_last_packet_may_be_short() {
        let rays = [1.0, 2.0, 3.0, 4.0, 5.0].map(|x| Ray::new(Vec3::X * x, Vec3::Z)).to_vec();
        let set = RaySet { name: "a".to_owned(), rays: rays.clone() };
        let packets = set.packets::<4>();
        assert_eq!(packets.len(), 2, "packets");
        assert_eq!(
            (packets[1].get(0), packets[1].get(1).is_traceable()),
            (rays[4], false),
            "the rest is empty"
        );
        assert_eq!(set.stream().get(3), rays[3], "stream");
    }
}
