//! Queries of a committed scene: one ray, packets of 4, 8 and 16, streams of any length.
//!
//! Our ray and packet types have the layout of Embree's, asserted below, and their alignment by type: a query copies
//! one ray by three vector moves and traces a packet where it lies. "For performance reasons this function does not
//! do any error checks": the types rule out what it would have checked, and nothing is asked afterwards.
//!
//! What the types cannot rule out is checked before each call, for it is not only a wrong answer: on library 4.4.0 a
//! direction that is not a number crashed a robust scene of spheres, and an infinite origin was found to hit
//! triangles. Rays count as sound up to [`LARGEST`]; all others hit nothing.
//!
//! Embree 4 has no streams. Ours are cut into packets of the widest native kind; the arrays are copied, which costs
//! little beside the traversal.

use super::scene::{Committed, Scene};
use crate::accel::packet::placement;
use crate::accel::{Active, Coherence, HitPacket, HitStream, Packet, RayPacket, RayStream};
use crate::geometry::{Hit, Ray};
use embree4_sys as sys;
use glam::{Vec3, Vec4};
use std::mem::{align_of, offset_of, size_of};
use std::ptr::null_mut;

/// Asserts that one of our structures begins as Embree's does, is no smaller and no less aligned.
macro_rules! same_layout {
    ($ours:ty, $theirs:ty, [$($own:ident = $its:ident),+]) => {
        const _: () = {
            assert!(size_of::<$ours>() >= size_of::<$theirs>());
            assert!(align_of::<$ours>() >= align_of::<$theirs>());
            $(assert!(offset_of!($ours, $own) == offset_of!($theirs, $its));)+
        };
    };
}

const _: () = assert!(size_of::<Ray>() == size_of::<sys::RTCRay>(), "a ray is copied whole");
same_layout!(Ray, sys::RTCRay, [o = org_x, t_min = tnear, d = dir_x, time = time, t_max = tfar, mask = mask]);

macro_rules! same_packet_layout {
    ($n:literal, $ray:ty, $hit:ty, $both:ty) => {
        same_layout!(
            RayPacket<$n>,
            $ray,
            [
                o_x = org_x,
                o_y = org_y,
                o_z = org_z,
                t_min = tnear,
                d_x = dir_x,
                d_y = dir_y,
                d_z = dir_z,
                time = time,
                t_max = tfar,
                mask = mask
            ]
        );
        same_layout!(
            HitPacket<$n>,
            $hit,
            [
                ng_x = Ng_x,
                ng_y = Ng_y,
                ng_z = Ng_z,
                u = u,
                v = v,
                prim = primID,
                geometry = geomID,
                instance = instID
            ]
        );
        same_layout!(Packet<$n>, $both, [ray = ray, hit = hit]);
    };
}

same_packet_layout!(4, sys::RTCRay4, sys::RTCHit4, sys::RTCRayHit4);
same_packet_layout!(8, sys::RTCRay8, sys::RTCHit8, sys::RTCRayHit8);
same_packet_layout!(16, sys::RTCRay16, sys::RTCHit16, sys::RTCRayHit16);

/// No hit, as a query wants to find it.
const NO_HIT: sys::RTCHit = sys::RTCHit {
    Ng_x: 0.0,
    Ng_y: 0.0,
    Ng_z: 0.0,
    u: 0.0,
    v: 0.0,
    primID: sys::RTC_INVALID_GEOMETRY_ID,
    geomID: sys::RTC_INVALID_GEOMETRY_ID,
    instID: [sys::RTC_INVALID_GEOMETRY_ID],
    instPrimID: [sys::RTC_INVALID_GEOMETRY_ID],
};

/// The largest sum of the magnitudes of a ray's coordinates that is traced: about the root of the largest number, so
/// that squares are finite. Embree leaves out primitives from half of it on ("greater than 1.844E18f").
const LARGEST: f32 = 1.8e18;

