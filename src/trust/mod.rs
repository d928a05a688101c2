//! How far files from outside are trusted: what they may ask for, and where they may lie.
//!
//! Scenes come from the web, from colleagues and from programs. A few bytes of a header can claim a picture of a terabyte, and a path can
//! name any file of the machine. So whoever opens a file that another one names does it by [`Trust::read`], and whoever takes memory for
//! what a file claims asks [`Limits`] before.

mod limits;
mod sandbox;

pub use limits::{Excess, Limit, Limits};
pub use sandbox::{Outside, Sandbox};

use crate::error::{Error, Place, Problem, Result};
use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

/// How far files are trusted. By default within [`Limits::default`], wherever they lie.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trust {
    /// What they may ask for.
    pub limits: Limits,
    /// Where they must lie, if that matters.
    pub sandbox: Option<Sandbox>,
}

impl Trust {
    /// Whatever they ask for, wherever they lie.
    #[must_use]
    pub fn full() -> Self {
        Self { limits: Limits::none(), sandbox: None }
    }

    /// What is wrong with the place of a file that is named by another one, and what to do about it; `None` if nothing is. It need not be there.
    #[must_use]
    pub fn outside(&self, path: &Path) -> Option<(String, String)> {
        let outside = self.sandbox.as_ref()?.check(path).err()?;
        Some((outside.to_string(), outside.remedy()))
    }

    fn refuse_outside(&self, path: &Path) -> Result<()> {
        let refused = |(what, remedy): (String, String)| {
            Error::Refused(Problem::at(Place::file(path), what).remedy(remedy))
        };
        self.outside(path).map_or(Ok(()), |outside| Err(refused(outside)))
    }

    /// Fails with [`Error::Refused`] where a file must not lie, or if it has more bytes than allowed. It need not be there.
    pub fn check(&self, path: &Path) -> Result<()> {
        self.refuse_outside(path)?;
        let length = path.metadata().map_or(0, |about| about.len());
        let refused = |excess: Excess| Error::Refused(excess.at(Place::file(path)));
        self.limits.check(Limit::Bytes, length).map_err(refused)
    }

    /// All bytes of a file; `what` says what failed if it cannot be read.
    ///
    /// Fails with [`Error::Refused`] where it must not lie or if it has more bytes than allowed, which is known before memory is taken.
    pub fn read(&self, path: &Path, what: &'static str) -> Result<Vec<u8>> {
        self.read_counted(path, what, (Limit::Bytes, 0))
    }

    /// The same where another limit counts, of which others have taken so much before.
    pub fn read_counted(
        &self,
        path: &Path,
        what: &'static str,
        (limit, before): (Limit, u64),
    ) -> Result<Vec<u8>> {
        self.refuse_outside(path)?;
        let failed = |source| Error::Io { path: path.to_owned(), what, source };
        let refused = |excess: Excess| Error::Refused(excess.at(Place::file(path)));
        let file = File::open(path).map_err(failed)?;
        let length = file.metadata().map_err(failed)?.len();
        self.limits.check(limit, before.saturating_add(length)).map_err(refused)?;
        let mut bytes = Vec::new();
        let reserved = usize::try_from(length).ok().map(|length| bytes.try_reserve_exact(length));
        if !matches!(reserved, Some(Ok(()))) {
            return Err(failed(io::ErrorKind::OutOfMemory.into()));
        }
        // Pipes and devices do not tell their length, and a file may grow.
        let most = self.limits.most(limit).unwrap_or(u64::MAX).saturating_sub(before);
        file.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(failed)?;
        self.limits.check(limit, before.saturating_add(bytes.len() as u64)).map_err(refused)?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_within_limits() {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.obj");
        std::fs::write(&path, b"12345").expect("written");
        let trust = |most| Trust { limits: Limits::default().with(Limit::Bytes, most), sandbox: None };
        assert_eq!(trust(Some(5)).read(&path, "cannot read").expect("read"), b"12345", "as many as allowed");
        assert_eq!(trust(None).read(&path, "cannot read").expect("read"), b"12345", "without a limit");
        let error = trust(Some(4)).read(&path, "cannot read").expect_err("too many");
        assert!(matches!(error, Error::Refused(_)), "{error:?}");
        let told = error.to_string();
        assert!(told.contains("a.obj: 5 bytes") && told.contains("--limits bytes=5"), "{told}");
        let error = trust(Some(4)).read(&dir.path().join("b.obj"), "cannot read the mesh").expect_err("none");
        assert!(error.to_string().ends_with("b.obj: cannot read the mesh"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn what_has_no_end_is_read_up_to_the_limit() {
        let trust = Trust { limits: Limits::default().with(Limit::Bytes, Some(1 << 20)), sandbox: None };
        let error = trust.read(Path::new("/dev/zero"), "cannot read").expect_err("endless");
        assert!(error.to_string().contains("1048577 bytes"), "{error}");
    }

    #[test]
    fn files_outside_are_not_opened() {
        let dir = tempfile::tempdir().expect("a directory");
        let trust = Trust { sandbox: Some(Sandbox::new(dir.path())), ..Trust::default() };
        let error = trust.read(&dir.path().join("../a.obj"), "cannot read").expect_err("outside");
        assert!(matches!(error, Error::Refused(_)), "{error:?}");
    }
}
