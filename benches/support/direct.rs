//! The queries as a C programmer would write them, straight through `embree4_sys`: what safety is measured against.
//!
//! Nothing is checked: the rays are known to be sound.

#![expect(unsafe_code, reason = "the cost of not writing this is measured")]

use embree4_sys as sys;
use specula::accel::RayPacket;
use specula::geometry::Ray;
use std::ptr::null_mut;

/// A scene by its library handle.
#[derive(Clone, Copy)]
pub(crate) struct Direct(sys::RTCScene);

/// The four kinds of packet calls share everything but their names and types.
macro_rules! packets {
    ($intersect:ident, $occluded:ident, $n:literal, $ray:ident, $both:ident, $query:ident, $query_occluded:ident) => {
        pub(crate) fn $intersect(self, packets: &[RayPacket<$n>], coherent: bool) -> u64 {
            let mut arguments = sys::rtcInitIntersectArguments();
            arguments.flags = flags(coherent);
            let valid = Valid([-1; $n]);
            let mut sum = 0;
            for packet in packets {
                let from: *const RayPacket<$n> = packet;
                // SAFETY: the layouts agree; the hit is numbers only, for which zero is good.
                let mut query: sys::$both = unsafe { std::mem::zeroed() };
                // SAFETY: as above.
                query.ray = unsafe { from.cast::<sys::$ray>().read() };
                query.hit.geomID = [sys::RTC_INVALID_GEOMETRY_ID; $n];
                query.hit.instID = [[sys::RTC_INVALID_GEOMETRY_ID; $n]];
                // SAFETY: the scene is committed, the structures are aligned by their types.
                unsafe { sys::$query(valid.0.as_ptr(), self.0, &raw mut query, &raw mut arguments) };
                sum += sum_of(&query.ray.tfar, &query.hit.geomID);
            }
            sum
        }

        pub(crate) fn $occluded(self, packets: &[RayPacket<$n>], coherent: bool) -> u64 {
            let mut arguments = sys::rtcInitOccludedArguments();
            arguments.flags = flags(coherent);
            let valid = Valid([-1; $n]);
            let mut sum = 0;
            for packet in packets {
                let from: *const RayPacket<$n> = packet;
                // SAFETY: the layouts agree.
                let mut query = unsafe { from.cast::<sys::$ray>().read() };
                // SAFETY: the scene is committed, the structures are aligned by their types.
                unsafe { sys::$query_occluded(valid.0.as_ptr(), self.0, &raw mut query, &raw mut arguments) };
                sum += query.tfar.iter().filter(|&&t| t < 0.0).count() as u64;
            }
            sum
        }
    };
}

/// Any number of rays, one array per component, cut into packets of `$n`.
macro_rules! stream {
    ($name:ident, $n:literal, $both:ident, $query:ident) => {
        fn $name(self, stream: &mut DirectStream, coherent: bool) -> u64 {
            let mut arguments = sys::rtcInitIntersectArguments();
            arguments.flags = flags(coherent);
            let valid = Valid([-1; $n]);
            // SAFETY: numbers only, for which zero is good.
            let mut query: sys::$both = unsafe { std::mem::zeroed() };
            for start in (0..stream.mask.len()).step_by($n) {
                let of = start..start + $n;
                let ray = &mut query.ray;
                let [o_x, o_y, o_z, t_min, d_x, d_y, d_z, time, t_max] = &stream.rays;
                ray.org_x.copy_from_slice(&o_x[of.clone()]);
                ray.org_y.copy_from_slice(&o_y[of.clone()]);
                ray.org_z.copy_from_slice(&o_z[of.clone()]);
                ray.tnear.copy_from_slice(&t_min[of.clone()]);
                ray.dir_x.copy_from_slice(&d_x[of.clone()]);
                ray.dir_y.copy_from_slice(&d_y[of.clone()]);
                ray.dir_z.copy_from_slice(&d_z[of.clone()]);
                ray.time.copy_from_slice(&time[of.clone()]);
                ray.tfar.copy_from_slice(&t_max[of.clone()]);
                ray.mask.copy_from_slice(&stream.mask[of.clone()]);
                query.hit.geomID = [sys::RTC_INVALID_GEOMETRY_ID; $n];
                query.hit.instID = [[sys::RTC_INVALID_GEOMETRY_ID; $n]];
                // SAFETY: the scene is committed, the structures are aligned by their types.
                unsafe { sys::$query(valid.0.as_ptr(), self.0, &raw mut query, &raw mut arguments) };
                let [t, u, v, ng_x, ng_y, ng_z] = &mut stream.hits;
                t[of.clone()].copy_from_slice(&query.ray.tfar);
                u[of.clone()].copy_from_slice(&query.hit.u);
                v[of.clone()].copy_from_slice(&query.hit.v);
                ng_x[of.clone()].copy_from_slice(&query.hit.Ng_x);
                ng_y[of.clone()].copy_from_slice(&query.hit.Ng_y);
                ng_z[of.clone()].copy_from_slice(&query.hit.Ng_z);
                stream.prim[of.clone()].copy_from_slice(&query.hit.primID);
                stream.instance[of.clone()].copy_from_slice(&query.hit.instID[0]);
                stream.geometry[of].copy_from_slice(&query.hit.geomID);
            }
            stream.geometry.iter().filter(|&&geometry| geometry != sys::RTC_INVALID_GEOMETRY_ID).count()
                as u64
        }
    };
}

