//! Which instruction set to run kernels with: found once at start, or asked for by name.

use std::fmt;

#[cfg(target_arch = "x86_64")]
use super::{Avx2, Avx512};
use super::{Isa, Kernel, Portable, Scalar};

/// The environment variable that asks for an instruction set: `scalar`, `portable`, `avx2` or `avx512`. With `avx2` and
/// `portable` Embree is held to what such machines have, too.
pub const VARIABLE: &str = "SPECULA_ISA";

/// An instruction set this machine has. Hold one and run all kernels with it.
#[derive(Clone, Copy, Debug)]
pub enum Level {
    /// One lane.
    Scalar(Scalar),
    /// Arrays of eight, for what the compiler was told to build for.
    Portable(Portable<8>),
    /// Eight lanes of AVX2 with FMA.
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    /// Sixteen lanes of AVX-512.
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

/// Why a requested instruction set cannot be had.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LevelError {
    /// No instruction set has this name.
    Unknown(String),
    /// The machine lacks the instruction set of this name.
    Missing(String),
}

impl fmt::Display for LevelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(name) => write!(f, "unknown instruction set `{name}` (have: {})", NAMES.join(", ")),
            Self::Missing(name) => {
                let have: Vec<_> = Level::available().into_iter().map(Level::name).collect();
                write!(f, "this machine has no `{name}` (have: {})", have.join(", "))
            }
        }
    }
}

impl std::error::Error for LevelError {}

/// The names of all levels, slowest first.
const NAMES: [&str; 4] = ["scalar", "portable", "avx2", "avx512"];

impl Level {
    /// What this machine has, fastest last; never empty.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let mut levels = vec![Self::Scalar(Scalar), Self::Portable(Portable)];
        #[cfg(target_arch = "x86_64")]
        {
            levels.extend(Avx2::detect().map(Self::Avx2));
            levels.extend(Avx512::detect().map(Self::Avx512));
        }
        levels
    }

    /// The fastest this machine has.
    #[must_use]
    pub fn best() -> Self {
        Self::available().pop().unwrap_or(Self::Scalar(Scalar))
    }

    /// The level of that name.
    ///
    /// # Errors
    /// If there is no such level, or this machine lacks it.
    pub fn named(name: &str) -> Result<Self, LevelError> {
        if !NAMES.contains(&name) {
            return Err(LevelError::Unknown(name.to_owned()));
        }
        let found = Self::available().into_iter().find(|level| level.name() == name);
        found.ok_or_else(|| LevelError::Missing(name.to_owned()))
    }

    /// The level that the environment variable [`VARIABLE`] asks for, the fastest if it is unset or empty.
    ///
    /// # Errors
    /// If there is no such level, or this machine lacks it.
    pub fn from_env() -> Result<Self, LevelError> {
        match std::env::var_os(VARIABLE) {
            None => Ok(Self::best()),
            Some(name) if name.is_empty() => Ok(Self::best()),
            Some(name) => Self::named(&name.to_string_lossy()),
        }
    }

    /// The name, as the environment variable spells it.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.run(Describe).0
    }

    /// The number of lanes.
    #[must_use]
    pub fn width(self) -> usize {
        self.run(Describe).1
    }

    /// Runs a kernel compiled for this level.
    #[inline]
    pub fn run<K: AnyKernel>(self, kernel: K) -> K::Output {
        kernel.run_at(self)
    }
}

/// A kernel that runs at every level: all that implement [`Kernel`] for any [`Isa`] do.
pub trait AnyKernel {
    /// What the work gives.
    type Output;
    /// Does the work with the instruction set of `level`.
    fn run_at(self, level: Level) -> Self::Output;
}

/// `AnyKernel` for what is a kernel of every token: the variants of [`Level`], then their tokens.
macro_rules! any_kernel {
    ($($variant:ident),*; $first:ty, $($other:ty),*) => {
        impl<K> AnyKernel for K
        where
            K: Kernel<$first> $(+ Kernel<$other, Output = <K as Kernel<$first>>::Output>)*,
        {
            type Output = <K as Kernel<$first>>::Output;
            #[inline]
            fn run_at(self, level: Level) -> Self::Output {
                match level {
                    $(Level::$variant(isa) => isa.run(self),)*
                }
            }
        }
    };
}
#[cfg(target_arch = "x86_64")]
any_kernel!(Scalar, Portable, Avx2, Avx512; Scalar, Portable<8>, Avx2, Avx512);
#[cfg(not(target_arch = "x86_64"))]
any_kernel!(Scalar, Portable; Scalar, Portable<8>);

struct Describe;

impl<S: Isa> Kernel<S> for Describe {
    type Output = (&'static str, usize);
    #[inline(always)]
    fn run(self, _isa: S) -> Self::Output {
        (S::NAME, S::WIDTH)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_available_level_is_found_by_its_name() {
        for level in Level::available() {
            let found = Level::named(level.name()).map(Level::name);
            assert_eq!(found, Ok(level.name()), "{level:?}");
        }
    }

    #[test]
    fn an_unknown_name_is_an_error_that_lists_the_names() {
        let error = Level::named("mmx").map(Level::name).unwrap_err();
        let text = error.to_string();
        assert_eq!(text, "unknown instruction set `mmx` (have: scalar, portable, avx2, avx512)", "one line");
    }
}
