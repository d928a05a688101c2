//! The words of `fuzzy`.

use std::path::PathBuf;

use clap::ValueHint;

use super::words::Words;
use super::{LimitsArgs, LogArgs};
use crate::scene::description::{FuzzyCorrection, FuzzyRadius, FuzzyRejection, FuzzyWeighting, FuzzyWindow};

/// What to filter again, and how.
#[derive(Clone, Debug, clap::Args)]
pub struct FuzzyArgs {
    /// The first pass: an .exr file written by `specula render --glossy two-pass --aov gbuffer`
    ///
    /// Of a crop only what is in it can be mirrored. Knobs that are not given are those that the picture was rendered with.
    #[arg(value_name = "GBUFFER", value_hint = ValueHint::FilePath)]
    pub gbuffer: PathBuf,

    /// Write the picture to FILE; .exr is scene-linear, .png a preview. May be given several times
    ///
    /// Without it, the picture is written to the current directory under the name of the file with _fuzzy added, as .exr and as .png.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub output: Vec<PathBuf>,

    /// The roughness of all reflectors, from 0, a mirror, to 1: all but a hundredth of the lobe within 10 degrees
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub roughness: Option<String>,

    /// The exponent, or the shininess, of all reflectors; larger is sharper
    #[arg(long, value_name = "P", allow_negative_numbers = true, conflicts_with = "roughness")]
    pub exponent: Option<String>,

    /// What weights follow from: the exponent of a lobe, or shininess and strength
    #[arg(long, value_name = "NAME", value_parser = Words::of(FuzzyWeighting::ALL, FuzzyWeighting::word))]
    pub weighting: Option<String>,

    /// Under the weighting `shininess`: what reflections are multiplied by
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub strength: Option<String>,

    /// The part of a lobe that may lie outside of its window
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub lost_mass: Option<String>,

    /// The greatest half angle of a lobe in degrees
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub max_angle: Option<String>,

    /// The greatest radius of a window in pixels
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    pub max_radius: Option<String>,

    /// What the radius of a window follows from
    #[arg(long, value_name = "NAME", value_parser = Words::of(FuzzyRadius::ALL, FuzzyRadius::word))]
    pub radius: Option<String>,

    /// The outline of a window
    #[arg(long, value_name = "NAME", value_parser = Words::of(FuzzyWindow::ALL, FuzzyWindow::word))]
    pub window: Option<String>,

    /// What is made of pixels being samples of area and not of solid angle
    #[arg(long, value_name = "NAME", value_parser = Words::of(FuzzyCorrection::ALL, FuzzyCorrection::word))]
    pub correction: Option<String>,

    /// Leave pixels whose window is below half a pixel as they are at once: true or false
    #[arg(long, value_name = "BOOL")]
    pub skip: Option<String>,

    /// How what lies outside of the lobe is told
    #[arg(long, value_name = "NAME", value_parser = Words::of(FuzzyRejection::ALL, FuzzyRejection::word))]
    pub rejection: Option<String>,

    /// Look weights up in a table: true or false
    #[arg(long, value_name = "BOOL")]
    pub table: Option<String>,

    /// How many pixels of a window count at most, or `off`
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub taps: Option<String>,

    /// Look at windows of at least twice this radius in a smaller picture, or `off`
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    pub pyramid: Option<String>,

    /// From this radius on filter every other row and column, or `off`
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    pub half: Option<String>,

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
