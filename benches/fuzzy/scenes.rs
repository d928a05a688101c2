//! Errors and times of the contenders against 4096 rays a pixel.

use crate::loglog::{Curve, Panel, svg};
use crate::masks::{Class, classes};
use crate::pictures::file_of;
use specula::error::Result;
use specula::film::Layout;
use specula::image::{Image, exr};
use specula::render::{Rendered, Settings, Silent, render};
use specula::scene::{self, Scene};
use std::error::Error;
use std::num::NonZeroUsize;
use std::path::Path;

/// Columns and rows of the pictures.
const SIZE: [u32; 2] = [192, 120];

/// Rays of a pixel of the reference.
pub(crate) const REFERENCE: u32 = 4096;

const SCENES: [&str; 5] = ["fuzzy_plane", "fuzzy_curved", "fuzzy_contact", "fuzzy_silhouettes", "fuzzy_100"];

/// Keys beside the number of samples, and the numbers.
type Contender = (&'static str, &'static [&'static str], &'static [u32]);

const CONTENDERS: [Contender; 4] = [
    ("two-pass", &["render.glossy=two-pass"], &[1, 4, 16]),
    ("lobe", &["render.glossy=lobe"], &[1, 4, 16, 64, 256]),
    ("jitter", &["render.glossy=jitter"], &[1, 4, 16, 64, 256]),
    (
        "as published",
        &[
            "render.glossy=two-pass",
            "render.fuzzy.radius=cone",
            "render.fuzzy.correction=none",
            "render.fuzzy.pyramid=off",
            "render.fuzzy.max_angle_deg=10",
        ],
        &[4],
    ),
];

/// A picture of a contender.
struct Shot {
    spp: u32,
    seconds: f64,
    /// RMSE over the mask and over each of its classes.
    errors: [f64; 4],
}

/// Prints the tables and draws the plot, against references of so many rays; without a number it only shows that it runs.
pub(crate) fn tables(rays: Option<u32>, part: &str) -> std::result::Result<(), Box<dyn Error>> {
    let is_bench = rays.is_some();
    let mut panels = Vec::new();
    for name in SCENES.into_iter().filter(|name| name.contains(part)) {
        let reference = reference(name, rays.unwrap_or(4))?;
        let first = rendered(name, (&["render.glossy=two-pass"], 4), 0, true)?.first_pass;
        let classes = classes(&first);
        let count = |class| classes.iter().filter(|other| **other == class).count();
        println!(
            "\n{name}, {} x {}, pixels: {}",
            SIZE[0],
            SIZE[1],
            Class::OF_MASK.map(|c| format!("{} {}", count(c), c.name())).join(", ")
        );
        println!(
            "way | samples | CPU s | RMSE in the mask | inside | silhouettes | contact\n---|---|---|---|---|---|---"
        );
        let mut found = Vec::new();
        for (way, keys, numbers) in CONTENDERS {
            let mut shots = Vec::new();
            for &spp in if is_bench { numbers } else { &numbers[..1] } {
                let picture = rendered(name, (keys, spp), 0, false)?;
                let seconds = picture.statistics.render.cpu.as_secs_f64();
                let errors = errors(&picture.film.image(), &reference, &classes);
                let [all, inside, silhouettes, contact] = errors.map(|e| format!("{e:.5}"));
                println!("{way} | {spp} | {seconds:.3} | {all} | {inside} | {silhouettes} | {contact}");
                shots.push(Shot { spp, seconds, errors });
            }
            found.push((way, shots));
        }
        compare(&found);
        let curve = |(way, shots): &(&str, Vec<Shot>)| Curve {
            label: (*way).to_owned(),
            points: shots.iter().map(|shot| [shot.seconds, shot.errors[0]]).collect(),
        };
        let curves = found.iter().take(3).map(curve).collect();
        panels.push(Panel { title: name.to_owned(), axes: ["CPU seconds", "RMSE in the mask"], curves });
    }
    if is_bench && part.is_empty() {
        std::fs::write(
            Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/record/fuzzy.svg"),
            svg(&panels)?,
        )?;
    }
    Ok(())
}

/// At the time of the filter what the others have for errors, and how long they take to its errors.
fn compare(found: &[(&str, Vec<Shot>)]) {
    let (_, filtered) = &found[0];
    for mine in filtered.iter().filter(|shot| [1, 4, 16].contains(&shot.spp)) {
        for (way, shots) in &found[1..3] {
            for (class, name) in [(0, "the mask"), (1, "inside")] {
                let points: Vec<_> =
                    shots.iter().map(|shot| [shot.seconds.ln(), shot.errors[class].max(1e-9).ln()]).collect();
                if points.len() < 2 || mine.errors[class] <= 0.0 {
                    continue;
                }
                let error = line(&points, mine.seconds.ln()).exp();
                let turned: Vec<_> = points.iter().map(|&[x, y]| [y, x]).collect();
                let seconds = line(&turned, mine.errors[class].ln()).exp();
                let ratio = seconds / mine.seconds;
                let times = if ratio < 1e4 {
                    format!("takes {ratio:.1} times as long to its error")
                } else {
                    "never has its error".to_owned()
                };
                println!(
                    "{} samples of two-pass, {name}: {way} has {:.2} of its error in its time, and {times}{}",
                    mine.spp,
                    error / mine.errors[class],
                    if turned.last().is_some_and(|last| mine.errors[class].ln() < last[0]) {
                        " (by the last slope)"
                    } else {
                        ""
                    },
                );
            }
        }
    }
}

/// The height at x of a line through points, straight between neighbours and beyond the last two at either end.
fn line(points: &[[f64; 2]], x: f64) -> f64 {
    let rising = points[0][0] < points[points.len() - 1][0];
    let after = |point: &[f64; 2]| if rising { point[0] >= x } else { point[0] <= x };
    let i = points.iter().position(after).unwrap_or(points.len()).clamp(1, points.len() - 1);
    let ([x0, y0], [x1, y1]) = (points[i - 1], points[i]);
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}

fn reference(name: &str, spp: u32) -> Result<Image> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/fuzzy");
    let file = folder.join(format!("{name}_{}_{spp}.exr", SIZE[0]));
    if file.exists() {
        return Ok(specula::image::read(&file)?.image);
    }
    let scene = scene_of(name, (&["render.glossy=lobe", "render.seed=77"], spp))?;
    let film = render(&scene, &Settings::default(), &Silent)?.film;
    if std::fs::create_dir_all(&folder).is_ok() {
        exr::write(&file, film.picture(specula::film::Precision::Float, Vec::new()))?;
    }
    Ok(film.image())
}

