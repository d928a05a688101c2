//! What the properties of an element are for.

use super::header::Element;
use crate::error::{Place, Problem};
use std::path::Path;

/// What a property is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    /// A number of a vertex: x, y, z, those of the normal, u, v.
    Slot(usize),
    /// Indices of the corners of a polygon.
    Face,
    /// Indices of strips of triangles.
    Strip,
    /// Nothing here.
    Idle,
}

impl Column {
    /// How many numbers a vertex may have.
    pub(super) const SLOTS: usize = 8;
}

/// What all of them are for.
#[derive(Debug)]
pub(super) struct Columns {
    /// That of each property.
    pub(super) each: Vec<Column>,
    /// Whether the element is that of vertices.
    pub(super) positions: bool,
    /// Whether vertices have normals.
    pub(super) normals: bool,
    /// Whether vertices have surface parameters.
    pub(super) uvs: bool,
}

const POSITION: [&str; 3] = ["x", "y", "z"];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
/// Names of surface parameters, most usual first.
const UVS: [[&str; 2]; 4] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];
/// Names of the list of corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

impl Columns {
    /// Those of an element. Fails where it lacks what it cannot do without.
    pub(super) fn of(element: &Element, path: &Path) -> Result<Self, Problem> {
        let lacks = |what: &str, remedy: &str| {
            let what = format!("element `{}` has no {what}", element.name);
            Problem::at(Place { line: Some(element.line), ..Place::file(path) }, what).remedy(remedy)
        };
        let mut columns = Self {
            each: vec![Column::Idle; element.properties.len()],
            positions: false,
            normals: false,
            uvs: false,
        };
        match element.name.as_str() {
            "vertex" => {
                columns.positions = columns.find(element, &POSITION, 0);
                columns.normals = columns.find(element, &NORMAL, 3);
                columns.uvs = UVS.iter().any(|names| columns.find(element, names, 6));
                if !columns.positions {
                    return Err(lacks("position", "give it the properties x, y and z"));
                }
            }
            "face" | "tristrips" => {
                let list = |name: &&str| {
                    element.properties.iter().position(|p| p.name == *name && p.length.is_some())
                };
                let Some(list) = CORNERS.iter().find_map(list) else {
                    return Err(lacks(
                        "list of corners",
                        "give it the property `list uchar int vertex_indices`",
                    ));
                };
                columns.each[list] = if element.name == "face" { Column::Face } else { Column::Strip };
            }
            _ => {}
        }
        Ok(columns)
    }

    /// Whether nothing of the element is read and all its properties are single numbers.
    pub(super) fn are_idle(&self, element: &Element) -> bool {
        self.each.iter().all(|column| *column == Column::Idle)
            && element.properties.iter().all(|property| property.length.is_none())
    }

    /// Puts the properties of some names into slots from `slot` on, if they are all there.
    fn find(&mut self, element: &Element, names: &[&str], slot: usize) -> bool {
        let number =
            |name: &&str| element.properties.iter().position(|p| p.name == *name && p.length.is_none());
        let Some(found) = names.iter().map(number).collect::<Option<Vec<usize>>>() else { return false };
        for (i, property) in found.into_iter().enumerate() {
            self.each[property] = Column::Slot(slot + i);
        }
        true
    }
}
