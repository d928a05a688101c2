//! Which frames of a sequence.

use crate::scene::load::node::{Content, Node};
use crate::scene::load::report::Report;
use crate::scene::record::{Rules, Value};
use serde_json::{Map, Value as Json, json};
use std::collections::HashSet;
use std::fmt;

/// Numbers of frames, each once, in the order asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frames {
    numbers: Vec<i32>,
    text: String,
}

/// Frames of one request; more is a slip of the hand.
const MOST: i64 = 1_000_000;

impl Frames {
    /// How frames are written.
    pub const SYNTAX: &str =
        "write a number, A..B with both ends rendered, A..BxSTEP, or several of these with commas between";

    /// One frame.
    #[must_use]
    pub fn one(number: i32) -> Self {
        Self { numbers: vec![number], text: number.to_string() }
    }

    /// What a text says: `7`, `1..100` (both ends included), `1..100x10` (every tenth), or several of these with commas between.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let (mut numbers, mut known, mut asked) = (Vec::new(), HashSet::new(), 0);
        for part in text.split(',') {
            let (first, last, step) = range(part.trim())?;
            if first > last {
                return None;
            }
            // Before any memory is taken; those named twice count twice.
            asked += (i64::from(last) - i64::from(first)) / i64::from(step) + 1;
            if asked > MOST {
                return None;
            }
            let step = usize::try_from(step).ok()?;
            numbers.extend((first..=last).step_by(step).filter(|number| known.insert(*number)));
        }
        Some(Self { numbers, text: text.trim().to_owned() })
    }

    /// The numbers.
    #[must_use]
    pub fn numbers(&self) -> &[i32] {
        &self.numbers
    }
}

impl fmt::Display for Frames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// The first and the last number, and the step from one to the next.
fn range(text: &str) -> Option<(i32, i32, u32)> {
    let (text, step) = match text.split_once('x') {
        Some((text, step)) => (text, step.trim().parse().ok().filter(|step| *step > 0)?),
        None => (text, 1),
    };
    let number = |text: &str| text.trim().parse::<i32>().ok();
    match text.split_once("..") {
        Some((first, last)) => Some((number(first)?, number(last)?, step)),
        None if step == 1 => number(text).map(|only| (only, only, 1)),
        None => None,
    }
}

impl Value for Frames {
    fn decode(node: &Node, key: &str, _: &Rules, report: &mut Report) -> Option<Self> {
        let (read, found) = match &node.content {
            Content::Integer(number) => (i32::try_from(*number).ok().map(Self::one), number.to_string()),
            Content::String(text) => (Self::parse(text), format!("\"{text}\"")),
            _ => (None, node.kind().to_owned()),
        };
        if read.is_none() {
            report.error(&node.spot, format!("`{key}` is {found}"), Self::SYNTAX);
        }
        read
    }

    fn expects(_: &Rules) -> String {
        "a number of a frame, or a text such as \"1..100\"".into()
    }

    fn schema(_: &Rules, _: &mut Map<String, Json>) -> Json {
        let range = r"-?[0-9]+(\s*\.\.\s*-?[0-9]+(\s*x\s*[0-9]+)?)?";
        let pattern = format!(r"^\s*{range}(\s*,\s*{range})*\s*$");
        json!({ "anyOf": [
            { "type": "integer", "minimum": i32::MIN, "maximum": i32::MAX },
            { "type": "string", "pattern": pattern },
        ] })
    }

    fn to_json(&self) -> Json {
        self.text.as_str().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_of_a_range_are_rendered() {
        let numbers = |text| Frames::parse(text).map(|frames| frames.numbers);
        assert_eq!(numbers("7"), Some(vec![7]), "one");
        assert_eq!(numbers("1..3"), Some(vec![1, 2, 3]), "both ends");
        assert_eq!(numbers(" -2 .. 1 "), Some(vec![-2, -1, 0, 1]), "below zero");
        assert_eq!(numbers("1..10x4"), Some(vec![1, 5, 9]), "a step");
        assert_eq!(numbers("5,1..3,2,9..9"), Some(vec![5, 1, 2, 3, 9]), "each once, in this order");
        for text in ["", "a", "1..", "..3", "3..1", "1...3", "1..3x0", "4x2", "1,,2", "1.5", "0..99999999999"]
        {
            assert_eq!(numbers(text), None, "{text}");
        }
        assert_eq!(numbers("0..1000000"), None, "more than a million");
        assert_eq!(numbers("1..1000000,1"), None, "those named twice count twice");
    }
}
