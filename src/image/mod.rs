//! Pixels, colour, and the files that hold them.
//!
//! Colour is linear Rec.709 everywhere except in the bytes of a PNG. Rows run from the top, pixels from the left.
//! Files that come in are not trusted: what they claim is checked before memory is asked for, and no NaN passes.

pub mod atomic;
mod buffer;
pub mod exr;
mod files;
mod gray;
mod hdr;
pub mod png;
mod raster;
pub mod tone;

use std::path::Path;

pub use buffer::{Image, Window};
pub use gray::{Gray, decode_gray, read_gray, read_gray_within};
pub use raster::{Pixels, RASTERS, Raster, decode_raster, read_raster, read_raster_within};

use crate::error::{Place, Problem, Result};
use crate::trust::{Limits, Trust};

/// What kind of file a picture is written to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Scene-linear OpenEXR with any channels.
    Exr,
    /// An 8-bit sRGB preview.
    Png,
}

impl Format {
    /// The format that the extension of `path` names; a [`Problem`] for any but the two there are.
    pub fn of(path: &Path) -> Result<Self> {
        match extension(path).as_str() {
            "exr" => Ok(Self::Exr),
            "png" => Ok(Self::Png),
            "" => Err(Problem::new(format!("`{}` has no extension to choose a format by", path.display()))
                .remedy("end the name in .exr or .png")
                .into()),
            other => {
                Err(Problem::new(format!("cannot write `{}`: unknown format `.{other}`", path.display()))
                    .remedy("end the name in .exr or .png")
                    .into())
            }
        }
    }
}

/// What the numbers of a picture stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Range {
    /// Light of a scene, without an upper end.
    Scene,
    /// What a display shows, from 0 for its black to 1 for its white.
    Display,
}

/// A colour picture read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Decoded {
    /// Linear colour, all of it finite unless [`read_as_stored`] says otherwise.
    pub image: Image,
    /// What it stands for.
    pub range: Range,
    /// Coverage in [0, 1] by row, where the file has it.
    pub alpha: Option<Vec<f32>>,
    /// Where `image` lies in the whole picture: all of it, unless the file holds a crop.
    pub window: Window,
    /// Width and height of the whole picture.
    pub full: [u32; 2],
    /// What was odd about the file, and what was made of it.
    pub warnings: Vec<Problem>,
}

/// As if a file held that picture, whole, of a scene's light.
impl From<Image> for Decoded {
    fn from(image: Image) -> Self {
        let full = [image.width(), image.height()];
        let window = Window::whole(full[0], full[1]);
        Self { image, range: Range::Scene, alpha: None, window, full, warnings: Vec::new() }
    }
}

/// The colour picture in an `.exr` or `.hdr` file, within the usual limits.
pub fn read(path: &Path) -> Result<Decoded> {
    read_within(path, &Trust::default())
}

/// The colour picture in an `.exr` or `.hdr` file that is trusted so far.
pub fn read_within(path: &Path, trust: &Trust) -> Result<Decoded> {
    known(path, &["exr", "hdr"])?;
    decode(&trust.read(path, files::UNREAD)?, path, &trust.limits)
}

/// The same as the display window of an `.exr` file shows it: black where there are no data, and without those that lie beyond.
pub fn read_shown_within(path: &Path, trust: &Trust) -> Result<Decoded> {
    let kind = known(path, &["exr", "hdr"])?;
    let bytes = trust.read(path, files::UNREAD)?;
    if kind != "exr" {
        return hdr::decode(&bytes, path, &trust.limits);
    }
    let (picture, as_colour) = exr::decode_shown(&bytes, path, &trust.limits)?;
    let mut decoded = picture.into_decoded(path)?;
    decoded.warnings.extend(as_colour);
    Ok(decoded)
}

/// The colour picture in the bytes of an `.exr` or `.hdr` file; `name` tells which, and is for messages.
pub fn decode(bytes: &[u8], name: &Path, limits: &Limits) -> Result<Decoded> {
    match known(name, &["exr", "hdr"])? {
        "exr" => exr::decode(bytes, name, limits)?.into_decoded(name),
        // The only other one.
        _ => hdr::decode(bytes, name, limits),
    }
}

/// The colour picture in an `.exr`, `.hdr` or `.png` file with its numbers as they are, finite or not: for those who judge
/// a file rather than use it.
pub fn read_as_stored(path: &Path, trust: &Trust) -> Result<Decoded> {
    let kind = known(path, &["exr", "hdr", "png"])?;
    let bytes = trust.read(path, files::UNREAD)?;
    match kind {
        "exr" => exr::decode(&bytes, path, &trust.limits)?.into_stored(path),
        // The format has no way to write a number that is not finite.
        "hdr" => hdr::decode(&bytes, path, &trust.limits),
        _ => png::decode(&bytes, path, &trust.limits),
    }
}

/// Which of some kinds of files it is by its extension; a [`Problem`] if it is none of them.
fn known(path: &Path, kinds: &[&'static str]) -> Result<&'static str> {
    let extension = extension(path);
    kinds.iter().copied().find(|&kind| kind == extension).ok_or_else(|| {
        let (last, others) = kinds.split_last().unwrap_or((&"", &[]));
        let others: Vec<String> = others.iter().map(|kind| format!(".{kind}")).collect();
        let article = if kinds.first() == Some(&"exr") { "an" } else { "a" };
        Problem::at(Place::file(path), "not a picture that can be read")
            .remedy(format!("use {article} {} or .{last} file", others.join(", ")))
            .into()
    })
}

/// The extension of a file name in lower case, empty where there is none.
fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_choose_formats_in_any_case() {
        assert_eq!(Format::of(Path::new("a.EXR")).ok(), Some(Format::Exr), "upper case");
        assert_eq!(Format::of(Path::new("dir.exr/a.png")).ok(), Some(Format::Png), "the last extension");
    }

    #[test]
    fn other_extensions_are_refused_with_both_names() {
        for name in ["a.jpg", "a", ".exr", "a.exr.gz"] {
            let message = Format::of(Path::new(name)).expect_err(name).to_string();
            assert!(message.contains(".exr or .png") && message.contains(name), "{message}");
        }
        let message = read(Path::new("a.jpg")).expect_err("not there").to_string();
        assert!(message.contains(".exr or .hdr"), "{message}");
    }

    #[test]
    fn pictures_by_other_programs_are_read() {
        let data = std::env::var_os("SPECULA_DATA")
            .map_or_else(|| "../shared/data".into(), std::path::PathBuf::from);
        let Ok(files) = std::fs::read_dir(data.join("env")) else {
            eprintln!("skipped: no pictures in {}", data.display());
            return;
        };
        for path in files.map(|file| file.expect("an entry").path()) {
            if !matches!(extension(&path).as_str(), "exr" | "hdr") {
                continue;
            }
            let picture = read(&path).unwrap_or_else(|error| panic!("{error}"));
            let mean = picture.image.pixels().iter().map(|p| f64::from(p.luminance())).sum::<f64>()
                / f64::from(picture.image.width() * picture.image.height());
            assert!((1e-3..1e4).contains(&mean), "{}: mean luminance {mean}", path.display());
        }
    }
}
