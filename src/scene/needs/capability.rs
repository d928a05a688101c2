//! What a renderer can do and a scene may not need.

use std::fmt;

/// Something that costs time or memory where a scene asks for it, and nothing where not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Capability {
    /// Triangles of meshes.
    Triangles,
    /// Spheres.
    Spheres,
    /// Discs.
    Discs,
    /// Shapes that find their own hits.
    Surfaces,
    /// Shapes placed by a map that stays.
    Instances,
    /// Shapes placed by a map that changes while the shutter is open.
    MovingPoses,
    /// Shapes that change by themselves while the shutter is open.
    MovingVertices,
    /// Shapes that some rays do not see.
    Masks,
    /// Shapes of which not all hits count.
    CutOuts,
    /// Rays that slip through no edge between triangles.
    RobustTraversal,
    /// Normals that differ from those of the triangles.
    ShadingNormals,
    /// Surface parameters from files, that somebody reads.
    SurfaceParameters,
    /// Materials with a mirrored ray.
    Mirrors,
    /// Materials that let light through.
    Refraction,
    /// Materials that bound a medium.
    Media,
    /// Media that absorb light.
    Absorption,
    /// Materials with a lobe.
    GlossyLobes,
    /// Materials that are not the same in all directions.
    Anisotropy,
    /// Materials with several ways on.
    LobeChoice,
    /// Materials made of several.
    Mixes,
    /// Materials that change over their surface.
    Textures,
    /// Pictures on surfaces.
    ImageTextures,
    /// Normals from pictures.
    Reliefs,
    /// Lights of a single point or direction.
    PointLights,
    /// Lights with a surface.
    AreaLights,
    /// Light from infinity.
    Environment,
    /// More lights than one to ask.
    LightChoice,
    /// Shadow rays that go on through glass.
    GlassShadows,
    /// A camera that moves while the shutter is open.
    MovingCamera,
    /// A camera whose rays leave from more than one point.
    Lens,
    /// Coordinates that count from near the camera.
    MovedOrigin,
    /// Fuzzy reflections by a filter.
    TwoPass,
    /// Outputs beside the picture.
    Aovs,
    /// Samples where they bring most.
    AdaptiveSampling,
}

/// At what level a capability is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Nothing of it is built.
    Built,
    /// It is not run: a flag that is looked at once for a chunk of lanes, or once for a picture.
    Run,
}

impl Level {
    /// The word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Built => "built",
            Self::Run => "run",
        }
    }
}

/// What there is to say of a capability.
struct About {
    name: &'static str,
    /// What it takes where a scene asks for it.
    takes: &'static str,
    /// What is left out where not.
    spares: &'static str,
    level: Level,
    /// Whether it can be switched on for a scene that does not need it.
    forceable: bool,
}

impl Capability {
    /// All of them: shapes first, then materials, then lights, then the camera, then what is asked of the picture.
    pub const ALL: [Self; 34] = [
        Self::Triangles,
        Self::Spheres,
        Self::Discs,
        Self::Surfaces,
        Self::Instances,
        Self::MovingPoses,
        Self::MovingVertices,
        Self::Masks,
        Self::CutOuts,
        Self::RobustTraversal,
        Self::ShadingNormals,
        Self::SurfaceParameters,
        Self::Mirrors,
        Self::Refraction,
        Self::Media,
        Self::Absorption,
        Self::GlossyLobes,
        Self::Anisotropy,
        Self::LobeChoice,
        Self::Mixes,
        Self::Textures,
        Self::ImageTextures,
        Self::Reliefs,
        Self::PointLights,
        Self::AreaLights,
        Self::Environment,
        Self::LightChoice,
        Self::GlassShadows,
        Self::MovingCamera,
        Self::Lens,
        Self::MovedOrigin,
        Self::TwoPass,
        Self::Aovs,
        Self::AdaptiveSampling,
    ];

