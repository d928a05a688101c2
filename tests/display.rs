//! Pictures in a viewer while they are made: a small receiver reads what the viewer tev would. It has the picture of the file in the end,
//! and whatever it does, rendering neither waits for it nor fails.

#[path = "support/desk.rs"]
mod desk;
#[path = "support/room.rs"]
mod room;
#[path = "support/scene.rs"]
mod scene;

use desk::Desk;
use specula::film::{Film, Tile};
use specula::image::exr::{self, Samples};
use specula::image::{self, Window};
use specula::render::{Progress, Settings, render};
use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader, ErrorKind, Read};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::process::Stdio;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

const SCENE: &str = "[film]\nwidth = 150\nheight = 70\n[render]\nintegrator = 'path'\nspp = 48\n[materials.m]\ntype = 'diffuse'\n\
    [[shapes]]\ntype = 'sphere'\nmaterial = 'm'\n[[lights]]\ntype = 'environment'\nradiance = 1\n\
    [[lights]]\ntype = 'point'\nposition = [2, 3, 4]\nintensity = 20\n";

/// What a message says.
struct Message(Vec<u8>, usize);

impl Message {
    /// The next one; none where the sender has closed the connection between messages.
    fn read(from: &mut TcpStream) -> Option<Self> {
        let mut length = [0; 4];
        match from.read_exact(&mut length) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return None,
            other => other.expect("readable"),
        }
        let length = u32::from_le_bytes(length) as usize;
        let mut bytes = vec![0; length - 4];
        from.read_exact(&mut bytes).expect("whole");
        Some(Self(bytes, 0))
    }

    /// Whether a picture begins.
    fn begins(&self) -> bool {
        self.0[0] == 4
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let bytes = self.0[self.1..self.1 + N].try_into().expect("there");
        self.1 += N;
        bytes
    }

    fn number(&mut self) -> usize {
        usize::try_from(i32::from_le_bytes(self.take())).expect("not negative")
    }

    fn long(&mut self) -> usize {
        usize::try_from(i64::from_le_bytes(self.take())).expect("not negative")
    }

    fn text(&mut self) -> String {
        let length = self.0[self.1..].iter().position(|&byte| byte == 0).expect("an end");
        let text = String::from_utf8(self.0[self.1..self.1 + length].to_vec()).expect("UTF-8");
        self.1 += length + 1;
        text
    }

    fn texts(&mut self) -> Vec<String> {
        let count = self.number();
        (0..count).map(|_| self.text()).collect()
    }

    fn floats(&self) -> Vec<f32> {
        let floats = self.0[self.1..].as_chunks().0;
        floats.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect()
    }
}

/// A picture that was received.
#[derive(Default)]
struct Received {
    name: String,
    size: [usize; 2],
    channels: BTreeMap<String, Vec<f32>>,
    /// Messages with pixels.
    updates: usize,
    /// Pixels that were there before the last ones came.
    early: usize,
}

impl Received {
    fn take(&mut self, mut message: Message) {
        let [kind] = message.take();
        let [focus] = message.take();
        let name = message.text();
        match kind {
            4 => {
                assert_eq!(focus, 1, "it is to be seen");
                let size = [message.number(), message.number()];
                let black = vec![0.0; size[0] * size[1]];
                let channels = message.texts().into_iter().map(|name| (name, black.clone())).collect();
                assert_eq!(message.1, message.0.len(), "nothing more");
                (self.name, self.size, self.channels) = (name, size, channels);
            }
            6 => {
                assert_eq!(name, self.name, "of the picture");
                let names = message.texts();
                let [x, y, width, height] = [(); 4].map(|()| message.number());
                let offsets: Vec<usize> = names.iter().map(|_| message.long()).collect();
                let steps: Vec<usize> = names.iter().map(|_| message.long()).collect();
                let floats = message.floats();
                assert!(x + width <= self.size[0] && y + height <= self.size[1], "within the picture");
                for ((name, offset), step) in names.iter().zip(offsets).zip(steps) {
                    let channel = self.channels.get_mut(name).expect("a channel of the picture");
                    for i in 0..width * height {
                        channel[(y + i / width) * self.size[0] + x + i % width] = floats[offset + i * step];
                    }
                }
                self.updates += 1;
                self.early += if width < 150 { width * height } else { 0 };
            }
            other => panic!("a message of kind {other}"),
        }
    }
}

