//! The command `farm`: one picture on many machines, through an engine that runs jobs.
//!
//! Each task is a rendering of one slice as a user might type it, with a checkpoint of its own; one job more merges the parts. All
//! names of files hold a digest of what the picture is of, so that pictures do not mix in one directory, and what is there
//! already is not rendered again.

mod job;
mod openjd;
mod queue;
mod slurm;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::args::{FarmArgs, FarmEngine};
use super::interrupt::Interrupt;
use super::options::{FarmOptions, SlurmOptions};
use super::{log, output};
use crate::error::{Error, Result};
use crate::image::atomic;
use job::Job;
use queue::Ids;

/// Writes jobs, hands them over and waits for the picture, as far as asked for.
pub(super) fn run(args: &FarmArgs) -> Result<()> {
    match &args.engine {
        FarmEngine::Slurm(args) => {
            log::start(&args.common.picture.args.log);
            let interrupt = Interrupt::listen();
            let options = SlurmOptions::new(args)?;
            let job = Job::new(&options.farm)?;
            let files = slurm::files(&job, &options);
            written(&job, &files)?;
            let ids = if options.farm.submit { Some(queue::submit(&job)?) } else { None };
            tell("slurm", &job, &files, ids.as_ref())?;
            if let Some(ids) = ids.filter(|_| options.farm.wait) {
                queue::wait(&job, &ids, &interrupt)?;
                made(&options.farm)?;
            }
        }
        FarmEngine::OpenJd(args) => {
            log::start(&args.common.picture.args.log);
            let interrupt = Interrupt::listen();
            let options = FarmOptions::of_openjd(args)?;
            let job = Job::new(&options)?;
            let files = openjd::files(&job)?;
            written(&job, &files)?;
            tell("openjd", &job, &files, None)?;
            if options.submit {
                openjd::run(&job, &interrupt)?;
                made(&options)?;
            }
        }
    }
    Ok(())
}

/// The name of a file in the directory of a farm, and what it holds.
type Written = (&'static str, Vec<u8>);

/// Writes files into the directory, which is made if it is not there, and takes damaged ones out of it.
fn written(job: &Job<'_>, files: &[Written]) -> Result<()> {
    let dir = &job.options.dir;
    std::fs::create_dir_all(dir).map_err(|source| Error::Io {
        path: dir.clone(),
        what: "cannot make the directory of the farm",
        source,
    })?;
    job.damaged.iter().try_for_each(|path| atomic::remove(path))?;
    for (name, text) in files {
        atomic::write(&dir.join(name), |file| std::io::Write::write_all(file, text))?;
    }
    Ok(())
}

/// Prints what was written, and what was queued.
fn tell(engine: &str, job: &Job<'_>, files: &[Written], ids: Option<&Ids>) -> Result<()> {
    let options = job.options;
    let files: Vec<PathBuf> = files.iter().map(|(name, _)| options.dir.join(name)).collect();
    let there = job.slices - u32::try_from(job.missing.len()).unwrap_or(job.slices);
    if there > 0 {
        tracing::info!("{there} of {} slices are there already", job.slices);
    }
    let text = if options.json {
        let shown = |paths: &[PathBuf]| paths.iter().map(|path| shown(path)).collect::<Vec<_>>();
        let parts: Vec<PathBuf> = (0..job.slices).map(|slice| job.part(slice)).collect();
        let document = json!({
            "engine": engine,
            "dir": shown(std::slice::from_ref(&options.dir))[0],
            "files": shown(&files),
            "slices": job.slices,
            "to_render": job.missing,
            "parts": shown(&parts),
            "outputs": shown(&options.outputs),
            "scene_hash": job.scene_hash,
            "tasks": ids.and_then(|ids| ids.tasks.clone()),
            "merge": ids.map(|ids| ids.merge.clone()),
        });
        format!("{document:#}\n")
    } else {
        let mut text: String = files.iter().map(|path| format!("{}\n", path.display())).collect();
        if let Some(Ids { tasks, merge, .. }) = ids {
            text += &tasks.iter().map(|id| format!("tasks {id}\n")).collect::<String>();
            text += &format!("merge {merge}\n");
        }
        text
    };
    output::print(text.as_bytes())
}

/// Prints the names of the pictures that were made; a JSON document has them already.
fn made(options: &FarmOptions) -> Result<()> {
    if options.json {
        return Ok(());
    }
    let paths = options.outputs.iter().chain(&options.stats);
    output::print(paths.map(|path| format!("{}\n", path.display())).collect::<String>().as_bytes())
}

fn shown(path: &Path) -> Value {
    path.display().to_string().into()
}

/// A flag with its value in one word.
fn flag(name: &str, value: impl AsRef<std::ffi::OsStr>) -> OsString {
    let mut word = OsString::from(format!("--{name}="));
    word.push(value);
    word
}
