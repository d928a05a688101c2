//! What of the data makes a mesh.

use super::columns::{Column, Columns};
use super::header::{Element, Header};
use super::scalar::Scalar;
use super::source::{Fault, Source};
use crate::error::Problem;
use crate::geometry::Mesh;
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::path::Path;

/// Vertices and polygons as they are in the file.
#[derive(Debug, Default)]
pub(super) struct Content {
    pub(super) positions: Vec<DVec3>,
    /// As many as positions; absent where the file has none, zero where one is not finite.
    pub(super) normals: Option<Vec<Vec3>>,
    /// As many as positions; absent where the file has none.
    pub(super) uvs: Option<Vec<Vec2>>,
    /// Indices of the corners of all polygons; all of them name vertices.
    pub(super) corners: Vec<u32>,
    /// How many corners polygons have, at least three, and how many of them in a row have so many.
    pub(super) runs: Vec<[usize; 2]>,
    /// How many normals were not finite.
    pub(super) odd_normals: usize,
    /// How many faces have fewer than three corners.
    pub(super) thin_faces: usize,
    /// How many vertices there are by the header; they may come after the faces.
    vertices: u64,
}

impl Content {
    /// All that is in the data. Fails at the first fault, naming its place.
    pub(super) fn read(header: &Header, source: &mut impl Source, path: &Path) -> Result<Self, Problem> {
        let vertices = header.elements.iter().find(|element| element.name == "vertex");
        let mut content = Self { vertices: vertices.map_or(0, |element| element.count), ..Self::default() };
        for element in &header.elements {
            let columns = Columns::of(element, path)?;
            let read = if columns.are_idle(element) {
                source.skip(element)
            } else {
                content.reserve(element, &columns, source);
                content.element(element, &columns, source)
            };
            read.map_err(|(entry, fault)| fault.at(path, source.at(), element, entry))?;
        }
        Ok(content)
    }

    /// How many triangles all polygons are cut into.
    pub(super) fn triangles(&self) -> usize {
        let polygons: usize = self.runs.iter().map(|[_, count]| count).sum();
        self.corners.len() - 2 * polygons
    }

    /// Makes room for what an element promises, as far as the file can hold it.
    fn reserve(&mut self, element: &Element, columns: &Columns, source: &impl Source) {
        let promised = usize::try_from(element.count).unwrap_or(usize::MAX);
        let entries = promised.min(source.room(element));
        if columns.positions {
            self.positions.reserve(entries);
            self.normals = columns.normals.then(|| Vec::with_capacity(entries));
            self.uvs = columns.uvs.then(|| Vec::with_capacity(entries));
        } else if element.name == "face" {
            self.corners.reserve(entries * 3);
        }
    }

    /// Reads all entries; fails with the number of the one at fault.
    fn element(
        &mut self,
        element: &Element,
        columns: &Columns,
        source: &mut impl Source,
    ) -> Result<(), (u64, Fault)> {
        for entry in 0..element.count {
            let slots = self.entry(element, columns, source).map_err(|fault| (entry, fault))?;
            if columns.positions {
                self.vertex(slots);
            }
        }
        Ok(())
    }

    /// Reads an entry; gives what is in its slots.
    #[inline]
    fn entry(
        &mut self,
        element: &Element,
        columns: &Columns,
        source: &mut impl Source,
    ) -> Result<[f64; Column::SLOTS], Fault> {
        let mut slots = [0.0; Column::SLOTS];
        for (property, &column) in element.properties.iter().zip(&columns.each) {
            let scalar = property.scalar;
            let Some(length) = property.length else {
                let number = source.number(scalar)?;
                if let Column::Slot(slot) = column {
                    slots[slot] = coordinate(slot, number)?;
                }
                continue;
            };
            let length = list_length(source, length, scalar)?;
            match column {
                Column::Face => self.face(source, length, scalar)?,
                Column::Strip => self.strips(source, length, scalar)?,
                _ => (0..length).try_for_each(|_| source.number(scalar).map(|_| ()))?,
            }
        }
        source.end_entry(element)?;
        Ok(slots)
    }

