//! Files that are there whole or not at all.
//!
//! What is written goes to a temporary file in the same directory, which takes the target's name when it is complete. A
//! reader never sees half a file, and a failure leaves the old one as it was. A symbolic link is followed, not replaced. What a
//! process leaves that is killed meanwhile goes when a later process writes the same target again.

use std::collections::HashMap;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};

use tempfile::NamedTempFile;

use crate::error::{Error, Problem, Result};

/// Writes `path` by `fill`, atomically. An error of `fill` is passed on and nothing changes.
pub fn write<T>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut NamedTempFile>) -> io::Result<T>,
) -> Result<T> {
    let failed = |source| Error::Io { path: path.to_owned(), what: "cannot write", source };
    write_through(&followed(path), fill).map_err(failed)
}

fn write_through<T>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut NamedTempFile>) -> io::Result<T>,
) -> io::Result<T> {
    let name = path.file_name().ok_or_else(|| io::Error::other("it does not name a file"))?;
    let prefix = prefix(name);
    sweep(directory(path), &prefix);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).rand_bytes(RANDOM).suffix(SUFFIX);
    let permissions = new_file_permissions(path);
    if let Some(permissions) = permissions.clone() {
        builder.permissions(permissions);
    }
    let mut file = builder.tempfile_in(directory(path))?;
    // Says that somebody is at it. Where files cannot be locked, nobody can find that nobody is.
    let _ = file.as_file().try_lock();
    let mut writer = BufWriter::new(&mut file);
    let value = fill(&mut writer)?;
    writer.flush()?;
    drop(writer);
    // Without this a crash of the machine soon after could leave the new name with none of the contents.
    file.as_file().sync_all()?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(value)
}

/// Takes `path` away, and what writers that were killed have left of it. One that is not there is no error.
pub fn remove(path: &Path) -> Result<()> {
    if let Some(name) = path.file_name() {
        sweep(directory(path), &prefix(name));
    }
    match fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(Error::Io { path: path.to_owned(), what: "cannot remove", source })
        }
        _ => Ok(()),
    }
}

/// How the names of temporary files of a target begin.
fn prefix(name: &OsStr) -> OsString {
    let mut prefix = OsString::from(".");
    prefix.push(name);
    prefix
}

/// How the names of temporary files end: so many letters by chance, and this.
const RANDOM: usize = 6;
const SUFFIX: &str = ".tmp";

/// Temporary files that directories had when this process first wrote to them: what a killed process left. Listing a directory of thousands of
/// files for each of them took more time than writing them.
static LEFT: LazyLock<Mutex<HashMap<PathBuf, Vec<OsString>>>> = LazyLock::new(Mutex::default);

/// Removes temporary files of a target whose writers are gone: their locks went with them.
fn sweep(directory: &Path, prefix: &OsStr) {
    let mut left = LEFT.lock().unwrap_or_else(PoisonError::into_inner);
    let left = left.entry(directory.to_owned()).or_insert_with(|| temporary(directory));
    left.retain(|name| {
        let (bytes, prefix) = (name.as_encoded_bytes(), prefix.as_encoded_bytes());
        let is_ours = bytes.len() == prefix.len() + RANDOM + SUFFIX.len() && bytes.starts_with(prefix);
        let path = directory.join(name);
        let is_over = is_ours && File::open(&path).is_ok_and(|file| file.try_lock().is_ok());
        !is_over || fs::remove_file(&path).is_err()
    });
}

/// The temporary files of a directory.
fn temporary(directory: &Path) -> Vec<OsString> {
    let Ok(entries) = fs::read_dir(directory) else { return Vec::new() };
    let names = entries.flatten().map(|entry| entry.file_name());
    let is_temporary = |name: &OsString| {
        let bytes = name.as_encoded_bytes();
        bytes.starts_with(b".") && bytes.ends_with(SUFFIX.as_bytes())
    };
    names.filter(is_temporary).collect()
}

