//! Standard output.

use std::io::{self, Write as _};

use crate::error::{Error, Result};

/// Writes results to standard output. A reader that has gone away has seen enough: that is no error.
pub(super) fn print(bytes: &[u8]) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::Io { path: "standard output".into(), what: "cannot write", source: error })
        }
        _ => Ok(()),
    }
}
