//! The types that can stand behind a key: numbers, vectors, colours, words, files, lists.

use crate::math::Rgb;
use crate::scene::description::{
    Checker, ImageTexture, Knob, Located, Named, PerAxis, PerTangent, Roughness, ScalarTexture, Texture,
};
use crate::scene::load::node::{Content, Node};
use crate::scene::load::report::Report;
use crate::scene::load::words;
use crate::scene::record::{Choice, Rules, Table, Value};
use crate::scene::schema;
use glam::{DVec3, Vec3};
use serde_json::{Map, Value as Json, json};
use std::path::{Path, PathBuf};

/// Reports that a value is not what it must be.
fn mismatch<T: Value>(node: &Node, key: &str, found: &str, rules: &Rules, report: &mut Report) -> Option<T> {
    report.error(&node.spot, format!("`{key}` is {found}"), format!("it must be {}", T::expects(rules)));
    None
}

impl Value for f32 {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        let exact = real::<Self>(node, key, rules, report)?;
        let value = single(exact);
        if value.is_finite() && rules.allow(value.into()) {
            return Some(value);
        }
        mismatch(node, key, &said(exact), rules, report)
    }

    fn expects(rules: &Rules) -> String {
        format!("a number{}", rules.in_words())
    }

    fn schema(rules: &Rules, _: &mut Map<String, Json>) -> Json {
        schema::number("number", rules)
    }

    fn to_json(&self) -> Json {
        // The shortest decimal that reads back as the same single-precision number.
        self.to_string().parse::<f64>().map_or(Json::Null, Json::from)
    }
}

/// A number of any kind.
fn real<T: Value>(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<f64> {
    match node.content {
        Content::Integer(value) => Some(value as f64),
        Content::Float(value) => Some(value),
        _ => {
            mismatch::<T>(node, key, node.kind(), rules, report);
            None
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "what overflows is refused by those who ask")]
fn single(exact: f64) -> f32 {
    exact as f32
}

/// A number that is refused, in words.
fn said(exact: f64) -> String {
    match (exact.is_finite(), single(exact).is_finite()) {
        (true, false) => format!("{exact:e}, too large for single precision"),
        _ if exact != 0.0 && exact.abs() < 1e-4 => format!("{exact:e}"),
        _ => exact.to_string(),
    }
}

/// Moments, places and what carries there: they may be far from zero and yet close to each other. Rounded in the end, they must
/// fit into single precision.
impl Value for f64 {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        let value = real::<Self>(node, key, rules, report)?;
        let rounded = single(value);
        if rounded.is_finite() && rules.allow(rounded.into()) {
            return Some(value);
        }
        mismatch(node, key, &said(value), rules, report)
    }

    fn expects(rules: &Rules) -> String {
        f32::expects(rules)
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        f32::schema(rules, definitions)
    }

    fn to_json(&self) -> Json {
        Json::from(*self)
    }
}

macro_rules! integer {
    ($Integer:ty) => {
        impl Value for $Integer {
            fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
                let Content::Integer(value) = node.content else {
                    let found = if let Content::Float(value) = node.content {
                        format!("{value:?}, a float")
                    } else {
                        node.kind().into()
                    };
                    return mismatch(node, key, &found, rules, report);
                };
                let allowed = rules.allow(value as f64);
                match Self::try_from(value) {
                    Ok(value) if allowed => Some(value),
                    _ => mismatch(node, key, &value.to_string(), rules, report),
                }
            }

            fn expects(rules: &Rules) -> String {
                if rules.lower.is_none() && rules.upper.is_none() {
                    return format!("an integer from {} to {}", Self::MIN, Self::MAX);
                }
                format!("an integer{}", rules.in_words())
            }

            fn schema(rules: &Rules, _: &mut Map<String, Json>) -> Json {
                let mut schema = schema::number("integer", rules);
                if rules.lower.is_none() {
                    schema["minimum"] = Self::MIN.into();
                }
                if rules.upper.is_none() {
                    schema["maximum"] = Self::MAX.into();
                }
                schema
            }

            fn to_json(&self) -> Json {
                (*self).into()
            }
        }
    };
}

integer!(u32);
integer!(u64);
integer!(i32);

