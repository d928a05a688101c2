//! User geometry: shapes that are asked for their own hits while Embree walks its hierarchy.
//!
//! Boxes are asked for once, before Embree sees the shape. Embree asks several times in one build and trusts the answers
//! to agree: it counts the primitives that have a box, makes room for them, and asks again to fill it. A shape that
//! changed its mind would have it write beyond that room.

use super::guard::guarded;
use super::lanes::{HitLanes, Identity, RayLanes};
use crate::geometry::{HitFilter, Ray, Shape, ShapeHit};
use crate::math::Aabb;
use embree4_sys as sys;
use std::ffi::c_void;
use std::slice;
use std::sync::Arc;

/// A shape that is asked for its own hits by [`Shape::intersect`], with the boxes of its primitives. Cheap to clone.
#[derive(Clone, Debug)]
pub struct UserShape(Arc<Asked>);

/// What the callbacks read; behind an `Arc`, so that it stays where Embree's pointer says.
#[derive(Debug)]
struct Asked {
    shape: Shape,
    filter: Option<Arc<dyn HitFilter>>,
    boxes: Box<[Aabb]>,
}

impl UserShape {
    /// Asks a shape for the boxes of its primitives. One that is empty or not finite is never hit.
    ///
    /// # Panics
    /// If the shape does when asked.
    #[must_use]
    pub fn new(shape: Shape, filter: Option<Arc<dyn HitFilter>>) -> Self {
        let boxes = (0..).take(shape.primitive_count()).map(|prim| shape.primitive_bounds(prim)).collect();
        Self(Arc::new(Asked { shape, filter, boxes }))
    }

    /// Bytes of the boxes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.0.boxes)
    }

    /// How many primitives there are.
    pub(super) fn primitive_count(&self) -> u32 {
        u32::try_from(self.0.boxes.len()).expect("shapes count their primitives in 32 bits")
    }

    /// The same shape, of whose hits only those count that `filter` accepts.
    pub(super) fn filtered(&self, filter: Arc<dyn HitFilter>) -> Self {
        let Asked { shape, boxes, .. } = &*self.0;
        Self(Arc::new(Asked { shape: shape.clone(), filter: Some(filter), boxes: boxes.clone() }))
    }

    /// What to hand to Embree beside [`bounds`], [`intersect`] and [`occluded`]; good as long as `self` or a clone.
    pub(super) fn pointer(&self) -> *mut c_void {
        Arc::as_ptr(&self.0).cast_mut().cast()
    }
}

impl Asked {
    /// The nearest hit, if the ray can be traced at all: what Embree makes of a ray for an instance need not be.
    fn nearest(&self, prim: u32, ray: &Ray) -> Option<ShapeHit> {
        if !ray.is_traceable() {
            return None;
        }
        let hit = self.shape.intersect_filtered(prim, ray, self.filter.as_deref())?;
        (ray.t_min <= hit.t && hit.t <= ray.t_max).then_some(hit)
    }

    fn occludes(&self, prim: u32, ray: &Ray) -> bool {
        match (&self.shape, &self.filter) {
            (Shape::Surface(surface), None) => ray.is_traceable() && surface.occludes(prim, ray),
            _ => self.nearest(prim, ray).is_some(),
        }
    }
}

/// The callback that tells the box of a primitive.
///
/// # Safety
/// `args` points to what Embree hands to a bounds callback of a geometry whose user data is [`UserShape::pointer`].
pub(super) unsafe extern "C" fn bounds(args: *const sys::RTCBoundsFunctionArguments) {
    // SAFETY: the caller's promise.
    let args = unsafe { &*args };
    // SAFETY: the caller's promise.
    let asked = unsafe { &*args.geometryUserPtr.cast::<Asked>() };
    let own = asked.boxes.get(args.primID as usize).copied().unwrap_or(Aabb::EMPTY);
    // Embree leaves out primitives with a box like this.
    let is_sound = own.min.is_finite() && own.max.is_finite() && own.min.cmple(own.max).all();
    let Aabb { min, max } = if is_sound { own } else { Aabb::EMPTY };
    let out = sys::RTCBounds {
        lower_x: min.x,
        lower_y: min.y,
        lower_z: min.z,
        align0: 0.0,
        upper_x: max.x,
        upper_y: max.y,
        upper_z: max.z,
        align1: 0.0,
    };
    // SAFETY: Embree offers room for one box, aligned by its type.
    unsafe { args.bounds_o.write(out) };
}

/// The callback that finds the nearest hits of a primitive.
///
/// # Safety
/// `args` points to what Embree hands to an intersection callback of a geometry whose user data is
/// [`UserShape::pointer`].
pub(super) unsafe extern "C" fn intersect(args: *const sys::RTCIntersectFunctionNArguments) {
    // SAFETY: the caller's promise.
    let args = unsafe { &*args };
    // SAFETY: the caller's promise.
    let asked = unsafe { &*args.geometryUserPtr.cast::<Asked>() };
    // SAFETY: Embree always has a context, its own if the query brought none.
    let context = unsafe { &*args.context };
    let n = args.N as usize;
    // SAFETY: one flag per lane, for the callback's use.
    let valid = unsafe { slice::from_raw_parts_mut(args.valid, n) };
    // SAFETY: the rays of `n` lanes, for the callback's use.
    let mut rays = unsafe { RayLanes::at(args.rayhit.cast(), n) };
    // SAFETY: the hits behind them, of which `rays` is no part.
    let mut hits = unsafe { HitLanes::behind(args.rayhit.cast(), n) };
    let who = Identity {
        prim: args.primID,
        geometry: args.geomID,
        instance: context.instID[0],
        instance_prim: context.instPrimID[0],
    };
    guarded(|| {
        for (lane, flag) in valid.iter_mut().enumerate().filter(|(_, flag)| **flag != 0) {
            // Only lanes that are hit stay flagged.
            *flag = 0;
            if let Some(hit) = asked.nearest(who.prim, &rays.get(lane)) {
                hits.set(lane, &hit, who);
                rays.set_t_max(lane, hit.t);
                *flag = -1;
            }
        }
    });
}

/// The callback that tells whether a primitive is in the way.
///
/// # Safety
/// `args` points to what Embree hands to an occlusion callback of a geometry whose user data is
/// [`UserShape::pointer`].
pub(super) unsafe extern "C" fn occluded(args: *const sys::RTCOccludedFunctionNArguments) {
    // SAFETY: the caller's promise.
    let args = unsafe { &*args };
    // SAFETY: the caller's promise.
    let asked = unsafe { &*args.geometryUserPtr.cast::<Asked>() };
    let n = args.N as usize;
    // SAFETY: one flag per lane, for the callback's use.
    let valid = unsafe { slice::from_raw_parts_mut(args.valid, n) };
    // SAFETY: the rays of `n` lanes, for the callback's use.
    let mut rays = unsafe { RayLanes::at(args.ray.cast(), n) };
    guarded(|| {
        for (lane, flag) in valid.iter_mut().enumerate().filter(|(_, flag)| **flag != 0) {
            *flag = 0;
            if asked.occludes(args.primID, &rays.get(lane)) {
                rays.set_t_max(lane, f32::NEG_INFINITY);
                *flag = -1;
            }
        }
    });
}
