//! Pictures in a viewer while they are made, by the protocol of tev.
//!
//! Threads that render leave tiles in a queue and go on; a thread of its own sends them. Where it does not come along, because the viewer is
//! slow, hangs or is not there, newer pixels replace older ones of the same tile, and the oldest tiles are dropped. At the end the whole
//! picture is sent once more, so that what is seen is what is in the file, unless the viewer does not read it in time. A viewer that went
//! is looked for every few seconds.

mod link;
mod queue;
mod tev;

use crate::film::{Film, Tile};
use crate::image::Window;
use link::Link;
use queue::{Next, Queue};
use std::io;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// How old what is shown may be.
pub const EVERY: Duration = Duration::from_millis(500);

/// Between attempts to find the viewer.
const AGAIN: Duration = Duration::from_secs(3);

/// For how long at the end the viewer may read nothing, and how long all of it may take.
const PATIENCE: [Duration; 2] = [Duration::from_secs(2), Duration::from_secs(30)];

/// Pixels of a message at the end.
const BAND: usize = 1 << 16;

/// Somebody who is told, at most once, that the viewer cannot be reached.
pub type Warn = Box<dyn FnOnce(String) + Send>;

/// A picture that is shown somewhere.
#[derive(Debug)]
pub struct Display {
    queue: Arc<Queue>,
}

impl Display {
    /// Shows a picture of that name, width and height at a place `HOST:PORT`. Looks for the viewer meanwhile.
    ///
    /// Fails if there can be no further thread.
    pub fn start(place: &str, name: &str, full: [u32; 2], warn: Warn) -> io::Result<Self> {
        let queue = Arc::new(Queue::default());
        let sender = Sender {
            queue: queue.clone(),
            place: place.to_owned(),
            name: name.to_owned(),
            full,
            warn: Some(warn),
            link: None,
        };
        thread::Builder::new().name("display".to_owned()).spawn(move || sender.run())?;
        Ok(Self { queue })
    }

    /// Shows a part as it is now, some time. Does not wait.
    pub fn show(&self, tile: &Tile) {
        self.queue.push(tile.window(), tile.shown());
    }

    /// Shows the whole picture, which is done; waits until the viewer has it, or has read nothing for two seconds.
    pub fn finish(self, film: &Film) {
        self.queue.end(film.window(), film.shown());
        let begin = Instant::now();
        let [idle, all] = PATIENCE;
        self.queue.wait(|last| last.max(begin).elapsed() < idle && begin.elapsed() < all);
    }
}

/// Without [`Display::finish`] nothing more is sent.
impl Drop for Display {
    fn drop(&mut self) {
        self.queue.abandon();
    }
}

/// The thread that sends.
struct Sender {
    queue: Arc<Queue>,
    place: String,
    name: String,
    full: [u32; 2],
    warn: Option<Warn>,
    link: Option<Link>,
}

impl Sender {
    fn run(mut self) {
        while !self.queue.is_abandoned() {
            let found = self.find();
            let work = if found { self.queue.next() } else { self.queue.rest(AGAIN) };
            match work {
                Next::Nothing => {}
                Next::Tile(window, pixels) => self.send(window, &pixels),
                Next::Last(window, pixels) => {
                    // Somebody may have started the viewer just now, or another one in place of one that went unnoticed.
                    self.link = self.link.take().filter(|link| !link.is_closed());
                    if self.find() {
                        self.send_all(window, &pixels);
                    }
                    break;
                }
            }
        }
        self.queue.done();
    }

    /// Whether there is a viewer, looked for if need be.
    fn find(&mut self) -> bool {
        if self.link.is_none() {
            let opened = Link::open(&self.place, &self.queue)
                .and_then(|mut link| link.send(&tev::create(&self.name, self.full)).map(|()| link));
            match opened {
                Ok(link) => self.link = Some(link),
                Err(error) => self.tell(&format!("cannot reach the viewer at {}: {error}", self.place)),
            }
        }
        self.link.is_some()
    }

    fn send(&mut self, window: Window, pixels: &[[f32; 4]]) {
        let Some(link) = &mut self.link else { return };
        if let Err(error) = link.send(&tev::update(&self.name, window, pixels)) {
            self.link = None;
            self.tell(&format!("the viewer at {} went: {error}", self.place));
        }
    }

    /// Sends a picture in bands.
    fn send_all(&mut self, window: Window, pixels: &[[f32; 4]]) {
        let width = window.width().max(1);
        let rows = u32::try_from(BAND / width as usize).unwrap_or(1).max(1);
        let bands = (window.y0..window.y1).step_by(rows as usize);
        for (y0, pixels) in bands.zip(pixels.chunks(rows as usize * width as usize)) {
            if self.queue.is_abandoned() {
                return;
            }
            self.send(Window { y0, y1: y0.saturating_add(rows).min(window.y1), ..window }, pixels);
        }
    }

    fn tell(&mut self, what: &str) {
        if let Some(warn) = self.warn.take().filter(|_| !self.queue.is_abandoned()) {
            warn(format!("{what}; rendering goes on without it"));
        }
    }
}
