//! The list of channels that a film keeps.
//!
//! To add one: a variant, its line in [`Aov::ALL`] and in [`Aov::channels`], and somebody who fills it.

/// What is kept of the samples. An arbitrary output variable, in the words of the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Aov {
    /// Radiance towards the camera, W/(sr m^2).
    Beauty,
    /// The part of the pixel that shows anything but what lies infinitely far away, in [0, 1].
    Alpha,
    /// The part of white light that what is seen sends back, in [0, 1].
    Albedo,
    /// Shading normal of what is seen, in the world.
    Normal,
    /// Geometric normal of the first surface, in the world.
    GeometricNormal,
    /// Distance from the eye in metres: the mean over what the pixel sees, 0 where that is nothing.
    Depth,
    /// Place of the first surface in metres: the mean over what the pixel sees.
    Position,
    /// Surface parameters of the first surface: the mean over what the pixel sees.
    Uv,
    /// Variance of the pixel's radiance, as far as samples are independent: of better samples it is an upper bound.
    Variance,
    /// How many samples the pixel has.
    Samples,
}

impl Aov {
    /// All there are.
    pub const ALL: [Self; 10] = [
        Self::Beauty,
        Self::Alpha,
        Self::Albedo,
        Self::Normal,
        Self::GeometricNormal,
        Self::Depth,
        Self::Position,
        Self::Uv,
        Self::Variance,
        Self::Samples,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Beauty => "beauty",
            Self::Alpha => "alpha",
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::GeometricNormal => "geometric_normal",
            Self::Depth => "depth",
            Self::Position => "position",
            Self::Uv => "uv",
            Self::Variance => "variance",
            Self::Samples => "samples",
        }
    }

    /// The names of its channels in an EXR file.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Beauty => &["R", "G", "B"],
            Self::Alpha => &["A"],
            Self::Albedo => &["albedo.R", "albedo.G", "albedo.B"],
            Self::Normal => &["N.X", "N.Y", "N.Z"],
            Self::GeometricNormal => &["Ng.X", "Ng.Y", "Ng.Z"],
            Self::Depth => &["Z"],
            Self::Position => &["P.X", "P.Y", "P.Z"],
            Self::Uv => &["uv.U", "uv.V"],
            Self::Variance => &["variance.R", "variance.G", "variance.B"],
            Self::Samples => &["samples"],
        }
    }

    /// How many values each sample brings; those of the others are made of the pixel's sums.
    pub fn len(self) -> usize {
        if matches!(self, Self::Variance | Self::Samples) { 0 } else { self.channels().len() }
    }

    /// Whether samples bring nothing for it.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Whether its pixels are limited to [0, 1]: a filter with negative parts would overshoot.
    pub fn is_fraction(self) -> bool {
        matches!(self, Self::Alpha | Self::Albedo)
    }

    /// Whether it is of surfaces and nothing but that: unfiltered, and a mean over the samples that hit one.
    pub fn is_of_hits(self) -> bool {
        matches!(self, Self::Depth | Self::Position | Self::Uv)
    }

    /// Whether it is of what camera rays see, and not of light.
    pub fn is_feature(self) -> bool {
        matches!(self, Self::Albedo | Self::Normal | Self::GeometricNormal) || self.is_of_hits()
    }
}

/// Which outputs a film keeps, and where the values of each stand in a sample.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    aovs: Vec<Aov>,
}

impl Layout {
    /// The picture and its coverage, then those outputs, each once, in that order.
    pub fn with(aovs: impl IntoIterator<Item = Aov>) -> Self {
        Self::new([Aov::Beauty, Aov::Alpha].into_iter().chain(aovs))
    }

    /// Whether this output is kept.
    pub fn has(&self, aov: Aov) -> bool {
        self.aovs.contains(&aov)
    }

    /// Whether anything is kept of what camera rays see.
    pub fn has_features(&self) -> bool {
        self.aovs.iter().any(|aov| aov.is_feature())
    }

    /// Those outputs, each once, in that order.
    pub fn new(aovs: impl IntoIterator<Item = Aov>) -> Self {
        let mut unique = Vec::new();
        for aov in aovs {
            if !unique.contains(&aov) {
                unique.push(aov);
            }
        }
        Self { aovs: unique }
    }

    /// The outputs in order.
    pub fn aovs(&self) -> &[Aov] {
        &self.aovs
    }

    /// How many values a sample has.
    pub fn len(&self) -> usize {
        self.aovs.iter().map(|aov| aov.len()).sum()
    }

    /// Whether nothing is kept.
    pub fn is_empty(&self) -> bool {
        self.aovs.is_empty()
    }

    /// Where the first value of `aov` stands in a sample, if it is kept.
    pub fn offset(&self, aov: Aov) -> Option<usize> {
        let position = self.aovs.iter().position(|&other| other == aov)?;
        Some(self.aovs[..position].iter().map(|aov| aov.len()).sum())
    }
}

impl Default for Layout {
    /// The picture and its coverage: four values a sample.
    fn default() -> Self {
        Self::new([Aov::Beauty, Aov::Alpha])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_in_the_order_asked_for() {
        let layout = Layout::new([Aov::Alpha, Aov::Beauty, Aov::Alpha]);
        assert_eq!(
            (layout.len(), layout.offset(Aov::Alpha), layout.offset(Aov::Beauty)),
            (4, Some(0), Some(1))
        );
        assert_eq!(Layout::new([Aov::Beauty]).offset(Aov::Alpha), None, "not kept");
        assert_eq!(Layout::default().offset(Aov::Alpha), Some(3), "behind the picture");
    }

    #[test]
    fn no_two_channels_or_outputs_share_a_name() {
        let mut names: Vec<_> = Aov::ALL.iter().flat_map(|aov| aov.channels()).collect();
        let all = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all, "{names:?}");
        let mut names: Vec<_> = Aov::ALL.iter().map(|aov| aov.name()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), Aov::ALL.len(), "{names:?}");
    }
}
