//! The words of `tradeoff`.

use std::path::PathBuf;

use clap::ValueHint;

use super::words::Words;
use super::{LogArgs, TrustArgs};
use crate::tradeoff::knobs::Knob;

/// What to sweep, and how.
#[derive(Clone, Debug, clap::Args)]
pub struct TradeoffArgs {
    /// The scene file (TOML)
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    pub scene: PathBuf,

    /// Turn this knob, through its usual values or these. May be given several times
    ///
    /// Without it all knobs are turned that do something in the scene: what is not turned is told, and why.
    #[arg(long, value_name = "NAME[=V1,V2,..]", value_parser = Words::of(Knob::ALL, |knob| knob.name))]
    pub knob: Vec<String>,

    /// How points are chosen [default: one-at-a-time]
    ///
    /// one-at-a-time: each knob by itself, at all numbers of samples if spp is turned. grid: every combination. random:N: so many of them by chance,
    /// by the scene's seed.
    #[arg(long, value_name = "one-at-a-time|grid|random:N")]
    pub design: Option<String>,

    /// How often each point is rendered, with another seed each time, from 2 [default: 4]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub runs: Option<String>,

    /// Compare with the picture in FILE (.exr or .hdr)
    ///
    /// Its noise is taken out of errors if it has the channels of `specula render --aov variance`.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub reference: Option<PathBuf>,

    /// Samples per pixel of the reference that is rendered, with the most accurate value of each knob that is turned [default: 16 times
    /// the most that points have, and at least 256]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub reference_spp: Option<String>,

    /// Columns of the pictures; without size and reference those of the scene, made smaller to 320 pixels at most
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    pub width: Option<String>,

    /// Rows of the pictures
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    pub height: Option<String>,

    /// Tell what to take for this relMSE. May be given several times [default: 1e-2, 1e-3 and 1e-4]
    #[arg(long, value_name = "E", allow_negative_numbers = true, value_delimiter = ',')]
    pub target: Vec<String>,

    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,

    /// Write a line for each point to FILE, for spreadsheets
    #[arg(long, value_name = "FILE.csv", value_hint = ValueHint::FilePath)]
    pub csv: Option<PathBuf>,

    /// Write a page with plots, pictures and all settings to FILE
    #[arg(long, value_name = "FILE.html", value_hint = ValueHint::FilePath)]
    pub report: Option<PathBuf>,

    /// Keep each run in FILE as soon as it is done, for --resume; and the reference beside it
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with = "resume")]
    pub keep: Option<PathBuf>,

    /// Go on from the runs in FILE, if it is there, and add to it: only what is missing is rendered
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub resume: Option<PathBuf>,

    /// Threads to use; as many as there are processors if not given
    #[arg(short, long, value_name = "N", allow_negative_numbers = true)]
    pub threads: Option<String>,

    /// Set any value of the scene file by its dotted path, such as render.seed=4, for all points. May be given several times
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,

    /// How far files are trusted.
    #[command(flatten)]
    pub trust: TrustArgs,

    /// What is told on standard error.
    #[command(flatten)]
    pub log: LogArgs,
}
