//! Meshes of Wavefront OBJ files, with the materials of the MTL files they name (Alias|Wavefront 1995, Advanced
//! Visualizer, appendix B1).
//!
//! A file gives one mesh. Polygons become triangles; each material in use is a group of triangles. How materials are
//! understood is told in `mtl.rs`. Numbers and indices are read by tobj; what it cannot do is done here: lines are named,
//! polygons cut, vertices joined and normals averaged, and corners with and without normals may stand side by side.
//!
//! Limits: no free-form surfaces, points, lines or vertex colours; smoothing groups are ignored.

mod faults;
mod maps;
mod mtl;
mod outline;
mod polygons;
mod text;
mod vertices;

use super::mesh::{About, Cutter, LoadedMesh, Parts, Shading, check_count, no_triangle};
use crate::error::{Error, Place, Problem, Problems, Result};
use crate::scene::description::{Material, Named, Normals, Scattering, Texture};
use crate::scene::library::Stamp;
use crate::trust::{Limit, Trust};
use glam::Vec2;
use mtl::Library;
use outline::Outline;
use polygons::{Corner, Polygons};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use vertices::Vertices;

/// The triangles of the bytes of an OBJ file, as [`load_mesh`](super::load_mesh) gives them; files of materials are looked for beside `path`.
pub(super) fn decode_obj(
    bytes: Vec<u8>,
    path: &Path,
    (shading, about): (Shading, About),
    trust: &Trust,
) -> Result<LoadedMesh> {
    let text = text::decode(bytes);
    let outline = Outline::of(&text);
    check_count(|| Place::file(path), outline.faces.len() as u64, &trust.limits)?;
    let place = |line| Place { line: Some(line), ..Place::file(path) };
    let mut warnings = Vec::new();
    for (what, line, count) in &outline.ignored {
        warnings.push(Problem::at(place(*line), format!("{what} are ignored, {count} in all")));
    }
    let polygons = Polygons::read((&text, &outline), about, path, &mut warnings).map_err(Error::Input)?;
    check_count(|| Place::file(path), polygons.triangles() as u64, &trust.limits)?;
    let triangles = Triangles::of(&polygons, shading.normals);
    warnings.extend(triangles.cutter.warning(path));
    if triangles.indices.is_empty() {
        let ignored = outline.ignored.first();
        let ignored = ignored.map(|(what, line, count)| (Some(*line), format!("{what}, {count} in all")));
        let dropped = triangles.cutter.dropped().map(|what| (None, what));
        return Err(no_triangle(path, dropped.or(ignored)).into());
    }
    let files = library_files(&outline, path, trust)?;
    let materials = materials((&outline, &files[..]), &triangles.groups, (path, trust), &mut warnings)?;
    let loaded = triangles.parts(&polygons).load(shading, path, warnings)?;
    let libraries = files.into_iter().map(|file| (file.path, file.stamp)).collect();
    Ok(LoadedMesh { materials, libraries, ..loaded })
}

/// A number of tobj in single precision: it reads in double precision because positions need it.
#[expect(clippy::cast_possible_truncation, reason = "colours and texture coordinates are single precision")]
fn single(number: f64) -> f32 {
    number as f32
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
    /// The group of each material.
    numbers: HashMap<Option<u16>, u16>,
    /// The latest of these.
    latest: Option<(Option<u16>, u16)>,
    cutter: Cutter,
}

impl Triangles {
    fn of(polygons: &Polygons, normals: Normals) -> Self {
        let mut made = Self {
            vertices: Vertices::new(polygons.positions.len()),
            indices: vec![],
            group_of: vec![],
            groups: vec![],
            numbers: HashMap::new(),
            latest: None,
            cutter: Cutter::default(),
        };
        let mut cutter = Cutter::default();
        for (corners, material) in polygons.iter() {
            let position = |corner: Corner| polygons.positions[corner.position as usize];
            cutter.cut(corners, position, |triangle| made.add(triangle, material, normals));
        }
        Self { cutter, ..made }
    }

    fn add(&mut self, corners: [Corner; 3], material: Option<u16>, normals: Normals) {
        let keep = normals == Normals::File;
        let [a, b, c] = corners
            .map(|corner| Corner { normal: corner.normal.filter(|_| keep), ..corner })
            .map(|corner| self.vertices.of(corner));
        self.indices.push([a, b, c]);
        // Faces of one material come in long runs: the latest group is nearly always the right one.
        let group = match self.latest {
            Some((latest, group)) if latest == material => group,
            _ => self.group(material),
        };
        self.latest = Some((material, group));
        self.group_of.push(group);
    }

