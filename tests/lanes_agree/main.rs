//! Shading at every width gives what one lane gives.
//!
//! Not bit for bit: where the hardware fuses, `mul_add` rounds once instead of twice, and whatever cancels afterwards
//! shows the difference. Each quantity therefore states the relative error it is held to and why that is not zero.
//! Instruction sets that the machine lacks are skipped with a printed line.
//!
//! Each lobe is asked in one function per instruction set, out of line, however many of its parameters are tried: the time to
//! compile a kernel grows faster than its size.

/// A kernel, its name, and the test that it is the same at every width.
macro_rules! parts {
    ($($(#[$doc:meta])* $part:ident $test:ident, |$table:ident, $input:ident| $body:block)*) => { $(
        $(#[$doc])*
        struct $part;

        impl $crate::Part for $part {
            #[inline(always)]
            fn shade<F: Lanes>(&self, $table: &mut $crate::Table, $input: [F; 8]) $body
        }

        #[test]
        fn $test() {
            $crate::agree(&$part);
        }
    )* };
}

mod kinds;
mod lights;
#[path = "../support/lights.rs"]
mod lights_list;
#[path = "../support/one_of_each.rs"]
mod one_of_each;
mod phong;
#[path = "../support/random.rs"]
mod random;
mod rough;
mod skies;
mod smooth;

use random::Random;
use specula::bsdf::{Branch, BsdfSample, Lobe};
use specula::math::lanes::{Isa, Kernel, Lanes, Level};
use specula::math::{Rgb, Vec3};

/// Numbers for one lane.
type Input = [f32; 8];

/// What is computed: a name, a bound on the error relative to the magnitude `scale` (or to the value, where that is
/// greater), and a value for each input. NaN stands for what is not valid.
#[derive(Debug)]
struct Column {
    name: String,
    bound: f32,
    scale: f32,
    values: Vec<f32>,
}

/// Collects the values of all lanes. What is not arithmetic stays out of line: kernels are compiled in one piece.
#[derive(Default)]
struct Table {
    columns: Vec<Column>,
    next: usize,
}

impl Table {
    #[inline(never)]
    fn append(&mut self, [who, what]: [&str; 2], [bound, scale]: [f32; 2], values: &[f32]) {
        if self.next == self.columns.len() {
            self.columns.push(Column { name: format!("{who}: {what}"), bound, scale, values: Vec::new() });
        }
        self.columns[self.next].values.extend_from_slice(values);
        self.next += 1;
    }

    #[inline(always)]
    fn put<F: Lanes>(&mut self, name: [&str; 2], bound: [f32; 2], value: F) {
        let mut row = [0.0; 16];
        value.store(&mut row);
        self.append(name, bound, &row[..F::WIDTH]);
    }

    #[inline(always)]
    fn put_all<F: Lanes>(&mut self, name: [&str; 2], bound: [f32; 2], valid: F::Mask, values: [F; 3]) {
        for x in values {
            self.put(name, bound, F::select(valid, x, x.splat(f32::NAN)));
        }
    }

    /// `bound` is on the direction, the density (of 0.01 at least: near the horizon cosines are differences) and the weight.
    #[inline(always)]
    fn put_sample<F: Lanes>(&mut self, who: &str, bound: [f32; 3], sample: BsdfSample<F>) {
        let BsdfSample { wi, weight, pdf, valid } = sample;
        self.put_all([who, "direction"], [bound[0], 1.0], valid, [wi.x, wi.y, wi.z]);
        self.put_all([who, "sampled density"], [bound[1], 0.01], valid, [pdf; 3]);
        self.put_all([who, "weight"], [bound[2], 1.0], valid, [weight.r; 3]);
    }

    /// The same for all ways that there are.
    #[inline(always)]
    fn put_samples<F: Lanes>(&mut self, who: &str, bound: [f32; 3], samples: [Option<BsdfSample<F>>; 2]) {
        for sample in samples.into_iter().flatten() {
            self.put_sample(who, bound, sample);
        }
    }

    #[inline(always)]
    fn put_branch<F: Lanes>(&mut self, who: &str, bound: f32, branch: Branch<F>) {
        let Branch { wi, weight, radiance_scale, valid, .. } = branch;
        self.put_all([who, "direction"], [bound, 1.0], valid, [wi.x, wi.y, wi.z]);
        self.put_all([who, "weight"], [bound, 1.0], valid, [weight.r, weight.g, weight.b]);
        self.put([who, "scale"], [1e-6, 0.0], radiance_scale);
    }
}

/// What a lobe answers.
struct Told<F: Lanes> {
    sampled: [Option<BsdfSample<F>>; 2],
    branches: [Option<Branch<F>>; 2],
    pdf: F,
    glossy: Rgb<F>,
    diffuse: Rgb<F>,
}

/// All that can be asked of a lobe.
struct Ask<'a, L, F> {
    lobe: &'a L,
    wo: Vec3<F>,
    wi: Vec3<F>,
    u2: [F; 2],
}

impl<S: Isa, L: Lobe<S::F>> Kernel<S> for Ask<'_, L, S::F> {
    type Output = Told<S::F>;
    #[inline(always)]
    fn run(self, _isa: S) -> Told<S::F> {
        let Self { lobe, wo, wi, u2 } = self;
        Told {
            sampled: lobe.sample_glossy(wo, u2),
            branches: lobe.branches(wo),
            pdf: lobe.pdf_glossy(wo, wi),
            glossy: lobe.eval_glossy(wo, wi),
            diffuse: lobe.eval_diffuse(wo, wi),
        }
    }
}

