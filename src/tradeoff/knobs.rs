//! What can be turned. One list: a knob more is one entry.
//!
//! A knob is a key of the scene file by its dotted path, as `-D` takes it, with values that are worth comparing. It is left out of a sweep
//! where the scene has nothing that it turns, with the reason told; whoever names it gets it all the same.

use super::presets::Kind;
use crate::scene::description::FuzzyBy;
use crate::scene::needs::ChosenLights;
use crate::scene::needs::capability::Capability;
use crate::scene::{Needs, Scene};

/// Something to be turned.
#[derive(Clone, Copy, Debug)]
pub struct Knob {
    /// What it is called.
    pub name: &'static str,
    /// The key of the scene file that it sets.
    pub key: &'static str,
    /// Values that are compared where nobody names others, as a scene file would say them.
    pub values: &'static [&'static str],
    /// Which of its values is right.
    pub truth: Truth,
    /// Why it does nothing in a scene, if so.
    idle: fn(&Facts<'_>) -> Option<&'static str>,
    /// Whether a scene can do with a value.
    fits: fn(&Facts<'_>, &str) -> bool,
}

/// What a knob does to a picture of endless samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// Nothing: noise and time alone.
    Any,
    /// The greater its number, the nearer to the truth.
    Greatest,
    /// The less its number, the nearer to the truth.
    Least,
    /// This word is right, all others are approximations.
    Word(&'static str),
    /// Every value is another picture, and none is wrong: left out unless it is named.
    Taste,
}

/// What is known of the scene that knobs are turned on.
#[derive(Clone, Copy, Debug)]
pub struct Facts<'a> {
    /// The scene, as its file says.
    pub scene: &'a Scene,
    /// What it requires.
    pub needs: &'a Needs,
}

impl Facts<'_> {
    fn has(&self, capability: Capability) -> bool {
        self.needs.count(capability) > 0
    }

    fn follows(&self, kind: Kind) -> bool {
        Kind::of(self.scene.render.integrator) == Some(kind)
    }

    fn splits(&self) -> bool {
        self.scene.render.light_samples() > 1 || self.scene.render.glossy_samples() > 1
    }
}

impl Knob {
    /// The list.
    pub const ALL: &'static [Self] = LIST;

    /// The knob of that name.
    #[must_use]
    pub fn of(name: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|knob| knob.name == name)
    }

    /// Why a sweep does without it, if so.
    #[must_use]
    pub fn idle(&self, facts: &Facts<'_>) -> Option<&'static str> {
        (self.idle)(facts)
    }

    /// The usual values that the scene can do with.
    #[must_use]
    pub fn usual(&self, facts: &Facts<'_>) -> Vec<String> {
        self.values
            .iter()
            .filter(|value| (self.fits)(facts, value))
            .map(|value| (*value).to_owned())
            .collect()
    }

    /// The one of these values that is nearest to the truth; `None` where all are alike.
    #[must_use]
    pub fn truest<'a>(&self, values: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
        let number = |value: &&str| value.parse().unwrap_or(f64::INFINITY);
        let mut values = values.into_iter();
        match self.truth {
            Truth::Any | Truth::Taste => None,
            Truth::Greatest => values.max_by(|a, b| number(a).total_cmp(&number(b))),
            Truth::Least => values.min_by(|a, b| number(a).total_cmp(&number(b))),
            Truth::Word(word) => values.find(|value| *value == word),
        }
    }
}

