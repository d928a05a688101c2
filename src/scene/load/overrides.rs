//! Values set on the command line by dotted path.
//!
//! `render.spp=4`, `materials.glass.ior=1.6`, `shapes.model.file=my.obj`, `shapes.0.transform=[{scale=2}]`: a path leads
//! through tables by key and through arrays by index or by `name`; what is missing on the way is created, except items
//! of arrays. Keys with dots are quoted as in TOML. The value is read as TOML, else taken as a string.

use crate::scene::load::batch;
use crate::scene::load::node::{Content, Entry, Node};
use crate::scene::load::report::Report;
use crate::scene::load::source::{Source, Spot};
use crate::scene::load::words;
use crate::trust::{Limit, Trust};
use std::path::Path;
use std::sync::Arc;

/// Applies overrides to the tree, one after the other, files in each as seen from a folder; what is wrong with them is reported.
pub(crate) fn apply<'a>(
    tree: &mut Node,
    overrides: impl IntoIterator<Item = (&'a str, &'a Path)>,
    trust: &Arc<Trust>,
    report: &mut Report,
) {
    for (index, (text, folder)) in overrides.into_iter().enumerate() {
        let source = Arc::new(Source::command_line(text, folder, index, trust));
        apply_one(tree, text, &source, report);
    }
}

fn apply_one(tree: &mut Node, text: &str, source: &Arc<Source>, report: &mut Report) {
    let spot = Spot { source: source.clone(), offset: 0 };
    let Some((path, value)) = split(text) else {
        report.error(&spot, "this is no override", "write key=value, the key as a dotted path");
        return;
    };
    if path.iter().any(String::is_empty) {
        report.error(&spot, "the path has an empty part", "write key=value, the key as a dotted path");
        return;
    }
    if let Err(excess) = source.limits().check(Limit::Nesting, path.len() as u64) {
        report.error(&spot, format!("the path has {excess}"), excess.remedy());
        return;
    }
    if path[0] == "include" {
        report.error(&spot, "`include` cannot be overridden", "name another scene file");
        return;
    }
    let value = Node::parse_value(value.trim(), source, report);
    if let Err((what, remedy)) = set(tree, &path, value, &spot) {
        report.error(&spot, what, remedy);
    }
}

/// The same override with files that are seen from the current directory named from the root, so that it can be given anywhere.
#[must_use]
pub fn from_root(text: &str) -> String {
    let Some((path, value)) = split(text) else { return text.to_owned() };
    let source = Arc::new(Source::command_line(text, Path::new(""), 0, &Arc::default()));
    let mut node = Node::parse_value(value.trim(), &source, &mut Report::default());
    let is_file = path.last().is_some_and(|key| key == FILE);
    if !root(&mut node, is_file) {
        return text.to_owned();
    }
    let key = &text[..text.len() - value.len()];
    batch::value(&node).map_or_else(|| text.to_owned(), |value| format!("{key}{value}"))
}

/// The key of whatever names a file.
const FILE: &str = "file";

/// Names files in a value, or the one that it is, from the root; whether there are any.
fn root(node: &mut Node, is_file: bool) -> bool {
    match &mut node.content {
        Content::String(text) if is_file => {
            let Ok(path) = std::path::absolute(&*text) else { return false };
            path.into_os_string().into_string().is_ok_and(|path| {
                *text = path;
                true
            })
        }
        // All of them, also after the first.
        Content::Array(items) => {
            items.iter_mut().filter_map(|item| root(item, false).then_some(())).count() > 0
        }
        Content::Table(entries) => {
            let found = entries.iter_mut().filter_map(|it| root(&mut it.node, it.key == FILE).then_some(()));
            found.count() > 0
        }
        _ => false,
    }
}

