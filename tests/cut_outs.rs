//! Holes by opacity are holes: every backend and every integrator sees through them, as through holes of geometry.

#[path = "support/folder.rs"]
mod folder;

use folder::{Folder, WAYS, frontal, picture, square};
use image::{GrayImage, Luma, Rgba, RgbaImage};
use specula::image::Window;
use specula::image::exr::{self, Channel, Picture, Samples};
use specula::math::Rgb;
use specula::scene::{self, Wanted};

const BACKENDS: [&str; 4] = ["embree", "bvh2", "cwbvh", "brute"];

/// A picture whose right half is there, as a shade of gray and as coverage.
fn folder() -> Folder {
    let folder = Folder::new();
    let half = |x: u32| if x < 8 { 0 } else { 255 };
    GrayImage::from_fn(16, 2, |x, _| Luma([half(x)])).save(folder.path().join("half.png")).expect("written");
    let covered = RgbaImage::from_fn(16, 2, |x, _| Rgba([255, 0, 0, half(x)]));
    covered.save(folder.path().join("covered.png")).expect("written");
    folder
}

/// A black wall behind what is cut out, whose left half is missing.
const WALL: &str = "
    [materials.black]
    type = \"diffuse\"
    reflectance = 0
    [[shapes]]
    type = \"rectangle\"
    center = [0, 0, -1]
    edge_u = [2, 0, 0]
    edge_v = [0, 2, 0]
    material = \"black\"
    [materials.white]
    type = \"mirror\"
    ";

const CUT: &str = "opacity = { file = \"half.png\" }
    [[shapes]]
    type = \"rectangle\"
    edge_u = [1, 0, 0]
    edge_v = [0, 1, 0]
    material = \"white\"";

const GEOMETRY: &str = "[[shapes]]
    type = \"rectangle\"
    center = [0.5, 0, 0]
    edge_u = [0.5, 0, 0]
    edge_v = [0, 1, 0]
    material = \"white\"";

#[test]
fn a_hole_in_a_picture_is_a_hole() {
    let folder = folder();
    for backend in BACKENDS {
        for way in WAYS {
            let way = format!("{way}\nbackend = \"{backend}\"");
            let cut = picture(&folder.scene(&frontal(&way, &format!("{WALL}{CUT}"))));
            let geometry = picture(&folder.scene(&frontal(&way, &format!("{WALL}{GEOMETRY}"))));
            // The edge of the hole lies between two columns of pixels.
            for (i, (a, b)) in cut.pixels().iter().zip(geometry.pixels()).enumerate() {
                let differs = (a.g - b.g).abs();
                assert!(differs < 1e-3, "{way}, pixel {i}: {a:?}, {b:?}");
            }
            assert!(cut.pixel(2, 8).g < 1e-3 && cut.pixel(13, 8).g > 0.99, "{way}: there is a hole");
        }
    }
}

