//! The command `render`.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::Value;

use super::args::RenderArgs;
use super::batch::memory;
use super::command::Rendering;
use super::done::Wanted;
use super::frozen::Frozen;
use super::interrupt::Interrupt;
use super::kept;
use super::options::{Output, RenderOptions, Trusted};
use super::progress::{Meter, Shown, metric};
use super::stage::{Made, Order, Stage};
use super::statistics::{self, Times};
use super::{both, log, options, output, threads};
use crate::display::Display;
use crate::error::{Error, Result};
use crate::image::tone::{Curve, Development};
use crate::image::{Format, atomic, exr, png};
use crate::post;
use crate::render::{self, Ended, Estimate, Part, Phase, Rendered, Settings, Studio};
use crate::scene::description::Tone;
use crate::scene::{self, Library, Scene};

/// Renders a scene, or frames of it, to files, whose names it prints.
pub(super) fn run(args: &RenderArgs) -> Result<()> {
    let mut start = Instant::now();
    log::start(&args.log);
    let interrupt = Interrupt::listen();
    let options = RenderOptions::new(args).map_err(|error| with_scene_problems(args, error))?;
    threads::limit(options.threads);

    let (loaded, mut reading) = Phase::of(|| {
        tracing::debug!("reading {}", options.scene.display());
        scene::load_within(&options.scene, &options.overrides, &options.trust)
    });
    let loaded = loaded?;
    options.spare(&loaded.files)?;
    let count = options.frames.as_ref().map_or(1, |frames| frames.numbers().len());
    // One picture has nobody to keep files for.
    let library = Library::of_bytes(if count > 1 { memory::half_of_free() } else { 0 });
    let mut stage = Stage::new(Studio::new(options.threads)?, library.into());
    let display = display(&options)?;
    for (picture, number) in options.pictures().zip(1..) {
        if let Some(frame) = picture.frame.filter(|_| count > 1) {
            tracing::info!("frame {frame}, {number} of {count}");
        }
        let is_kept = count > 1 && picture.checkpoint.is_some();
        let wanted = is_kept.then(|| Wanted::new(&picture, &loaded, stage.library())).transpose()?;
        if wanted.as_ref().is_some_and(|wanted| is_done(&picture, wanted, stage.library())) {
            interrupt.check()?;
            output::print(names(&picture).as_bytes())?;
        } else {
            let order = Order { options: &picture, loaded: &loaded, start, is_lenient: false };
            let watch = Watch { quiet: args.log.quiet, interrupt: &interrupt, display: display.as_ref() };
            one(&mut stage, &order, watch, (wanted.as_ref(), reading, number == count))?;
        }
        (start, reading) = (Instant::now(), Phase::default());
    }
    if let Some(display) = display {
        display.finish(|| interrupt.is_asked());
    }
    Ok(())
}

/// Who watches, and may stop it.
#[derive(Clone, Copy)]
struct Watch<'a> {
    quiet: bool,
    interrupt: &'a Interrupt,
    display: Option<&'a Display>,
}

/// Whether a frame is there already, of a sequence that is gone on with.
fn is_done(options: &RenderOptions, wanted: &Wanted, library: &Library) -> bool {
    let Some(checkpoints) = options.checkpoint.as_ref().filter(|it| it.resume) else { return false };
    if let Some(why) = wanted.due(options, library) {
        tracing::debug!("not there yet: {why}");
        return false;
    }
    tracing::info!("it is there already: left out");
    kept::clear(checkpoints);
    true
}

/// Renders one picture, after the scene file was read for it. What is `wanted`, if anything, its metadata tell, so that it is known to be
/// done; with `is_last` the hierarchy is given up before pictures are written.
fn one(
    stage: &mut Stage,
    order: &Order<'_>,
    Watch { quiet, interrupt, display }: Watch<'_>,
    (wanted, reading, is_last): (Option<&Wanted>, Phase, bool),
) -> Result<()> {
    let mut options = order.options.clone();
    interrupt.check()?;
    options.try_out()?;
    let read = stage.load(order)?;
    options.spare(&stage.frozen()?.files)?;
    let meter = Meter::new(quiet, "samples", interrupt.clone());
    let prediction = stage.settle(&mut options, order.start, &meter)?;
    let options = &options;
    if let Some(display) = display {
        begin(display, options, &stage.frozen()?.scene);
    }
    let shown = Shown { meter: &meter, display };
    let made = stage.make(&Order { options, ..*order }, read, &shown);
    meter.finish();
    let elapsed = order.start.elapsed();
    let Made { rendered, about, settings, mut load, kept } = made?;
    load += reading;
    if is_last {
        stage.clear_hierarchy();
    }
    let frozen = stage.frozen()?;
    tell(options, &frozen.scene, &rendered);

    let notes = wanted.map_or(Ok(Vec::new()), |wanted| wanted.notes(frozen, stage.library()))?;
    let (written, write) = Phase::of(|| {
        let pictures = write(options, frozen, &rendered, (load, &notes));
        both(pictures, write_parts(options, (frozen, about), (&settings, &rendered), load))
    });
    let told = options.stats.as_ref().map_or(Ok(()), |path| {
        let mut report = statistics::report(options, frozen, &rendered, Times { load, write });
        if let Some(prediction) = prediction {
            report["cost"] = prediction.beside(&rendered, elapsed);
        }
        write_json(path, &report)
    });
    both(written, told)?;
    if let Some(kept) = kept {
        kept.remove();
    }
    if let Some(display) = display {
        display.end(&rendered.film);
    }
    output::print(names(options).as_bytes())
}