/// The parts of the path, and the value; `None` without an equals sign or with an open quote.
pub(super) fn split(text: &str) -> Option<(Vec<String>, &str)> {
    let mut parts = vec![String::new()];
    let mut quote = None;
    for (i, c) in text.char_indices() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (None, '"' | '\'') => quote = Some(c),
            (None, '=') => {
                let parts = parts.iter().map(|part| part.trim().to_owned()).collect();
                return Some((parts, &text[i + 1..]));
            }
            (None, '.') => parts.push(String::new()),
            _ => parts.last_mut()?.push(c),
        }
    }
    None
}

type Fault = (String, String);

fn set(node: &mut Node, path: &[String], value: Node, spot: &Spot) -> Result<(), Fault> {
    let [key, rest @ ..] = path else {
        *node = value;
        return Ok(());
    };
    match &mut node.content {
        Content::Table(entries) => {
            let i = entries.iter().position(|entry| entry.key == *key).unwrap_or_else(|| {
                let node = absent(key, spot);
                entries.push(Entry { key: key.clone(), spot: spot.clone(), node });
                entries.len() - 1
            });
            set(&mut entries[i].node, rest, value, spot)
        }
        Content::Array(items) => set(item(items, key)?, rest, value, spot),
        _ => Err((
            format!("`{key}` leads into {}", node.kind()),
            "only tables and arrays have something inside".into(),
        )),
    }
}

/// What stands for a key that is missing: an array under the two keys that hold arrays, else a table.
fn absent(key: &str, spot: &Spot) -> Node {
    let content =
        if ["shapes", "lights"].contains(&key) { Content::Array(vec![]) } else { Content::Table(vec![]) };
    Node { spot: spot.clone(), content }
}

fn item<'a>(items: &'a mut [Node], key: &str) -> Result<&'a mut Node, Fault> {
    let count = items.len();
    if let Ok(i) = key.parse::<usize>() {
        let fault = (
            format!("there is no entry {i}"),
            format!("entries count from 0, and there are {} of them", words::count(count)),
        );
        return items.get_mut(i).ok_or(fault);
    }
    let name = |node: &Node| node.get("name").and_then(Node::text).map(String::from);
    if let Some(i) = items.iter().position(|item| name(item).as_deref() == Some(key)) {
        return Ok(&mut items[i]);
    }
    let names: Vec<String> = items.iter().filter_map(name).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let remedy = if names.is_empty() {
        format!("none of the {count} has a name; they count from 0")
    } else {
        words::suggest_name(key, &names, "name")
    };
    Err((format!("there is no entry named `{key}`"), remedy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_split_outside_of_quotes() {
        let parts = |text| split(text).map(|(path, value)| (path.join("|"), value));
        assert_eq!(parts("a.b = 1=2"), Some(("a|b".into(), " 1=2")), "the first equals sign");
        assert_eq!(parts("a.\"b.c=\".d=1"), Some(("a|b.c=|d".into(), "1")), "quoted");
        assert_eq!(parts("a.b"), None, "no value");
        assert_eq!(parts("a.\"b=1"), None, "open quote");
    }

    #[test]
    fn files_are_named_from_the_root() {
        let here = std::env::current_dir().expect("somewhere");
        let full = |name: &str| here.join(name).display().to_string();
        for plain in ["render.spp=4", "materials.m.note=a.png", "a.file=/x/a.obj", "no override", "a.file=3"]
        {
            let told = from_root(plain);
            assert!(told == plain || told == plain.replace("/x/a.obj", "\"/x/a.obj\""), "{told}");
        }
        let mesh = format!("shapes.0.file=\"{}\"", full("sub/a.obj"));
        assert_eq!(from_root("shapes.0.file=sub/a.obj"), mesh, "a bare name");
        assert_eq!(from_root("shapes.0.file='sub/a.obj'"), mesh, "a text");
        let table = from_root("materials.m.reflectance = { file = 'a.png', repeat = [2.0, 1] }");
        let wanted =
            format!("materials.m.reflectance ={{ file = \"{}\", repeat = [2.0, 1] }}", full("a.png"));
        assert_eq!(table, wanted, "a table");
    }
}
