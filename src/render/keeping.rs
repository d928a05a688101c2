//! Copies of pictures under way, taken while they are made.
//!
//! A thread of its own copies the sums from time to time, under the lock under which tiles are put, and has the copy kept while samples
//! go on being taken. Tiles are put after packets of samples that take a part of the time between copies, so that no more than that time
//! is lost.

use crate::error::{Error, Result};
use crate::render::schedule::PACKET;
use crate::render::{Keeper, Phase, Progress, State};
use cpu_time::ProcessTime;
use std::ops::Range;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// The part of the time between copies that samples of a tile take before they are put.
const PART: f64 = 1.0 / 16.0;

/// Longer than that they do not take in any case, in seconds.
const LONGEST: f64 = 2.0;

/// A picture under way, for those who take samples and for who copies it.
pub(super) struct Running {
    state: Mutex<Clocked>,
    /// When this run began, and how long others had traced before.
    begin: (Instant, ProcessTime),
    before: Phase,
}

/// The state, and since when its pass is under way in this run.
pub(super) struct Clocked {
    pub(super) state: State,
    pub(super) since: Instant,
}

impl Running {
    /// Goes on from there.
    pub(super) fn new(state: State) -> Self {
        let before = state.spent;
        let since = Instant::now();
        Self { state: Mutex::new(Clocked { state, since }), begin: (since, ProcessTime::now()), before }
    }

    /// Nobody else takes part meanwhile.
    pub(super) fn locked(&self) -> MutexGuard<'_, Clocked> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The state as it is, with times that count until now.
    fn copy(&self) -> State {
        let spent = self.spent();
        let Clocked { state, since } = &*self.locked();
        let mut copy = State { spent, ..state.clone() };
        if let Some((_, seconds)) = &mut copy.pass {
            *seconds += since.elapsed().as_secs_f64();
        }
        copy
    }

    /// How long tracing has taken in all runs.
    pub(super) fn spent(&self) -> Phase {
        let (wall, cpu) = (self.begin.0.elapsed(), self.begin.1.elapsed());
        Phase { wall: self.before.wall + wall, cpu: self.before.cpu + cpu }
    }

    /// The state at last, and how long tracing has taken.
    pub(super) fn into_state(self) -> State {
        let spent = self.spent();
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner).state;
        State { spent, ..state }
    }

    /// Does `work`, and has copies kept meanwhile, and once more if somebody asks to stop.
    pub(super) fn kept<T>(&self, keeper: Option<&dyn Keeper>, work: impl FnOnce() -> Result<T>) -> Result<T> {
        let Some(keeper) = keeper else { return work() };
        let worked = thread::scope(|scope| {
            // Its end tells the thread to end, be it by a panic.
            let (alive, end) = mpsc::channel::<()>();
            scope.spawn(move || self.keep(keeper, &end));
            let worked = work();
            drop(alive);
            worked
        });
        match worked {
            Err(Error::Interrupted) => {
                keeper.keep(&self.copy())?;
                Err(Error::Interrupted)
            }
            other => other,
        }
    }

    /// Has copies kept until the end.
    fn keep(&self, keeper: &dyn Keeper, end: &mpsc::Receiver<()>) {
        let every = keeper.every();
        let mut writing = None;
        loop {
            let Err(RecvTimeoutError::Timeout) = end.recv_timeout(wait(every, writing)) else { return };
            let begin = Instant::now();
            if let Err(error) = keeper.keep(&self.copy()) {
                keeper.missed(error);
            }
            // What took long may do so again, even if it did not the last time.
            writing = Some(begin.elapsed().max(writing.unwrap_or_default() * 3 / 4));
        }
    }
}

/// How long to wait before the next copy is taken, where copies take so long to write; the first one tells that, and is an early one.
fn wait(every: Duration, writing: Option<Duration>) -> Duration {
    let Some(writing) = writing else { return every / 4 };
    // What is not in a copy: samples of tiles that have not been put, and those taken while it is written.
    every.saturating_sub(late(every) + 2 * writing).max(every / 4)
}

/// How long samples of a tile may have been taken that have not been put.
fn late(every: Duration) -> Duration {
    every.mul_f64(PART).min(Duration::from_secs_f64(LONGEST))
}

/// How many seconds samples of a tile may take before they are put, if that matters to anybody.
pub(super) fn longest(keeper: Option<&dyn Keeper>, progress: &dyn Progress) -> Option<f64> {
    let kept = keeper.map(|keeper| late(keeper.every()).as_secs_f64());
    let shown = progress.looks_every().map(|every| every.as_secs_f64());
    kept.into_iter().chain(shown).reduce(f64::min)
}

/// Cuts samples of a tile to be put one after the other: all at once, or by time.
pub(super) struct Pieces {
    left: Range<u32>,
    /// Seconds that one takes, if that counts.
    longest: Option<f64>,
    /// The last one, and when it began.
    last: Option<(u32, Instant)>,
}

impl Pieces {
    /// Of these samples, by so many seconds.
    pub(super) fn new(samples: Range<u32>, longest: Option<f64>) -> Self {
        Self { left: samples, longest, last: None }
    }
}

impl Iterator for Pieces {
    type Item = Range<u32>;

    /// Whole packets, up to the last one: cuts do not show in how camera rays are traced.
    fn next(&mut self) -> Option<Range<u32>> {
        if self.left.is_empty() {
            return None;
        }
        let start = self.left.start;
        let step = match (self.longest, self.last) {
            (None, _) => self.left.end - start,
            (Some(_), None) => PACKET,
            (Some(longest), Some((step, begin))) => {
                let taken = begin.elapsed().as_secs_f64().max(1e-9);
                let fits = (f64::from(step) * longest / taken).min(8.0 * f64::from(step));
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "cut at both ends"
                )]
                let fits = fits as u32;
                fits / PACKET * PACKET
            }
        };
        // A first one that does not begin with a packet ends with one.
        let end = (start / PACKET * PACKET).saturating_add(step.max(PACKET)).min(self.left.end);
        self.left.start = end;
        self.last = Some((end - start, Instant::now()));
        Some(start..end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_than_the_interval_is_lost_however_long_copies_take() {
        for every in [0.01, 1.0, 60.0, 3600.0].map(Duration::from_secs_f64) {
            for part in [0.0, 0.01, 0.05, 0.1, 0.2, 0.3] {
                let writing = every.mul_f64(part);
                // A copy counts from when it has its name.
                let first = wait(every, None) + writing;
                assert!(first <= every, "{every:?}, {writing:?}: nothing for {first:?}");
                let wait = wait(every, Some(writing));
                let lost = late(every) + writing + wait + writing;
                assert!(lost <= every, "{every:?}, {writing:?}: {lost:?} between copies");
                assert!(wait >= every / 4, "{every:?}, {writing:?}: {wait:?} between copies");
            }
        }
        let every = Duration::from_secs(60);
        assert!(wait(every, Some(Duration::ZERO)) > every * 9 / 10, "quick copies are no more than it takes");
        assert_eq!(wait(every, Some(every)), every / 4, "samples go on being taken between long ones");
    }
}
