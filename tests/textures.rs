//! Pictures on surfaces: what they show and where, at every width, with every integrator and backend, and what becomes of files
//! that are not what they should be.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bytes and texels are small")]

#[path = "support/desk.rs"]
mod desk;
#[path = "support/folder.rs"]
mod folder;
#[path = "support/random.rs"]
mod random;

use folder::{Folder, WAYS, close, picture, square};
use image::{RgbImage, RgbaImage};
use random::Random;
use specula::image::exr::{self, Channel as Layer, Picture, Samples};
use specula::image::{Image, Pixels, Raster, Window, read_raster};
use specula::math::Rgb;
use specula::math::lanes::{Isa, Kernel, Lanes, Level};
use specula::texture::{Bitmap, Channel, Mapped, Scalar, Space, Spot, Texture, Wrap};
use std::sync::Arc;

const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

/// Random texels of each way of storing them.
fn bitmaps(width: u32, height: u32) -> Vec<(&'static str, Bitmap)> {
    let mut random = Random::new(1);
    let count = (width * height) as usize;
    let mut byte = || (random.unit() * 255.99) as u8;
    let gray = Pixels::Gray((0..count).map(|_| byte()).collect());
    let bytes = Pixels::Bytes((0..count).map(|_| [byte(), byte(), byte(), byte()]).collect());
    let floats: Vec<[f32; 4]> =
        (0..count).map(|_| std::array::from_fn(|_| f32::from(byte()) / 64.0)).collect();
    let bitmap = |pixels: Pixels, space: Space| {
        let raster = Raster {
            width,
            height,
            pixels,
            encoded: space == Space::Srgb,
            has_alpha: true,
            warnings: vec![],
            as_colour: vec![],
        };
        Bitmap::new(&raster, space)
    };
    vec![
        ("gray", bitmap(gray, Space::Srgb)),
        ("bytes", bitmap(bytes, Space::Srgb)),
        ("halves", bitmap(Pixels::Floats { values: floats.clone(), half: true }, Space::Linear)),
        ("floats", bitmap(Pixels::Floats { values: floats, half: false }, Space::Linear)),
    ]
}

fn mapped(bitmap: Bitmap, wrap: Wrap) -> Mapped {
    let (repeat, offset) = (glam::Vec2::ONE, glam::Vec2::ZERO);
    Mapped { bitmap: Arc::new(bitmap), wrap, repeat, offset }
}

/// A picture of four texels: red and green above blue and white.
fn four() -> Bitmap {
    let pixels = Pixels::Bytes(vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]]);
    let raster = Raster {
        width: 2,
        height: 2,
        pixels,
        encoded: true,
        has_alpha: false,
        warnings: vec![],
        as_colour: vec![],
    };
    Bitmap::new(&raster, Space::Srgb)
}

#[expect(clippy::float_cmp, reason = "texels are exact in their middle")]
#[test]
fn texels_are_themselves_in_their_middle_and_v_goes_up() {
    for wrap in WRAPS {
        let map = mapped(four(), wrap);
        let at = |u: f32, v: f32| map.at(Spot::from([u, v]));
        assert_eq!(at(0.25, 0.75), [1.0, 0.0, 0.0, 1.0], "{wrap:?}: above left");
        assert_eq!(at(0.75, 0.75), [0.0, 1.0, 0.0, 1.0], "{wrap:?}: above right");
        assert_eq!(at(0.25, 0.25), [0.0, 0.0, 1.0, 1.0], "{wrap:?}: below left");
        assert_eq!(at(0.75, 0.25), [1.0; 4], "{wrap:?}: below right");
        assert_eq!(at(0.5, 0.5), [0.5, 0.5, 0.5, 1.0], "{wrap:?}: the middle is a quarter of each");
    }
}

#[test]
fn parameters_that_overflow_are_the_edge() {
    for wrap in WRAPS {
        let mut map = mapped(four(), wrap);
        map.repeat = glam::Vec2::splat(1e6);
        let texel = map.at(Spot::from([3e38_f32, 1e38]));
        assert!(texel.iter().all(|x| (0.0..=1.0).contains(x)), "{wrap:?}: {texel:?}");
    }
}

/// Column and row that a whole number means beyond the edges.
fn wrapped(wrap: Wrap, i: i64, size: i64) -> i64 {
    match wrap {
        Wrap::Repeat => i.rem_euclid(size),
        Wrap::Clamp => i.clamp(0, size - 1),
        Wrap::Mirror => {
            let i = i.rem_euclid(2 * size);
            if i < size { i } else { 2 * size - 1 - i }
        }
    }
}

