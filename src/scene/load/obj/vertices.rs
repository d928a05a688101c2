//! Vertices with one index each, out of corners with an index per attribute.

use super::polygons::{Corner, Polygons};
use glam::Vec3;

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