impl Scene<Committed> {
    /// The nearest hit within the ray's range.
    #[must_use]
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let mut query = sys::RTCRayHit { ray: sound(ray)?, hit: NO_HIT };
        // SAFETY: the scene is committed; the structure is aligned by its type and its identifiers are preset.
        unsafe { sys::rtcIntersect1(self.raw(), &raw mut query, null_mut()) };
        let hit = &query.hit;
        Some(Hit {
            placement: placement(hit.geomID, hit.instID[0])?,
            t: query.ray.tfar,
            u: hit.u,
            v: hit.v,
            ng: Vec3::new(hit.Ng_x, hit.Ng_y, hit.Ng_z),
            prim: hit.primID,
        })
    }

    /// Whether anything lies within the ray's range.
    #[must_use]
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        let Some(mut query) = sound(ray) else { return false };
        // SAFETY: the scene is committed; the structure is aligned by its type.
        unsafe { sys::rtcOccluded1(self.raw(), &raw mut query, null_mut()) };
        // Found: the end was set to negative infinity, where no sound ray has it.
        query.tfar < ray.t_max
    }

    /// The nearest hit of each active lane; see [`crate::accel::Accel::intersect_packet`].
    #[inline]
    pub fn intersect_packet<const N: usize>(
        &self,
        active: &Active<N>,
        packet: &mut Packet<N>,
        coherence: Coherence,
    ) {
        if !has_kernel(N) {
            for lane in active.lanes() {
                let hit = self.intersect(&packet.ray.get(lane));
                packet.set_hit(lane, hit.as_ref());
            }
            return;
        }
        let mut arguments = sys::rtcInitIntersectArguments();
        arguments.flags = flags(coherence);
        preset(active, &mut packet.hit);
        let sound = soundness(active, &packet.ray);
        let active = sound.as_ref().unwrap_or(active);
        let valid = active.as_array().as_ptr();
        let to: *mut Packet<N> = packet;
        let (scene, arguments) = (self.raw(), &raw mut arguments);
        match N {
            // SAFETY: the scene is committed, layout and alignment are asserted above, identifiers are preset.
            4 => unsafe { sys::rtcIntersect4(valid, scene, to.cast(), arguments) },
            // SAFETY: as for 4.
            8 => unsafe { sys::rtcIntersect8(valid, scene, to.cast(), arguments) },
            // SAFETY: as for 4.
            16 => unsafe { sys::rtcIntersect16(valid, scene, to.cast(), arguments) },
            _ => unreachable!("there are kernels for packets of 4, 8 and 16"),
        }
    }

    /// Whether anything lies within the range of each active lane; see [`crate::accel::Accel::occluded_packet`].
    #[inline]
    pub fn occluded_packet<const N: usize>(
        &self,
        active: &Active<N>,
        rays: &mut RayPacket<N>,
        coherence: Coherence,
    ) {
        if !has_kernel(N) {
            for lane in active.lanes() {
                if self.occluded(&rays.get(lane)) {
                    rays.t_max[lane] = f32::NEG_INFINITY;
                }
            }
            return;
        }
        let mut arguments = sys::rtcInitOccludedArguments();
        arguments.flags = flags(coherence);
        let sound = soundness(active, rays);
        let active = sound.as_ref().unwrap_or(active);
        let valid = active.as_array().as_ptr();
        let to: *mut RayPacket<N> = rays;
        let (scene, arguments) = (self.raw(), &raw mut arguments);
        match N {
            // SAFETY: the scene is committed, layout and alignment are asserted above.
            4 => unsafe { sys::rtcOccluded4(valid, scene, to.cast(), arguments) },
            // SAFETY: as for 4.
            8 => unsafe { sys::rtcOccluded8(valid, scene, to.cast(), arguments) },
            // SAFETY: as for 4.
            16 => unsafe { sys::rtcOccluded16(valid, scene, to.cast(), arguments) },
            _ => unreachable!("there are kernels for packets of 4, 8 and 16"),
        }
    }

    /// The nearest hit of every ray; `hits` is resized to match.
    pub fn intersect_stream(&self, rays: &RayStream, hits: &mut HitStream, coherence: Coherence) {
        hits.resize(rays.len());
        match self.device().native_width() {
            16 => self.intersect_blocks::<16>(rays, hits, coherence),
            8 => self.intersect_blocks::<8>(rays, hits, coherence),
            _ => self.intersect_blocks::<4>(rays, hits, coherence),
        }
    }

    /// Whether anything lies within the range of every ray; `occluded` is resized to match.
    pub fn occluded_stream(&self, rays: &RayStream, occluded: &mut Vec<bool>, coherence: Coherence) {
        occluded.clear();
        match self.device().native_width() {
            16 => self.occluded_blocks::<16>(rays, occluded, coherence),
            8 => self.occluded_blocks::<8>(rays, occluded, coherence),
            _ => self.occluded_blocks::<4>(rays, occluded, coherence),
        }
    }

    fn intersect_blocks<const N: usize>(&self, rays: &RayStream, hits: &mut HitStream, coherence: Coherence) {
        let mut packet = Packet::<N>::EMPTY;
        for start in (0..rays.len()).step_by(N) {
            let count = N.min(rays.len() - start);
            load(rays, start, count, &mut packet.ray);
            packet.hit = HitPacket::NONE;
            self.intersect_packet(&Active::first(count), &mut packet, coherence);
            store(&packet, start, count, hits);
        }
    }

    fn occluded_blocks<const N: usize>(
        &self,
        rays: &RayStream,
        occluded: &mut Vec<bool>,
        coherence: Coherence,
    ) {
        let mut packet = RayPacket::<N>::EMPTY;
        for start in (0..rays.len()).step_by(N) {
            let count = N.min(rays.len() - start);
            load(rays, start, count, &mut packet);
            self.occluded_packet(&Active::first(count), &mut packet, coherence);
            let ends = packet.t_max[..count].iter().zip(&rays.t_max[start..]);
            occluded.extend(ends.map(|(after, before)| after < before));
        }
    }
}

