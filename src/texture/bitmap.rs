//! Pictures to be looked up over lanes: texels in as few bits as their file has, at full size and halved again and again.
//!
//! Each level is half as wide and high as the one before, down to one texel. A texel is the mean of what it covers, which at odd
//! sizes are parts of texels (area weights), taken of light and not of encoded numbers: all levels have the same mean. Levels
//! of bytes are rounded once, from numbers that were never rounded (Williams 1983, Pyramidal Parametrics).

use crate::image::tone::{linear_from_srgb, srgb_from_linear};
use crate::image::{Pixels, Raster};
use crate::math::lanes::{Compare, IntLanes, Isa, Lanes, Select, Wrapping};
use half::f16;
use std::sync::OnceLock;

/// How encoded numbers stand for light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Space {
    /// By the curve of sRGB; coverage is linear.
    Srgb,
    /// As they are.
    Linear,
}

/// A picture, ready to be looked up.
#[derive(Clone, Debug, PartialEq)]
pub struct Bitmap {
    texels: Texels,
    space: Space,
    /// The light of each byte.
    curve: &'static [f32; 256],
    /// Of each level where it starts, its width and its height.
    starts: Vec<u32>,
    widths: Vec<f32>,
    heights: Vec<f32>,
    /// Of all texels, never rounded.
    mean: [f32; 4],
    has_alpha: bool,
}

/// Texels of all levels, one level after the other, each by row from the top.
#[derive(Clone, Debug, PartialEq)]
enum Texels {
    /// Four texels a word, the first in the lowest byte.
    Gray(Vec<u32>),
    /// Red in the lowest byte, then green, blue and coverage.
    Bytes(Vec<u32>),
    /// Two words of two numbers of half precision, the first in the lower half.
    Halves(Vec<u32>),
    /// Red, green and blue, and coverage where the file has it.
    Floats {
        rows: Vec<[f32; 3]>,
        /// Empty where all is covered.
        coverage: Vec<f32>,
    },
}

/// A level in numbers.
struct Level {
    width: usize,
    height: usize,
    values: Vec<[f32; 4]>,
}

impl Bitmap {
    /// The picture of a file, with all smaller ones.
    #[must_use]
    pub fn new(raster: &Raster, space: Space) -> Self {
        let (width, height) = (raster.width as usize, raster.height as usize);
        let mut bitmap = Self {
            texels: match &raster.pixels {
                Pixels::Gray(bytes) => Texels::Gray(bytes.chunks(4).map(packed).collect()),
                Pixels::Bytes(bytes) => {
                    Texels::Bytes(bytes.iter().map(|texel| u32::from_le_bytes(*texel)).collect())
                }
                Pixels::Floats { half: true, .. } => Texels::Halves(vec![]),
                Pixels::Floats { half: false, .. } => Texels::Floats { rows: vec![], coverage: vec![] },
            },
            space,
            curve: curve(space),
            starts: vec![0],
            widths: vec![size(width)],
            heights: vec![size(height)],
            mean: [0.0; 4],
            has_alpha: raster.has_alpha,
        };
        let (curve, straight) = (curve(space), curve(Space::Linear));
        let mut level = match &raster.pixels {
            Pixels::Gray(bytes) => {
                let gray = |i: usize| {
                    let x = curve[usize::from(bytes[i])];
                    [x, x, x, 1.0]
                };
                halved(width, height, gray)
            }
            Pixels::Bytes(bytes) => {
                let color = |i: usize| {
                    let [r, g, b, a] = bytes[i].map(usize::from);
                    [curve[r], curve[g], curve[b], straight[a]]
                };
                halved(width, height, color)
            }
            Pixels::Floats { values, .. } => {
                let light = |[r, g, b, a]: [f32; 4]| match space {
                    Space::Linear => [r, g, b, a],
                    Space::Srgb => {
                        let [r, g, b] = [r, g, b].map(linear_from_srgb);
                        [r, g, b, a]
                    }
                };
                let values: Vec<[f32; 4]> = values.iter().map(|&v| light(v)).collect();
                bitmap.append(&values);
                // From here on they are light.
                bitmap.space = Space::Linear;
                halved(width, height, |i| values[i])
            }
        };
        let mut texels = width * height;
        bitmap.mean = bitmap.texel(0);
        while let Some(next) = level {
            bitmap.mean = next.values[0];
            bitmap.starts.push(u32::try_from(bitmap.aligned(&mut texels)).unwrap_or(u32::MAX));
            bitmap.widths.push(size(next.width));
            bitmap.heights.push(size(next.height));
            bitmap.append(&next.values);
            texels += next.values.len();
            level = halved(next.width, next.height, |i| next.values[i]);
        }
        bitmap
    }