#[test]
fn beyond_the_edges_all_is_as_the_wrap_mode_says() {
    let (width, height) = (7_i64, 4_i64);
    let value = |x: i64, y: i64| ((x * 5 + y * 11) % 13) as f32;
    let values = (0..28).map(|i| [value(i % width, i / width), 0.0, 0.0, 1.0]).collect();
    let pixels = Pixels::Floats { values, half: false };
    let raster = Raster {
        width: 7,
        height: 4,
        pixels,
        encoded: false,
        has_alpha: false,
        warnings: vec![],
        as_colour: vec![],
    };
    let bitmap = Bitmap::new(&raster, Space::Linear);
    let mut random = Random::new(2);
    for wrap in WRAPS {
        let map = mapped(bitmap.clone(), wrap);
        for _ in 0..2000 {
            let [u, v] = [random.unit() * 8.0 - 4.0, random.unit() * 8.0 - 4.0];
            let (x, y) = (f64::from(u) * width as f64 - 0.5, (1.0 - f64::from(v)) * height as f64 - 0.5);
            let (fx, fy) = (x - x.floor(), y - y.floor());
            let texel = |dx: i64, dy: i64| {
                let (x, y) = (x.floor() as i64 + dx, y.floor() as i64 + dy);
                f64::from(value(wrapped(wrap, x, width), wrapped(wrap, y, height)))
            };
            let expected = (texel(0, 0) * (1.0 - fx) + texel(1, 0) * fx) * (1.0 - fy)
                + (texel(0, 1) * (1.0 - fx) + texel(1, 1) * fx) * fy;
            let [found, ..] = map.at(Spot::from([u, v]));
            assert!(
                (f64::from(found) - expected).abs() < 2e-4,
                "{wrap:?} at {u}, {v}: {found}, not {expected}"
            );
        }
    }
}

#[expect(clippy::float_cmp, reason = "the same level, bit for bit")]
#[test]
fn wide_rays_see_smaller_pictures() {
    for (name, bitmap) in bitmaps(32, 16) {
        let mean = bitmap.mean();
        let map = mapped(bitmap, Wrap::Repeat);
        let at = |footprint: f32| map.at(Spot { uv: [0.3_f32, 0.6], footprint });
        assert_eq!(at(0.0), at(1.0 / 32.0), "{name}: less than a texel is a point");
        // Levels of bytes are rounded, those of halves to eleven bits.
        let tolerance = match name {
            "floats" => 1e-6,
            "halves" => 1e-3,
            _ => 5e-3,
        };
        for (found, mean) in at(10.0).into_iter().zip(mean) {
            assert!((found - mean).abs() < tolerance, "{name}: wider than the picture is its mean, {found}");
        }
        // Between two levels lies their mixture: half an octave is half of each.
        let texel = (1.0_f32 / 512.0).sqrt();
        let [a, b, c] = [2.0, 2.0 * 2.0_f32.sqrt(), 4.0].map(|texels| at(texels * texel)[0]);
        assert!((b - 0.5 * (a + c)).abs() < 2e-5, "{name}: {a}, {b}, {c}");
        assert!((a - c).abs() > 1e-3, "{name}: the levels differ");
    }
}

/// Lookups of one texture.
struct Ask<'a> {
    map: &'a Mapped,
    spots: &'a [[f32; 3]],
}

impl<S: Isa> Kernel<S> for Ask<'_> {
    type Output = Vec<[f32; 4]>;
    #[inline(always)]
    fn run(self, isa: S) -> Self::Output {
        let mut found = Vec::new();
        for some in self.spots.chunks_exact(S::WIDTH) {
            let [u, v, footprint] = std::array::from_fn(|k| isa.per_lane(|i| some[i][k]));
            let texel = self.map.at(Spot { uv: [u, v], footprint });
            found.extend((0..S::WIDTH).map(|i| texel.map(|channel| channel.extract(i))));
        }
        found
    }
}

#[test]
fn all_widths_see_the_same() {
    let mut random = Random::new(3);
    let spots: Vec<[f32; 3]> = (0..960)
        .map(|i| {
            let footprint = if i % 3 == 0 { 0.0 } else { 2.0_f32.powf(-8.0 + 9.0 * random.unit()) };
            [random.unit() * 6.0 - 3.0, random.unit() * 6.0 - 3.0, footprint]
        })
        .collect();
    for (name, bitmap) in bitmaps(19, 33) {
        for wrap in WRAPS {
            let map = mapped(bitmap.clone(), wrap);
            let one: Vec<[f32; 4]> =
                spots.iter().map(|&[u, v, footprint]| map.at(Spot { uv: [u, v], footprint })).collect();
            for level in Level::available() {
                let wide = level.run(Ask { map: &map, spots: &spots });
                for ((a, b), spot) in one.iter().zip(&wide).zip(&spots) {
                    // Fused products round once: the place within a picture of 33 texels moves by as much.
                    let close = a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 2e-4);
                    assert!(close, "{name}, {wrap:?}, {} at {spot:?}: {b:?}, not {a:?}", level.name());
                }
            }
        }
    }
}

