//! A first pass in an EXR file: a group of layers for each sample of its pixels.
//!
//! `fuzzy.0.mirror.R` and so on; sample 1 is `fuzzy.1`. All numbers are 32-bit floats or integers, a hundred bytes for a pixel and
//! sample. `fuzzy.0.r` is infinite where the mirrored ray ends nowhere; `fuzzy.0.b` is its direction then. What is no channel, the
//! scale of the picture and the weights of its samples, is metadata.

use super::gbuffer::{End, GBuffer, Mirror, Texel};
use crate::error::{Place, Problem, Problems, Result};
use crate::image::exr::{Channel, Picture, Samples};
use glam::Vec3;
use std::path::Path;

/// The metadata with the scale.
const SCALE: &str = "specula:fuzzy_scale";

/// The metadata with a weight for each sample, separated by spaces.
const WEIGHTS: &str = "specula:fuzzy_weights";

/// A saved first pass: its samples in order, of one size.
pub type Saved = Vec<GBuffer>;

const FLOATS: [&str; CHANNELS] = [
    "rest.R", "rest.G", "rest.B", "alpha", "mirror.R", "mirror.G", "mirror.B", "factor.R", "factor.G",
    "factor.B", "a.X", "a.Y", "a.Z", "b.X", "b.Y", "b.Z", "N.X", "N.Y", "N.Z", "s", "r", "exponent",
    "strength",
];

const CHANNELS: usize = 23;

const IDS: [&str; 2] = ["reflector", "hit"];

/// The channels and the metadata of a first pass.
#[must_use]
pub fn layers(samples: &[GBuffer]) -> (Vec<Channel>, Vec<(String, String)>) {
    let mut channels = Vec::new();
    for (k, g) in samples.iter().enumerate() {
        let name = |channel: &str| format!("fuzzy.{k}.{channel}");
        for (i, channel) in FLOATS.iter().enumerate() {
            let values = g.texels.iter().map(|texel| floats(texel)[i]).collect();
            channels.push(Channel { name: name(channel), samples: Samples::Float(values) });
        }
        for (i, channel) in IDS.iter().enumerate() {
            let values = g.texels.iter().map(|texel| ids(texel)[i]).collect();
            channels.push(Channel { name: name(channel), samples: Samples::Uint(values) });
        }
    }
    let scale = samples.first().map_or(0.0, |g| g.scale);
    let weights: Vec<String> = samples.iter().map(|g| g.weight.to_string()).collect();
    (channels, vec![(SCALE.to_owned(), scale.to_string()), (WEIGHTS.to_owned(), weights.join(" "))])
}

fn floats(texel: &Texel) -> [f32; CHANNELS] {
    let mut numbers = [0.0; CHANNELS];
    numbers[..3].copy_from_slice(&texel.rest);
    numbers[3] = texel.alpha;
    if let Some(mirror) = &texel.mirror {
        let end = match mirror.end {
            End::At(end) | End::Away(end) => end,
        };
        numbers[4..7].copy_from_slice(&mirror.radiance);
        numbers[7..10].copy_from_slice(&mirror.factor);
        numbers[10..13].copy_from_slice(&mirror.a.to_array());
        numbers[13..16].copy_from_slice(&end.to_array());
        numbers[16..19].copy_from_slice(&mirror.normal.to_array());
        numbers[19..].copy_from_slice(&[mirror.s, mirror.length(), mirror.exponent, mirror.strength]);
    }
    numbers
}

fn ids(texel: &Texel) -> [u32; 2] {
    texel.mirror.map_or([0; 2], |mirror| [mirror.reflector, mirror.hit])
}

/// The first pass in a file. Fails with all that is missing.
pub fn saved(picture: &Picture, path: &Path) -> Result<Saved> {
    let problem = |what: String| {
        Problem::at(Place::file(path), what).remedy("write the file with `specula render --aov gbuffer`")
    };
    let number =
        |name: &str| picture.attribute(name)?.parse().ok().filter(|x: &f32| x.is_finite() && *x > 0.0);
    let weights: Option<Vec<f32>> = picture.attribute(WEIGHTS).and_then(|text| {
        text.split(' ').map(|word| word.parse().ok().filter(|x: &f32| x.is_finite())).collect()
    });
    let (Some(scale), Some(weights)) = (number(SCALE), weights) else {
        return Err(problem(format!(
            "no first pass in it: the metadata `{SCALE}` and `{WEIGHTS}` are missing"
        ))
        .into());
    };
    let mut problems = Problems::default();
    let mut samples = Vec::new();
    for (k, weight) in weights.into_iter().enumerate() {
        let mut channel = |name: &str| {
            let name = format!("fuzzy.{k}.{name}");
            let found = picture.channel(&name);
            if found.is_none() {
                problems.push(problem(format!("the channel `{name}` is missing")));
            }
            found
        };
        let floats: Vec<_> = FLOATS.iter().filter_map(|name| Some(channel(name)?.to_f32())).collect();
        let ids: Vec<_> = IDS.iter().filter_map(|name| Some(whole(channel(name)?))).collect();
        if floats.len() == CHANNELS && ids.len() == IDS.len() {
            let texel = |i: usize| texel(|channel| floats[channel][i], [ids[0][i], ids[1][i]]);
            let texels = (0..picture.window.area()).map(texel).collect();
            samples.push(GBuffer { full: picture.full, window: picture.window, scale, weight, texels });
        }
    }
    problems.into_result(samples)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers that a program stored as floats"
)]
fn whole(samples: &Samples) -> Vec<u32> {
    match samples {
        Samples::Uint(values) => values.clone(),
        Samples::Half(values) | Samples::Float(values) => values.iter().map(|&x| x as u32).collect(),
    }
}

fn texel(number: impl Fn(usize) -> f32, [reflector, hit]: [u32; 2]) -> Texel {
    let three = |first: usize| [number(first), number(first + 1), number(first + 2)];
    let end = Vec3::from(three(13));
    let mirror = (reflector > 0).then(|| Mirror {
        radiance: three(4),
        factor: three(7),
        a: three(10).into(),
        normal: three(16).into(),
        end: if number(20).is_finite() { End::At(end) } else { End::Away(end) },
        s: number(19),
        reflector,
        exponent: number(21),
        strength: number(22),
        hit,
    });
    Texel { rest: three(0), direct: [0.0; 3], alpha: number(3), mirror }
}
