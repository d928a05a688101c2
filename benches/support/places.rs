//! Scenes that engines are compared on: those of this repository, pictures that other renderers have, a landscape and a building.

#![allow(dead_code, reason = "each bench uses a part")]

use crate::peers;
use crate::terrain;
use specula::accel::embree::{BuildOptions, Config};
use specula::geometry::{Shape, World};
use specula::scene::{self, Scene};
use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

#[path = "../../tests/support/data.rs"]
mod data;

/// Embree as pictures use it, with the instruction sets that the environment allows.
pub(crate) fn embree() -> BuildOptions {
    BuildOptions { device: Config::from_env(), ..BuildOptions::default() }
}

/// A scene by the text of its file.
pub(crate) fn of_text(text: &str) -> Result<Scene, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("scene.toml");
    std::fs::write(&file, text)?;
    Ok(scene::build(&scene::load(&file, &[])?.description)?.scene)
}

/// A scene of `scenes/` with some keys set.
pub(crate) fn of_file(name: &str, keys: &[&str]) -> Result<Scene, Box<dyn Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("toml");
    let keys: Vec<String> = keys.iter().map(|&key| key.to_owned()).collect();
    Ok(scene::build(&scene::load(&file, &keys)?.description)?.scene)
}

/// A picture that other renderers have, with a table `render`; `None`, with a printed line, where the data is absent.
pub(crate) fn peer(name: &str, render: &str, size: u32) -> Result<Option<Scene>, Box<dyn Error>> {
    let Some(folder) = data::data("peer-scenes") else { return Ok(None) };
    of_text(&peers::scene_file(&folder, name, render, size)).map(Some)
}

/// A landscape of `2 * cells * cells` matt triangles under sun and sky, with a table `render` and `size` by `size` pixels.
pub(crate) fn landscape(cells: u32, render: &str, size: u32) -> Result<Scene, Box<dyn Error>> {
    let (eye, at) = terrain::view();
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("scene.toml");
    let text = format!(
        "[camera]\nfrom = {:?}\nat = {:?}\nvfov_deg = 50.0\n[film]\nwidth = {size}\nheight = {size}\n\
         filter = \"box\"\n[render]\n{render}\n[materials.rock]\ntype = \"diffuse\"\nreflectance = 0.6\n\
         [[shapes]]\ntype = \"mesh\"\nfile = \"stand_in.obj\"\nnormals = \"flat\"\nmaterial = \"rock\"\n\
         [[lights]]\ntype = \"directional\"\ndirection = [1.0, -0.6, -0.4]\nirradiance = 3.0\n\
         [[lights]]\ntype = \"environment\"\nradiance = [0.3, 0.4, 0.6]\n",
        eye.to_array(),
        at.to_array(),
    );
    std::fs::write(&file, text)?;
    std::fs::write(folder.path().join("stand_in.obj"), "v 0 0 0\nv 0 0 1\nv 1 0 0\nf 1 2 3\n")?;
    let mut scene = scene::build(&scene::load(&file, &[])?.description)?.scene;
    // Ten million triangles take minutes by way of text.
    let mut world = World::clone(&scene.world);
    let [mesh] = &mut world.shapes[..] else { return Err("a landscape is one shape".into()) };
    *mesh = Shape::Mesh(terrain::terrain(cells));
    scene.world = Arc::new(world);
    Ok(scene)
}

/// A furnished room of 270 000 triangles, all matt, lit through its windows; `None`, with a printed line, where its files are
/// absent.
pub(crate) fn interior(render: &str, size: u32) -> Result<Option<Scene>, Box<dyn Error>> {
    let Some(folder) = data::data("scenes/dining-room/models") else { return Ok(None) };
    let files = folder.read_dir()?.filter_map(|entry| Some(entry.ok()?.path()));
    let mut files: Vec<_> = files.filter(|file| file.extension().is_some_and(|ext| ext == "obj")).collect();
    files.sort();
    let mut text = format!(
        "[camera]\nfrom = [-0.587317, 2.7623, 9.71429]\nat = [-0.574259, 2.698437, 8.716417]\n\
         vfov_deg = 36.0\n[film]\nwidth = {size}\nheight = {size}\nfilter = \"box\"\n[render]\n{render}\n\
         [materials.matt]\ntype = \"diffuse\"\nreflectance = 0.6\n[[lights]]\ntype = \"directional\"\n\
         direction = [-0.887, -0.289, -0.36]\nirradiance = 10.0\n[[lights]]\ntype = \"environment\"\nradiance = 1.0\n"
    );
    for file in files {
        writeln!(text, "[[shapes]]\ntype = \"mesh\"\nfile = {file:?}\nmaterial = \"matt\"").expect("memory");
    }
    of_text(&text).map(Some)
}
