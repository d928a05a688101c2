//! Numbers of the data, one after the other, written in digits or in bytes.

use super::header::{Element, Format, Header};
use super::scalar::Scalar;
use crate::error::{Place, Problem};
use std::path::Path;

/// Where numbers come from.
pub(super) trait Source {
    /// The next number.
    fn number(&mut self, scalar: Scalar) -> Result<f64, Fault>;

    /// How many numbers of a type there can be at most in what is left.
    fn numbers_left(&self, scalar: Scalar) -> usize;

    /// How many entries of an element there can be at most in what is left.
    fn room(&self, element: &Element) -> usize;

    /// Ends an entry of an element.
    fn end_entry(&mut self, element: &Element) -> Result<(), Fault>;

    /// Passes over entries all of whose properties are single numbers; fails with the number of the one at fault.
    fn skip(&mut self, element: &Element) -> Result<(), (u64, Fault)>;

    /// Where the latest number stands: a line, or how many bytes are before it.
    fn at(&self) -> At;

    /// How many bytes are left after all elements, but for white space of text.
    fn left_over(&self) -> usize;
}

/// A place in the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum At {
    Line(u32),
    Byte(usize),
}

/// What is wrong with data, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fault {
    pub(super) what: String,
    pub(super) remedy: &'static str,
}

impl Fault {
    pub(super) fn new(what: impl Into<String>, remedy: &'static str) -> Self {
        Self { what: what.into(), remedy }
    }

    /// The same at an entry of an element.
    pub(super) fn at(self, path: &Path, at: At, element: &Element, entry: u64) -> Problem {
        let Self { what, remedy } = self;
        let name = &element.name;
        let (line, what) = match at {
            At::Line(line) => (Some(line), format!("{name} {entry}: {what}")),
            At::Byte(byte) => (None, format!("{name} {entry}, at byte {byte}: {what}")),
        };
        Problem::at(Place { line, ..Place::file(path) }, what).remedy(remedy)
    }
}

fn cut_short() -> Fault {
    Fault::new("the file ends here", "get a complete copy of the file")
}

/// The least bytes of an entry: its lists may be empty.
fn least_size(element: &Element) -> usize {
    let sizes = element.properties.iter().map(|property| property.length.unwrap_or(property.scalar).size());
    sizes.sum::<usize>().max(1)
}

/// Numbers in bytes.
#[derive(Debug)]
pub(super) struct Binary<'a, const BIG: bool> {
    bytes: &'a [u8],
    /// Where the next number starts.
    next: usize,
    /// Where the latest one starts.
    latest: usize,
}

impl<'a, const BIG: bool> Binary<'a, BIG> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        debug_assert!(header.format != Format::Ascii, "the header says how data is written");
        Self { bytes, next: header.body, latest: header.body }
    }
}

impl<const BIG: bool> Source for Binary<'_, BIG> {
    #[inline]
    fn number(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        self.latest = self.next;
        let Some(number) = scalar.read::<BIG>(&self.bytes[self.next..]) else {
            return Err(cut_short());
        };
        self.next += scalar.size();
        Ok(number)
    }

    fn numbers_left(&self, scalar: Scalar) -> usize {
        (self.bytes.len() - self.next) / scalar.size()
    }

    fn room(&self, element: &Element) -> usize {
        (self.bytes.len() - self.next) / least_size(element)
    }

    #[inline]
    fn end_entry(&mut self, _: &Element) -> Result<(), Fault> {
        Ok(())
    }

    fn skip(&mut self, element: &Element) -> Result<(), (u64, Fault)> {
        if element.properties.is_empty() {
            return Ok(());
        }
        let there = self.room(element);
        match usize::try_from(element.count).ok().filter(|count| *count <= there) {
            Some(count) => self.next += count * least_size(element),
            None => {
                self.latest = self.bytes.len();
                return Err((wide(there), cut_short()));
            }
        }
        Ok(())
    }

    fn at(&self) -> At {
        At::Byte(self.latest)
    }

    fn left_over(&self) -> usize {
        self.bytes.len() - self.next
    }
}

/// Numbers in digits, each entry on lines of its own.
#[derive(Debug)]
pub(super) struct Ascii<'a> {
    bytes: &'a [u8],
    /// Where the next number, or space before it, starts.
    next: usize,
    /// The line there, from 1.
    line: u32,
}

impl<'a> Ascii<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self { bytes, next: header.body, line: header.body_line }
    }

    /// Passes over space; over ends of lines too if `lines`. Whether a word follows.
    fn space(&mut self, lines: bool) -> bool {
        while let Some(&byte) = self.bytes.get(self.next) {
            if !byte.is_ascii_whitespace() || (!lines && matches!(byte, b'\n' | b'\r')) {
                return !byte.is_ascii_whitespace();
            }
            let ends = byte == b'\n' || (byte == b'\r' && self.bytes.get(self.next + 1) != Some(&b'\n'));
            self.line = self.line.saturating_add(u32::from(ends));
            self.next += 1;
        }
        false
    }

    fn word(&self) -> &'a [u8] {
        let rest = &self.bytes[self.next..];
        &rest[..rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len())]
    }
}

impl Source for Ascii<'_> {
    fn number(&mut self, _: Scalar) -> Result<f64, Fault> {
        if !self.space(true) {
            return Err(cut_short());
        }
        let word = self.word();
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        let Some(number) = number else {
            let what = format!("`{}` is not a number", String::from_utf8_lossy(word));
            return Err(Fault::new(what, "give a number like -1.5e3"));
        };
        self.next += word.len();
        Ok(number)
    }

    fn numbers_left(&self, _: Scalar) -> usize {
        // A digit and a space each, but for the last.
        (self.bytes.len() - self.next).div_ceil(2)
    }

    fn room(&self, element: &Element) -> usize {
        (self.bytes.len() - self.next).div_ceil(2) / element.properties.len().max(1)
    }

    fn end_entry(&mut self, element: &Element) -> Result<(), Fault> {
        if !self.space(false) {
            return Ok(());
        }
        let what = format!(
            "`{}` follows what the header says of a {}",
            String::from_utf8_lossy(self.word()),
            element.name
        );
        Err(Fault::new(what, "give each entry a line of its own, with one number for each property"))
    }

    fn skip(&mut self, element: &Element) -> Result<(), (u64, Fault)> {
        let entries = if element.properties.is_empty() { 0 } else { element.count };
        for entry in 0..entries {
            let read =
                element.properties.iter().try_for_each(|property| self.number(property.scalar).map(|_| ()));
            read.and_then(|()| self.end_entry(element)).map_err(|fault| (entry, fault))?;
        }
        Ok(())
    }

    fn at(&self) -> At {
        At::Line(self.line)
    }

    fn left_over(&self) -> usize {
        self.bytes[self.next..].trim_ascii().len()
    }
}

fn wide(n: usize) -> u64 {
    u64::try_from(n).expect("sizes have at most 64 bits")
}
