//! The same surface in all lanes.

use crate::bsdf::microfacet::{Beckmann, Distribution, Ggx};
use crate::bsdf::{
    Bsdf, Conductor, Dielectric, Diffuse, Glazed, Glossy, Jitter, Metal, Mirror, OrenNayar, Over, Phong,
    RoughConductor, RoughDielectric, ThinDielectric,
};
use crate::math::Rgb;
use crate::math::lanes::Lanes;

/// What is known of one point and can be had for several alike.
pub trait Spread {
    /// The same over lanes.
    type Over<F: Lanes>;

    /// The same in all lanes of the kind of `like`.
    fn spread<F: Lanes>(&self, like: F) -> Self::Over<F>;
}

impl Spread for f32 {
    type Over<F: Lanes> = F;
    #[inline(always)]
    fn spread<F: Lanes>(&self, like: F) -> F {
        like.splat(*self)
    }
}

impl Spread for Rgb<f32> {
    type Over<F: Lanes> = Rgb<F>;
    #[inline(always)]
    fn spread<F: Lanes>(&self, like: F) -> Rgb<F> {
        Rgb::splat(like, *self)
    }
}

/// Spreads a structure field by field; fields after the bar are the same for all lanes already.
macro_rules! spread {
    ($($name:ident { $($field:ident),* $(| $($same:ident),*)? })*) => {$(
        impl Spread for $name<f32> {
            type Over<F: Lanes> = $name<F>;
            #[inline(always)]
            fn spread<F: Lanes>(&self, like: F) -> $name<F> {
                $name { $($field: self.$field.spread(like),)* $($($same: self.$same),*)? }
            }
        }
    )*};
}

spread! {
    Ggx { alpha_x, alpha_y }
    Beckmann { alpha_x, alpha_y }
    Diffuse { reflectance }
    OrenNayar { reflectance, roughness }
    Mirror { reflectance }
    Conductor { metal }
    RoughConductor { metal, facets }
    Dielectric { glass }
    RoughDielectric { glass, facets }
    ThinDielectric { glass, transmittance }
    Glossy { reflectance, exponent | below }
    Phong { reflectance, exponent | scale }
    Jitter { reflectance, exponent }
    Glazed { glass, inside }
}

impl Spread for Distribution<f32> {
    type Over<F: Lanes> = Distribution<F>;
    #[inline(always)]
    fn spread<F: Lanes>(&self, like: F) -> Distribution<F> {
        match self {
            Self::Ggx(own) => Distribution::Ggx(own.spread(like)),
            Self::Beckmann(own) => Distribution::Beckmann(own.spread(like)),
        }
    }
}

impl Spread for Metal<f32> {
    type Over<F: Lanes> = Metal<F>;
    #[inline(always)]
    fn spread<F: Lanes>(&self, like: F) -> Metal<F> {
        match self {
            Self::Exact { eta, k } => Metal::Exact { eta: eta.spread(like), k: k.spread(like) },
            Self::Schlick { r0 } => Metal::Schlick { r0: r0.spread(like) },
            Self::F82 { r0, edge } => Metal::F82 { r0: r0.spread(like), edge: edge.spread(like) },
            Self::Constant { r0 } => Metal::Constant { r0: r0.spread(like) },
        }
    }
}

impl<L: Spread> Spread for Over<L, f32> {
    type Over<F: Lanes> = Over<L::Over<F>, F>;
    #[inline(always)]
    fn spread<F: Lanes>(&self, like: F) -> Self::Over<F> {
        Over { lobe: self.lobe.spread(like), base: self.base.spread(like) }
    }
}

impl Spread for Bsdf<f32> {
    type Over<F: Lanes> = Bsdf<F>;
    #[inline(always)]
    fn spread<F: Lanes>(&self, like: F) -> Bsdf<F> {
        match self {
            Self::Diffuse(lobe) => Bsdf::Diffuse(lobe.spread(like)),
            Self::OrenNayar(lobe) => Bsdf::OrenNayar(lobe.spread(like)),
            Self::Mirror(lobe) => Bsdf::Mirror(lobe.spread(like)),
            Self::Conductor(lobe) => Bsdf::Conductor(lobe.spread(like)),
            Self::RoughConductor(lobe) => Bsdf::RoughConductor(lobe.spread(like)),
            Self::Dielectric(lobe) => Bsdf::Dielectric(lobe.spread(like)),
            Self::RoughDielectric(lobe) => Bsdf::RoughDielectric(lobe.spread(like)),
            Self::ThinDielectric(lobe) => Bsdf::ThinDielectric(lobe.spread(like)),
            Self::Glossy(lobe) => Bsdf::Glossy(lobe.spread(like)),
            Self::Phong(lobe) => Bsdf::Phong(lobe.spread(like)),
            Self::Jitter(lobe) => Bsdf::Jitter(lobe.spread(like)),
            Self::Glazed(lobe) => Bsdf::Glazed(lobe.spread(like)),
            Self::Schlick(lobe) => Bsdf::Schlick(lobe.spread(like)),
        }
    }
}
