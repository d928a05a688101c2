//! Files that are there whole or not at all.
//!
//! What is written goes to a temporary file in the same directory, which takes the target's name when it is complete. A
//! reader never sees half a file, and a failure leaves the old one as it was. A symbolic link is followed, not replaced. What a
//! process leaves that is killed meanwhile goes when a later process writes the same target again.
//!
//! What is no file stays: pipes and devices are written to when all that they get is there.

use std::collections::HashMap;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};

use tempfile::NamedTempFile;

use crate::error::{Error, Problem, Result};

/// Writes `path` by `fill`, atomically. An error of `fill` is passed on and nothing changes.
pub fn write<T>(path: &Path, fill: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<T>) -> Result<T> {
    let written = if is_no_file(path) { pour(path, fill) } else { replace(&followed(path), fill) };
    written.map_err(|source| failed(path, source))
}

fn failed(path: &Path, source: io::Error) -> Error {
    Error::Io { path: path.to_owned(), what: "cannot write", source }
}

/// Whether there is something that is neither a file nor a directory, such as a pipe or a device.
fn is_no_file(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|about| !about.is_file() && !about.is_dir())
}

/// Writes to what is no file. Writers may go back in what they write, so a file without a name has it first.
fn pour<T>(path: &Path, fill: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<T>) -> io::Result<T> {
    let mut file = tempfile::tempfile()?;
    let value = filled(&mut file, fill)?;
    file.rewind()?;
    io::copy(&mut file, &mut File::options().write(true).open(path)?)?;
    Ok(value)
}

/// Puts a file in the place of what is there, if anything.
fn replace<T>(path: &Path, fill: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<T>) -> io::Result<T> {
    sweep(directory(path), &prefix(name(path)?));
    let mut file = beside(path)?;
    // Says that somebody is at it. Where files cannot be locked, nobody can find that nobody is.
    let _ = file.as_file().try_lock();
    let value = filled(file.as_file_mut(), fill)?;
    // Without this a crash of the machine soon after could leave the new name with none of the contents.
    file.as_file().sync_all()?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(value)
}

fn filled<T>(
    file: &mut File,
    fill: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<T>,
) -> io::Result<T> {
    let mut writer = BufWriter::new(file);
    let value = fill(&mut writer)?;
    writer.flush()?;
    Ok(value)
}

/// A new file beside a target, to take its name.
fn beside(path: &Path) -> io::Result<NamedTempFile> {
    let prefix = prefix(name(path)?);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).rand_bytes(RANDOM).suffix(SUFFIX);
    if let Some(permissions) = new_file_permissions(path) {
        builder.permissions(permissions);
    }
    builder.tempfile_in(directory(path))
}

fn name(path: &Path) -> io::Result<&OsStr> {
    path.file_name().ok_or_else(|| io::Error::other("it does not name a file"))
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

/// Fails now where the folder of `path` would not take a new file later: makes one, and takes it away. What is no file is not tried, since
/// somebody may be listening.
pub fn try_out(path: &Path) -> Result<()> {
    if is_no_file(path) {
        return Ok(());
    }
    beside(&followed(path)).map(drop).map_err(|source| failed(path, source))
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

    #[cfg(target_os = "linux")]
    #[test]
    fn folders_that_take_no_file_are_known_beforehand() {
        let dir = tempfile::tempdir().expect("a directory");
        assert!(try_out(&dir.path().join("a.png")).is_ok(), "a new file");
        assert_eq!(names(dir.path()), [""; 0], "nothing is left");
        // Not even root can make a file there.
        let told = try_out(Path::new("/proc/a.png")).expect_err("no file").to_string();
        assert_eq!(told, "/proc/a.png: cannot write", "as it is told later");
        let link = dir.path().join("link");
        std::os::unix::fs::symlink("/proc/self/status", &link).expect("linked");
        assert!(try_out(&link).is_err(), "the folder of the file itself");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_is_no_file_is_written_to_and_stays() {
        use std::io::Read as _;
        use std::os::unix::fs::FileTypeExt as _;
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&path).status().expect("run");
        assert!(made.success(), "a pipe");
        // Open for both, so that nobody waits for anybody.
        let mut pipe = File::options().read(true).write(true).open(&path).expect("opened");
        assert!(try_out(&path).is_ok(), "not tried");
        let failed = write(&path, |w| w.write_all(b"half").and(Err::<(), _>(io::Error::other("no more"))));
        assert!(failed.is_err(), "passed on");
        let back = |w: &mut BufWriter<&mut File>| {
            w.write_all(b"new")?;
            w.seek(io::SeekFrom::Start(0))?;
            w.write_all(b"N")
        };
        write(&path, back).expect("written");
        assert!(fs::metadata(&path).expect("there").file_type().is_fifo(), "still a pipe");
        let mut bytes = [0; 16];
        let length = pipe.read(&mut bytes).expect("readable");
        assert_eq!(&bytes[..length], b"New", "all of it, once");
        assert_eq!(names(dir.path()), ["pipe"], "nothing beside it");
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
