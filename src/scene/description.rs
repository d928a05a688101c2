//! What a scene file says: plain data, each entry with its place.
//!
//! Every table of the scene file is declared here, once: names, types, units, ranges and defaults of its keys, and the
//! sentence that explains each. The decoder, the checks, the suggestions and the JSON Schema all come from these
//! declarations (the macros of `record.rs`). Lengths are metres, radiance is W/(sr m^2), angles are degrees. Places and what
//! carries shapes to them are double precision: far from the origin, small differences count.
//!
//! A description that came out of [`crate::scene::load()`] is valid key by key, its references resolve and the files it
//! names exist; whether those files can be read and whether a transform is invertible is found out later.

use crate::error::Place;
use crate::image::RASTERS;
use crate::math::Rgb;
use crate::scene::load::{EXTENSIONS, check};
use crate::scene::record::{Value, choice, record, tagged, words};
use glam::{DVec3, Vec3};
use std::ops::Deref;
use std::path::PathBuf;

pub use crate::bsdf::{Below, FresnelModel as Fresnel, PhongScale};
pub use crate::texture::{Channel, Space, Wrap};

/// A value, and where it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Located<T> {
    /// The value.
    pub value: T,
    /// Where it stands; the table around it where it was left out.
    pub place: Place,
}

impl<T> Deref for Located<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

/// An entry of a table whose keys are names.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T> {
    /// Its name.
    pub name: String,
    /// Where the name was given.
    pub place: Place,
    /// The entry.
    pub value: T,
}

/// One number per axis; a single number in the file stands for all three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerAxis(pub DVec3);

/// A width along each tangent; a single number in the file stands for both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerTangent(pub [f32; 2]);

/// A colour that may vary over a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(Rgb<f32>),
    /// Two colours by turns.
    Checker(Checker),
    /// A picture.
    Image(Box<ImageTexture>),
}

impl Texture {
    /// The same gray everywhere.
    #[must_use]
    pub const fn gray(value: f32) -> Self {
        Self::Constant(Rgb::gray(value))
    }
}

record! {
    /// A chequered pattern over surface parameters.
    pub struct Checker {
        /// The two colours; the first one starts at the origin of the surface parameters.
        checker: [Rgb<f32>; 2], min(0.0), max(1.0);
        /// How many fields there are along u and along v between 0 and 1.
        repeat: [f32; 2] = [2.0, 2.0], above(0.0), max(1e6);
    }
}

record! {
    /// How a picture lies over surface parameters.
    pub struct Lie {
        /// What is beyond the edges of the picture.
        wrap: Wrap = Wrap::Repeat;
        /// How often the picture is repeated along u and along v between 0 and 1; negative numbers mirror it, which reliefs cannot be.
        repeat: [f32; 2] = [1.0, 1.0], min(-1e6), max(1e6);
        /// What is added to the repeated parameters.
        offset: [f32; 2] = [0.0, 0.0], min(-1e6), max(1e6);
    }
}

record! {
    /// A picture over surface parameters: its lower left corner is at 0, its upper right one at 1.
    pub struct ImageTexture {
        /// A PNG, JPEG, EXR or HDR file.
        file: Located<PathBuf>, file(RASTERS);
        /// What its numbers stand for; absent: `srgb` for colours of PNG and JPEG files, else `linear`.
        space: Option<Space>;
        /// What its colours are multiplied by; what is reflected is cut at 1.
        factor: Rgb<f32> = Rgb::gray(1.0), min(0.0), max(1e20);
        ..lie: Lie, "How the picture lies.";
    }
}

record! {
    /// One number per point of a picture over surface parameters.
    pub struct ScalarTexture {
        /// A PNG, JPEG, EXR or HDR file.
        file: Located<PathBuf>, file(RASTERS);
        /// Which of its numbers; absent: `a` for an opacity where the file has it, else `r`.
        channel: Option<Channel>;
        /// What its numbers stand for.
        space: Space = Space::Linear;
        /// What the number is multiplied by; beyond 1 it is cut.
        factor: f32 = 1.0, min(0.0), max(1e6);
        ..lie: Lie, "How the picture lies.";
    }
}

