//! What workers do: one picture after the other, until there is none or somebody asks to stop.

use std::collections::HashMap;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::memory::{self, Gate, Pass};
use super::summary::Fate;
use super::tasks::Task;
use crate::cli::done::Wanted;
use crate::cli::options::{BatchOptions, RenderOptions};
use crate::cli::progress::Meter;
use crate::cli::render::{tell_dropped, write};
use crate::cli::stage::{Made, Order, Stage};
use crate::error::{Error, Problem, Problems, Result};
use crate::render::{Progress, Studio};
use crate::scene::description::Located;
use crate::scene::{self, Library, Loaded};

/// Steps of progress in a picture.
pub(super) const STEPS: u64 = 1000;

/// All pictures, and how far they are.
#[derive(Debug)]
pub(super) struct Whole<'a> {
    tasks: &'a [Task],
    options: &'a BatchOptions,
    library: &'a Arc<Library>,
    gate: &'a Gate,
    meter: &'a Meter,
    next: AtomicUsize,
    steps: AtomicU64,
    fates: Mutex<Vec<Fate>>,
    /// Bytes that scenes have taken, by file and overrides.
    measured: Mutex<HashMap<(PathBuf, Vec<String>), u64>>,
}

/// What a worker has from the picture before.
struct Bench<'a> {
    stage: Stage,
    loaded: Option<(Sources, Loaded)>,
    pass: Option<Pass<'a>>,
}

/// What a description is read from: a scene file, overrides, and what files in those are relative to.
type Sources = (PathBuf, Vec<String>, PathBuf);

/// How far one picture is.
struct Part<'a> {
    whole: &'a Whole<'a>,
    steps: AtomicU64,
}

impl<'a> Whole<'a> {
    pub(super) fn new(
        tasks: &'a [Task],
        options: &'a BatchOptions,
        (library, gate): (&'a Arc<Library>, &'a Gate),
        meter: &'a Meter,
    ) -> Self {
        let fates = tasks.iter().map(|_| Fate::NotBegun).collect();
        Self {
            tasks,
            options,
            library,
            gate,
            meter,
            next: AtomicUsize::new(0),
            steps: AtomicU64::new(0),
            fates: Mutex::new(fates),
            measured: Mutex::default(),
        }
    }

    /// Does what there is to do, with so many threads.
    pub(super) fn work(&self, threads: NonZeroUsize) -> Result<()> {
        let stage = Stage::new(Studio::new(Some(threads))?, self.library.clone());
        let mut bench = Bench { stage, loaded: None, pass: None };
        while !self.meter.is_cancelled() {
            let number = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(task) = self.tasks.get(number) else { break };
            let fate = self.fate(task, &mut bench);
            self.fates()[number] = fate;
        }
        Ok(())
    }

    /// What became of all.
    pub(super) fn into_fates(self) -> Vec<Fate> {
        self.fates.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn fates(&self) -> MutexGuard<'_, Vec<Fate>> {
        self.fates.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What becomes of one picture; nothing that goes wrong with it stops the others.
    fn fate(&self, task: &Task, bench: &mut Bench<'a>) -> Fate {
        let label = task.label();
        let named = tracing::error_span!("picture", message = label.as_str());
        let part = Part { whole: self, steps: AtomicU64::new(0) };
        let made = named.in_scope(|| catch_unwind(AssertUnwindSafe(|| self.one(task, bench, &part))));
        part.advance(1, 1);
        let failed = match made {
            Ok(Ok(fate)) => return fate,
            Ok(Err(Error::Interrupted)) => return Fate::Interrupted,
            Ok(Err(error)) => in_words(error, &task.job.overrides),
            Err(_) => vec!["the program has an error; it was told above".to_owned()],
        };
        bench.clear();
        let first = failed.first().map_or("", String::as_str);
        named.in_scope(|| tracing::warn!("failed, the others go on: {first}"));
        Fate::Failed(failed)
    }

    fn one(&self, task: &Task, bench: &mut Bench<'a>, progress: &dyn Progress) -> Result<Fate> {
        let options = &task.options;
        let loaded = read(task, &mut bench.loaded)?;
        options.spare(&loaded.files)?;
        let wanted = Wanted::new(options, loaded, self.library)?;
        let why = wanted.due(options, self.library);
        let why = if self.options.force { why.or_else(|| Some("all are asked for".to_owned())) } else { why };
        let Some(why) = why else { return Ok(Fate::Done) };
        if self.options.dry_run {
            return Ok(Fate::Due(why));
        }
        options.try_out()?;
        self.admit(self.estimate(task, loaded), &options.scene, (&mut bench.stage, &mut bench.pass))?;
        // Waiting is no part of the time that a picture may take.
        let begin = Instant::now();
        let stage = &mut bench.stage;
        let order = Order { options, loaded, start: begin, is_lenient: true };
        let read = stage.load(&order)?;
        options.spare(&stage.frozen()?.files)?;
        // Nobody sees the warnings of a batch before they have replaced good pictures.
        Problems(stage.frozen()?.unread.clone()).into_result(())?;
        let Made { rendered, load, kept, .. } = stage.make(&order, read, progress)?;
        let frozen = stage.frozen()?;
        tell_dropped(options, &task.alone(), (&frozen.scene, &rendered));
        let bytes = memory::of_scene(&frozen.scene, &rendered);
        self.measured().insert((options.scene.clone(), options.overrides.clone()), bytes);
        let notes = wanted.notes(frozen, self.library)?;
        write(options, frozen, &rendered, (load, &notes))?;
        if let Some(kept) = kept {
            kept.remove();
        }
        let samples = rendered.statistics.samples;
        Ok(Fate::Made { why, time: begin.elapsed(), samples })
    }

    /// Waits until a picture of a scene may take so many bytes; what is there of the picture before is given up where there is no room for it.
    fn admit(
        &self,
        bytes: u64,
        scene: &Path,
        (stage, pass): (&mut Stage, &mut Option<Pass<'a>>),
    ) -> Result<()> {
        if stage.has(scene) && pass.as_mut().is_some_and(|pass| pass.resize(bytes)) {
            return Ok(());
        }
        stage.clear();
        *pass = None;
        *pass = Some(self.gate.pass(bytes, || self.meter.is_cancelled())?);
        Ok(())
    }

    /// Bytes that a picture takes, about: with what its scene took before, where that is known.
    fn estimate(&self, task: &Task, loaded: &Loaded) -> u64 {
        let RenderOptions { scene, overrides, .. } = &task.options;
        let known = self.measured().get(&(scene.clone(), overrides.clone())).copied();
        let scene = known.unwrap_or_else(|| memory::of_files(loaded));
        let film = &loaded.description.film;
        scene.saturating_add(memory::of_film(&task.options, [film.width, film.height]))
    }

    fn measured(&self) -> MutexGuard<'_, HashMap<(PathBuf, Vec<String>), u64>> {
        self.measured.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Bench<'_> {
    fn clear(&mut self) {
        self.stage.clear();
        (self.loaded, self.pass) = (None, None);
    }
}

impl Progress for Part<'_> {
    fn advance(&self, done: u64, total: u64) {
        let steps = (u128::from(done) * u128::from(STEPS) / u128::from(total.max(1))).min(STEPS.into());
        let steps = u64::try_from(steps).unwrap_or(STEPS);
        let more = steps.saturating_sub(self.steps.fetch_max(steps, Ordering::Relaxed));
        let all = self.whole.steps.fetch_add(more, Ordering::Relaxed) + more;
        self.whole.meter.advance(all, STEPS * self.whole.tasks.len() as u64);
    }

    fn is_cancelled(&self) -> bool {
        self.whole.meter.is_cancelled()
    }
}

/// The description for a task: that of the task before, if it is the same.
fn read<'a>(task: &Task, last: &'a mut Option<(Sources, Loaded)>) -> Result<&'a Loaded> {
    let options = &task.options;
    let (scene, overrides, folder) = (&options.scene, &options.overrides, &task.job.folder);
    let known = last.take_if(|(of, _)| of.0 == *scene && of.1 == *overrides && of.2 == *folder);
    let entry = match known {
        Some(entry) => entry,
        None => {
            let loaded = scene::load_from(scene, task.job.replaced(), &options.trust)?;
            ((scene.clone(), overrides.clone(), folder.clone()), loaded)
        }
    };
    Ok(&last.insert(entry).1)
}

