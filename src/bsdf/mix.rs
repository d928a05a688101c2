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

    /// No surface yet.
    #[inline(always)]
    pub fn nothing() -> Self {
        Self { parts: [None; MOST_PARTS] }
    }

    /// Adds a surface; one beyond [`MOST_PARTS`] is left out.
    #[inline(always)]
    pub fn push(&mut self, part: Part<F>) {
        if let Some(free) = self.parts.iter_mut().find(|slot| slot.is_none()) {
            *free = Some(part);
        }
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
