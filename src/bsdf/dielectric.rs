//! Glass and water: a smooth interface between two transparent media.

use crate::bsdf::mirror::reflection;
use crate::bsdf::{Branch, Glass};
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// A smooth interface.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric<F> {
    /// How much it reflects; its `eta` is the far side's index over the near side's, as seen by wo.
    pub glass: Glass<F>,
}

impl<F: Lanes> Dielectric<F> {
    /// Reflection and refraction. The second does not exist under total internal reflection; the first not between
    /// equal media.
    #[inline(always)]
    pub fn branches(&self, wo: Vec3<F>) -> [Branch<F>; 2] {
        let at = self.glass.at(wo.z);
        let above = wo.z.gt(0.0);
        let mut reflected = reflection(wo, Rgb::gray(at.reflectance));
        reflected.valid = above & at.reflectance.gt(0.0);
        let inverse = self.glass.eta().recip();
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
