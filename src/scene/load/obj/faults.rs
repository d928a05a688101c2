//! Where the faults of an OBJ file are, sought only once it is known that there are some.

use super::outline::{Indices, MOST_MATERIALS, corner, keyword, statements, words};
use crate::error::{Place, Problem, Problems};
use crate::geometry::Mesh;
use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

/// How many faults of a file are told one by one: they tend to have one cause.
const TOLD: usize = 20;

/// The greatest sizes of positions and uv.
const MOST: [f32; 2] = [Mesh::MAX_COORDINATE, f32::MAX];

const INDICES: &str = "indices count from 1 or backwards from -1";

/// All faults of a text, from top to bottom; `otherwise` if none is found.
pub(super) fn find(text: &str, path: &Path, otherwise: &str) -> Problems {
    let mut search = Search::new(path);
    for (line, statement) in statements(text) {
        search.statement(line, &statement);
    }
    search.check_indices();
    search.into_problems(otherwise)
}

/// The first line with a normal that is not finite, and how many there are.
pub(super) fn odd_normals(text: &str) -> Option<(u32, usize)> {
    let mut lines = statements(text).filter_map(|(line, statement)| {
        let (keyword, rest) = keyword(&statement);
        (keyword == "vn" && !is_finite(rest)).then_some(line)
    });
    lines.next().map(|first| (first, 1 + lines.count()))
}

fn is_finite(rest: &str) -> bool {
    words(rest).take(3).all(|word| word.parse().is_ok_and(f32::is_finite))
}

#[derive(Debug)]
struct Search {
    file: Arc<Path>,
    told: Problems,
    untold: usize,
    /// How many positions, uv and normals there are so far.
    counts: [u64; 3],
    /// Lines of faces with their corners.
    faces: Vec<(u32, Vec<Indices>)>,
    materials: HashSet<String>,
}

impl Search {
    fn new(path: &Path) -> Self {
        Self {
            file: path.into(),
            told: Problems::default(),
            untold: 0,
            counts: [0; 3],
            faces: vec![],
            materials: HashSet::new(),
        }
    }

    fn push(&mut self, line: u32, what: impl Into<String>, remedy: &str) {
        if self.told.0.len() < TOLD {
            let place = Place { file: self.file.clone(), line: Some(line), column: None };
            self.told.push(Problem::at(place, what).remedy(remedy));
        } else {
            self.untold += 1;
        }
    }

    fn statement(&mut self, line: u32, statement: &str) {
        let (keyword, rest) = keyword(statement);
        match keyword {
            "v" => self.element(0, line, rest, [3, 3]),
            "vt" => self.element(1, line, rest, [1, 2]),
            "vn" => self.element(2, line, rest, [3, 3]),
            "f" => self.face(line, rest),
            "usemtl" => self.use_material(line, rest.trim()),
            _ => {}
        }
    }

    fn use_material(&mut self, line: u32, name: &str) {
        let new = self.materials.insert(name.into());
        if new && self.materials.len() == MOST_MATERIALS + 1 {
            let what = format!("a mesh can have {MOST_MATERIALS} materials");
            self.push(line, what, "use fewer, or split the file");
        }
    }

    /// Counts an element, which needs at least `least` numbers, of which at most `most` mean something. A bad one counts
    /// too: faces that refer to it are not at fault.
    fn element(&mut self, kind: usize, line: u32, rest: &str, [least, most]: [usize; 2]) {
        self.counts[kind] += 1;
        let mut found = 0;
        for word in words(rest).take(most) {
            found += 1;
            match word.parse::<f32>() {
                // Normals that are not finite are put right.
                Ok(value) if kind == 2 || value.abs() <= MOST[kind] => {}
                Ok(value) if value.is_finite() => {
                    let what = format!("`{word}` is farther than {:e} from zero", MOST[kind]);
                    return self.push(line, what, "scale the model down");
                }
                Ok(_) => {
                    let what = format!("`{word}` is not finite in single precision");
                    return self.push(line, what, "give a finite coordinate");
                }
                Err(_) => {
                    let what = format!("`{word}` is not a number");
                    return self.push(line, what, "give a number like -1.5e3");
                }
            }
        }
        if found < least {
            let what = format!("{found} of {least} numbers are there");
            self.push(line, what, "give one for each coordinate");
        }
    }

    fn face(&mut self, line: u32, rest: &str) {
        let mut corners = Vec::new();
        for word in words(rest) {
            let Some(indices) = corner(word, self.counts) else {
                let remedy = "give position, position/uv, position//normal or position/uv/normal, \
                              counted from 1 or backwards from -1";
                return self.push(line, format!("`{word}` is no corner of a face"), remedy);
            };
            corners.push(indices);
        }
        if corners.len() >= 3 {
            self.faces.push((line, corners));
        }
    }

    fn check_indices(&mut self) {
        for (line, corners) in std::mem::take(&mut self.faces) {
            let kinds = ["position", "uv", "normal"];
            let beyond =
                corners.iter().flat_map(|indices| indices.iter().zip(kinds).zip(self.counts)).find_map(
                    |((index, what), count)| index.filter(|&index| index >= count).map(|i| (what, i, count)),
                );
            if let Some((what, index, count)) = beyond {
                let what = format!("the face refers to {what} {}, but there are {count}", index + 1);
                self.push(line, what, INDICES);
            }
        }
    }

    fn into_problems(mut self, otherwise: &str) -> Problems {
        self.told.0.sort_by(|a, b| a.place.cmp(&b.place));
        if self.told.0.is_empty() {
            self.told.push(Problem::at(Place::file(&self.file), otherwise));
        }
        if self.untold > 0 {
            let what = format!("and {} more problems", self.untold);
            self.told.push(Problem::at(Place::file(&self.file), what));
        }
        self.told
    }
}
