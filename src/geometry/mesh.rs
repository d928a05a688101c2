//! Triangle meshes.

use crate::math::{Aabb, Transform};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Indexed triangles, counter-clockwise seen from outside; checked once, then immutable and cheap to share.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    positions: Arc<[Vec3]>,
    triangles: Arc<[[u32; 3]]>,
    normals: Option<Arc<[Vec3]>>,
    uvs: Option<Arc<[Vec2]>>,
    groups: Option<Arc<[u16]>>,
}

/// Why a mesh was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// A vertex attribute of another length than the positions.
    #[error("{what}: {found} values for {expected} vertices")]
    Length {
        /// Which attribute.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        expected: usize,
    },
    /// A triangle that names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {count}")]
    Index {
        /// Which triangle, from 0.
        triangle: usize,
        /// The index it holds, from 0.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// A coordinate that is not a number or not finite.
    #[error("vertex {vertex} is not finite")]
    NotFinite {
        /// Which vertex, from 0.
        vertex: usize,
    },
}

impl Mesh {
    /// A mesh without normals, surface parameters or groups. Every index must name a vertex and every coordinate
    /// must be finite.
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        let count = positions.len();
        if let Some(vertex) = positions.iter().position(|p| !p.is_finite()) {
            return Err(MeshError::NotFinite { vertex });
        }
        for (triangle, indices) in triangles.iter().enumerate() {
            if let Some(&vertex) = indices.iter().find(|&&i| i as usize >= count) {
                return Err(MeshError::Index { triangle, vertex, count });
            }
        }
        let (positions, triangles) = (positions.into(), triangles.into());
        Ok(Self { positions, triangles, normals: None, uvs: None, groups: None })
    }

    /// The same mesh with a shading normal per vertex, of any length; zero ones fall back to the triangle's own.
    pub fn with_normals(self, normals: Vec<Vec3>) -> Result<Self, MeshError> {
        check_length("normals", normals.len(), self.positions.len())?;
        Ok(Self { normals: Some(normals.into()), ..self })
    }

    /// The same mesh with surface parameters per vertex.
    pub fn with_uvs(self, uvs: Vec<Vec2>) -> Result<Self, MeshError> {
        check_length("uv", uvs.len(), self.positions.len())?;
        Ok(Self { uvs: Some(uvs.into()), ..self })
    }

    /// The same mesh with a group per triangle, by which materials are told apart.
    pub fn with_groups(self, groups: Vec<u16>) -> Result<Self, MeshError> {
        check_length("groups", groups.len(), self.triangles.len())?;
        Ok(Self { groups: Some(groups.into()), ..self })
    }

    /// The same mesh carried to another place. Mirrored maps keep the outside outside.
    #[must_use]
    pub fn transformed(&self, map: &Transform) -> Self {
        if map.is_identity() {
            return self.clone();
        }
        let mirrored = map.world_from_object().matrix3.determinant() < 0.0;
        let turned = |[a, b, c]: [u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
        let normal = |n: &Vec3| map.normal(*n).normalize_or_zero();
        Self {
            positions: self.positions.iter().map(|p| map.point(*p)).collect(),
            triangles: self.triangles.iter().copied().map(turned).collect(),
            normals: self.normals.as_ref().map(|normals| normals.iter().map(normal).collect()),
            uvs: self.uvs.clone(),
            groups: self.groups.clone(),
        }
    }

    /// Vertex positions.
    #[must_use]
    pub fn positions(&self) -> &Arc<[Vec3]> {
        &self.positions
    }

    /// Vertex indices per triangle.
    #[must_use]
    pub fn triangles(&self) -> &Arc<[[u32; 3]]> {
        &self.triangles
    }

    /// Whether vertices carry shading normals.
    #[must_use]
    pub fn has_normals(&self) -> bool {
        self.normals.is_some()
    }

    /// The group of a triangle; 0 where the mesh has no groups.
    #[must_use]
    pub fn group(&self, triangle: u32) -> u16 {
        self.groups.as_ref().map_or(0, |groups| groups[triangle as usize])
    }

    /// How many groups triangles may name: one more than the largest.
    #[must_use]
    pub fn group_count(&self) -> usize {
        self.groups.as_ref().and_then(|groups| groups.iter().max()).map_or(1, |&last| usize::from(last) + 1)
    }

    /// The corners of a triangle.
    #[must_use]
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|i| self.positions[i as usize])
    }

    /// The shading normals at the corners of a triangle, where there are any.
    #[must_use]
    pub fn corner_normals(&self, triangle: u32) -> Option<[Vec3; 3]> {
        let normals = self.normals.as_ref()?;
        Some(self.triangles[triangle as usize].map(|i| normals[i as usize]))
    }

    /// The surface parameters at the corners of a triangle, where there are any.
    #[must_use]
    pub fn corner_uvs(&self, triangle: u32) -> Option<[Vec2; 3]> {
        let uvs = self.uvs.as_ref()?;
        Some(self.triangles[triangle as usize].map(|i| uvs[i as usize]))
    }

    /// The area of a triangle.
    #[must_use]
    pub fn area(&self, triangle: u32) -> f32 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a).length() * 0.5
    }

    /// A box around all vertices that triangles use.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.triangles.iter().flatten().map(|&i| self.positions[i as usize]))
    }

    /// Bytes of the arrays.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let normals = self.normals.as_ref().map_or(0, |n| size_of_val::<[Vec3]>(n));
        let uvs = self.uvs.as_ref().map_or(0, |n| size_of_val::<[Vec2]>(n));
        let groups = self.groups.as_ref().map_or(0, |n| size_of_val::<[u16]>(n));
        size_of_val::<[Vec3]>(&self.positions)
            + size_of_val::<[[u32; 3]]>(&self.triangles)
            + normals
            + uvs
            + groups
    }
}

fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), MeshError> {
    if found == expected { Ok(()) } else { Err(MeshError::Length { what, found, expected }) }
}

/// Ray parameter, u and v of the hit in `[t_min, t_max]`, if any, of a ray on the triangle `corners`; both sides count.
///
/// The edge tests are those of a shear along the ray that both neighbours of an edge evaluate alike, redone in
/// double precision, so that no ray slips between them (Woop, Benthin, Wald 2013, Watertight Ray/Triangle
/// Intersection). An oracle: exact rather than fast.
#[must_use]
pub fn intersect_triangle(corners: [Vec3; 3], o: Vec3, d: Vec3, t_min: f32, t_max: f32) -> Option<[f32; 3]> {
    let (o, d) = (o.as_dvec3(), d.as_dvec3());
    let [a, b, c] = corners.map(|p| p.as_dvec3() - o);
    let volume = |p: glam::DVec3, q: glam::DVec3| d.dot(p.cross(q));
    let (w_a, w_b, w_c) = (volume(c, b), volume(a, c), volume(b, a));
    let below = w_a < 0.0 || w_b < 0.0 || w_c < 0.0;
    let above = w_a > 0.0 || w_b > 0.0 || w_c > 0.0;
    let det = w_a + w_b + w_c;
    if (below && above) || det == 0.0 || !det.is_finite() {
        return None;
    }
    let p = (a * w_a + b * w_b + c * w_c) / det;
    let t = p.dot(d) / d.length_squared();
    #[expect(clippy::cast_possible_truncation, reason = "the answer is single precision")]
    let [t, u, v] = [t, w_b / det, w_c / det].map(|x| x as f32);
    (t >= t_min && t <= t_max).then_some([t, u, v])
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    #[test]
    fn triangle_hits_carry_barycentrics() {
        let o = Vec3::new(0.25, 0.5, 2.0);
        let hit = intersect_triangle(CORNERS, o, -Vec3::Z, 0.0, 10.0);
        assert_eq!(hit, Some([2.0, 0.25, 0.5]), "from the front");
        let hit = intersect_triangle(CORNERS, o * Vec3::new(1.0, 1.0, -1.0), Vec3::Z, 0.0, 10.0);
        assert_eq!(hit, Some([2.0, 0.25, 0.5]), "from behind");
        assert_eq!(intersect_triangle(CORNERS, o, -Vec3::Z, 0.0, 1.9), None, "too far");
        assert_eq!(intersect_triangle(CORNERS, o, Vec3::X, 0.0, 9.0), None, "parallel");
        assert_eq!(intersect_triangle(CORNERS, o, Vec3::ZERO, 0.0, 9.0), None, "no direction");
        assert_eq!(intersect_triangle(CORNERS, o, Vec3::NAN, 0.0, 9.0), None, "no number");
    }

    #[test]
    fn meshes_are_checked() {
        let bad = Mesh::new(CORNERS.to_vec(), vec![[0, 1, 3]]);
        assert_eq!(bad, Err(MeshError::Index { triangle: 0, vertex: 3, count: 3 }), "index");
        let bad = Mesh::new(vec![Vec3::NAN], vec![]);
        assert_eq!(bad, Err(MeshError::NotFinite { vertex: 0 }), "nan");
        let mesh = Mesh::new(CORNERS.to_vec(), vec![[0, 1, 2]]).expect("good");
        assert!(mesh.clone().with_normals(vec![Vec3::Z]).is_err(), "one normal for three vertices");
        assert!((mesh.area(0) - 0.5).abs() < 1e-7, "area");
    }
}
