//! The command `fuzzy`.

use serde_json::Value;

use super::args::FuzzyArgs;
use super::interrupt::Interrupt;
use super::options::{FuzzyOptions, Output};
use super::{log, output, threads};
use crate::error::{Problem, Result};
use crate::film::{Film, Layout, Precision, SampleId, Tile};
use crate::image::exr::{self, Picture};
use crate::image::tone::{Curve, Development};
use crate::image::{Format, png};
use crate::math::lanes::{Level, VARIABLE};
use crate::post::{self, Fuzzy, GBuffer};
use crate::render::{Phase, filter_of};
use crate::scene::load::fuzzy_filter;
use crate::trust::Trust;

/// The metadata with the knobs of the filter, a JSON document.
pub(super) const KNOBS: &str = "specula:fuzzy";

/// The metadata with the exposure of previews, and with the word of their curve.
pub(super) const PREVIEW: [&str; 2] = ["specula:exposure_ev", "specula:tone"];

/// Filters a saved first pass to files, whose names it prints.
pub(super) fn run(args: &FuzzyArgs) -> Result<()> {
    log::start(&args.log);
    let interrupt = Interrupt::listen();
    let options = FuzzyOptions::new(args)?;
    threads::limit(options.threads);
    let level = Level::from_env().map_err(|error| Problem::new(format!("{VARIABLE}: {error}")))?;
    let trust = Trust { limits: options.limits, sandbox: None };
    let picture = exr::read_within(&options.gbuffer, &trust)?;
    log::warn(&picture.warnings);
    let described = fuzzy_filter(&knobs(&picture, &options))?;
    let mut samples = post::saved(&picture, &options.gbuffer)?;
    for g in &mut samples {
        if let Some(exponent) = options.exponent {
            g.set_exponent(exponent);
        }
        g.set_strength(described.strength);
    }
    interrupt.check()?;
    let fuzzy = filter_of(&described);
    let (film, time) = Phase::of(|| film(&samples, &fuzzy, level, &interrupt));
    let film = film?;
    let pixels = film.window().area() * samples.len();
    tracing::info!(
        "filtered {:.2} million pixels in {:.2} s ({:.2} s of the processors)",
        pixels as f64 * 1e-6,
        time.wall.as_secs_f64(),
        time.cpu.as_secs_f64(),
    );
    let mut attributes = picture.attributes.clone();
    attributes
        .retain(|(key, _)| key.starts_with("specula:") && key != KNOBS && !key.starts_with("specula:fuzzy_"));
    attributes.push((KNOBS.to_owned(), described.to_json().to_string()));
    attributes.extend(options.exponent.map(|x| ("specula:exponent".to_owned(), x.to_string())));
    let mut names = String::new();
    for Output { path, format } in &options.outputs {
        match format {
            Format::Exr => log::warn(&exr::write(path, film.picture(Precision::Float, attributes.clone()))?),
            Format::Png => png::write(path, &film.image(), development(&picture))?,
        }
        names += &format!("{}\n", path.display());
    }
    output::print(names.as_bytes())
}

/// The knobs that the picture was rendered with, then those of the command line.
fn knobs(picture: &Picture, options: &FuzzyOptions) -> Vec<String> {
    let saved = picture.attribute(KNOBS).and_then(|text| serde_json::from_str(text).ok());
    let saved = if let Some(Value::Object(saved)) = saved { saved } else { serde_json::Map::new() };
    let word = |value: Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let saved = saved.into_iter().map(|(key, value)| format!("{key}={}", word(value)));
    saved.chain(options.settings.iter().cloned()).collect()
}

/// The mean of the filtered samples, as the film of a rendering takes it.
fn film(samples: &[GBuffer], fuzzy: &Fuzzy, level: Level, interrupt: &Interrupt) -> Result<Film> {
    let (full, window) =
        samples.first().map_or(([1, 1], crate::image::Window::whole(1, 1)), |g| (g.full, g.window));
    let mut tile = Tile::new(window, Layout::default());
    for (index, g) in (0..).zip(samples) {
        interrupt.check()?;
        let filtered = post::filter(g, window, fuzzy, (level, index));
        let places = (window.y0..window.y1).flat_map(|y| (window.x0..window.x1).map(move |x| [x, y]));
        for (([x, y], &[r, g, b]), texel) in places.zip(&filtered.colour).zip(&g.texels) {
            tile.add(SampleId { x, y, index }, samples[index as usize].weight, &[r, g, b, texel.alpha]);
        }
    }
    let mut film = Film::new(full, window, Layout::default());
    film.put(&tile);
    Ok(film)
}

/// How the scene wanted to be shown.
fn development(picture: &Picture) -> Development {
    let [exposure, curve] = PREVIEW.map(|name| picture.attribute(name));
    Development {
        exposure_ev: exposure.and_then(|text| text.parse().ok()).unwrap_or(0.0),
        curve: if curve == Some("clip") { Curve::Clip } else { Curve::Filmic },
    }
}
