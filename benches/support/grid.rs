//! A height field that walks its grid, to compare triangles with.
//!
//! The grid is walked through a pyramid of least and greatest heights (Tevs, Ihrke, Seidel 2008, Maximum mipmaps for fast,
//! accurate, and scalable dynamic height field rendering), four children at a time, front to back; its cells are
//! divided as the mesh's are.

use glam::{Vec2, Vec3};
use specula::geometry::{HeightField, Ray, ShapeHit, Surface, SurfacePoint};
use specula::math::Aabb;

/// Heights with the extremes of blocks of 2, 4, 8, ... cells.
#[derive(Debug)]
pub(crate) struct Grid {
    count: u32,
    heights: Vec<f32>,
    /// Blocks per side, and their extremes by row; from 2 cells up.
    levels: Vec<(u32, Vec<[f32; 2]>)>,
}

impl Grid {
    /// The same heights over the square from -1 to 1.
    pub(crate) fn new(field: &HeightField) -> Self {
        let [count, _] = field.counts();
        let heights =
            (0..count).flat_map(|row| (0..count).map(move |column| field.height(column, row))).collect();
        let mut grid = Self { count, heights, levels: vec![] };
        let mut side = count - 1;
        while side > 1 {
            let level = grid.levels.len();
            side = side.div_ceil(2);
            let blocks = (0..side).flat_map(|j| (0..side).map(move |i| (i, j)));
            let extremes = blocks
                .map(|(i, j)| {
                    let parts = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(a, b)| (2 * i + a, 2 * j + b));
                    let inside = parts.into_iter().filter(|&(i, j)| i.max(j) < grid.side(level));
                    let of = inside.map(|(i, j)| grid.extremes(level, i, j));
                    of.fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], [c, d]| [a.min(c), b.max(d)])
                })
                .collect();
            grid.levels.push((side, extremes));
        }
        grid
    }

    /// Bytes of it.
    pub(crate) fn bytes(&self) -> usize {
        self.levels.iter().map(|(_, level)| size_of_val(&**level)).sum::<usize>()
            + size_of_val(&*self.heights)
    }

    /// Blocks per side; cells at level 0.
    fn side(&self, level: usize) -> u32 {
        if level == 0 { self.count - 1 } else { self.levels[level - 1].0 }
    }

    fn extremes(&self, level: usize, i: u32, j: u32) -> [f32; 2] {
        if level > 0 {
            let (side, blocks) = &self.levels[level - 1];
            return blocks[(j * side + i) as usize];
        }
        let corners = self.cell(i, j).map(|node| self.heights[node as usize]);
        corners.into_iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], h| [a.min(h), b.max(h)])
    }

    fn cell(&self, i: u32, j: u32) -> [u32; 4] {
        let first = j * self.count + i;
        [first, first + self.count, first + self.count + 1, first + 1]
    }

    fn place(&self, i: u32) -> f32 {
        i as f32 / (self.count - 1) as f32 * 2.0 - 1.0
    }

    fn corner(&self, node: u32) -> Vec3 {
        Vec3::new(self.place(node % self.count), self.heights[node as usize], self.place(node / self.count))
    }

    /// Whether a block's box lies on the ray.
    fn is_met(&self, level: usize, i: u32, j: u32, ray: &Ray, inverse: Vec3) -> bool {
        let [low, high] = self.extremes(level, i, j);
        let edge = |i: u32| self.place((i << level).min(self.count - 1));
        let (min, max) = (Vec3::new(edge(i), low, edge(j)), Vec3::new(edge(i + 1), high, edge(j + 1)));
        let (a, b) = ((min - ray.o) * inverse, (max - ray.o) * inverse);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element() * (1.0 + 4.0 * f32::EPSILON));
        enter.max(ray.t_min) <= leave.min(ray.t_max)
    }

    fn hit_cell(&self, i: u32, j: u32, ray: &Ray) -> Option<ShapeHit> {
        let cell = self.cell(i, j);
        let [a, b, c, d] = cell.map(|node| self.heights[node as usize]);
        let turned = (a - c).abs() > (b - d).abs();
        let [a, b, c, d] = if turned { [cell[1], cell[2], cell[3], cell[0]] } else { cell };
        let [a, b, c, d] = [a, b, c, d].map(|node| self.corner(node));
        let hits = [hit_triangle([a, b, c], ray), hit_triangle([a, c, d], ray)];
        hits.into_iter().flatten().min_by(|a, b| a.t.total_cmp(&b.t))
    }
}

/// Möller and Trumbore 1997, Fast, minimum storage ray/triangle intersection.
fn hit_triangle([a, b, c]: [Vec3; 3], ray: &Ray) -> Option<ShapeHit> {
    let (e1, e2, s) = (b - a, c - a, ray.o - a);
    let (p, q) = (ray.d.cross(e2), s.cross(e1));
    let inverse = e1.dot(p).recip();
    let (u, v, t) = (s.dot(p) * inverse, ray.d.dot(q) * inverse, e2.dot(q) * inverse);
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= ray.t_min && t <= ray.t_max;
    inside.then(|| ShapeHit { t, u, v, ng: e1.cross(e2) })
}

impl Surface for Grid {
    fn primitive_bounds(&self, _: u32) -> Aabb {
        let [low, high] = self.extremes(self.levels.len(), 0, 0);
        Aabb { min: Vec3::new(-1.0, low, -1.0), max: Vec3::new(1.0, high, 1.0) }
    }

    fn intersect(&self, _: u32, ray: &Ray) -> Option<ShapeHit> {
        let inverse = ray.d.recip();
        let (first_i, first_j) = (u32::from(ray.d.x < 0.0), u32::from(ray.d.z < 0.0));
        let mut stack = [(0_usize, 0_u32, 0_u32); 64];
        stack[0] = (self.levels.len(), 0, 0);
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (level, i, j) = stack[depth];
            if !self.is_met(level, i, j, ray, inverse) {
                continue;
            }
            if level == 0 {
                if let Some(hit) = self.hit_cell(i, j, ray) {
                    return Some(hit);
                }
                continue;
            }
            let side = self.side(level - 1);
            // The farthest first, so that the nearest is taken from the stack first.
            for (far_i, far_j) in [(1, 1), (0, 1), (1, 0), (0, 0)] {
                let (i, j) = (2 * i + (first_i ^ far_i), 2 * j + (first_j ^ far_j));
                if i < side && j < side {
                    stack[depth] = (level - 1, i, j);
                    depth += 1;
                }
            }
        }
        None
    }

    fn point(&self, _: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        SurfacePoint::smooth(ray.at(hit.t), Vec3::splat(1e-6), hit.ng.normalize(), Vec2::ZERO)
    }
}
