//! A directory in which the program is run.

#![allow(dead_code, reason = "each test program uses a part")]

use assert_cmd::Command;
use specula::image::exr;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A directory of its own, gone with the value.
pub(crate) struct Desk(TempDir);

impl Desk {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a directory"))
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The program, to be run there.
    pub(crate) fn command(&self) -> Command {
        let mut command = Command::cargo_bin("specula").expect("built");
        command.current_dir(self.0.path());
        command
    }

    /// The program's exit status, standard output and standard error.
    pub(crate) fn run(&self, words: &[&str]) -> (i32, String, String) {
        let output = self.command().args(words).output().expect("run");
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("UTF-8");
        (output.status.code().unwrap_or(-1), text(&output.stdout), text(&output.stderr))
    }

    /// All channels of a picture, as bits.
    pub(crate) fn channels(&self, name: &str) -> Vec<(String, Vec<u32>)> {
        let picture = exr::read(&self.path(name)).expect("readable");
        let bits = |channel: exr::Channel| {
            let bits = channel.samples.to_f32().iter().map(|x| x.to_bits()).collect();
            (channel.name, bits)
        };
        picture.channels.into_iter().map(bits).collect()
    }

    /// What is in the directory, in the order of the alphabet.
    pub(crate) fn names(&self) -> Vec<String> {
        Self::names_in(self.0.path())
    }

    /// What is in another directory.
    pub(crate) fn names_in(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).expect("a directory");
        let name = |entry: std::io::Result<std::fs::DirEntry>| {
            entry.expect("an entry").file_name().to_string_lossy().into_owned()
        };
        let mut names: Vec<_> = entries.map(name).collect();
        names.sort();
        names
    }
}
