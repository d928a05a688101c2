//! Heights from pictures.

use crate::texture::{Channel, Mapped, Spot};

/// A relief: how far each point of it stands out of the smooth surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    /// The picture and how it lies.
    pub map: Mapped,
    /// Which of its numbers is the height.
    pub channel: Channel,
    /// How far 1 stands out over 0.
    pub height: Height,
}

/// A unit of heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Height {
    /// Metres.
    Metres(f32),
    /// Widths of a texel, wherever the picture lies.
    Texels(f32),
}

impl Heights {
    /// How the height grows with u and with v at a spot, for each unit of them, in numbers of the picture.
    ///
    /// Differences over a texel on either side, or over what the ray is wide: between texels, where heights are interpolated, they
    /// change steadily.
    #[must_use]
    pub fn slopes(&self, spot: Spot<f32>) -> [f32; 2] {
        let [width, height] = self.map.bitmap.size();
        let texel = [(width * self.map.repeat.x).abs().recip(), (height * self.map.repeat.y).abs().recip()];
        std::array::from_fn(|i| {
            let step = texel[i].max(0.5 * spot.footprint);
            let at = |step: f32| {
                let mut uv = spot.uv;
                uv[i] += step;
                self.map.channel_at(Spot { uv, ..spot }, self.channel)
            };
            (at(step) - at(-step)) / (2.0 * step)
        })
    }

    /// How far 1 stands out over 0, in metres, where there are so many units of u and v to a metre.
    #[must_use]
    pub fn metres(&self, density: f32) -> f32 {
        match self.height {
            Height::Metres(height) => height,
            Height::Texels(height) => {
                let [across, down] = self.map.bitmap.size();
                let repeats = (self.map.repeat.x * self.map.repeat.y).abs();
                height / (density * (across * down * repeats).sqrt())
            }
        }
    }
}
