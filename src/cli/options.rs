//! The command line as meant: checked, with defaults resolved.

mod batch;
mod bench;
mod cost;
mod farm;
mod fuzzy;
mod merge;
mod tradeoff;
mod trust;

pub(super) use batch::BatchOptions;
pub(super) use bench::BenchOptions;
pub(super) use cost::Cost;
pub(super) use farm::{FarmOptions, SlurmOptions};
pub(super) use fuzzy::FuzzyOptions;
pub(super) use merge::MergeOptions;
pub(super) use tradeoff::{Against, TradeoffOptions};
pub(super) use trust::{Trusted, words as trust_words};

use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::args::{
    CRYPTOMATTE, DiffArgs, FIRST_PASS, PRUNING, PlanArgs, RenderArgs, further_outputs, specialised,
};
use super::frames;
use crate::error::{Place, Problem, Problems, Result};
use crate::film::{Aov, Layout, Precision};
use crate::image::{Format, Window, atomic};
use crate::measure::Metric;
use crate::measure::flip::Viewing;
use crate::render::{Limits, Slice};
use crate::scene::Wanted;
use crate::scene::description::Frames;
use crate::scene::load::words::suggest;
use crate::scene::needs::capability::{Capabilities, Capability};
use crate::trust::{self as files, Trust};

/// Most threads that make any sense on any machine; more is a slip of the hand.
const MOST_THREADS: usize = 4096;

/// What `render` is to do.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RenderOptions {
    pub(super) scene: PathBuf,
    pub(super) outputs: Vec<Output>,
    /// Files for the sums.
    pub(super) parts: Vec<PathBuf>,
    /// What replaces values of the scene file, in this order.
    pub(super) overrides: Vec<String>,
    /// Frames to render; names of files have a place for the number then.
    pub(super) frames: Option<Frames>,
    /// The one frame that this is about.
    pub(super) frame: Option<i32>,
    pub(super) crop: Option<Window>,
    pub(super) slice: Option<Slice>,
    pub(super) checkpoint: Option<Checkpoints>,
    pub(super) layout: Layout,
    /// Whether what fuzzy reflections are filtered from is written, too.
    pub(super) first_pass: bool,
    pub(super) threads: Option<NonZeroUsize>,
    pub(super) limits: Limits,
    pub(super) specialise: Specialise,
    /// Whether somebody else chooses settings.
    pub(super) cost: Option<Cost>,
    pub(super) precision: Precision,
    pub(super) stats: Option<PathBuf>,
    /// How far the files of the scene are trusted.
    pub(super) trust: Trust,
    /// Where somebody looks at the picture while it is made, `HOST:PORT`.
    pub(super) display: Option<String>,
}

/// What is done beside what a scene needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Specialise {
    /// What is switched on.
    pub(super) forced: Capabilities,
    /// Whether what has no effect is kept.
    pub(super) keeps: bool,
}

impl Specialise {
    /// What the words of `--no-specialise` mean: everything where there are none.
    fn new(words: Option<&[String]>, problems: &mut Problems) -> Self {
        let Some(words) = words else { return Self::default() };
        if words.is_empty() {
            return Self { forced: Capabilities::forceable(), keeps: true };
        }
        let known = specialised();
        for word in words.iter().filter(|word| !known.contains(&word.as_str())) {
            let what = format!("`{word}` is nothing to switch on");
            problems.push(on_command_line(what).remedy(suggest(word, &known)));
        }
        let is_named = |capability: &Capability| words.iter().any(|word| word == capability.word());
        Self {
            forced: Capabilities::forceable().iter().filter(is_named).collect(),
            keeps: words.iter().any(|word| word == PRUNING),
        }
    }

    /// A picture with these outputs, for which samples are taken where they bring most or not.
    fn wanted(self, layout: Layout, adaptive: bool) -> Wanted {
        Wanted { adaptive, forced: self.forced, prunes: !self.keeps, ..Wanted::picture(layout) }
    }
}

