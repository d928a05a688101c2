//! What a lobe answers to a path: the value for a light's direction and the way on, as the path integrator asks for them.

use crate::one_of_each::each_lobe;
use crate::support::Race;
use specula::bsdf::choice::{Answer, Question, ask};
use specula::bsdf::{Bsdf, Lobe, Spread};
use specula::math::Vec3;
use specula::math::lanes::{Isa, Kernel, Lanes, Level, Select};
use specula::sampling::pcg::pcg3d;
use specula::sampling::warp;
use std::hint::black_box;

/// Questions, and how often a pass asks them all; they stay in the second cache.
const COUNT: usize = 2048;
const REPEATS: usize = 32;

/// What is asked, an array per number.
pub(crate) struct Questions {
    wo: [Vec<f32>; 3],
    light: [Vec<f32>; 3],
    light_pdf: Vec<f32>,
    choice: Vec<f32>,
    direction: [Vec<f32>; 2],
}

impl Questions {
    /// Viewers over the hemisphere as light that a matt surface sends them, lights above the surface and some below.
    pub(crate) fn new() -> Self {
        let unit = |i: usize, what: u32| {
            let i = u32::try_from(i).expect("few");
            pcg3d([i, what, 7]).map(|bits| (bits >> 8) as f32 / 16_777_216.0)
        };
        let all = |f: &dyn Fn(usize) -> f32| (0..COUNT).map(f).collect::<Vec<_>>();
        let wo = |i| {
            let [u, v, _] = unit(i, 0);
            let Vec3 { x, y, z } = warp::cosine_hemisphere([u, v]);
            [x, y, z.max(1e-3)]
        };
        let light = |i| {
            let [u, v, below] = unit(i, 1);
            let Vec3 { x, y, z } = warp::cosine_hemisphere([u, v]);
            [x, y, if below < 0.2 { -z } else { z }]
        };
        Self {
            wo: [0, 1, 2].map(|axis: usize| all(&|i| wo(i)[axis])),
            light: [0, 1, 2].map(|axis: usize| all(&|i| light(i)[axis])),
            light_pdf: all(&|i| 0.05 + unit(i, 2)[0]),
            choice: all(&|i| unit(i, 3)[0]),
            direction: [0, 1].map(|axis: usize| all(&|i| unit(i, 4)[axis])),
        }
    }

    #[inline(always)]
    fn load<S: Isa>(&self, isa: S, at: usize) -> Question<S::F> {
        let row = |row: &[f32]| isa.load(&row[at..]);
        let [wo, light] = [&self.wo, &self.light].map(|[x, y, z]| Vec3::new(row(x), row(y), row(z)));
        Question {
            wo,
            light,
            light_pdf: row(&self.light_pdf),
            choice: row(&self.choice),
            direction: [row(&self.direction[0]), row(&self.direction[1])],
            last: false,
        }
    }
}

/// All levels beside each other.
pub(crate) fn race<'a>(name: &str, lobe: Bsdf<f32>, questions: &'a Questions) -> Race<'a> {
    let race = Race::new(format!("lobe {name}"), COUNT * REPEATS, "answers");
    Level::available().into_iter().fold(race, |race, level| {
        race.with(level.name(), move || {
            let mut sum = 0.0;
            for _ in 0..REPEATS {
                sum += level.run(Answers { lobe: black_box(lobe), questions });
            }
            u64::from(f32::to_bits(sum))
        })
    })
}

/// Asks everything of one lobe, the same in all lanes.
struct Answers<'a> {
    lobe: Bsdf<f32>,
    questions: &'a Questions,
}

impl<S: Isa> Kernel<S> for Answers<'_> {
    type Output = f32;
    #[inline(always)]
    fn run(self, isa: S) -> f32 {
        let lobe = self.lobe.spread(isa.splat(0.0));
        let sum = each_lobe!(&lobe, lobe => all(isa, lobe, self.questions));
        let mut lanes = [0.0; 16];
        sum.store(&mut lanes);
        lanes.iter().sum()
    }
}

#[inline(always)]
fn all<S: Isa, L: Lobe<S::F>>(isa: S, lobe: &L, questions: &Questions) -> S::F {
    let mut sum = isa.splat(0.0);
    for at in (0..COUNT).step_by(S::WIDTH) {
        let Answer { lit, step } = ask(isa, lobe, &questions.load(isa, at));
        let way =
            step.wi.x + step.wi.y + step.wi.z + step.weight.r + step.weight.g + step.weight.b + step.pdf;
        let way = S::F::select(step.crosses, -way, way);
        sum += lit.r + lit.g + lit.b + S::F::select(step.valid, way, isa.splat(0.0));
    }
    sum
}
