//! A picture laid over surface parameters, and how it is looked up.
//!
//! Surface parameters of 0 and 1 are the edges of the picture: u to the right, v upwards. Within a level four texels are
//! interpolated, between levels two; the level is that at which the footprint of a ray is one texel wide.

use crate::math::Rgb;
use crate::math::lanes::{Compare, Isa, Kernel, Lanes, MaskLanes};
use crate::texture::{Bitmap, Spot};
use glam::Vec2;
use std::sync::Arc;

/// What is beyond the edges of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// The picture again, every other time mirrored.
    Mirror,
    /// The colour of the edge.
    Clamp,
}

/// A picture over a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapped {
    /// The picture.
    pub bitmap: Arc<Bitmap>,
    /// What is beyond its edges.
    pub wrap: Wrap,
    /// How often it is repeated for each unit of the surface parameters; negative ones mirror it.
    pub repeat: Vec2,
    /// What is added to the repeated parameters.
    pub offset: Vec2,
}

/// One number of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Red, or the shade of a gray picture.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// Coverage.
    Alpha,
}

impl Mapped {
    /// Red, green, blue and coverage.
    #[inline(always)]
    pub fn at<F: Lanes>(&self, spot: Spot<F>) -> [F; 4] {
        look_up(spot.uv[0].isa(), self, spot)
    }

    /// The colour.
    #[inline(always)]
    pub(super) fn color_at<F: Lanes>(&self, spot: Spot<F>) -> Rgb<F> {
        let [r, g, b, _] = self.at(spot);
        Rgb::new(r, g, b)
    }

    /// -1 along those axes on which the picture is mirrored at a place, 1 along the others.
    #[inline(always)]
    pub(super) fn turned<F: Lanes>(&self, [u, v]: [F; 2]) -> [F; 2] {
        let one = u.splat(1.0);
        if self.wrap != Wrap::Mirror {
            return [one, one];
        }
        let of = |x: F| {
            let half = x * 0.5;
            F::select((half - half.floor()).ge(0.5), -one, one)
        };
        [of(u * self.repeat.x + self.offset.x), of(v * self.repeat.y + self.offset.y)]
    }

    /// One of the channels.
    #[inline(always)]
    pub(super) fn channel_at<F: Lanes>(&self, spot: Spot<F>, channel: Channel) -> F {
        let [r, g, b, a] = self.at(spot);
        match channel {
            Channel::Red => r,
            Channel::Green => g,
            Channel::Blue => b,
            Channel::Alpha => a,
        }
    }
}

/// A function of its own per instruction set: in line, kernels would hold it once for each kind of surface.
#[inline(never)]
fn look_up<S: Isa>(isa: S, map: &Mapped, spot: Spot<S::F>) -> [S::F; 4] {
    isa.run(LookUp { map, spot })
}

struct LookUp<'a, F> {
    map: &'a Mapped,
    spot: Spot<F>,
}

impl<S: Isa> Kernel<S> for LookUp<'_, S::F> {
    type Output = [S::F; 4];
    #[inline(always)]
    fn run(self, isa: S) -> [S::F; 4] {
        let Self { map: Mapped { bitmap, wrap, repeat, offset }, spot } = self;
        let [u, v] = spot.uv;
        let (u, v) = (u * repeat.x + offset.x, v * repeat.y + offset.y);
        let st = [wrapped(*wrap, u), -wrapped(*wrap, v) + 1.0];
        let [width, height] = bitmap.size();
        let texels = spot.footprint * ((repeat.x * repeat.y).abs() * width * height).sqrt();
        #[expect(clippy::cast_precision_loss, reason = "few levels")]
        let last = (bitmap.levels() - 1) as f32;
        if texels.le(1.0).all() {
            return smooth::<S>((bitmap, *wrap), isa.splat(0.0), st);
        }
        let level = (texels.ln() * std::f32::consts::LOG2_E).clamp(0.0, last);
        let finer = level.floor();
        let part = level - finer;
        let fine = smooth::<S>((bitmap, *wrap), finer, st);
        let coarse = smooth::<S>((bitmap, *wrap), (finer + 1.0).min(last), st);
        let [r, g, b, a] = fine;
        [r.lerp(coarse[0], part), g.lerp(coarse[1], part), b.lerp(coarse[2], part), a.lerp(coarse[3], part)]
    }
}

/// The parameter brought between 0 and 1.
#[inline(always)]
fn wrapped<F: Lanes>(wrap: Wrap, x: F) -> F {
    let inside = match wrap {
        Wrap::Repeat => x - x.floor(),
        Wrap::Mirror => {
            let x = x - (x * 0.5).floor() * 2.0;
            -(x - 1.0).abs() + 1.0
        }
        Wrap::Clamp => x,
    };
    // Parameters that overflow when they are repeated are not numbers by now: those are 0.
    inside.clamp(0.0, 1.0)
}

/// Four texels of a level interpolated; `s` to the right and `t` downwards, between 0 and 1.
#[inline(always)]
fn smooth<S: Isa>((bitmap, wrap): (&Bitmap, Wrap), level: S::F, [s, t]: [S::F; 2]) -> [S::F; 4] {
    let level = level.to_int();
    let [width, height] = bitmap.size_of(level);
    let ([x0, x1], fx) = neighbours(wrap, s * width - 0.5, width);
    let ([y0, y1], fy) = neighbours(wrap, t * height - 0.5, height);
    let [a, b] = [bitmap.at(level, width, [x0, y0]), bitmap.at(level, width, [x1, y0])];
    let [c, d] = [bitmap.at(level, width, [x0, y1]), bitmap.at(level, width, [x1, y1])];
    let between = |i: usize| {
        let (upper, lower) = (a[i].lerp(b[i], fx), c[i].lerp(d[i], fx));
        upper.lerp(lower, fy)
    };
    [between(0), between(1), between(2), between(3)]
}

/// The two texels about a place, and how far it is from the first to the second.
#[inline(always)]
fn neighbours<F: Lanes>(wrap: Wrap, at: F, size: F) -> ([F; 2], F) {
    let first = at.floor();
    let part = at - first;
    let (before, after) = (first, first + 1.0);
    let zero = at.splat(0.0);
    let [low, high] = match wrap {
        Wrap::Repeat => [size - 1.0, zero],
        Wrap::Mirror | Wrap::Clamp => [zero, size - 1.0],
    };
    let before = F::select(before.lt(0.0), low, before);
    let after = F::select(after.ge(size), high, after);
    ([before, after], part)
}
