//! The ways of building a hierarchy that race.

use super::query::{Query, Tracer};
use crate::accel::Brute;
use crate::accel::bvh::{self, Binary, BvhAccel, Hierarchy, Options, Preset, Wide};
use crate::accel::embree::{BuildOptions, Config, EmbreeAccel, EmbreeError, Quality, SceneOptions};
use crate::error::{Error, Result};
use crate::geometry::World;
use crate::scene::description::Backend;
use std::num::NonZeroU32;
use std::ops::ControlFlow;
use std::sync::Arc;

/// A backend and all that is chosen about its hierarchy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contestant {
    /// Embree.
    Embree(SceneOptions),
    /// obvhs, binary.
    Bvh2(Preset),
    /// obvhs, eight wide.
    CwBvh(Preset),
    /// No hierarchy.
    Brute,
}

impl Contestant {
    /// All of them. The first is what the others are compared with.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let plain = SceneOptions::default();
        let embree = [
            plain,
            SceneOptions { robust: true, ..plain },
            SceneOptions { compact: true, ..plain },
            SceneOptions { robust: true, compact: true, ..plain },
            SceneOptions { quality: Quality::Low, ..plain },
            SceneOptions { quality: Quality::High, ..plain },
        ];
        let embree = embree.into_iter().map(Self::Embree);
        let obvhs = Preset::ALL.into_iter().map(Self::Bvh2).chain(Preset::ALL.into_iter().map(Self::CwBvh));
        embree.chain(obvhs).chain([Self::Brute]).collect()
    }

    /// Those of a quick look: Embree as it comes and robust, the hierarchies as they come.
    #[must_use]
    pub fn is_quick(&self) -> bool {
        match self {
            Self::Embree(options) => options.quality == Quality::Medium && !options.compact,
            Self::Bvh2(preset) | Self::CwBvh(preset) => *preset == Preset::default(),
            Self::Brute => true,
        }
    }

    /// The backend.
    #[must_use]
    pub fn backend(&self) -> Backend {
        match self {
            Self::Embree(_) => Backend::Embree,
            Self::Bvh2(_) => Backend::Bvh2,
            Self::CwBvh(_) => Backend::CwBvh,
            Self::Brute => Backend::Brute,
        }
    }

    /// The backend's word and what is chosen: `embree-medium`, `embree-medium-robust`, `cwbvh-fast`.
    #[must_use]
    pub fn name(&self) -> String {
        let mut name = self.backend().word().to_owned();
        for word in match self {
            Self::Embree(options) => {
                let flags = [(options.robust, "robust"), (options.compact, "compact")];
                let flags = flags.into_iter().filter_map(|(set, word)| set.then_some(word));
                std::iter::once(quality(options.quality)).chain(flags).collect()
            }
            Self::Bvh2(preset) | Self::CwBvh(preset) => vec![preset_word(*preset)],
            Self::Brute => Vec::new(),
        } {
            name = format!("{name}-{word}");
        }
        name
    }

    /// Whether a word of the command line means it: its name, or that of its backend.
    #[must_use]
    pub fn is_called(&self, word: &str) -> bool {
        word == self.backend().word() || word == self.name()
    }

    /// Every setting, by name.
    #[must_use]
    pub fn settings(&self) -> Vec<(&'static str, String)> {
        match self {
            Self::Embree(SceneOptions { quality: effort, robust, compact, dynamic, quads }) => vec![
                ("quality", quality(*effort).to_owned()),
                ("robust", robust.to_string()),
                ("compact", compact.to_string()),
                ("dynamic", dynamic.to_string()),
                ("quads", quads.to_string()),
            ],
            Self::Bvh2(preset) | Self::CwBvh(preset) => {
                let Options { preset, padding } = Options { preset: *preset, ..Options::default() };
                vec![("preset", preset_word(preset).to_owned()), ("padding", padding.to_string())]
            }
            Self::Brute => Vec::new(),
        }
    }

    /// The kinds of query that race. All for backends that have kernels for them in the end, and for the others as they come,
    /// to show that packets and streams are traced ray by ray there; single rays where only the build differs.
    #[must_use]
    pub fn queries(&self) -> &'static [Query] {
        let all = match self {
            Self::Embree(SceneOptions { quality, robust, compact, .. }) => {
                *quality == Quality::Medium && !(*robust && *compact)
            }
            Self::Bvh2(preset) | Self::CwBvh(preset) => *preset == Preset::default(),
            Self::Brute => false,
        };
        if all { &Query::ALL } else { &Query::ALL[..1] }
    }

    /// Builds it on `threads` threads, which the current pool has.
    pub(super) fn build(
        &self,
        world: &Arc<World>,
        threads: usize,
        is_cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Built> {
        match self {
            Self::Embree(scene) => {
                let threads = u32::try_from(threads).ok().and_then(NonZeroU32::new);
                let options =
                    BuildOptions { device: Config { threads, ..Config::from_env() }, scene: *scene };
                let go_on = |_| go_on(is_cancelled);
                let accel =
                    EmbreeAccel::build_with(world, &options, &go_on).map_err(|error| match error {
                        EmbreeError::Cancelled => Error::Interrupted,
                        other => Error::Backend { backend: "embree", what: other.to_string() },
                    })?;
                let device = accel.device();
                let version = format!("embree {}", device.version());
                let isa = device.isa().map_or("unknown", |isa| isa.name()).to_owned();
                Ok(Built { version, isa, tracer: Box::new(accel) })
            }
            Self::Bvh2(preset) => hierarchy::<Binary>(*preset, world, is_cancelled),
            Self::CwBvh(preset) => hierarchy::<Wide>(*preset, world, is_cancelled),
            Self::Brute => Ok(Built {
                version: format!("specula {}", env!("CARGO_PKG_VERSION")),
                isa: "scalar".to_owned(),
                tracer: Box::new(Brute::new(world.clone())),
            }),
        }
    }
}

