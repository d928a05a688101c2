//! The command `diff`.

use std::path::Path;

use super::args::DiffArgs;
use super::interrupt::Interrupt;
use super::options::{DiffOptions, Output};
use super::progress::Meter;
use super::report::Report;
use super::{log, output, threads};
use crate::error::{Error, Problem, Problems, Result};
use crate::image::{self, Decoded, Format, exr, png};
use crate::math::lanes::{Level, VARIABLE};
use crate::measure::flip::Watch;
use crate::measure::{Comparison, Pair, difference};
use crate::trust::Trust;

/// Compares two pictures, prints how far they are apart, and says no where that is too far.
pub(super) fn run(args: &DiffArgs) -> Result<()> {
    log::start(&args.log);
    let interrupt = Interrupt::listen();
    let options = DiffOptions::new(args)?;
    threads::limit(options.threads);
    let level = Level::from_env().map_err(|error| Problem::new(format!("{VARIABLE}: {error}")))?;
    if args.metric.is_some() && options.max_error.is_none() {
        tracing::warn!("`--metric` says what `--max-error` is about; without that, all errors are told");
    }

    tracing::debug!("reading {} and {}", options.test.display(), options.reference.display());
    let pair = read(&options)?;
    interrupt.check()?;

    let meter = Meter::new(args.log.quiet, "pixels", interrupt.clone());
    let comparison = Comparison::of(&pair, options.viewing, Watch { level, progress: &meter });
    meter.finish();
    let comparison = comparison?;
    interrupt.check()?;

    let report = Report { options: &options, pair: &pair, comparison: &comparison };
    write(&report)?;
    let text = if options.json { format!("{:#}\n", report.json()) } else { report.table() };
    output::print(text.as_bytes())?;
    match report.findings() {
        findings if findings.is_empty() => Ok(()),
        findings => Err(Error::Check(findings)),
    }
}

/// Both pictures; all that is wrong with either at once.
fn read(options: &DiffOptions) -> Result<Pair> {
    let (test, reference) = match both(options) {
        (Ok(test), Ok(reference)) => (test, reference),
        (Err(Error::Input(mut problems)), Err(Error::Input(more))) => {
            problems.0.extend(more.0);
            return Err(unique(problems).into());
        }
        (Err(error), _) | (_, Err(error)) => return Err(error),
    };
    [&test, &reference].into_iter().for_each(|picture| log::warn(&picture.warnings));
    let names = [&options.test, &options.reference].map(|path| path.display().to_string());
    Pair::new(test, reference, [&names[0], &names[1]])
}

fn both(options: &DiffOptions) -> (Result<Decoded>, Result<Decoded>) {
    let trust = Trust { limits: options.limits, sandbox: None };
    let read = |path: &Path| image::read_as_stored(path, &trust);
    rayon::join(|| read(&options.test), || read(&options.reference))
}

/// Each problem once: somebody may compare a broken file with itself.
fn unique(mut problems: Problems) -> Problems {
    problems.0.dedup();
    problems
}

/// Writes the pictures of the difference.
fn write(report: &Report<'_>) -> Result<()> {
    let Report { options, pair, comparison } = report;
    for Output { path, format } in &options.outputs {
        match format {
            Format::Exr => {
                let picture = difference::picture(pair, comparison, report.attributes());
                log::warn(&exr::write(path, picture)?);
            }
            Format::Png => {
                let size = [pair.test().width(), pair.test().height()];
                png::write_bytes(path, size, &difference::colours(comparison))?;
            }
        }
        tracing::info!("wrote {}", path.display());
    }
    Ok(())
}
