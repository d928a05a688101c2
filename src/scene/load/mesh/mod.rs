//! Triangle meshes of files, and what all their formats have in common once they are parsed.
//!
//! A format gives polygons; here they are cut (`polygon`), those without area are dropped and counted (`cutter`), and
//! vertices and triangles become a mesh with the normals asked for (`parts`, `normals`).

mod about;
mod cutter;
mod grid;
mod normals;
mod parts;
mod polygon;
mod ring;

use super::obj::decode_obj;
use super::ply::decode_ply;
use crate::error::{Error, Place, Problem, Result};
use crate::geometry::Mesh;
use crate::scene::description::{Material, Named, Normals};
use crate::scene::library::Stamp;
use crate::trust::{Limit, Limits, Trust};
pub(super) use about::positions;
pub(super) use cutter::Cutter;
use glam::DVec3;
pub(super) use parts::Parts;
use std::path::{Path, PathBuf};

/// A mesh as its file says.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedMesh {
    /// The triangles, in one group per material; positions count from `origin`.
    pub mesh: Mesh,
    /// What was taken from all positions of the file, in double precision.
    pub origin: DVec3,
    /// A material for each group; none where the file speaks of no material.
    pub materials: Vec<Named<Material>>,
    /// Files of materials that the file names, each once, as they were before they were read.
    pub libraries: Vec<(PathBuf, Stamp)>,
    /// What was left out or put right.
    pub warnings: Vec<Problem>,
}

/// Where shading normals come from, and which edges they keep sharp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shading {
    /// Where they come from.
    pub normals: Normals,
    /// Smooth normals are not averaged over edges whose triangles are turned by more against each other, in degrees;
    /// 180 smooths over all.
    pub crease_deg: f32,
}

impl From<Normals> for Shading {
    fn from(normals: Normals) -> Self {
        Self { normals, crease_deg: 180.0 }
    }
}

/// Where positions of a mesh are counted from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum About {
    /// From the origin of the file, unless its vertices are so far from there that single precision would lose their form
    /// ([`recentre::FAR`](crate::math::recentre::FAR)).
    #[default]
    Needed,
    /// From a point near the middle of its vertices.
    Middle,
}

/// Extensions of the files that [`load_mesh`] reads, in lower case.
pub const EXTENSIONS: &[&str] = &["obj", "ply"];

/// The triangles of a file of any known format, by its extension, with shading normals as `shading` says, within the usual limits.
///
/// Triangles without area are left out, with a warning. Fails, naming the place, on whatever the file refers to and does
/// not have, on coordinates that are not finite or beyond [`Mesh::MAX_COORDINATE`], and on files without a triangle.
pub fn load_mesh(path: &Path, shading: impl Into<Shading>) -> Result<LoadedMesh> {
    load_mesh_within(path, shading, About::Needed, &Trust::default())
}

/// The same of a file that is trusted so far, with positions counted from where `about` says.
pub fn load_mesh_within(
    path: &Path,
    shading: impl Into<Shading>,
    about: About,
    trust: &Trust,
) -> Result<LoadedMesh> {
    let format = Format::of(path)?;
    format.decode(trust.read(path, "cannot read the mesh")?, path, (shading.into(), about), trust)
}

/// The same of the bytes of a file; `path` tells its format, is for messages, and says beside which files those are that it names.
pub fn decode_mesh(
    bytes: Vec<u8>,
    path: &Path,
    shading: impl Into<Shading>,
    about: About,
    trust: &Trust,
) -> Result<LoadedMesh> {
    Format::of(path)?.decode(bytes, path, (shading.into(), about), trust)
}

#[derive(Clone, Copy, Debug)]
enum Format {
    Obj,
    Ply,
}

impl Format {
    fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or("");
        match extension.to_lowercase().as_str() {
            "obj" => Ok(Self::Obj),
            "ply" => Ok(Self::Ply),
            _ => {
                let problem = Problem::at(Place::file(path), "this is no mesh of a known format");
                Err(problem.remedy("its name must end in .obj or .ply").into())
            }
        }
    }

    fn decode(
        self,
        bytes: Vec<u8>,
        path: &Path,
        (shading, about): (Shading, About),
        trust: &Trust,
    ) -> Result<LoadedMesh> {
        match self {
            Self::Obj => decode_obj(bytes, path, (shading, about), trust),
            Self::Ply => decode_ply(bytes, path, (shading, about), &trust.limits),
        }
    }
}

/// Refuses more triangles than are allowed, before they are made.
pub(super) fn check_count(place: impl FnOnce() -> Place, triangles: u64, limits: &Limits) -> Result<()> {
    limits.check(Limit::Triangles, triangles).map_err(|excess| Error::Refused(excess.at(place())))
}

/// What to say of a file without a triangle that has at most `only` this, first in some line.
pub(super) fn no_triangle(path: &Path, only: Option<(Option<u32>, String)>) -> Problem {
    let (line, only) = only.map_or((None, String::new()), |(line, only)| (line, format!(", only {only}")));
    let place = Place { line, ..Place::file(path) };
    Problem::at(place, format!("there is no triangle in this file{only}")).remedy("name a file with faces")
}
