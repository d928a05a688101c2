//! How hierarchies are built.

use obvhs::BvhBuildParams;

/// How much work goes into a hierarchy; slower builds are traced faster. The presets of obvhs: clustering by PLOC, then
/// reinsertion of nodes (Meister, Bittner 2022, Performance Comparison of Bounding Volume Hierarchies).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// Clusters of nearest neighbours, leaves of one primitive.
    Fastest,
    /// As `Fastest`, with one per cent of the nodes reinserted and larger leaves.
    VeryFast,
    /// Looks farther for neighbours, two per cent reinserted.
    Fast,
    /// Looks farther still, five per cent reinserted.
    #[default]
    Medium,
    /// Splits large triangles beforehand; a fifth reinserted.
    Slow,
    /// As `Slow`, with all nodes reinserted.
    VerySlow,
}

impl Preset {
    /// All of them, fastest first.
    pub const ALL: [Self; 6] =
        [Self::Fastest, Self::VeryFast, Self::Fast, Self::Medium, Self::Slow, Self::VerySlow];

    pub(super) fn params(self) -> BvhBuildParams {
        match self {
            Self::Fastest => BvhBuildParams::fastest_build(),
            Self::VeryFast => BvhBuildParams::very_fast_build(),
            Self::Fast => BvhBuildParams::fast_build(),
            Self::Medium => BvhBuildParams::medium_build(),
            Self::Slow => BvhBuildParams::slow_build(),
            Self::VerySlow => BvhBuildParams::very_slow_build(),
        }
    }
}

/// Everything that can be chosen about a hierarchy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How much work goes into it.
    pub preset: Preset,
    /// How far boxes are padded, in parts of what rounding calls for. Less loses hits, which is what experiments want.
    pub padding: f32,
}

impl Default for Options {
    fn default() -> Self {
        Self { preset: Preset::default(), padding: 1.0 }
    }
}