/// A picture by one thread, one ray at a time: all contenders trace alike.
fn rendered(name: &str, what: (&[&str], u32), seed: u64, first_pass: bool) -> Result<Rendered> {
    let mut scene = scene_of(name, what)?;
    scene.render.seed = seed;
    scene.render.query = Some(scene::description::Query::Single);
    let layout = Layout::default();
    render(
        &scene,
        &Settings { threads: NonZeroUsize::new(1), layout, first_pass, ..Settings::default() },
        &Silent,
    )
}

fn scene_of(name: &str, (keys, spp): (&[&str], u32)) -> Result<Scene> {
    let [width, height] = SIZE;
    let own = [
        format!("film.width={width}"),
        format!("film.height={height}"),
        format!("render.spp={spp}"),
        "film.filter=box".to_owned(),
    ];
    let keys: Vec<_> = own.into_iter().chain(keys.iter().map(|key| (*key).to_owned())).collect();
    Ok(scene::build(&scene::load(&file_of(name), &keys)?.description)?.scene)
}

/// RMSE over the mask, inside, at silhouettes and at contacts.
fn errors(test: &Image, reference: &Image, classes: &[Class]) -> [f64; 4] {
    let of = |wanted: &dyn Fn(Class) -> bool| {
        let (mut sum, mut count) = (0.0, 0.0);
        for ((a, b), class) in test.pixels().iter().zip(reference.pixels()).zip(classes) {
            if wanted(*class) {
                for (a, b) in [(a.r, b.r), (a.g, b.g), (a.b, b.b)] {
                    sum += f64::from(a - b).powi(2);
                    count += 1.0;
                }
            }
        }
        f64::sqrt(sum / f64::max(count, 1.0))
    };
    let [inside, silhouettes, contact] = Class::OF_MASK.map(|class| of(&|other| other == class));
    [of(&|class| class != Class::Outside), inside, silhouettes, contact]
}
