//! Reading.

use std::fs::File;
use std::io::{BufReader, Cursor, Read};
use std::path::Path;

use exr::image::read::read as reader;
use exr::image::{AnyChannels, FlatSamples, Layer};
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Chromaticities, IntegerBounds, SampleType};
use exr::meta::header::{Header, LayerAttributes};
use exr::prelude::{ReadChannels as _, ReadLayers as _};

use super::write::REC_709;
use super::{Channel, Picture, Samples, display};
use crate::error::{Error, Place, Problem, Result};
use crate::image::buffer::check_size;
use crate::image::{Window, files};
use crate::trust::{Limit, Limits, Trust};

/// Bytes that the samples of a file may take for each pixel that a picture may have: four float channels of the largest.
const BYTES_PER_TEXEL: u64 = 16;

/// No compression of the format packs tighter than this (deflate stays below 1032:1), so a file of a few bytes that
/// claims gigabytes is refused before they are allocated.
const MAX_RATIO: u64 = 4096;

/// Bytes of samples that are decoded before threads have started.
const FEW_BYTES: u64 = 1 << 22;

/// All flat parts of an EXR file that share the first part's window, within the usual limits.
pub fn read(path: &Path) -> Result<Picture> {
    read_within(path, &Trust::default())
}

/// The same of a file that is trusted so far.
pub fn read_within(path: &Path, trust: &Trust) -> Result<Picture> {
    decode(&trust.read(path, files::UNREAD)?, path, &trust.limits)
}

