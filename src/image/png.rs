//! The preview: 8 bits a channel, sRGB, no alpha.

use std::io;
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _};

use super::tone::Development;
use super::{Image, atomic};
use crate::error::Result;

/// Writes a preview of `picture`, whole or not at all.
pub fn write(path: &Path, picture: &Image, development: Development) -> Result<()> {
    let bytes: Vec<u8> = picture.pixels().iter().flat_map(|&colour| development.bytes(colour)).collect();
    atomic::write(path, |file| {
        PngEncoder::new_with_quality(file, CompressionType::Default, FilterType::Adaptive)
            .write_image(&bytes, picture.width(), picture.height(), ExtendedColorType::Rgb8)
            .map_err(io::Error::other)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::tone::Curve;
    use crate::math::Rgb;

    #[test]
    fn a_preview_comes_back_as_its_bytes() {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.png");
        let mut picture = Image::new(3, 2);
        picture.set_pixel(1, 0, Rgb::new(0.5, 2.0, f32::NAN));
        write(&path, &picture, Development { exposure_ev: 0.0, curve: Curve::Clip }).expect("written");
        let back = image::open(&path).expect("a picture").to_rgb8();
        assert_eq!(back.dimensions(), (3, 2), "size");
        assert_eq!(back.get_pixel(1, 0).0, [188, 255, 0], "colour");
        assert_eq!(back.get_pixel(1, 1).0, [0, 0, 0], "black");
    }
}
