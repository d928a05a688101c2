//! From what a scene chose to find hits with to the types that do it: built, named, and handed to integrators.

use crate::accel::Brute;
use crate::accel::bvh::{self, Binary, BvhAccel, Hierarchy, Options, Wide};
use crate::accel::embree::{BuildOptions, Config, Device, EmbreeAccel, EmbreeError, Quality, SceneOptions};
use crate::error::{Error, Result};
use crate::geometry::World;
use crate::render::dispatch::with_accel;
use crate::render::tiles::Plan;
use crate::render::{Progress, Rendered};
use crate::scene::Scene;
use crate::scene::description::{Backend, BuildQuality};
use crate::scene::needs::capability::Capability;
use std::num::NonZeroU32;
use std::ops::ControlFlow;
use std::sync::{Arc, OnceLock};

/// What finds hits, by what a scene may choose.
#[derive(Debug)]
pub(super) enum Hierarchies {
    Embree(EmbreeAccel),
    Binary(BvhAccel<Binary>),
    Wide(BvhAccel<Wide>),
    Brute(Brute),
}

/// What of a scene, besides its world, says how hierarchies are built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct How {
    backend: Backend,
    /// What only Embree asks: how well, and whether robust.
    embree: Option<(BuildQuality, bool)>,
}

impl How {
    pub(super) fn of(scene: &Scene) -> Self {
        let backend = scene.render.backend;
        let embree = (scene.render.build_quality, scene.uses(Capability::RobustTraversal));
        Self { backend, embree: (backend == Backend::Embree).then_some(embree) }
    }
}

impl Hierarchies {
    /// Those of a scene, built on the threads that then trace.
    pub(super) fn build(
        scene: &Scene,
        (threads, pool): (usize, &rayon::ThreadPool),
        progress: &dyn Progress,
    ) -> Result<Self> {
        let world = &scene.world;
        Ok(match scene.render.backend {
            Backend::Embree => Self::Embree(embree(scene, threads, progress)?),
            Backend::Bvh2 => Self::Binary(hierarchy(world, pool, progress)?),
            Backend::CwBvh => Self::Wide(hierarchy(world, pool, progress)?),
            Backend::Brute => Self::Brute(Brute::new(world.clone())),
        })
    }

    /// Takes all samples of a picture of the scene that they were built of.
    pub(super) fn trace(&self, plan: &Plan<'_>, pool: &rayon::ThreadPool) -> Result<Rendered> {
        let (traced, isa) = match self {
            Self::Embree(accel) => (pool.install(|| with_accel(plan, accel)), told(accel.device()).isa),
            Self::Binary(accel) => (pool.install(|| with_accel(plan, accel)), accel.isa()),
            Self::Wide(accel) => (pool.install(|| with_accel(plan, accel)), accel.isa()),
            Self::Brute(accel) => (pool.install(|| with_accel(plan, accel)), "scalar"),
        };
        let mut rendered = traced?;
        rendered.statistics.backend = name(plan.scene.render.backend)?;
        isa.clone_into(&mut rendered.statistics.isa);
        Ok(rendered)
    }
}

/// What finds hits for a scene, as far as pixels depend on it: Embree's kernels of other versions and instruction sets meet edges elsewhere,
/// hierarchies of one version of ours give the same answers on every machine.
pub fn backend(scene: &Scene) -> Result<String> {
    told_of(scene.render.backend)
}

/// The same of all that there are; of one that cannot be used here, why.
#[must_use]
pub fn backends() -> Vec<String> {
    Backend::ALL.iter().map(|&backend| told_of(backend).unwrap_or_else(|error| error.to_string())).collect()
}

/// A backend, with all that pixels depend on.
fn told_of(backend: Backend) -> Result<String> {
    let name = name(backend)?;
    Ok(if backend == Backend::Embree { format!("{name}, {}", library()?.isa) } else { name })
}

/// A backend, with its version.
fn name(backend: Backend) -> Result<String> {
    Ok(match backend {
        Backend::Embree => format!("embree {}", library()?.version),
        Backend::Bvh2 | Backend::CwBvh => format!("{} (obvhs {})", backend.word(), bvh::VERSION),
        Backend::Brute => backend.word().to_owned(),
    })
}

/// What there is to tell of Embree: the same of all devices of a process.
#[derive(Debug)]
struct Library {
    version: String,
    isa: &'static str,
}

static LIBRARY: OnceLock<Library> = OnceLock::new();

/// By the first device that is asked.
fn told(device: &Device) -> &'static Library {
    LIBRARY.get_or_init(|| Library {
        version: device.version(),
        isa: device.isa().map_or("unknown", |isa| isa.name()),
    })
}

/// By a device of its own, if there was none before.
fn library() -> Result<&'static Library> {
    if let Some(library) = LIBRARY.get() {
        return Ok(library);
    }
    let config = Config { threads: NonZeroU32::new(1), ..Config::from_env() };
    Device::new(config).map(|device| told(&device)).map_err(failed)
}

fn failed(error: EmbreeError) -> Error {
    match error {
        EmbreeError::Cancelled => Error::Interrupted,
        other => Error::Backend { backend: "embree", what: other.to_string() },
    }
}

fn embree(scene: &Scene, threads: usize, progress: &dyn Progress) -> Result<EmbreeAccel> {
    let threads = u32::try_from(threads).ok().and_then(NonZeroU32::new);
    let quality = match scene.render.build_quality {
        BuildQuality::Low => Quality::Low,
        BuildQuality::Medium => Quality::Medium,
        BuildQuality::High => Quality::High,
    };
    let robust = scene.uses(Capability::RobustTraversal);
    let options = BuildOptions {
        device: Config { threads, ..Config::from_env() },
        scene: SceneOptions { quality, robust, ..SceneOptions::default() },
    };
    EmbreeAccel::build_with(&scene.world, &options, &|_| go_on(progress)).map_err(failed)
}

/// A hierarchy of ours, built on these threads.
fn hierarchy<H: Hierarchy>(
    world: &Arc<World>,
    pool: &rayon::ThreadPool,
    progress: &dyn Progress,
) -> Result<BvhAccel<H>> {
    let accel = pool.install(|| BvhAccel::<H>::build_with(world, &Options::default(), &|_| go_on(progress)));
    accel.ok_or(Error::Interrupted)
}

fn go_on(progress: &dyn Progress) -> ControlFlow<()> {
    if progress.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}
