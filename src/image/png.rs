//! PNG: previews of 8 bits a channel written, pictures of any kind read.
//!
//! Bytes are encoded by sRGB, whatever a file says of gamma or colour profiles; a gamma that differs is told.

use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use image::{DynamicImage, ExtendedColorType, ImageDecoder as _, ImageEncoder as _};

use super::buffer::{check_claim, check_size};
use super::tone::{Development, linear_from_srgb};
use super::{Decoded, Image, Range, Window, atomic, files};
use crate::error::{Place, Problem, Result};
use crate::math::Rgb;
use crate::trust::{Limits, Trust};

/// Most pixels that one byte of a file can hold: one bit each, and deflate stays below 1032:1.
const MAX_PIXELS_PER_BYTE: u64 = 8 * 1032;

/// Writes a preview of `picture`, whole or not at all.
pub fn write(path: &Path, picture: &Image, development: Development) -> Result<()> {
    let bytes: Vec<u8> = picture.pixels().iter().flat_map(|&colour| development.bytes(colour)).collect();
    write_bytes(path, [picture.width(), picture.height()], &bytes)
}

/// Writes red, green and blue as they are, whole or not at all. There are three bytes for each pixel, by row from the top.
pub fn write_bytes(path: &Path, [width, height]: [u32; 2], bytes: &[u8]) -> Result<()> {
    atomic::write(path, |file| encode(file, [width, height], bytes))
}

/// Writes red, green and blue as a PNG file into something else than a file. There are three bytes for each pixel, by row from the top.
pub fn encode(into: impl io::Write, [width, height]: [u32; 2], bytes: &[u8]) -> io::Result<()> {
    PngEncoder::new_with_quality(into, CompressionType::Default, FilterType::Adaptive)
        .write_image(bytes, width, height, ExtendedColorType::Rgb8)
        .map_err(io::Error::other)
}

/// The picture in a PNG file of 1 to 16 bits, in colour, grey or with a palette, as linear light from 0 to 1.
pub fn read(path: &Path) -> Result<Decoded> {
    let trust = Trust::default();
    decode(&trust.read(path, files::UNREAD)?, path, &trust.limits)
}

