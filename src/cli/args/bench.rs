//! The words of `bench`.

use std::path::PathBuf;

use clap::ValueHint;

use super::words::Words;
use super::{LogArgs, TrustArgs};
use crate::bench::{self, Class};
use crate::scene::description::Backend;

/// What to race, and how.
#[derive(Clone, Debug, clap::Args)]
pub struct BenchArgs {
    /// The scene files (TOML)
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath, required = true)]
    pub scenes: Vec<PathBuf>,

    /// Race only these: a backend with all its builds, or one of its builds such as embree-medium-robust or
    /// cwbvh-fast. May be given several times
    ///
    /// Without it all builds race, but brute, which tests every primitive, in small scenes only.
    #[arg(long, value_name = "NAME", value_parser = Words::of(Backend::ALL, Backend::word))]
    pub backend: Vec<String>,

    /// Ask only in this way. May be given several times
    ///
    /// Without it the usual builds are asked in all ways, and those of other qualities and presets by single rays.
    #[arg(long, value_name = "NAME", value_parser = Words::of(&bench::Query::WORDS, |word| word))]
    pub query: Vec<String>,

    /// Trace only rays of this class. May be given several times
    #[arg(long, value_name = "NAME", value_parser = Words::of(&Class::ALL, Class::word))]
    pub class: Vec<String>,

    /// Rays of each class [default: 16384, or 4096 with --quick]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub rays: Option<String>,

    /// Passes that count; one more warms up [default: 5, or 3 with --quick]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub passes: Option<String>,

    /// Threads to race on, besides one; as many as there are processors if not given
    #[arg(short, long, value_name = "N", allow_negative_numbers = true)]
    pub threads: Option<String>,

    /// Fewer builds, kinds of query, rays and passes: for a first look
    #[arg(long)]
    pub quick: bool,

    /// Print one JSON document instead of tables
    #[arg(long)]
    pub json: bool,

    /// Write a page with tables, plots and all settings to FILE
    #[arg(long, value_name = "FILE.html", value_hint = ValueHint::FilePath)]
    pub report: Option<PathBuf>,

    /// Write the rays to FILE, for --replay or for other programs
    ///
    /// The format is described in the documentation of the module `bench::file`: a head, then arrays of 32-bit floats.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub record: Option<PathBuf>,

    /// Trace the rays of FILE instead of recording new ones
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub replay: Option<PathBuf>,

    /// Set any value of the scene files by its dotted path, such as film.width=640. May be given several times
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,

    /// How far files are trusted.
    #[command(flatten)]
    pub trust: TrustArgs,

    /// What is told on standard error.
    #[command(flatten)]
    pub log: LogArgs,
}
