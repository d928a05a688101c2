//! Scenes from text.

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
