//! Batch files.

use crate::error::Result;
use crate::scene::description::{Batch, Description, Located};
use crate::scene::load::decode::Fields;
use crate::scene::load::merge::read_alone;
use crate::scene::load::node::{Content, Entry, Node};
use crate::scene::load::overrides::split;
use crate::scene::load::report::Report;
use crate::scene::load::source::Source;
use crate::scene::record::{Rules, Table, Value as _};
use crate::trust::Limits;
use serde_json::{Map, Value as Json};
use std::path::Path;
use std::sync::Arc;
use toml::Value;

/// What the batch file at `path` says, within limits. Fails with everything that is wrong with it.
pub fn load_batch(path: &Path, limits: Limits) -> Result<Batch> {
    let mut report = Report::default();
    let tree = read_alone(path, limits, &mut report);
    let batch = tree.and_then(|tree| Batch::decode(&tree, "batch", &Rules::default(), &mut report));
    report.into_result(batch)
}

/// Whether a file is a scene file rather than a batch file, by its tables; a file that is no TOML, or beyond limits, is not.
#[must_use]
pub fn is_scene(path: &Path, limits: Limits) -> bool {
    let tree = read_alone(path, limits, &mut Report::default());
    tree.is_some_and(|tree| has_key_of::<Description>(&tree) && !has_key_of::<Batch>(&tree))
}

/// Whether any key of a kind of table stands in this one.
fn has_key_of<T: Table>(tree: &Node) -> bool {
    let kinds = T::kinds(&mut Map::new());
    kinds.iter().flat_map(|kind| kind.properties.keys()).any(|key| tree.get(key).is_some())
}

/// There are jobs, and each has a scene.
pub(crate) fn check(batch: &Batch, fields: &mut Fields<'_>) {
    if !fields.is_whole("jobs", &batch.jobs) {
        return;
    }
    if batch.jobs.is_empty() {
        fields.problem("jobs", "there is no job", "add `[[jobs]]`");
    }
    for (i, job) in batch.jobs.iter().enumerate() {
        if job.own.scene.is_none() && batch.defaults.scene.is_none() {
            fields.problem_in(("jobs", i, "scene"), "a job without a scene", "give it a key `scene`");
        }
    }
}

/// Adds the overrides that stand below a path. Tables that are written by dotted paths or under headings lead on, what is written in
/// braces is a value; `None` where something is no value of a scene file, with the problem reported.
pub(crate) fn flatten(
    path: String,
    node: &Node,
    into: &mut Vec<Located<String>>,
    report: &mut Report,
) -> Option<()> {
    match &node.content {
        Content::Table(entries) if !node.spot.is_at("{") => {
            for Entry { key, spot, node } in entries {
                let Some(part) = quoted(key) else {
                    let what = format!("the key `{key}` cannot be a part of a path");
                    report.error(spot, what, "leave out quotes of one kind, and spaces at its ends");
                    return None;
                };
                flatten(format!("{path}.{part}"), node, into, report)?;
            }
        }
        _ => match value(node) {
            Some(value) => {
                let text = format!("{path}={value}");
                into.push(Located { value: text, place: node.spot.place() });
            }
            None => {
                report.error(&node.spot, format!("`{path}` is {}", node.kind()), "no key has such a value");
                return None;
            }
        },
    }
    Some(())
}

/// A key as a part of a path, if paths can have it.
fn quoted(key: &str) -> Option<String> {
    if key.trim() != key || key.contains('"') && key.contains('\'') {
        return None;
    }
    if !key.contains(['.', '=', '"', '\'']) {
        return Some(key.to_owned());
    }
    let quote = if key.contains('"') { '\'' } else { '"' };
    Some(format!("{quote}{key}{quote}"))
}

/// An override as the table of a batch file has it: its path, and its value in JSON.
pub(crate) fn entry(text: &str) -> Option<(String, Json)> {
    let (_, written) = split(text)?;
    let source = Arc::new(Source::command_line(text, Path::new(""), 0, &Arc::default()));
    let node = Node::parse_value(written.trim(), &source, &mut Report::default());
    let path = text[..text.len() - written.len()].strip_suffix('=')?.trim();
    Some((path.to_owned(), serde_json::to_value(value(&node)?).ok()?))
}

