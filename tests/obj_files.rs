//! OBJ files give the triangles, groups and messages that they should.
//!
//! Counts for the public models are those of an independent reader (tobj 4.0.5, one index per vertex), less the triangles
//! without area; they are skipped where the models are absent.

#[path = "support/data.rs"]
mod data;

use data::data;
use glam::Vec3;
use specula::scene::description::{Normals, Scattering, Texture};
use specula::scene::load::{LoadedMesh, load_mesh};
use std::fs;
use std::path::Path;

/// Warnings or errors, without the path of the folder.
fn messages(path: &Path, normals: Normals) -> Vec<String> {
    let dir = format!("{}/", path.parent().expect("a folder").display());
    match load_mesh(path, normals) {
        Ok(loaded) => {
            loaded.warnings.iter().map(|problem| format!("warning: {problem}").replace(&dir, "")).collect()
        }
        Err(error) => error.to_string().lines().map(|line| line.replace(&dir, "")).collect(),
    }
}

fn load_text(text: &str, normals: Normals) -> LoadedMesh {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.obj");
    fs::write(&path, text).expect("written");
    load_mesh(&path, normals).unwrap_or_else(|error| panic!("{error}\nof\n{text}"))
}

#[test]
fn public_models_have_the_known_counts() {
    let Some(models) = data("models") else { return };
    // Triangles, vertices, groups, whether normals.
    let known = [
        ("dragon", 100_000, 50_000, 1, false),
        ("buddha", 100_000, 49_950, 1, false),
        ("sponza", 33_663, 35_933, 11, true),
        ("legocar", 10_992 - 112, 12_260, 8, true),
        ("wine_glass", 16_128, 8353, 1, true),
        ("spot", 5856, 3225, 1, false),
        ("beetle", 2053, 1254, 1, true),
        ("sword-quad-dominant", 44_582, 22_293, 1, false),
    ];
    for (name, triangles, vertices, groups, normals) in known {
        let path = models.join("obj").join(name).with_extension("obj");
        let LoadedMesh { mesh, materials, .. } = load_mesh(&path, Normals::File).expect(name);
        let found = (mesh.triangles().len(), mesh.positions().len(), mesh.group_count(), mesh.has_normals());
        assert_eq!(found, (triangles, vertices, groups, normals), "{name}");
        assert!(materials.is_empty() || materials.len() == groups, "{name}: {} materials", materials.len());
        let smooth = load_mesh(&path, Normals::Smooth).expect(name).mesh;
        assert_eq!(smooth.triangles().len(), triangles, "{name}: smooth");
        assert!(smooth.has_normals(), "{name}: smooth");
        assert!(!load_mesh(&path, Normals::Flat).expect(name).mesh.has_normals(), "{name}: flat");
    }
    let bounds = load_mesh(&models.join("obj/dragon.obj"), Normals::Flat).expect("dragon").mesh.bounds();
    let expected = (Vec3::new(-7.0467, 0.0, -3.1513), Vec3::new(7.0467, 9.9399, 3.1513));
    assert!(bounds.min.abs_diff_eq(expected.0, 1e-4), "dragon: {bounds:?}");
    assert!(bounds.max.abs_diff_eq(expected.1, 1e-4), "dragon: {bounds:?}");
}