/// The same of the bytes of a file; `path` is for messages.
pub fn decode(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Picture> {
    let Contents { mut picture, as_colour, .. } = contents(bytes, path, limits)?;
    picture.warnings.extend(as_colour);
    Ok(picture)
}

/// The same as its display window shows it, zero where there are no data; and what is odd about it where its numbers are taken for colour.
pub(in crate::image) fn decode_shown(
    bytes: &[u8],
    path: &Path,
    limits: &Limits,
) -> Result<(Picture, Vec<Problem>)> {
    let Contents { picture, display, as_colour } = contents(bytes, path, limits)?;
    Ok((display::shown(picture, display, (path, limits))?, as_colour.into_iter().collect()))
}

/// What is in a file.
struct Contents {
    picture: Picture,
    /// The display window in the whole picture.
    display: Window,
    /// What is odd where numbers are taken for colour.
    as_colour: Option<Problem>,
}

fn contents(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Contents> {
    let claimed = check((bytes, path), &headers(path, Cursor::new(bytes))?, limits)?;
    let reader =
        reader().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let reader = if claimed < FEW_BYTES { reader.non_parallel() } else { reader };
    let file = reader.from_buffered(Cursor::new(bytes)).map_err(|e| refused(path, &e))?;
    let mut warnings = Vec::new();
    let mut layers = file.layer_data.into_iter();
    let Some(first) = layers.next() else {
        return Err(Problem::at(Place::file(path), "there is no picture in it").into());
    };
    let (full, [window, display]) = place(first.absolute_bounds(), file.attributes.display_window);
    let mut attributes = texts(&first);
    attributes.sort();
    let bounds = first.absolute_bounds();
    let mut channels = named(first, false);
    for layer in layers {
        if layer.absolute_bounds() == bounds {
            channels.extend(named(layer, true));
        } else {
            let name = layer.attributes.layer_name.map(|n| n.to_string()).unwrap_or_default();
            let what = format!("part `{name}` has another window than the first and was left out");
            warnings.push(Problem::at(Place::file(path), what));
        }
    }
    let as_colour = odd_primaries(path, file.attributes.chromaticities);
    let picture = Picture { full, window, channels, attributes, warnings };
    Ok(Contents { picture, display, as_colour })
}

/// What a file says of one channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelInfo {
    /// The part it is in, where parts have names.
    pub part: Option<String>,
    /// The name as stored.
    pub name: String,
    /// Bits of each sample.
    pub bits: u8,
    /// Floating point, not integer.
    pub is_float: bool,
}

/// The channels of an EXR file, read from its header alone.
pub fn channels(path: &Path) -> Result<Vec<ChannelInfo>> {
    let headers = headers_of(path)?;
    let infos = headers.iter().flat_map(|header| {
        header.channels.list.iter().map(|channel| ChannelInfo {
            part: header.own_attributes.layer_name.as_ref().map(ToString::to_string),
            name: channel.name.to_string(),
            bits: if channel.sample_type == SampleType::F16 { 16 } else { 32 },
            is_float: channel.sample_type != SampleType::U32,
        })
    });
    Ok(infos.collect())
}

/// The metadata of an EXR file that are text, read from its header alone.
pub fn attributes(path: &Path) -> Result<Vec<(String, String)>> {
    Ok(headers_of(path)?.first().map(|header| texts_of(&header.own_attributes)).unwrap_or_default())
}

/// What a file says before its samples, of which none is read.
fn headers_of(path: &Path) -> Result<Vec<Header>> {
    let io = |source| Error::Io { path: path.to_owned(), what: files::UNREAD, source };
    headers(path, BufReader::new(File::open(path).map_err(io)?))
}

fn headers(path: &Path, from: impl Read) -> Result<Vec<Header>> {
    let meta = MetaData::read_from_buffered(from, false).map_err(|e| refused(path, &e))?;
    Ok(meta.headers.into_vec())
}

/// How many bytes samples take. Refuses what cannot be read, and what claims more than its bytes can hold.
fn check((bytes, path): (&[u8], &Path), headers: &[Header], limits: &Limits) -> Result<u64> {
    let refuse = |what: &str, remedy: &str| Err(Problem::at(Place::file(path), what).remedy(remedy).into());
    let mut claimed = 0_u64;
    for header in headers {
        if header.deep {
            return refuse("a deep picture", "flatten it first");
        }
        let channels = &header.channels.list;
        if channels.iter().any(|channel| channel.sampling.0 != 1 || channel.sampling.1 != 1) {
            return refuse("a picture with subsampled channels", "write it as R, G and B");
        }
        let (width, height) = (header.layer_size.0 as u64, header.layer_size.1 as u64);
        check_size(path, [width, height], limits)?;
        let pixel: u64 = channels.iter().map(|c| c.sample_type.bytes_per_sample() as u64).sum();
        claimed = claimed.saturating_add((width * height).saturating_mul(pixel));
    }
    check_bytes(path, claimed, limits)?;
    if claimed / MAX_RATIO > bytes.len() as u64 {
        return refuse("its header claims more pixels than its bytes can hold", "write it again");
    }
    Ok(claimed)
}

/// Refuses samples that take more bytes than are allowed.
pub(super) fn check_bytes(path: &Path, bytes: u64, limits: &Limits) -> Result<()> {
    limits.check(Limit::Texels, bytes / BYTES_PER_TEXEL).map_err(|excess| {
        let what = format!("its samples take {bytes} bytes, as many as four channels of {excess}");
        Error::Refused(Problem::at(Place::file(path), what).remedy(excess.remedy()))
    })
}

/// Whole size of a data window and a display window, and where both lie in it. Data beyond the display window enlarge the whole; where
/// it starts elsewhere than at the origin everything moves along.
fn place(data: IntegerBounds, display: IntegerBounds) -> ([u32; 2], [Window; 2]) {
    let axis = |starts: [i32; 2], sizes: [usize; 2]| {
        let origin = i64::from(starts[0].min(starts[1]));
        [0, 1].map(|i| {
            let start = u32::try_from(i64::from(starts[i]) - origin).unwrap_or(u32::MAX);
            (start, start.saturating_add(u32::try_from(sizes[i]).unwrap_or(u32::MAX)))
        })
    };
    let xs = axis([data.position.0, display.position.0], [data.size.0, display.size.0]);
    let ys = axis([data.position.1, display.position.1], [data.size.1, display.size.1]);
    let windows = [0, 1].map(|i| Window { x0: xs[i].0, y0: ys[i].0, x1: xs[i].1, y1: ys[i].1 });
    let [data, display] = windows;
    ([data.x1.max(display.x1), data.y1.max(display.y1)], windows)
}

/// That the primaries or the white that a file states are not those of Rec.709.
fn odd_primaries(path: &Path, stated: Option<Chromaticities>) -> Option<Problem> {
    const TOLERANCE: f32 = 1e-3;
    let of = |it: Chromaticities| [it.red, it.green, it.blue, it.white];
    let near =
        |(a, b): (Vec2<f32>, Vec2<f32>)| (a.0 - b.0).abs() <= TOLERANCE && (a.1 - b.1).abs() <= TOLERANCE;
    let is_odd = !of(stated?).into_iter().zip(of(REC_709)).all(near);
    is_odd.then(|| {
        let what = "chromaticities other than those of Rec.709 in the file are not applied";
        Problem::at(Place::file(path), what).remedy("convert it to linear Rec.709")
    })
}

/// The channels of a part, with the part's name before theirs where `prefixed` and it has one.
fn named(layer: Layer<AnyChannels<FlatSamples>>, prefixed: bool) -> Vec<Channel> {
    let part = layer.attributes.layer_name.filter(|_| prefixed).map(|name| name.to_string());
    let channels = layer.channel_data.list.into_iter().map(|channel| {
        let own = channel.name.to_string();
        let name = match &part {
            Some(part) if !own.starts_with(part.as_str()) => format!("{part}.{own}"),
            _ => own,
        };
        let samples = match channel.sample_data {
            FlatSamples::F16(values) => Samples::Half(values.into_iter().map(|x| x.to_f32()).collect()),
            FlatSamples::F32(values) => Samples::Float(values),
            FlatSamples::U32(values) => Samples::Uint(values),
        };
        Channel { name, samples }
    });
    channels.collect()
}

/// The metadata of a part that are text.
fn texts(layer: &Layer<AnyChannels<FlatSamples>>) -> Vec<(String, String)> {
    texts_of(&layer.attributes)
}

fn texts_of(attributes: &LayerAttributes) -> Vec<(String, String)> {
    let utf8 = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let entries = attributes.other.iter().filter_map(|(key, value)| match value {
        AttributeValue::Text(value) => Some((utf8(key.bytes()), utf8(value.bytes()))),
        _ => None,
    });
    entries.collect()
}

fn refused(path: &Path, error: &exr::error::Error) -> Error {
    let remedy = match error {
        exr::error::Error::NotSupported(_) => "convert it to plain scan lines with ZIP compression",
        _ => "write it again; it may be cut short",
    };
    Problem::at(Place::file(path), format!("not a sound EXR file: {error}")).remedy(remedy).into()
}
