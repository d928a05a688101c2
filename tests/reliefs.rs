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

/// A slope of 64 by 8 texels, each 2/255 above its left neighbour.
fn slope(folder: &Folder, name: &str) {
    let ramp = image::GrayImage::from_fn(64, 8, |x, _| image::Luma([u8::try_from(2 * x).expect("small")]));
    ramp.save(folder.path().join(name)).expect("written");
}

#[test]
fn a_plane_whose_heights_grow_is_as_bright_as_one_that_leans() {
    let folder = folder();
    slope(&folder, "slope.png");
    let leaning = |slope: f32| glam::Vec3::new(-slope, 0.0, 1.0);
    // 64 by 8 texels over two by two metres: texels are 1/32 by 1/4 m, as wide as their root on average.
    let texel = (2.0_f32 / 64.0 * 2.0 / 8.0).sqrt();
    let per_metre = 2.0 / 255.0 * 32.0;
    let cases = [
        ("bump = { file = \"slope.png\", height = 0.0 }", leaning(0.0)),
        ("bump = { file = \"slope.png\", height = 1.5 }", leaning(1.5 * per_metre)),
        ("bump = { file = \"slope.png\", height = -1.5 }", leaning(-1.5 * per_metre)),
        ("bump = { file = \"slope.png\", strength = 20 }", leaning(20.0 * texel * per_metre)),
        // Half as wide, as often repeated: twice as steep in metres, as steep in texels but for the mean of their edges.
        (
            "bump = { file = \"slope.png\", height = 1.5, repeat = [2, 1], offset = [0.3, 0] }",
            leaning(3.0 * per_metre),
        ),
        (
            "bump = { file = \"slope.png\", strength = 20, repeat = [2, 1], offset = [0.3, 0] }",
            leaning(20.0 * texel * 2.0_f32.sqrt() * per_metre),
        ),
    ];
    for way in WAYS {
        for (material, n) in cases {
            let found = value(&picture(&folder.scene(&lit(way, material, UPRIGHT))));
            assert!((found - expected(n)).abs() < 1e-4, "{way}, {material}: {found}, not {}", expected(n));
        }
    }
}

#[test]
fn mtl_files_bring_heights_and_normals_by_the_same_name() {
    let folder = folder();
    slope(&folder, "slope.png");
    let square = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    folder.write("bumpy.obj", &format!("mtllib bumpy.mtl\n{square}usemtl m\nf 1/1 2/2 3/3 4/4\n"));
    let text = lit(WAYS[1], "", UPRIGHT)
        .replace("type = \"rectangle\"", "type = \"mesh\"\nfile = \"bumpy.obj\"")
        .replace(UPRIGHT, "")
        .replace("        material = \"m\"\n", "");
    let steep = 20.0 * (2.0_f32 / 64.0 * 2.0 / 8.0).sqrt() * 2.0 / 255.0 * 32.0;
    let n = leaning();
    let cases = [
        ("-bm 20 slope.png", glam::Vec3::new(-steep, 0.0, 1.0), 0),
        ("lean.png", n, 0),
        ("-bm 0.3 lean.png", glam::Vec3::new(0.3 * n.x, 0.3 * n.y, n.z), 0),
        // Of heights it would be their other side.
        ("-bm -0.3 lean.png", n, 1),
    ];
    for (map, n, ignored) in cases {
        folder.write("bumpy.mtl", &format!("newmtl m\nKd 0.5 0.5 0.5\nmap_Bump {map}\n"));
        let built = folder.load(&text).expect("a scene");
        let found = value(&picture(&built.scene));
        assert!((found - expected(n)).abs() < 1e-4, "{map}: {found}, not {}", expected(n));
        let told = built.warnings.iter().filter(|it| it.what.contains("`-bm` of -0.3 is ignored")).count();
        assert_eq!(told, ignored, "{map}: {:?}", built.warnings);
    }
}
