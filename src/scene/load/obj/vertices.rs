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
    /// All vertices at positions that have many.
    crowds: HashMap<u32, HashMap<Corner, u32>>,
}

/// Vertices of a position that are looked at one after the other; more are looked up. Real meshes have a dozen at the tip of a cone.
const CROWD: usize = 64;

impl Vertices {
    /// None yet; there are `positions` positions.
    pub(super) fn new(positions: usize) -> Self {
        Self { corners: vec![], heads: vec![None; positions], others: vec![], crowds: HashMap::new() }
    }

    /// The vertex of a corner.
    ///
    /// # Panics
    /// Beyond 2^32 vertices, for which there is no memory.
    pub(super) fn of(&mut self, corner: Corner) -> u32 {
        let crowded = !self.crowds.is_empty() && self.crowds.contains_key(&corner.position);
        let found = if crowded { self.looked_up(corner) } else { self.sought(corner) };
        found.unwrap_or_else(|| self.add(corner))
    }

    /// The vertex of a corner among those at its position; notes where these are many.
    fn sought(&mut self, corner: Corner) -> Option<u32> {
        let mut seen = 0;
        let mut next = self.heads[corner.position as usize];
        while let Some(i) = next {
            if self.corners[i as usize] == corner {
                return Some(i);
            }
            next = self.others[i as usize];
            seen += 1;
        }
        if seen >= CROWD {
            let all =
                std::iter::successors(self.heads[corner.position as usize], |&i| self.others[i as usize]);
            let all = all.map(|i| (self.corners[i as usize], i)).collect();
            self.crowds.insert(corner.position, all);
        }
        None
    }

    /// The vertex of a corner at a position that has many.
    fn looked_up(&self, corner: Corner) -> Option<u32> {
        self.crowds.get(&corner.position)?.get(&corner).copied()
    }

    fn add(&mut self, corner: Corner) -> u32 {
        let new = u32::try_from(self.corners.len()).expect("fewer than 2^32 vertices");
        self.corners.push(corner);
        self.others.push(self.heads[corner.position as usize].replace(new));
        if let Some(crowd) = self.crowds.get_mut(&corner.position) {
            crowd.insert(corner, new);
        }
        new
    }
}

/// Normals of the file, zero for vertices without; `None` if no vertex has one.
pub(super) fn file_normals(polygons: &Polygons, vertices: &[Corner]) -> Option<Vec<Vec3>> {
    let normal = |corner: &Corner| corner.normal.map_or(Vec3::ZERO, |i| polygons.normals[i as usize]);
    vertices.iter().any(|corner| corner.normal.is_some()).then(|| vertices.iter().map(normal).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_of_one_position_are_told_apart_however_many_there_are() {
        let corner = |position, uv| Corner { position, uv: Some(uv), normal: None };
        let mut vertices = Vertices::new(2);
        // One by one this would be seconds at two hundred thousand, and hours in files of the size of real ones.
        let count = 200_000;
        for uv in 0..count {
            assert_eq!(vertices.of(corner(0, uv)), uv, "a new one");
            assert_eq!(vertices.of(corner(0, uv / 2)), uv / 2, "known");
        }
        assert_eq!(vertices.of(corner(1, 0)), count, "elsewhere");
        assert_eq!(vertices.of(corner(1, 0)), count, "known");
        assert_eq!(vertices.corners.len(), count as usize + 1, "each once");
    }
}
