//! Meshes of Wavefront OBJ files, with the materials of the MTL files they name (Alias|Wavefront 1995, Advanced
//! Visualizer, appendix B1).
//!
//! A file gives one mesh. Polygons become triangles; each material in use is a group of triangles. How materials are
//! understood is told in `mtl.rs`. Numbers and indices are read by tobj; what it cannot do is done here: lines are named,
//! polygons cut, vertices joined and normals averaged, and corners with and without normals may stand side by side.
//!
//! Limits: no free-form surfaces, points, lines, vertex colours or textures; smoothing groups are ignored.

mod faults;
mod mtl;
mod outline;
mod polygon;
mod polygons;
mod vertices;

use crate::error::{Error, Place, Problem, Result};
use crate::geometry::{Mesh, MeshError};
use crate::scene::description::{Material, Named, Normals, Scattering, Texture};
use glam::{Vec2, Vec3};
use mtl::Library;
use outline::Outline;
use polygons::{Corner, Polygons};
use std::path::{Path, PathBuf};
use vertices::Vertices;

/// A mesh as its file says.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedMesh {
    /// The triangles, in one group per material.
    pub mesh: Mesh,
    /// A material for each group; none where the file speaks of no material.
    pub materials: Vec<Named<Material>>,
    /// What was left out or put right.
    pub warnings: Vec<Problem>,
}

/// The triangles of an OBJ file, with shading normals as `normals` says.
///
/// Triangles without area are left out, with a warning. Fails, naming file and line, on coordinates that are not
/// finite, on faces that refer to what is not there, and on files without a triangle.
pub fn load_obj(path: &Path, normals: Normals) -> Result<LoadedMesh> {
    let text = read(path)?;
    let outline = Outline::of(&text);
    let place = |line| Place { line: Some(line), ..Place::file(path) };
    let mut warnings = Vec::new();
    for (what, line, count) in &outline.ignored {
        warnings.push(Problem::at(place(*line), format!("{what} are ignored, {count} in all")));
    }
    let polygons = Polygons::read(&text, &outline, path, &mut warnings).map_err(Error::Input)?;
    let triangles = Triangles::of(&polygons, normals);
    if triangles.degenerate > 0 {
        let what = format!("triangles without area are left out, {} in all", triangles.degenerate);
        warnings.push(Problem::at(Place::file(path), what));
    }
    if triangles.indices.is_empty() {
        let problem = Problem::at(Place::file(path), "there is no triangle in this file");
        return Err(problem.remedy("name a file with faces").into());
    }
    let materials = materials(&outline, &triangles.groups, path, &mut warnings);
    let mesh = triangles
        .mesh(&polygons, normals)
        .map_err(|error| Problem::at(Place::file(path), error.to_string()))?;
    Ok(LoadedMesh { mesh, materials, warnings })
}

/// The text of a file. Names in other encodings than UTF-8 do no harm; whole files in UTF-16 cannot be read.
fn read(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).map_err(|source| Error::Io {
        path: path.into(),
        what: "cannot read the mesh",
        source,
    })?;
    if bytes.starts_with(&[0xfe, 0xff]) || bytes.starts_with(&[0xff, 0xfe]) {
        return Err(Problem::at(Place::file(path), "this file is UTF-16").remedy("save it as UTF-8").into());
    }
    let text = String::from_utf8(bytes)
        .unwrap_or_else(|error| String::from_utf8_lossy(error.as_bytes()).into_owned());
    Ok(text.strip_prefix('\u{feff}').map(String::from).unwrap_or(text))
}

/// Triangles whose corners have one index each.
#[derive(Debug)]
struct Triangles {
    vertices: Vertices,
    indices: Vec<[u32; 3]>,
    /// The group of each triangle.
    group_of: Vec<u16>,
    /// Which material of the outline each group is of; none is that of faces before the first `usemtl`.
    groups: Vec<Option<u16>>,
    /// How many were left out because they have no area.
    degenerate: usize,
}

impl Triangles {
    fn of(polygons: &Polygons, normals: Normals) -> Self {
        let mut made = Self {
            vertices: Vertices::new(polygons.positions.len()),
            indices: vec![],
            group_of: vec![],
            groups: vec![],
            degenerate: 0,
        };
        let mut points = Vec::new();
        for (corners, material) in polygons.iter() {
            points.clear();
            points.extend(corners.iter().map(|corner| polygons.positions[corner.position as usize]));
            polygon::triangulate(&points, |triangle| {
                let [a, b, c] = triangle.map(|i| points[i]);
                if (b - a).cross(c - a) == Vec3::ZERO {
                    made.degenerate += 1;
                } else {
                    made.add(triangle.map(|i| corners[i]), material, normals);
                }
            });
        }
        made
    }

