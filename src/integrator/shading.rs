//! The frame in which a surface is shaded.

use crate::geometry::Interaction;
use crate::math::{Frame, Vec3};
use glam::Vec3 as Point;

/// Closer to the surface than this, mirrored rays are lifted: below it they would hit the surface that sent them.
const LOWEST: f32 = 1e-4;

/// A frame on the viewer's side of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shading {
    /// z is the shading normal on the side of the viewer.
    pub(super) frame: Frame<f32>,
    /// Towards the viewer, local; z is positive.
    pub(super) wo: Vec3<f32>,
    /// Unit geometric normal on the side of the viewer.
    pub(super) ng: Point,
}

impl Shading {
    /// The frame at an interaction; its x is `tangent` where one is given, else arbitrary. Interpolated normals that turn away from the viewer, or that mirror the view into the
    /// surface, are bent back just far enough, so that no surface shows black rims.
    pub(super) fn at(it: &Interaction, tangent: Option<Point>) -> Self {
        let side = if it.is_front() { 1.0 } else { -1.0 };
        let (ng, ns) = (it.ng * side, it.ns * side);
        let ns = if it.ns == it.ng { ns } else { bent(ns, ng, it.wo) };
        let frame = tangent.map_or_else(|| Frame::about(ns.into()), |tangent| along(ns, tangent));
        let mut wo = frame.to_local(it.wo.into());
        wo.z = wo.z.max(1e-7);
        Self { frame, wo, ng }
    }

    /// A local direction in the world.
    pub(super) fn to_world(self, wi: Vec3<f32>) -> Point {
        self.frame.to_world(wi).into()
    }
}

/// The frame about `ns` whose x is as near to `tangent` as can be.
fn along(ns: Point, tangent: Point) -> Frame<f32> {
    let x = (tangent - ns * tangent.dot(ns)).try_normalize().unwrap_or_else(|| ns.any_orthonormal_vector());
    Frame { x: x.into(), y: ns.cross(x).into(), z: ns.into() }
}

/// The normal nearest to `ns` that mirrors `wo` to a direction above the surface.
fn bent(ns: Point, ng: Point, wo: Point) -> Point {
    let mirrored = ns * (2.0 * wo.dot(ns)) - wo;
    let height = mirrored.dot(ng);
    if height >= LOWEST && wo.dot(ns) > 0.0 {
        return ns;
    }
    let lifted = (mirrored + ng * (LOWEST - height)).normalize_or(ng);
    (wo + lifted).normalize_or(ng)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bent_normals_mirror_above_the_surface() {
        let ng = Point::Z;
        for i in 0..200_u16 {
            let tilt = f32::from(i) * 0.01;
            let ns = Point::new(tilt.sin(), 0.2 * tilt.cos(), tilt.cos().abs()).normalize();
            for j in 1..100_u16 {
                let a = f32::from(j) * 0.0157;
                let wo = Point::new(-a.cos(), 0.0, a.sin()).normalize();
                let n = bent(ns, ng, wo);
                let out = n * (2.0 * wo.dot(n)) - wo;
                assert!(out.dot(ng) > 0.0, "ns {ns} wo {wo}: {out}");
                assert!(wo.dot(n) > 0.0, "ns {ns} wo {wo}: the normal turns away");
            }
        }
    }
}