record! {
    /// A picture of normals in tangent space: red, green and blue from 0 to 1 are -1 to 1 along u, along v and outwards.
    pub struct NormalMap checked by check::normal_map {
        /// A PNG, JPEG, EXR or HDR file; its numbers are taken as they are.
        file: Located<PathBuf>, file(RASTERS);
        /// What the lean along u and v is multiplied by.
        strength: f32 = 1.0, min(0.0), max(100.0);
        /// Whether green counts against v, as some programs write it.
        flip_y: bool = false;
        ..lie: Lie, "How the picture lies, not mirrored.";
    }
}

record! {
    /// A picture of heights: the surface is shaded as if white stood out over black. Its outline stays as it is.
    pub struct Bump checked by check::bump {
        /// A PNG, JPEG, EXR or HDR file; its numbers are taken as they are.
        file: Located<PathBuf>, file(RASTERS);
        /// Where the heights are; red without, which in gray pictures is the shade.
        channel: Option<Channel>;
        /// How far white stands out over black, in widths of a texel: 1 makes a slope of 45 degrees of white beside black; negative
        /// numbers sink it.
        strength: f32 = 1.0, min(-1e4), max(1e4);
        /// The same in metres, instead of `strength`.
        height: Option<f32>, unit("m"), min(-1e6), max(1e6);
        ..lie: Lie, "How the picture lies, not mirrored.";
    }
}

words! {
    Space {
        /// Light by the curve of sRGB.
        "srgb" => Srgb,
        /// Light, or other numbers, as they are.
        "linear" => Linear,
    }
}

words! {
    Wrap {
        /// The picture again.
        "repeat" => Repeat,
        /// The picture again, every other time mirrored.
        "mirror" => Mirror,
        /// The colour of the edge.
        "clamp" => Clamp,
    }
}

words! {
    Channel {
        /// Red, or the shade of a gray picture.
        "r" => Red,
        /// Green.
        "g" => Green,
        /// Blue.
        "b" => Blue,
        /// Coverage; 1 where the file has none.
        "a" => Alpha,
    }
}

/// A number, or the word `off`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knob<T> {
    /// Not in use.
    Off,
    /// In use, with this value.
    At(T),
}

impl<T> Knob<T> {
    /// The value, if it is in use.
    #[must_use]
    pub fn value(self) -> Option<T> {
        if let Self::At(value) = self { Some(value) } else { None }
    }
}

impl<T: std::fmt::Display> std::fmt::Display for Knob<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Off => f.write_str("off"),
            Self::At(value) => value.fmt(f),
        }
    }
}

/// A width of facets that may vary over a surface, then alike in all directions.
#[derive(Clone, Debug, PartialEq)]
pub enum Roughness {
    /// The same everywhere.
    Constant(PerTangent),
    /// A picture.
    Image(Box<ScalarTexture>),
}

record! {
    /// A scene.
    pub struct Description {
        /// Other scene files, whose tables come first; `camera`, `film` and `render` of this file override theirs key by
        /// key, shapes and lights are added to theirs.
        include: Vec<Located<PathBuf>>, file(&["toml"]);
        /// From where and how the scene is seen.
        camera: Located<Camera>;
        /// The picture and how samples become pixels.
        film: Film;
        /// How light is followed; flags of the command line override these.
        render: Render;
        /// Materials by name.
        materials: Vec<Named<Material>>;
        /// Surfaces.
        shapes: Vec<Located<Shape>>;
        /// Lights; surfaces of an emitting material shine too.
        lights: Vec<Located<Light>>;
    }
}

impl Description {
    /// The same scene as one file without includes would say it, in JSON. Defaults are written out; names of files are
    /// as seen from the current directory.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        let mut json = Value::to_json(self);
        if let Some(object) = json.as_object_mut() {
            object.shift_remove("include");
        }
        json
    }
}

