//! The command line as typed: words, and help beside them.

mod batch;
mod farm;

pub use farm::{FarmArgs, FarmCommonArgs, FarmEngine, Farmed, OpenJdArgs, SlurmArgs};

use std::ffi::OsStr;
use std::path::PathBuf;

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use clap::{Arg, Parser, Subcommand, ValueEnum, ValueHint};
use clap_complete::Shell;

use crate::bench::{self, Class};
use crate::film::Aov;
use crate::measure::Metric;
use crate::scene::description::{
    Backend, Fresnel, FuzzyBy, FuzzyCorrection, FuzzyRadius, FuzzyRejection, FuzzyWeighting, FuzzyWindow,
    Integrator, LightChoice, Query, Sampler, View,
};
use crate::scene::needs::capability::{Capabilities, Capability};
use crate::tradeoff::knobs::Knob;
use crate::tradeoff::presets::Preset;

pub use batch::{BatchArgs, SchemaArgs, SchemaOf};

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

/// What to render, and how.
#[derive(Clone, Debug, clap::Args)]
pub struct RenderArgs {
    /// The scene file (TOML)
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    pub scene: PathBuf,

    /// Write the picture to FILE; .exr is scene-linear, .png a preview, .part its sums for `specula merge`. May be given
    /// several times
    ///
    /// Without it, the picture is written to the current directory under the name of the scene file, as .exr and as
    /// .png; with --slice as .part.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub output: Vec<PathBuf>,

    /// Samples per pixel; with --time-limit or --target-error at most
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub spp: Option<String>,

    /// End the picture when this time is over, such as 90, 90s, 2m or 1.5h
    ///
    /// By the clock, reading the scene included, writing the picture not. All pixels get the same number of samples, one in any
    /// case, and those of --spp (or of the scene file) at most.
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    pub time_limit: Option<String>,

    /// End the picture when its relMSE is below E: more samples where they bring most
    ///
    /// The relMSE of `specula diff` against a picture of endless samples, estimated from the picture's own: it is below E in 95 of 100
    /// pictures. Light that no sample has found is not in the estimate. Pixels get 32 samples at least and those of --spp (or
    /// of the scene file) at most.
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    pub target_error: Option<String>,

    /// Settings that reach an error soonest: a relMSE of 0.03, 0.01, 0.001 or 0.0001
    ///
    /// By what was measured on scenes that ship, and a first look at some pixels of this one, which finds how many samples it takes. What is set
    /// by other flags stays. The log says which flags do the same.
    #[arg(long, value_name = "NAME", value_parser = Words::of(&Preset::ALL, Preset::word))]
    pub preset: Option<String>,

    /// Make the best of this time, such as 30s, 2m or 1.5h: choose settings, then take samples until it is over
    ///
    /// By the clock, reading the scene included, writing the picture not. Settings are those of --tradeoff, or of the presets. What is set by other
    /// flags stays. The log tells the error to be expected.
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    pub budget: Option<String>,

    /// With --budget: choose by the runs in FILE, which `specula tradeoff --keep FILE` wrote of the same scene on a machine like this
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub tradeoff: Option<PathBuf>,

    /// What to compute
    #[arg(long, value_name = "NAME", value_parser = Words::of(Integrator::ALL, Integrator::word))]
    pub integrator: Option<String>,

    /// What the integrator `view` shows; chooses that integrator unless --integrator is given too
    #[arg(long, value_name = "NAME", value_parser = Words::of(View::ALL, View::word))]
    pub view: Option<String>,

    /// What finds hits
    #[arg(long, value_name = "NAME", value_parser = Words::of(Backend::ALL, Backend::word))]
    pub backend: Option<String>,

    /// How rays are traced: one by one, in packets, or in streams of many samples
    #[arg(long, value_name = "NAME", value_parser = Words::of(Query::ALL, Query::word))]
    pub query: Option<String>,

    /// Where samples fall
    #[arg(long, value_name = "NAME", value_parser = Words::of(Sampler::ALL, Sampler::word))]
    pub sampler: Option<String>,

    /// How reflectance depends on the angle, in materials that do not say so themselves
    #[arg(long, value_name = "NAME", value_parser = Words::of(Fresnel::ALL, Fresnel::word))]
    pub fresnel: Option<String>,

    /// How lobes become fuzzy reflections: by rays, by a filter over ideal mirrors, or by trembling normals
    #[arg(long, value_name = "NAME", value_parser = Words::of(FuzzyBy::ALL, FuzzyBy::word))]
    pub glossy: Option<String>,

    /// Columns of the picture
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    pub width: Option<String>,

    /// Rows of the picture
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    pub height: Option<String>,

