//! The command line as meant: checked, with defaults resolved.

mod batch;
mod bench;
mod cost;
mod diff;
mod farm;
mod files;
mod fuzzy;
mod merge;
mod render;
mod tradeoff;
mod trust;
mod values;

pub(super) use batch::BatchOptions;
pub(super) use bench::BenchOptions;
pub(super) use cost::Cost;
pub(super) use diff::DiffOptions;
pub(super) use farm::{FarmOptions, SlurmOptions};
pub(super) use files::{Output, check_target, try_out, with_extension};
pub(super) use fuzzy::FuzzyOptions;
pub(super) use merge::MergeOptions;
pub(super) use render::{
    Checkpoints, RenderOptions, check_first_pass, layout, overrides, planned, same_for_all,
};
pub(super) use tradeoff::{Against, TradeoffOptions};
pub(super) use trust::{Trusted, words as trust_words};
pub(super) use values::window;