/// A function of its own per lobe and instruction set, as a renderer has it.
#[inline(never)]
fn ask<F: Lanes, L: Lobe<F>>(lobe: &L, [wo, wi]: [Vec3<F>; 2], u2: [F; 2]) -> Told<F> {
    wo.z.isa().run(Ask { lobe, wo, wi, u2 })
}

/// What is computed from each input, compiled as one kernel.
trait Part {
    /// Puts the same columns, in the same order, for every input.
    fn shade<F: Lanes>(&self, table: &mut Table, input: [F; 8]);
}

/// One part for each input.
struct Shade<'a, P> {
    inputs: &'a [Input],
    part: &'a P,
}

impl<S: Isa, P: Part> Kernel<S> for Shade<'_, P> {
    type Output = Vec<Column>;
    #[inline(always)]
    fn run(self, isa: S) -> Self::Output {
        let mut table = Table::default();
        for some in self.inputs.chunks_exact(S::WIDTH) {
            let input: [S::F; 8] = std::array::from_fn(|k| isa.per_lane(|i| some[i][k]));
            table.next = 0;
            self.part.shade(&mut table, input);
        }
        table.columns
    }
}

/// The viewer of an input.
#[inline(always)]
fn viewer<F: Lanes>([c, turn, ..]: [F; 8]) -> Vec3<F> {
    let sin = (-c.square() + 1.0).max(0.0).sqrt();
    let (s, t) = turn.sin_cos_turns();
    Vec3::new(t * sin, s * sin, c)
}

/// A light's direction that is not sampled.
#[inline(always)]
fn another<F: Lanes>([_, _, u, v, _, _, x, y]: [F; 8]) -> Vec3<F> {
    viewer([x.abs(), y, u, v, u, v, u, v])
}

/// Random inputs, and every eighth with something at an end of its range: a whole number of blocks of any width.
fn inputs() -> Vec<Input> {
    const LAST: f32 = 1.0 - f32::EPSILON / 2.0;
    let mut random = Random::new(1);
    let make = |i: usize| {
        let [c, turn, u] = random.triple();
        let [v, x, y] = random.triple();
        let (eta, k) = (random.logarithmic(0.3, 4.0), random.logarithmic(0.01, 100.0));
        let mut input = [c.max(1e-3), turn, u, v, eta, k, x * 2.0 - 1.0, y * 2.0 - 1.0];
        if i.is_multiple_of(8) {
            let ends = [
                [1e-3, 1.0],
                [0.0, LAST],
                [0.0, LAST],
                [0.0, LAST],
                [1.0, 1.5],
                [0.0, 1e6],
                [0.0, 1.0],
                [0.0, 1.0],
            ];
            let which = i / 8 % 8;
            input[which] = ends[which][i / 64 % 2];
        }
        input
    };
    (0..8192).map(make).collect()
}

/// Compares all columns; a decision near its threshold may fall either way, but seldom.
fn compare(name: &str, found: &[Column], expected: &[Column]) {
    assert_eq!(found.len(), expected.len(), "{name}: columns");
    for (wide, narrow) in found.iter().zip(expected) {
        let (mut flips, mut valid) = (0, 0);
        for (lane, (&a, &b)) in wide.values.iter().zip(&narrow.values).enumerate() {
            if a.is_nan() != b.is_nan() {
                flips += 1;
            } else if !a.is_nan() {
                valid += 1;
                let bound = wide.bound * b.abs().max(wide.scale);
                assert!((a - b).abs() <= bound, "{name}: {}, input {lane}: {a:e}, not {b:e}", wide.name);
            }
        }
        assert!(flips <= 4, "{name}: {}: {flips} decisions differ", wide.name);
        assert!(valid > 400, "{name}: {}: only {valid} valid", wide.name);
    }
}

/// Runs a part at every width of this machine.
#[expect(clippy::print_stdout, reason = "says what was not tested")]
fn agree(part: &impl Part) {
    let inputs = inputs();
    let shade = || Shade { inputs: &inputs, part };
    let expected = Level::named("scalar").expect("always there").run(shade());
    for level in Level::available() {
        compare(level.name(), &level.run(shade()), &expected);
    }
    for name in ["avx2", "avx512"] {
        if Level::named(name).is_err() {
            println!("skipped: this machine has no {name}");
        }
    }
}
