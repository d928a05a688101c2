//! Pictures beside each other.

#![allow(dead_code, reason = "each test program uses a part")]

use specula::image::exr::Picture;
use specula::image::{Decoded, Image};
use specula::measure::{Errors, Pair};

/// Asserts that no value is off by more than this part of its own size, or of `least` where that is more; without one, of the greatest of
/// all.
pub(crate) fn assert_values_close(
    what: &str,
    found: &[f32],
    wanted: &[f32],
    (relative, least): (f32, Option<f32>),
) {
    assert_eq!(found.len(), wanted.len(), "{what}");
    let finite = wanted.iter().filter(|b| b.is_finite());
    let least = least.unwrap_or_else(|| finite.fold(0.0_f32, |most, b| most.max(b.abs())));
    for (a, b) in found.iter().zip(wanted) {
        let is_close = (a - b).abs() <= relative * b.abs().max(least) || a.to_bits() == b.to_bits();
        assert!(is_close, "{what}: {a} for {b}, where {least} counts");
    }
}

/// The same of all channels of two pictures of one size; none is black but for ids that are nowhere.
pub(crate) fn assert_close(found: &Picture, wanted: &Picture, tolerance: (f32, Option<f32>)) {
    assert_eq!((found.full, found.channels.len()), (wanted.full, wanted.channels.len()), "size and channels");
    for (found, wanted) in found.channels.iter().zip(&wanted.channels) {
        assert_eq!(found.name, wanted.name, "channels");
        let name = format!("channel {:?}", found.name);
        let [found, wanted] = [found, wanted].map(|channel| channel.samples.to_f32());
        let is_id = name.contains("Crypto");
        assert!(is_id || wanted.iter().any(|x| x.abs() > 0.0), "{name}: black");
        assert_values_close(&name, &found, &wanted, tolerance);
    }
}

/// relMSE of a picture against another.
pub(crate) fn relmse(picture: impl Into<Decoded>, reference: impl Into<Decoded>) -> f64 {
    let pair = Pair::new(picture.into(), reference.into(), ["picture", "reference"]).expect("alike");
    Errors::of(&pair).expect("finite pixels").relmse
}

/// In how many pixels a colour is off by more than this part of it and by more than that.
pub(crate) fn differing(found: &Image, wanted: &Image, relative: f32, absolute: f32) -> usize {
    assert_eq!((found.width(), found.height()), (wanted.width(), wanted.height()), "size");
    let is_close = |a: f32, b: f32| (a - b).abs() <= (relative * b.abs()).max(absolute);
    let both = found.pixels().iter().zip(wanted.pixels());
    both.filter(|(a, b)| !(is_close(a.r, b.r) && is_close(a.g, b.g) && is_close(a.b, b.b))).count()
}
