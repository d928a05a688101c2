//! When a picture is done, besides having all samples.

use std::time::Duration;

/// What ends a picture before it has all samples; without any of these it has them all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// How long building and tracing may take by the clock. One sample of each pixel is taken in any case.
    pub time: Option<Duration>,
    /// The relMSE that is good enough, as `specula diff` measures it against an endless picture: the picture ends when it is below with a
    /// probability of 95 %, by an estimate from its own samples. Tiles then get as many samples each as it takes.
    pub error: Option<f64>,
    /// Whether the error of other pictures is estimated, too; that of one which the error is to end is in any case. The picture is
    /// compared with what it was before: after a half of its samples, or, where time counts, after a third to three quarters or so.
    ///
    /// There is no estimate where there was no such picture: without a limit of time, below 32 samples, of a number of samples that is no
    /// multiple of 16, and of later slices, all of which are taken in one pass; with one, of pictures of one pass; after a resume, unless a
    /// quarter of all samples or more come after the first pass from then on; and of pictures whose reflections are filtered.
    pub is_estimated: bool,
}

impl Limits {
    /// Whether there is any.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.time.is_none() && self.error.is_none()
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
    /// The error is below its target.
    Error,
}

/// How far a picture is from an endless one: relMSE, estimated from its own samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// What is to be expected.
    pub error: f64,
    /// What the true error is below of with a probability of 95 %.
    pub bound: f64,
}

impl Ended {
    /// The word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::Time => "time",
            Self::Error => "error",
        }
    }
}
