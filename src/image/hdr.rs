//! Radiance pictures (`.hdr`), reading only.
//!
//! The header's EXPOSURE is not applied, as in most renderers, but told. Ward, 1991, "Real pixels", in Graphics Gems II.

use std::io::{self, Read};
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
    let decoder = HdrDecoder::with_strictness(Guarded { bytes, markers: 0 }, strict)
        .map_err(|error| files::refused(path, KIND, error))?;
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

/// Most pixels in a row that stand for runs in the older way of the format. Each counts 256 times what the one before does, and the eighth
/// is more than the decoder (image 0.25) can count.
const MOST_MARKERS: u32 = 7;

/// The bytes of a file for a decoder that reads pixels by four.
struct Guarded<'a> {
    bytes: &'a [u8],
    /// How many pixels that stand for runs there were just now.
    markers: u32,
}

impl Read for Guarded<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let read = self.bytes.read(into)?;
        let is_marker = read == 4 && matches!(into, [1, 1, 1, _]);
        self.markers = if is_marker { self.markers + 1 } else { 0 };
        if self.markers > MOST_MARKERS {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a run without an end"));
        }
        Ok(read)
    }
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
    fn older_runs_are_read_and_endless_ones_refused() {
        let file = |width: u32, pixels: &[[u8; 4]]| {
            let mut bytes = format!("#?RADIANCE\n\n-Y 1 +X {width}\n").into_bytes();
            bytes.extend(pixels.iter().flatten());
            read_bytes(&bytes)
        };
        let (pixel, run) = ([64, 128, 192, 129], |length| [1, 1, 1, length]);
        // 2 + 1 * 256 pixels more.
        let picture = file(259, &[pixel, run(2), run(1)]).expect("read").image;
        assert!(picture.pixels().iter().all(|p| *p == Rgb::new(0.5, 1.0, 1.5)), "a run of 258");
        let endless = [vec![pixel], vec![run(0); 12], vec![run(8)]].concat();
        let error = file(9, &endless).expect_err("endless").to_string();
        assert!(error.contains("not a sound Radiance picture: a run without an end"), "{error}");
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
