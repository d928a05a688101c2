//! Values over a surface.

use crate::math::Rgb;
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
    /// The colour at surface parameters.
    #[must_use]
    pub fn at(&self, uv: Vec2) -> Rgb<f32> {
        match self {
            Self::Constant(color) => *color,
            Self::Checker { colors, repeat } => {
                let field = (uv * repeat).floor();
                let odd = (field.x + field.y).rem_euclid(2.0) >= 1.0;
                colors[usize::from(odd)]
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
        assert_eq!(checker.at(Vec2::new(0.1, 0.1)), Rgb::BLACK, "origin");
        assert_eq!(checker.at(Vec2::new(0.3, 0.1)), Rgb::WHITE, "next");
        assert_eq!(checker.at(Vec2::new(0.3, 0.6)), Rgb::BLACK, "diagonal");
        assert_eq!(checker.at(Vec2::new(-0.1, 0.1)), Rgb::WHITE, "negative");
    }
}
