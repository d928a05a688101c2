//! Every mesh file there is gives what `mesh_files.txt` says: triangles, groups and warnings, or the reasons of its refusal.
//!
//! What matters of each file is in that table, judged by hand. Skipped where the public models are absent.

#[path = "support/data.rs"]
mod data;

use data::data;
use glam::{DVec3, Vec3};
use specula::scene::description::Normals;
use specula::scene::load::{LoadedMesh, load_mesh};
use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// All mesh files under a folder, sorted.
fn mesh_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in folder.read_dir().expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(mesh_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "obj" || extension == "ply") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// What comes of a file, a line for itself and one for each warning or fault.
fn outcome(path: &Path, data: &Path) -> String {
    let name = path.strip_prefix(data).expect("a file of the data").display();
    let folder = format!("{}/", path.parent().expect("a folder").display());
    let mut lines = String::new();
    let (kind, problems) = match load_mesh(path, Normals::File) {
        Ok(LoadedMesh { mesh, warnings, .. }) => {
            let normals = if mesh.has_normals() { ", normals" } else { "" };
            let (triangles, groups) = (mesh.triangles().len(), mesh.group_count());
            writeln!(lines, "{name}: {triangles} triangles, {groups} groups{normals}").expect("text");
            ("warning", warnings.iter().map(ToString::to_string).collect())
        }
        Err(error) => {
            writeln!(lines, "{name}: refused").expect("text");
            ("error", error.to_string().lines().map(String::from).collect::<Vec<_>>())
        }
    };
    for problem in problems {
        writeln!(lines, "    {kind}: {}", problem.replace(&folder, "")).expect("text");
    }
    lines
}

#[test]
fn every_file_gives_what_the_table_says() {
    let Some(data) = data("") else { return };
    let folders = ["models/obj", "models/ply", "models/awkward", "scenes"];
    let files: Vec<PathBuf> = folders.iter().flat_map(|folder| mesh_files(&data.join(folder))).collect();
    let found: Vec<String> = files.iter().map(|path| outcome(path, &data)).collect();
    let written = Path::new(env!("CARGO_TARGET_TMPDIR")).join("mesh_files.txt");
    fs::write(&written, found.concat()).expect("written");
    let expected = include_str!("mesh_files.txt");
    for block in &found {
        let at = written.display();
        assert!(expected.contains(block.as_str()), "not in the table, but in {at}:\n{block}");
    }
    let lines = |text: &str| text.lines().count();
    assert_eq!(lines(expected), found.iter().map(|block| lines(block)).sum::<usize>(), "lines of the table");
}

/// Positions and polygons of an OBJ file without continued lines, read the simplest way.
fn polygons(text: &str) -> (Vec<DVec3>, Vec<Vec<usize>>) {
    let text = text.replace("\\\r\n", " ").replace("\\\n", " ");
    let (mut positions, mut polygons) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let p: Vec<f32> = words.take(3).map(|word| word.parse().expect("a number")).collect();
                positions.push(Vec3::from_slice(&p).as_dvec3());
            }
            Some("f") => polygons.push(
                words
                    .map(|word| {
                        let index = word.split('/').next().expect("a word").parse::<i64>().expect("an index");
                        let back = i64::try_from(positions.len()).expect("few");
                        usize::try_from(if index < 0 { index + back } else { index - 1 }).expect("from 1")
                    })
                    .collect(),
            ),
            _ => {}
        }
    }
    (positions, polygons)
}

/// Triangles of flat polygons cover as much as the polygons do: more where they overlap, less where some are missing.
#[test]
fn triangles_cover_as_much_as_polygons() {
    let Some(models) = data("models") else { return };
    let files = [
        ("awkward/assimp-obj/concave_polygon.obj", 1e-5),
        ("awkward/assimp-obj/box.obj", 1e-6),
        ("awkward/assimp-obj/regr01.obj", 1e-4),
        ("awkward/assimp-obj/space_in_material_name.obj", 1e-5),
        ("awkward/tinyobj/issue-295-trianguation-failure.obj", 1e-6),
        ("awkward/tinyobj/issue-319-002.obj", 1e-3),
        ("obj/legocar.obj", 1e-5),
        ("obj/sponza.obj", 1e-2),
        ("obj/wine_glass.obj", 1e-3),
    ];
    for (file, tolerance) in files {
        let path = models.join(file);
        let (positions, polygons) = polygons(&String::from_utf8_lossy(&fs::read(&path).expect(file)));
        let area = |polygon: &Vec<usize>| {
            let p = |i: usize| positions[polygon[i % polygon.len()]] - positions[polygon[0]];
            (0..polygon.len()).map(|i| p(i).cross(p(i + 1))).sum::<DVec3>().length() * 0.5
        };
        let expected: f64 = polygons.iter().map(area).sum();
        let mesh = load_mesh(&path, Normals::Flat).expect(file).mesh;
        let triangles = mesh.triangles().iter().map(|t| t.map(|i| mesh.positions()[i as usize].as_dvec3()));
        let found: f64 = triangles.map(|[a, b, c]| (b - a).cross(c - a).length() * 0.5).sum();
        assert!((found - expected).abs() <= tolerance * expected, "{file}: {found}, not {expected}");
    }
}

