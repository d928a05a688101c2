//! The folder of data beside the repository.

use std::path::PathBuf;

/// A folder of the data; `None`, with a printed line, where it is absent. `SPECULA_DATA` names another folder than
/// `../shared/data`.
#[expect(clippy::print_stdout, reason = "says what was not tested")]
pub(crate) fn folder(name: &str) -> Option<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data");
    let data = std::env::var_os("SPECULA_DATA").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let folder = data.join(name);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: {} is absent", folder.display());
    None
}
