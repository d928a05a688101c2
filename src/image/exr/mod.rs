//! OpenEXR: any number of named channels, whole pictures or crops, metadata as text.
//!
//! Written as one part, scan lines in blocks of 16 compressed by ZIP (lossless), channels called `layer.channel`. Read
//! from any flat file in half, float or integer samples, tiled or not, of one part or several. Limits: deep and
//! subsampled (luminance/chroma) pictures are refused; of several resolution levels the finest is read.
//! Kainz, Bogart, Stanczyk, 2013, "Technical introduction to OpenEXR".

mod display;
mod read;
mod write;

use std::path::Path;

pub(super) use read::decode_shown;
pub use read::{ChannelInfo, attributes, channels, decode, read, read_within};
pub use write::write;

use super::buffer::Repairs;
use super::{Decoded, Image, Range, Window};
use crate::error::{Place, Problem, Result};
use crate::math::Rgb;

/// Everything that an EXR file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height of the whole picture, the display window.
    pub full: [u32; 2],
    /// The pixels that are there, the data window.
    pub window: Window,
    /// All with as many samples as `window` has pixels, by row from the top.
    pub channels: Vec<Channel>,
    /// Metadata, in the order written; a file does not keep the order.
    pub attributes: Vec<(String, String)>,
    /// What was odd about a file that was read.
    pub warnings: Vec<Problem>,
}

/// One number for each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// `R`, `Z`, or with its layer `albedo.R`.
    pub name: String,
    /// The numbers.
    pub samples: Samples,
}

/// Numbers by row from the top, and how a file stores them.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Stored as 16-bit floats: 11 bits of precision up to 65504, beyond which finite values are cut.
    Half(Vec<f32>),
    /// Stored as 32-bit floats.
    Float(Vec<f32>),
    /// Stored as 32-bit integers.
    Uint(Vec<u32>),
}

impl Samples {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Half(values) | Self::Float(values) => values.len(),
            Self::Uint(values) => values.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All as floats; integers above 2^24 are rounded.
    #[expect(clippy::cast_precision_loss, reason = "said so")]
    pub fn to_f32(&self) -> Vec<f32> {
        match self {
            Self::Half(values) | Self::Float(values) => values.clone(),
            Self::Uint(values) => values.iter().map(|&x| x as f32).collect(),
        }
    }
}

impl Picture {
    /// The channel of that name, if there.
    pub fn channel(&self, name: &str) -> Option<&Samples> {
        self.channels.iter().find(|channel| channel.name == name).map(|channel| &channel.samples)
    }

    /// The value of that metadata, if there.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The colour picture in it: R, G, B, and A if there, without a layer or else of the first layer that has them; or a
    /// grey one of Y. Numbers that are not finite are replaced and told. `path` is for messages.
    pub fn into_decoded(self, path: &Path) -> Result<Decoded> {
        let mut repairs = Repairs::default();
        let mut decoded = self.into_colour(path, |x| repairs.finite(x))?;
        decoded.warnings.extend(repairs.warnings(path));
        Ok(decoded)
    }

    /// The same colour picture with its numbers as they are.
    pub fn into_stored(self, path: &Path) -> Result<Decoded> {
        self.into_colour(path, |x| x)
    }

    fn into_colour(self, path: &Path, mut number: impl FnMut(f32) -> f32) -> Result<Decoded> {
        let prefix = self.colour_prefix(path)?;
        let mut values = |name: &str| -> Option<Vec<f32>> {
            let mut values = self.channel(&format!("{prefix}{name}"))?.to_f32();
            values.iter_mut().for_each(|x| *x = number(*x));
            Some(values)
        };
        let pixels = match (values("R"), values("G"), values("B")) {
            (Some(r), Some(g), Some(b)) => {
                r.into_iter().zip(g).zip(b).map(|((r, g), b)| Rgb::new(r, g, b)).collect()
            }
            _ => values("Y").unwrap_or_default().into_iter().map(Rgb::gray).collect(),
        };
        let alpha = values("A");
        let Some(image) = Image::from_pixels(self.window.width(), self.window.height(), pixels) else {
            return Err(Problem::at(Place::file(path), "channels of different sizes").into());
        };
        let Self { window, full, warnings, .. } = self;
        Ok(Decoded { image, range: Range::Scene, alpha, window, full, warnings })
    }

    /// What stands before `R`, `G`, `B` in the names of the channels to take for colour.
    fn colour_prefix(&self, path: &Path) -> Result<String> {
        let has = |name: String| self.channel(&name).is_some();
        let prefixes = std::iter::once("")
            .chain(self.channels.iter().filter_map(|channel| channel.name.strip_suffix('R')))
            .filter(|prefix| prefix.is_empty() || prefix.ends_with('.'));
        for prefix in prefixes {
            if ["R", "G", "B"].iter().all(|name| has(format!("{prefix}{name}"))) {
                return Ok(prefix.to_owned());
            }
        }
        if has("Y".to_owned()) && !has("RY".to_owned()) {
            return Ok(String::new());
        }
        let names: Vec<_> = self.channels.iter().map(|channel| channel.name.as_str()).collect();
        let what = format!("no colour among its channels ({})", names.join(", "));
        Err(Problem::at(Place::file(path), what).remedy("write it with channels R, G and B").into())
    }
}

#[cfg(test)]
mod tests;
