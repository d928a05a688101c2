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
metal = "Au"

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
    for part in ["bad.obj:2", "scene.toml:14:", "a second environment; keep one"] {
        assert!(found.contains(part), "`{part}` is missing from\n{found}");
    }
    assert!(found.lines().count() >= 4, "not all are told:\n{found}");
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

#[test]
fn round_bodies_that_shine_are_refused_wherever_they_stand() {
    for kind in ["cylinder", "cone", "torus"] {
        for transform in
            ["", "transform = [{ translate = [1, 0, 0] }]", "transform = [{ scale = [1.0, 2.0, 1.0] }]"]
        {
            let text = format!(
                "[materials.lamp]\ntype = \"emission\"\nradiance = 1.0\n[[shapes]]\ntype = \"{kind}\"\n\
                 material = \"lamp\"\n{transform}\n"
            );
            let found = problems(&text, &[]);
            let expected = "scene.toml:4:1: only meshes, spheres and discs can be lights; use one of those";
            assert_eq!(found, expected, "{text}");
        }
    }
}

#[test]
fn pictures_that_are_no_heights_are_refused_with_place_and_remedy() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = |width: u32, height: u32, values: &[f32]| {
        let path = folder.path().join("a.hdr");
        // Radiance without run lengths: equal mantissas under an exponent.
        let mut bytes =
            format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
        for value in values {
            let mantissa = if *value > 0.0 { 128 } else { 0 };
            bytes.extend([mantissa, mantissa, mantissa / 2, if mantissa > 0 { 128 } else { 0 }]);
        }
        fs::write(&path, bytes).expect("a picture");
        path.display().to_string()
    };
    let scene = |file: &str| {
        format!(
            "[materials.m]\ntype = \"diffuse\"\n[[shapes]]\ntype = \"height_field\"\nmaterial = \"m\"\n\
             file = \"{file}\"\n"
        )
    };
    let found = problems(&scene(&picture(2, 2, &[0.0, 0.0, 0.0, 1.0])), &[]);
    assert!(
        found.ends_with(
            "a.hdr: a colour picture, where one number per pixel is needed; save it in shades of gray"
        ),
        "{found}"
    );
    let found = problems(&scene(&picture(3, 1, &[0.0; 3])), &[]);
    assert!(
        found.contains("a.hdr: 3 by 1 heights span no area: two columns and two rows are the least"),
        "{found}"
    );
    assert_eq!(problems(&scene(&picture(2, 2, &[0.0; 4])), &[]), "", "a flat field");
}

#[test]
fn shapes_made_of_numbers_that_are_too_large_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let heights = folder.path().join("a.png");
    image::GrayImage::from_pixel(2, 2, image::Luma([255])).save(&heights).expect("a picture");
    let shapes = [
        "[[shapes]]\nmaterial = \"m\"\ntype = \"rectangle\"\nedge_u = [1e19, 0, 0]\nedge_v = [0, 1, 0]".to_owned(),
        "[[shapes]]\nmaterial = \"m\"\ntype = \"rectangle\"\nedge_u = [3e38, 0, 0]\nedge_v = [3e38, 3e38, 0]".to_owned(),
        "[[shapes]]\nmaterial = \"m\"\ntype = \"box\"\nmin = [0, 0, 0]\nmax = [1e19, 1, 1]".to_owned(),
        "[[lights]]\ntype = \"rectangle\"\ncenter = [0, 0, 2e18]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\nradiance = 1"
            .to_owned(),
        format!(
            "[[shapes]]\nmaterial = \"m\"\ntype = \"height_field\"\nheight = [0, 1e19]\nfile = \"{}\"",
            heights.display()
        ),
    ];
    for shape in shapes {
        let found = problems(&format!("[materials.m]\ntype = \"diffuse\"\n{shape}\n"), &[]);
        assert!(found.starts_with("scene.toml:3:1: vertex "), "{shape}\n{found}");
        assert!(found.ends_with("; scale the scene down") && found.lines().count() == 1, "{shape}\n{found}");
    }
}

const LAMP: &str = "newmtl a\nKe 1 1 1\nnewmtl b\nKe 2 2 2\nnewmtl c\nKd 1 1 1\n";

#[test]
fn meshes_that_shine_in_parts_are_told_why_they_cannot() {
    let text = "[[shapes]]\ntype = \"mesh\"\nfile = \"a.obj\"\n";
    let mesh = |second: &str| {
        format!("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl {second}\nf 1 3 2\n")
    };
    let found = |second: &str| problems(text, &[("a.obj", &mesh(second)), ("a.mtl", LAMP)]);
    assert_eq!(
        found("b"),
        "scene.toml:1:1: a mesh that emits in more than one material cannot be asked for light; \
         split it into a file for each of them"
    );
    assert_eq!(
        found("c"),
        "scene.toml:1:1: a mesh that emits in some of its groups only cannot be asked for light; \
         split the emitting part off into a file of its own"
    );
}

#[test]
fn a_mesh_light_beyond_all_numbers_is_told() {
    let text = "[camera]\nfrom = [-5e34, 0, 0]\nat = [-4.999999999999999e34, 0, 0]\n[[lights]]\ntype = \"mesh\"\nfile = \"a.obj\"\n\
                radiance = 1\ntransform = [{ translate = [3.4028234e38, 0, 0] }]\n";
    let found = problems(text, &[("a.obj", TRIANGLE)]);
    assert!(
        found.contains("scene.toml:4:1: a mesh light is carried infinitely far from the camera"),
        "{found}"
    );
}
