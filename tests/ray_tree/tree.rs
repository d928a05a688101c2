//! Ray trees along single rays, in scenes with known answers.

use glam::Vec3;
use specula::accel::Brute;
use specula::geometry::Ray;
use specula::integrator::{CameraRay, Counters, Integrator, Radiance, Splitting, Stage, Whitted, Worker};
use specula::sampling::SamplerKind;
use specula::scene::Scene;

/// What arrives along one ray.
pub(crate) fn trace(scene: &Scene, whitted: Whitted, ray: Ray, index: u32) -> (Radiance, Counters) {
    let accel = Brute::new(scene.world.clone());
    let stage = Stage::new(scene, &accel, scene.render.spp());
    let mut worker = Worker::default();
    let sampler = SamplerKind::Independent.start(1, [0_u32, 0], index);
    let found = whitted.li(&stage, &CameraRay { ray, found: None }, &sampler, &mut worker);
    (found, worker.counters)
}

/// The tree without splitting.
pub(crate) const fn whitted(max_depth: u32, min_throughput: f32) -> Whitted {
    Whitted { max_depth, min_throughput, splitting: Splitting::NONE, polished: false }
}

/// A ray that meets the unit sphere at the origin at `theta` degrees from the normal.
pub(crate) fn at_angle(theta_deg: f64) -> Ray {
    #[expect(clippy::cast_possible_truncation, reason = "a test's ray")]
    let offset = theta_deg.to_radians().sin() as f32;
    Ray::new(Vec3::new(offset, 0.0, 3.0), -Vec3::Z)
}

/// Exact reflectance of glass, in double precision.
pub(crate) fn fresnel(theta_deg: f64, n: f64) -> f64 {
    let c = theta_deg.to_radians().cos();
    let t = (1.0 - (1.0 - c * c) / (n * n)).sqrt();
    let (s, p) = ((c - n * t) / (c + n * t), (n * c - t) / (n * c + t));
    (s * s + p * p) / 2.0
}

/// A ball of glass in light that is the same from everywhere.
pub(crate) const BALL_IN_FURNACE: &str = r#"
    [materials.glass]
    type = "dielectric"
    ior = 1.5
    [[shapes]]
    type = "sphere"
    material = "glass"
    [[lights]]
    type = "environment"
    radiance = 1.0
"#;

/// Two parallel mirrors of this reflectance, which shine with a radiance of 1.
pub(crate) fn mirrors(k: f64) -> String {
    format!(
        r#"
        [materials.wall]
        type = "mirror"
        reflectance = {k:?}
        emission = 1.0
        [[shapes]]
        type = "rectangle"
        center = [0.0, 0.0, 1.0]
        edge_u = [0.0, 1.0, 0.0]
        edge_v = [1.0, 0.0, 0.0]
        material = "wall"
        [[shapes]]
        type = "rectangle"
        center = [0.0, 0.0, -1.0]
        edge_u = [1.0, 0.0, 0.0]
        edge_v = [0.0, 1.0, 0.0]
        material = "wall"
        "#
    )
}
