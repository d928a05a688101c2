//! The command `render`.

use std::io;
use std::path::Path;
use std::time::Instant;

use serde_json::Value;

use super::args::RenderArgs;
use super::frozen::Frozen;
use super::interrupt::Interrupt;
use super::kept::{self, Kept};
use super::options::{Output, RenderOptions, Trusted};
use super::progress::{Meter, Shown, metric};
use super::statistics::{self, Times};
use super::{log, options, output, threads};
use crate::display::Display;
use crate::error::{Error, Result};
use crate::image::tone::{Curve, Development};
use crate::image::{Format, atomic, exr, png};
use crate::post;
use crate::render::{self, Ended, Estimate, Keeper, Limits, Part, Phase, Rendered, Settings};
use crate::scene::description::Tone;
use crate::scene::{self, Scene};

/// Renders a scene to files, whose names it prints.
pub(super) fn run(args: &RenderArgs) -> Result<()> {
    let start = Instant::now();
    log::start(&args.log);
    let interrupt = Interrupt::listen();
    let options = RenderOptions::new(args).map_err(|error| with_scene_problems(args, error))?;
    threads::limit(options.threads);

    let (frozen, load) = Phase::of(|| load(&options));
    let (frozen, about) = frozen?;
    let scene = &frozen.scene;
    interrupt.check()?;

    let kept = options.checkpoint.as_ref().map(|it| Kept::new(it, &options, about.clone()));
    let begin = kept.as_ref().map_or(Ok(None), Kept::begin)?;
    let meter = Meter::new(args.log.quiet, "samples", interrupt);
    let display = display(&options, scene)?;
    let settings = settings(&options, start);
    let keeper = kept.as_ref().map(|kept| -> &dyn Keeper { kept });
    let shown = Shown { meter: &meter, display: display.as_ref() };
    let rendered = render::render_kept(scene, &settings, &shown, render::Kept { begin, keeper });
    meter.finish();
    let rendered = rendered?;
    tell(&options, scene, &rendered);

    let (written, write) = Phase::of(|| {
        write(&options, &frozen, &rendered, load)?;
        write_parts(&options, (&frozen, about), (&settings, &rendered), load)
    });
    written?;
    if let Some(path) = &options.stats {
        let report = statistics::report(&options, &frozen, &rendered, Times { load, write });
        write_json(path, &report)?;
    }
    if let Some(kept) = kept {
        kept.remove();
    }
    if let Some(display) = display {
        display.finish(&rendered.film);
    }
    output::print(names(&options).as_bytes())
}

/// Where the picture is shown while it is made, if anywhere.
fn display(options: &RenderOptions, scene: &Scene) -> Result<Option<Display>> {
    let Some(place) = &options.display else { return Ok(None) };
    let (name, full) = (options.scene.display().to_string(), [scene.film.width, scene.film.height]);
    let warn = Box::new(|what: String| tracing::warn!("{what}"));
    let failed = |error: io::Error| Error::Backend { backend: "threads", what: error.to_string() };
    Display::start(place, &name, full, warn).map(Some).map_err(failed)
}

/// What the scene does not say. The limit of time began at `start`.
fn settings(options: &RenderOptions, start: Instant) -> Settings {
    Settings {
        threads: options.threads,
        crop: options.crop,
        layout: options.layout.clone(),
        first_pass: options.first_pass,
        slice: options.slice,
        limits: Limits {
            time: options.limits.time.map(|time| time.saturating_sub(start.elapsed())),
            ..options.limits
        },
    }
}

/// What is wrong with the command line, and with the scene as well, lest it be told only after the next try.
fn with_scene_problems(args: &RenderArgs, error: Error) -> Error {
    let Ok(trusted) = Trusted::alone(&args.trust) else { return error };
    let loaded = scene::load_within(&args.scene, &options::overrides(args), &trusted.of(&args.scene));
    match (error, loaded) {
        (Error::Input(mut problems), Err(Error::Input(more))) => {
            problems.0.extend(more.0);
            Error::Input(problems)
        }
        (error, _) => error,
    }
}

