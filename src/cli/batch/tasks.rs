//! From batch files and scene files to tasks: one for each picture.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use crate::cli::args::FIRST_PASS;
use crate::cli::command::{Rendering, relative};
use crate::cli::frames;
use crate::cli::options::{
    BatchOptions, Checkpoints, Output, RenderOptions, check_first_pass, check_target, layout, same_for_all,
    window, with_extension,
};
use crate::cli::shell::word;
use crate::error::{Place, Problem, Problems, Result};
use crate::film::Precision;
use crate::image::Format;
use crate::render::Limits;
use crate::scene::description::{Batch, Frames, JobSettings, Located};
use crate::scene::load::from_root;
use crate::scene::{is_scene, load_batch};

/// A picture to be made.
#[derive(Debug)]
pub(super) struct Task {
    /// Of which job.
    pub(super) job: Arc<JobOf>,
    /// What `render` would be told.
    pub(super) options: RenderOptions,
}

/// What all pictures of a job have in common.
#[derive(Debug)]
pub(super) struct JobOf {
    pub(super) name: String,
    /// What files in it are relative to.
    pub(super) folder: PathBuf,
    /// Where its overrides were written.
    pub(super) overrides: Vec<Located<String>>,
    /// How many of them are its own; those of the command line follow.
    own: usize,
    /// The same as `render` can be told them in that folder.
    told: Vec<String>,
    /// Words of the command line that do not depend on the frame, but for outputs.
    words: Vec<String>,
    outputs: Vec<PathBuf>,
}

impl JobOf {
    /// What replaces values of the scene file, and from where files in it are seen.
    pub(super) fn replaced(&self) -> impl Iterator<Item = (&str, &Path)> {
        let folder = move |i: usize| if i < self.own { &*self.folder } else { Path::new("") };
        self.overrides.iter().enumerate().map(move |(i, text)| (text.value.as_str(), folder(i)))
    }
}

impl Task {
    /// The job, and the frame if there is one.
    pub(super) fn label(&self) -> String {
        match self.options.frame {
            Some(frame) => format!("{} frame {frame}", self.job.name),
            None => self.job.name.clone(),
        }
    }

    /// It alone, as a user can ask for it.
    pub(super) fn alone(&self) -> Rendering<'_> {
        let folder = &self.job.folder;
        let scene = relative(&self.options.scene, folder);
        Rendering { folder, scene, overrides: &self.job.told, ..Rendering::of(&self.options) }
    }

    /// The command that makes this picture alone.
    pub(super) fn command(&self) -> String {
        let named = |path: &PathBuf| {
            let path = self.options.frame.map_or_else(|| path.clone(), |frame| frames::named(path, frame));
            ["-o".to_owned(), word(path)]
        };
        let outputs = self.job.outputs.iter().flat_map(named);
        self.alone().command(self.job.words.iter().cloned().chain(outputs))
    }
}

/// The tasks of all files, in their order. Fails with everything that is wrong with batch files.
pub(super) fn all(options: &BatchOptions) -> Result<Vec<Task>> {
    let mut problems = Problems::default();
    let mut planner =
        Planner { options, tasks: Vec::new(), targets: HashSet::new(), folders: HashMap::new() };
    for file in &options.files {
        if is_scene(file, options.trusted.limits()) {
            let settings = JobSettings { scene: Some(at(file, file.clone())), ..JobSettings::default() };
            planner.add(
                (None, &settings),
                &JobSettings::default(),
                (Path::new(""), Place::file(file)),
                &mut problems,
            );
            continue;
        }
        match load_batch(file, options.trusted.limits()) {
            Ok(Batch { defaults, jobs }) => {
                let folder = file.parent().unwrap_or(Path::new(""));
                for job in jobs {
                    let name = job.value.name.as_ref();
                    planner.add(
                        (name, &job.value.own),
                        &defaults,
                        (folder, job.place.clone()),
                        &mut problems,
                    );
                }
            }
            Err(error) => problems.absorb(error, Some(&Place::file(file))),
        }
    }
    problems.into_result(planner.tasks)
}

fn at<T>(file: &Path, value: T) -> Located<T> {
    Located { value, place: Place::file(file) }
}

struct Planner<'a> {
    options: &'a BatchOptions,
    tasks: Vec<Task>,
    /// Files that are written.
    targets: HashSet<PathBuf>,
    /// Folders as they are called, and which they are; nothing of one that is not there.
    folders: HashMap<PathBuf, Option<PathBuf>>,
}

