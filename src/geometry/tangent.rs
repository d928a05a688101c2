//! The direction along a surface that brushed materials count from.

use crate::geometry::{Interaction, Shape, World};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// The axis, in world space, around which surfaces without texture coordinates are taken to be turned.
const AXIS: Vec3 = Vec3::Y;

/// How surface parameters lie on a surface at a point, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    /// How the point moves as the first parameter grows while the second stays.
    pub along_u: Vec3,
    /// The same for the second.
    pub along_v: Vec3,
}

impl Grain {
    /// How many units of the parameters there are to a metre, as a mean over directions.
    #[must_use]
    pub fn density(&self) -> f32 {
        self.along_u.cross(self.along_v).length().max(f32::MIN_POSITIVE).recip().sqrt()
    }

    /// The directions in which the parameters grow, at right angles to the unit normal `ns` and to each other: the first as it is,
    /// the second on its side; unit. `None` where the parameters do not span the surface.
    #[must_use]
    pub fn frame(&self, ns: Vec3) -> Option<[Vec3; 2]> {
        let x = (self.along_u - ns * self.along_u.dot(ns)).try_normalize()?;
        let y = ns.cross(x);
        Some([x, if y.dot(self.along_v) < 0.0 { -y } else { y }])
    }

    /// By how much a number grows over a metre, in the direction in which it grows fastest at right angles to the unit normal `ns`,
    /// if it grows so much with a unit of each parameter. `None` where the parameters do not span the surface.
    #[must_use]
    pub fn uphill(&self, ns: Vec3, [with_u, with_v]: [f32; 2]) -> Option<Vec3> {
        let (across_v, across_u) = (self.along_v.cross(ns), ns.cross(self.along_u));
        let uphill = (across_v * with_u + across_u * with_v) / self.along_u.dot(across_v);
        uphill.is_finite().then_some(uphill)
    }
}

impl World {
    /// How surface parameters lie at a point, on meshes that have them and on spheres.
    #[must_use]
    pub fn grain(&self, it: &Interaction) -> Option<Grain> {
        let placement = &self.placements[it.placement.index()];
        let map = placement.pose.at(it.time);
        let own = match &self.shapes[placement.shape.index()] {
            Shape::Mesh(mesh) => spans(mesh.corners_at(it.prim, it.time), mesh.corner_uvs(it.prim)?)?,
            Shape::Sphere(sphere) => {
                let n = match &map {
                    None => it.ng,
                    Some(map) => map.world_from_object().inverse().transform_point3(it.p) - sphere.center,
                };
                let n = n.try_normalize()?;
                let around = Vec3::Z.cross(n);
                let down = around.try_normalize()?.cross(n);
                [around * (TAU * sphere.radius), down * (PI * sphere.radius)]
            }
            _ => return None,
        };
        let [along_u, along_v] = own.map(|v| map.as_ref().map_or(v, |map| map.vector(v)));
        Some(Grain { along_u, along_v })
    }

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

/// How the point of a triangle moves as each of its parameters grows; `None` where they do not span it.
fn spans([a, b, c]: [Vec3; 3], [s, t, u]: [Vec2; 3]) -> Option<[Vec3; 2]> {
    let (e1, e2) = (b - a, c - a);
    let (d1, d2) = (t - s, u - s);
    let area = d1.perp_dot(d2);
    let along = [(e1 * d2.y - e2 * d1.y) / area, (e2 * d1.x - e1 * d2.x) / area];
    along.iter().all(|v| v.is_finite()).then_some(along)
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
        assert_eq!(spans(corners, [Vec2::ONE; 3]), None, "nor do two grow");
        let [along_u, along_v] = spans(corners, uvs).expect("uvs span the triangle");
        assert!((along_u - Vec3::new(0.0, 3.0, 1.0)).length() < 1e-6, "{along_u}: a whole edge");
        assert!((along_v - Vec3::new(-1.0, 0.0, 0.0)).length() < 1e-6, "{along_v}: against the other");
        let grain = Grain { along_u, along_v };
        let n = corners[1].cross(corners[2]).normalize();
        let uphill = grain.uphill(n, [1.0, 2.0]).expect("spanned");
        assert!(uphill.dot(n).abs() < 1e-6, "{uphill}: in the plane");
        assert!((uphill.dot(along_u) - 1.0).abs() < 1e-6, "{uphill}: with u");
        assert!((uphill.dot(along_v) - 2.0).abs() < 1e-6, "{uphill}: with v");
        let mirrored = Grain { along_u: along_v, along_v: along_u }.uphill(n, [2.0, 1.0]).expect("spanned");
        assert!((mirrored - uphill).length() < 1e-6, "{mirrored}: whatever their order");
        assert!((grain.density() - 10.0_f32.powf(-0.25)).abs() < 1e-6, "{}", grain.density());
    }
}
