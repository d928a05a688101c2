//! A path at a surface: one of the ways on is chosen, and a light is asked.
//!
//! The ray tree follows every way on; a path takes one, in proportion to what each is likely to return. Each way is a
//! strategy of its own that shares with asking the light by the power heuristic (Veach 1997, Robust Monte Carlo Methods,
//! 9.2): the light's share of a lobe depends on that lobe's density alone, so no lobe is evaluated for the direction of
//! another.

use crate::bsdf::{BsdfSample, Lobe, Lobes};
use crate::math::lanes::{Isa, Kernel, Lanes, MaskLanes, Select};
use crate::math::{Rgb, Vec3};
use crate::sampling::{heuristic, warp};
use std::f32::consts::{FRAC_1_PI, PI};

/// What a path asks at a surface.
#[derive(Clone, Copy, Debug)]
pub struct Question<F> {
    /// Unit direction towards the viewer, local.
    pub wo: Vec3<F>,
    /// Unit direction towards a light, local; above the surface where it counts.
    pub light: Vec3<F>,
    /// Density with which the light was asked for that direction, per solid angle; infinite where no way on can find it.
    pub light_pdf: F,
    /// In [0, 1): chooses the way.
    pub choice: F,
    /// In [0, 1): choose the direction.
    pub direction: [F; 2],
    /// Whether the way on has no more to find than light. Asking lights then has all of the diffuse lobe's light but that of
    /// lights which are not asked, for which the lobe's way is marked by a density of -1.
    pub last: bool,
}

/// What it is told.
#[derive(Clone, Copy, Debug)]
pub struct Answer<F: Lanes> {
    /// The BSDF for the light's direction, 1/sr, times what asking has a share in.
    pub lit: Rgb<F>,
    /// The way on.
    pub step: Step<F>,
}

/// A way on.
#[derive(Clone, Copy, Debug)]
pub struct Step<F: Lanes> {
    /// Unit direction, local.
    pub wi: Vec3<F>,
    /// What radiance from there is multiplied by on its way to the viewer.
    pub weight: Rgb<F>,
    /// Density per solid angle, the choice included; 0 where asking lights does not find the same directions, so that what
    /// is met counts in full; negative where nothing counts that asking lights may find (see [`Question::last`]).
    pub pdf: F,
    /// Where the surface is crossed.
    pub crosses: F::Mask,
    /// Where there is a way on.
    pub valid: F::Mask,
}

/// Answers for a surface of one kind.
#[inline(always)]
pub fn answer<F: Lanes, L: Lobe<F>>(lobe: &L, question: &Question<F>) -> Answer<F> {
    let Question { wo, light, light_pdf, choice, direction, last } = *question;
    let (zero, one) = (wo.z.splat(0.0), wo.z.splat(1.0));
    let up = Vec3::new(zero, zero, one);
    let has = |lobes: Lobes| L::LOBES.intersects(lobes);
    // Where there is one way only, nothing is weighed.
    let one_way = L::LOBES == Lobes::DIFFUSE || L::LOBES == Lobes::GLOSSY;
    let weighed = |lobes: Lobes| has(lobes) && !one_way;
    let diffuse = if weighed(Lobes::DIFFUSE) { lobe.eval_diffuse(wo, up).max_channel() * PI } else { zero };
    let glossy = if weighed(Lobes::GLOSSY) { lobe.glossy_albedo(wo) } else { [zero; 2] };
    let branches = if has(Lobes::SPECULAR) { lobe.branches(wo) } else { [None, None] };
    let specular = branches.map(|branch| {
        branch.map_or(zero, |branch| F::select(branch.valid, branch.weight.max_channel(), zero))
    });
    let total = diffuse + glossy[0] + glossy[1] + specular[0] + specular[1];
    let per = one / total.max(1e-30);
    let mut chooser = Chooser { one_way, at: zero, target: choice * total, step: nowhere(wo) };
    let mut lit = Rgb::gray(zero);
    if has(Lobes::DIFFUSE) {
        let part = if one_way { one } else { diffuse * per };
        let share = if last { one } else { heuristic::power(light_pdf, light.z.max(0.0) * FRAC_1_PI * part) };
        lit += lobe.eval_diffuse(wo, light) * share;
        let wi = warp::cosine_hemisphere(direction);
        let pdf = if last { -one } else { wi.z * FRAC_1_PI * part };
        let weight = lobe.eval_diffuse(wo, wi).scale(PI);
        chooser.offer(diffuse, part, Step { wi, weight, pdf, crosses: never(wo), valid: wi.z.gt(0.0) });
    }
    if has(Lobes::GLOSSY) {
        let part = if one_way { one } else { glossy[0] * per };
        let drawn = lobe.pdf_glossy(wo, light) * part;
        lit += lobe.eval_glossy(wo, light) * heuristic::power(light_pdf, drawn);
        let [mirrored, refracted] = lobe.sample_glossy(wo, direction);
        if let Some(sample) = mirrored {
            chooser.offer(glossy[0], part, along(sample, sample.pdf * part, never(wo)));
        }
        if let Some(sample) = refracted {
            chooser.offer(glossy[1], glossy[1] * per, along(sample, zero, !never(wo)));
        }
    }
    for (branch, share) in branches.into_iter().zip(specular) {
        if let Some(branch) = branch {
            let weight = branch.weight * branch.radiance_scale;
            let crosses = if branch.transmission { !never(wo) } else { never(wo) };
            chooser.offer(
                share,
                share * per,
                Step { wi: branch.wi, weight, pdf: zero, crosses, valid: branch.valid },
            );
        }
    }
    Answer { lit, step: chooser.step }
}

