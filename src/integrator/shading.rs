//! The frame in which a surface is shaded.

use crate::geometry::Interaction;
use crate::math::lanes::{Lanes, Select};
use crate::math::{Frame, Vec3};

/// Closer to the surface than this, mirrored rays are lifted: below it they would hit the surface that sent them.
const LOWEST: f32 = 1e-4;

/// A frame on the viewer's side of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shading<F> {
    /// z is the shading normal on the side of the viewer.
    pub(super) frame: Frame<F>,
    /// Towards the viewer, local; z is positive.
    pub(super) wo: Vec3<F>,
    /// Unit geometric normal on the side of the viewer.
    pub(super) ng: Vec3<F>,
}

impl Shading<f32> {
    /// The frame at an interaction; its x is `tangent` where one is given, else arbitrary.
    pub(super) fn at(it: &Interaction, tangent: Option<glam::Vec3>) -> Self {
        Self::seen(it.wo.into(), [it.ng.into(), it.ns.into()], tangent.map(Into::into))
    }
}

impl<F: Lanes> Shading<F> {
    /// The frame where a surface is seen from `wo`, a unit vector, given its geometric and its shading normal; x is the
    /// tangent where one is given, else arbitrary. Interpolated normals that turn away from the viewer, or that mirror the view
    /// into the surface, are bent back just far enough, so that no surface shows black rims.
    #[inline(always)]
    pub(super) fn seen(wo: Vec3<F>, [ng, ns]: [Vec3<F>; 2], tangent: Option<Vec3<F>>) -> Self {
        let front = wo.dot(ng).gt(0.0);
        let (ng, ns) = (Vec3::select(front, ng, -ng), Vec3::select(front, ns, -ns));
        let flat = ns.x.eq(ng.x) & ns.y.eq(ng.y) & ns.z.eq(ng.z);
        let ns = Vec3::select(flat, ns, bent(ns, ng, wo));
        let frame = match tangent {
            Some(tangent) => along(ns, tangent),
            None => Frame::about(ns),
        };
        let mut wo = frame.to_local(wo);
        wo.z = wo.z.max(1e-7);
        Self { frame, wo, ng }
    }

    /// A local direction in the world; unit.
    #[inline(always)]
    pub(super) fn to_world(self, wi: Vec3<F>) -> Vec3<F> {
        self.frame.to_world(wi).normalize()
    }
}

/// The frame about `ns` whose x is as near to `tangent` as can be.
#[inline(always)]
fn along<F: Lanes>(ns: Vec3<F>, tangent: Vec3<F>) -> Frame<F> {
    let x = (tangent - ns * tangent.dot(ns)).normalize_or(Frame::about(ns).x);
    Frame { x, y: ns.cross(x), z: ns }
}

/// The normal nearest to `ns` that mirrors `wo` to a direction above the surface.
#[inline(always)]
fn bent<F: Lanes>(ns: Vec3<F>, ng: Vec3<F>, wo: Vec3<F>) -> Vec3<F> {
    let mirrored = wo.reflect(ns);
    let height = mirrored.dot(ng);
    let above = height.ge(LOWEST) & wo.dot(ns).gt(0.0);
    let lifted = (mirrored + ng * (-height + LOWEST)).normalize_or(ng);
    Vec3::select(above, ns, (wo + lifted).normalize_or(ng))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3 as Point;

    #[test]
    fn bent_normals_mirror_above_the_surface() {
        let ng = Point::Z;
        for i in 0..200_u16 {
            let tilt = f32::from(i) * 0.01;
            let ns = Point::new(tilt.sin(), 0.2 * tilt.cos(), tilt.cos().abs()).normalize();
            for j in 1..100_u16 {
                let a = f32::from(j) * 0.0157;
                let wo = Point::new(-a.cos(), 0.0, a.sin()).normalize();
                let n: Point = bent::<f32>(ns.into(), ng.into(), wo.into()).into();
                let out = n * (2.0 * wo.dot(n)) - wo;
                assert!(out.dot(ng) > 0.0, "ns {ns} wo {wo}: {out}");
                assert!(wo.dot(n) > 0.0, "ns {ns} wo {wo}: the normal turns away");
            }
        }
    }
}
