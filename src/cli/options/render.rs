//! What `render` and `plan` are to do.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::cost::{self, Cost};
use super::files::{
    Output, check_target, is_same, outputs, spare, spare_all, try_out, twice, with_extension,
};
use super::trust::Trusted;
use super::values::{crop, frames, given, on_command_line, target_error, threads, time};
use crate::cli::args::{
    CRYPTOMATTE, FIRST_PASS, PRUNING, PlanArgs, RenderArgs, further_outputs, specialised,
};
use crate::cli::frames;
use crate::error::{Place, Problem, Problems, Result};
use crate::film::{Aov, Layout, Precision};
use crate::image::{Format, Window};
use crate::render::{Limits, Slice};
use crate::scene::Wanted;
use crate::scene::description::Frames;
use crate::scene::load::words::suggest;
use crate::scene::needs::capability::{Capabilities, Capability};
use crate::trust::Trust;

/// What `render` is to do.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct RenderOptions {
    pub(in crate::cli) scene: PathBuf,
    pub(in crate::cli) outputs: Vec<Output>,
    /// Files for the sums.
    pub(in crate::cli) parts: Vec<PathBuf>,
    /// What replaces values of the scene file, in this order.
    pub(in crate::cli) overrides: Vec<String>,
    /// Frames to render; names of files have a place for the number then.
    pub(in crate::cli) frames: Option<Frames>,
    /// The one frame that this is about.
    pub(in crate::cli) frame: Option<i32>,
    pub(in crate::cli) crop: Option<Window>,
    pub(in crate::cli) slice: Option<Slice>,
    pub(in crate::cli) checkpoint: Option<Checkpoints>,
    pub(in crate::cli) layout: Layout,
    /// Whether what fuzzy reflections are filtered from is written, too.
    pub(in crate::cli) first_pass: bool,
    pub(in crate::cli) threads: Option<NonZeroUsize>,
    pub(in crate::cli) limits: Limits,
    pub(in crate::cli) specialise: Specialise,
    /// Whether somebody else chooses settings.
    pub(in crate::cli) cost: Option<Cost>,
    pub(in crate::cli) precision: Precision,
    pub(in crate::cli) stats: Option<PathBuf>,
    /// How far the files of the scene are trusted.
    pub(in crate::cli) trust: Trust,
    /// Where somebody looks at the picture while it is made, `HOST:PORT`.
    pub(in crate::cli) display: Option<String>,
}

