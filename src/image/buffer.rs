//! Pixels in memory.

use std::path::Path;

use crate::error::{Error, Place, Problem, Result};
use crate::math::Rgb;
use crate::trust::{Limit, Limits};

/// Linear Rec.709 colour of each pixel, by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<Rgb<f32>>,
}

impl Image {
    /// A black picture.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![Rgb::BLACK; width as usize * height as usize] }
    }

    /// A picture of `pixels`, by row from the top; none if their number is not `width` times `height`.
    pub fn from_pixels(width: u32, height: u32, pixels: Vec<Rgb<f32>>) -> Option<Self> {
        (pixels.len() == width as usize * height as usize).then_some(Self { width, height, pixels })
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, by row from the top.
    pub fn pixels(&self) -> &[Rgb<f32>] {
        &self.pixels
    }

    /// All pixels, by row from the top.
    pub fn pixels_mut(&mut self) -> &mut [Rgb<f32>] {
        &mut self.pixels
    }

    /// The pixel in column `x` and row `y`.
    ///
    /// # Panics
    /// Outside of the picture.
    pub fn pixel(&self, x: u32, y: u32) -> Rgb<f32> {
        self.pixels[self.index(x, y)]
    }

    /// Sets the pixel in column `x` and row `y`.
    ///
    /// # Panics
    /// Outside of the picture.
    pub fn set_pixel(&mut self, x: u32, y: u32, colour: Rgb<f32>) {
        let index = self.index(x, y);
        self.pixels[index] = colour;
    }

    fn index(&self, x: u32, y: u32) -> usize {
        assert!(
            x < self.width && y < self.height,
            "pixel ({x}, {y}) outside of {}x{}",
            self.width,
            self.height
        );
        y as usize * self.width as usize + x as usize
    }
}

/// A rectangle of pixels in a picture, half-open: from (`x0`, `y0`) up to but without (`x1`, `y1`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Window {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One past the last column.
    pub x1: u32,
    /// One past the last row.
    pub y1: u32,
}

impl Window {
    /// The whole of a picture.
    pub const fn whole(width: u32, height: u32) -> Self {
        Self { x0: 0, y0: 0, x1: width, y1: height }
    }

    /// x0, y0, x1, y1.
    pub const fn corners(self) -> [u32; 4] {
        [self.x0, self.y0, self.x1, self.y1]
    }

    /// Columns.
    pub fn width(self) -> u32 {
        self.x1.saturating_sub(self.x0)
    }

    /// Rows.
    pub fn height(self) -> u32 {
        self.y1.saturating_sub(self.y0)
    }

    /// Number of pixels.
    pub fn area(self) -> usize {
        self.width() as usize * self.height() as usize
    }

    /// Whether there is no pixel in it.
    pub fn is_empty(self) -> bool {
        self.area() == 0
    }

    /// Whether the pixel is inside.
    pub fn contains(self, x: u32, y: u32) -> bool {
        (self.x0..self.x1).contains(&x) && (self.y0..self.y1).contains(&y)
    }

    /// Whether all of it lies in a picture of that size.
    pub fn fits(self, width: u32, height: u32) -> bool {
        self.x1 <= width && self.y1 <= height
    }
}

/// Refuses a picture without pixels, or with more than are allowed.
pub(super) fn check_size(path: &Path, [width, height]: [u64; 2], limits: &Limits) -> Result<()> {
    let problem = |what: String| Problem::at(Place::file(path), what);
    if width == 0 || height == 0 {
        return Err(problem(format!("a picture of {width} by {height} pixels has none")).into());
    }
    limits.check(Limit::Texels, width.saturating_mul(height)).map_err(|excess| {
        let what = format!("a picture of {width} by {height} pixels is too large: {excess}");
        Error::Refused(problem(what).remedy(excess.remedy()))
    })
}

/// Refuses a picture that no file of so many bytes can hold at `most` pixels a byte: what a broken header claims is no reason to take
/// memory.
pub(super) fn check_claim(path: &Path, [width, height]: [u64; 2], bytes: usize, most: u64) -> Result<()> {
    if width.saturating_mul(height) / most > bytes as u64 {
        let what = "its header claims more pixels than its bytes can hold";
        return Err(Problem::at(Place::file(path), what).remedy("write it again").into());
    }
    Ok(())
}

/// Numbers that were not finite and what became of them, counted over a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Repairs {
    nans: u64,
    infinities: u64,
}

impl Repairs {
    /// The largest finite half float: what an infinity most likely was before it was stored.
    const HALF_MAX: f32 = 65504.0;

    /// `x` if finite; zero for NaN; the largest half float, with its sign, for an infinity.
    pub(super) fn finite(&mut self, x: f32) -> f32 {
        if x.is_finite() {
            x
        } else if x.is_nan() {
            self.nans += 1;
            0.0
        } else {
            self.infinities += 1;
            Self::HALF_MAX.copysign(x)
        }
    }

    /// What was repaired in that file, if anything.
    pub(super) fn warnings(self, path: &Path) -> Vec<Problem> {
        let entry = |count: u64, what: &str, by: &str| {
            (count > 0).then(|| {
                Problem::at(Place::file(path), format!("{count} {what} replaced by {by}"))
                    .remedy("check the program that wrote the file")
            })
        };
        [entry(self.nans, "NaN values", "zero"), entry(self.infinities, "infinite values", "65504")]
            .into_iter()
            .flatten()
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_addressed_by_column_and_row() {
        let mut image = Image::new(3, 2);
        image.set_pixel(2, 1, Rgb::WHITE);
        assert_eq!(image.pixels()[5], Rgb::WHITE, "last pixel");
        assert_eq!(image.pixel(2, 1), Rgb::WHITE, "read back");
        assert!(Image::from_pixels(2, 2, vec![Rgb::BLACK; 3]).is_none(), "one pixel short");
    }

    #[test]
    fn windows_are_half_open() {
        let window = Window { x0: 1, y0: 2, x1: 3, y1: 3 };
        assert_eq!((window.width(), window.height(), window.area()), (2, 1, 2), "size");
        assert!(window.contains(2, 2) && !window.contains(3, 2) && !window.contains(1, 3), "edges");
        assert!(window.fits(3, 3) && !window.fits(2, 3), "bounds");
        assert!(Window { x0: 3, y0: 0, x1: 1, y1: 5 }.is_empty(), "reversed");
    }

    #[test]
    fn absurd_sizes_are_refused() {
        let path = Path::new("a.exr");
        let limits = Limits::default();
        assert!(check_size(path, [0, 5], &limits).is_err(), "no pixel");
        assert!(check_size(path, [u64::MAX; 2], &limits).is_err(), "overflow");
        assert!(check_size(path, [32_000, 31_250], &limits).is_ok(), "the largest");
    }

    #[test]
    fn non_finite_numbers_are_replaced_and_counted() {
        let mut repairs = Repairs::default();
        assert_eq!(repairs.finite(1.5).to_bits(), 1.5_f32.to_bits(), "kept");
        assert_eq!(repairs.finite(f32::NAN).to_bits(), 0.0_f32.to_bits(), "NaN");
        assert_eq!(repairs.finite(f32::NEG_INFINITY).to_bits(), (-65504.0_f32).to_bits(), "infinity");
        assert_eq!(repairs, Repairs { nans: 1, infinities: 1 }, "counts");
        assert_eq!(repairs.warnings(Path::new("a.hdr")).len(), 2, "told");
    }
}
