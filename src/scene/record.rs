//! The macros by which a table of the scene file is declared once.
//!
//! One declaration gives a type and its [`Table`], from which come the decoder, the range checks, the suggestions for
//! misspelt keys, the JSON Schema and the way back to JSON. A key reads
//!
//! ```text
//! /// What it means, in one sentence.
//! name: Type = default, unit("m"), above(0.0);
//! ```
//!
//! where default and rules (the methods of [`Rules`]) may be left out. A key without a default must be written, unless
//! its type can do without (an `Option`, a list, a table whose keys all have defaults).

use crate::scene::load::decode::Fields;
use crate::scene::load::node::Node;
use crate::scene::load::report::Report;
use serde_json::{Map, Value as Json};

/// A key of a table.
#[derive(Debug)]
pub(crate) struct Key<T> {
    /// As written in files.
    pub(crate) name: &'static str,
    /// What it means.
    pub(crate) doc: &'static str,
    /// What its value must satisfy.
    pub(crate) rules: Rules,
    /// What it is where it is not written.
    pub(crate) default: Option<T>,
}

/// What a value must satisfy beyond being of its type; each number of a list or colour by itself.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rules {
    /// Unit, for explanations.
    pub(crate) unit: Option<&'static str>,
    /// Least value, and whether it is itself excluded.
    pub(crate) lower: Option<(f64, bool)>,
    /// Greatest value, and whether it is itself excluded.
    pub(crate) upper: Option<(f64, bool)>,
    /// Whether a vector must have a length.
    pub(crate) nonzero: bool,
    /// Extensions a file may have, in lower case.
    pub(crate) extensions: &'static [&'static str],
    /// Whether a file may be missing.
    pub(crate) may_be_missing: bool,
}

impl Rules {
    pub(crate) fn unit(self, unit: &'static str) -> Self {
        Self { unit: Some(unit), ..self }
    }

    pub(crate) fn min(self, bound: f64) -> Self {
        Self { lower: Some((bound, false)), ..self }
    }

    pub(crate) fn max(self, bound: f64) -> Self {
        Self { upper: Some((bound, false)), ..self }
    }

    pub(crate) fn above(self, bound: f64) -> Self {
        Self { lower: Some((bound, true)), ..self }
    }

    pub(crate) fn below(self, bound: f64) -> Self {
        Self { upper: Some((bound, true)), ..self }
    }

    pub(crate) fn nonzero(self) -> Self {
        Self { nonzero: true, ..self }
    }

    pub(crate) fn file(self, extensions: &'static [&'static str]) -> Self {
        Self { extensions, ..self }
    }

    /// A picture on a surface, which is warned of and made up for where it is missing.
    pub(crate) fn picture(self, extensions: &'static [&'static str]) -> Self {
        Self { extensions, may_be_missing: true, ..self }
    }

    /// Whether a number lies within the bounds; none does that is not a number.
    pub(crate) fn allow(&self, x: f64) -> bool {
        let above = self.lower.is_none_or(|(bound, excluded)| x > bound || (!excluded && x >= bound));
        let below = self.upper.is_none_or(|(bound, excluded)| x < bound || (!excluded && x <= bound));
        above && below && !x.is_nan()
    }

    /// Bounds and unit in words, to be put behind a noun: ` from 0 to 1`, ` above 0 m`.
    pub(crate) fn in_words(&self) -> String {
        let bounds = match (self.lower, self.upper) {
            (None, None) => String::new(),
            (Some((a, true)), None) => format!(" above {}", short(a)),
            (Some((a, false)), None) => format!(" of at least {}", short(a)),
            (None, Some((b, true))) => format!(" below {}", short(b)),
            (None, Some((b, false))) => format!(" of at most {}", short(b)),
            (Some((a, false)), Some((b, false))) => format!(" from {} to {}", short(a), short(b)),
            (Some((a, from)), Some((b, to))) => {
                let (from, to) =
                    (if from { "above" } else { "at least" }, if to { "below" } else { "at most" });
                format!(" {from} {} and {to} {}", short(a), short(b))
            }
        };
        match self.unit {
            Some(unit) if bounds.is_empty() => format!(" in {unit}"),
            Some(unit) => format!("{bounds} {unit}"),
            None => bounds,
        }
    }
}

