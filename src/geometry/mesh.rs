//! Triangle meshes.

use crate::geometry::points::Corners;
use crate::geometry::{Points, ShapeHit, SurfacePoint};
use crate::math::{Aabb, Transform, motion};
use glam::{Vec2, Vec3};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Indexed triangles, counter-clockwise seen from outside; checked once, then immutable and cheap to share.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    positions: Arc<[Vec3]>,
    triangles: Arc<[[u32; 3]]>,
    normals: Option<Arc<[Vec3]>>,
    uvs: Option<Arc<[Vec2]>>,
    groups: Option<Arc<[u16]>>,
    /// What the vertices do after the opening of the shutter: keys at equal steps to its closing; empty if they stay.
    later: Arc<[Key]>,
}

/// A mesh at another moment.
#[derive(Clone, Debug, PartialEq)]
struct Key {
    positions: Arc<[Vec3]>,
    normals: Option<Arc<[Vec3]>>,
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
    /// More keys than [`motion::MOST_KEYS`].
    #[error("{found} keys, but there can be {most} at most")]
    Keys {
        /// How many there are, that of the opening of the shutter counted.
        found: usize,
        /// How many there can be.
        most: usize,
    },
    /// A coordinate beyond [`Mesh::MAX_COORDINATE`].
    #[error("vertex {vertex} is farther than {:e} from zero", Mesh::MAX_COORDINATE)]
    TooFar {
        /// Which vertex, from 0.
        vertex: usize,
    },
}

impl Mesh {
    /// The greatest size of a coordinate. Products of two must fit into single precision with room to spare (it ends at
    /// 3.4e38), and Embree 4 leaves out primitives with coordinates beyond 1.844e18 without a word.
    pub const MAX_COORDINATE: f32 = 1e18;

    /// A mesh without normals, surface parameters or groups. Every index must name a vertex, and no coordinate may be
    /// beyond [`Mesh::MAX_COORDINATE`].
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        let count = positions.len();
        check_positions(&positions)?;
        for (triangle, indices) in triangles.iter().enumerate() {
            if let Some(&vertex) = indices.iter().find(|&&i| i as usize >= count) {
                return Err(MeshError::Index { triangle, vertex, count });
            }
        }
        let (positions, triangles) = (positions.into(), triangles.into());
        let later = Arc::default();
        Ok(Self { positions, triangles, normals: None, uvs: None, groups: None, later })
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

    /// The same mesh without surface parameters.
    #[must_use]
    pub fn without_uvs(self) -> Self {
        Self { uvs: None, ..self }
    }

    /// The same mesh without shading normals.
    #[must_use]
    pub fn without_normals(self) -> Self {
        let later = self.later.iter().map(|key| Key { positions: key.positions.clone(), normals: None });
        Self { normals: None, later: later.collect(), ..self }
    }

    /// The same mesh with a group per triangle, by which materials are told apart.
    pub fn with_groups(self, groups: Vec<u16>) -> Result<Self, MeshError> {
        check_length("groups", groups.len(), self.triangles.len())?;
        Ok(Self { groups: Some(groups.into()), ..self })
    }

    /// The same mesh, whose vertices move: on straight lines from where they are now, at the opening of the shutter, through
    /// the positions of each key, the last at its closing, in equal steps of time. Normals, one per vertex and key, move
    /// likewise; they are absent where the mesh has none.
    pub fn with_keys(self, keys: Vec<(Vec<Vec3>, Option<Vec<Vec3>>)>) -> Result<Self, MeshError> {
        if keys.len() >= motion::MOST_KEYS {
            return Err(MeshError::Keys { found: keys.len() + 1, most: motion::MOST_KEYS });
        }
        for (positions, normals) in &keys {
            check_length("positions of a key", positions.len(), self.positions.len())?;
            check_positions(positions)?;
            let expected = self.normals.as_ref().map_or(0, |normals| normals.len());
            check_length("normals of a key", normals.as_ref().map_or(0, Vec::len), expected)?;
        }
        let key = |(positions, normals): (Vec<Vec3>, Option<Vec<Vec3>>)| Key {
            positions: positions.into(),
            normals: normals.filter(|_| self.normals.is_some()).map(Arc::from),
        };
        let later = keys.into_iter().map(key).collect();
        Ok(Self { later, ..self })
    }

    /// The same mesh, if it stays, with a second key at which everything is where it was.
    #[must_use]
    pub(crate) fn held(self) -> Self {
        let key = || Key { positions: self.positions.clone(), normals: self.normals.clone() };
        let later = if self.later.is_empty() { Arc::from([key()]) } else { self.later.clone() };
        Self { later, ..self }
    }