/// What `plan` is to plan for, and how far the files of the scene are trusted.
pub(super) fn planned(args: &PlanArgs) -> Result<(Wanted, Trust)> {
    let mut problems = Problems::default();
    let adaptive = args
        .target_error
        .as_deref()
        .and_then(|text| target_error("target-error", text, &mut problems))
        .is_some();
    let specialise = Specialise::new(args.no_specialise.as_deref(), &mut problems);
    let wanted = specialise.wanted(layout(&args.aov, &mut problems), adaptive);
    let trust = Trusted::new(&args.trust, &mut problems).of(&args.scene);
    problems.into_result((wanted, trust))
}

/// Where copies of a picture under way are kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Checkpoints {
    pub(super) path: PathBuf,
    pub(super) every: Duration,
    /// Whether to go on from the one that is there.
    pub(super) resume: bool,
}

/// A file to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Output {
    pub(super) path: PathBuf,
    pub(super) format: Format,
}

impl RenderOptions {
    /// What those words mean; all that is wrong with them at once.
    pub(super) fn new(args: &RenderArgs) -> Result<Self> {
        let mut problems = Problems::default();
        let frames = args.frames.as_deref().and_then(|text| frames(text, &mut problems));
        let paths = rendered_paths(args);
        let others = args.stats.iter().chain(&args.checkpoint);
        places(frames.as_ref(), paths.iter().chain(others.clone()), &mut problems);
        // What is true of the names of one frame is true of all.
        let named = |path: &PathBuf| first(frames.as_ref()).map_or(path.clone(), |n| frames::named(path, n));
        let (parts, pictures): (Vec<PathBuf>, Vec<PathBuf>) =
            paths.iter().cloned().partition(|path| is_part(path));
        let checked = outputs(pictures.iter().map(named).collect(), &mut problems);
        let others: Vec<PathBuf> = parts.iter().chain(others).map(named).collect();
        for (i, path) in others.iter().enumerate() {
            check_target(path, &mut problems);
            let is_taken = |other: &PathBuf| is_same(other, path);
            if others[..i].iter().any(is_taken) || checked.iter().any(|output| is_taken(&output.path)) {
                problems.push(twice(path));
            }
        }
        if args.aov.iter().any(|name| name == FIRST_PASS) {
            check_first_pass(args.checkpoint.is_some(), &checked, &mut problems);
        }
        let targets = checked.iter().map(|output| &output.path).chain(&others);
        targets.for_each(|target| spare([&args.scene], target, &mut problems));
        let of_format = |path: PathBuf| Some(Output { format: Format::of(&path).ok()?, path });
        let options = Self {
            scene: args.scene.clone(),
            outputs: pictures.into_iter().filter_map(of_format).collect(),
            parts,
            overrides: overrides(args),
            frames,
            frame: None,
            crop: args.crop.as_deref().and_then(|text| crop(text, &mut problems)),
            slice: args.slice.as_deref().and_then(|text| slice(text, &mut problems)),
            checkpoint: checkpoint(args, &mut problems),
            layout: layout(&args.aov, &mut problems),
            first_pass: args.aov.iter().any(|name| name == FIRST_PASS),
            threads: args.threads.as_deref().and_then(|text| threads(text, &mut problems)),
            limits: Limits {
                time: args.time_limit.as_deref().and_then(|text| time("time-limit", text, &mut problems)),
                error: args
                    .target_error
                    .as_deref()
                    .and_then(|text| target_error("target-error", text, &mut problems)),
                is_estimated: false,
            },
            specialise: Specialise::new(args.no_specialise.as_deref(), &mut problems),
            cost: cost::cost(args, &mut problems),
            precision: if args.half { Precision::Half } else { Precision::Float },
            stats: args.stats.clone(),
            trust: Trusted::new(&args.trust, &mut problems).of(&args.scene),
            display: args.display.as_deref().and_then(|text| display(text, &mut problems)),
        };
        cost::check(&options, &mut problems);
        problems.into_result(options)
    }

