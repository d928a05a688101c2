//! Pictures for textures: numbers as their files hold them, compact, not turned to light.

use std::io::Cursor;
use std::path::Path;

use image::codecs::jpeg::JpegDecoder;
use image::{ColorType, DynamicImage, ImageDecoder as _};

use super::buffer::{check_claim, check_size};
use super::exr::Samples;
use super::{Decoded, exr, files, hdr, known, png};
use crate::error::{Problem, Result};
use crate::trust::{Limits, Trust};

/// Extensions of the files that [`read_raster`] reads.
pub const RASTERS: &[&str] = &["png", "jpg", "jpeg", "exr", "hdr"];

/// A picture by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The pixels.
    pub pixels: Pixels,
    /// Whether the numbers are meant to be encoded by sRGB, as those of PNG and JPEG files are.
    pub encoded: bool,
    /// Whether the file says how much of each pixel is covered.
    pub has_alpha: bool,
    /// What was odd about the file.
    pub warnings: Vec<Problem>,
    /// What is odd besides where its numbers are taken for colour, and not for heights, normals or the like.
    pub as_colour: Vec<Problem>,
}

/// Pixels, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// A byte each.
    Gray(Vec<u8>),
    /// Red, green, blue and coverage, a byte each.
    Bytes(Vec<[u8; 4]>),
    /// Red, green, blue and coverage; all finite, and `half` where a file of 16-bit numbers held them.
    Floats {
        /// The pixels.
        values: Vec<[f32; 4]>,
        /// Whether half precision keeps them.
        half: bool,
    },
}

/// The picture in a `.png`, `.jpg`, `.exr` or `.hdr` file, within the usual limits. Gamma and colour profiles in it are not applied; an odd
/// gamma, and other primaries than those of Rec.709, are told. Of an `.exr` file it is what the display window shows: zero where there are
/// no data.
pub fn read_raster(path: &Path) -> Result<Raster> {
    read_raster_within(path, &Trust::default())
}

/// The same of a file that is trusted so far.
pub fn read_raster_within(path: &Path, trust: &Trust) -> Result<Raster> {
    known(path, RASTERS)?;
    decode_raster(&trust.read(path, files::UNREAD)?, path, &trust.limits)
}

