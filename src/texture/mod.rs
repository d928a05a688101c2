//! Values over a surface.
//!
//! A texture is asked at a [`Spot`]: surface parameters, and how wide the ray is there. Pictures are shared by all textures that
//! show them.

mod bitmap;
mod heights;
mod mapped;
mod normal_map;
mod scalar;

pub use bitmap::{Bitmap, Space};
pub use heights::{Height, Heights};
pub use mapped::{Channel, Mapped, Wrap};
pub use normal_map::NormalMap;
pub use scalar::Scalar;

use crate::math::Rgb;
use crate::math::lanes::{Lanes, Select};
use glam::Vec2;

/// What is known of the fine shape of a surface beside its mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Relief {
    /// Where the normal leans to.
    Normals(NormalMap),
    /// How far points stand out.
    Heights(Heights),
}

impl Relief {
    /// The picture and how it lies.
    #[must_use]
    pub fn map(&self) -> &Mapped {
        match self {
            Self::Normals(normals) => &normals.map,
            Self::Heights(heights) => &heights.map,
        }
    }
}

/// Where a texture is asked.
#[derive(Clone, Copy, Debug)]
pub struct Spot<F> {
    /// Surface parameters.
    pub uv: [F; 2],
    /// How wide the ray is, in surface parameters; 0 for a point.
    pub footprint: F,
}

impl<F: Lanes> From<[F; 2]> for Spot<F> {
    #[inline(always)]
    fn from(uv: [F; 2]) -> Self {
        Self { uv, footprint: uv[0].splat(0.0) }
    }
}

/// A colour that may change over a surface.
#[derive(Clone, Debug, PartialEq)]
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
    /// A picture.
    Image {
        /// The picture and how it lies.
        map: Mapped,
        /// What its colours are multiplied by.
        factor: Rgb<f32>,
        /// What no channel exceeds: 1 for what is reflected, infinity for light.
        limit: f32,
    },
}

impl Texture {
    /// Whether the colour is the same everywhere.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// The picture that it shows and how it lies, if it does.
    #[must_use]
    pub fn map(&self) -> Option<&Mapped> {
        if let Self::Image { map, .. } = self { Some(map) } else { None }
    }

    /// The mean over the surface parameters.
    #[must_use]
    pub fn mean(&self) -> Rgb<f32> {
        match self {
            Self::Constant(color) => *color,
            Self::Checker { colors: [a, b], .. } => (*a + *b).scale(0.5),
            Self::Image { map, factor, limit } => {
                let [r, g, b, _] = map.bitmap.mean();
                (Rgb::new(r, g, b) * *factor).clamp(0.0, *limit)
            }
        }
    }

    /// The colour at a spot.
    #[inline(always)]
    pub fn at<F: Lanes>(&self, spot: impl Into<Spot<F>>) -> Rgb<F> {
        let spot = spot.into();
        let [u, v] = spot.uv;
        match self {
            Self::Constant(color) => Rgb::splat(u, *color),
            Self::Checker { colors, repeat } => {
                let field = (u * repeat.x).floor() + (v * repeat.y).floor();
                let odd = (field - (field * 0.5).floor() * 2.0).ge(1.0);
                let [even, other] = colors.map(|color| Rgb::splat(u, color));
                Rgb::select(odd, other, even)
            }
            Self::Image { map, factor, limit } => {
                (map.color_at(spot) * Rgb::splat(u, *factor)).clamp(0.0, *limit)
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