#[test]
fn factors_and_limits_apply() {
    let texture = |factor: f32, limit: f32| Texture::Image {
        map: mapped(four(), Wrap::Clamp),
        factor: Rgb::gray(factor),
        limit,
    };
    assert_eq!(texture(0.5, 1.0).at([0.25_f32, 0.75]), Rgb::new(0.5, 0.0, 0.0), "dimmed");
    assert_eq!(texture(3.0, 1.0).at([0.25_f32, 0.75]), Rgb::new(1.0, 0.0, 0.0), "cut");
    assert_eq!(texture(3.0, f32::INFINITY).at([0.25_f32, 0.75]), Rgb::new(3.0, 0.0, 0.0), "light is not");
    for (channel, expected) in
        [(Channel::Red, 0.5), (Channel::Green, 0.0), (Channel::Blue, 0.0), (Channel::Alpha, 0.5)]
    {
        let scalar = Scalar { map: mapped(four(), Wrap::Clamp), channel, factor: 0.5 };
        let found: f32 = scalar.at([0.25_f32, 0.75]);
        assert!((found - expected).abs() < 1e-6, "{channel:?}: {found}");
    }
}

#[test]
fn a_matt_square_in_white_light_shows_its_picture() {
    let folder = Folder::new();
    let expected = [
        ((3, 3), Rgb::new(1.0, 0.0, 0.0)),
        ((12, 3), Rgb::new(0.0, 1.0, 0.0)),
        ((3, 12), Rgb::new(0.0, 0.0, 1.0)),
        ((12, 12), Rgb::WHITE),
    ];
    for way in WAYS {
        for backend in ["embree", "bvh2", "cwbvh", "brute"] {
            let way = format!("{way}\nbackend = \"{backend}\"");
            let scene =
                folder.scene(&square(&way, "type = \"diffuse\"\nreflectance = { file = \"four.png\" }"));
            let shown = picture(&scene);
            for ((x, y), color) in expected {
                let found = shown.pixel(x, y);
                // The light over the square is drawn by its cosine, but not by shadow rays of the tree: these have noise.
                let tolerance = if way.contains("path") { 1e-5 } else { 0.1 };
                assert!(close(found, color, tolerance), "{way}, pixel {x}, {y}: {found:?}");
            }
        }
    }
}

#[test]
fn mirrors_show_theirs_too_and_bases_under_lobes() {
    let folder = Folder::new();
    let materials = [
        "type = \"mirror\"\nreflectance = { file = \"four.png\" }",
        "type = \"glossy\"\nexponent = 10\nreflectance = 0\ndiffuse = { file = \"four.png\" }",
        "type = \"phong\"\nexponent = 10\nreflectance = 0\ndiffuse = { file = \"four.png\" }",
        "type = \"oren_nayar\"\nroughness = 0\nreflectance = { file = \"four.png\" }",
        "type = \"glazed\"\nior = 1\nreflectance = { file = \"four.png\" }",
    ];
    for material in materials {
        for way in &WAYS[..2] {
            let shown = picture(&folder.scene(&square(way, material)));
            assert!(
                close(shown.pixel(3, 3), Rgb::new(1.0, 0.0, 0.0), 2e-3),
                "{material}: {:?}",
                shown.pixel(3, 3)
            );
            assert!(close(shown.pixel(12, 12), Rgb::WHITE, 2e-3), "{material}: {:?}", shown.pixel(12, 12));
        }
    }
}

#[test]
fn repeats_and_offsets_move_the_picture() {
    let folder = Folder::new();
    let shown = |how: &str| {
        let material = format!("type = \"diffuse\"\nreflectance = {{ file = \"four.png\", {how} }}");
        picture(&folder.scene(&square(WAYS[1], &material)))
    };
    let red = Rgb::new(1.0, 0.0, 0.0);
    let twice = shown("repeat = [2, 2]");
    assert!(
        close(twice.pixel(1, 1), red, 1e-5) && close(twice.pixel(9, 9), red, 1e-5),
        "{:?}",
        twice.pixel(9, 9)
    );
    let moved = shown("offset = [0.5, 0.0]");
    assert!(close(moved.pixel(12, 3), red, 1e-5), "to the left by half: {:?}", moved.pixel(12, 3));
    let mirrored = shown("repeat = [2, 1], wrap = \"mirror\"");
    assert!(close(mirrored.pixel(14, 3), red, 1e-5), "{:?}", mirrored.pixel(14, 3));
    let clamped = shown("repeat = [2, 1], wrap = \"clamp\"");
    assert!(close(clamped.pixel(14, 3), Rgb::new(0.0, 1.0, 0.0), 1e-5), "{:?}", clamped.pixel(14, 3));
}

#[test]
fn spaces_can_be_told() {
    let folder = Folder::new();
    for (space, expected) in
        [("", 0.215_860_5), (", space = \"srgb\"", 0.215_860_5), (", space = \"linear\"", 128.0 / 255.0)]
    {
        let material = format!("type = \"diffuse\"\nreflectance = {{ file = \"gray.png\"{space} }}");
        let found = picture(&folder.scene(&square(WAYS[0], &material))).pixel(8, 8).r;
        assert!((found - expected).abs() < 1e-5, "{space}: {found}");
    }
}