    #[inline]
    fn vertex(&mut self, [x, y, z, nx, ny, nz, u, v]: [f64; Column::SLOTS]) {
        self.positions.push(DVec3::new(x, y, z));
        if let Some(uvs) = &mut self.uvs {
            uvs.push(DVec2::new(u, v).as_vec2());
        }
        if let Some(normals) = &mut self.normals {
            // Exporters write odd normals for slivers: zero stands for them, which falls back to the triangle's own.
            let normal = DVec3::new(nx, ny, nz).as_vec3();
            self.odd_normals += usize::from(!normal.is_finite());
            normals.push(if normal.is_finite() { normal } else { Vec3::ZERO });
        }
    }

    #[inline]
    fn face(&mut self, source: &mut impl Source, length: usize, scalar: Scalar) -> Result<(), Fault> {
        for _ in 0..length {
            let index = self.index(source.number(scalar)?)?;
            self.corners.push(index);
        }
        if length < 3 {
            self.thin_faces += 1;
            self.corners.truncate(self.corners.len() - length);
        } else {
            self.end_polygon(length);
        }
        Ok(())
    }

    #[inline]
    fn end_polygon(&mut self, corners: usize) {
        match self.runs.last_mut() {
            Some([known, count]) if *known == corners => *count += 1,
            _ => self.runs.push([corners, 1]),
        }
    }

    /// Strips of triangles: each index makes one with the two before it, turning by turns; -1 starts another strip.
    fn strips(&mut self, source: &mut impl Source, length: usize, scalar: Scalar) -> Result<(), Fault> {
        let mut latest: [Option<u32>; 2] = [None; 2];
        let mut turned = false;
        for _ in 0..length {
            let number = source.number(scalar)?;
            if whole(-number) == Some(1) {
                (latest, turned) = ([None; 2], false);
                continue;
            }
            let c = self.index(number)?;
            if let [Some(a), Some(b)] = latest {
                // Strips are stitched together by corners written twice, which make no triangle.
                if a != b && b != c && c != a {
                    self.corners.extend(if turned { [b, a, c] } else { [a, b, c] });
                    self.end_polygon(3);
                }
                turned = !turned;
            }
            latest = [latest[1], Some(c)];
        }
        Ok(())
    }

    /// A number as the index of a vertex.
    #[inline]
    fn index(&self, number: f64) -> Result<u32, Fault> {
        match whole(number) {
            Some(index) if u64::from(index) < self.vertices => Ok(index),
            _ => {
                let what = format!("index {number} names no vertex, there are {}", self.vertices);
                Err(Fault::new(what, "indices count from 0"))
            }
        }
    }
}

/// A number as it goes into a slot: one that single precision can hold.
#[inline]
fn coordinate(slot: usize, number: f64) -> Result<f64, Fault> {
    #[expect(clippy::cast_possible_truncation, reason = "meshes are single precision")]
    let value = number as f32;
    match slot {
        0..3 if value.is_finite() && value.abs() > Mesh::MAX_COORDINATE => {
            let what = format!("coordinate {value:e} is farther than {:e} from zero", Mesh::MAX_COORDINATE);
            Err(Fault::new(what, "scale the model down"))
        }
        0..3 | 6.. if !value.is_finite() => Err(Fault::new(
            format!("{number:e} is not finite in single precision"),
            "give a finite coordinate",
        )),
        _ => Ok(number),
    }
}

/// The length of a list, for which there is room.
#[inline]
fn list_length(source: &mut impl Source, length: Scalar, scalar: Scalar) -> Result<usize, Fault> {
    let number = source.number(length)?;
    let Some(length) = whole(number).and_then(|length| usize::try_from(length).ok()) else {
        return Err(Fault::new(format!("{number} is no length of a list"), "give a whole number from 0"));
    };
    let most = source.numbers_left(scalar);
    if length > most {
        let what = format!("a list of {length} numbers is begun, but the file holds {most} more at most");
        return Err(Fault::new(what, "get a complete copy of the file"));
    }
    Ok(length)
}

/// A number that is whole and from 0.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::float_cmp,
    reason = "whole numbers are exact, which is checked"
)]
fn whole(number: f64) -> Option<u32> {
    let whole = number as u32;
    (f64::from(whole) == number).then_some(whole)
}
