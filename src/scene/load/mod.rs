//! From files to a [`Description`].
//!
//! A scene file is parsed to a tree that knows where everything stands (`node`), files that it includes are merged
//! into it (`merge`), overrides of the command line are applied (`overrides`), then the tree is decoded by the
//! declarations of [`crate::scene::description`] (`decode`, `value`, `check`) and its names are resolved
//! (`references`). Whatever is wrong is collected (`report`) and told at once.
//!
//! Limits: a syntax error hides all other faults of its file and of what refers to it. Meshes and pictures are checked
//! for being there, not opened; pictures on surfaces, which a scene can do without, not even that. [`load_mesh`] reads meshes.

mod asked;
pub(crate) mod batch;
pub(crate) mod check;
pub(crate) mod decode;
pub(crate) mod files;
mod merge;
mod mesh;
pub(crate) mod node;
mod obj;
mod overrides;
mod ply;
mod references;
pub(crate) mod report;
mod source;
pub(crate) mod value;
pub(crate) mod words;

use crate::error::{Problem, Result};
use crate::scene::description::{Description, Form, FuzzyFilter, Integrator, Light, Scattering, Texture};
use crate::scene::identity;
use crate::scene::load::node::{Entry, Node};
use crate::scene::record::{Rules, Value};
use crate::trust::Trust;
pub use batch::{is_scene, load_batch};
use merge::Reader;
pub use mesh::{About, EXTENSIONS, LoadedMesh, Shading, decode_mesh, load_mesh, load_mesh_within};
pub use overrides::from_root;
use report::Report;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene as its files say.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// What they say.
    pub description: Description,
    /// What is allowed but hardly meant.
    pub warnings: Vec<Problem>,
    /// The scene file, those that it includes, and those that the description names, from the root.
    pub files: Vec<PathBuf>,
}

/// The description in the scene file at `path`, with values replaced by `overrides` of the form `key=value`, the key
/// being a dotted path.
///
/// Files are trusted within the usual limits. Fails with everything wrong with the files and the overrides, each with its place and a
/// remedy.
pub fn load(path: &Path, overrides: &[String]) -> Result<Loaded> {
    load_within(path, overrides, &Trust::default())
}

/// The same as [`load`] of files that are trusted so far; overrides are trusted no farther.
pub fn load_within(path: &Path, overrides: &[String], trust: &Trust) -> Result<Loaded> {
    load_from(path, here(overrides), trust)
}

/// Overrides, the files in them as seen from the current directory.
fn here(overrides: &[String]) -> impl Iterator<Item = (&str, &Path)> {
    overrides.iter().map(|text| (text.as_str(), Path::new("")))
}

/// The same of files that are trusted so far, with overrides that each have a folder from which files in it are seen.
pub fn load_from<'a>(
    path: &Path,
    overrides: impl IntoIterator<Item = (&'a str, &'a Path)>,
    trust: &Trust,
) -> Result<Loaded> {
    let mut report = Report::default();
    let trust = Arc::new(trust.clone());
    let mut reader = Reader::new(trust.clone());
    let Some(mut tree) = reader.read(path, None, &mut report) else {
        return report.into_result(None);
    };
    overrides::apply(&mut tree, overrides, &trust, &mut report);
    let description = Description::decode(&tree, "scene", &Rules::default(), &mut report);
    if !reader.incomplete {
        references::check(&tree, &trust.limits, &mut report);
    }
    if let Some(description) = &description {
        asked::check(&tree, description, &trust.limits, &mut report);
    }
    let description = report.into_result(description)?;
    let mut warnings = warnings(&description);
    warnings.extend(idle_knobs(&tree, description.render.integrator));
    let files = identity::files(&description, reader.done());
    Ok(Loaded { description, warnings, files })
}

/// The filter that settings of the form `key=value` describe, later ones before earlier ones, defaults for the rest.
///
/// Fails with everything wrong with them.
pub fn fuzzy_filter(settings: &[String]) -> Result<FuzzyFilter> {
    let mut report = Report::default();
    let mut tree = Node::nowhere();
    overrides::apply(&mut tree, here(settings), &Arc::default(), &mut report);
    let filter = FuzzyFilter::decode(&tree, "fuzzy", &Rules::default(), &mut report);
    report.into_result(filter)
}

/// What is allowed but hardly meant.
fn warnings(description: &Description) -> Vec<Problem> {
    let mut warnings = Vec::new();
    let Description { shapes, lights, materials, .. } = description;
    let is_view = description.render.integrator == Integrator::View;
    let sky = lights.iter().any(|light| matches!(light.value, Light::Environment { .. }));
    if shapes.is_empty() && (is_view || !sky) {
        warnings
            .push(Problem::new("there is no shape: the picture will be empty").remedy("add `[[shapes]]`"));
    }
    let emission = materials.iter().any(|material| {
        matches!(material.value.scattering, Scattering::Emission { .. })
            || material.value.emission != Texture::gray(0.0)
    });
    let own_materials =
        shapes.iter().any(|shape| shape.material.is_none() && matches!(shape.form, Form::Mesh { .. }));
    if !is_view && lights.is_empty() && !emission && !own_materials {
        warnings
            .push(Problem::new("there is no light: the picture will be black").remedy("add `[[lights]]`"));
    }
    warnings.extend(idle_prototypes(description));
    warnings
}

/// Knobs of how rays split that are set where another integrator is to run.
fn idle_knobs(tree: &Node, integrator: Integrator) -> Vec<Problem> {
    let of_trees: &[&str] = &["light_samples", "glossy_samples", "split_depth"];
    let kinds = [
        (integrator.is_ray_tree(), of_trees, "the ray tree", "`distribution` or `whitted`"),
        (integrator == Integrator::Path, &["path_splits"], "paths", "`path`"),
    ];
    let entries = tree.get("render").and_then(Node::entries).unwrap_or_default();
    let warnings = |(_, keys, whose, others): &(bool, &[&str], &str, &str)| {
        let idle: Vec<&Entry> = entries.iter().filter(|entry| keys.contains(&entry.key.as_str())).collect();
        let warning = |entry: &Entry| {
            let word = integrator.word();
            let what = format!("`{}` is of {whose}: the integrator `{word}` does not use it", entry.key);
            report::told(&entry.node.spot, what)
                .remedy(format!("leave it out, or choose the integrator {others}"))
        };
        idle.into_iter().map(warning).collect::<Vec<_>>()
    };
    kinds.iter().filter(|(is_used, ..)| !is_used).flat_map(warnings).collect()
}

/// Hidden shapes that nothing shows.
fn idle_prototypes(description: &Description) -> impl Iterator<Item = Problem> {
    let shown: HashSet<&str> = description
        .shapes
        .iter()
        .filter_map(|shape| if let Form::Instance { of } = &shape.form { Some(of.as_str()) } else { None })
        .collect();
    description.shapes.iter().filter(|shape| shape.hidden).filter_map(move |shape| {
        let name = shape.name.as_ref().map(|name| name.as_str());
        if name.is_some_and(|name| shown.contains(name)) {
            return None;
        }
        let problem = Problem::at(shape.place.clone(), "this shape is hidden and has no instance");
        Some(problem.remedy("add an instance of it, or remove `hidden`"))
    })
}