#[test]
fn roughness_from_a_picture_is_that_of_the_number() {
    let folder = Folder::new();
    let gray = 128.0 / 255.0;
    for kind in ["type = \"conductor\"\nmetal = \"Au\"", "type = \"dielectric\""] {
        for way in &WAYS[..3] {
            let by_number = picture(&folder.scene(&square(way, &format!("{kind}\nalpha = {gray}"))));
            let by_file =
                picture(&folder.scene(&square(
                    way,
                    &format!("{kind}\nalpha = {{ file = \"gray.png\", channel = \"g\" }}"),
                )));
            for (a, b) in by_number.pixels().iter().zip(by_file.pixels()) {
                assert!(close(*a, *b, 1e-4), "{kind}, {way}: {a:?}, {b:?}");
            }
        }
    }
}

#[test]
fn a_file_used_twice_is_loaded_once_and_counted() {
    let folder = Folder::new();
    let two = square(WAYS[0], "type = \"diffuse\"\nreflectance = { file = \"four.png\" }")
        + "[materials.n]\ntype = \"mirror\"\nreflectance = { file = \"./four.png\", repeat = [3, 3], space = \"srgb\" }";
    let scene = folder.scene(&two);
    assert_eq!(scene.textures.len(), 1, "one picture");
    assert_eq!(scene.texture_bytes(), 4 * (256 + 64 + 16 + 4 + 1), "all its sizes");
    let three = two
        + "\n[materials.o]\ntype = \"diffuse\"\nreflectance = { file = \"four.png\", space = \"linear\" }";
    assert_eq!(folder.scene(&three).textures.len(), 2, "light is another picture");
}

/// Keys of a matt or metal square that name a picture, the material without that key, and what becomes of the surface.
const WITHOUT: [[&str; 4]; 6] = [
    [
        "type = 'diffuse'",
        "reflectance = { file = 'FILE', factor = 0.2 }",
        "reflectance = 0.5",
        "the surface is made gray",
    ],
    ["type = 'emission'", "radiance = { file = 'FILE' }", "radiance = 0", "the surface does not shine by it"],
    ["type = 'conductor'\nmetal = 'Au'", "alpha = { file = 'FILE' }", "", "the surface is left polished"],
    ["type = 'diffuse'", "normal_map = { file = 'FILE' }", "", "the surface is left even"],
    ["type = 'diffuse'", "bump = { file = 'FILE' }", "", "the surface is left even"],
    ["type = 'diffuse'", "opacity = { file = 'FILE' }", "", "the surface is left whole"],
];

#[test]
fn missing_and_damaged_files_are_warned_of_with_their_place_and_made_up_for() {
    let folder = Folder::new();
    std::fs::write(folder.path().join("bad.png"), b"rubbish").expect("written");
    for (file, told) in [("for.png", "no such file"), ("bad.png", "not a sound PNG picture")] {
        for [material, key, without, what] in WITHOUT {
            let key = key.replace("FILE", file);
            let text = square(WAYS[0], &format!("{material}\n{key}"));
            let built = folder.load(&text).expect("a scene");
            let line = text.lines().position(|line| line.contains(file)).expect("there");
            let column =
                text.lines().nth(line).and_then(|line| line.find(&format!("'{file}'"))).expect("there");
            let [warning] = &built.warnings[..] else { panic!("{key}: {:?}", built.warnings) };
            let warning = warning.to_string();
            assert!(
                warning.contains(&format!("scene.toml:{}:{}: ", line + 1, column + 1)),
                "{key}: {warning}"
            );
            assert!(
                warning.contains(told) && warning.contains(file) && warning.ends_with(what),
                "{key}: {warning}"
            );
            assert_eq!(warning.contains("did you mean `four.png`?"), file == "for.png", "{key}: {warning}");
            let plain = folder.scene(&square(WAYS[0], &format!("{material}\n{without}")));
            assert_eq!(built.scene.materials, plain.materials, "{key}: as without it");
            assert!(built.scene.textures.is_empty(), "{key}: nothing to look up");
            if what.contains("gray") {
                for way in WAYS {
                    let built = folder.load(&square(way, &format!("{material}\n{key}"))).expect("a scene");
                    let shown = picture(&built.scene).pixel(8, 8);
                    assert!(
                        close(shown, Rgb::gray(0.5), 0.1),
                        "{way}: visible, whatever the factor: {shown:?}"
                    );
                }
            }
        }
    }
    // Two surfaces by one file are one warning.
    let two = square(WAYS[0], "type = 'diffuse'\nreflectance = { file = 'for.png' }")
        + "[materials.n]\ntype = 'mirror'\nreflectance = { file = './for.png' }";
    assert_eq!(folder.load(&two).expect("a scene").warnings.len(), 1, "told once");
}

