//! Meshes as Embree reads them in place.

use super::error::EmbreeError;
use super::faces::Faces;
use crate::geometry::Mesh;
use glam::Vec3;
use std::fmt;
use std::sync::Arc;

/// Vertex positions that Embree can read in place: "the last buffer element must be readable using 16-byte SSE load
/// instructions", so one more position lies behind the last. Cheap to clone; made from an array by copying it once.
#[derive(Clone, PartialEq)]
pub struct Vertices {
    padded: Arc<[Vec3]>,
}

impl Vertices {
    /// The positions.
    #[must_use]
    pub fn as_slice(&self) -> &[Vec3] {
        &self.padded[..self.padded.len() - 1]
    }

    /// How many owners share the array.
    #[cfg(test)]
    pub(super) fn owners(&self) -> usize {
        Arc::strong_count(&self.padded)
    }
}

impl From<&[Vec3]> for Vertices {
    fn from(positions: &[Vec3]) -> Self {
        Self { padded: positions.iter().copied().chain([Vec3::ZERO]).collect() }
    }
}

impl From<Vec<Vec3>> for Vertices {
    fn from(mut positions: Vec<Vec3>) -> Self {
        positions.push(Vec3::ZERO);
        Self { padded: positions.into() }
    }
}

impl fmt::Debug for Vertices {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Vertices").field("len", &self.as_slice().len()).finish()
    }
}

/// A mesh with all its keys; indices are checked. Cheap to clone.
#[derive(Clone, Debug)]
pub struct MeshArrays {
    /// Positions at each key, the same number at each.
    pub(super) keys: Vec<Vertices>,
    pub(super) primitives: Primitives,
}

/// What joins the vertices.
#[derive(Clone, Debug)]
pub(super) enum Primitives {
    Triangles(Arc<[[u32; 3]]>),
    Quads(Arc<[[u32; 4]]>, Faces),
}

impl MeshArrays {
    /// Copies the positions of a mesh, and shares its triangles; `quads` joins two triangles in a row to one primitive
    /// where they can be halves of a quad. Hits name triangles all the same.
    #[must_use]
    pub fn new(mesh: &Mesh, quads: bool) -> Self {
        let keys = (0..mesh.key_count()).map(|key| Vertices::from(&mesh.key_positions(key)[..])).collect();
        let faces = if quads { Faces::of(mesh) } else { None };
        let primitives = match faces {
            Some(faces) => Primitives::Quads(faces.quads(mesh.triangles()), faces),
            None => Primitives::Triangles(mesh.triangles().clone()),
        };
        Self { keys, primitives }
    }

    /// Triangles that do not move.
    pub(super) fn of_triangles(vertices: Vertices, triangles: Arc<[[u32; 3]]>) -> Result<Self, EmbreeError> {
        let count = vertices.as_slice().len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= count) {
                return Err(EmbreeError::Index { triangle, vertex, count });
            }
        }
        Ok(Self { keys: vec![vertices], primitives: Primitives::Triangles(triangles) })
    }

    /// Bytes of what is not shared with the mesh.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let quads = match &self.primitives {
            Primitives::Triangles(_) => 0,
            Primitives::Quads(quads, _) => size_of_val(&**quads),
        };
        quads + self.keys.iter().map(|key| size_of_val(&*key.padded)).sum::<usize>()
    }
}
