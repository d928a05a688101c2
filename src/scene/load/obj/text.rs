//! Text of OBJ and MTL files in whatever encoding.

/// Text in UTF-8, in UTF-16 with a byte order mark, or else in Latin-1, which gives every name letters of its own. A
/// file without line feeds has its lines ended by carriage returns.
pub(super) fn decode(bytes: Vec<u8>) -> String {
    let text = match bytes.as_slice() {
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => utf8(rest.to_vec()),
        _ => utf8(bytes),
    };
    if text.contains('\r') && !text.contains('\n') { text.replace('\r', "\n") } else { text }
}

fn utf8(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes)
        .unwrap_or_else(|error| error.as_bytes().iter().map(|&byte| char::from(byte)).collect())
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    char::decode_utf16(units).map(|read| read.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_encoding_gives_the_same_text() {
        let text = "usemtl Ter\u{e4}d\n\u{1f600}";
        let utf16 = |bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
            ['\u{feff}']
                .into_iter()
                .chain(text.chars())
                .flat_map(|c| {
                    c.encode_utf16(&mut [0; 2]).iter().copied().flat_map(bytes).collect::<Vec<u8>>()
                })
                .collect()
        };
        assert_eq!(decode(text.into()), text, "UTF-8");
        assert_eq!(decode(format!("\u{feff}{text}").into()), text, "UTF-8 with a mark");
        assert_eq!(decode(utf16(u16::to_be_bytes)), text, "UTF-16, big end first");
        assert_eq!(decode(utf16(u16::to_le_bytes)), text, "UTF-16, little end first");
        assert_eq!(decode(b"Ter\xe4d".to_vec()), "Ter\u{e4}d", "Latin-1");
        assert_eq!(decode(b"a\rb".to_vec()), "a\nb", "lines of the old Macintosh");
        assert_eq!(decode(b"\xff\xfea".to_vec()), "", "half a unit");
    }
}
