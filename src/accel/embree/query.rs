//! Queries of a committed scene: one ray, packets of 4, 8 and 16, streams of any length.
//!
//! Our ray and packet types have the layout of Embree's, asserted below, and their alignment by type: a query copies
//! one ray by three vector moves and traces a packet where it lies. "For performance reasons this function does not
//! do any error checks": the types rule out what it would have checked, and nothing is asked afterwards.
//!
//! What the types cannot rule out and Embree does not bear is checked before each call. On library 4.4.0 a direction
//! that is not a number crashed a robust scene of spheres, an infinite origin was found to hit triangles, and so were
//! rays of an empty range in coherent packets at instances. Rays are traced up to [`LARGEST`]; all others hit nothing.
//! What Embree does bear is left to it: directions without length, and for single rays the range.
//! `tests/accel_agree.rs` holds it to that, for the kernels of three instruction sets. Every instruction here counts:
//! twenty are two per cent of a short ray.
//!
//! Embree 4 has no streams. Ours are cut into packets of the widest native kind; the arrays are copied, which costs
//! little beside the traversal.

use super::scene::{Committed, Scene};
use crate::accel::packet::{intersect_one_by_one, occluded_one_by_one, placement};
use crate::accel::{Active, Coherence, HitPacket, HitStream, Packet, RayPacket, RayStream};
use crate::geometry::{Hit, Ray};
use embree4_sys as sys;
use glam::{BVec4A, Vec3, Vec4};
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

/// A ray on a cache line of its own. Split between two lines, where the stack happens to lie so, it cost three to five
/// per cent of a short shadow ray. Queries for hits, which fill two lines, gained nothing.
#[repr(align(64))]
struct Line<T>(T);

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

/// The largest magnitude of origin and direction together, along each axis, that is traced: about the root of the
/// largest number, so that squares are finite. Embree leaves out primitives from there on ("greater than 1.844E18f").
const LARGEST: f32 = 1.8e18;

