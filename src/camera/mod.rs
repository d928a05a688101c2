//! From a film point to a ray.

mod lens;
mod moving;
mod pinhole;
mod viewpoint;

pub use lens::Lens;
pub use moving::MovingPinhole;
pub use pinhole::Pinhole;
pub use viewpoint::Viewpoint;

use crate::geometry::Ray;
use crate::math::Vec3;
use crate::math::lanes::Lanes;

/// Where pictures are taken from.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    stand: Stand,
    lens: Option<Lens>,
}

/// How it stands while the shutter is open.
#[derive(Clone, Debug, PartialEq)]
enum Stand {
    Still(Pinhole),
    Moving(MovingPinhole),
}

impl From<Pinhole> for Camera {
    fn from(pinhole: Pinhole) -> Self {
        Self { stand: Stand::Still(pinhole), lens: None }
    }
}

impl From<MovingPinhole> for Camera {
    fn from(pinhole: MovingPinhole) -> Self {
        Self { stand: Stand::Moving(pinhole), lens: None }
    }
}

impl Camera {
    /// The same camera with a lens in place of its hole, or without one.
    #[must_use]
    pub fn with_lens(self, lens: Option<Lens>) -> Self {
        Self { lens, ..self }
    }

    /// The ray through a film point in pixels, from the upper left corner, at a moment of the shutter in [0, 1]; its direction
    /// is a unit vector. `u2` draws a point of the lens; where there is none it means nothing.
    #[must_use]
    pub fn ray(&self, film: [f32; 2], u2: [f32; 2], time: f32) -> Ray {
        let (o, d) = self.rays(film, u2, time);
        Ray::new(o.into(), d.into()).at_time(time)
    }

    /// The same over lanes: origins and directions.
    #[inline(always)]
    pub fn rays<F: Lanes>(&self, film: [F; 2], u2: [F; 2], time: F) -> (Vec3<F>, Vec3<F>) {
        let pinhole = match &self.stand {
            Stand::Still(pinhole) => pinhole.spread(time),
            Stand::Moving(pinhole) => pinhole.over(time),
        };
        match &self.lens {
            None => (pinhole.eye, pinhole.towards(film).normalize()),
            Some(lens) => lens.rays(&pinhole, film, u2),
        }
    }

    /// The angle that a pixel in the middle of a picture of this size is wide, in radians, as the shutter opens.
    #[must_use]
    pub fn pixel_angle(&self, [width, height]: [u32; 2]) -> f32 {
        #[expect(clippy::cast_precision_loss, reason = "pictures are smaller than 2^24")]
        let middle = [width as f32 * 0.5, height as f32 * 0.5];
        let pinhole = self.pinhole(0.0);
        let [a, b] = [middle, [middle[0] + 1.0, middle[1]]].map(|film| pinhole.towards(film).normalize());
        (b - a).length()
    }

    /// The camera at a moment of the shutter, in [0, 1], without its lens.
    #[must_use]
    pub fn pinhole(&self, time: f32) -> Pinhole {
        match &self.stand {
            Stand::Still(pinhole) => *pinhole,
            Stand::Moving(pinhole) => pinhole.at(time),
        }
    }

    /// Where the camera stands at a moment of the shutter, in [0, 1]: the middle of its lens.
    #[must_use]
    pub fn eye(&self, time: f32) -> glam::Vec3 {
        self.pinhole(time).eye.into()
    }

    /// Whether it moves while the shutter is open.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        matches!(self.stand, Stand::Moving(_))
    }

    /// Whether there is a lens, so that rays leave from more than one point.
    #[must_use]
    pub fn has_lens(&self) -> bool {
        self.lens.is_some()
    }
}
