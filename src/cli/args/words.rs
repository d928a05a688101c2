//! Words that flags know, and what shows them in help and to shells.

use std::ffi::OsStr;

use clap::Arg;
use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};

use crate::film::Aov;
use crate::scene::needs::capability::{Capabilities, Capability};

/// All outputs that are mattes.
pub(in crate::cli) const CRYPTOMATTE: &str = "cryptomatte";

/// The output that is no mean of samples: what fuzzy reflections are filtered from.
pub(in crate::cli) const FIRST_PASS: &str = "gbuffer";

/// What `--aov` knows.
pub(in crate::cli) fn further_outputs() -> Vec<&'static str> {
    Aov::ALL.map(Aov::name).into_iter().chain([CRYPTOMATTE, FIRST_PASS]).collect()
}

/// Keeping what has no effect, beside capabilities that can be switched on.
pub(in crate::cli) const PRUNING: &str = "pruning";

/// What can be switched on though a scene does not need it.
pub(in crate::cli) fn specialised() -> Vec<&'static str> {
    Capabilities::forceable().iter().map(Capability::word).chain([PRUNING]).collect()
}

/// Any string; the words that make sense are shown in help and completed by shells. Wrong ones are left to the check of
/// the scene file, so that all problems are told at once and alike.
#[derive(Clone, Debug)]
pub(super) struct Words(pub(super) Vec<&'static str>);

impl Words {
    pub(super) fn of<T: Copy>(all: &[T], word: impl Fn(T) -> &'static str) -> Self {
        Self(all.iter().map(|&value| word(value)).collect())
    }
}

impl TypedValueParser for Words {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.0.iter().copied().map(PossibleValue::new)))
    }
}