impl Value for bool {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        let Content::Boolean(value) = node.content else {
            return mismatch(node, key, node.kind(), rules, report);
        };
        Some(value)
    }

    fn expects(_: &Rules) -> String {
        "`true` or `false`".into()
    }

    fn schema(_: &Rules, _: &mut Map<String, Json>) -> Json {
        json!({ "type": "boolean" })
    }

    fn to_json(&self) -> Json {
        (*self).into()
    }
}

impl Value for String {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        match node.text() {
            Some("") => mismatch(node, key, "empty", rules, report),
            Some(text) => Some(text.into()),
            None => mismatch(node, key, node.kind(), rules, report),
        }
    }

    fn expects(_: &Rules) -> String {
        "a string with at least one character".into()
    }

    fn schema(_: &Rules, _: &mut Map<String, Json>) -> Json {
        json!({ "type": "string", "minLength": 1 })
    }

    fn to_json(&self) -> Json {
        self.as_str().into()
    }
}

impl Value for PathBuf {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        let Some(text) = node.text().filter(|text| !text.is_empty()) else {
            let found = if node.text().is_some() { "empty" } else { node.kind() };
            return mismatch(node, key, found, rules, report);
        };
        let named = node.spot.source.named(Path::new(text), rules);
        named.map_err(|(what, remedy)| report.error(&node.spot, what, remedy)).ok()
    }

    fn expects(rules: &Rules) -> String {
        let kinds = rules.extensions.iter().map(|extension| format!(".{extension}")).collect::<Vec<_>>();
        if kinds.is_empty() { "a file".into() } else { format!("a file ({})", words::join(&kinds, "or")) }
    }

    fn schema(_: &Rules, _: &mut Map<String, Json>) -> Json {
        json!({ "type": "string", "minLength": 1 })
    }

    fn to_json(&self) -> Json {
        self.to_string_lossy().into()
    }
}

/// The items of an array of `n` that spells a `T`.
fn items<'a, T: Value>(
    node: &'a Node,
    n: usize,
    key: &str,
    rules: &Rules,
    report: &mut Report,
) -> Option<&'a [Node]> {
    let Some(items) = node.items() else {
        mismatch::<T>(node, key, node.kind(), rules, report);
        return None;
    };
    if items.len() != n {
        let found = format!("an array of {}", words::count(items.len()));
        mismatch::<T>(node, key, &found, rules, report);
        return None;
    }
    Some(items)
}

impl<T: Value, const N: usize> Value for [T; N] {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        let items = items::<Self>(node, N, key, rules, report)?;
        // All items are looked at before any fault ends it: each is reported.
        let values: Vec<Option<T>> = items.iter().map(|item| T::decode(item, key, rules, report)).collect();
        values.into_iter().collect::<Option<Vec<T>>>()?.try_into().ok()
    }

    fn expects(rules: &Rules) -> String {
        format!("an array of {}, each {}", words::count(N), T::expects(rules))
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        json!({ "type": "array", "items": T::schema(rules, definitions), "minItems": N, "maxItems": N })
    }

    fn to_json(&self) -> Json {
        self.iter().map(Value::to_json).collect()
    }
}

impl Value for Vec3 {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        items::<Self>(node, 3, key, rules, report)?;
        let v = Self::from(<[f32; 3]>::decode(node, key, rules, report)?);
        if rules.nonzero && v == Self::ZERO {
            return mismatch(node, key, "zero", rules, report);
        }
        Some(v)
    }

    fn expects(rules: &Rules) -> String {
        let not_zero = if rules.nonzero { ", not all zero" } else { "" };
        format!("three numbers [x, y, z]{}{not_zero}", rules.in_words())
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        <[f32; 3]>::schema(rules, definitions)
    }

    fn to_json(&self) -> Json {
        self.to_array().to_json()
    }
}

impl Value for DVec3 {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        items::<Self>(node, 3, key, rules, report)?;
        let v = Self::from(<[f64; 3]>::decode(node, key, rules, report)?);
        if rules.nonzero && v.as_vec3() == Vec3::ZERO {
            return mismatch(node, key, "zero", rules, report);
        }
        Some(v)
    }

    fn expects(rules: &Rules) -> String {
        Vec3::expects(rules)
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        Vec3::schema(rules, definitions)
    }

    fn to_json(&self) -> Json {
        self.to_array().to_json()
    }
}

