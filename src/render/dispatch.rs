//! From what a user chose to the types that do it: the only place that knows both.

use crate::accel::Accel;
use crate::accel::bvh::{BvhAccel, Hierarchy, Options};
use crate::accel::embree::{BuildOptions, Config, Device, EmbreeAccel, EmbreeError, Quality, SceneOptions};
use crate::error::{Error, Place, Problem, Result};
use crate::film::{Filter, FilterShape};
use crate::geometry::World;
use crate::image::Window;
use crate::integrator::{Integrator, Path, Splitting, View, Whitted};
use crate::render::query::{query, shading};
use crate::render::schedule::PACKET;
use crate::render::tiles::{self, Engine, InBatches, InStreams, OneByOne, Plan, Traced};
use crate::render::two_pass;
use crate::render::{Checkpoint, Keeper, Outline, Progress, Rendered, Settings, Slice, Statistics, Studio};
use crate::sampling::SamplerKind;
use crate::scene::description::Query;
use crate::scene::needs::capability::Capability;
use crate::scene::{Scene, description};
use std::fmt;
use std::io::Read;
use std::num::{NonZeroU32, NonZeroUsize};
use std::ops::{ControlFlow, Range};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Instant;

/// Renders a scene: builds the hierarchy, then takes all samples.
///
/// Fails if the crop lies outside the picture, the backend gives up, or `progress` says so.
pub fn render(scene: &Scene, settings: &Settings, progress: &dyn Progress) -> Result<Rendered> {
    render_kept(scene, settings, progress, Kept::default())
}

/// A copy that was kept, and what it is called.
pub type Begin<'a> = (Checkpoint<Box<dyn Read + 'a>>, Place);

/// A picture that is not begun from nothing, or of which copies are kept.
#[derive(Default)]
pub struct Kept<'a> {
    /// A copy of the same picture, from which it goes on.
    pub begin: Option<Begin<'a>>,
    /// Who keeps copies.
    pub keeper: Option<&'a dyn Keeper>,
}

impl fmt::Debug for Kept<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Kept").field("begin", &self.begin.is_some()).finish_non_exhaustive()
    }
}

/// Renders a scene as [`render`] does, from where it was left, and keeps copies from which it can go on: the picture is that of one go,
/// to the bit.
///
/// Fails as [`render`] does, and if the copy cannot be read or the last one cannot be kept.
pub fn render_kept(
    scene: &Scene,
    settings: &Settings,
    progress: &dyn Progress,
    kept: Kept<'_>,
) -> Result<Rendered> {
    Studio::new(settings.threads)?.render(scene, settings, progress, kept)
}

/// What finds hits for a scene, as far as pixels depend on it: Embree's kernels of other versions and instruction sets meet edges elsewhere,
/// hierarchies of our own give the same answers on every machine.
pub fn backend(scene: &Scene) -> Result<String> {
    Ok(match scene.render.backend {
        description::Backend::Embree => {
            let device = Device::new(Config { threads: NonZeroU32::new(1), ..Config::from_env() });
            let device =
                device.map_err(|error| Error::Backend { backend: "embree", what: error.to_string() })?;
            format!("embree {}, {}", device.version(), device.isa().map_or("unknown", |isa| isa.name()))
        }
        other => other.word().to_owned(),
    })
}

/// Renders parts of a scene's picture on one hierarchy, one after the other: each is that part of the whole, bit for bit.
///
/// Fails as [`render`] does.
pub fn render_crops(
    scene: &Scene,
    settings: &Settings,
    crops: &[Window],
    progress: &dyn Progress,
) -> Result<Vec<Rendered>> {
    let mut studio = Studio::new(settings.threads)?;
    let of = |&crop: &Window| {
        let settings = Settings { crop: Some(crop), ..settings.clone() };
        studio.render(scene, &settings, progress, Kept::default())
    };
    let mut rendered: Vec<Rendered> = crops.iter().map(of).collect::<Result<_>>()?;
    // Built once, for all of them.
    if let Some(build) = rendered.first().map(|first| first.statistics.build) {
        rendered.iter_mut().for_each(|each| each.statistics.build = build);
    }
    Ok(rendered)
}

/// Which part of its picture a scene with these settings gives. Fails as [`render`] does, where settings are wrong.
pub fn outline(scene: &Scene, settings: &Settings) -> Result<Outline> {
    let spp = most(scene, settings);
    Ok(Outline {
        full: [scene.film.width, scene.film.height],
        window: window(scene, settings)?,
        layout: settings.layout.clone(),
        samples: samples(settings, spp)?,
        spp,
        has_limit: !settings.limits.is_none(),
    })
}

