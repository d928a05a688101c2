//! TOML as a tree in which everything knows where it was written.
//!
//! Between the parser and the decoder stands this tree, because a scene is put together from several files and the
//! command line before anything is checked. Keys keep the order of the file.

use crate::scene::load::report::Report;
use crate::scene::load::source::{Source, Spot};
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
        let source = Source::file(Path::new(""), String::new(), 0);
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
        errors.is_empty().then(|| Self::of_table(table.into_inner(), source, 0))
    }

    /// The value that an override sets: TOML if it is that, else the text as it stands.
    pub(crate) fn parse_value(text: &str, source: &Arc<Source>) -> Self {
        match DeValue::parse(text) {
            Ok(value) => Self::of(value, source),
            Err(_) => {
                let spot = Spot { source: source.clone(), offset: 0 };
                Self { spot, content: Content::String(text.into()) }
            }
        }
    }

    fn of(value: Spanned<DeValue<'_>>, source: &Arc<Source>) -> Self {
        let offset = value.span().start;
        let content = match value.into_inner() {
            DeValue::Table(table) => return Self::of_table(table, source, offset),
            DeValue::Array(array) => {
                Content::Array(array.into_iter().map(|item| Self::of(item, source)).collect())
            }
            DeValue::String(text) => Content::String(text.into_owned()),
            DeValue::Boolean(value) => Content::Boolean(value),
            DeValue::Integer(number) => integer(&number),
            DeValue::Float(number) => Content::Float(float(&number)),
            DeValue::Datetime(_) => Content::Date,
        };
        Self { spot: Spot { source: source.clone(), offset }, content }
    }

    fn of_table(table: DeTable<'_>, source: &Arc<Source>, offset: usize) -> Self {
        let mut entries: Vec<Entry> = table
            .into_iter()
            .map(|(key, value)| {
                let spot = Spot { source: source.clone(), offset: key.span().start };
                Entry { key: key.into_inner().into_owned(), spot, node: Self::of(value, source) }
            })
            .collect();
        entries.sort_by_key(|entry| entry.spot.offset);
        Self { spot: Spot { source: source.clone(), offset }, content: Content::Table(entries) }
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
