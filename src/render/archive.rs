//! Files of sums: a head that says what they are, arrays, and checksums.
//!
//! ```text
//! 0    8 bytes   SPECSUMS
//! 8    u32       version of the format: 1
//! 12   u32       bytes of the head, n
//! 16   u64       bytes of the arrays, m
//! 24   u32       CRC-32 of the 24 bytes before and of the head
//! 28   n bytes   the head: one JSON object
//!      m bytes   arrays of numbers, which the head explains
//!      u32       CRC-32 of the arrays
//! ```
//!
//! All numbers have their least byte first. Nothing stands behind. Lengths are compared with that of the file before anything is read or
//! memory is taken; a CRC finds every change of up to 32 bits in a row (Peterson and Brown 1961, "Cyclic codes for error detection").

use crc32fast::Hasher;
use serde_json::Value;
use std::io::{self, Read, Write};

const MAGIC: [u8; 8] = *b"SPECSUMS";
const VERSION: u32 = 1;

/// Bytes before the head.
const PREFIX: usize = 28;

/// Writes a file whose arrays are `length` bytes that `arrays` writes.
pub(super) fn write(
    into: &mut dyn Write,
    head: &Value,
    length: u64,
    arrays: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let head = head.to_string();
    let size = u32::try_from(head.len()).map_err(|_| io::Error::other("a head of more than 4 GiB"))?;
    let mut prefix = Vec::with_capacity(PREFIX);
    prefix.extend(MAGIC);
    prefix.extend(VERSION.to_le_bytes());
    prefix.extend(size.to_le_bytes());
    prefix.extend(length.to_le_bytes());
    let mut hasher = Hasher::new();
    hasher.update(&prefix);
    hasher.update(head.as_bytes());
    prefix.extend(hasher.finalize().to_le_bytes());
    into.write_all(&prefix)?;
    into.write_all(head.as_bytes())?;
    let mut body = Hashed { inner: &mut *into, hasher: Hasher::new(), length: 0 };
    arrays(&mut body)?;
    let (written, sum) = (body.length, body.hasher.finalize());
    if written != length {
        return Err(io::Error::other(format!("arrays of {written} bytes for {length}")));
    }
    into.write_all(&sum.to_le_bytes())
}

/// A file whose head has been read.
#[derive(Debug)]
pub(super) struct Archive<R> {
    pub(super) head: Value,
    /// Bytes of the arrays.
    pub(super) length: u64,
    from: R,
}

impl<R: Read> Archive<R> {
    /// The head of a file of `length` bytes. Fails with what is wrong with the file.
    pub(super) fn open(mut from: R, length: u64) -> Result<Self, String> {
        let mut prefix = [0; PREFIX];
        let read = fill(&mut from, &mut prefix)?;
        if read < MAGIC.len() || prefix[..8] != MAGIC {
            return Err("not a checkpoint or part of a picture".to_owned());
        }
        if read < PREFIX {
            return Err(cut_off());
        }
        let number = |at: usize| [prefix[at], prefix[at + 1], prefix[at + 2], prefix[at + 3]];
        let [version, size, low, high, sum] = [8, 12, 16, 20, 24].map(|at| u32::from_le_bytes(number(at)));
        if version != VERSION {
            return Err(format!("a file of format {version}; this program knows format {VERSION}"));
        }
        let arrays = u64::from(low) | u64::from(high) << 32;
        let all = arrays.checked_add(PREFIX as u64 + u64::from(size) + 4);
        if all != Some(length) {
            return Err(cut_off());
        }
        // No more than the file has.
        let mut head = vec![0; size as usize];
        if fill(&mut from, &mut head)? < head.len() {
            return Err(cut_off());
        }
        let mut hasher = Hasher::new();
        hasher.update(&prefix[..24]);
        hasher.update(&head);
        if hasher.finalize() != sum {
            return Err(damaged());
        }
        let head = serde_json::from_slice(&head).map_err(|error| format!("its head is no JSON: {error}"))?;
        Ok(Self { head, length: arrays, from })
    }

