//! A picture of light from infinity.
//!
//! The picture is a longitude-latitude map: its middle row is the horizon, its top row the zenith +Y, its middle column -Z seen from
//! inside, and columns grow towards +X. A pixel is an area: row j of h is centred at the colatitude (j + 1/2) pi / h, and its light is
//! interpolated to those of its neighbours; columns wrap, and above the first row and below the last light stays as it is there.
//!
//! **Cells.** Light is bilinear in cells whose corners are the middles of four pixels. A cell is chosen by the brightness that it has as a whole,
//! then a place in it by that of its corners, each times the sine of its colatitude, bilinearly. So the density is that of the
//! light, but for what the sine changes within a pixel where the light does, too, and the map from the square is monotone in a row of cells:
//! what is stratified stays so.
//!
//! **Memory.** Corners are stored with their colour and with what the density of their cell is beside its brightness (for the cell to the right of
//! them and below). So four look-ups of 16 bytes, two of which are mostly in the same line of the cache, bring light and density. With the tables to draw from
//! 21 bytes per pixel.

use crate::image::Image;
use crate::math::lanes::{Compare, IntLanes, Isa, Kernel, Lanes, Select, Wrapping};
use crate::math::{Rgb, Vec3};
use crate::sampling::{Table2d, TableError};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

/// A longitude-latitude picture of radiance, interpolated linearly.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    /// Of (width + 2) x (height + 2) corners, by row: corner (i, j) is the middle of the pixel (i - 1, j - 1), repeated beyond the edges. Radiance,
    /// and the density of the cell over that of its interpolated brightness.
    corners: Vec<[f32; 4]>,
    /// Of each row of cells the sines of the colatitudes of its upper and lower corners; two are spare.
    sines: Vec<[f32; 4]>,
    width: u32,
    height: u32,
    /// In turns.
    rotation: f32,
    /// Over width x (height + 1) cells; those of the first and the last row are half as high.
    choice: Table2d,
    mean_luminance: f32,
}

/// What comes from a direction.
#[derive(Clone, Copy, Debug)]
pub struct Arriving<F: Lanes> {
    /// Radiance.
    pub radiance: Rgb<F>,
    /// Density, with respect to solid angle, with which the direction is drawn.
    pub pdf: F,
}

/// A direction that was drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct FromMap<F: Lanes> {
    pub(super) wi: Vec3<F>,
    pub(super) arriving: Arriving<F>,
}

impl EnvironmentMap {
    /// Bytes of the picture and of the tables to draw from it.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.corners[..]) + size_of_val(&self.sines[..]) + self.choice.bytes()
    }

    /// From a picture, a factor on its values and a rotation about +Y in radians, counter-clockwise seen from above. Fails
    /// if the picture is black or holds negative or non-finite values.
    pub fn new(image: Image, scale: f32, rotation: f32) -> Result<Self, TableError> {
        let [width, height] = [image.width(), image.height()];
        if let Some(bad) = image.pixels().iter().position(|pixel| !is_light(pixel.scale(scale))) {
            return Err(TableError::Weight(bad));
        }
        let mut corners = Vec::with_capacity((width as usize + 2) * (height as usize + 2));
        for j in 0..height + 2 {
            let row = Ord::min(j.saturating_sub(1), height.saturating_sub(1));
            for i in 0..width + 2 {
                let Rgb { r, g, b } = image.pixel((i + width - 1) % width, row).scale(scale);
                corners.push([r, g, b, 0.0]);
            }
        }
        let sines: Vec<f32> = (0..height + 2).map(|j| sine_of_row(j.clamp(1, height) - 1, height)).collect();
        let mean_luminance = mean_luminance(&image, scale);
        drop(image);
        let means = means(&corners, &sines, width);
        let choice = Table2d::new(&means, width as usize)?;
        let sines = sines.windows(2).map(|both| [both[0], both[1], 0.0, 0.0]).collect();
        let mut map =
            Self { corners, sines, width, height, rotation: rotation / TAU, choice, mean_luminance };
        map.note_densities(&means);
        Ok(map)
    }

    /// The mean over all directions.
    pub(super) fn mean_luminance(&self) -> f32 {
        self.mean_luminance
    }

    /// Notes at corners the densities of their cells: the first cell of a row is also that after its last.
    fn note_densities(&mut self, weights: &[f32]) {
        let [width, stride] = [self.width as usize, self.width as usize + 2];
        for row in 0..=self.height as usize {
            for column in 0..width {
                let weight = weights[row * width + column];
                let probability = self.choice.probability([column, row]);
                // A density of 1 is that of all pixels alike: weights are by pixels.
                let density = probability / weight * (self.width as f32 * self.height as f32);
                let density = if weight > 0.0 { density.min(f32::MAX) } else { 0.0 };
                self.corners[row * stride + column][3] = density;
                if column == 0 {
                    self.corners[row * stride + width][3] = density;
                }
            }
        }
    }

    /// What comes from the unit directions `d`.
    #[inline(always)]
    pub fn arriving<F: Lanes>(&self, d: Vec3<F>) -> Arriving<F> {
        look_up(d.x.isa(), self, d)
    }

    /// Directions by the light that comes from them.
    #[inline(always)]
    pub(super) fn sample<F: Lanes>(&self, u2: [F; 2]) -> FromMap<F> {
        draw(u2[0].isa(), self, u2)
    }

    #[inline(always)]
    fn cell<S: Isa>(&self, isa: S, [column, row]: [S::I; 2]) -> Cell<S::F> {
        let stride = self.width + 2;
        let first = Wrapping::<S::I>::wrapping_add(Wrapping::<u32>::wrapping_mul(row, stride), column);
        let corner = |offset| isa.gather_quads(&self.corners, Wrapping::<u32>::wrapping_add(first, offset));
        let [r, g, b, density] = corner(0);
        let [a, b] = [Rgb::new(r, g, b), colour(corner(1))];
        let [c, d] = [colour(corner(stride)), colour(corner(stride + 1))];
        let [above, below, ..] = isa.gather_quads(&self.sines, row);
        Cell {
            upper: [a, b],
            lower: [c, d],
            upper_weights: [a.luminance() * above, b.luminance() * above],
            lower_weights: [c.luminance() * below, d.luminance() * below],
            density,
        }
    }
}

