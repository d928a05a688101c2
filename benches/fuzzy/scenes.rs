//! Errors and times of the contenders against 4096 rays a pixel.

use crate::loglog::{Curve, Panel, svg};
use crate::masks::{Class, classes};
use crate::pictures::file_of;
use crate::versus::compare;
use specula::error::Result;
use specula::film::{Layout, Precision};
use specula::image::{Image, exr};
use specula::render::{Rendered, Settings, Silent, render};
use specula::scene::{self, Description, Scene};
use std::error::Error;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::num::NonZeroUsize;
use std::path::Path;

/// Columns and rows of the pictures.
const SIZE: [u32; 2] = [192, 120];

/// Rays of a pixel of the reference.
pub(crate) const REFERENCE: u32 = 4096;

/// Pictures that take less, in CPU seconds, are made several times: the median counts.
const SHORT: f64 = 0.5;

const SCENES: [&str; 7] =
    ["fuzzy_plane", "fuzzy_curved", "fuzzy_contact", "fuzzy_silhouettes", "fuzzy_0", "fuzzy_50", "fuzzy_100"];

/// Keys beside the number of samples, and the numbers.
type Contender = (&'static str, &'static [&'static str], &'static [u32]);

/// The first three are those of the comparison.
fn contenders(scene: &str) -> [Contender; 5] {
    // On the plane rays come as far down as the filter.
    let many: &[u32] = if scene == "fuzzy_plane" { &[1, 4, 16, 64, 256, 1024] } else { &[1, 4, 16, 64, 256] };
    [
        ("two-pass", &["render.glossy=two-pass"], &[1, 4, 16]),
        ("lobe", &["render.glossy=lobe"], many),
        ("jitter", &["render.glossy=jitter"], &[1, 4, 16, 64, 256]),
        (
            "two-pass, radius by distances",
            &["render.glossy=two-pass", "render.fuzzy.radius=cone"],
            &[1, 4, 16],
        ),
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
    ]
}

/// A picture of a contender.
pub(crate) struct Shot {
    pub(crate) spp: u32,
    pub(crate) seconds: f64,
    /// RMSE over the mask and over each of its classes, without the noise of the reference; nothing of a class without pixels.
    pub(crate) errors: [Option<f64>; 4],
}

/// Prints the tables and draws the plot, against references of so many rays; without a number it only shows that it runs.
pub(crate) fn tables(rays: Option<u32>, part: &str) -> std::result::Result<(), Box<dyn Error>> {
    let is_bench = rays.is_some();
    let (mut panels, mut lines) = (Vec::new(), Vec::new());
    for name in SCENES.into_iter().filter(|name| name.contains(part)) {
        let reference = Reference::of(name, rays.unwrap_or(4))?;
        let first = rendered(name, (&["render.glossy=two-pass"], 4), true)?.first_pass;
        let classes = classes(&first);
        let count = |class| classes.iter().filter(|other| **other == class).count();
        println!(
            "\n**`{name}`** (pixels: {}; noise of the reference, RMSE: {})\n",
            Class::OF_MASK.map(|c| format!("{} {}", count(c), c.name())).join(", "),
            reference.noise(&classes).map(|noise| number(noise.map(f64::sqrt))).join(", "),
        );
        println!(
            "| way | samples | CPU s | mask | inside | silhouettes | contact |\n|---|---|---|---|---|---|---|"
        );
        let mut found = Vec::new();
        for (way, keys, numbers) in contenders(name) {
            let mut shots = Vec::new();
            for &spp in if is_bench { numbers } else { &numbers[..1] } {
                let (picture, seconds) = timed(name, (keys, spp), is_bench)?;
                let errors = reference.errors(&picture, &classes);
                println!("| {way} | {spp} | {seconds:.3} | {} |", errors.map(number).join(" | "));
                shots.push(Shot { spp, seconds, errors });
            }
            found.push((way, shots));
        }
        lines.extend(compare(name, &found));
        panels.extend(drawn(name, &found));
    }
    println!("{}", crate::versus::HEAD);
    lines.iter().for_each(|line| println!("{line}"));
    if is_bench && SCENES.iter().all(|name| name.contains(part)) {
        std::fs::write(
            Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/record/fuzzy.svg"),
            svg(&panels)?,
        )?;
    }
    Ok(())
}

/// Traces the references, and nothing else.
pub(crate) fn references(rays: u32, part: &str) -> Result<()> {
    SCENES
        .into_iter()
        .filter(|name| name.contains(part))
        .try_for_each(|name| Reference::of(name, rays).map(|_| ()))
}

fn number(x: Option<f64>) -> String {
    x.map_or_else(String::new, |x| format!("{x:.5}"))
}

/// Error over time in the mask, and inside where there is an inside.
fn drawn(name: &str, found: &[(&str, Vec<Shot>)]) -> Vec<Panel> {
    let panel = |(class, place): (usize, &str)| {
        let curve = |(way, shots): &(&str, Vec<Shot>)| {
            let point = |shot: &Shot| Some([shot.seconds, shot.errors[class].filter(|error| *error > 0.0)?]);
            Curve { label: (*way).to_owned(), points: shots.iter().filter_map(point).collect() }
        };
        let curves: Vec<Curve> =
            found.iter().take(3).map(curve).filter(|curve| curve.points.len() > 1).collect();
        let title = format!("{name}, {place}");
        (!curves.is_empty()).then_some(Panel { title, axes: ["CPU seconds", "RMSE"], curves })
    };
    [(0, "mask"), (1, "inside")].into_iter().filter_map(panel).collect()
}

/// A picture by rays within the lobe, as the mean of two that know nothing of each other, so that their noise is known.
struct Reference {
    mean: Image,
    halves: [Image; 2],
}

impl Reference {
    fn of(name: &str, rays: u32) -> Result<Self> {
        let halves = [half(name, rays / 2, 77)?, half(name, rays / 2, 78)?];
        let both = halves[0].pixels().iter().zip(halves[1].pixels());
        let pixels = both.map(|(&a, &b)| (a + b).scale(0.5)).collect();
        let mean = Image::from_pixels(SIZE[0], SIZE[1], pixels).expect("as many pixels");
        Ok(Self { mean, halves })
    }

    /// The variance of the mean over the mask and over each of its classes: a quarter of the squared difference of both.
    fn noise(&self, classes: &[Class]) -> [Option<f64>; 4] {
        by_class([&self.halves[0], &self.halves[1]], classes).map(|square| Some(square? * 0.25))
    }

    /// RMSE by class.
    fn errors(&self, test: &Image, classes: &[Class]) -> [Option<f64>; 4] {
        let (squares, noise) = (by_class([test, &self.mean], classes), self.noise(classes));
        [0, 1, 2, 3].map(|i| Some((squares[i]? - noise[i]?).max(0.0).sqrt()))
    }
}

/// One half of a reference, kept in a file that is named after all of the scene that it depends on: the folder is to be removed when lobes,
/// lights or samplers change.
fn half(name: &str, spp: u32, seed: u32) -> Result<Image> {
    let description = described(name, (&["render.glossy=lobe", &format!("render.seed={seed}")], spp))?;
    let file = file_of(name);
    let identity = scene::identity(&description, file.parent().unwrap_or(Path::new("")), &[])?;
    let mut hasher = DefaultHasher::new();
    identity.to_string().hash(&mut hasher);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/fuzzy");
    let file = folder.join(format!("{name}_{spp}_{:016x}.exr", hasher.finish()));
    if file.exists() {
        return Ok(specula::image::read(&file)?.image);
    }
    let film = render(&scene::build(&description)?.scene, &Settings::default(), &Silent)?.film;
    if std::fs::create_dir_all(&folder).is_ok() {
        exr::write(&file, film.picture(Precision::Float, Vec::new()))?;
    }
    Ok(film.image())
}

/// A picture, and CPU seconds for it.
fn timed(name: &str, what: (&[&str], u32), is_bench: bool) -> Result<(Image, f64)> {
    let mut times = Vec::new();
    loop {
        let picture = rendered(name, what, false)?;
        times.push(picture.statistics.render.cpu.as_secs_f64());
        if !is_bench || times.len() >= 5 || times.iter().sum::<f64>() > SHORT {
            times.sort_by(f64::total_cmp);
            return Ok((picture.film.image(), times[times.len() / 2]));
        }
    }
}

/// A picture by one thread, one ray at a time: all contenders trace alike.
fn rendered(name: &str, what: (&[&str], u32), first_pass: bool) -> Result<Rendered> {
    let mut scene: Scene = scene::build(&described(name, what)?)?.scene;
    scene.render.query = Some(scene::description::Query::Single);
    let layout = Layout::default();
    render(
        &scene,
        &Settings { threads: NonZeroUsize::new(1), layout, first_pass, ..Settings::default() },
        &Silent,
    )
}

fn described(name: &str, (keys, spp): (&[&str], u32)) -> Result<Description> {
    let [width, height] = SIZE;
    let own = [
        format!("film.width={width}"),
        format!("film.height={height}"),
        format!("render.spp={spp}"),
        "film.filter=box".to_owned(),
    ];
    let keys: Vec<_> = own.into_iter().chain(keys.iter().map(|key| (*key).to_owned())).collect();
    Ok(scene::load(&file_of(name), &keys)?.description)
}

/// The mean of squared differences over the mask, inside, at silhouettes and at contacts.
fn by_class([a, b]: [&Image; 2], classes: &[Class]) -> [Option<f64>; 4] {
    let of = |wanted: &dyn Fn(Class) -> bool| {
        let (mut sum, mut count) = (0.0, 0.0);
        for ((a, b), class) in a.pixels().iter().zip(b.pixels()).zip(classes) {
            if wanted(*class) {
                for (a, b) in [(a.r, b.r), (a.g, b.g), (a.b, b.b)] {
                    sum += f64::from(a - b).powi(2);
                    count += 1.0;
                }
            }
        }
        (count > 0.0).then_some(sum / count)
    };
    let [inside, silhouettes, contact] = Class::OF_MASK.map(|class| of(&|other| other == class));
    [of(&|class| class != Class::Outside), inside, silhouettes, contact]
}
