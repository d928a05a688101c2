//! The polygons of an OBJ file as tobj reads them.

use super::faults;
use super::outline::Outline;
use super::single;
use crate::error::{Place, Problem, Problems};
use crate::geometry::Mesh;
use crate::scene::load::mesh::{About, positions};
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::path::Path;

/// Polygons whose corners have an index per attribute.
#[derive(Debug)]
pub(super) struct Polygons {
    /// Where positions count from in the file.
    pub(super) origin: DVec3,
    pub(super) positions: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    /// Normals; zero where the file has one that is not finite.
    pub(super) normals: Vec<Vec3>,
    corners: Vec<Corner>,
    polygons: Vec<Polygon>,
}

/// What a corner of a polygon refers to; indices count from 0 and name what is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: Option<u32>,
    pub(super) normal: Option<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Polygon {
    /// How many corners follow those of the polygon before.
    corners: u32,
    material: Option<u16>,
}

impl Polygons {
    /// Those of the text of a file, whose outline is given. Fails, naming lines, on numbers that tobj cannot read, on
    /// coordinates of faces that are not finite, and on indices of what is not there.
    pub(super) fn read(
        (text, outline): (&str, &Outline),
        about: About,
        path: &Path,
        warnings: &mut Vec<Problem>,
    ) -> Result<Self, Problems> {
        if !outline.sound {
            return Err(faults::find(text, path, "an index is out of range"));
        }
        let mesh = parse(&outline.statements).map_err(|e| faults::find(text, path, &e.to_string()))?;
        // Not a number is beyond the limit too: all comparisons with it are false.
        let near = |x: &f64| single(*x).abs() <= Mesh::MAX_COORDINATE;
        if !mesh.positions.iter().all(near) || !mesh.texcoords.iter().all(|uv| single(*uv).is_finite()) {
            return Err(faults::find(text, path, "a coordinate is not finite or too large"));
        }
        let mut read = Self::of(&mesh, outline, about);
        if read.clear_odd_normals()
            && let Some((line, count)) = faults::odd_normals(text)
        {
            let place = Place { line: Some(line), ..Place::file(path) };
            let what = format!("normals that are not finite are ignored, {count} in all");
            warnings.push(Problem::at(place, what));
        }
        Ok(read)
    }

    fn of(mesh: &tobj::Mesh, outline: &Outline, about: About) -> Self {
        let (origin, positions) = positions(mesh.positions.chunks_exact(3).map(DVec3::from_slice), about);
        let mut read = Self {
            origin,
            positions,
            uvs: mesh.texcoords.chunks_exact(2).map(|uv| DVec2::from_slice(uv).as_vec2()).collect(),
            normals: mesh.normals.chunks_exact(3).map(|n| DVec3::from_slice(n).as_vec3()).collect(),
            corners: Vec::with_capacity(mesh.indices.len()),
            polygons: Vec::with_capacity(outline.faces.len()),
        };
        for (i, face) in outline.faces.iter().enumerate() {
            // No arities are given where all faces are triangles.
            let corners = mesh.face_arities.get(i).copied().unwrap_or(3);
            read.polygons.push(Polygon { corners, material: face.material });
            for _ in 0..corners {
                let i = read.corners.len();
                let of = |indices: &[u32], has: bool| indices.get(i).copied().filter(|_| has);
                read.corners.push(Corner {
                    position: mesh.indices[i],
                    uv: of(&mesh.texcoord_indices, face.uvs),
                    normal: of(&mesh.normal_indices, face.normals),
                });
            }
        }
        read
    }

    /// Whether there were normals that are not finite. Exporters write them for slivers: zero stands for them, which
    /// falls back to the triangle's own.
    fn clear_odd_normals(&mut self) -> bool {
        let mut any = false;
        for normal in self.normals.iter_mut().filter(|normal| !normal.is_finite()) {
            *normal = Vec3::ZERO;
            any = true;
        }
        any
    }

    /// How many triangles all polygons are cut into.
    pub(super) fn triangles(&self) -> usize {
        self.corners.len() - 2 * self.polygons.len()
    }

    /// The corners of each polygon, and which of the outline's materials it has.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&[Corner], Option<u16>)> {
        let mut left = &self.corners[..];
        self.polygons.iter().map(move |polygon| {
            let (corners, rest) = left.split_at(polygon.corners as usize);
            left = rest;
            (corners, polygon.material)
        })
    }
}

/// The one mesh of statements that name neither objects nor materials.
fn parse(statements: &str) -> Result<tobj::Mesh, tobj::LoadError> {
    let options = tobj::LoadOptions {
        single_index: false,
        triangulate: false,
        ignore_points: true,
        ignore_lines: true,
    };
    let no_library = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut statements.as_bytes(), &options, no_library)?;
    Ok(models.into_iter().next().map(|model| model.mesh).unwrap_or_default())
}
