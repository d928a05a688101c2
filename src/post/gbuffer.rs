//! What pass one knows of a picture: light, and where mirrored rays go.

use crate::image::Window;
use glam::Vec3;

/// A picture of geometry, one ray per pixel.
///
/// Rays of neighbouring pixels are a pixel apart: the grid may be moved as a whole, as it is from one sample of a picture to the next, on the
/// film, on the lens and in time, but no ray by itself, since the filter takes pixels for samples of equal area.
#[derive(Clone, Debug, PartialEq)]
pub struct GBuffer {
    /// Width and height of the whole picture.
    pub full: [u32; 2],
    /// The pixels that are there.
    pub window: Window,
    /// Pixels of a picture at unit distance from the camera: height / (2 tan(angle of view / 2)).
    pub scale: f32,
    /// What the picture counts by the filter of the film.
    pub weight: f32,
    /// The pixels by row from the top.
    pub texels: Vec<Texel>,
}

/// What is known of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Texel {
    /// All light but that of the filtered reflection, W/(sr m^2).
    pub rest: Rgb3,
    /// What of that came by two edges at most.
    pub direct: Rgb3,
    /// The part of the pixel that shows a surface.
    pub alpha: f32,
    /// The fuzzy reflector that the pixel shows.
    pub mirror: Option<Mirror>,
}

/// Light of a pixel, by channel.
pub type Rgb3 = [f32; 3];

/// A fuzzy reflector as an ideal mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// Light along the mirrored ray, without what the reflector makes of it, W/(sr m^2).
    pub radiance: Rgb3,
    /// What of it the reflector sends on: its colour, and Fresnel's factor where it has one.
    pub factor: Rgb3,
    /// The point of the reflector, in metres.
    pub a: Vec3,
    /// Unit normal there, on the viewer's side.
    pub normal: Vec3,
    /// Where the mirrored ray ends.
    pub end: End,
    /// Distance of `a` from the eye, in metres.
    pub s: f32,
    /// Which reflector, counted from 1. Those of different numbers are kept apart.
    pub reflector: u32,
    /// Exponent of the lobe about the mirrored ray, or its shininess.
    pub exponent: f32,
    /// Strength of the shine, in [0, 1]; counts under [`super::Weighting::Shininess`] only.
    pub strength: f32,
    /// What the mirrored ray hits, counted from 1; 0 for nothing.
    pub hit: u32,
}

/// Where a ray ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// At a point, in metres.
    At(Vec3),
    /// Nowhere: it goes on for ever in this direction, a unit vector.
    Away(Vec3),
}

impl Mirror {
    /// Unit direction of the mirrored ray; `None` if it ends where it begins.
    #[must_use]
    pub fn direction(&self) -> Option<Vec3> {
        match self.end {
            End::At(b) => (b - self.a).try_normalize(),
            End::Away(d) => Some(d),
        }
    }

    /// How long the mirrored ray is, in metres; infinite if it ends nowhere.
    #[must_use]
    pub fn length(&self) -> f32 {
        match self.end {
            End::At(b) => b.distance(self.a),
            End::Away(_) => f32::INFINITY,
        }
    }
}

impl GBuffer {
    /// The pixel in that column and row of the whole picture, if it is there.
    #[must_use]
    pub fn texel(&self, x: u32, y: u32) -> Option<&Texel> {
        self.window.contains(x, y).then(|| &self.texels[self.place(x, y)])
    }

    /// The number of a pixel that is there.
    pub(super) fn place(&self, x: u32, y: u32) -> usize {
        (y - self.window.y0) as usize * self.window.width() as usize + (x - self.window.x0) as usize
    }

    /// The same with another exponent for all reflectors.
    pub fn set_exponent(&mut self, exponent: f32) {
        self.mirrors_mut().for_each(|mirror| mirror.exponent = exponent);
    }

    /// The same with another strength for all reflectors.
    pub fn set_strength(&mut self, strength: f32) {
        self.mirrors_mut().for_each(|mirror| mirror.strength = strength);
    }

    fn mirrors_mut(&mut self) -> impl Iterator<Item = &mut Mirror> {
        self.texels.iter_mut().filter_map(|texel| texel.mirror.as_mut())
    }
}