    /// What the scene is to be frozen for.
    pub(super) fn wanted(&self) -> Wanted {
        self.specialise.wanted(self.layout.clone(), self.limits.error.is_some())
    }
}

impl RenderOptions {
    /// One picture after the other: a frame each, or the one that there is.
    pub(super) fn pictures(&self) -> impl Iterator<Item = Self> {
        let numbers = match &self.frames {
            None => vec![None],
            Some(frames) => frames.numbers().iter().copied().map(Some).collect(),
        };
        numbers.into_iter().map(|frame| frame.map_or_else(|| self.clone(), |frame| self.at_frame(frame)))
    }

    fn at_frame(&self, frame: i32) -> Self {
        let named = |path: &PathBuf| frames::named(path, frame);
        let mut options = Self { frame: Some(frame), frames: None, ..self.clone() };
        options.outputs.iter_mut().for_each(|output| output.path = named(&output.path));
        options.parts.iter_mut().chain(&mut options.stats).for_each(|path| *path = named(path));
        if let Some(checkpoint) = &mut options.checkpoint {
            checkpoint.path = named(&checkpoint.path);
        }
        options
    }
}

fn first(frames: Option<&Frames>) -> Option<i32> {
    frames?.numbers().first().copied()
}

fn frames(text: &str, problems: &mut Problems) -> Option<Frames> {
    given(Frames::parse(text), ("frames", text), "a range of frames", || Frames::SYNTAX.to_owned(), problems)
}

/// Files of several frames have places for their numbers, and folders that are there.
fn places<'a>(frames: Option<&Frames>, paths: impl Iterator<Item = &'a PathBuf>, problems: &mut Problems) {
    let Some(frames) = frames.filter(|frames| frames.numbers().len() > 1) else { return };
    for path in paths {
        if !frames::has_place(path) {
            let count = frames.numbers().len();
            let what = format!("`{}` would be written for each of {count} frames", path.display());
            problems.push(
                on_command_line(what).remedy("put #### or {frame} where its name is to have the number"),
            );
        } else if path.parent().is_some_and(frames::has_place) {
            let others = &frames.numbers()[1..];
            others.iter().for_each(|&frame| check_target(&frames::named(path, frame), problems));
        }
    }
}

/// What `diff` is to do.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DiffOptions {
    pub(super) test: PathBuf,
    pub(super) reference: PathBuf,
    pub(super) outputs: Vec<Output>,
    pub(super) metric: Metric,
    /// Above it the check says no.
    pub(super) max_error: Option<f64>,
    pub(super) viewing: Viewing,
    /// What the pictures may ask for.
    pub(super) limits: files::Limits,
    pub(super) json: bool,
    pub(super) threads: Option<NonZeroUsize>,
}

impl DiffOptions {
    /// What those words mean; all that is wrong with them at once.
    pub(super) fn new(args: &DiffArgs) -> Result<Self> {
        let mut problems = Problems::default();
        let inputs = [&args.test, &args.reference];
        inputs.into_iter().for_each(|path| check_input(path, &mut problems));
        let outputs = outputs(args.output.clone(), &mut problems);
        outputs.iter().for_each(|output| spare(inputs, &output.path, &mut problems));
        let options = Self {
            test: args.test.clone(),
            reference: args.reference.clone(),
            outputs,
            metric: args
                .metric
                .as_deref()
                .and_then(|word| metric(word, &mut problems))
                .unwrap_or(Metric::RelMse),
            max_error: args.max_error.as_deref().and_then(|text| max_error(text, &mut problems)),
            viewing: args.ppd.as_deref().and_then(|text| viewing(text, &mut problems)).unwrap_or_default(),
            limits: trust::limits(&args.limits, &mut problems),
            json: args.json,
            threads: args.threads.as_deref().and_then(|text| threads(text, &mut problems)),
        };
        problems.into_result(options)
    }
}

