//! The words of `batch`.

use std::path::PathBuf;

use clap::ValueHint;

use super::{LogArgs, TrustArgs};

/// Which pictures to render, and how many at a time.
#[derive(Clone, Debug, clap::Args)]
pub struct BatchArgs {
    /// Batch files (TOML with jobs), or scene files, each of which is a job
    ///
    /// `specula schema batch` has all keys of a batch file. Files in it are as seen from its folder.
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath, required = true)]
    pub files: Vec<PathBuf>,

    /// Frames of all jobs: N, A..B (both ends are rendered), A..BxSTEP, or several with commas between
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    pub frames: Option<String>,

    /// Outputs of all jobs; {name} is the name of the job, #### and {frame} the number of the frame. May be given several times
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub output: Vec<PathBuf>,

    /// Set any value of all scene files by its dotted path, such as render.spp=4, files as seen from here. May be given several times
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,

    /// Pictures to render side by side, each on its part of the threads [default: 1]
    #[arg(short, long, value_name = "N", allow_negative_numbers = true)]
    pub jobs: Option<String>,

    /// Memory to be used, such as 8G or 500M: pictures wait, or run alone, where their estimates exceed it
    ///
    /// Without it nothing waits, and what was read of files is kept up to half of the memory that is free.
    #[arg(long, value_name = "BYTES", allow_negative_numbers = true)]
    pub memory: Option<String>,

    /// Keep copies of pictures under way in files beside their outputs (.ckpt), from which the next run goes on; no more than this time is
    /// lost, such as 30s, 5m or 1h
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    pub checkpoint_every: Option<String>,

    /// Render what is done already, too
    #[arg(long)]
    pub force: bool,

    /// Tell what would be rendered, and why, without rendering
    #[arg(long)]
    pub dry_run: bool,

    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,

    /// Threads to use in all; as many as there are processors if not given
    #[arg(short, long, value_name = "N", allow_negative_numbers = true)]
    pub threads: Option<String>,

    /// How far files are trusted.
    #[command(flatten)]
    pub trust: TrustArgs,

    /// What is told on standard error.
    #[command(flatten)]
    pub log: LogArgs,
}
