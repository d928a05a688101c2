//! Threads and hierarchies, for one picture or for one after the other.

use crate::accel::Accel;
use crate::error::{Error, Place, Problem, Result};
use crate::geometry::World;
use crate::render::dispatch::{plan, with_accel};
use crate::render::hierarchies::{Hierarchies, How};
use crate::render::tiles;
use crate::render::{Checkpoint, Keeper, Phase, Progress, Rendered, Settings, State};
use crate::scene::Scene;
use std::fmt;
use std::io::Read;
use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex};
use std::thread;

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
    how: How,
    hierarchies: Hierarchies,
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

impl Studio {
    /// So many threads, or all processors.
    pub fn new(threads: Option<NonZeroUsize>) -> Result<Self> {
        let threads = threads.or_else(|| thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|i| format!("render {i}"))
            .build()
            .map_err(|error| Error::Backend { backend: "threads", what: error.to_string() })?;
        Ok(Self { threads, pool, last: None })
    }

    /// Gives up the hierarchy of the last picture, with its world.
    pub fn clear(&mut self) {
        self.last = None;
    }

    /// Renders as [`render_kept`] does, on the threads that are there, whatever the settings say of them.
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
        let how = How::of(scene);
        let is_same = |last: &mut Last| Arc::ptr_eq(&last.world, &scene.world) && last.how == how;
        let (hierarchies, build) = match self.last.take_if(is_same) {
            Some(last) => (last.hierarchies, Phase::default()),
            None => {
                // First the old one goes: both need not fit into memory.
                self.last = None;
                let on = (self.threads, &self.pool);
                let (built, build) = Phase::of(|| Hierarchies::build(scene, on, progress));
                (built?, build)
            }
        };
        let rendered = hierarchies.trace(&plan, &self.pool);
        self.last = Some(Last { world: scene.world.clone(), how, hierarchies });
        let mut rendered = rendered?;
        rendered.statistics.build = build;
        rendered.statistics.threads = self.threads;
        Ok(rendered)
    }
}

/// Renders a scene: builds the hierarchy, then takes all samples.
///
/// Fails if the crop lies outside the picture, the backend gives up, or `progress` says so.
pub fn render(scene: &Scene, settings: &Settings, progress: &dyn Progress) -> Result<Rendered> {
    render_kept(scene, settings, progress, Kept::default())
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
    let Studio { threads, pool, .. } = Studio::new(settings.threads)?;
    let mut rendered = pool.install(|| with_accel(&plan, accel))?;
    rendered.statistics.threads = threads;
    Ok(rendered)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bvh;
    use crate::render::{Silent, Statistics};
    use crate::scene;
    use crate::scene::description::{Backend, BuildQuality};

    fn scene() -> Scene {
        let text = "[film]\nwidth = 4\nheight = 2\n[render]\nspp = 1\n[materials.m]\ntype = 'diffuse'\n[[shapes]]\n\
            type = 'sphere'\nradius = 1.0\nmaterial = 'm'\n[[lights]]\ntype = 'environment'\nradiance = 1.0\n";
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.toml");
        std::fs::write(&path, text).expect("written");
        let loaded = scene::load(&path, &[]).expect("a scene file");
        scene::build(&loaded.description).expect("a scene").scene
    }

    const ALL: [Backend; 4] = [Backend::Embree, Backend::Bvh2, Backend::CwBvh, Backend::Brute];

    #[test]
    fn a_hierarchy_serves_on_while_it_would_be_built_the_same() {
        let (mut scene, mut studio) = (scene(), Studio::new(NonZeroUsize::new(1)).expect("threads"));
        let mut is_built = |backend, build_quality| {
            (scene.render.backend, scene.render.build_quality) = (backend, build_quality);
            let picture = studio.render(&scene, &Settings::default(), &Silent, Kept::default());
            picture.expect("a picture").statistics.build != Phase::default()
        };
        for backend in ALL {
            assert!(is_built(backend, BuildQuality::Medium), "{backend:?}: the first");
            assert!(!is_built(backend, BuildQuality::Medium), "{backend:?}: the same");
            let asks = backend == Backend::Embree;
            assert_eq!(is_built(backend, BuildQuality::High), asks, "{backend:?}: of another quality");
        }
    }

    #[test]
    fn checkpoints_and_statistics_tell_one_name_with_its_version() {
        let (mut scene, settings) =
            (scene(), Settings { threads: NonZeroUsize::new(1), ..Settings::default() });
        for backend in ALL {
            scene.render.backend = backend;
            let told = crate::render::backend(&scene).expect("a name");
            let Statistics { backend: name, isa, .. } =
                render(&scene, &settings, &Silent).expect("a picture").statistics;
            match backend {
                Backend::Embree => assert_eq!(told, format!("{name}, {isa}"), "Embree's kernels differ"),
                Backend::Brute => assert_eq!((told.as_str(), name.as_str()), ("brute", "brute"), "ours"),
                Backend::Bvh2 | Backend::CwBvh => {
                    assert_eq!(told, name, "the same everywhere");
                    assert!(told.ends_with(&format!(" (obvhs {})", bvh::VERSION)), "{told}");
                }
            }
        }
    }
}
