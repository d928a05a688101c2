//! What sampling a lobe gives.

use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};
use std::ops::BitOr;

/// A set of kinds of scattering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lobes(u8);

impl Lobes {
    /// Nothing.
    pub const NONE: Self = Self(0);
    /// Spread over the hemisphere.
    pub const DIFFUSE: Self = Self(1);
    /// Spread about the mirror direction.
    pub const GLOSSY: Self = Self(2);
    /// Exactly one direction, which is asked for as a [`Branch`].
    pub const SPECULAR: Self = Self(4);
    /// Spread about the refracted direction, below the surface.
    pub const THROUGH: Self = Self(8);

    /// Both sets together.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether the two sets share a kind.
    #[must_use]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

impl BitOr for Lobes {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        self.and(other)
    }
}

/// A direction drawn from a lobe that is spread; specular ones have branches.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample<F: Lanes> {
    /// Unit direction towards the light, local.
    pub wi: Vec3<F>,
    /// f |cos theta_i| / pdf.
    pub weight: Rgb<F>,
    /// Density with respect to solid angle.
    pub pdf: F,
    /// Where a direction was found at all.
    pub valid: F::Mask,
}

/// One way on at a specular interface.
#[derive(Clone, Copy, Debug)]
pub struct Branch<F: Lanes> {
    /// Unit direction towards the light, local.
    pub wi: Vec3<F>,
    /// Fraction of the power that takes this way.
    pub weight: Rgb<F>,
    /// What becomes of radiance besides: its growth by the square of the index ratio on transmission, else 1.
    pub radiance_scale: F,
    /// Where this way exists.
    pub valid: F::Mask,
    /// Whether the surface is crossed.
    pub transmission: bool,
}