    /// Where the next level starts: those of gray bytes fill words.
    fn aligned(&self, texels: &mut usize) -> usize {
        if let Texels::Gray(_) = self.texels {
            *texels = texels.next_multiple_of(4);
        }
        *texels
    }

    /// Adds texels given as light.
    fn append(&mut self, values: &[[f32; 4]]) {
        let space = self.space;
        match &mut self.texels {
            Texels::Gray(words) => {
                let bytes: Vec<u8> = values.iter().map(|v| byte(v[0], space)).collect();
                words.extend(bytes.chunks(4).map(packed));
            }
            Texels::Bytes(words) => words.extend(values.iter().map(|&[r, g, b, a]| {
                let [r, g, b] = [r, g, b].map(|x| byte(x, space));
                u32::from_le_bytes([r, g, b, byte(a, Space::Linear)])
            })),
            Texels::Halves(words) => words.extend(values.iter().flat_map(|v| {
                let [r, g, b, a] = v.map(|x| u32::from(f16::from_f32(x).to_bits()));
                [r | g << 16, b | a << 16]
            })),
            Texels::Floats { rows, coverage } => {
                rows.extend(values.iter().map(|&[r, g, b, _]| [r, g, b]));
                if self.has_alpha {
                    coverage.extend(values.iter().map(|&[.., a]| a));
                }
            }
        }
    }

    /// Bytes of memory that its texels take, all levels counted.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match &self.texels {
            Texels::Gray(words) | Texels::Bytes(words) | Texels::Halves(words) => size_of_val(&words[..]),
            Texels::Floats { rows, coverage } => size_of_val(&rows[..]) + size_of_val(&coverage[..]),
        }
    }

    /// Columns and rows at full size.
    #[must_use]
    pub fn size(&self) -> [f32; 2] {
        [self.widths[0], self.heights[0]]
    }

    /// How many levels there are.
    #[must_use]
    pub fn levels(&self) -> usize {
        self.starts.len()
    }

    /// Whether the file says how much of each texel is covered.
    #[must_use]
    pub fn has_alpha(&self) -> bool {
        self.has_alpha
    }

    /// Red, green, blue and coverage where all texels have the same.
    #[must_use]
    pub fn constant(&self) -> [Option<f32>; 4] {
        let mut found = self.texel::<f32>(0).map(Some);
        // The first level alone: the others are means of it.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "sizes of pictures")]
        let texels = self.widths[0] as u32 * self.heights[0] as u32;
        for index in 1..texels {
            let texel = self.texel::<f32>(index);
            for (known, value) in found.iter_mut().zip(texel) {
                #[expect(clippy::float_cmp, reason = "the same texel again")]
                if known.is_some_and(|known| known != value) {
                    *known = None;
                }
            }
            if found.iter().all(Option::is_none) {
                break;
            }
        }
        found
    }

    /// The mean of all texels, not rounded as the smallest level is: red, green, blue and coverage.
    #[must_use]
    pub fn mean(&self) -> [f32; 4] {
        self.mean
    }

    /// Width and height of the level of each lane.
    #[inline(always)]
    pub(super) fn size_of<I: IntLanes>(&self, level: I) -> [I::F; 2] {
        let isa = level.isa();
        [isa.gather(&self.widths, level), isa.gather(&self.heights, level)]
    }

    /// The texel in column `x` and row `y` of a level as wide as `width`; all whole numbers within it.
    #[inline(always)]
    pub(super) fn at<I: IntLanes>(&self, level: I, width: I::F, [x, y]: [I::F; 2]) -> [I::F; 4] {
        let start = level.isa().gather_u32(&self.starts, level);
        let row = Wrapping::<I>::wrapping_mul(y.to_int(), width.to_int());
        let index = Wrapping::<I>::wrapping_add(Wrapping::<I>::wrapping_add(row, x.to_int()), start);
        self.texel(index)
    }

    #[inline(always)]
    fn texel<F: Lanes>(&self, index: F::Int) -> [F; 4] {
        let isa = index.isa();
        let one = isa.splat(1.0);
        match &self.texels {
            Texels::Gray(words) => {
                let word = isa.gather_u32(words, index >> 2);
                let upper = Compare::<u32>::ge(index & 3, 2);
                let word = F::Int::select(upper, word >> 16, word);
                let odd = Compare::<u32>::ne(index & 1, 0);
                let byte = F::Int::select(odd, word >> 8, word) & 0xff;
                let x = self.decoded::<F>(byte);
                [x, x, x, one]
            }
            Texels::Bytes(words) => {
                let word = isa.gather_u32(words, index);
                let [r, g, b] = [word & 0xff, (word >> 8) & 0xff, (word >> 16) & 0xff];
                let a = (word >> 24).signed_to_float() * (1.0 / 255.0);
                [self.decoded(r), self.decoded(g), self.decoded(b), a]
            }
            Texels::Halves(words) => {
                let first = index << 1;
                let rg = isa.gather_u32(words, first);
                let ba = isa.gather_u32(words, Wrapping::<u32>::wrapping_add(first, 1));
                [from_half(rg), from_half(rg >> 16), from_half(ba), from_half(ba >> 16)]
            }
            Texels::Floats { rows, coverage } => {
                let [r, g, b] = isa.gather_rows(rows, index);
                [r, g, b, if coverage.is_empty() { one } else { isa.gather(coverage, index) }]
            }
        }
    }

    #[inline(always)]
    fn decoded<F: Lanes>(&self, byte: F::Int) -> F {
        byte.isa().gather(self.curve, byte)
    }
}

