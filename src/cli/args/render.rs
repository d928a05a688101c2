//! The words of `render`.

use std::path::PathBuf;

use clap::ValueHint;

use super::words::{Words, further_outputs, specialised};
use super::{LogArgs, TrustArgs};
use crate::scene::description::{Backend, Fresnel, FuzzyBy, Integrator, LightChoice, Query, Sampler, View};
use crate::tradeoff::presets::Preset;

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
    /// Scene, files, flags and version must be the same, as must the instruction set. Of several frames (--frames), those whose .exr or .part
    /// files say that they are what is asked for are left out.
    #[arg(long)]
    pub resume: bool,

    /// Another seed gives another, equally valid noise
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub seed: Option<String>,

    /// Threads to use; as many as there are processors if not given
    #[arg(short, long, value_name = "N", allow_negative_numbers = true)]
    pub threads: Option<String>,

    /// Store colour, coverage and normals in EXR files as 16-bit floats; other outputs keep all digits
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
