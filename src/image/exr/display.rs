//! What a picture shows: its display window, which programs that crop a file to what is not empty leave as it was.

use std::path::Path;

use super::read::check_bytes;
use super::{Channel, Picture, Samples};
use crate::error::Result;
use crate::image::Window;
use crate::image::buffer::check_size;
use crate::trust::Limits;

/// The part `display` of the whole picture as a picture of its own: zeros where there are no data, which are cut where they lie beyond.
pub(super) fn shown(picture: Picture, display: Window, (path, limits): (&Path, &Limits)) -> Result<Picture> {
    if picture.window == display {
        return Ok(picture);
    }
    let [width, height] = [display.width(), display.height()];
    let size = [width, height].map(u64::from);
    check_size(path, size, limits)?;
    let pixel: u64 = picture.channels.iter().map(|channel| bytes(&channel.samples)).sum();
    check_bytes(path, (size[0] * size[1]).saturating_mul(pixel), limits)?;
    let Picture { window, channels, attributes, warnings, .. } = picture;
    let channels = channels.into_iter().map(|Channel { name, samples }| {
        let samples = match samples {
            Samples::Half(values) => Samples::Half(framed(&values, window, display)),
            Samples::Float(values) => Samples::Float(framed(&values, window, display)),
            Samples::Uint(values) => Samples::Uint(framed(&values, window, display)),
        };
        Channel { name, samples }
    });
    let channels = channels.collect();
    Ok(Picture {
        full: [width, height],
        window: Window::whole(width, height),
        channels,
        attributes,
        warnings,
    })
}

/// Bytes of each sample in a file.
const fn bytes(samples: &Samples) -> u64 {
    match samples {
        Samples::Half(_) => 2,
        Samples::Float(_) | Samples::Uint(_) => 4,
    }
}

/// The numbers of a frame, of those of the window `data`.
fn framed<T: Copy + Default>(values: &[T], data: Window, frame: Window) -> Vec<T> {
    let mut framed = vec![T::default(); frame.area()];
    let both = Window {
        x0: data.x0.max(frame.x0),
        y0: data.y0.max(frame.y0),
        x1: data.x1.min(frame.x1),
        y1: data.y1.min(frame.y1),
    };
    if both.is_empty() {
        return framed;
    }
    let start = |of: Window, y: u32| (y - of.y0) as usize * of.width() as usize + (both.x0 - of.x0) as usize;
    let width = both.width() as usize;
    for y in both.y0..both.y1 {
        let (from, to) = (start(data, y), start(frame, y));
        framed[to..to + width].copy_from_slice(&values[from..from + width]);
    }
    framed
}
