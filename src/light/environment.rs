//! Light from infinity.
//!
//! A constant environment is sampled by the cosine about the normal; a picture by its brightness, interpolated as its light is: a pixel
//! in proportion to its own, then a place about its middle by the weight with which the pixel counts there. The picture is a
//! longitude-latitude map: its middle row is the horizon, its top row the zenith +Y, its middle column -Z seen from
//! inside, and columns grow towards +X.

use crate::image::Image;
use crate::light::{LightSample, Reference, per_lane};
use crate::math::lanes::Lanes;
use crate::math::{Frame, Rgb, Vec3};
use crate::sampling::{Table2d, TableError, warp};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

/// Radiance from every direction.
#[derive(Clone, Debug)]
pub enum Environment {
    /// The same from everywhere.
    Constant(Rgb<f32>),
    /// A picture.
    Map(Box<EnvironmentMap>),
}

impl Environment {
    /// The radiance where it is the same from everywhere.
    #[must_use]
    pub fn constant(&self) -> Option<Rgb<f32>> {
        if let Self::Constant(radiance) = self { Some(*radiance) } else { None }
    }

    /// Radiance from the unit direction `d`.
    #[must_use]
    pub fn radiance(&self, d: glam::Vec3) -> Rgb<f32> {
        match self {
            Self::Constant(radiance) => *radiance,
            Self::Map(map) => map.radiance(d),
        }
    }

    #[inline(always)]
    pub(super) fn sample<F: Lanes>(&self, at: Reference<F>, u2: [F; 2]) -> LightSample<F> {
        let like = at.p.x;
        match self {
            Self::Constant(radiance) => {
                let local = warp::cosine_hemisphere(u2);
                let wi = Frame::about(at.n).to_world(local);
                let pdf = local.z * FRAC_1_PI;
                LightSample { wi, p: at.p, li: Rgb::splat(like, *radiance), pdf, valid: pdf.gt(0.0) }
            }
            Self::Map(map) => {
                let [u, v] = u2;
                let [x, y, z, r, g, b, pdf] =
                    per_lane(like, |lane| map.sample_one([u.extract(lane), v.extract(lane)]));
                let wi = Vec3::new(x, y, z);
                let valid = pdf.gt(0.0) & pdf.is_finite() & wi.dot(at.n).gt(0.0);
                LightSample { wi, p: at.p, li: Rgb::new(r, g, b), pdf, valid }
            }
        }
    }

    pub(super) fn pdf(&self, at: Reference<f32>, wi: Vec3<f32>) -> f32 {
        match self {
            Self::Constant(_) => wi.dot(at.n).max(0.0) * FRAC_1_PI,
            Self::Map(map) => map.pdf(wi.into()),
        }
    }

    pub(super) fn mean_luminance(&self) -> f32 {
        match self {
            Self::Constant(radiance) => radiance.luminance(),
            Self::Map(map) => map.mean_luminance,
        }
    }
}

/// A longitude-latitude picture of radiance, interpolated linearly.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    image: Image,
    scale: f32,
    rotation: f32,
    choice: Table2d,
    mean_luminance: f32,
}

