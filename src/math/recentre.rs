//! Where to count coordinates from, where single precision would be too coarse for them.

use glam::DVec3;

/// Distance from the origin, in sizes of what is there, from which on coordinates are counted from elsewhere. A coordinate is
/// then off by up to 64 / 2^24 of the size, 4 in a million: a two-hundredth of a pixel in a picture of a thousand rows. Greater
/// lets forms tremble; smaller moves scenes that need no moving.
pub const FAR: f64 = 64.0;

/// Where to count from about what is `size` large and lies about `middle`: zero unless that is [`FAR`] from zero on an axis.
#[must_use]
pub fn if_far(middle: DVec3, size: f64) -> DVec3 {
    if size > 0.0 && middle.abs().max_element() > FAR * size { beside(middle, size) } else { DVec3::ZERO }
}

/// A point within half a `size` of `middle` on each axis, whose coordinates are multiples of a power of two: numbers with few
/// digits stay numbers with few digits when they are counted from there.
#[must_use]
pub fn beside(middle: DVec3, size: f64) -> DVec3 {
    let grid = size.log2().floor().exp2();
    let rounded = (middle / grid).round() * grid;
    // Nothing is that small beside its distance, or it has no size at all.
    if rounded.is_finite() { rounded } else { middle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_near_stays_and_what_is_far_is_brought_near() {
        for size in [1e-6, 1.0, 5.0, 1e6] {
            for ratio in [0.0, 1.0, 63.0] {
                assert_eq!(
                    if_far(DVec3::new(ratio, -ratio, 1.0) * size, size),
                    DVec3::ZERO,
                    "{ratio} {size}"
                );
            }
            for ratio in [65.0, 1e3, 1e9] {
                let middle = DVec3::new(ratio, -1.3, 0.0) * size;
                let origin = if_far(middle, size);
                let off = (origin - middle).abs().max_element();
                assert!(off <= 0.5 * size, "{ratio} of {size}: {off} away");
                let digits = origin / size.log2().floor().exp2();
                assert_eq!(digits, digits.round(), "{ratio} of {size}: a multiple of a power of two");
            }
        }
    }

    #[test]
    fn no_size_is_no_reason() {
        for size in [0.0, -1.0, f64::NAN] {
            assert_eq!(if_far(DVec3::ONE * 1e6, size), DVec3::ZERO, "size {size}");
        }
        for size in [0.0, f64::from_bits(1), f64::NAN] {
            assert_eq!(beside(DVec3::ONE * 1e6, size), DVec3::ONE * 1e6, "size {size}");
        }
    }
}