    /// Longest path followed, in edges: 1 sees emission only, 2 adds direct light
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub max_depth: Option<String>,

    /// Do not follow branches that carry less than this part of what reaches the pixel
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub min_throughput: Option<String>,

    /// Paths of N edges and more that carry little may end at random; `off` for never
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub roulette: Option<String>,

    /// Limit the luminance of any one piece of indirect light of paths: no bright specks, too little light; or `off`
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub clamp_indirect: Option<String>,

    /// How paths choose the light that they ask: by power, all alike, or through a tree over all emitters
    #[arg(long, value_name = "NAME", value_parser = Words::of(LightChoice::ALL, LightChoice::word))]
    pub light_choice: Option<String>,

    /// Shadow rays of the ray tree to each light that has a size, at the first hits of a camera ray
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub light_samples: Option<String>,

    /// Rays of the ray tree for each glossy lobe, at the first hits of a camera ray
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub glossy_samples: Option<String>,

    /// Further outputs of the EXR file; `cryptomatte` stands for both of its kinds, and `gbuffer`, with `--glossy two-pass`, for what
    /// `specula fuzzy` reads
    ///
    /// `direct` is what came by two edges at most, `indirect` the rest of the picture. A filtered reflection (`--glossy two-pass`) is all indirect, also where
    /// the mirrored ray ends on a light, which by rays within the lobe is direct.
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = Words(further_outputs()))]
    pub aov: Vec<String>,

    /// Render only these pixels, the upper ends excluded
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true)]
    pub crop: Option<String>,

    /// Render frames of a sequence: N, A..B (both ends are rendered), A..BxSTEP, or several with commas between
    ///
    /// For frame F the shutter opens and closes F / fps later than the scene file says (`fps` of the camera, 24 by default). Names of files
    /// need a place for the number, where there are several frames: {frame}, or as many # as there are to be digits. A limit of time is one
    /// for each frame.
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    pub frames: Option<String>,

    /// Take only one of N parts of the samples of each pixel, K from 0: `specula merge` joins all of them
    ///
    /// As many samples as --spp (or the scene file) says are cut into N parts that follow one another.
    #[arg(long, value_name = "K/N", allow_hyphen_values = true)]
    pub slice: Option<String>,

    /// Keep a copy of what there is in FILE, from which --resume goes on; removed when the picture is written
    ///
    /// Also written when somebody asks to stop (Ctrl-C, SIGTERM), with exit status 130.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub checkpoint: Option<PathBuf>,

    /// No more than this time is lost whatever happens, such as 30s, 5m or 1h [default: 60s]
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    pub checkpoint_every: Option<String>,

    /// Go on from the file of --checkpoint, if it is there: the picture is that of one go, bit for bit
    ///
    /// Scene, files, flags and version must be the same, as must the instruction set.
    #[arg(long)]
    pub resume: bool,

    /// Another seed gives another, equally valid noise
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub seed: Option<String>,

    /// Threads to use; as many as there are processors if not given
    #[arg(short, long, value_name = "N", allow_negative_numbers = true)]
    pub threads: Option<String>,

    /// Store colour in EXR files as 16-bit floats
    #[arg(long)]
    pub half: bool,

    /// Write times, rays and counts to FILE as JSON
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath)]
    pub stats: Option<PathBuf>,

    /// Switch on what the scene does not need, and keep what has no effect: the same picture, slower, for comparing
    ///
    /// With names, only these: `plan` lists them. `pruning` stands for keeping what has no effect.
    #[arg(long, value_name = "NAME", value_delimiter = ',', num_args = 0.., require_equals = true,
        value_parser = Words(specialised()))]
    pub no_specialise: Option<Vec<String>>,

    /// Show the picture in the viewer tev at HOST:PORT while it is made, such as localhost:14158
    ///
    /// The viewer may be started, end or hang at any time: rendering neither waits for it nor depends on it.
    #[arg(long, value_name = "HOST:PORT", value_hint = ValueHint::Hostname)]
    pub display: Option<String>,

    /// Set any value of the scene file by its dotted path, such as render.spp=4. May be given several times
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,

    /// How far files are trusted.
    #[command(flatten)]
    pub trust: TrustArgs,

    /// What is told on standard error.
    #[command(flatten)]
    pub log: LogArgs,
}

/// What to plan.
#[derive(Clone, Debug, clap::Args)]
pub struct PlanArgs {
    /// The scene file (TOML)
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    pub scene: PathBuf,

    /// What finds hits
    #[arg(long, value_name = "NAME", value_parser = Words::of(Backend::ALL, Backend::word))]
    pub backend: Option<String>,

