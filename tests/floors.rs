//! The direction of the floors: a module uses itself and lower floors, never a higher one, and only the Embree backend
//! touches the raw bindings.

use std::fs;
use std::path::{Path, PathBuf};

/// Lowest first.
const FLOORS: [&str; 22] = [
    "math",
    "error",
    "trust",
    "image",
    "sampling",
    "geometry",
    "accel",
    "texture",
    "bsdf",
    "material",
    "light",
    "camera",
    "film",
    "scene",
    "integrator",
    "post",
    "render",
    "display",
    "measure",
    "bench",
    "tradeoff",
    "cli",
];

fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            into.push(path);
        }
    }
}

/// The floors named after `crate::` in a line, those of a list in braces included.
fn named(text: &str) -> Vec<String> {
    let word = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut found = Vec::new();
    for rest in text.split("crate::").skip(1) {
        match rest.strip_prefix('{') {
            None => found.push(word(rest)),
            Some(list) => {
                let mut depth = 0;
                let mut start = true;
                for (i, c) in list.char_indices() {
                    match c {
                        '{' => depth += 1,
                        '}' if depth == 0 => break,
                        '}' => depth -= 1,
                        ',' if depth == 0 => start = true,
                        c if start && !c.is_whitespace() => {
                            found.push(word(&list[i..]));
                            start = false;
                        }
                        _ => {}
                    }
                }
            }
        }
    }
    found
}

/// What is wrong with a source file that stands on `floor`.
fn offences(floor: &str, path: &Path, text: &str) -> Vec<String> {
    let level = |name: &str| FLOORS.iter().position(|floor| *floor == name);
    let own = level(floor);
    let mut wrong = Vec::new();
    let code: String =
        text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    for used in named(&code) {
        if let (Some(own), Some(used_level)) = (own, level(&used))
            && used_level > own
        {
            wrong.push(format!("{}: `{floor}` uses the higher floor `{used}`", path.display()));
        }
    }
    if code.contains("embree4_sys") && !path.components().any(|part| part.as_os_str() == "embree") {
        wrong.push(format!("{}: raw bindings outside the Embree backend", path.display()));
    }
    let may_be_unsafe =
        ["embree", "lanes"].iter().any(|name| path.components().any(|part| part.as_os_str() == *name));
    if code.contains("unsafe_code") && !may_be_unsafe {
        wrong.push(format!("{}: unsafe code outside the Embree backend and the lanes", path.display()));
    }
    wrong
}

#[test]
fn no_floor_uses_a_higher_one() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    assert!(files.len() > 50, "only {} sources found", files.len());
    let mut wrong = Vec::new();
    for path in files {
        let inner = path.strip_prefix(&root).expect("below src");
        let first = inner.components().next().expect("a name").as_os_str().to_string_lossy();
        let floor = first.trim_end_matches(".rs");
        assert!(
            FLOORS.contains(&floor) || ["lib", "main"].contains(&floor),
            "{} stands on no floor: add it to the list, in its place",
            inner.display()
        );
        wrong.extend(offences(floor, inner, &fs::read_to_string(&path).expect("a readable source")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn offences_are_found() {
    let find = |text| offences("geometry", Path::new("geometry/ray.rs"), text).len();
    assert_eq!(find("use crate::math::Aabb;"), 0, "a lower floor");
    assert_eq!(find("use crate::{math::Aabb, geometry::{Ray, Hit}};"), 0, "itself");
    assert_eq!(find("use crate::{math::Aabb, accel::Accel};"), 1, "a higher floor in a list");
    assert_eq!(find("let a = crate::scene::load();"), 1, "a higher floor in passing");
    assert_eq!(find("/// see [`crate::scene::load()`]"), 0, "a comment is no use");
    assert_eq!(find("use embree4_sys::rtcNewDevice;"), 1, "raw bindings");
    assert_eq!(find("#![expect(unsafe_code)]"), 1, "unsafe code");
}