#[test]
fn what_is_no_picture_or_is_a_light_is_refused_with_its_place() {
    let folder = Folder::new();
    std::fs::write(folder.path().join("bad.exr"), b"rubbish").expect("written");
    let refused = |text: &str, told: &[&str]| {
        let message = folder.load(text).expect_err("refused");
        assert!(told.iter().all(|told| message.contains(told)), "{told:?}: {message}");
    };
    let matt = |texture: &str| square(WAYS[0], &format!("type = 'diffuse'\nreflectance = {texture}"));
    refused(&matt("{ file = 'four.png', wrap = 'round' }"), &["`wrap` is `round`"]);
    refused(&matt("{ file = 'lost.tif' }"), &["scene.toml:", "`", "lost.tif` is of an unknown format"]);
    refused(&matt("{ file = '.' }"), &["scene.toml:", "is a directory"]);
    for (file, told) in
        [("lost.exr", "scene.toml:3:8: no such file"), ("bad.exr", "bad.exr: not a sound EXR file")]
    {
        refused(&format!("[[lights]]\ntype = 'environment'\nfile = '{file}'\n"), &[told]);
    }
}

#[test]
fn the_program_renders_without_a_missing_picture_and_tells() {
    let desk = desk::Desk::new();
    let text = square(WAYS[1], "type = 'diffuse'\nreflectance = { file = 'lost.png' }");
    std::fs::write(desk.path("a.toml"), &text).expect("a scene");
    let (status, _, said) = desk.run(&["render", "a.toml", "-o", "a.exr", "--stats", "a.json"]);
    assert_eq!(status, 0, "{said}");
    let line = text.lines().position(|line| line.contains("lost.png")).expect("there") + 1;
    let place = format!("a.toml:{line}:");
    assert!(said.contains(&place) && said.contains("no such file `lost.png`"), "{said}");
    assert!(said.contains("the surface is made gray"), "{said}");
    let stats = std::fs::read_to_string(desk.path("a.json")).expect("written");
    let stats: serde_json::Value = serde_json::from_str(&stats).expect("JSON");
    let warning = stats["plan"]["warnings"][0].as_str().expect("a warning");
    assert!(warning.contains(&place) && warning.contains("lost.png"), "{warning}");
    let (status, told, _) = desk.run(&["plan", "a.toml"]);
    assert!(status == 0 && told.contains(&place) && told.contains("made gray"), "{status}: {told}");
}

#[test]
fn all_kinds_of_files_are_read() {
    let folder = Folder::new();
    let path = |name: &str| folder.path().join(name);
    let color = image::Rgb([200, 100, 50]);
    RgbImage::from_pixel(16, 16, color).save(path("a.jpg")).expect("written");
    RgbaImage::from_pixel(3, 3, image::Rgba([9, 8, 7, 6])).save(path("b.png")).expect("written");
    assert!(read_raster(&path("b.png")).expect("read").has_alpha, "coverage");
    RgbImage::from_pixel(16, 16, color).save(path("a.png")).expect("written");
    // The light of those bytes, by the curve of sRGB.
    let light = [200.0_f64, 100.0, 50.0].map(|byte| ((byte / 255.0 + 0.055) / 1.055).powf(2.4) as f32);
    let plane = |value: f32| vec![value; 256];
    for (name, half) in [("float.exr", false), ("half.exr", true)] {
        let samples =
            |value: f32| if half { Samples::Half(plane(value)) } else { Samples::Float(plane(value)) };
        let channel = |(name, value): (&str, f32)| Layer { name: name.to_owned(), samples: samples(value) };
        let channels = ["R", "G", "B"].into_iter().zip(light).map(channel).collect();
        let window = Window::whole(16, 16);
        let picture =
            Picture { full: [16, 16], window, channels, attributes: Vec::new(), warnings: Vec::new() };
        exr::write(&path(name), picture).expect("written");
    }
    let hdr = std::fs::File::create(path("a.hdr")).expect("made");
    let pixels = vec![image::Rgb(light); 256];
    image::codecs::hdr::HdrEncoder::new(hdr).encode(&pixels, 16, 16).expect("written");
    // Bytes are exact, and as good as exact in whole floats; JPEG is off by two of them; halves have eleven bits, and HDR eight for its
    // greatest channel, the same step for the others.
    for (name, tolerance) in
        [("a.png", 1e-5), ("a.jpg", 0.013), ("float.exr", 1e-5), ("half.exr", 5e-4), ("a.hdr", 4e-3)]
    {
        let material = format!("type = \"diffuse\"\nreflectance = {{ file = \"{name}\" }}");
        for way in &WAYS[..2] {
            let found = picture(&folder.scene(&square(way, &material))).pixel(8, 8);
            let [r, g, b] = light;
            assert!(close(found, Rgb::new(r, g, b), tolerance), "{name}, {way}: {found:?} for {light:?}");
        }
    }
}