/// A number in words: great round ones by their exponent.
fn short(x: f64) -> String {
    let (plain, scientific) = (x.to_string(), format!("{x:e}"));
    if x.abs() >= 1e6 && scientific.len() < plain.len() { scientific } else { plain }
}

/// What can stand behind a key.
pub(crate) trait Value: Sized {
    /// The value that a node spells, or `None` with the problems reported.
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self>;

    /// What it must be, in words, after "must be".
    fn expects(rules: &Rules) -> String;

    /// Its JSON Schema; definitions it refers to are added to `definitions`.
    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json;

    /// As it could stand in a scene file, in JSON.
    fn to_json(&self) -> Json;

    /// What it is where the key is missing from the table at `parent` and has no default.
    fn absent(parent: &Node) -> Option<Self> {
        let _ = parent;
        None
    }
}

/// A value whose parts are the keys of a table.
pub(crate) trait Table: Sized {
    /// Its name among the definitions of the schema.
    const NAME: &'static str;
    /// What it is, in one sentence.
    const ABOUT: &'static str;

    /// The value whose keys are among `fields`.
    fn read(fields: &mut Fields<'_>) -> Option<Self>;

    /// Adds the keys to `into`.
    fn write(&self, into: &mut Map<String, Json>);

    /// The kinds there are, each with its keys; one for a plain record.
    fn kinds(definitions: &mut Map<String, Json>) -> Vec<Kind>;
}

/// Adds a key to a table, unless its value is none.
pub(crate) fn insert<T: Value>(into: &mut Map<String, Json>, key: &str, value: &T) {
    let json = value.to_json();
    if !json.is_null() {
        into.insert(key.into(), json);
    }
}

/// One kind of table, for the schema and for remedies.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kind {
    /// What makes it of this kind, outermost choice first: ``type `mesh` ``, `` `metal` ``.
    pub(crate) marks: Vec<String>,
    /// What it is.
    pub(crate) about: &'static str,
    /// Schemas by key.
    pub(crate) properties: Map<String, Json>,
    /// Keys that must be written.
    pub(crate) required: Vec<&'static str>,
}

impl Kind {
    /// The same kind with one more key.
    pub(crate) fn key<T: Value>(mut self, key: &Key<T>, definitions: &mut Map<String, Json>) -> Self {
        let mut schema = T::schema(&key.rules, definitions);
        if let Json::Object(schema) = &mut schema {
            let unit = key.rules.unit.map_or(String::new(), |unit| format!(" Unit: {unit}."));
            schema.insert("description".into(), format!("{}{unit}", key.doc.trim()).into());
            if let Some(default) = &key.default {
                schema.insert("default".into(), default.to_json());
            }
        }
        self.properties.insert(key.name.into(), schema);
        if key.default.is_none() && T::absent(&Node::nowhere()).is_none() {
            self.required.push(key.name);
        }
        self
    }

    /// The kinds that come of adding the keys of `inner`.
    pub(crate) fn with(self, inner: Vec<Self>) -> Vec<Self> {
        inner.into_iter().map(|inner| self.clone().joined(inner)).collect()
    }

    fn joined(mut self, inner: Self) -> Self {
        self.marks.extend(inner.marks);
        self.properties.extend(inner.properties);
        self.required.extend(inner.required);
        if self.about.is_empty() {
            self.about = inner.about;
        }
        self
    }
}

/// How the kind of a table is told.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Selector {
    /// By the word behind `type`; if a default is given, it may be left out.
    Tag(Option<&'static str>),
    /// By the presence of the key that the kind is named after.
    Presence,
}

impl Selector {
    pub(crate) const fn tag() -> Self {
        Self::Tag(None)
    }

    pub(crate) const fn tag_or(default: &'static str) -> Self {
        Self::Tag(Some(default))
    }

    pub(crate) const fn key() -> Self {
        Self::Presence
    }

    /// A kind without its keys.
    pub(crate) fn kind(self, tag: &'static str, about: &'static str) -> Kind {
        let Self::Tag(default) = self else {
            return Kind { marks: vec![self.mark(tag)], about, ..Kind::default() };
        };
        let mut schema = Map::new();
        schema.insert("const".into(), tag.into());
        schema.insert("description".into(), about.trim().into());
        if default == Some(tag) {
            schema.insert("default".into(), tag.into());
        }
        let required = if default == Some(tag) { vec![] } else { vec!["type"] };
        let mut properties = Map::new();
        properties.insert("type".into(), schema.into());
        Kind { marks: vec![self.mark(tag)], about, properties, required }
    }

