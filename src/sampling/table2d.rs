//! Piecewise-constant distributions over the unit square: a row by its total, then a cell of the row.
//!
//! Made for environment images. Rows that are black are never drawn. As [`super::Table1d`], densities are those with
//! which cells are drawn, exactly, and no positive cell is lost.
//!
//! Memory: 4 bytes per cell, and 8 more per row. 2048 x 1024 cells take 8.4 MB.

use super::table1d::{Table1d, TableError, accumulate, cell_of, draw, probability, to_f32};

/// A distribution over [0, 1)^2 that is constant on each of width x height equal cells; u runs along a row.
#[derive(Clone, Debug)]
pub struct Table2d {
    rows: Table1d,
    /// The cumulative distribution of each row, `width + 1` numbers; all zero for a black row.
    cumulative: Vec<u32>,
    width: usize,
}

/// What was drawn from a [`Table2d`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick2d {
    /// The place in [0, 1)^2.
    pub uv: [f32; 2],
    /// Column and row of its cell.
    pub cell: [usize; 2],
    /// The density at `uv`, with respect to area over [0, 1)^2.
    pub pdf: f32,
}

impl Table2d {
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
        let mut cumulative = Vec::with_capacity(height * (width + 1));
        let mut totals = Vec::with_capacity(height);
        for (y, row) in weights.chunks_exact(width).enumerate() {
            let total = accumulate(row.iter().map(|&w| f64::from(w)), &mut cumulative);
            totals.push(total.map_err(|error| match error {
                TableError::Weight(x) => TableError::Weight(y * width + x),
                other => other,
            })?);
        }
        Ok(Self { rows: Table1d::from_f64(&totals)?, cumulative, width })
    }

    /// Cells in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.rows.len()
    }

    /// The sum of the weights.
    pub fn total(&self) -> f64 {
        self.rows.total()
    }

    /// The place and density for a pair in [0, 1)^2.
    pub fn sample(&self, [u, v]: [f32; 2]) -> Pick2d {
        let row = self.rows.sample(v);
        let cumulative = self.row(row.index);
        let (column, value) = draw(cumulative, u);
        let pdf = row.pdf * probability(cumulative, column) * to_f32(self.width);
        Pick2d { uv: [value, row.value], cell: [column, row.index], pdf }
    }

    /// The density at a place of the unit square, with respect to area; zero outside.
    pub fn pdf(&self, [u, v]: [f32; 2]) -> f32 {
        let (Some(column), Some(row)) = (cell_of(u, self.width), cell_of(v, self.height())) else {
            return 0.0;
        };
        let rows = self.rows.probability(row) * to_f32(self.height());
        rows * probability(self.row(row), column) * to_f32(self.width)
    }

    /// The probability of the cell at this column and row: discrete; zero outside.
    pub fn probability(&self, [column, row]: [usize; 2]) -> f32 {
        if column >= self.width || row >= self.height() {
            return 0.0;
        }
        self.rows.probability(row) * probability(self.row(row), column)
    }

    fn row(&self, y: usize) -> &[u32] {
        &self.cumulative[y * (self.width + 1)..][..=self.width]
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "exact by construction")]
mod tests {
    use super::*;

    const WEIGHTS: [f32; 12] = [0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 9.0];

    #[test]
    fn densities_follow_the_weights() {
        let table = Table2d::new(&WEIGHTS, 4).expect("positive");
        assert_eq!((table.width(), table.height()), (4, 3), "size");
        for (i, w) in WEIGHTS.into_iter().enumerate() {
            let uv = [((i % 4) as f32 + 0.5) / 4.0, ((i / 4) as f32 + 0.5) / 3.0];
            let expected = w / 16.0 * 12.0;
            assert!(
                (table.pdf(uv) - expected).abs() <= 1e-6 * expected.max(1.0),
                "cell {i}: {}",
                table.pdf(uv)
            );
        }
        assert!(table.pdf([1.0, 0.5]) == 0.0 && table.pdf([0.5, -0.1]) == 0.0, "outside");
    }

    #[test]
    fn samples_carry_the_density_of_their_place() {
        let table = Table2d::new(&WEIGHTS, 4).expect("positive");
        let mut counts = [0_u32; 12];
        for i in 0..64 {
            for j in 0..64 {
                let pick = table.sample([(i as f32 + 0.5) / 64.0, (j as f32 + 0.5) / 64.0]);
                assert!(pick.pdf > 0.0 && pick.pdf == table.pdf(pick.uv), "{pick:?}");
                counts[pick.cell[1] * 4 + pick.cell[0]] += 1;
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
