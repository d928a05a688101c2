//! What surfaces make of a path: where it goes on, and what they make of light that is asked.

use super::met::Met;
use super::surfaces::Surfaces;
use super::vertex::Beyond;
use crate::bsdf::choice::{Answer, Question, Step, ask};
use crate::bsdf::{Diffuse, with_lobe};
use crate::material::{Layer, Scattering};
use crate::math::Rgb;
use crate::math::lanes::{Compare, IntLanes, Isa, Lanes, MaskLanes, Select};
use crate::scene::Scene;
use crate::texture::Texture;

/// What surfaces answer, material by material.
#[inline(always)]
pub(super) fn scatter<S: Isa, const N: usize>(
    isa: S,
    (scene, surfaces): (&Scene, &Surfaces),
    met: &Met<S>,
    beyond: &Beyond<N>,
    question: &Question<S::F>,
) -> Answer<S::F> {
    let eta = isa.load(&beyond.eta);
    let mut all = Answer::black(question.wo);
    let mut bits = met.hit.bits();
    let kinds = surfaces.alike(isa, met.materials);
    while bits != 0 {
        let id = kinds.extract(bits.trailing_zeros() as usize);
        let same = Compare::<u32>::eq(kinds, id) & met.hit;
        bits &= !same.bits();
        let found = match &scene.materials[id as usize].scattering {
            Scattering::Diffuse { reflectance: Texture::Constant(_) } => {
                let reflectance = surfaces.colors(isa, S::I::select(same, met.materials, isa.splat_u32(id)));
                ask(isa, &Diffuse { reflectance }, question)
            }
            scattering => of_material(isa, scattering, (met, eta), question),
        };
        if same.bits() == met.hit.bits() {
            // Lobes answer for all lanes, and those without a hit have no media.
            let step = Step { valid: found.step.valid & met.hit, ..found.step };
            return Answer { step, ..found };
        }
        all = Answer::select(same, found, all);
    }
    all
}

#[inline(always)]
fn of_material<S: Isa>(
    isa: S,
    scattering: &Scattering,
    (met, eta): (&Met<S>, S::F),
    question: &Question<S::F>,
) -> Answer<S::F> {
    match scattering {
        Scattering::Mix(layers) => of_layers(isa, layers, (met, eta), question),
        single => match single.single(met.spot(), eta) {
            Some(bsdf) => with_lobe!(&bsdf, lobe => ask(isa, lobe, question)),
            None => Answer::black(question.wo),
        },
    }
}

/// One of the layers is chosen for the way on, each with the probability of its greatest weight.
#[inline(always)]
fn of_layers<S: Isa>(
    isa: S,
    layers: &[Layer],
    (met, eta): (&Met<S>, S::F),
    question: &Question<S::F>,
) -> Answer<S::F> {
    let mut total = 0.0;
    for layer in layers {
        total += share_of(layer);
    }
    let mut all = Answer::black(question.wo);
    let mut at = 0.0;
    for layer in layers {
        let probability = share_of(layer) / total;
        if share_of(layer) <= 0.0 {
            continue;
        }
        let Some(bsdf) = layer.scattering.single(met.spot(), eta) else { continue };
        let chosen = question.choice.ge(at);
        let inverse = 1.0 / probability;
        // What is left of the number is as good as new within the layer.
        let choice = ((question.choice - at) * inverse).clamp(0.0, 1.0 - f32::EPSILON);
        let own = Question { choice, light_pdf: question.light_pdf * inverse, ..*question };
        let Answer { lit, step } = with_lobe!(&bsdf, lobe => ask(isa, lobe, &own));
        let weight = Rgb::splat(eta, layer.weight);
        let step = Step { weight: step.weight * weight.scale(inverse), pdf: step.pdf * probability, ..step };
        all = Answer { lit: all.lit + lit * weight, step: Step::select(chosen, step, all.step) };
        at += probability;
    }
    all
}

/// What of a choice falls to a layer; a black one has no way on.
fn share_of(layer: &Layer) -> f32 {
    if matches!(layer.scattering, Scattering::Black) { 0.0 } else { layer.weight.max_channel() }
}