/// Says now what would keep `path` from being written later: its directory is missing, or it is one itself.
pub fn check_target(path: &Path) -> Result<()> {
    let directory = directory(path);
    if !directory.is_dir() {
        let what =
            format!("cannot write `{}`: there is no directory `{}`", path.display(), directory.display());
        return Err(Problem::new(what).remedy("create it, or choose another place").into());
    }
    if path.is_dir() {
        let what = format!("cannot write `{}`: it is a directory", path.display());
        return Err(Problem::new(what).remedy("name a file in it").into());
    }
    Ok(())
}

/// Where the file really is, if `path` is a link to one.
fn followed(path: &Path) -> PathBuf {
    if path.is_symlink() {
        fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
    } else {
        path.to_owned()
    }
}

fn directory(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// What any newly created file may be used for (the process's mask is applied); temporary files are private otherwise.
#[cfg(unix)]
fn new_file_permissions(path: &Path) -> Option<fs::Permissions> {
    use std::os::unix::fs::PermissionsExt as _;
    let mode = fs::metadata(path).map_or(0o666, |old| old.permissions().mode() & 0o777);
    Some(fs::Permissions::from_mode(mode | 0o600))
}

#[cfg(not(unix))]
fn new_file_permissions(_path: &Path) -> Option<fs::Permissions> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(dir: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(dir)
            .expect("a directory")
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.txt");
        write(&path, |w| w.write_all(b"old")).expect("first");
        let failed = write(&path, |w| {
            w.write_all(b"new")?;
            Err::<(), _>(io::Error::other("disk full"))
        });
        let error = failed.expect_err("fails");
        assert!(error.to_string().contains("a.txt: cannot write"), "{error}");
        assert_eq!(fs::read(&path).expect("still there"), b"old", "untouched");
        assert_eq!(names(dir.path()), ["a.txt"], "no temporary file");
        write(&path, |w| w.write_all(b"new")).expect("second");
        assert_eq!(fs::read(&path).expect("still there"), b"new", "replaced");
    }

    #[test]
    fn what_a_killed_writer_left_goes_and_what_another_one_writes_stays() {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.txt");
        for name in [".a.txtabcdef.tmp", ".a.txtlonger_.tmp", ".b.txtabcdef.tmp", "a.txtabcdef.tmp"] {
            fs::write(dir.path().join(name), b"half").expect("written");
        }
        let other = File::create(dir.path().join(".a.txtlocked.tmp")).expect("made");
        other.lock().expect("locked");
        write(&path, |w| w.write_all(b"new")).expect("written");
        let left = [".a.txtlocked.tmp", ".a.txtlonger_.tmp", ".b.txtabcdef.tmp", "a.txt", "a.txtabcdef.tmp"];
        assert_eq!(names(dir.path()), left, "the one that nobody writes");
        drop(other);
        write(&path, |w| w.write_all(b"new")).expect("written");
        assert!(!names(dir.path()).contains(&left[0].to_owned()), "now nobody writes that one");
    }

    #[test]
    fn targets_that_cannot_be_written_are_known_beforehand() {
        let dir = tempfile::tempdir().expect("a directory");
        assert!(check_target(&dir.path().join("a.png")).is_ok(), "a new file");
        assert!(check_target(Path::new("a.png")).is_ok(), "in the current directory");
        let inside = check_target(&dir.path().join("no/a.png")).expect_err("no directory").to_string();
        assert!(inside.contains("no directory"), "{inside}");
        assert!(check_target(dir.path()).is_err(), "a directory");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_modes_kept() {
        use std::os::unix::fs::PermissionsExt as _;
        let dir = tempfile::tempdir().expect("a directory");
        let (real, link) = (dir.path().join("real"), dir.path().join("link"));
        fs::write(&real, b"old").expect("written");
        fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).expect("changed");
        std::os::unix::fs::symlink(&real, &link).expect("linked");
        write(&link, |w| w.write_all(b"new")).expect("written");
        assert!(link.is_symlink(), "still a link");
        assert_eq!(fs::read(&real).expect("there"), b"new", "written through");
        let mode = fs::metadata(&real).expect("there").permissions().mode() & 0o777;
        assert_eq!(mode, 0o640, "mode kept");
    }
}
