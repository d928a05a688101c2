//! A property of the first surface, for looking at a scene.

use crate::accel::Accel;
use crate::geometry::Interaction;
use crate::integrator::{CameraRay, Integrator, Radiance, Stage, Whitted, Worker, relief};
use crate::math::Rgb;
use crate::sampling::Sampler;
use glam::Vec3;

/// What to show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// Geometric normals, each component from [-1, 1] to [0, 1].
    Normals,
    /// Shading normals, alike.
    ShadingNormals,
    /// Distance from the camera in metres.
    Depth,
    /// Surface parameters as red and green.
    Uv,
    /// A colour per material.
    Material,
    /// How many rays the ray tree needs, all kinds counted.
    Cost(Whitted),
}

impl Integrator for View {
    fn li<A: Accel, S: Sampler<I = u32>>(
        &self,
        stage: &Stage<'_, A>,
        camera: &CameraRay,
        sampler: &S,
        worker: &mut Worker,
    ) -> Radiance {
        if let Self::Cost(whitted) = self {
            let before = worker.counters.rays();
            // What waits would add its light to the number later.
            let waiting = worker.deferred.take();
            let radiance = whitted.li(stage, camera, sampler, worker);
            worker.deferred = waiting;
            #[expect(clippy::cast_precision_loss, reason = "rays of one sample")]
            let rays = (worker.counters.rays() - before) as f32;
            return Radiance { color: Rgb::gray(rays), direct: Rgb::gray(rays), ..radiance };
        }
        worker.counters.camera += 1;
        let Some(hit) = camera.hit(stage.accel) else { return Radiance::NOTHING };
        let it = stage.scene.world.interaction(&camera.ray, &hit);
        let color = self.show(stage, &it);
        Radiance { color, direct: color, alpha: 1.0 }
    }
}

impl View {
    fn show<A: Accel>(&self, stage: &Stage<'_, A>, it: &Interaction) -> Rgb<f32> {
        match self {
            Self::Normals => as_color(it.ng),
            Self::ShadingNormals => {
                let (_, material) = stage.scene.material(it);
                let spot = it.uv.to_array().into();
                as_color(relief::normal(stage.scene, it, material, spot).unwrap_or(it.ns))
            }
            Self::Depth | Self::Cost(_) => Rgb::gray(it.t),
            Self::Uv => Rgb::new(it.uv.x, it.uv.y, 0.0),
            Self::Material => distinct(stage.scene.material(it).0.0),
        }
    }
}

fn as_color(n: Vec3) -> Rgb<f32> {
    (n * 0.5 + 0.5).to_array().into()
}

/// Colours far apart for neighbouring numbers: hues a golden section apart.
fn distinct(index: u32) -> Rgb<f32> {
    #[expect(clippy::cast_precision_loss, reason = "a hue")]
    let hue = (index as f32 * 0.618_034).fract() * 6.0;
    let channel =
        |shift: f32| 0.15 + 0.75 * (((hue + shift).rem_euclid(6.0) - 3.0).abs() - 1.0).clamp(0.0, 1.0);
    Rgb::new(channel(0.0), channel(4.0), channel(2.0))
}
