//! The command `bench`: backends beside each other, on the rays of scenes.

use std::io::Write as _;
use std::path::Path;

use glam::DVec3;

use super::args::BenchArgs;
use super::frozen::Frozen;
use super::interrupt::Interrupt;
use super::options::BenchOptions;
use super::progress::Meter;
use super::{log, options, output};
use crate::bench::file::{self, Recording};
use crate::bench::machine::{self, Machine};
use crate::bench::{Outcome, Report, Track, Watch};
use crate::error::{Error, Place, Problem, Problems, Result};
use crate::image::atomic;
use crate::scene::{Scene, Wanted};

/// Races on every scene and prints what came out.
pub(super) fn run(args: &BenchArgs) -> Result<()> {
    log::start(&args.log);
    let interrupt = Interrupt::listen();
    let options = BenchOptions::new(args)?;
    options::try_out(options.report.iter().chain(&options.record))?;
    let machine = Machine::here();
    if machine.build.debug_assertions {
        tracing::warn!("built with assertions for debugging: rates mean nothing; build with `--release`");
    }
    let scenes = load_all(&options)?;
    let replayed = options.replay.as_deref().map(file::read).transpose()?;
    let replayed = replayed.map(|recording| chosen(recording, &options, &scenes)).transpose()?;
    interrupt.check()?;

    let mut outcomes = Vec::new();
    for (path, scene) in options.scenes.iter().zip(&scenes) {
        outcomes.push(race(path, scene, replayed.as_ref(), (&options, args.log.quiet, &interrupt))?);
    }
    let report =
        Report { machine, load_after: machine::load(), settings: options.settings.clone(), outcomes };
    if let Some(path) = &options.report {
        let page = report.page();
        atomic::write(path, |file| file.write_all(page.as_bytes()))?;
        tracing::info!("wrote {}", path.display());
    }
    let text = if options.json { format!("{:#}\n", report.json()) } else { report.table() };
    output::print(text.as_bytes())
}

/// All scenes; all that is wrong with any of them at once.
fn load_all(options: &BenchOptions) -> Result<Vec<Scene>> {
    let (mut scenes, mut problems) = (Vec::new(), Problems::default());
    for path in &options.scenes {
        match Frozen::told(path, &options.overrides, Wanted::default(), &options.trusted.of(path)) {
            Ok(frozen) => scenes.push(frozen.scene),
            Err(Error::Input(more)) => problems.0.extend(more.0),
            Err(error) => return Err(error),
        }
    }
    problems.into_result(scenes)
}

/// What of a file of rays is wanted: all of it, but for a choice of classes.
fn chosen(mut recording: Recording, options: &BenchOptions, scenes: &[Scene]) -> Result<Recording> {
    let path = options.replay.as_deref().unwrap_or(Path::new("rays"));
    let is_chosen = options.settings.classes.len() < crate::bench::Class::ALL.len();
    if is_chosen {
        recording.sets.retain(|set| options.settings.classes.iter().any(|class| class.word() == set.name));
    }
    recording.sets.retain(|set| !set.rays.is_empty());
    if recording.sets.is_empty() {
        let what = if is_chosen { "holds no rays of the classes asked for" } else { "holds no rays" };
        return Err(Problem::at(Place::file(path), what).remedy("choose others, or another file").into());
    }
    let origin = scenes.first().map_or(DVec3::ZERO, |scene| scene.origin);
    if recording.origin != origin {
        let [there, here] = [recording.origin, origin].map(|it| format!("({}, {}, {})", it.x, it.y, it.z));
        let what =
            format!("its rays are counted from {there}, and this scene from {here}, by where its camera is");
        let remedy = "give the camera of the recording, or record anew with --record";
        return Err(Problem::at(Place::file(path), what).remedy(remedy).into());
    }
    let primitives = scenes.first().map_or(0, |scene| scene.world.primitive_count() as u64);
    if recording.primitives != primitives {
        tracing::warn!(
            "{}: recorded in a scene of {} primitives, and this one has {primitives}",
            path.display(),
            recording.primitives
        );
    }
    Ok(recording)
}

/// All races of a scene.
fn race(
    path: &Path,
    scene: &Scene,
    replayed: Option<&Recording>,
    (options, quiet, interrupt): (&BenchOptions, bool, &Interrupt),
) -> Result<Outcome> {
    let track = Track::new(scene);
    let recorded;
    let recording = if let Some(recording) = replayed {
        recording
    } else {
        tracing::info!("{}: recording rays", path.display());
        recorded = track.record(&options.settings);
        if let Some(file) = &options.record {
            file::write(file, &recorded)?;
            tracing::info!("wrote {}", file.display());
        }
        &recorded
    };
    interrupt.check()?;
    let meter = Meter::new(quiet, "rays", interrupt.clone());
    let say = |what: &str| tracing::debug!("{}: {what}", path.display());
    let outcome = track.run(&recording.sets, &options.settings, Watch { progress: &meter, say: &say });
    meter.finish();
    Ok(Outcome {
        scene: path.display().to_string(),
        replayed: options.replay.as_ref().map(|file| file.display().to_string()),
        ..outcome?
    })
}
