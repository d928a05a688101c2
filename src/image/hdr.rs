//! Radiance pictures (`.hdr`), reading only.
//!
//! The header's EXPOSURE is not applied, as in most renderers, but told. Ward, 1991, "Real pixels", in Graphics Gems II.

use std::path::Path;

use image::codecs::hdr::HdrDecoder;

use super::buffer::{Repairs, check_claim, check_size};
use super::{Decoded, Image, Range, Window, files};
use crate::error::{Place, Problem, Result};
use crate::math::Rgb;
use crate::trust::Limits;

/// Most pixels that one byte of a file can hold: runs end with rows, whose ends take four bytes, and hold up to 65536 pixels of equal colour.
const MAX_PIXELS_PER_BYTE: u64 = 65536 / 4;

/// The picture in the bytes of a Radiance file; `path` is for messages.
pub(super) fn decode(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Decoded> {
    const KIND: &str = "Radiance";
    // Many start with `#?RGBE` instead of what the standard says, which only a lenient reader takes.
    let strict = !bytes.starts_with(b"#?RGBE");
    let decoder =
        HdrDecoder::with_strictness(bytes, strict).map_err(|error| files::refused(path, KIND, error))?;
    let header = decoder.metadata();
    let size = [header.width, header.height].map(u64::from);
    check_size(path, size, limits)?;
    check_claim(path, size, bytes.len(), MAX_PIXELS_PER_BYTE)?;
    check_claim(path, [1, size[1]], bytes.len(), 1)?;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn read_bytes(bytes: &[u8]) -> Result<Decoded> {
        decode(bytes, Path::new("a.hdr"), &Limits::default())
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
