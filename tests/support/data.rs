//! Models, scenes, pictures and tables by others: the folder that `SPECULA_DATA` names, else `../shared/data` beside the repository.

#![allow(dead_code, reason = "each program uses a part")]

use std::path::{Path, PathBuf};

/// A file or folder of the data; `None`, with a printed line, where it is absent.
///
/// # Panics
/// If it is absent although `SPECULA_DATA` is set.
#[expect(clippy::print_stdout, reason = "says what was not tested")]
pub(crate) fn data(name: &str) -> Option<PathBuf> {
    let named = std::env::var_os("SPECULA_DATA");
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let path = named.as_ref().map_or_else(beside, PathBuf::from).join(name);
    if path.exists() {
        return Some(path);
    }
    assert!(named.is_none(), "{} is absent, and SPECULA_DATA is set", path.display());
    println!("skipped: {} is absent", path.display());
    None
}

/// The rows of a table after its heading, split at commas (fields in quotes come last and are not needed); `None` where it is absent.
pub(crate) fn rows(name: &str) -> Option<Vec<Vec<String>>> {
    let text = std::fs::read_to_string(data(name)?).expect("readable");
    Some(text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect())
}
