//! What `fuzzy` is to do.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use super::files::{Output, check_input, outputs, spare, with_extension};
use super::trust::limits;
use super::values::{on_command_line, threads};
use crate::cli::args::FuzzyArgs;
use crate::error::{Problems, Result};
use crate::post::exponent_of_roughness;
use crate::trust::Limits;

/// What `fuzzy` is to do.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct FuzzyOptions {
    pub(in crate::cli) gbuffer: PathBuf,
    pub(in crate::cli) outputs: Vec<Output>,
    /// The exponent of all reflectors, instead of their own.
    pub(in crate::cli) exponent: Option<f32>,
    /// Knobs of the filter, `key=value`.
    pub(in crate::cli) settings: Vec<String>,
    pub(in crate::cli) threads: Option<NonZeroUsize>,
    /// What the first pass may ask for.
    pub(in crate::cli) limits: Limits,
}

impl FuzzyOptions {
    /// What those words mean; all that is wrong with them at once.
    pub(in crate::cli) fn new(args: &FuzzyArgs) -> Result<Self> {
        let mut problems = Problems::default();
        check_input(&args.gbuffer, &mut problems);
        let paths = if args.output.is_empty() {
            let mut stem = args.gbuffer.file_stem().unwrap_or("picture".as_ref()).to_owned();
            stem.push("_fuzzy");
            ["exr", "png"].map(|extension| with_extension(stem.as_ref(), extension)).to_vec()
        } else {
            args.output.clone()
        };
        let outputs = outputs(paths, &mut problems);
        outputs.iter().for_each(|output| spare([&args.gbuffer], &output.path, &mut problems));
        let roughness = number(args.roughness.as_deref(), ("roughness", 1.0), &mut problems);
        let exponent = number(args.exponent.as_deref(), ("exponent", 1e9), &mut problems);
        let options = Self {
            gbuffer: args.gbuffer.clone(),
            outputs,
            exponent: exponent.or(roughness.map(exponent_of_roughness)),
            settings: settings(args),
            threads: args.threads.as_deref().and_then(|text| threads(text, &mut problems)),
            limits: limits(&args.limits, &mut problems),
        };
        problems.into_result(options)
    }
}

/// A number from 0 to `most`.
fn number(text: Option<&str>, (flag, most): (&str, f32), problems: &mut Problems) -> Option<f32> {
    let text = text?;
    let number = text.trim().parse().ok().filter(|x| (0.0..=most).contains(x));
    if number.is_none() {
        let what = format!("`--{flag} {text}` is not a number from 0 to {most}");
        problems.push(
            on_command_line(what).remedy("0 to 1 is from a mirror to 10 degrees; exponents go the other way"),
        );
    }
    number
}

/// Flags as keys of the table `render.fuzzy` of scene files.
fn settings(args: &FuzzyArgs) -> Vec<String> {
    let keys = [
        ("weighting", &args.weighting),
        ("strength", &args.strength),
        ("lost_mass", &args.lost_mass),
        ("max_angle_deg", &args.max_angle),
        ("max_radius", &args.max_radius),
        ("radius", &args.radius),
        ("window", &args.window),
        ("correction", &args.correction),
        ("skip", &args.skip),
        ("rejection", &args.rejection),
        ("table", &args.table),
        ("taps", &args.taps),
        ("pyramid", &args.pyramid),
        ("half", &args.half),
    ];
    keys.iter().filter_map(|(key, value)| Some(format!("{key}={}", value.as_ref()?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use clap::Parser as _;

    fn options(words: &[&str]) -> Result<FuzzyOptions> {
        let words = ["specula", "fuzzy"].iter().chain(words);
        let crate::cli::Command::Fuzzy(args) =
            crate::cli::Args::try_parse_from(words).expect("words").command
        else {
            panic!("another command")
        };
        FuzzyOptions::new(&args)
    }

    #[test]
    fn roughness_becomes_an_exponent_and_knobs_become_keys() {
        let knobs = ["--taps", "9", "--half", "off", "--skip", "false", "--rejection", "angle"];
        let found = options(&[&["Cargo.toml", "--roughness", "1"], &knobs[..]].concat()).expect("valid");
        assert!((found.exponent.expect("given") - 300.0).abs() < 1.0, "{found:?}");
        assert_eq!(found.settings, ["skip=false", "rejection=angle", "taps=9", "half=off"], "keys");
        assert_eq!(found.outputs[0].path.to_str(), Some("Cargo_fuzzy.exr"), "name");
    }

    #[test]
    fn all_problems_are_told_at_once() {
        let error =
            options(&["nothing.exr", "--exponent", "-3", "-o", "a.jpg", "-t", "0"]).expect_err("wrong");
        let Error::Input(problems) = error else { panic!("{error}") };
        assert_eq!(problems.0.len(), 4, "{problems}");
    }
}
