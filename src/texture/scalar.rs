//! One number over a surface.

use crate::math::lanes::Lanes;
use crate::texture::{Channel, Mapped, Spot};

/// A number from a channel of a picture, such as a roughness.
#[derive(Clone, Debug, PartialEq)]
pub struct Scalar {
    /// The picture and how it lies.
    pub map: Mapped,
    /// Which of its numbers.
    pub channel: Channel,
    /// What it is multiplied by.
    pub factor: f32,
}

impl Scalar {
    /// The number at a spot, from 0 to 1.
    #[inline(always)]
    pub fn at<F: Lanes>(&self, spot: impl Into<Spot<F>>) -> F {
        (self.map.channel_at(spot.into(), self.channel) * self.factor).clamp(0.0, 1.0)
    }
}
