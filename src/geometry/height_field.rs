//! Heights over a rectangle.

use crate::geometry::{Mesh, MeshError};
use glam::{Vec2, Vec3};

/// Heights along +y over a grid in the plane of x and z, as triangles: `ARCHITECTURE.md` has the measurement against a
/// traversal of the grid itself.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    columns: u32,
    rows: u32,
    heights: Vec<f32>,
}

/// Why heights were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HeightFieldError {
    /// Fewer than two columns or rows span no area.
    #[error("{columns} by {rows} heights span no area: two columns and two rows are the least")]
    TooFew {
        /// Along x.
        columns: u32,
        /// Along z.
        rows: u32,
    },
    /// Another number of heights than columns times rows.
    #[error("{found} heights for {columns} columns and {rows} rows")]
    Length {
        /// Along x.
        columns: u32,
        /// Along z.
        rows: u32,
        /// How many there are.
        found: usize,
    },
    /// A height that is not a number or infinite.
    #[error("the height in column {column} of row {row} is not finite")]
    NotFinite {
        /// From 0.
        column: u32,
        /// From 0.
        row: u32,
    },
}

impl HeightField {
    /// Heights by row, the first row at the least z, each from the least x on: a picture seen from above. All finite, two
    /// columns and two rows at least.
    pub fn new(columns: u32, rows: u32, heights: Vec<f32>) -> Result<Self, HeightFieldError> {
        if columns < 2 || rows < 2 {
            return Err(HeightFieldError::TooFew { columns, rows });
        }
        if heights.len() != columns as usize * rows as usize {
            return Err(HeightFieldError::Length { columns, rows, found: heights.len() });
        }
        if let Some(bad) = heights.iter().position(|height| !height.is_finite()) {
            let (row, column) = (bad / columns as usize, bad % columns as usize);
            let [row, column] = [row, column].map(super::count);
            return Err(HeightFieldError::NotFinite { column, row });
        }
        Ok(Self { columns, rows, heights })
    }

    /// Columns and rows.
    #[must_use]
    pub fn counts(&self) -> [u32; 2] {
        [self.columns, self.rows]
    }

    /// The height in a column of a row.
    ///
    /// # Panics
    /// Outside of the grid.
    #[must_use]
    pub fn height(&self, column: u32, row: u32) -> f32 {
        assert!(column < self.columns && row < self.rows, "({column}, {row}) lies outside of the grid");
        self.heights[row as usize * self.columns as usize + column as usize]
    }

