//! How light is followed.

use super::{Fresnel, FuzzyBy, FuzzyFilter, Knob};
use crate::scene::record::{choice, record, words};

record! {
    /// How light is followed.
    pub struct Render {
        /// What is computed.
        integrator: Integrator = Integrator::Whitted;
        /// How rays are traced; absent: what is fastest for the integrator, backend and processor, as `specula plan` says.
        query: Option<Query>;
        /// What the integrator `view` shows.
        view: View = View::ShadingNormals;
        /// Samples per pixel; absent: 16, or 65536 at most where time or error are to end the picture.
        spp: Option<u32>, min(1.0), max(16_777_216.0);
        /// Longest path followed, in edges: 1 sees emission only, 2 adds direct light.
        max_depth: u32 = 16, min(1.0), max(65536.0);
        /// Branches that would carry less than this part of what reaches the pixel are not followed.
        min_throughput: f32 = 1e-3, min(0.0), max(1.0);
        /// The length in edges from which paths that carry less than a quarter of what reaches the pixel may end at random, or `off`; what
        /// survives counts for the others, so that pictures stay right in the mean.
        roulette: Knob<u32> = Knob::At(3), min(1.0), max(65536.0);
        /// The most luminance, in W/(sr m^2), that any one piece of light may bring to a sample of a path after more than one
        /// bounce, or `off`: takes bright specks away, and light that belongs to the picture; statistics tell how much.
        clamp_indirect: Knob<f32> = Knob::Off, above(0.0), max(1e20);
        /// How a path chooses the light that it asks at a surface; absent: by a tree where more than one emitter is
        /// somewhere, else by power, as `specula plan` says.
        light_choice: Option<LightChoice>;
        /// Shadow rays of the ray tree to each light that has a size, at the first hits; absent: 2 under `distribution`, else 1.
        light_samples: Option<u32>, min(1.0), max(65536.0);
        /// Rays of the ray tree for each glossy lobe, at the first hits; absent: 2 under `distribution`, else 1.
        glossy_samples: Option<u32>, min(1.0), max(65536.0);
        /// How many hits of the ray tree are first hits, counted from the camera along each way; later ones send one ray of each kind.
        split_depth: u32 = 1, min(0.0), max(64.0);
        /// Paths that go on from what a camera ray meets first, each with a way of its own; lights are asked there once for all of them.
        path_splits: u32 = 1, min(1.0), max(64.0);
        /// What finds hits.
        backend: Backend = Backend::Embree;
        /// How long Embree builds for the sake of fewer steps of rays.
        build_quality: BuildQuality = BuildQuality::Medium;
        /// Whether Embree avoids what loses accuracy: rays that meet an edge exactly do not slip through; costs about a quarter of its speed.
        robust: bool = false;
        /// Where samples fall.
        sampler: Sampler = Sampler::Sobol;
        /// How reflectance depends on the angle, in materials that do not say so themselves.
        fresnel: Fresnel = Fresnel::Exact;
        /// How light on its way to a surface passes through glass.
        glass_shadows: GlassShadows = GlassShadows::Straight;
        /// Who finds light that comes straight from lights, under `path`: for comparing strategies.
        direct: Direct = Direct::Both;
        /// Another seed gives another, equally valid noise.
        seed: u64 = 0;
        /// How the lobes of `glossy`, `phong` and `jitter` materials become fuzzy reflections.
        glossy: FuzzyBy = FuzzyBy::Lobe;
        /// The filter of `glossy = "two-pass"`.
        fuzzy: FuzzyFilter;
    }
}

impl Render {
    /// Samples per pixel.
    #[must_use]
    pub fn spp(&self) -> u32 {
        self.spp.unwrap_or(16)
    }

    /// Shadow rays to each light that has a size, at the first hits.
    #[must_use]
    pub fn light_samples(&self) -> u32 {
        self.light_samples.unwrap_or(self.integrator.default_samples())
    }

    /// Rays of each glossy lobe, at the first hits.
    #[must_use]
    pub fn glossy_samples(&self) -> u32 {
        self.glossy_samples.unwrap_or(self.integrator.default_samples())
    }
}

choice! {
    /// What is computed.
    pub enum Integrator {
        /// A tree of mirrored and refracted rays with direct light.
        "whitted" => Whitted,
        /// The same tree with several shadow rays and glossy rays at the first hit.
        "distribution" => Distribution,
        /// Paths that choose one way on at every surface: all light, diffuse light between surfaces included.
        "path" => Path,
        /// A property of the first surface, for looking at a scene.
        "view" => View,
    }
}

