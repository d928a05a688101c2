//! What a surface does with light.

use crate::bsdf::microfacet::{Beckmann, Distribution, Ggx, SMOOTHEST};
use crate::bsdf::{
    Bsdf, Coat, Conductor, Dielectric, Diffuse, FresnelModel, Glass, Glossy, Jitter, Metal, Mirror, Mix,
    OrenNayar, Over, Part, Phong, RoughConductor, RoughDielectric, Schlick, Spread, ThinDielectric,
};
use crate::material::Medium;
use crate::math::Rgb;
use crate::math::lanes::Lanes;
use crate::texture::{Mapped, Scalar, Spot, Texture};

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
    /// A mirror, the same at all angles.
    Mirror {
        /// Fraction reflected.
        reflectance: Texture,
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
#[derive(Clone, Debug, PartialEq)]
pub struct Facets {
    /// How normals are spread.
    pub distribution: Distribution<f32>,
    /// By how many radians the first tangent is turned about the normal, counter-clockwise seen from outside; absent where the
    /// spread is the same in all directions.
    pub turn: Option<f32>,
    /// The width of the spread where it changes over the surface, instead of that of `distribution`; alike in all directions.
    pub width: Option<Scalar>,
}

impl Facets {
    /// How normals are spread at a spot.
    #[inline(always)]
    fn at<F: Lanes>(&self, spot: Spot<F>) -> Distribution<F> {
        let spread = self.distribution.spread(spot.footprint);
        let Some(width) = &self.width else { return spread };
        let alpha = width.at(spot).max(SMOOTHEST);
        match spread {
            Distribution::Ggx(_) => Distribution::Ggx(Ggx { alpha_x: alpha, alpha_y: alpha }),
            Distribution::Beckmann(_) => Distribution::Beckmann(Beckmann { alpha_x: alpha, alpha_y: alpha }),
        }
    }
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
    pub(super) fn bsdf<F: Lanes>(&self, spot: Spot<F>, eta: F) -> Option<Mix<F>> {
        let Self::Mix(layers) = self else { return Some(Mix::of(eta, self.single(spot, eta)?)) };
        let mut mix = Mix::nothing();
        for layer in layers {
            if let Some(bsdf) = layer.scattering.single(spot, eta) {
                mix.push(Part { weight: layer.weight.spread(eta), bsdf });
            }
        }
        Some(mix)
    }

    /// How one surface scatters, as [`crate::material::Material::bsdf`]; absent for black ones and for mixes.
    #[inline(always)]
    pub fn single<F: Lanes>(&self, spot: impl Into<Spot<F>>, eta: F) -> Option<Bsdf<F>> {
        let spot = spot.into();
        Some(match self {
            Self::Diffuse { reflectance } => Bsdf::Diffuse(Diffuse { reflectance: reflectance.at(spot) }),
            Self::OrenNayar { reflectance, roughness } => {
                let roughness = eta.splat(*roughness);
                Bsdf::OrenNayar(OrenNayar { reflectance: reflectance.at(spot), roughness })
            }
            Self::Mirror { reflectance } => Bsdf::Mirror(Mirror { reflectance: reflectance.at(spot) }),
            Self::Conductor { metal, facets: None } => {
                Bsdf::Conductor(Conductor { metal: metal.spread(eta) })
            }
            Self::Conductor { metal, facets: Some(facets) } => {
                let (metal, facets) = (metal.spread(eta), facets.at(spot));
                Bsdf::RoughConductor(RoughConductor { metal, facets })
            }
            Self::Dielectric { fresnel, facets: None, .. } => {
                Bsdf::Dielectric(Dielectric { glass: Glass::new(*fresnel, eta) })
            }
            Self::Dielectric { fresnel, facets: Some(facets), .. } => {
                let (glass, facets) = (Glass::new(*fresnel, eta), facets.at(spot));
                Bsdf::RoughDielectric(RoughDielectric { glass, facets })
            }
            Self::ThinDielectric(pane) => Bsdf::ThinDielectric(pane.spread(eta)),
            Self::Glossy { lobe, base } => Bsdf::Glossy(over(lobe.spread(eta), base.at(spot))),
            Self::Phong { lobe, base } => Bsdf::Phong(over(lobe.spread(eta), base.at(spot))),
            Self::Jitter { lobe, base } => Bsdf::Jitter(over(lobe.spread(eta), base.at(spot))),
            Self::Glazed { coat, base } => Bsdf::Glazed(coat.over(base.at(spot))),
            Self::Schlick(surface) => Bsdf::Schlick(surface.spread(eta)),
            Self::Black | Self::Mix(_) => return None,
        })
    }

    /// The surfaces that this one is made of: itself, or the parts of a mix.
    pub fn parts(&self) -> impl Iterator<Item = &Self> {
        self.all_parts().map(|(part, _)| part)
    }

    /// The same, but for parts of weight zero, which may be kept for comparison.
    fn parts_that_count(&self) -> impl Iterator<Item = &Self> {
        self.all_parts().filter(|(_, counts)| *counts).map(|(part, _)| part)
    }

    /// All parts, and whether they have any weight.
    fn all_parts(&self) -> impl Iterator<Item = (&Self, bool)> {
        let layers = if let Self::Mix(layers) = self { layers.as_slice() } else { &[] };
        let own = (!matches!(self, Self::Mix(_))).then_some((self, true));
        own.into_iter().chain(layers.iter().map(|layer| (&layer.scattering, !layer.weight.is_black())))
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
        self.parts().any(|part| part.texture().is_some_and(|t| !t.is_constant()) || part.width().is_some())
    }

    /// Whether it shows any picture.
    #[must_use]
    pub fn has_images(&self) -> bool {
        self.maps().next().is_some()
    }

    /// The pictures that it shows, and how they lie.
    pub(super) fn maps(&self) -> impl Iterator<Item = &Mapped> {
        self.parts().flat_map(|part| {
            [part.texture().and_then(Texture::map), part.width().map(|width| &width.map)]
                .into_iter()
                .flatten()
        })
    }

    /// What colours a single surface.
    fn texture(&self) -> Option<&Texture> {
        match self {
            Self::Diffuse { reflectance }
            | Self::OrenNayar { reflectance, .. }
            | Self::Mirror { reflectance } => Some(reflectance),
            Self::Glossy { base, .. }
            | Self::Phong { base, .. }
            | Self::Jitter { base, .. }
            | Self::Glazed { base, .. } => Some(base),
            _ => None,
        }
    }

    /// How rough a single surface is, where that changes over it.
    fn width(&self) -> Option<&Scalar> {
        match self {
            Self::Conductor { facets, .. } | Self::Dielectric { facets, .. } => {
                facets.as_ref()?.width.as_ref()
            }
            _ => None,
        }
    }

    /// The medium that the surface bounds.
    pub(super) fn medium(&self) -> Option<&Medium> {
        self.parts_that_count()
            .find_map(|part| if let Self::Dielectric { medium, .. } = part { Some(medium) } else { None })
    }

    /// By how much the first tangent is turned about the normal, where the surface is not the same in all directions. Parts of a mix are
    /// all turned alike.
    #[must_use]
    pub fn turn(&self) -> Option<f32> {
        self.turns().next()
    }

    /// The same of each part for which it counts.
    pub fn turns(&self) -> impl Iterator<Item = f32> {
        self.parts_that_count().filter_map(|part| match part {
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
