//! Rays and triangles, exactly.

use glam::Vec3;

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
}
