//! The words of `schema`, `completions` and `man`.

use std::path::PathBuf;

use clap::{ValueEnum, ValueHint};
use clap_complete::Shell;

/// The file to describe.
#[derive(Clone, Debug, clap::Args)]
pub struct SchemaArgs {
    /// What kind of file
    #[arg(value_name = "FILE", default_value = "scene")]
    pub of: SchemaOf,
}

/// A kind of file that users write.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SchemaOf {
    /// A scene
    Scene,
    /// Jobs for `specula batch`
    Batch,
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
