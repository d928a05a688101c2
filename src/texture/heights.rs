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
    /// Differences over half a texel on either side, or over what the ray is wide: between texels, where heights are interpolated, they
    /// change steadily.
    #[must_use]
    pub fn slopes(&self, spot: Spot<f32>) -> [f32; 2] {
        let [width, height] = self.map.bitmap.size();
        let texel = [(width * self.map.repeat.x).abs().recip(), (height * self.map.repeat.y).abs().recip()];
        std::array::from_fn(|i| {
            let step = 0.5 * texel[i].max(spot.footprint);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Pixels, Raster};
    use crate::texture::{Bitmap, Space, Wrap};
    use glam::Vec2;
    use std::sync::Arc;

    #[test]
    fn white_beside_black_is_a_slope_of_one() {
        let values = [0.0, 1.0, 0.0, 1.0].map(|x| [x, x, x, 1.0]).to_vec();
        let raster = Raster {
            width: 4,
            height: 1,
            pixels: Pixels::Floats { values, half: false },
            encoded: false,
            has_alpha: false,
            warnings: vec![],
            as_colour: vec![],
        };
        let bitmap = Arc::new(Bitmap::new(&raster, Space::Linear));
        let map = Mapped { bitmap, wrap: Wrap::Clamp, repeat: Vec2::ONE, offset: Vec2::ZERO };
        let heights = Heights { map, channel: Channel::Red, height: Height::Texels(1.0) };
        // For each texel, which is a quarter.
        let slope = |u: f32| 0.25 * heights.slopes(Spot { uv: [u, 0.5], footprint: 0.0 })[0];
        for (u, wanted) in [(0.25, 1.0), (0.5, -1.0), (0.375, 0.0), (0.3125, 0.5)] {
            assert!((slope(u) - wanted).abs() < 1e-5, "at {u}: {}, not {wanted}", slope(u));
        }
    }
}
