//! Direct light: every light is asked, once or several times; lobes that are also followed share the answer with their own
//! rays.

use crate::accel::Accel;
use crate::bsdf::{Bsdf, Lobes, Mix, Part};
use crate::geometry::{Interaction, Ray};
use crate::integrator::shading::Shading;
use crate::integrator::splitting::Counts;
use crate::integrator::{Counters, Stage, Worker};
use crate::light::{Emitter, Light, LightSample, Reference};
use crate::material::{Crossing, MOST_HIDDEN, Media};
use crate::math::{Rgb, Vec3};
use crate::sampling::{Dim, Sampler, Vertex, heuristic};
use crate::scene::needs::capability::Capability;

/// A point that light falls on.
pub(super) struct Receiver<'a> {
    pub(super) it: &'a Interaction,
    pub(super) shading: Shading<f32>,
    pub(super) mix: &'a Mix<f32>,
    /// The media on the viewer's side, and those on the other.
    pub(super) media: [Media; 2],
    /// How many rays are sent from here.
    pub(super) counts: Counts,
    /// Whether glossy lobes are followed as mirrors, which find lights with a size alone.
    pub(super) polished: bool,
}

/// Where lights are asked from: the viewer's side of the surface, or what lies `below` it.
pub(super) fn reference((it, shading): (&Interaction, Shading<f32>), below: bool) -> Reference<f32> {
    let n = shading.frame.z;
    Reference { p: it.p.into(), n: if below { -n } else { n } }
}

/// Radiance towards the viewer of light that comes straight from lights, scattered by diffuse and glossy lobes.
///
/// Glossy lobes are followed by rays of their own, which may meet the same lights: the two share by the power
/// heuristic with their numbers of rays (Veach 1997, Robust Monte Carlo Methods, 9.2). Diffuse lobes are not followed and
/// take all. Lights without size, which always give the same answer, are asked once. A constant environment is left to the
/// rays of glossy lobes: they know all that there is to know of it, and where it is free sharing adds noise.
///
/// Where the worker defers rays, what they will bring, times `carried`, is left out here.
pub(super) fn light<A: Accel, S: Sampler<I = u32>>(
    stage: &Stage<'_, A>,
    receiver: &Receiver<'_>,
    (sampler, vertex): (&S, Vertex),
    carried: Rgb<f32>,
    worker: &mut Worker,
) -> Rgb<f32> {
    let mut sum = Rgb::BLACK;
    let lobes = receiver.mix.lobes();
    if !lobes.intersects(Lobes::DIFFUSE | Lobes::GLOSSY) {
        return sum;
    }
    for (index, light) in (0..).zip(&stage.scene.lights) {
        let ways: &[bool] = if lobes.intersects(Lobes::THROUGH) { &[false, true] } else { &[false] };
        let factor = receiver.counts.light_factor().max(1.0).recip();
        let carried = if light.is_delta() { carried } else { carried.scale(factor) };
        let mut ask = |u2: [f32; 2]| {
            let of = |&below: &bool| from_light(stage, receiver, light, (u2, below, carried), worker);
            ways.iter().map(of).fold(Rgb::BLACK, |all, one| all + one)
        };
        if light.is_delta() {
            sum += ask([0.5; 2]);
            continue;
        }
        let Counts { lights: count, .. } = receiver.counts;
        let mut of_light = Rgb::BLACK;
        for j in 0..count {
            of_light += ask(sampler.get_2d_split(Dim::LightPoint(index), vertex, j, count));
        }
        sum += of_light.scale(factor);
    }
    sum
}

/// What one light brings by the way that `u2` draws, from above the surface or from `below`.
fn from_light<A: Accel>(
    stage: &Stage<'_, A>,
    receiver: &Receiver<'_>,
    light: &Light,
    (u2, below, carried): ([f32; 2], bool, Rgb<f32>),
    worker: &mut Worker,
) -> Rgb<f32> {
    let counters = &mut worker.counters;
    let sample = light.sample(reference((receiver.it, receiver.shading), below), u2);
    let (diffuse, glossy) = scattered(receiver, light, &sample, below);
    if (diffuse + glossy).is_black() {
        return Rgb::BLACK;
    }
    let Some(ray) = towards(stage, receiver, light, (&sample, below), counters) else { return Rgb::BLACK };
    // Through glass the rays of glossy lobes find their own, bent way to lights that they can meet.
    let passing = if light.is_delta() { diffuse + glossy } else { diffuse };
    let straight = !passing.is_black() && stage.scene.uses(Capability::GlassShadows);
    let mut unhindered = diffuse + glossy;
    let media = receiver.media[usize::from(below)];
    if stage.scene.uses(Capability::Absorption) {
        let length = left(light, &sample, receiver.it.p);
        unhindered *= stage.scene.absorbed(media.current(), length);
    }
    if let Some(deferred) = worker.deferred.as_mut().filter(|_| !straight) {
        counters.shadow += 1;
        deferred.push(&ray, carried * unhindered);
        return Rgb::BLACK;
    }
    if !straight {
        counters.shadow += 1;
        return if stage.accel.occluded(&ray) { Rgb::BLACK } else { unhindered };
    }
    let seen = visibility(stage, (&ray, media), light, &sample, counters);
    if seen.clear { unhindered } else { passing * seen.through }
}

