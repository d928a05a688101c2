//! What `diff` is to do.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use super::files::{Output, check_input, outputs, spare};
use super::trust;
use super::values::{given, threads};
use crate::cli::args::DiffArgs;
use crate::error::{Problems, Result};
use crate::measure::Metric;
use crate::measure::flip::Viewing;
use crate::trust::Limits;

/// What `diff` is to do.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct DiffOptions {
    pub(in crate::cli) test: PathBuf,
    pub(in crate::cli) reference: PathBuf,
    pub(in crate::cli) outputs: Vec<Output>,
    pub(in crate::cli) metric: Metric,
    /// Above it the check says no.
    pub(in crate::cli) max_error: Option<f64>,
    pub(in crate::cli) viewing: Viewing,
    /// What the pictures may ask for.
    pub(in crate::cli) limits: Limits,
    pub(in crate::cli) json: bool,
    pub(in crate::cli) threads: Option<NonZeroUsize>,
}

impl DiffOptions {
    /// What those words mean; all that is wrong with them at once.
    pub(in crate::cli) fn new(args: &DiffArgs) -> Result<Self> {
        let mut problems = Problems::default();
        let inputs = [&args.test, &args.reference];
        inputs.into_iter().for_each(|path| check_input(path, &mut problems));
        let outputs = outputs(args.output.clone(), &mut problems);
        outputs.iter().for_each(|output| spare(inputs, &output.path, &mut problems));
        let options = Self {
            test: args.test.clone(),
            reference: args.reference.clone(),
            outputs,
            metric: args
                .metric
                .as_deref()
                .and_then(|word| metric(word, &mut problems))
                .unwrap_or(Metric::RelMse),
            max_error: args.max_error.as_deref().and_then(|text| max_error(text, &mut problems)),
            viewing: args.ppd.as_deref().and_then(|text| viewing(text, &mut problems)).unwrap_or_default(),
            limits: trust::limits(&args.limits, &mut problems),
            json: args.json,
            threads: args.threads.as_deref().and_then(|text| threads(text, &mut problems)),
        };
        problems.into_result(options)
    }
}

fn metric(word: &str, problems: &mut Problems) -> Option<Metric> {
    let remedy = || format!("choose one of {}", Metric::ALL.map(Metric::word).join(", "));
    given(Metric::of(word), ("metric", word), "an error that is measured", remedy, problems)
}

fn max_error(text: &str, problems: &mut Problems) -> Option<f64> {
    let number = text.trim().parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
    given(number, ("max-error", text), "an error", || "give a number from 0 on".to_owned(), problems)
}

fn viewing(text: &str, problems: &mut Problems) -> Option<Viewing> {
    let number = text.trim().parse().ok().filter(|x| Viewing::RANGE.contains(x));
    let remedy = || format!("give a number from {} to {}", Viewing::RANGE.start(), Viewing::RANGE.end());
    given(number, ("ppd", text), "a number of pixels per degree", remedy, problems)
        .map(|pixels_per_degree| Viewing { pixels_per_degree })
}