fn check_input(path: &Path, problems: &mut Problems) {
    let place = || Place::file(path);
    if path.is_dir() {
        problems.push(Problem::at(place(), "a directory, not a picture").remedy("name a file in it"));
    } else if !path.exists() {
        problems.push(Problem::at(place(), "there is no such file").remedy("check the name"));
    }
}

/// Whether both name one file, be it there or not.
fn is_same(a: &Path, b: &Path) -> bool {
    let resolved = |path: &Path| {
        path.canonicalize().ok().or_else(|| {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            let folder = folder.unwrap_or(Path::new(".")).canonicalize().ok()?;
            Some(folder.join(path.file_name()?))
        })
    };
    a == b || matches!((resolved(a), resolved(b)), (Some(a), Some(b)) if a == b)
}

/// Refuses a file to write that is one of those to read.
fn spare<'a>(inputs: impl IntoIterator<Item = &'a PathBuf>, target: &Path, problems: &mut Problems) {
    if inputs.into_iter().any(|input| is_same(input, target)) {
        let what = format!("`{}` is read and would be overwritten", target.display());
        problems.push(on_command_line(what).remedy("name another file to write"));
    }
}

fn metric(word: &str, problems: &mut Problems) -> Option<Metric> {
    let remedy = || format!("choose one of {}", Metric::ALL.map(Metric::word).join(", "));
    given(Metric::of(word), ("metric", word), "an error that is measured", remedy, problems)
}

fn max_error(text: &str, problems: &mut Problems) -> Option<f64> {
    let number = text.trim().parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
    given(number, ("max-error", text), "an error", || "give a number from 0 on".to_owned(), problems)
}

fn viewing(text: &str, problems: &mut Problems) -> Option<Viewing> {
    let number = text.trim().parse().ok().filter(|x| Viewing::RANGE.contains(x));
    let remedy = || format!("give a number from {} to {}", Viewing::RANGE.start(), Viewing::RANGE.end());
    given(number, ("ppd", text), "a number of pixels per degree", remedy, problems)
        .map(|pixels_per_degree| Viewing { pixels_per_degree })
}

/// Flags that a scene file knows as keys, as overrides; those of `-D` come first, so that a named flag wins.
pub(super) fn overrides(args: &RenderArgs) -> Vec<String> {
    let view_implied = args.view.as_ref().filter(|_| args.integrator.is_none()).map(|_| "view".to_owned());
    let keys = [
        ("render.spp", args.spp.as_ref()),
        ("render.integrator", args.integrator.as_ref().or(view_implied.as_ref())),
        ("render.view", args.view.as_ref()),
        ("render.backend", args.backend.as_ref()),
        ("render.query", args.query.as_ref()),
        ("render.sampler", args.sampler.as_ref()),
        ("render.fresnel", args.fresnel.as_ref()),
        ("render.glossy", args.glossy.as_ref()),
        ("film.width", args.width.as_ref()),
        ("film.height", args.height.as_ref()),
        ("render.max_depth", args.max_depth.as_ref()),
        ("render.min_throughput", args.min_throughput.as_ref()),
        ("render.roulette", args.roulette.as_ref()),
        ("render.clamp_indirect", args.clamp_indirect.as_ref()),
        ("render.light_choice", args.light_choice.as_ref()),
        ("render.light_samples", args.light_samples.as_ref()),
        ("render.glossy_samples", args.glossy_samples.as_ref()),
        ("render.seed", args.seed.as_ref()),
    ];
    let flags = keys.iter().filter_map(|(key, value)| value.map(|value| format!("{key}={value}")));
    args.overrides.iter().cloned().chain(flags).collect()
}

