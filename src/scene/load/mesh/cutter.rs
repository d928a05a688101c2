//! Triangles of many polygons, without those that have no area.

use super::polygon::Workspace;
use crate::error::{Place, Problem};
use glam::Vec3;
use std::path::Path;

/// Cuts one polygon after the other, and counts what it drops.
#[derive(Debug, Default)]
pub(in crate::scene::load) struct Cutter {
    /// Triangles dropped because they have no area.
    degenerate: usize,
    points: Vec<Vec3>,
    workspace: Workspace,
}

impl Cutter {
    /// Gives the triangles of a polygon with area to `triangle`. A polygon has at least three corners.
    pub(in crate::scene::load) fn cut<C: Copy>(
        &mut self,
        corners: &[C],
        position: impl Fn(C) -> Vec3,
        mut triangle: impl FnMut([C; 3]),
    ) {
        if let &[a, b, c] = corners {
            return if is_degenerate([a, b, c].map(position)) {
                self.degenerate += 1;
            } else {
                triangle([a, b, c]);
            };
        }
        let Self { degenerate, points, workspace } = self;
        points.clear();
        points.extend(corners.iter().map(|&corner| position(corner)));
        points.truncate(round(points));
        workspace.triangulate(points, |indices| {
            if is_degenerate(indices.map(|i| points[i])) {
                *degenerate += 1;
            } else {
                triangle(indices.map(|i| corners[i]));
            }
        });
    }

    /// What to say of the triangles that were dropped, if any.
    pub(in crate::scene::load) fn warning(&self, path: &Path) -> Option<Problem> {
        let what = || format!("triangles without area are left out, {} in all", self.degenerate);
        (self.degenerate > 0).then(|| Problem::at(Place::file(path), what()))
    }

    /// What was dropped, if anything.
    pub(in crate::scene::load) fn dropped(&self) -> Option<String> {
        (self.degenerate > 0).then(|| format!("triangles without area, {} in all", self.degenerate))
    }
}

/// How many corners a polygon has until it goes round again, all of them if it does not.
fn round(points: &[Vec3]) -> usize {
    let n = points.len();
    let again = points[1..].iter().position(|p| *p == points[0]).map_or(n, |i| i + 1);
    if again >= 3 && n.is_multiple_of(again) && points[again..] == points[..n - again] { again } else { n }
}

/// Whether a triangle has no normal in single precision.
fn is_degenerate([a, b, c]: [Vec3; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    // Products of edges below 1e-22 are zero: such triangles are looked at again, enlarged.
    u.cross(v) == Vec3::ZERO && {
        let [u, v] = enlarged([u, v]);
        u.cross(v) == Vec3::ZERO
    }
}

/// Vectors of the same proportions whose greatest component is about 1; zero ones stay zero.
pub(super) fn enlarged<const N: usize>(vectors: [Vec3; N]) -> [Vec3; N] {
    let greatest = vectors.iter().fold(0.0, |greatest: f32, v| greatest.max(v.abs().max_element()));
    // Half of the exponents from the smallest normal number on have an inverse that is a normal number.
    let scale = 1.0 / greatest.max(f32::MIN_POSITIVE);
    vectors.map(|v| v * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_that_go_round_again_count_once() {
        let quad = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let count = |corners: &[Vec3]| {
            let mut count = 0;
            Cutter::default().cut(corners, |corner| corner, |_| count += 1);
            count
        };
        assert_eq!(count(&quad.repeat(3)), 2, "three times round");
        let bridge = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::ZERO, Vec3::X + Vec3::Y, Vec3::Y];
        assert_eq!(count(&bridge), 2, "back at the first corner, but elsewhere from there");
    }

    #[test]
    fn tiny_triangles_have_an_area_and_flat_ones_have_none() {
        for size in [-140.0, -100.0, -30.0, 0.0, 30.0, 59.0].map(f32::exp2) {
            let thin = [Vec3::ZERO, Vec3::X * size, Vec3::new(0.5, 0.0625, 0.25) * size];
            assert!(!is_degenerate(thin), "{size}");
            let flat = [Vec3::ZERO, Vec3::new(1.0, 0.5, 0.25) * size, Vec3::new(2.0, 1.0, 0.5) * size];
            assert!(is_degenerate(flat), "{size}");
        }
        assert!(is_degenerate([Vec3::ONE; 3]), "a point");
    }
}
