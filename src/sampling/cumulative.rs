//! Cumulative distributions of equally many entries each, and how an entry is found in one: what tables are made of.
//!
//! A distribution is summed in `f64` and stored in units of 2^-24, the step of the random numbers. So the
//! probability that is reported is the one with which an entry is drawn, exactly, and every entry of positive weight has
//! at least one unit: nothing that contributes is lost to rounding, however dim it is beside the rest.
//! Weights below one unit are therefore drawn more often than they ask for, which costs variance and no bias.
//!
//! An entry is found by a guide (Chen and Asau 1974, On Generating Random Variates from an Empirical Distribution): for equal parts of the
//! units, where their first falls. Between two of these there is mostly one entry or few, and a bisection among them; the map from numbers
//! to entries stays monotone, so what was stratified stays so.

use super::table1d::TableError;
use crate::math::lanes::{Compare, IntLanes, Isa, Lanes, MaskLanes, Select, Wrapping};

/// 2^24.
pub(super) const UNITS: u32 = 1 << 24;
pub(super) const UNIT: f32 = 1.0 / 16_777_216.0;

/// The greatest number of entries of a distribution.
pub(super) const MAX_LEN: usize = 1 << 22;

/// What a guide notes of an entry's number, and for as many more as do not fit beside it, or more.
const NUMBER: u32 = (1 << 22) - 1;
const MANY: u32 = u32::MAX >> 22;

/// Distributions with the same number of entries.
#[derive(Clone, Debug)]
pub(super) struct Cumulative {
    /// The lower end of each entry and the upper one of the last, for one distribution after the other. All zero where no weight is positive.
    ends: Vec<u32>,
    /// The entry in which each part begins, and above it how many more it meets, for one distribution after the other.
    guide: Vec<u32>,
    cells: u32,
    parts: u32,
    /// What brings a unit to its part.
    shift: u32,
}

/// An entry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found<F: Lanes> {
    pub(super) index: F::Int,
    /// How far the number is into the units of the entry, between 0 and 1; never an end but by rounding.
    pub(super) within: F,
    /// Discrete.
    pub(super) probability: F,
}

impl Cumulative {
    /// Bytes of the tables.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.ends[..]) + size_of_val(&self.guide[..])
    }

    /// No distribution yet of `cells` entries; room for `count`.
    pub(super) fn with_capacity(cells: usize, count: usize) -> Result<Self, TableError> {
        if cells > MAX_LEN {
            return Err(TableError::TooMany);
        }
        // Eight entries to a part: more parts were no faster. But the guide of one distribution may stay in the cache, and four
        // parts to an entry save most steps.
        let entries = cells.next_power_of_two();
        let cached = if count == 1 { Ord::min(4 * entries, 1 << 12) } else { 1 };
        let parts = Ord::max(entries / 8, cached);
        let whole = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Ok(Self {
            ends: Vec::with_capacity((cells + 1) * count),
            guide: Vec::with_capacity(parts * count),
            cells: whole(cells),
            parts: whole(parts),
            shift: UNITS.ilog2() - parts.ilog2(),
        })
    }

    /// Adds the distribution with these weights, as many as there are cells, and gives their sum.
    pub(super) fn push(&mut self, weights: impl Iterator<Item = f64> + Clone) -> Result<f64, TableError> {
        if let Some(bad) = weights.clone().position(|w| !(w >= 0.0 && w.is_finite())) {
            return Err(TableError::Weight(bad));
        }
        let first = self.ends.len();
        let total: f64 = weights.clone().sum();
        let positive = u32::try_from(weights.clone().filter(|&w| w > 0.0).count()).unwrap_or(UNITS);
        let shared = f64::from(UNITS - positive);
        // One unit for each that has passed, and its share of the rest.
        let (mut passed, mut sum) = (0, 0.0);
        self.ends.push(0);
        for weight in weights {
            if weight > 0.0 {
                passed += 1;
                sum += weight;
            }
            self.ends.push(if passed == positive && positive > 0 {
                UNITS
            } else {
                passed + floor(sum / total * shared)
            });
        }
        let ends = &self.ends[first..];
        // The last whose lower end is not above; an empty one shares its end with the next.
        let reach = |mut at: u32, unit: u32| {
            while at + 1 < self.cells && ends[at as usize + 1] <= unit {
                at += 1;
            }
            at
        };
        let mut at = reach(0, 0);
        for part in 0..self.parts {
            let end = (part + 1) << self.shift;
            let last = reach(at, end - 1);
            self.guide.push(at | Ord::min(last - at, MANY) << MAX_LEN.ilog2());
            at = reach(last, end);
        }
        Ok(total)
    }

    /// Entries of each distribution.
    pub(super) fn cells(&self) -> usize {
        self.cells as usize
    }

    /// The entries of the distributions `which` for numbers in [0, 1).
    #[inline(always)]
    pub(super) fn find<F: Lanes>(&self, which: F::Int, u: F) -> Found<F> {
        let isa = u.isa();
        let last = UNITS - 1;
        let unit = Compare::<u32>::min((u.clamp(0.0, 1.0) * (1.0 / UNIT)).to_int(), last);
        let part = Wrapping::<F::Int>::wrapping_add(
            Wrapping::<u32>::wrapping_mul(which, self.parts),
            unit >> self.shift,
        );
        let first = Wrapping::<u32>::wrapping_mul(which, self.cells + 1);
        let guide = isa.gather_u32(&self.guide, part);
        let (mut low, more) = (guide & NUMBER, guide >> MAX_LEN.ilog2());
        let mut high = Wrapping::<F::Int>::wrapping_add(low, more);
        high = F::Int::select(Compare::<u32>::eq(more, MANY), isa.splat_u32(self.cells - 1), high);
        let ends = &self.ends[..];
        while Compare::<F::Int>::lt(low, high).any() {
            // The upper middle: it goes up to there, or stays below.
            let sum = Wrapping::<F::Int>::wrapping_add(low, high);
            let middle = Wrapping::<u32>::wrapping_add(sum, 1) >> 1;
            let end = isa.gather_u32(ends, Wrapping::<F::Int>::wrapping_add(first, middle));
            let fits = Compare::<F::Int>::le(end, unit);
            low = F::Int::select(fits, middle, low);
            high = F::Int::select(fits, high, Wrapping::<u32>::wrapping_sub(middle, 1));
        }
        let at = Wrapping::<F::Int>::wrapping_add(first, low);
        let lower = isa.gather_u32(ends, at);
        let upper = isa.gather_u32(ends, Wrapping::<u32>::wrapping_add(at, 1));
        let width = Wrapping::<F::Int>::wrapping_sub(upper, lower).signed_to_float();
        let offset = Wrapping::<F::Int>::wrapping_sub(unit, lower).signed_to_float();
        // The centre of the unit, so that entries with few units are not drawn towards their lower end.
        Found { index: low, within: (offset + 0.5) / width.max(1.0), probability: width * UNIT }
    }

    /// The probability of an entry of a distribution: discrete; zero beyond the last.
    pub(super) fn probability(&self, which: usize, index: usize) -> f32 {
        let at = which * (self.cells() + 1) + index;
        match self.ends.get(at..at + 2) {
            Some(&[low, high]) if index < self.cells() => (high - low) as f32 * UNIT,
            _ => 0.0,
        }
    }
}

