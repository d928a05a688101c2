//! Scattering at one point, untextured, in the local frame.
//!
//! A [`Bsdf`] holds numbers only. Directions are unit vectors pointing away from the surface, in a frame whose z is the
//! shading normal on the side of `wo`, so `wo.z > 0`. It is generic over lanes; every lobe keeps `sample`, `pdf` and
//! `eval` in one file, in that order. `eval` is without the cosine, `pdf` is with respect to solid angle. Specular lobes
//! have neither: they have [`Bsdf::branches`].

pub mod choice;
pub mod fresnel;
pub mod microfacet;

mod conductor;
mod dielectric;
mod diffuse;
mod glazed;
mod glossy;
mod jitter;
mod lobe;
mod mirror;
mod mix;
mod oren_nayar;
mod phong;
mod polished;
mod reflectance;
mod rough_dielectric;
mod sample;
mod schlick;
mod spread;
mod thin_dielectric;
mod truncation;

pub use conductor::{Conductor, RoughConductor};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use glazed::{Coat, Glazed};
pub use glossy::{Below, Glossy};
pub use jitter::Jitter;
pub use lobe::{Lobe, Over};
pub use mirror::Mirror;
pub(crate) use mirror::mirrored;
pub use mix::{MOST_PARTS, Mix, Part};
pub use oren_nayar::OrenNayar;
pub use phong::{Phong, PhongScale};
pub use polished::LobeOfMirror;
pub use reflectance::{FresnelModel, Glass, Metal};
pub use rough_dielectric::RoughDielectric;
pub use sample::{Branch, BsdfSample, Lobes};
pub use schlick::Schlick;
pub use spread::Spread;
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
    Glossy(Over<Glossy<F>, F>),
    /// A reciprocal Phong lobe over a matt base.
    Phong(Over<Phong<F>, F>),
    /// A mirror with a trembling normal over a matt base.
    Jitter(Over<Jitter<F>, F>),
    /// A smooth coat over a matt base.
    Glazed(Glazed<F>),
    /// From matt to mirror by one number.
    Schlick(Schlick<F>),
}

/// Runs an expression for the lobe within, whichever it is. Arms of their own: each sees one lobe only.
macro_rules! with_lobe {
    ($bsdf:expr, $lobe:ident => $body:expr) => {
        match $bsdf {
            $crate::bsdf::Bsdf::Diffuse($lobe) => $body,
            $crate::bsdf::Bsdf::OrenNayar($lobe) => $body,
            $crate::bsdf::Bsdf::Mirror($lobe) => $body,
            $crate::bsdf::Bsdf::Conductor($lobe) => $body,
            $crate::bsdf::Bsdf::RoughConductor($lobe) => $body,
            $crate::bsdf::Bsdf::Dielectric($lobe) => $body,
            $crate::bsdf::Bsdf::RoughDielectric($lobe) => $body,
            $crate::bsdf::Bsdf::ThinDielectric($lobe) => $body,
            $crate::bsdf::Bsdf::Glossy($lobe) => $body,
            $crate::bsdf::Bsdf::Phong($lobe) => $body,
            $crate::bsdf::Bsdf::Jitter($lobe) => $body,
            $crate::bsdf::Bsdf::Glazed($lobe) => $body,
            $crate::bsdf::Bsdf::Schlick($lobe) => $body,
        }
    };
}
pub(crate) use with_lobe;

impl<F: Lanes> Bsdf<F> {
    /// Which kinds of scattering there are.
    #[inline(always)]
    pub fn lobes(&self) -> Lobes {
        const fn of<F: Lanes, L: Lobe<F>>(_: &L) -> Lobes {
            L::LOBES
        }
        with_lobe!(self, lobe => of::<F, _>(lobe))
    }

    /// See [`Lobe::eval_diffuse`].
    #[inline(always)]
    pub fn eval_diffuse(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        with_lobe!(self, lobe => lobe.eval_diffuse(wo, wi))
    }

    /// See [`Lobe::eval_glossy`].
    #[inline(always)]
    pub fn eval_glossy(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        with_lobe!(self, lobe => lobe.eval_glossy(wo, wi))
    }

    /// See [`Lobe::pdf_glossy`].
    #[inline(always)]
    pub fn pdf_glossy(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        with_lobe!(self, lobe => lobe.pdf_glossy(wo, wi))
    }

    /// See [`Lobe::sample_glossy`].
    #[inline(always)]
    pub fn sample_glossy(&self, wo: Vec3<F>, u2: [F; 2]) -> [Option<BsdfSample<F>>; 2] {
        with_lobe!(self, lobe => lobe.sample_glossy(wo, u2))
    }

    /// See [`Lobe::branches`].
    #[inline(always)]
    pub fn branches(&self, wo: Vec3<F>) -> [Option<Branch<F>>; 2] {
        with_lobe!(self, lobe => Lobe::branches(lobe, wo))
    }
}
