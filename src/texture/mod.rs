//! Values over a surface.

use crate::math::Rgb;
use crate::math::lanes::{Lanes, Select};
use glam::Vec2;

/// A colour that may change over a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(Rgb<f32>),
    /// Two colours in turn.
    Checker {
        /// The colour at the origin, and the other.
        colors: [Rgb<f32>; 2],
        /// Fields per unit of each surface parameter.
        repeat: Vec2,
    },
}

impl Texture {
    /// Whether the colour is the same everywhere.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// The colour at surface parameters.
    #[inline(always)]
    pub fn at<F: Lanes>(&self, [u, v]: [F; 2]) -> Rgb<F> {
        match self {
            Self::Constant(color) => Rgb::splat(u, *color),
            Self::Checker { colors, repeat } => {
                let field = (u * repeat.x).floor() + (v * repeat.y).floor();
                let odd = (field - (field * 0.5).floor() * 2.0).ge(1.0);
                let [even, other] = colors.map(|color| Rgb::splat(u, color));
                Rgb::select(odd, other, even)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_alternate_on_both_sides_of_zero() {
        let checker = Texture::Checker { colors: [Rgb::BLACK, Rgb::WHITE], repeat: Vec2::new(4.0, 2.0) };
        assert_eq!(checker.at([0.1, 0.1_f32]), Rgb::BLACK, "origin");
        assert_eq!(checker.at([0.3, 0.1_f32]), Rgb::WHITE, "next");
        assert_eq!(checker.at([0.3, 0.6_f32]), Rgb::BLACK, "diagonal");
        assert_eq!(checker.at([-0.1, 0.1_f32]), Rgb::WHITE, "negative");
    }
}
