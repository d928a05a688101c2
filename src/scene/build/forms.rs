//! Shapes made of numbers, and shapes moved to their place.

use crate::geometry::{Disc, Mesh, MeshError, Shape, Sphere};
use crate::math::Transform;
use glam::{Affine3A, Vec2, Vec3};

/// Two triangles; its outside is that of `u` x `v`, and surface parameters run from 0 to 1 along them.
pub(super) fn rectangle(center: Vec3, u: Vec3, v: Vec3) -> Result<Mesh, MeshError> {
    quads(&[[center - u - v, center + u - v, center + u + v, center - u + v]])
}

/// Twelve triangles facing outwards, surface parameters from 0 to 1 on each face.
pub(super) fn cuboid(min: Vec3, max: Vec3) -> Result<Mesh, MeshError> {
    let corner = |x: u8, y: u8, z: u8| {
        let pick = |high: u8, low: f32, up: f32| if high == 1 { up } else { low };
        Vec3::new(pick(x, min.x, max.x), pick(y, min.y, max.y), pick(z, min.z, max.z))
    };
    quads(&[
        [corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)],
        [corner(1, 0, 0), corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0)],
        [corner(1, 0, 1), corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1)],
        [corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0)],
        [corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0), corner(0, 1, 0)],
        [corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)],
    ])
}

fn quads(faces: &[[Vec3; 4]]) -> Result<Mesh, MeshError> {
    let positions = faces.iter().flatten().copied().collect();
    let triangles =
        (0..).step_by(4).take(faces.len()).flat_map(|i| [[i, i + 1, i + 2], [i, i + 2, i + 3]]).collect();
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let uvs = faces.iter().flat_map(|_| corners).collect();
    Mesh::new(positions, triangles)?.with_uvs(uvs)
}

/// The shape carried to its place, where it stays of its kind: meshes under every map, spheres and discs where angles and
/// proportions stay, others there, too, if they say how.
pub(super) fn moved(shape: &Shape, map: &Affine3A) -> Option<Shape> {
    let transform = Transform::new(*map)?;
    Some(match shape {
        Shape::Mesh(mesh) => Shape::Mesh(mesh.transformed(&transform)),
        Shape::Sphere(sphere) => {
            let center = transform.point(sphere.center);
            Shape::Sphere(Sphere { center, radius: sphere.radius * uniform_scale(map)? })
        }
        Shape::Disc(disc) => Shape::Disc(Disc {
            center: transform.point(disc.center),
            normal: transform.normal(disc.normal).normalize(),
            radius: disc.radius * uniform_scale(map)?,
        }),
        Shape::Surface(surface) => Shape::Surface(surface.scaled(&transform, uniform_scale(map)?)?),
    })
}

/// Whether the moved shape has the surface parameters of the shape itself: those of spheres and discs run about axes of the world.
pub(super) fn keeps_parameters(shape: &Shape, map: &Affine3A) -> bool {
    let m = &map.matrix3;
    let aside = [m.x_axis.y, m.x_axis.z, m.y_axis.x, m.y_axis.z, m.z_axis.x, m.z_axis.y];
    let is_turned = aside.iter().any(|x| x.abs() > 0.0);
    let is_mirrored = m.x_axis.x.min(m.y_axis.y).min(m.z_axis.z) <= 0.0;
    !matches!(shape, Shape::Sphere(_) | Shape::Disc(_)) || !(is_turned || is_mirrored)
}

/// The factor by which a map scales all lengths alike.
fn uniform_scale(map: &Affine3A) -> Option<f32> {
    let m = &map.matrix3;
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    let scale = x.length();
    let tolerance = 1e-5 * scale;
    let alike = (y.length() - scale).abs() < tolerance && (z.length() - scale).abs() < tolerance;
    let square = [x.dot(y), y.dot(z), z.dot(x)].iter().all(|dot| dot.abs() < tolerance * scale);
    (alike && square).then_some(scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_and_rectangles_face_outwards() {
        let mesh = cuboid(Vec3::new(-1.0, -2.0, -3.0), Vec3::new(1.0, 2.0, 3.0)).expect("a box");
        assert_eq!(mesh.triangles().len(), 12, "two per face");
        for triangle in 0..12 {
            let [a, b, c] = mesh.corners(triangle);
            assert!((b - a).cross(c - a).dot(a) > 0.0, "triangle {triangle} faces inwards");
        }
        let flat = rectangle(Vec3::ZERO, Vec3::X, Vec3::Y).expect("a rectangle");
        let [a, b, c] = flat.corners(0);
        assert!((b - a).cross(c - a).z > 0.0, "u x v");
    }

    #[test]
    fn spheres_stay_spheres_only_under_similarities() {
        let ball = Shape::Sphere(Sphere { center: Vec3::X, radius: 2.0 });
        let map = Affine3A::from_scale(Vec3::splat(-3.0)) * Affine3A::from_rotation_x(0.4);
        let Some(Shape::Sphere(sphere)) = moved(&ball, &map) else { panic!("lost the sphere") };
        assert!((sphere.radius - 6.0).abs() < 1e-5, "radius");
        assert!(moved(&ball, &Affine3A::from_scale(Vec3::new(1.0, 1.0, 2.0))).is_none(), "an ellipsoid");
    }
}
