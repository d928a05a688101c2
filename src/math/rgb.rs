//! Linear Rec.709 colour over lanes: reflectance, radiance, throughput.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub};

use super::lanes::{Lanes, Select};

/// Three channels, linear, Rec.709 primaries; one colour per lane. All operators work channel by channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rgb<F> {
    /// Red.
    pub r: F,
    /// Green.
    pub g: F,
    /// Blue.
    pub b: F,
}

impl<F> Rgb<F> {
    /// The colour (r, g, b).
    #[inline(always)]
    pub const fn new(r: F, g: F, b: F) -> Self {
        Self { r, g, b }
    }
}

impl<F: Copy> Rgb<F> {
    /// `x` in all channels.
    #[inline(always)]
    pub const fn gray(x: F) -> Self {
        Self::new(x, x, x)
    }
}

impl Rgb<f32> {
    /// No light.
    pub const BLACK: Self = Self::gray(0.0);
    /// Everything is returned.
    pub const WHITE: Self = Self::gray(1.0);
}

impl<F: Lanes> Rgb<F> {
    /// `c` in all lanes of the kind of `like`.
    #[inline(always)]
    pub fn splat(like: F, c: Rgb<f32>) -> Self {
        Self::new(like.splat(c.r), like.splat(c.g), like.splat(c.b))
    }
    /// Relative luminance Y by the weights of ITU-R BT.709, item 3.2.
    #[inline(always)]
    pub fn luminance(self) -> F {
        self.r * 0.2126 + self.g * 0.7152 + self.b * 0.0722
    }
    /// The greatest channel.
    #[inline(always)]
    pub fn max_channel(self) -> F {
        self.r.max(self.g.max(self.b))
    }
    /// `self` times one number for all lanes.
    #[inline(always)]
    pub fn scale(self, s: f32) -> Self {
        Self::new(self.r * s, self.g * s, self.b * s)
    }
    /// `self` at `t` = 0, `to` at 1.
    #[inline(always)]
    pub fn lerp(self, to: Self, t: F) -> Self {
        Self::new(self.r.lerp(to.r, t), self.g.lerp(to.g, t), self.b.lerp(to.b, t))
    }
    /// e^c of each channel.
    #[inline(always)]
    pub fn exp(self) -> Self {
        Self::new(self.r.exp(), self.g.exp(), self.b.exp())
    }
    /// The square root of each channel.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self::new(self.r.sqrt(), self.g.sqrt(), self.b.sqrt())
    }
    /// Each channel limited to [`low`, `high`]; NaN gives `low`.
    #[inline(always)]
    pub fn clamp(self, low: f32, high: f32) -> Self {
        Self::new(self.r.clamp(low, high), self.g.clamp(low, high), self.b.clamp(low, high))
    }
    /// All channels are finite.
    #[inline(always)]
    pub fn is_finite(self) -> F::Mask {
        self.r.is_finite() & self.g.is_finite() & self.b.is_finite()
    }
    /// All channels are zero.
    #[inline(always)]
    pub fn is_black(self) -> F::Mask {
        self.r.eq(0.0) & self.g.eq(0.0) & self.b.eq(0.0)
    }
    /// Lane `i`. Slow; for tests and rare cases.
    #[inline(always)]
    pub fn extract(self, i: usize) -> Rgb<f32> {
        Rgb::new(self.r.extract(i), self.g.extract(i), self.b.extract(i))
    }
}

impl<F: Lanes> Select for Rgb<F> {
    type Mask = F::Mask;
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self::new(F::select(mask, yes.r, no.r), F::select(mask, yes.g, no.g), F::select(mask, yes.b, no.b))
    }
}

/// One operator between colours, channel by channel.
macro_rules! channelwise {
    ($($op:ident :: $method:ident => $symbol:tt),*) => {
        $(impl<F: Lanes> $op for Rgb<F> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, c: Self) -> Self {
                Self::new(self.r $symbol c.r, self.g $symbol c.g, self.b $symbol c.b)
            }
        })*
    };
}
channelwise!(Add::add => +, Sub::sub => -, Mul::mul => *, Div::div => /);

impl<F: Lanes> Mul<F> for Rgb<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: F) -> Self {
        Self::new(self.r * s, self.g * s, self.b * s)
    }
}

impl<F: Lanes> Div<F> for Rgb<F> {
    type Output = Self;
    #[inline(always)]
    #[expect(clippy::suspicious_arithmetic_impl, reason = "one division instead of three")]
    fn div(self, s: F) -> Self {
        self * s.recip()
    }
}

impl<F: Lanes> AddAssign for Rgb<F> {
    #[inline(always)]
    fn add_assign(&mut self, c: Self) {
        *self = *self + c;
    }
}

impl<F: Lanes> MulAssign for Rgb<F> {
    #[inline(always)]
    fn mul_assign(&mut self, c: Self) {
        *self = *self * c;
    }
}

impl<F: Lanes> MulAssign<F> for Rgb<F> {
    #[inline(always)]
    fn mul_assign(&mut self, s: F) {
        *self = *self * s;
    }
}

impl From<[f32; 3]> for Rgb<f32> {
    #[inline(always)]
    fn from([r, g, b]: [f32; 3]) -> Self {
        Self::new(r, g, b)
    }
}

impl From<Rgb<f32>> for [f32; 3] {
    #[inline(always)]
    fn from(c: Rgb<f32>) -> Self {
        [c.r, c.g, c.b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_luminance_one() {
        assert!((Rgb::WHITE.luminance() - 1.0).abs() < 1e-6, "{}", Rgb::WHITE.luminance());
    }

    #[test]
    fn the_greatest_channel_ignores_nan() {
        assert_eq!(Rgb::new(1.0_f32, f32::NAN, 3.0).max_channel().to_bits(), 3.0_f32.to_bits(), "NaN loses");
    }
}
