//! Threads and hierarchies for one picture after the other.

use crate::accel::Brute;
use crate::accel::bvh::{self, Binary, BvhAccel, Hierarchy, Wide};
use crate::accel::embree::EmbreeAccel;
use crate::error::{Problem, Result};
use crate::geometry::World;
use crate::render::dispatch::{embree, hierarchy, plan, pool, with_accel};
use crate::render::tiles::{self, Plan};
use crate::render::{Checkpoint, Kept, Phase, Progress, Rendered, Settings, State};
use crate::scene::needs::capability::Capability;
use crate::scene::{Scene, description};
use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex};

/// Threads that render one picture after the other, and the hierarchy of the last one, which serves on while the world is the same.
#[derive(Debug)]
pub struct Studio {
    threads: usize,
    pool: rayon::ThreadPool,
    last: Option<Last>,
}

/// The hierarchy of the last picture, and what it was built of and how.
#[derive(Debug)]
struct Last {
    world: Arc<World>,
    how: (description::BuildQuality, bool),
    hierarchies: Hierarchies,
}

/// What of a scene says how hierarchies are built.
fn how(scene: &Scene) -> (description::BuildQuality, bool) {
    (scene.render.build_quality, scene.uses(Capability::RobustTraversal))
}

/// What finds hits, by what a scene may choose.
#[derive(Debug)]
enum Hierarchies {
    Embree(EmbreeAccel),
    Binary(BvhAccel<Binary>),
    Wide(BvhAccel<Wide>),
    Brute(Brute),
}

impl Studio {
    /// So many threads, or all processors.
    pub fn new(threads: Option<NonZeroUsize>) -> Result<Self> {
        let (threads, pool) = pool(threads)?;
        Ok(Self { threads, pool, last: None })
    }

    /// Gives up the hierarchy of the last picture, with its world.
    pub fn clear(&mut self) {
        self.last = None;
    }

    /// Renders as [`render_kept`](crate::render::render_kept) does, on the threads that are there, whatever the settings say of them.
    pub fn render(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        progress: &dyn Progress,
        kept: Kept<'_>,
    ) -> Result<Rendered> {
        let is_kept = kept.keeper.is_some() || kept.begin.is_some();
        let mut plan = plan(scene, settings, (progress, is_kept))?;
        plan.keeper = kept.keeper;
        if let Some((checkpoint, place)) = kept.begin {
            let State { film, course, .. } = plan.state();
            let tiles = tiles::tiles(plan.window);
            let state = checkpoint.state((film, course), &tiles, &plan.samples);
            let state = state.map_err(|what| Problem::at(place, what).remedy(Checkpoint::<&[u8]>::REMEDY))?;
            plan.begin = Mutex::new(Some(state));
        }
        let is_same = |last: &mut Last| {
            Arc::ptr_eq(&last.world, &scene.world)
                && last.how == how(scene)
                && last.hierarchies.is_of(scene.render.backend)
        };
        let (hierarchies, build) = match self.last.take_if(is_same) {
            Some(last) => (last.hierarchies, Phase::default()),
            None => {
                // First the old one goes: both need not fit into memory.
                self.last = None;
                let (built, build) = Phase::of(|| self.build(scene, progress));
                (built?, build)
            }
        };
        let rendered = hierarchies.trace(&plan, &self.pool);
        self.last = Some(Last { world: scene.world.clone(), how: how(scene), hierarchies });
        let mut rendered = rendered?;
        rendered.statistics.build = build;
        rendered.statistics.threads = self.threads;
        Ok(rendered)
    }

    /// The hierarchy of a world, built on the threads that then trace.
    fn build(&self, scene: &Scene, progress: &dyn Progress) -> Result<Hierarchies> {
        let world = &scene.world;
        Ok(match scene.render.backend {
            description::Backend::Embree => Hierarchies::Embree(embree(scene, self.threads, progress)?),
            description::Backend::Bvh2 => Hierarchies::Binary(hierarchy(world, &self.pool, progress)?),
            description::Backend::CwBvh => Hierarchies::Wide(hierarchy(world, &self.pool, progress)?),
            description::Backend::Brute => Hierarchies::Brute(Brute::new(world.clone())),
        })
    }
}

impl Hierarchies {
    fn is_of(&self, backend: description::Backend) -> bool {
        let own = match self {
            Self::Embree(_) => description::Backend::Embree,
            Self::Binary(_) => description::Backend::Bvh2,
            Self::Wide(_) => description::Backend::CwBvh,
            Self::Brute(_) => description::Backend::Brute,
        };
        own == backend
    }

    /// Takes all samples.
    fn trace(&self, plan: &Plan<'_>, pool: &rayon::ThreadPool) -> Result<Rendered> {
        let (traced, backend, isa) = match self {
            Self::Embree(accel) => {
                let isa = accel.device().isa().map_or("unknown", |isa| isa.name());
                let backend = format!("embree {}", accel.device().version());
                (pool.install(|| with_accel(plan, accel)), backend, isa)
            }
            Self::Binary(accel) => (pool.install(|| with_accel(plan, accel)), named(accel), accel.isa()),
            Self::Wide(accel) => (pool.install(|| with_accel(plan, accel)), named(accel), accel.isa()),
            Self::Brute(accel) => (pool.install(|| with_accel(plan, accel)), "brute".to_owned(), "scalar"),
        };
        let mut rendered = traced?;
        rendered.statistics.backend = backend;
        isa.clone_into(&mut rendered.statistics.isa);
        Ok(rendered)
    }
}

fn named<H: Hierarchy>(_: &BvhAccel<H>) -> String {
    format!("{} (obvhs {})", H::NAME, bvh::VERSION)
}