#[test]
fn awkward_files_give_their_messages() {
    let Some(models) = data("models") else { return };
    let no_number = |line: u32, word: &str| {
        format!("number_formats.obj:{line}: `{word}` is not a number; give a number like -1.5e3")
    };
    let corner = "give position, position/uv, position//normal or position/uv/normal, \
                  counted from 1 or backwards from -1";
    let cases: [(&str, Vec<String>); 6] = [
        ("assimp-obj/concave_polygon.obj", vec![]),
        (
            "assimp-obj/point_cloud.obj",
            vec!["point_cloud.obj: there is no triangle in this file; name a file with faces".into()],
        ),
        (
            "assimp-obj/number_formats.obj",
            [
                (11, "3.1+e2"),
                (12, "+3.1+e2"),
                (13, "-3.1+e2"),
                (15, "3.1-e2"),
                (16, "+3.1-e2"),
                (17, "-3.1-e2"),
            ]
            .map(|(line, word)| no_number(line, word))
            .to_vec(),
        ),
        (
            "tinyobj/test-nan.obj",
            vec![
                "test-nan.obj:12: `nan` is not finite in single precision; give a finite coordinate".into(),
                "test-nan.obj:13: `inf` is not finite in single precision; give a finite coordinate".into(),
                "test-nan.obj:14: `1.#IND` is not a number; give a number like -1.5e3".into(),
                "test-nan.obj:15: `1.#INF` is not a number; give a number like -1.5e3".into(),
            ],
        ),
        (
            "tinyobj/issue-140-zero-face-idx.obj",
            vec![
                format!("issue-140-zero-face-idx.obj:16: `0/0/0` is no corner of a face; {corner}"),
                format!("issue-140-zero-face-idx.obj:17: `1/1/0` is no corner of a face; {corner}"),
            ],
        ),
        (
            "tinyobj/issue-244-mtl-searchpaths.obj",
            vec![
                "warning: issue-244-mtl-searchpaths.obj:2: cannot read `issue-244.mtl`: No such file or \
                 directory (os error 2); its materials are made gray and diffuse"
                    .into(),
            ],
        ),
    ];
    for (file, expected) in cases {
        assert_eq!(messages(&models.join("awkward").join(file), Normals::File), expected, "{file}");
    }
}

#[test]
fn faults_name_their_lines() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.obj");
    let text = "v 0 0 0\r\nv 1 0\r\nv 0 1 x\r\nv 1e39 0 0\r\nvt\r\nvn 0 nan 1\r\nf 1 2 9\r\nf 1 \\\r\n 1/7 -1//1\r\n\
                f 1//1 1//1 1//2\r\nf a b c\r\nf -7 1 1\r\n";
    fs::write(&path, text).expect("written");
    let corner = "is no corner of a face; give position, position/uv, position//normal or position/uv/normal, \
                  counted from 1 or backwards from -1";
    let beyond = "indices count from 1 or backwards from -1";
    let expected = [
        "a.obj:2: 2 of 3 numbers are there; give one for each coordinate".to_owned(),
        "a.obj:3: `x` is not a number; give a number like -1.5e3".into(),
        "a.obj:4: `1e39` is not finite in single precision; give a finite coordinate".into(),
        "a.obj:5: 0 of 1 numbers are there; give one for each coordinate".into(),
        format!("a.obj:7: the face refers to position 9, but there are 4; {beyond}"),
        format!("a.obj:8: the face refers to uv 7, but there are 1; {beyond}"),
        format!("a.obj:10: the face refers to normal 2, but there are 1; {beyond}"),
        format!("a.obj:11: `a` {corner}"),
        format!("a.obj:12: `-7` {corner}"),
    ];
    assert_eq!(messages(&path, Normals::File), expected, "messages");
    fs::write(&path, "f 0 0 0\n".repeat(50)).expect("written");
    let found = messages(&path, Normals::File);
    assert_eq!(found.len(), 21, "a flood is cut short");
    assert_eq!(found[20], "a.obj: and 30 more problems", "what is cut is counted");
}

#[test]
fn what_is_left_out_is_told() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.obj");
    let text = "mtllib a.mtl b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\np 1\nl 1 2\nf 1 2 3\nusemtl red\nf 1 2 3\nf 1 1 2\n\
                usemtl blue\nf 1 2\nf 3 2 1\ncurv 0 1 1 2\n";
    fs::write(&path, text).expect("written");
    fs::write(dir.path().join("a.mtl"), "newmtl red\nKd 1 0 0\n").expect("written");
    let expected = [
        "warning: a.obj:5: points are ignored, 1 in all",
        "warning: a.obj:6: lines are ignored, 1 in all",
        "warning: a.obj:12: faces with fewer than three corners are ignored, 1 in all",
        "warning: a.obj:14: statements of another kind than polygons are ignored, 1 in all",
        "warning: a.obj: triangles without area are left out, 1 in all",
        "warning: a.obj:1: cannot read `b.mtl`: No such file or directory (os error 2); its materials are made gray and diffuse",
        "warning: a.obj: faces before the first `usemtl` are made gray and diffuse",
    ];
    assert_eq!(messages(&path, Normals::File), expected, "warnings");
    let loaded = load_mesh(&path, Normals::File).expect("good");
    let groups: Vec<u16> = (0..3).map(|i| loaded.mesh.group(i)).collect();
    assert_eq!(groups, [0, 1, 2], "a group per material");
    let names: Vec<&str> = loaded.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["(none)", "red", "blue"], "in order of use");
    let gray = Scattering::Diffuse { reflectance: Texture::gray(0.5) };
    assert_eq!(loaded.materials[2].value.scattering, gray, "undefined");
}

