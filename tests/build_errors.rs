//! What only the files of a scene can tell is told with place and remedy, all of it at once.

use specula::scene::{build, load};
use std::fs;

/// The problems of freezing a scene beside the files given.
fn problems(text: &str, files: &[(&str, &str)]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, content) in files {
        fs::write(folder.path().join(name), content).expect("a file");
    }
    let path = folder.path().join("scene.toml");
    fs::write(&path, text).expect("a scene");
    let loaded = load(&path, &[]).expect("a sound description");
    let error = build(&loaded.description).err().map(|error| error.to_string()).unwrap_or_default();
    error.replace(&format!("{}/", folder.path().display()), "")
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn a_mesh_needs_a_material_from_somewhere() {
    let text = "[[shapes]]\ntype = \"mesh\"\nfile = \"a.obj\"\n";
    let found = problems(text, &[("a.obj", TRIANGLE)]);
    assert_eq!(found, "scene.toml:3:8: the file brings no materials; give the shape a `material`");
}

#[test]
fn all_problems_are_told_at_once() {
    let text = r#"
[materials.m]
type = "conductor"
metal = "Unobtainium"

[[shapes]]
type = "mesh"
file = "bad.obj"
material = "m"

[[shapes]]
type = "sphere"
material = "m"
transform = [{ scale = [1.0, 1e-30, 1.0] }, { scale = [1.0, 1e-30, 1.0] }]

[[lights]]
type = "mesh"
file = "flat.obj"
radiance = 1.0

[[lights]]
type = "environment"
radiance = 1.0

[[lights]]
type = "environment"
radiance = 2.0
"#;
    let files = [
        ("bad.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("flat.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n"),
    ];
    let found = problems(text, &files);
    for part in [
        "scene.toml:4:9: unknown metal `Unobtainium`; known are ",
        "bad.obj:2",
        "scene.toml:14:",
        "a second environment; keep one",
    ] {
        assert!(found.contains(part), "`{part}` is missing from\n{found}");
    }
    assert!(found.lines().count() >= 5, "not all are told:\n{found}");
}

#[test]
fn emitters_that_cannot_be_asked_for_light_are_refused() {
    let text = r#"
[materials.lamp]
type = "emission"
radiance = 1.0
[[shapes]]
type = "sphere"
material = "lamp"
transform = [{ scale = [1.0, 2.0, 1.0] }]
"#;
    let found = problems(text, &[]);
    assert!(found.contains("an emitting sphere or disc can be moved, turned and scaled alike"), "{found}");
}
