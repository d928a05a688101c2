//! Points of the plane by place.

use glam::DVec2;

/// Which cell a corner is in, and its place among the corners of that cell.
#[derive(Clone, Copy, Debug)]
struct Slot {
    cell: usize,
    /// Where in the list it is; absent while it is not kept.
    at: Option<usize>,
}

/// Some of a set of points, found by place; square cells that hold about one point each if those kept are spread evenly.
#[derive(Debug, Default)]
pub(super) struct Grid {
    min: DVec2,
    per_cell: DVec2,
    /// How many points are kept.
    kept: usize,
    /// Cells along each axis.
    cells: [usize; 2],
    /// Where the points of each cell start in the list, and how many are kept.
    spans: Vec<[usize; 2]>,
    list: Vec<usize>,
    slots: Vec<Slot>,
}

impl Grid {
    /// Makes room for points, about `expected` of which will be kept, and keeps none.
    pub(super) fn start(&mut self, points: &[DVec2], expected: usize) {
        let min = points.iter().fold(DVec2::INFINITY, |min, p| min.min(*p));
        let max = points.iter().fold(DVec2::NEG_INFINITY, |max, p| max.max(*p));
        let extent = (max - min).max(DVec2::splat(f64::MIN_POSITIVE));
        #[expect(clippy::cast_precision_loss, reason = "a number of cells need not be exact")]
        let side = extent.x.sqrt() * extent.y.sqrt() / (expected as f64).sqrt();
        let along = |extent: f64| cell((extent / side).ceil(), expected).max(1);
        self.min = min;
        self.cells = [along(extent.x), along(extent.y)];
        #[expect(clippy::cast_precision_loss, reason = "at most as many as points")]
        let counts = DVec2::new(self.cells[0] as f64, self.cells[1] as f64);
        self.per_cell = counts / extent;
        self.fill(points);
    }

    fn fill(&mut self, points: &[DVec2]) {
        self.spans.clear();
        self.spans.resize(self.cells[0] * self.cells[1], [0; 2]);
        self.slots.clear();
        for p in points {
            let [x, y] = self.cell_of(*p);
            let cell = y * self.cells[0] + x;
            self.spans[cell][0] += 1;
            self.slots.push(Slot { cell, at: None });
        }
        let mut start = 0;
        for span in &mut self.spans {
            start += std::mem::replace(&mut span[0], start);
        }
        self.kept = 0;
        self.list.clear();
        self.list.resize(points.len(), 0);
    }

    fn cell_of(&self, p: DVec2) -> [usize; 2] {
        let at = (p - self.min) * self.per_cell;
        [cell(at.x, self.cells[0] - 1), cell(at.y, self.cells[1] - 1)]
    }

    /// Keeps a point or not.
    pub(super) fn keep(&mut self, i: usize, keep: bool) {
        let Slot { cell, at } = self.slots[i];
        let [start, kept] = &mut self.spans[cell];
        match at {
            None if keep => {
                self.list[*start + *kept] = i;
                self.slots[i].at = Some(*start + *kept);
                *kept += 1;
                self.kept += 1;
            }
            Some(at) if !keep => {
                *kept -= 1;
                self.kept -= 1;
                let last = self.list[*start + *kept];
                self.list[at] = last;
                self.slots[last].at = Some(at);
                self.slots[i].at = None;
            }
            _ => {}
        }
    }

    /// Whether `holds` is true of any point kept in the cells of a box; others of these cells are asked for too.
    pub(super) fn any(&self, [min, max]: [DVec2; 2], mut holds: impl FnMut(usize) -> bool) -> bool {
        if self.kept == 0 {
            return false;
        }
        let ([x0, y0], [x1, y1]) = (self.cell_of(min), self.cell_of(max));
        (y0..=y1).any(|y| {
            self.spans[y * self.cells[0] + x0..=y * self.cells[0] + x1]
                .iter()
                .any(|&[start, kept]| self.list[start..start + kept].iter().any(|&i| holds(i)))
        })
    }
}

/// A number of cells, at most `most`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "limited before it is cast"
)]
fn cell(at: f64, most: usize) -> usize {
    at.clamp(0.0, most as f64) as usize
}