fn listener() -> (TcpListener, String) {
    listener_at("127.0.0.1")
}

/// At an address of its own: nobody else takes the port when the listener goes.
fn listener_at(address: &str) -> (TcpListener, String) {
    // Elsewhere there is one such address.
    let address = if cfg!(target_os = "linux") { address } else { "127.0.0.1" };
    let listener = TcpListener::bind((address, 0)).expect("a port");
    let place = listener.local_addr().expect("bound").to_string();
    (listener, place)
}

/// Takes one connection with one picture to its end.
fn receiver(listener: TcpListener) -> JoinHandle<Received> {
    thread::spawn(move || {
        let mut pictures = take_all(&listener);
        assert_eq!(pictures.len(), 1, "pictures");
        pictures.remove(0)
    })
}

/// Takes one connection with any number of pictures to its end.
fn take_all(listener: &TcpListener) -> Vec<Received> {
    let (mut stream, _) = listener.accept().expect("a connection");
    let mut pictures: Vec<Received> = Vec::new();
    while let Some(message) = Message::read(&mut stream) {
        if message.begins() {
            pictures.push(Received::default());
        }
        pictures.last_mut().expect("a picture began").take(message);
    }
    pictures
}

fn desk() -> Desk {
    let desk = Desk::new();
    std::fs::write(desk.path("scene.toml"), SCENE).expect("written");
    desk
}

/// What differs between what was received and a file, in the pixels that the file has.
fn compare(received: &Received, picture: &exr::Picture) {
    let Window { x0, y0, x1, y1 } = picture.window;
    assert_eq!(picture.full.map(|size| size as usize), received.size, "size");
    assert_eq!(received.channels.keys().collect::<Vec<_>>(), ["A", "B", "G", "R"], "channels");
    for name in received.channels.keys() {
        let Some(Samples::Float(stored)) = picture.channel(name) else { panic!("no channel {name}") };
        let shown = (y0..y1).flat_map(|y| (x0..x1).map(move |x| y as usize * received.size[0] + x as usize));
        let shown: Vec<u32> = shown.map(|i| received.channels[name][i].to_bits()).collect();
        let stored: Vec<u32> = stored.iter().map(|x| x.to_bits()).collect();
        assert!(shown == stored, "channel {name}");
    }
}

#[test]
fn a_viewer_has_the_picture_of_the_file() {
    for words in
        [&[][..], &["--crop", "20,10,130,61"], &["--integrator", "whitted", "-D", "render.glossy=two-pass"]]
    {
        let desk = desk();
        let (listener, place) = listener();
        let received = receiver(listener);
        let all = [&["render", "scene.toml", "-o", "a.exr", "--display", &place], words].concat();
        let (status, _, log) = desk.run(&all);
        assert_eq!(status, 0, "{log}");
        let received = received.join().expect("received");
        println!("{words:?}: {} updates, {} pixels before the end", received.updates, received.early);
        assert_eq!(received.name, "scene.toml", "name");
        compare(&received, &exr::read(&desk.path("a.exr")).expect("a picture"));
        let plain = [&["render", "scene.toml", "-o", "b.exr"], words].concat();
        assert_eq!(desk.run(&plain).0, 0, "without a viewer");
        let [a, b] = ["a.exr", "b.exr"].map(|name| image::read(&desk.path(name)).expect("read").image);
        assert!(a == b, "the same picture, looked at or not");
    }
}

