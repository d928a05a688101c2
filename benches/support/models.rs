//! Models of real scenes, where their files are.

use specula::geometry::Mesh;
use specula::scene::description::Normals;
use specula::scene::load::load_mesh;

#[path = "../../tests/support/data.rs"]
mod data;

/// The mesh of that name; none, with a printed line, where its file is not.
pub(crate) fn model(name: &str) -> Option<Mesh> {
    let file = data::data(&format!("models/obj/{name}.obj"))?;
    Some(load_mesh(&file, Normals::Flat).expect("a mesh").mesh)
}