    /// Reads the arrays for their checksum alone. Fails with what is wrong with them.
    pub(super) fn check(self) -> Result<(), String> {
        self.arrays(|_, _| Ok(()))
    }

    /// What `read` makes of the arrays, which it reads to their end.
    pub(super) fn arrays<T>(
        mut self,
        read: impl FnOnce(&Value, &mut dyn Read) -> Result<T, String>,
    ) -> Result<T, String> {
        let mut body = Hashed { inner: (&mut self.from).take(self.length), hasher: Hasher::new(), length: 0 };
        let value = read(&self.head, &mut body);
        // What is left of arrays that were given up counts for the checksum: damage is what to tell, not what it led to.
        io::copy(&mut body, &mut io::sink()).map_err(|error| error.to_string())?;
        let (length, sum) = (body.length, body.hasher.finalize());
        let mut told = [0; 4];
        if length < self.length || fill(&mut self.from, &mut told)? < told.len() {
            return Err(cut_off());
        }
        if sum != u32::from_le_bytes(told) {
            return Err(damaged());
        }
        value
    }
}

fn cut_off() -> String {
    "not as long as it says it is; it was cut off".to_owned()
}

fn damaged() -> String {
    "damaged: its checksum is another one".to_owned()
}

/// Reads until `into` is full or nothing is left: how many bytes.
fn fill(from: &mut impl Read, into: &mut [u8]) -> Result<usize, String> {
    let mut filled = 0;
    while filled < into.len() {
        match from.read(&mut into[filled..]) {
            Ok(0) => break,
            Ok(read) => filled += read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error.to_string()),
        }
    }
    Ok(filled)
}

/// Passes on bytes, and notes their checksum and how many they were.
struct Hashed<T> {
    inner: T,
    hasher: Hasher,
    length: u64,
}

impl<T: Write> Write for Hashed<T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        self.length += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<T: Read> Read for Hashed<T> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(bytes)?;
        self.hasher.update(&bytes[..read]);
        self.length += read as u64;
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn read(bytes: &[u8]) -> Result<(Value, Vec<u8>), String> {
        Archive::open(bytes, bytes.len() as u64)?.arrays(|head, body| {
            let mut all = Vec::new();
            body.read_to_end(&mut all).map_err(|error| error.to_string())?;
            Ok((head.clone(), all))
        })
    }

    fn check(bytes: &[u8]) -> Result<(), String> {
        Archive::open(bytes, bytes.len() as u64)?.check()
    }

    fn written() -> Vec<u8> {
        let mut bytes = Vec::new();
        write(&mut bytes, &json!({ "a": 1 }), 5, |into| into.write_all(b"12345")).expect("written");
        bytes
    }

    #[test]
    fn what_was_written_is_read() {
        assert_eq!(read(&written()), Ok((json!({ "a": 1 }), b"12345".to_vec())), "the same");
        assert_eq!(check(&written()), Ok(()), "sound");
    }

    #[test]
    fn any_other_length_and_any_other_byte_is_told() {
        let bytes = written();
        for length in 0..bytes.len() {
            assert!(read(&bytes[..length]).is_err() && check(&bytes[..length]).is_err(), "{length} bytes");
        }
        assert!(read(&[bytes.clone(), vec![0]].concat()).is_err(), "a byte more");
        for at in 0..bytes.len() {
            for flip in 1..=255 {
                let mut other = bytes.clone();
                other[at] ^= flip;
                assert!(read(&other).is_err() && check(&other).is_err(), "byte {at}, {flip}");
            }
        }
    }

    #[test]
    fn arrays_of_another_length_are_not_written() {
        let mut bytes = Vec::new();
        let error = write(&mut bytes, &json!({}), 4, |into| into.write_all(b"123")).expect_err("too few");
        assert!(error.to_string().contains("3 bytes for 4"), "{error}");
    }
}