    /// The same mesh carried to another place. Mirrored maps keep the outside outside.
    #[must_use]
    pub fn transformed(&self, map: &Transform) -> Self {
        if map.is_identity() {
            return self.clone();
        }
        let mirrored = map.world_from_object().matrix3.determinant() < 0.0;
        let moved = |positions: &Arc<[Vec3]>| positions.iter().map(|p| map.point(*p)).collect();
        let turned =
            |normals: &Arc<[Vec3]>| normals.iter().map(|n| map.normal(*n).normalize_or_zero()).collect();
        let key =
            |key: &Key| Key { positions: moved(&key.positions), normals: key.normals.as_ref().map(turned) };
        Self {
            positions: moved(&self.positions),
            triangles: if mirrored {
                self.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect()
            } else {
                self.triangles.clone()
            },
            normals: self.normals.as_ref().map(turned),
            uvs: self.uvs.clone(),
            groups: self.groups.clone(),
            later: self.later.iter().map(key).collect(),
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

    /// How many keys the motion of the vertices has; 1 where they stay.
    #[must_use]
    pub fn key_count(&self) -> usize {
        1 + self.later.len()
    }

    /// Vertex positions at a key; the first is the opening of the shutter.
    ///
    /// # Panics
    /// Beyond the last key.
    #[must_use]
    pub fn key_positions(&self, key: usize) -> &Arc<[Vec3]> {
        key.checked_sub(1).map_or(&self.positions, |later| &self.later[later].positions)
    }

    /// Whether vertices carry shading normals.
    #[must_use]
    pub fn has_normals(&self) -> bool {
        self.normals.is_some()
    }

    /// Whether vertices carry surface parameters.
    #[must_use]
    pub fn has_uvs(&self) -> bool {
        self.uvs.is_some()
    }

    pub(super) fn normals(&self) -> Option<&[Vec3]> {
        self.normals.as_deref()
    }

    pub(super) fn uvs(&self) -> Option<&[Vec2]> {
        self.uvs.as_deref()
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

    /// The corners of a triangle; at the opening of the shutter if they move.
    #[must_use]
    #[inline]
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|i| self.positions[i as usize])
    }

    /// The corners of a triangle at a moment of the shutter, in [0, 1].
    #[must_use]
    #[inline]
    pub fn corners_at(&self, triangle: u32, time: f32) -> [Vec3; 3] {
        if self.later.is_empty() {
            return self.corners(triangle);
        }
        let (key, part) = motion::step(time, self.key_count());
        let [before, after] = [key, key + 1].map(|key| self.key_positions(key));
        self.triangles[triangle as usize].map(|i| mix(before[i as usize], after[i as usize], part))
    }

    /// The shading normals at the corners of a triangle, where there are any; at the opening of the shutter if they move.
    #[must_use]
    pub fn corner_normals(&self, triangle: u32) -> Option<[Vec3; 3]> {
        self.corner_normals_at(triangle, 0.0)
    }

    /// The shading normals at the corners of a triangle at a moment of the shutter, where there are any; of any length.
    #[must_use]
    pub fn corner_normals_at(&self, triangle: u32, time: f32) -> Option<[Vec3; 3]> {
        let first = self.normals.as_ref()?;
        let corners = self.triangles[triangle as usize];
        if self.later.is_empty() {
            return Some(corners.map(|i| first[i as usize]));
        }
        let (key, part) = motion::step(time, self.key_count());
        let at =
            |key: usize| key.checked_sub(1).map_or(Some(first), |later| self.later[later].normals.as_ref());
        let (before, after) = (at(key)?, at(key + 1)?);
        Some(corners.map(|i| mix(before[i as usize], after[i as usize], part)))
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

    /// A box around all vertices that triangles use, at all moments of the shutter.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        (0..self.key_count()).fold(Aabb::EMPTY, |all, key| {
            let positions = self.key_positions(key);
            all.union(Aabb::around(self.triangles.iter().flatten().map(|&i| positions[i as usize])))
        })
    }

    /// A box around a triangle, at all moments of the shutter.
    #[must_use]
    pub fn triangle_bounds(&self, triangle: u32) -> Aabb {
        let corners = self.triangles[triangle as usize];
        let at = |key| corners.map(|i| self.key_positions(key)[i as usize]);
        Aabb::around((0..self.key_count()).flat_map(at))
    }

    /// The point with the surface parameters of a hit, at a moment of the shutter.
    pub(super) fn point(&self, triangle: u32, time: f32, hit: &ShapeHit) -> SurfacePoint {
        let corners = self.corners_at(triangle, time);
        let normals = self.corner_normals_at(triangle, time);
        let known = Corners {
            positions: corners.map(Into::into),
            normals: normals.map(|normals| normals.map(Into::into)),
            uvs: self.corner_uvs(triangle).map(|uvs| uvs.map(Into::into)),
            moving: !self.later.is_empty(),
        };
        let Points { p, p_error, ng, ns, uv, .. } = known.at([hit.u, hit.v], hit.ng.into());
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let lift = normals.map_or([Vec3::ZERO; 2], |normals| lift(corners, normals, weights));
        SurfacePoint {
            p: p.into(),
            p_error: p_error.into(),
            ng: ng.into(),
            ns: ns.into(),
            uv: uv.into(),
            lift,
        }
    }

    /// Bytes of the arrays.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.bytes_beside(&mut BTreeSet::new())
    }

    /// Bytes of the arrays but for those that have been seen, by where they are, which these now have: meshes share arrays.
    pub(crate) fn bytes_beside(&self, seen: &mut BTreeSet<usize>) -> usize {
        fn array<T>(array: &Arc<[T]>) -> (usize, usize) {
            (array.as_ptr().addr(), size_of_val(&**array))
        }
        let later = self.later.iter().flat_map(|key| [Some(&key.positions), key.normals.as_ref()]);
        let arrays = [
            Some(array(&self.positions)),
            Some(array(&self.triangles)),
            self.normals.as_ref().map(array),
            self.uvs.as_ref().map(array),
            self.groups.as_ref().map(array),
        ];
        let all = arrays.into_iter().flatten().chain(later.flatten().map(array));
        all.filter(|(place, _)| seen.insert(*place)).map(|(_, bytes)| bytes).sum()
    }
}

