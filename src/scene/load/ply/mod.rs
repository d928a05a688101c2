//! Meshes of PLY files (Turk 1994, The PLY Polygon File Format), in digits or in bytes of either order.
//!
//! Read are positions, normals and surface parameters of vertices, polygons and strips of triangles; all else is passed
//! over. A file brings no materials.
//!
//! Limits: no colours, no surface parameters of corners (lists `texcoord` of faces), no edges and no point clouds.

mod columns;
mod content;
mod header;
mod scalar;
mod source;

use super::mesh::{About, Cutter, LoadedMesh, Parts, Shading, check_count, no_triangle, positions};
use crate::error::{Place, Problem, Result};
use crate::trust::Limits;
use content::Content;
use glam::Vec3;
use header::{Format, Header};
use source::{Ascii, Binary, Source};
use std::path::Path;

/// The triangles of the bytes of a PLY file, as [`load_mesh`](super::load_mesh) gives them.
pub(super) fn decode_ply(
    bytes: Vec<u8>,
    path: &Path,
    (shading, about): (Shading, About),
    limits: &Limits,
) -> Result<LoadedMesh> {
    let header = Header::read(&bytes, path)?;
    let faces = header.elements.iter().find(|element| element.name == "face");
    if let Some(element) = faces {
        check_count(|| Place { line: Some(element.line), ..Place::file(path) }, element.count, limits)?;
    }
    let (mut content, left_over) = match header.format {
        Format::Ascii => read(Ascii::new(&bytes, &header), &header, path),
        Format::BinaryLittleEndian => read(Binary::<false>::new(&bytes, &header), &header, path),
        Format::BinaryBigEndian => read(Binary::<true>::new(&bytes, &header), &header, path),
    }?;
    drop(bytes);
    check_count(|| Place::file(path), content.triangles() as u64, limits)?;
    let mut warnings = warnings(&header, &content, left_over, path);
    let mut cutter = Cutter::default();
    let far = std::mem::take(&mut content.positions);
    let (origin, positions) = positions(far.iter().copied(), about);
    drop(far);
    let triangles = triangles(&content, &positions, &mut cutter);
    warnings.extend(cutter.warning(path));
    if triangles.is_empty() {
        let vertex = header.elements.iter().find(|element| element.name == "vertex");
        let vertices = vertex.map(|vertex| (Some(vertex.line), format!("vertices, {} in all", vertex.count)));
        let dropped = cutter.dropped().map(|what| (None, what));
        return Err(no_triangle(path, dropped.or(vertices)).into());
    }
    let Content { normals, uvs, .. } = content;
    let parts = Parts { origin, positions, normals, uvs, triangles, groups: None };
    Ok(parts.load(shading, path, warnings)?)
}

/// The content, and how many bytes follow it.
fn read(mut source: impl Source, header: &Header, path: &Path) -> Result<(Content, usize)> {
    let content = Content::read(header, &mut source, path)?;
    Ok((content, source.left_over()))
}

fn triangles(content: &Content, positions: &[Vec3], cutter: &mut Cutter) -> Vec<[u32; 3]> {
    let Content { corners, runs, .. } = content;
    let mut triangles = Vec::with_capacity(content.triangles());
    let mut left = corners.as_slice();
    for &[length, count] in runs {
        let (run, rest) = left.split_at(length * count);
        left = rest;
        for polygon in run.chunks_exact(length) {
            cutter.cut(
                polygon,
                |corner: u32| positions[corner as usize],
                |triangle| triangles.push(triangle),
            );
        }
    }
    triangles
}

/// What was passed over that was hardly meant to be.
fn warnings(header: &Header, content: &Content, left_over: usize, path: &Path) -> Vec<Problem> {
    let at = |line| Place { line: Some(line), ..Place::file(path) };
    let mut warnings: Vec<Problem> = header
        .odd
        .iter()
        .map(|(text, line)| {
            Problem::at(at(*line), format!("`{text}` has no meaning in a PLY header and is ignored"))
        })
        .collect();
    let face = header.elements.iter().find(|element| element.name == "face");
    let texcoord = |element: &&header::Element| element.properties.iter().any(|p| p.name == "texcoord");
    if let Some(face) = face.filter(texcoord) {
        let what = "surface parameters of corners (`texcoord`) are ignored";
        warnings.push(Problem::at(at(face.line), what).remedy("give them to the vertices"));
    }
    for (what, count) in [
        ("faces with fewer than three corners", content.thin_faces),
        ("normals that are not finite", content.odd_normals),
        ("bytes after the last element", left_over),
    ] {
        if count > 0 {
            warnings.push(Problem::at(Place::file(path), format!("{what} are ignored, {count} in all")));
        }
    }
    warnings
}
