//! The text of an OBJ file: its numbers and faces, not yet put together.
//!
//! Read are `v`, `vt`, `vn`, `f`, `usemtl` and `mtllib`, with comments, continued lines and indices that count backwards.
//! Names of objects, groups and smoothing groups mean nothing here. Points, lines and free-form surfaces are counted,
//! to be warned of.

use crate::error::{Place, Problem, Problems};
use glam::{Vec2, Vec3};
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// How many faults of a file are told one by one: they tend to have one cause.
const TOLD: usize = 20;

/// What an OBJ file says.
#[derive(Debug, Default)]
pub(super) struct Text {
    pub(super) positions: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    /// Normals; zero where the file has one that is not finite.
    pub(super) normals: Vec<Vec3>,
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<Face>,
    /// Names of materials with the lines of their first use.
    pub(super) materials: Vec<(String, u32)>,
    /// Files of materials with their lines.
    pub(super) libraries: Vec<(String, u32)>,
    /// Statements that were not read, each with its first line and how often it occurs.
    pub(super) ignored: Vec<(&'static str, u32, usize)>,
}

/// What a corner of a face refers to; indices count from 0 and may name what is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: Option<u32>,
    pub(super) normal: Option<u32>,
}

/// A polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Its first corner; the others follow up to that of the next face.
    pub(super) start: usize,
    pub(super) line: u32,
    /// Which of the materials; none before the first `usemtl`.
    pub(super) material: Option<u16>,
}

/// Faults of one file, the first few of them told.
#[derive(Debug)]
pub(super) struct Faults {
    file: Arc<Path>,
    told: Problems,
    untold: usize,
}

impl Faults {
    pub(super) fn new(file: &Path) -> Self {
        Self { file: file.into(), told: Problems::default(), untold: 0 }
    }

    /// A place in the file.
    pub(super) fn place(&self, line: u32) -> Place {
        Place { file: self.file.clone(), line: Some(line), column: None }
    }

    pub(super) fn push(&mut self, line: u32, what: impl Into<String>, remedy: &str) {
        if self.told.0.len() < TOLD {
            self.told.push(Problem::at(self.place(line), what).remedy(remedy));
        } else {
            self.untold += 1;
        }
    }

    /// `value` if there was no fault, else all of them from top to bottom.
    pub(super) fn into_result<T>(mut self, value: T) -> crate::error::Result<T> {
        self.told.0.sort_by(|a, b| a.place.cmp(&b.place));
        if self.untold > 0 {
            let what = format!("and {} more problems", self.untold);
            self.told.push(Problem::at(Place::file(&self.file), what));
        }
        self.told.into_result(value)
    }
}

impl Text {
    /// The statements of a file; what cannot be read is among `faults`.
    pub(super) fn parse(text: &str, faults: &mut Faults) -> Self {
        let mut parser = Parser { text: Self::default(), material: None, numbers: HashMap::new(), faults };
        for (line, statement) in statements(text) {
            parser.statement(line, &statement);
        }
        parser.text
    }

    /// The corners of a face.
    pub(super) fn corners_of(&self, face: usize) -> &[Corner] {
        let end = self.faces.get(face + 1).map_or(self.corners.len(), |next| next.start);
        &self.corners[self.faces[face].start..end]
    }
}

/// Lines with their numbers; lines that end in a backslash go on in the next one.
fn statements(text: &str) -> impl Iterator<Item = (u32, Cow<'_, str>)> {
    let mut lines = (1..).zip(text.lines());
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let mut statement = Cow::Borrowed(line.trim());
        while let Some(begun) = statement.strip_suffix('\\') {
            let Some((_, next)) = lines.next() else { break };
            statement = Cow::Owned(format!("{begun} {}", next.trim()));
        }
        Some((number, statement))
    })
}

struct Parser<'a> {
    text: Text,
    material: Option<u16>,
    /// Which number a name of a material has.
    numbers: HashMap<String, u16>,
    faults: &'a mut Faults,
}

