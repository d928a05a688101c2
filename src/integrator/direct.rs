//! Direct light: every light is asked once, lobes that are also followed share the answer with their own rays.

use crate::accel::Accel;
use crate::bsdf::{Bsdf, Lobes, fresnel};
use crate::geometry::{Interaction, Ray};
use crate::integrator::shading::Shading;
use crate::integrator::{Counters, Stage};
use crate::light::{Emitter, Light, LightSample, Reference};
use crate::material::Medium;
use crate::math::{Rgb, Vec3};
use crate::sampling::{Dim, Sampler, Vertex, heuristic};
use crate::scene::GlassShadows;

/// A point that light falls on.
pub(super) struct Receiver<'a> {
    pub(super) it: &'a Interaction,
    pub(super) shading: Shading,
    pub(super) bsdf: &'a Bsdf<f32>,
}

impl Receiver<'_> {
    /// Where lights are asked from.
    pub(super) fn reference(&self) -> Reference<f32> {
        Reference { p: self.it.p.into(), n: self.shading.frame.z }
    }
}

/// Radiance towards the viewer of light that comes straight from lights, scattered by diffuse and glossy lobes.
///
/// Glossy lobes are followed by rays of their own, which may meet the same lights: the two share by the power
/// heuristic (Veach 1997, Robust Monte Carlo Methods, 9.2). Diffuse lobes are not followed and take all.
pub(super) fn light<A: Accel, S: Sampler<I = u32>>(
    stage: &Stage<'_, A>,
    receiver: &Receiver<'_>,
    sampler: &S,
    vertex: Vertex,
    counters: &mut Counters,
) -> Rgb<f32> {
    let mut sum = Rgb::BLACK;
    if !receiver.bsdf.lobes().intersects(Lobes::DIFFUSE | Lobes::GLOSSY) {
        return sum;
    }
    for (index, light) in (0..).zip(&stage.scene.lights) {
        let u2 = if light.is_delta() { [0.5; 2] } else { sampler.get_2d(Dim::LightPoint(index), vertex) };
        let sample = light.sample(receiver.reference(), u2);
        let (diffuse, glossy) = scattered(receiver, light, &sample);
        if (diffuse + glossy).is_black() {
            continue;
        }
        let seen = visibility(stage, receiver.it, light, &sample, counters);
        // Through glass the rays of glossy lobes find their own, bent way.
        sum += diffuse * seen.through + if seen.clear { glossy } else { Rgb::BLACK };
    }
    sum
}

/// What diffuse and glossy lobes make of a light's sample, were nothing in between.
fn scattered(receiver: &Receiver<'_>, light: &Light, sample: &LightSample<f32>) -> (Rgb<f32>, Rgb<f32>) {
    let Receiver { shading, bsdf, .. } = receiver;
    let wi = shading.frame.to_local(sample.wi);
    // Light from behind the true surface would leak through it, whatever the interpolated normal says.
    if !sample.valid || wi.z <= 0.0 || sample.wi.dot(shading.ng.into()) <= 0.0 {
        return (Rgb::BLACK, Rgb::BLACK);
    }
    let arriving = sample.li * (wi.z / sample.pdf);
    let diffuse = bsdf.eval_diffuse(shading.wo, wi) * arriving;
    if !bsdf.lobes().intersects(Lobes::GLOSSY) {
        return (diffuse, Rgb::BLACK);
    }
    let share =
        if light.is_delta() { 1.0 } else { heuristic::power(sample.pdf, bsdf.pdf_glossy(shading.wo, wi)) };
    (diffuse, bsdf.eval_glossy(shading.wo, wi) * arriving * share)
}

/// What is left of light on its way.
struct Visibility {
    through: Rgb<f32>,
    /// Whether nothing, glass included, was in the way.
    clear: bool,
}

impl Visibility {
    const BLOCKED: Self = Self { through: Rgb::BLACK, clear: false };
    const CLEAR: Self = Self { through: Rgb::WHITE, clear: true };
}

/// The ray from a surface towards a light's sample.
fn towards(it: &Interaction, light: &Light, sample: &LightSample<f32>) -> Ray {
    if light.is_infinite() { it.spawn(sample.wi.into()) } else { it.spawn_to(sample.p.into()) }
}

/// How much of a light's sample arrives: all or nothing, but for straight ways through glass where the scene asks for
/// them.
fn visibility<A: Accel>(
    stage: &Stage<'_, A>,
    from: &Interaction,
    light: &Light,
    sample: &LightSample<f32>,
    counters: &mut Counters,
) -> Visibility {
    let ray = towards(from, light, sample);
    counters.shadow += 1;
    if stage.scene.glass_shadows == GlassShadows::Opaque {
        return if stage.accel.occluded(&ray) { Visibility::BLOCKED } else { Visibility::CLEAR };
    }
    let mut seen = Visibility::CLEAR;
    let mut ray = ray;
    while let Some(hit) = stage.accel.intersect(&ray) {
        let it = stage.scene.world.interaction(&ray, &hit);
        let Some(medium) = stage.scene.material(&it).1.medium() else { return Visibility::BLOCKED };
        seen.clear = false;
        seen.through *= passed(medium, &it, hit.t * ray.d.length());
        if seen.through.max_channel() < FAINTEST {
            return Visibility::BLOCKED;
        }
        ray = towards(&it, light, sample);
        counters.shadow += 1;
    }
    seen
}

/// Light that is less than this part of what it was is not followed through more glass.
const FAINTEST: f32 = 1e-4;

/// What a surface of glass passes on a straight way, and what the glass before it absorbed over `length`.
///
/// A body bends light in as it bends it out, so the true way meets both faces alike: the outer angle counts at each.
fn passed(medium: &Medium, it: &Interaction, length: f32) -> Rgb<f32> {
    let reflected = fresnel::dielectric(it.wo.dot(it.ns).abs(), medium.ior).reflectance;
    let inside = if it.is_front() { Rgb::WHITE } else { medium.absorption.scale(-length).exp() };
    inside.scale(1.0 - reflected)
}

/// The density, per solid angle, with which asking lights would have found what a ray from `at` along `wi` met.
pub(super) fn light_pdf(light: &Light, at: Reference<f32>, wi: Vec3<f32>, it: Option<&Interaction>) -> f32 {
    light.pdf(at, wi, it.map(|it| Emitter { p: it.p, ng: it.ng, prim: it.prim }).as_ref())
}