    fn add(&mut self, corners: [Corner; 3], material: Option<u16>, normals: Normals) {
        let keep = normals == Normals::File;
        let [a, b, c] = corners
            .map(|corner| Corner { normal: corner.normal.filter(|_| keep), ..corner })
            .map(|corner| self.vertices.of(corner));
        self.indices.push([a, b, c]);
        // Faces of one material come in long runs: the last group is nearly always the right one.
        let known = self.groups.iter().rposition(|group| *group == material);
        let group = known.unwrap_or_else(|| {
            self.groups.push(material);
            self.groups.len() - 1
        });
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the outline has fewer materials than u16 tells apart"
        )]
        self.group_of.push(group as u16);
    }

    fn mesh(self, polygons: &Polygons, normals: Normals) -> std::result::Result<Mesh, MeshError> {
        let corners = &self.vertices.corners;
        let positions: Vec<Vec3> = corners.iter().map(|c| polygons.positions[c.position as usize]).collect();
        let normals = match normals {
            Normals::Flat => None,
            Normals::File => vertices::file_normals(polygons, corners),
            Normals::Smooth => Some(vertices::smooth_normals(&positions, &self.indices)),
        };
        let uv = |corner: &Corner| corner.uv.map_or(Vec2::ZERO, |i| polygons.uvs[i as usize]);
        let uvs: Option<Vec<Vec2>> =
            corners.iter().any(|corner| corner.uv.is_some()).then(|| corners.iter().map(uv).collect());
        let mut mesh = Mesh::new(positions, self.indices)?;
        if let Some(normals) = normals {
            mesh = mesh.with_normals(normals)?;
        }
        if let Some(uvs) = uvs {
            mesh = mesh.with_uvs(uvs)?;
        }
        if self.groups.len() > 1 { mesh.with_groups(self.group_of) } else { Ok(mesh) }
    }
}

/// The materials of the groups.
fn materials(
    outline: &Outline,
    groups: &[Option<u16>],
    path: &Path,
    warnings: &mut Vec<Problem>,
) -> Vec<Named<Material>> {
    if groups.iter().all(Option::is_none) {
        return vec![];
    }
    let (library, complete) = library(outline, path, warnings);
    let gray = || Scattering::Diffuse { reflectance: Texture::gray(0.5) }.into();
    let material = |group: &Option<u16>| {
        let Some((name, line)) = group.map(|i| &outline.materials[usize::from(i)]) else {
            let place = Place::file(path);
            let what = "faces before the first `usemtl` are made gray and diffuse";
            warnings.push(Problem::at(place.clone(), what));
            return Named { name: "(none)".into(), place, value: gray() };
        };
        let place = Place { line: Some(*line), ..Place::file(path) };
        let value = library.materials.get(name).cloned().unwrap_or_else(|| {
            if complete {
                let problem = Problem::at(place.clone(), format!("material `{name}` is not defined"));
                warnings
                    .push(problem.remedy("it is made gray and diffuse; define it in the file of `mtllib`"));
            }
            gray()
        });
        Named { name: name.clone(), place, value }
    };
    groups.iter().map(material).collect()
}

/// The materials of all files that the text names, and whether all these files could be read.
fn library(outline: &Outline, path: &Path, warnings: &mut Vec<Problem>) -> (Library, bool) {
    let mut library = Library::default();
    let mut complete = true;
    for (names, line) in &outline.libraries {
        for file in library_files(names, path) {
            let read = std::fs::read(&file)
                .map_err(|error| error.to_string())
                .and_then(|bytes| library.read(&file, &String::from_utf8_lossy(&bytes)));
            if let Err(error) = read {
                complete = false;
                let place = Place { line: Some(*line), ..Place::file(path) };
                let problem = Problem::at(place, format!("cannot read `{}`: {error}", file.display()));
                warnings.push(problem.remedy("its materials are made gray and diffuse"));
            }
        }
    }
    warnings.append(&mut library.warnings);
    (library, complete)
}

/// The files that a line of `mtllib` names: one with spaces in its name if there is such a file, else one per word.
fn library_files(names: &str, path: &Path) -> Vec<PathBuf> {
    let beside = |name: &str| path.with_file_name(name.replace('\\', "/"));
    let whole = beside(names);
    if whole.is_file() || !names.contains(char::is_whitespace) {
        return vec![whole];
    }
    names.split_whitespace().map(beside).collect()
}
