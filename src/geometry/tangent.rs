//! The direction along a surface that brushed materials count from.

use crate::geometry::{Interaction, Shape, World};
use glam::{Vec2, Vec3};

/// The axis, in world space, around which surfaces without texture coordinates are taken to be turned.
const AXIS: Vec3 = Vec3::Y;

impl World {
    /// The direction in which the first surface parameter grows, in world space, at right angles to the shading normal; unit.
    ///
    /// Meshes have it from the texture coordinates of their file, one direction per triangle. All other shapes, and meshes
    /// without texture coordinates, are taken to be turned on a lathe about the world's y axis: the direction is that of
    /// the motion. Where the normal is that axis, and where coordinates do not span a triangle, it is arbitrary.
    #[must_use]
    pub fn tangent(&self, it: &Interaction) -> Vec3 {
        let placement = &self.placements[it.placement.index()];
        let along = match &self.shapes[placement.shape.index()] {
            Shape::Mesh(mesh) => {
                mesh.corner_uvs(it.prim).and_then(|uvs| growth(mesh.corners_at(it.prim, it.time), uvs))
            }
            _ => None,
        };
        let along = match (along, placement.pose.at(it.time)) {
            (Some(along), Some(map)) => map.vector(along),
            (Some(along), None) => along,
            (None, _) => AXIS.cross(it.ns),
        };
        let flat = along - it.ns * along.dot(it.ns);
        flat.try_normalize().unwrap_or_else(|| it.ns.any_orthonormal_vector())
    }
}

/// The direction in which the first parameter of a triangle grows while the second stays.
fn growth([a, b, c]: [Vec3; 3], [s, t, u]: [Vec2; 3]) -> Option<Vec3> {
    let (e1, e2) = (b - a, c - a);
    let (d1, d2) = (t - s, u - s);
    let area = d1.perp_dot(d2);
    let along = (e1 * d2.y - e2 * d1.y) * area.signum();
    (area != 0.0 && along.is_finite() && along != Vec3::ZERO).then_some(along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_parameter_grows_along_it() {
        let corners = [Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 1.0)];
        // u = y / 3, v = -x: u grows along the second edge.
        let uvs = [Vec2::ZERO, Vec2::new(0.0, -2.0), Vec2::new(1.0, 0.0)];
        let along = growth(corners, uvs).expect("uvs span the triangle");
        assert!((along.normalize() - Vec3::new(0.0, 3.0, 1.0).normalize()).length() < 1e-6, "{along}");
        assert_eq!(growth(corners, [Vec2::ONE; 3]), None, "one point has no direction");
    }
}
