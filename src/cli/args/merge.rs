//! The words of `merge`.

use std::path::PathBuf;

use clap::ValueHint;

use super::{LimitsArgs, LogArgs};

/// What to join.
#[derive(Clone, Debug, clap::Args)]
pub struct MergeArgs {
    /// Parts of one picture, written by `specula render -o FILE.part` with --slice or --crop, in any order
    #[arg(value_name = "PART", value_hint = ValueHint::FilePath, required = true)]
    pub parts: Vec<PathBuf>,

    /// Write the picture to FILE; .exr is scene-linear, .png a preview. May be given several times
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath, required = true)]
    pub output: Vec<PathBuf>,

    /// The pixels that the parts make up, the upper ends excluded; without it all of the picture, or those of all parts
    /// where these have the same
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true)]
    pub crop: Option<String>,

    /// Store colour, coverage and normals in EXR files as 16-bit floats; other outputs keep all digits
    #[arg(long)]
    pub half: bool,

    /// Write times, rays and counts of all parts together to FILE as JSON
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath)]
    pub stats: Option<PathBuf>,

    /// What files may ask for.
    #[command(flatten)]
    pub limits: LimitsArgs,

    /// What is told on standard error.
    #[command(flatten)]
    pub log: LogArgs,
}
