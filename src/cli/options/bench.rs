//! What `bench` is to do.

use std::path::PathBuf;

use super::files::{check_target, is_same, spare, twice};
use super::trust::Trusted;
use super::values::{on_command_line, threads, whole};
use crate::bench::{Class, Contestant, Query, Settings};
use crate::cli::args::BenchArgs;
use crate::error::{Problem, Problems, Result};
use crate::scene::description::Backend;
use crate::scene::load::words::suggest;

/// What `bench` is to do.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct BenchOptions {
    pub(in crate::cli) scenes: Vec<PathBuf>,
    pub(in crate::cli) overrides: Vec<String>,
    pub(in crate::cli) settings: Settings,
    pub(in crate::cli) json: bool,
    pub(in crate::cli) report: Option<PathBuf>,
    pub(in crate::cli) record: Option<PathBuf>,
    pub(in crate::cli) replay: Option<PathBuf>,
    /// How far the files of scenes are trusted.
    pub(in crate::cli) trusted: Trusted,
}

/// Most rays of a class: more would not fit into the memory of most machines in all forms.
const MOST_RAYS: usize = 1 << 24;

/// Most passes; more is a slip of the hand.
const MOST_PASSES: usize = 10_000;

impl BenchOptions {
    /// What those words mean; all that is wrong with them at once.
    pub(in crate::cli) fn new(args: &BenchArgs) -> Result<Self> {
        let mut problems = Problems::default();
        let contestants = contestants(args, &mut problems);
        let classes = chosen("class", &args.class, &Class::ALL, Class::word, &mut problems);
        let queries = queries(args, &mut problems);
        let number = |flag, text: &Option<String>, most, default, problems: &mut Problems| {
            text.as_deref().and_then(|text| whole(flag, text, 1..=most, problems)).unwrap_or(default)
        };
        let [rays, passes] = if args.quick { [4096, 3] } else { [16384, 5] };
        let asked = args.threads.as_deref().and_then(|text| threads(text, &mut problems));
        let settings = Settings {
            contestants,
            brute: args.backend.iter().any(|word| word == Backend::Brute.word()),
            queries,
            all_queries: !args.query.is_empty(),
            classes,
            rays: number("rays", &args.rays, MOST_RAYS, rays, &mut problems),
            passes: number("passes", &args.passes, MOST_PASSES, passes, &mut problems),
            threads: crate::cli::threads::all(asked).get(),
        };
        check_files(args, &mut problems);
        let trusted = Trusted::new(&args.trust, &mut problems);
        problems.into_result(Self {
            scenes: args.scenes.clone(),
            overrides: args.overrides.clone(),
            settings,
            json: args.json,
            report: args.report.clone(),
            record: args.record.clone(),
            replay: args.replay.clone(),
            trusted,
        })
    }
}

/// Those that race, in the order of the list.
fn contestants(args: &BenchArgs, problems: &mut Problems) -> Vec<Contestant> {
    let all = Contestant::all();
    for word in args.backend.iter().filter(|word| !all.iter().any(|it| it.is_called(word))) {
        let backends = Backend::ALL.iter().map(|backend| backend.word().to_owned());
        let names: Vec<String> = backends.chain(all.iter().map(Contestant::name)).collect();
        problems.push(unknown("backend", word, &names));
    }
    // Whoever names a build wants it, quick or not.
    let is_named = |it: &Contestant| args.backend.iter().any(|word| *word == it.name());
    let is_asked =
        |it: &Contestant| args.backend.is_empty() || args.backend.iter().any(|word| it.is_called(word));
    all.into_iter().filter(|it| is_asked(it) && (!args.quick || it.is_quick() || is_named(it))).collect()
}

fn queries(args: &BenchArgs, problems: &mut Problems) -> Vec<Query> {
    let words = chosen("query", &args.query, &Query::WORDS, |word| word, problems);
    let quick = |query: &Query| {
        !args.quick || !args.query.is_empty() || ["single", "packet8"].contains(&query.word())
    };
    Query::ALL.into_iter().filter(|query| words.contains(&query.word()) && quick(query)).collect()
}

