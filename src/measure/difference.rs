//! Differences as pictures.

use super::{Comparison, Pair, magma};
use crate::image::exr::{Channel, Picture, Samples};
use crate::math::Rgb;

/// One channel of a colour.
type Part = fn(Rgb<f32>) -> f32;

/// FLIP of each pixel in the colour map [`magma`], three bytes each by row from the top.
pub fn colours(comparison: &Comparison) -> Vec<u8> {
    comparison.flip_map.iter().flat_map(|&error| magma::colour(error)).collect()
}

/// The picture minus its reference in R, G and B, and FLIP in `flip`; all NaN where a pixel does not count.
pub fn picture(pair: &Pair, comparison: &Comparison, attributes: Vec<(String, String)>) -> Picture {
    let channels: [(&str, Part); 3] = [("R", |p| p.r), ("G", |p| p.g), ("B", |p| p.b)];
    let mut channels: Vec<Channel> = channels
        .into_iter()
        .map(|(name, of)| Channel { name: name.to_owned(), samples: Samples::Float(signed(pair, of)) })
        .collect();
    channels.push(Channel { name: "flip".to_owned(), samples: Samples::Float(comparison.flip_map.clone()) });
    Picture { full: pair.full(), window: pair.window(), channels, attributes, warnings: Vec::new() }
}

fn signed(pair: &Pair, of: Part) -> Vec<f32> {
    let pixels = pair.test().pixels().iter().zip(pair.reference().pixels()).zip(pair.counts());
    pixels.map(|((&a, &b), counts)| if *counts { of(a) - of(b) } else { f32::NAN }).collect()
}
