//! Normal maps: a plane whose picture leans is shaded as a plane that leans.

#[path = "support/folder.rs"]
#[expect(dead_code, reason = "scenes of its own")]
mod folder;

use folder::{Folder, picture};
use image::RgbImage;
use specula::image::Image;

/// A square that fills the picture, lit along a direction from the upper left.
fn lit(way: &str, material: &str, edges: &str) -> String {
    format!(
        r#"
        [camera]
        from = [0.0, 0.0, 10.0]
        at = [0.0, 0.0, 0.0]
        vfov_deg = 8.0
        [film]
        width = 8
        height = 8
        filter = "box"
        [render]
        {way}
        [materials.m]
        type = "diffuse"
        reflectance = 0.5
        {material}
        [[shapes]]
        type = "rectangle"
        {edges}
        material = "m"
        [[lights]]
        type = "directional"
        direction = [0.4, -0.3, -1.0]
        irradiance = 3.0
        "#
    )
}

const UPRIGHT: &str = "edge_u = [1.0, 0.0, 0.0]\nedge_v = [0.0, 1.0, 0.0]";

const WAYS: [&str; 3] = [
    "integrator = \"path\"\nmax_depth = 2\nquery = \"single\"\nspp = 16",
    "integrator = \"path\"\nmax_depth = 2\nquery = \"stream\"\nspp = 16",
    "integrator = \"whitted\"\nspp = 16",
];

fn folder() -> Folder {
    let folder = Folder::new();
    // (0.247, -0.2, 0.949): as bytes say it.
    let leaning = RgbImage::from_pixel(4, 4, image::Rgb([159, 102, 249]));
    leaning.save(folder.path().join("lean.png")).expect("written");
    folder
}

fn value(image: &Image) -> f32 {
    image.pixel(4, 4).g
}

/// What a matt surface of reflectance a half shows whose normal has this direction.
fn expected(n: glam::Vec3) -> f32 {
    let towards = glam::Vec3::new(-0.4, 0.3, 1.0).normalize();
    0.5 / std::f32::consts::PI * 3.0 * n.normalize().dot(towards).max(0.0)
}

fn leaning() -> glam::Vec3 {
    glam::Vec3::new(159.0, 102.0, 249.0) / 255.0 * 2.0 - 1.0
}

#[test]
fn a_plane_that_is_said_to_lean_is_as_bright_as_one_that_does() {
    let folder = folder();
    for way in WAYS {
        let n = leaning();
        let cases = [
            ("", glam::Vec3::Z),
            ("normal_map = { file = \"lean.png\" }", n),
            ("normal_map = { file = \"lean.png\", strength = 0 }", glam::Vec3::Z),
            (
                "normal_map = { file = \"lean.png\", strength = 2 }",
                glam::Vec3::new(2.0 * n.x, 2.0 * n.y, n.z),
            ),
            ("normal_map = { file = \"lean.png\", flip_y = true }", glam::Vec3::new(n.x, -n.y, n.z)),
        ];
        for (material, n) in cases {
            let found = value(&picture(&folder.scene(&lit(way, material, UPRIGHT))));
            assert!((found - expected(n)).abs() < 1e-4, "{way}, {material}: {found}, not {}", expected(n));
        }
    }
}

#[test]
fn reliefs_lie_as_the_surface_parameters_do() {
    let folder = folder();
    let n = leaning();
    let cases = [
        // A quarter turn: u is up, v to the left.
        ("edge_u = [0.0, 1.0, 0.0]\nedge_v = [-1.0, 0.0, 0.0]", glam::Vec3::new(-n.y, n.x, n.z)),
        // Stretched: directions stay.
        ("edge_u = [3.0, 0.0, 0.0]\nedge_v = [0.0, 1.0, 0.0]", n),
    ];
    for way in WAYS {
        for (edges, n) in cases {
            let scene = folder.scene(&lit(way, "normal_map = { file = \"lean.png\" }", edges));
            let found = value(&picture(&scene));
            assert!((found - expected(n)).abs() < 1e-4, "{way}, {edges}: {found}, not {}", expected(n));
        }
    }
}

#[test]
fn mirrored_parameters_mirror_the_relief() {
    let folder = folder();
    folder.write(
        "mirrored.obj",
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 1 0\nvt 0 0\nvt 0 1\nvt 1 1\nf 1/1 2/2 3/3 4/4\n",
    );
    let n = leaning();
    let n = glam::Vec3::new(-n.x, n.y, n.z);
    for way in WAYS {
        let text = lit(way, "normal_map = { file = \"lean.png\" }", UPRIGHT)
            .replace("type = \"rectangle\"", "type = \"mesh\"\nfile = \"mirrored.obj\"")
            .replace(UPRIGHT, "");
        let found = value(&picture(&folder.scene(&text)));
        assert!((found - expected(n)).abs() < 1e-4, "{way}: {found}, not {}", expected(n));
    }
}
