//! What files may ask for.

use crate::error::{Place, Problem};
use std::fmt;

/// Something that files may ask for only so much of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Limit {
    /// Pixels of the picture to render, whatever is cropped: 5e8, whose sums take 40 GB.
    Pixels,
    /// Samples of all pixels together: no limit, since time is not taken from others; `--time-limit` ends a picture.
    Samples,
    /// Triangles of all meshes and height fields of a scene, instances not counted: 2e9, which take 200 GB and more.
    Triangles,
    /// Pixels of each picture that is read, be it a texture, an environment, heights, or one to be compared: 1e9, which take up to 16 GB.
    Texels,
    /// Texels of all textures of a scene together: 1e10, which take 40 to 160 GB.
    Textures,
    /// Bytes of each file: 1e11.
    Bytes,
    /// Bytes of all scene files (TOML) of a scene together: 5e8, whose tree takes some hundred times as much.
    SceneBytes,
    /// Scene files of a scene, and likewise other files that it is read from: 1e6.
    Files,
    /// How deep scene files may include each other: 32.
    IncludeDepth,
    /// How deep tables and lists of a scene file may stand in each other, and how many instances may follow one another: 64. Far more
    /// would take more stack than there is.
    Nesting,
}

impl Limit {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Pixels,
        Self::Samples,
        Self::Triangles,
        Self::Texels,
        Self::Textures,
        Self::Bytes,
        Self::SceneBytes,
        Self::Files,
        Self::IncludeDepth,
        Self::Nesting,
    ];

    /// Its name on the command line.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Pixels => "pixels",
            Self::Samples => "samples",
            Self::Triangles => "triangles",
            Self::Texels => "texels",
            Self::Textures => "textures",
            Self::Bytes => "bytes",
            Self::SceneBytes => "scene_bytes",
            Self::Files => "files",
            Self::IncludeDepth => "include_depth",
            Self::Nesting => "nesting",
        }
    }

    /// How much is allowed where nobody says: more than real work asks for, and no more than a large machine has.
    #[must_use]
    pub const fn default_most(self) -> Option<u64> {
        match self {
            Self::Pixels => Some(500_000_000),
            Self::Samples => None,
            Self::Triangles => Some(2_000_000_000),
            Self::Texels => Some(1_000_000_000),
            Self::Textures => Some(10_000_000_000),
            Self::Bytes => Some(100_000_000_000),
            Self::SceneBytes => Some(500_000_000),
            Self::Files => Some(1_000_000),
            Self::IncludeDepth => Some(32),
            Self::Nesting => Some(64),
        }
    }

    /// What is counted.
    const fn unit(self) -> &'static str {
        match self {
            Self::Pixels => "pixels",
            Self::Samples => "samples in all",
            Self::Triangles => "triangles in all",
            Self::Texels => "texels",
            Self::Textures => "texels in all",
            Self::Bytes => "bytes",
            Self::SceneBytes => "bytes of scene files",
            Self::Files => "files",
            Self::IncludeDepth => "files that include each other",
            Self::Nesting => "levels",
        }
    }
}

/// How much files may ask for, of each kind; `None` is as much as they like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits([Option<u64>; Limit::ALL.len()]);

impl Default for Limits {
    fn default() -> Self {
        Self(Limit::ALL.map(Limit::default_most))
    }
}

impl Limits {
    /// As much as they like of everything.
    #[must_use]
    pub const fn none() -> Self {
        Self([None; Limit::ALL.len()])
    }

    /// The same with another limit of one kind.
    #[must_use]
    pub const fn with(mut self, limit: Limit, most: Option<u64>) -> Self {
        self.0[limit as usize] = most;
        self
    }

    /// How much is allowed.
    #[must_use]
    pub const fn most(&self, limit: Limit) -> Option<u64> {
        self.0[limit as usize]
    }

    /// Whether `found` is allowed.
    pub const fn check(&self, limit: Limit, found: u64) -> Result<(), Excess> {
        match self.most(limit) {
            Some(most) if found > most => Err(Excess { limit, found, most }),
            _ => Ok(()),
        }
    }
}

/// That something is more than is allowed. Shown in words that a sentence may begin or end with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Excess {
    /// Of what.
    pub limit: Limit,
    /// How much there is.
    pub found: u64,
    /// How much is allowed.
    pub most: u64,
}

impl fmt::Display for Excess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { limit, found, most } = self;
        write!(f, "{found} {}, and {most} are allowed", limit.unit())
    }
}

impl Excess {
    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> String {
        let Self { limit, found, .. } = self;
        format!("if that is meant, allow more by `--limits {}={}`", limit.word(), rounded_up(*found))
    }

    /// The same as a problem at a place.
    #[must_use]
    pub fn at(&self, place: Place) -> Problem {
        Problem::at(place, self.to_string()).remedy(self.remedy())
    }
}

/// A number that is short to write, and no less than `x`.
fn rounded_up(x: u64) -> String {
    if x < 10_000 {
        return x.to_string();
    }
    let zeros = x.ilog10() - 1;
    let digits = x.div_ceil(10_u64.pow(zeros));
    match digits {
        _ if digits.is_multiple_of(10) => format!("{}e{}", digits / 10, zeros + 1),
        _ => format!("{}.{}e{}", digits / 10, digits % 10, zeros + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_where_their_kinds_are() {
        for (i, limit) in Limit::ALL.into_iter().enumerate() {
            assert_eq!(limit as usize, i, "{limit:?}");
            let limits = Limits::none().with(limit, Some(7));
            assert_eq!(limits.check(limit, 7), Ok(()), "{limit:?}");
            assert_eq!(limits.check(limit, 8), Err(Excess { limit, found: 8, most: 7 }), "{limit:?}");
            assert_eq!(Limits::none().check(limit, u64::MAX), Ok(()), "{limit:?}");
            assert_eq!(Limits::default().most(limit), limit.default_most(), "{limit:?}");
        }
    }

    #[test]
    fn numbers_to_allow_are_short_and_enough() {
        for (x, text) in [
            (9999, "9999"),
            (10_000, "1e4"),
            (10_001, "1.1e4"),
            (4_900_000_000, "4.9e9"),
            (4_900_000_001, "5e9"),
            (9_900_000_001, "10e9"),
            (u64::MAX, "1.9e19"),
        ] {
            assert_eq!(rounded_up(x), text, "{x}");
        }
        let excess = Excess { limit: Limit::Texels, found: 4_900_000_000, most: 1_000_000_000 };
        assert_eq!(excess.to_string(), "4900000000 texels, and 1000000000 are allowed", "what");
        assert_eq!(excess.remedy(), "if that is meant, allow more by `--limits texels=4.9e9`", "remedy");
    }
}
