//! `specula diff` as its users meet it: pictures in; numbers, pictures and exit status out.

#[path = "support/desk.rs"]
mod desk;

use std::fs;
use std::path::PathBuf;

use desk::Desk;
use serde_json::Value;
use specula::image::exr::{self, Channel, Picture, Samples};
use specula::image::tone::{Curve, Development};
use specula::image::{Image, Window, png};
use specula::math::Rgb;
use specula::measure::magma;

/// A directory with pictures in it, in which the program is run.
struct Place(Desk);

/// One channel of a colour.
type Part = fn(&Rgb<f32>) -> f32;

const SIZE: [u32; 2] = [24, 16];

impl Place {
    /// With `a.exr`, which is 0.5 brighter than `b.exr` everywhere but 2 at (5, 3), and both as `.png`.
    fn new() -> Self {
        let place = Self(Desk::new());
        let reference = place.picture("b", |x, y| f32::from(u16::try_from(x + y).expect("small")) / 20.0);
        let mut test = reference;
        test.pixels_mut().iter_mut().for_each(|p| *p += Rgb::gray(0.5));
        let brighter = test.pixel(5, 3) + Rgb::new(1.5, 0.0, 0.0);
        test.set_pixel(5, 3, brighter);
        place.write("a", &test);
        place
    }

    fn picture(&self, name: &str, light: impl Fn(u32, u32) -> f32) -> Image {
        let mut image = Image::new(SIZE[0], SIZE[1]);
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                image.set_pixel(x, y, Rgb::new(1.0, 0.8, 0.6).scale(light(x, y)));
            }
        }
        self.write(name, &image);
        image
    }

    /// As `.exr` and as `.png`.
    fn write(&self, name: &str, image: &Image) {
        let whole = Window::whole(image.width(), image.height());
        self.write_exr(name, image, whole, [image.width(), image.height()]);
        let development = Development { exposure_ev: 0.0, curve: Curve::Clip };
        png::write(&self.path(&format!("{name}.png")), image, development).expect("written");
    }

    fn write_exr(&self, name: &str, image: &Image, window: Window, full: [u32; 2]) {
        let channels: [(&str, Part); 3] = [("R", |p| p.r), ("G", |p| p.g), ("B", |p| p.b)];
        let channels = channels.map(|(name, of)| Channel {
            name: name.to_owned(),
            samples: Samples::Float(image.pixels().iter().map(of).collect()),
        });
        let (channels, attributes, warnings) = (channels.into(), Vec::new(), Vec::new());
        let picture = Picture { full, window, channels, attributes, warnings };
        exr::write(&self.path(&format!("{name}.exr")), picture).expect("written");
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path(name)
    }

    /// The exit status, standard output and standard error of the comparison.
    fn run(&self, words: &[&str]) -> (i32, String, String) {
        self.0.run(&[&["diff"], words].concat())
    }

    /// The JSON document of a comparison that ends well.
    fn json(&self, words: &[&str]) -> Value {
        let (status, stdout, stderr) = self.run(&[words, &["--json"]].concat());
        assert_eq!(status, 0, "{words:?}: {stderr}");
        serde_json::from_str(&stdout).expect("JSON")
    }
}

fn number(value: &Value, pointer: &str) -> f64 {
    value.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} in {value}"))
}

#[test]
fn a_table_names_every_error() {
    let place = Place::new();
    let (status, stdout, stderr) = place.run(&["a.exr", "b.exr"]);
    assert_eq!((status, stderr.as_str()), (0, ""), "nothing to say");
    assert!(stdout.starts_with("a.exr against b.exr, 24 by 16 pixels\n"), "{stdout}");
    for line in ["mse  ", "rmse  ", "relmse  ", "mae  ", "bias  ", "flip  "] {
        assert!(stdout.contains(&format!("\n{line}")), "{line} in {stdout}");
    }
    assert!(stdout.contains("\nlargest     2.00000 at 5,3\n"), "{stdout}");
    assert!(stdout.ends_with("non-finite  0 pixels in a.exr, 0 in b.exr\n"), "{stdout}");
}