/// The value that a node spells, to be written again.
pub(crate) fn value(node: &Node) -> Option<Value> {
    Some(match &node.content {
        Content::Boolean(value) => Value::Boolean(*value),
        Content::Integer(number) => Value::Integer(i64::try_from(*number).ok()?),
        Content::Float(number) => Value::Float(*number),
        Content::String(text) => Value::String(text.clone()),
        Content::Date => return None,
        Content::Array(items) => Value::Array(items.iter().map(value).collect::<Option<_>>()?),
        Content::Table(entries) => {
            let entries = entries.iter().map(|entry| Some((entry.key.clone(), value(&entry.node)?)));
            Value::Table(entries.collect::<Option<_>>()?)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn read(text: &str) -> std::result::Result<Batch, String> {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("a.toml"), "").expect("written");
        let path = folder.path().join("batch.toml");
        std::fs::write(&path, text).expect("written");
        let folder = format!("{}/", folder.path().display());
        load_batch(&path, Limits::default()).map_err(|error| error.to_string().replace(&folder, ""))
    }

    fn overrides(text: &str) -> Vec<String> {
        let batch = read(&format!("[[jobs]]\nscene = 'a.toml'\n{text}")).expect("sound");
        batch.jobs[0].own.overrides.0.iter().map(|text| text.value.clone()).collect()
    }

    #[test]
    fn overrides_are_dotted_paths_however_they_are_written() {
        let spp = ["render.spp=4", "film.width=8"];
        assert_eq!(overrides("overrides = { render.spp = 4, film.width = 8 }"), spp, "dotted");
        assert_eq!(overrides("overrides = { 'render.spp' = 4, 'film.width' = 8 }"), spp, "as a text");
        assert_eq!(overrides("[jobs.overrides]\nrender.spp = 4\nfilm.width = 8"), spp, "under a heading");
        assert_eq!(overrides("[jobs.overrides.render]\nspp = 4"), spp[..1], "all of it in the heading");
        let table = "overrides = { materials.a.reflectance = { file = 'a.png', repeat = [2.0, 1] } }";
        let told = "materials.a.reflectance={ file = \"a.png\", repeat = [2.0, 1] }";
        assert_eq!(overrides(table), [told], "a table in braces is a value");
        let dots = "overrides.materials.'a.b'.ior = 1.5";
        assert_eq!(overrides(dots), ["materials.\"a.b\".ior=1.5"], "a name with a dot");
        for key in ["\"a'\\\"b\"", "' a'"] {
            let text = format!("[[jobs]]\nscene = 'a.toml'\noverrides.materials.{key}.ior = 1.5");
            let told = read(&text).expect_err("no path can say so");
            assert!(told.starts_with("batch.toml:3:21: the key `"), "{key}: {told}");
        }
    }

    #[test]
    fn overrides_are_a_table_in_json_as_in_files() {
        let table = json!({ "render.spp": 4, "materials.a.b": { "c": [0.5, "x"] } });
        let text = "overrides = { render.spp = 4, materials.a.b = { c = [0.5, 'x'] } }";
        let batch = read(&format!("[[jobs]]\nscene = 'a.toml'\n{text}")).expect("sound");
        assert_eq!(batch.jobs[0].own.overrides.to_json(), table, "as written");
    }

    #[test]
    fn everything_wrong_is_told_at_once_with_its_place() {
        let text = "[defaults]\nframes = '3..1'\n[[jobs]]\nscenes = 'a.toml'\n[[jobs]]\nscene = 'b.toml'\ncrop = [0, 0, 1]\noverrides = 3\n";
        let told = read(text).expect_err("wrong");
        let told: Vec<&str> = told.lines().collect();
        let wanted = [
            "batch.toml:2:10: `frames` is \"3..1\"; ",
            "batch.toml:4:1: unknown key `scenes`; did you mean `scene`?",
            "batch.toml:6:9: no such file `b.toml`; did you mean `a.toml`?",
            "batch.toml:7:8: `crop` is an array of three",
            "batch.toml:8:13: `overrides` is an integer; it must be a table",
        ];
        assert_eq!(told.len(), wanted.len(), "{told:?}");
        for (told, wanted) in told.iter().zip(wanted) {
            assert!(told.starts_with(wanted), "{told}, not {wanted}");
        }
        let none = read("[[jobs]]\n[[jobs]]\nscene = 'a.toml'").expect_err("wrong");
        assert_eq!(none, "batch.toml:1:1: a job without a scene; give it a key `scene`", "no scene");
        assert!(read("").expect_err("wrong").contains("there is no job"), "no job");
        assert!(read("[[jobs").is_err(), "no TOML");
    }
}