/// Bilinear light.
struct Cell<F: Lanes> {
    /// At the corners, left and right.
    upper: [Rgb<F>; 2],
    lower: [Rgb<F>; 2],
    /// Brightness times sine.
    upper_weights: [F; 2],
    lower_weights: [F; 2],
    /// Of the density over the map, beside these.
    density: F,
}

impl<F: Lanes> Cell<F> {
    /// At a place in the cell, where `sine` is that of the colatitude.
    #[inline(always)]
    fn at(&self, [x, y]: [F; 2], sine: F) -> Arriving<F> {
        let [a, b] = self.upper;
        let [c, d] = self.lower;
        let radiance = a.lerp(c, y).lerp(b.lerp(d, y), x);
        let [left, right] = self.sides(y);
        let density = left.lerp(right, x) * self.density;
        // It is infinite at the poles; there the sine stands for that of the last direction that is drawn.
        Arriving { radiance, pdf: density / (sine.max(1e-9) * (2.0 * PI * PI)) }
    }

    /// Weights at the left and right side.
    #[inline(always)]
    fn sides(&self, y: F) -> [F; 2] {
        let [a, b] = self.upper_weights;
        let [c, d] = self.lower_weights;
        [a.lerp(c, y), b.lerp(d, y)]
    }

    /// A place in the cell, by the weights; `u2` is for the place along the row and that downwards.
    #[inline(always)]
    fn sample(&self, [u, v]: [F; 2]) -> [F; 2] {
        let [a, b] = self.upper_weights;
        let [c, d] = self.lower_weights;
        let y = linear([a + b, c + d], v);
        [linear(self.sides(y), u), y]
    }
}

/// A function of its own per instruction set: kernels of lights would hold it beside all others.
#[inline(never)]
fn look_up<S: Isa>(isa: S, map: &EnvironmentMap, d: Vec3<S::F>) -> Arriving<S::F> {
    isa.run(LookUp { map, d })
}

struct LookUp<'a, F> {
    map: &'a EnvironmentMap,
    d: Vec3<F>,
}

impl<S: Isa> Kernel<S> for LookUp<'_, S::F> {
    type Output = Arriving<S::F>;
    #[inline(always)]
    fn run(self, isa: S) -> Arriving<S::F> {
        let Self { map, d } = self;
        let (width, height) = (to_f32(map.width), to_f32(map.height));
        let longitude = d.x.atan2(-d.z) * (1.0 / TAU) + (map.rotation + 0.5);
        // The length of the horizontal part keeps the angle exact near the poles.
        let sine = (d.x.square() + d.z.square()).sqrt();
        let colatitude = sine.atan2(d.y) * FRAC_1_PI;
        let x = (longitude - longitude.floor()) * width + 0.5;
        let y = colatitude.clamp(0.0, 1.0) * height + 0.5;
        let [column, row] = [x.floor().min(width), y.floor().min(height)];
        let cell = map.cell(isa, [column.to_int(), row.to_int()]);
        cell.at([x - column, y - row], sine)
    }
}

