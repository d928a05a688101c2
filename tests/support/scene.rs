//! Scenes and pictures from text.

#![allow(dead_code, reason = "each program uses a part")]

use specula::film::Film;
use specula::render::{Rendered, Settings, Silent, render};
use specula::scene::{self, Loaded, Scene};
use std::path::Path;

/// What a scene file says with these keys set.
///
/// # Panics
/// With all that is wrong with it, as the others here.
pub(crate) fn loaded<K: AsRef<str>>(path: &Path, keys: &[K]) -> Loaded {
    let keys: Vec<String> = keys.iter().map(|key| key.as_ref().to_owned()).collect();
    scene::load(path, &keys).unwrap_or_else(|error| panic!("{error}"))
}

/// The scene in a file with these keys set.
pub(crate) fn scene_in<K: AsRef<str>>(path: &Path, keys: &[K]) -> Scene {
    scene::build(&loaded(path, keys).description).unwrap_or_else(|error| panic!("{error}")).scene
}

/// The scene that a text describes.
pub(crate) fn scene_of(text: &str) -> Scene {
    let folder = tempfile::tempdir().expect("a folder for a scene");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).expect("a scene file");
    scene_in::<&str>(&path, &[])
}

/// The picture that a text describes.
pub(crate) fn rendered(text: &str, settings: &Settings) -> Rendered {
    let rendered = render(&scene_of(text), settings, &Silent).expect("a picture");
    assert_eq!(rendered.film.non_finite().count(), 0, "samples that are not finite");
    rendered
}

/// The film of a scene.
pub(crate) fn film(scene: &Scene) -> Film {
    let film = render(scene, &Settings::default(), &Silent).expect("a picture").film;
    assert_eq!(film.non_finite().count(), 0, "samples that are not finite");
    film
}

/// All that a film keeps, channel by channel, as bits.
pub(crate) fn bits(film: &Film) -> Vec<Vec<u32>> {
    let all = film.layout().aovs().iter().filter_map(|&aov| film.channels(aov)).flatten();
    all.map(|values| values.iter().map(|value| value.to_bits()).collect()).collect()
}