choice! {
    /// How a path chooses the light that it asks at a surface.
    pub enum LightChoice {
        /// In proportion to power, wherever the surface is.
        "power" => Power,
        /// All alike.
        "uniform" => Uniform,
        /// By distance, direction and intensity, through a tree over all emitters.
        "tree" => Tree,
    }
}

choice! {
    /// How rays are traced.
    pub enum Query {
        /// One ray at a time, samples one after the other.
        "single" => Single,
        /// Rays from the camera and rays towards lights in packets, all others one at a time.
        "packet" => Packet,
        /// Many samples side by side, with all rays of paths in packets; of ray trees those from the camera and towards lights.
        "stream" => Stream,
    }
}

impl Integrator {
    /// Whether it follows a tree of rays.
    #[must_use]
    pub const fn is_ray_tree(self) -> bool {
        matches!(self, Self::Whitted | Self::Distribution)
    }

    /// Rays of each kind at the first hits where the scene does not say.
    const fn default_samples(self) -> u32 {
        match self {
            Self::Distribution => 2,
            Self::Whitted | Self::Path | Self::View => 1,
        }
    }
}

choice! {
    /// What the integrator `view` shows.
    pub enum View {
        /// Geometric normals as colours.
        "normals" => Normals,
        /// Shading normals as colours.
        "shading_normals" => ShadingNormals,
        /// Distance from the camera in metres.
        "depth" => Depth,
        /// Surface parameters as red and green.
        "uv" => Uv,
        /// A colour per material.
        "material" => Material,
        /// The work a pixel takes.
        "cost" => Cost,
    }
}

choice! {
    /// What finds hits.
    pub enum Backend {
        /// Intel Embree 4.
        "embree" => Embree,
        /// A binary hierarchy of obvhs.
        "bvh2" => Bvh2,
        /// An eight-wide hierarchy of obvhs with compressed boxes.
        "cwbvh" => CwBvh,
        /// Every primitive is tested against every ray: slow, for checking the others.
        "brute" => Brute,
    }
}

choice! {
    /// How long Embree builds for the sake of fewer steps of rays.
    pub enum BuildQuality {
        /// By Morton codes: built soonest, traced slowest.
        "low" => Low,
        /// By the surface area heuristic in bins.
        "medium" => Medium,
        /// With triangles cut in two where that helps; as `medium` where it is to be robust.
        "high" => High,
    }
}

words! {
    Fresnel {
        /// Fresnel's equations.
        "exact" => Exact,
        /// Schlick's polynomial: within 0.06 for indices from 1.3 to 2.2, within 0.2 for metals, wrong for indices near 1.
        "schlick" => Schlick,
        /// Schlick's polynomial made exact near 82 degrees: within 0.034 for metals and for indices from 1.1 to 2.4.
        "f82" => F82,
        /// That of normal incidence at all angles: the metal of introductory lectures.
        "constant" => Constant,
    }
}

choice! {
    /// Who finds light that comes straight from lights. The picture is the same, its noise is not.
    pub enum Direct {
        /// Asking lights and following lobes, each with the share that it is the better at.
        "both" => Both,
        /// Asking lights alone, but for what only lobes find: mirrors, and an environment that is the same all around.
        "light" => Light,
        /// Following lobes alone, but for lights without size, which they cannot find.
        "bsdf" => Bsdf,
    }
}

choice! {
    /// How light on its way to a surface passes through glass. The ray tree does not find the true, bent way.
    pub enum GlassShadows {
        /// Straight on, dimmed by reflection and absorption: brighter and nearer the truth for thin glass.
        "straight" => Straight,
        /// Not at all: glass casts full shadows.
        "opaque" => Opaque,
    }
}

choice! {
    /// Where samples fall.
    pub enum Sampler {
        /// An Owen-scrambled Sobol' sequence.
        "sobol" => Sobol,
        /// Independent random numbers.
        "independent" => Independent,
        /// One sample at random in each of as many strata as there are samples, whatever their number.
        "stratified" => Stratified,
        /// The Sobol' sequence laid over the picture so that errors of neighbouring pixels cancel; best with 1, 2, 4, 8, ...
        /// samples per pixel.
        "blue_noise" => BlueNoise,
    }
}