/// A file that holds all of a picture of four by four shades, or a part of it: its four inner pixels are light, the others black.
fn inner(folder: &Folder, name: &str, window: Window) {
    let light = Window { x0: 1, y0: 1, x1: 3, y1: 3 };
    let pixels = (window.y0..window.y1).flat_map(|y| (window.x0..window.x1).map(move |x| (x, y)));
    let values: Vec<f32> = pixels.map(|(x, y)| if light.contains(x, y) { 0.8 } else { 0.0 }).collect();
    let channel = |name: &str| Layer { name: name.to_owned(), samples: Samples::Float(values.clone()) };
    let channels = ["R", "G", "B"].map(channel).into();
    let picture = Picture { full: [4, 4], window, channels, attributes: Vec::new(), warnings: Vec::new() };
    exr::write(&folder.path().join(name), picture).expect("written");
}

#[test]
fn a_file_that_holds_a_part_of_a_picture_shows_it_where_it_lies() {
    let folder = Folder::new();
    inner(&folder, "whole.exr", Window::whole(4, 4));
    inner(&folder, "part.exr", Window { x0: 1, y0: 1, x1: 3, y1: 3 });
    let matt = "type = \"diffuse\"\nreflectance = 0.5";
    let hill = "[[shapes]]\ntype = \"height_field\"\nfile = \"whole.exr\"\nmaterial = \"m\"";
    let scenes = [
        ("a texture", square(WAYS[1], "type = \"diffuse\"\nreflectance = { file = \"whole.exr\" }")),
        ("a sky", square(WAYS[1], matt).replace("radiance = 1.0", "file = \"whole.exr\"")),
        ("heights", folder::frontal(WAYS[1], &format!("[materials.m]\n{matt}\n{hill}"))),
    ];
    for (name, text) in scenes {
        let shown = |file| picture(&folder.scene(&text.replace("whole.exr", file)));
        assert!(shown("part.exr") == shown("whole.exr"), "{name}");
    }
}

#[test]
fn primaries_are_told_of_colours_alone_and_once() {
    let folder = Folder::new();
    let path = folder.path().join("wide.exr");
    inner(&folder, "wide.exr", Window::whole(4, 4));
    let mut bytes = std::fs::read(&path).expect("there");
    // Eight numbers follow the name of the attribute, its type and its size.
    let name = b"chromaticities\0chromaticities\0";
    let start = bytes.windows(name.len()).position(|w| w == name).expect("there") + name.len() + 4;
    bytes[start..start + 4].copy_from_slice(&0.708_f32.to_le_bytes());
    std::fs::write(&path, bytes).expect("written");
    let cases = [
        ("type = \"diffuse\"\nreflectance = { file = \"wide.exr\" }", 1),
        ("type = \"diffuse\"\nreflectance = 0.5\nemission = { file = \"wide.exr\" }", 1),
        ("type = \"diffuse\"\nreflectance = 0.5\nnormal_map = { file = \"wide.exr\" }", 0),
        ("type = \"diffuse\"\nreflectance = 0.5\nbump = { file = \"wide.exr\" }", 0),
        ("type = \"diffuse\"\nreflectance = 0.5\nopacity = { file = \"wide.exr\" }", 0),
        // In two spaces, and for normals.
        (
            "type = \"diffuse\"\nreflectance = { file = \"wide.exr\" }\nnormal_map = { file = \"wide.exr\" }\n\
             emission = { file = \"wide.exr\", space = \"srgb\" }",
            1,
        ),
    ];
    for (material, wanted) in cases {
        let warnings = folder.load(&square(WAYS[0], material)).expect("a scene").warnings;
        let told = warnings.iter().filter(|it| it.what.contains("chromaticities")).count();
        assert_eq!(told, wanted, "{material}: {warnings:?}");
    }
    let sky = square(WAYS[0], "type = \"mirror\"").replace("radiance = 1.0", "file = \"wide.exr\"");
    let warnings = folder.load(&sky).expect("a scene").warnings;
    assert!(warnings.iter().any(|it| it.what.contains("chromaticities")), "{warnings:?}");
}

/// A square that shines by a picture, seen from the front, and a white floor below it that only it lights.
fn panel(way: &str, radiance: &str) -> String {
    format!(
        r#"
        [camera]
        from = [0.0, 0.0, 10.0]
        at = [0.0, 0.0, 0.0]
        vfov_deg = 30.0
        [film]
        width = 32
        height = 32
        filter = "box"
        [render]
        {way}
        [materials.panel]
        type = "emission"
        radiance = {radiance}
        [materials.white]
        type = "diffuse"
        reflectance = 0.8
        [[shapes]]
        type = "rectangle"
        edge_u = [1.0, 0.0, 0.0]
        edge_v = [0.0, 1.0, 0.0]
        material = "panel"
        [[shapes]]
        type = "rectangle"
        center = [0.0, -1.2, 1.0]
        edge_u = [2.0, 0.0, 0.0]
        edge_v = [0.0, 0.0, -2.0]
        material = "white"
        transform = [{{ rotate_deg = 10.0, axis = [1, 0, 0] }}]
        "#
    )
}