/// The three numbers of a `T`, for which one number may stand.
fn one_or_three<T: Value, N: Value + Copy>(
    node: &Node,
    key: &str,
    rules: &Rules,
    report: &mut Report,
) -> Option<[N; 3]> {
    if let Content::Integer(_) | Content::Float(_) = node.content {
        return N::decode(node, key, rules, report).map(|x| [x; 3]);
    }
    items::<T>(node, 3, key, rules, report)?;
    <[N; 3]>::decode(node, key, rules, report)
}

fn one_or_three_schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
    json!({ "anyOf": [f32::schema(rules, definitions), <[f32; 3]>::schema(rules, definitions)] })
}

fn one_or_three_json<N: Value + PartialEq>([x, y, z]: [N; 3]) -> Json {
    if x == y && y == z { x.to_json() } else { [x, y, z].to_json() }
}

impl Value for PerAxis {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        one_or_three::<Self, f64>(node, key, rules, report).map(|v| Self(v.into()))
    }

    fn expects(rules: &Rules) -> String {
        format!("a number or three numbers [x, y, z]{}", rules.in_words())
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        one_or_three_schema(rules, definitions)
    }

    fn to_json(&self) -> Json {
        one_or_three_json(self.0.to_array())
    }
}

impl Value for PerTangent {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        if let Content::Integer(_) | Content::Float(_) = node.content {
            return f32::decode(node, key, rules, report).map(|x| Self([x; 2]));
        }
        items::<Self>(node, 2, key, rules, report)?;
        <[f32; 2]>::decode(node, key, rules, report).map(Self)
    }

    fn expects(rules: &Rules) -> String {
        format!("a number or two numbers [x, y]{}", rules.in_words())
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        json!({ "anyOf": [f32::schema(rules, definitions), <[f32; 2]>::schema(rules, definitions)] })
    }

    #[expect(clippy::float_cmp, reason = "only equal numbers are written once")]
    fn to_json(&self) -> Json {
        if self.0[0] == self.0[1] { self.0[0].to_json() } else { self.0.to_json() }
    }
}

impl Value for Rgb<f32> {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        one_or_three::<Self, f32>(node, key, rules, report).map(|[r, g, b]| Self::new(r, g, b))
    }

    fn expects(rules: &Rules) -> String {
        format!("a colour: one number or [r, g, b], each{}", {
            let bounds = rules.in_words();
            if bounds.is_empty() { " a number".into() } else { bounds }
        })
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        one_or_three_schema(rules, definitions)
    }

    fn to_json(&self) -> Json {
        one_or_three_json([self.r, self.g, self.b])
    }
}

impl Value for Texture {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        match node.content {
            Content::Table(_) if node.get("file").is_some() => {
                ImageTexture::decode(node, key, rules, report).map(|image| Self::Image(Box::new(image)))
            }
            Content::Table(_) => Checker::decode(node, key, rules, report).map(Self::Checker),
            Content::Array(_) | Content::Integer(_) | Content::Float(_) => {
                Rgb::decode(node, key, rules, report).map(Self::Constant)
            }
            _ => mismatch(node, key, node.kind(), rules, report),
        }
    }

    fn expects(rules: &Rules) -> String {
        format!(
            "{}, or a texture {{ file = \"..\" }} or {{ checker = [.., ..] }}",
            Rgb::<f32>::expects(rules)
        )
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        let constant = Rgb::<f32>::schema(rules, definitions);
        let image = ImageTexture::schema(rules, definitions);
        json!({ "anyOf": [constant, Checker::schema(rules, definitions), image] })
    }

    fn to_json(&self) -> Json {
        match self {
            Self::Constant(color) => color.to_json(),
            Self::Checker(checker) => checker.to_json(),
            Self::Image(image) => image.to_json(),
        }
    }
}

impl Value for Roughness {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        if let Content::Table(_) = node.content {
            return ScalarTexture::decode(node, key, rules, report).map(|image| Self::Image(Box::new(image)));
        }
        PerTangent::decode(node, key, rules, report).map(Self::Constant)
    }

    fn expects(rules: &Rules) -> String {
        PerTangent::expects(rules)
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        let constant = PerTangent::schema(rules, definitions);
        json!({ "anyOf": [constant, ScalarTexture::schema(rules, definitions)] })
    }

    fn to_json(&self) -> Json {
        match self {
            Self::Constant(width) => width.to_json(),
            Self::Image(image) => image.to_json(),
        }
    }
}