const fn never(_: &Facts<'_>) -> Option<&'static str> {
    None
}

const fn all(_: &Facts<'_>, _: &str) -> bool {
    true
}

fn of_trees(facts: &Facts<'_>) -> Option<&'static str> {
    (!facts.follows(Kind::Tree)).then_some("a knob of ray trees")
}

fn of_paths(facts: &Facts<'_>) -> Option<&'static str> {
    (!facts.follows(Kind::Path)).then_some("a knob of the integrator `path`")
}

fn of_embree(facts: &Facts<'_>) -> Option<&'static str> {
    let is_embree = facts.scene.render.backend == crate::scene::description::Backend::Embree;
    (!is_embree).then_some("a knob of Embree")
}

/// What a knob is, before what it asks of a scene.
const fn knob(name: &'static str, key: &'static str, values: &'static [&'static str], truth: Truth) -> Knob {
    Knob { name, key, values, truth, idle: never, fits: all }
}

/// The list.
const LIST: &[Knob] = &[
    knob("spp", "render.spp", &["4", "16", "64"], Truth::Any),
    knob("sampler", "render.sampler", &["sobol", "independent", "stratified", "blue_noise"], Truth::Any),
    knob("max_depth", "render.max_depth", &["2", "4", "8", "16"], Truth::Greatest),
    Knob {
        idle: of_trees,
        ..knob("min_throughput", "render.min_throughput", &["1e-4", "1e-3", "1e-2", "1e-1"], Truth::Least)
    },
    Knob {
        idle: |facts| {
            let kinds = [Capability::Mirrors, Capability::Refraction, Capability::GlossyLobes];
            let has = kinds.into_iter().any(|kind| facts.has(kind));
            (!has).then_some("nothing that is polished, clear or has a lobe")
        },
        ..knob("fresnel", "render.fresnel", &["exact", "schlick", "f82", "constant"], Truth::Word("exact"))
    },
    Knob {
        idle: |facts| (!facts.has(Capability::GlossyLobes)).then_some("no material with a lobe"),
        fits: |facts, value| value != FuzzyBy::TwoPass.word() || facts.follows(Kind::Tree),
        ..knob("glossy", "render.glossy", &["lobe", "jitter", "two-pass"], Truth::Word("lobe"))
    },
    Knob {
        idle: |facts| {
            let has = facts.has(Capability::AreaLights) || facts.has(Capability::Environment);
            of_trees(facts).or_else(|| (!has).then_some("no light with a size"))
        },
        ..knob("light_samples", "render.light_samples", &["1", "2", "4", "8"], Truth::Any)
    },
    Knob {
        idle: |facts| {
            let has = facts.has(Capability::GlossyLobes);
            of_trees(facts).or_else(|| (!has).then_some("no material with a lobe"))
        },
        ..knob("glossy_samples", "render.glossy_samples", &["1", "2", "4", "8"], Truth::Any)
    },
    Knob {
        idle: |facts| {
            let splits = facts.splits();
            of_trees(facts).or_else(|| (!splits).then_some("no hit sends more than one ray of a kind"))
        },
        ..knob("split_depth", "render.split_depth", &["0", "1", "2"], Truth::Any)
    },
    knob("query", "render.query", &["single", "packet", "stream"], Truth::Any),
    knob("backend", "render.backend", &["embree", "bvh2", "cwbvh"], Truth::Any),
    Knob {
        idle: of_embree,
        ..knob("build_quality", "render.build_quality", &["low", "medium", "high"], Truth::Any)
    },
    Knob { idle: of_embree, ..knob("robust", "render.robust", &["false", "true"], Truth::Word("true")) },
    Knob { idle: of_paths, ..knob("path_splits", "render.path_splits", &["1", "2", "4"], Truth::Any) },
    Knob { idle: of_paths, ..knob("roulette", "render.roulette", &["off", "3", "6"], Truth::Any) },
    Knob {
        idle: of_paths,
        ..knob("clamp_indirect", "render.clamp_indirect", &["off", "100", "10", "1"], Truth::Word("off"))
    },
    Knob {
        idle: |facts| {
            let several = ChosenLights::of(facts.scene).emitters > 1;
            of_paths(facts).or_else(|| (!several).then_some("no choice among lights"))
        },
        ..knob("light_choice", "render.light_choice", &["power", "uniform", "tree"], Truth::Any)
    },
    Knob {
        idle: |_| Some("each filter is another picture, and none is wrong"),
        ..knob("filter", "film.filter", &["box", "tent", "gaussian", "mitchell"], Truth::Taste)
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::schema;
    use std::collections::BTreeSet;

    #[test]
    fn every_knob_is_a_key_of_scene_files_with_a_name_of_its_own() {
        let schema = schema();
        let names: BTreeSet<_> = Knob::ALL.iter().map(|knob| knob.name).collect();
        assert_eq!(names.len(), Knob::ALL.len(), "names");
        for knob in Knob::ALL {
            let (table, key) = knob.key.split_once('.').expect("a table and a key");
            let table = if table == "render" { "Render" } else { "Film" };
            let known = &schema["$defs"][table]["properties"][key];
            assert!(known.is_object(), "{} sets no key: {known}", knob.name);
            assert!(knob.values.len() > 1, "{}: nothing to compare", knob.name);
            if let Truth::Word(word) = knob.truth {
                assert!(knob.values.contains(&word), "{}: {word}", knob.name);
            }
        }
    }

    #[test]
    fn truth_is_the_end_of_a_list_or_a_word() {
        let truest = |name: &str, values: &[&'static str]| {
            Knob::of(name).expect("there").truest(values.iter().copied())
        };
        assert_eq!(truest("max_depth", &["4", "16", "8"]), Some("16"), "the deepest");
        assert_eq!(truest("min_throughput", &["1e-3", "0.0001", "1"]), Some("0.0001"), "the least");
        assert_eq!(truest("clamp_indirect", &["10", "off"]), Some("off"), "the word");
        assert_eq!(truest("fresnel", &["schlick"]), None, "not among them");
        assert_eq!(truest("spp", &["1", "2"]), None, "noise alone");
    }
}
