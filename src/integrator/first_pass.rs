//! A camera ray for fuzzy reflections that are filtered afterwards: light, and where mirrored light comes from.
//!
//! The ray tree with glossy lobes as ideal mirrors (`polished`). What comes along the mirrored ray of the first surface is kept apart, with
//! both ends of that ray; nothing else is to be blurred. Of a mix the lobe that reflects most is kept apart. Lights without a size are
//! found by no ray: their highlights are asked for as ever, in the shape of the lobe. Reflections in reflections stay sharp.

use super::whitted::Node;
use super::{CameraRay, Radiance, Stage, Whitted, Worker};
use crate::accel::Accel;
use crate::bsdf::LobeOfMirror;
use crate::geometry::PlacementId;
use crate::math::Rgb;
use crate::sampling::Sampler;
use glam::Vec3;

/// What a camera ray brings home.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstPass {
    /// All light but that of the reflection that is kept apart.
    pub rest: Radiance,
    /// The reflection of the first surface, where it is fuzzy.
    pub reflection: Option<Reflection>,
}

/// A fuzzy reflection as a sharp one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection {
    /// Light along the mirrored ray.
    pub radiance: Rgb<f32>,
    /// What is made of it: how much is sent on, and the lobe it is to be blurred by.
    pub lobe: LobeOfMirror,
    /// Where it is mirrored.
    pub a: Vec3,
    /// Distance of that from the eye, in metres.
    pub s: f32,
    /// Unit normal there, on the viewer's side.
    pub normal: Vec3,
    /// Direction of the mirrored ray.
    pub d: Vec3,
    /// What it hits, and where; nothing if it escapes.
    pub end: Option<(PlacementId, Vec3)>,
    /// What it is mirrored by.
    pub reflector: PlacementId,
}

impl Whitted {
    /// Follows a camera ray; the tree must be `polished`, and the worker must not defer rays.
    pub fn first_pass<A: Accel, S: Sampler<I = u32>>(
        &self,
        stage: &Stage<'_, A>,
        camera: &CameraRay,
        sampler: &S,
        worker: &mut Worker,
    ) -> FirstPass {
        debug_assert!(self.polished && worker.deferred.is_none(), "a tree of mirrors, all at once");
        worker.counters.camera += 1;
        let mut node = Node::of_camera(stage, camera);
        let mut rest = Radiance::NOTHING;
        let Some(met) = self.meet(stage, &mut node, sampler, worker, &mut rest) else {
            return FirstPass { rest, reflection: None };
        };
        let lobes = (0..).zip(met.mix.parts()).filter_map(|(index, part)| {
            let LobeOfMirror { weight, exponent } = part.bsdf.lobe_of_mirror(met.shading.wo)?;
            Some((index, LobeOfMirror { weight: part.weight * weight, exponent }))
        });
        let chosen = lobes.max_by(|a, b| a.1.weight.max_channel().total_cmp(&b.1.weight.max_channel()));
        let at = met.at(stage, &node);
        let mut apart = None;
        for (index, part) in (0..).zip(met.mix.parts()) {
            match chosen {
                // Such a lobe has no branches besides.
                Some((of, lobe)) if of == index => {
                    apart = at.mirror_child((index, part), &mut worker.counters).map(|child| (child, lobe));
                }
                _ => self.push(&at, (index, part), sampler, worker),
            }
        }
        self.finish(stage, sampler, worker, &mut rest);
        let reflection = apart.map(|(mut child, lobe)| {
            let hit = stage.accel.intersect(&child.ray);
            let end = hit.map(|hit| {
                let it = stage.scene.world.interaction(&child.ray, &hit);
                (it.placement, it.p)
            });
            let d = child.ray.d;
            child.found = Some(hit);
            // What is sent on is multiplied in after the filter.
            child.beta = Rgb::WHITE;
            let mut light = Radiance::NOTHING;
            if self.pend(child, worker) {
                worker.counters.reflected += 1;
                self.finish(stage, sampler, worker, &mut light);
            }
            Reflection {
                radiance: light.color,
                lobe,
                a: met.it.p,
                s: met.it.p.distance(camera.ray.o),
                normal: met.shading.frame.z.into(),
                d,
                end,
                reflector: met.it.placement,
            }
        });
        FirstPass { rest, reflection }
    }
}
