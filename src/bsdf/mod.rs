//! Scattering at one point, untextured, in the local frame.
//!
//! A [`Bsdf`] holds numbers only. Directions are unit vectors pointing away from the surface, in a frame whose z is the
//! shading normal on the side of `wo`, so `wo.z > 0`. It is generic over lanes; every lobe keeps `sample`, `pdf` and
//! `eval` in one file, in that order. `eval` is without the cosine, `pdf` is with respect to solid angle. Specular lobes
//! have neither: they have [`Bsdf::branches`].

pub mod fresnel;
pub mod microfacet;

mod conductor;
mod dielectric;
mod diffuse;
mod glazed;
mod glossy;
mod mirror;
mod sample;

pub use conductor::{Conductor, RoughConductor};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use glazed::{Coat, Glazed};
pub use glossy::Glossy;
pub use mirror::Mirror;
pub use sample::{Branch, BsdfSample, Lobes};

use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// Every way that surfaces scatter.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<F> {
    /// Matt.
    Diffuse(Diffuse<F>),
    /// A mirror of constant reflectance.
    Mirror(Mirror<F>),
    /// Polished metal.
    Conductor(Conductor<F>),
    /// Rough metal.
    RoughConductor(RoughConductor<F>),
    /// Smooth glass.
    Dielectric(Dielectric<F>),
    /// A fuzzy mirror over a matt base.
    Glossy {
        /// The fuzzy mirror.
        lobe: Glossy<F>,
        /// The base, which gets its own share of the light.
        base: Diffuse<F>,
    },
    /// A smooth coat over a matt base.
    Glazed(Glazed<F>),
}

impl<F: Lanes> Bsdf<F> {
    /// Which kinds of scattering there are.
    #[inline(always)]
    pub fn lobes(&self) -> Lobes {
        match self {
            Self::Diffuse(_) => Lobes::DIFFUSE,
            Self::Mirror(_) | Self::Conductor(_) | Self::Dielectric(_) => Lobes::SPECULAR,
            Self::RoughConductor(_) => Lobes::GLOSSY,
            Self::Glossy { .. } => Lobes::GLOSSY | Lobes::DIFFUSE,
            Self::Glazed(_) => Lobes::SPECULAR | Lobes::DIFFUSE,
        }
    }

    /// The BSDF of the diffuse lobe, 1/sr.
    #[inline(always)]
    pub fn eval_diffuse(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        match self {
            Self::Diffuse(lobe) | Self::Glossy { base: lobe, .. } => lobe.eval(wo, wi),
            Self::Glazed(lobe) => lobe.diffuse(wo, wi),
            _ => Rgb::gray(wo.z.splat(0.0)),
        }
    }

    /// The BSDF of the glossy lobe, 1/sr.
    #[inline(always)]
    pub fn eval_glossy(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        match self {
            Self::RoughConductor(lobe) => lobe.eval(wo, wi),
            Self::Glossy { lobe, .. } => lobe.eval(wo, wi),
            _ => Rgb::gray(wo.z.splat(0.0)),
        }
    }

    /// Density of [`Self::sample_glossy`] with respect to solid angle.
    #[inline(always)]
    pub fn pdf_glossy(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        match self {
            Self::RoughConductor(lobe) => lobe.pdf(wo, wi),
            Self::Glossy { lobe, .. } => lobe.pdf(wo, wi),
            _ => wo.z.splat(0.0),
        }
    }

    /// A direction of the glossy lobe, where there is one.
    #[inline(always)]
    pub fn sample_glossy(&self, wo: Vec3<F>, u2: [F; 2]) -> Option<BsdfSample<F>> {
        match self {
            Self::RoughConductor(lobe) => Some(lobe.sample(wo, u2)),
            Self::Glossy { lobe, .. } => Some(lobe.sample(wo, u2)),
            _ => None,
        }
    }

    /// The ways on at a specular interface, none for other surfaces: reflection first, then refraction.
    #[inline(always)]
    pub fn branches(&self, wo: Vec3<F>) -> [Option<Branch<F>>; 2] {
        match self {
            Self::Mirror(lobe) => [Some(lobe.branch(wo)), None],
            Self::Conductor(lobe) => [Some(lobe.branch(wo)), None],
            Self::Glazed(lobe) => [Some(lobe.branch(wo)), None],
            Self::Dielectric(lobe) => lobe.branches(wo).map(Some),
            Self::Diffuse(_) | Self::RoughConductor(_) | Self::Glossy { .. } => [None, None],
        }
    }
}
