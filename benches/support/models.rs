//! Models of real scenes, where their files are.

use specula::geometry::Mesh;
use specula::scene::description::Normals;
use specula::scene::load::load_mesh;
use std::path::PathBuf;

/// The mesh of that name; none, with a printed line, where its file is not. `SPECULA_DATA` names another folder than
/// `../shared/data`.
pub(crate) fn model(name: &str) -> Option<Mesh> {
    let data = std::env::var_os("SPECULA_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    let loaded = load_mesh(&data.join(format!("models/obj/{name}.obj")), Normals::Flat);
    if loaded.is_err() {
        println!("{name}: skipped, its file is not here");
    }
    Some(loaded.ok()?.mesh)
}
