//! Reconstruction filters, sampled by their importance.
//!
//! All are separable and symmetric. Box and tent are sampled in closed form. Gaussian and Mitchell use a piecewise-linear
//! inverse of their distribution, 4096 pieces for each stretch of one sign: the probability of any interval along an axis
//! is off by less than 2e-5 of the whole, the second moment by less than 1e-4 of
//! that of the absolute value (held by tests below).
//! Where a filter is negative its absolute value is sampled and the sample's weight carries the sign.

use crate::math::lanes::{Isa, Lanes, Wrapping};

/// The shape of a filter along one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilterShape {
    /// All alike.
    Box,
    /// Falling linearly to zero at the radius.
    Tent,
    /// A Gaussian whose deviation is a third of the radius, lowered to zero there.
    Gaussian,
    /// The cubic of Mitchell, Netravali, 1988, "Reconstruction filters in computer graphics", eq. 8, with B = C = 1/3,
    /// stretched from 2 to the radius.
    #[default]
    Mitchell,
}

impl FilterShape {
    /// The value at distance `x` from the centre, of any scale, negative in places for [`FilterShape::Mitchell`]; zero
    /// beyond `radius`.
    pub fn eval(self, x: f64, radius: f64) -> f64 {
        let x = (x / radius).abs();
        if x > 1.0 {
            return 0.0;
        }
        match self {
            Self::Box => 1.0,
            Self::Tent => 1.0 - x,
            Self::Gaussian => (-4.5 * x * x).exp() - (-4.5_f64).exp(),
            Self::Mitchell => mitchell(2.0 * x),
        }
    }
}

/// Eq. 8 for B = C = 1/3, times 18; `x` in [0, 2].
fn mitchell(x: f64) -> f64 {
    if x < 1.0 { (21.0 * x - 36.0) * x * x + 16.0 } else { ((-7.0 * x + 36.0) * x - 60.0) * x + 32.0 }
}

/// Where [`mitchell`] changes sign: the root of -7 x^3 + 36 x^2 - 60 x + 32 = (x - 2)^2 (8 - 7 x).
const MITCHELL_ROOT: f64 = 8.0 / 7.0;

/// Where a sample is taken and what it counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSample<F = f32> {
    /// Pixels from the centre of the pixel, to the right and down.
    pub offset: [F; 2],
    /// The filter's value over the probability density of `offset`, both normalised; of mean 1 over the unit square.
    pub weight: F,
}

/// A filter over the plane: a shape along each axis.
#[derive(Clone, Debug)]
pub struct Filter {
    shape: FilterShape,
    radius: f32,
    lobes: Vec<Lobe>,
    /// Integral of the absolute value over that of the value, along one axis.
    excess: f32,
}

impl Filter {
    /// A filter that reaches `radius` pixels, which is positive and finite, to either side.
    pub fn new(shape: FilterShape, radius: f32) -> Self {
        debug_assert!(radius > 0.0 && radius.is_finite(), "radius {radius}");
        let far = f64::from(radius);
        let stretches: &[(f64, f64, f32)] = match shape {
            FilterShape::Box | FilterShape::Tent => &[],
            FilterShape::Gaussian => &[(0.0, 1.0, 1.0)],
            FilterShape::Mitchell => &[(0.0, MITCHELL_ROOT / 2.0, 1.0), (MITCHELL_ROOT / 2.0, 1.0, -1.0)],
        };
        let mut lobes: Vec<_> =
            stretches.iter().map(|&(from, to, sign)| Lobe::new(shape, far, [from, to], sign)).collect();
        let absolute: f64 = lobes.iter().map(|lobe| lobe.mass).sum();
        let signed: f64 = lobes.iter().map(|lobe| lobe.mass * f64::from(lobe.sign)).sum();
        lobes.iter_mut().for_each(|lobe| lobe.mass /= absolute);
        let excess = if lobes.is_empty() { 1.0 } else { rounded(absolute / signed) };
        Self { shape, radius, lobes, excess }
    }

    /// Whether every sample weighs exactly 1.
    fn is_positive(&self) -> bool {
        self.shape != FilterShape::Mitchell
    }