/// The frozen scene, and what it is of, where that is to be kept; warnings are logged.
fn load(options: &RenderOptions) -> Result<(Frozen, Value)> {
    let frozen = Frozen::told(&options.scene, &options.overrides, &options.trust)?;
    let is_kept = options.checkpoint.is_some() || !options.parts.is_empty();
    let about = if is_kept { kept::about(options, &frozen)? } else { Value::Null };
    Ok((frozen, about))
}

/// Logs how it went, and what was dropped.
fn tell(options: &RenderOptions, scene: &Scene, rendered: &Rendered) {
    let statistics = &rendered.statistics;
    let rate = statistics::rate(statistics.counters.rays(), statistics.render.wall).unwrap_or(0.0);
    tracing::info!(
        "{} samples in {:.1} s, {}rays/s, {}, {} thread{}",
        statistics.samples,
        statistics.render.wall.as_secs_f64(),
        metric(rate),
        statistics.backend,
        statistics.threads,
        if statistics.threads == 1 { "" } else { "s" },
    );
    if !options.limits.is_none() {
        let why = match statistics.ended {
            Ended::Samples => "all samples were taken",
            Ended::Time => "the time was over",
            Ended::Error => "the error is below its target",
        };
        tracing::info!("ended with {} per pixel: {why}", statistics::per_pixel(rendered));
        if let Some(Estimate { error, bound }) = statistics.estimate {
            tracing::info!("relMSE about {error:.3e}, below {bound:.3e} with a probability of 95 %");
        } else if options.limits.error.is_some() {
            tracing::warn!("too few samples to estimate the error");
        }
    }
    let non_finite = rendered.film.non_finite();
    if let Some(&first) = non_finite.first().first() {
        tracing::warn!(
            "{} samples were not finite and count as black; see the first one by `{}`",
            non_finite.count(),
            statistics::replay(options, statistics::replayed_spp(options, scene), first),
        );
    }
}

/// Writes all pictures.
fn write(options: &RenderOptions, frozen: &Frozen, rendered: &Rendered, load: Phase) -> Result<()> {
    for Output { path, format } in &options.outputs {
        match format {
            Format::Exr => {
                let attributes = statistics::attributes(frozen, rendered, load);
                let mut picture = rendered.film.picture(options.precision, attributes);
                if options.first_pass {
                    let (channels, attributes) = post::layers(&rendered.first_pass);
                    picture.channels.extend(channels);
                    picture.attributes.extend(attributes);
                }
                log::warn(&exr::write(path, picture)?);
            }
            Format::Png => png::write(path, &rendered.film.image(), development(&frozen.scene))?,
        }
    }
    Ok(())
}

/// Writes the sums.
fn write_parts(
    options: &RenderOptions,
    (frozen, about): (&Frozen, Value),
    (settings, rendered): (&Settings, &Rendered),
    load: Phase,
) -> Result<()> {
    if options.parts.is_empty() {
        return Ok(());
    }
    let statistics = statistics::report(options, frozen, rendered, Times { load, write: Phase::default() });
    let part = Part {
        outline: render::outline(&frozen.scene, settings)?,
        film: rendered.film.clone(),
        counters: rendered.statistics.counters,
        about,
        told: kept::told(&statistics::attributes(frozen, rendered, load), &statistics, &frozen.scene),
    };
    for path in &options.parts {
        atomic::write(path, |mut file| part.write(&mut file))?;
    }
    Ok(())
}

/// How the scene wants to be shown.
fn development(scene: &Scene) -> Development {
    let curve = match scene.film.tone {
        Tone::Clip => Curve::Clip,
        Tone::Filmic => Curve::Filmic,
    };
    Development { exposure_ev: scene.film.exposure_ev, curve }
}

pub(super) fn write_json(path: &Path, value: &Value) -> Result<()> {
    atomic::write(path, |file| io::Write::write_all(file, format!("{value:#}\n").as_bytes()))
}

/// The files that were written, one a line.
fn names(options: &RenderOptions) -> String {
    let paths = options.outputs.iter().map(|output| &output.path).chain(&options.parts).chain(&options.stats);
    paths.map(|path| format!("{}\n", path.display())).collect()
}
