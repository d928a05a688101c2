//! Everything wrong with the files of a scene, collected.

use crate::error::{Problem, Problems, Result};
use crate::scene::load::source::Spot;

/// Problems in the order they were found, with what sorts them.
#[derive(Debug, Default)]
pub(crate) struct Report {
    errors: Vec<((usize, usize), Problem)>,
}

impl Report {
    /// Adds what is wrong at a spot, and what to do about it.
    pub(crate) fn error(&mut self, spot: &Spot, what: impl Into<String>, remedy: impl Into<String>) {
        self.add(spot, told(spot, what).remedy(remedy));
    }

    /// Adds what is wrong at a spot.
    pub(crate) fn error_without_remedy(&mut self, spot: &Spot, what: impl Into<String>) {
        self.add(spot, told(spot, what));
    }

    /// Whether so much is wrong that words need not be sought that were meant.
    pub(crate) fn is_long(&self) -> bool {
        self.errors.len() > 1000
    }

    fn add(&mut self, spot: &Spot, problem: Problem) {
        self.errors.push((spot.order(), problem));
    }

    /// `value` if nothing was wrong, else everything that was, from top to bottom of each file.
    pub(crate) fn into_result<T>(mut self, value: Option<T>) -> Result<T> {
        self.errors.sort_by_key(|(order, _)| *order);
        let problems = Problems(self.errors.into_iter().map(|(_, problem)| problem).collect());
        match value {
            Some(value) => problems.into_result(value),
            None => Err(problems.into()),
        }
    }
}

/// What there is to tell of a spot; of an override with its text.
pub(crate) fn told(spot: &Spot, what: impl Into<String>) -> Problem {
    let what = what.into();
    let what = match spot.source.as_override() {
        Some(text) => format!("in `{text}`: {what}"),
        None => what,
    };
    Problem::at(spot.place(), what)
}