#[test]
fn json_has_the_numbers_that_formulas_give() {
    let place = Place::new();
    let found = place.json(&["a.exr", "b.exr", "--max-error", "99"]);
    let pixels = f64::from(SIZE[0] * SIZE[1]);
    let mse = (0.25 * (3.0 * pixels - 1.0) + 4.0) / (3.0 * pixels);
    for (pointer, wanted) in [
        ("/mse", mse),
        ("/rmse", mse.sqrt()),
        ("/bias", 0.5 + 1.5 / (3.0 * pixels)),
        ("/mae", 0.5 + 1.5 / (3.0 * pixels)),
        ("/pixels", pixels),
        ("/width", 24.0),
        ("/height", 16.0),
        ("/largest/error", 2.0),
        ("/largest/pixel/0", 5.0),
        ("/largest/pixel/1", 3.0),
        ("/non_finite/a", 0.0),
        ("/viewing/pixels_per_degree", 67.020_643),
        ("/check/max_error", 99.0),
    ] {
        let there = number(&found, pointer);
        assert!((there - wanted).abs() < 1e-6 * wanted.abs().max(1e-9), "{pointer}: {there}, not {wanted}");
    }
    assert!((0.1..0.9).contains(&number(&found, "/flip")), "{found}");
    assert!(number(&found, "/relmse") > mse, "dark pixels count more: {found}");
    assert_eq!((&found["a"], &found["check"]["passed"]), (&"a.exr".into(), &true.into()), "{found}");
    assert_eq!(found["viewing"]["range"], "scene", "{found}");
    assert!(number(&found, "/viewing/exposures/count") >= 2.0, "{found}");
}

#[test]
fn a_picture_does_not_differ_from_itself() {
    let place = Place::new();
    for name in ["a.exr", "a.png"] {
        let found = place.json(&[name, name, "--max-error", "0", "--metric", "flip"]);
        for pointer in ["/mse", "/rmse", "/relmse", "/mae", "/bias", "/flip", "/largest/error"] {
            assert_eq!(number(&found, pointer).to_bits(), 0, "{name}: {pointer}");
        }
    }
}

#[test]
fn png_against_png_is_compared_as_displays_show_them() {
    let place = Place::new();
    let found = place.json(&["a.png", "b.png"]);
    assert_eq!(
        (&found["viewing"]["range"], &found["viewing"]["exposures"]),
        (&"display".into(), &Value::Null),
        "{found}"
    );
    let near = place.json(&["a.png", "b.png", "--ppd", "20"]);
    let (near_flip, far_flip) = (number(&near, "/flip"), number(&found, "/flip"));
    assert!((near_flip - far_flip).abs() > 0.01, "from where one looks: {near_flip} and {far_flip}");
    assert_eq!(near["mse"], found["mse"], "only FLIP depends on that");
}

#[test]
fn radiance_pictures_are_scene_light() {
    let place = Place::new();
    // Two pixels of (0.5, 1, 1.5) and black: mantissas over 256, times 2 to the exponent less 128.
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n".to_vec();
    bytes.extend([64, 128, 192, 129, 0, 0, 0, 0]);
    fs::write(place.path("c.hdr"), bytes).expect("written");
    let image = Image::from_pixels(2, 1, vec![Rgb::new(0.5, 1.0, 1.5), Rgb::BLACK]).expect("two pixels");
    place.write("c", &image);
    let found = place.json(&["c.hdr", "c.exr", "--max-error", "0"]);
    assert_eq!(
        (&found["viewing"]["range"], number(&found, "/flip").to_bits()),
        (&"scene".into(), 0),
        "{found}"
    );
}

