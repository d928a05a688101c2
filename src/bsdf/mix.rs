//! Several surfaces in one place, each with its share: paint that has worn off, dust on a mirror.
//!
//! A mix holds [`Bsdf`]s and a `Bsdf` holds no mix, so mixes are one level deep. Their glossy parts are sampled one by one,
//! each with its own density.

use crate::bsdf::{Bsdf, Lobes};
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// Most surfaces in one mix.
pub const MOST_PARTS: usize = 4;

/// A surface and its share.
#[derive(Clone, Copy, Debug)]
pub struct Part<F> {
    /// What of the light falls to it, in [0, 1] per channel.
    pub weight: Rgb<F>,
    /// The surface.
    pub bsdf: Bsdf<F>,
}

/// One to [`MOST_PARTS`] surfaces. Shares that add up to at most 1 make no light.
#[derive(Clone, Copy, Debug)]
pub struct Mix<F> {
    parts: [Option<Part<F>>; MOST_PARTS],
}

impl<F: Lanes> Mix<F> {
    /// One surface with all of the light.
    #[inline(always)]
    pub fn of(like: F, bsdf: Bsdf<F>) -> Self {
        Self { parts: [Some(Part { weight: Rgb::gray(like.splat(1.0)), bsdf }), None, None, None] }
    }

    /// The surfaces of `parts`, without what is beyond [`MOST_PARTS`].
    pub fn new(parts: impl IntoIterator<Item = Part<F>>) -> Self {
        let mut own = [None; MOST_PARTS];
        for (slot, part) in own.iter_mut().zip(parts) {
            *slot = Some(part);
        }
        Self { parts: own }
    }

    /// The surfaces, in order.
    #[inline(always)]
    pub fn parts(&self) -> impl Iterator<Item = &Part<F>> {
        self.parts.iter().flatten()
    }

    /// Which kinds of scattering there are in any of them.
    #[inline(always)]
    pub fn lobes(&self) -> Lobes {
        let mut all = Lobes::NONE;
        for part in self.parts() {
            all = all | part.bsdf.lobes();
        }
        all
    }

    /// The BSDF of all diffuse lobes, 1/sr.
    #[inline(always)]
    pub fn eval_diffuse(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        let mut sum = Rgb::gray(wo.z.splat(0.0));
        for part in self.parts() {
            sum += part.weight * part.bsdf.eval_diffuse(wo, wi);
        }
        sum
    }
}