/// An error, problem by problem; those of overrides where these were written.
fn in_words(error: Error, overrides: &[Located<String>]) -> Vec<String> {
    let Error::Input(problems) = error else { return vec![crate::cli::chain(&error)] };
    let placed = |mut problem: Problem| {
        let is_override =
            problem.place.as_ref().is_some_and(|place| *place.file == *Path::new("command line"));
        let told = |text: &&Located<String>| problem.what.starts_with(&format!("in `{}`", text.value));
        if let Some(text) = overrides.iter().rev().find(told).filter(|_| is_override) {
            problem.place = Some(text.place.clone());
        }
        problem.to_string()
    };
    problems.0.into_iter().map(placed).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tasks;
    use super::*;
    use crate::cli::interrupt::Interrupt;
    use crate::cli::{Args, Command};
    use clap::Parser as _;

    #[test]
    fn every_picture_asks_for_the_memory_that_it_takes() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, text: &str| {
            std::fs::write(folder.path().join(name), text).expect("written");
        };
        let scene = "[render]\nspp = 1\n[materials.m]\ntype = 'diffuse'\n[[shapes]]\ntype = 'sphere'\nmaterial = 'm'\n[[lights]]\ntype = 'environment'\nradiance = 1\n";
        write("a.toml", scene);
        let job = |size: u32| {
            format!(
                "[[jobs]]\nname = 'a{size}'\nscene = 'a.toml'\noverrides = {{ film.width = {size}, film.height = {size} }}\n"
            )
        };
        write("jobs.toml", &[4, 100, 8].map(job).concat());
        let file = folder.path().join("jobs.toml");
        let words = ["specula", "batch", "--memory", "1"].map(std::ffi::OsString::from);
        let words = words.into_iter().chain([file.into_os_string()]);
        let Command::Batch(args) = Args::try_parse_from(words).expect("parsed").command else {
            panic!("another command")
        };
        let options = BatchOptions::new(&args).expect("valid");
        let tasks = tasks::all(&options).expect("sound");
        let library = Arc::new(Library::default());
        let gate = Gate::new(options.memory, library.clone());
        let meter = Meter::in_steps(true, ("pictures", STEPS), Interrupt::default());
        let whole = Whole::new(&tasks, &options, (&library, &gate), &meter);
        let studio = Studio::new(Some(NonZeroUsize::MIN)).expect("a thread");
        let mut bench = Bench { stage: Stage::new(studio, library.clone()), loaded: None, pass: None };
        let mut held = |task: &Task| {
            let fate = whole.fate(task, &mut bench);
            assert!(matches!(fate, Fate::Made { .. }), "{fate:?}");
            bench.pass.as_ref().map_or(0, Pass::bytes)
        };
        let held: Vec<u64> = tasks.iter().map(&mut held).collect();
        assert!(held[0] < 8 * 8 * 160, "a small one: {held:?}");
        assert!(held[1] >= 100 * 100 * 160, "a large one of the same scene: {held:?}");
        assert!(held[2] < held[1], "a small one again: {held:?}");
    }
}
