//! What `batch` is to do.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

use super::trust::Trusted;
use super::values::{MOST_THREADS, frames, given, threads, time, whole, with_unit};
use crate::cli::args::BatchArgs;
use crate::error::{Problems, Result};
use crate::scene::description::Frames;

/// What `batch` is to do.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct BatchOptions {
    pub(in crate::cli) files: Vec<PathBuf>,
    /// In place of those of jobs.
    pub(in crate::cli) frames: Option<Frames>,
    pub(in crate::cli) outputs: Vec<PathBuf>,
    /// After those of jobs.
    pub(in crate::cli) overrides: Vec<String>,
    /// Pictures side by side.
    pub(in crate::cli) jobs: NonZeroUsize,
    /// Bytes.
    pub(in crate::cli) memory: Option<u64>,
    pub(in crate::cli) checkpoint_every: Option<Duration>,
    pub(in crate::cli) force: bool,
    pub(in crate::cli) dry_run: bool,
    pub(in crate::cli) json: bool,
    pub(in crate::cli) threads: Option<NonZeroUsize>,
    /// How far the files of scenes are trusted.
    pub(in crate::cli) trusted: Trusted,
}

impl BatchOptions {
    /// What those words mean; all that is wrong with them at once.
    pub(in crate::cli) fn new(args: &BatchArgs) -> Result<Self> {
        let mut problems = Problems::default();
        let every = args.checkpoint_every.as_deref();
        let options = Self {
            files: args.files.clone(),
            frames: args.frames.as_deref().and_then(|text| frames(text, &mut problems)),
            outputs: args.output.clone(),
            overrides: args.overrides.clone(),
            jobs: args
                .jobs
                .as_deref()
                .and_then(|text| whole("jobs", text, 1..=MOST_THREADS, &mut problems))
                .and_then(NonZeroUsize::new)
                .unwrap_or(NonZeroUsize::MIN),
            memory: args.memory.as_deref().and_then(|text| memory(text, &mut problems)),
            checkpoint_every: every.and_then(|text| time("checkpoint-every", text, &mut problems)),
            force: args.force,
            dry_run: args.dry_run,
            json: args.json,
            threads: args.threads.as_deref().and_then(|text| threads(text, &mut problems)),
            trusted: Trusted::new(&args.trust, &mut problems),
        };
        problems.into_result(options)
    }
}

/// Bytes with their unit, by powers of 1024.
fn memory(text: &str, problems: &mut Problems) -> Option<u64> {
    const K: f64 = 1024.0;
    let letters = [("K", K), ("M", K * K), ("G", K * K * K), ("T", K * K * K * K)];
    let spelled =
        |(letter, factor): (&str, f64)| ["IB", "B", ""].map(|end| (format!("{letter}{end}"), factor));
    let spelled: Vec<(String, f64)> = letters.into_iter().flat_map(spelled).collect();
    let units = spelled.iter().map(|(unit, factor)| (unit.as_str(), *factor)).chain([("B", 1.0)]);
    let bytes = with_unit(&text.to_ascii_uppercase(), &units.collect::<Vec<_>>());
    let bytes = bytes.filter(|bytes| *bytes < 2_f64.powi(60));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 2^60")]
    let bytes = bytes.map(|bytes| bytes as u64);
    let remedy = || "give a number of bytes above 0, or with its unit: 500M, 8G".to_owned();
    given(bytes, ("memory", text), "a size", remedy, problems)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        let parse = |text| memory(text, &mut Problems::default());
        for (text, bytes) in [
            ("1000", 1000),
            ("8G", 8 << 30),
            ("500M", 500 << 20),
            ("1.5GiB", 3 << 29),
            ("2 kB", 2048),
            ("1t", 1 << 40),
            ("100 b", 100),
        ] {
            assert_eq!(parse(text), Some(bytes), "{text}");
        }
        for text in ["", "G", "0", "-1G", "8X", "8Gbb", "5i", "8iB", "nan", "inf", "1e30"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
