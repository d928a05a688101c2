//! Settings beside each other, and settings chosen for an error or a time.

#[path = "../support/desk.rs"]
mod desk;
#[path = "../support/pictures.rs"]
mod pictures;
#[path = "../support/room.rs"]
mod room;

mod budget;
mod sweep;

use desk::Desk;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A desk with `a.toml`, a scene whose noise behaves.
fn place(settings: &str) -> Desk {
    let desk = Desk::new();
    std::fs::write(desk.path("a.toml"), room::corner(settings)).expect("written");
    desk
}

/// Held by tests that look at the clock, one at a time.
fn clock() -> MutexGuard<'static, ()> {
    static CLOCK: Mutex<()> = Mutex::new(());
    CLOCK.lock().unwrap_or_else(PoisonError::into_inner)
}
