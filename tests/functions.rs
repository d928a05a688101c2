//! The stated errors of the functions over lanes, against `f64`, at every width of this machine.
//!
//! The normal run takes every 1021st float (4.2 million of them, of all exponents and both signs); the ignored one takes
//! all 2^32, in about an hour. One ulp is the distance of neighbouring floats at the true value.
#![expect(clippy::print_stdout, reason = "the errors found are printed, so that stated ones can be revised")]
#![expect(
    clippy::cast_possible_truncation,
    reason = "truths are rounded to be arguments and to find infinities"
)]
#![expect(clippy::float_cmp, reason = "limits and special values are exact")]

use std::f64::consts::TAU;

use specula::math::lanes::{Isa, Kernel, Lanes, Level, Scalar};

/// A function of one argument under test.
#[derive(Clone, Copy, Debug)]
enum Function {
    Exp,
    ExpM1,
    Ln,
    Ln1p,
    Sin,
    Cos,
    SinTurns,
    CosTurns,
    Asin,
    Acos,
    Atan,
    Rsqrt,
}

use Function::{Acos, Asin, Atan, Cos, CosTurns, Exp, ExpM1, Ln, Ln1p, Rsqrt, Sin, SinTurns};

/// Each function with its stated error in ulps.
const STATED: [(Function, f64); 12] = [
    (Exp, 1.1),
    (ExpM1, 1.5),
    (Ln, 1.0),
    (Ln1p, 1.6),
    (Sin, 1.0),
    (Cos, 1.0),
    (SinTurns, 1.1),
    (CosTurns, 1.0),
    (Asin, 1.9),
    (Acos, 1.3),
    (Atan, 1.4),
    (Rsqrt, 1.5),
];

impl Function {
    fn truth(self, x: f64) -> f64 {
        match self {
            Exp => x.exp(),
            ExpM1 => x.exp_m1(),
            Ln => x.ln(),
            Ln1p => x.ln_1p(),
            Sin => x.sin(),
            Cos => x.cos(),
            SinTurns => sin_turns(x),
            CosTurns => sin_turns(x + 0.25),
            Asin => x.asin(),
            Acos => x.acos(),
            Atan => x.atan(),
            Rsqrt => 1.0 / x.sqrt(),
        }
    }

    /// Where the stated error holds.
    fn domain(self, x: f32) -> bool {
        match self {
            Sin | Cos => !(x.is_finite() && x.abs() > 12_867.0),
            // Beyond, adding a quarter of a turn is not exact in the truth either.
            SinTurns | CosTurns => !(x.is_finite() && x.abs() > 1_048_576.0),
            _ => true,
        }
    }
}

/// sin(2 pi x), reduced to an eighth of a turn first, which is exact.
fn sin_turns(x: f64) -> f64 {
    let quarters = (x * 4.0).round_ties_even();
    let r = (x - quarters * 0.25) * TAU;
    match quarters.rem_euclid(4.0) {
        0.0 => r.sin(),
        1.0 => r.cos(),
        2.0 => -r.sin(),
        _ => -r.cos(),
    }
}

struct Evaluate<'a> {
    function: Function,
    x: &'a [f32],
    y: &'a mut [f32],
}

impl<S: Isa> Kernel<S> for Evaluate<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self, isa: S) {
        let Evaluate { function, x, y } = self;
        match function {
            Exp => each(isa, x, y, S::F::exp),
            ExpM1 => each(isa, x, y, S::F::exp_m1),
            Ln => each(isa, x, y, S::F::ln),
            Ln1p => each(isa, x, y, S::F::ln_1p),
            Sin => each(isa, x, y, S::F::sin),
            Cos => each(isa, x, y, S::F::cos),
            SinTurns => each(isa, x, y, |x| x.sin_cos_turns().0),
            CosTurns => each(isa, x, y, |x| x.sin_cos_turns().1),
            Asin => each(isa, x, y, S::F::asin),
            Acos => each(isa, x, y, S::F::acos),
            Atan => each(isa, x, y, S::F::atan),
            Rsqrt => each(isa, x, y, S::F::rsqrt),
        }
    }
}

#[inline(always)]
fn each<S: Isa>(isa: S, x: &[f32], y: &mut [f32], f: impl Fn(S::F) -> S::F) {
    for (x, y) in x.chunks_exact(S::WIDTH).zip(y.chunks_exact_mut(S::WIDTH)) {
        f(isa.load(x)).store(y);
    }
}

