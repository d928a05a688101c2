//! Names as numbers, and pixels as shares of names: what compositing programs cut things out with.
//!
//! Friedman and Jones 2015, "Fully automatic ID mattes with support for motion blur and transparency"; the file layout is that of the
//! Cryptomatte specification 1.2.0 (Psyop). A name is its hash, taken for the bits of a 32-bit float; a pixel has pairs of name and
//! coverage, the greatest coverage first, in channels `CryptoObject00.R`, `.G` (first pair), `.B`, `.A` (second pair),
//! `CryptoObject01.R` and so on; metadata say which hash is which name.

use serde_json::{Map, Value};

/// Pairs of name and coverage that a file has room for.
pub const RANKS: usize = 6;

/// The number that stands for a name.
#[must_use]
pub fn hash(name: &str) -> f32 {
    f32::from_bits(bits(name))
}

/// MurmurHash3 of a name, changed in one bit where it would be no number, an infinity, or too small a number to survive.
fn bits(name: &str) -> u32 {
    let hash = murmur(name);
    let exponent = (hash >> 23) & 255;
    if exponent == 0 || exponent == 255 { hash ^ (1 << 23) } else { hash }
}

/// MurmurHash3_x86_32 with seed 0 (Appleby 2011, public domain).
fn murmur(name: &str) -> u32 {
    let scrambled = |word: u32| word.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let (words, rest) = name.as_bytes().as_chunks::<4>();
    let mut hash = 0_u32;
    for &word in words {
        hash ^= scrambled(u32::from_le_bytes(word));
        hash = hash.rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64);
    }
    if !rest.is_empty() {
        let mut last = [0; 4];
        last[..rest.len()].copy_from_slice(rest);
        hash ^= scrambled(u32::from_le_bytes(last));
    }
    // The length counts modulo 2^32.
    #[expect(clippy::cast_possible_truncation, reason = "said so")]
    let length = name.len() as u32;
    hash ^= length;
    hash = (hash ^ (hash >> 16)).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ (hash >> 13)).wrapping_mul(0xc2b2_ae35);
    hash ^ (hash >> 16)
}

/// The metadata of a file whose layer of that name has mattes of those names.
#[must_use]
pub fn attributes(layer: &str, names: &[String]) -> Vec<(String, String)> {
    let manifest: Map<String, Value> =
        names.iter().map(|name| (name.clone(), format!("{:08x}", bits(name)).into())).collect();
    let key = &format!("{:08x}", bits(layer))[..7];
    [
        ("name", layer.to_owned()),
        ("hash", "MurmurHash3_32".to_owned()),
        ("conversion", "uint32_to_float32".to_owned()),
        ("manifest", Value::Object(manifest).to_string()),
    ]
    .map(|(entry, value)| (format!("cryptomatte/{key}/{entry}"), value))
    .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_others() {
        // Appleby's test program and the unit tests of the specification's plug-ins.
        assert_eq!(murmur(""), 0, "nothing");
        assert_eq!(murmur("hello"), 0x248b_fa47, "five bytes");
        assert_eq!(murmur("Hello, world!"), 0xc036_3e43, "thirteen bytes");
        for (name, number) in [
            ("hello", 6.070_562_710_24e-17_f64),
            ("cube", -4.084_619_125_19e15),
            ("sphere", 2.790_186_043_83e15),
            ("plane", 3.665_576_175_93e-11),
        ] {
            let found = f64::from(hash(name));
            assert!((found / number - 1.0).abs() < 1e-7, "{name}: {found:e}");
        }
    }

    #[test]
    fn every_name_is_a_number() {
        for i in 0..200_000 {
            let number = hash(&format!("object_{i}"));
            assert!(number.is_normal(), "{i}: {number}");
        }
    }

    #[test]
    fn metadata_name_the_layer_and_its_names() {
        let entries = attributes("CryptoObject", &["cube".to_owned(), "a \"b\"".to_owned()]);
        let value = |end: &str| &entries.iter().find(|(key, _)| key.ends_with(end)).expect("there").1;
        assert_eq!(value("/name"), "CryptoObject", "name");
        assert!(entries[0].0.len() == "cryptomatte/0123456/name".len(), "{}", entries[0].0);
        let manifest: Value = serde_json::from_str(value("/manifest")).expect("JSON");
        assert_eq!(manifest["cube"], format!("{:08x}", hash("cube").to_bits()), "{manifest}");
        assert_eq!(manifest.as_object().map(Map::len), Some(2), "{manifest}");
    }
}
