//! From words to calls.
//!
//! Words become [`Args`], as typed; those become options, validated, all problems at once; those become calls. Results go
//! to standard output, progress and log to standard error. Flags that set what a scene file can set are overrides of it:
//! the same checks, the same messages.

mod args;
mod batch;
mod bench;
mod command;
mod cost;
mod diff;
mod documents;
mod done;
mod farm;
mod frames;
mod frozen;
mod fuzzy;
mod interrupt;
mod kept;
mod log;
mod merge;
mod options;
mod output;
mod plan;
mod progress;
mod render;
mod report;
mod shell;
mod stage;
mod statistics;
mod threads;
mod tradeoff;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser as _;
use clap::error::ErrorKind;

pub use args::{
    Args, BatchArgs, BenchArgs, Command, CompletionsArgs, DiffArgs, FarmArgs, FarmCommonArgs, FarmEngine,
    Farmed, FuzzyArgs, LimitsArgs, LogArgs, LogFormat, LogLevel, ManArgs, MergeArgs, OpenJdArgs, PlanArgs,
    RenderArgs, SchemaArgs, SchemaOf, SlurmArgs, TradeoffArgs, TrustArgs,
};

use crate::error::{Error, Result};

/// What the words of the command line say, or the status to exit with after clap has shown help or what is wrong.
pub fn parse(words: impl IntoIterator<Item = OsString>) -> std::result::Result<Args, ExitCode> {
    let words: Vec<OsString> = words.into_iter().collect();
    let is_long = words.iter().any(|word| word == "--version");
    Args::try_parse_from(words).map_err(|error| {
        // Nobody is left to tell if showing it fails.
        let _ = error.print();
        if is_long && error.kind() == ErrorKind::DisplayVersion {
            let _ = output::print(engines().as_bytes());
        }
        if error.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS }
    })
}

/// What pixels depend on beside the version, a line each: our own instruction set, and each backend.
fn engines() -> String {
    let lanes = format!("lanes {}\n", crate::render::lanes());
    crate::render::backends().into_iter().fold(lanes, |text, backend| text + &backend + "\n")
}

/// Does what was asked for.
pub fn run(args: Args) -> Result<()> {
    match args.command {
        Command::Render(args) => render::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Batch(args) => batch::run(&args),
        Command::Merge(args) => merge::run(&args),
        Command::Farm(args) => farm::run(&args),
        Command::Diff(args) => diff::run(&args),
        Command::Fuzzy(args) => fuzzy::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Tradeoff(args) => tradeoff::run(&args),
        Command::Schema(args) => documents::schema(args.of),
        Command::Completions(args) => documents::completions(args.shell),
        Command::Man(args) => documents::man(args.dir.as_deref()),
    }
}

/// Tells what stopped the command, and the status to exit with: 1 failed while running, 2 wrong input, 3 a check said no,
/// 130 interrupted.
pub fn fail(error: &Error) -> ExitCode {
    log::start_if_not_yet();
    match error {
        Error::Input(problems) => problems.0.iter().for_each(|problem| tracing::error!("{problem}")),
        Error::Refused(problem) => tracing::error!("{problem}"),
        Error::Check(findings) => findings.iter().for_each(|finding| tracing::error!("{finding}")),
        other => tracing::error!("{}", chain(other)),
    }
    ExitCode::from(match error {
        Error::Input(_) | Error::Refused(_) => 2,
        Error::Io { .. } | Error::Backend { .. } | Error::Failed { .. } => 1,
        Error::Check(_) => 3,
        Error::Interrupted => 130,
    })
}

/// Fails if one of two things did. Where both did, the error of the second is told.
fn both(first: Result<()>, second: Result<()>) -> Result<()> {
    match (first, second) {
        (Err(first), Err(second)) => {
            tracing::error!("{}", chain(&second));
            Err(first)
        }
        (first, second) => first.and(second),
    }
}

/// The message of an error and of what caused it, down to the root.
fn chain(error: &Error) -> String {
    let mut text = error.to_string();
    let mut source = std::error::Error::source(error);
    while let Some(cause) = source {
        text = format!("{text}: {cause}");
        source = cause.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_goes_down_to_the_root() {
        let source = std::io::Error::other("disk full");
        let error = Error::Io { path: "a.exr".into(), what: "cannot write", source };
        assert_eq!(chain(&error), "a.exr: cannot write: disk full", "chain");
    }
}
