//! What `tradeoff` is to do.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use super::files::{check_input, check_target, is_same, spare, twice};
use super::trust::Trusted;
use super::values::{given, on_command_line, target_error, threads, whole};
use crate::cli::args::TradeoffArgs;
use crate::error::{Problem, Problems, Result};
use crate::scene::load::words::suggest;
use crate::tradeoff::design::Design;
use crate::tradeoff::knobs::Knob;
use crate::trust::Trust;

/// What `tradeoff` is to do.
#[derive(Clone, Debug)]
pub(in crate::cli) struct TradeoffOptions {
    pub(in crate::cli) scene: PathBuf,
    pub(in crate::cli) overrides: Vec<String>,
    /// Knobs to be turned and their values, none for the usual ones; empty for all that do something.
    pub(in crate::cli) knobs: Vec<(&'static Knob, Vec<String>)>,
    /// Without the seed, which is that of the scene.
    pub(in crate::cli) design: Design,
    pub(in crate::cli) runs: u32,
    pub(in crate::cli) against: Against,
    /// Whether somebody said how large pictures are to be.
    pub(in crate::cli) is_sized: bool,
    pub(in crate::cli) targets: Vec<f64>,
    pub(in crate::cli) json: bool,
    pub(in crate::cli) csv: Option<PathBuf>,
    pub(in crate::cli) report: Option<PathBuf>,
    /// Where runs are kept, and whether to go on from those that are there.
    pub(in crate::cli) keep: Option<(PathBuf, bool)>,
    pub(in crate::cli) threads: Option<NonZeroUsize>,
    /// How far the files of the scene are trusted.
    pub(in crate::cli) trust: Trust,
}

/// What points are compared with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::cli) enum Against {
    /// A picture in a file.
    File(PathBuf),
    /// One that is rendered, with so many samples per pixel where somebody says.
    Rendered(Option<u32>),
}

/// Most runs of a point; more is a slip of the hand.
const MOST_RUNS: usize = 1000;

/// Most points by chance.
const MOST_POINTS: usize = crate::tradeoff::design::MOST;

/// The samples that a picture may have.
const MOST_SAMPLES: usize = crate::tradeoff::recommend::MOST as usize;

impl TradeoffOptions {
    /// What those words mean; all that is wrong with them at once.
    pub(in crate::cli) fn new(args: &TradeoffArgs) -> Result<Self> {
        let mut problems = Problems::default();
        check_files(args, &mut problems);
        let runs = args.runs.as_deref().and_then(|text| whole("runs", text, 2..=MOST_RUNS, &mut problems));
        let sizes = [("film.width", &args.width), ("film.height", &args.height)];
        let sizes =
            sizes.iter().filter_map(|(key, value)| value.as_ref().map(|value| format!("{key}={value}")));
        let overrides: Vec<String> = args.overrides.iter().cloned().chain(sizes).collect();
        let is_size =
            |text: &String| ["film.width", "film.height", "film="].iter().any(|key| text.starts_with(key));
        let targets: Vec<f64> =
            args.target.iter().filter_map(|text| target_error("target", text, &mut problems)).collect();
        let options = Self {
            scene: args.scene.clone(),
            is_sized: overrides.iter().any(is_size),
            overrides,
            knobs: knobs(&args.knob, &mut problems),
            design: args
                .design
                .as_deref()
                .and_then(|text| design(text, &mut problems))
                .unwrap_or(Design::OneAtATime),
            runs: runs.and_then(|runs| u32::try_from(runs).ok()).unwrap_or(4),
            against: against(args, &mut problems),
            targets: if targets.is_empty() { vec![1e-2, 1e-3, 1e-4] } else { targets },
            json: args.json,
            csv: args.csv.clone(),
            report: args.report.clone(),
            keep: args
                .keep
                .clone()
                .map(|path| (path, false))
                .or(args.resume.clone().map(|path| (path, true))),
            threads: args.threads.as_deref().and_then(|text| threads(text, &mut problems)),
            trust: Trusted::new(&args.trust, &mut problems).of(&args.scene),
        };
        problems.into_result(options)
    }
}