#[test]
fn a_check_says_no_with_status_3_after_the_numbers() {
    let place = Place::new();
    for (metric, limit) in [("mse", "0.25"), ("rmse", "0.5"), ("relmse", "0.3"), ("flip", "0.1")] {
        let words = ["a.exr", "b.exr", "--metric", metric, "--max-error"];
        let (status, stdout, stderr) = place.run(&[&words[..], &[limit]].concat());
        assert_eq!(status, 3, "{metric}: {stderr}");
        assert!(stdout.contains("\nrelmse"), "the table: {stdout}");
        let start = format!("error: {metric} of ");
        assert!(stderr.starts_with(&start) && stderr.ends_with(&format!(" is above {limit}\n")), "{stderr}");
        assert_eq!(place.run(&[&words[..], &["50"]].concat()).0, 0, "{metric}: far below");
    }
    let (status, _, stderr) = place.run(&["a.exr", "b.exr", "--max-error", "1e-6"]);
    assert!(status == 3 && stderr.contains("relmse of"), "relMSE unless said otherwise: {stderr}");
    let (status, stdout, _) = place.run(&["a.exr", "b.exr", "--max-error", "1e-6", "--json"]);
    let found: Value = serde_json::from_str(&stdout).expect("JSON");
    assert_eq!((status, &found["check"]["passed"]), (3, &false.into()), "{found}");
}

#[test]
fn pixels_that_are_not_finite_are_counted_left_out_and_never_pass() {
    let place = Place::new();
    let mut image = specula::image::read(&place.path("b.exr")).expect("read").image;
    image.set_pixel(7, 7, Rgb::new(f32::NAN, 0.0, 0.0));
    image.set_pixel(8, 9, Rgb::new(0.0, f32::INFINITY, 0.0));
    place.write("odd", &image);
    let found = place.json(&["odd.exr", "b.exr", "-o", "d.exr", "-o", "d.png"]);
    for pointer in ["/mse", "/flip", "/largest/error"] {
        assert_eq!(number(&found, pointer).to_bits(), 0, "{pointer}: {found}");
    }
    assert_eq!(found["non_finite"], serde_json::json!({ "a": 2, "b": 0 }), "{found}");
    assert_eq!(found["pixels"], 24 * 16 - 2, "{found}");

    let flip = exr::read(&place.path("d.exr")).expect("read").channel("flip").expect("there").to_f32();
    let unknown: Vec<_> = (0..flip.len()).filter(|&i| flip[i].is_nan()).collect();
    assert_eq!(unknown, [7 * 24 + 7, 9 * 24 + 8], "NaN where they are, and nowhere else");
    let shown = png::read(&place.path("d.png")).expect("read").image;
    let green = Rgb::new(0.0, 1.0, 0.0);
    assert!(shown.pixel(7, 7) == green && shown.pixel(8, 9) == green && shown.pixel(6, 7) != green, "marked");

    let (status, stdout, stderr) = place.run(&["odd.exr", "b.exr", "--max-error", "1000"]);
    assert_eq!((status, stderr.as_str()), (3, "error: 2 pixels of `odd.exr` are not finite\n"), "never pass");
    assert!(stdout.contains("non-finite  2 pixels in odd.exr, 0 in b.exr"), "{stdout}");
}

#[test]
fn pictures_without_a_finite_pixel_have_no_error() {
    let place = Place::new();
    place.picture("nan", |_, _| f32::NAN);
    let found = place.json(&["nan.exr", "b.exr"]);
    assert_eq!(
        (&found["mse"], &found["flip"], &found["pixels"]),
        (&Value::Null, &Value::Null, &0.into()),
        "{found}"
    );
    let (status, stdout, _) = place.run(&["nan.exr", "b.exr", "--max-error", "1000"]);
    assert!(status == 3 && stdout.contains("mse         none\n"), "{stdout}");
}