tagged! {
    /// From where and how the scene is seen.
    pub enum Camera by tag_or("perspective") checked by check::camera {
        /// A pinhole, or a thin lens in its place.
        "perspective" => Perspective {
            /// Where the camera stands.
            from: DVec3 = DVec3::new(0.0, 1.6, 4.6), unit("m");
            /// The point in the middle of the picture.
            at: DVec3 = DVec3::new(0.0, 0.35, 0.0), unit("m");
            /// The direction that points up in the picture; any length, not along the view.
            up: Vec3 = Vec3::Y, nonzero();
            /// Angle of view from the bottom to the top of the picture.
            vfov_deg: f32 = 50.0, unit("degrees"), above(0.0), below(180.0);
            /// Radius of the lens, that is focal length / (2 f-number); 0 is a pinhole, with everything sharp.
            lens_radius: f32 = 0.0, unit("m"), min(0.0);
            /// How far away the plane in focus is, along the view; absent: the plane through `at`.
            focus_distance: Option<f32>, unit("m"), above(0.0);
            /// Corners of the iris, which lie on the circle of `lens_radius`; 0 for a round one, else 3 or more.
            blades: u32 = 0, min(0.0), max(1000.0);
            /// Turns the iris, counter-clockwise seen from behind the camera; at 0 one of its corners is on top.
            blade_rotation_deg: f32 = 0.0, unit("degrees");
            /// When the shutter opens: what moves is seen where it is from then on.
            shutter_open_s: f64 = 0.0, unit("s");
            /// When the shutter closes; at the moment it opens, nothing is blurred.
            shutter_close_s: f64 = 0.0, unit("s");
            /// Views at two or more moments, in the order of time: between them the camera moves on straight lines and turns
            /// on the shorter way, before the first and after the last it stands still.
            keys: Vec<Located<CameraKey>> = vec![];
        }
    }
}

record! {
    /// How a moving camera sees the scene at one moment.
    pub struct CameraKey {
        /// When.
        time_s: f64, unit("s");
        /// Where the camera stands; absent: the camera's own `from`.
        from: Option<DVec3>, unit("m");
        /// The point in the middle of the picture; absent: the camera's own `at`.
        at: Option<DVec3>, unit("m");
        /// The direction that points up in the picture; absent: the camera's own `up`.
        up: Option<Vec3>, nonzero();
        /// Angle of view from the bottom to the top of the picture; absent: the camera's own.
        vfov_deg: Option<f32>, unit("degrees"), above(0.0), below(180.0);
        /// How far away the plane in focus is, along the view; absent: the camera's own, or the plane through this key's `at`.
        focus_distance: Option<f32>, unit("m"), above(0.0);
    }
}

record! {
    /// The picture and how samples become pixels.
    pub struct Film {
        /// Columns.
        width: u32 = 1280, unit("pixels"), min(1.0), max(65536.0);
        /// Rows.
        height: u32 = 720, unit("pixels"), min(1.0), max(65536.0);
        /// How samples are weighted about the middle of a pixel. Mitchell's is the sharpest; where samples are few, its negative
        /// lobes leave dark specks beside bright edges, which gaussian does not.
        filter: Filter = Filter::Mitchell;
        /// How far the filter reaches; absent: 0.5 for box, 1 for tent, 1.5 for gaussian, 2 for mitchell.
        filter_radius: Option<f32>, unit("pixels"), above(0.0), max(16.0);
        /// Exposure of the PNG preview, in powers of two; EXR files are not touched by it.
        exposure_ev: f32 = 0.0, unit("stops"), min(-100.0), max(100.0);
        /// How radiance beyond white is shown in the PNG preview.
        tone: Tone = Tone::Filmic;
        /// Whether the outputs `albedo` and `normal` are of what polished surfaces show, as denoisers want them, instead of the first surface.
        follow_polished: bool = true;
    }
}

choice! {
    /// How samples are weighted about the middle of a pixel.
    pub enum Filter {
        /// All alike.
        "box" => Box,
        /// Falling linearly.
        "tent" => Tent,
        /// A Gaussian, shifted down to zero at its radius.
        "gaussian" => Gaussian,
        /// The sharpening cubic of Mitchell and Netravali.
        "mitchell" => Mitchell,
    }
}

impl Filter {
    /// How far it reaches where the film does not say, in pixels.
    #[must_use]
    pub const fn default_radius(self) -> f32 {
        match self {
            Self::Box => 0.5,
            Self::Tent => 1.0,
            Self::Gaussian => 1.5,
            Self::Mitchell => 2.0,
        }
    }
}

choice! {
    /// How radiance beyond white is shown in the PNG preview.
    pub enum Tone {
        /// Cut off at white.
        "clip" => Clip,
        /// Rolled off smoothly.
        "filmic" => Filmic,
    }
}

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
        /// Shadow rays to each light that has a size, at the first hits; absent: 2 under `distribution`, else 1.
        light_samples: Option<u32>, min(1.0), max(65536.0);
        /// Rays of each glossy lobe, at the first hits; absent: 2 under `distribution`, else 1.
        glossy_samples: Option<u32>, min(1.0), max(65536.0);
        /// How many hits are first hits, counted along each path from the camera; later ones send one ray of each kind.
        split_depth: u32 = 1, min(0.0), max(64.0);
        /// What finds hits.
        backend: Backend = Backend::Embree;
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
    /// How the normals of microfacets are spread.
    pub enum Distribution {
        /// Long tails, as most real surfaces have.
        "ggx" => Ggx,
        /// Gaussian slopes, no tails.
        "beckmann" => Beckmann,
    }
}