/// The integer part of a number in [0, 2^24]; zero for NaN.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates; the range is below 2^32"
)]
fn floor(x: f64) -> u32 {
    x as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights over many magnitudes, some of them zero, most of them in one entry.
    fn weights(cells: u32) -> Vec<f64> {
        let weight = |i: u32| {
            let random = i.wrapping_mul(2_654_435_769) >> 20;
            match random % 5 {
                0 => 0.0,
                k => f64::from(random) * 0.1_f64.powi(3 * i32::try_from(k).expect("small")),
            }
        };
        let mut all: Vec<_> = (0..cells).map(weight).collect();
        all[cells as usize / 3] = 1e5;
        all
    }

    #[test]
    fn the_guide_leads_to_the_entry_that_owns_the_unit() {
        for cells in [1, 2, 3, 7, 64, 65, 1000, 20_000] {
            let mut table = Cumulative::with_capacity(cells as usize, 2).expect("few");
            table.push((0..cells).map(|i| f64::from(i + 1))).expect("positive");
            table.push(weights(cells).into_iter()).expect("positive");
            for which in 0..2_u32 {
                let ends = &table.ends[which as usize * (cells as usize + 1)..][..=cells as usize];
                for unit in (0..UNITS).step_by(997).chain([1, UNITS - 1]) {
                    let found = table.find(which, unit as f32 * UNIT);
                    let at = found.index as usize;
                    assert!(ends[at] <= unit && unit < ends[at + 1], "{cells} cells: unit {unit} in {at}");
                    let probability = table.probability(which as usize, at);
                    assert!(found.probability.to_bits() == probability.to_bits(), "{cells} cells: {found:?}");
                    assert!((0.0..=1.0).contains(&found.within), "{cells} cells: {found:?}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_number_in_range_finds_the_nearest_entry() {
        let mut table = Cumulative::with_capacity(4, 1).expect("few");
        table.push([0.0, 1.0, 1.0, 0.0].into_iter()).expect("positive");
        for (u, entry) in [(-1.0, 1), (f32::NAN, 1), (1.0, 2), (9.0, 2)] {
            assert_eq!(table.find(0, u).index, entry, "u = {u}");
        }
    }
}
