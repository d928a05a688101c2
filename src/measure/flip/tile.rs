//! FLIP of one tile, over lanes.
//!
//! A tile is small enough that all it needs stays in the second-level cache. All exposures are gone through before the
//! next tile, so that pictures cross memory once, however many exposures there are.

use super::colour;
use super::filter::Filters;
use super::sight::{Desk, Extent, Plane, Seen, Sight, see};
use super::tone::Tone;
use crate::image::Image;
use crate::math::Rgb;
use crate::math::lanes::{Compare as _, Isa, Kernel, Lanes, WIDEST};

/// Most columns and rows of a tile.
pub(super) const SIDES: [usize; 2] = [128, 64];

/// A part of two pictures, and how to compare it.
#[derive(Debug)]
pub(super) struct Tile<'a> {
    filters: &'a Filters,
    /// The greatest error over all of them counts.
    tones: &'a [Tone],
    extent: Extent,
    /// Red, green and blue of both pictures, with what is around the tile.
    light: [[Plane; 3]; 2],
}

impl<'a> Tile<'a> {
    /// The tile with its first pixel at `origin`, of two pictures of one size.
    pub(super) fn new(
        pictures: [&Image; 2],
        origin: [usize; 2],
        filters: &'a Filters,
        tones: &'a [Tone],
    ) -> Self {
        let [width, height] = [pictures[0].width() as usize, pictures[0].height() as usize];
        let extent = Extent {
            columns: (width - origin[0]).min(SIDES[0]).next_multiple_of(WIDEST),
            rows: (height - origin[1]).min(SIDES[1]),
            reach: filters.radius(),
        };
        Self { filters, tones, extent, light: pictures.map(|picture| surroundings(picture, origin, extent)) }
    }

    /// Columns of what the kernel gives; those beyond the picture mean nothing.
    pub(super) fn columns(&self) -> usize {
        self.extent.columns
    }

    /// Rows.
    pub(super) fn rows(&self) -> usize {
        self.extent.rows
    }
}

/// The light of a tile and around it. Beyond the border of the picture it is that of the border.
fn surroundings(picture: &Image, origin: [usize; 2], extent: Extent) -> [Plane; 3] {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let inside = |i: usize, end: usize| i.saturating_sub(extent.reach).min(end - 1);
    let length = (extent.stride() * extent.lines()).next_multiple_of(WIDEST);
    let mut planes = [(); 3].map(|()| vec![0.0; length]);
    let [red, green, blue] = &mut planes;
    for line in 0..extent.lines() {
        let row = &picture.pixels()[inside(origin[1] + line, height) * width..][..width];
        for column in 0..extent.stride() {
            let Rgb { r, g, b } = row[inside(origin[0] + column, width)];
            let i = line * extent.stride() + column;
            (red[i], green[i], blue[i]) = (r, g, b);
        }
    }
    planes
}

/// The errors of all pixels, by row.
impl<S: Isa> Kernel<S> for &Tile<'_> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn run(self, isa: S) -> Vec<f32> {
        let extent = self.extent;
        let mut desk = Desk::new(extent, self.light[0][0].len());
        let mut sights = [Sight::new(extent), Sight::new(extent)];
        let mut worst = vec![0.0; extent.columns * extent.rows];
        let greatest = colour::greatest_distance();
        for &tone in self.tones {
            let [first, second] = &mut sights;
            see(isa, (&self.light[0], tone), self.filters, extent, &mut desk, first);
            see(isa, (&self.light[1], tone), self.filters, extent, &mut desk, second);
            for i in (0..worst.len()).step_by(S::WIDTH) {
                let error = difference(first.at(isa, i), second.at(isa, i), greatest);
                error.max(isa.load(&worst[i..])).store(&mut worst[i..]);
            }
        }
        worst
    }
}

/// The error of each pixel: that of colour, made worse where edges or points differ. Andersson et al., 2020, "FLIP",
/// sections 4.2.2 and 4.3.
#[inline(always)]
fn difference<F: Lanes>(first: Seen<F>, second: Seen<F>, greatest: f32) -> F {
    let colour = colour::error(first.colour.distance(second.colour), greatest);
    let edges = (first.edge - second.edge).abs();
    let points = (first.point - second.point).abs();
    let features = (edges.max(points) * std::f32::consts::FRAC_1_SQRT_2).sqrt();
    colour.powf(-features + 1.0)
}