    /// A point about the centre of a pixel; `u` in [0, 1) each. Along each axis the offset rises with `u`, so that what is
    /// stratified stays so.
    #[inline(always)]
    pub fn sample<F: Lanes>(&self, [u, v]: [F; 2]) -> FilterSample<F> {
        let one = u.splat(1.0);
        let [u, v] = [u * 2.0 - 1.0, v * 2.0 - 1.0];
        match self.shape {
            FilterShape::Box => FilterSample { offset: [u * self.radius, v * self.radius], weight: one },
            FilterShape::Tent => {
                FilterSample { offset: [tent(u) * self.radius, tent(v) * self.radius], weight: one }
            }
            FilterShape::Gaussian | FilterShape::Mitchell => {
                let ((x, sign_x), (y, sign_y)) = (self.tabulated(u), self.tabulated(v));
                let weight =
                    if self.is_positive() { one } else { sign_x * sign_y * (self.excess * self.excess) };
                FilterSample { offset: [x, y], weight }
            }
        }
    }

    /// Offset and sign for `v` in [-1, 1), whose sign chooses the side.
    #[inline(always)]
    fn tabulated<F: Lanes>(&self, v: F) -> (F, F) {
        let mut share = v.abs();
        let mut open = share.ge(0.0);
        // Beyond all lobes by rounding alone.
        let (mut offset, mut sign) = (v.splat(self.radius), v.splat(1.0));
        for lobe in &self.lobes {
            let mass = rounded(lobe.mass);
            let here = open & share.lt(mass);
            sign = F::select(open, v.splat(lobe.sign), sign);
            offset = F::select(here, lobe.at(share / mass), offset);
            open = open & !here;
            share -= mass;
        }
        (offset.copysign(v), sign)
    }
}

/// The inverse distribution of 1 - |x| for `v` in [-1, 1).
#[inline(always)]
fn tent<F: Lanes>(v: F) -> F {
    let one = v.splat(1.0);
    (one - (one - v.abs()).sqrt()).copysign(v)
}

/// One side of a filter between two zeros.
#[derive(Clone, Debug)]
struct Lobe {
    /// Integral of the absolute value; of all lobes of a side together 1 once the filter is made.
    mass: f64,
    sign: f32,
    /// Offsets at equal steps of the share of `mass` below them.
    inverse: Vec<f32>,
}

impl Lobe {
    /// Pieces of the inverse distribution.
    const PIECES: usize = 4096;

    /// Steps of the integral for each piece of the inverse.
    const STEPS: usize = 16 * Self::PIECES;

    /// The stretch of `shape` between two fractions of its radius, in which it has one sign.
    fn new(shape: FilterShape, radius: f64, [from, to]: [f64; 2], sign: f32) -> Self {
        let width = (to - from) * radius / real(Self::STEPS);
        let at = |step: f64| from * radius + width * step;
        let mut below = Vec::with_capacity(Self::STEPS + 1);
        let mut sum = 0.0;
        below.push(sum);
        for step in 0..Self::STEPS {
            sum += shape.eval(at(real(step) + 0.5), radius).abs() * width;
            below.push(sum);
        }
        let mut inverse = Vec::with_capacity(Self::PIECES + 1);
        let mut step = 0;
        for piece in 0..=Self::PIECES {
            let wanted = sum * real(piece) / real(Self::PIECES);
            while step + 1 < Self::STEPS && below[step + 1] < wanted {
                step += 1;
            }
            let within = (wanted - below[step]) / (below[step + 1] - below[step]);
            inverse.push(rounded(at(real(step) + within.clamp(0.0, 1.0))));
        }
        Self { mass: sum, sign, inverse }
    }

    /// The offset below which `share` of the lobe lies; in [0, 1), anything where it is not.
    #[inline(always)]
    fn at<F: Lanes>(&self, share: F) -> F {
        let position = share * Self::PIECES as f32;
        let whole = position.clamp(0.0, (Self::PIECES - 1) as f32).floor();
        let piece = whole.to_int();
        let isa = share.isa();
        let low = isa.gather(&self.inverse, piece);
        let high = isa.gather(&self.inverse, Wrapping::<u32>::wrapping_add(piece, 1));
        low + (high - low) * (position - whole)
    }
}

/// Indices here are far below 2^53.
#[expect(clippy::cast_precision_loss, reason = "small")]
fn real(n: usize) -> f64 {
    n as f64
}

/// Tables are kept in single precision.
#[expect(clippy::cast_possible_truncation, reason = "rounding is meant")]
fn rounded(x: f64) -> f32 {
    x as f32
}

#[cfg(test)]
#[path = "filter_tests.rs"]
mod tests;
