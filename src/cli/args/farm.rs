//! The words of `farm`: those of `render`, kept as they were typed, and where they go.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::error::Error;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command, FromArgMatches, Subcommand, ValueHint};

use super::RenderArgs;

/// For which engine to write jobs.
#[derive(Clone, Debug, clap::Args)]
pub struct FarmArgs {
    /// The engine.
    #[command(subcommand)]
    pub engine: FarmEngine,
}

/// What runs jobs on many machines.
#[derive(Clone, Debug, Subcommand)]
pub enum FarmEngine {
    /// Write a job array for Slurm and the job that merges its parts; submit both, wait for the picture
    Slurm(Box<SlurmArgs>),
    /// Write an Open Job Description template (2023-09), which several engines take; run it here
    #[command(name = "openjd")]
    OpenJd(Box<OpenJdArgs>),
}

/// What to have rendered through Slurm.
#[derive(Clone, Debug, clap::Args)]
pub struct SlurmArgs {
    /// A word more for `sbatch`, for both jobs, such as --sbatch-option=--partition=fast. May be given several times
    #[arg(long, value_name = "WORD", allow_hyphen_values = true)]
    pub sbatch_option: Vec<OsString>,

    /// Let no more than this number of tasks run at once
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub at_once: Option<String>,

    #[expect(missing_docs, reason = "a comment would be taken for that of the command")]
    #[command(flatten)]
    pub common: FarmCommonArgs,
}

/// What to have rendered as an Open Job Description.
#[derive(Clone, Debug, clap::Args)]
pub struct OpenJdArgs {
    #[expect(missing_docs, reason = "a comment would be taken for that of the command")]
    #[command(flatten)]
    pub common: FarmCommonArgs,
}

/// What all engines take.
#[derive(Clone, Debug, clap::Args)]
pub struct FarmCommonArgs {
    /// Cut the samples into N slices, a task each [default: 8, or as many as there are samples]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub slices: Option<String>,

    /// Put scripts, logs, checkpoints and parts into DIR, which all machines must see under this name [default: the first picture
    /// to write, with the extension .farm]
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub dir: Option<PathBuf>,

    /// The program as the other machines find it [default: this one]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::ExecutablePath)]
    pub program: Option<PathBuf>,

    /// Hand the jobs over, not only write them
    ///
    /// To Slurm by `sbatch`. Open Job Descriptions have no common way to be handed over: they are run on this machine by `openjd run`, one
    /// task after another.
    #[arg(long)]
    pub submit: bool,

    /// With --submit: wait for the merged picture; the exit status is that of its job
    #[arg(long)]
    pub wait: bool,

    /// Print one JSON document instead of lines
    #[arg(long)]
    pub json: bool,

    #[expect(missing_docs, reason = "a comment would be taken for that of the command")]
    #[command(flatten)]
    pub picture: Farmed,
}

/// Words of `render`, read, and as words again.
#[derive(Clone, Debug)]
pub struct Farmed {
    /// What they mean.
    pub args: RenderArgs,
    /// The flags that hold for every slice of the picture, to be passed on: whatever `render` knows, but for what each task gets anew
    /// or only the merged picture has.
    pub words: Vec<OsString>,
}

/// What is not passed on: each task has its own, or the job that merges has it.
const NOT_PASSED_ON: [&str; 8] =
    ["scene", "output", "slice", "checkpoint", "resume", "half", "stats", "display"];

/// What `farm` refuses, and does not show therefore.
const HIDDEN: [&str; 10] = [
    "frames",
    "slice",
    "checkpoint",
    "resume",
    "time_limit",
    "target_error",
    "preset",
    "budget",
    "tradeoff",
    "display",
];

impl Farmed {
    fn words_of(matches: &ArgMatches) -> Vec<OsString> {
        let command = <RenderArgs as clap::Args>::augment_args(Command::new("render"));
        command.get_arguments().flat_map(|arg| words_of(arg, matches)).collect()
    }
}