impl Planner<'_> {
    /// Adds the pictures of a job.
    fn add(
        &mut self,
        (name, own): (Option<&Located<String>>, &JobSettings),
        defaults: &JobSettings,
        (folder, place): (&Path, Place),
        problems: &mut Problems,
    ) {
        let Some(scene) = own.scene.as_ref().or(defaults.scene.as_ref()) else { return };
        let stem = || scene.value.file_stem().map_or_else(|| "picture".into(), |stem| stem.to_string_lossy());
        let name = name.map_or_else(|| stem().into_owned(), |name| name.value.clone());
        let frames = self.options.frames.as_ref().or(own.frames.as_ref()).or(defaults.frames.as_ref());
        let found = problems.0.len();
        let outputs = self.outputs((own, defaults), &name, frames, (folder, &place));
        let mut overrides = defaults.overrides.0.clone();
        overrides.extend(own.overrides.0.iter().cloned());
        let count = overrides.len();
        overrides
            .extend(self.options.overrides.iter().map(|text| at(Path::new("command line"), text.clone())));
        let Some(template) = self.template((own, defaults), (&scene.value, &outputs), &overrides, problems)
        else {
            return;
        };
        let shown = outputs.iter().map(|(path, _)| relative(path, folder)).collect();
        let job = Arc::new(JobOf {
            name,
            folder: folder.to_owned(),
            own: count,
            told: told(&overrides, count, folder),
            overrides,
            words: words((own, defaults)),
            outputs: shown,
        });
        let numbers =
            frames.map_or_else(|| vec![None], |it| it.numbers().iter().copied().map(Some).collect());
        if let Some((path, place)) =
            outputs.iter().find(|(path, _)| numbers.len() > 1 && !frames::has_place(path))
        {
            let problem = same_for_all(path, numbers.len());
            return problems.push(Problem { place: Some(place.clone()), ..problem });
        }
        for frame in numbers {
            let targets = self.targets(&outputs, frame, problems);
            let mut options = RenderOptions { frame, outputs: targets, ..template.clone() };
            let first = options.outputs.first().map(|output| output.path.clone());
            options.checkpoint = self.options.checkpoint_every.zip(first).map(|(every, path)| Checkpoints {
                path: with_extension(&path, "ckpt"),
                every,
                resume: true,
            });
            if problems.0.len() > found + MOST_TOLD {
                return;
            }
            self.tasks.push(Task { job: job.clone(), options });
        }
    }

    /// Names of outputs, frames still open, and where they were written.
    fn outputs(
        &self,
        (own, defaults): (&JobSettings, &JobSettings),
        name: &str,
        frames: Option<&Frames>,
        (folder, place): (&Path, &Place),
    ) -> Vec<(PathBuf, Place)> {
        let given = if own.outputs.is_empty() { &defaults.outputs } else { &own.outputs };
        let named = |text: &str| text.replace("{name}", name);
        if !self.options.outputs.is_empty() {
            let place = Place::file("command line");
            let named =
                |path: &PathBuf| path.to_str().map_or_else(|| path.clone(), |text| named(text).into());
            return self.options.outputs.iter().map(|path| (named(path), place.clone())).collect();
        }
        if given.is_empty() {
            let stem = match frames {
                Some(_) => format!("{name}.{}", frames::DEFAULT),
                None => name.to_owned(),
            };
            let of = |extension| (folder.join(format!("{stem}.{extension}")), place.clone());
            return ["exr", "png"].map(of).into();
        }
        given.iter().map(|text| (folder.join(named(&text.value)), text.place.clone())).collect()
    }

    /// What all pictures of a job are told.
    fn template(
        &self,
        (own, defaults): (&JobSettings, &JobSettings),
        (scene, outputs): (&Path, &[(PathBuf, Place)]),
        overrides: &[Located<String>],
        problems: &mut Problems,
    ) -> Option<RenderOptions> {
        let aov = if own.aov.is_empty() { &defaults.aov } else { &own.aov };
        let found = problems.0.len();
        let names: Vec<String> = aov.iter().map(|name| name.value.clone()).collect();
        let layout = layout(&names, problems);
        let first_pass = names.iter().any(|name| name == FIRST_PASS);
        if first_pass {
            let kept = self.options.checkpoint_every.map(|_| "checkpoint-every");
            let formats = outputs.iter().filter_map(|(path, _)| Format::of(path).ok());
            check_first_pass(kept, formats, problems);
        }
        let crop = own.crop.as_ref().or(defaults.crop.as_ref()).map(|crop| (window(crop.value), &crop.place));
        if let Some((None, place)) = crop {
            let problem = Problem::at((*place).clone(), "`crop` has no pixel");
            problems.push(problem.remedy("give x0, y0, x1, y1 with x0 < x1 and y0 < y1"));
        }
        // Where the words stand that are meant.
        let place = aov.first().map(|name| name.place.clone());
        for problem in &mut problems.0[found..] {
            problem.place = problem.place.take().filter(|it| it.line.is_some()).or_else(|| place.clone());
        }
        let time = own.time_limit_s.or(defaults.time_limit_s);
        (problems.0.len() == found).then(|| RenderOptions {
            overrides: overrides.iter().map(|text| text.value.clone()).collect(),
            crop: crop.and_then(|(window, _)| window),
            layout,
            first_pass,
            threads: self.options.threads,
            limits: Limits {
                time: time.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
                error: own.target_error.or(defaults.target_error),
                is_estimated: false,
            },
            precision: if own.half.or(defaults.half) == Some(true) {
                Precision::Half
            } else {
                Precision::Float
            },
            ..RenderOptions::of(scene, self.options.trusted.of(scene))
        })
    }

    /// The files of one picture, the EXR files last: by them it is known to be done.
    fn targets(
        &mut self,
        outputs: &[(PathBuf, Place)],
        frame: Option<i32>,
        problems: &mut Problems,
    ) -> Vec<Output> {
        let mut targets = Vec::new();
        for (path, place) in outputs {
            let path = frame.map_or_else(|| path.clone(), |frame| frames::named(path, frame));
            match Format::of(&path) {
                Ok(format) => {
                    if let Some(problem) = self.claim(&path) {
                        problems.push(Problem { place: Some(place.clone()), ..problem });
                    }
                    targets.push(Output { path, format });
                }
                Err(error) => {
                    let found = problems.0.len();
                    problems.absorb(error, Some(place));
                    problems.0[found..].iter_mut().for_each(|problem| problem.place = Some(place.clone()));
                }
            }
        }
        targets.sort_by_key(|output| output.format == Format::Exr);
        targets
    }

    /// Takes a file for one picture; what is wrong with it, if anything.
    fn claim(&mut self, path: &Path) -> Option<Problem> {
        let folder = path.parent().filter(|it| !it.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let known = self.folders.entry(folder.to_owned()).or_insert_with(|| folder.canonicalize().ok());
        let real = known.as_ref().zip(path.file_name()).map(|(folder, name)| folder.join(name));
        let Some(real) = real.filter(|real| !real.is_dir()) else {
            let mut found = Problems::default();
            check_target(path, &mut found);
            return found.0.into_iter().next();
        };
        if self.targets.insert(real) {
            return None;
        }
        let what = format!("`{}` would be written twice", path.display());
        Some(Problem::new(what).remedy("put {name} into the names of outputs, or #### for the frame"))
    }
}