/// The error of `got` in ulps of the truth; infinite where one is a finite number and the other is not. What is below
/// 2^-126 counts as zero.
fn ulps(got: f32, truth: f64) -> f64 {
    let least = f64::from(f32::MIN_POSITIVE);
    let (value, rounded) = (f64::from(got), truth as f32);
    if truth.is_nan() || got.is_nan() {
        return if truth.is_nan() && got.is_nan() { 0.0 } else { f64::INFINITY };
    }
    if got.is_infinite() && rounded.is_infinite() {
        return if got == rounded { 0.0 } else { f64::INFINITY };
    }
    if truth.abs() < least && value.abs() <= least {
        return 0.0;
    }
    // The power of two at or below the truth, by its exponent alone.
    let size = truth.abs().clamp(least, f64::from(f32::MAX));
    let ulp = f64::from_bits(size.to_bits() & 0x7FF0_0000_0000_0000) * f64::exp2(-23.0);
    (value - truth).abs() / ulp
}

/// The functions whose error on every `stride`-th float exceeds the stated one at some of the levels.
fn failures(levels: &[Level], stride: usize) -> Vec<String> {
    let mut failures = Vec::new();
    for (function, stated) in STATED {
        for (level, (error, at)) in levels.iter().zip(worst(function, levels, stride)) {
            let text = format!("{function:?} {}: {error:.3} ulp at {at:e}, stated {stated}", level.name());
            println!("{text}");
            if error > stated {
                failures.push(text);
            }
        }
    }
    failures
}

/// The largest error and its argument at each level, among every `stride`-th float.
fn worst(function: Function, levels: &[Level], stride: usize) -> Vec<(f64, f32)> {
    let mut worst = vec![(0.0, 0.0); levels.len()];
    let (mut x, mut y, mut truth) = (vec![0.0; 4096], vec![0.0; 4096], vec![0.0; 4096]);
    let mut arguments = (0..=u32::MAX).step_by(stride).map(argument).filter(|&x| function.domain(x));
    loop {
        let mut n = 0;
        for (x, argument) in x.iter_mut().zip(&mut arguments) {
            *x = argument;
            n += 1;
        }
        for (x, truth) in x.iter().zip(&mut truth) {
            *truth = function.truth(f64::from(*x));
        }
        for (level, worst) in levels.iter().zip(&mut worst) {
            level.run(Evaluate { function, x: &x, y: &mut y });
            for i in 0..n {
                let error = ulps(y[i], truth[i]);
                if error > worst.0 {
                    *worst = (error, x[i]);
                }
            }
        }
        if n < 4096 {
            return worst;
        }
    }
}

/// The float with these bits, but zero below 2^-126.
fn argument(bits: u32) -> f32 {
    let x = f32::from_bits(bits);
    if x.is_subnormal() { 0.0 } else { x }
}

#[test]
fn errors_are_as_stated() {
    let failures = failures(&Level::available(), 1021);
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
#[ignore = "takes an hour"]
fn errors_are_as_stated_for_all_floats() {
    // One level that fuses multiply-add and one that does not: the others compute the same.
    let failures = failures(&[Level::best(), Level::Scalar(Scalar)], 1);
    assert!(failures.is_empty(), "{failures:#?}");
}

/// A function of two arguments under test.
#[derive(Clone, Copy, Debug)]
enum Function2 {
    Powf,
    Atan2,
}

struct Evaluate2<'a> {
    function: Function2,
    a: &'a [f32],
    b: &'a [f32],
    y: &'a mut [f32],
}

impl<S: Isa> Kernel<S> for Evaluate2<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self, isa: S) {
        let Evaluate2 { function, a, b, y } = self;
        for i in (0..y.len()).step_by(S::WIDTH) {
            let (a, b) = (isa.load(&a[i..]), isa.load(&b[i..]));
            let value = match function {
                Function2::Powf => a.powf(b),
                Function2::Atan2 => a.atan2(b),
            };
            value.store(&mut y[i..]);
        }
    }
}

/// A sequence of well mixed words (the output function of PCG; M. E. O'Neill 2014).
struct Words(u32);

impl Words {
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    }
    fn unit(&mut self) -> f64 {
        f64::from(self.next()) / 4_294_967_296.0
    }
}

/// The largest error at any level among `n` pairs.
fn worst2(function: Function2, n: usize, mut pair: impl FnMut() -> (f32, f32)) -> f64 {
    let (a, b): (Vec<f32>, Vec<f32>) = (0..n).map(|_| pair()).unzip();
    let mut worst = 0.0;
    for level in Level::available() {
        let mut y = vec![0.0; n];
        level.run(Evaluate2 { function, a: &a, b: &b, y: &mut y });
        for i in 0..n {
            let (a, b) = (f64::from(a[i]), f64::from(b[i]));
            let truth = match function {
                Function2::Powf => a.powf(b),
                Function2::Atan2 => a.atan2(b),
            };
            let error = ulps(y[i], truth);
            if error > worst {
                println!("{function:?} {}: {error:.3} ulp at {a:e}, {b:e}", level.name());
                worst = error;
            }
        }
    }
    worst
}

