//! What a renderer can do and a scene may not need.

use std::fmt;

/// The list: shapes first, then materials, then lights, then the camera, then what is asked of the picture. Each is declared once, with its
/// name, the same as one word, and what there is to say of it.
macro_rules! capabilities {
    ($( $(#[doc = $doc:literal])+ $Capability:ident = $name:literal $word:literal $says:expr; )+) => {
        /// Something that costs time or memory where a scene asks for it, and nothing where not.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Capability {
            $( $(#[doc = $doc])+ $Capability, )+
        }

        impl Capability {
            /// All of them: shapes first, then materials, then lights, then the camera, then what is asked of the picture.
            pub const ALL: [Self; ABOUT.len()] = [$( Self::$Capability, )+];
        }

        /// By capability.
        const ABOUT: &[About] = &[$( About { name: $name, word: $word, ..$says }, )+];
    };
}

capabilities! {
    /// Triangles of meshes.
    Triangles = "triangles" "triangles" built("triangle geometry", "no triangle geometry");
    /// Spheres.
    Spheres = "spheres" "spheres" built("sphere geometry", "no sphere geometry");
    /// Discs.
    Discs = "discs" "discs" built("disc geometry", "no disc geometry");
    /// Shapes that find their own hits.
    Surfaces = "surfaces" "surfaces" built("a call of the shape for every candidate", "no calls of shapes");
    /// Shapes placed by a map that stays.
    Instances = "instances" "instances" built(
        "a second level of hierarchy, rays carried into it",
        "what stands still was moved to its place once",
    ).forceable();
    /// Shapes placed by a map that changes while the shutter is open.
    MovingPoses = "moving shapes" "moving-shapes" built(
        "a transform per key, a random moment per sample",
        "one moment: no key is interpolated",
    ).forceable();
    /// Shapes that change by themselves while the shutter is open.
    MovingVertices = "moving vertices" "moving-vertices" built(
        "a vertex buffer per key",
        "one vertex buffer per mesh",
    ).forceable();
    /// Shapes that some rays do not see.
    Masks = "masks" "masks" built("a mask per geometry", "every ray sees everything");
    /// Shapes of which not all hits count.
    CutOuts = "cut-outs" "cut-outs" built("a filter function per hit", "no filter function").forceable();
    /// Rays that slip through no edge between triangles.
    RobustTraversal = "robust traversal" "robust-traversal" built(
        "watertight tests of triangles",
        "the faster tests",
    ).forceable();
    /// Normals that differ from those of the triangles.
    ShadingNormals = "shading normals" "shading-normals" built(
        "12 bytes per vertex and key, interpolated",
        "the triangles' own normals",
    ).forceable();
    /// Surface parameters from files, that somebody reads.
    SurfaceParameters = "surface parameters" "surface-parameters" built(
        "8 bytes per vertex, interpolated",
        "those of files are dropped, barycentric ones are not looked at",
    ).forceable();
    /// Materials with a mirrored ray.
    Mirrors = "mirrors" "mirrors" run("a mirrored ray per hit", "no mirrored rays");
    /// Materials that let light through.
    Refraction = "refraction" "refraction" run("two rays per hit", "no refracted rays");
    /// Materials that bound a medium.
    Media = "media" "media" run(
        "a stack of media per path, looked at per hit",
        "no stack of media, no look for what the camera stands in",
    ).forceable();
    /// Media that absorb light.
    Absorption = "absorption" "absorption" run(
        "an exponential for each way through a medium",
        "no lengths of ways through media",
    ).forceable();
    /// Materials with a lobe.
    GlossyLobes = "glossy lobes" "glossy-lobes" run(
        "a sampled ray per hit, weighed against lights",
        "no rays for lobes",
    );
    /// Materials that are not the same in all directions.
    Anisotropy = "anisotropy" "anisotropy" run(
        "a tangent per hit",
        "of paths: frames of any turn",
    ).forceable();
    /// Materials with several ways on.
    LobeChoice = "lobe choice" "lobe-choice" run(
        "a random number per hit",
        "of paths: no random number for it",
    ).forceable();
    /// Materials made of several.
    Mixes = "mixes" "mixes" built("every part is asked at each hit", "one surface per material").forceable();
    /// Materials that change over their surface.
    Textures = "textures" "textures" run(
        "surface parameters per hit",
        "of paths: no surface parameters; spheres are resolved over lanes",
    ).forceable();
    /// Pictures on surfaces.
    ImageTextures = "image textures" "image-textures" run(
        "pictures at all sizes, a cone about every ray",
        "no widths of rays",
    ).forceable();
    /// Normals from pictures.
    Reliefs = "reliefs" "reliefs" run(
        "a look at the picture for every normal",
        "of paths: no look for pictures of normals",
    ).forceable();
    /// Lights of a single point or direction.
    PointLights = "point lights" "point-lights" run("a shadow ray each", "none");
    /// Lights with a surface.
    AreaLights = "area lights" "area-lights" run(
        "a shadow ray each, two random numbers",
        "no points drawn on lights",
    );
    /// Light from infinity.
    Environment = "environment" "environment" built(
        "a table of directions",
        "rays that leave see nothing",
    ).forceable();
    /// More lights than one to ask.
    LightChoice = "light choice" "light-choice" built(
        "a random number, and a table or a tree of lights; a normal per path",
        "of paths: the only light is asked without a choice",
    ).forceable();
    /// Shadow rays that go on through glass.
    GlassShadows = "glass shadows" "glass-shadows" run(
        "shadow rays traced one by one, through glass",
        "shadow rays end at the first hit, and many are traced together",
    ).forceable();
    /// A camera that moves while the shutter is open.
    MovingCamera = "moving camera" "moving-camera" built(
        "a viewpoint between keys and a random moment for every sample",
        "one viewpoint",
    ).forceable();
    /// A camera whose rays leave from more than one point.
    Lens = "lens" "lens" built(
        "a point of the lens for every sample, two random numbers",
        "one point of view",
    ).forceable();
    /// Coordinates that count from near the camera.
    MovedOrigin = "moved origin" "moved-origin" built(
        "all coordinates are counted from near the camera",
        "coordinates are those of the files",
    );
    /// Fuzzy reflections by a filter.
    TwoPass = "two-pass" "two-pass" run("a picture of geometry per sample, filtered", "no filter");
    /// Outputs beside the picture.
    Aovs = "aovs" "aovs" run(
        "channels of the film, and a look at what camera rays see",
        "nothing is kept but the picture and its coverage",
    );
    /// Samples where they bring most.
    AdaptiveSampling = "adaptive sampling" "adaptive-sampling" run(
        "passes, and the noise of every tile",
        "as many samples in all pixels, no noise of tiles",
    );
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
    /// The name as one word.
    word: &'static str,
    /// What it takes where a scene asks for it.
    takes: &'static str,
    /// What is left out where not.
    spares: &'static str,
    level: Level,
    /// Whether it can be switched on for a scene that does not need it.
    forceable: bool,
}

const fn built(takes: &'static str, spares: &'static str) -> About {
    About { name: "", word: "", takes, spares, level: Level::Built, forceable: false }
}

const fn run(takes: &'static str, spares: &'static str) -> About {
    About { level: Level::Run, ..built(takes, spares) }
}

impl About {
    const fn forceable(self) -> Self {
        Self { forceable: true, ..self }
    }
}

impl Capability {
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
        self.about().word
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

    fn about(self) -> &'static About {
        &ABOUT[self as usize]
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
