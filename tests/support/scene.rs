//! Scenes from text.

#![allow(dead_code, reason = "each program uses a part")]

use specula::film::Film;
use specula::scene::{self, Scene};

/// The scene that a text describes.
///
/// # Panics
/// With all that is wrong with the text.
pub(crate) fn scene_of(text: &str) -> Scene {
    let folder = tempfile::tempdir().expect("a folder for a scene");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).expect("a scene file");
    let loaded = scene::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
    scene::build(&loaded.description).unwrap_or_else(|error| panic!("{error}")).scene
}

/// All that a film keeps, channel by channel, as bits.
pub(crate) fn bits(film: &Film) -> Vec<Vec<u32>> {
    let all = film.layout().aovs().iter().filter_map(|&aov| film.channels(aov)).flatten();
    all.map(|values| values.iter().map(|value| value.to_bits()).collect()).collect()
}
