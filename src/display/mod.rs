//! Pictures in a viewer while they are made, by the protocol of tev.
//!
//! Threads that render leave tiles in a queue and go on; a thread of its own sends them. Where it does not come along, because the viewer is
//! slow, hangs or is not there, newer pixels replace older ones of the same tile, and of several pictures, one after the other, those before
//! the last two are left out. At its end the whole picture is sent once more, so that what is seen is what is in the file, unless the viewer
//! does not read it in time. A viewer that went is looked for every few seconds.

mod link;
mod queue;
mod tev;

use crate::film::{Film, Tile};
use crate::image::Window;
use link::Link;
use queue::{About, Next, Queue};
use std::io;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// How old what is shown may be.
pub const EVERY: Duration = Duration::from_millis(500);

/// Between attempts to find the viewer.
const AGAIN: Duration = Duration::from_secs(3);

/// For how long after the last picture the viewer may read nothing, and how long all of it may take.
const PATIENCE: [Duration; 2] = [Duration::from_secs(2), Duration::from_secs(30)];

/// Pixels of a message at the end.
const BAND: usize = 1 << 16;

/// Somebody who is told, at most once, that the viewer cannot be reached.
pub type Warn = Box<dyn FnOnce(String) + Send>;

/// Pictures that are shown somewhere, one after the other.
#[derive(Debug)]
pub struct Display {
    queue: Arc<Queue>,
}

impl Display {
    /// Shows pictures at a place `HOST:PORT`. Looks for the viewer meanwhile.
    ///
    /// Fails if there can be no further thread.
    pub fn start(place: &str, warn: Warn) -> io::Result<Self> {
        let queue = Arc::new(Queue::default());
        let sender = Sender {
            queue: queue.clone(),
            place: place.to_owned(),
            warn: Some(warn),
            link: None,
            told: None,
        };
        thread::Builder::new().name("display".to_owned()).spawn(move || sender.run())?;
        Ok(Self { queue })
    }

    /// Begins a picture of that name, width and height.
    pub fn begin(&self, name: &str, full: [u32; 2]) {
        self.queue.begin(About { name: name.to_owned(), full });
    }

    /// Shows a part of it as it is now, some time. Does not wait.
    pub fn show(&self, tile: &Tile) {
        self.queue.push(tile.window(), tile.shown());
    }

    /// Shows the whole picture, which is done. Does not wait.
    pub fn end(&self, film: &Film) {
        self.queue.end(film.window(), film.shown());
    }

    /// Waits until the viewer has all pictures, or has read nothing for two seconds, or somebody asks to stop.
    pub fn finish(self, is_cancelled: impl Fn() -> bool) {
        self.queue.finish();
        let begin = Instant::now();
        let [idle, all] = PATIENCE;
        let is_patient = |last: Instant| last.max(begin).elapsed() < idle && begin.elapsed() < all;
        self.queue.wait(|last| is_patient(last) && !is_cancelled());
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
    warn: Option<Warn>,
    link: Option<Link>,
    /// The picture that the viewer was told of.
    told: Option<Arc<About>>,
}

impl Sender {
    fn run(mut self) {
        while !self.queue.is_abandoned() {
            let found = self.find();
            let work = if found { self.queue.next() } else { self.queue.rest(AGAIN) };
            match work {
                Next::Nothing => {}
                Next::Begin(about) => {
                    self.look_again();
                    self.told = None;
                    self.introduce(&about);
                }
                Next::Tile(about, window, pixels) => self.send(&about, window, &pixels),
                Next::Last(about, window, pixels) => {
                    self.look_again();
                    self.send_all(&about, window, &pixels);
                }
                Next::End => break,
            }
        }
        self.queue.done();
    }

    /// Whether there is a viewer, looked for if need be.
    fn find(&mut self) -> bool {
        if self.link.is_none() {
            match Link::open(&self.place, &self.queue) {
                Ok(link) => (self.link, self.told) = (Some(link), None),
                Err(error) => self.tell(&format!("cannot reach the viewer at {}: {error}", self.place)),
            }
        }
        self.link.is_some()
    }

    /// Gives up a viewer that went unnoticed: another one may have taken its place.
    fn look_again(&mut self) {
        self.link = self.link.take().filter(|link| !link.is_closed());
    }

    /// Whether there is a viewer that knows of a picture; it is told if need be.
    fn introduce(&mut self, about: &Arc<About>) -> bool {
        if !self.find() {
            return false;
        }
        if self.told.as_ref() != Some(about) {
            self.say(&tev::create(&about.name, about.full));
            self.told = Some(about.clone());
        }
        self.link.is_some()
    }

    fn send(&mut self, about: &Arc<About>, window: Window, pixels: &[[f32; 4]]) {
        if self.introduce(about) {
            self.say(&tev::update(&about.name, window, pixels));
        }
    }

    /// Sends a message to the viewer that was found, which may be gone.
    fn say(&mut self, message: &[u8]) {
        let Some(link) = &mut self.link else { return };
        if let Err(error) = link.send(message) {
            self.link = None;
            self.tell(&format!("the viewer at {} went: {error}", self.place));
        }
    }

    /// Sends a picture in bands.
    fn send_all(&mut self, about: &Arc<About>, window: Window, pixels: &[[f32; 4]]) {
        self.introduce(about);
        let width = window.width().max(1);
        let rows = u32::try_from(BAND / width as usize).unwrap_or(1).max(1);
        let bands = (window.y0..window.y1).step_by(rows as usize);
        for (y0, pixels) in bands.zip(pixels.chunks(rows as usize * width as usize)) {
            if self.queue.is_abandoned() || self.link.is_none() {
                return;
            }
            let band = Window { y0, y1: y0.saturating_add(rows).min(window.y1), ..window };
            self.say(&tev::update(&about.name, band, pixels));
        }
    }

    fn tell(&mut self, what: &str) {
        if let Some(warn) = self.warn.take().filter(|_| !self.queue.is_abandoned()) {
            warn(format!("{what}; rendering goes on without it"));
        }
    }
}
