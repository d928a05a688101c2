//! Pictures of one number per pixel, such as heights; reading only.

use std::path::Path;

use super::exr::Picture;
use super::{exr, files, hdr, known, png};
use crate::error::{Place, Problem, Result};
use crate::trust::{Limits, Trust};

/// One number per pixel, by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Gray {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// From 0 for black to 1 for white in a PNG, whose numbers are taken as they are, without a tone curve; any number in
    /// EXR and HDR files, those of an EXR not even checked to be finite, and zero where its display window has no data.
    pub values: Vec<f32>,
}

/// Extensions of the files that [`read_gray`] reads.
const KINDS: [&str; 3] = ["exr", "hdr", "png"];

/// The numbers in a `.png`, `.exr` or `.hdr` file, within the usual limits. Colours are refused, unless they are grays; coverage is ignored.
pub fn read_gray(path: &Path) -> Result<Gray> {
    read_gray_within(path, &Trust::default())
}

/// The same of a file that is trusted so far.
pub fn read_gray_within(path: &Path, trust: &Trust) -> Result<Gray> {
    known(path, &KINDS)?;
    decode_gray(&trust.read(path, files::UNREAD)?, path, &trust.limits)
}

/// The same of the bytes of a file; `path` tells of which kind, and is for messages.
pub fn decode_gray(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Gray> {
    let (width, height, values): Numbers = match known(path, &KINDS)? {
        "png" => from_png(bytes, path, limits)?,
        "exr" => from_exr(exr::decode_shown(bytes, path, limits)?.0),
        _ => {
            let image = hdr::decode(bytes, path, limits)?.image;
            let values = image.pixels().iter().map(|p| gray([p.r, p.g, p.b])).collect();
            (image.width(), image.height(), values)
        }
    };
    let Some(values) = values else {
        let problem =
            Problem::at(Place::file(path), "a colour picture, where one number per pixel is needed");
        return Err(problem.remedy("save it in shades of gray").into());
    };
    Ok(Gray { width, height, values })
}

/// Width, height and numbers; none of these where there are colours.
type Numbers = (u32, u32, Option<Vec<f32>>);

fn gray([r, g, b]: [f32; 3]) -> Option<f32> {
    let same = r.to_bits() == g.to_bits() && g.to_bits() == b.to_bits();
    same.then_some(r)
}

fn from_png(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Numbers> {
    // 16 bits hold what 8 bits say exactly, as 257 times as much. Numbers are taken as they are, whatever the file says of gamma.
    let picture = png::decoded(bytes, path, limits)?.0.into_rgb16();
    let values = picture.pixels().map(|p| gray(p.0.map(|x| f32::from(x) / 65535.0))).collect();
    Ok((picture.width(), picture.height(), values))
}

/// R, G and B if they are the same; else Y; else the only channel there is, whatever its name.
fn from_exr(picture: Picture) -> Numbers {
    let channel = |name: &str| picture.channel(name).map(exr::Samples::to_f32);
    let values = match (channel("R"), channel("G"), channel("B")) {
        (Some(r), Some(g), Some(b)) => {
            r.into_iter().zip(g).zip(b).map(|((r, g), b)| gray([r, g, b])).collect()
        }
        _ => channel("Y").or_else(|| match picture.channels.as_slice() {
            [only] => Some(only.samples.to_f32()),
            _ => None,
        }),
    };
    (picture.window.width(), picture.window.height(), values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Window;
    use crate::image::exr::{Channel, Samples};
    use image::{DynamicImage, ImageBuffer, Luma, Rgb};

    fn saved(picture: &DynamicImage) -> Result<Gray> {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.png");
        picture.save(&path).expect("written");
        read_gray(&path)
    }

    #[test]
    fn png_files_of_both_depths_keep_every_bit() {
        let deep = ImageBuffer::from_fn(3, 2, |x, y| Luma([u16::try_from(x * 1000 + y).expect("small")]));
        let read = saved(&DynamicImage::ImageLuma16(deep)).expect("read");
        assert_eq!((read.width, read.height), (3, 2), "size");
        let expected: Vec<f32> = [0.0, 1000.0, 2000.0, 1.0, 1001.0, 2001.0].map(|x| x / 65535.0).to_vec();
        assert_eq!(read.values, expected, "16 bits");
        let shallow = ImageBuffer::from_fn(2, 1, |x, _| Luma([if x == 0 { 51_u8 } else { 255 }]));
        assert_eq!(saved(&DynamicImage::ImageLuma8(shallow)).expect("read").values, [0.2, 1.0], "8 bits");
    }

    #[test]
    fn colours_are_refused_and_grays_in_three_channels_are_not() {
        let colour = ImageBuffer::from_pixel(2, 2, Rgb([1_u8, 2, 3]));
        let message = saved(&DynamicImage::ImageRgb8(colour)).expect_err("colour").to_string();
        assert!(message.contains("save it in shades of gray"), "{message}");
        let plain = ImageBuffer::from_pixel(2, 2, Rgb([255_u8; 3]));
        assert_eq!(saved(&DynamicImage::ImageRgb8(plain)).expect("gray").values, [1.0; 4], "three alike");
    }

    #[test]
    fn a_lone_channel_of_an_exr_is_taken_whatever_its_name() {
        let channel = |name: &str| Channel { name: name.into(), samples: Samples::Float(vec![-1.0, 2.5]) };
        let picture = |channels| Picture {
            full: [2, 1],
            window: Window::whole(2, 1),
            channels,
            attributes: vec![],
            warnings: vec![],
        };
        assert_eq!(from_exr(picture(vec![channel("height")])).2, Some(vec![-1.0, 2.5]), "one");
        assert_eq!(from_exr(picture(vec![channel("a"), channel("b")])).2, None, "which of two?");
        let rgb = ["R", "G", "B"].map(channel).to_vec();
        assert_eq!(from_exr(picture(rgb)).2, Some(vec![-1.0, 2.5]), "three alike");
    }

    #[test]
    fn damaged_files_are_refused_with_their_name() {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.png");
        std::fs::write(&path, b"\x89PNG\r\n\x1a\nrubbish").expect("written");
        let message = read_gray(&path).expect_err("damaged").to_string();
        assert!(message.contains("a.png: not a sound PNG picture"), "{message}");
    }
}