    /// Further outputs of the EXR file, which ask for more
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = Words(further_outputs()))]
    pub aov: Vec<String>,

    /// Plan for `render` with this flag
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    pub target_error: Option<String>,

    /// Plan for `render` with this flag
    #[arg(long, value_name = "NAME", value_delimiter = ',', num_args = 0.., require_equals = true,
        value_parser = Words(specialised()))]
    pub no_specialise: Option<Vec<String>>,

    /// Set any value of the scene file by its dotted path, such as render.spp=4. May be given several times
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,

    /// Print one JSON document instead of tables
    #[arg(long)]
    pub json: bool,

    #[expect(missing_docs, reason = "a comment would be taken for that of the command")]
    #[command(flatten)]
    pub trust: TrustArgs,

    #[expect(missing_docs, reason = "a comment would be taken for that of the command")]
    #[command(flatten)]
    pub log: LogArgs,
}

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

    /// Store colour in EXR files as 16-bit floats
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

/// How far files are trusted.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct TrustArgs {
    /// What they may ask for.
    #[command(flatten)]
    pub limits: LimitsArgs,

    /// Read no file outside of the folder of the scene file, links followed: includes, meshes, materials and pictures
    ///
    /// For scenes by people whom you do not know. A path that leads out of the folder is refused, be it by `..`, by a link, from the
    /// root, or in an override (-D). What is written is not affected.
    #[arg(long)]
    pub sandbox: bool,
}

/// What files may ask for.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct LimitsArgs {
    /// Change how much files may ask for, such as texels=4e9,triangles=1e6; `none` of one or of all is without a limit
    ///
    /// More is refused before memory is taken. `pixels` (5e8) of the picture, whatever is cropped; `samples` (none) of all pixels
    /// together; `triangles` (2e9) of all meshes, instances not counted; `texels` (1e9) of each picture that is read; `textures` (1e10):
    /// texels of all textures; `bytes` (1e11) of each file; `scene_bytes` (5e8) of all scene files; `files` (1e6); `include_depth`
    /// (32); `nesting` (64) of tables in tables and of instances of instances.
    #[arg(long, value_name = "NAME=N,..", value_delimiter = ',')]
    pub limits: Vec<String>,
}

/// What is told on standard error, and how.
#[derive(Clone, Debug, clap::Args)]
pub struct LogArgs {
    /// Show no progress, only warnings and errors
    #[arg(short, long)]
    pub quiet: bool,

    /// How log lines on standard error are written
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub log_format: LogFormat,

    /// The least important log lines to show [default: info, or warn with --quiet]
    #[arg(long, value_name = "LEVEL")]
    pub log_level: Option<LogLevel>,
}

/// Which shell to complete for.
#[derive(Clone, Debug, clap::Args)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL")]
    pub shell: Shell,
}

/// Where manual pages go.
#[derive(Clone, Debug, clap::Args)]
pub struct ManArgs {
    /// Write the pages of all commands to files in DIR
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub dir: Option<PathBuf>,
}

/// How log lines are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    /// For people
    #[default]
    Text,
    /// One JSON object a line
    Json,
}

/// How important a log line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LogLevel {
    /// What stops the command
    Error,
    /// What is allowed but hardly meant
    Warn,
    /// What was done
    Info,
    /// How
    Debug,
    /// Everything
    Trace,
}

/// All outputs that are mattes.
pub(super) const CRYPTOMATTE: &str = "cryptomatte";

/// The output that is no mean of samples: what fuzzy reflections are filtered from.
pub(super) const FIRST_PASS: &str = "gbuffer";

/// What `--aov` knows.
pub(super) fn further_outputs() -> Vec<&'static str> {
    Aov::ALL.map(Aov::name).into_iter().chain([CRYPTOMATTE, FIRST_PASS]).collect()
}

/// Keeping what has no effect, beside capabilities that can be switched on.
pub(super) const PRUNING: &str = "pruning";

/// What can be switched on though a scene does not need it.
pub(super) fn specialised() -> Vec<&'static str> {
    Capabilities::forceable().iter().map(Capability::word).chain([PRUNING]).collect()
}

/// Any string; the words that make sense are shown in help and completed by shells. Wrong ones are left to the check of
/// the scene file, so that all problems are told at once and alike.
#[derive(Clone, Debug)]
struct Words(Vec<&'static str>);

impl Words {
    fn of<T: Copy>(all: &[T], word: impl Fn(T) -> &'static str) -> Self {
        Self(all.iter().map(|&value| word(value)).collect())
    }
}

impl TypedValueParser for Words {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.0.iter().copied().map(PossibleValue::new)))
    }
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