    /// The kinds of geometry among them.
    pub const GEOMETRIES: [Self; 4] = [Self::Triangles, Self::Spheres, Self::Discs, Self::Surfaces];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.about().name
    }

    /// Its name as one word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::MovingPoses => "moving-shapes",
            Self::MovingVertices => "moving-vertices",
            Self::RobustTraversal => "robust-traversal",
            Self::ShadingNormals => "shading-normals",
            Self::SurfaceParameters => "surface-parameters",
            Self::GlossyLobes => "glossy-lobes",
            Self::LobeChoice => "lobe-choice",
            Self::ImageTextures => "image-textures",
            Self::PointLights => "point-lights",
            Self::AreaLights => "area-lights",
            Self::LightChoice => "light-choice",
            Self::GlassShadows => "glass-shadows",
            Self::MovingCamera => "moving-camera",
            Self::MovedOrigin => "moved-origin",
            Self::AdaptiveSampling => "adaptive-sampling",
            one => one.name(),
        }
    }

    /// What it takes where a scene asks for it.
    #[must_use]
    pub fn takes(self) -> &'static str {
        self.about().takes
    }

    /// What is left out where a scene does not ask for it.
    #[must_use]
    pub fn spares(self) -> &'static str {
        self.about().spares
    }

    /// At what level it is left out.
    #[must_use]
    pub fn level(self) -> Level {
        self.about().level
    }

    /// Whether it can be switched on for a scene that does not need it: what hangs on things that are not there cannot.
    #[must_use]
    pub fn is_forceable(self) -> bool {
        self.about().forceable
    }

    fn about(self) -> About {
        match self {
            Self::Triangles | Self::Spheres | Self::Discs | Self::Surfaces | Self::Instances => {
                self.of_shapes()
            }
            Self::MovingPoses | Self::MovingVertices | Self::Masks | Self::CutOuts => self.of_shapes(),
            Self::RobustTraversal | Self::ShadingNormals | Self::SurfaceParameters => self.of_shapes(),
            Self::Mirrors | Self::Refraction | Self::Media | Self::Absorption | Self::GlossyLobes => {
                self.of_materials()
            }
            Self::Anisotropy | Self::LobeChoice | Self::Mixes | Self::Textures => self.of_materials(),
            Self::ImageTextures | Self::Reliefs => self.of_materials(),
            _ => self.of_the_rest(),
        }
    }

    fn of_shapes(self) -> About {
        match self {
            Self::Triangles => built("triangles", "triangle geometry", "no triangle geometry"),
            Self::Spheres => built("spheres", "sphere geometry", "no sphere geometry"),
            Self::Discs => built("discs", "disc geometry", "no disc geometry"),
            Self::Surfaces => {
                built("surfaces", "a call of the shape for every candidate", "no calls of shapes")
            }
            Self::Instances => built(
                "instances",
                "a second level of hierarchy, rays carried into it",
                "what stands still was moved to its place once",
            )
            .forceable(),
            Self::MovingPoses => built(
                "moving shapes",
                "a transform per key, a random moment per sample",
                "one moment: no key is interpolated",
            )
            .forceable(),
            Self::MovingVertices => {
                built("moving vertices", "a vertex buffer per key", "one vertex buffer per mesh").forceable()
            }
            Self::Masks => built("masks", "a mask per geometry", "every ray sees everything"),
            Self::CutOuts => built("cut-outs", "a filter function per hit", "no filter function").forceable(),
            Self::RobustTraversal => {
                built("robust traversal", "watertight tests of triangles", "the faster tests").forceable()
            }
            Self::ShadingNormals => built(
                "shading normals",
                "12 bytes per vertex and key, interpolated",
                "the triangles' own normals",
            )
            .forceable(),
            _ => built(
                "surface parameters",
                "8 bytes per vertex, interpolated",
                "those of files are dropped, barycentric ones are not looked at",
            )
            .forceable(),
        }
    }

    fn of_materials(self) -> About {
        match self {
            Self::Mirrors => run("mirrors", "a mirrored ray per hit", "no mirrored rays"),
            Self::Refraction => run("refraction", "two rays per hit", "no refracted rays"),
            Self::Media => run(
                "media",
                "a stack of media per path, looked at per hit",
                "no stack of media, no look for what the camera stands in",
            )
            .forceable(),
            Self::Absorption => run(
                "absorption",
                "an exponential for each way through a medium",
                "no lengths of ways through media",
            )
            .forceable(),
            Self::GlossyLobes => {
                run("glossy lobes", "a sampled ray per hit, weighed against lights", "no rays for lobes")
            }
            Self::Anisotropy => run("anisotropy", "a tangent per hit", "frames of any turn").forceable(),
            Self::LobeChoice => {
                run("lobe choice", "a random number per hit", "no random number for it").forceable()
            }
            Self::Mixes => {
                built("mixes", "every part is asked at each hit", "one surface per material").forceable()
            }
            Self::Textures => run(
                "textures",
                "surface parameters per hit",
                "no surface parameters; spheres are resolved over lanes",
            )
            .forceable(),
            Self::ImageTextures => {
                run("image textures", "pictures at all sizes, a cone about every ray", "no widths of rays")
                    .forceable()
            }
            _ => run("reliefs", "a look at the picture for every normal", "no look for pictures of normals")
                .forceable(),
        }
    }

    fn of_the_rest(self) -> About {
        match self {
            Self::PointLights => run("point lights", "a shadow ray each", "none"),
            Self::AreaLights => {
                run("area lights", "a shadow ray each, two random numbers", "no points drawn on lights")
            }
            Self::Environment => {
                built("environment", "a table of directions", "rays that leave see nothing").forceable()
            }
            Self::LightChoice => built(
                "light choice",
                "a random number, and a table or a tree of lights; a normal per path",
                "the only light is asked without a choice",
            )
            .forceable(),
            Self::GlassShadows => run(
                "glass shadows",
                "shadow rays traced one by one, through glass",
                "shadow rays end at the first hit, and many are traced together",
            )
            .forceable(),
            Self::MovingCamera => built(
                "moving camera",
                "a viewpoint between keys and a random moment for every sample",
                "one viewpoint",
            )
            .forceable(),
            Self::Lens => {
                built("lens", "a point of the lens for every sample, two random numbers", "one point of view")
                    .forceable()
            }
            Self::MovedOrigin => built(
                "moved origin",
                "all coordinates are counted from near the camera",
                "coordinates are those of the files",
            ),
            Self::TwoPass => run("two-pass", "a picture of geometry per sample, filtered", "no filter"),
            Self::Aovs => run(
                "aovs",
                "channels of the film, and a look at what camera rays see",
                "nothing is kept but the picture and its coverage",
            ),
            _ => run("adaptive sampling", "passes, and the noise of every tile", "one pass with all samples"),
        }
    }
}

