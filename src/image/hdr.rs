//! Radiance pictures (`.hdr`), reading only.
//!
//! The header's EXPOSURE is not applied, as in most renderers, but told. Ward, 1991, "Real pixels", in Graphics Gems II.

use std::fs::File;
use std::io::{BufReader, Read as _, Seek as _, SeekFrom};
use std::path::Path;

use image::codecs::hdr::HdrDecoder;

use super::buffer::{Repairs, check_size};
use super::{Decoded, Image, Range, Window, files};
use crate::error::{Place, Problem, Result};
use crate::math::Rgb;

/// The picture in a Radiance file.
pub(super) fn read(path: &Path) -> Result<Decoded> {
    const KIND: &str = "Radiance";
    let unread = |error| files::unread(path, error);
    let mut file = BufReader::new(File::open(path).map_err(unread)?);
    let strict = starts_with_radiance(&mut file).map_err(unread)?;
    let decoder =
        HdrDecoder::with_strictness(file, strict).map_err(|error| files::refused(path, KIND, error))?;
    let header = decoder.metadata();
    check_size(path, header.width.into(), header.height.into())?;
    let picture = files::decoded(path, KIND, decoder)?.into_rgb32f();
    let mut repairs = Repairs::default();
    let pixels = picture.pixels().map(|p| {
        let [r, g, b] = p.0.map(|x| repairs.finite(x));
        Rgb::new(r, g, b)
    });
    let image = Image::from_pixels(header.width, header.height, pixels.collect()).ok_or_else(|| {
        Problem::at(Place::file(path), "the decoder gave another number of pixels than it said")
    })?;
    let mut warnings = repairs.warnings(path);
    warnings.extend(header.exposure.filter(|e| (e - 1.0).abs() > 1e-6).map(|exposure| {
        Problem::at(Place::file(path), format!("an exposure of {exposure} in the header is not applied"))
            .remedy(format!("for the original radiance scale by {}", 1.0 / exposure))
    }));
    let window = Window::whole(header.width, header.height);
    let range = Range::Scene;
    Ok(Decoded { image, range, alpha: None, window, full: [header.width, header.height], warnings })
}

/// Whether the file starts as the standard says. Many start with `#?RGBE` instead, which only a lenient reader takes.
fn starts_with_radiance(file: &mut BufReader<File>) -> std::io::Result<bool> {
    let mut start = Vec::new();
    file.by_ref().take(6).read_to_end(&mut start)?;
    file.seek(SeekFrom::Start(0))?;
    Ok(start != *b"#?RGBE")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_bytes(bytes: &[u8]) -> Result<Decoded> {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.hdr");
        std::fs::write(&path, bytes).expect("written");
        read(&path)
    }

    /// Two pixels without run lengths: 2^(129 - 128) * 64/256 = 0.5 and black.
    fn file(header: &str) -> Vec<u8> {
        let mut bytes = format!("{header}\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n").into_bytes();
        bytes.extend([64, 128, 192, 129, 0, 0, 0, 0]);
        bytes
    }

    #[test]
    fn both_signatures_are_read() {
        for signature in ["#?RADIANCE", "#?RGBE"] {
            let picture = read_bytes(&file(signature)).expect("read");
            assert_eq!(picture.image.pixel(0, 0), Rgb::new(0.5, 1.0, 1.5), "{signature}");
            assert!(picture.warnings.is_empty(), "{:?}", picture.warnings);
        }
    }

    #[test]
    fn an_exposure_is_told() {
        let picture = read_bytes(&file("#?RADIANCE\nEXPOSURE=2")).expect("read");
        assert!(picture.warnings[0].to_string().contains("scale by 0.5"), "{:?}", picture.warnings);
    }

    #[test]
    fn damaged_files_are_refused() {
        let sound = file("#?RADIANCE");
        for length in 0..sound.len() {
            assert!(read_bytes(&sound[..length]).is_err(), "cut to {length}");
        }
        let huge = b"#?RADIANCE\n\n-Y 2000000000 +X 2000000000\nxxxxxxxx";
        let error = read_bytes(huge).expect_err("huge").to_string();
        assert!(error.contains("too large"), "{error}");
        assert!(read_bytes(b"#?RADIANCE\n\n-Y 0 +X 5\n").is_err(), "no pixels");
    }
}
