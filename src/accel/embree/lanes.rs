//! Rays and hits as callbacks get them: `n` lanes, one component after the other, whatever the width of the query.

use crate::geometry::{Ray, ShapeHit};
use glam::Vec3;
use std::ffi::c_void;
use std::slice;

/// Components of a ray up to its mask, in the order of Embree's `RTCRayN_*` accessors.
const RAY: usize = 10;
/// Components of a whole ray: hits lie behind it.
const WHOLE_RAY: usize = 12;
const T_MIN: usize = 3;
const DIRECTION: usize = 4;
const TIME: usize = 7;
const T_MAX: usize = 8;
const MASK: usize = 9;

/// Components of a hit, in the order of Embree's `RTCHitN_*` accessors, with one level of instances.
const HIT: usize = 9;
const U: usize = 3;
const V: usize = 4;
const PRIM: usize = 5;
const GEOMETRY: usize = 6;
const INSTANCE: usize = 7;
const INSTANCE_PRIM: usize = 8;

/// Rays.
pub(super) struct RayLanes<'a> {
    words: &'a mut [u32],
    n: usize,
}

/// Hits.
pub(super) struct HitLanes<'a> {
    words: &'a mut [u32],
    n: usize,
}

/// Who was hit.
#[derive(Clone, Copy)]
pub(super) struct Identity {
    pub(super) prim: u32,
    pub(super) geometry: u32,
    pub(super) instance: u32,
    pub(super) instance_prim: u32,
}

impl RayLanes<'_> {
    /// The rays at `start`.
    ///
    /// # Safety
    /// `start` points to an `RTCRayN` of `n` lanes, which nothing else uses for as long as the result is used.
    pub(super) unsafe fn at(start: *mut c_void, n: usize) -> Self {
        // SAFETY: the caller's promise; a component is `n` words, and any bits are a word.
        let words = unsafe { slice::from_raw_parts_mut(start.cast(), RAY * n) };
        Self { words, n }
    }

    /// The ray of a lane.
    pub(super) fn get(&self, lane: usize) -> Ray {
        let number = |component| f32::from_bits(self.words[component * self.n + lane]);
        let vector = |first| Vec3::new(number(first), number(first + 1), number(first + 2));
        let ray = Ray::new(vector(0), vector(DIRECTION)).starting(number(T_MIN)).until(number(T_MAX));
        ray.at_time(number(TIME)).seeing(self.words[MASK * self.n + lane])
    }

    /// Ends the ray of a lane.
    pub(super) fn set_t_max(&mut self, lane: usize, t: f32) {
        self.words[T_MAX * self.n + lane] = t.to_bits();
    }
}

impl HitLanes<'_> {
    /// The hits at `start`.
    ///
    /// # Safety
    /// `start` points to an `RTCHitN` of `n` lanes, which nothing else uses for as long as the result is used.
    pub(super) unsafe fn at(start: *mut c_void, n: usize) -> Self {
        // SAFETY: the caller's promise; a component is `n` words, and any bits are a word.
        let words = unsafe { slice::from_raw_parts_mut(start.cast(), HIT * n) };
        Self { words, n }
    }

    /// The hits behind the rays at `start`.
    ///
    /// # Safety
    /// `start` points to an `RTCRayHitN` of `n` lanes, of whose hits nothing else makes use for as long as the result is
    /// used.
    pub(super) unsafe fn behind(start: *mut c_void, n: usize) -> Self {
        // SAFETY: within the structure, by the caller's promise.
        let hits = unsafe { start.cast::<u32>().add(WHOLE_RAY * n) };
        // SAFETY: the caller's promise.
        unsafe { Self::at(hits.cast(), n) }
    }

    /// The hit of a lane, whose ray parameter stands in the ray, and the primitive.
    pub(super) fn get(&self, lane: usize, t: f32) -> (ShapeHit, u32) {
        let word = |component| self.words[component * self.n + lane];
        let number = |component| f32::from_bits(word(component));
        let ng = Vec3::new(number(0), number(1), number(2));
        (ShapeHit { t, u: number(U), v: number(V), ng }, word(PRIM))
    }

    /// Writes the hit of a lane, but for its ray parameter.
    pub(super) fn set(&mut self, lane: usize, hit: &ShapeHit, who: Identity) {
        let n = self.n;
        let mut set = |component: usize, word: u32| self.words[component * n + lane] = word;
        hit.ng.to_array().into_iter().enumerate().for_each(|(axis, value)| set(axis, value.to_bits()));
        set(U, hit.u.to_bits());
        set(V, hit.v.to_bits());
        set(PRIM, who.prim);
        set(GEOMETRY, who.geometry);
        set(INSTANCE, who.instance);
        set(INSTANCE_PRIM, who.instance_prim);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Packet;
    use crate::geometry::PlacementId;

    #[test]
    fn lanes_are_those_of_packets() {
        let mut packet = Packet::<8>::EMPTY;
        let mut ray = Ray::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0)).until(9.0).at_time(0.5);
        (ray.t_min, ray.mask) = (0.25, 77);
        packet.ray.set(5, &ray);
        let start: *mut c_void = (&raw mut packet).cast();
        // SAFETY: a packet has the layout of Embree's, and is used by nothing else.
        let mut rays = unsafe { RayLanes::at(start, 8) };
        // SAFETY: as above; the hits are not part of the rays.
        let mut hits = unsafe { HitLanes::behind(start, 8) };
        assert_eq!(rays.get(5), ray, "the ray");
        let hit = ShapeHit { t: 7.0, u: 0.1, v: 0.2, ng: Vec3::new(-1.0, -2.0, -3.0) };
        hits.set(5, &hit, Identity { prim: 11, geometry: 12, instance: 13, instance_prim: 0 });
        rays.set_t_max(5, hit.t);
        assert_eq!(hits.get(5, 7.0), (hit, 11), "read back");
        let found = packet.get_hit(5).expect("a hit");
        assert_eq!((found.t, found.u, found.v, found.ng), (hit.t, hit.u, hit.v, hit.ng), "numbers");
        assert_eq!((found.prim, found.placement), (11, PlacementId(13)), "identity");
        assert_eq!(packet.get_hit(4), None, "other lanes stay as they were");
    }
}