#[test]
fn differences_are_written_as_numbers_and_as_colours() {
    let place = Place::new();
    let (status, _, stderr) = place.run(&["a.exr", "b.exr", "-o", "d.exr", "-o", "d.png"]);
    assert_eq!((status, stderr.as_str()), (0, "wrote d.exr\nwrote d.png\n"), "told");
    let picture = exr::read(&place.path("d.exr")).expect("read");
    let channel = |name: &str| picture.channel(name).expect(name).to_f32();
    let (red, green, flip) = (channel("R"), channel("G"), channel("flip"));
    assert!((red[3 * 24 + 5] - 2.0).abs() < 1e-6 && (green[3 * 24 + 5] - 0.5).abs() < 1e-6, "A - B");
    assert!(flip.iter().all(|&error| error > 0.0 && error <= 1.0), "{flip:?}");
    let told: f64 = picture.attribute("specula:flip").expect("told").parse().expect("a number");
    let mean = flip.iter().map(|&x| f64::from(x)).sum::<f64>() / f64::from(SIZE[0] * SIZE[1]);
    assert!((told - mean).abs() < 1e-9, "{told} and {mean}");
    assert_eq!(picture.attribute("specula:reference"), Some("b.exr"), "what it is");
    let shown = png::read(&place.path("d.png")).expect("read").image;
    let bytes = Development { exposure_ev: 0.0, curve: Curve::Clip };
    for (pixel, &error) in shown.pixels().iter().zip(&flip) {
        assert_eq!(bytes.bytes(*pixel), magma::colour(error), "{error}");
    }
}

#[test]
fn crops_of_the_same_pixels_are_compared_where_they_lie() {
    let place = Place::new();
    let window = Window { x0: 10, y0: 20, x1: 34, y1: 36 };
    for name in ["a", "b"] {
        let image = specula::image::read(&place.path(&format!("{name}.exr"))).expect("read").image;
        place.write_exr(&format!("crop_{name}"), &image, window, [50, 40]);
    }
    let whole = place.json(&["a.exr", "b.exr"]);
    let crop = place.json(&["crop_a.exr", "crop_b.exr", "-o", "d.exr", "-q"]);
    assert_eq!((&crop["mse"], &crop["flip"]), (&whole["mse"], &whole["flip"]), "the same pixels");
    assert_eq!(crop["largest"]["pixel"], serde_json::json!([15, 23]), "in the whole picture");
    assert_eq!(crop["crop"], serde_json::json!([10, 20, 34, 36]), "{crop}");
    let picture = exr::read(&place.path("d.exr")).expect("read");
    assert_eq!((picture.window, picture.full), (window, [50, 40]), "a crop as well");

    place.write_exr("moved", &Image::new(24, 16), Window { x0: 11, y0: 20, x1: 35, y1: 36 }, [50, 40]);
    let (status, _, stderr) = place.run(&["crop_a.exr", "moved.exr"]);
    assert_eq!(status, 2, "{stderr}");
    assert!(stderr.contains("10,20,34,36") && stderr.contains("11,20,35,36; render both with"), "{stderr}");
}