/// A flag as it may be typed.
fn words_of(arg: &Arg, matches: &ArgMatches) -> Vec<OsString> {
    let id = arg.get_id().as_str();
    if NOT_PASSED_ON.contains(&id) || matches.value_source(id) != Some(ValueSource::CommandLine) {
        return Vec::new();
    }
    let name = match (arg.get_long(), arg.get_short()) {
        (Some(long), _) => format!("--{long}"),
        (None, Some(short)) => format!("-{short}"),
        (None, None) => return Vec::new(),
    };
    if !arg.get_action().takes_values() {
        return vec![name.into()];
    }
    let mut values = matches.get_raw(id).into_iter().flatten().peekable();
    if values.peek().is_none() {
        return vec![name.into()];
    }
    // One word where possible, whatever the value begins with.
    let words = values.flat_map(|value| {
        if arg.get_long().is_some() {
            let mut word = OsString::from(format!("{name}="));
            word.push(value);
            vec![word]
        } else {
            vec![name.clone().into(), value.to_owned()]
        }
    });
    words.collect()
}

impl FromArgMatches for Farmed {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        Ok(Self { words: Self::words_of(matches), args: RenderArgs::from_arg_matches(matches)? })
    }

    fn from_arg_matches_mut(matches: &mut ArgMatches) -> Result<Self, Error> {
        let words = Self::words_of(matches);
        Ok(Self { words, args: RenderArgs::from_arg_matches_mut(matches)? })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        self.words.extend(Self::words_of(matches));
        self.args.update_from_arg_matches(matches)
    }
}

impl clap::Args for Farmed {
    fn augment_args(command: Command) -> Command {
        let command = RenderArgs::augment_args(command);
        HIDDEN.into_iter().fold(command, |command, id| command.mut_arg(id, |arg| arg.hide(true)))
    }

    fn augment_args_for_update(command: Command) -> Command {
        RenderArgs::augment_args_for_update(command)
    }
}

#[cfg(test)]
mod tests {
    use crate::cli::{Args, Command, FarmEngine, SlurmArgs};
    use clap::Parser as _;

    fn slurm(words: &[&str]) -> SlurmArgs {
        let words = ["specula", "farm", "slurm"].iter().chain(words);
        let Command::Farm(args) = Args::try_parse_from(words).expect("parsed").command else {
            panic!("another command")
        };
        let FarmEngine::Slurm(args) = args.engine else { panic!("another engine") };
        *args
    }

    #[test]
    fn flags_of_a_picture_are_kept_as_they_were_typed() {
        let words = [
            "a b.toml",
            "--slices=3",
            "-oa.exr",
            "--half",
            "--stats",
            "s.json",
            "--spp",
            "16",
            "-t2",
            "--aov",
            "albedo,depth",
            "-D",
            "materials.m.note='$(x)'",
            "-Drender.seed=3",
            "--crop=-1,0,2,2",
            "-q",
            "--json",
        ];
        let farmed = slurm(&words).common.picture;
        let wanted = [
            "--spp=16",
            "--aov=albedo",
            "--aov=depth",
            "--crop=-1,0,2,2",
            "--threads=2",
            "-D",
            "materials.m.note='$(x)'",
            "-D",
            "render.seed=3",
            "--quiet",
        ];
        assert_eq!(farmed.words, wanted, "passed on");
        assert_eq!(farmed.args.scene.to_str(), Some("a b.toml"), "and read");
        assert!(farmed.args.half && farmed.args.stats.is_some(), "kept for the merge");
    }

    #[test]
    fn words_that_are_passed_on_mean_the_same() {
        let given = slurm(&[
            "a.toml",
            "--aov",
            "albedo,depth",
            "--fresnel=schlick",
            "-D",
            "a.b=c",
            "--log-level",
            "warn",
            "--limits=texels=4e9,triangles=none",
            "--sandbox",
            "--no-specialise",
        ]);
        let farmed = given.common.picture;
        let words = ["specula", "render", "a.toml"].into_iter().map(Into::into).chain(farmed.words);
        let Command::Render(args) = Args::try_parse_from(words).expect("parsed").command else {
            panic!("another command")
        };
        assert_eq!(format!("{args:?}"), format!("{:?}", Box::new(farmed.args)), "read again");
    }

    #[test]
    fn words_for_sbatch_may_begin_with_dashes() {
        let args = slurm(&["a.toml", "--sbatch-option=--partition=a b", "--sbatch-option", "-n1"]);
        assert_eq!(args.sbatch_option, ["--partition=a b", "-n1"], "words");
    }
}
