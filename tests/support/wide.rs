//! Parts of surfaces asked over lanes: one function per lobe and instruction set, out of line, as a renderer has it.

use crate::lobes::{self, Part};
use crate::one_of_each::each_lobe;
use specula::bsdf::{Bsdf, BsdfSample, Lobe, Lobes, Spread};
use specula::math::lanes::{Isa, Kernel, Lanes, Level, MaskLanes};
use specula::math::{Rgb, Vec3};
use specula::sampling::warp;
use std::f32::consts::PI;

type V = Vec3<f32>;

/// Nothing on the side of a twin.
#[inline(always)]
fn on_side<F: Lanes, L: Lobe<F>>(part: Part, wi: Vec3<F>, value: F) -> F {
    let (below, zero) = (wi.z.lt(0.0), value.splat(0.0));
    if !L::LOBES.intersects(Lobes::THROUGH) {
        return value;
    }
    if part == Part::Below { F::select(below, value, zero) } else { F::select(below, zero, value) }
}

/// A direction of the part.
#[inline(always)]
fn draw<F: Lanes, L: Lobe<F>>(lobe: &L, part: Part, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F> {
    let found = match part {
        Part::Matt => None,
        Part::Above => lobe.sample_glossy(wo, u2)[0],
        Part::Below => lobe.sample_glossy(wo, u2)[1],
    };
    if let Some(sample) = found {
        return sample;
    }
    let wi = warp::cosine_hemisphere(u2);
    let weight = lobe.eval_diffuse(wo, wi).scale(PI);
    BsdfSample { wi, weight, pdf: warp::cosine_hemisphere_pdf(wi.z), valid: wi.z.gt(0.0) }
}

/// Density and value of a direction.
#[inline(always)]
fn ask<F: Lanes, L: Lobe<F>>(lobe: &L, part: Part, wo: Vec3<F>, wi: Vec3<F>) -> (F, Rgb<F>) {
    if part == Part::Matt {
        return (warp::cosine_hemisphere_pdf(wi.z), lobe.eval_diffuse(wo, wi));
    }
    let one = on_side::<F, L>(part, wi, wo.z.splat(1.0));
    (on_side::<F, L>(part, wi, lobe.pdf_glossy(wo, wi)), lobe.eval_glossy(wo, wi) * one)
}

/// What a lobe says of a direction that it drew, or of one that it is given.
#[derive(Clone, Copy)]
enum Question<F> {
    Draw(Vec3<F>, [F; 2]),
    Ask(Vec3<F>, Vec3<F>),
}

/// A sample, and density and value for its direction; of a direction that is given, only these.
#[derive(Clone, Copy)]
pub(crate) struct Told<F: Lanes> {
    pub(crate) sample: BsdfSample<F>,
    pub(crate) pdf: F,
    pub(crate) f: Rgb<F>,
}

struct Answer<'a, L, F>(&'a L, Part, Question<F>);

impl<S: Isa, L: Lobe<S::F>> Kernel<S> for Answer<'_, L, S::F> {
    type Output = Told<S::F>;
    #[inline(always)]
    fn run(self, isa: S) -> Told<S::F> {
        let Self(lobe, part, question) = self;
        let (wo, sample) = match question {
            Question::Draw(wo, u2) => (wo, draw(lobe, part, wo, u2)),
            Question::Ask(wo, wi) => {
                let (zero, none) = (isa.splat(0.0), isa.splat_mask(false));
                (wo, BsdfSample { wi, weight: Rgb::gray(zero), pdf: zero, valid: none })
            }
        };
        let (pdf, f) = ask(lobe, part, wo, sample.wi);
        Told { sample, pdf, f }
    }
}

#[inline(never)]
fn answer<S: Isa, L: Lobe<S::F>>(isa: S, lobe: &L, part: Part, question: Question<S::F>) -> Told<S::F> {
    isa.run(Answer(lobe, part, question))
}

/// One question for each pair of numbers, or of directions.
struct All<'a, Q>(Bsdf<f32>, Part, &'a [Q]);

/// What is asked in one lane.
pub(crate) trait Asked: Copy {
    /// The same of as many as there are lanes, the last one repeated.
    fn gather<S: Isa>(isa: S, some: &[Self]) -> Wide<S::F>;
}

/// Questions in lanes.
pub(crate) struct Wide<F>(Question<F>);

fn rows<S: Isa, Q: Copy>(isa: S, some: &[Q], number: impl Fn(&Q) -> f32) -> S::F {
    isa.per_lane(|i| number(some.get(i).unwrap_or(&some[some.len() - 1])))
}

impl Asked for (V, [f32; 2]) {
    #[inline(always)]
    fn gather<S: Isa>(isa: S, some: &[Self]) -> Wide<S::F> {
        let wo =
            Vec3::new(rows(isa, some, |q| q.0.x), rows(isa, some, |q| q.0.y), rows(isa, some, |q| q.0.z));
        Wide(Question::Draw(wo, [rows(isa, some, |q| q.1[0]), rows(isa, some, |q| q.1[1])]))
    }
}

impl Asked for [V; 2] {
    #[inline(always)]
    fn gather<S: Isa>(isa: S, some: &[Self]) -> Wide<S::F> {
        let of = |k: usize| {
            Vec3::new(rows(isa, some, |q| q[k].x), rows(isa, some, |q| q[k].y), rows(isa, some, |q| q[k].z))
        };
        Wide(Question::Ask(of(0), of(1)))
    }
}

impl<S: Isa, Q: Asked> Kernel<S> for All<'_, Q> {
    type Output = Vec<Told<f32>>;
    #[inline(always)]
    fn run(self, isa: S) -> Vec<Told<f32>> {
        let Self(bsdf, part, questions) = self;
        let bsdf = bsdf.spread(isa.splat(0.0));
        let mut told = Vec::with_capacity(questions.len());
        for some in questions.chunks(S::WIDTH) {
            let Wide(question) = Q::gather(isa, some);
            let Told { sample, pdf, f } = each_lobe!(bsdf, lobe => answer(isa, &lobe, part, question));
            let valid = sample.valid.bits();
            told.extend((0..some.len()).map(|i| Told {
                sample: BsdfSample {
                    wi: sample.wi.extract(i),
                    weight: sample.weight.extract(i),
                    pdf: sample.pdf.extract(i),
                    valid: valid >> i & 1 == 1,
                },
                pdf: pdf.extract(i),
                f: f.extract(i),
            }));
        }
        told
    }
}

/// What a lobe says, at that width, of directions that it draws with numbers, or of pairs of directions.
pub(crate) fn told<Q: Asked>(level: Level, lobe: &lobes::Lobe, questions: &[Q]) -> Vec<Told<f32>> {
    level.run(All(lobe.bsdf, lobe.part, questions))
}
