//! How rays are asked for where nobody says so: by what was measured (`benches/record/engines.md`).

use crate::integrator::Path;
use crate::math::lanes::{Level, Scalar};
use crate::scene::Scene;
use crate::scene::description::{Backend, FuzzyBy, Integrator, Query};

/// A way to ask for hits, and why it is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chosen {
    /// The way.
    pub query: Query,
    /// The reason, as half a sentence.
    pub why: &'static str,
}

/// How a scene is going to be rendered on this machine.
#[must_use]
pub fn query(scene: &Scene) -> Chosen {
    chosen(&scene.render)
}

/// What everything over lanes is run with: what the environment asks for, or the best there is.
#[must_use]
pub fn level() -> Level {
    Level::from_env().unwrap_or_else(|_| Level::best())
}

/// The name of what everything over lanes is run with. Pictures by different ones differ by rounding.
#[must_use]
pub fn lanes() -> &'static str {
    level().name()
}

/// What the shading of a scene is run with: paths side by side over the lanes that they are followed with, ray trees and single paths one
/// ray at a time.
#[must_use]
pub fn shading(scene: &Scene) -> Level {
    Path::followed_with(batches(scene))
}

/// What batches of a scene's samples are begun with, and paths are told.
pub(super) fn batches(scene: &Scene) -> Level {
    let is_wide = scene.render.integrator == Integrator::Path && query(scene).query != Query::Single;
    if is_wide { level() } else { Level::Scalar(Scalar) }
}

fn chosen(render: &crate::scene::description::Render) -> Chosen {
    let of = |query, why| Chosen { query, why };
    if render.integrator.is_ray_tree() && render.glossy == FuzzyBy::TwoPass {
        return of(Query::Single, "the first of two passes asks one ray at a time");
    }
    if let Some(query) = render.query {
        return of(query, "as asked for");
    }
    let has_packets = render.backend == Backend::Embree;
    if render.integrator == Integrator::Path {
        return of(Query::Stream, "paths are followed many at a time");
    }
    if has_packets {
        return of(Query::Stream, "camera and shadow rays are faster in packets");
    }
    of(Query::Single, "this backend has single rays only")
}
