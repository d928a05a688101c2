//! Frames in names of files.

use std::path::{Path, PathBuf};

/// What stands for the number of a frame.
const WORD: &str = "{frame}";

/// What a file of one frame alone is called by default.
pub(super) const DEFAULT: &str = "####";

/// Whether a name has a place for the number of a frame.
pub(super) fn has_place(path: &Path) -> bool {
    path.to_str().is_some_and(|text| text.contains('#') || text.contains(WORD))
}

/// The name with the number of a frame in its places: `{frame}`, and each row of `#` with zeros before it to as many digits.
pub(super) fn named(path: &Path, frame: i32) -> PathBuf {
    let Some(text) = path.to_str() else { return path.to_owned() };
    let (mut name, mut rest) = (String::new(), text);
    while let Some(at) = rest.find('#') {
        let row = rest[at..].chars().take_while(|&c| c == '#').count();
        let sign = if frame < 0 { "-" } else { "" };
        name += &format!("{}{sign}{:0row$}", &rest[..at], frame.unsigned_abs());
        rest = &rest[at + row..];
    }
    name += rest;
    name.replace(WORD, &frame.to_string()).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_go_to_their_places() {
        let name = |text: &str, frame| named(Path::new(text), frame).to_string_lossy().into_owned();
        assert_eq!(name("a.####.exr", 7), "a.0007.exr", "four digits");
        assert_eq!(name("#/a_##.png", 123), "123/a_123.png", "more digits than places");
        assert_eq!(name("a{frame}.exr", 7), "a7.exr", "as it is");
        assert_eq!(name("a.####.exr", -7), "a.-0007.exr", "below zero");
        assert_eq!(name("a.exr", 7), "a.exr", "no place");
        assert!(has_place(Path::new("a#")) && has_place(Path::new("{frame}")), "places");
        assert!(!has_place(Path::new("a.{name}.exr")), "none");
    }
}
