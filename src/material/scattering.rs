//! What a surface does with light.

use crate::bsdf::microfacet::Distribution;
use crate::bsdf::{
    Bsdf, Coat, Conductor, Dielectric, Diffuse, FresnelModel, Glass, Glossy, Jitter, Metal, Mirror, Mix,
    OrenNayar, Over, Part, Phong, RoughConductor, RoughDielectric, Schlick, Spread, ThinDielectric,
};
use crate::material::Medium;
use crate::math::Rgb;
use crate::math::lanes::Lanes;
use crate::texture::Texture;

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
    /// Matt and rough.
    OrenNayar {
        /// Fraction reflected by each slope.
        reflectance: Texture,
        /// From 0, smooth, to 1.
        roughness: f32,
    },
    /// A mirror of constant reflectance.
    Mirror {
        /// Fraction reflected.
        reflectance: Rgb<f32>,
    },
    /// Metal.
    Conductor {
        /// How much it reflects.
        metal: Metal<f32>,
        /// How rough it is; polished without.
        facets: Option<Facets>,
    },
    /// Glass, water: the boundary of a medium.
    Dielectric {
        /// What is behind.
        medium: Medium,
        /// How reflectance depends on the angle.
        fresnel: FresnelModel,
        /// How rough it is; polished without.
        facets: Option<Facets>,
    },
    /// A pane.
    ThinDielectric(ThinDielectric<f32>),
    /// A fuzzy mirror over a matt base.
    Glossy {
        /// The fuzzy mirror.
        lobe: Glossy<f32>,
        /// Fraction reflected by the base.
        base: Texture,
    },
    /// A reciprocal Phong lobe over a matt base.
    Phong {
        /// The lobe.
        lobe: Phong<f32>,
        /// Fraction reflected by the base.
        base: Texture,
    },
    /// A mirror with a trembling normal over a matt base.
    Jitter {
        /// The mirror.
        lobe: Jitter<f32>,
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
    /// From matt to mirror by one number.
    Schlick(Schlick<f32>),
    /// Several of the others in one place.
    Mix(Vec<Layer>),
}

/// How rough a surface is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facets {
    /// How normals are spread.
    pub distribution: Distribution<f32>,
    /// By how many radians the first tangent is turned about the normal, counter-clockwise seen from outside; absent where the
    /// spread is the same in all directions.
    pub turn: Option<f32>,
}

/// A part of a mix.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// What of the light falls to it.
    pub weight: Rgb<f32>,
    /// What it does; not a mix itself.
    pub scattering: Scattering,
}

impl Scattering {
    /// How the surface scatters; see [`crate::material::Material::bsdf`].
    #[inline(always)]
    pub(super) fn bsdf<F: Lanes>(&self, uv: [F; 2], eta: F) -> Option<Mix<F>> {
        let Self::Mix(layers) = self else { return Some(Mix::of(eta, self.single(uv, eta)?)) };
        let mut mix = Mix::nothing();
        for layer in layers {
            if let Some(bsdf) = layer.scattering.single(uv, eta) {
                mix.push(Part { weight: layer.weight.spread(eta), bsdf });
            }
        }
        Some(mix)
    }

    /// How one surface scatters, as [`crate::material::Material::bsdf`]; absent for black ones and for mixes.
    #[inline(always)]
    pub fn single<F: Lanes>(&self, uv: [F; 2], eta: F) -> Option<Bsdf<F>> {
        Some(match self {
            Self::Diffuse { reflectance } => Bsdf::Diffuse(Diffuse { reflectance: reflectance.at(uv) }),
            Self::OrenNayar { reflectance, roughness } => {
                let roughness = eta.splat(*roughness);
                Bsdf::OrenNayar(OrenNayar { reflectance: reflectance.at(uv), roughness })
            }
            Self::Mirror { reflectance } => Bsdf::Mirror(Mirror { reflectance: reflectance.spread(eta) }),
            Self::Conductor { metal, facets: None } => {
                Bsdf::Conductor(Conductor { metal: metal.spread(eta) })
            }
            Self::Conductor { metal, facets: Some(Facets { distribution, .. }) } => {
                let (metal, facets) = (metal.spread(eta), distribution.spread(eta));
                Bsdf::RoughConductor(RoughConductor { metal, facets })
            }
            Self::Dielectric { fresnel, facets: None, .. } => {
                Bsdf::Dielectric(Dielectric { glass: Glass::new(*fresnel, eta) })
            }
            Self::Dielectric { fresnel, facets: Some(Facets { distribution, .. }), .. } => {
                let (glass, facets) = (Glass::new(*fresnel, eta), distribution.spread(eta));
                Bsdf::RoughDielectric(RoughDielectric { glass, facets })
            }
            Self::ThinDielectric(pane) => Bsdf::ThinDielectric(pane.spread(eta)),
            Self::Glossy { lobe, base } => Bsdf::Glossy(over(lobe.spread(eta), base.at(uv))),
            Self::Phong { lobe, base } => Bsdf::Phong(over(lobe.spread(eta), base.at(uv))),
            Self::Jitter { lobe, base } => Bsdf::Jitter(over(lobe.spread(eta), base.at(uv))),
            Self::Glazed { coat, base } => Bsdf::Glazed(coat.over(base.at(uv))),
            Self::Schlick(surface) => Bsdf::Schlick(surface.spread(eta)),
            Self::Black | Self::Mix(_) => return None,
        })
    }

