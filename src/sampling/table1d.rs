//! Piecewise-constant distributions over [0, 1): choosing one of many by weight.
//!
//! Exact and monotone as `cumulative` says: probabilities are those with which entries are drawn, and no positive one is lost.
//!
//! Memory: 4 bytes per entry, and for the guide up to 16 KB or one byte per entry.

use super::cumulative::{Cumulative, Found, MAX_LEN};
use crate::math::lanes::{IntLanes, Lanes};

/// A distribution over [0, 1) that is constant on each of n equal cells.
#[derive(Clone, Debug)]
pub struct Table1d {
    cumulative: Cumulative,
    total: f64,
}

/// What was drawn from a [`Table1d`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// The entry.
    pub index: usize,
    /// The place in [0, 1), inside the cell of the entry.
    pub value: f32,
    /// The probability of the entry: discrete.
    pub probability: f32,
    /// The density at `value`, with respect to length over [0, 1).
    pub pdf: f32,
}

/// What was drawn over lanes.
#[derive(Clone, Copy, Debug)]
pub struct Picks<F: Lanes> {
    /// The entries.
    pub index: F::Int,
    /// The places within the cells, in [0, 1].
    pub within: F,
    /// The probabilities of the entries: discrete.
    pub probability: F,
}

/// Why weights make no distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TableError {
    /// No weight is positive: there is nothing to choose.
    #[error("no weight is positive")]
    Zero,
    /// A weight is negative, infinite or NaN.
    #[error("weight {0} is negative or not finite")]
    Weight(usize),
    /// More entries than random numbers can tell apart.
    #[error("more than {} weights", Table1d::MAX_LEN)]
    TooMany,
    /// A table of two dimensions whose weights do not fill its rows.
    #[error("the number of weights is not width times height")]
    Shape,
}

impl Table1d {
    /// The greatest number of entries.
    pub const MAX_LEN: usize = MAX_LEN;

    /// Bytes of the tables.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.cumulative.bytes()
    }

    /// The distribution with these weights.
    ///
    /// # Errors
    /// If no weight is positive, one is negative or not finite, or there are more than [`Table1d::MAX_LEN`].
    pub fn new(weights: &[f32]) -> Result<Self, TableError> {
        Self::of(weights.iter().map(|&w| f64::from(w)))
    }

    /// The same for weights in `f64`.
    pub(super) fn of(weights: impl ExactSizeIterator<Item = f64> + Clone) -> Result<Self, TableError> {
        let mut cumulative = Cumulative::with_capacity(weights.len(), 1)?;
        let total = cumulative.push(weights)?;
        if total > 0.0 { Ok(Self { cumulative, total }) } else { Err(TableError::Zero) }
    }

    /// The number of entries, at least 1.
    #[expect(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.cumulative.cells()
    }

    /// The sum of the weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// The entry, place and density for a number in [0, 1).
    pub fn sample(&self, u: f32) -> Pick {
        let Found { index, within, probability } = self.cumulative.find(0, u);
        let (index, cells) = (index as usize, self.len());
        Pick { index, value: place(index, within, cells), probability, pdf: probability * to_f32(cells) }
    }

    /// As [`Table1d::sample`], for numbers over lanes: multiples of 2^-24 in [0, 1).
    #[inline(always)]
    pub fn sample_lanes<F: Lanes>(&self, u: F) -> Picks<F> {
        let Found { index, within, probability } = self.cumulative.find(u.to_bits().splat(0), u);
        Picks { index, within, probability }
    }

    /// The probability of an entry: discrete; zero beyond the last.
    pub fn probability(&self, index: usize) -> f32 {
        self.cumulative.probability(0, index)
    }

    /// The density at a place of [0, 1), with respect to length; zero outside.
    pub fn pdf(&self, value: f32) -> f32 {
        cell_of(value, self.len()).map_or(0.0, |index| self.probability(index) * to_f32(self.len()))
    }
}

