//! What ways of asking lights and of ending paths cost and bring: CPU time and error of pictures of paths.
//!
//! Tables: a panel near a floor, drawn from by solid angle and by area; the choice of one light among many; the length from which paths may
//! end at random; how much of the error the light of the first hit has, which is what splitting paths there could save.
//! `cargo bench --bench lights [-- part of a table's name]`.
//!
//! Gain is 1 / (CPU seconds x relMSE) over that of the first row: above 1, the same error is reached sooner. References have other random
//! numbers and sixteen times as many samples or more.

#![expect(clippy::print_stdout, reason = "a bench prints its results")]

#[path = "../tests/support/peers.rs"]
mod peers;
#[path = "support/pictures.rs"]
mod pictures;
#[path = "support/places.rs"]
mod places;
#[path = "support/terrain.rs"]
mod terrain;

use pictures::{errors, rendered};
use specula::film::{Aov, Layout};
use specula::image::Image;
use specula::math::Rgb;
use specula::render::{Settings, Silent};
use specula::scene::Scene;
use std::error::Error;
use std::fmt::Write as _;

/// Pictures with different seeds whose times and errors are averaged.
const SEEDS: u32 = 4;

/// Pictures are as wide as this, and 3/4 as high.
const WIDTH: u32 = 96;

/// A scene by the keys of its table `render`; none where its files are missing.
type Place<'a> = &'a dyn Fn(&str) -> Result<Option<Scene>, Box<dyn Error>>;

