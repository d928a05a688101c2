//! Vertices with one index each, out of corners with an index per attribute.

use super::polygons::{Corner, Polygons};
use glam::Vec3;
use std::collections::HashMap;

/// Corners that differ in no attribute are one vertex.
#[derive(Debug)]
pub(super) struct Vertices {
    /// What each vertex refers to.
    pub(super) corners: Vec<Corner>,
    /// The latest vertex at each position.
    heads: Vec<Option<u32>>,
    /// The vertex made before this one at the same position.
    others: Vec<Option<u32>>,
}

impl Vertices {
    /// None yet; there are `positions` positions.
    pub(super) fn new(positions: usize) -> Self {
        Self { corners: vec![], heads: vec![None; positions], others: vec![] }
    }

    /// The vertex of a corner.
    ///
    /// # Panics
    /// Beyond 2^32 vertices, for which there is no memory.
    pub(super) fn of(&mut self, corner: Corner) -> u32 {
        let head = &mut self.heads[corner.position as usize];
        let mut next = *head;
        while let Some(i) = next {
            if self.corners[i as usize] == corner {
                return i;
            }
            next = self.others[i as usize];
        }
        let new = u32::try_from(self.corners.len()).expect("fewer than 2^32 vertices");
        self.corners.push(corner);
        self.others.push(head.replace(new));
        new
    }
}

/// Normals of the file, zero for vertices without; `None` if no vertex has one.
pub(super) fn file_normals(polygons: &Polygons, vertices: &[Corner]) -> Option<Vec<Vec3>> {
    let normal = |corner: &Corner| corner.normal.map_or(Vec3::ZERO, |i| polygons.normals[i as usize]);
    vertices.iter().any(|corner| corner.normal.is_some()).then(|| vertices.iter().map(normal).collect())
}

/// Normals averaged over the triangles that meet at a point, each weighted by its angle there, which makes the average
/// independent of how polygons were cut (Thuermer, Wuethrich 1998, Computing Vertex Normals from Polygonal Facets).
/// Vertices at the same coordinates share one, whatever their other attributes.
pub(super) fn smooth_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut points = HashMap::new();
    let point_of: Vec<usize> = positions
        .iter()
        .map(|p| {
            let next = points.len();
            // Adding zero makes one of the two zeros.
            *points.entry((*p + 0.0).to_array().map(f32::to_bits)).or_insert(next)
        })
        .collect();
    let mut sums = vec![Vec3::ZERO; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| positions[i as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for (i, u, v) in [(0, b - a, c - a), (1, c - b, a - b), (2, a - c, b - c)] {
            sums[point_of[triangle[i] as usize]] += normal * u.angle_between(v);
        }
    }
    point_of.into_iter().map(|i| sums[i].normalize_or_zero()).collect()
}
