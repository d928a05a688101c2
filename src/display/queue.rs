//! What waits to be sent.

use crate::image::Window;
use std::collections::{HashMap, VecDeque};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Most tiles that wait; 16 MB of them.
const MOST: usize = 4096;

/// Pixels of a part of the picture, by row.
type Pixels = Vec<[f32; 4]>;

/// Tiles that wait, the newest pixels of each.
#[derive(Debug)]
pub(super) struct Queue {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug)]
struct State {
    order: VecDeque<Window>,
    tiles: HashMap<Window, Pixels>,
    /// The whole picture, once it is done.
    last: Option<(Window, Pixels)>,
    /// When bytes were sent last.
    sent: Instant,
    /// Whether all has been sent that will be.
    done: bool,
    /// Whether nobody waits for it any more.
    abandoned: bool,
}

/// What to send next.
#[derive(Debug, PartialEq)]
pub(super) enum Next {
    Nothing,
    Tile(Window, Pixels),
    /// The whole picture; nothing follows it.
    Last(Window, Pixels),
}

impl Default for Queue {
    fn default() -> Self {
        let state = State {
            order: VecDeque::new(),
            tiles: HashMap::new(),
            last: None,
            sent: Instant::now(),
            done: false,
            abandoned: false,
        };
        Self { state: Mutex::new(state), changed: Condvar::new() }
    }
}

impl Queue {
    fn locked(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a tile, in the place of its older pixels or of the oldest tile where there is no room. Does not wait.
    pub(super) fn push(&self, window: Window, pixels: Pixels) {
        let mut state = self.locked();
        if state.tiles.insert(window, pixels).is_none() {
            state.order.push_back(window);
            if state.order.len() > MOST
                && let Some(oldest) = state.order.pop_front()
            {
                state.tiles.remove(&oldest);
            }
        }
        drop(state);
        self.changed.notify_all();
    }

    /// Ends it with the whole picture, in place of all that waits.
    pub(super) fn end(&self, window: Window, pixels: Pixels) {
        let mut state = self.locked();
        (state.order, state.tiles) = (VecDeque::new(), HashMap::new());
        state.last = Some((window, pixels));
        drop(state);
        self.changed.notify_all();
    }

    /// Nobody waits for it any more.
    pub(super) fn abandon(&self) {
        self.locked().abandoned = true;
        self.changed.notify_all();
    }

    pub(super) fn is_abandoned(&self) -> bool {
        self.locked().abandoned
    }

    /// What is to be sent next; waits for it.
    pub(super) fn next(&self) -> Next {
        let is_idle = |state: &mut State| state.order.is_empty() && state.last.is_none() && !state.abandoned;
        let mut state =
            self.changed.wait_while(self.locked(), is_idle).unwrap_or_else(PoisonError::into_inner);
        let first = state.order.pop_front();
        match first.and_then(|window| Some((window, state.tiles.remove(&window)?))) {
            Some((window, pixels)) => Next::Tile(window, pixels),
            None => state.last.take().map_or(Next::Nothing, |(window, pixels)| Next::Last(window, pixels)),
        }
    }

    /// Waits for a time, or until nothing more comes.
    pub(super) fn rest(&self, time: Duration) -> Next {
        let is_under_way = |state: &mut State| state.last.is_none() && !state.abandoned;
        let waited = self.changed.wait_timeout_while(self.locked(), time, is_under_way);
        let mut state = waited.unwrap_or_else(PoisonError::into_inner).0;
        state.last.take().map_or(Next::Nothing, |(window, pixels)| Next::Last(window, pixels))
    }

    /// Bytes have been sent.
    pub(super) fn sent(&self) {
        self.locked().sent = Instant::now();
    }

    /// All has been sent that will be.
    pub(super) fn done(&self) {
        self.locked().done = true;
        self.changed.notify_all();
    }

    /// Waits until all has been sent, as long as `goes_on` says so of when bytes were sent last.
    pub(super) fn wait(&self, goes_on: impl Fn(Instant) -> bool) {
        const STEP: Duration = Duration::from_millis(50);
        let mut state = self.locked();
        while !state.done && goes_on(state.sent) {
            state = self.changed.wait_timeout(state, STEP).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile(x0: u32) -> Window {
        Window { x0, y0: 0, x1: x0 + 1, y1: 1 }
    }

    #[test]
    fn newer_pixels_take_the_place_of_older_ones() {
        let queue = Queue::default();
        queue.push(tile(1), vec![[1.0; 4]]);
        queue.push(tile(2), vec![[2.0; 4]]);
        queue.push(tile(1), vec![[3.0; 4]]);
        assert_eq!(queue.next(), Next::Tile(tile(1), vec![[3.0; 4]]), "the newest pixels, in turn");
        assert_eq!(queue.next(), Next::Tile(tile(2), vec![[2.0; 4]]), "the other one");
        queue.push(tile(1), vec![[4.0; 4]]);
        queue.end(tile(9), vec![[5.0; 4]]);
        assert_eq!(queue.next(), Next::Last(tile(9), vec![[5.0; 4]]), "all of it at the end");
    }

    #[test]
    fn there_is_an_end_to_what_waits() {
        let queue = Queue::default();
        let many = u32::try_from(MOST).expect("few") + 10;
        (0..many).for_each(|x| queue.push(tile(x), vec![]));
        assert_eq!(queue.locked().tiles.len(), MOST, "tiles");
        assert_eq!(queue.next(), Next::Tile(tile(10), vec![]), "the oldest are gone");
    }
}