const fn built(name: &'static str, takes: &'static str, spares: &'static str) -> About {
    About { name, takes, spares, level: Level::Built, forceable: false }
}

const fn run(name: &'static str, takes: &'static str, spares: &'static str) -> About {
    About { name, takes, spares, level: Level::Run, forceable: false }
}

impl About {
    const fn forceable(self) -> Self {
        Self { forceable: true, ..self }
    }
}

/// A set of capabilities.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Capabilities(u64);

impl Capabilities {
    /// None of them.
    pub const NONE: Self = Self(0);

    /// All that can be switched on for a scene that does not need them.
    #[must_use]
    pub fn forceable() -> Self {
        Capability::ALL.into_iter().filter(|capability| capability.is_forceable()).collect()
    }

    /// Whether it is one of them.
    #[inline]
    #[must_use]
    pub const fn has(self, capability: Capability) -> bool {
        self.0 >> capability as u32 & 1 == 1
    }

    /// These and one more.
    #[must_use]
    pub const fn with(self, capability: Capability) -> Self {
        Self(self.0 | 1 << capability as u32)
    }

    /// Those of either set.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// All of them, in the order of [`Capability::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Capability> {
        Capability::ALL.into_iter().filter(move |capability| self.has(*capability))
    }
}

impl FromIterator<Capability> for Capabilities {
    fn from_iter<I: IntoIterator<Item = Capability>>(capabilities: I) -> Self {
        capabilities.into_iter().fold(Self::NONE, Self::with)
    }
}

impl fmt::Debug for Capabilities {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_capability_has_a_name_of_its_own() {
        let names: std::collections::BTreeSet<&str> =
            Capability::ALL.into_iter().map(Capability::name).collect();
        assert_eq!(names.len(), Capability::ALL.len(), "{names:?}");
        for capability in Capability::ALL {
            assert_eq!(capability.word(), capability.name().replace(' ', "-"), "{capability:?}");
        }
        let texts = Capability::ALL.into_iter().flat_map(|it| [it.name(), it.takes(), it.spares()]);
        assert_eq!(texts.filter(|text| text.contains("Embree")).count(), 0, "there are other backends");
    }

    #[test]
    fn sets_hold_what_was_put_in() {
        let set: Capabilities = [Capability::Lens, Capability::Media].into_iter().collect();
        for capability in Capability::ALL {
            let is_in = matches!(capability, Capability::Lens | Capability::Media);
            assert_eq!(set.has(capability), is_in, "{capability:?}");
        }
        assert_eq!(set.iter().collect::<Vec<_>>(), [Capability::Media, Capability::Lens], "in their order");
        assert!(Capabilities::forceable().has(Capability::CutOuts), "filters can be there for nothing");
        assert!(!Capabilities::forceable().has(Capability::Spheres), "spheres cannot");
    }
}
