//! When a picture is done, besides having all samples.

use std::time::Duration;

/// What ends a picture before it has all samples. Without any of these it is made in one go.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// How long building and tracing may take by the clock. One sample of each pixel is taken in any case.
    pub time: Option<Duration>,
}

impl Limits {
    /// Whether there is any.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.time.is_none()
    }
}

/// What ended a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ended {
    /// All pixels have all their samples.
    #[default]
    Samples,
    /// The time was over.
    Time,
}

impl Ended {
    /// The word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::Time => "time",
        }
    }
}
