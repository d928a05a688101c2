//! Words as a POSIX shell reads them.

use std::ffi::OsStr;

/// A script under way. Paths may be any bytes, so it is not a string.
#[derive(Clone, Debug, Default)]
pub(super) struct Script(Vec<u8>);

impl Script {
    /// One or more lines that are right as they are.
    pub(super) fn lines(mut self, lines: impl AsRef<str>) -> Self {
        self.0.extend(lines.as_ref().as_bytes());
        self.0.push(b'\n');
        self
    }

    /// A line of something and words behind it, each of which the shell takes for one word, whatever it holds.
    pub(super) fn command<'a>(mut self, begin: &str, words: impl IntoIterator<Item = &'a OsStr>) -> Self {
        self.0.extend(begin.as_bytes());
        for word in words {
            self.0.push(b' ');
            self.0.extend(quoted(word));
        }
        self.0.push(b'\n');
        self
    }

    /// A variable and its value.
    pub(super) fn set(mut self, name: &str, value: impl AsRef<OsStr>) -> Self {
        self.0.extend(name.as_bytes());
        self.0.push(b'=');
        self.0.extend(quoted(value.as_ref()));
        self.0.push(b'\n');
        self
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }
}

/// A word that stands for itself. Within single quotes nothing means anything but the quote that ends them.
fn quoted(word: &OsStr) -> Vec<u8> {
    let bytes = word.as_encoded_bytes();
    let is_plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"_-+./:=,@%".contains(byte);
    if !bytes.is_empty() && bytes.iter().all(is_plain) {
        return bytes.to_owned();
    }
    let mut quoted = vec![b'\''];
    for &byte in bytes {
        if byte == b'\'' {
            quoted.extend(br"'\''");
        } else {
            quoted.push(byte);
        }
    }
    quoted.push(b'\'');
    quoted
}

/// The same as text, to be shown.
pub(super) fn word(word: impl AsRef<OsStr>) -> String {
    String::from_utf8_lossy(&quoted(word.as_ref())).into_owned()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::ffi::OsStrExt as _;
    use std::process::Command;

    #[test]
    fn a_shell_reads_what_was_meant() {
        let words: [&[u8]; 12] = [
            b"plain-1.0/a_b:c=d",
            b"",
            b"two  words ",
            b"it's",
            b"''",
            b"$(touch gone) `id` $HOME \\n \\",
            b"a\nb\n#SBATCH --array=0-9999\n",
            b"\"quoted\"; echo & | < > ( ) { } [a-z]* ? !! # ~",
            b"~root",
            b"-n",
            "\u{fc}n\u{ef}c\u{f6}d\u{e9} \u{1f525}".as_bytes(),
            b"not utf-8: \xff\xfe",
        ];
        let script = Script::default()
            .set("a", OsStr::from_bytes(words[5]))
            .command("printf '%s\\0' \"$a\"", words.map(OsStr::from_bytes));
        let output =
            Command::new("sh").arg("-c").arg(OsStr::from_bytes(script.bytes())).output().expect("a shell");
        let read: Vec<&[u8]> = output.stdout.split(|&byte| byte == 0).collect();
        assert_eq!(read[0], words[5], "a variable");
        assert_eq!(read[1..13], words, "words");
    }
}