#[test]
fn surfaces_shine_by_a_picture_and_light_others() {
    let folder = Folder::new();
    let radiance = "{ file = \"four.png\", factor = 2, wrap = \"clamp\" }";
    let sum = |image: &Image| {
        // The floor alone, which is lit by what is asked of the light, by what is met by chance, or by both.
        let floor = (19..32).flat_map(|y| (0..32).map(move |x| (x, y)));
        floor.fold(Rgb::BLACK, |sum, (x, y)| sum + image.pixel(x, y))
    };
    let mut sums = Vec::new();
    for way in WAYS {
        let way = way.replace("spp = 16", "spp = 64");
        let shown = picture(&folder.scene(&panel(&way, radiance)));
        assert!(
            close(shown.pixel(14, 14), Rgb::new(2.0, 0.0, 0.0), 1e-4),
            "{way}: {:?}",
            shown.pixel(14, 14)
        );
        assert!(close(shown.pixel(17, 17), Rgb::gray(2.0), 1e-4), "{way}: {:?}", shown.pixel(17, 17));
        sums.push(sum(&shown));
    }
    // Four squares of one colour each light the floor as the quarters of the picture do.
    let mut mtl = String::new();
    for (i, [x, y, r, g, b]) in
        [[-1, 0, 2, 0, 0], [0, 0, 0, 2, 0], [-1, -1, 0, 0, 2], [0, -1, 2, 2, 2]].into_iter().enumerate()
    {
        mtl += &format!("newmtl m{i}\nKe {r} {g} {b}\n");
        let file = format!(
            "mtllib quarters.mtl\nusemtl m{i}\nv {x} {y} 0\nv {} {y} 0\nv {} {} 0\nv {x} {} 0\nf 1 2 3 4\n",
            x + 1,
            x + 1,
            y + 1,
            y + 1
        );
        folder.write(&format!("quarter{i}.obj"), &file);
    }
    folder.write("quarters.mtl", &mtl);
    let text = panel(&WAYS[0].replace("spp = 16", "spp = 64"), "0");
    let quarters: String =
        (0..4).map(|i| format!("[[shapes]]\ntype = \"mesh\"\nfile = \"quarter{i}.obj\"\n")).collect();
    let first = text.find("[[shapes]]").expect("the panel");
    let second = first + 2 + text[first + 2..].find("[[shapes]]").expect("the floor");
    let text = format!("{}{}{}", &text[..first], &text[second..], quarters);
    let expected = sum(&picture(&folder.scene(&text)));
    for (way, found) in WAYS.iter().zip(sums) {
        let ratio = [found.r / expected.r, found.g / expected.g, found.b / expected.b];
        // Some 400 pixels of 64 samples each: within 2 per cent.
        assert!(ratio.iter().all(|r| (r - 1.0).abs() < 0.02), "{way}: {ratio:?} of {expected:?}");
    }
}

/// A sphere or disc of its own is as one that is placed by a map, which has always been turned.
#[test]
fn turned_spheres_and_discs_turn_their_pictures() {
    let folder = Folder::new();
    for (form, axis) in [("sphere", [1, 0, 0]), ("disc", [0, 0, 1])] {
        let scene = |shapes: &str| {
            folder.scene(&format!(
                "[camera]\nfrom = [0, 0.5, 4]\nat = [0, 0, 0]\nvfov_deg = 35\n[film]\nwidth = 24\nheight = 24\n\
                 [render]\nspp = 4\n[materials.m]\ntype = \"diffuse\"\nreflectance = {{ file = \"four.png\" }}\n\
                 [[lights]]\ntype = \"environment\"\nradiance = 1.0\n{shapes}"
            ))
        };
        let shape = format!("[[shapes]]\ntype = \"{form}\"\nradius = 1.0\nmaterial = \"m\"\n");
        let turn = format!("transform = [{{ rotate_deg = 50, axis = {axis:?} }}]\n");
        let still = picture(&scene(&shape));
        let turned = picture(&scene(&format!("{shape}{turn}")));
        let hidden = format!("{shape}name = \"a\"\nhidden = true\n");
        let instance = format!("[[shapes]]\ntype = \"instance\"\nof = \"a\"\n{turn}");
        let placed = picture(&scene(&format!("{hidden}{instance}")));
        let apart = |a: &Image, b: &Image| {
            a.pixels().iter().zip(b.pixels()).filter(|(a, b)| (a.g - b.g).abs() > 0.1).count()
        };
        assert!(apart(&turned, &placed) < 6, "{form}: {} pixels", apart(&turned, &placed));
        assert!(apart(&turned, &still) > 40, "{form}: {} pixels", apart(&turned, &still));
    }
}