/// Renders a scene with something that finds hits in its world, whatever backend the scene names.
///
/// Fails as [`render`] does.
pub fn render_on<A: Accel>(
    scene: &Scene,
    settings: &Settings,
    accel: &A,
    progress: &dyn Progress,
) -> Result<Rendered> {
    let plan = plan(scene, settings, (progress, false))?;
    let (threads, pool) = pool(settings.threads)?;
    let mut rendered = pool.install(|| with_accel(&plan, accel))?;
    rendered.statistics.threads = threads;
    Ok(rendered)
}

pub(super) fn plan<'a>(
    scene: &'a Scene,
    settings: &Settings,
    (progress, is_kept): (&'a dyn Progress, bool),
) -> Result<Plan<'a>> {
    two_pass::check(scene, settings, is_kept)?;
    let seed = scene.render.seed;
    let most = most(scene, settings);
    let samples = samples(settings, most)?;
    Ok(Plan {
        scene,
        window: window(scene, settings)?,
        filter: filter(&scene.film),
        sampler: sampler(&scene.render, most),
        #[expect(clippy::cast_possible_truncation, reason = "both halves of the seed count")]
        seed: (seed ^ (seed >> 32)) as u32,
        moves: scene.is_moving(),
        layout: settings.layout.clone(),
        most,
        samples,
        limits: settings.limits,
        start: Instant::now(),
        progress,
        first_pass: settings.first_pass,
        keeper: None,
        begin: Mutex::new(None),
    })
}

/// Threads that render, and how many.
pub(super) fn pool(threads: Option<NonZeroUsize>) -> Result<(usize, rayon::ThreadPool)> {
    let threads = threads.or_else(|| thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|i| format!("render {i}"))
        .build()
        .map_err(|error| Error::Backend { backend: "threads", what: error.to_string() })?;
    Ok((threads, pool))
}

pub(super) fn embree(scene: &Scene, threads: usize, progress: &dyn Progress) -> Result<EmbreeAccel> {
    let threads = u32::try_from(threads).ok().and_then(NonZeroU32::new);
    let quality = match scene.render.build_quality {
        description::BuildQuality::Low => Quality::Low,
        description::BuildQuality::Medium => Quality::Medium,
        description::BuildQuality::High => Quality::High,
    };
    let robust = scene.uses(Capability::RobustTraversal);
    let options = BuildOptions {
        device: Config { threads, ..Config::from_env() },
        scene: SceneOptions { quality, robust, ..SceneOptions::default() },
    };
    let go_on = |_| if progress.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    EmbreeAccel::build_with(&scene.world, &options, &go_on).map_err(|error| match error {
        EmbreeError::Cancelled => Error::Interrupted,
        other => Error::Backend { backend: "embree", what: other.to_string() },
    })
}

/// A hierarchy built on these threads.
pub(super) fn hierarchy<H: Hierarchy>(
    world: &Arc<World>,
    pool: &rayon::ThreadPool,
    progress: &dyn Progress,
) -> Result<BvhAccel<H>> {
    let go_on = |_| if progress.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let accel = pool.install(|| BvhAccel::<H>::build_with(world, &Options::default(), &go_on));
    accel.ok_or(Error::Interrupted)
}

pub(super) fn with_accel<A: Accel>(plan: &Plan<'_>, accel: &A) -> Result<Rendered> {
    let settings = &plan.scene.render;
    let &description::Render { max_depth, min_throughput, split_depth: hits, .. } = settings;
    let splitting = Splitting { lights: settings.light_samples(), glossy: settings.glossy_samples(), hits };
    if settings.glossy == description::FuzzyBy::TwoPass {
        let tree = Whitted { max_depth, min_throughput, splitting, polished: true };
        return two_pass::render(plan, accel, &tree);
    }
    let tree = Whitted { max_depth, min_throughput, splitting, polished: false };
    let way = query(plan.scene).query;
    match settings.integrator {
        description::Integrator::Whitted | description::Integrator::Distribution => {
            with_integrator(plan, accel, &tree, way)
        }
        description::Integrator::Path => {
            let level = shading(plan.scene);
            let sampler = plan.sampler.times(settings.path_splits);
            let path = Path::new(plan.scene, (sampler, plan.seed), (level, way != Query::Packet))
                .splitting(plan.layout.splits());
            let size = if way == Query::Single { 1 } else { (BATCH / settings.path_splits).max(1) };
            timed(plan, accel, &InBatches { path: &path, size })
        }
        description::Integrator::View => {
            let view = match settings.view {
                description::View::Normals => View::Normals,
                description::View::ShadingNormals => View::ShadingNormals,
                description::View::Depth => View::Depth,
                description::View::Uv => View::Uv,
                description::View::Material => View::Material,
                description::View::Cost => View::Cost(tree),
            };
            with_integrator(plan, accel, &view, way)
        }
    }
}

