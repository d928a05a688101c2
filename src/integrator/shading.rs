//! The frame in which a surface is shaded, and where rays leave it.
//!
//! Meshes are shaded with normals of a smooth surface that they only stand for. Two things go wrong without care. A mirrored
//! ray may go into the mesh: the normal is bent until it does not. And light may come from above the smooth surface, but from
//! below the triangle, which then is black beside lit neighbours: such rays start from the smooth surface instead (Hanika
//! 2021, Hacking the Shadow Terminator), if nothing stands in between.

use crate::accel::Accel;
use crate::geometry::{Interaction, Ray, spawn};
use crate::integrator::{Counters, Stage};
use crate::math::lanes::{Lanes, MaskLanes, Select};
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
pub(super) struct Shading<F> {
    /// z is the shading normal on the side of the viewer.
    pub(super) frame: Frame<F>,
    /// Towards the viewer, local; z is positive.
    pub(super) wo: Vec3<F>,
    /// Unit geometric normal on the side of the viewer.
    pub(super) ng: Vec3<F>,
}

/// A ray that starts from the smooth surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lifted {
    /// The ray.
    pub(super) ray: Ray,
    /// The way to its start, on which nothing may stand: a wall that the smooth surface would reach through must not let light
    /// through.
    pub(super) guard: Ray,
}

impl Shading<f32> {
    /// The frame at an interaction; its x is `tangent` where one is given, else arbitrary.
    pub(super) fn at(it: &Interaction, tangent: Option<Point>) -> Self {
        Self::seen(it.wo.into(), [it.ng.into(), it.ns.into()], tangent.map(Into::into))
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
        if (d.dot(self.ng.into()) < 0.0) == below {
            return Some(it.spawn(d));
        }
        let Lifted { ray, guard } = lifted(it, self.frame.z.into(), (d, below))?;
        counters.shadow += 1;
        (!stage.accel.occluded(&guard)).then_some(ray)
    }
}

/// The ray along `d`, above the horizon of the shading normal `ns` or `below` it, that starts from the smooth surface.
pub(super) fn lifted(it: &Interaction, ns: Point, (d, below): (Point, bool)) -> Option<Lifted> {
    // Of the lifts the first is for the outside.
    let lift = it.lift[usize::from(it.is_front() == below)];
    let n = if below { -ns } else { ns };
    if lift.length_squared() <= LEAST_LIFT * it.p_error.length_squared() || d.dot(n) <= 0.0 {
        return None;
    }
    let start = it.p + lift;
    let ray = spawn::ray(start, it.p_error, n, d).at_time(it.time);
    Some(Lifted { ray, guard: it.spawn_to(start).until(PAST) })
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
        let ns = if flat.all() { ns } else { Vec3::select(flat, ns, bent(ns, ng, wo)) };
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