/// A byte holds no less than 1.5e-4 of light: the mean of a picture that is dark almost everywhere is none.
#[test]
fn a_picture_with_a_small_bright_patch_is_a_light() {
    let folder = Folder::new();
    let patch = |x: u32, y: u32| image::Luma([if x < 3 && y < 3 { 255 } else { 0 }]);
    image::GrayImage::from_fn(256, 256, patch).save(folder.path().join("patch.png")).expect("written");
    for (radiance, lights) in [("{ file = \"patch.png\" }", 1), ("{ file = \"patch.png\", factor = 0 }", 0)] {
        let built = folder.load(&panel(WAYS[0], radiance)).expect("a scene");
        assert_eq!(built.scene.lights.len(), lights, "{radiance}");
    }
}

/// What one sample a pixel shows of a picture of random texels, 64 of them across a pixel.
fn spread(folder: &Folder, way: &str, shape: &str) -> (f32, f32) {
    let way = way.replace("spp = 16", "spp = 1");
    let material = "[materials.m]\ntype = \"emission\"\nradiance = { file = \"noise.png\" }\n";
    let shown = picture(&folder.scene(&folder::frontal(&way, &format!("{material}{shape}"))));
    let inner: Vec<f32> =
        (2..14).flat_map(|y| (2..14).map(move |x| (x, y))).map(|(x, y)| shown.pixel(x, y).r).collect();
    let mean = inner.iter().sum::<f32>() / inner.len() as f32;
    let variance = inner.iter().map(|x| (x - mean).powi(2)).sum::<f32>() / inner.len() as f32;
    (mean, variance.sqrt())
}

#[test]
fn fine_patterns_are_seen_as_their_mean() {
    let folder = Folder::new();
    let mut random = Random::new(4);
    let noise = image::GrayImage::from_fn(1024, 1024, |_, _| {
        image::Luma([if random.unit() < 0.5 { 0 } else { 255 }])
    });
    noise.save(folder.path().join("noise.png")).expect("written");
    let flat = "[[shapes]]\ntype = \"rectangle\"\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\nmaterial = \"m\"";
    let instance = "[[shapes]]\nname = \"s\"\nhidden = true\ntype = \"rectangle\"\nedge_u = [0.1, 0, 0]\nedge_v = [0, 0.1, 0]\n\
        material = \"m\"\n[[shapes]]\ntype = \"instance\"\nof = \"s\"\ntransform = [{ scale = 10 }]";
    let mirrored = "[materials.mirror]\ntype = \"mirror\"\n[[shapes]]\ntype = \"rectangle\"\ncenter = [0, 0, 0]\n\
        edge_u = [2, 0, 0]\nedge_v = [0, 2, 0]\nmaterial = \"mirror\"\n\
        [[shapes]]\ntype = \"rectangle\"\ncenter = [0, 0, 20]\nedge_u = [-4, 0, 0]\nedge_v = [0, 4, 0]\nmaterial = \"m\"";
    for way in WAYS {
        for (name, shape) in [("flat", flat), ("instance", instance), ("in a mirror", mirrored)] {
            let (mean, deviation) = spread(&folder, way, shape);
            // Single texels deviate by a half; means of 64 by 64 of them by 1/128, those of lookups between by less.
            assert!((mean - 0.5).abs() < 0.02, "{name}, {way}: the mean is {mean}");
            assert!(deviation < 0.05, "{name}, {way}: pixels deviate by {deviation}");
        }
    }
}

#[test]
fn damaged_pictures_of_mtl_files_are_done_without_and_told() {
    let folder = Folder::new();
    std::fs::write(folder.path().join("bad.png"), b"rubbish").expect("written");
    folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    let text = folder::frontal(WAYS[0], "[[shapes]]\ntype = \"mesh\"\nfile = \"a.obj\"");
    let without = [
        ("map_Kd", "the surface is made gray"),
        ("map_Ke", "the surface does not shine by it"),
        ("map_d", "the surface is left whole"),
        ("norm", "the surface is left even"),
        ("map_Bump", "the surface is left even"),
    ];
    for (keyword, what) in without {
        folder.write("a.mtl", &format!("newmtl m\nKd 0.5 0.5 0.5\n{keyword} bad.png\n"));
        let built = folder.load(&text).expect("a scene");
        let [warning] = &built.warnings[..] else { panic!("{keyword}: {:?}", built.warnings) };
        let warning = warning.to_string();
        assert!(
            warning.contains("a.mtl:3: ")
                && warning.contains("not a sound PNG picture")
                && warning.ends_with(what),
            "{keyword}: {warning}"
        );
        let material = &built.scene.materials[0];
        assert_eq!(material.emission, None, "{keyword}: a lamp");
        assert!(material.relief.is_none() && material.opacity.is_none(), "{keyword}: {material:?}");
    }
}
