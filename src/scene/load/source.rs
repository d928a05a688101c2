//! Texts that users wrote, and places in them.

use crate::error::Place;
use crate::scene::load::files;
use crate::scene::record::Rules;
use crate::trust::{Limits, Trust};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene file, or one override of the command line.
#[derive(Debug)]
pub(crate) struct Source {
    /// As the user named it.
    name: Arc<Path>,
    /// What relative paths in it are relative to.
    dir: PathBuf,
    text: String,
    /// Offsets at which lines start; empty where there are no lines to name.
    lines: Vec<usize>,
    /// Files in the order they were opened, overrides after them.
    order: usize,
    /// How far it is trusted.
    trust: Arc<Trust>,
}

impl Source {
    /// A file.
    pub(crate) fn file(path: &Path, text: String, order: usize, trust: &Arc<Trust>) -> Self {
        let dir = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect();
        Self { name: path.into(), dir, text, lines, order, trust: trust.clone() }
    }

    /// A file that could not be read: places in it have no line.
    pub(crate) fn unread(path: &Path) -> Self {
        let (dir, text) = (PathBuf::new(), String::new());
        Self { name: path.into(), dir, text, lines: vec![], order: 0, trust: Arc::default() }
    }

    /// An override; paths in it are relative to `dir`.
    pub(crate) fn command_line(text: &str, dir: &Path, index: usize, trust: &Arc<Trust>) -> Self {
        let order = usize::MAX / 2 + index;
        let name = Path::new("command line").into();
        Self { name, dir: dir.into(), text: text.into(), lines: vec![], order, trust: trust.clone() }
    }

    /// Everything that was written.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// A file that is named here as seen from the current directory, if it is what rules ask for (there, unless it may be missing, and of one
    /// of their extensions) and lies where it may; else what is wrong with it, and what to do about it.
    pub(crate) fn named(&self, path: &Path, rules: &Rules) -> Result<PathBuf, (String, String)> {
        let path = self.dir.join(path);
        let fault = if rules.may_be_missing { files::fault_if_there } else { files::fault };
        match fault(&path, rules.extensions, &self.trust) {
            None => Ok(path),
            Some(fault) => Err(fault),
        }
    }

    /// What it may ask for.
    pub(crate) fn limits(&self) -> &Limits {
        &self.trust.limits
    }

    /// The override, if it is one.
    pub(crate) fn as_override(&self) -> Option<&str> {
        (self.lines.is_empty() && !self.text.is_empty()).then_some(&self.text)
    }

    fn place(&self, offset: usize) -> Place {
        let Some(line) = self.lines.partition_point(|&start| start <= offset).checked_sub(1) else {
            return Place { file: self.name.clone(), line: None, column: None };
        };
        let end = self.text.floor_char_boundary(offset.min(self.text.len()));
        let before = self.text.get(self.lines[line]..end).unwrap_or("");
        let count = |n: usize| u32::try_from(n + 1).unwrap_or(u32::MAX);
        Place {
            file: self.name.clone(),
            line: Some(count(line)),
            column: Some(count(before.chars().count())),
        }
    }
}

/// A place in a source, cheap to keep.
#[derive(Clone, Debug)]
pub(crate) struct Spot {
    /// In which text.
    pub(crate) source: Arc<Source>,
    /// How many bytes into it.
    pub(crate) offset: usize,
}

impl Spot {
    /// File, line and column.
    pub(crate) fn place(&self) -> Place {
        self.source.place(self.offset)
    }

    /// Whether this is written there.
    pub(crate) fn is_at(&self, text: &str) -> bool {
        self.source.text.get(self.offset..).is_some_and(|rest| rest.starts_with(text))
    }

    /// A key to sort by: files in the order they were opened, then from top to bottom.
    pub(crate) fn order(&self) -> (usize, usize) {
        (self.source.order, self.offset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_lines_and_characters_from_one() {
        let text = "a\nβγ = 1\n";
        let source = Source::file(Path::new("a.toml"), text.to_owned(), 0, &Arc::default());
        let at = |offset| source.place(offset).to_string();
        assert_eq!(at(0), "a.toml:1:1", "start");
        assert_eq!(at(text.find('=').expect("there")), "a.toml:2:4", "after two letters of two bytes");
        assert_eq!(at(1000), "a.toml:3:1", "past the end");
    }
}
