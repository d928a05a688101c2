//! Panics of what users wrote, carried over the frames of the C library.
//!
//! A panic must not unwind into C. A query and all its callbacks run on the caller's thread, so what a callback panics
//! with waits in that thread until the query has returned, and goes on from there. Scenes without user code never
//! look.

use std::any::Any;
use std::cell::Cell;
use std::mem::ManuallyDrop;
use std::panic::{self, AssertUnwindSafe};

thread_local! {
    /// Whether a callback of the query under way has panicked.
    static PANICKED: Cell<bool> = const { Cell::new(false) };
    /// What with. The query that follows takes it, so nothing is left for the end of the thread to drop, and both
    /// places can be used as long as the thread runs.
    static PAYLOAD: Cell<Option<ManuallyDrop<Box<dyn Any + Send>>>> = const { Cell::new(None) };
}

/// Runs what a user wrote, in a callback. Once something has panicked in a query, nothing more is run in it.
pub(super) fn guarded(run: impl FnOnce()) {
    if PANICKED.get() {
        return;
    }
    // What `run` leaves half done is the answer of a query that will not return.
    if let Err(payload) = panic::catch_unwind(AssertUnwindSafe(run)) {
        PAYLOAD.set(Some(ManuallyDrop::new(payload)));
        PANICKED.set(true);
    }
}

/// Goes on with the panic of a callback of the query that has just returned, if there was one.
pub(super) fn resume() {
    if PANICKED.replace(false)
        && let Some(payload) = PAYLOAD.take()
    {
        panic::resume_unwind(ManuallyDrop::into_inner(payload));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_panic_waits_and_nothing_runs_after_it() {
        resume();
        guarded(|| panic!("first"));
        guarded(|| unreachable!("run after a panic"));
        let payload = panic::catch_unwind(resume).expect_err("it goes on");
        assert_eq!(payload.downcast_ref::<&str>(), Some(&"first"), "the payload");
        let mut ran = false;
        guarded(|| ran = true);
        resume();
        assert!(ran, "the next query starts afresh");
    }
}
