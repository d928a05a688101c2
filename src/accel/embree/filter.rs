//! Filters: the caller's code that decides which hits on a geometry of Embree's own kinds count.

use super::faces::Faces;
use super::guard::guarded;
use super::lanes::{HitLanes, RayLanes};
use crate::geometry::HitFilter;
use embree4_sys as sys;
use std::ffi::c_void;
use std::slice;
use std::sync::Arc;

/// What the callback reads; kept behind an `Arc`, so that it stays where Embree's pointer says.
#[derive(Debug)]
pub(super) struct Sieve {
    filter: Arc<dyn HitFilter>,
    /// Where Embree's primitives are faces: filters know triangles only.
    faces: Option<Faces>,
}

impl Sieve {
    pub(super) fn new(filter: Arc<dyn HitFilter>, faces: Option<Faces>) -> Arc<Self> {
        Arc::new(Self { filter, faces })
    }

    /// What to hand to Embree beside [`sift`]; good as long as `self`.
    pub(super) fn pointer(self: &Arc<Self>) -> *mut c_void {
        Arc::as_ptr(self).cast_mut().cast()
    }
}

/// The callback that passes over hits which do not count, for the nearest hit and for any.
///
/// # Safety
/// `args` points to what Embree hands to a filter callback of a geometry whose user data is [`Sieve::pointer`].
pub(super) unsafe extern "C" fn sift(args: *const sys::RTCFilterFunctionNArguments) {
    // SAFETY: the caller's promise.
    let args = unsafe { &*args };
    // SAFETY: the caller's promise.
    let sieve = unsafe { &*args.geometryUserPtr.cast::<Sieve>() };
    let n = args.N as usize;
    // SAFETY: one flag per lane, for the callback's use.
    let valid = unsafe { slice::from_raw_parts_mut(args.valid, n) };
    // SAFETY: the rays of `n` lanes, for the callback's use.
    let rays = unsafe { RayLanes::at(args.ray.cast(), n) };
    // SAFETY: the hits of `n` lanes, for the callback's use.
    let hits = unsafe { HitLanes::at(args.hit.cast(), n) };
    guarded(|| {
        for (lane, flag) in valid.iter_mut().enumerate().filter(|(_, flag)| **flag != 0) {
            // Embree has ended the ray at the hit.
            let ray = rays.get(lane);
            let (mut hit, mut prim) = hits.get(lane, ray.t_max);
            if let Some(faces) = &sieve.faces {
                (prim, [hit.u, hit.v]) = faces.triangle(prim, [hit.u, hit.v]);
            }
            if !sieve.filter.accepts(&ray, &hit, prim) {
                *flag = 0;
            }
        }
    });
}