impl<T: Value> Value for Knob<T> {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        match node.text() {
            Some("off") => Some(Self::Off),
            Some(text) => mismatch(node, key, &format!("`{text}`"), rules, report),
            None => T::decode(node, key, rules, report).map(Self::At),
        }
    }

    fn expects(rules: &Rules) -> String {
        format!("{}, or `off`", T::expects(rules))
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        json!({ "anyOf": [T::schema(rules, definitions), { "const": "off" }] })
    }

    fn to_json(&self) -> Json {
        match self {
            Self::Off => "off".into(),
            Self::At(value) => value.to_json(),
        }
    }
}

impl<T: Value> Value for Option<T> {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        T::decode(node, key, rules, report).map(Some)
    }

    fn expects(rules: &Rules) -> String {
        T::expects(rules)
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        T::schema(rules, definitions)
    }

    fn to_json(&self) -> Json {
        self.as_ref().map_or(Json::Null, Value::to_json)
    }

    fn absent(_: &Node) -> Option<Self> {
        Some(None)
    }
}

impl<T: Value> Value for Located<T> {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        let value = T::decode(node, key, rules, report)?;
        Some(Self { value, place: node.spot.place() })
    }

    fn expects(rules: &Rules) -> String {
        T::expects(rules)
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        T::schema(rules, definitions)
    }

    fn to_json(&self) -> Json {
        self.value.to_json()
    }

    fn absent(parent: &Node) -> Option<Self> {
        Some(Self { value: T::absent(parent)?, place: parent.spot.place() })
    }
}

/// The items that could be decoded: the faults of the others are in the report, which fails the whole.
impl<T: Value> Value for Vec<T> {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        match node.items() {
            Some(items) => {
                Some(items.iter().filter_map(|item| T::decode(item, key, rules, report)).collect())
            }
            None => mismatch(node, key, node.kind(), rules, report),
        }
    }

    fn expects(rules: &Rules) -> String {
        format!("an array, each entry {}", T::expects(rules))
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        json!({ "type": "array", "items": T::schema(rules, definitions) })
    }

    fn to_json(&self) -> Json {
        self.iter().map(Value::to_json).collect()
    }

    fn absent(_: &Node) -> Option<Self> {
        Some(vec![])
    }
}

/// The entries that could be decoded, as for lists.
impl<T: Table> Value for Vec<Named<T>> {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        let Some(entries) = node.entries() else {
            return mismatch(node, key, node.kind(), rules, report);
        };
        let named = entries.iter().filter_map(|entry| {
            let value = T::decode(&entry.node, &entry.key, rules, report)?;
            Some(Named { name: entry.key.clone(), place: entry.spot.place(), value })
        });
        Some(named.collect())
    }

    fn expects(_: &Rules) -> String {
        "a table with a name for each entry".into()
    }

    fn schema(rules: &Rules, definitions: &mut Map<String, Json>) -> Json {
        json!({ "type": "object", "additionalProperties": T::schema(rules, definitions) })
    }

    fn to_json(&self) -> Json {
        self.iter().map(|named| (named.name.clone(), named.value.to_json())).collect()
    }

    fn absent(_: &Node) -> Option<Self> {
        Some(vec![])
    }
}

/// A word out of a few.
pub(crate) fn decode_choice<C: Choice + Value>(node: &Node, key: &str, report: &mut Report) -> Option<C> {
    let Some(word) = node.text() else {
        return mismatch(node, key, node.kind(), &Rules::default(), report);
    };
    let found = C::WORDS.iter().find(|&&(known, _, _)| known == word);
    if found.is_none() {
        let known: Vec<&str> = C::WORDS.iter().map(|&(known, _, _)| known).collect();
        let remedy = words::suggest(word, &known);
        report.error(&node.spot, format!("`{key}` is `{word}`"), remedy);
    }
    found.map(|&(_, _, value)| value)
}

/// All the words there are.
pub(crate) fn choice_in_words<C: Choice>() -> String {
    words::list(C::WORDS.iter().map(|&(word, _, _)| word), "or")
}