/// Where pictures are shown while they are made, if anywhere.
fn display(options: &RenderOptions) -> Result<Option<Display>> {
    let Some(place) = &options.display else { return Ok(None) };
    let warn = Box::new(|what: String| tracing::warn!("{what}"));
    let failed = |error: io::Error| Error::Backend { backend: "threads", what: error.to_string() };
    Display::start(place, warn).map(Some).map_err(failed)
}

/// Begins to show a picture: each frame under its own name.
fn begin(display: &Display, options: &RenderOptions, scene: &Scene) {
    let path = options.scene.display();
    let name = options.frame.map_or_else(|| path.to_string(), |frame| format!("{path} frame {frame}"));
    display.begin(&name, [scene.film.width, scene.film.height]);
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
    }
    if let Some(Estimate { error, bound }) = statistics.estimate {
        tracing::info!("relMSE about {error:.3e}, below {bound:.3e} with a probability of 95 %");
    } else if options.limits.error.is_some() {
        tracing::warn!("too few samples to estimate the error");
    }
    tell_dropped(options, &Rendering::of(options), (scene, rendered));
}

/// Warns of samples that were dropped, with the command by which one is seen again.
pub(super) fn tell_dropped(
    options: &RenderOptions,
    again: &Rendering<'_>,
    (scene, rendered): (&Scene, &Rendered),
) {
    let non_finite = rendered.film.non_finite();
    if let Some(&first) = non_finite.first().first() {
        tracing::warn!(
            "{} samples were not finite and count as black; see the first one by `{}`",
            non_finite.count(),
            statistics::replay(again, statistics::replayed_spp(options, scene), first),
        );
    }
}

/// Writes all pictures, one that fails beside the others, with `more` metadata by which a picture is known to be done: EXR files come last,
/// and lack them where another file could not be written.
pub(super) fn write(
    options: &RenderOptions,
    frozen: &Frozen,
    rendered: &Rendered,
    (load, more): (Phase, &[(String, String)]),
) -> Result<()> {
    let (last, first): (Vec<_>, Vec<_>) =
        options.outputs.iter().partition(|output| output.format == Format::Exr);
    let mut written = Ok(());
    for Output { path, format } in first.into_iter().chain(last) {
        let this = match format {
            Format::Exr => {
                let more = if written.is_ok() { more } else { &[] };
                write_exr(path, options, (frozen, rendered), (load, more))
            }
            Format::Png => png::write(path, &rendered.film.image(), development(&frozen.scene)),
        };
        written = both(written, this);
    }
    written
}

/// Writes a picture with all its outputs and metadata, and `more`.
fn write_exr(
    path: &Path,
    options: &RenderOptions,
    (frozen, rendered): (&Frozen, &Rendered),
    (load, more): (Phase, &[(String, String)]),
) -> Result<()> {
    let mut attributes = statistics::attributes(frozen, rendered, load);
    attributes.extend_from_slice(more);
    let mut picture = rendered.film.picture(options.precision, attributes);
    if options.first_pass {
        let (channels, attributes) = post::layers(&rendered.first_pass);
        picture.channels.extend(channels);
        picture.attributes.extend(attributes);
    }
    exr::write(path, picture).map(|warnings| log::warn(&warnings))
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
    let write = |path: &PathBuf| atomic::write(path, |mut file| part.write(&mut file));
    options.parts.iter().map(write).fold(Ok(()), both)
}

/// How the scene wants to be shown.
pub(super) fn development(scene: &Scene) -> Development {
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
    options.results().map(|path| format!("{}\n", path.display())).collect()
}