/// Those whose words were given, in the order of the list; all if none was.
fn chosen<T: Copy>(
    flag: &str,
    words: &[String],
    all: &[T],
    word_of: impl Fn(T) -> &'static str,
    problems: &mut Problems,
) -> Vec<T> {
    let known: Vec<String> = all.iter().map(|&it| word_of(it).to_owned()).collect();
    for word in words.iter().filter(|word| !known.contains(word)) {
        problems.push(unknown(flag, word, &known));
    }
    let is_asked = |it: &T| words.is_empty() || words.iter().any(|word| word == word_of(*it));
    all.iter().copied().filter(is_asked).collect()
}

fn unknown(flag: &str, word: &str, known: &[String]) -> Problem {
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    on_command_line(format!("`--{flag} {word}` is not known")).remedy(suggest(word, &known))
}

fn check_files(args: &BenchArgs, problems: &mut Problems) {
    let targets: Vec<&PathBuf> = args.report.iter().chain(&args.record).collect();
    for target in &targets {
        check_target(target, problems);
        spare(args.scenes.iter().chain(&args.replay), target, problems);
    }
    if let [report, record] = targets[..]
        && is_same(report, record)
    {
        problems.push(twice(report));
    }
    if args.record.is_some() && args.replay.is_some() {
        let what = "`--record` and `--replay` together would copy a file of rays";
        problems.push(on_command_line(what.to_owned()).remedy("leave out one of them"));
    }
    for (flag, path) in [("record", &args.record), ("replay", &args.replay)] {
        if path.is_some() && args.scenes.len() > 1 {
            let what =
                format!("`--{flag}` is for the rays of one scene, and {} are given", args.scenes.len());
            problems.push(on_command_line(what).remedy("run it scene by scene"));
        }
    }
    if args.replay.is_some() && args.rays.is_some() {
        let what = "`--rays` says how many to record, and `--replay` records none";
        problems.push(on_command_line(what.to_owned()).remedy("leave out one of them"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Args, Command};
    use crate::error::Error;
    use clap::Parser as _;

    fn options(words: &[&str]) -> Result<BenchOptions> {
        let words = ["specula", "bench"].iter().chain(words);
        let Command::Bench(args) = Args::try_parse_from(words).expect("parsed").command else {
            panic!("another command")
        };
        BenchOptions::new(&args)
    }

    #[test]
    fn without_flags_everything_races() {
        let settings = options(&["a.toml"]).expect("valid").settings;
        assert_eq!(settings.contestants, Contestant::all(), "contestants");
        assert_eq!((settings.queries, settings.classes), (Query::ALL.to_vec(), Class::ALL.to_vec()), "all");
        assert_eq!((settings.rays, settings.passes, settings.brute), (16384, 5, false), "defaults");
    }

    #[test]
    fn names_choose_and_quick_leaves_out() {
        let names = |words: &[&str]| {
            let settings = options(words).expect("valid").settings;
            settings.contestants.iter().map(Contestant::name).collect::<Vec<_>>()
        };
        let quick = ["embree-medium", "embree-medium-robust", "bvh2-medium", "cwbvh-medium", "brute"];
        assert_eq!(names(&["a.toml", "--quick"]), quick, "quick");
        let named = names(&["a.toml", "--quick", "--backend", "bvh2", "--backend", "cwbvh-slow"]);
        assert_eq!(named, ["bvh2-medium", "cwbvh-slow"], "whoever is named races");
        assert!(options(&["a.toml", "--backend", "brute"]).expect("valid").settings.brute, "asked for");
    }

    #[test]
    fn all_problems_are_told_at_once() {
        let words = [
            "a.toml",
            "b.toml",
            "--backend",
            "abacus",
            "--class",
            "tertiary",
            "--query",
            "packet5",
            "--rays",
            "0",
            "--passes",
            "-1",
            "-t",
            "0",
            "--report",
            "no/a.html",
            "--record",
            "a",
            "--replay",
            "b",
        ];
        let Err(Error::Input(problems)) = options(&words) else { panic!("valid") };
        // Of the files: no such directory, record and replay, each of them with two scenes, rays with replay.
        assert_eq!(problems.0.len(), 6 + 5, "{problems}");
        assert!(problems.0.iter().all(|problem| problem.remedy.is_some()), "{problems}");
    }
}