impl EnvironmentMap {
    /// From a picture, a factor on its values and a rotation about +Y in radians, counter-clockwise seen from above. Fails
    /// if the picture is black or holds negative or non-finite values.
    pub fn new(image: Image, scale: f32, rotation: f32) -> Result<Self, TableError> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        let mut weights = vec![0.0_f32; width * height];
        let (mut sum, mut solid) = (0.0_f64, 0.0_f64);
        for y in 0..height {
            let sin = (PI * (y as f32 + 0.5) / height as f32).sin();
            for x in 0..width {
                let bright = texel(&image, x as isize, y as isize).luminance() * sin;
                weights[y * width + x] = bright;
                sum += f64::from(bright);
                solid += f64::from(sin);
            }
        }
        #[expect(clippy::cast_possible_truncation, reason = "a mean needs no more digits")]
        let mean_luminance = (sum / solid) as f32 * scale;
        Ok(Self { choice: Table2d::new(&weights, width)?, image, scale, rotation, mean_luminance })
    }

    fn radiance(&self, d: glam::Vec3) -> Rgb<f32> {
        let [u, v] = self.uv(d);
        let x = u * self.image.width() as f32 - 0.5;
        let y = v * self.image.height() as f32 - 0.5;
        let (fx, fy) = (x - x.floor(), y - y.floor());
        #[expect(clippy::cast_possible_truncation, reason = "columns and rows of a picture")]
        let (x, y) = (x.floor() as isize, y.floor() as isize);
        let row = |y| texel(&self.image, x, y).lerp(texel(&self.image, x + 1, y), fx);
        row(y).lerp(row(y + 1), fy).scale(self.scale)
    }

    /// The map's coordinates of a unit direction, in [0, 1).
    fn uv(&self, d: glam::Vec3) -> [f32; 2] {
        let longitude = d.x.atan2(-d.z) + self.rotation;
        // The length of the horizontal part keeps the angle exact near the poles.
        let colatitude = d.x.hypot(d.z).atan2(d.y);
        [
            (longitude / TAU + 0.5).rem_euclid(1.0).min(1.0 - f32::EPSILON),
            (colatitude / PI).min(1.0 - f32::EPSILON),
        ]
    }

    fn pdf(&self, d: glam::Vec3) -> f32 {
        per_solid_angle(self.pdf_at(self.uv(d)), d.x.hypot(d.z))
    }

    /// The density over the map: probabilities of pixels, interpolated as their values are.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "columns and rows of a picture"
    )]
    fn pdf_at(&self, [u, v]: [f32; 2]) -> f32 {
        let [width, height] = [self.choice.width() as f32, self.choice.height() as f32];
        let (x, y) = (u * width - 0.5, v * height - 0.5);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let columns = [x.floor(), x.floor() + 1.0].map(|x| x.rem_euclid(width) as usize);
        let rows = [y.floor(), y.floor() + 1.0].map(|y| y.clamp(0.0, height - 1.0) as usize);
        let row = |row| {
            let [a, b] = columns.map(|column| self.choice.probability([column, row]));
            a + (b - a) * fx
        };
        let [a, b] = rows.map(row);
        (a + (b - a) * fy) * width * height
    }

    /// Direction, radiance and density.
    fn sample_one(&self, u2: [f32; 2]) -> [f32; 7] {
        let chosen = self.choice.sample(u2);
        let [width, height] = [self.choice.width() as f32, self.choice.height() as f32];
        let [column, row] = chosen.cell.map(|k| k as f32);
        let [u, v] = chosen.uv;
        // About the middle of the pixel, as far as interpolation carries its light; columns wrap, and what goes beyond a pole comes back.
        let u = ((column + 0.5 + tent(u * width - column)) / width).rem_euclid(1.0);
        let v = (row + 0.5 + tent(v * height - row)) / height;
        let v = if v > 1.0 { 2.0 - v } else { v.abs() };
        let (sin, cos) = (v * PI).sin_cos();
        let (sin_longitude, cos_longitude) = ((u - 0.5) * TAU - self.rotation).sin_cos();
        let d = glam::Vec3::new(sin * sin_longitude, cos, -sin * cos_longitude);
        let pdf = per_solid_angle(self.pdf_at([u, v]), sin);
        let Rgb { r, g, b } = self.radiance(d);
        [d.x, d.y, d.z, r, g, b, pdf]
    }
}

/// A density over the map as one over directions, given the sine of the colatitude. It is infinite at the poles; there
/// the sine stands for that of the last direction that is drawn.
fn per_solid_angle(pdf: f32, sin: f32) -> f32 {
    pdf / (2.0 * PI * PI * sin.max(1e-9))
}

/// A pixel; columns wrap, rows end.
#[expect(
    clippy::cast_sign_loss,
    clippy::cast_possible_truncation,
    reason = "wrapped and clamped to the picture"
)]
fn texel(image: &Image, x: isize, y: isize) -> Rgb<f32> {
    let x = x.rem_euclid(image.width() as isize) as u32;
    let y = y.clamp(0, image.height() as isize - 1) as u32;
    image.pixel(x, y)
}

/// From -1 to 1 with a density that falls linearly from the middle, for a number in [0, 1).
fn tent(u: f32) -> f32 {
    if u < 0.5 { (2.0 * u.max(0.0)).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - u).max(0.0)).sqrt() }
}