#[test]
fn smooth_normals_average_over_points_not_vertices() {
    // A cube whose faces share positions but not uv; quads are cut in two, which must not tilt the normals.
    let mut text = String::new();
    for i in 0..8 {
        text += &format!("v {} {} {}\n", i & 1, i >> 1 & 1, i >> 2 & 1);
    }
    text += "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    for [a, b, c, d] in [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]] {
        text += &format!("f {a}/1 {b}/2 {c}/3 {d}/4\n");
    }
    let mesh = load_text(&text, Normals::Smooth).mesh;
    assert!(mesh.positions().len() > 8, "uv make more vertices than points");
    for triangle in 0..12 {
        let corners = mesh.corners(triangle);
        for (p, n) in corners.into_iter().zip(mesh.corner_normals(triangle).expect("smooth")) {
            let expected = (p - Vec3::splat(0.5)).normalize();
            assert!(n.abs_diff_eq(expected, 1e-5), "at {p}: {n}, not {expected}");
        }
    }
}

#[test]
fn normals_may_stand_beside_faces_without() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 2\nf 1//1 2//1 3//1\nf 1 2 4\n";
    let mesh = load_text(text, Normals::File).mesh;
    assert_eq!(mesh.corner_normals(0), Some([Vec3::Z * 2.0; 3]), "as written");
    assert_eq!(mesh.corner_normals(1), Some([Vec3::ZERO; 3]), "zero falls back to the triangle");
    assert!(!load_text(text, Normals::Flat).mesh.has_normals(), "flat");
}

#[test]
fn what_writers_of_files_take_for_granted_is_read() {
    // Comments after statements, colours and weights of positions, continued lines, uv of one number, indices ahead and
    // backwards, objects in between.
    let text = "o one # name\nv 0 0 0 # origin\nv 1 0 0 0.5 0.5 0.5\nvt 0.5\nf 1/1 2/-1 \\\n 3/1 # half\no two\n\
                v 0 1 0 2\nvt 0.25 0.75 0\nf -3/2 -2/2 -1/2\n";
    let mesh = load_text(text, Normals::File).mesh;
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    assert_eq!((mesh.corners(0), mesh.corners(1)), (corners, corners), "positions");
    assert_eq!(mesh.positions().len(), 6, "vertices with other uv are apart");
}

#[test]
fn indices_far_away_are_refused() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.obj");
    for odd in ["1/-9223372036854775808", "1/9223372036854775807", "1//-2", "1//4294967296", "1/1/1/1", "/1"]
    {
        fs::write(&path, format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1 2 {odd}\n"))
            .expect("written");
        let found = messages(&path, Normals::File);
        assert_eq!(found.len(), 1, "{odd}: {found:?}");
        assert!(found[0].starts_with("a.obj:6: "), "{odd}: {found:?}");
    }
}

#[test]
fn odd_normals_and_libraries_do_no_harm() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.obj");
    let text =
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn nan 0 0\nusemtl red\nf 1//1 2//1 3//2\n";
    fs::write(&path, text).expect("written");
    fs::write(dir.path().join("a.mtl"), "newmtl\nKd 1 0 0\n").expect("written");
    let expected = [
        "warning: a.obj:6: normals that are not finite are ignored, 1 in all",
        "warning: a.mtl:1: a material without a name; only faces after a `usemtl` without a name have it; name it",
        "warning: a.obj:7: material `red` is not defined; it is made gray and diffuse; define it in the file of `mtllib`",
    ];
    assert_eq!(messages(&path, Normals::File), expected, "warnings");
    let mesh = load_mesh(&path, Normals::File).expect("good").mesh;
    assert_eq!(mesh.corner_normals(0), Some([Vec3::Z, Vec3::Z, Vec3::ZERO]), "zero falls back");
}