#[test]
fn frames_are_shown_under_their_own_names() {
    let desk = desk();
    let (listener, place) = listener();
    let frames = thread::spawn(move || take_all(&listener));
    let words = ["render", "scene.toml", "-o", "a.#.exr", "--frames", "3..4", "--display", &place];
    let (status, _, log) = desk.run(&words);
    assert_eq!(status, 0, "{log}");
    let frames = frames.join().expect("received");
    assert_eq!(frames.len(), 2, "one after the other");
    for (received, frame) in frames.iter().zip([3, 4]) {
        assert_eq!(received.name, format!("scene.toml frame {frame}"), "name");
        compare(received, &exr::read(&desk.path(&format!("a.{frame}.exr"))).expect("a picture"));
    }
}

#[test]
fn tiles_come_while_the_picture_is_made() {
    let desk = desk();
    let (listener, place) = listener();
    let received = receiver(listener);
    // Long enough for the viewer to be found before the end.
    let words = ["render", "scene.toml", "-o", "a.exr", "--spp", "4096", "--display", &place];
    let (status, _, log) = desk.run(&words);
    assert_eq!(status, 0, "{log}");
    let received = received.join().expect("received");
    println!("{} updates, {} pixels before the end", received.updates, received.early);
    assert!(received.early > 0, "something was seen before the end");
    compare(&received, &exr::read(&desk.path("a.exr")).expect("a picture"));
}

#[test]
fn a_viewer_that_never_reads_holds_nothing_up() {
    let desk = desk();
    let (listener, place) = listener();
    // So large that no buffers of the system take it all.
    let size = ["--width", "2400", "--height", "2400", "--spp", "1", "--integrator", "view", "-o", "a.exr"];
    let begin = Instant::now();
    let plain = [&["render", "scene.toml"], &size[..]].concat();
    assert_eq!(desk.run(&plain).0, 0, "without a viewer");
    let alone = begin.elapsed();
    let begin = Instant::now();
    let (status, _, log) = desk.run(&[&plain[..], &["--display", &place]].concat());
    let stalled = begin.elapsed();
    println!("{alone:?} without a viewer, {stalled:?} with one that does not read");
    assert_eq!(status, 0, "{log}");
    // No more than it waits at the end, and ample time for a machine with other things to do: a hang would have no end.
    assert!(stalled < 2 * alone + Duration::from_secs(30), "{stalled:?} for {alone:?}");
    drop(listener);
}

#[cfg(unix)]
#[test]
fn files_are_named_before_a_slow_viewer_has_them_and_a_stop_ends_the_wait() {
    let desk = desk();
    let (listener, place) = listener();
    // So slow that it never has all within the time that it is given.
    let slow = thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a connection");
        let mut block = vec![0; 1 << 16];
        while stream.read(&mut block).is_ok_and(|read| read > 0) {
            thread::sleep(Duration::from_millis(100));
        }
    });
    let size = ["--width", "2400", "--height", "2400", "--spp", "1", "--integrator", "view", "-o", "a.exr"];
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("specula"));
    command.current_dir(desk.path(".")).args(["render", "scene.toml", "-q", "--display", &place]).args(size);
    let mut child = command.stdout(Stdio::piped()).spawn().expect("started");
    while !desk.path("a.exr").exists() {
        thread::sleep(Duration::from_millis(10));
        assert!(child.try_wait().expect("known").is_none(), "it renders");
    }
    let begin = Instant::now();
    let mut line = String::new();
    BufReader::new(child.stdout.as_mut().expect("a pipe")).read_line(&mut line).expect("text");
    assert_eq!(line, "a.exr\n", "the name of the file");
    let asked = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(asked.expect("run").success(), "asked to stop");
    assert!(child.wait().expect("ended").success(), "the picture is there");
    // It would wait for 30 s.
    assert!(begin.elapsed() < Duration::from_secs(20), "{:?}", begin.elapsed());
    slow.join().expect("ended");
}

/// Counts what it is shown.
struct Looker {
    every: Duration,
    shown: AtomicUsize,
}

impl Progress for Looker {
    fn advance(&self, _done: u64, _total: u64) {}

