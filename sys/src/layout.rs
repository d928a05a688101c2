//! What callers rely on, asserted at compile time: size, alignment and field offsets of the ray structures.
//!
//! A packet of `N` is a structure of arrays: field `k` begins at `4 N k`. The bindings are generated from whatever
//! headers the machine has, so an Embree with other structures fails here, not at the first ray.

use crate::{
    RTCBounds, RTCHit, RTCHit4, RTCHit8, RTCHit16, RTCRay, RTCRay4, RTCRay8, RTCRay16, RTCRayHit, RTCRayHit4,
    RTCRayHit8, RTCRayHit16,
};
use std::mem::{align_of, offset_of, size_of};

/// Asserts size and alignment, then each field's offset in units of one lane row (`4 N` bytes).
macro_rules! layout {
    ($type:ty, lanes $n:literal, size $size:literal, align $align:literal, [$($field:ident),+]) => {
        const _: () = {
            assert!(size_of::<$type>() == $size);
            assert!(align_of::<$type>() == $align);
            let mut row = 0;
            $(
                assert!(offset_of!($type, $field) == 4 * $n * row);
                row += 1;
            )+
            assert!(4 * $n * row <= $size);
        };
    };
}

/// Asserts that a ray-hit is a ray directly followed by its hit.
macro_rules! ray_hit {
    ($type:ty, $ray:ty, size $size:literal, align $align:literal) => {
        const _: () = {
            assert!(size_of::<$type>() == $size);
            assert!(align_of::<$type>() == $align);
            assert!(offset_of!($type, ray) == 0);
            assert!(offset_of!($type, hit) == size_of::<$ray>());
        };
    };
}

macro_rules! ray {
    ($type:ty, lanes $n:literal, size $size:literal, align $align:literal) => {
        layout!($type, lanes $n, size $size, align $align,
            [org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags]);
    };
}

macro_rules! hit {
    ($type:ty, lanes $n:literal, size $size:literal, align $align:literal) => {
        layout!($type, lanes $n, size $size, align $align,
            [Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID, instPrimID]);
    };
}

ray!(RTCRay, lanes 1, size 48, align 16);
ray!(RTCRay4, lanes 4, size 192, align 16);
ray!(RTCRay8, lanes 8, size 384, align 32);
ray!(RTCRay16, lanes 16, size 768, align 64);

hit!(RTCHit, lanes 1, size 48, align 16);
hit!(RTCHit4, lanes 4, size 144, align 16);
hit!(RTCHit8, lanes 8, size 288, align 32);
hit!(RTCHit16, lanes 16, size 576, align 64);

ray_hit!(RTCRayHit, RTCRay, size 96, align 16);
ray_hit!(RTCRayHit4, RTCRay4, size 336, align 16);
ray_hit!(RTCRayHit8, RTCRay8, size 672, align 32);
ray_hit!(RTCRayHit16, RTCRay16, size 1344, align 64);

layout!(RTCBounds, lanes 1, size 32, align 16,
    [lower_x, lower_y, lower_z, align0, upper_x, upper_y, upper_z, align1]);