#[test]
fn too_many_materials_are_refused() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.obj");
    let faces: String = (0..65536).map(|i| format!("usemtl {i}\nf 1 2 3\n")).collect();
    fs::write(&path, format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}")).expect("written");
    let expected = ["a.obj:131074: a mesh can have 65535 materials; use fewer, or split the file"];
    assert_eq!(messages(&path, Normals::Flat), expected, "one too many");
}

/// References to normals or uv that the file does not have at all are those of another exporter's habit; the rest is good.
#[test]
fn faces_may_refer_to_what_no_file_has() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.obj");
    let text =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.5\nf 1/1/1 2/1/2 3/1/7\nf 1//1 2//1 3//1\nf 1/1 2/1 3/1\n";
    fs::write(&path, text).expect("written");
    let expected = ["warning: a.obj:5: normals of faces, of which the file has none, are ignored, 2 in all"];
    assert_eq!(messages(&path, Normals::File), expected, "warnings");
    let mesh = load_mesh(&path, Normals::File).expect("good").mesh;
    assert!(!mesh.has_normals() && mesh.triangles().len() == 3, "the triangles are there");
    assert_eq!(mesh.corner_uvs(0), Some([glam::Vec2::splat(0.5); 3]), "and so are the uv");
    fs::write(&path, text.replace("vt 0.5 0.5", "")).expect("written");
    assert_eq!(messages(&path, Normals::File).len(), 2, "neither");
    fs::write(&path, format!("{text}vn 0 0 1\n")).expect("written");
    let found = messages(&path, Normals::File);
    assert!(found.len() == 1 && found[0].starts_with("a.obj:5: the face refers to normal 2"), "{found:?}");
}

#[test]
fn absurd_coordinates_are_refused_and_tiny_ones_read() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.obj");
    let triangle = |size: &str| format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nf 1 2 3\n");
    fs::write(&path, triangle("-1.1e18")).expect("written");
    let expected = [2, 3]
        .map(|line| format!("a.obj:{line}: `-1.1e18` is farther than 1e18 from zero; scale the model down"));
    assert_eq!(messages(&path, Normals::File), expected, "too far");
    for size in ["1e18", "1e10", "1e-10", "1e-25", "1e-38"] {
        let mesh = load_text(&triangle(size), Normals::Smooth).mesh;
        let normals = mesh.corner_normals(0).expect("smooth");
        assert!(normals.iter().all(|n| n.abs_diff_eq(Vec3::Z, 1e-6)), "{size}: {normals:?}");
    }
}

#[test]
fn names_in_other_encodings_stay_apart() {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.obj");
    let text = b"mtllib a\\ b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl \xe4\nf 1 2 3\nusemtl \xf6\nf 3 2 1\n";
    fs::write(&path, text).expect("written");
    fs::write(dir.path().join("a b.mtl"), b"newmtl \xe4\nKd 0.25\nnewmtl \xf6\nKd 0.75\n").expect("written");
    let loaded = load_mesh(&path, Normals::File).expect("good");
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let found: Vec<Scattering> = loaded.materials.into_iter().map(|named| named.value.scattering).collect();
    let expected = [0.25, 0.75].map(|x| Scattering::Diffuse { reflectance: Texture::gray(x) });
    assert_eq!(found, expected, "two materials whose names differ in one letter of Latin-1");
}

#[test]
fn lines_may_end_and_go_on_in_any_way() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n# C:\\models\\\nf 1 2 3\n";
    let continued = text.replace("f 1 2 3", &format!("f 1 2 {}3", "\\\n".repeat(100_000)));
    let macintosh = text.replace('\n', "\r");
    for text in [text, &text.replace('\n', "\r\n"), &macintosh, &continued] {
        let corners = load_text(text, Normals::File).mesh.corners(0);
        assert_eq!(corners, [Vec3::ZERO, Vec3::X, Vec3::Y], "{}", &text[..60.min(text.len())]);
    }
}
