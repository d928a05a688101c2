//! The list of channels that a film keeps.
//!
//! To add one: a variant, its line in [`Aov::ALL`] and in [`Aov::channels`], and somebody who fills it.

use super::cryptomatte::RANKS;

/// What is kept of the samples. An arbitrary output variable, in the words of the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Aov {
    /// Radiance towards the camera, W/(sr m^2).
    Beauty,
    /// The part of the picture that came by two edges at most: emission that is seen directly, and light from lights (the
    /// environment is one) that one surface scattered, be it asked for or met by chance; but no reflection that was filtered.
    Direct,
    /// The rest of the picture; filtered reflections whole, also of lights.
    Indirect,
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
    /// Place of the first surface in metres, counted as the scene's files do: the mean over what the pixel sees. Single precision knows a
    /// place 1000 km out to 6 cm.
    Position,
    /// Surface parameters of the first surface: the mean over what the pixel sees.
    Uv,
    /// Variance of the pixel's radiance, as far as samples are independent: of better samples it is an upper bound.
    Variance,
    /// How many samples the pixel has.
    Samples,
    /// The number of the nearest object that a sample of the pixel shows, from 1; 0 where there is none.
    ObjectId,
    /// The number of the material of the same.
    MaterialId,
    /// How much of which object: names as numbers and coverages.
    CryptoObject,
    /// The same of materials.
    CryptoMaterial,
}

impl Aov {
    /// All there are.
    pub const ALL: [Self; 16] = [
        Self::Beauty,
        Self::Alpha,
        Self::Direct,
        Self::Indirect,
        Self::Albedo,
        Self::Normal,
        Self::GeometricNormal,
        Self::Depth,
        Self::Position,
        Self::Uv,
        Self::Variance,
        Self::Samples,
        Self::ObjectId,
        Self::MaterialId,
        Self::CryptoObject,
        Self::CryptoMaterial,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Beauty => "beauty",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::Alpha => "alpha",
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::GeometricNormal => "geometric_normal",
            Self::Depth => "depth",
            Self::Position => "position",
            Self::Uv => "uv",
            Self::Variance => "variance",
            Self::Samples => "samples",
            Self::ObjectId => "object_id",
            Self::MaterialId => "material_id",
            Self::CryptoObject => "crypto_object",
            Self::CryptoMaterial => "crypto_material",
        }
    }

    /// The names of its channels in an EXR file.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Beauty => &["R", "G", "B"],
            Self::Alpha => &["A"],
            Self::Direct => &["direct.R", "direct.G", "direct.B"],
            Self::Indirect => &["indirect.R", "indirect.G", "indirect.B"],
            Self::Albedo => &["albedo.R", "albedo.G", "albedo.B"],
            Self::Normal => &["N.X", "N.Y", "N.Z"],
            Self::GeometricNormal => &["Ng.X", "Ng.Y", "Ng.Z"],
            Self::Depth => &["Z"],
            Self::Position => &["P.X", "P.Y", "P.Z"],
            Self::Uv => &["uv.U", "uv.V"],
            Self::Variance => &["variance.R", "variance.G", "variance.B"],
            Self::Samples => &["samples"],
            Self::ObjectId => &["object_id"],
            Self::MaterialId => &["material_id"],
            Self::CryptoObject => &CRYPTO_OBJECT,
            Self::CryptoMaterial => &CRYPTO_MATERIAL,
        }
    }

    /// How many values each sample brings; those of the others are made of the pixel's sums.
    pub fn len(self) -> usize {
        let is_made = matches!(self, Self::Variance | Self::Samples) || self.is_of_ids();
        if is_made { 0 } else { self.channels().len() }
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

    /// Whether it is of numbers of things, which have no mean.
    pub fn is_of_ids(self) -> bool {
        matches!(self, Self::ObjectId | Self::MaterialId) || self.matte_layer().is_some()
    }

    /// The name of the layer of mattes that it is, if it is one.
    pub fn matte_layer(self) -> Option<&'static str> {
        match self {
            Self::CryptoObject => Some("CryptoObject"),
            Self::CryptoMaterial => Some("CryptoMaterial"),
            _ => None,
        }
    }

    /// Whether 16-bit floats are enough for it, as they are for light, fractions and directions, but not for lengths, places, variances,
    /// counts and names.
    pub fn fits_half(self) -> bool {
        let is_light = matches!(self, Self::Beauty | Self::Direct | Self::Indirect);
        is_light || self.is_fraction() || matches!(self, Self::Normal | Self::GeometricNormal)
    }

    /// Whether it is of what camera rays see, and not of light.
    pub fn is_feature(self) -> bool {
        let is_surface = matches!(self, Self::Albedo | Self::Normal | Self::GeometricNormal);
        is_surface || self.is_of_hits() || self.is_of_ids()
    }
}

/// The channels of three layers of two pairs of name and coverage.
macro_rules! ranked {
    ($layer:literal) => {
        [
            concat!($layer, "00.R"),
            concat!($layer, "00.G"),
            concat!($layer, "00.B"),
            concat!($layer, "00.A"),
            concat!($layer, "01.R"),
            concat!($layer, "01.G"),
            concat!($layer, "01.B"),
            concat!($layer, "01.A"),
            concat!($layer, "02.R"),
            concat!($layer, "02.G"),
            concat!($layer, "02.B"),
            concat!($layer, "02.A"),
        ]
    };
}

const CRYPTO_OBJECT: [&str; 2 * RANKS] = ranked!("CryptoObject");
const CRYPTO_MATERIAL: [&str; 2 * RANKS] = ranked!("CryptoMaterial");

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

    /// Whether anything is kept of what surfaces look like, and not only of where and what they are.
    pub fn has_colours(&self) -> bool {
        self.has(Aov::Albedo) || self.has(Aov::Normal)
    }

    /// Whether anything is kept of the numbers of things.
    pub fn has_ids(&self) -> bool {
        self.aovs.iter().any(|aov| aov.is_of_ids())
    }

    /// Whether direct light is told apart.
    pub fn splits(&self) -> bool {
        self.has(Aov::Direct) || self.has(Aov::Indirect)
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
