//! The mirror: one direction, one colour.

use crate::bsdf::Branch;
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// Reflects a constant fraction at every angle: the simplest metal.
#[derive(Clone, Copy, Debug)]
pub struct Mirror<F> {
    /// Fraction of the power reflected, in [0, 1].
    pub reflectance: Rgb<F>,
}

impl<F: Lanes> Mirror<F> {
    /// The mirror direction.
    #[inline(always)]
    pub fn branch(&self, wo: Vec3<F>) -> Branch<F> {
        reflection(wo, self.reflectance)
    }
}

/// The branch along the mirror direction that carries `weight`.
#[inline(always)]
pub(crate) fn reflection<F: Lanes>(wo: Vec3<F>, weight: Rgb<F>) -> Branch<F> {
    let wi = mirrored(wo);
    Branch { wi, weight, radiance_scale: wo.z.splat(1.0), valid: wo.z.gt(0.0), transmission: false }
}

/// `wo` reflected at the normal.
#[inline(always)]
pub(crate) fn mirrored<F: Lanes>(wo: Vec3<F>) -> Vec3<F> {
    Vec3::new(-wo.x, -wo.y, wo.z)
}
