//! Names in a scene: that they are unlike each other, and that what refers to them finds them.
//!
//! This looks at the tree, not at the description, so that broken references are found beside all other faults. What
//! is not even a string is left to the decoder.

use crate::scene::description::{Material, Texture};
use crate::scene::load::node::{Entry, Node};
use crate::scene::load::report::Report;
use crate::scene::load::words;
use crate::scene::record::{Rules, Value};
use crate::trust::{Limit, Limits};
use std::collections::{HashMap, HashSet};

/// Types of shapes that bring no material of their own.
const WITHOUT_MATERIALS: [&str; 8] =
    ["sphere", "disc", "rectangle", "box", "cylinder", "cone", "torus", "height_field"];

/// Reports names given twice, references to nothing, shapes without a material, shapes that are instances of
/// themselves, and instances of instances beyond what `limits` allow.
pub(crate) fn check(tree: &Node, limits: &Limits, report: &mut Report) {
    let materials: Vec<&str> = tree
        .get("materials")
        .and_then(Node::entries)
        .map_or(vec![], |entries| entries.iter().map(|entry: &Entry| entry.key.as_str()).collect());
    let known: HashSet<&str> = materials.iter().copied().collect();
    let shapes = tree.get("shapes").and_then(Node::items).unwrap_or(&[]);
    let names = names(shapes, report);
    let entries = tree.get("materials").and_then(Node::entries).unwrap_or(&[]);
    let nodes: HashMap<&str, &Node> = entries.iter().map(|entry| (entry.key.as_str(), &entry.node)).collect();
    let shining: HashSet<&str> =
        nodes.iter().filter(|(_, node)| shines(node)).map(|(name, _)| *name).collect();
    for entry in entries {
        check_mix(entry, (&nodes, &shining), &materials, report);
    }
    for shape in shapes {
        check_material(shape, &known, &materials, report);
        check_instance(shape, &names, report);
    }
    check_chains(shapes, &names, limits, report);
}

/// A remedy for a name that is none of those there are. Not sought in long reports: it would be each of many names against all of many.
fn suggested(report: &Report, name: &str, known: &[&str], what: &str) -> String {
    if report.is_long() {
        return format!("define that {what}, or name another");
    }
    words::suggest_name(name, known, what)
}

/// Shapes by name.
fn names<'a>(shapes: &'a [Node], report: &mut Report) -> HashMap<&'a str, &'a Node> {
    let mut names = HashMap::new();
    for shape in shapes {
        let Some(node) = shape.get("name") else { continue };
        let Some(name) = node.text() else { continue };
        match names.get(name) {
            None => _ = names.insert(name, shape),
            Some(first) => {
                let place = Node::get(first, "name").map_or(&first.spot, |name| &name.spot).place();
                let what = format!("a shape named `{name}` is there already at {place}");
                report.error(&node.spot, what, "give one of them another name");
            }
        }
    }
    names
}

/// `materials` are those in `known`, in the order of the files.
fn check_material(shape: &Node, known: &HashSet<&str>, materials: &[&str], report: &mut Report) {
    let kind = shape.get("type").and_then(Node::text);
    let Some(node) = shape.get("material") else {
        if kind.is_some_and(|kind| WITHOUT_MATERIALS.contains(&kind)) {
            let remedy = words::suggest_name("", materials, "material");
            report.error(&shape.spot, "missing key `material`", remedy);
        }
        return;
    };
    let Some(name) = node.text() else { return };
    if !known.contains(name) {
        let remedy = suggested(report, name, materials, "material");
        report.error(&node.spot, format!("unknown material `{name}`"), remedy);
    }
}

