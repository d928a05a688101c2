//! Textures and numbers that make a BSDF at an interaction.

pub mod conductors;
mod media;

pub use media::{Crossing, Media};

use crate::bsdf::microfacet::{Ggx, SMOOTHEST};
use crate::bsdf::{Bsdf, Coat, Conductor, Dielectric, Diffuse, Glossy, Mirror, RoughConductor};
use crate::math::Rgb;
use crate::texture::Texture;
use glam::Vec2;

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
}

/// Light that a surface gives off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Radiance on the side of the normal.
    pub radiance: Rgb<f32>,
    /// Whether the other side shines too.
    pub two_sided: bool,
}

/// What a surface does with light.
#[derive(Clone, Debug, PartialEq)]
pub enum Scattering {
    /// Nothing: a black surface, or a light.
    Black,
    /// Matt.
    Diffuse {
        /// Fraction reflected.
        reflectance: Texture,
    },
    /// A mirror of constant reflectance.
    Mirror {
        /// Fraction reflected.
        reflectance: Rgb<f32>,
    },
    /// Metal.
    Conductor {
        /// Real part of the index of refraction.
        eta: Rgb<f32>,
        /// Extinction.
        k: Rgb<f32>,
        /// GGX roughness; polished below [`SMOOTHEST`].
        alpha: f32,
    },
    /// Glass, water: the boundary of a medium.
    Dielectric(Medium),
    /// A fuzzy mirror over a matt base.
    Glossy {
        /// Exponent of the lobe.
        exponent: f32,
        /// Fraction reflected by the lobe.
        reflectance: Rgb<f32>,
        /// Fraction reflected by the base.
        base: Texture,
    },
    /// A smooth coat over a matt base.
    Glazed {
        /// The coat.
        coat: Coat,
        /// Fraction reflected by the base, coat removed.
        base: Texture,
    },
}

impl Material {
    /// The medium that the surface bounds.
    #[must_use]
    pub fn medium(&self) -> Option<&Medium> {
        if let Scattering::Dielectric(medium) = &self.scattering { Some(medium) } else { None }
    }

    /// Radiance that leaves the surface, on its front or back.
    #[must_use]
    pub fn emitted(&self, front: bool) -> Rgb<f32> {
        match self.emission {
            Some(Emission { radiance, two_sided }) if front || two_sided => radiance,
            _ => Rgb::BLACK,
        }
    }

    /// How the surface scatters at surface parameters `uv`; absent for black ones. `eta` is the index of
    /// the far side over that of the near side, and matters to dielectrics only.
    #[must_use]
    pub fn bsdf(&self, uv: Vec2, eta: f32) -> Option<Bsdf<f32>> {
        Some(match &self.scattering {
            Scattering::Diffuse { reflectance } => Bsdf::Diffuse(Diffuse { reflectance: reflectance.at(uv) }),
            Scattering::Mirror { reflectance } => Bsdf::Mirror(Mirror { reflectance: *reflectance }),
            &Scattering::Conductor { eta, k, alpha } if alpha < SMOOTHEST => {
                Bsdf::Conductor(Conductor { eta, k })
            }
            &Scattering::Conductor { eta, k, alpha } => {
                Bsdf::RoughConductor(RoughConductor { eta, k, ggx: Ggx::isotropic(alpha) })
            }
            Scattering::Dielectric(_) => Bsdf::Dielectric(Dielectric { eta }),
            Scattering::Glossy { exponent, reflectance, base } => Bsdf::Glossy {
                lobe: Glossy { reflectance: *reflectance, exponent: *exponent },
                base: Diffuse { reflectance: base.at(uv) },
            },
            Scattering::Glazed { coat, base } => Bsdf::Glazed(coat.over(base.at(uv))),
            Scattering::Black => return None,
        })
    }
}
