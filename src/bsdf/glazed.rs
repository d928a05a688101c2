//! A smooth dielectric coat over a diffuse base: glazed pottery, billiard balls.

use crate::bsdf::mirror::reflection;
use crate::bsdf::{Branch, Diffuse, FresnelModel, Glass, Spread};
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// The coat alone: what a scene computes once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// Index of refraction, relative to outside.
    pub ior: f32,
    /// How it reflects.
    glass: Glass<f32>,
    /// Mean reflectance from within.
    inside: f32,
}

impl Coat {
    /// A coat of index `ior` >= 1. Under every model what is not reflected goes through, so that a coat over white loses
    /// nothing.
    #[must_use]
    pub fn new(model: FresnelModel, ior: f32) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "a reflectance needs no more digits")]
        let inside = model.average_inside(ior.into()) as f32;
        Self { ior, glass: Glass::new(model, ior), inside }
    }

    /// The coat over a base that reflects `base`, each channel in [0, 1].
    #[inline(always)]
    pub fn over<F: Lanes>(&self, base: Rgb<F>) -> Glazed<F> {
        let inside = Rgb::new(self.through(base.r), self.through(base.g), self.through(base.b));
        Glazed { glass: self.glass.spread(base.r), inside }
    }

    /// The sum over all bounces between base and coat, and the spreading of the cone of light that enters.
    #[inline(always)]
    fn through<F: Lanes>(&self, rho: F) -> F {
        rho / ((-rho * self.inside + 1.0) * (self.ior * self.ior))
    }
}

/// A glazed surface. Light enters the coat, is scattered by the base, and bounces between base and coat until it
/// leaves or is absorbed.
#[derive(Clone, Copy, Debug)]
pub struct Glazed<F> {
    /// How the coat reflects; its `eta` is the index of the coat, relative to outside.
    pub glass: Glass<F>,
    /// Reflectance of the base once light is inside: base / (n^2 (1 - base F_inside)).
    pub inside: Rgb<F>,
}

impl<F: Lanes> Glazed<F> {
    /// The reflection in the coat.
    #[inline(always)]
    pub fn branch(&self, wo: Vec3<F>) -> Branch<F> {
        reflection(wo, Rgb::gray(self.glass.at(wo.z).reflectance))
    }

    /// The light that went through the coat twice.
    #[inline(always)]
    pub fn diffuse(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        let base = Diffuse { reflectance: self.inside }.eval(wo, wi);
        base * (self.transmitted(wo.z) * self.transmitted(wi.z))
    }

    #[inline(always)]
    fn transmitted(&self, cos: F) -> F {
        -self.glass.at(cos).reflectance + 1.0
    }
}