    /// The surfaces that this one is made of: itself, or the parts of a mix.
    pub fn parts(&self) -> impl Iterator<Item = &Self> {
        let layers = if let Self::Mix(layers) = self { layers.as_slice() } else { &[] };
        let own = (!matches!(self, Self::Mix(_))).then_some(self);
        own.into_iter().chain(layers.iter().map(|layer| &layer.scattering))
    }

    /// Whether a path has a choice of ways on.
    #[must_use]
    pub fn has_choice(&self) -> bool {
        match self {
            Self::Black
            | Self::Diffuse { .. }
            | Self::OrenNayar { .. }
            | Self::Mirror { .. }
            | Self::Conductor { .. } => false,
            Self::Dielectric { .. }
            | Self::ThinDielectric(_)
            | Self::Glossy { .. }
            | Self::Phong { .. }
            | Self::Jitter { .. }
            | Self::Glazed { .. }
            | Self::Schlick(_)
            | Self::Mix(_) => true,
        }
    }

    /// Whether anything of it changes over the surface.
    #[must_use]
    pub fn is_textured(&self) -> bool {
        self.parts().any(|part| match part {
            Self::Diffuse { reflectance } | Self::OrenNayar { reflectance, .. } => !reflectance.is_constant(),
            Self::Glossy { base, .. }
            | Self::Phong { base, .. }
            | Self::Jitter { base, .. }
            | Self::Glazed { base, .. } => !base.is_constant(),
            _ => false,
        })
    }

    /// The medium that the surface bounds.
    pub(super) fn medium(&self) -> Option<&Medium> {
        self.parts()
            .find_map(|part| if let Self::Dielectric { medium, .. } = part { Some(medium) } else { None })
    }

    /// By how much the first tangent is turned about the normal, where the surface is not the same in all directions.
    #[must_use]
    pub fn turn(&self) -> Option<f32> {
        self.parts().find_map(|part| match part {
            Self::Conductor { facets, .. } | Self::Dielectric { facets, .. } => facets.as_ref()?.turn,
            Self::Schlick(surface) => (!surface.is_isotropic()).then_some(0.0),
            _ => None,
        })
    }

    /// Whether light may go straight on through the surface.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.parts().any(|part| matches!(part, Self::Dielectric { .. } | Self::ThinDielectric(_)))
    }

    /// What of the light goes straight on through the surface at this cosine with the normal, absorption inside left out.
    ///
    /// For a pane that is the truth. A body bends light in as it bends it out, so the true way meets both faces alike: the
    /// outer angle counts at each. Roughness is left out: what it spreads is taken as going straight on.
    #[must_use]
    pub fn passes(&self, cos: f32) -> Rgb<f32> {
        match self {
            Self::Dielectric { medium, fresnel, .. } => {
                Rgb::gray(1.0 - Glass::new(*fresnel, medium.ior).at(cos).reflectance)
            }
            Self::ThinDielectric(pane) => pane.fractions(cos)[1],
            Self::Mix(layers) => {
                layers.iter().fold(Rgb::BLACK, |sum, layer| sum + layer.weight * layer.scattering.passes(cos))
            }
            _ => Rgb::BLACK,
        }
    }
}

/// A lobe over a matt base of this colour.
#[inline(always)]
fn over<L, F>(lobe: L, reflectance: Rgb<F>) -> Over<L, F> {
    Over { lobe, base: Diffuse { reflectance } }
}
