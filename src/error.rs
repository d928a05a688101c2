//! Errors and places in files.
//!
//! What can go wrong outside the inner loops is a value of [`Error`]. Problems with input are collected, all of a file at
//! once, and each names its place and a remedy.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A place in a text that a user wrote.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Place {
    /// The file as the user named it, or a word such as `command line`.
    pub file: Arc<Path>,
    /// Line, from 1; absent where only the file is known.
    pub line: Option<u32>,
    /// Column in characters, from 1; absent where only the line is known.
    pub column: Option<u32>,
}

impl Place {
    /// Somewhere in a file.
    pub fn file(file: impl AsRef<Path>) -> Self {
        Self { file: file.as_ref().into(), line: None, column: None }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if let Some(column) = self.column {
            write!(f, ":{column}")?;
        }
        Ok(())
    }
}

/// One thing wrong with an input: shown as `place: what; remedy`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Where.
    pub place: Option<Place>,
    /// What is wrong, in lower case, without a full stop.
    pub what: String,
    /// What to do about it.
    pub remedy: Option<String>,
}

impl Problem {
    /// A problem at a place.
    pub fn at(place: Place, what: impl Into<String>) -> Self {
        Self { place: Some(place), what: what.into(), remedy: None }
    }

    /// A problem without a place in a file.
    pub fn new(what: impl Into<String>) -> Self {
        Self { place: None, what: what.into(), remedy: None }
    }

    /// The same problem with a remedy.
    #[must_use]
    pub fn remedy(self, remedy: impl Into<String>) -> Self {
        Self { remedy: Some(remedy.into()), ..self }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        f.write_str(&self.what)?;
        if let Some(remedy) = &self.remedy {
            write!(f, "; {remedy}")?;
        }
        Ok(())
    }
}

/// Everything wrong with an input, at least one thing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problems(pub Vec<Problem>);

impl Problems {
    /// Adds a problem.
    pub fn push(&mut self, problem: Problem) {
        self.0.push(problem);
    }

    /// Adds the problems that an error holds; an error of another kind is one problem at `place`.
    pub fn absorb(&mut self, error: Error, place: Option<&Place>) {
        match error {
            Error::Input(more) => self.0.extend(more.0),
            Error::Refused(problem) => self.push(problem),
            other => self.push(Problem { place: place.cloned(), ..Problem::new(other.to_string()) }),
        }
    }

    /// `value` if nothing was wrong, else all that was.
    pub fn into_result<T>(self, value: T) -> Result<T> {
        if self.0.is_empty() { Ok(value) } else { Err(Error::Input(self)) }
    }
}

impl From<Problem> for Problems {
    fn from(problem: Problem) -> Self {
        Self(vec![problem])
    }
}

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.0.iter().enumerate() {
            let line_break = if i == 0 { "" } else { "\n" };
            write!(f, "{line_break}{problem}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Problems {}

/// What stops a command.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The command line or an input is wrong.
    #[error(transparent)]
    Input(#[from] Problems),
    /// An input asks for more than is allowed, or lies where it must not: right or wrong, it is not read.
    #[error("{0}")]
    Refused(Problem),
    /// Reading or writing failed.
    #[error("{}: {what}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried.
        what: &'static str,
        /// Why it failed.
        source: std::io::Error,
    },
    /// A backend gave up.
    #[error("{backend}: {what}")]
    Backend {
        /// Which.
        backend: &'static str,
        /// What it said.
        what: String,
    },
    /// Some pictures of many could not be made; why was told.
    #[error("{failed} of {of} pictures failed")]
    Failed {
        /// How many.
        failed: usize,
        /// Of how many.
        of: usize,
    },
    /// Somebody asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// A check said no: all that it found, in words.
    #[error("{}", .0.join("\n"))]
    Check(Vec<String>),
}

impl From<Problem> for Error {
    fn from(problem: Problem) -> Self {
        Self::Input(problem.into())
    }
}

/// A value, or what stopped the command.
pub type Result<T> = std::result::Result<T, Error>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_name_place_and_remedy() {
        let problem =
            Problem::at(Place::file("x.toml"), "unknown material `glas`").remedy("did you mean `glass`?");
        assert_eq!(problem.to_string(), "x.toml: unknown material `glas`; did you mean `glass`?", "shown");
    }
}
