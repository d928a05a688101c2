//! What has no effect is left out and told, and the picture stays.

use crate::pictures;
use crate::support::{bits, film, loaded};
use specula::geometry::Shape;
use specula::material::Scattering;
use specula::scene::needs::capability::Capability;
use specula::scene::pruned::Ineffective;
use specula::scene::{self, Built, Needs, Pruned, Wanted};
use std::fs;
use std::path::Path;

/// A gray picture of one shade, and one of two.
fn pictures(folder: &Path) {
    let write = |name: &str, pixels: [[u8; 3]; 4]| {
        let image = image::RgbImage::from_fn(2, 2, |x, y| image::Rgb(pixels[(y * 2 + x) as usize]));
        image.save(folder.join(name)).expect("a picture");
    };
    write("flat.png", [[120, 60, 30]; 4]);
    write("white.png", [[255; 3]; 4]);
    write("black.png", [[0; 3]; 4]);
    write("varied.png", [[120, 60, 30], [10, 60, 30], [120, 200, 30], [120, 60, 90]]);
}

const MESH: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";

const SCENE: &str = r#"
[camera]
from = [0.0, 1.0, 4.0]
at = [0.0, 0.5, 0.0]
[film]
width = 40
height = 30
[render]
integrator = "path"
spp = 8
max_depth = 5
[materials.floor]
type = "diffuse"
reflectance = { checker = [[0.5, 0.4, 0.3], [0.5, 0.4, 0.3]] }
[materials.flat]
type = "diffuse"
reflectance = { file = "flat.png" }
[materials.varied]
type = "diffuse"
reflectance = { file = "varied.png" }
opacity = { file = "white.png" }
bump = { file = "flat.png" }
[materials.hole]
type = "diffuse"
opacity = { file = "black.png" }
[materials.dull]
type = "glossy"
reflectance = 0.0
diffuse = [0.2, 0.5, 0.3]
[materials.coal]
type = "diffuse"
reflectance = 0.0
[materials.gold]
type = "conductor"
metal = "Au"
[materials.mixed]
type = "mix"
parts = [{ material = "gold", weight = 0.5 }, { material = "dull", weight = 0.0 }, { material = "floor", weight = 0.5 }]
[materials.unused]
type = "dielectric"
absorption = 2.0
[[shapes]]
type = "rectangle"
edge_u = [4.0, 0.0, 0.0]
edge_v = [0.0, 0.0, -4.0]
material = "floor"
[[shapes]]
type = "mesh"
file = "quad.obj"
material = "flat"
transform = [{ translate = [-1.5, 0.0, 0.0] }]
[[shapes]]
type = "mesh"
file = "quad.obj"
material = "varied"
transform = [{ rotate_deg = 20.0, axis = [0, 1, 0] }]
[[shapes]]
type = "mesh"
file = "same.obj"
material = "dull"
transform = [{ translate = [0.8, 0.0, -1.0] }]
[[shapes]]
type = "rectangle"
center = [0.0, 0.5, 1.0]
edge_u = [0.5, 0.0, 0.0]
edge_v = [0.0, 0.5, 0.0]
material = "hole"
[[shapes]]
type = "sphere"
center = [-0.5, 0.3, 1.0]
radius = 0.3
material = "mixed"
[[shapes]]
type = "sphere"
center = [0.6, 0.3, 1.0]
radius = 0.3
material = "coal"
[[shapes]]
name = "ghost"
type = "sphere"
radius = 9.0
hidden = true
material = "flat"
[[lights]]
type = "point"
position = [0.0, 3.0, 3.0]
intensity = 0.0
[[lights]]
type = "rectangle"
center = [0.0, 3.0, 1.0]
edge_u = [0.5, 0.0, 0.0]
edge_v = [0.0, 0.0, 0.5]
radiance = 6.0
[[lights]]
type = "environment"
radiance = 0.2
"#;

/// The scene as it is, and with what has no effect left out.
fn both() -> [Built; 2] {
    let folder = tempfile::tempdir().expect("a folder");
    pictures(folder.path());
    for name in ["quad.obj", "same.obj"] {
        fs::write(folder.path().join(name), MESH).expect("a mesh");
    }
    let path = folder.path().join("scene.toml");
    fs::write(&path, SCENE).expect("a scene");
    let description = loaded::<&str>(&path, &[]).description;
    [Wanted::anything(), Wanted::default()]
        .map(|wanted| scene::build_for(&description, &wanted).unwrap_or_else(|error| panic!("{error}")))
}

