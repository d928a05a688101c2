//! From rays to radiance.
//!
//! An [`Integrator`] is a function of scene, ray and random numbers. What it must write besides its answer, counts and
//! scratch memory, belongs to one thread: [`Worker`].

mod cone;
mod counters;
mod deferred;
mod direct;
mod features;
mod first_pass;
mod path;
mod relief;
mod shading;
mod splitting;
mod view;
mod whitted;

pub use counters::Counters;
pub use deferred::Deferred;
pub use features::Features;
pub use first_pass::{FirstPass, Reflection};
pub use path::{Path, Wave};
pub use splitting::Splitting;
pub use view::View;
pub use whitted::Whitted;

use cone::Beam;

use crate::accel::Accel;
use crate::geometry::{Hit, Interaction, Ray};
use crate::material::{Material, Media};
use crate::math::Rgb;
use crate::sampling::Sampler;
use crate::scene::Scene;
use glam::Vec3;

/// What one camera ray brings home.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radiance {
    /// Radiance, W/(sr m^2), or what a view shows.
    pub color: Rgb<f32>,
    /// The part of it that came by [`DIRECT`] edges at most: emission seen directly, and light that one surface scattered. What a
    /// view shows is direct.
    pub direct: Rgb<f32>,
    /// 1 where a surface was hit, 0 where not.
    pub alpha: f32,
}

/// Edges of the longest path of direct light: from the eye to a surface, and from there to a light.
pub const DIRECT: u32 = 2;

impl Radiance {
    /// Nothing that was hit.
    pub const NOTHING: Self = Self { color: Rgb::BLACK, direct: Rgb::BLACK, alpha: 0.0 };

    /// Adds light that came by so many edges.
    #[inline]
    pub fn add(&mut self, light: Rgb<f32>, edges: u32) {
        self.color += light;
        if edges <= DIRECT {
            self.direct += light;
        }
    }
}

/// A frozen scene, and what finds hits in it.
#[derive(Debug)]
pub struct Stage<'a, A> {
    /// The scene.
    pub scene: &'a Scene,
    /// The backend, built from the scene's world.
    pub accel: &'a A,
    /// What the camera stands in.
    pub eye_media: Media,
    /// Where surfaces show pictures, what the widths of rays follow from.
    beam: Option<Beam>,
}

impl<'a, A> Stage<'a, A> {
    /// Of a scene, with what finds hits in it, and the camera in the open. So many samples a pixel gets at most: the more, the finer
    /// pictures on surfaces are looked at.
    pub fn new(scene: &'a Scene, accel: &'a A, spp: u32) -> Self {
        Self { scene, accel, eye_media: Media::default(), beam: Beam::of(scene, spp) }
    }

    /// The same with the camera in these media.
    #[must_use]
    pub fn within(&self, eye_media: Media) -> Self {
        Self { eye_media, ..*self }
    }
}

/// What one thread writes to.
#[derive(Debug, Default)]
pub struct Worker {
    /// How often what happened.
    pub counters: Counters,
    /// Branches of the ray tree still to be followed; empty between camera rays.
    pub(crate) pending: Vec<whitted::Node>,
    /// Rays towards lights that wait to be traced; where there is no such list they are traced at once.
    pub deferred: Option<Deferred>,
}

/// A ray from the camera, with a unit direction.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// The ray.
    pub ray: Ray,
    /// What it hits, where that has been found already.
    pub found: Option<Option<Hit>>,
}

impl CameraRay {
    /// What the ray hits.
    #[inline]
    pub fn hit<A: Accel>(&self, accel: &A) -> Option<Hit> {
        self.found.unwrap_or_else(|| accel.intersect(&self.ray))
    }
}

/// From a camera ray to radiance.
pub trait Integrator: Sync {
    /// The radiance that arrives along a camera ray, but for that of rays which the worker has deferred. Depends on scene, ray
    /// and `sampler` alone.
    fn li<A: Accel, S: Sampler<I = u32>>(
        &self,
        stage: &Stage<'_, A>,
        camera: &CameraRay,
        sampler: &S,
        worker: &mut Worker,
    ) -> Radiance;
}

/// The first tangent of a surface that is not the same in all directions.
fn tangent(scene: &Scene, it: &Interaction, material: &Material) -> Option<Vec3> {
    let (sin, cos) = material.scattering.turn()?.sin_cos();
    let x = scene.world.tangent(it);
    Some(x * cos + it.ns.cross(x) * sin)
}