/// From a point of a triangle, by its barycentric coordinates, to the smooth surface that the corners' normals stand for: the
/// mean of its projections on the planes through the corners, of those it lies below (Hanika 2021, Hacking the Shadow
/// Terminator). First for the side of the normals, then for the other.
fn lift(corners: [Vec3; 3], normals: [Vec3; 3], weights: [f32; 3]) -> [Vec3; 2] {
    let p = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
    let mut lift = [Vec3::ZERO; 2];
    for ((corner, normal), weight) in corners.into_iter().zip(normals).zip(weights) {
        let n = normal.normalize_or_zero();
        let height = (p - corner).dot(n);
        lift[usize::from(height > 0.0)] -= n * (height * weight);
    }
    lift
}

fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), MeshError> {
    if found == expected { Ok(()) } else { Err(MeshError::Length { what, found, expected }) }
}

fn check_positions(positions: &[Vec3]) -> Result<(), MeshError> {
    if let Some(vertex) = positions.iter().position(|p| !p.is_finite()) {
        return Err(MeshError::NotFinite { vertex });
    }
    let far = positions.iter().position(|p| p.abs().max_element() > Mesh::MAX_COORDINATE);
    far.map_or(Ok(()), |vertex| Err(MeshError::TooFar { vertex }))
}

fn mix(a: Vec3, b: Vec3, part: f32) -> Vec3 {
    a * (1.0 - part) + b * part
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    #[test]
    fn meshes_are_checked() {
        let bad = Mesh::new(CORNERS.to_vec(), vec![[0, 1, 3]]);
        assert_eq!(bad, Err(MeshError::Index { triangle: 0, vertex: 3, count: 3 }), "index");
        let bad = Mesh::new(vec![Vec3::NAN], vec![]);
        assert_eq!(bad, Err(MeshError::NotFinite { vertex: 0 }), "nan");
        let bad = Mesh::new(vec![Vec3::ZERO, Vec3::Y * -1.1e18], vec![]);
        assert_eq!(bad, Err(MeshError::TooFar { vertex: 1 }), "far away");
        let mesh = Mesh::new(CORNERS.to_vec(), vec![[0, 1, 2]]).expect("good");
        assert!(mesh.clone().with_normals(vec![Vec3::Z]).is_err(), "one normal for three vertices");
        assert!((mesh.area(0) - 0.5).abs() < 1e-7, "area");
    }

    #[test]
    fn corners_move_on_straight_lines_from_key_to_key() {
        let shifted = |by: Vec3| CORNERS.iter().map(|p| *p + by).collect::<Vec<_>>();
        let mesh = || Mesh::new(CORNERS.to_vec(), vec![[0, 1, 2]]).expect("good");
        let moving =
            mesh().with_keys(vec![(shifted(Vec3::X * 2.0), None), (shifted(Vec3::Z), None)]).expect("good");
        assert_eq!(moving.key_count(), 3, "keys");
        for (time, by) in [(0.0, 0.0), (0.25, 1.0), (0.5, 2.0)] {
            assert_eq!(moving.corners_at(0, time), CORNERS.map(|p| p + Vec3::X * by), "at {time}");
        }
        assert_eq!(moving.corners_at(0, 0.75)[0], Vec3::new(1.0, 0.0, 0.5), "between the last two");
        assert_eq!(
            moving.bounds(),
            Aabb { min: Vec3::ZERO, max: Vec3::new(3.0, 1.0, 1.0) },
            "box of all moments"
        );
        assert_eq!(moving.triangle_bounds(0), moving.bounds(), "box of the triangle");
        let bad = mesh().with_keys(vec![(vec![Vec3::ZERO], None)]);
        assert!(matches!(bad, Err(MeshError::Length { .. })), "a vertex that is missing later");
        let bad = mesh().with_keys(vec![(CORNERS.to_vec(), Some(CORNERS.to_vec()))]);
        assert!(matches!(bad, Err(MeshError::Length { .. })), "normals at a later key only");
        let bad = mesh().with_keys(vec![(CORNERS.to_vec(), None); 129]);
        assert_eq!(bad, Err(MeshError::Keys { found: 130, most: 129 }), "too many keys");
    }
}