/// A function of its own per instruction set, as [`look_up`].
#[inline(never)]
fn draw<S: Isa>(isa: S, map: &EnvironmentMap, u2: [S::F; 2]) -> FromMap<S::F> {
    isa.run(Draw { map, u2 })
}

struct Draw<'a, F> {
    map: &'a EnvironmentMap,
    u2: [F; 2],
}

impl<S: Isa> Kernel<S> for Draw<'_, S::F> {
    type Output = FromMap<S::F>;
    #[inline(always)]
    fn run(self, isa: S) -> FromMap<S::F> {
        let Self { map, u2 } = self;
        let chosen = map.choice.sample(u2);
        let cell = map.cell(isa, [chosen.column, chosen.row]);
        let [x, y] = cell.sample(chosen.within);
        // At the poles cells are halves, of light that does not change with the colatitude.
        let (first, last) = (Compare::<u32>::eq(chosen.row, 0), Compare::<u32>::eq(chosen.row, map.height));
        let half = y * 0.5;
        let y = S::F::select(first, half + 0.5, S::F::select(last, half, y));
        let (column, row) = (chosen.column.signed_to_float(), chosen.row.signed_to_float());
        let longitude = (column + (x - 0.5)) * (1.0 / to_f32(map.width)) - (map.rotation + 0.5);
        let colatitude = (row + (y - 0.5)) * (0.5 / to_f32(map.height));
        let (sine, cosine) = colatitude.sin_cos_turns();
        let (sine_of, cosine_of) = longitude.sin_cos_turns();
        let wi = Vec3::new(sine * sine_of, cosine, -(sine * cosine_of));
        FromMap { wi, arriving: cell.at([x, y], sine) }
    }
}

/// The place in [0, 1] for a number in (0, 1), with a density that goes linearly from `a` to `b`.
#[inline(always)]
fn linear<F: Lanes>([a, b]: [F; 2], u: F) -> F {
    let sum = a + b;
    // Weights are of any size: their squares are not.
    let inverse = F::select(sum.gt(0.0), sum, sum.splat(1.0)).recip();
    let (a, b) = (a * inverse, b * inverse);
    // The root of a x (2 - x) + b x^2 = u that does not cancel, since a + b = 1.
    let root = (b - a).mul_add(u, a.square()).max(0.0).sqrt();
    (u / (a + root)).min(1.0)
}

#[inline(always)]
fn colour<F>([r, g, b, _]: [F; 4]) -> Rgb<F> {
    Rgb::new(r, g, b)
}

/// The weight of each cell in pixels: its mean brightness times sine, and half of that at the poles.
fn means(corners: &[[f32; 4]], sines: &[f32], width: u32) -> Vec<f32> {
    let stride = width as usize + 2;
    let weight = |corner: [f32; 4], sine: f32| colour(corner).luminance() * sine;
    let rows = sines.len() - 1;
    let mut means = Vec::with_capacity(rows * width as usize);
    for row in 0..rows {
        let [above, below] = [row, row + 1].map(|j| (&corners[j * stride..][..stride], sines[j]));
        let share = if row == 0 || row + 1 == rows { 0.5 } else { 1.0 };
        for column in 0..width as usize {
            let both = |(corners, sine): (&[[f32; 4]], f32)| {
                f64::from(weight(corners[column], sine)) + f64::from(weight(corners[column + 1], sine))
            };
            #[expect(clippy::cast_possible_truncation, reason = "a mean of numbers of that precision")]
            means.push(((both(above) + both(below)) * 0.25 * share) as f32);
        }
    }
    means
}

/// The mean over all directions, in luminance.
fn mean_luminance(image: &Image, scale: f32) -> f32 {
    let (mut sum, mut solid) = (0.0_f64, 0.0_f64);
    for (y, row) in (0..image.height()).zip(image.pixels().chunks_exact(image.width() as usize)) {
        let sine = f64::from(sine_of_row(y, image.height()));
        sum += sine * row.iter().map(|pixel| f64::from(pixel.luminance())).sum::<f64>();
        solid += sine * f64::from(image.width());
    }
    #[expect(clippy::cast_possible_truncation, reason = "a mean needs no more digits")]
    let mean = (sum / solid) as f32;
    mean * scale
}

/// The sine of the colatitude in the middle of a row of pixels.
fn sine_of_row(row: u32, height: u32) -> f32 {
    (PI * (to_f32(row) + 0.5) / to_f32(height)).sin()
}

/// Whether a pixel is a finite amount of light.
fn is_light(pixel: Rgb<f32>) -> bool {
    pixel.is_finite() && pixel.luminance() >= 0.0
}

/// A count of pixels.
#[expect(clippy::cast_precision_loss, reason = "pictures have less than 2^24 rows and columns")]
fn to_f32(n: u32) -> f32 {
    n as f32
}
