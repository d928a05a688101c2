//! File systems that are full or read-only.

use crate::desk::Desk;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// A file system of its own in the directory `disk`, gone with the value; not everybody may.
pub(crate) struct Mounted(pub(crate) PathBuf);

impl Mounted {
    pub(crate) fn new(desk: &Desk, options: &str) -> Option<Self> {
        let path = desk.path("disk");
        std::fs::create_dir(&path).expect("made");
        let mut command = Command::new("mount");
        command.args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(&path).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success()).then_some(Self(path))
    }
}

impl Drop for Mounted {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}
