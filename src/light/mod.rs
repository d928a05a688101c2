//! Emission and how to sample it.
//!
//! A light answers from a reference point: a direction towards it drawn at random with its density ([`Light::sample`]),
//! and the density with which a given direction would have been drawn ([`Light::pdf`]). Densities are with respect to
//! solid angle; lights of a single direction or point have none and say so ([`Light::is_delta`]). Sampling is generic
//! over lanes: the light is the same in all lanes, the reference points differ.

mod area;
mod delta;
mod disc;
mod environment;
mod environment_map;
mod mesh;
mod rectangle;
mod sphere;
pub mod tree;

pub use area::{Area, Asked, Density, SampleArea, SurfacePoint};
pub use delta::{Directional, Point, Spot, spot_versines};
pub use disc::DiscArea;
pub use environment::Environment;
pub use environment_map::{Arriving, EnvironmentMap};
pub use mesh::MeshArea;
pub use rectangle::RectangleArea;
pub use sphere::SphereLight;
pub use tree::LightTree;

use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// Which light of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LightId(pub u32);

impl LightId {
    /// The place in the scene's list.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Where light is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Reference<F> {
    /// The point.
    pub p: Vec3<F>,
    /// The unit normal on the side of the viewer: only light from its side counts.
    pub n: Vec3<F>,
}

/// A direction towards a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample<F: Lanes> {
    /// Unit direction towards the light.
    pub wi: Vec3<F>,
    /// The point on the light; meaningless where the light is infinitely far ([`Light::is_infinite`]).
    pub p: Vec3<F>,
    /// Incident radiance, W/(sr m^2); for delta lights incident irradiance on a surface facing the light, W/m^2.
    pub li: Rgb<F>,
    /// Density with respect to solid angle; 1 for delta lights.
    pub pdf: F,
    /// Where the light shines on the reference point at all, before any occlusion.
    pub valid: F::Mask,
}

/// Where a ray met an area light.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// The point.
    pub p: glam::Vec3,
    /// Unit geometric normal of the light there.
    pub ng: glam::Vec3,
    /// Which primitive.
    pub prim: u32,
}

/// Every kind of light.
#[derive(Clone, Debug)]
pub enum Light {
    /// A point that shines alike in all directions.
    Point(Point),
    /// A point that shines into a cone.
    Spot(Spot),
    /// Parallel light.
    Directional(Directional),
    /// A flat rectangle.
    Rectangle(Area<RectangleArea>),
    /// A flat disc.
    Disc(Area<DiscArea>),
    /// A sphere.
    Sphere(SphereLight),
    /// Triangles.
    Mesh(Area<MeshArea>),
    /// Light from infinity on all sides.
    Environment(Environment),
}

impl Light {
    /// A direction towards the light.
    #[inline(always)]
    pub fn sample<F: Lanes>(&self, at: Reference<F>, u2: [F; 2]) -> LightSample<F> {
        self.sample_part(at, None, u2)
    }

    /// As [`Self::sample`], towards the triangle `part` of a mesh, where one is given. Other lights have no parts.
    #[inline(always)]
    pub fn sample_part<F: Lanes>(
        &self,
        at: Reference<F>,
        part: Option<F::Int>,
        u2: [F; 2],
    ) -> LightSample<F> {
        match self {
            Self::Point(light) => light.sample(at),
            Self::Spot(light) => light.sample(at),
            Self::Directional(light) => light.sample(at),
            Self::Rectangle(light) => light.sample(at, None, u2),
            Self::Disc(light) => light.sample(at, None, u2),
            Self::Sphere(light) => light.sample(at, u2),
            Self::Mesh(light) => light.sample(at, part, u2),
            Self::Environment(light) => light.sample(at, u2),
        }
    }

    /// Density, with respect to solid angle, with which [`Self::sample`] draws the direction `wi`, along which a ray from
    /// the reference point met the light at `emitter` (absent for lights at infinity). Zero for delta lights.
    #[must_use]
    pub fn pdf(&self, at: Reference<f32>, wi: Vec3<f32>, emitter: Option<&Emitter>) -> f32 {
        self.density(at, wi, emitter, false)
    }

    /// As [`Self::pdf`], for [`Self::sample_part`] with the part that was met.
    #[must_use]
    pub fn pdf_part(&self, at: Reference<f32>, wi: Vec3<f32>, emitter: Option<&Emitter>) -> f32 {
        self.density(at, wi, emitter, true)
    }

    fn density(&self, at: Reference<f32>, wi: Vec3<f32>, emitter: Option<&Emitter>, is_part: bool) -> f32 {
        match (self, emitter) {
            (Self::Environment(light), _) => light.pdf(at, wi),
            (Self::Sphere(light), Some(_)) => light.pdf(at),
            (Self::Rectangle(light), Some(emitter)) => light.pdf(at, wi, emitter, false),
            (Self::Disc(light), Some(emitter)) => light.pdf(at, wi, emitter, false),
            (Self::Mesh(light), Some(emitter)) => light.pdf(at, wi, emitter, is_part),
            _ => 0.0,
        }
    }

    /// Whether no ray can meet the light by chance.
    #[must_use]
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Point(_) | Self::Spot(_) | Self::Directional(_))
    }

    /// Whether the light is infinitely far: its shadow rays have no end.
    #[must_use]
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Directional(_) | Self::Environment(_))
    }

    /// Emitted power in W, in luminance; `scene_radius` in metres bounds what light from infinity can reach.
    #[must_use]
    pub fn power(&self, scene_radius: f32) -> f32 {
        let disc = std::f32::consts::PI * scene_radius * scene_radius;
        match self {
            Self::Point(light) => light.power(),
            Self::Spot(light) => light.power(),
            Self::Directional(light) => light.irradiance.luminance() * disc,
            Self::Rectangle(light) => light.power(),
            Self::Disc(light) => light.power(),
            Self::Sphere(light) => light.power(),
            Self::Mesh(light) => light.power(),
            Self::Environment(light) => light.mean_luminance() * std::f32::consts::PI * disc * 4.0,
        }
    }
}
