//! Piecewise-constant distributions over a rectangle of cells: a row by its total, then a cell of the row.
//!
//! Made for environment images. Rows that are black are never drawn. As [`super::Table1d`], probabilities are those with
//! which cells are drawn, exactly, and no positive cell is lost.
//!
//! Memory: up to 5 bytes per cell and 13 more per row, and up to 16 KB. 2048 x 1024 cells take 9.5 MB.

use super::cumulative::{Cumulative, Found};
use super::table1d::{Table1d, TableError};
use crate::math::lanes::Lanes;

/// A distribution over width x height cells.
#[derive(Clone, Debug)]
pub struct Table2d {
    rows: Table1d,
    columns: Cumulative,
}

/// What was drawn over lanes from a [`Table2d`].
#[derive(Clone, Copy, Debug)]
pub struct Picks2d<F: Lanes> {
    /// The columns.
    pub column: F::Int,
    /// The rows.
    pub row: F::Int,
    /// The places within the cells, in [0, 1]^2: along the row, and downwards.
    pub within: [F; 2],
    /// The probabilities of the cells: discrete.
    pub probability: F,
}

impl Table2d {
    /// Bytes of the tables.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.rows.bytes() + self.columns.bytes()
    }

    /// The distribution with these weights, row after row.
    ///
    /// # Errors
    /// If the weights do not fill their rows, none is positive, one is negative or not finite, or width or height is more
    /// than [`Table1d::MAX_LEN`].
    pub fn new(weights: &[f32], width: usize) -> Result<Self, TableError> {
        if width == 0 || !weights.len().is_multiple_of(width) {
            return Err(TableError::Shape);
        }
        let height = weights.len() / width;
        let mut columns = Cumulative::with_capacity(width, height)?;
        let mut totals = Vec::with_capacity(height);
        for (y, row) in weights.chunks_exact(width).enumerate() {
            let total = columns.push(row.iter().map(|&w| f64::from(w)));
            totals.push(total.map_err(|error| match error {
                TableError::Weight(x) => TableError::Weight(y * width + x),
                other => other,
            })?);
        }
        Ok(Self { rows: Table1d::of(totals.iter().copied())?, columns })
    }

    /// Cells in a row.
    pub fn width(&self) -> usize {
        self.columns.cells()
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.rows.len()
    }

    /// The sum of the weights.
    pub fn total(&self) -> f64 {
        self.rows.total()
    }

    /// The cells for pairs of multiples of 2^-24 in [0, 1): the second chooses the row, the first the column.
    #[inline(always)]
    pub fn sample<F: Lanes>(&self, [u, v]: [F; 2]) -> Picks2d<F> {
        let row = self.rows.sample_lanes(v);
        let Found { index, within, probability } = self.columns.find(row.index, u);
        Picks2d {
            column: index,
            row: row.index,
            within: [within, row.within],
            probability: row.probability * probability,
        }
    }

    /// The probability of the cell at this column and row: discrete; zero outside.
    pub fn probability(&self, [column, row]: [usize; 2]) -> f32 {
        self.rows.probability(row) * self.columns.probability(row, column)
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "exact by construction")]
mod tests {
    use super::*;

    const WEIGHTS: [f32; 12] = [0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 9.0];

    #[test]
    fn probabilities_follow_the_weights() {
        let table = Table2d::new(&WEIGHTS, 4).expect("positive");
        assert_eq!((table.width(), table.height()), (4, 3), "size");
        for (i, w) in WEIGHTS.into_iter().enumerate() {
            let (p, expected) = (table.probability([i % 4, i / 4]), w / 16.0);
            assert!((p - expected).abs() <= 1e-6, "cell {i}: {p}");
        }
        assert!(table.probability([4, 0]) == 0.0 && table.probability([0, 3]) == 0.0, "outside");
        assert!((table.total() - 16.0).abs() < 1e-12, "total {}", table.total());
    }

    #[test]
    fn cells_are_drawn_with_their_probabilities() {
        let table = Table2d::new(&WEIGHTS, 4).expect("positive");
        let mut counts = [0_u32; 12];
        for i in 0..64 {
            for j in 0..64 {
                let pick = table.sample([(i as f32 + 0.5) / 64.0, (j as f32 + 0.5) / 64.0]);
                let cell = [pick.column as usize, pick.row as usize];
                assert!(pick.probability > 0.0 && pick.probability == table.probability(cell), "{pick:?}");
                assert!(pick.within.iter().all(|x| (0.0..=1.0).contains(x)), "{pick:?}");
                counts[cell[1] * 4 + cell[0]] += 1;
            }
        }
        for (i, w) in WEIGHTS.into_iter().enumerate() {
            let error = f64::from(counts[i]) - f64::from(w) * 256.0;
            // A cell of the 64 x 64 grid may fall to either side of each edge.
            assert!(error.abs() <= 130.0, "cell {i}: {} of {}", counts[i], w * 256.0);
            assert!((counts[i] > 0) == (w > 0.0), "cell {i}");
        }
    }

    #[test]
    fn weights_that_make_no_distribution_are_errors() {
        assert_eq!(Table2d::new(&[1.0; 5], 2).err(), Some(TableError::Shape), "ragged");
        assert_eq!(Table2d::new(&[], 0).err(), Some(TableError::Shape), "no width");
        assert_eq!(Table2d::new(&[0.0; 4], 2).err(), Some(TableError::Zero), "black");
        assert_eq!(Table2d::new(&[1.0, 1.0, 1.0, -1.0], 2).err(), Some(TableError::Weight(3)), "negative");
    }
}
