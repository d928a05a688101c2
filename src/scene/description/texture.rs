//! Values over a surface: colours, numbers, normals and heights.

use super::{Channel, Located, PerTangent, Space, Wrap};
use crate::image::RASTERS;
use crate::math::Rgb;
use crate::scene::load::check;
use crate::scene::record::{record, words};
use std::path::PathBuf;

/// A colour that may vary over a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(Rgb<f32>),
    /// Two colours by turns.
    Checker(Checker),
    /// A picture.
    Image(Box<ImageTexture>),
}

impl Texture {
    /// The same gray everywhere.
    #[must_use]
    pub const fn gray(value: f32) -> Self {
        Self::Constant(Rgb::gray(value))
    }
}

record! {
    /// A chequered pattern over surface parameters.
    pub struct Checker {
        /// The two colours; the first one starts at the origin of the surface parameters.
        checker: [Rgb<f32>; 2], min(0.0), max(1.0);
        /// How many fields there are along u and along v between 0 and 1.
        repeat: [f32; 2] = [2.0, 2.0], above(0.0), max(1e6);
    }
}

record! {
    /// How a picture lies over surface parameters.
    pub struct Lie {
        /// What is beyond the edges of the picture.
        wrap: Wrap = Wrap::Repeat;
        /// How often the picture is repeated along u and along v between 0 and 1; negative numbers mirror it, which reliefs cannot be.
        repeat: [f32; 2] = [1.0, 1.0], min(-1e6), max(1e6);
        /// What is added to the repeated parameters.
        offset: [f32; 2] = [0.0, 0.0], min(-1e6), max(1e6);
    }
}

record! {
    /// A picture over surface parameters: its lower left corner is at 0, its upper right one at 1.
    pub struct ImageTexture {
        /// A PNG, JPEG, EXR or HDR file.
        file: Located<PathBuf>, picture(RASTERS);
        /// What its numbers stand for; absent: `srgb` for colours of PNG and JPEG files, else `linear`.
        space: Option<Space>;
        /// What its colours are multiplied by; what is reflected is cut at 1.
        factor: Rgb<f32> = Rgb::gray(1.0), min(0.0), max(1e20);
        ..lie: Lie, "How the picture lies.";
    }
}

record! {
    /// One number per point of a picture over surface parameters.
    pub struct ScalarTexture {
        /// A PNG, JPEG, EXR or HDR file.
        file: Located<PathBuf>, picture(RASTERS);
        /// Which of its numbers; absent: `a` for an opacity where the file has it, else `r`.
        channel: Option<Channel>;
        /// What its numbers stand for.
        space: Space = Space::Linear;
        /// What the number is multiplied by; beyond 1 it is cut.
        factor: f32 = 1.0, min(0.0), max(1e6);
        ..lie: Lie, "How the picture lies.";
    }
}

record! {
    /// A picture of normals in tangent space: red, green and blue from 0 to 1 are -1 to 1 along u, along v and outwards.
    pub struct NormalMap checked by check::normal_map {
        /// A PNG, JPEG, EXR or HDR file; its numbers are taken as they are.
        file: Located<PathBuf>, picture(RASTERS);
        /// What the lean along u and v is multiplied by.
        strength: f32 = 1.0, min(0.0), max(100.0);
        /// Whether green counts against v, as some programs write it.
        flip_y: bool = false;
        ..lie: Lie, "How the picture lies, not mirrored.";
    }
}

record! {
    /// A picture of heights: the surface is shaded as if white stood out over black. Its outline stays as it is.
    pub struct Bump checked by check::bump {
        /// A PNG, JPEG, EXR or HDR file; its numbers are taken as they are.
        file: Located<PathBuf>, picture(RASTERS);
        /// Where the heights are; red without, which in gray pictures is the shade.
        channel: Option<Channel>;
        /// How far white stands out over black, in widths of a texel: 1 makes a slope of 45 degrees of white beside black; negative
        /// numbers sink it.
        strength: f32 = 1.0, min(-1e4), max(1e4);
        /// The same in metres, instead of `strength`.
        height: Option<f32>, unit("m"), min(-1e6), max(1e6);
        ..lie: Lie, "How the picture lies, not mirrored.";
    }
}

words! {
    Space {
        /// Light by the curve of sRGB.
        "srgb" => Srgb,
        /// Light, or other numbers, as they are.
        "linear" => Linear,
    }
}

words! {
    Wrap {
        /// The picture again.
        "repeat" => Repeat,
        /// The picture again, every other time mirrored.
        "mirror" => Mirror,
        /// The colour of the edge.
        "clamp" => Clamp,
    }
}

words! {
    Channel {
        /// Red, or the shade of a gray picture.
        "r" => Red,
        /// Green.
        "g" => Green,
        /// Blue.
        "b" => Blue,
        /// Coverage; 1 where the file has none.
        "a" => Alpha,
    }
}

/// A width of facets that may vary over a surface, then alike in all directions.
#[derive(Clone, Debug, PartialEq)]
pub enum Roughness {
    /// The same everywhere.
    Constant(PerTangent),
    /// A picture.
    Image(Box<ScalarTexture>),
}