/// The files asked for, or one of each kind named after the scene.
fn rendered_paths(args: &RenderArgs) -> Vec<PathBuf> {
    if !args.output.is_empty() {
        return args.output.clone();
    }
    let stem = args.scene.file_stem().unwrap_or("picture".as_ref());
    let stem = match args.frames {
        Some(_) => with_extension(stem.as_ref(), frames::DEFAULT),
        None => stem.into(),
    };
    if let Some(text) = &args.slice {
        return vec![with_extension(&stem, &format!("{}.{PART}", text.trim().replace('/', "of")))];
    }
    ["exr", "png"].map(|extension| with_extension(&stem, extension)).to_vec()
}

/// The extension of files of sums.
const PART: &str = "part";

fn is_part(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(PART))
}

/// One of several slices.
fn slice(text: &str, problems: &mut Problems) -> Option<Slice> {
    let slice = text.split_once('/').and_then(|(index, of)| {
        let slice = Slice { index: index.trim().parse().ok()?, of: of.trim().parse().ok()? };
        (slice.index < slice.of).then_some(slice)
    });
    let remedy = || "give K/N with K from 0 to N - 1, such as 0/8".to_owned();
    given(slice, ("slice", text), "a slice", remedy, problems)
}

/// A machine and one of its ports.
fn display(text: &str, problems: &mut Problems) -> Option<String> {
    let text = text.trim();
    let is_sound = text.rsplit_once(':').is_some_and(|(host, port)| {
        let is_host = !host.is_empty() && (!host.contains(':') || host.starts_with('['));
        is_host && port.parse().is_ok_and(|port: u16| port > 0)
    });
    let remedy = || "give HOST:PORT, such as localhost:14158".to_owned();
    given(is_sound.then(|| text.to_owned()), ("display", text), "a place of a viewer", remedy, problems)
}

/// Where copies are kept, if anywhere.
fn checkpoint(args: &RenderArgs, problems: &mut Problems) -> Option<Checkpoints> {
    let every = args.checkpoint_every.as_deref();
    let every = every.map(|text| time("checkpoint-every", text, problems));
    let Some(path) = &args.checkpoint else {
        let flags = [(args.checkpoint_every.is_some(), "--checkpoint-every"), (args.resume, "--resume")];
        for (_, flag) in flags.iter().filter(|(is_given, _)| *is_given) {
            let what = format!("`{flag}` without a checkpoint");
            problems.push(on_command_line(what).remedy("name its file by --checkpoint FILE"));
        }
        return None;
    };
    let every = every.unwrap_or(Some(EVERY))?;
    Some(Checkpoints { path: path.clone(), every, resume: args.resume })
}

/// Between copies, where nobody says.
const EVERY: Duration = Duration::from_secs(60);

/// What filtered reflections are filtered from has room in EXR files only.
fn check_first_pass(is_kept: bool, outputs: &[Output], problems: &mut Problems) {
    if is_kept {
        let what = format!("`--checkpoint` beside the output `{FIRST_PASS}`, which no checkpoint holds");
        problems.push(on_command_line(what).remedy("leave out one of them"));
    }
    if outputs.iter().all(|output| output.format != Format::Exr) {
        let what = format!("the output `{FIRST_PASS}` without an EXR file, which alone can hold it");
        problems.push(on_command_line(what).remedy("name one by -o FILE.exr"));
    }
}

/// Files to write, each once.
fn outputs(paths: Vec<PathBuf>, problems: &mut Problems) -> Vec<Output> {
    let mut outputs: Vec<Output> = Vec::new();
    for path in paths {
        match Format::of(&path) {
            Err(error) => problems.absorb(error, None),
            Ok(_) if outputs.iter().any(|output| is_same(&output.path, &path)) => problems.push(twice(&path)),
            Ok(format) => {
                check_target(&path, problems);
                outputs.push(Output { path, format });
            }
        }
    }
    outputs
}

