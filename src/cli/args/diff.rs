//! The words of `diff`.

use std::path::PathBuf;

use clap::ValueHint;

use super::words::Words;
use super::{LimitsArgs, LogArgs};
use crate::measure::Metric;

/// What to compare, and how.
#[derive(Clone, Debug, clap::Args)]
pub struct DiffArgs {
    /// The picture to judge (.exr, .hdr or .png)
    #[arg(value_name = "A", value_hint = ValueHint::FilePath)]
    pub test: PathBuf,

    /// The reference: what the picture should be
    ///
    /// Both hold light of a scene (.exr, .hdr), or both what a display shows (.png, decoded from sRGB). They must be of one
    /// size and, where they are crops, of the same pixels. Alpha is ignored. Pixels that are not finite in either are
    /// counted and left out.
    #[arg(value_name = "B", value_hint = ValueHint::FilePath)]
    pub reference: PathBuf,

    /// Write the difference to FILE; .exr is A - B and FLIP in numbers, .png FLIP in colours. May be given several times
    ///
    /// In a .png, black is no error and pale yellow the greatest (the colour map magma); pixels that are not finite are
    /// green. In an .exr the channels R, G and B are A - B and the channel `flip` is FLIP.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub output: Vec<PathBuf>,

    /// Exit with status 3 if the error is above X, or if any pixel is not finite
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub max_error: Option<String>,

    /// Which error --max-error is about [default: relmse]
    ///
    /// Means over pixels and channels of linear light: mse of (A - B)^2, rmse its square root, relmse of (A - B)^2 /
    /// (B^2 + 0.01). flip is the mean over pixels of what an eye would notice, from 0 to 1: of pictures of scene light at
    /// all exposures that show anything of B.
    #[arg(long, value_name = "NAME", value_parser = Words::of(&Metric::ALL, Metric::word))]
    pub metric: Option<String>,

    /// For FLIP: pixels in one degree of the visual field, from 1 to 1000 [default: 67.02, a 4K display of 0.7 m seen
    /// from 0.7 m]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub ppd: Option<String>,

    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,

    /// Threads to use; as many as there are processors if not given
    #[arg(short, long, value_name = "N", allow_negative_numbers = true)]
    pub threads: Option<String>,

    /// What files may ask for.
    #[command(flatten)]
    pub limits: LimitsArgs,

    /// What is told on standard error.
    #[command(flatten)]
    pub log: LogArgs,
}
