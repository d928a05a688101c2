//! Pictures of scenes at a small size, and how far they are from each other.

#![allow(dead_code, reason = "each bench uses a part")]

use specula::error::Result;
use specula::image::Image;
use specula::measure::{Errors, Pair};
use specula::render::{Rendered, Settings, Silent, render};
use specula::scene::{self, Scene};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// The file of a scene in `scenes/`.
pub(crate) fn file_of(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("toml")
}

/// The scene of a file, `width` pixels wide and 9/16 as high, with some keys set.
pub(crate) fn scene_of(file: &Path, width: u32, keys: &[(&str, String)]) -> Result<Scene> {
    let size = [("film.width", width.to_string()), ("film.height", (width * 9 / 16).to_string())];
    let overrides: Vec<_> = size.iter().chain(keys).map(|(key, value)| format!("{key}={value}")).collect();
    Ok(scene::build(&scene::load(file, &overrides)?.description)?.scene)
}

/// A picture by one thread, with statistics.
pub(crate) fn rendered(scene: &Scene) -> Result<Rendered> {
    render(scene, &Settings { threads: NonZeroUsize::new(1), ..Settings::default() }, &Silent)
}

/// The errors of a picture against a reference of its size.
pub(crate) fn errors(test: &Image, reference: &Image) -> Result<Errors> {
    let pair = Pair::new(test.clone().into(), reference.clone().into(), ["picture", "reference"])?;
    Ok(Errors::of(&pair).expect("some pixel is finite"))
}
