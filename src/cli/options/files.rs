//! Files that a command reads and writes.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::values::on_command_line;
use crate::error::{Place, Problem, Problems, Result};
use crate::image::{Format, atomic};

/// A file to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::cli) struct Output {
    pub(in crate::cli) path: PathBuf,
    pub(in crate::cli) format: Format,
}

pub(super) fn check_input(path: &Path, problems: &mut Problems) {
    let place = || Place::file(path);
    if path.is_dir() {
        problems.push(Problem::at(place(), "a directory, not a picture").remedy("name a file in it"));
    } else if !path.exists() {
        problems.push(Problem::at(place(), "there is no such file").remedy("check the name"));
    }
}

/// Whether both name one file, be it there or not.
pub(super) fn is_same(a: &Path, b: &Path) -> bool {
    a == b || matches!((resolved(a), resolved(b)), (Some(a), Some(b)) if a == b)
}

/// The one name of a file, be it there or not.
fn resolved(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok().or_else(|| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new(".")).canonicalize().ok()?;
        Some(folder.join(path.file_name()?))
    })
}

/// Refuses a file to write that is one of those to read.
pub(super) fn spare<'a>(
    inputs: impl IntoIterator<Item = &'a PathBuf>,
    target: &Path,
    problems: &mut Problems,
) {
    if inputs.into_iter().any(|input| is_same(input, target)) {
        problems.push(Problem { place: Some(Place::file("command line")), ..overwritten(target) });
    }
}

/// Fails where files to write are among those that a scene is made of, wherever they were named.
pub(super) fn spare_all(inputs: &[PathBuf], targets: impl IntoIterator<Item = PathBuf>) -> Result<()> {
    let inputs: HashSet<PathBuf> = inputs.iter().filter_map(|input| resolved(input)).collect();
    let is_read = |target: &PathBuf| resolved(target).is_some_and(|target| inputs.contains(&target));
    let problems = targets.into_iter().filter(is_read).map(|target| overwritten(&target)).collect();
    Problems(problems).into_result(())
}

fn overwritten(target: &Path) -> Problem {
    let what = format!("`{}` is read and would be overwritten", target.display());
    Problem::new(what).remedy("name another file to write")
}

/// Fails where no file can be made in the folder of one of these, before the work is done that they are to hold.
pub(in crate::cli) fn try_out<'a>(targets: impl IntoIterator<Item = &'a PathBuf>) -> Result<()> {
    targets.into_iter().try_for_each(|target| atomic::try_out(target))
}

/// Files to write, each once.
pub(super) fn outputs(paths: Vec<PathBuf>, problems: &mut Problems) -> Vec<Output> {
    let mut outputs: Vec<Output> = Vec::new();
    for path in paths {
        match Format::of(&path) {
            Err(error) => problems.absorb(error, None),
            Ok(_) if outputs.iter().any(|output| is_same(&output.path, &path)) => problems.push(twice(&path)),
            Ok(format) => {
                check_target(&path, problems);
                outputs.push(Output { path, format });
            }
        }
    }
    outputs
}

/// `stem` with an extension more, whatever dots it has.
pub(in crate::cli) fn with_extension(stem: &Path, extension: &str) -> PathBuf {
    let mut name = stem.as_os_str().to_owned();
    name.push(".");
    name.push(extension);
    name.into()
}

pub(in crate::cli) fn check_target(path: &Path, problems: &mut Problems) {
    if let Err(error) = atomic::check_target(path) {
        problems.absorb(error, None);
    }
}

pub(super) fn twice(path: &Path) -> Problem {
    on_command_line(format!("`{}` would be written twice", path.display())).remedy("name each file once")
}