/// What diffuse and glossy lobes make of a light's sample on one side, were nothing in between.
fn scattered(
    receiver: &Receiver<'_>,
    light: &Light,
    sample: &LightSample<f32>,
    below: bool,
) -> (Rgb<f32>, Rgb<f32>) {
    let Receiver { shading, mix, counts, polished, .. } = receiver;
    let wi = shading.frame.to_local(sample.wi);
    let cos = if below { -wi.z } else { wi.z };
    if !sample.valid || cos <= 0.0 || sample.li.is_black() {
        return (Rgb::BLACK, Rgb::BLACK);
    }
    let arriving = sample.li * (cos / sample.pdf);
    let mut glossy = Rgb::BLACK;
    let left_out = is_left_to_rays(light) && counts.glossy > 0;
    let mirrored = |bsdf: &Bsdf<f32>| *polished && !light.is_delta() && bsdf.is_fuzzy_mirror();
    let is_asked =
        |part: &&Part<f32>| !left_out && part.bsdf.lobes().intersects(Lobes::GLOSSY) && !mirrored(&part.bsdf);
    for part in mix.parts().filter(is_asked) {
        let share = if light.is_delta() {
            1.0
        } else {
            let drawn = part.bsdf.pdf_glossy(shading.wo, wi) * counts.glossy_factor();
            heuristic::power(sample.pdf * counts.light_factor(), drawn)
        };
        glossy += part.weight * part.bsdf.eval_glossy(shading.wo, wi) * share;
    }
    let diffuse = if below { Rgb::BLACK } else { mix.eval_diffuse(shading.wo, wi) };
    (diffuse * arriving, glossy * arriving)
}

/// Whether the rays of glossy lobes, where there are any, find this light alone.
fn is_left_to_rays(light: &Light) -> bool {
    matches!(light, Light::Environment(environment) if environment.constant().is_some())
}

/// What is left of light on its way.
struct Visibility {
    through: Rgb<f32>,
    /// Whether nothing, glass included, was in the way.
    clear: bool,
}

impl Visibility {
    const BLOCKED: Self = Self { through: Rgb::BLACK, clear: false };
}

/// The ray from a surface towards a light's sample; `None` where the surface itself is in the way.
fn towards<A: Accel>(
    stage: &Stage<'_, A>,
    receiver: &Receiver<'_>,
    light: &Light,
    (sample, below): (&LightSample<f32>, bool),
    counters: &mut Counters,
) -> Option<Ray> {
    let ray = receiver.shading.spawn(stage, receiver.it, (sample.wi.into(), below), counters)?;
    Some(if light.is_infinite() { ray } else { ray.towards(sample.p.into()) })
}

/// The ray from glass on towards a light's sample.
fn onwards(it: &Interaction, light: &Light, sample: &LightSample<f32>) -> Ray {
    if light.is_infinite() { it.spawn(sample.wi.into()) } else { it.spawn_to(sample.p.into()) }
}

/// How far it is to a light's sample.
fn left(light: &Light, sample: &LightSample<f32>, from: glam::Vec3) -> f32 {
    if light.is_infinite() { f32::INFINITY } else { from.distance(sample.p.into()) }
}

/// How much of a light's sample arrives where ways through glass are taken as straight: what surfaces pass on and media leave, but for the medium
/// of a way that is clear. Faces that overlapping media hide are not there.
fn visibility<A: Accel>(
    stage: &Stage<'_, A>,
    (first, mut media): (&Ray, Media),
    light: &Light,
    sample: &LightSample<f32>,
    counters: &mut Counters,
) -> Visibility {
    let scene = stage.scene;
    let mut seen = Visibility { through: Rgb::WHITE, clear: true };
    let mut ray = *first;
    for _ in 0..MOST_HIDDEN {
        counters.shadow += 1;
        let Some(hit) = stage.accel.intersect(&ray) else {
            if !seen.clear {
                seen.through *= scene.absorbed(media.current(), left(light, sample, ray.o));
            }
            return seen;
        };
        let it = scene.world.interaction(&ray, &hit);
        let (id, material) = scene.material(&it);
        if !material.scattering.is_clear() {
            return Visibility::BLOCKED;
        }
        seen.clear = false;
        seen.through *= scene.absorbed(media.current(), hit.t * ray.d.length());
        let crossing =
            material.medium().map(|medium| media.cross((id, medium), it.is_front(), material.is_interface()));
        let is_seen = !matches!(crossing, Some(Crossing::Hidden { .. }));
        if let Some(Crossing::Hidden { beyond } | Crossing::Interface { beyond, .. }) = crossing {
            media = beyond;
        }
        if is_seen {
            seen.through *= material.scattering.passes(it.wo.dot(it.ns).abs());
        }
        if seen.through.max_channel() < FAINTEST {
            return Visibility::BLOCKED;
        }
        ray = onwards(&it, light, sample);
    }
    Visibility::BLOCKED
}

/// Light that is less than this part of what it was is not followed through more glass.
const FAINTEST: f32 = 1e-4;

/// The density, per solid angle, with which asking lights would have found what a ray from `at` along `wi` met.
pub(super) fn light_pdf(light: &Light, at: Reference<f32>, wi: Vec3<f32>, it: Option<&Interaction>) -> f32 {
    light.pdf(at, wi, it.map(|it| Emitter { p: it.p, ng: it.ng, prim: it.prim }).as_ref())
}
