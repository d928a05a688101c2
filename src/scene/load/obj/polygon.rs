//! From polygons to triangles.
//!
//! Convex polygons become fans. From others, ears are cut off one by one: corners whose triangle turns the way the whole
//! does and holds no other corner (Meisters 1975, Polygons have ears). Polygons that cross themselves have no right
//! answer; they get as many triangles as any other.

use glam::{DVec2, DVec3, Vec3};

/// Polygons of more corners are made fans in any case: where there are no ears, cutting takes time with the cube of their number.
const MOST_CORNERS: usize = 1000;

/// Triangles of a polygon, as indices into its corners, turning the way it does; two less than there are corners.
pub(super) fn triangulate(corners: &[Vec3], mut triangle: impl FnMut([usize; 3])) {
    let n = corners.len();
    let flat = flatten(corners);
    let convex = (0..n).all(|i| turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) >= 0.0);
    if n == 3 || convex || n > MOST_CORNERS {
        (2..n).for_each(|i| triangle([0, i - 1, i]));
        return;
    }
    let mut left: Vec<usize> = (0..n).collect();
    while left.len() > 3 {
        // A polygon that crosses itself can be without an ear: then any corner must do.
        let ear = (0..left.len()).find(|&i| is_ear(&left, i, &flat)).unwrap_or(0);
        let [before, after] = neighbours(&left, ear);
        triangle([before, left[ear], after]);
        left.remove(ear);
    }
    triangle([left[0], left[1], left[2]]);
}

/// The corners in the plane that the polygon is most nearly in, turning counter-clockwise as a whole.
fn flatten(corners: &[Vec3]) -> Vec<DVec2> {
    let origin = corners[0].as_dvec3();
    let points: Vec<DVec3> = corners.iter().map(|p| p.as_dvec3() - origin).collect();
    // Twice the area as a vector (Newell).
    let area: DVec3 = (0..points.len()).map(|i| points[i].cross(points[(i + 1) % points.len()])).sum();
    let (x, y) = area.try_normalize().unwrap_or(DVec3::Z).any_orthonormal_pair();
    points.iter().map(|p| DVec2::new(p.dot(x), p.dot(y))).collect()
}

fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - b)
}

fn neighbours(left: &[usize], i: usize) -> [usize; 2] {
    [left[(i + left.len() - 1) % left.len()], left[(i + 1) % left.len()]]
}

fn is_ear(left: &[usize], i: usize, points: &[DVec2]) -> bool {
    let [before, after] = neighbours(left, i);
    let [a, b, c] = [points[before], points[left[i]], points[after]];
    let holds = |p: DVec2| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    // Corners may coincide, where an outline runs along itself to a hole: those are not inside.
    let inside = |&j: &usize| ![a, b, c].contains(&points[j]) && holds(points[j]);
    turn(a, b, c) > 0.0 && !left.iter().any(inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[Vec3]) -> (usize, f32) {
        let (mut count, mut area) = (0, 0.0);
        triangulate(corners, |[a, b, c]| {
            count += 1;
            let (u, v) = (corners[b] - corners[a], corners[c] - corners[a]);
            assert!(u.cross(v).z >= 0.0, "a triangle is turned over");
            area += u.cross(v).length() * 0.5;
        });
        (count, area)
    }

    #[test]
    fn triangles_cover_the_polygon_once() {
        let at = |x, y| Vec3::new(x, y, 5.0);
        let square = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        assert_eq!(area(&square), (2, 1.0), "convex");
        let arrow = [at(0.0, 0.0), at(2.0, -1.0), at(1.0, 0.0), at(2.0, 1.0)];
        assert_eq!(area(&arrow), (2, 1.0), "concave at a corner that a fan from the first splits well");
        let arrow = [at(2.0, -1.0), at(1.0, 0.0), at(2.0, 1.0), at(0.0, 0.0)];
        assert_eq!(area(&arrow), (2, 1.0), "concave, and a fan would turn one over");
        let comb =
            [(0, 0), (5, 0), (5, 2), (4, 2), (4, 1), (3, 1), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)];
        let comb: Vec<Vec3> = comb.iter().map(|&(x, y): &(u8, u8)| at(x.into(), y.into())).collect();
        assert_eq!(area(&comb), (10, 8.0), "two notches");
    }
}