words! {
    Below {
        /// They are turned by half a turn about the mirror direction: nothing is lost.
        "through_r" => ThroughR,
        /// They count as black: the rim darkens.
        "discard" => Discard,
        /// Others are drawn instead: the lobe cut off at the surface and brought back to 1. Slower.
        "rejection" => Rejection,
    }
}

words! {
    PhongScale {
        /// (e + 2) / (2 pi), the modified Phong model: darkens with the angle, to its cosine where it is sharp.
        "modified" => Modified,
        /// (e + 2) / (2 pi) over the greater cosine: a mirror where it is sharp.
        "max_cosine" => MaxCosine,
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

record! {
    /// What a surface is made of.
    pub struct Material {
        /// Radiance it gives off besides, on the side of its normals; a picture or a pattern on meshes and rectangles only.
        emission: Texture = Texture::gray(0.0), unit("W/(sr m^2)"), min(0.0), max(1e20);
        /// A relief by a picture of normals; on meshes with texture coordinates and on spheres.
        normal_map: Option<NormalMap>;
        /// A relief by a picture of heights, likewise; instead of `normal_map`.
        bump: Option<Bump>;
        /// Holes: where this is below 0.5 there is no surface. For materials that do not shine.
        opacity: Option<ScalarTexture>;
        ..scattering: Scattering, "What it does with light.";
    }
}

impl From<Scattering> for Material {
    fn from(scattering: Scattering) -> Self {
        Self { emission: Texture::gray(0.0), normal_map: None, bump: None, opacity: None, scattering }
    }
}

tagged! {
    /// What a surface does with light.
    pub enum Scattering by tag() checked by check::scattering {
        /// A matt surface.
        "diffuse" => Diffuse {
            /// The part of the light that is reflected, per channel.
            reflectance: Texture = Texture::gray(0.5), min(0.0), max(1.0);
        }
        /// A rough matt surface, such as plaster or clay.
        "oren_nayar" => OrenNayar {
            /// The part of the light that each slope reflects, per channel.
            reflectance: Texture = Texture::gray(0.5), min(0.0), max(1.0);
            /// From 0, the same as `diffuse`, to 1.
            roughness: f32 = 0.5, min(0.0), max(1.0);
        }
        /// An ideal mirror, the same at all angles.
        "mirror" => Mirror {
            /// The part of the light that is reflected, per channel.
            reflectance: Texture = Texture::gray(1.0), min(0.0), max(1.0);
        }
        /// A metal.
        "conductor" => Conductor {
            /// Width of the distribution of facets, one number or one along each tangent, or a picture; 0 is a mirror. Tangents follow the
            /// texture coordinates of a mesh, and run around the y axis where there are none.
            alpha: Roughness = Roughness::Constant(PerTangent([0.0; 2])), min(0.0), max(1.0);
            /// How the normals of the facets are spread.
            distribution: Distribution = Distribution::Ggx;
            /// Turns the tangents about the normal, counter-clockwise seen from outside; for two widths.
            rotate_deg: f32 = 0.0, unit("degrees"), min(-36000.0), max(36000.0);
            /// How reflectance depends on the angle; absent: as the table `render` says.
            fresnel: Option<Fresnel>;
            ..optics: Optics, "How much it reflects at which angle.";
        }
        /// A clear body, such as glass or water, polished or frosted.
        "dielectric" => Dielectric {
            /// Index of refraction against that of air; 1 is invisible.
            ior: f32 = 1.5, min(1.0), max(10.0);
            /// What is absorbed on the way through, per channel: light falls to 1/e over 1/absorption metres.
            absorption: Rgb<f32> = Rgb::gray(0.0), unit("1/m"), min(0.0), max(1e9);
            /// Where bodies overlap, the one of the highest priority is there.
            priority: i32 = 0;
            /// Width of the distribution of facets, one number or one along each tangent, or a picture; 0 is polished. Tangents follow the
            /// texture coordinates of a mesh, and run around the y axis where there are none.
            alpha: Roughness = Roughness::Constant(PerTangent([0.0; 2])), min(0.0), max(1.0);
            /// How the normals of the facets are spread.
            distribution: Distribution = Distribution::Ggx;
            /// Turns the tangents about the normal, counter-clockwise seen from outside; for two widths.
            rotate_deg: f32 = 0.0, unit("degrees"), min(-36000.0), max(36000.0);
            /// How reflectance depends on the angle; absent: as the table `render` says.
            fresnel: Option<Fresnel>;
        }
        /// A clear sheet without thickness, such as a window pane: what goes through is not bent.
        "thin_dielectric" => ThinDielectric {
            /// Index of refraction against that of air; 1 is invisible but for its transmittance.
            ior: f32 = 1.5, min(1.0), max(10.0);
            /// What is left of light that crosses the sheet once straight on, per channel.
            transmittance: Rgb<f32> = Rgb::gray(1.0), min(0.0), max(1.0);
            /// How reflectance depends on the angle; absent: as the table `render` says.
            fresnel: Option<Fresnel>;
        }
        /// A coloured base under a Phong lobe.
        "glossy" => Glossy {
            /// Exponent of the lobe; larger is sharper.
            exponent: f32 = 100.0, min(0.0), max(1e9);
            /// The part of the light that the lobe reflects, per channel.
            reflectance: Rgb<f32> = Rgb::gray(0.8), min(0.0), max(1.0);
            /// The part of the light that the base reflects, per channel.
            diffuse: Texture = Texture::gray(0.0), min(0.0), max(1.0);
            /// What becomes of directions of the lobe that fall below the surface.
            below: Below = Below::ThroughR;
        }
        /// A coloured base under a Phong lobe that obeys reciprocity and darkens towards grazing.
        "phong" => Phong {
            /// Exponent of the lobe; larger is sharper.
            exponent: f32 = 100.0, min(0.0), max(1e9);
            /// The part of the light that the lobe reflects at most, per channel.
            reflectance: Rgb<f32> = Rgb::gray(0.8), min(0.0), max(1.0);
            /// The part of the light that the base reflects, per channel.
            diffuse: Texture = Texture::gray(0.0), min(0.0), max(1.0);
            /// What the lobe is multiplied by.
            scale: PhongScale = PhongScale::MaxCosine;
        }
        /// A coloured base under a mirror whose normal trembles.
        "jitter" => Jitter {
            /// Exponent of the distribution of normals; four times that of a lobe of `glossy` is as sharp.
            exponent: f32 = 400.0, min(0.0), max(1e9);
            /// The part of the light that the mirror reflects, per channel.
            reflectance: Rgb<f32> = Rgb::gray(0.8), min(0.0), max(1.0);
            /// The part of the light that the base reflects, per channel.
            diffuse: Texture = Texture::gray(0.0), min(0.0), max(1.0);
        }
        /// A matt base under a smooth clear coat, such as glazed ceramic.
        "glazed" => Glazed {
            /// Index of refraction of the coat.
            ior: f32 = 1.5, min(1.0), max(10.0);
            /// The part of the light that the base reflects, per channel.
            reflectance: Texture = Texture::gray(0.5), min(0.0), max(1.0);
            /// How the reflectance of the coat depends on the angle; absent: as the table `render` says.
            fresnel: Option<Fresnel>;
        }
        /// A surface between matt and mirror by one number, after Schlick.
        "schlick" => Schlick {
            /// Colour straight on, per channel; whiter towards grazing.
            color: Rgb<f32> = Rgb::gray(0.8), min(0.0), max(1.0);
            /// From 0, a mirror, to 1, matt; part of the light is lost between, half of it at 0.5.
            roughness: f32 = 0.2, min(0.0), max(1.0);
            /// 1 is the same in all directions; less is brushed along the first tangent of `conductor`.
            isotropy: f32 = 1.0, min(1e-4), max(1.0);
        }
        /// Other materials in one place, each with its share of the light.
        "mix" => Mix {
            /// One to four parts, whose weights add up to at most 1.
            parts: Vec<MixPart>;
        }
        /// A surface that shines and reflects nothing.
        "emission" => Emission {
            /// What it emits in every direction; a picture or a pattern on meshes and rectangles only.
            radiance: Texture, unit("W/(sr m^2)"), min(0.0), max(1e20);
            /// Whether it shines on both sides, not only on that of its normals.
            two_sided: bool = false;
        }
    }
}

record! {
    /// A part of a mix.
    pub struct MixPart {
        /// Name of the material; neither a mix nor a light. Its relief and holes do not count: a mix has its own.
        material: Located<String>;
        /// Its share of the light, per channel.
        weight: Rgb<f32> = Rgb::gray(0.5), min(0.0), max(1.0);
    }
}

impl Scattering {
    /// Polished clear glass of this index.
    #[must_use]
    pub const fn glass(ior: f32) -> Self {
        Self::Dielectric {
            ior,
            absorption: Rgb::BLACK,
            priority: 0,
            alpha: Roughness::Constant(PerTangent([0.0; 2])),
            distribution: Distribution::Ggx,
            rotate_deg: 0.0,
            fresnel: None,
        }
    }

    /// A metal with facets of this width, alike in all directions.
    #[must_use]
    pub const fn metal(alpha: f32, optics: Optics) -> Self {
        let distribution = Distribution::Ggx;
        Self::Conductor {
            alpha: Roughness::Constant(PerTangent([alpha; 2])),
            distribution,
            rotate_deg: 0.0,
            fresnel: None,
            optics,
        }
    }

    /// A coat of this index over a base.
    #[must_use]
    pub const fn glazed(ior: f32, reflectance: Texture) -> Self {
        Self::Glazed { ior, reflectance, fresnel: None }
    }

    /// A Phong lobe over a base.
    #[must_use]
    pub const fn glossy(exponent: f32, reflectance: Rgb<f32>, diffuse: Texture) -> Self {
        Self::Glossy { exponent, reflectance, diffuse, below: Below::ThroughR }
    }
}

tagged! {
    /// How much a metal reflects at which angle.
    pub enum Optics by key() {
        /// A metal whose optical constants are known by name.
        "metal" => Metal {
            /// Symbol of the element.
            metal: Located<String>;
        }
        /// A complex index of refraction, per channel.
        "eta" => Index {
            /// Real part of the index of refraction.
            eta: Rgb<f32>, min(1e-3), max(1e3);
            /// Imaginary part of the index of refraction.
            k: Rgb<f32>, above(0.0), max(1e6);
        }
        /// Two colours, from which an index of refraction is derived.
        "reflectance" => Artist {
            /// Reflectance seen straight on.
            reflectance: Rgb<f32>, min(0.0), max(1.0);
            /// Tint towards grazing angles.
            edge_tint: Rgb<f32> = Rgb::gray(1.0), min(0.0), max(1.0);
        }
    }
}

record! {
    /// A surface, or a prototype of one.
    pub struct Shape checked by check::shape {
        /// A name, unlike those of all other shapes.
        name: Option<Located<String>>;
        /// Name of its material; may be absent where the file of a mesh brings materials.
        material: Option<Located<String>>;
        /// Steps that carry the shape to its place, in the order written.
        transform: Vec<Located<Step>> = vec![];
        /// Where it is carried from there at two or more moments, in the order of time; before the first and after the last
        /// it stands still.
        keys: Vec<Located<ShapeKey>> = vec![];
        /// Whether it is not seen itself, but only through its instances.
        hidden: bool = false;
        ..form: Form, "What it is.";
    }
}

record! {
    /// Where a moving shape is at one moment.
    ///
    /// Where the key before has steps of the same kinds in the same order, or none, each step goes from one to the other by
    /// itself, so that an angle from 0 to 720 degrees is two turns; else the shape turns on the shorter way.
    pub struct ShapeKey {
        /// When.
        time_s: f64, unit("s");
        /// Steps that carry the shape, after its own `transform`, in the order written; all but `fit`.
        transform: Vec<Located<Step>> = vec![];
    }
}

tagged! {
    /// The form of a surface.
    pub enum Form by tag() checked by check::form {
        /// Triangles from a file.
        "mesh" => Mesh {
            /// An OBJ or PLY file.
            file: Located<PathBuf>, file(EXTENSIONS);
            /// Where shading normals come from.
            normals: Normals = Normals::File;
            /// Smooth normals keep edges sharp whose triangles are turned by more against each other; 180 smooths over all.
            crease_deg: f32 = 180.0, unit("degrees"), min(0.0), max(180.0);
        }
        /// A sphere.
        "sphere" => Sphere {
            /// Centre.
            center: DVec3 = DVec3::ZERO, unit("m");
            /// Radius.
            radius: f32 = 1.0, unit("m"), above(0.0);
        }
        /// A flat round disc.
        "disc" => Disc {
            /// Centre.
            center: DVec3 = DVec3::ZERO, unit("m");
            /// The side that is outside; any length.
            normal: Vec3 = Vec3::Y, nonzero();
            /// Radius.
            radius: f32 = 1.0, unit("m"), above(0.0);
        }
        /// A flat parallelogram; its outside is that of `edge_u` x `edge_v`.
        "rectangle" => Rectangle {
            /// Centre.
            center: DVec3 = DVec3::ZERO, unit("m");
            /// From the centre to the middle of one side.
            edge_u: Vec3, unit("m"), nonzero();
            /// From the centre to the middle of the next side.
            edge_v: Vec3, unit("m"), nonzero();
        }
        /// A box along the axes.
        "box" => Box {
            /// Its lowest corner.
            min: DVec3, unit("m");
            /// Its highest corner.
            max: DVec3, unit("m");
        }
        /// A cylinder.
        "cylinder" => Cylinder {
            /// Centre of its first end.
            from: DVec3 = DVec3::ZERO, unit("m");
            /// Centre of its second end.
            to: DVec3 = DVec3::Y, unit("m");
            /// Radius.
            radius: f32 = 1.0, unit("m"), above(0.0);
            /// Whether discs close its ends; a clear body needs them.
            caps: bool = true;
        }
        /// A cone, or what is left of one whose tip is cut off.
        "cone" => Cone {
            /// Centre of its base.
            from: DVec3 = DVec3::ZERO, unit("m");
            /// Its tip, or the centre of the end where that is cut off.
            to: DVec3 = DVec3::Y, unit("m");
            /// Radius of its base.
            radius: f32 = 1.0, unit("m"), above(0.0);
            /// Radius of its other end.
            end_radius: f32 = 0.0, unit("m"), min(0.0);
            /// Whether discs close its ends; a clear body needs them.
            caps: bool = true;
        }
        /// A ring with a hole.
        "torus" => Torus {
            /// Centre.
            center: DVec3 = DVec3::ZERO, unit("m");
            /// The direction through the hole; any length.
            axis: Vec3 = Vec3::Y, nonzero();
            /// From the centre to the middle of the tube.
            major_radius: f32 = 1.0, unit("m"), above(0.0);
            /// Radius of the tube; below `major_radius`.
            minor_radius: f32 = 0.25, unit("m"), above(0.0);
        }
        /// Heights over a rectangle, from the brightness of a picture seen from above: its right is +x, its top -z.
        "height_field" => HeightField {
            /// A gray picture (PNG of 8 or 16 bits, EXR or HDR), 2 by 2 pixels at least; a height per pixel.
            file: Located<PathBuf>, file(&["png", "exr", "hdr"]);
            /// Centre of the rectangle, from which heights are counted.
            center: DVec3 = DVec3::ZERO, unit("m");
            /// Edges of the rectangle along x and z, between the outermost heights.
            size: [f32; 2] = [1.0, 1.0], unit("m"), above(0.0);
            /// Heights of black (0) and of white (1); of what is beyond them in EXR and HDR files in proportion.
            height: [f32; 2] = [0.0, 1.0], unit("m");
            /// Where shading normals come from.
            normals: HeightNormals = HeightNormals::Smooth;
        }
        /// Another shape once more, with a transform of its own after that shape's.
        "instance" => Instance {
            /// Name of the other shape.
            of: Located<String>;
        }
    }
}

choice! {
    /// Where shading normals of a height field come from.
    pub enum HeightNormals {
        /// The slope between the neighbours of each height.
        "smooth" => Smooth,
        /// The triangles between heights.
        "flat" => Flat,
    }
}

choice! {
    /// Where shading normals come from.
    pub enum Normals {
        /// Those of the file; flat where it has none.
        "file" => File,
        /// Averaged over the triangles about each point.
        "smooth" => Smooth,
        /// Those of the triangles.
        "flat" => Flat,
    }
}

tagged! {
    /// A step of a transform.
    pub enum Step by key() checked by check::step {
        /// Scales about the origin.
        "scale" => Scale {
            /// A factor for all axes, or one for each; not zero.
            scale: PerAxis;
        }
        /// Turns about an axis through the origin, counter-clockwise seen from its tip.
        "rotate_deg" => Rotate {
            /// The angle.
            rotate_deg: f64, unit("degrees");
            /// The axis; any length.
            axis: DVec3, nonzero();
        }
        /// Moves.
        "translate" => Translate {
            /// By how much.
            translate: DVec3, unit("m");
        }
        /// Applies an affine matrix to column vectors.
        "matrix" => Matrix {
            /// Four rows of four numbers, one row after the other; the last is 0, 0, 0, 1.
            matrix: [f64; 16];
        }
        /// Scales and moves the shape so that it stands centred on the origin on the plane y = 0.
        "fit" => Fit {
            /// The longest edge that its bounding box shall have.
            fit: f64, unit("m"), above(0.0);
        }
    }
}

tagged! {
    /// A light.
    pub enum Light by tag() checked by check::light {
        /// A point that shines alike in all directions.
        "point" => Point {
            /// Where it is.
            position: DVec3, unit("m");
            /// Power per solid angle.
            intensity: Rgb<f32>, unit("W/sr"), min(0.0), max(1e20);
        }
        /// A point that shines into a cone.
        "spot" => Spot {
            /// Where it is.
            position: DVec3, unit("m");
            /// The point it aims at.
            at: DVec3, unit("m");
            /// Power per solid angle in the middle of the cone.
            intensity: Rgb<f32>, unit("W/sr"), min(0.0), max(1e20);
            /// Angle between the axis and the rim of the cone.
            angle_deg: f32 = 30.0, unit("degrees"), above(0.0), max(180.0);
            /// The outer part of the angle over which the light fades to nothing.
            softness: f32 = 0.1, min(0.0), max(1.0);
        }
        /// Parallel light from infinitely far away.
        "directional" => Directional {
            /// Where the light travels; any length.
            direction: Vec3, nonzero();
            /// Power per area on a surface that faces the light.
            irradiance: Rgb<f32>, unit("W/m^2"), min(0.0), max(1e20);
        }
        /// A flat parallelogram that shines along `edge_u` x `edge_v`.
        "rectangle" => Rectangle {
            /// Centre.
            center: DVec3, unit("m");
            /// From the centre to the middle of one side.
            edge_u: Vec3, unit("m"), nonzero();
            /// From the centre to the middle of the next side.
            edge_v: Vec3, unit("m"), nonzero();
            /// What it emits in every direction of its bright side.
            radiance: Rgb<f32>, unit("W/(sr m^2)"), min(0.0), max(1e20);
        }
        /// A flat round disc that shines along its normal.
        "disc" => Disc {
            /// Centre.
            center: DVec3, unit("m");
            /// The bright side; any length.
            normal: Vec3, nonzero();
            /// Radius.
            radius: f32, unit("m"), above(0.0);
            /// What it emits in every direction of its bright side.
            radiance: Rgb<f32>, unit("W/(sr m^2)"), min(0.0), max(1e20);
        }
        /// A sphere that shines outwards.
        "sphere" => Sphere {
            /// Centre.
            center: DVec3, unit("m");
            /// Radius.
            radius: f32, unit("m"), above(0.0);
            /// What it emits in every direction.
            radiance: Rgb<f32>, unit("W/(sr m^2)"), min(0.0), max(1e20);
        }
        /// Triangles from a file that shine on the side their normals point to.
        "mesh" => Mesh {
            /// An OBJ or PLY file.
            file: Located<PathBuf>, file(EXTENSIONS);
            /// What they emit in every direction of their bright side.
            radiance: Rgb<f32>, unit("W/(sr m^2)"), min(0.0), max(1e20);
            /// Steps that carry the mesh to its place, in the order written.
            transform: Vec<Located<Step>> = vec![];
        }
        /// Light from all around, infinitely far away.
        "environment" => Environment {
            /// A factor on all of it.
            scale: f32 = 1.0, min(0.0);
            /// Turns it about +Y, counter-clockwise seen from above.
            rotate_deg: f32 = 0.0, unit("degrees");
            ..sky: Sky, "What arrives from where.";
        }
    }
}

tagged! {
    /// What an environment shows.
    pub enum Sky by key() {
        /// A picture of all directions, longitude by latitude.
        "file" => File {
            /// An HDR or EXR file.
            file: Located<PathBuf>, file(&["hdr", "exr"]);
        }
        /// The same from everywhere.
        "radiance" => Constant {
            /// What arrives.
            radiance: Rgb<f32>, unit("W/(sr m^2)"), min(0.0), max(1e20);
        }
    }
}
