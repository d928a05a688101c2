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
mod jitter;
mod mirror;
mod mix;
mod oren_nayar;
mod phong;
mod reflectance;
mod rough_dielectric;
mod sample;
mod schlick;
mod thin_dielectric;
mod truncation;

pub use conductor::{Conductor, RoughConductor};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use glazed::{Coat, Glazed};
pub use glossy::{Below, Glossy};
pub use jitter::Jitter;
pub use mirror::Mirror;
pub use mix::{MOST_PARTS, Mix, Part};
pub use oren_nayar::OrenNayar;
pub use phong::{Phong, PhongScale};
pub use reflectance::{FresnelModel, Glass, Metal};
pub use rough_dielectric::RoughDielectric;
pub use sample::{Branch, BsdfSample, Lobes};
pub use schlick::Schlick;
pub use thin_dielectric::ThinDielectric;

use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// Every way that surfaces scatter.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<F> {
    /// Matt.
    Diffuse(Diffuse<F>),
    /// Matt and rough.
    OrenNayar(OrenNayar<F>),
    /// A mirror of constant reflectance.
    Mirror(Mirror<F>),
    /// Polished metal.
    Conductor(Conductor<F>),
    /// Rough metal.
    RoughConductor(RoughConductor<F>),
    /// Smooth glass.
    Dielectric(Dielectric<F>),
    /// Frosted glass.
    RoughDielectric(RoughDielectric<F>),
    /// A pane.
    ThinDielectric(ThinDielectric<F>),
    /// A fuzzy mirror over a matt base.
    Glossy {
        /// The fuzzy mirror.
        lobe: Glossy<F>,
        /// The base, which gets its own share of the light.
        base: Diffuse<F>,
    },
    /// A reciprocal Phong lobe over a matt base.
    Phong {
        /// The lobe.
        lobe: Phong<F>,
        /// The base, which gets its own share of the light.
        base: Diffuse<F>,
    },
    /// A mirror with a trembling normal over a matt base.
    Jitter {
        /// The mirror.
        lobe: Jitter<F>,
        /// The base, which gets its own share of the light.
        base: Diffuse<F>,
    },
    /// A smooth coat over a matt base.
    Glazed(Glazed<F>),
    /// From matt to mirror by one number.
    Schlick(Schlick<F>),
}

impl<F: Lanes> Bsdf<F> {
    /// Which kinds of scattering there are.
    #[inline(always)]
    pub fn lobes(&self) -> Lobes {
        match self {
            Self::Diffuse(_) | Self::OrenNayar(_) => Lobes::DIFFUSE,
            Self::Mirror(_) | Self::Conductor(_) | Self::Dielectric(_) | Self::ThinDielectric(_) => {
                Lobes::SPECULAR
            }
            Self::RoughConductor(_) => Lobes::GLOSSY,
            Self::RoughDielectric(_) => Lobes::GLOSSY | Lobes::THROUGH,
            Self::Glossy { .. } | Self::Phong { .. } | Self::Jitter { .. } => Lobes::GLOSSY | Lobes::DIFFUSE,
            Self::Glazed(_) => Lobes::SPECULAR | Lobes::DIFFUSE,
            Self::Schlick(_) => Lobes::SPECULAR | Lobes::GLOSSY | Lobes::DIFFUSE,
        }
    }

    /// The BSDF of the diffuse lobe, 1/sr.
    #[inline(always)]
    pub fn eval_diffuse(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        match self {
            Self::Diffuse(lobe)
            | Self::Glossy { base: lobe, .. }
            | Self::Phong { base: lobe, .. }
            | Self::Jitter { base: lobe, .. } => lobe.eval(wo, wi),
            Self::OrenNayar(lobe) => lobe.eval(wo, wi),
            Self::Glazed(lobe) => lobe.diffuse(wo, wi),
            Self::Schlick(lobe) => lobe.diffuse(wo, wi),
            _ => Rgb::gray(wo.z.splat(0.0)),
        }
    }

    /// The BSDF of the glossy lobe that `wi` belongs to, reflection above and transmission below, 1/sr.
    #[inline(always)]
    pub fn eval_glossy(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        match self {
            Self::RoughConductor(lobe) => lobe.eval(wo, wi),
            Self::RoughDielectric(lobe) => lobe.eval(wo, wi),
            Self::Glossy { lobe, .. } => lobe.eval(wo, wi),
            Self::Phong { lobe, .. } => lobe.eval(wo, wi),
            Self::Jitter { lobe, .. } => lobe.eval(wo, wi),
            Self::Schlick(lobe) => lobe.eval(wo, wi),
            _ => Rgb::gray(wo.z.splat(0.0)),
        }
    }

    /// Density of the sample of [`Self::sample_glossy`] on the side of `wi`, with respect to solid angle.
    #[inline(always)]
    pub fn pdf_glossy(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        match self {
            Self::RoughConductor(lobe) => lobe.pdf(wo, wi),
            Self::RoughDielectric(lobe) => lobe.pdf(wo, wi),
            Self::Glossy { lobe, .. } => lobe.pdf(wo, wi),
            Self::Phong { lobe, .. } => lobe.pdf(wo, wi),
            Self::Jitter { lobe, .. } => lobe.pdf(wo, wi),
            Self::Schlick(lobe) => lobe.pdf(wo, wi),
            _ => wo.z.splat(0.0),
        }
    }

    /// A direction of the glossy reflection and one of the glossy transmission, where there are such lobes. Each has the
    /// density of its own lobe: both are to be followed.
    #[inline(always)]
    pub fn sample_glossy(&self, wo: Vec3<F>, u2: [F; 2]) -> [Option<BsdfSample<F>>; 2] {
        match self {
            Self::RoughConductor(lobe) => [Some(lobe.sample(wo, u2)), None],
            Self::RoughDielectric(lobe) => {
                let [mirrored, refracted] = lobe.sample(wo, u2);
                [Some(mirrored), Some(refracted)]
            }
            Self::Glossy { lobe, .. } => [Some(lobe.sample(wo, u2)), None],
            Self::Phong { lobe, .. } => [Some(lobe.sample(wo, u2)), None],
            Self::Jitter { lobe, .. } => [Some(lobe.sample(wo, u2)), None],
            Self::Schlick(lobe) => [Some(lobe.sample(wo, u2)), None],
            _ => [None, None],
        }
    }

    /// The ways on at a specular interface, none for other surfaces: reflection first, then transmission.
    #[inline(always)]
    pub fn branches(&self, wo: Vec3<F>) -> [Option<Branch<F>>; 2] {
        match self {
            Self::Mirror(lobe) => [Some(lobe.branch(wo)), None],
            Self::Conductor(lobe) => [Some(lobe.branch(wo)), None],
            Self::Glazed(lobe) => [Some(lobe.branch(wo)), None],
            Self::Schlick(lobe) => [Some(lobe.branch(wo)), None],
            Self::Dielectric(lobe) => {
                let [reflected, refracted] = lobe.branches(wo);
                [Some(reflected), Some(refracted)]
            }
            Self::ThinDielectric(lobe) => {
                let [reflected, transmitted] = lobe.branches(wo);
                [Some(reflected), Some(transmitted)]
            }
            _ => [None, None],
        }
    }
}