/// Those that are named, each with its values.
fn knobs(words: &[String], problems: &mut Problems) -> Vec<(&'static Knob, Vec<String>)> {
    let known: Vec<&str> = Knob::ALL.iter().map(|knob| knob.name).collect();
    let mut chosen: Vec<(&'static Knob, Vec<String>)> = Vec::new();
    for word in words {
        let (name, values) =
            word.split_once('=').map_or((word.as_str(), None), |(name, rest)| (name, Some(rest)));
        let name = name.trim();
        let Some(knob) = Knob::of(name) else {
            let what = format!("there is no knob `{name}`");
            problems.push(on_command_line(what).remedy(suggest(name, &known)));
            continue;
        };
        let mut own: Vec<String> = Vec::new();
        for value in values.into_iter().flat_map(|values| values.split(',')).map(str::trim) {
            if value.is_empty() {
                let what = format!("`--knob {word}` has an empty value");
                problems.push(on_command_line(what).remedy("write NAME=V1,V2,.. or NAME alone"));
                break;
            }
            if !own.iter().any(|other| other == value) {
                own.push(value.to_owned());
            }
        }
        if chosen.iter().any(|(other, _)| other.name == name) {
            let what = format!("the knob `{name}` is given twice");
            problems.push(on_command_line(what).remedy("give all of its values at once: NAME=V1,V2,.."));
            continue;
        }
        chosen.push((knob, own));
    }
    chosen
}

fn design(text: &str, problems: &mut Problems) -> Option<Design> {
    let design = match text.trim() {
        "one-at-a-time" => Some(Design::OneAtATime),
        "grid" => Some(Design::Grid),
        other => other
            .strip_prefix("random:")
            .and_then(|points| points.trim().parse().ok())
            .filter(|points| (1..=MOST_POINTS).contains(points))
            .map(|points| Design::Random { points, seed: 0 }),
    };
    let remedy = || format!("give one-at-a-time, grid, or random:N with N from 1 to {MOST_POINTS}");
    given(design, ("design", text), "a way to choose points", remedy, problems)
}

fn against(args: &TradeoffArgs, problems: &mut Problems) -> Against {
    let spp = args.reference_spp.as_deref();
    let spp = spp.and_then(|text| whole("reference-spp", text, 1..=MOST_SAMPLES, problems));
    let Some(file) = &args.reference else {
        return Against::Rendered(spp.and_then(|spp| u32::try_from(spp).ok()));
    };
    if args.reference_spp.is_some() {
        let what = "`--reference-spp` is for a reference that is rendered, and `--reference` names one";
        problems.push(on_command_line(what.to_owned()).remedy("leave out one of them"));
    }
    Against::File(file.clone())
}

fn check_files(args: &TradeoffArgs, problems: &mut Problems) {
    args.reference.iter().for_each(|path| check_input(path, problems));
    let targets: Vec<&PathBuf> =
        args.csv.iter().chain(&args.report).chain(&args.keep).chain(&args.resume).collect();
    for (i, target) in targets.iter().enumerate() {
        check_target(target, problems);
        spare([&args.scene].into_iter().chain(&args.reference), target, problems);
        if targets[..i].iter().any(|other| is_same(other, target)) {
            problems.push(twice(target));
        }
    }
    if let Some(path) = args.keep.as_ref().filter(|path| path.exists()) {
        let what = format!("`--keep {}`: there is a file already", path.display());
        let remedy = "give --resume with its name to go on from it, or remove it";
        problems.push(Problem { remedy: Some(remedy.to_owned()), ..on_command_line(what) });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Args, Command};
    use crate::error::Error;
    use clap::Parser as _;

    fn options(words: &[&str]) -> Result<TradeoffOptions> {
        let words = ["specula", "tradeoff"].iter().chain(words);
        let Command::Tradeoff(args) = Args::try_parse_from(words).expect("parsed").command else {
            panic!("another command")
        };
        TradeoffOptions::new(&args)
    }

    #[test]
    fn knobs_have_their_values() {
        let found = options(&["a.toml", "--knob", "spp=1,4,4", "--knob", "fresnel", "--target", "1e-2,5e-3"]);
        let found = found.expect("valid");
        let named: Vec<_> = found.knobs.iter().map(|(knob, values)| (knob.name, values.len())).collect();
        assert_eq!(named, [("spp", 2), ("fresnel", 0)], "each once, in order");
        assert_eq!(found.targets, [1e-2, 5e-3], "targets");
        assert!(!found.is_sized && found.runs == 4, "defaults");
        let sized = options(&["a.toml", "--width", "9", "-D", "render.seed=3"]).expect("valid");
        assert!(sized.is_sized && sized.overrides == ["render.seed=3", "film.width=9"], "{sized:?}");
        let random = options(&["a.toml", "--design", "random:7"]).expect("valid");
        assert_eq!(random.design, Design::Random { points: 7, seed: 0 }, "random");
    }

    #[test]
    fn all_problems_are_told_at_once() {
        let words = [
            "a.toml",
            "--knob",
            "dept=3",
            "--knob",
            "spp=1,,2",
            "--knob",
            "query",
            "--knob",
            "query",
            "--design",
            "random:0",
            "--runs",
            "1",
            "--reference",
            "no.exr",
            "--reference-spp",
            "0",
            "--target",
            "-1",
            "--report",
            "no/a.html",
            "--csv",
            "a.toml",
            "-t",
            "0",
        ];
        let Err(Error::Input(problems)) = options(&words) else { panic!("valid") };
        // Of the reference: not there, no number, and both ways at once.
        assert_eq!(problems.0.len(), 3 + 1 + 1 + 3 + 1 + 1 + 1 + 1, "{problems}");
        assert!(problems.0.iter().all(|problem| problem.remedy.is_some()), "{problems}");
        let text = problems.to_string();
        assert!(text.contains("there is no knob `dept`") && text.contains("max_depth"), "{text}");
    }
}