/// The place at a fraction of a cell. Rounding never moves it to another cell.
#[expect(clippy::cast_possible_truncation, reason = "rounding is provided for")]
#[expect(clippy::cast_precision_loss, reason = "indices are below 2^22")]
fn place(index: usize, within: f32, cells: usize) -> f32 {
    let value = ((index as f64 + f64::from(within)) / cells as f64) as f32;
    match cell_of(value, cells) {
        Some(cell) if cell == index => value,
        Some(cell) if cell < index => value.next_up(),
        _ => value.next_down(),
    }
}

/// The cell of a place, if it is inside [0, 1).
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside [0, cells)")]
#[expect(clippy::cast_precision_loss, reason = "cells are below 2^23")]
fn cell_of(value: f32, cells: usize) -> Option<usize> {
    (0.0..1.0).contains(&value).then(|| ((f64::from(value) * cells as f64) as usize).min(cells - 1))
}

/// A count as a factor.
#[expect(clippy::cast_precision_loss, reason = "counts are below 2^23")]
fn to_f32(n: usize) -> f32 {
    n as f32
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "exact by construction")]
mod tests {
    use super::super::cumulative::{UNIT, UNITS};
    use super::*;

    #[test]
    fn probabilities_are_weights_to_a_unit() {
        let weights = [1.0, 0.0, 2.0, 5.0, 0.0, 0.0, 8.0, 0.0];
        let table = Table1d::new(&weights).expect("positive");
        for (i, w) in weights.iter().enumerate() {
            let p = table.probability(i);
            // Four units are shared out beforehand, one is lost to rounding at either end.
            assert!((p - w / 16.0).abs() <= 6.0 * UNIT, "entry {i}: {p}");
            assert!((p > 0.0) == (*w > 0.0), "entry {i} with weight {w} has probability {p}");
        }
        assert!((table.total() - 16.0).abs() < 1e-12, "total {}", table.total());
        assert!(table.probability(8) == 0.0, "beyond the last");
    }

    #[test]
    fn each_unit_is_drawn_once_by_every_entry_that_owns_it() {
        let weights = [3.0, 0.0, 1e-30, 1.0, 1e-3];
        let table = Table1d::new(&weights).expect("positive");
        let mut counts = [0_u32; 5];
        for i in 0..UNITS {
            let pick = table.sample(i as f32 * UNIT);
            counts[pick.index] += 1;
            assert_eq!(cell_of(pick.value, 5), Some(pick.index), "value {} of unit {i}", pick.value);
        }
        for (i, n) in counts.into_iter().enumerate() {
            assert!(n as f32 * UNIT == table.probability(i), "entry {i}: {n} units");
        }
        assert_eq!((counts[1], counts[2]), (0, 1), "zero is never drawn, the dimmest is");
    }

    #[test]
    fn ends_and_single_entries() {
        let table = Table1d::new(&[0.0, 4.0, 0.0]).expect("positive");
        for u in [0.0, 0.5, 1.0 - f32::EPSILON / 2.0, 1.0, -1.0, f32::NAN] {
            let pick = table.sample(u);
            assert_eq!((pick.index, pick.probability), (1, 1.0), "u = {u}");
            assert!(pick.pdf == 3.0 && table.pdf(pick.value) == 3.0, "density at {}", pick.value);
        }
        assert!(table.pdf(1.0) == 0.0 && table.pdf(-0.1) == 0.0 && table.pdf(0.1) == 0.0, "outside");
        assert!(Table1d::new(&[7.0]).expect("positive").sample(0.25).probability == 1.0, "one entry");
    }

    #[test]
    fn weights_that_make_no_distribution_are_errors() {
        assert_eq!(Table1d::new(&[]).err(), Some(TableError::Zero), "empty");
        assert_eq!(Table1d::new(&[0.0; 3]).err(), Some(TableError::Zero), "zero");
        assert_eq!(Table1d::new(&[1.0, -1.0]).err(), Some(TableError::Weight(1)), "negative");
        assert_eq!(Table1d::new(&[f32::NAN]).err(), Some(TableError::Weight(0)), "NaN");
        assert_eq!(Table1d::new(&[1.0, 2.0, f32::INFINITY]).err(), Some(TableError::Weight(2)), "infinite");
        let many = vec![1.0; Table1d::MAX_LEN + 1];
        assert_eq!(Table1d::new(&many).err(), Some(TableError::TooMany), "one more than it holds");
    }
}
