//! One kernel for every lobe, for lights, for every sampler, for the functions over lanes.
//!
//! Each is a function of its own per instruction set, out of line: in one piece they would take minutes to compile.

use crate::one_of_each::{each_lobe, lobes};
use specula::bsdf::choice::{Answer, Question, answer};
use specula::bsdf::{Bsdf, Lobe, Spread};
use specula::light::tree::Drawn;
use specula::light::{Light, LightId, LightSample, LightTree, Reference};
use specula::math::lanes::{IntLanes, Isa, Kernel, Lanes, Level, MaskLanes};
use specula::math::{Rgb, Vec3};
use specula::sampling::{Dim, Sampler, SamplerKind, Vertex};

/// Uses the functions over lanes that the shading pass does not.
pub(crate) struct Functions<'a>(pub(crate) &'a mut [f32]);

impl<S: Isa> Kernel<S> for Functions<'_> {
    type Output = bool;
    #[inline(always)]
    fn run(self, isa: S) -> bool {
        let x = isa.load(self.0);
        let (s, c) = x.sin_cos();
        let grown = x.exp() + x.exp_m1() + x.ln() + x.ln_1p() + x.powf(s);
        let turned = x.asin() + x.acos() + c.atan() + x.atan2(c).floor().round_ties_even();
        let bits = (grown + turned).to_bits().reverse_bits();
        let gathered = isa.gather_u32(&[1, 2, 3], bits & 3).to_unit();
        (gathered + turned.copysign(s).lerp(grown, c)).store(self.0);
        bits.signed_to_float().is_finite().all()
    }
}

/// What a path asks a lobe.
struct Ask<'a, L, F>(&'a L, Question<F>);

impl<S: Isa, L: Lobe<S::F>> Kernel<S> for Ask<'_, L, S::F> {
    type Output = Answer<S::F>;
    #[inline(always)]
    fn run(self, _isa: S) -> Answer<S::F> {
        answer(self.0, &self.1)
    }
}

#[inline(never)]
fn ask<S: Isa, L: Lobe<S::F>>(isa: S, lobe: &L, question: Question<S::F>) -> Answer<S::F> {
    isa.run(Ask(lobe, question))
}

/// What a ray tree asks a lobe for the direction of a light.
struct Value<'a, L, F>(&'a L, [Vec3<F>; 2]);

impl<S: Isa, L: Lobe<S::F>> Kernel<S> for Value<'_, L, S::F> {
    type Output = Rgb<S::F>;
    #[inline(always)]
    fn run(self, _isa: S) -> Rgb<S::F> {
        let Self(lobe, [wo, wi]) = self;
        lobe.eval_glossy(wo, wi) * lobe.pdf_glossy(wo, wi) + lobe.eval_diffuse(wo, wi)
    }
}

#[inline(never)]
fn value<S: Isa, L: Lobe<S::F>>(isa: S, lobe: &L, both: [Vec3<S::F>; 2]) -> Rgb<S::F> {
    isa.run(Value(lobe, both))
}

/// A point that a light, or a part of it, is asked for.
struct Shine<'a, F: Lanes>(&'a Light, Reference<F>, Option<F::Int>, [F; 2]);

impl<S: Isa> Kernel<S> for Shine<'_, S::F> {
    type Output = LightSample<S::F>;
    #[inline(always)]
    fn run(self, _isa: S) -> LightSample<S::F> {
        self.0.sample_part(self.1, self.2, self.3)
    }
}

#[inline(never)]
fn shine<S: Isa>(
    isa: S,
    (light, part): (&Light, Option<S::I>),
    at: Reference<S::F>,
    u2: [S::F; 2],
) -> LightSample<S::F> {
    isa.run(Shine(light, at, part, u2))
}

/// A leaf of a tree of lights.
struct Pick<'a, F>(&'a LightTree, Reference<F>, F);

impl<S: Isa> Kernel<S> for Pick<'_, S::F> {
    type Output = Drawn<S::F>;
    #[inline(always)]
    fn run(self, _isa: S) -> Drawn<S::F> {
        self.0.sample(self.1, self.2)
    }
}

#[inline(never)]
fn pick<S: Isa>(isa: S, tree: &LightTree, at: Reference<S::F>, u: S::F) -> Drawn<S::F> {
    isa.run(Pick(tree, at, u))
}

/// The numbers of a sample.
struct Numbers<I>(SamplerKind, [I; 2], I);

impl<S: Isa> Kernel<S> for Numbers<S::I> {
    type Output = [S::F; 3];
    #[inline(always)]
    fn run(self, _isa: S) -> [S::F; 3] {
        let sampler = self.0.start(1, self.1, self.2);
        let [u, v] = sampler.get_2d(Dim::Film, Vertex::ROOT);
        [u, v, sampler.get_1d(Dim::LobeChoice, Vertex::ROOT)]
    }
}

#[inline(never)]
fn numbers<S: Isa>(isa: S, kind: SamplerKind, pixel: [S::I; 2], index: S::I) -> [S::F; 3] {
    isa.run(Numbers(kind, pixel, index))
}

/// Everything, by way of the functions above.
pub(crate) struct Everything<'a> {
    pub(crate) lobes: &'a [Bsdf<f32>],
    pub(crate) lights: &'a [(&'static str, Light)],
    pub(crate) tree: &'a LightTree,
}

impl<S: Isa> Kernel<S> for Everything<'_> {
    type Output = f32;
    #[inline(always)]
    fn run(self, isa: S) -> f32 {
        let x = isa.splat(0.6);
        let [a, b, c] = [x, x * 0.0, x * 0.0 + 0.8];
        let (wo, light) = (Vec3::new(a, b, c), Vec3::new(-a, b, c));
        let mut sum = x;
        for kind in samplers() {
            let [u, v, w] = numbers(isa, kind, [isa.iota(), isa.splat_u32(3)], isa.splat_u32(5));
            sum = sum + u * v + w;
        }
        let question = Question { wo, light, light_pdf: x, choice: x, direction: [x, c], last: false };
        for lobe in self.lobes {
            let lobe = lobe.spread(x);
            let (told, asked) =
                each_lobe!(lobe, lobe => (ask(isa, &lobe, question), value(isa, &lobe, [wo, light])));
            sum = sum + told.lit.r + told.step.pdf + told.step.weight.g + asked.b;
        }
        for (_, one) in self.lights {
            for part in [None, Some(isa.splat_u32(0))] {
                let told = shine(isa, (one, part), Reference { p: wo, n: light }, [x, c]);
                sum = sum + told.pdf + told.li.r + told.wi.x;
            }
        }
        sum += pick(isa, self.tree, Reference { p: wo, n: light }, x).probability;
        sum.extract(0)
    }
}

fn samplers() -> [SamplerKind; 4] {
    [
        SamplerKind::Independent,
        SamplerKind::OwenSobol,
        SamplerKind::Stratified { spp: 12 },
        SamplerKind::BlueNoise { spp: 16 },
    ]
}

/// Runs them all at one width.
pub(crate) fn everything(level: Level, lights: &[(&'static str, Light)]) -> f32 {
    let lobes: Vec<_> = lobes().into_iter().map(|(_, lobe)| lobe).collect();
    let numbered = (0..).map(LightId).zip(lights.iter().map(|(_, light)| light));
    let tree = LightTree::new(numbered).expect("emitters");
    level.run(Everything { lobes: &lobes, lights, tree: &tree })
}
