//! What a camera ray sees, for denoisers and for compositing: no light, but where it comes from.
//!
//! Place, depth, geometric normal, object and material are of the first surface. Albedo and shading normal are of the first one that is not
//! polished: a mirror shows those of what it mirrors, tinted, and glass those of what is behind it or what it mirrors, whichever
//! brings more. That is what denoisers want to know (Intel Open Image Denoise, documentation of auxiliary images). Where the scene's film
//! does not want polished surfaces followed, all is of the first one.

use super::whitted::{Arrival, Node, arrive};
use crate::accel::Accel;
use crate::bsdf::{Branch, Lobes, Mix};
use crate::geometry::PlacementId;
use crate::integrator::shading::Shading;
use crate::integrator::{CameraRay, Stage, Worker, relief, tangent};
use crate::material::MaterialId;
use crate::math::{Rgb, Vec3};
use crate::texture::Spot;
use glam::{Vec2, Vec3 as Point};
use std::f32::consts::PI;

/// What is seen along a camera ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Features {
    /// The part of white light that comes back, in [0, 1]; of what shines its radiance, at most 1.
    pub albedo: Rgb<f32>,
    /// Unit shading normal towards the viewer, in the world.
    pub normal: Point,
    /// Unit geometric normal towards the viewer, in the world.
    pub geometric_normal: Point,
    /// Distance from the eye in metres.
    pub depth: f32,
    /// Place in the world, in metres, counted as the scene's files do, whatever the scene is counted from itself.
    pub position: Point,
    /// Surface parameters.
    pub uv: Vec2,
    /// What was hit.
    pub object: PlacementId,
    /// What it is made of.
    pub material: MaterialId,
}

/// Polished surfaces in a row that are followed.
const MOST_POLISHED: u32 = 16;

impl Features {
    /// Of one camera ray; `None` where it hits nothing. Where nobody asks for `colours`, albedo and normal are those of nothing in particular.
    #[must_use]
    pub fn of<A: Accel>(stage: &Stage<'_, A>, camera: &CameraRay, colours: bool) -> Option<Self> {
        let mut worker = Worker::default();
        let mut node = Node::of_camera(stage, camera);
        let first = arrive(stage, &mut node, &mut worker)?;
        let towards = |n: Point, wo: Point| if n.dot(wo) < 0.0 { -n } else { n };
        let it = &first.it;
        let mut features = Self {
            albedo: Rgb::BLACK,
            normal: towards(it.ns, it.wo),
            geometric_normal: towards(it.ng, it.wo),
            depth: it.p.distance(camera.ray.o),
            position: (it.p.as_dvec3() + stage.scene.origin).as_vec3(),
            uv: it.uv,
            object: it.placement,
            material: stage.scene.material(it).0,
        };
        if !colours {
            return Some(features);
        }
        let mut tint = Rgb::WHITE;
        let mut arrival = first;
        for _ in 0..MOST_POLISHED {
            let spot = node.spot(stage, &arrival.it);
            let seen = Seen::of(stage, &arrival, spot, stage.scene.film.follow_polished);
            features.normal = seen.normal;
            features.albedo = tint * seen.albedo;
            let Some((branch, d)) = seen.polished else { return Some(features) };
            tint *= branch.weight;
            features.albedo = tint;
            node.pass(stage, &arrival, (d, branch.transmission));
            let Some(next) = arrive(stage, &mut node, &mut worker) else { return Some(features) };
            arrival = next;
        }
        Some(features)
    }
}

/// A surface by itself.
struct Seen {
    albedo: Rgb<f32>,
    normal: Point,
    /// The heavier way on, and its direction in the world, where there is nothing but such ways.
    polished: Option<(Branch<f32>, Point)>,
}

impl Seen {
    fn of<A: Accel>(stage: &Stage<'_, A>, arrival: &Arrival, spot: Spot<f32>, follow: bool) -> Self {
        let mut it = arrival.it;
        let (_, material) = stage.scene.material(&it);
        let emitted = material.emitted(it.is_front(), spot);
        if let Some(ns) = relief::normal(stage.scene, &it, material, spot) {
            it.ns = ns;
        }
        let shading = Shading::at(&it, tangent(stage.scene, &it, material));
        let normal = shading.frame.z.into();
        let Some(mix) = material.bsdf(spot, arrival.eta) else {
            return Self { albedo: limited(emitted), normal, polished: None };
        };
        if follow && emitted.is_black() && !mix.lobes().intersects(Lobes::DIFFUSE | Lobes::GLOSSY) {
            let branches = mix.parts().flat_map(|part| {
                let scaled =
                    move |branch: Branch<f32>| Branch { weight: branch.weight * part.weight, ..branch };
                part.bsdf.branches(shading.wo).into_iter().flatten().map(scaled)
            });
            let heaviest = branches
                .filter(|branch| branch.valid)
                .max_by(|a, b| a.weight.max_channel().total_cmp(&b.weight.max_channel()));
            let polished = heaviest.map(|branch| (branch, shading.to_world(branch.wi).into()));
            return Self { albedo: Rgb::BLACK, normal, polished };
        }
        Self { albedo: limited(emitted + albedo(&mix, shading.wo)), normal, polished: None }
    }
}

/// About what comes back of white light: exact for matt surfaces, for glossy lobes what their middle sample weighs.
fn albedo(mix: &Mix<f32>, wo: Vec3<f32>) -> Rgb<f32> {
    let mut sum = Rgb::BLACK;
    for part in mix.parts() {
        let bsdf = &part.bsdf;
        let mut own = bsdf.eval_diffuse(wo, Vec3::new(0.0, 0.0, 1.0)).scale(PI);
        for sample in bsdf.sample_glossy(wo, [0.5; 2]).into_iter().flatten().filter(|sample| sample.valid) {
            own += sample.weight;
        }
        for branch in bsdf.branches(wo).into_iter().flatten().filter(|branch| branch.valid) {
            own += branch.weight;
        }
        sum += part.weight * own;
    }
    sum
}

fn limited(color: Rgb<f32>) -> Rgb<f32> {
    Rgb::new(color.r.clamp(0.0, 1.0), color.g.clamp(0.0, 1.0), color.b.clamp(0.0, 1.0))
}