#[test]
fn wrong_input_ends_with_status_2_says_what_to_do_and_leaves_the_old_file() {
    let place = Place::new();
    place.write("small", &Image::new(12, 16));
    fs::write(place.path("text.exr"), "no picture").expect("written");
    fs::write(place.path("text.png"), "no picture").expect("written");
    fs::write(place.path("a.jpg"), "no picture").expect("written");
    fs::write(place.path("old.exr"), "old").expect("written");
    fs::create_dir(place.path("dir.exr")).expect("created");
    let before = place.0.names();
    let cases: [(&[&str], &[&str]); 21] = [
        (&[], &["<A>", "<B>"]),
        (&["a.exr"], &["<B>"]),
        (&["none.exr", "b.exr"], &["none.exr: there is no such file; "]),
        (&["none.exr", "neither.exr"], &["none.exr: there is", "neither.exr: there is"]),
        (&["dir.exr", "b.exr"], &["dir.exr: a directory, not a picture; "]),
        (&["a.jpg", "b.exr"], &["a.jpg: not a picture that can be read; use an .exr, .hdr or .png file"]),
        (&["text.exr", "b.exr"], &["text.exr: not a sound EXR file", "; "]),
        (&["a.png", "text.png"], &["text.png: not a sound PNG picture", "; "]),
        (&["text.exr", "text.png"], &["text.exr: not", "text.png: not"]),
        (&["a.exr", "small.exr"], &["`a.exr` has 24 by 16 pixels, `small.exr` has 12 by 16 pixels; "]),
        (&["small.png", "b.png"], &["`small.png` has 12 by 16 pixels, `b.png` has 24 by 16 pixels; "]),
        (
            &["a.png", "b.exr"],
            &["`a.png` holds what a display shows, `b.exr` holds light of a scene; ", "compare two"],
        ),
        (&["a.exr", "b.exr", "--max-error", "-1"], &["--max-error -1", "from 0 on"]),
        (&["a.exr", "b.exr", "--max-error", "nan"], &["--max-error nan"]),
        (&["a.exr", "b.exr", "--max-error", "little"], &["--max-error little"]),
        (&["a.exr", "b.exr", "--metric", "ssim"], &["--metric ssim", "mse, rmse, relmse, flip"]),
        (&["a.exr", "b.exr", "--ppd", "0"], &["--ppd 0", "from 1 to 1000"]),
        (&["a.exr", "b.exr", "-t", "0"], &["--threads 0"]),
        (&["a.exr", "b.exr", "-o", "d.jpg"], &["d.jpg", ".exr or .png"]),
        (&["a.exr", "b.exr", "-o", "no/d.png"], &["no/d.png", "create it"]),
        (&["a.exr", "b.exr", "-o", "./b.exr"], &["./b.exr", "would be overwritten; "]),
    ];
    for (words, parts) in cases {
        let words = if words.len() < 2 { words.to_vec() } else { [words, &["-o", "old.exr"]].concat() };
        let (status, stdout, stderr) = place.run(&words);
        assert_eq!((status, stdout.as_str()), (2, ""), "{words:?}: {stderr}");
        for part in parts {
            assert!(stderr.contains(part), "{words:?}: `{part}` in {stderr}");
        }
        assert!(!stderr.contains("panicked"), "{words:?}: {stderr}");
        assert_eq!(fs::read(place.path("old.exr")).expect("there"), b"old", "{words:?}: untouched");
    }
    assert_eq!(place.0.names(), before, "nothing else is left");
}

#[test]
fn several_wrong_words_are_told_together() {
    let place = Place::new();
    let words =
        ["none.exr", "b.exr", "--max-error", "x", "--metric", "y", "--ppd", "z", "-t", "w", "-o", "d"];
    let (status, _, stderr) = place.run(&words);
    let told = stderr.lines().filter(|line| line.starts_with("error: ")).count();
    assert_eq!((status, told), (2, 6), "{stderr}");
}

#[test]
fn an_instruction_set_that_is_not_there_is_refused() {
    let place = Place::new();
    let mut command = place.0.command();
    let output = command.args(["diff", "a.exr", "b.exr"]).env("SPECULA_ISA", "mmx").output().expect("run");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("SPECULA_ISA: unknown instruction set `mmx`"), "{stderr}");
}

#[test]
fn threads_change_nothing() {
    let place = Place::new();
    let one = place.json(&["a.exr", "b.exr", "-t", "1"]);
    assert_eq!(one, place.json(&["a.exr", "b.exr", "-t", "3"]), "the same document");
}

#[test]
fn logs_are_chosen_as_for_render() {
    let place = Place::new();
    let told = |words: &[&str]| place.run(&[&["a.exr", "b.exr", "-o", "d.png"], words].concat()).2;
    assert_eq!(told(&["-q"]), "", "quiet");
    let metric = told(&["-q", "--metric", "flip"]);
    assert!(metric.starts_with("warning: `--metric` says"), "{metric}");
    let line = told(&["--log-format", "json"]);
    let entry: Value = serde_json::from_str(line.lines().next().expect("a line")).expect("JSON");
    assert_eq!(entry["fields"]["message"], "wrote d.png", "{line}");
}