/// Problems of a job that are told.
const MOST_TOLD: usize = 20;

/// Overrides as `render` can be told them in a folder from which the first ones see files.
fn told(overrides: &[Located<String>], own: usize, folder: &Path) -> Vec<String> {
    let is_here = folder.as_os_str().is_empty();
    let told = |(i, text): (usize, &Located<String>)| {
        if is_here || i < own { text.value.clone() } else { from_root(&text.value) }
    };
    overrides.iter().enumerate().map(told).collect()
}

/// Flags for these settings, but for overrides, frame and outputs.
fn words((own, defaults): (&JobSettings, &JobSettings)) -> Vec<String> {
    let mut words = Vec::new();
    let aov = if own.aov.is_empty() { &defaults.aov } else { &own.aov };
    if !aov.is_empty() {
        let names: Vec<&str> = aov.iter().map(|name| name.value.as_str()).collect();
        words.extend(["--aov".to_owned(), word(names.join(","))]);
    }
    if let Some([x0, y0, x1, y1]) = own.crop.as_ref().or(defaults.crop.as_ref()).map(|crop| crop.value) {
        words.extend(["--crop".to_owned(), format!("{x0},{y0},{x1},{y1}")]);
    }
    words.extend(own.half.or(defaults.half).filter(|half| *half).map(|_| "--half".to_owned()));
    let time = own.time_limit_s.or(defaults.time_limit_s);
    words.extend(time.map(|seconds| format!("--time-limit={seconds}s")));
    words.extend(own.target_error.or(defaults.target_error).map(|error| format!("--target-error={error}")));
    words
}
