//! Model data beside the repository, where it is at hand.

use std::path::PathBuf;

/// The rows of a table after its heading, split at commas (fields in quotes come last and are not needed); none, with a
/// printed line, where the file is absent. `SPECULA_DATA` names another folder than `../shared/data`.
#[expect(clippy::print_stdout, reason = "says what was not tested")]
pub(crate) fn rows(name: &str) -> Option<Vec<Vec<String>>> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data");
    let folder = std::env::var_os("SPECULA_DATA").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    let path = folder.join(name);
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: {} is absent", path.display());
        return None;
    };
    Some(text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect())
}
