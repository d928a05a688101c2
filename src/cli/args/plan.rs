//! The words of `plan`.

use std::path::PathBuf;

use clap::ValueHint;

use super::words::{Words, further_outputs, specialised};
use super::{LogArgs, TrustArgs};
use crate::scene::description::Backend;

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