/// The ray as Embree's structure; `None` if it must not be traced.
#[inline]
fn sound(ray: &Ray) -> Option<sys::RTCRay> {
    let own: *const Ray = ray;
    // SAFETY: a ray is three rows of four numbers, aligned as they are; any bits are a number.
    let [o, d, _] = unsafe { own.cast::<[Vec4; 3]>().read() };
    let xyz = |v: Vec4| v.x.abs() + v.y.abs() + v.z.abs();
    if !is_sound(xyz(o), xyz(d), ray.t_min, ray.t_max) {
        return None;
    }
    // SAFETY: size, alignment and fields agree, as asserted above, and every field is a plain number.
    Some(unsafe { own.cast::<sys::RTCRay>().read() })
}

/// Whether a ray may be traced, given the sums of magnitudes of its origin's and direction's coordinates: comparisons
/// are false of what is not a number.
#[inline]
fn is_sound(o: f32, d: f32, t_min: f32, t_max: f32) -> bool {
    // No short circuit: this runs over lanes.
    (o + d <= LARGEST) & (d > 0.0) & (t_min <= t_max)
}

/// The active lanes that may be traced, if those are not all of them.
#[inline]
fn soundness<const N: usize>(active: &Active<N>, rays: &RayPacket<N>) -> Option<Active<N>> {
    let is_sound = |lane: usize| {
        let o = rays.o_x[lane].abs() + rays.o_y[lane].abs() + rays.o_z[lane].abs();
        let d = rays.d_x[lane].abs() + rays.d_y[lane].abs() + rays.d_z[lane].abs();
        is_sound(o, d, rays.t_min[lane], rays.t_max[lane])
    };
    let flags = active.as_array();
    let unsound = (0..N).fold(0, |all, lane| all | flags[lane] & !-i32::from(is_sound(lane)));
    if unsound == 0 {
        return None;
    }
    let bits = active.lanes().filter(|&lane| is_sound(lane)).fold(0, |bits, lane| bits | 1 << lane);
    Some(Active::from_bits(bits))
}

/// Whether Embree takes packets of `n`.
const fn has_kernel(n: usize) -> bool {
    matches!(n, 4 | 8 | 16)
}

fn flags(coherence: Coherence) -> sys::RTCRayQueryFlags {
    match coherence {
        Coherence::Coherent => sys::RTC_RAY_QUERY_FLAG_COHERENT,
        Coherence::Incoherent => sys::RTC_RAY_QUERY_FLAG_INCOHERENT,
    }
}

/// Marks the active lanes as without a hit and leaves the others.
#[inline]
fn preset<const N: usize>(active: &Active<N>, hit: &mut HitPacket<N>) {
    for (lane, flag) in active.as_array().iter().enumerate() {
        // All ones where active.
        let none = flag.cast_unsigned();
        hit.geometry[lane] |= none;
        hit.instance[lane] |= none;
    }
}

/// Copies `count` rays from `start` on to the first lanes.
#[inline]
fn load<const N: usize>(rays: &RayStream, start: usize, count: usize, packet: &mut RayPacket<N>) {
    let of = start..start + count;
    packet.o_x[..count].copy_from_slice(&rays.o[0][of.clone()]);
    packet.o_y[..count].copy_from_slice(&rays.o[1][of.clone()]);
    packet.o_z[..count].copy_from_slice(&rays.o[2][of.clone()]);
    packet.t_min[..count].copy_from_slice(&rays.t_min[of.clone()]);
    packet.d_x[..count].copy_from_slice(&rays.d[0][of.clone()]);
    packet.d_y[..count].copy_from_slice(&rays.d[1][of.clone()]);
    packet.d_z[..count].copy_from_slice(&rays.d[2][of.clone()]);
    packet.time[..count].copy_from_slice(&rays.time[of.clone()]);
    packet.t_max[..count].copy_from_slice(&rays.t_max[of.clone()]);
    packet.mask[..count].copy_from_slice(&rays.mask[of]);
}

/// Copies the answers of the first `count` lanes.
#[inline]
fn store<const N: usize>(packet: &Packet<N>, start: usize, count: usize, hits: &mut HitStream) {
    let hit = &packet.hit;
    let of = start..start + count;
    hits.t[of.clone()].copy_from_slice(&packet.ray.t_max[..count]);
    hits.u[of.clone()].copy_from_slice(&hit.u[..count]);
    hits.v[of.clone()].copy_from_slice(&hit.v[..count]);
    hits.ng[0][of.clone()].copy_from_slice(&hit.ng_x[..count]);
    hits.ng[1][of.clone()].copy_from_slice(&hit.ng_y[..count]);
    hits.ng[2][of.clone()].copy_from_slice(&hit.ng_z[..count]);
    hits.prim[of.clone()].copy_from_slice(&hit.prim[..count]);
    let named = hit.geometry.iter().zip(&hit.instance);
    for (to, (&geometry, &instance)) in hits.placement[of].iter_mut().zip(named) {
        *to = if instance == sys::RTC_INVALID_GEOMETRY_ID { geometry } else { instance };
    }
}
