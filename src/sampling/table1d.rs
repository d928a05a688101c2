//! Piecewise-constant distributions over [0, 1): choosing one of many by weight.
//!
//! The cumulative distribution is summed in `f64` and stored in units of 2^-24, the step of the random numbers. So the
//! probability that is reported is the one with which an entry is drawn, exactly, and every entry of positive weight has
//! at least one unit: nothing that contributes is lost to rounding, however dim it is beside the rest.
//! Weights below one unit are therefore drawn more often than they ask for, which costs variance and no bias.
//!
//! Memory: 4 bytes per entry and 4 more. Drawing is a bisection.

use crate::math::lanes::{Compare, IntLanes, Isa, Lanes, Select, Wrapping};

/// 2^24.
pub(super) const UNITS: u32 = 1 << 24;
const UNIT: f32 = 1.0 / 16_777_216.0;

/// A distribution over [0, 1) that is constant on each of n equal cells.
#[derive(Clone, Debug)]
pub struct Table1d {
    cumulative: Vec<u32>,
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
    pub const MAX_LEN: usize = 1 << 22;

    /// The distribution with these weights.
    ///
    /// # Errors
    /// If no weight is positive, one is negative or not finite, or there are more than [`Table1d::MAX_LEN`].
    pub fn new(weights: &[f32]) -> Result<Self, TableError> {
        let mut cumulative = Vec::with_capacity(weights.len() + 1);
        let total = accumulate(weights.iter().map(|&w| f64::from(w)), &mut cumulative)?;
        if total > 0.0 { Ok(Self { cumulative, total }) } else { Err(TableError::Zero) }
    }

    /// The same for weights in `f64`.
    pub(super) fn from_f64(weights: &[f64]) -> Result<Self, TableError> {
        let mut cumulative = Vec::with_capacity(weights.len() + 1);
        let total = accumulate(weights.iter().copied(), &mut cumulative)?;
        if total > 0.0 { Ok(Self { cumulative, total }) } else { Err(TableError::Zero) }
    }

    /// The number of entries, at least 1.
    #[expect(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.cumulative.len() - 1
    }

    /// The sum of the weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// The entry, place and density for a number in [0, 1).
    pub fn sample(&self, u: f32) -> Pick {
        let (index, value) = draw(&self.cumulative, u);
        let probability = self.probability(index);
        Pick { index, value, probability, pdf: probability * to_f32(self.len()) }
    }

    /// As [`Table1d::sample`], for numbers over lanes: multiples of 2^-24 in [0, 1).
    #[inline(always)]
    pub fn sample_lanes<F: Lanes>(&self, u: F) -> Picks<F> {
        let table = &self.cumulative;
        let unit = (u * (1.0 / UNIT)).to_int();
        // The last whose lower end is not above, by halving steps.
        let (mut index, mut low) = (unit.splat(0), unit.splat(0));
        let last = u32::try_from(self.len() - 1).unwrap_or(u32::MAX);
        let mut step = last.checked_ilog2().map_or(0, |steps| 1 << steps);
        while step > 0 {
            let next = Wrapping::<u32>::wrapping_add(index, step);
            let end = unit.isa().gather_u32(table, next);
            let fits = Compare::<F::Int>::le(end, unit) & Compare::<u32>::le(next, last);
            index = F::Int::select(fits, next, index);
            low = F::Int::select(fits, end, low);
            step >>= 1;
        }
        let high = unit.isa().gather_u32(table, Wrapping::<u32>::wrapping_add(index, 1));
        let width = Wrapping::<F::Int>::wrapping_sub(high, low).signed_to_float();
        let offset = Wrapping::<F::Int>::wrapping_sub(unit, low).signed_to_float();
        Picks { index, within: (offset + 0.5) / width.max(1.0), probability: width * UNIT }
    }

    /// The probability of an entry: discrete; zero beyond the last.
    pub fn probability(&self, index: usize) -> f32 {
        probability(&self.cumulative, index)
    }

    /// The density at a place of [0, 1), with respect to length; zero outside.
    pub fn pdf(&self, value: f32) -> f32 {
        cell_of(value, self.len()).map_or(0.0, |index| self.probability(index) * to_f32(self.len()))
    }
}

/// Appends the cumulative distribution in units of 2^-24, from 0 to 2^24 (all zero where the total is), and gives the
/// total.
pub(super) fn accumulate(
    weights: impl ExactSizeIterator<Item = f64> + Clone,
    to: &mut Vec<u32>,
) -> Result<f64, TableError> {
    if weights.len() > Table1d::MAX_LEN {
        return Err(TableError::TooMany);
    }
    if let Some(bad) = weights.clone().position(|w| !(w >= 0.0 && w.is_finite())) {
        return Err(TableError::Weight(bad));
    }
    let total: f64 = weights.clone().sum();
    let positive = u32::try_from(weights.clone().filter(|&w| w > 0.0).count()).unwrap_or(UNITS);
    let shared = f64::from(UNITS - positive);
    // One unit for each that has passed, and its share of the rest.
    let (mut passed, mut sum) = (0, 0.0);
    to.push(0);
    for weight in weights {
        if weight > 0.0 {
            passed += 1;
            sum += weight;
        }
        to.push(if passed == positive && positive > 0 {
            UNITS
        } else {
            passed + floor(sum / total * shared)
        });
    }
    Ok(total)
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

/// Entry and place of the number `u` in a cumulative distribution.
pub(super) fn draw(cumulative: &[u32], u: f32) -> (usize, f32) {
    let cells = cumulative.len() - 1;
    let unit = floor(f64::from(u.clamp(0.0, 1.0)) * f64::from(UNITS));
    let unit = Ord::min(unit, UNITS - 1);
    // The last whose lower end is not above: it has a width, since an empty one shares its end with the next.
    let index = cumulative.partition_point(|&end| end <= unit).clamp(1, cells) - 1;
    let (low, high) = (cumulative[index], cumulative[index + 1]);
    // The centre of the unit, so that entries with few units are not drawn towards their lower end.
    let within = (f64::from(unit - low) + 0.5) / f64::from(Ord::max(high - low, 1));
    (index, place(index, within, cells))
}

/// The place at a fraction of a cell. Rounding never moves it to another cell.
#[expect(clippy::cast_possible_truncation, reason = "rounding is provided for")]
#[expect(clippy::cast_precision_loss, reason = "indices are below 2^22")]
fn place(index: usize, within: f64, cells: usize) -> f32 {
    let value = ((index as f64 + within) / cells as f64) as f32;
    match cell_of(value, cells) {
        Some(cell) if cell == index => value,
        Some(cell) if cell < index => value.next_up(),
        _ => value.next_down(),
    }
}

/// The probability of a cell.
pub(super) fn probability(cumulative: &[u32], index: usize) -> f32 {
    match cumulative.get(index..index + 2) {
        Some(&[low, high]) => (high - low) as f32 * UNIT,
        _ => 0.0,
    }
}

/// The cell of a place, if it is inside [0, 1).
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside [0, cells)")]
#[expect(clippy::cast_precision_loss, reason = "cells are below 2^23")]
pub(super) fn cell_of(value: f32, cells: usize) -> Option<usize> {
    (0.0..1.0).contains(&value).then(|| ((f64::from(value) * cells as f64) as usize).min(cells - 1))
}

/// A count as a factor.
#[expect(clippy::cast_precision_loss, reason = "counts are below 2^23")]
pub(super) fn to_f32(n: usize) -> f32 {
    n as f32
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "exact by construction")]
mod tests {
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
    }
}
