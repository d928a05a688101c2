//! The command line as typed: words, and help beside them.

mod batch;
mod bench;
mod common;
mod diff;
mod documents;
mod farm;
mod fuzzy;
mod merge;
mod plan;
mod render;
mod tradeoff;
mod words;

pub use batch::BatchArgs;
pub use bench::BenchArgs;
pub use common::{LimitsArgs, LogArgs, LogFormat, LogLevel, TrustArgs};
pub use diff::DiffArgs;
pub use documents::{CompletionsArgs, ManArgs, SchemaArgs, SchemaOf};
pub use farm::{FarmArgs, FarmCommonArgs, FarmEngine, Farmed, OpenJdArgs, SlurmArgs};
pub use fuzzy::FuzzyArgs;
pub use merge::MergeArgs;
pub use plan::PlanArgs;
pub use render::RenderArgs;
pub use tradeoff::TradeoffArgs;
pub(super) use words::{CRYPTOMATTE, FIRST_PASS, PRUNING, further_outputs, specialised};

use clap::{Parser, Subcommand};

/// An offline ray tracer for shiny things.
#[derive(Clone, Debug, Parser)]
#[command(name = "specula", version, propagate_version = true, max_term_width = 100)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What can be done.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Render a scene to EXR and PNG
    Render(Box<RenderArgs>),
    /// Tell what a scene contains and requires, without rendering it
    Plan(Box<PlanArgs>),
    /// Render many pictures and sequences, leaving out what is done
    Batch(Box<BatchArgs>),
    /// Join slices or crops into one picture
    Merge(Box<MergeArgs>),
    /// Have many machines render slices of a picture and merge them, through an engine that runs jobs
    Farm(FarmArgs),
    /// Measure how far a picture is from its reference
    Diff(Box<DiffArgs>),
    /// Make fuzzy reflections again from a saved first pass, with another roughness and no ray
    Fuzzy(Box<FuzzyArgs>),
    /// Compare backends: the same rays of scenes through each, in every kind of query
    Bench(Box<BenchArgs>),
    /// Measure what accuracy costs: settings of a scene beside each other, error against time
    Tradeoff(Box<TradeoffArgs>),
    /// Print the JSON Schema of the scene file, or of the batch file
    Schema(SchemaArgs),
    /// Print a completion script for a shell
    Completions(CompletionsArgs),
    /// Print the manual page, or write those of all commands
    Man(ManArgs),
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn the_declarations_are_consistent() {
        Args::command().debug_assert();
    }

    #[test]
    fn words_are_shown_but_not_enforced() {
        let args =
            Args::try_parse_from(["specula", "render", "a.toml", "--backend", "abacus"]).expect("accepted");
        let Command::Render(args) = args.command else { panic!("another command") };
        assert_eq!(args.backend.as_deref(), Some("abacus"), "kept for the check of the scene");
        let help = Args::try_parse_from(["specula", "render", "-h"]).expect_err("help").to_string();
        assert!(help.contains("[possible values: embree, bvh2, cwbvh, brute]"), "{help}");
        let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(help.contains("crypto_object, crypto_material, cryptomatte, gbuffer]"), "{help}");
        assert_eq!(help.matches("geometric_normal").count(), 1, "outputs are named once: {help}");
    }

    #[test]
    fn negative_numbers_are_values() {
        let words = ["specula", "render", "a.toml", "--spp", "-1", "--crop", "-1,0,2,2"];
        assert!(Args::try_parse_from(words).is_ok(), "left to later checks");
    }
}