    /// The group of a material.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the outline has fewer materials than u16 tells apart"
    )]
    fn group(&mut self, material: Option<u16>) -> u16 {
        *self.numbers.entry(material).or_insert_with(|| {
            self.groups.push(material);
            (self.groups.len() - 1) as u16
        })
    }

    fn parts(self, polygons: &Polygons) -> Parts {
        let corners = &self.vertices.corners;
        let uv = |corner: &Corner| corner.uv.map_or(Vec2::ZERO, |i| polygons.uvs[i as usize]);
        let any_uv = corners.iter().any(|corner| corner.uv.is_some());
        Parts {
            origin: polygons.origin,
            positions: corners.iter().map(|c| polygons.positions[c.position as usize]).collect(),
            normals: vertices::file_normals(polygons, corners),
            uvs: any_uv.then(|| corners.iter().map(uv).collect()),
            triangles: self.indices,
            groups: (self.groups.len() > 1).then_some(self.group_of),
        }
    }
}

/// The materials of the groups. Fails where files of materials, or pictures that these name, ask for too much or lie where they must not.
fn materials(
    (outline, files): (&Outline, &[LibraryFile]),
    groups: &[Option<u16>],
    (path, trust): (&Path, &Trust),
    warnings: &mut Vec<Problem>,
) -> Result<Vec<Named<Material>>> {
    if groups.iter().all(Option::is_none) {
        return Ok(vec![]);
    }
    let (library, complete) = library(files, (path, trust), warnings)?;
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
    Ok(groups.iter().map(material).collect())
}

/// The materials of all files, and whether all of them could be read.
fn library<'a>(
    files: &[LibraryFile],
    (path, trust): (&Path, &'a Trust),
    warnings: &mut Vec<Problem>,
) -> Result<(Library<'a>, bool)> {
    let mut library = Library::new(trust);
    let mut complete = true;
    let mut refused = Problems::default();
    for LibraryFile { path: file, line, .. } in files {
        let place = Place { line: Some(*line), ..Place::file(path) };
        if let Some((what, remedy)) = trust.outside(file) {
            refused.push(Problem::at(place, what).remedy(remedy));
            continue;
        }
        let why = match trust.read(file, "cannot read") {
            Ok(bytes) => library.read(file, &text::decode(bytes)).err(),
            Err(Error::Refused(Problem { what, remedy, .. })) => {
                let what = format!("`{}` is not read: {what}", file.display());
                refused.push(Problem { place: Some(place), what, remedy });
                continue;
            }
            Err(error) => Some(cause(&error)),
        };
        if let Some(why) = why {
            complete = false;
            let problem = Problem::at(place, format!("cannot read `{}`: {why}", file.display()));
            warnings.push(problem.remedy("its materials are made gray and diffuse"));
        }
    }
    warnings.append(&mut library.warnings);
    refused.0.append(&mut library.refused.0);
    refused.into_result((library, complete))
}

/// Why a file could not be read.
fn cause(error: &Error) -> String {
    std::error::Error::source(error).map_or_else(|| error.to_string(), ToString::to_string)
}

/// A file of materials.
#[derive(Debug)]
struct LibraryFile {
    path: PathBuf,
    /// The first line that names it.
    line: u32,
    /// As it is before it is read.
    stamp: Stamp,
}

/// The files of materials that a mesh names, each once in the order met. Fails, before any is read, where they are too many.
fn library_files(outline: &Outline, path: &Path, trust: &Trust) -> Result<Vec<LibraryFile>> {
    let (mut files, mut lines, mut known) = (Vec::new(), HashSet::new(), HashSet::new());
    for (names, line) in &outline.libraries {
        let named = if lines.insert(names) { named_files(names, path, trust) } else { vec![] };
        for file in named {
            if known.insert(file.clone()) {
                files.push((file, *line));
            }
        }
    }
    // The mesh is a file, too.
    trust.limits.check(Limit::Files, files.len() as u64 + 1).map_err(|excess| {
        let allowed = usize::try_from(excess.most.saturating_sub(1)).ok();
        let line = allowed.and_then(|allowed| files.get(allowed)).map(|(_, line)| *line);
        Error::Refused(excess.at(Place { line, ..Place::file(path) }))
    })?;
    let stamped = |(path, line): (PathBuf, u32)| LibraryFile { stamp: Stamp::of(&path), path, line };
    Ok(files.into_iter().map(stamped).collect())
}

/// The files that a line of `mtllib` names: one with spaces in its name if there is such a file, else one per word. A
/// backslash makes a space part of a word, and stands between folders otherwise. Where files must not lie it is not looked.
fn named_files(names: &str, path: &Path, trust: &Trust) -> Vec<PathBuf> {
    let beside = |name: &str| path.with_file_name(name.replace('\\', "/").replace('\0', " "));
    let escaped = names.replace("\\ ", "\0");
    let whole = beside(names);
    if trust.outside(&whole).is_none() && whole.is_file() {
        return vec![whole];
    }
    escaped.split_whitespace().map(beside).collect()
}
