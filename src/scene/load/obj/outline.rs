//! What an OBJ file says besides its numbers, and its numbers as tobj can read them.
//!
//! tobj (4.0) reads coordinates and indices. It names no lines, refuses comments after a statement, continued lines and
//! `vt` with one number, takes index 0 for a missing one, overflows on indices far out of range, and gives corners
//! without a normal or uv those of the corner before. So the text goes through here first: `v`, `vt`, `vn` and `f` are
//! written down one per line for tobj, indices are checked, and each face notes its material and which attributes its
//! corners have. Materials are noted here because tobj forgets the names of those it does not find, and would cut the
//! mesh at each change into parts without common vertices.
//!
//! Names of objects, groups and smoothing groups mean nothing here. Points, lines and free-form surfaces are counted, to
//! be warned of.

use std::borrow::Cow;
use std::collections::HashMap;

/// Most materials of a mesh; one more number is left for faces without a material.
pub(super) const MOST_MATERIALS: usize = u16::MAX as usize;

/// What is said of faces that refer to what the file does not have at all; nothing goes without positions.
const ABSENT: [&str; 3] =
    ["", "uv of faces, of which the file has none,", "normals of faces, of which the file has none,"];

/// What an OBJ file says besides its numbers.
#[derive(Debug, Default)]
pub(super) struct Outline {
    /// The statements for tobj.
    pub(super) statements: String,
    /// The faces among them, in order.
    pub(super) faces: Vec<Face>,
    /// Names of materials with the lines of their first use.
    pub(super) materials: Vec<(String, u32)>,
    /// Files of materials with their lines.
    pub(super) libraries: Vec<(String, u32)>,
    /// Statements that were not read, each with its first line and how often it occurs.
    pub(super) ignored: Vec<(&'static str, u32, usize)>,
    /// Whether all indices name something that is there, and there are not too many materials.
    pub(super) sound: bool,
}

/// What a face says besides its indices.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Which of the materials; none before the first `usemtl`.
    pub(super) material: Option<u16>,
    /// Whether all its corners have a uv.
    pub(super) uvs: bool,
    /// Whether all its corners have a normal.
    pub(super) normals: bool,
}

/// Indices of a corner's position, uv and normal, from 0; they may name what is not there.
pub(super) type Indices = [Option<u64>; 3];

impl Outline {
    /// That of the text of a file. Where a file has no normal at all or no uv, faces that refer to some are read without.
    pub(super) fn of(text: &str) -> Self {
        let (outline, absent) = Self::read(text, [false; 3]);
        if absent.contains(&true) { Self::read(text, absent).0 } else { outline }
    }

    /// The outline without references to the kinds `left_out`; also, which kinds are referred to without being there.
    fn read(text: &str, left_out: [bool; 3]) -> (Self, [bool; 3]) {
        let mut reader = Reader {
            outline: Self { sound: true, ..Self::default() },
            material: None,
            numbers: HashMap::new(),
            counts: [0; 3],
            needed: [0; 3],
            left_out,
        };
        for (line, statement) in statements(text) {
            reader.statement(line, &statement);
        }
        let Reader { mut outline, counts, needed, .. } = reader;
        outline.sound &= needed.iter().zip(counts).all(|(&needed, count)| needed <= count);
        let absent = |kind: usize| counts[kind] == 0 && needed[kind] > 0;
        (outline, [false, absent(1), absent(2)])
    }
}

/// Lines with their numbers; lines that end in a backslash go on in the next one, but for comments.
pub(super) fn statements(text: &str) -> impl Iterator<Item = (u32, Cow<'_, str>)> {
    let mut lines = (1..).zip(text.lines());
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let mut statement = Cow::Borrowed(line.trim());
        while !statement.starts_with('#') && statement.ends_with('\\') {
            let Some((_, next)) = lines.next() else { break };
            let statement = statement.to_mut();
            statement.pop();
            statement.extend([" ", next.trim()]);
        }
        Some((number, statement))
    })
}

/// The first word of a statement, and all after it.
pub(super) fn keyword(statement: &str) -> (&str, &str) {
    statement.split_once(char::is_whitespace).unwrap_or((statement, ""))
}

/// Words of a line up to a comment.
pub(super) fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_whitespace().take_while(|word| !word.starts_with('#'))
}

/// What a corner refers to, where there are so many positions, uv and normals so far; `None` if it makes no sense.
pub(super) fn corner(word: &str, counts: [u64; 3]) -> Option<Indices> {
    let mut indices = [None; 3];
    for (i, part) in word.split('/').enumerate() {
        let (index, count) = (indices.get_mut(i)?, counts[i]);
        if !part.is_empty() {
            *index = Some(match part.parse::<i64>().ok()? {
                0 => return None,
                // tobj counts vertices in 32 bits.
                written @ 1.. => u64::from(u32::try_from(written - 1).ok()?),
                written => count.checked_sub(written.unsigned_abs())?,
            });
        }
    }
    indices[0].is_some().then_some(indices)
}

