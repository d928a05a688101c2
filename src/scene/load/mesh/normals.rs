//! Normals averaged over the triangles that meet at a point.

use super::cutter::enlarged;
use glam::Vec3;
use std::collections::HashMap;

/// Normals averaged over all triangles that meet at a point, each weighted by its angle there, which makes the average
/// independent of how polygons were cut (Thuermer, Wuethrich 1998, Computing Vertex Normals from Polygonal Facets).
/// Vertices at the same coordinates share one, whatever their other attributes.
pub(super) fn smooth(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let (point_of, points) = points(positions);
    let mut sums = vec![Vec3::ZERO; points];
    for triangle in triangles {
        let (_, parts) = weighted(triangle.map(|i| positions[i as usize]));
        for (&i, part) in triangle.iter().zip(parts) {
            sums[point_of[i as usize] as usize] += part;
        }
    }
    point_of.into_iter().map(|i| sums[i as usize].normalize_or_zero()).collect()
}

/// Vertices that were taken apart along sharp edges.
#[derive(Debug)]
pub(super) struct Creased {
    /// Which vertex each of them was.
    pub(super) vertices: Vec<u32>,
    /// The normal of each.
    pub(super) normals: Vec<Vec3>,
    /// The same triangles by these vertices.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The same average over the triangles about a point that can be reached from one another without crossing an edge
/// between triangles turned by more than `crease_deg` against each other.
pub(super) fn creased(positions: &[Vec3], triangles: &[[u32; 3]], crease_deg: f32) -> Creased {
    let (point_of, _) = points(positions);
    let (faces, parts): (Vec<Vec3>, Vec<[Vec3; 3]>) =
        triangles.iter().map(|triangle| weighted(triangle.map(|i| positions[i as usize]))).unzip();
    let cos_crease = crease_deg.to_radians().cos();
    let mut fans = Fans::new(triangles.len() * 3);
    // The last corner seen that starts each edge; edges run from the lower point to the higher.
    let mut edges: HashMap<[u32; 2], [usize; 2]> = HashMap::with_capacity(triangles.len() * 2);
    for (t, triangle) in triangles.iter().enumerate() {
        let points = triangle.map(|i| point_of[i as usize]);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (i, j) = if points[i] < points[j] { (i, j) } else { (j, i) };
            let corners = [t * 3 + i, t * 3 + j];
            let Some(others) = edges.insert([points[i], points[j]], corners) else { continue };
            if faces[t].dot(faces[others[0] / 3]) >= cos_crease {
                fans.join(corners[0], others[0]);
                fans.join(corners[1], others[1]);
            }
        }
    }
    let mut sums = vec![Vec3::ZERO; triangles.len() * 3];
    for (corner, part) in parts.into_iter().flatten().enumerate() {
        sums[fans.of(corner)] += part;
    }
    split(triangles, &mut fans, &sums)
}

/// One vertex for each fan and vertex of it.
fn split(triangles: &[[u32; 3]], fans: &mut Fans, sums: &[Vec3]) -> Creased {
    let mut made =
        Creased { vertices: vec![], normals: vec![], triangles: Vec::with_capacity(triangles.len()) };
    let mut known: HashMap<(usize, u32), u32> = HashMap::new();
    for (t, triangle) in triangles.iter().enumerate() {
        let mut corner = t * 3;
        made.triangles.push(triangle.map(|vertex| {
            let fan = fans.of(corner);
            corner += 1;
            *known.entry((fan, vertex)).or_insert_with(|| {
                made.vertices.push(vertex);
                made.normals.push(sums[fan].normalize_or_zero());
                number(made.vertices.len() - 1)
            })
        }));
    }
    made
}

/// Sets of corners that share a normal: a forest whose roots stand for them.
struct Fans(Vec<usize>);

impl Fans {
    fn new(corners: usize) -> Self {
        Self((0..corners).collect())
    }

    fn of(&mut self, mut corner: usize) -> usize {
        while self.0[corner] != corner {
            self.0[corner] = self.0[self.0[corner]];
            corner = self.0[corner];
        }
        corner
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b)] = a.min(b);
    }
}

/// A number for each vertex, the same for those at the same coordinates, and how many there are.
fn points(positions: &[Vec3]) -> (Vec<u32>, usize) {
    let mut numbers = HashMap::with_capacity(positions.len());
    let point_of = positions
        .iter()
        .map(|p| {
            let next = number(numbers.len());
            // Adding zero makes one of the two zeros.
            *numbers.entry((*p + 0.0).to_array().map(f32::to_bits)).or_insert(next)
        })
        .collect();
    (point_of, numbers.len())
}

/// The normal of a triangle, and that times the angle at each corner.
fn weighted([a, b, c]: [Vec3; 3]) -> (Vec3, [Vec3; 3]) {
    let mut edges = [b - a, c - b, a - c];
    let size: f32 = edges.iter().map(|edge| edge.length_squared()).sum();
    // Products of squares of lengths must neither be infinite nor zero.
    if !(1e-14..1e18).contains(&size) {
        edges = enlarged(edges);
    }
    let [ab, bc, ca] = edges;
    let normal = ca.cross(ab).normalize_or_zero();
    let angles = [ab.angle_between(-ca), bc.angle_between(-ab), ca.angle_between(-bc)];
    (normal, angles.map(|angle| normal * angle))
}

fn number(n: usize) -> u32 {
    u32::try_from(n).expect("indices of vertices have 32 bits")
}
