//! TOML as a tree in which everything knows where it was written.
//!
//! Between the parser and the decoder stands this tree, because a scene is put together from several files and the
//! command line before anything is checked. Keys keep the order of the file.

use crate::scene::load::report::Report;
use crate::scene::load::source::{Source, Spot};
use crate::trust::Limit;
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeFloat, DeInteger, DeTable, DeValue};

/// A value.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// Where it starts; for a table with a header, the header.
    pub(crate) spot: Spot,
    /// What it is.
    pub(crate) content: Content,
}

/// What a value may be.
#[derive(Clone, Debug)]
pub(crate) enum Content {
    /// `true` or `false`.
    Boolean(bool),
    /// A whole number; infinite as a float where it is beyond all integer types.
    Integer(i128),
    /// A number with a point or an exponent, also nan and inf.
    Float(f64),
    /// A text.
    String(String),
    /// A date or a time.
    Date,
    /// A list.
    Array(Vec<Node>),
    /// Keys with values.
    Table(Vec<Entry>),
}

/// A key with its value.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    /// The key.
    pub(crate) key: String,
    /// Where it is written.
    pub(crate) spot: Spot,
    /// Its value.
    pub(crate) node: Node,
}

impl Node {
    /// An empty table.
    pub(crate) fn empty_table(spot: Spot) -> Self {
        Self { spot, content: Content::Table(vec![]) }
    }

    /// An empty table that nobody wrote.
    pub(crate) fn nowhere() -> Self {
        let source = Source::file(Path::new(""), String::new(), 0, &Arc::default());
        Self::empty_table(Spot { source: source.into(), offset: 0 })
    }

    /// The tables and values of a text; `None` where it is no TOML, with all syntax errors reported.
    pub(crate) fn parse(source: &Arc<Source>, report: &mut Report) -> Option<Self> {
        let (table, errors) = DeTable::parse_recoverable(source.text());
        for error in &errors {
            let offset = error.span().map_or(0, |span| span.start);
            let spot = Spot { source: source.clone(), offset };
            let message = error.message().lines().collect::<Vec<_>>().join(", ");
            match message.split_once(", expected ") {
                Some((what, expected)) => report.error(&spot, what, format!("expected {expected}")),
                None if message == "duplicate key" => {
                    report.error(&spot, message, "it stands further up already; remove one of them");
                }
                None => report.error_without_remedy(&spot, message),
            }
        }
        if !errors.is_empty() {
            return None;
        }
        let mut planted = Planted::new(source);
        let tree = planted.table(table.into_inner(), 0, 0);
        planted.is_sound(report).then_some(tree)
    }

    /// The value that an override sets: TOML if it is that, else the text as it stands.
    pub(crate) fn parse_value(text: &str, source: &Arc<Source>, report: &mut Report) -> Self {
        match DeValue::parse(text) {
            Ok(value) => {
                let mut planted = Planted::new(source);
                let value = planted.value(value, 1);
                planted.is_sound(report);
                value
            }
            Err(_) => {
                let spot = Spot { source: source.clone(), offset: 0 };
                Self { spot, content: Content::String(text.into()) }
            }
        }
    }

    /// The keys and values, if it is a table.
    pub(crate) fn entries(&self) -> Option<&[Entry]> {
        if let Content::Table(entries) = &self.content { Some(entries) } else { None }
    }

    /// The items, if it is a list.
    pub(crate) fn items(&self) -> Option<&[Self]> {
        if let Content::Array(items) = &self.content { Some(items) } else { None }
    }

    /// The text, if it is one.
    pub(crate) fn text(&self) -> Option<&str> {
        if let Content::String(text) = &self.content { Some(text) } else { None }
    }

    /// What stands behind a key, if it is a table that has it.
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        Some(&self.entries()?.iter().find(|entry| entry.key == key)?.node)
    }

    /// The type, with an article.
    pub(crate) fn kind(&self) -> &'static str {
        match &self.content {
            Content::Boolean(_) => "a boolean",
            Content::Integer(_) => "an integer",
            Content::Float(_) => "a float",
            Content::String(_) => "a string",
            Content::Date => "a date",
            Content::Array(_) => "an array",
            Content::Table(_) => "a table",
        }
    }
}

/// A tree that is made of what the parser gives, no deeper than allowed: it is walked by recursion from here on.
struct Planted<'a> {
    source: &'a Arc<Source>,
    /// The first thing that stands too deep.
    too_deep: Option<usize>,
}

impl<'a> Planted<'a> {
    fn new(source: &'a Arc<Source>) -> Self {
        Self { source, too_deep: None }
    }

    /// Whether nothing stands too deep; else that is reported.
    fn is_sound(&self, report: &mut Report) -> bool {
        let limits = self.source.limits();
        if let (Some(offset), Some(most)) = (self.too_deep, limits.most(Limit::Nesting)) {
            let what = format!("tables and lists stand in each other more than {most} deep");
            let remedy = format!("if that is meant, allow more by `--limits nesting={}`", most + 1);
            report.error(&self.spot(offset), what, remedy);
            return false;
        }
        true
    }

    fn spot(&self, offset: usize) -> Spot {
        Spot { source: self.source.clone(), offset }
    }

    fn value(&mut self, value: Spanned<DeValue<'_>>, depth: u64) -> Node {
        let offset = value.span().start;
        let content = match value.into_inner() {
            DeValue::Table(table) => return self.table(table, offset, depth),
            DeValue::Array(_) if self.is_too_deep(offset, depth) => Content::Array(vec![]),
            DeValue::Array(array) => {
                Content::Array(array.into_iter().map(|item| self.value(item, depth + 1)).collect())
            }
            DeValue::String(text) => Content::String(text.into_owned()),
            DeValue::Boolean(value) => Content::Boolean(value),
            DeValue::Integer(number) => integer(&number),
            DeValue::Float(number) => Content::Float(float(&number)),
            DeValue::Datetime(_) => Content::Date,
        };
        Node { spot: self.spot(offset), content }
    }

    fn table(&mut self, table: DeTable<'_>, offset: usize, depth: u64) -> Node {
        if self.is_too_deep(offset, depth) {
            return Node::empty_table(self.spot(offset));
        }
        let mut entries: Vec<Entry> = table
            .into_iter()
            .map(|(key, value)| {
                let spot = self.spot(key.span().start);
                Entry { key: key.into_inner().into_owned(), spot, node: self.value(value, depth + 1) }
            })
            .collect();
        entries.sort_by_key(|entry| entry.spot.offset);
        Node { spot: self.spot(offset), content: Content::Table(entries) }
    }

    /// Whether something at that depth is left out, which is noted.
    fn is_too_deep(&mut self, offset: usize, depth: u64) -> bool {
        let is = self.source.limits().check(Limit::Nesting, depth).is_err();
        if is {
            self.too_deep.get_or_insert(offset);
        }
        is
    }
}

fn integer(number: &DeInteger<'_>) -> Content {
    match i128::from_str_radix(number.as_str(), number.radix()) {
        Ok(value) => Content::Integer(value),
        Err(_) if number.as_str().starts_with('-') => Content::Float(f64::NEG_INFINITY),
        Err(_) => Content::Float(f64::INFINITY),
    }
}

fn float(number: &DeFloat<'_>) -> f64 {
    number.as_str().parse().unwrap_or(f64::NAN)
}