    fn is_cancelled(&self) -> bool {
        false
    }

    fn looks_every(&self) -> Option<Duration> {
        Some(self.every)
    }

    fn show(&self, _part: &Tile) {
        self.shown.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn filtered_pictures_are_shown_no_more_often_than_is_looked() {
    let scene = scene::scene_of(&room::fuzzy_room("spp = 6"));
    let shown = |every| {
        let looker = Looker { every, shown: AtomicUsize::new(0) };
        render(&scene, &Settings::default(), &looker).expect("a picture");
        looker.shown.into_inner()
    };
    let once = shown(Duration::from_secs(3600));
    assert!(once > 0, "the first sample");
    assert_eq!(shown(Duration::ZERO), 6 * once, "every sample");
}

#[test]
fn a_viewer_that_dies_is_told_of_once() {
    let desk = desk();
    let (listener, place) = listener();
    let dying = thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a connection");
        Message::read(&mut stream).expect("the picture begins");
        stream.shutdown(Shutdown::Both).expect("closed");
    });
    let words = ["render", "scene.toml", "-o", "a.exr", "--spp", "2048", "--display", &place];
    let (status, _, log) = desk.run(&words);
    dying.join().expect("died");
    assert_eq!(status, 0, "{log}");
    assert_eq!(log.matches("viewer").count(), 1, "one warning: {log}");
    assert!(exr::read(&desk.path("a.exr")).is_ok(), "the picture is there");
}

#[test]
fn a_viewer_that_is_not_there_is_told_of_once() {
    let desk = desk();
    let (listener, place) = listener_at("127.0.0.2");
    drop(listener);
    let words = ["render", "scene.toml", "-o", "a.#.exr", "--frames", "1..3", "--display", &place];
    let (status, _, log) = desk.run(&words);
    assert_eq!(status, 0, "{log}");
    assert!(log.contains(&format!("cannot reach the viewer at {place}")), "{log}");
    assert_eq!(log.matches("viewer").count(), 1, "one warning: {log}");
}

#[test]
fn a_viewer_that_comes_late_has_it_all() {
    let (listener, place) = listener_at("127.0.0.3");
    drop(listener);
    let display = specula::display::Display::start(&place, Box::new(|_| {})).expect("a thread");
    display.begin("late", [3, 2]);
    // Nobody is there when the first tile comes; the viewer is before the picture is done.
    thread::sleep(Duration::from_millis(300));
    let received = receiver(TcpListener::bind(&place).expect("the same port"));
    let film = Film::new([3, 2], Window::whole(3, 2), specula::film::Layout::default());
    display.end(&film);
    display.finish(|| false);
    let received = received.join().expect("received");
    assert_eq!((received.name.as_str(), received.size, received.updates), ("late", [3, 2], 1), "the picture");
}

#[test]
fn a_viewer_that_takes_the_place_of_one_that_went_has_it_all() {
    let (listener, place) = listener();
    let display = specula::display::Display::start(&place, Box::new(|_| {})).expect("a thread");
    display.begin("again", [3, 2]);
    // Nothing is sent after the beginning until the end, so that nobody notices.
    let (mut stream, _) = listener.accept().expect("a connection");
    Message::read(&mut stream).expect("the picture begins");
    drop(stream);
    let received = receiver(listener);
    thread::sleep(Duration::from_millis(300));
    let film = Film::new([3, 2], Window::whole(3, 2), specula::film::Layout::default());
    display.end(&film);
    display.finish(|| false);
    let received = received.join().expect("received");
    assert_eq!(
        (received.name.as_str(), received.size, received.updates),
        ("again", [3, 2], 1),
        "the picture"
    );
}

#[test]
fn places_without_a_port_are_refused() {
    let desk = desk();
    let (status, _, log) = desk.run(&["render", "scene.toml", "-o", "a.exr", "--display", "localhost"]);
    assert_eq!(status, 2, "{log}");
    assert!(log.contains("give HOST:PORT"), "{log}");
}