/// The same of the bytes of a file; `path` tells of which kind, and is for messages.
pub fn decode_raster(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Raster> {
    match known(path, RASTERS)? {
        "png" => png::decoded(bytes, path, limits).map(|(picture, warnings)| from_display(picture, warnings)),
        "jpg" | "jpeg" => from_jpeg(bytes, path, limits).map(|picture| from_display(picture, vec![])),
        "exr" => {
            let (picture, as_colour) = exr::decode_shown(bytes, path, limits)?;
            let half = picture.channels.iter().all(|channel| matches!(channel.samples, Samples::Half(_)));
            Ok(Raster { as_colour, ..from_light(picture.into_decoded(path)?, half) })
        }
        _ => {
            let decoded = hdr::decode(bytes, path, limits)?;
            // Eight bits of mantissa fit; the exponents may not.
            let largest = decoded.image.pixels().iter().map(|p| p.max_channel()).fold(0.0, f32::max);
            let half = largest <= half::f16::MAX.to_f32();
            Ok(from_light(decoded, half))
        }
    }
}

fn from_light(decoded: Decoded, half: bool) -> Raster {
    let Decoded { image, alpha, warnings, .. } = decoded;
    let coverage = |i: usize| alpha.as_ref().map_or(1.0, |alpha| alpha[i]);
    let values = image.pixels().iter().enumerate().map(|(i, p)| [p.r, p.g, p.b, coverage(i)]).collect();
    let (width, height) = (image.width(), image.height());
    let pixels = Pixels::Floats { values, half };
    let has_alpha = alpha.is_some();
    Raster { width, height, pixels, encoded: false, has_alpha, warnings, as_colour: vec![] }
}

/// Most pixels that one byte of a JPEG file can hold: blocks of 64 take a bit each at least, and twice that to be safe.
const MAX_PIXELS_PER_BYTE: u64 = 2 * 8 * 64;

/// The picture in the bytes of a JPEG file; its size is checked before memory is asked for.
fn from_jpeg(bytes: &[u8], path: &Path, limits: &Limits) -> Result<DynamicImage> {
    const KIND: &str = "JPEG";
    let decoder = JpegDecoder::new(Cursor::new(bytes)).map_err(|error| files::refused(path, KIND, error))?;
    let size = [decoder.dimensions().0, decoder.dimensions().1].map(u64::from);
    check_size(path, size, limits)?;
    check_claim(path, size, bytes.len(), MAX_PIXELS_PER_BYTE)?;
    files::decoded(path, KIND, decoder)
}

fn from_display(picture: DynamicImage, warnings: Vec<Problem>) -> Raster {
    let (width, height) = (picture.width(), picture.height());
    let color = picture.color();
    let has_alpha = color.has_alpha();
    let pixels = match color {
        ColorType::L8 => Pixels::Gray(picture.into_luma8().into_raw()),
        ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            Pixels::Bytes(picture.into_rgba8().pixels().map(|p| p.0).collect())
        }
        _ => {
            let deep = picture.into_rgba16();
            let values = deep.pixels().map(|p| p.0.map(|x| f32::from(x) / 65535.0)).collect();
            Pixels::Floats { values, half: false }
        }
    };
    Raster { width, height, pixels, encoded: true, has_alpha, warnings, as_colour: vec![] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn saved(picture: &DynamicImage, name: &str) -> Raster {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join(name);
        picture.save(&path).expect("written");
        read_raster(&path).expect("read")
    }

    #[test]
    fn bytes_stay_bytes() {
        let color = image::RgbaImage::from_pixel(2, 1, image::Rgba([1, 2, 3, 4]));
        let read = saved(&DynamicImage::ImageRgba8(color), "a.png");
        assert_eq!(read.pixels, Pixels::Bytes(vec![[1, 2, 3, 4]; 2]), "colour");
        assert!(read.has_alpha && read.encoded, "{read:?}");
        let gray = image::GrayImage::from_pixel(1, 2, image::Luma([7]));
        let read = saved(&DynamicImage::ImageLuma8(gray), "a.png");
        assert_eq!(read.pixels, Pixels::Gray(vec![7; 2]), "gray");
        assert_eq!((read.width, read.height, read.has_alpha), (1, 2, false), "about it");
    }

    #[test]
    fn jpeg_files_are_read() {
        let flat = image::RgbImage::from_pixel(16, 8, image::Rgb([200, 100, 50]));
        let read = saved(&DynamicImage::ImageRgb8(flat), "a.jpg");
        let Pixels::Bytes(bytes) = &read.pixels else { panic!("{read:?}") };
        let near = |a: u8, b: u8| a.abs_diff(b) <= 2;
        assert!(bytes.iter().all(|[r, g, b, a]| near(*r, 200) && near(*g, 100) && near(*b, 50) && *a == 255));
    }

    #[test]
    fn deep_pictures_become_numbers() {
        let deep = image::ImageBuffer::from_pixel(1, 1, image::Luma([13107_u16]));
        let read = saved(&DynamicImage::ImageLuma16(deep), "a.png");
        assert_eq!(
            read.pixels,
            Pixels::Floats { values: vec![[0.2, 0.2, 0.2, 1.0]], half: false },
            "a fifth"
        );
    }

    #[test]
    fn damaged_files_are_refused_with_their_name() {
        let dir = tempfile::tempdir().expect("a directory");
        for (name, kind) in [("a.png", "PNG"), ("a.jpg", "JPEG")] {
            let path = dir.path().join(name);
            std::fs::write(&path, b"rubbish").expect("written");
            let message = read_raster(&path).expect_err("damaged").to_string();
            assert!(message.contains(&format!("{name}: not a sound {kind} picture")), "{message}");
        }
    }

    #[test]
    fn a_header_that_claims_more_than_the_file_holds_is_refused_before_memory_is_asked_for() {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.png");
        let mut sound = Vec::new();
        let picture = DynamicImage::ImageLuma8(image::GrayImage::new(1, 1));
        picture.write_to(&mut Cursor::new(&mut sound), image::ImageFormat::Png).expect("written");
        // Width and height stand behind the signature and the head of the first chunk, its checksum behind its 13 bytes.
        sound[16..20].copy_from_slice(&16000_u32.to_be_bytes());
        sound[20..24].copy_from_slice(&16000_u32.to_be_bytes());
        let crc = checksum(&sound[12..29]);
        sound[29..33].copy_from_slice(&crc.to_be_bytes());
        std::fs::write(&path, sound).expect("written");
        for message in [
            read_raster(&path).map(drop).expect_err("claims").to_string(),
            crate::image::read_gray(&path).map(drop).expect_err("claims").to_string(),
        ] {
            assert!(message.contains("claims more pixels than its bytes can hold"), "{message}");
        }
    }

    /// CRC-32 of a chunk's kind and bytes (PNG specification, annex D), bit by bit.
    fn checksum(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(u32::MAX, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1)))
        })
    }
}
