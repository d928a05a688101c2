//! The backends that there are, each to be asked in every way.

#![allow(dead_code, reason = "each test program uses a part")]

use crate::queries::{Answers, Kind};
use specula::accel::bvh::Options;
use specula::accel::embree::{BuildOptions, Config, EmbreeAccel, Isa, Quality, SceneOptions};
use specula::accel::{Accel, Bvh2Accel, CwBvhAccel};
use specula::geometry::{Ray, World};
use specula::math::Aabb;
use std::sync::Arc;

/// Answers to rays by every kind of query.
type Ask = Box<dyn Fn(&[Ray]) -> Vec<Answers>>;

/// A backend built from a world.
pub(crate) struct Backend {
    pub(crate) name: &'static str,
    pub(crate) bounds: Aabb,
    ask: Ask,
}

impl Backend {
    fn new<A: Accel + 'static>(name: &'static str, accel: A) -> Self {
        Self { name, bounds: accel.bounds(), ask: Box::new(move |rays| all_kinds(&accel, rays)) }
    }

    /// The answers to `rays` by every kind of query.
    pub(crate) fn ask(&self, rays: &[Ray]) -> Vec<Answers> {
        (self.ask)(rays)
    }
}

/// All backends but the oracle, in all ways of building them that change what they do with a ray.
pub(crate) fn backends(world: &Arc<World>) -> Vec<Backend> {
    let embree = |name, max_isa, scene| {
        let device = Config { max_isa, ..Config::default() };
        Backend::new(name, EmbreeAccel::build(world, &BuildOptions { device, scene }).expect("built"))
    };
    let fast = SceneOptions::default();
    let robust = SceneOptions { robust: true, ..fast };
    vec![
        embree("embree", None, fast),
        embree("embree robust", None, robust),
        embree("embree compact", None, SceneOptions { compact: true, ..fast }),
        embree("embree high", None, SceneOptions { quality: Quality::High, ..fast }),
        embree("embree sse2", Some(Isa::Sse2), fast),
        embree("embree sse2 robust", Some(Isa::Sse2), robust),
        embree("embree quads", None, SceneOptions { quads: true, ..fast }),
        embree("embree avx robust quads", Some(Isa::Avx), SceneOptions { quads: true, ..robust }),
        embree(
            "embree sse2 compact quads",
            Some(Isa::Sse2),
            SceneOptions { compact: true, quads: true, ..fast },
        ),
        Backend::new("bvh2", Bvh2Accel::build(world, &Options::default())),
        Backend::new("cwbvh", CwBvhAccel::build(world, &Options::default())),
    ]
}

/// The answers of every kind of query.
pub(crate) fn all_kinds<A: Accel>(accel: &A, rays: &[Ray]) -> Vec<Answers> {
    Kind::all().into_iter().map(|kind| kind.answers(accel, rays)).collect()
}