/// Rays and hits, one array per component.
pub(crate) struct DirectStream {
    rays: [Vec<f32>; 9],
    mask: Vec<u32>,
    hits: [Vec<f32>; 6],
    prim: Vec<u32>,
    geometry: Vec<u32>,
    instance: Vec<u32>,
}

impl DirectStream {
    pub(crate) fn new(rays: &[Ray]) -> Self {
        let component = |get: fn(&Ray) -> f32| rays.iter().map(get).collect();
        Self {
            rays: [
                component(|r| r.o.x),
                component(|r| r.o.y),
                component(|r| r.o.z),
                component(|r| r.t_min),
                component(|r| r.d.x),
                component(|r| r.d.y),
                component(|r| r.d.z),
                component(|r| r.time),
                component(|r| r.t_max),
            ],
            mask: rays.iter().map(|r| r.mask).collect(),
            hits: std::array::from_fn(|_| vec![0.0; rays.len()]),
            prim: vec![0; rays.len()],
            geometry: vec![0; rays.len()],
            instance: vec![0; rays.len()],
        }
    }
}

#[repr(align(64))]
struct Valid<const N: usize>([i32; N]);

impl Direct {
    /// The scene that `specula::accel::embree::Scene::address` names.
    pub(crate) fn new(address: usize) -> Self {
        Self(std::ptr::with_exposed_provenance_mut(address))
    }

    pub(crate) fn intersect(self, rays: &[Ray]) -> u64 {
        let mut sum = 0;
        for ray in rays {
            let from: *const Ray = ray;
            // SAFETY: the hit is numbers only, for which zero is good.
            let mut query: sys::RTCRayHit = unsafe { std::mem::zeroed() };
            // SAFETY: the layouts agree.
            query.ray = unsafe { from.cast::<sys::RTCRay>().read() };
            query.hit.geomID = sys::RTC_INVALID_GEOMETRY_ID;
            query.hit.instID = [sys::RTC_INVALID_GEOMETRY_ID];
            // SAFETY: the scene is committed, the structure is aligned by its type.
            unsafe { sys::rtcIntersect1(self.0, &raw mut query, null_mut()) };
            if query.hit.geomID != sys::RTC_INVALID_GEOMETRY_ID {
                sum += u64::from(query.ray.tfar.to_bits() ^ query.hit.primID);
            }
        }
        sum
    }

    pub(crate) fn occluded(self, rays: &[Ray]) -> u64 {
        let mut sum = 0;
        for ray in rays {
            let from: *const Ray = ray;
            // SAFETY: the layouts agree.
            let mut query = unsafe { from.cast::<sys::RTCRay>().read() };
            // SAFETY: the scene is committed, the structure is aligned by its type.
            unsafe { sys::rtcOccluded1(self.0, &raw mut query, null_mut()) };
            sum += u64::from(query.tfar < 0.0);
        }
        sum
    }

    /// All of a stream, in packets of the width given.
    pub(crate) fn stream(self, stream: &mut DirectStream, width: usize, coherent: bool) -> u64 {
        match width {
            16 => self.stream16(stream, coherent),
            8 => self.stream8(stream, coherent),
            _ => self.stream4(stream, coherent),
        }
    }

    stream!(stream4, 4, RTCRayHit4, rtcIntersect4);
    stream!(stream8, 8, RTCRayHit8, rtcIntersect8);
    stream!(stream16, 16, RTCRayHit16, rtcIntersect16);
    packets!(intersect4, occluded4, 4, RTCRay4, RTCRayHit4, rtcIntersect4, rtcOccluded4);
    packets!(intersect8, occluded8, 8, RTCRay8, RTCRayHit8, rtcIntersect8, rtcOccluded8);
    packets!(intersect16, occluded16, 16, RTCRay16, RTCRayHit16, rtcIntersect16, rtcOccluded16);
}

fn flags(coherent: bool) -> sys::RTCRayQueryFlags {
    if coherent { sys::RTC_RAY_QUERY_FLAG_COHERENT } else { sys::RTC_RAY_QUERY_FLAG_INCOHERENT }
}

/// Something of every lane, so that none can be left out.
pub(crate) fn sum_of<const N: usize>(t: &[f32; N], geometry: &[u32; N]) -> u64 {
    let lanes = t.iter().zip(geometry);
    lanes.filter(|(_, geometry)| **geometry != u32::MAX).fold(0, |sum, (t, _)| sum + u64::from(t.to_bits()))
}
