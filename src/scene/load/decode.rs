//! From a table of the tree to its type, with everything wrong on the way reported.

use crate::scene::load::node::{Entry, Node};
use crate::scene::load::report::Report;
use crate::scene::load::source::Spot;
use crate::scene::load::words;
use crate::scene::record::{Key, Kind, Rules, Selector, Table, Value};
use crate::scene::schema;
use serde_json::{Map, Value as Json};

/// The keys of a table while it is decoded: remembers which ones mean something, so that the others can be reported.
#[derive(Debug)]
pub(crate) struct Fields<'a> {
    node: &'a Node,
    entries: &'a [Entry],
    known: Vec<&'static str>,
    /// What makes the table of its kind, as in [`Kind::marks`].
    marks: Vec<String>,
    /// Whether the kind could not be told, so that no key can be called unknown.
    undecided: bool,
    report: &'a mut Report,
}

impl Fields<'_> {
    /// The value behind a key, its default, or `None` with the problem reported.
    pub(crate) fn take<T: Value>(&mut self, key: Key<T>) -> Option<T> {
        self.known.push(key.name);
        if let Some(entry) = self.entries.iter().find(|entry| entry.key == key.name) {
            return T::decode(&entry.node, key.name, &key.rules, self.report);
        }
        let value = key.default.or_else(|| T::absent(self.node));
        if value.is_none() {
            let remedy = format!("give {}", T::expects(&key.rules));
            self.report.error(&self.node.spot, format!("missing key `{}`", key.name), remedy);
        }
        value
    }

    /// The tag of the kind of this table, or `None` with the problem reported.
    pub(crate) fn select(&mut self, selector: Selector, tags: &[&'static str]) -> Option<&'static str> {
        let selected = match selector {
            Selector::Tag(default) => self.select_by_tag(default, tags),
            Selector::Presence => self.select_by_presence(tags),
        };
        self.undecided |= selected.is_none();
        self.marks.extend(selected.map(|tag| selector.mark(tag)));
        selected
    }

    fn select_by_tag(
        &mut self,
        default: Option<&'static str>,
        tags: &[&'static str],
    ) -> Option<&'static str> {
        self.known.push("type");
        let all = || format!("it must be {}", words::list(tags.iter().copied(), "or"));
        let Some(node) = self.node.get("type") else {
            if default.is_none() {
                self.report.error(&self.node.spot, "missing key `type`", all());
            }
            return default;
        };
        let Some(word) = node.text() else {
            self.report.error(&node.spot, format!("`type` is {}", node.kind()), all());
            return None;
        };
        let tag = tags.iter().copied().find(|&tag| tag == word);
        if tag.is_none() {
            let remedy = words::suggest(word, tags);
            self.report.error(&node.spot, format!("unknown type `{word}`"), remedy);
        }
        tag
    }

    fn select_by_presence(&mut self, tags: &[&'static str]) -> Option<&'static str> {
        let tag = tags.iter().copied().find(|tag| self.node.get(tag).is_some());
        if tag.is_none() {
            let misspelt = self.entries.iter().filter(|entry| !self.known.contains(&entry.key.as_str()));
            let meant = |entry: &'_ Entry| words::nearest(&entry.key, tags.iter().copied());
            if let Some((entry, meant)) = misspelt.into_iter().find_map(|entry| Some((entry, meant(entry)?)))
            {
                let what = format!("unknown key `{}`", entry.key);
                self.report.error(&entry.spot, what, format!("did you mean `{meant}`?"));
            } else {
                let what = format!("one of the keys {} is needed", words::list(tags.iter().copied(), "or"));
                self.report.error_without_remedy(&self.node.spot, what);
            }
        }
        tag
    }

    /// Reports that a value, which is good by itself, is not good among the others.
    pub(crate) fn problem(&mut self, key: &str, what: impl Into<String>, remedy: impl Into<String>) {
        let spot = self.spot(key).clone();
        self.report.error(&spot, what, remedy);
    }

    /// Reports that the value behind `key` in item `index` of the list `list` is not good among the others.
    pub(crate) fn problem_in(
        &mut self,
        (list, index, key): (&str, usize, &str),
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let item = self.node.get(list).and_then(Node::items).and_then(|items| items.get(index));
        let node = item.map(|item| item.get(key).unwrap_or(item)).unwrap_or(self.node);
        let spot = node.spot.clone();
        self.report.error(&spot, what, remedy);
    }

    /// Whether every item of a list could be decoded, so that it can be asked how they go together.
    pub(crate) fn is_whole<T>(&self, list: &str, decoded: &[T]) -> bool {
        self.node.get(list).and_then(Node::items).is_none_or(|items| items.len() == decoded.len())
    }

    fn spot(&self, key: &str) -> &Spot {
        self.node.get(key).map_or(&self.node.spot, |node| &node.spot)
    }

    fn report_unknown(&mut self, kinds: &[Kind]) {
        if self.undecided {
            return;
        }
        for entry in self.entries.iter().filter(|entry| !self.known.contains(&entry.key.as_str())) {
            let key = entry.key.as_str();
            let homes: Vec<&Kind> = kinds.iter().filter(|kind| kind.properties.contains_key(key)).collect();
            if let Some((clash, home)) = self.clash(&homes) {
                let what = format!("`{key}` does not go with {clash}");
                let remedy = match home {
                    Some(home) => format!("it belongs to {home}"),
                    None => "remove one of them".into(),
                };
                self.report.error(&entry.spot, what, remedy);
                continue;
            }
            let remedy = words::suggest_name(key, &self.known, "key");
            self.report.error(&entry.spot, format!("unknown key `{key}`"), remedy);
        }
    }

    /// The mark of this table that keeps a key from standing in it, and the marks it would stand with; the latter only
    /// where they are words behind `type`.
    fn clash(&self, homes: &[&Kind]) -> Option<(String, Option<String>)> {
        if homes.is_empty() {
            return None;
        }
        let depth = (0..self.marks.len())
            .find(|&i| homes.iter().all(|home| home.marks.get(..=i) != Some(&self.marks[..=i])))?;
        let clash = self.marks[depth].clone();
        let mut others: Vec<String> =
            homes.iter().filter_map(|home| home.marks.get(depth).cloned()).collect();
        others.dedup();
        let home = clash.starts_with("type").then(|| words::join(&others, "or"));
        Some((clash, home))
    }
}

impl<T: Table> Value for T {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        let Some(entries) = node.entries() else {
            let remedy = format!("it must be {}", Self::expects(rules));
            report.error(&node.spot, format!("`{key}` is {}", node.kind()), remedy);
            return None;
        };
        let mut fields = Fields { node, entries, known: vec![], marks: vec![], undecided: false, report };
        let value = Self::read(&mut fields);
        if fields.entries.iter().any(|entry| !fields.known.contains(&entry.key.as_str())) {
            fields.report_unknown(&Self::kinds(&mut Map::new()));
        }
        value
    }

    fn expects(_: &Rules) -> String {
        "a table".into()
    }

    fn schema(_: &Rules, definitions: &mut Map<String, Json>) -> Json {
        schema::of_table::<Self>(definitions)
    }

    fn to_json(&self) -> Json {
        let mut object = Map::new();
        self.write(&mut object);
        object.into()
    }

    fn absent(parent: &Node) -> Option<Self> {
        let node = Node::empty_table(parent.spot.clone());
        Self::decode(&node, "", &Rules::default(), &mut Report::default())
    }
}