/// As [`answer`], a function of its own per lobe and instruction set: in one piece, kernels take minutes to compile.
#[inline(never)]
pub fn ask<S: Isa, L: Lobe<S::F>>(isa: S, lobe: &L, question: &Question<S::F>) -> Answer<S::F> {
    isa.run(Ask { lobe, question })
}

struct Ask<'a, L, F> {
    lobe: &'a L,
    question: &'a Question<F>,
}

impl<S: Isa, L: Lobe<S::F>> Kernel<S> for Ask<'_, L, S::F> {
    type Output = Answer<S::F>;
    #[inline(always)]
    fn run(self, _isa: S) -> Answer<S::F> {
        answer(self.lobe, self.question)
    }
}

/// Takes the last way that begins before a number.
struct Chooser<F: Lanes> {
    /// Whether the first way is the only one.
    one_way: bool,
    at: F,
    target: F,
    step: Step<F>,
}

impl<F: Lanes> Chooser<F> {
    /// A way of this `share` of all, chosen with the probability `part`.
    #[inline(always)]
    fn offer(&mut self, share: F, part: F, step: Step<F>) {
        if self.one_way {
            self.step = step;
            return;
        }
        let chosen = self.target.ge(self.at) & share.gt(0.0);
        let weight = step.weight * part.max(1e-30).recip();
        self.step = Step::select(chosen, Step { weight, ..step }, self.step);
        self.at += share;
    }
}

impl<F: Lanes> Select for Step<F> {
    type Mask = F::Mask;
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            wi: Vec3::select(mask, yes.wi, no.wi),
            weight: Rgb::select(mask, yes.weight, no.weight),
            pdf: F::select(mask, yes.pdf, no.pdf),
            crosses: (yes.crosses & mask) | (no.crosses & !mask),
            valid: (yes.valid & mask) | (no.valid & !mask),
        }
    }
}

impl<F: Lanes> Select for Answer<F> {
    type Mask = F::Mask;
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self { lit: Rgb::select(mask, yes.lit, no.lit), step: Step::select(mask, yes.step, no.step) }
    }
}

impl<F: Lanes> Answer<F> {
    /// Nothing: a black surface.
    #[inline(always)]
    pub fn black(wo: Vec3<F>) -> Self {
        Self { lit: Rgb::gray(wo.z.splat(0.0)), step: nowhere(wo) }
    }
}

#[inline(always)]
fn along<F: Lanes>(sample: BsdfSample<F>, pdf: F, crosses: F::Mask) -> Step<F> {
    Step { wi: sample.wi, weight: sample.weight, pdf, crosses, valid: sample.valid }
}

#[inline(always)]
fn nowhere<F: Lanes>(wo: Vec3<F>) -> Step<F> {
    let zero = wo.z.splat(0.0);
    Step { wi: wo, weight: Rgb::gray(zero), pdf: zero, crosses: never(wo), valid: never(wo) }
}

#[inline(always)]
fn never<F: Lanes>(wo: Vec3<F>) -> F::Mask {
    wo.z.gt(0.0).splat(false)
}