/// The same of the bytes of a file; `path` is for messages.
pub fn decode(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Decoded> {
    let (picture, warnings) = decoded(bytes, path, limits)?;
    let has_alpha = picture.color().has_alpha();
    let picture = picture.into_rgba16();
    let (width, height) = picture.dimensions();
    let light = light();
    let pixels = picture.pixels().map(|p| {
        let [r, g, b, _] = p.0.map(|x| light[usize::from(x)]);
        Rgb::new(r, g, b)
    });
    let image = Image::from_pixels(width, height, pixels.collect()).ok_or_else(|| {
        Problem::at(Place::file(path), "the decoder gave another number of pixels than it said")
    })?;
    let alpha = has_alpha.then(|| picture.pixels().map(|p| f32::from(p.0[3]) / 65535.0).collect());
    let window = Window::whole(width, height);
    Ok(Decoded { image, range: Range::Display, alpha, window, full: [width, height], warnings })
}

/// The pixels of the bytes of a PNG file as it holds them, and what is odd about it. What its header claims is checked before memory is
/// asked for.
pub(super) fn decoded(bytes: &[u8], path: &Path, limits: &Limits) -> Result<(DynamicImage, Vec<Problem>)> {
    let gamma = stated_gamma(&mut Cursor::new(bytes)).unwrap_or(None);
    let decoder = PngDecoder::new(Cursor::new(bytes)).map_err(|error| files::refused(path, "PNG", error))?;
    let size = [decoder.dimensions().0, decoder.dimensions().1].map(u64::from);
    check_size(path, size, limits)?;
    check_claim(path, size, bytes.len(), MAX_PIXELS_PER_BYTE)?;
    let warnings = gamma.and_then(|gamma| odd_gamma(path, gamma)).into_iter().collect();
    Ok((files::decoded(path, "PNG", decoder)?, warnings))
}

/// The light of each of 65536 levels. Eight bits are exactly every 257th.
fn light() -> Vec<f32> {
    (0..=u16::MAX).map(|level| linear_from_srgb(f32::from(level) / 65535.0)).collect()
}

/// The gamma that a file states before its pixels, unless it also says that it is sRGB. The decoder keeps it to itself.
fn stated_gamma(file: &mut (impl Read + Seek)) -> io::Result<Option<f64>> {
    const SIGNATURE_BYTES: u64 = 8;
    const CHECKSUM_BYTES: i64 = 4;
    file.seek(SeekFrom::Start(SIGNATURE_BYTES))?;
    let mut gamma = None;
    loop {
        let (mut length, mut kind) = ([0; 4], [0; 4]);
        file.read_exact(&mut length)?;
        file.read_exact(&mut kind)?;
        let mut left = i64::from(u32::from_be_bytes(length));
        match &kind {
            b"gAMA" if left == 4 => {
                let mut value = [0; 4];
                file.read_exact(&mut value)?;
                gamma = Some(f64::from(u32::from_be_bytes(value)) / 1e5);
                left = 0;
            }
            b"sRGB" => return Ok(None),
            b"IDAT" | b"IEND" => return Ok(gamma),
            _ => {}
        }
        file.seek(SeekFrom::Current(left + CHECKSUM_BYTES))?;
    }
}

/// That a file's gamma is not the 1/2.2 which stands for sRGB.
fn odd_gamma(path: &Path, gamma: f64) -> Option<Problem> {
    let is_odd = (gamma - 1.0 / 2.2).abs() > 0.01;
    is_odd.then(|| {
        Problem::at(Place::file(path), format!("a gamma of {gamma} in the file is not applied"))
            .remedy("write it as sRGB")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::tone::Curve;
    use image::DynamicImage as Dynamic;

    fn temporary() -> (tempfile::TempDir, std::path::PathBuf) {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.png");
        (dir, path)
    }

    #[test]
    fn a_preview_comes_back_as_its_bytes() {
        let (_dir, path) = temporary();
        let mut picture = Image::new(3, 2);
        picture.set_pixel(1, 0, Rgb::new(0.5, 2.0, f32::NAN));
        let development = Development { exposure_ev: 0.0, curve: Curve::Clip };
        write(&path, &picture, development).expect("written");
        let back = image::open(&path).expect("a picture").to_rgb8();
        assert_eq!(back.dimensions(), (3, 2), "size");
        assert_eq!(back.get_pixel(1, 0).0, [188, 255, 0], "colour");
        assert_eq!(back.get_pixel(1, 1).0, [0, 0, 0], "black");
        let read = read(&path).expect("read");
        assert_eq!(development.bytes(read.image.pixel(1, 0)), [188, 255, 0], "read as light");
        assert_eq!((read.range, read.alpha, read.full), (Range::Display, None, [3, 2]), "about it");
    }

    #[test]
    fn all_kinds_of_pixels_are_read() {
        let (_dir, path) = temporary();
        let colour = Rgb::new(1.0, 0.0, linear_from_srgb(0.2));
        let grey = Rgb::gray(linear_from_srgb(0.2));
        let kinds = [
            (
                Dynamic::ImageRgb8(image::ImageBuffer::from_pixel(1, 1, image::Rgb([255, 0, 51]))),
                colour,
                None,
            ),
            (
                Dynamic::ImageRgba16(image::ImageBuffer::from_pixel(1, 1, image::Rgba([65535, 0, 13107, 0]))),
                colour,
                Some(0.0),
            ),
            (Dynamic::ImageLuma8(image::ImageBuffer::from_pixel(1, 1, image::Luma([51]))), grey, None),
            (Dynamic::ImageLuma16(image::ImageBuffer::from_pixel(1, 1, image::Luma([13107]))), grey, None),
            (
                Dynamic::ImageLumaA8(image::ImageBuffer::from_pixel(1, 1, image::LumaA([51, 255]))),
                grey,
                Some(1.0),
            ),
        ];
        for (picture, wanted, alpha) in kinds {
            picture.save(&path).expect("written");
            let read = read(&path).expect("read");
            assert_eq!(read.image.pixel(0, 0), wanted, "{:?}", picture.color());
            assert_eq!(read.alpha, alpha.map(|a| vec![a]), "{:?}", picture.color());
        }
    }

    /// Four pixels of two bits each, with a palette of black, red and grey 51, and a gamma of 1.
    const PALETTE: [u8; 104] = [
        0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
        0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x01, 0x02, 0x03, 0x00, 0x00, 0x00, 0x84, 0x52, 0xe7, 0x5e, 0x00,
        0x00, 0x00, 0x04, 0x67, 0x41, 0x4d, 0x41, 0x00, 0x01, 0x86, 0xa0, 0x31, 0xe8, 0x96, 0x5f, 0x00, 0x00,
        0x00, 0x09, 0x50, 0x4c, 0x54, 0x45, 0x00, 0x00, 0x00, 0xff, 0x00, 0x00, 0x33, 0x33, 0x33, 0x0a, 0x31,
        0x1d, 0xe3, 0x00, 0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x90, 0x04, 0x00, 0x00,
        0x1b, 0x00, 0x1a, 0x83, 0x5a, 0xf7, 0x20, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42,
        0x60, 0x82,
    ];

    #[test]
    fn palettes_are_looked_up_and_another_gamma_is_told() {
        let (_dir, path) = temporary();
        std::fs::write(&path, PALETTE).expect("written");
        let read = read(&path).expect("read");
        let wanted =
            [Rgb::BLACK, Rgb::new(1.0, 0.0, 0.0), Rgb::gray(linear_from_srgb(0.2)), Rgb::new(1.0, 0.0, 0.0)];
        assert_eq!(read.image.pixels(), wanted, "colours");
        assert!(
            read.warnings.len() == 1 && read.warnings[0].what.contains("gamma of 1 "),
            "{:?}",
            read.warnings
        );
    }

    #[test]
    fn damaged_files_are_refused_or_read_but_never_panic() {
        let (_dir, path) = temporary();
        for length in 0..PALETTE.len() - 12 {
            std::fs::write(&path, &PALETTE[..length]).expect("written");
            assert!(read(&path).is_err(), "cut to {length}");
        }
        let mut refused = 0;
        for position in 0..PALETTE.len() {
            let mut bytes = PALETTE;
            bytes[position] ^= 0xff;
            std::fs::write(&path, bytes).expect("written");
            refused += usize::from(read(&path).is_err());
        }
        assert!(refused > PALETTE.len() / 2, "only {refused} of {} flips were noticed", PALETTE.len());
    }

    #[test]
    fn a_few_bytes_that_claim_gigabytes_are_refused() {
        let (_dir, path) = temporary();
        let mut bytes = PALETTE;
        bytes[16..24].copy_from_slice(&[0, 0, 0x3f, 0xff, 0, 0, 0x3f, 0xff]);
        // The checksum of the header that now claims 16 383 by 16 383 pixels.
        bytes[29..33].copy_from_slice(&[166, 223, 130, 56]);
        std::fs::write(&path, bytes).expect("written");
        let error = read(&path).expect_err("refused").to_string();
        assert!(error.contains("claims more pixels"), "{error}");
    }
}