/// `stem` with an extension more, whatever dots it has.
fn with_extension(stem: &Path, extension: &str) -> PathBuf {
    let mut name = stem.as_os_str().to_owned();
    name.push(".");
    name.push(extension);
    name.into()
}

pub(super) fn check_target(path: &Path, problems: &mut Problems) {
    if let Err(error) = atomic::check_target(path) {
        problems.absorb(error, None);
    }
}

fn twice(path: &Path) -> Problem {
    on_command_line(format!("`{}` would be written twice", path.display())).remedy("name each file once")
}

/// The picture, its coverage, and the outputs of these names in the order of the list.
pub(super) fn layout(names: &[String], problems: &mut Problems) -> Layout {
    let known = further_outputs();
    for name in names.iter().filter(|name| !known.contains(&name.as_str())) {
        let what = format!("there is no output `{name}`");
        problems.push(on_command_line(what).remedy(suggest(name, &known)));
    }
    let means =
        |name: &str, aov: Aov| name == aov.name() || (name == CRYPTOMATTE && aov.matte_layer().is_some());
    Layout::with(Aov::ALL.into_iter().filter(|&aov| names.iter().any(|name| means(name, aov))))
}

/// The pixels between these corners, if there are any.
pub(super) fn window([x0, y0, x1, y1]: [u32; 4]) -> Option<Window> {
    Some(Window { x0, y0, x1, y1 }).filter(|window| !window.is_empty())
}

fn crop(text: &str, problems: &mut Problems) -> Option<Window> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let window = numbers.and_then(|numbers| window(numbers.try_into().ok()?));
    let remedy = || "give x0,y0,x1,y1 with x0 < x1 and y0 < y1, counted from 0 at the top left".to_owned();
    given(window, ("crop", text), "a rectangle of pixels", remedy, problems)
}

fn threads(text: &str, problems: &mut Problems) -> Option<NonZeroUsize> {
    let number = text.trim().parse().ok().filter(|n: &NonZeroUsize| n.get() <= MOST_THREADS);
    let remedy = || format!("give a whole number from 1 to {MOST_THREADS}");
    given(number, ("threads", text), "a number of threads", remedy, problems)
}

/// A whole number in a range.
fn whole(flag: &str, text: &str, range: RangeInclusive<usize>, problems: &mut Problems) -> Option<usize> {
    let number = text.trim().parse().ok().filter(|n| range.contains(n));
    let remedy = || format!("give a whole number from {} to {}", range.start(), range.end());
    given(number, (flag, text), &format!("a number of {flag}"), remedy, problems)
}

/// A time with its unit, seconds where there is none.
fn time(flag: &str, text: &str, problems: &mut Problems) -> Option<Duration> {
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let with_unit = |&(unit, seconds): &(&str, f64)| text.strip_suffix(unit).map(|rest| (rest, seconds));
    let (number, seconds) = units.iter().find_map(with_unit).unwrap_or((text, 1.0));
    let number = number.trim().parse().ok().filter(|x: &f64| *x > 0.0);
    let time = number.and_then(|number| Duration::try_from_secs_f64(number * seconds).ok());
    let remedy = || "give a number above 0 in seconds, or with its unit: 90s, 2m, 1.5h".to_owned();
    given(time, (flag, text), "a time", remedy, problems)
}

fn target_error(flag: &str, text: &str, problems: &mut Problems) -> Option<f64> {
    let number = text.trim().parse().ok().filter(|x: &f64| x.is_finite() && *x > 0.0);
    let remedy = || "give a relMSE above 0, such as 0.001".to_owned();
    given(number, (flag, text), "an error", remedy, problems)
}

/// What the text behind a flag was read as; it is a problem that it is not `what` if it could not be.
fn given<T>(
    read: Option<T>,
    (flag, text): (&str, &str),
    what: &str,
    remedy: impl FnOnce() -> String,
    problems: &mut Problems,
) -> Option<T> {
    if read.is_none() {
        problems.push(on_command_line(format!("`--{flag} {text}` is not {what}")).remedy(remedy()));
    }
    read
}

