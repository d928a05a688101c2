//! Pictures in slices: each has some of the samples of every pixel.

use crate::render::schedule::PACKET;
use std::ops::Range;

/// One of several parts of the samples of every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slice {
    /// Which, from 0.
    pub index: u32,
    /// Of how many.
    pub of: u32,
}

impl Slice {
    /// Which of `spp` samples; none where there are fewer samples than slices. Whole packets, of the widest size that divides `spp` and
    /// leaves enough of them: then camera rays are traced in the same packets as in one go, and as fast.
    #[must_use]
    pub fn samples(self, spp: u32) -> Range<u32> {
        let sizes = [PACKET, PACKET / 2, PACKET / 4];
        let fits = |size: &u32| spp.is_multiple_of(*size) && spp / size >= self.of;
        let unit = sizes.into_iter().find(fits).unwrap_or(1);
        let begin = |index: u32| {
            let units = u64::from(spp / unit) * u64::from(index) / u64::from(self.of.max(1));
            u32::try_from(units).unwrap_or(u32::MAX).saturating_mul(unit).min(spp)
        };
        begin(self.index)..begin(self.index.saturating_add(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_follow_one_another() {
        for (spp, of) in [(64, 3), (64, 8), (10, 3), (7, 7), (1 << 31, 300), (48, 3), (1, 1)] {
            let mut end = 0;
            for index in 0..of {
                let samples = Slice { index, of }.samples(spp);
                assert!(samples.start == end && samples.end > end, "{samples:?}: {index} of {of}, {spp}");
                end = samples.end;
            }
            assert_eq!(end, spp, "all");
        }
        assert_eq!(Slice { index: 1, of: 3 }.samples(64), 16..32, "whole packets");
        assert!(Slice { index: 0, of: 3 }.samples(2).is_empty(), "too few");
    }
}