    /// The surface over a rectangle about `center` with edges `size` along x and z, heights counted from `center`; outside
    /// is above. Two triangles per cell, divided along the diagonal whose ends differ less in height; surface parameters
    /// run from 0 to 1, u along +x, v along -z, as on a picture. Smooth normals are those of central differences. Fails where
    /// a corner is beyond [`Mesh::MAX_COORDINATE`].
    pub fn mesh(&self, center: Vec3, size: Vec2, smooth: bool) -> Result<Mesh, MeshError> {
        let nodes = || (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| [column, row]));
        let parameters = |[column, row]: [u32; 2]| {
            Vec2::new(column as f32 / (self.columns - 1) as f32, row as f32 / (self.rows - 1) as f32)
        };
        let position = |node: [u32; 2]| {
            let flat = (parameters(node) - 0.5) * size;
            center + Vec3::new(flat.x, self.height(node[0], node[1]), flat.y)
        };
        let triangles: Vec<[u32; 3]> = self.triangles();
        let uvs = nodes().map(|node| Vec2::new(parameters(node).x, 1.0 - parameters(node).y)).collect();
        let mesh = Mesh::new(nodes().map(position).collect(), triangles)?.with_uvs(uvs)?;
        if !smooth {
            return Ok(mesh);
        }
        mesh.with_normals(nodes().map(|[column, row]| self.normal(column, row, size)).collect())
    }

    fn triangles(&self) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity((self.columns as usize - 1) * (self.rows as usize - 1) * 2);
        for row in 0..self.rows - 1 {
            for column in 0..self.columns - 1 {
                let first = row * self.columns + column;
                // Counter-clockwise seen from above, where z points down the picture.
                let cell = [first, first + self.columns, first + self.columns + 1, first + 1];
                let [a, b, c, d] = cell.map(|node| self.heights[node as usize]);
                let [a, b, c, d] =
                    if (a - c).abs() <= (b - d).abs() { cell } else { [cell[1], cell[2], cell[3], cell[0]] };
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        triangles
    }

    /// The normal at a node: central differences, one-sided on the border.
    fn normal(&self, column: u32, row: u32, size: Vec2) -> Vec3 {
        let slope = |low: f32, high: f32, nodes: u32, count: u32, size: f32| {
            (high - low) * (count - 1) as f32 / (nodes as f32 * size)
        };
        let (left, right) = (column.saturating_sub(1), (column + 1).min(self.columns - 1));
        let (far, near) = (row.saturating_sub(1), (row + 1).min(self.rows - 1));
        let along_x =
            slope(self.height(left, row), self.height(right, row), right - left, self.columns, size.x);
        let along_z =
            slope(self.height(column, far), self.height(column, near), near - far, self.rows, size.y);
        Vec3::new(-along_x, 1.0, -along_z).normalize_or(Vec3::Y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_faces_upwards_and_is_a_plane() {
        // Height grows with x by 3 over a width of 2, and with z by 1 over a depth of 1.
        let heights = vec![0.0, 1.5, 3.0, 1.0, 2.5, 4.0];
        let field = HeightField::new(3, 2, heights).expect("a field");
        let mesh = field.mesh(Vec3::Y, Vec2::new(2.0, 1.0), true).expect("a mesh");
        let n = Vec3::new(-1.5, 1.0, -1.0).normalize();
        assert_eq!(mesh.triangles().len(), 4, "two per cell");
        for triangle in 0..4 {
            let [a, b, c] = mesh.corners(triangle);
            let ng = (b - a).cross(c - a).normalize();
            assert!(ng.abs_diff_eq(n, 1e-6), "triangle {triangle}: {ng}");
            for ns in mesh.corner_normals(triangle).expect("normals") {
                assert!(ns.abs_diff_eq(n, 1e-6), "normal of {triangle}: {ns}");
            }
        }
        let bounds = mesh.bounds();
        assert_eq!((bounds.min, bounds.max), (Vec3::new(-1.0, 1.0, -0.5), Vec3::new(1.0, 5.0, 0.5)), "place");
    }

    #[test]
    fn rows_are_seen_from_above_like_a_picture() {
        let field = HeightField::new(2, 2, vec![1.0, 2.0, 3.0, 4.0]).expect("a field");
        let mesh = field.mesh(Vec3::ZERO, Vec2::ONE, false).expect("a mesh");
        assert_eq!(mesh.positions()[1], Vec3::new(0.5, 2.0, -0.5), "the end of the first row: right, far");
        let [uv, ..] = mesh.corner_uvs(0).expect("parameters");
        assert!(!mesh.has_normals() && uv.is_finite(), "flat, with parameters");
        // b and d differ by 1, a and c by 3: the cell is divided between b and d.
        let shared = mesh.triangles()[0];
        assert!(shared.contains(&1) && shared.contains(&2), "the wrong diagonal: {shared:?}");
    }

    #[test]
    fn what_is_no_field_is_refused() {
        let refusal =
            |columns, rows, heights| HeightField::new(columns, rows, heights).expect_err("no field");
        assert!(matches!(refusal(1, 5, vec![0.0; 5]), HeightFieldError::TooFew { .. }), "a line");
        assert!(matches!(refusal(2, 2, vec![0.0; 5]), HeightFieldError::Length { found: 5, .. }), "too many");
        let found = refusal(2, 2, vec![0.0, 0.0, f32::NAN, 0.0]);
        assert_eq!(found, HeightFieldError::NotFinite { column: 0, row: 1 }, "not a number");
        let high = HeightField::new(2, 2, vec![0.0, 0.0, 0.0, 1e19]).expect("a field");
        let found = high.mesh(Vec3::ZERO, Vec2::ONE, true).expect_err("too high");
        assert_eq!(found, MeshError::TooFar { vertex: 3 }, "too high");
    }
}
