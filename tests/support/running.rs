//! The program under way.

#![allow(dead_code, reason = "each test program uses a part")]

use crate::desk::Desk;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The program, started at a desk, its output kept.
pub(crate) fn spawn(desk: &Desk, words: &[&str]) -> Child {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("specula"));
    command.args(words).current_dir(desk.path("."));
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("started")
}

/// Waits until something holds.
///
/// # Panics
/// Where it does not within `most`.
pub(crate) fn wait_for(what: &str, most: Duration, mut holds: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !holds() {
        assert!(begin.elapsed() < most, "{what}: not within {most:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Sends a signal, by its flag for `kill`.
pub(crate) fn signal(child: &Child, flag: &str) {
    let sent = Command::new("kill").args([flag, &child.id().to_string()]).status().expect("run");
    assert!(sent.success(), "{flag}: sent");
}