impl Scene<Committed> {
    /// The nearest hit within the ray's range.
    #[must_use]
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let mut query = sys::RTCRayHit { ray: sound(ray)?, hit: NO_HIT };
        // SAFETY: the scene is committed; the structure is aligned by its type and its identifiers are preset.
        unsafe { sys::rtcIntersect1(self.raw(), &raw mut query, null_mut()) };
        if let Some(after) = self.after() {
            after.single(&mut query.hit);
        }
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
        let Some(query) = sound(ray) else { return false };
        let mut query = Line(query);
        // SAFETY: the scene is committed; the structure is aligned by its type.
        unsafe { sys::rtcOccluded1(self.raw(), &raw mut query.0, null_mut()) };
        if let Some(after) = self.after() {
            after.occluded();
        }
        // Found: the end was set to negative infinity. A ray that had it there before found nothing.
        query.0.tfar < ray.t_max
    }

    /// The nearest hit of each active lane; see [`crate::accel::Accel::intersect_packet`].
    #[inline]
    pub fn intersect_packet<const N: usize>(
        &self,
        active: &Active<N>,
        packet: &mut Packet<N>,
        coherence: Coherence,
    ) {
        if has_kernel(N) {
            preset(active, &mut packet.hit);
            self.trace(active, packet, &mut intersect_arguments(coherence));
            return;
        }
        intersect_one_by_one(active, packet, |ray| self.intersect(ray));
    }

    /// Whether anything lies within the range of each active lane; see [`crate::accel::Accel::occluded_packet`].
    #[inline]
    pub fn occluded_packet<const N: usize>(
        &self,
        active: &Active<N>,
        rays: &mut RayPacket<N>,
        coherence: Coherence,
    ) {
        if has_kernel(N) {
            self.trace_occluded(active, rays, &mut occluded_arguments(coherence));
            return;
        }
        occluded_one_by_one(active, rays, |ray| self.occluded(ray));
    }

    /// Traces a packet of 4, 8 or 16 whose active lanes have their identifiers preset.
    #[inline]
    fn trace<const N: usize>(
        &self,
        active: &Active<N>,
        packet: &mut Packet<N>,
        arguments: &mut sys::RTCIntersectArguments,
    ) {
        let sound = soundness(active, &packet.ray);
        let valid = sound.as_ref().unwrap_or(active).as_array().as_ptr();
        let to: *mut Packet<N> = packet;
        let scene = self.raw();
        match N {
            // SAFETY: the scene is committed, layout and alignment are asserted above, identifiers are preset.
            4 => unsafe { sys::rtcIntersect4(valid, scene, to.cast(), arguments) },
            // SAFETY: as for 4.
            8 => unsafe { sys::rtcIntersect8(valid, scene, to.cast(), arguments) },
            // SAFETY: as for 4.
            16 => unsafe { sys::rtcIntersect16(valid, scene, to.cast(), arguments) },
            _ => unreachable!("there are kernels for packets of 4, 8 and 16"),
        }
        if let Some(after) = self.after() {
            after.packet(active, &mut packet.hit);
        }
    }

    /// Asks a packet of 4, 8 or 16.
    #[inline]
    fn trace_occluded<const N: usize>(
        &self,
        active: &Active<N>,
        rays: &mut RayPacket<N>,
        arguments: &mut sys::RTCOccludedArguments,
    ) {
        let sound = soundness(active, rays);
        let valid = sound.as_ref().unwrap_or(active).as_array().as_ptr();
        let to: *mut RayPacket<N> = rays;
        let scene = self.raw();
        match N {
            // SAFETY: the scene is committed, layout and alignment are asserted above.
            4 => unsafe { sys::rtcOccluded4(valid, scene, to.cast(), arguments) },
            // SAFETY: as for 4.
            8 => unsafe { sys::rtcOccluded8(valid, scene, to.cast(), arguments) },
            // SAFETY: as for 4.
            16 => unsafe { sys::rtcOccluded16(valid, scene, to.cast(), arguments) },
            _ => unreachable!("there are kernels for packets of 4, 8 and 16"),
        }
        if let Some(after) = self.after() {
            after.occluded();
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
        let mut arguments = intersect_arguments(coherence);
        let whole = rays.len() / N * N;
        for start in (0..whole).step_by(N) {
            load(rays, start, &mut packet.ray);
            packet.hit.geometry = [sys::RTC_INVALID_GEOMETRY_ID; N];
            packet.hit.instance = [sys::RTC_INVALID_GEOMETRY_ID; N];
            self.trace(&Active::ALL, &mut packet, &mut arguments);
            store(&packet, start, hits);
        }
        let mut rest = Packet::<N>::EMPTY;
        (whole..rays.len()).enumerate().for_each(|(lane, i)| rest.ray.set(lane, &rays.get(i)));
        self.intersect_packet(&Active::first(rays.len() - whole), &mut rest, coherence);
        (whole..rays.len()).enumerate().for_each(|(lane, i)| hits.set(i, rest.get_hit(lane).as_ref()));
    }

    fn occluded_blocks<const N: usize>(
        &self,
        rays: &RayStream,
        occluded: &mut Vec<bool>,
        coherence: Coherence,
    ) {
        let mut packet = RayPacket::<N>::EMPTY;
        let mut arguments = occluded_arguments(coherence);
        let whole = rays.len() / N * N;
        for start in (0..whole).step_by(N) {
            load(rays, start, &mut packet);
            self.trace_occluded(&Active::ALL, &mut packet, &mut arguments);
            let ends = packet.t_max.iter().zip(&rays.t_max[start..start + N]);
            occluded.extend(ends.map(|(after, before)| after < before));
        }
        occluded.extend((whole..rays.len()).map(|i| self.occluded(&rays.get(i))));
    }
}

/// The ray as Embree's structure; `None` if it must not be traced.
#[inline]
fn sound(ray: &Ray) -> Option<sys::RTCRay> {
    let own: *const Ray = ray;
    // SAFETY: a ray is three rows of four numbers, aligned as they are; any bits are a number.
    let [o, d, _] = unsafe { own.cast::<[Vec4; 3]>().read() };
    // Of the fourth column, the near end and the moment, nothing is asked. Comparisons are false of what is not a
    // number.
    if (o.abs() + d.abs()).cmple(Vec4::splat(LARGEST)).bitmask() & 0b111 != 0b111 {
        return None;
    }
    // SAFETY: size, alignment and fields agree, as asserted above, and every field is a plain number.
    Some(unsafe { own.cast::<sys::RTCRay>().read() })
}

