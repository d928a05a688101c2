//! Writing.

use std::io;
use std::path::Path;

use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, Chromaticities, IntegerBounds, Text};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{WritableImage as _, f16};

use super::{Picture, Samples};
use crate::error::{Problem, Result};
use crate::image::atomic;

/// Writes `picture`, whole or not at all. The result says what of it the file could not hold.
pub fn write(path: &Path, picture: Picture) -> Result<Vec<Problem>> {
    check(path, &picture)?;
    let mut cut = 0_u64;
    let (width, height) = (picture.window.width() as usize, picture.window.height() as usize);
    let channels = picture.channels.into_iter().map(|channel| {
        let samples = match channel.samples {
            Samples::Half(values) => FlatSamples::F16(values.iter().map(|&x| half(x, &mut cut)).collect()),
            Samples::Float(values) => FlatSamples::F32(values),
            Samples::Uint(values) => FlatSamples::U32(values),
        };
        AnyChannel::new(text(&channel.name), samples)
    });
    let channels = AnyChannels::sort(channels.collect());
    let layer = Layer::new(
        (width, height),
        LayerAttributes {
            layer_position: Vec2(signed(picture.window.x0), signed(picture.window.y0)),
            software_name: Some(text("specula")),
            other: picture
                .attributes
                .iter()
                .map(|(key, value)| (text(key), AttributeValue::Text(text(value))))
                .collect(),
            ..LayerAttributes::default()
        },
        Encoding::SMALL_LOSSLESS,
        channels,
    );
    let [width, height] = picture.full.map(|n| n as usize);
    let attributes = ImageAttributes {
        chromaticities: Some(REC_709),
        ..ImageAttributes::new(IntegerBounds::from_dimensions((width, height)))
    };
    let image = Image::new(attributes, layer);
    atomic::write(path, |file| image.write().to_buffered(file).map_err(plain))?;
    Ok(warnings(path, cut))
}

/// Primaries and white of ITU-R BT.709.
pub(super) const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// Refuses what a file cannot hold.
fn check(path: &Path, picture: &Picture) -> Result<()> {
    let refuse =
        |what: String| Err(Problem::new(format!("cannot write `{}`: {what}", path.display())).into());
    let window = picture.window;
    if window.is_empty() || !window.fits(picture.full[0], picture.full[1]) {
        let [width, height] = picture.full;
        return refuse(format!(
            "the window {window:?} is not part of a picture of {width} by {height} pixels"
        ));
    }
    if picture.channels.is_empty() {
        return refuse("it has no channel".to_owned());
    }
    for (i, channel) in picture.channels.iter().enumerate() {
        if channel.samples.len() != window.area() {
            let (there, wanted) = (channel.samples.len(), window.area());
            return refuse(format!("channel `{}` has {there} samples for {wanted} pixels", channel.name));
        }
        if picture.channels[..i].iter().any(|other| other.name == channel.name) {
            return refuse(format!("two channels are called `{}`", channel.name));
        }
    }
    let mut names =
        picture.channels.iter().map(|c| &c.name).chain(picture.attributes.iter().map(|(key, _)| key));
    match names.find(|name| name.is_empty() || name.len() > 255 || name.contains('\0')) {
        Some(name) => refuse(format!("`{name}` is not a name of 1 to 255 bytes")),
        None => Ok(()),
    }
}

fn warnings(path: &Path, cut: u64) -> Vec<Problem> {
    let told = || {
        Problem::new(format!("`{}`: {cut} values beyond 65504 were cut to it", path.display()))
            .remedy("write full floats for this picture")
    };
    (cut > 0).then(told).into_iter().collect()
}

/// The nearest half; finite values beyond the largest are cut to it and counted.
fn half(x: f32, cut: &mut u64) -> f16 {
    let y = f16::from_f32(x);
    if y.is_infinite() && x.is_finite() {
        *cut += 1;
        return f16::MAX.copysign(y);
    }
    y
}

/// UTF-8 bytes as they are.
fn text(s: &str) -> Text {
    Text::from_slice_unchecked(s.as_bytes())
}

/// Sizes and positions are far below 2^31.
fn signed(n: u32) -> i32 {
    i32::try_from(n).unwrap_or(i32::MAX)
}

/// The error of the operating system, where there is one.
fn plain(error: exr::error::Error) -> io::Error {
    match error {
        exr::error::Error::Io(error) => error,
        other => io::Error::other(other),
    }
}