fn on_command_line(what: String) -> Problem {
    Problem::at(Place::file("command line"), what)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Args, Command};
    use crate::error::Error;
    use clap::Parser as _;

    fn args(words: &[&str]) -> RenderArgs {
        let words = ["specula", "render"].iter().chain(words);
        let Command::Render(args) = Args::try_parse_from(words).expect("parsed").command else {
            panic!("another command")
        };
        *args
    }

    #[test]
    fn without_outputs_both_kinds_are_named_after_the_scene() {
        let options = RenderOptions::new(&args(&["some/where/a.b.toml"])).expect("valid");
        let paths: Vec<_> = options.outputs.iter().map(|o| o.path.to_string_lossy().into_owned()).collect();
        assert_eq!(paths, ["a.b.exr", "a.b.png"], "in the current directory");
    }

    #[test]
    fn flags_become_overrides_after_those_of_d() {
        let words = ["a.toml", "--spp", "4", "-D", "render.spp=9", "--width", "7", "-D", "camera.vfov_deg=3"];
        let options = RenderOptions::new(&args(&words)).expect("valid");
        let wanted = ["render.spp=9", "camera.vfov_deg=3", "render.spp=4", "film.width=7"];
        assert_eq!(options.overrides, wanted, "order");
    }

    #[test]
    fn a_view_chooses_its_integrator_unless_one_is_given() {
        let overrides = |words: &[&str]| RenderOptions::new(&args(words)).expect("valid").overrides;
        let implied = overrides(&["a.toml", "--view", "depth"]);
        assert_eq!(implied, ["render.integrator=view", "render.view=depth"], "implied");
        let given = overrides(&["a.toml", "--view", "depth", "--integrator", "whitted"]);
        assert_eq!(given, ["render.integrator=whitted", "render.view=depth"], "given");
    }

    #[test]
    fn all_problems_are_told_at_once() {
        let words = [
            "a.toml",
            "-o",
            "a.jpg",
            "-o",
            "no/dir/a.png",
            "-o",
            "a.exr",
            "-o",
            "a.exr",
            "--crop",
            "3,0,3,9",
            "-t0",
        ];
        let error = RenderOptions::new(&args(&words)).expect_err("wrong");
        let Error::Input(problems) = error else { panic!("{error}") };
        assert_eq!(problems.0.len(), 5, "{problems}");
        assert!(problems.0.iter().all(|problem| problem.remedy.is_some()), "{problems}");
    }

    #[test]
    fn times_have_units() {
        let parse = |text| time("time-limit", text, &mut Problems::default());
        for (text, seconds) in
            [("90", 90.0), ("90s", 90.0), ("0.5 m", 30.0), ("1.5h", 5400.0), ("250ms", 0.25)]
        {
            assert_eq!(parse(text), Some(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in ["", "s", "0", "-3", "1d", "1m30s", "nan", "inf", "1e300h"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }

    #[test]
    fn viewers_have_a_host_and_a_port() {
        let parse = |text| display(text, &mut Problems::default());
        for text in ["localhost:14158", "10.0.0.7:1", "[::1]:14158"] {
            assert_eq!(parse(text).as_deref(), Some(text), "{text}");
        }
        for text in ["", "localhost", ":14158", "localhost:", "localhost:0", "localhost:99999", "::1:14158"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }

    #[test]
    fn crops_are_four_numbers() {
        let parse = |text| crop(text, &mut Problems::default());
        assert_eq!(parse("1,2, 3,4"), Some(Window { x0: 1, y0: 2, x1: 3, y1: 4 }), "with a space");
        for text in ["", "1,2,3", "1,2,3,4,5", "-1,0,3,3", "0,0,1.5,2", "2,0,1,1", "0,0,99999999999,1"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