/// A hierarchy, and what is known of the code behind it.
pub(super) struct Built {
    pub(super) version: String,
    pub(super) isa: String,
    pub(super) tracer: Box<dyn Tracer>,
}

fn hierarchy<H: Hierarchy + 'static>(
    preset: Preset,
    world: &Arc<World>,
    is_cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<Built> {
    let options = Options { preset, ..Options::default() };
    let go_on = |_| go_on(is_cancelled);
    let accel = BvhAccel::<H>::build_with(world, &options, &go_on).ok_or(Error::Interrupted)?;
    let isa = accel.isa().to_owned();
    Ok(Built { version: format!("obvhs {}", bvh::VERSION), isa, tracer: Box::new(accel) })
}

fn go_on(is_cancelled: &(dyn Fn() -> bool + Sync)) -> ControlFlow<()> {
    if is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

fn quality(quality: Quality) -> &'static str {
    match quality {
        Quality::Low => "low",
        Quality::Medium => "medium",
        Quality::High => "high",
    }
}

fn preset_word(preset: Preset) -> &'static str {
    match preset {
        Preset::Fastest => "fastest",
        Preset::VeryFast => "very_fast",
        Preset::Fast => "fast",
        Preset::Medium => "medium",
        Preset::Slow => "slow",
        Preset::VerySlow => "very_slow",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_distinct_and_backends_mean_all_of_theirs() {
        let all = Contestant::all();
        let mut names: Vec<String> = all.iter().map(Contestant::name).collect();
        assert_eq!(names[0], "embree-medium", "what the others are compared with");
        assert!(names.contains(&"embree-medium-robust-compact".to_owned()), "{names:?}");
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all.len(), "distinct");
        let called = |word| all.iter().filter(|contestant| contestant.is_called(word)).count();
        assert_eq!(
            [called("embree"), called("bvh2"), called("brute"), called("cwbvh-slow")],
            [6, 6, 1, 1],
            "words"
        );
        assert_eq!(called("abacus"), 0, "unknown");
    }
}
