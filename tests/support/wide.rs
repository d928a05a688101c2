//! Lobes of the list asked over lanes: one function per lobe and instruction set, out of line, as a renderer has it.

use crate::lobes::{Kind, Side};
use specula::bsdf::{
    BsdfSample, Diffuse, Glossy, Jitter, OrenNayar, Phong, RoughConductor, RoughDielectric, Schlick, Spread,
};
use specula::math::lanes::{Isa, Kernel, Lanes, Level, MaskLanes};
use specula::math::{Rgb, Vec3};

type V = Vec3<f32>;

/// Sample, density and value of a lobe.
trait Law<F: Lanes>: Copy {
    fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F>;
    fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F;
    fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F>;
}

macro_rules! laws {
    ($($Lobe:ident)*) => { $(
        impl<F: Lanes> Law<F> for $Lobe<F> {
            #[inline(always)]
            fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F> {
                Self::sample(self, wo, u2)
            }
            #[inline(always)]
            fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
                Self::pdf(self, wo, wi)
            }
            #[inline(always)]
            fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
                Self::eval(self, wo, wi)
            }
        }
    )* };
}
laws! { Diffuse OrenNayar RoughConductor Glossy Phong Jitter Schlick }

/// The reflection of a rough interface, or its transmission.
#[derive(Clone, Copy)]
struct OneSide<F>(RoughDielectric<F>, Side);

impl<F: Lanes> OneSide<F> {
    #[inline(always)]
    fn on_side(&self, wi: Vec3<F>, value: F) -> F {
        let (below, zero) = (wi.z.lt(0.0), value.splat(0.0));
        match self.1 {
            Side::Above => F::select(below, zero, value),
            Side::Below => F::select(below, value, zero),
        }
    }
}

impl<F: Lanes> Law<F> for OneSide<F> {
    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, u2: [F; 2]) -> BsdfSample<F> {
        self.0.sample(wo, u2)[usize::from(self.1 == Side::Below)]
    }
    #[inline(always)]
    fn pdf(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        self.on_side(wi, self.0.pdf(wo, wi))
    }
    #[inline(always)]
    fn eval(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        Rgb::gray(self.on_side(wi, self.0.eval(wo, wi).r))
    }
}

/// Runs an expression for the lobe within, spread over lanes like `like`.
macro_rules! with_kind {
    ($kind:expr, $like:expr, $lobe:ident => $body:expr) => {
        match $kind {
            Kind::Diffuse(own) => {
                let $lobe = own.spread($like);
                $body
            }
            Kind::OrenNayar(own) => {
                let $lobe = own.spread($like);
                $body
            }
            Kind::Rough(own) => {
                let $lobe = own.spread($like);
                $body
            }
            Kind::Interface(own, side) => {
                let $lobe = OneSide(own.spread($like), side);
                $body
            }
            Kind::Glossy(own) => {
                let $lobe = own.spread($like);
                $body
            }
            Kind::Phong(own) => {
                let $lobe = own.spread($like);
                $body
            }
            Kind::Jitter(own) => {
                let $lobe = own.spread($like);
                $body
            }
            Kind::Schlick(own) => {
                let $lobe = own.spread($like);
                $body
            }
        }
    };
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

struct Answer<'a, L, F>(&'a L, Question<F>);

impl<S: Isa, L: Law<S::F>> Kernel<S> for Answer<'_, L, S::F> {
    type Output = Told<S::F>;
    #[inline(always)]
    fn run(self, isa: S) -> Told<S::F> {
        let Self(lobe, question) = self;
        let (wo, sample) = match question {
            Question::Draw(wo, u2) => (wo, lobe.sample(wo, u2)),
            Question::Ask(wo, wi) => {
                let (zero, none) = (isa.splat(0.0), isa.splat_mask(false));
                (wo, BsdfSample { wi, weight: Rgb::gray(zero), pdf: zero, valid: none })
            }
        };
        Told { sample, pdf: lobe.pdf(wo, sample.wi), f: lobe.eval(wo, sample.wi) }
    }
}

#[inline(never)]
fn answer<S: Isa, L: Law<S::F>>(isa: S, lobe: &L, question: Question<S::F>) -> Told<S::F> {
    isa.run(Answer(lobe, question))
}

/// One question for each pair of numbers, or of directions.
struct All<'a, Q>(Kind, &'a [Q]);

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
        let Self(kind, questions) = self;
        let mut told = Vec::with_capacity(questions.len());
        for some in questions.chunks(S::WIDTH) {
            let Wide(question) = Q::gather(isa, some);
            let like = isa.splat(0.0);
            let Told { sample, pdf, f } = with_kind!(kind, like, lobe => answer(isa, &lobe, question));
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
pub(crate) fn told<Q: Asked>(level: Level, kind: Kind, questions: &[Q]) -> Vec<Told<f32>> {
    level.run(All(kind, questions))
}
