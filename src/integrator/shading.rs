//! The frame in which a surface is shaded, and where rays leave it.
//!
//! Meshes are shaded with normals of a smooth surface that they only stand for. Two things go wrong without care. A mirrored
//! ray may go into the mesh: the normal is bent until it does not. And light may come from above the smooth surface, but from
//! below the triangle, which then is black beside lit neighbours: such rays start from the smooth surface instead (Hanika
//! 2021, Hacking the Shadow Terminator), if nothing stands in between.

use crate::accel::Accel;
use crate::geometry::{Interaction, Ray, spawn};
use crate::integrator::{Counters, Stage};
use crate::math::{Frame, Vec3};
use glam::Vec3 as Point;

/// Closer to the surface than this, mirrored rays are lifted: below it they would hit the surface that sent them.
const LOWEST: f32 = 1e-4;

/// Square of how many times its error a point must lie below the smooth surface: less is rounding, not form.
const LEAST_LIFT: f32 = 16.0;

/// How far the way to the smooth surface must be free, in its lengths. Just to its end, and a wall that stands there is passed by
/// the rounding of one or the other; farther than needed leaves facets near walls in the dark.
const PAST: f32 = 1.01;

/// A frame on the viewer's side of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shading {
    /// z is the shading normal on the side of the viewer.
    pub(super) frame: Frame<f32>,
    /// Towards the viewer, local; z is positive.
    pub(super) wo: Vec3<f32>,
    /// Unit geometric normal on the side of the viewer.
    ng: Point,
    /// From the point to the smooth surface above it, and to that below it, seen from the viewer's side.
    lift: [Point; 2],
}

impl Shading {
    /// The frame at an interaction; its x is `tangent` where one is given, else arbitrary. Interpolated normals that turn away
    /// from the viewer, or that mirror the view into the surface, are bent back just far enough, so that no surface shows black
    /// rims.
    pub(super) fn at(it: &Interaction, tangent: Option<Point>) -> Self {
        let side = if it.is_front() { 1.0 } else { -1.0 };
        let (ng, ns) = (it.ng * side, it.ns * side);
        let ns = if it.ns == it.ng { ns } else { bent(ns, ng, it.wo) };
        let frame = tangent.map_or_else(|| Frame::about(ns.into()), |tangent| along(ns, tangent));
        let mut wo = frame.to_local(it.wo.into());
        wo.z = wo.z.max(1e-7);
        let [outer, inner] = it.lift;
        let lift = if it.is_front() { [outer, inner] } else { [inner, outer] };
        Self { frame, wo, ng, lift }
    }

    /// The ray that leaves the interaction along `d`, which is above the shading normal's horizon, or `below` it; `None` where
    /// that is not so of the surface itself and the ray cannot start from the smooth surface instead.
    pub(super) fn spawn<A: Accel>(
        &self,
        stage: &Stage<'_, A>,
        it: &Interaction,
        (d, below): (Point, bool),
        counters: &mut Counters,
    ) -> Option<Ray> {
        let side = if below { -1.0 } else { 1.0 };
        if d.dot(self.ng) * side > 0.0 {
            return Some(it.spawn(d));
        }
        let lift = self.lift[usize::from(below)];
        if lift.length_squared() <= LEAST_LIFT * it.p_error.length_squared() {
            return None;
        }
        // A wall that the smooth surface would reach through must not let light through.
        counters.shadow += 1;
        let lifted = it.p + lift;
        let n = Point::from(self.frame.z) * side;
        let is_free = d.dot(n) > 0.0 && !stage.accel.occluded(&it.spawn_to(lifted).until(PAST));
        is_free.then(|| spawn::ray(lifted, it.p_error, n, d).at_time(it.time))
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
