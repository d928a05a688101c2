//! Commands that are told, for a user to give them again.

use std::path::{Path, PathBuf};

use super::options::{RenderOptions, trust_words};
use super::shell::word;
use crate::trust::Trust;

/// A rendering as it can be given again.
#[derive(Clone, Debug)]
pub(super) struct Rendering<'a> {
    /// From where, if not from the current directory.
    pub(super) folder: &'a Path,
    /// The scene file, as seen from there.
    pub(super) scene: PathBuf,
    pub(super) overrides: &'a [String],
    pub(super) frame: Option<i32>,
    pub(super) trust: &'a Trust,
}

impl<'a> Rendering<'a> {
    /// What was asked for in the current directory.
    pub(super) fn of(options: &'a RenderOptions) -> Self {
        Self {
            folder: Path::new(""),
            scene: options.scene.clone(),
            overrides: &options.overrides,
            frame: options.frame,
            trust: &options.trust,
        }
    }

    /// The command, ending with more words, as a POSIX shell reads it.
    pub(super) fn command(&self, more: impl IntoIterator<Item = String>) -> String {
        let mut words = vec!["specula".to_owned(), "render".to_owned(), word(&self.scene)];
        for text in self.overrides {
            words.extend(["-D".to_owned(), word(text)]);
        }
        words.extend(self.frame.map(|frame| format!("--frames={frame}")));
        words.extend(trust_words(self.trust));
        words.extend(more);
        let command = words.join(" ");
        if self.folder.as_os_str().is_empty() {
            return command;
        }
        format!("cd {} && {command}", word(self.folder))
    }
}

/// A path as seen from a folder that it was found in; from the root where it is elsewhere.
pub(super) fn relative(path: &Path, folder: &Path) -> PathBuf {
    if folder.as_os_str().is_empty() {
        return path.to_owned();
    }
    path.strip_prefix(folder)
        .map_or_else(|_| std::path::absolute(path).unwrap_or_else(|_| path.to_owned()), Path::to_owned)
}