#[test]
fn everything_without_effect_is_told_with_its_place() {
    let [whole, pruned] = both();
    let of = |kind: Ineffective| {
        let found = pruned.pruned.iter().filter(|it| it.kind == kind).map(|it| it.what.clone());
        found.collect::<Vec<_>>()
    };
    assert_eq!(
        of(Ineffective::Object),
        ["its opacity is below a half everywhere", "`ghost` is hidden and has no instance that is seen"],
        "objects"
    );
    assert_eq!(of(Ineffective::Light), ["never asked"], "lights");
    assert_eq!(
        of(Ineffective::Lobe),
        [
            "`dull`: its fuzzy mirror reflects nothing",
            "`coal`: it reflects nothing",
            "`mixed`: `dull` has a weight of zero"
        ],
        "lobes"
    );
    assert_eq!(
        of(Ineffective::Texture),
        [
            "`floor`: of one colour",
            "`flat`: of one colour",
            "`varied`: a relief that is even",
            "`varied`: an opacity without holes"
        ],
        "textures"
    );
    assert_eq!(of(Ineffective::Mesh).len(), 2, "the second of one file, and its copy: {:?}", pruned.pruned);
    assert_eq!(of(Ineffective::Material), ["`unused`"], "materials");
    let told: Vec<String> = pruned.pruned.iter().map(Pruned::to_string).collect();
    assert!(told.iter().all(|line| line.contains("scene.toml:")), "{told:#?}");
    let line = SCENE.lines().position(|line| line == "[materials.unused]").expect("there") + 1;
    assert!(told.iter().any(|told| told.contains(&format!("scene.toml:{line}:"))), "line {line}: {told:#?}");
    assert!(
        whole.pruned.iter().all(|it| matches!(it.kind, Ineffective::Light | Ineffective::Object)),
        "{whole:?}"
    );
}

#[test]
fn what_a_library_keeps_is_not_in_the_scene_for_that() {
    let folder = tempfile::tempdir().expect("a folder");
    pictures(folder.path());
    let path = folder.path().join("scene.toml");
    let flat = "[materials.flat]\ntype = \"diffuse\"\nreflectance = { file = \"flat.png\" }\n";
    fs::write(&path, format!("{flat}[[shapes]]\ntype = \"sphere\"\nmaterial = \"flat\"\n")).expect("a scene");
    let description = loaded::<&str>(&path, &[]).description;
    let library = std::sync::Arc::new(scene::Library::of_bytes(1 << 20));
    let from = (&specula::trust::Trust::default(), &library);
    let built = scene::build_from(&description, &Wanted::default(), from).expect("a scene");
    assert!(library.bytes() > 0, "the picture is kept");
    assert!(built.scene.textures.is_empty(), "of one colour");
}

#[test]
fn light_by_a_pattern_stays_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    let lamp = "[materials.lamp]\ntype = \"emission\"\nradiance = { checker = [0.5, 0.5] }\n";
    fs::write(&path, format!("{lamp}[[shapes]]\ntype = \"sphere\"\nmaterial = \"lamp\"\n")).expect("a scene");
    let description = loaded::<&str>(&path, &[]).description;
    for wanted in [Wanted::anything(), Wanted::default()] {
        let error = scene::build_for(&description, &wanted).expect_err("a ball").to_string();
        assert!(error.contains("only meshes and rectangles can emit light by a texture"), "{error}");
    }
}

#[test]
fn what_is_left_is_less() {
    let [whole, pruned] = both();
    let needs = [&whole, &pruned].map(|built| Needs::of(&built.scene, &Wanted::default()));
    let [before, after] = &needs;
    assert!(before.count(Capability::CutOuts) > 0, "filters for opacities");
    assert_eq!(after.count(Capability::CutOuts), 0, "no filter is left");
    assert_eq!(after.count(Capability::Reliefs), 0, "no relief is left");
    assert_eq!(after.count(Capability::Media), 0, "the only glass was not used");
    assert_eq!(after.count(Capability::ImageTextures), 1, "the picture that varies");
    assert_eq!(pruned.scene.textures.len(), 2, "and that of the hole: {:?}", pruned.scene.textures.len());
    assert_eq!((before.placements, after.placements), (8, 7), "the hole is gone");
    assert!(after.mesh_bytes < before.mesh_bytes, "{} of {}", after.mesh_bytes, before.mesh_bytes);
    let dull = pruned.scene.names.materials.iter().position(|name| name == "dull").expect("named");
    assert!(matches!(pruned.scene.materials[dull].scattering, Scattering::Diffuse { .. }), "its base");
    let meshes = pruned.scene.world.shapes.iter();
    let triangles: Vec<_> = meshes
        .filter_map(
            |shape| if let Shape::Mesh(mesh) = shape { Some(mesh.triangles().as_ptr()) } else { None },
        )
        .collect();
    assert!(
        triangles[1] == triangles[2] && triangles[1] == triangles[3],
        "one array of indices for three copies"
    );
}

#[test]
fn the_picture_stays() {
    let [whole, pruned] = both().map(|built| film(&built.scene).image());
    // Texels that are all the same, interpolated, are the same to rounding.
    assert_eq!(pictures::differing(&pruned, &whole, 1e-5, 1e-8), 0, "pixels");
}

#[test]
fn without_textures_the_picture_stays_to_the_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("quad.obj"), MESH).expect("a mesh");
    let path = folder.path().join("scene.toml");
    let plain = SCENE
        .replace("{ file = \"flat.png\" }", "0.3")
        .replace("{ file = \"varied.png\" }", "{ checker = [0.2, 0.6] }")
        .replace("\"same.obj\"", "\"quad.obj\"")
        .replace("bump = 0.3\n", "")
        .replace("opacity = { file = \"white.png\" }\n", "")
        .replace("opacity = { file = \"black.png\" }\n", "");
    fs::write(&path, plain).expect("a scene");
    let description = loaded::<&str>(&path, &[]).description;
    let film = |wanted: &Wanted| {
        let built = scene::build_for(&description, wanted).unwrap_or_else(|error| panic!("{error}"));
        bits(&film(&built.scene))
    };
    assert!(film(&Wanted::anything()) == film(&Wanted::default()), "another picture");
}
