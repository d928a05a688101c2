//! What a picture is of: the description and all files that it is made of.

use crate::error::{Error, Place, Result};
use crate::scene::fingerprint::related;
use crate::scene::{Description, Library};
use crate::trust::{Excess, Limit, Trust};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::Xxh3;

/// The description as JSON, and 32 hexadecimal digits for each file that it names and for `more` files, by name as seen from `folder`.
///
/// Files count by what they hold, not by size and time: on another machine of a farm a copy has another time. Files that are not there
/// count as such. By XXH3 of 128 bits (Collet 2019).
///
/// Fails if a file cannot be read, or is beyond the usual limits.
pub fn identity(description: &Description, folder: &Path, more: &[PathBuf]) -> Result<Value> {
    identity_within(description, folder, more, (&Trust::default(), &Library::default()))
}

/// The same of files that are trusted so far, with digits that a library has already.
pub fn identity_within(
    description: &Description,
    folder: &Path,
    more: &[PathBuf],
    from: (&Trust, &Library),
) -> Result<Value> {
    let files = digest_of_files(description, folder, more, from)?;
    Ok(json!({ "scene": related(description, folder), "files": files }))
}

/// The part of [`identity`] that is about files, trusted so far, with digits that a library has already.
///
/// Fails if a file cannot be read.
pub fn digest_of_files(
    description: &Description,
    folder: &Path,
    more: &[PathBuf],
    (trust, library): (&Trust, &Library),
) -> Result<Map<String, Value>> {
    let folder = full(folder);
    let mut digests = Map::new();
    for path in &files(description, more) {
        digests.insert(seen(path, &folder), library.digits(path, trust)?.into());
    }
    Ok(digests)
}

/// Digits of a file that is called so as seen from `folder`.
///
/// Fails if it cannot be read.
pub fn digest_of_file(name: &str, folder: &Path, (trust, library): (&Trust, &Library)) -> Result<String> {
    library.digits(&full(folder).join(name), trust)
}

/// The files that a description names, and `more`: from the root, each once, in order.
#[must_use]
pub fn files(description: &Description, more: &[PathBuf]) -> Vec<PathBuf> {
    let mut paths: BTreeSet<PathBuf> = more.iter().cloned().collect();
    collect(&description.to_json(), &mut paths);
    let paths: BTreeSet<PathBuf> = paths.iter().map(|path| full(path)).collect();
    paths.into_iter().collect()
}

/// From the root, without links where it is there.
fn full(path: &Path) -> PathBuf {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_owned())
}

/// The name of a file as seen from a folder, both from the root.
fn seen(path: &Path, folder: &Path) -> String {
    let (mut path, mut folder) = (path.components().peekable(), folder.components().peekable());
    while path.peek().is_some() && path.peek() == folder.peek() {
        path.next();
        folder.next();
    }
    let up = folder.map(|_| "..".as_ref());
    let seen: PathBuf = up.chain(path.map(|part| part.as_os_str())).collect();
    seen.to_string_lossy().replace('\\', "/")
}

/// The values of all keys that name files.
fn collect(json: &Value, into: &mut BTreeSet<PathBuf>) {
    match json {
        Value::Object(entries) => entries.iter().for_each(|(key, entry)| match entry {
            Value::String(path) if key == "file" => {
                into.insert(path.into());
            }
            _ => collect(entry, into),
        }),
        Value::Array(items) => items.iter().for_each(|item| collect(item, into)),
        _ => {}
    }
}

/// Of what a file holds, and how many bytes that are.
pub(super) fn digits(path: &Path, trust: &Trust) -> Result<(String, u64)> {
    trust.check(path)?;
    let failed = |source| Error::Io { path: path.to_owned(), what: "cannot read", source };
    let too_much = |excess: Excess| Error::Refused(excess.at(Place::file(path)));
    let mut file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Ok(("not there".to_owned(), 0));
        }
        Err(error) => return Err(failed(error)),
    };
    let (mut hasher, mut block, mut length) = (Xxh3::new(), vec![0; 1 << 18], 0);
    loop {
        match file.read(&mut block) {
            Ok(0) => return Ok((format!("{:032x}", hasher.digest128()), length)),
            Ok(read) => {
                hasher.update(&block[..read]);
                // Pipes and devices do not tell their length.
                length += read as u64;
                trust.limits.check(Limit::Bytes, length).map_err(too_much)?;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(failed(error)),
        }
    }
}

