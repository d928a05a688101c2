//! Who chooses settings of a picture, if not the scene and the flags.

use std::path::PathBuf;
use std::time::Duration;

use super::files::{check_input, spare};
use super::render::RenderOptions;
use super::values::{given, on_command_line, time};
use crate::cli::args::RenderArgs;
use crate::error::Problems;
use crate::tradeoff::presets::Preset;

/// Who chooses settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::cli) enum Cost {
    /// A preset.
    Preset(Preset),
    /// A time, and a file of runs of the scene.
    Budget { time: Duration, runs: Option<PathBuf> },
}

/// What flags say of it; all that is wrong with them.
pub(super) fn cost(args: &RenderArgs, problems: &mut Problems) -> Option<Cost> {
    let preset = args.preset.as_deref().and_then(|word| {
        let remedy = || format!("choose one of {}", Preset::ALL.map(Preset::word).join(", "));
        given(Preset::of(word), ("preset", word), "a preset", remedy, problems)
    });
    let budget = args.budget.as_deref().and_then(|text| time("budget", text, problems));
    let mut refuse =
        |what: &str, remedy: &str| problems.push(on_command_line(what.to_owned()).remedy(remedy));
    if args.preset.is_some() && args.budget.is_some() {
        refuse("`--preset` is about an error and `--budget` about a time", "leave out one of them");
    }
    if args.tradeoff.is_some() && args.budget.is_none() {
        refuse("`--tradeoff` without a budget", "say how long it may take by --budget TIME");
    }
    if args.budget.is_some() && args.time_limit.is_some() {
        refuse("`--budget` is a limit of time itself", "leave out `--time-limit`");
    }
    if let Some(runs) = &args.tradeoff {
        check_input(runs, problems);
        let targets = args.output.iter().chain(&args.stats).chain(&args.checkpoint);
        targets.for_each(|target| spare([runs], target, problems));
    }
    match (preset, budget) {
        (Some(preset), _) => Some(Cost::Preset(preset)),
        (None, Some(time)) => Some(Cost::Budget { time, runs: args.tradeoff.clone() }),
        (None, None) => None,
    }
}

/// Refuses what does not go together with settings that are found on the way: they may be others on another machine.
pub(super) fn check(options: &RenderOptions, problems: &mut Problems) {
    if options.cost.is_none() {
        return;
    }
    let with = [
        (options.slice.is_some(), "--slice"),
        (!options.parts.is_empty(), "an output of sums (.part)"),
        (options.checkpoint.is_some(), "--checkpoint"),
        (options.limits.error.is_some(), "--target-error"),
    ];
    for (_, what) in with.into_iter().filter(|(is_given, _)| *is_given) {
        let text = format!("{what} does not go together with settings that are found on the way");
        problems.push(
            on_command_line(text)
                .remedy("render once with --preset or --budget, then give the flags that it told"),
        );
    }
}