    /// How messages speak of a kind.
    pub(crate) fn mark(self, tag: &str) -> String {
        match self {
            Self::Tag(_) => format!("type `{tag}`"),
            Self::Presence => format!("`{tag}`"),
        }
    }

    /// Writes what tells the kind.
    pub(crate) fn write(self, tag: &'static str, into: &mut Map<String, Json>) {
        if let Self::Tag(_) = self {
            into.insert("type".into(), tag.into());
        }
    }
}

/// A table: a struct with one field per key; `..field: Type` stands for the keys of another table in the same place.
macro_rules! record {
    (
        $(#[doc = $about:literal])+
        pub struct $Record:ident $(checked by $check:path)? {
            $( $(#[doc = $doc:literal])+ $key:ident : $Type:ty $(= $default:expr)? $(, $rule:ident($($arg:expr),*))* ; )*
            $( ..$rest:ident : $Rest:ty, $rest_doc:literal; )?
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq)]
        pub struct $Record {
            $( $(#[doc = $doc])+ pub $key: $Type, )*
            $( #[doc = $rest_doc] pub $rest: $Rest, )?
        }

        impl $crate::scene::record::Table for $Record {
            const NAME: &'static str = stringify!($Record);
            const ABOUT: &'static str = concat!($($about),+);

            fn read(fields: &mut $crate::scene::load::decode::Fields<'_>) -> Option<Self> {
                $( let $key = fields.take($crate::scene::record::key!($(#[doc = $doc])+ $key: $Type $(= $default)? $(, $rule($($arg),*))*)); )*
                $( let $rest = <$Rest as $crate::scene::record::Table>::read(fields); )?
                let read = Self { $( $key: $key?, )* $( $rest: $rest?, )? };
                $( $check(&read, fields); )?
                Some(read)
            }

            fn write(&self, into: &mut serde_json::Map<String, serde_json::Value>) {
                $( $crate::scene::record::insert(into, stringify!($key), &self.$key); )*
                $( $crate::scene::record::Table::write(&self.$rest, into); )?
            }

            fn kinds(definitions: &mut serde_json::Map<String, serde_json::Value>) -> Vec<$crate::scene::record::Kind> {
                let kind = $crate::scene::record::Kind::default();
                $( let kind = kind.key(&$crate::scene::record::key!($(#[doc = $doc])+ $key: $Type $(= $default)? $(, $rule($($arg),*))*), definitions); )*
                let kinds = vec![kind];
                $( let kinds = kinds.into_iter().flat_map(|kind| kind.with(<$Rest as $crate::scene::record::Table>::kinds(definitions))).collect(); )?
                kinds
            }
        }
    };
}

/// A table of several kinds: an enum with one variant per kind, told apart by a [`Selector`].
macro_rules! tagged {
    (
        $(#[doc = $about:literal])+
        pub enum $Tagged:ident by $selector:ident($($selector_arg:expr)?) $(checked by $check:path)? {
            $(
                $(#[doc = $kind_about:literal])+
                $tag:literal => $Kind:ident {
                    $( $(#[doc = $doc:literal])+ $key:ident : $Type:ty $(= $default:expr)? $(, $rule:ident($($arg:expr),*))* ; )*
                    $( ..$rest:ident : $Rest:ty, $rest_doc:literal; )?
                }
            )+
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq)]
        pub enum $Tagged {
            $(
                $(#[doc = $kind_about])+
                $Kind {
                    $( $(#[doc = $doc])+ $key: $Type, )*
                    $( #[doc = $rest_doc] $rest: $Rest, )?
                },
            )+
        }

        impl $Tagged {
            const SELECTOR: $crate::scene::record::Selector = $crate::scene::record::Selector::$selector($($selector_arg)?);
        }

        impl $crate::scene::record::Table for $Tagged {
            const NAME: &'static str = stringify!($Tagged);
            const ABOUT: &'static str = concat!($($about),+);

            fn read(fields: &mut $crate::scene::load::decode::Fields<'_>) -> Option<Self> {
                let read = match fields.select(Self::SELECTOR, &[$($tag),+])? {
                    $(
                        $tag => {
                            $( let $key = fields.take($crate::scene::record::key!($(#[doc = $doc])+ $key: $Type $(= $default)? $(, $rule($($arg),*))*)); )*
                            $( let $rest = <$Rest as $crate::scene::record::Table>::read(fields); )?
                            Self::$Kind { $( $key: $key?, )* $( $rest: $rest?, )? }
                        }
                    )+
                    _ => return None,
                };
                $( $check(&read, fields); )?
                Some(read)
            }

            fn write(&self, into: &mut serde_json::Map<String, serde_json::Value>) {
                match self {
                    $(
                        Self::$Kind { $( $key, )* $( $rest, )? } => {
                            Self::SELECTOR.write($tag, into);
                            $( $crate::scene::record::insert(into, stringify!($key), $key); )*
                            $( $crate::scene::record::Table::write($rest, into); )?
                        }
                    )+
                }
            }

            fn kinds(definitions: &mut serde_json::Map<String, serde_json::Value>) -> Vec<$crate::scene::record::Kind> {
                let mut all = Vec::new();
                $(
                    let kind = Self::SELECTOR.kind($tag, concat!($($kind_about),+));
                    $( let kind = kind.key(&$crate::scene::record::key!($(#[doc = $doc])+ $key: $Type $(= $default)? $(, $rule($($arg),*))*), definitions); )*
                    let kinds = vec![kind];
                    $( let kinds = kinds.into_iter().flat_map(|kind| kind.with(<$Rest as $crate::scene::record::Table>::kinds(definitions))); )?
                    all.extend(kinds);
                )+
                all
            }
        }
    };
}

/// The [`Key`] that a line of a table declares.
macro_rules! key {
    ($(#[doc = $doc:literal])+ $key:ident : $Type:ty $(= $default:expr)? $(, $rule:ident($($arg:expr),*))*) => {
        $crate::scene::record::Key::<$Type> {
            name: stringify!($key),
            doc: concat!($($doc),+),
            rules: $crate::scene::record::Rules::default()$(.$rule($($arg),*))*,
            default: None$(.or(Some($default)))?,
        }
    };
}

/// A word out of a few.
macro_rules! choice {
    (
        $(#[doc = $about:literal])+
        pub enum $Choice:ident { $( $(#[doc = $doc:literal])+ $word:literal => $Word:ident, )+ }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $Choice {
            $( $(#[doc = $doc])+ $Word, )+
        }

        $crate::scene::record::words! { $Choice { $( $(#[doc = $doc])+ $word => $Word, )+ } }
    };
}

/// The words that stand for the values of an enum, each with what it means to who writes scene files.
macro_rules! words {
    ( $Choice:ident { $( $(#[doc = $doc:literal])+ $word:literal => $Word:ident, )+ } ) => {
        impl $crate::scene::record::Choice for $Choice {
            const WORDS: &'static [(&'static str, &'static str, Self)] =
                &[$( ($word, concat!($($doc),+), Self::$Word), )+];
        }

        impl $crate::scene::record::Value for $Choice {
            fn decode(
                node: &$crate::scene::load::node::Node,
                key: &str,
                _: &$crate::scene::record::Rules,
                report: &mut $crate::scene::load::report::Report,
            ) -> Option<Self> {
                $crate::scene::load::value::decode_choice(node, key, report)
            }

            fn expects(_: &$crate::scene::record::Rules) -> String {
                $crate::scene::load::value::choice_in_words::<Self>()
            }

            fn schema(
                _: &$crate::scene::record::Rules,
                _: &mut serde_json::Map<String, serde_json::Value>,
            ) -> serde_json::Value {
                $crate::scene::schema::of_choice::<Self>()
            }

            fn to_json(&self) -> serde_json::Value {
                self.word().into()
            }
        }

        impl $Choice {
            /// All there are.
            pub const ALL: &'static [Self] = &[$( Self::$Word, )+];

            /// The word that stands for it in files and on the command line.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self {
                    $( Self::$Word => $word, )+
                }
            }
        }
    };
}

/// A value that is one of a few words.
pub(crate) trait Choice: Copy + PartialEq + 'static {
    /// Each word, its meaning and what it stands for.
    const WORDS: &'static [(&'static str, &'static str, Self)];
}

pub(crate) use {choice, key, record, tagged, words};
