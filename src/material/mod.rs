//! Textures and numbers that make a BSDF at an interaction.

pub mod conductors;
mod cut_out;
mod media;
mod scattering;

pub use cut_out::CutOut;
pub use media::{Crossing, MOST_HIDDEN, Media};
pub use scattering::{Facets, Layer, Scattering};

use crate::bsdf::Mix;
use crate::math::Rgb;
use crate::math::lanes::Lanes;
use crate::texture::{Bitmap, Relief, Scalar, Spot, Texture};
use std::sync::Arc;

/// Which material of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MaterialId(pub u32);

impl MaterialId {
    /// The place in the scene's list.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A transparent substance with a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Index of refraction, relative to vacuum.
    pub ior: f32,
    /// Absorption per metre.
    pub absorption: Rgb<f32>,
    /// Where media overlap, the one of the highest priority is there.
    pub priority: i32,
}

/// What a surface is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// What it does with light.
    pub scattering: Scattering,
    /// The light it gives off.
    pub emission: Option<Emission>,
    /// Its relief.
    pub relief: Option<Relief>,
    /// How much of it is there: below a half there is a hole.
    pub opacity: Option<Scalar>,
}

/// Light that a surface gives off.
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    /// Radiance on the side of the normal.
    pub radiance: Texture,
    /// Whether the other side shines too.
    pub two_sided: bool,
}

impl Material {
    /// The medium that the surface bounds.
    #[must_use]
    pub fn medium(&self) -> Option<&Medium> {
        self.scattering.medium()
    }

    /// Whether it shows any picture, or asks one for its normal.
    #[must_use]
    pub fn has_images(&self) -> bool {
        let shows = self.emission.as_ref().is_some_and(|emission| emission.radiance.map().is_some());
        shows || self.scattering.has_images() || self.relief.is_some()
    }

    /// The pictures of it, those of its relief and of its opacity included; one may come twice.
    pub fn bitmaps(&self) -> impl Iterator<Item = &Arc<Bitmap>> {
        let emission = self.emission.as_ref().and_then(|emission| emission.radiance.map());
        let relief = self.relief.as_ref().map(Relief::map);
        let opacity = self.opacity.as_ref().map(|opacity| &opacity.map);
        let own = [emission, relief, opacity].into_iter().flatten();
        own.chain(self.scattering.maps()).map(|map| &map.bitmap)
    }

    /// Whether anything of it changes over the surface parameters.
    #[must_use]
    pub fn is_textured(&self) -> bool {
        let changes = self.emission.as_ref().is_some_and(|emission| !emission.radiance.is_constant());
        changes || self.scattering.is_textured() || self.relief.is_some()
    }

    /// Whether it reads surface parameters, or the direction in which they grow.
    #[must_use]
    pub fn reads_parameters(&self) -> bool {
        self.is_textured() || self.opacity.is_some() || self.scattering.turn().is_some()
    }

    /// Whether the surface is nothing but the boundary of its medium, so that between equal media it is not seen.
    #[must_use]
    pub fn is_interface(&self) -> bool {
        matches!(self.scattering, Scattering::Dielectric { .. })
    }

    /// Radiance that leaves the surface at a spot, on its front or back.
    #[must_use]
    pub fn emitted(&self, front: bool, spot: Spot<f32>) -> Rgb<f32> {
        match &self.emission {
            Some(Emission { radiance, two_sided }) if front || *two_sided => radiance.at(spot),
            _ => Rgb::BLACK,
        }
    }

    /// How the surface scatters at a spot; absent for black ones. `eta` is the index of the far side over that of the near
    /// side, and matters to dielectrics only.
    #[inline(always)]
    pub fn bsdf<F: Lanes>(&self, spot: impl Into<Spot<F>>, eta: F) -> Option<Mix<F>> {
        self.scattering.bsdf(spot.into(), eta)
    }
}