/// The parts of a mix exist, are not mixes or lights, and bound one body at most.
fn check_mix(
    mix: &Entry,
    (nodes, shining): (&HashMap<&str, &Node>, &HashSet<&str>),
    materials: &[&str],
    report: &mut Report,
) {
    let kind = |node: &Node| node.get("type").and_then(Node::text).map(str::to_owned);
    if kind(&mix.node).as_deref() != Some("mix") {
        return;
    }
    let mut bodies = 0;
    for part in mix.node.get("parts").and_then(Node::items).unwrap_or(&[]) {
        let Some(node) = part.get("material") else { continue };
        let Some(name) = node.text() else { continue };
        let Some(&found) = nodes.get(name) else {
            let remedy = suggested(report, name, materials, "material");
            report.error(&node.spot, format!("unknown material `{name}`"), remedy);
            continue;
        };
        match kind(found).as_deref() {
            Some("mix") => {
                report.error(&node.spot, format!("`{name}` is a mix itself"), "name its parts here");
            }
            Some("emission") => {
                report.error(
                    &node.spot,
                    format!("`{name}` is a light"),
                    "give the mix a key `emission` instead",
                );
            }
            _ if shining.contains(name) => {
                let what = format!("`{name}` shines, which a part of a mix cannot");
                report.error(&node.spot, what, "give the mix a key `emission` instead");
            }
            Some("dielectric") => bodies += 1,
            _ => {}
        }
    }
    if bodies > 1 {
        let what = format!("`{}` would be the surface of two bodies", mix.key);
        report.error(&mix.spot, what, "let one part at most be a `dielectric`");
    }
}

/// Whether a material gives off light besides. What is wrong with it is left to the decoder.
fn shines(material: &Node) -> bool {
    let (rules, ignored) = (Rules::default(), &mut Report::default());
    material.get("emission").is_some()
        && Material::decode(material, "", &rules, ignored)
            .is_some_and(|material| material.emission != Texture::gray(0.0))
}

fn check_instance(shape: &Node, names: &HashMap<&str, &Node>, report: &mut Report) {
    let Some((node, name)) = prototype(shape) else { return };
    if !names.contains_key(name) {
        let mut known: Vec<&str> = names.keys().copied().collect();
        known.sort_unstable();
        let remedy = suggested(report, name, &known, "shape");
        report.error(&node.spot, format!("unknown shape `{name}`"), remedy);
    }
}

/// The name that an instance refers to.
fn prototype(shape: &Node) -> Option<(&Node, &str)> {
    if shape.get("type").and_then(Node::text) != Some("instance") {
        return None;
    }
    let node = shape.get("of")?;
    Some((node, node.text()?))
}

/// Follows instances from each shape; a cycle is reported once, at the shape of it that stands first, and so is the first chain that is too
/// long.
fn check_chains<'a>(
    shapes: &'a [Node],
    names: &HashMap<&'a str, &'a Node>,
    limits: &Limits,
    report: &mut Report,
) {
    let mut told = false;
    // How many instances lead from a shape to one that is none.
    let mut lengths: HashMap<*const Node, u64> = HashMap::new();
    for shape in shapes {
        let mut trail: Vec<&Node> = vec![];
        let mut places: HashMap<*const Node, usize> = HashMap::new();
        let mut next = Some(shape);
        while let Some(here) = next.filter(|here| !lengths.contains_key(&std::ptr::from_ref::<Node>(here))) {
            if let Some(&start) = places.get(&std::ptr::from_ref(here)) {
                report_cycle(&trail[start..], report);
                break;
            }
            places.insert(here, trail.len());
            trail.push(here);
            next = prototype(here).and_then(|(_, name)| names.get(name).copied());
        }
        let known = next.and_then(|next| lengths.get(&std::ptr::from_ref::<Node>(next)));
        let first = known.map_or(0, |known| known + 1);
        for (here, length) in trail.into_iter().rev().zip(first..) {
            if !told && let Err(excess) = limits.check(Limit::Nesting, length) {
                let what = format!("an instance of an instance and so on: {excess}");
                report.error(&here.spot, what, excess.remedy());
                told = true;
            }
            lengths.insert(here, length);
        }
    }
}

fn report_cycle(cycle: &[&Node], report: &mut Report) {
    let Some((of, name)) = cycle.last().and_then(|last| prototype(last)) else { return };
    let steps: Vec<String> =
        cycle.iter().filter_map(|shape| Some(format!("`{}`", prototype(shape)?.1))).collect();
    let what = format!("shape `{name}` is an instance of itself, by {}", words::join(&steps, "and"));
    report.error(&of.spot, what, "make one of them a shape of its own");
}
