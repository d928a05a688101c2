//! Light from infinity.
//!
//! A constant environment is sampled by the cosine about the normal; a picture by its brightness, see
//! [`EnvironmentMap`].

use crate::light::environment_map::{EnvironmentMap, FromMap};
use crate::light::{LightSample, Reference};
use crate::math::lanes::Lanes;
use crate::math::{Frame, Rgb, Vec3};
use crate::sampling::warp;
use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

/// Radiance from every direction.
#[derive(Clone, Debug)]
pub enum Environment {
    /// The same from everywhere.
    Constant(Rgb<f32>),
    /// A picture.
    Map(Arc<EnvironmentMap>),
}

impl Environment {
    /// The radiance where it is the same from everywhere.
    #[must_use]
    pub fn constant(&self) -> Option<Rgb<f32>> {
        if let Self::Constant(radiance) = self { Some(*radiance) } else { None }
    }

    /// Radiance from the unit direction `d`.
    #[must_use]
    pub fn radiance(&self, d: glam::Vec3) -> Rgb<f32> {
        match self {
            Self::Constant(radiance) => *radiance,
            Self::Map(map) => map.arriving(Vec3::from(d)).radiance,
        }
    }

    #[inline(always)]
    pub(super) fn sample<F: Lanes>(&self, at: Reference<F>, u2: [F; 2]) -> LightSample<F> {
        let like = at.p.x;
        match self {
            Self::Constant(radiance) => {
                let local = warp::cosine_hemisphere(u2);
                let wi = Frame::about(at.n).to_world(local);
                let pdf = local.z * FRAC_1_PI;
                LightSample { wi, p: at.p, li: Rgb::splat(like, *radiance), pdf, valid: pdf.gt(0.0) }
            }
            Self::Map(map) => {
                let FromMap { wi, arriving } = map.sample(u2);
                let pdf = arriving.pdf;
                let valid = pdf.gt(0.0) & pdf.is_finite() & wi.dot(at.n).gt(0.0);
                LightSample { wi, p: at.p, li: arriving.radiance, pdf, valid }
            }
        }
    }

    pub(super) fn pdf(&self, at: Reference<f32>, wi: Vec3<f32>) -> f32 {
        match self {
            Self::Constant(_) => wi.dot(at.n).max(0.0) * FRAC_1_PI,
            Self::Map(map) => map.arriving(wi).pdf,
        }
    }

    pub(super) fn mean_luminance(&self) -> f32 {
        match self {
            Self::Constant(radiance) => radiance.luminance(),
            Self::Map(map) => map.mean_luminance(),
        }
    }
}