/// What is done beside what a scene needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::cli) struct Specialise {
    /// What is switched on.
    pub(in crate::cli) forced: Capabilities,
    /// Whether what has no effect is kept.
    pub(in crate::cli) keeps: bool,
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
pub(in crate::cli) fn planned(args: &PlanArgs) -> Result<(Wanted, Trust)> {
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
pub(in crate::cli) struct Checkpoints {
    pub(in crate::cli) path: PathBuf,
    pub(in crate::cli) every: Duration,
    /// Whether to go on from the one that is there.
    pub(in crate::cli) resume: bool,
}

impl RenderOptions {
    /// The picture of a scene trusted so far, with nothing else said, and no file to write.
    pub(in crate::cli) fn of(scene: &Path, trust: Trust) -> Self {
        Self {
            scene: scene.to_owned(),
            outputs: Vec::new(),
            parts: Vec::new(),
            overrides: Vec::new(),
            frames: None,
            frame: None,
            crop: None,
            slice: None,
            checkpoint: None,
            layout: Layout::default(),
            first_pass: false,
            threads: None,
            limits: Limits::default(),
            specialise: Specialise::default(),
            cost: None,
            precision: Precision::Float,
            stats: None,
            trust,
            display: None,
        }
    }

    /// What those words mean; all that is wrong with them at once.
    pub(in crate::cli) fn new(args: &RenderArgs) -> Result<Self> {
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
            let kept = args.checkpoint.as_ref().map(|_| "checkpoint");
            check_first_pass(kept, checked.iter().map(|output| output.format), &mut problems);
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
    pub(in crate::cli) fn wanted(&self) -> Wanted {
        self.specialise.wanted(self.layout.clone(), self.limits.error.is_some())
    }
}

impl RenderOptions {
    /// One picture after the other: a frame each, or the one that there is.
    pub(in crate::cli) fn pictures(&self) -> impl Iterator<Item = Self> {
        let numbers = match &self.frames {
            None => vec![None],
            Some(frames) => frames.numbers().iter().copied().map(Some).collect(),
        };
        numbers.into_iter().map(|frame| frame.map_or_else(|| self.clone(), |frame| self.at_frame(frame)))
    }

    /// Fails where a file to write, of any frame, is among these, of which the scene is made.
    pub(in crate::cli) fn spare(&self, inputs: &[PathBuf]) -> Result<()> {
        let targets = self.pictures().flat_map(|picture| {
            let checkpoint = picture.checkpoint.iter().map(|it| &it.path);
            picture.results().chain(checkpoint).cloned().collect::<Vec<_>>()
        });
        spare_all(inputs, targets)
    }

    /// Fails where no file can be made in the folder of one that is to be written. Rendering goes on without checkpoints.
    pub(in crate::cli) fn try_out(&self) -> Result<()> {
        try_out(self.results())
    }

    /// All files to write, but for the checkpoint.
    pub(in crate::cli) fn results(&self) -> impl Iterator<Item = &PathBuf> {
        self.outputs.iter().map(|output| &output.path).chain(&self.parts).chain(&self.stats)
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

/// Files of several frames have places for their numbers, and folders that are there.
fn places<'a>(frames: Option<&Frames>, paths: impl Iterator<Item = &'a PathBuf>, problems: &mut Problems) {
    let Some(frames) = frames.filter(|frames| frames.numbers().len() > 1) else { return };
    for path in paths {
        if !frames::has_place(path) {
            let problem = same_for_all(path, frames.numbers().len());
            problems.push(Problem { place: Some(Place::file("command line")), ..problem });
        } else if path.parent().is_some_and(frames::has_place) {
            let others = &frames.numbers()[1..];
            others.iter().for_each(|&frame| check_target(&frames::named(path, frame), problems));
        }
    }
}

/// That the name of a file has no place for the number of a frame, of which there are several.
pub(in crate::cli) fn same_for_all(path: &Path, frames: usize) -> Problem {
    let what = format!("`{}` would be written for each of {frames} frames", path.display());
    Problem::new(what).remedy("put #### or {frame} where its name is to have the number")
}

/// Flags that a scene file knows as keys, as overrides; those of `-D` come first, so that a named flag wins.
pub(in crate::cli) fn overrides(args: &RenderArgs) -> Vec<String> {
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
pub(super) fn rendered_paths(args: &RenderArgs) -> Vec<PathBuf> {
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
pub(super) const PART: &str = "part";

pub(super) fn is_part(path: &Path) -> bool {
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

/// What filtered reflections are filtered from has room in EXR files only, and none in what a flag keeps.
pub(in crate::cli) fn check_first_pass(
    kept: Option<&str>,
    mut formats: impl Iterator<Item = Format>,
    problems: &mut Problems,
) {
    if let Some(flag) = kept {
        let what = format!("`--{flag}` beside the output `{FIRST_PASS}`, which no checkpoint holds");
        problems.push(on_command_line(what).remedy("leave out one of them"));
    }
    if formats.all(|format| format != Format::Exr) {
        let what = format!("the output `{FIRST_PASS}` without an EXR file, which alone can hold it");
        problems.push(on_command_line(what).remedy("name one by -o FILE.exr"));
    }
}

/// The picture, its coverage, and the outputs of these names in the order of the list.
pub(in crate::cli) fn layout(names: &[String], problems: &mut Problems) -> Layout {
    let known = further_outputs();
    for name in names.iter().filter(|name| !known.contains(&name.as_str())) {
        let what = format!("there is no output `{name}`");
        problems.push(on_command_line(what).remedy(suggest(name, &known)));
    }
    let means =
        |name: &str, aov: Aov| name == aov.name() || (name == CRYPTOMATTE && aov.matte_layer().is_some());
    Layout::with(Aov::ALL.into_iter().filter(|&aov| names.iter().any(|name| means(name, aov))))
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
    fn viewers_have_a_host_and_a_port() {
        let parse = |text| display(text, &mut Problems::default());
        for text in ["localhost:14158", "10.0.0.7:1", "[::1]:14158"] {
            assert_eq!(parse(text).as_deref(), Some(text), "{text}");
        }
        for text in ["", "localhost", ":14158", "localhost:", "localhost:0", "localhost:99999", "::1:14158"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