#[test]
fn powers_are_as_accurate_as_stated() {
    let mut words = Words(1);
    // Exponents such that the logarithm of the result is uniform.
    let mut pair = |limit: f64| {
        let x = argument(words.next() & 0x7FFF_FFFF).clamp(f32::MIN_POSITIVE, f32::MAX);
        let x = if words.next() & 1 == 0 { x } else { (0.5 + words.unit()) as f32 };
        let y = (words.unit() * 2.0 - 1.0) * limit / f64::from(x).ln();
        (x, if y.is_finite() { y as f32 } else { 3.0 })
    };
    let near = worst2(Function2::Powf, 1 << 21, || pair(11.5));
    let far = worst2(Function2::Powf, 1 << 21, || pair(87.3));
    assert!(near <= 1.4, "results between 1e-5 and 1e5: {near} ulp");
    assert!(far <= 2.6, "all results: {far} ulp");
}

#[test]
fn angles_are_as_accurate_as_stated() {
    let mut words = Words(2);
    let near =
        worst2(Function2::Atan2, 1 << 21, || ((words.unit() - 0.5) as f32, (words.unit() - 0.5) as f32));
    let small = |x: f32| if x.abs() > 1.7e38 && x.is_finite() { 1.0 } else { x };
    let any = worst2(Function2::Atan2, 1 << 21, || {
        let (y, x) = (small(argument(words.next())), small(argument(words.next())));
        (y, if y.is_infinite() && x.is_infinite() { 1.0 } else { x })
    });
    assert!(near <= 1.6, "{near} ulp");
    assert!(any <= 1.6, "{any} ulp");
}

/// f(a, b) at every level, with the bits of the result.
fn at_all_levels(function: Function2, a: f32, b: f32) -> Vec<f32> {
    let evaluate = |level: Level| {
        let mut y = [0.0; 16];
        level.run(Evaluate2 { function, a: &[a; 16], b: &[b; 16], y: &mut y });
        y[15]
    };
    Level::available().into_iter().map(evaluate).collect()
}

#[test]
fn powers_have_the_limits_stated() {
    const INF: f32 = f32::INFINITY;
    let cases = [
        (0.0, 0.0, 1.0),
        (0.0, 2.5, 0.0),
        (0.0, -2.5, INF),
        (1.0, INF, 1.0),
        (1.0, f32::NAN, 1.0),
        (INF, 0.5, INF),
        (INF, -0.5, 0.0),
        (INF, 0.0, 1.0),
        (f32::NAN, 0.0, 1.0),
        (0.5, INF, 0.0),
        (2.0, INF, INF),
        (2.0, 200.0, INF),
        (2.0, -200.0, 0.0),
        (-2.0, 2.0, f32::NAN),
        (2.0, f32::NAN, f32::NAN),
        (f32::NAN, 1.0, f32::NAN),
    ];
    for (x, y, expected) in cases {
        for got in at_all_levels(Function2::Powf, x, y) {
            assert!(
                got == expected || (got.is_nan() && expected.is_nan()),
                "{x}^{y} is {got}, not {expected}"
            );
        }
    }
}

#[test]
fn angles_of_zeros_and_infinities_are_those_of_the_axes() {
    const INF: f32 = f32::INFINITY;
    for (y, x) in [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0), (0.0, -1.0), (-0.0, -1.0), (0.0, 1.0)]
    {
        for got in at_all_levels(Function2::Atan2, y, x) {
            assert_eq!(got.to_bits(), y.atan2(x).to_bits(), "atan2({y}, {x}) is {got}");
        }
    }
    for (y, x) in [(INF, 1.0), (-INF, -2.0), (1.0, INF), (-1.0, -INF), (2.0, 0.0), (-2.0, -0.0)] {
        for got in at_all_levels(Function2::Atan2, y, x) {
            assert!((got - y.atan2(x)).abs() < 1e-6, "atan2({y}, {x}) is {got}");
        }
    }
    for (y, x) in [(f32::NAN, 1.0), (1.0, f32::NAN), (INF, INF)] {
        for got in at_all_levels(Function2::Atan2, y, x) {
            assert!(got.is_nan(), "atan2({y}, {x}) is {got}");
        }
    }
}

#[test]
fn angles_beyond_the_domain_count_as_zero() {
    for x in [12_868.0, 1e6, 1e9, -1e20, f32::MAX] {
        let (mut s, mut c) = ([0.0; 16], [0.0; 16]);
        for level in Level::available() {
            level.run(Evaluate { function: Sin, x: &[x; 16], y: &mut s });
            level.run(Evaluate { function: Cos, x: &[x; 16], y: &mut c });
            assert!(s[0].abs() < 1e-30 && c[0] == 1.0, "{x:e}: {}, {}", s[0], c[0]);
        }
    }
}
