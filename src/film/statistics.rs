//! Samples that were not finite: how many, and the first few, so that they can be traced again.

/// One sample of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SampleId {
    /// Row of its pixel in the whole picture.
    pub y: u32,
    /// Column of its pixel in the whole picture.
    pub x: u32,
    /// Which of the pixel's samples, from 0.
    pub index: u32,
}

/// Samples that were dropped because a value was NaN or infinite. They count as black.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NonFinite {
    count: u64,
    /// Sorted.
    first: Vec<SampleId>,
}

impl NonFinite {
    /// Of how many the place is kept.
    pub const KEPT: usize = 16;

    /// How many there were.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The first of them by row, column and index, [`NonFinite::KEPT`] at most: the same in whatever order they came.
    pub fn first(&self) -> &[SampleId] {
        &self.first
    }

    /// So many, the first of which are these.
    pub fn of(count: u64, first: impl IntoIterator<Item = SampleId>) -> Self {
        let mut all = Self { count, first: Vec::new() };
        first.into_iter().for_each(|sample| all.keep(sample));
        all
    }

    /// Counts one more.
    pub fn record(&mut self, sample: SampleId) {
        self.count += 1;
        self.keep(sample);
    }

    /// Counts those of another part of the picture as well.
    pub fn merge(&mut self, other: &Self) {
        self.count = self.count.saturating_add(other.count);
        other.first.iter().for_each(|&sample| self.keep(sample));
    }

    fn keep(&mut self, sample: SampleId) {
        let position = self.first.partition_point(|other| *other < sample);
        if position < Self::KEPT {
            self.first.insert(position, sample);
            self.first.truncate(Self::KEPT);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_are_kept_in_whatever_order_they_come() {
        let sample = |i: u32| SampleId { y: i / 7, x: i % 7, index: i % 3 };
        let (mut forward, mut backward, mut parts) =
            (NonFinite::default(), NonFinite::default(), NonFinite::default());
        let mut tiles = [NonFinite::default(), NonFinite::default()];
        for i in 0..100 {
            forward.record(sample(i));
            backward.record(sample(99 - i));
            tiles[(i % 2) as usize].record(sample(i));
        }
        tiles.iter().rev().for_each(|tile| parts.merge(tile));
        assert_eq!(forward.count(), 100, "all are counted");
        assert_eq!(forward.first().len(), NonFinite::KEPT, "some are kept");
        assert_eq!(forward.first()[0], sample(0), "the first");
        assert!(forward == backward && forward == parts, "{backward:?} {parts:?}");
    }
}
