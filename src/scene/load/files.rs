//! Files that scenes name.

use crate::scene::load::words;
use crate::trust::Trust;
use std::path::Path;

/// What is wrong with a file that is to be read, and what to do about it; `None` if it lies where it may, is there and its extension is
/// one of `extensions`, if any are given. Of files elsewhere nothing is told, not even whether they are there.
pub(crate) fn fault(path: &Path, extensions: &[&str], trust: &Trust) -> Option<(String, String)> {
    if let Some(outside) = trust.outside(path) {
        return Some(outside);
    }
    let shown = path.display();
    if path.is_dir() {
        return Some((format!("`{shown}` is a directory"), "name a file in it".into()));
    }
    if !path.exists() {
        let remedy = match neighbour(path) {
            Some(name) => format!("did you mean `{name}`?"),
            None => "paths are relative to the file that names them".into(),
        };
        return Some((format!("no such file `{shown}`"), remedy));
    }
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or("").to_lowercase();
    if !extensions.is_empty() && !extensions.contains(&extension.as_str()) {
        let known: Vec<String> = extensions.iter().map(|extension| format!(".{extension}")).collect();
        let remedy = format!("it must end in {}", words::join(&known, "or"));
        return Some((format!("`{shown}` is of an unknown format"), remedy));
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