/// A closed body of polygons gives a closed body of triangles: each edge is there as often in one direction as in the
/// other, and what is inside is as much. The floor plan has notches, corners in line and a hole by a bridge.
#[test]
fn closed_bodies_stay_closed() {
    let plan = [
        (0, 0),
        (3, 0),
        (6, 0),
        (9, 0),
        (9, 6),
        (6, 6),
        (6, 4),
        (3, 4),
        (3, 6),
        (0, 6),
        (0, 3),
        (0, 0),
        (1, 1),
        (1, 2),
        (2, 2),
        (2, 1),
        (1, 1),
    ];
    // Positions in order of first use.
    let mut points: Vec<(i32, i32)> = Vec::new();
    let ring: Vec<usize> = plan
        .iter()
        .map(|p| {
            points.iter().position(|known| known == p).unwrap_or_else(|| {
                points.push(*p);
                points.len() - 1
            })
        })
        .collect();
    let mut text = String::new();
    for z in [0, 2] {
        points.iter().for_each(|(x, y)| writeln!(text, "v {x} {y} {z}").expect("text"));
    }
    let n = points.len();
    let top: Vec<String> = ring.iter().map(|i| (i + n + 1).to_string()).collect();
    let bottom: Vec<String> = ring.iter().rev().map(|i| (i + 1).to_string()).collect();
    writeln!(text, "f {}\nf {}", top.join(" "), bottom.join(" ")).expect("text");
    for i in 0..ring.len() {
        let (a, b) = (ring[i] + 1, ring[(i + 1) % ring.len()] + 1);
        writeln!(text, "f {a} {b} {} {}", b + n, a + n).expect("text");
    }
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.obj");
    fs::write(&path, text).expect("written");
    let mesh = load_mesh(&path, Normals::Flat).expect("good").mesh;
    let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
    for &[a, b, c] in mesh.triangles().iter() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|&sum| sum == 0), "an edge is open: {edges:?}");
    let six_volumes: f32 = (0..u32::try_from(mesh.triangles().len()).expect("few"))
        .map(|i| mesh.corners(i))
        .map(|[a, b, c]| a.cross(b).dot(c))
        .sum();
    let area = 9.0 * 6.0 - 3.0 * 2.0 - 1.0;
    assert!((six_volumes / 6.0 - area * 2.0).abs() < 1e-3, "volume {}", six_volumes / 6.0);
}

/// Edges turned by more than the crease stay sharp, others are smoothed.
#[test]
fn creases_keep_edges_sharp() {
    use specula::scene::load::Shading;
    // A prism of 24 sides: 15 degrees from side to side, 90 to the lids.
    let mut text = String::new();
    let n = 24;
    for i in 0..n {
        let (y, x) = (f64::from(i) * std::f64::consts::TAU / f64::from(n)).sin_cos();
        writeln!(text, "v {x} {y} 0\nv {x} {y} 1").expect("text");
    }
    for i in 0..n {
        let j = (i + 1) % n;
        writeln!(text, "f {} {} {} {}", 2 * i + 1, 2 * j + 1, 2 * j + 2, 2 * i + 2).expect("text");
    }
    let lid = |offset: i32| (0..n).map(|i| (2 * i + offset).to_string()).collect::<Vec<_>>();
    let bottom: Vec<String> = lid(1).into_iter().rev().collect();
    writeln!(text, "f {}\nf {}", lid(2).join(" "), bottom.join(" ")).expect("text");
    let dir = tempfile::tempdir().expect("a temporary directory");
    let path = dir.path().join("a.obj");
    fs::write(&path, text).expect("written");
    let load =
        |crease_deg| load_mesh(&path, Shading { normals: Normals::Smooth, crease_deg }).expect("good").mesh;
    let counts = [180.0, 100.0, 30.0, 10.0].map(|crease| load(crease).positions().len());
    assert_eq!(counts, [48, 48, 96, 48 * 3], "vertices: all shared, all shared, lids apart, all apart");
    let mesh = load(30.0);
    for triangle in 0..u32::try_from(mesh.triangles().len()).expect("few") {
        let [a, b, c] = mesh.corners(triangle);
        let flat = (b - a).cross(c - a).normalize();
        for (p, normal) in [a, b, c].into_iter().zip(mesh.corner_normals(triangle).expect("smooth")) {
            let expected = if flat.z.abs() > 0.5 { flat } else { Vec3::new(p.x, p.y, 0.0) };
            assert!(normal.abs_diff_eq(expected, 1e-5), "at {p}: {normal}, not {expected}");
        }
    }
}
