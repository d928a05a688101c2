//! Headers of PLY files: what elements there are, and of what they are made.

use super::scalar::Scalar;
use crate::error::{Place, Problem};
use std::path::Path;

/// What a file says before its data.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) format: Format,
    /// In the order of the data.
    pub(super) elements: Vec<Element>,
    /// Where the data starts, in bytes.
    pub(super) body: usize,
    /// The line in which it starts, from 1.
    pub(super) body_line: u32,
    /// Lines that mean nothing, which do no harm before the first element.
    pub(super) odd: Vec<(String, u32)>,
}

/// How data is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    BinaryLittleEndian,
    BinaryBigEndian,
}

/// A table of the data.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    /// How many entries are promised.
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// Where it is declared.
    pub(super) line: u32,
}

/// A column of a table.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of the length, where an entry is a list.
    pub(super) length: Option<Scalar>,
    /// The type of the value or of those of the list.
    pub(super) scalar: Scalar,
}

/// What is wrong with a header: line, what, remedy.
type Fault = (u32, String, &'static str);

const WORDS: &str = "write `format`, `comment`, `obj_info`, `element`, `property` or `end_header`";

impl Header {
    /// That of the bytes of a file. Fails naming the line.
    pub(super) fn read(bytes: &[u8], path: &Path) -> Result<Self, Problem> {
        Self::parse(bytes).map_err(|(line, what, remedy)| {
            Problem::at(Place { line: Some(line), ..Place::file(path) }, what).remedy(remedy)
        })
    }

    fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        let mut lines = Lines::of(bytes);
        if lines.next().as_deref() != Some("ply") {
            return Err((lines.line.max(1), "this is no PLY file".into(), "its first line must be `ply`"));
        }
        let mut format = None;
        let (mut elements, mut odd) = (Vec::new(), Vec::new());
        loop {
            let Some(line) = lines.next() else {
                return Err((
                    lines.line,
                    "the file ends in its header".into(),
                    "end the header by `end_header`",
                ));
            };
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words[..] {
                ["end_header"] => break,
                [] | ["comment" | "obj_info", ..] => {}
                ["format", name, ..] => format = Some(format_named(name, lines.line)?),
                ["element", ..] => elements.push(element(&words, &elements, lines.line)?),
                ["property", ..] => property(&words, &mut elements, lines.line)?,
                // After an element it may be a property misspelt, without which data cannot be read.
                _ if elements.is_empty() => odd.push((line.clone(), lines.line)),
                _ => return Err((lines.line, format!("`{line}` has no meaning in a PLY header"), WORDS)),
            }
        }
        let Some(format) = format else {
            return Err((lines.line, "the header names no format".into(), "write `format ascii 1.0`"));
        };
        Ok(Self { format, elements, body: lines.at, body_line: lines.line + 1, odd })
    }
}

fn format_named(name: &str, line: u32) -> Result<Format, Fault> {
    match name {
        "ascii" => Ok(Format::Ascii),
        "binary_little_endian" => Ok(Format::BinaryLittleEndian),
        "binary_big_endian" => Ok(Format::BinaryBigEndian),
        _ => {
            let remedy = "it must be `ascii`, `binary_little_endian` or `binary_big_endian`";
            Err((line, format!("unknown format `{name}`"), remedy))
        }
    }
}

fn element(words: &[&str], known: &[Element], line: u32) -> Result<Element, Fault> {
    let &[_, name, count] = words else {
        return Err((line, "this declares no element".into(), "write `element NAME COUNT`"));
    };
    let Ok(count) = count.parse() else {
        return Err((line, format!("`{count}` is no number of entries"), "give a whole number from 0"));
    };
    if let Some(twin) = known.iter().find(|twin| twin.name == name) {
        let what = format!("element `{name}` is declared already in line {}", twin.line);
        return Err((line, what, "remove one of them"));
    }
    Ok(Element { name: name.into(), count, properties: vec![], line })
}

fn property(words: &[&str], elements: &mut [Element], line: u32) -> Result<(), Fault> {
    let (length, scalar, name) = match *words {
        [_, "list", length, scalar, name] => (Some(scalar_named(length, line)?), scalar, name),
        [_, scalar, name] => (None, scalar, name),
        _ => {
            let remedy = "write `property TYPE NAME` or `property list TYPE TYPE NAME`";
            return Err((line, "this declares no property".into(), remedy));
        }
    };
    let Some(element) = elements.last_mut() else {
        return Err((line, format!("property `{name}` belongs to no element"), "declare an element first"));
    };
    if element.properties.iter().any(|twin| twin.name == name) {
        let what = format!("element `{}` has a property `{name}` already", element.name);
        return Err((line, what, "remove one of them"));
    }
    element.properties.push(Property { name: name.into(), length, scalar: scalar_named(scalar, line)? });
    Ok(())
}

fn scalar_named(name: &str, line: u32) -> Result<Scalar, Fault> {
    Scalar::named(name).ok_or_else(|| {
        let remedy = "known are char, uchar, short, ushort, int, uint, float, double, and int8 to float64";
        (line, format!("unknown type `{name}`"), remedy)
    })
}

/// The lines of a header, without spaces at their ends.
struct Lines<'a> {
    bytes: &'a [u8],
    /// Where the next line starts.
    at: usize,
    /// The number of the latest line, from 1.
    line: u32,
    /// What ends lines: a carriage return if one ends the first and no line feed follows it. Otherwise those before a
    /// line feed are left out. So binary data may start with the byte of either.
    end: u8,
}

impl<'a> Lines<'a> {
    fn of(bytes: &'a [u8]) -> Self {
        let mark = if bytes.starts_with(&[0xef, 0xbb, 0xbf]) { 3 } else { 0 };
        let start = bytes[mark..].iter().take_while(|byte| byte.is_ascii_whitespace()).count() + mark;
        let line = 1 + count(bytes[..start].iter().filter(|&&byte| byte == b'\n').count());
        let first = bytes[start..].iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let end = match first.map(|i| &bytes[start + i..]) {
            Some([b'\r', next, ..]) if *next != b'\n' => b'\r',
            _ => b'\n',
        };
        Self { bytes, at: start, line: line - 1, end }
    }

    fn next(&mut self) -> Option<String> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|&byte| byte == self.end);
        self.at += length.map_or(rest.len(), |length| length + 1);
        self.line += 1;
        let line = &rest[..length.unwrap_or(rest.len())];
        Some(String::from_utf8_lossy(line).trim().into())
    }
}

fn count(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}
