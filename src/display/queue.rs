//! What waits to be sent.

use crate::image::Window;
use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Most pictures that wait: the one that is made, and the one before.
const MOST: usize = 2;

/// Pixels of a part of the picture, by row.
type Pixels = Vec<[f32; 4]>;

/// What a viewer is told of a picture when it begins.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct About {
    pub(super) name: String,
    /// Width and height.
    pub(super) full: [u32; 2],
}

/// Pictures that wait, the oldest first.
#[derive(Debug)]
pub(super) struct Queue {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug)]
struct State {
    pictures: VecDeque<Picture>,
    /// When bytes were sent last.
    sent: Instant,
    /// Whether no more comes.
    ended: bool,
    /// Whether all has been sent that will be.
    done: bool,
    /// Whether nobody waits for it any more.
    abandoned: bool,
}

/// What waits of a picture.
#[derive(Debug)]
struct Picture {
    about: Arc<About>,
    is_begun: bool,
    order: VecDeque<Window>,
    /// The newest pixels of each tile: no more in all than the picture has.
    tiles: HashMap<Window, Pixels>,
    /// All of it, once it is done.
    last: Option<(Window, Pixels)>,
}

/// What to send next.
#[derive(Debug, PartialEq)]
pub(super) enum Next {
    Nothing,
    /// That a picture begins.
    Begin(Arc<About>),
    Tile(Arc<About>, Window, Pixels),
    /// The whole picture; nothing of it follows.
    Last(Arc<About>, Window, Pixels),
    /// Nothing follows.
    End,
}

impl Default for Queue {
    fn default() -> Self {
        let state = State {
            pictures: VecDeque::new(),
            sent: Instant::now(),
            ended: false,
            done: false,
            abandoned: false,
        };
        Self { state: Mutex::new(state), changed: Condvar::new() }
    }
}

impl State {
    /// What is there to be sent.
    fn take(&mut self) -> Option<Next> {
        loop {
            let is_followed = self.ended || self.pictures.len() > 1;
            let Some(first) = self.pictures.front_mut() else { return self.ended.then_some(Next::End) };
            let about = first.about.clone();
            if !std::mem::replace(&mut first.is_begun, true) {
                return Some(Next::Begin(about));
            }
            let tile = first.order.pop_front();
            if let Some((window, pixels)) = tile.and_then(|window| first.tiles.remove_entry(&window)) {
                return Some(Next::Tile(about, window, pixels));
            }
            let last = first.last.take();
            if last.is_none() && !is_followed {
                return None;
            }
            self.pictures.pop_front();
            if let Some((window, pixels)) = last {
                return Some(Next::Last(about, window, pixels));
            }
        }
    }

    /// The first picture that is done, whatever waits before it.
    fn take_whole(&mut self) -> Option<Next> {
        let at = self.pictures.iter().position(|picture| picture.last.is_some())?;
        let Picture { about, last, .. } = self.pictures.drain(..=at).next_back()?;
        last.map(|(window, pixels)| Next::Last(about, window, pixels))
    }
}