#[test]
fn light_falls_through_holes() {
    let folder = folder();
    let lit = "
        [[lights]]
        type = \"directional\"
        direction = [0, 0, -1]
        irradiance = 3.14159265
        [materials.white]
        type = \"diffuse\"
        reflectance = 1
        [[shapes]]
        type = \"rectangle\"
        edge_u = [1, 0, 0]
        edge_v = [0, 1, 0]
        material = \"white\"
        [materials.leaf]
        type = \"diffuse\"
        opacity = { file = \"covered.png\" }
        [[shapes]]
        type = \"rectangle\"
        center = [0, 0, 20]
        edge_u = [1, 0, 0]
        edge_v = [0, 1, 0]
        material = \"leaf\"";
    for backend in BACKENDS {
        for way in &WAYS[..3] {
            let way = format!("{way}\nbackend = \"{backend}\"");
            let text = frontal(&way, lit).replace("radiance = 1.0", "radiance = 0.0");
            let shown = picture(&folder.scene(&text));
            assert!((shown.pixel(3, 8).g - 1.0).abs() < 1e-3, "{way}: lit, {:?}", shown.pixel(3, 8));
            assert!(shown.pixel(12, 8).g < 1e-6, "{way}: in the shadow, {:?}", shown.pixel(12, 8));
        }
    }
}

#[test]
fn instances_of_other_materials_have_holes_of_their_own() {
    let folder = folder();
    let rest = format!(
        "{WALL}{CUT}
        name = \"leaf\"
        transform = [{{ scale = [1, 0.5, 1] }}, {{ translate = [0, 0.5, 0] }}]
        [materials.whole]
        type = \"mirror\"
        [[shapes]]
        type = \"instance\"
        of = \"leaf\"
        material = \"whole\"
        transform = [{{ translate = [0, -1, 0] }}]"
    );
    for backend in BACKENDS {
        let way = format!("{}\nbackend = \"{backend}\"", WAYS[1]);
        let shown = picture(&folder.scene(&frontal(&way, &rest)));
        assert!(shown.pixel(3, 3).g < 1e-3, "{backend}: the hole, {:?}", shown.pixel(3, 3));
        assert!(shown.pixel(3, 12).g > 0.99, "{backend}: the whole one, {:?}", shown.pixel(3, 12));
    }
}

#[test]
fn only_shapes_with_holes_have_filters() {
    let folder = folder();
    let scene = folder.scene(&frontal(WAYS[0], &format!("{WALL}{CUT}")));
    assert_eq!(scene.world.filters.len(), 1, "the wall has none");
}

#[test]
fn what_shines_has_no_holes() {
    let folder = folder();
    GrayImage::new(2, 2).save(folder.path().join("none.png")).expect("written");
    for opacity in ["half.png", "none.png"] {
        let material = format!("type = \"emission\"\nradiance = 1\nopacity = {{ file = \"{opacity}\" }}");
        folder.write("scene.toml", &square(WAYS[0], &material));
        let loaded = scene::load(&folder.path().join("scene.toml"), &[]).expect("a scene");
        for wanted in [Wanted::anything(), Wanted::default()] {
            let message = scene::build_for(&loaded.description, &wanted).expect_err("refused").to_string();
            assert!(message.contains("a surface that emits light has holes"), "{opacity}: {message}");
        }
    }
}

#[test]
fn obj_files_bring_pictures_and_holes() {
    let folder = folder();
    folder.write(
        "leaf.obj",
        "mtllib leaf.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl leaf\nf 1/1 2/2 3/3 4/4\n",
    );
    let shape = "[[shapes]]\ntype = \"mesh\"\nfile = \"leaf.obj\"";
    let seen = |mtl: &str| {
        folder.write("leaf.mtl", mtl);
        let built = folder.load(&frontal(WAYS[1], shape)).unwrap_or_else(|error| panic!("{error}"));
        let warnings: Vec<String> = built.warnings.iter().map(ToString::to_string).collect();
        (picture(&built.scene), warnings)
    };
    let (shown, warnings) = seen("newmtl leaf\nKd 0.5 0.5 0.5\nmap_Kd four.png\n");
    assert!(warnings.is_empty(), "{warnings:?}");
    let near = |a: Rgb<f32>, b: [f32; 3]| folder::close(a, b.into(), 1e-4);
    assert!(near(shown.pixel(3, 3), [0.5, 0.0, 0.0]), "times Kd: {:?}", shown.pixel(3, 3));
    let (shown, _) = seen("newmtl leaf\nKd 0 0 0\nmap_Kd four.png\nmap_d half.png\n");
    assert!(near(shown.pixel(3, 3), [1.0; 3]), "the light behind the hole: {:?}", shown.pixel(3, 3));
    assert!(near(shown.pixel(12, 3), [0.0, 1.0, 0.0]), "Kd black is not meant: {:?}", shown.pixel(12, 3));
    let (shown, warnings) = seen("newmtl leaf\n\nKd 0.9 0 0\nmap_Kd textures\\for.png\n");
    assert!(near(shown.pixel(8, 8), [0.5; 3]), "neutral: {:?}", shown.pixel(8, 8));
    assert!(warnings[0].contains("leaf.mtl:4: no such file"), "{warnings:?}");
    assert!(warnings[0].ends_with("the surface is made gray"), "{warnings:?}");
    std::fs::write(folder.path().join("bad.png"), b"rubbish").expect("written");
    let (shown, warnings) = seen("newmtl leaf\nmap_Kd bad.png\n");
    assert!(near(shown.pixel(8, 8), [0.5; 3]), "neutral: {:?}", shown.pixel(8, 8));
    assert!(
        warnings.iter().any(|w| w.contains("leaf.mtl:2:") && w.contains("not a sound PNG")),
        "{warnings:?}"
    );
}

#[test]
fn holes_are_holes_at_every_depth() {
    let folder = folder();
    let there = |x: u32| x >= 8;
    let deep =
        image::ImageBuffer::from_fn(16, 2, |x, _| Rgba([0xffff_u16, 0, 0, u16::from(there(x)) * 0xffff]));
    deep.save(folder.path().join("deep.png")).expect("written");
    let numbers: Vec<f32> = (0..32).map(|i| f32::from(u8::from(there(i % 16)))).collect();
    for name in ["half.exr", "float.exr"] {
        let samples =
            |numbers| if name == "half.exr" { Samples::Half(numbers) } else { Samples::Float(numbers) };
        let channel = |name: &str| Channel { name: name.into(), samples: samples(numbers.clone()) };
        let picture = Picture {
            full: [16, 2],
            window: Window::whole(16, 2),
            channels: ["R", "G", "B", "A"].map(channel).to_vec(),
            attributes: vec![],
            warnings: vec![],
        };
        exr::write(&folder.path().join(name), picture).expect("written");
    }
    for way in WAYS {
        let shown = |file: &str| {
            let cut = CUT.replace("half.png", file);
            picture(&folder.scene(&frontal(way, &format!("{WALL}{cut}"))))
        };
        let expected = shown("covered.png");
        assert!(expected.pixel(2, 8).g < 1e-3 && expected.pixel(13, 8).g > 0.99, "{way}: there is a hole");
        for file in ["deep.png", "half.exr", "float.exr"] {
            assert_eq!(shown(file).pixels(), expected.pixels(), "{way}: {file}");
        }
    }
}
