//! Files that pictures come from, and what is said where decoders refuse them.

use std::io;
use std::path::Path;

use image::{DynamicImage, ImageDecoder, ImageError};

use crate::error::{Error, Place, Problem, Result};

/// What is said where a file cannot be read.
pub(super) const UNREAD: &str = "cannot read";

/// That a file cannot be read.
fn unread(path: &Path, source: io::Error) -> Error {
    Error::Io { path: path.to_owned(), what: UNREAD, source }
}

/// That a file is not what it should be, or that it cannot be read.
pub(super) fn refused(path: &Path, kind: &str, error: ImageError) -> Error {
    match error {
        ImageError::IoError(source)
            if !matches!(source.kind(), io::ErrorKind::UnexpectedEof | io::ErrorKind::InvalidData) =>
        {
            unread(path, source)
        }
        other => Problem::at(Place::file(path), format!("not a sound {kind} picture: {other}"))
            .remedy("write it again, or convert it to .exr")
            .into(),
    }
}

/// The picture that a decoder gives.
pub(super) fn decoded(path: &Path, kind: &str, decoder: impl ImageDecoder) -> Result<DynamicImage> {
    DynamicImage::from_decoder(decoder).map_err(|error| refused(path, kind, error))
}