impl Queue {
    fn locked(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a picture. Those before the last one are left out, if they still wait.
    pub(super) fn begin(&self, about: About) {
        let mut state = self.locked();
        let excess = (state.pictures.len() + 1).saturating_sub(MOST);
        state.pictures.drain(..excess);
        state.pictures.push_back(Picture {
            about: about.into(),
            is_begun: false,
            order: VecDeque::new(),
            tiles: HashMap::new(),
            last: None,
        });
        drop(state);
        self.changed.notify_all();
    }

    /// Adds a tile to the picture that began last, in the place of its older pixels. Does not wait.
    pub(super) fn push(&self, window: Window, pixels: Pixels) {
        let mut state = self.locked();
        if let Some(picture) = state.pictures.back_mut()
            && picture.tiles.insert(window, pixels).is_none()
        {
            picture.order.push_back(window);
        }
        drop(state);
        self.changed.notify_all();
    }

    /// Ends that picture with all of it, in place of the tiles that wait.
    pub(super) fn end(&self, window: Window, pixels: Pixels) {
        let mut state = self.locked();
        if let Some(picture) = state.pictures.back_mut() {
            (picture.order, picture.tiles) = (VecDeque::new(), HashMap::new());
            picture.last = Some((window, pixels));
        }
        drop(state);
        self.changed.notify_all();
    }

    /// No more comes.
    pub(super) fn finish(&self) {
        self.locked().ended = true;
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
        let mut state = self.locked();
        loop {
            if state.abandoned {
                return Next::Nothing;
            }
            if let Some(next) = state.take() {
                return next;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Waits for a time, or until a whole picture is there or nothing more comes.
    pub(super) fn rest(&self, time: Duration) -> Next {
        let is_under_way = |state: &mut State| {
            let is_whole = state.pictures.iter().any(|picture| picture.last.is_some());
            !is_whole && !state.ended && !state.abandoned
        };
        let waited = self.changed.wait_timeout_while(self.locked(), time, is_under_way);
        let mut state = waited.unwrap_or_else(PoisonError::into_inner).0;
        let whole = state.take_whole();
        whole.unwrap_or(if state.ended { Next::End } else { Next::Nothing })
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

    fn about(name: &str) -> About {
        About { name: name.to_owned(), full: [9, 9] }
    }

    /// A queue in which a picture of that name has begun.
    fn begun(name: &str) -> (Queue, Arc<About>) {
        let (queue, told) = (Queue::default(), Arc::new(about(name)));
        queue.begin(about(name));
        assert_eq!(queue.next(), Next::Begin(told.clone()), "it begins");
        (queue, told)
    }

    #[test]
    fn newer_pixels_take_the_place_of_older_ones() {
        let (queue, a) = begun("a");
        queue.push(tile(1), vec![[1.0; 4]]);
        queue.push(tile(2), vec![[2.0; 4]]);
        queue.push(tile(1), vec![[3.0; 4]]);
        let next = Next::Tile(a.clone(), tile(1), vec![[3.0; 4]]);
        assert_eq!(queue.next(), next, "the newest pixels, in turn");
        assert_eq!(queue.next(), Next::Tile(a.clone(), tile(2), vec![[2.0; 4]]), "the other one");
        queue.push(tile(1), vec![[4.0; 4]]);
        queue.end(tile(9), vec![[5.0; 4]]);
        queue.finish();
        assert_eq!(queue.next(), Next::Last(a, tile(9), vec![[5.0; 4]]), "all of it at the end");
        assert_eq!(queue.next(), Next::End, "nothing more");
    }

    #[test]
    fn no_tile_of_a_large_picture_is_lost() {
        let (queue, a) = begun("a");
        (0..20_000).for_each(|x| queue.push(tile(x), vec![]));
        for x in 0..20_000 {
            assert_eq!(queue.next(), Next::Tile(a.clone(), tile(x), vec![]), "each in turn");
        }
    }

    #[test]
    fn the_picture_before_the_last_one_still_waits_and_older_ones_do_not() {
        let queue = Queue::default();
        for (x, name) in ["a", "b", "c"].into_iter().enumerate() {
            queue.begin(about(name));
            queue.push(tile(7), vec![]);
            queue.end(tile(u32::try_from(x).expect("few")), vec![]);
        }
        let [b, c] = ["b", "c"].map(|name| Arc::new(about(name)));
        assert_eq!(queue.next(), Next::Begin(b.clone()), "the first one that waits");
        assert_eq!(queue.next(), Next::Last(b, tile(1), vec![]), "all of it");
        assert_eq!(queue.rest(Duration::ZERO), Next::Last(c, tile(2), vec![]), "also where nobody was there");
        assert_eq!(queue.rest(Duration::ZERO), Next::Nothing, "for now");
        queue.finish();
        assert_eq!(queue.rest(Duration::ZERO), Next::End, "nothing more");
    }
}
