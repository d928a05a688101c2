//! The functions over lanes, each beside the standard library's.

use specula::math::lanes::{Isa, Kernel, Lanes};

/// A function of one argument; those of two get a fixed second one.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Function {
    Sqrt,
    Rsqrt,
    Exp,
    ExpM1,
    Ln,
    Ln1p,
    Powf,
    SinCos,
    SinCosTurns,
    Asin,
    Acos,
    Atan2,
}

use Function::{Acos, Asin, Atan2, Exp, ExpM1, Ln, Ln1p, Powf, Rsqrt, SinCos, SinCosTurns, Sqrt};

/// The second argument of the functions of two.
const SECOND: f32 = 0.8;

impl Function {
    pub(crate) const ALL: [Self; 12] =
        [Sqrt, Rsqrt, Exp, ExpM1, Ln, Ln1p, Powf, SinCos, SinCosTurns, Asin, Acos, Atan2];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Sqrt => "sqrt",
            Rsqrt => "rsqrt",
            Exp => "exp",
            ExpM1 => "exp_m1",
            Ln => "ln",
            Ln1p => "ln_1p",
            Powf => "powf",
            SinCos => "sin_cos",
            SinCosTurns => "sin_cos_turns",
            Asin => "asin",
            Acos => "acos",
            Atan2 => "atan2",
        }
    }

    /// Argument `i` of `n`, spread over where the function is used.
    pub(crate) fn argument(self, i: usize, n: usize) -> f32 {
        let u = (i as f32 + 0.5) / n as f32;
        match self {
            Exp | ExpM1 | SinCos => u * 20.0 - 10.0,
            Asin | Acos | Atan2 => u * 2.0 - 1.0,
            Sqrt | Rsqrt | Ln | Ln1p | Powf | SinCosTurns => u,
        }
    }

    /// The standard library's result.
    #[inline(always)]
    pub(crate) fn standard(self, x: f32) -> f32 {
        match self {
            Sqrt => x.sqrt(),
            Rsqrt => 1.0 / x.sqrt(),
            Exp => x.exp(),
            ExpM1 => x.exp_m1(),
            Ln => x.ln(),
            Ln1p => x.ln_1p(),
            Powf => x.powf(SECOND),
            SinCos => x.sin() + x.cos(),
            SinCosTurns => (x * std::f32::consts::TAU).sin() + (x * std::f32::consts::TAU).cos(),
            Asin => x.asin(),
            Acos => x.acos(),
            Atan2 => x.atan2(SECOND),
        }
    }
}

/// `y = function(x)` for whole arrays, whose length is a multiple of sixteen.
pub(crate) struct Apply<'a> {
    pub(crate) function: Function,
    pub(crate) x: &'a [f32],
    pub(crate) y: &'a mut [f32],
}

impl<S: Isa> Kernel<S> for Apply<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self, isa: S) {
        let Apply { function, x, y } = self;
        match function {
            Sqrt => each(isa, x, y, Lanes::sqrt),
            Rsqrt => each(isa, x, y, Lanes::rsqrt),
            Exp => each(isa, x, y, Lanes::exp),
            ExpM1 => each(isa, x, y, Lanes::exp_m1),
            Ln => each(isa, x, y, Lanes::ln),
            Ln1p => each(isa, x, y, Lanes::ln_1p),
            Powf => each(isa, x, y, |x| x.powf(x.splat(SECOND))),
            SinCos => each(isa, x, y, |x| sum(x.sin_cos())),
            SinCosTurns => each(isa, x, y, |x| sum(x.sin_cos_turns())),
            Asin => each(isa, x, y, Lanes::asin),
            Acos => each(isa, x, y, Lanes::acos),
            Atan2 => each(isa, x, y, |x| x.atan2(x.splat(SECOND))),
        }
    }
}

#[inline(always)]
fn sum<F: Lanes>((s, c): (F, F)) -> F {
    s + c
}

#[inline(always)]
fn each<S: Isa>(isa: S, x: &[f32], y: &mut [f32], f: impl Fn(S::F) -> S::F) {
    for (x, y) in x.chunks_exact(S::WIDTH).zip(y.chunks_exact_mut(S::WIDTH)) {
        f(isa.load(x)).store(y);
    }
}
