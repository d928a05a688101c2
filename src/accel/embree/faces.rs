//! Faces of two triangles as Embree's quads, and hits on quads as hits on triangles.
//!
//! The quad of a face `[a, b, c]`, `[a, c, d]` is `(b, c, d, a)`: Embree cuts a quad `(v0, v1, v2, v3)` along `v1 v3` into
//! `(v0, v1, v3)`, which is `(b, c, a)`, and `(v2, v3, v1)`, which is `(d, a, c)`, and turns the parameters of the
//! second half over, "u = 1-u' and v = 1-v'" (manual, `RTC_GEOMETRY_TYPE_QUAD`). A face of one triangle is
//! `(b, c, a, a)`, whose second half is nothing.

use crate::geometry::Mesh;
use std::sync::Arc;

/// The first triangle of each face.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Faces {
    first: Arc<[u32]>,
    /// One more than the last triangle.
    end: u32,
}

impl Faces {
    /// The faces of a mesh: two triangles `[a, b, c]` and `[a, c, d]` in a row are one, as loaders cut quads and most programs
    /// write them. `None` if there is no pair.
    pub(super) fn of(mesh: &Mesh) -> Option<Self> {
        let triangles = mesh.triangles();
        let end = u32::try_from(triangles.len()).ok()?;
        let is_pair = |first: u32| match triangles.get(first as usize..first as usize + 2) {
            Some(&[[a, _, c], [d, e, _]]) => [a, c] == [d, e],
            _ => false,
        };
        let (mut first, mut next) = (Vec::new(), 0);
        while next < end {
            first.push(next);
            next += if is_pair(next) { 2 } else { 1 };
        }
        (first.len() < triangles.len()).then(|| Self { first: first.into(), end })
    }

    /// Whether a face has two triangles.
    fn is_pair(&self, face: usize) -> bool {
        self.first.get(face + 1).copied().unwrap_or(self.end) - self.first[face] == 2
    }

    /// Vertex indices of the quads, one per face.
    pub(super) fn quads(&self, triangles: &[[u32; 3]]) -> Arc<[[u32; 4]]> {
        let quad = |face: usize| {
            let first = self.first[face] as usize;
            let [a, b, c] = triangles[first];
            let d = if self.is_pair(face) { triangles[first + 1][2] } else { a };
            [b, c, d, a]
        };
        (0..self.first.len()).map(quad).collect()
    }

    /// The triangle and its parameters, of a face and the parameters of its quad.
    pub(super) fn triangle(&self, face: u32, [u, v]: [f32; 2]) -> (u32, [f32; 2]) {
        let first = self.first[face as usize];
        if u + v <= 1.0 || !self.is_pair(face as usize) {
            // Weights: 1 - u - v of b, u of c, v of a.
            return (first, [(1.0 - u - v).max(0.0), u]);
        }
        // Weights: 1 - u of a, 1 - v of c, the rest of d.
        let (a, c) = (1.0 - u, 1.0 - v);
        (first + 1, [c, (1.0 - a - c).max(0.0)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn both_halves_of_a_quad_are_found() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.5, 0.0), Vec3::Y, Vec3::Z];
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3], [0, 4, 3]]).expect("good");
        let faces = Faces::of(&mesh).expect("a quad and a triangle");
        let quads = faces.quads(mesh.triangles());
        assert_eq!(*quads, [[1, 2, 3, 0], [4, 3, 0, 0]], "indices");
        let at = |i: u32| mesh.positions()[i as usize];
        for (face, [u, v]) in
            [(0, [0.25, 0.5]), (0, [0.75, 0.625]), (0, [1.0, 1.0]), (0, [0.0, 0.0]), (1, [0.5, 0.25])]
        {
            let [v0, v1, v2, v3] = quads[face as usize].map(at);
            let wanted = if u + v <= 1.0 {
                v0 * (1.0 - u - v) + v1 * u + v3 * v
            } else {
                v2 * (u + v - 1.0) + v3 * (1.0 - u) + v1 * (1.0 - v)
            };
            let (triangle, [s, t]) = faces.triangle(face, [u, v]);
            let [a, b, c] = mesh.corners(triangle);
            let found = a * (1.0 - s - t) + b * s + c * t;
            assert!(found.abs_diff_eq(wanted, 1e-6), "{face} {u} {v}: {found}, not {wanted}");
        }
        assert_eq!(faces.triangle(1, [0.75, 0.250_000_1]).0, 2, "rounding does not lead to the next face");
    }
}
