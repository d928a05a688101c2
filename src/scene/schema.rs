//! JSON Schema (draft 2020-12) of the scene file, for editors and for checks outside of this program.
//!
//! It comes from the declarations in [`crate::scene::description`]. What it cannot say: that references resolve, that
//! files exist, and relations between keys of one table, such as that a camera does not stand at the point it looks at.

use crate::scene::description::{Batch, Description};
use crate::scene::record::{Choice, Kind, Rules, Table};
use serde_json::{Map, Value as Json, json};

/// The schema of a scene file.
#[must_use]
pub fn schema() -> Json {
    of_file::<Description>("Scene file of Specula")
}

/// The schema of a batch file.
#[must_use]
pub fn schema_of_batch() -> Json {
    of_file::<Batch>("Batch file of Specula")
}

fn of_file<T: Table>(title: &str) -> Json {
    let mut definitions = Map::new();
    let kinds = T::kinds(&mut definitions);
    let mut schema = Map::new();
    schema.insert("$schema".into(), "https://json-schema.org/draft/2020-12/schema".into());
    schema.insert("title".into(), title.into());
    schema.extend(of_kinds(T::ABOUT, kinds));
    schema.insert("$defs".into(), definitions.into());
    schema.into()
}

/// The schema of a table: a reference to its definition, which is made on first use.
pub(crate) fn of_table<T: Table>(definitions: &mut Map<String, Json>) -> Json {
    if !definitions.contains_key(T::NAME) {
        definitions.insert(T::NAME.into(), Json::Null);
        let kinds = T::kinds(definitions);
        definitions.insert(T::NAME.into(), of_kinds(T::ABOUT, kinds).into());
    }
    json!({ "$ref": format!("#/$defs/{}", T::NAME) })
}

/// The schema of a word out of a few.
pub(crate) fn of_choice<C: Choice>() -> Json {
    let alternatives: Vec<Json> =
        C::WORDS.iter().map(|(word, doc, _)| json!({ "const": word, "description": doc.trim() })).collect();
    let words: Vec<&str> = C::WORDS.iter().map(|(word, _, _)| *word).collect();
    // The list is what editors complete from, the alternatives carry the explanations.
    json!({ "type": "string", "enum": words, "oneOf": alternatives })
}

/// The schema of a number.
pub(crate) fn number(kind: &str, rules: &Rules) -> Json {
    let mut schema = Map::new();
    schema.insert("type".into(), kind.into());
    if let Some((bound, excluded)) = rules.lower {
        schema.insert(if excluded { "exclusiveMinimum" } else { "minimum" }.into(), bound_json(bound));
    }
    if let Some((bound, excluded)) = rules.upper {
        schema.insert(if excluded { "exclusiveMaximum" } else { "maximum" }.into(), bound_json(bound));
    }
    schema.into()
}

#[expect(clippy::cast_possible_truncation, reason = "only whole numbers within the range of i64 are cast")]
fn bound_json(bound: f64) -> Json {
    if bound.fract() == 0.0 && bound.abs() < 1e15 { (bound as i64).into() } else { bound.into() }
}

fn of_kinds(about: &str, kinds: Vec<Kind>) -> Map<String, Json> {
    let mut schema = Map::new();
    schema.insert("description".into(), about.trim().into());
    let mut objects: Vec<Map<String, Json>> = kinds.into_iter().map(of_kind).collect();
    if objects.len() == 1 {
        let Some(mut only) = objects.pop() else { return schema };
        only.shift_remove("description");
        schema.extend(only);
    } else {
        let objects: Vec<Json> = objects.into_iter().map(Json::from).collect();
        schema.insert("oneOf".into(), objects.into());
    }
    schema
}

fn of_kind(kind: Kind) -> Map<String, Json> {
    let mut schema = Map::new();
    schema.insert("description".into(), kind.about.trim().into());
    schema.insert("type".into(), "object".into());
    schema.insert("properties".into(), kind.properties.into());
    schema.insert("required".into(), kind.required.into());
    schema.insert("additionalProperties".into(), false.into());
    schema
}