/// Of how many differences something is said.
const TOLD: usize = 8;

/// What differs between two JSON documents, by dotted paths: what it is `there` and what it is here.
#[must_use]
pub fn differences(there: &Value, here: &Value) -> Vec<String> {
    let mut found = Vec::new();
    compare("", Some(there), Some(here), &mut found);
    let more = found.len().saturating_sub(TOLD);
    found.truncate(TOLD);
    if more > 0 {
        found.push(format!("{more} more values differ"));
    }
    found
}

fn compare(path: &str, there: Option<&Value>, here: Option<&Value>, found: &mut Vec<String>) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match (there, here) {
        (there, here) if there == here => {}
        (Some(Value::Object(there)), Some(Value::Object(here))) => {
            let keys: BTreeSet<&String> = there.keys().chain(here.keys()).collect();
            keys.into_iter().for_each(|key| compare(&below(key), there.get(key), here.get(key), found));
        }
        (Some(Value::Array(there)), Some(Value::Array(here))) if there.len() == here.len() => {
            for (i, (there, here)) in there.iter().zip(here).enumerate() {
                compare(&below(&i.to_string()), Some(there), Some(here), found);
            }
        }
        (there, here) => {
            let [there, here] = [there, here].map(shown);
            found.push(format!("`{path}` is {there} there and {here} here"));
        }
    }
}

/// A value in few words.
fn shown(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => "nothing".to_owned(),
        Some(Value::Array(items)) if items.iter().any(|item| item.is_array() || item.is_object()) => {
            format!("a list of {}", items.len())
        }
        Some(Value::Object(_)) => "a table".to_owned(),
        Some(other) => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_named() {
        let there = json!({ "a": { "b": 1, "c": [1, 2] }, "d": [{}, {}], "same": 3, "gone": "x" });
        let here = json!({ "a": { "b": 2, "c": [1, 3] }, "d": [{}], "same": 3 });
        let told = [
            "`a.b` is 1 there and 2 here",
            "`a.c.1` is 2 there and 3 here",
            "`d` is a list of 2 there and a list of 1 here",
            "`gone` is \"x\" there and nothing here",
        ];
        assert_eq!(differences(&there, &here), told, "all");
        assert_eq!(differences(&here, &here), [""; 0], "none");
        let many = differences(&json!((0..20).collect::<Vec<_>>()), &json!((1..21).collect::<Vec<_>>()));
        assert_eq!((many.len(), many[8].as_str()), (9, "12 more values differ"), "some");
    }

    #[test]
    fn files_count_by_what_they_hold() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("m.mtl"), "newmtl red\nKd 1 0 0\nmap_Kd late.png\n").expect("written");
        let mesh = "mtllib m.mtl gone.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
        std::fs::write(path("a.obj"), mesh).expect("written");
        std::fs::write(path("scene.toml"), "[[shapes]]\ntype = 'mesh'\nfile = 'a.obj'\n").expect("written");
        let of = || {
            let loaded = crate::scene::load(&path("scene.toml"), &[]).expect("a scene");
            let built = crate::scene::build(&loaded.description).expect("a scene");
            identity(&loaded.description, folder.path(), &built.files).expect("readable")
        };
        let before = of();
        assert_eq!(before["scene"]["shapes"][0]["file"], "a.obj", "{before}");
        let names: Vec<_> = before["files"].as_object().expect("files").keys().cloned().collect();
        assert_eq!(names, ["a.obj", "gone.mtl", "m.mtl"], "{before}");
        assert_eq!(before["files"]["gone.mtl"], "not there", "{before}");
        let text = std::fs::read(path("m.mtl")).expect("there");
        std::fs::write(path("m.mtl"), &text).expect("written");
        assert_eq!(of(), before, "written again");
        std::fs::write(path("m.mtl"), "newmtl red\nKd 0 1 0\nmap_Kd late.png\n").expect("written");
        let told = differences(&before, &of());
        assert!(told.len() == 1 && told[0].starts_with("`files.m.mtl` is \""), "{told:?}");
        std::fs::write(path("m.mtl"), &text).expect("written");
        image::RgbImage::new(1, 1).save(path("late.png")).expect("written");
        let told = differences(&before, &of());
        assert!(told.len() == 1 && told[0].starts_with("`files.late.png` is nothing there"), "{told:?}");
    }
}
