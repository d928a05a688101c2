//! Who is hit: one seam, several backends.
//!
//! [`Accel`] answers closest-hit and any-hit queries for one ray, for packets and for streams. A backend must
//! write the single queries; packets and streams have plain default bodies on top of them, so callers may not assume
//! that a packet or a stream is faster. All kinds of query give the same answers but for ties on shared edges.
//!
//! ```
//! use glam::Vec3;
//! use specula::accel::{Accel, Brute, Bvh2Accel, CwBvhAccel, HitStream, RayStream, Coherence};
//! use specula::accel::embree::{BuildOptions, EmbreeAccel};
//! use specula::geometry::{Mesh, Ray, Shape, World};
//! use std::sync::Arc;
//!
//! let corners = vec![Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
//! let mut world = World::default();
//! let triangle = world.add_shape(Shape::Mesh(Mesh::new(corners, vec![[0, 1, 2]])?));
//! world.place(triangle, None);
//! let world = Arc::new(world);
//!
//! fn trace(accel: &impl Accel) -> [f32; 2] {
//!     let ray = Ray::new(Vec3::new(0.1, 0.0, 3.0), -Vec3::Z);
//!     let hit = accel.intersect(&ray).expect("the triangle is in the way");
//!     assert!(accel.occluded(&ray) && !accel.occluded(&ray.until(2.5)));
//!     let (mut rays, mut hits) = (RayStream::default(), HitStream::default());
//!     rays.extend([&ray; 100]);
//!     accel.intersect_stream(&rays, &mut hits, Coherence::Coherent);
//!     assert!((0..100).all(|i| hits.get(i).is_some_and(|found| (found.t - hit.t).abs() < 1e-5)));
//!     [hit.u, hit.v]
//! }
//!
//! let [u, v] = trace(&EmbreeAccel::build(&world, &BuildOptions::default())?);
//! for [other_u, other_v] in [
//!     trace(&Bvh2Accel::build(&world, &Default::default())),
//!     trace(&CwBvhAccel::build(&world, &Default::default())),
//!     trace(&Brute::new(world)),
//! ] {
//!     assert!((u - other_u).abs() < 1e-6 && (v - other_v).abs() < 1e-6);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod brute;
pub mod bvh;
pub mod embree;
pub mod packet;
pub mod stream;

pub use brute::Brute;
pub use bvh::{Bvh2Accel, CwBvhAccel};
pub use packet::{Active, HitPacket, Packet, RayPacket};
pub use stream::{HitStream, RayStream};

use crate::geometry::{Hit, Ray};
use crate::math::Aabb;

/// Whether the rays of a packet or stream start and head alike. Only a hint: it changes speed, not answers, and the
/// wrong hint halves the speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coherence {
    /// Neighbours take nearly the same way, as camera rays do.
    Coherent,
    /// Neighbours part, as rays after a diffuse bounce do.
    Incoherent,
}

/// Something that finds hits in a frozen world.
///
/// Rays that are not traceable ([`Ray::is_traceable`]) hit nothing.
pub trait Accel: Send + Sync {
    /// The nearest hit within the ray's range.
    fn intersect(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything lies within the ray's range.
    fn occluded(&self, ray: &Ray) -> bool;

    /// The nearest hit of each active lane, written to `packet.hit`, and its parameter to `packet.ray.t_max`; inactive
    /// lanes and misses stay as they are, but for the identifiers of active misses, which say "none".
    fn intersect_packet<const N: usize>(
        &self,
        active: &Active<N>,
        packet: &mut Packet<N>,
        _coherence: Coherence,
    ) {
        packet::intersect_one_by_one(active, packet, |ray| self.intersect(ray));
    }

    /// Whether anything lies within the range of each active lane: those lanes' `t_max` becomes negative infinity.
    fn occluded_packet<const N: usize>(
        &self,
        active: &Active<N>,
        rays: &mut RayPacket<N>,
        _coherence: Coherence,
    ) {
        packet::occluded_one_by_one(active, rays, |ray| self.occluded(ray));
    }

    /// The nearest hit of every ray; `hits` is resized to match.
    fn intersect_stream(&self, rays: &RayStream, hits: &mut HitStream, _coherence: Coherence) {
        hits.resize(rays.len());
        for i in 0..rays.len() {
            hits.set(i, self.intersect(&rays.get(i)).as_ref());
        }
    }

    /// Whether anything lies within the range of every ray; `occluded` is resized to match.
    fn occluded_stream(&self, rays: &RayStream, occluded: &mut Vec<bool>, _coherence: Coherence) {
        occluded.clear();
        occluded.extend((0..rays.len()).map(|i| self.occluded(&rays.get(i))));
    }

    /// A box around everything that can be hit.
    fn bounds(&self) -> Aabb;

    /// Bytes held for the hierarchy, beyond the shapes themselves.
    fn bytes(&self) -> usize;
}
