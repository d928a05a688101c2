//! Files that scenes name.

use crate::scene::load::words;
use crate::trust::Trust;
use std::path::Path;

/// What is wrong with a file that is to be read, and what to do about it; `None` if it lies where it may, is there and its extension is
/// one of `extensions`, if any are given. Of files elsewhere nothing is told, not even whether they are there.
pub(crate) fn fault(path: &Path, extensions: &[&str], trust: &Trust) -> Option<(String, String)> {
    let there = || directory(path).or_else(|| absence(path)).or_else(|| unknown(path, extensions));
    trust.outside(path).or_else(there)
}

/// The same of a file that may be missing: whoever reads it makes up for it, and tells.
pub(crate) fn fault_if_there(path: &Path, extensions: &[&str], trust: &Trust) -> Option<(String, String)> {
    trust.outside(path).or_else(|| directory(path)).or_else(|| unknown(path, extensions))
}

fn directory(path: &Path) -> Option<(String, String)> {
    path.is_dir().then(|| (format!("`{}` is a directory", path.display()), "name a file in it".into()))
}

/// That there is no such file, and what may be meant; `None` if it is there.
pub(crate) fn absence(path: &Path) -> Option<(String, String)> {
    if path.exists() {
        return None;
    }
    let remedy = match neighbour(path) {
        Some(name) => format!("did you mean `{name}`?"),
        None => "paths are relative to the file that names them".into(),
    };
    Some((format!("no such file `{}`", path.display()), remedy))
}

fn unknown(path: &Path, extensions: &[&str]) -> Option<(String, String)> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or("").to_lowercase();
    if !extensions.is_empty() && !extensions.contains(&extension.as_str()) {
        let known: Vec<String> = extensions.iter().map(|extension| format!(".{extension}")).collect();
        let remedy = format!("it must end in {}", words::join(&known, "or"));
        return Some((format!("`{}` is of an unknown format", path.display()), remedy));
    }
    None
}

/// The file of the most similar name in the same directory.
fn neighbour(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let dir = path.parent().filter(|dir| !dir.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut names: Vec<String> =
        dir.read_dir().ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    words::nearest(name, names.iter().map(String::as_str)).map(String::from)
}