/// The number whose half-precision bits are the lower 16: shifted into place it is 2^-112 times what it stands for. No
/// infinities, no NaN.
#[inline(always)]
fn from_half<I: IntLanes>(bits: I) -> I::F {
    const SHIFTED: f32 = f32::from_bits((127 + 112) << 23);
    let magnitude = I::F::from_bits((bits & 0x7fff) << 13) * SHIFTED;
    I::F::from_bits(magnitude.to_bits() | ((bits & 0x8000) << 16))
}

#[expect(clippy::cast_precision_loss, reason = "sizes are below 2^24")]
fn size(texels: usize) -> f32 {
    texels as f32
}

fn packed(bytes: &[u8]) -> u32 {
    let mut word = [0; 4];
    word[..bytes.len()].copy_from_slice(bytes);
    u32::from_le_bytes(word)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a byte")]
fn byte(light: f32, space: Space) -> u8 {
    let encoded = if space == Space::Srgb { srgb_from_linear(light) } else { light };
    (encoded * 255.0).round().clamp(0.0, 255.0) as u8
}

/// The light of each byte.
fn curve(space: Space) -> &'static [f32; 256] {
    static CURVES: OnceLock<[[f32; 256]; 2]> = OnceLock::new();
    let curves = CURVES.get_or_init(|| {
        let mut curves = [[0.0; 256]; 2];
        for (byte, level) in (0..=u8::MAX).zip(0..) {
            let level: usize = level;
            let encoded = f32::from(byte) / 255.0;
            curves[0][level] = linear_from_srgb(encoded);
            curves[1][level] = encoded;
        }
        curves
    });
    &curves[usize::from(space == Space::Linear)]
}

/// Half as wide and high, each texel the mean of what it covers; `None` of a single texel.
fn halved(width: usize, height: usize, texel: impl Fn(usize) -> [f32; 4]) -> Option<Level> {
    if width * height <= 1 {
        return None;
    }
    let (to_width, to_height) = ((width / 2).max(1), (height / 2).max(1));
    let columns: Vec<Cover> = (0..to_width).map(|i| Cover::of(i, to_width, width)).collect();
    let mut values = Vec::with_capacity(to_width * to_height);
    for y in 0..to_height {
        let rows = Cover::of(y, to_height, height);
        for column in &columns {
            let mut sum = [0.0_f32; 4];
            for (row, weight) in rows.parts() {
                for (x, part) in column.parts() {
                    let found = texel(row * width + x);
                    sum.iter_mut().zip(found).for_each(|(sum, x)| *sum += x * weight * part);
                }
            }
            values.push(sum);
        }
    }
    Some(Level { width: to_width, height: to_height, values })
}

/// What one of fewer texels covers of more, along an axis: two or three of them.
struct Cover {
    first: usize,
    weights: [f32; 3],
}

impl Cover {
    /// Of texel `i` of `to` over `from` texels, which are at most three times as many.
    fn of(i: usize, to: usize, from: usize) -> Self {
        let ratio = size(from) / size(to);
        let (first, begin) = (i * from / to, size(i * from % to) / size(to));
        let mut left = ratio;
        let mut room = 1.0 - begin;
        let mut weights = [0.0; 3];
        for weight in &mut weights {
            let part = left.min(room);
            *weight = if part > 1e-4 { part / ratio } else { 0.0 };
            left -= part;
            room = 1.0;
        }
        Self { first, weights }
    }

    fn parts(&self) -> impl Iterator<Item = (usize, f32)> {
        (self.first..).zip(self.weights).filter(|(_, weight)| *weight > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(width: u32, height: u32, space: Space, texel: impl Fn(u32, u32) -> [u8; 4]) -> Bitmap {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y));
        let pixels = Pixels::Bytes(pixels.collect());
        let raster = Raster {
            width,
            height,
            pixels,
            encoded: true,
            has_alpha: true,
            warnings: vec![],
            as_colour: vec![],
        };
        Bitmap::new(&raster, space)
    }

