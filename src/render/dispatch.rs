//! From settings to what takes samples: the plan of a picture, and its integrator. `hierarchies.rs` does the same for what finds hits.

use crate::accel::Accel;
use crate::error::{Problem, Result};
use crate::film::{Filter, FilterShape};
use crate::image::Window;
use crate::integrator::{Integrator, Path, Splitting, View, Whitted};
use crate::render::query::{batches, query};
use crate::render::schedule::PACKET;
use crate::render::tiles::{self, Engine, InBatches, InStreams, OneByOne, Plan, Traced};
use crate::render::two_pass;
use crate::render::{Outline, Progress, Rendered, Settings, Slice, Statistics};
use crate::sampling::SamplerKind;
use crate::scene::description::Query;
use crate::scene::{Scene, description};
use std::ops::Range;
use std::sync::Mutex;
use std::time::Instant;

/// Which part of its picture a scene with these settings gives. Fails as [`render`](crate::render::render) does, where settings are
/// wrong.
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

/// The plan of a picture, whose first sample is yet to be taken; `is_kept` where copies of it are, or it goes on from one.
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

/// Takes all samples, on the threads of the current pool.
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
            let level = batches(plan.scene);
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