/// A row: its name and its keys, or another scene for the same light.
type Way<'a> = (String, String, Place<'a>);

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    // Under `cargo test --benches` it only shows that it runs.
    let is_bench = words.iter().any(|word| word == "--bench");
    let filter = words.iter().find(|word| !word.starts_with("--"));
    let wants = |name: &str| filter.is_none_or(|part| name.contains(part.as_str()));
    let counts = if is_bench { [64, 2048] } else { [1, 2] };
    if wants("panel") {
        let (whole, cut) = (|keys: &str| panel(keys, false), |keys: &str| panel(keys, true));
        let ways = [("by area", &cut as Place<'_>), ("by solid angle", &whole)];
        let ways = ways.map(|(name, place)| (name.to_owned(), "light_choice = \"power\"".to_owned(), place));
        table("panel", counts, &ways)?;
    }
    for count in [2, 3, 4, 8, 16, 100, 1000] {
        let name = format!("{count} lights");
        let place = |keys: &str| lamps(count, keys);
        let ways = ["power", "uniform", "tree"]
            .map(|choice| (choice.to_owned(), format!("light_choice = \"{choice}\""), &place as Place<'_>));
        if wants(&name) {
            table(&name, counts, &ways)?;
        }
    }
    let places: [(&str, Place<'_>); 4] = [
        ("closed box", &|keys| places::peer("cornell", keys, WIDTH)),
        ("glossy row", &|keys| places::peer("glossyrow", keys, WIDTH)),
        ("hello", &hello),
        ("glass", &glass),
    ];
    for (name, place) in places {
        let name = format!("roulette, {name}");
        let first = ["\"off\"", "2", "3", "5", "8"];
        let ways = first.map(|first| (first.replace('"', ""), format!("roulette = {first}"), place));
        if wants(&name) {
            table(&name, counts, &ways)?;
        }
    }
    let [whole, some] = [|keys: &str| panel(keys, false), |keys: &str| lamps(16, keys)];
    let further: [(&str, Place<'_>); 2] = [("panel", &whole), ("16 lights", &some)];
    for (name, place) in places.into_iter().chain(further) {
        if wants(&format!("first hit, {name}")) {
            first_hit(name, if is_bench { [32, 4096] } else { counts }, place)?;
        }
    }
    Ok(())
}

/// Rays of each kind that the light of the first hit is averaged over.
const SPLIT: u32 = 64;

/// The error of paths, and what is left of it where the light of the first hit (all that comes by two edges) is averaged over many rays
/// towards lights and in lobes, the paths going on as before, and where it has no error at all. The averages come from trees, whose samples
/// of a pixel begin with the same camera rays.
fn first_hit(name: &str, [spp, many]: [u32; 2], place: Place<'_>) -> Result<(), Box<dyn Error>> {
    let path = |spp: u32, seed: u32| {
        let render = format!("integrator = \"path\"\nspp = {spp}\nseed = {seed}");
        parts(place, &render, None)
    };
    let tree = |spp: u32, seed: u32| {
        let rays = format!("light_samples = {SPLIT}\nglossy_samples = {SPLIT}");
        let render = format!("integrator = \"distribution\"\nspp = {spp}\nseed = {seed}\n{rays}");
        parts(place, &render, Some(2))
    };
    let Some([all, direct, _]) = path(many, 1000)? else { return Ok(()) };
    let mut found = [0.0; 4];
    for seed in 0..SEEDS {
        let (Some([own, own_direct, rest]), Some([split, ..])) = (path(spp, seed)?, tree(spp, seed)?) else {
            return Ok(());
        };
        let pictures =
            [own, sum(&rest, &split), sum(&rest, &direct), sum(&all, &difference(&own_direct, &direct))];
        for (error, picture) in found.iter_mut().zip(&pictures) {
            *error += errors(picture, &all)?.relmse / f64::from(SEEDS);
        }
    }
    println!("\nfirst hit, {name}, {} x {}, {spp} samples\n", all.width(), all.height());
    println!("| | relMSE, 10^-6 | of that of paths |\n|---|---|---|");
    let split = format!("light of the first hit by {SPLIT} rays of each kind");
    let names = [
        "paths",
        &split,
        "light of the first hit without error",
        "error of the light of the first hit alone",
    ];
    for (name, error) in names.into_iter().zip(found) {
        println!("| {name} | {:.0} | {:.3} |", error * 1e6, error / found[0]);
    }
    Ok(())
}

/// A picture, the part of it that came by two edges at most, and the rest; by so many edges, if that is not for the scene to say.
fn parts(place: Place<'_>, render: &str, edges: Option<u32>) -> Result<Option<[Image; 3]>, Box<dyn Error>> {
    let Some(mut scene) = place(render)? else { return Ok(None) };
    scene.render.max_depth = edges.unwrap_or(scene.render.max_depth);
    let layout = Layout::with([Aov::Direct, Aov::Indirect]);
    let film = specula::render::render(&scene, &Settings { layout, ..Settings::default() }, &Silent)?.film;
    let image = |aov: Aov| {
        let mut image = Image::new(film.window().width(), film.window().height());
        let channels = film.channels(aov).unwrap_or_default();
        for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
            *pixel = Rgb::new(channels[0][i], channels[1][i], channels[2][i]);
        }
        image
    };
    Ok(Some([Aov::Beauty, Aov::Direct, Aov::Indirect].map(image)))
}

fn sum(a: &Image, b: &Image) -> Image {
    combined(a, b, |a, b| a + b)
}

fn difference(a: &Image, b: &Image) -> Image {
    combined(a, b, |a, b| a - b)
}

fn combined(a: &Image, b: &Image, of: impl Fn(Rgb<f32>, Rgb<f32>) -> Rgb<f32>) -> Image {
    let mut image = a.clone();
    image.pixels_mut().iter_mut().zip(b.pixels()).for_each(|(a, b)| *a = of(*a, *b));
    image
}

fn table(name: &str, [spp, many]: [u32; 2], ways: &[Way<'_>]) -> Result<(), Box<dyn Error>> {
    let picture =
        |(_, keys, place): &Way<'_>, spp: u32, seed: u32| -> Result<Option<(Image, f64)>, Box<dyn Error>> {
            let depth = if name.contains("roulette") { "" } else { "max_depth = 4\nroulette = \"off\"\n" };
            let depth = if name.contains("glass") { "max_depth = 64\n" } else { depth };
            let render = format!("integrator = \"path\"\nspp = {spp}\nseed = {seed}\n{depth}{keys}");
            let Some(scene) = place(&render)? else { return Ok(None) };
            let found = rendered(&scene)?;
            Ok(Some((found.film.image(), found.statistics.render.cpu.as_secs_f64())))
        };
    let Some((truth, _)) = picture(&ways[ways.len() - 1], many, 1000)? else { return Ok(()) };
    println!("\n{name}, {} x {}, {spp} samples\n", truth.width(), truth.height());
    println!("| | CPU s | relMSE, 10^-6 | gain |\n|---|---|---|---|");
    let mut found = vec![[0.0; 2]; ways.len()];
    for seed in 0..SEEDS {
        // There and back, so that what else the machine does falls on all.
        let order: Vec<_> =
            if seed % 2 == 0 { (0..ways.len()).collect() } else { (0..ways.len()).rev().collect() };
        for i in order {
            let Some((image, seconds)) = picture(&ways[i], spp, seed)? else { continue };
            found[i][0] += seconds / f64::from(SEEDS);
            found[i][1] += errors(&image, &truth)?.relmse / f64::from(SEEDS);
        }
    }
    let cost = |[seconds, error]: [f64; 2]| seconds * error;
    for ((way, _, _), own) in ways.iter().zip(&found) {
        let gain = cost(found[0]) / cost(*own);
        println!("| {way} | {:.3} | {:.0} | {gain:.2} |", own[0], own[1] * 1e6);
    }
    Ok(())
}

/// Head of a scene with a table `render`, two materials and a floor.
fn head(eye: &str, keys: &str) -> String {
    format!(
        "[camera]\n{eye}\nvfov_deg = 45.0\n[film]\nwidth = {WIDTH}\nheight = {}\nfilter = \"box\"\n[render]\n{keys}\n\
         [materials.wall]\ntype = \"diffuse\"\nreflectance = [0.6, 0.55, 0.5]\n\
         [materials.gloss]\ntype = \"glossy\"\nexponent = 40\ndiffuse = [0.3, 0.2, 0.1]\n\
         [[shapes]]\ntype = \"rectangle\"\nedge_u = [9.0, 0.0, 0.0]\nedge_v = [0.0, 0.0, -9.0]\nmaterial = \"wall\"\n",
        WIDTH * 3 / 4
    )
}

/// A wide panel low over a box and a ball; as a rectangle, or `cut` into more triangles than are looked at one by one.
fn panel(keys: &str, cut: bool) -> Result<Option<Scene>, Box<dyn Error>> {
    let mut text = head("from = [0.0, 0.9, 3.2]\nat = [0.0, 0.45, 0.0]", keys);
    text += "[[shapes]]\ntype = \"box\"\nmin = [-0.9, 0.0, -0.3]\nmax = [-0.4, 0.7, 0.2]\nmaterial = \"wall\"\n\
             [[shapes]]\ntype = \"sphere\"\ncenter = [0.4, 0.35, 0.2]\nradius = 0.35\nmaterial = \"gloss\"\n\
             [[lights]]\nradiance = 2.0\n";
    let folder = tempfile::tempdir()?;
    if cut {
        text += "type = \"mesh\"\nfile = \"panel.obj\"\n";
        let mut mesh = String::new();
        for i in 0..=8_u16 {
            let x = f32::from(i) * 0.4 - 1.6;
            let _ = writeln!(mesh, "v {x} 0.85 -1.4\nv {x} 0.85 1.0");
        }
        for i in (1..16).step_by(2) {
            let _ = writeln!(mesh, "f {} {} {} {}", i, i + 2, i + 3, i + 1);
        }
        std::fs::write(folder.path().join("panel.obj"), mesh)?;
    } else {
        text += "type = \"rectangle\"\ncenter = [0.0, 0.85, -0.2]\nedge_u = [1.6, 0.0, 0.0]\nedge_v = [0.0, 0.0, 1.2]\n";
    }
    let file = folder.path().join("scene.toml");
    std::fs::write(&file, text)?;
    let loaded = specula::scene::load(&file, &[])?;
    Ok(Some(specula::scene::build(&loaded.description)?.scene))
}

/// Balls under small lamps, as bright together however many there are.
fn lamps(count: u32, keys: &str) -> Result<Option<Scene>, Box<dyn Error>> {
    let mut text = head("from = [0.0, 3.0, 9.0]\nat = [0.0, 0.6, 0.0]", keys);
    // Places that spread evenly: the generalised golden ratio.
    let place =
        |i: u32, k: u32| (0.5 + f64::from(i) * [0.819_172_5, 0.671_043_6, 0.549_700_5][k as usize]).fract();
    for i in 0..8 {
        let (x, z) = (f64::from(i) - 3.5, place(i, 0) * 4.0 - 2.0);
        let material = if i % 2 == 0 { "wall" } else { "gloss" };
        let _ = writeln!(
            text,
            "[[shapes]]\ntype = \"sphere\"\ncenter = [{x:?}, 0.45, {z:?}]\nradius = 0.45\nmaterial = \"{material}\""
        );
    }
    for i in 0..count {
        let [x, y, z] = [place(i, 0) * 14.0 - 7.0, 1.0 + place(i, 1) * 1.5, place(i, 2) * 12.0 - 7.0];
        let radiance = [1000.0, 3000.0, 9000.0][i as usize % 3] / f64::from(count);
        let form = if i % 2 == 0 {
            "type = \"sphere\"\nradius = 0.06"
        } else {
            "type = \"rectangle\"\nedge_u = [0.08, 0.0, 0.0]\nedge_v = [0.0, 0.0, 0.06]"
        };
        let _ = writeln!(text, "[[lights]]\n{form}\ncenter = [{x:?}, {y:?}, {z:?}]\nradiance = {radiance:?}");
    }
    places::of_text(&text).map(Some)
}

fn hello(keys: &str) -> Result<Option<Scene>, Box<dyn Error>> {
    let keys = keys.lines().filter_map(|line| line.split_once(" = "));
    let keys: Vec<String> = keys.map(|(key, value)| format!("render.{key}={value}")).collect();
    let size = [format!("film.width={WIDTH}"), format!("film.height={}", WIDTH * 9 / 16)];
    let keys: Vec<&str> = keys.iter().chain(&size).map(String::as_str).collect();
    places::of_file("hello", &keys).map(Some)
}

/// Twenty balls of glass in a bright room.
fn glass(keys: &str) -> Result<Option<Scene>, Box<dyn Error>> {
    let mut text = head("from = [0.0, 1.0, 2.6]\nat = [0.0, 0.7, 0.0]", keys);
    text += "[materials.bright]\ntype = \"diffuse\"\nreflectance = 0.85\n\
             [materials.glass]\ntype = \"dielectric\"\nior = 1.8\nabsorption = [0.05, 0.02, 0.1]\n\
             [[shapes]]\ntype = \"box\"\nmin = [-2.0, -0.001, -2.0]\nmax = [2.0, 3.0, 3.0]\nmaterial = \"bright\"\n\
             [[lights]]\ntype = \"rectangle\"\ncenter = [0.0, 2.9, 0.0]\nedge_u = [0.7, 0.0, 0.0]\nedge_v = [0.0, 0.0, 0.7]\nradiance = 4.0\n";
    for i in 0..20_u16 {
        let (x, y) = (f32::from(i % 5) * 0.6 - 1.2, f32::from(i / 5) * 0.55 + 0.3);
        let z = f32::from(i % 3) * 0.2 - 0.8;
        let _ = writeln!(
            text,
            "[[shapes]]\ntype = \"sphere\"\ncenter = [{x:?}, {y:?}, {z:?}]\nradius = 0.26\nmaterial = \"glass\""
        );
    }
    places::of_text(&text).map(Some)
}
