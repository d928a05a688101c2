//! The list of channels that a film keeps.
//!
//! To add one: a variant, its line in [`Aov::ALL`] and in [`Aov::channels`], and somebody who fills it.

/// What is kept of each sample. An arbitrary output variable, in the words of the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Aov {
    /// Radiance towards the camera, W/(sr m^2).
    Beauty,
    /// The part of the pixel that shows anything but what lies infinitely far away, in [0, 1].
    Alpha,
}

impl Aov {
    /// All there are.
    pub const ALL: [Self; 2] = [Self::Beauty, Self::Alpha];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Beauty => "beauty",
            Self::Alpha => "alpha",
        }
    }

    /// The names of its channels in an EXR file.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Beauty => &["R", "G", "B"],
            Self::Alpha => &["A"],
        }
    }

    /// Whether its pixels are limited to [0, 1]: a filter with negative parts would overshoot.
    pub fn is_fraction(self) -> bool {
        self == Self::Alpha
    }
}

/// Which outputs a film keeps, and where the values of each stand in a sample.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    aovs: Vec<Aov>,
}

impl Layout {
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
        self.aovs.iter().map(|aov| aov.channels().len()).sum()
    }

    /// Whether nothing is kept.
    pub fn is_empty(&self) -> bool {
        self.aovs.is_empty()
    }

    /// Where the first value of `aov` stands in a sample, if it is kept.
    pub fn offset(&self, aov: Aov) -> Option<usize> {
        let position = self.aovs.iter().position(|&other| other == aov)?;
        Some(self.aovs[..position].iter().map(|aov| aov.channels().len()).sum())
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
        assert!(Aov::ALL[0].name() != Aov::ALL[1].name(), "names");
    }
}
