//! What `merge` is to do.

use std::path::PathBuf;

use super::files::{Output, check_target, is_same, outputs, spare, twice};
use super::trust::limits;
use super::values::crop;
use crate::cli::args::MergeArgs;
use crate::error::{Problems, Result};
use crate::film::Precision;
use crate::image::Window;
use crate::trust::Limits;

/// What `merge` is to do.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct MergeOptions {
    pub(in crate::cli) parts: Vec<PathBuf>,
    pub(in crate::cli) outputs: Vec<Output>,
    pub(in crate::cli) crop: Option<Window>,
    pub(in crate::cli) precision: Precision,
    pub(in crate::cli) stats: Option<PathBuf>,
    /// What the parts may ask for.
    pub(in crate::cli) limits: Limits,
}

impl MergeOptions {
    /// What those words mean; all that is wrong with them at once.
    pub(in crate::cli) fn new(args: &MergeArgs) -> Result<Self> {
        let mut problems = Problems::default();
        let outputs = outputs(args.output.clone(), &mut problems);
        if let Some(path) = &args.stats {
            check_target(path, &mut problems);
            if outputs.iter().any(|output| is_same(&output.path, path)) {
                problems.push(twice(path));
            }
        }
        for path in outputs.iter().map(|output| &output.path).chain(&args.stats) {
            spare(&args.parts, path, &mut problems);
        }
        let options = Self {
            parts: args.parts.clone(),
            outputs,
            crop: args.crop.as_deref().and_then(|text| crop(text, &mut problems)),
            precision: if args.half { Precision::Half } else { Precision::Float },
            stats: args.stats.clone(),
            limits: limits(&args.limits, &mut problems),
        };
        problems.into_result(options)
    }
}
