//! Words that several commands know.

use clap::ValueEnum;

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