impl Parser<'_> {
    fn statement(&mut self, line: u32, statement: &str) {
        let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
        match keyword {
            "v" => {
                if let Some([x, y, z]) = self.numbers::<3>(line, rest, 3) {
                    self.text.positions.push(Vec3::new(x, y, z));
                }
            }
            "vt" => {
                if let Some([u, v]) = self.numbers::<2>(line, rest, 1) {
                    self.text.uvs.push(Vec2::new(u, v));
                }
            }
            "vn" => self.normal(line, rest),
            "f" => self.face(line, rest),
            "usemtl" => self.use_material(line, rest.trim()),
            "mtllib" => self.text.libraries.push((rest.trim().into(), line)),
            "p" => self.ignore("points", line),
            "l" => self.ignore("lines", line),
            "" | "o" | "g" | "s" | "vp" => {}
            _ if keyword.starts_with('#') => {}
            _ => self.ignore("statements of another kind than polygons", line),
        }
    }

    fn ignore(&mut self, what: &'static str, line: u32) {
        match self.text.ignored.iter_mut().find(|(known, _, _)| *known == what) {
            Some((_, _, count)) => *count += 1,
            None => self.text.ignored.push((what, line, 1)),
        }
    }

    /// The first `N` numbers of a line, zero where fewer than `N` but at least `needed` are given.
    fn numbers<const N: usize>(&mut self, line: u32, rest: &str, needed: usize) -> Option<[f32; N]> {
        let mut numbers = [0.0; N];
        let mut found = 0;
        for (number, word) in numbers.iter_mut().zip(words(rest)) {
            found += 1;
            match word.parse::<f32>() {
                Ok(value) if value.is_finite() => *number = value,
                Ok(_) => {
                    let what = format!("`{word}` is not finite in single precision");
                    self.faults.push(line, what, "give a finite coordinate");
                    return None;
                }
                Err(_) => {
                    self.faults.push(line, format!("`{word}` is not a number"), "give a number like -1.5e3");
                    return None;
                }
            }
        }
        if found < needed {
            let what = format!("{found} of {needed} numbers are there");
            self.faults.push(line, what, "give one for each coordinate");
            return None;
        }
        Some(numbers)
    }

    /// Exporters write normals that are not numbers for slivers: these fall back to the triangle's own.
    fn normal(&mut self, line: u32, rest: &str) {
        let finite = words(rest).take(3).all(|word| word.parse().is_ok_and(f32::is_finite));
        let numbers = words(rest).take(3).all(|word| word.parse::<f32>().is_ok());
        if numbers && !finite {
            self.ignore("normals that are not finite", line);
            return self.text.normals.push(Vec3::ZERO);
        }
        if let Some(normal) = self.numbers::<3>(line, rest, 3) {
            self.text.normals.push(normal.into());
        }
    }

    fn face(&mut self, line: u32, rest: &str) {
        let start = self.text.corners.len();
        for word in words(rest) {
            match self.corner(word) {
                Some(corner) => self.text.corners.push(corner),
                None => {
                    let what = format!("`{word}` is no corner of a face");
                    let remedy = "give position, position/uv, position//normal or position/uv/normal, \
                                  counted from 1 or backwards from -1";
                    self.faults.push(line, what, remedy);
                    return self.text.corners.truncate(start);
                }
            }
        }
        if self.text.corners.len() < start + 3 {
            self.text.corners.truncate(start);
            return self.ignore("faces with fewer than three corners", line);
        }
        self.text.faces.push(Face { start, line, material: self.material });
    }

    fn corner(&self, word: &str) -> Option<Corner> {
        let mut parts = word.split('/');
        let position = index(parts.next()?, self.text.positions.len())?;
        let mut optional = |count| match parts.next() {
            None | Some("") => Some(None),
            Some(part) => index(part, count).map(Some),
        };
        let uv = optional(self.text.uvs.len())?;
        let normal = optional(self.text.normals.len())?;
        parts.next().is_none().then_some(Corner { position, uv, normal })
    }

    fn use_material(&mut self, line: u32, name: &str) {
        if let Some(&known) = self.numbers.get(name) {
            self.material = Some(known);
            return;
        }
        // One number is left for faces without a material.
        let Some(number) = u16::try_from(self.text.materials.len()).ok().filter(|&n| n < u16::MAX) else {
            return self.faults.push(line, "a mesh can have 65535 materials", "use fewer, or split the file");
        };
        self.text.materials.push((name.into(), line));
        self.numbers.insert(name.into(), number);
        self.material = Some(number);
    }
}

/// Words of a line up to a comment.
fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_whitespace().take_while(|word| !word.starts_with('#'))
}

/// An index from 0 out of one from 1 or backwards from -1, where `count` things are there so far.
fn index(word: &str, count: usize) -> Option<u32> {
    let written: i64 = word.parse().ok()?;
    let count = i64::try_from(count).ok()?;
    match written {
        1.. => u32::try_from(written - 1).ok(),
        0 => None,
        _ => u32::try_from(count + written).ok(),
    }
}
