//! The headers' inline initialisers and cast constants, written by hand: bindgen passes over both.
//!
//! Zeroed memory is not a default here: a zero feature mask means "nothing in the scene", and geometry number 0 is a
//! valid one.

#![expect(non_snake_case, reason = "C's own names")]

use crate::{
    RTC_FEATURE_FLAG_ALL, RTC_RAY_QUERY_FLAG_INCOHERENT, RTCIntersectArguments, RTCOccludedArguments,
    RTCRayQueryContext,
};

/// The id that no geometry, primitive or instance has: "nothing was hit".
pub const RTC_INVALID_GEOMETRY_ID: u32 = u32::MAX;

/// Arguments of an intersection query: incoherent rays, every feature, no context, filter or callback.
#[must_use]
pub const fn rtcInitIntersectArguments() -> RTCIntersectArguments {
    RTCIntersectArguments {
        flags: RTC_RAY_QUERY_FLAG_INCOHERENT,
        feature_mask: RTC_FEATURE_FLAG_ALL,
        context: std::ptr::null_mut(),
        filter: None,
        intersect: None,
    }
}

/// Arguments of an occlusion query: incoherent rays, every feature, no context, filter or callback.
#[must_use]
pub const fn rtcInitOccludedArguments() -> RTCOccludedArguments {
    RTCOccludedArguments {
        flags: RTC_RAY_QUERY_FLAG_INCOHERENT,
        feature_mask: RTC_FEATURE_FLAG_ALL,
        context: std::ptr::null_mut(),
        filter: None,
        occluded: None,
    }
}

/// A query context with an empty stack of instances.
#[must_use]
pub const fn rtcInitRayQueryContext() -> RTCRayQueryContext {
    RTCRayQueryContext { instID: [RTC_INVALID_GEOMETRY_ID], instPrimID: [RTC_INVALID_GEOMETRY_ID] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_select_every_feature() {
        assert_eq!(rtcInitIntersectArguments().feature_mask, u32::MAX, "a zero bit would hide geometry");
        assert_eq!(rtcInitOccludedArguments().feature_mask, u32::MAX, "a zero bit would hide geometry");
        assert_eq!(rtcInitRayQueryContext().instID, [u32::MAX], "no instance is on the stack");
    }
}