/// The active lanes that may be traced, if those are not all of them.
#[inline]
fn soundness<const N: usize>(active: &Active<N>, rays: &RayPacket<N>) -> Option<Active<N>> {
    // This runs before every packet: one sum and one comparison say that all is well. What is not a number, or not
    // finite, stays so in a sum.
    let mut sum = Vec4::ZERO;
    let mut ordered = BVec4A::splat(true);
    for start in (0..N).step_by(4) {
        let row = |component: &[f32; N]| Vec4::from_slice(&component[start..start + 4]);
        let origins = row(&rays.o_x).abs() + row(&rays.o_y).abs() + row(&rays.o_z).abs();
        sum += origins + (row(&rays.d_x).abs() + row(&rays.d_y).abs() + row(&rays.d_z).abs());
        ordered &= row(&rays.t_min).cmple(row(&rays.t_max));
    }
    if (ordered & sum.cmple(Vec4::splat(LARGEST))).all() {
        return None;
    }
    unsound(active, rays)
}

/// As [`soundness`], lane by lane.
#[cold]
fn unsound<const N: usize>(active: &Active<N>, rays: &RayPacket<N>) -> Option<Active<N>> {
    let bits = |lanes: &mut dyn Iterator<Item = usize>| lanes.fold(0, |bits, lane| bits | 1 << lane);
    let wanted = bits(&mut active.lanes());
    let is_sound = |lane: &usize| {
        let ray = rays.get(*lane);
        (ray.o.abs() + ray.d.abs()).cmple(Vec3::splat(LARGEST)).all() && ray.t_min <= ray.t_max
    };
    let sound = bits(&mut active.lanes().filter(is_sound));
    (sound != wanted).then(|| Active::from_bits(sound))
}

/// Whether Embree takes packets of `n`.
const fn has_kernel(n: usize) -> bool {
    matches!(n, 4 | 8 | 16)
}

fn intersect_arguments(coherence: Coherence) -> sys::RTCIntersectArguments {
    sys::RTCIntersectArguments { flags: flags(coherence), ..sys::rtcInitIntersectArguments() }
}

fn occluded_arguments(coherence: Coherence) -> sys::RTCOccludedArguments {
    sys::RTCOccludedArguments { flags: flags(coherence), ..sys::rtcInitOccludedArguments() }
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

/// Copies the `N` rays from `start` on.
#[inline]
fn load<const N: usize>(rays: &RayStream, start: usize, packet: &mut RayPacket<N>) {
    let of = start..start + N;
    packet.o_x.copy_from_slice(&rays.o[0][of.clone()]);
    packet.o_y.copy_from_slice(&rays.o[1][of.clone()]);
    packet.o_z.copy_from_slice(&rays.o[2][of.clone()]);
    packet.t_min.copy_from_slice(&rays.t_min[of.clone()]);
    packet.d_x.copy_from_slice(&rays.d[0][of.clone()]);
    packet.d_y.copy_from_slice(&rays.d[1][of.clone()]);
    packet.d_z.copy_from_slice(&rays.d[2][of.clone()]);
    packet.time.copy_from_slice(&rays.time[of.clone()]);
    packet.t_max.copy_from_slice(&rays.t_max[of.clone()]);
    packet.mask.copy_from_slice(&rays.mask[of]);
}

/// Copies the `N` answers to `start` and on.
#[inline]
fn store<const N: usize>(packet: &Packet<N>, start: usize, hits: &mut HitStream) {
    let hit = &packet.hit;
    let of = start..start + N;
    hits.t[of.clone()].copy_from_slice(&packet.ray.t_max);
    hits.u[of.clone()].copy_from_slice(&hit.u);
    hits.v[of.clone()].copy_from_slice(&hit.v);
    hits.ng[0][of.clone()].copy_from_slice(&hit.ng_x);
    hits.ng[1][of.clone()].copy_from_slice(&hit.ng_y);
    hits.ng[2][of.clone()].copy_from_slice(&hit.ng_z);
    hits.prim[of.clone()].copy_from_slice(&hit.prim);
    let named = hit.geometry.iter().zip(&hit.instance);
    for (to, (&geometry, &instance)) in hits.placement[of].iter_mut().zip(named) {
        *to = if instance == sys::RTC_INVALID_GEOMETRY_ID { geometry } else { instance };
    }
}