struct Reader {
    outline: Outline,
    material: Option<u16>,
    /// Which number a name of a material has.
    numbers: HashMap<String, u16>,
    /// How many positions, uv and normals there are so far.
    counts: [u64; 3],
    /// How many there must be in the end.
    needed: [u64; 3],
    /// Which of them are taken for absent.
    left_out: [bool; 3],
}

impl Reader {
    fn statement(&mut self, line: u32, statement: &str) {
        let (keyword, rest) = keyword(statement);
        match keyword {
            // What follows the third number is a weight or a colour.
            "v" => self.element(0, keyword, words(rest).take(3)),
            // Missing numbers are zero, but for the first.
            "vt" if words(rest).count() == 1 => self.element(1, keyword, words(rest).chain(["0"])),
            "vt" => self.element(1, keyword, words(rest).take(2)),
            "vn" => self.element(2, keyword, words(rest).take(3)),
            "f" => self.face(line, rest),
            "usemtl" => self.use_material(line, rest.trim()),
            "mtllib" => self.outline.libraries.push((rest.trim().into(), line)),
            "p" => self.ignore("points", line),
            "l" => self.ignore("lines", line),
            "" | "o" | "g" | "s" | "vp" => {}
            _ if keyword.starts_with('#') => {}
            _ => self.ignore("statements of another kind than polygons", line),
        }
    }

    fn ignore(&mut self, what: &'static str, line: u32) {
        match self.outline.ignored.iter_mut().find(|(known, _, _)| *known == what) {
            Some((_, _, count)) => *count += 1,
            None => self.outline.ignored.push((what, line, 1)),
        }
    }

    fn element<'a>(&mut self, kind: usize, keyword: &str, words: impl Iterator<Item = &'a str>) {
        self.counts[kind] += 1;
        self.write(keyword, words);
    }

    fn write<'a>(&mut self, keyword: &str, words: impl Iterator<Item = &'a str>) {
        let text = &mut self.outline.statements;
        text.push_str(keyword);
        for word in words {
            text.push(' ');
            text.push_str(word);
        }
        text.push('\n');
    }

    fn face(&mut self, line: u32, rest: &str) {
        let mut face = Face { material: self.material, uvs: true, normals: true };
        let mut corners = 0;
        for word in words(rest) {
            let Some(indices) = corner(word, self.counts).map(|indices| self.without(indices)) else {
                self.outline.sound = false;
                return;
            };
            corners += 1;
            face.uvs &= indices[1].is_some();
            face.normals &= indices[2].is_some();
            for (needed, index) in self.needed.iter_mut().zip(indices) {
                *needed = index.map_or(*needed, |index| (index + 1).max(*needed));
            }
        }
        if corners < 3 {
            return self.ignore("faces with fewer than three corners", line);
        }
        self.outline.faces.push(face);
        if self.left_out.contains(&true) {
            self.write_less(line, rest);
        } else {
            self.write("f", words(rest));
        }
    }

    fn without(&self, mut indices: Indices) -> Indices {
        for (index, _) in indices.iter_mut().zip(self.left_out).filter(|(_, left_out)| *left_out) {
            *index = None;
        }
        indices
    }

    /// A face without references to what is left out.
    fn write_less(&mut self, line: u32, rest: &str) {
        let mut told = [false; 3];
        let corners: Vec<String> = words(rest)
            .map(|word| {
                let parts = word.split('/').zip(self.left_out).enumerate().map(|(kind, (part, left_out))| {
                    told[kind] |= left_out && !part.is_empty();
                    if left_out { "" } else { part }
                });
                parts.collect::<Vec<_>>().join("/").trim_end_matches('/').into()
            })
            .collect();
        self.write("f", corners.iter().map(String::as_str));
        for (_, what) in told.into_iter().zip(ABSENT).filter(|(told, _)| *told) {
            self.ignore(what, line);
        }
    }

    fn use_material(&mut self, line: u32, name: &str) {
        if let Some(&known) = self.numbers.get(name) {
            self.material = Some(known);
            return;
        }
        let materials = &mut self.outline.materials;
        let Some(number) = u16::try_from(materials.len()).ok().filter(|&n| usize::from(n) < MOST_MATERIALS)
        else {
            self.outline.sound = false;
            return;
        };
        materials.push((name.into(), line));
        self.numbers.insert(name.into(), number);
        self.material = Some(number);
    }
}
