//! Glass and water: a smooth interface between two transparent media.

use crate::bsdf::mirror::reflection;
use crate::bsdf::{Branch, fresnel};
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// A smooth interface.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric<F> {
    /// n_t / n_i as seen by wo: the far side's index over the near side's.
    pub eta: F,
}

impl<F: Lanes> Dielectric<F> {
    /// Reflection and refraction. The second does not exist under total internal reflection; the first not between
    /// equal media.
    #[inline(always)]
    pub fn branches(&self, wo: Vec3<F>) -> [Branch<F>; 2] {
        let at = fresnel::dielectric(wo.z, self.eta);
        let above = wo.z.gt(0.0);
        let mut reflected = reflection(wo, Rgb::gray(at.reflectance));
        reflected.valid = above & at.reflectance.gt(0.0);
        let inverse = self.eta.recip();
        let refracted = Branch {
            wi: Vec3::new(-wo.x * inverse, -wo.y * inverse, -at.cos_t).normalize(),
            weight: Rgb::gray(-at.reflectance + 1.0),
            // Radiance per squared index is what is conserved (Veach 1997, Robust Monte Carlo Methods, 5.2).
            radiance_scale: inverse * inverse,
            valid: above & !at.total,
            transmission: true,
        };
        [reflected, refracted]
    }
}