    #[expect(clippy::float_cmp, reason = "0 and 1 are exact")]
    #[test]
    fn bytes_are_decoded_by_their_curve() {
        for (space, expected) in [(Space::Srgb, 0.215_860_5), (Space::Linear, 128.0 / 255.0)] {
            let map = bytes(1, 1, space, |_, _| [128, 0, 255, 51]);
            let [r, g, b, a] = map.texel::<f32>(0);
            // ((128 / 255 + 0.055) / 1.055)^2.4
            assert!((r - expected).abs() < 1e-6, "{space:?}: {r}");
            assert_eq!([g, b], [0.0, 1.0], "{space:?}");
            assert!((a - 0.2).abs() < 1e-7, "{space:?}: coverage has no curve, {a}");
        }
    }

    #[test]
    fn halves_come_back() {
        for x in [0.0, -0.0, 1.0, -2.5, 65504.0, 6.0e-8, 3.0e-5, 0.333_251_95] {
            let bits = u32::from(f16::from_f32(x).to_bits());
            let back: f32 = from_half(bits | 0xabcd_0000);
            assert_eq!(back.to_bits(), f16::from_f32(x).to_f32().to_bits(), "{x}");
        }
    }

    #[test]
    fn levels_have_the_mean_of_the_whole() {
        for (width, height) in [(8, 8), (7, 5), (1, 9), (13, 2), (3, 3)] {
            let value = |x: u32, y: u32| f32::from(u16::try_from((x * 7 + y * 13) % 11).expect("small"));
            let values: Vec<[f32; 4]> =
                (0..width * height).map(|i| [value(i % width, i / width); 4]).collect();
            let mean = values.iter().map(|v| v[0]).sum::<f32>() / size(values.len());
            for half in [false, true] {
                let pixels = Pixels::Floats { values: values.clone(), half };
                let raster = Raster {
                    width,
                    height,
                    pixels,
                    encoded: false,
                    has_alpha: true,
                    warnings: vec![],
                    as_colour: vec![],
                };
                let map = Bitmap::new(&raster, Space::Linear);
                let tolerance = if half { 1e-2 } else { 1e-5 };
                for level in 0..map.levels() {
                    let count = map.widths[level] * map.heights[level];
                    let end = map.starts.get(level + 1).copied();
                    let end = end.unwrap_or(map.starts[level] + 1);
                    let sum: f32 = (map.starts[level]..end).map(|i| map.texel::<f32>(i)[0]).sum();
                    assert!((sum / count - mean).abs() < tolerance, "{width} x {height}, level {level}");
                }
                assert!((map.mean()[0] - mean).abs() < tolerance, "{width} x {height}: mean");
            }
        }
    }

    #[test]
    fn means_are_means_of_light() {
        let map = bytes(2, 2, Space::Srgb, |x, y| if (x + y) % 2 == 0 { [0; 4] } else { [255; 4] });
        let [r, _, _, a] = map.mean();
        assert!((r - 0.5).abs() < 4e-3, "half the light, not half the byte: {r}");
        assert!((a - 0.5).abs() < 2e-3, "coverage has no curve: {a}");
    }

    #[test]
    fn the_mean_of_a_dark_picture_is_no_byte() {
        let map = bytes(256, 256, Space::Srgb, |x, y| if x < 2 && y < 3 { [255; 4] } else { [0, 0, 0, 255] });
        let [r, ..] = map.mean();
        assert!((r * 65536.0 / 6.0 - 1.0).abs() < 1e-5, "{r}");
    }

    #[expect(clippy::float_cmp, reason = "the same byte")]
    #[test]
    fn memory_is_what_the_file_needs_and_a_third() {
        let gray = Pixels::Gray(vec![9; 64 * 64]);
        let raster = Raster {
            width: 64,
            height: 64,
            pixels: gray,
            encoded: true,
            has_alpha: false,
            warnings: vec![],
            as_colour: vec![],
        };
        let gray = Bitmap::new(&raster, Space::Srgb);
        assert!((4096 + 1365..4096 + 1365 + 8).contains(&gray.bytes()), "{}", gray.bytes());
        assert_eq!(gray.texel::<f32>(gray.starts[6]), gray.texel::<f32>(5), "the last level");
        let color = bytes(64, 64, Space::Srgb, |_, _| [1; 4]);
        assert_eq!(color.bytes(), 4 * (4096 + 1365), "four bytes a texel");
    }
}