fn with_integrator<A: Accel, I: Integrator>(
    plan: &Plan<'_>,
    accel: &A,
    integrator: &I,
    way: Query,
) -> Result<Rendered> {
    let size = match way {
        Query::Single => return timed(plan, accel, &OneByOne(integrator)),
        Query::Packet => PACKET,
        Query::Stream => TREES,
    };
    timed(plan, accel, &InStreams { integrator, size })
}

fn timed<A: Accel, E: Engine>(plan: &Plan<'_>, accel: &A, engine: &E) -> Result<Rendered> {
    let Traced { film, counters, ended, estimate, spent: render } = tiles::trace(plan, accel, engine)?;
    let samples = film.samples();
    let hierarchy_bytes = accel.bytes();
    Ok(Rendered {
        film,
        first_pass: Vec::new(),
        statistics: Statistics {
            counters,
            first: plan.samples.start,
            samples,
            ended,
            estimate,
            render,
            hierarchy_bytes,
            ..Statistics::default()
        },
    })
}

/// Camera samples that are followed side by side: flat from 1000 to 4000.
const BATCH: u32 = 2048;

/// Samples of a pixel where something else is to end the picture, and the scene does not say.
pub const MOST: u32 = 1 << 16;

/// Camera samples of ray trees that are taken together: many have many rays towards lights.
const TREES: u32 = 256;

fn window(scene: &Scene, settings: &Settings) -> Result<Window> {
    let [width, height] = [scene.film.width, scene.film.height];
    let whole = Window { x0: 0, y0: 0, x1: width, y1: height };
    let window = settings.crop.unwrap_or(whole);
    if window.is_empty() || !window.fits(width, height) {
        let Window { x0, y0, x1, y1 } = window;
        let problem = Problem::new(format!("the crop {x0},{y0},{x1},{y1} is not a part of the picture"));
        return Err(problem.remedy(format!("stay within 0,0,{width},{height}, upper ends excluded")).into());
    }
    Ok(window)
}

/// Which samples of `most` are to be taken.
fn samples(settings: &Settings, most: u32) -> Result<Range<u32>> {
    let Some(slice) = settings.slice else { return Ok(0..most) };
    let samples = slice.samples(most);
    let Slice { index, of } = slice;
    let (what, remedy) = if index >= of {
        (format!("there is no slice {index} of {of}"), "count slices from 0")
    } else if !settings.limits.is_none() {
        let what = "slices of a picture whose number of samples is not known beforehand".to_owned();
        (what, "set the number of samples instead of a limit of time or a target for the error")
    } else if samples.is_empty() {
        (format!("{most} samples cannot be cut into {of} slices"), "take fewer slices, or more samples")
    } else {
        return Ok(samples);
    };
    Err(Problem::new(what).remedy(remedy).into())
}

/// How many samples a pixel gets at most.
fn most(scene: &Scene, settings: &Settings) -> u32 {
    if settings.limits.is_none() { scene.render.spp() } else { scene.render.spp.unwrap_or(MOST) }
}

fn sampler(render: &description::Render, spp: u32) -> SamplerKind {
    match render.sampler {
        description::Sampler::Sobol => SamplerKind::OwenSobol,
        description::Sampler::Independent => SamplerKind::Independent,
        description::Sampler::Stratified => SamplerKind::Stratified { spp },
        description::Sampler::BlueNoise => SamplerKind::BlueNoise { spp },
    }
}

fn filter(film: &description::Film) -> Filter {
    let shape = match film.filter {
        description::Filter::Box => FilterShape::Box,
        description::Filter::Tent => FilterShape::Tent,
        description::Filter::Gaussian => FilterShape::Gaussian,
        description::Filter::Mitchell => FilterShape::Mitchell,
    };
    Filter::new(shape, film.filter_radius.unwrap_or(film.filter.default_radius()))
}
