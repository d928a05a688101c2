//! Pictures that were interrupted, killed or whose files were damaged: what goes on is, to the bit, the picture of one go; what cannot
//! go on is refused, and says why.

#[path = "support/desk.rs"]
mod desk;
#[cfg(target_os = "linux")]
#[path = "support/disk.rs"]
mod disk;
#[path = "support/random.rs"]
mod random;
#[path = "support/room.rs"]
mod room;
#[path = "support/running.rs"]
mod running;
#[path = "support/scene.rs"]
mod scene;

use desk::Desk;
use room::{fuzzy_room, room};
use running::{spawn, wait_for};
use scene::{bits, scene_of};
use serde_json::{Value, json};
use specula::error::{Error, Place, Result};
use specula::film::{Aov, Layout};
use specula::image::Window;
use specula::render::{
    Checkpoint, Ended, Keeper, Kept, Limits, Progress, Rendered, Settings, Silent, Slice, State, render,
    render_kept,
};
use specula::scene::Scene;
use std::num::NonZeroUsize;

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Keeps copies in memory.
struct Memory {
    every: Duration,
    last: Mutex<Option<Vec<u8>>>,
}

impl Memory {
    fn new(every: Duration) -> Self {
        Self { every, last: Mutex::new(None) }
    }

    fn bytes(&self) -> Option<Vec<u8>> {
        self.last.lock().expect("sound").clone()
    }
}

impl Keeper for Memory {
    fn every(&self) -> Duration {
        self.every
    }

    fn keep(&self, state: &State) -> Result<()> {
        let mut bytes = Vec::new();
        state.write(&json!({ "of": "a test" }), &mut bytes).expect("written");
        *self.last.lock().expect("sound") = Some(bytes);
        Ok(())
    }

    fn missed(&self, error: Error) {
        panic!("{error}");
    }
}

/// Stops when so many more samples have been taken.
struct Stop {
    left: AtomicU64,
    last: AtomicU64,
}

impl Progress for Stop {
    fn advance(&self, done: u64, _total: u64) {
        let last = self.last.fetch_max(done, Ordering::Relaxed);
        let more = if last == 0 { 1 } else { done.saturating_sub(last) };
        let _ = self
            .left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| Some(left.saturating_sub(more)));
    }

    fn is_cancelled(&self) -> bool {
        self.left.load(Ordering::Relaxed) == 0
    }
}

fn begin(bytes: &[u8]) -> std::result::Result<Kept<'_>, String> {
    let reader: Box<dyn std::io::Read + '_> = Box::new(bytes);
    let checkpoint = Checkpoint::open(reader, bytes.len() as u64)?;
    Ok(Kept { begin: Some((checkpoint, Place::file("a.ckpt"))), keeper: None })
}

/// The picture with interruptions after so many samples each, and how many there were.
fn interrupted(scene: &Scene, settings: &Settings, samples: u64, every: Duration) -> (Rendered, usize) {
    let mut last: Option<Vec<u8>> = None;
    for times in 0..1000 {
        let (keeper, before) = (Memory::new(every), last.take());
        let kept = before.as_deref().map_or(Kept::default(), |bytes| begin(bytes).expect("sound"));
        let stop = Stop { left: AtomicU64::new(samples), last: AtomicU64::new(0) };
        match render_kept(scene, settings, &stop, Kept { keeper: Some(&keeper), ..kept }) {
            Ok(rendered) => return (rendered, times),
            Err(Error::Interrupted) => last = Some(keeper.bytes().expect("kept")),
            Err(error) => panic!("{error}"),
        }
    }
    panic!("it does not get on");
}

fn settings(threads: usize, limits: Limits) -> Settings {
    let layout = Layout::with([Aov::Variance, Aov::Depth, Aov::ObjectId, Aov::CryptoMaterial, Aov::Direct]);
    Settings { threads: NonZeroUsize::new(threads), layout, limits, ..Settings::default() }
}

/// Every integrator, every way to trace, every sampler; whole packets and not.
const WAYS: [(&str, usize); 8] = [
    ("integrator = \"path\"\nspp = 64", 2),
    ("integrator = \"path\"\nspp = 40\nsampler = \"stratified\"", 1),
    ("integrator = \"path\"\nquery = \"single\"\nspp = 37\nsampler = \"independent\"", 2),
    ("integrator = \"path\"\nquery = \"packet\"\nspp = 64\nsampler = \"blue_noise\"", 2),
    ("integrator = \"whitted\"\nspp = 64", 1),
    ("integrator = \"whitted\"\nquery = \"single\"\nspp = 50", 2),
    ("integrator = \"distribution\"\nquery = \"packet\"\nspp = 48", 2),
    ("integrator = \"view\"\nview = \"cost\"\nspp = 64\nbackend = \"bvh2\"", 2),
];

#[test]
fn interrupted_pictures_are_those_of_one_go() {
    for (render, threads) in WAYS {
        let scene = scene_of(&room(render));
        let settings = settings(threads, Limits::default());
        let whole = specula::render::render(&scene, &settings, &Silent).expect("a picture");
        let (resumed, times) = interrupted(&scene, &settings, 9000, Duration::from_secs(3600));
        println!("{render:?}: {times} interruptions");
        assert!(times > 0, "{render}: interrupted");
        assert!(bits(&resumed.film) == bits(&whole.film), "{render}: to the bit");
        assert_eq!(resumed.film, whole.film, "{render}: sums");
        assert_eq!(resumed.statistics.counters, whole.statistics.counters, "{render}: rays");
    }
}

/// Filtered reflections: copies have whole samples of the picture.
#[test]
fn interrupted_pictures_of_filtered_reflections_are_those_of_one_go() {
    for (render, threads) in [("spp = 24", 2), ("integrator = \"distribution\"\nspp = 17", 1)] {
        let scene = scene_of(&fuzzy_room(render));
        let settings = settings(threads, Limits::default());
        let whole = specula::render::render(&scene, &settings, &Silent).expect("a picture");
        let (resumed, times) = interrupted(&scene, &settings, 5000, Duration::from_secs(3600));
        println!("{render:?}: {times} interruptions");
        assert!(times > 1, "{render}: interrupted");
        assert_eq!(resumed.film, whole.film, "{render}: sums");
        assert_eq!(resumed.statistics.counters, whole.statistics.counters, "{render}: rays");
        let [all, filter] = [resumed.statistics.render, resumed.statistics.filter].map(|phase| phase.wall);
        assert!(
            Duration::ZERO < filter && filter < all,
            "{render}: times of all runs: {filter:?} of {all:?}"
        );
    }
    // Time that earlier runs took counts, and what ended is that of its samples.
    let limits = Limits { time: Some(Duration::from_millis(600)), ..Limits::default() };
    let scene = scene_of(&fuzzy_room(""));
    let (resumed, times) = interrupted(&scene, &settings(2, limits), 20_000, Duration::from_secs(3600));
    assert_eq!(resumed.statistics.ended, Ended::Time, "{times} interruptions");
    let [least, most] = resumed.film.samples_of_pixels();
    assert!(least == most && most < 1 << 16, "{least}, {most}");
    let whole = scene_of(&fuzzy_room(&format!("spp = {most}")));
    let whole = render(&whole, &settings(2, Limits::default()), &Silent).expect("a picture");
    assert!(bits(&resumed.film) == bits(&whole.film), "{most} samples, to the bit");
    // The first pass itself is in no copy.
    let keeper = Memory::new(Duration::from_secs(3600));
    let kept = Kept { begin: None, keeper: Some(&keeper) };
    let settings = Settings { first_pass: true, ..settings(1, Limits::default()) };
    let error = render_kept(&scene, &settings, &Silent, kept).expect_err("refused").to_string();
    assert!(error.contains("`gbuffer`") && error.contains("leave out"), "{error}");
}

#[test]
fn slices_and_crops_go_on_too() {
    let crop = Window { x0: 5, y0: 3, x1: 31, y1: 19 };
    let slice = Slice { index: 1, of: 2 };
    let texts = [room(WAYS[0].0), room(WAYS[1].0), room(WAYS[4].0), room(WAYS[5].0), fuzzy_room("spp = 48")];
    for text in texts {
        let scene = scene_of(&text);
        let render_keys =
            text.lines().skip_while(|line| !line.contains("[render]")).take(5).collect::<String>();
        for (slice, crop) in [(Some(slice), None), (None, Some(crop)), (Some(slice), Some(crop))] {
            // A thread that is stopped gets on by a packet of a tile, 4096 samples, at least.
            let settings = Settings { slice, crop, ..settings(1, Limits::default()) };
            let whole = render(&scene, &settings, &Silent).expect("a picture");
            let (resumed, times) = interrupted(&scene, &settings, 5000, Duration::from_secs(3600));
            let what = format!("{render_keys}, {slice:?}, {crop:?}: {times} interruptions");
            println!("{what}");
            assert!(times > 0, "{what}");
            assert_eq!(resumed.film, whole.film, "{what}: sums");
            assert_eq!(resumed.statistics.counters, whole.statistics.counters, "{what}: rays");
            assert_eq!(resumed.statistics.first, whole.statistics.first, "{what}: which samples");
        }
    }
}

#[test]
fn copies_taken_meanwhile_change_nothing() {
    // So often that tiles are put after every packet and copies are taken all the time.
    let scene = scene_of(&room("integrator = \"path\"\nspp = 256"));
    let settings = settings(2, Limits::default());
    let whole = render(&scene, &settings, &Silent).expect("a picture");
    let keeper = Memory::new(Duration::from_millis(1));
    let kept = Kept { begin: None, keeper: Some(&keeper) };
    let rendered = render_kept(&scene, &settings, &Silent, kept).expect("a picture");
    assert!(bits(&rendered.film) == bits(&whole.film), "to the bit");
    let bytes = keeper.bytes().expect("kept");
    let rendered = render_kept(&scene, &settings, &Silent, begin(&bytes).expect("sound")).expect("a picture");
    assert!(bits(&rendered.film) == bits(&whole.film), "from the last copy");
}

#[test]
fn pictures_that_end_by_their_error_go_on_by_what_they_knew() {
    for spp in [1000, 1024] {
        let scene = scene_of(&room(&format!("integrator = \"path\"\nspp = {spp}")));
        let settings = settings(2, Limits { error: Some(2e-3), ..Limits::default() });
        let whole = render(&scene, &settings, &Silent).expect("a picture");
        assert_eq!(whole.statistics.ended, Ended::Error, "{spp}");
        let (resumed, times) = interrupted(&scene, &settings, 12_000, Duration::from_secs(3600));
        println!("{spp}: {times} interruptions");
        assert!(times > 1, "{spp}: interrupted");
        assert_eq!(resumed.film, whole.film, "{spp}: sums");
        assert_eq!(resumed.statistics.estimate, whole.statistics.estimate, "{spp}: error");
    }
}

#[test]
fn pictures_that_time_ends_count_all_of_it() {
    let scene = scene_of(&room("integrator = \"path\""));
    let limits = Limits { time: Some(Duration::from_millis(900)), ..Limits::default() };
    let begin = Instant::now();
    let (resumed, times) = interrupted(&scene, &settings(2, limits), 15_000, Duration::from_secs(3600));
    println!("{times} interruptions, {:?}", begin.elapsed());
    assert_eq!(resumed.statistics.ended, Ended::Time, "time");
    let [least, most] = resumed.film.samples_of_pixels();
    assert_eq!(least, most, "all pixels have the same");
    let whole = scene_of(&room(&format!("integrator = \"path\"\nspp = {most}")));
    let whole = render(&whole, &settings(2, Limits::default()), &Silent).expect("a picture");
    assert!(bits(&resumed.film) == bits(&whole.film), "{most} samples, to the bit");
}

/// A small checkpoint in the middle of a picture, and that picture.
fn small() -> (Scene, Settings, Vec<u8>) {
    let text = room("integrator = \"path\"\nspp = 64").replace("width = 37", "width = 5");
    let scene = scene_of(&text.replace("height = 21", "height = 4"));
    let settings = settings(1, Limits { error: Some(1e-9), ..Limits::default() });
    let keeper = Memory::new(Duration::from_secs(3600));
    let stop = Stop { left: AtomicU64::new(700), last: AtomicU64::new(0) };
    let kept = Kept { begin: None, keeper: Some(&keeper) };
    let error = render_kept(&scene, &settings, &stop, kept).expect_err("interrupted");
    assert!(matches!(error, Error::Interrupted), "{error}");
    let bytes = keeper.bytes().expect("kept");
    (scene, settings, bytes)
}

#[test]
fn damaged_checkpoints_are_refused_whatever_is_wrong_with_them() {
    let (scene, settings, bytes) = small();
    println!("{} bytes", bytes.len());
    let result = |bytes: &[u8]| -> std::result::Result<Rendered, String> {
        let kept = begin(bytes)?;
        render_kept(&scene, &settings, &Silent, kept).map_err(|error| error.to_string())
    };
    assert!(result(&bytes).is_ok(), "sound");
    for length in 0..bytes.len() {
        let error = result(&bytes[..length]).expect_err("truncated");
        assert!(error.contains("cut off") || error.contains("not a checkpoint"), "{length}: {error}");
    }
    for at in 0..bytes.len() {
        let mut other = bytes.clone();
        other[at] ^= 1 << (at % 8);
        assert!(result(&other).is_err(), "byte {at}");
    }
    let longer = [&bytes[..], &[0]].concat();
    assert!(result(&longer).is_err(), "a byte more");
}

#[test]
fn lengths_that_lie_take_no_memory() {
    // A file of a few bytes that promises the most there can be, with a checksum that is right.
    for (head, arrays) in [(u32::MAX, 0_u64), (0, u64::MAX), (2, 1 << 60)] {
        let mut bytes = b"SPECSUMS\x01\0\0\0".to_vec();
        bytes.extend(head.to_le_bytes());
        bytes.extend(arrays.to_le_bytes());
        bytes.extend([0; 40]);
        assert!(begin(&bytes).is_err(), "{head}, {arrays}");
    }
}

/// The scene file that the program is run with.
fn write_scene(desk: &Desk, spp: u32) {
    let text = room(&format!("integrator = \"path\"\nspp = {spp}"));
    let text = text.replace("width = 37", "width = 120").replace("height = 21", "height = 80");
    std::fs::write(desk.path("a.toml"), text).expect("a scene");
}

const KEPT: [&str; 9] =
    ["render", "a.toml", "-o", "b.exr", "--checkpoint", "a.ckpt", "--checkpoint-every", "150ms", "--resume"];

#[test]
fn a_dozen_kills_at_any_time_leave_the_picture_as_it_is() {
    let desk = Desk::new();
    write_scene(&desk, 2048);
    let (status, _, said) = desk.run(&["render", "a.toml", "-o", "a.exr"]);
    assert_eq!(status, 0, "{said}");
    let mut random = random::Random::new(7);
    let (mut kills, mut goes_on) = (0, 0);
    for _ in 0..12 {
        let mut child = spawn(&desk, &KEPT);
        std::thread::sleep(Duration::from_secs_f32(0.1 + 0.5 * random.unit()));
        if child.try_wait().expect("known").is_some() {
            break;
        }
        child.kill().expect("killed");
        child.wait().expect("ended");
        kills += 1;
        goes_on += usize::from(desk.path("a.ckpt").exists());
        assert!(!desk.path("b.exr").exists(), "no picture before it is done");
    }
    let (status, _, said) = desk.run(&KEPT);
    assert_eq!(status, 0, "{said}");
    println!("{kills} kills, {goes_on} with a checkpoint\n{said}");
    assert_eq!(desk.names(), ["a.exr", "a.toml", "b.exr"], "killed writers leave nothing");
    assert!(kills >= 3 && goes_on >= 1, "{kills} kills, {goes_on} with a checkpoint");
    assert!(desk.channels("a.exr") == desk.channels("b.exr"), "to the bit");
    assert!(!desk.path("a.ckpt").exists(), "the checkpoint is gone");
}

#[cfg(unix)]
#[test]
fn signals_leave_a_checkpoint_and_status_130() {
    let desk = Desk::new();
    write_scene(&desk, 1024);
    let (status, _, said) = desk.run(&["render", "a.toml", "-o", "a.exr"]);
    assert_eq!(status, 0, "{said}");
    for signal in ["-TERM", "-INT"] {
        let mut child = spawn(&desk, &KEPT);
        wait_for("a checkpoint", Duration::from_secs(60), || desk.path("a.ckpt").exists());
        std::fs::remove_file(desk.path("a.ckpt")).expect("there");
        running::signal(&child, signal);
        assert_eq!(child.wait().expect("ended").code(), Some(130), "{signal}");
        assert!(desk.path("a.ckpt").exists(), "{signal}: a checkpoint");
        let temporary = desk.names().into_iter().filter(|name| name.ends_with(".tmp")).count();
        assert_eq!(temporary, 0, "{signal}: nothing half-written");
        let (status, _, said) = desk.run(&KEPT);
        assert!(status == 0 && said.contains("going on from"), "{signal}: {status}: {said}");
        assert!(desk.channels("a.exr") == desk.channels("b.exr"), "{signal}: to the bit");
        std::fs::remove_file(desk.path("b.exr")).expect("there");
    }
}

/// The same checkpoint as another version of the program would have written it; versions are equally long.
fn of_version(bytes: &[u8], version: &str, other: &str) -> Vec<u8> {
    let size = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let head = std::str::from_utf8(&bytes[28..28 + size]).expect("JSON");
    let [version, other] = [version, other].map(|version| format!("\"version\":\"{version}\""));
    assert_eq!(head.matches(&version).count(), 1, "{head}");
    let head = head.replace(&version, &other);
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&bytes[..24]);
    hasher.update(head.as_bytes());
    [&bytes[..24], &hasher.finalize().to_le_bytes(), head.as_bytes(), &bytes[28 + size..]].concat()
}

/// Has the program leave a checkpoint on the desk.
#[cfg(unix)]
fn leave(desk: &Desk) {
    let mut child = spawn(desk, &KEPT);
    wait_for("a checkpoint", Duration::from_secs(60), || desk.path("a.ckpt").exists());
    child.kill().expect("killed");
    child.wait().expect("ended");
}

#[cfg(unix)]
#[test]
fn checkpoints_of_anything_else_are_refused_and_the_difference_is_named() {
    let desk = Desk::new();
    write_scene(&desk, 8192);
    leave(&desk);
    let kept = std::fs::read(desk.path("a.ckpt")).expect("there");
    let refused = |more: &[&str], told: &str| {
        let words: Vec<&str> = KEPT.iter().chain(more).copied().collect();
        let (status, _, said) = desk.run(&words);
        assert_eq!(status, 2, "{more:?}: {said}");
        assert!(said.contains(told) && said.contains("a.ckpt"), "{more:?}: {said}");
        assert_eq!(said.matches("of another picture").count(), 1, "{more:?}: nothing else differs: {said}");
        assert!(std::fs::read(desk.path("a.ckpt")).expect("there") == kept, "{more:?}: untouched");
    };
    refused(&["--spp", "8193"], "`scene.render.spp` is 8192 there and 8193 here");
    refused(&["-D", "materials.wall.reflectance=0.5"], "`scene.materials.");
    refused(&["--seed", "3"], "`scene.render.seed` is 0 there and 3 here");
    refused(&["--aov", "depth"], "`outputs` is ");
    refused(&["--target-error", "0.001"], "`target_error` is nothing there and 0.001 here");
    refused(&["--slice", "1/2", "-o", "c.part"], "`slice` is nothing there and \"1/2\" here");
    refused(&["--crop", "0,0,9,9"], "`crop` is ");
    refused(&["--no-specialise=pruning"], "`pruning` is nothing there and false here");
    if specula::render::lanes() != "portable" {
        let output = desk.command().args(KEPT).env("SPECULA_ISA", "portable").output().expect("run");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        let told =
            format!("`instruction_set` is \"{}\" there and \"portable\" here", specula::render::lanes());
        assert!(said.contains(&told), "{said}");
        assert!(said.contains("`backend` is \"embree ") && said.contains(", sse4.2\" here"), "{said}");
        assert_eq!(said.matches("of another picture").count(), 2, "nothing else differs: {said}");
        assert!(std::fs::read(desk.path("a.ckpt")).expect("there") == kept, "untouched");
    } else {
        println!("skipped: there are no lanes but portable ones");
    }
    let version = env!("CARGO_PKG_VERSION");
    let other = version.replace(|c: char| c.is_ascii_digit(), "7");
    std::fs::write(desk.path("a.ckpt"), of_version(&kept, version, &other)).expect("written");
    let (status, _, said) = desk.run(&KEPT);
    assert!(
        status == 2 && said.contains(&format!("`version` is \"{other}\" there and \"{version}\" here")),
        "{said}"
    );
    assert_eq!(said.matches("of another picture").count(), 1, "nothing else differs: {said}");
    std::fs::write(desk.path("a.ckpt"), &kept).expect("written");
    let (status, _, said) = desk.run(&KEPT[..8]);
    assert!(status == 2 && said.contains("--resume"), "without --resume: {status}: {said}");
    std::fs::write(desk.path("a.ckpt"), "something else").expect("written");
    let (status, _, said) = desk.run(&KEPT);
    assert!(status == 2 && said.contains("not a checkpoint"), "another file: {status}: {said}");
    std::fs::write(desk.path("a.ckpt"), &kept[..kept.len() - 1]).expect("written");
    let (status, _, said) = desk.run(&KEPT);
    assert!(status == 2 && said.contains("cut off"), "truncated: {status}: {said}");
    let (status, _, said) =
        desk.run(&["render", "none.toml", "-o", "a.exr", "--checkpoint", "b.ckpt", "--aov", "gbuffer"]);
    assert!(status == 2 && said.contains("`--checkpoint` beside the output `gbuffer`"), "{status}: {said}");
    for flags in [&["--resume"][..], &["--checkpoint-every", "3s"]] {
        let words: Vec<&str> = ["render", "a.toml"].iter().chain(flags).copied().collect();
        let (status, _, said) = desk.run(&words);
        assert!(status == 2 && said.contains("--checkpoint FILE"), "{flags:?}: {status}: {said}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn full_and_read_only_disks_are_told_and_nothing_is_half_written() {
    for (options, told) in [("size=16k", "No space left"), ("ro", "Read-only")] {
        let desk = Desk::new();
        write_scene(&desk, 512);
        let Some(disk) = disk::Mounted::new(&desk, options) else {
            eprintln!("skipped: no file system may be mounted");
            return;
        };
        let files = || std::fs::read_dir(&disk.0).expect("there").count();
        let (status, _, said) = desk.run(&["render", "a.toml", "--spp", "1", "-o", "disk/a.exr"]);
        assert!(status == 1 && said.contains(told) && said.contains("disk/a.exr"), "{status}: {said}");
        let (status, _, said) = desk.run(&["render", "a.toml", "--spp", "1", "-o", "disk/a.part"]);
        assert!(status == 1 && said.contains(told) && said.contains("disk/a.part"), "{status}: {said}");
        assert_eq!(files(), 0, "{options}: nothing");
        // A picture is made all the same where checkpoints cannot be written.
        let words =
            ["render", "a.toml", "-o", "a.exr", "--checkpoint", "disk/a.ckpt", "--checkpoint-every", "100ms"];
        let (status, _, said) = desk.run(&words);
        assert!(status == 0 && said.contains(told) && said.contains("goes on"), "{status}: {said}");
        assert!(desk.path("a.exr").exists() && files() == 0, "{options}: the picture alone");
        // Whoever asks to stop learns that nothing was kept.
        let mut child = spawn(&desk, &[&words[..], &["--spp", "100000"]].concat());
        std::thread::sleep(Duration::from_millis(800));
        running::signal(&child, "-TERM");
        assert_eq!(child.wait().expect("ended").code(), Some(1), "{options}: no checkpoint, not 130");
    }
}

/// A checkpoint is JSON and arrays: what it is of can be read without the picture.
#[test]
fn what_a_checkpoint_is_of_can_be_read() {
    let (_, _, bytes) = small();
    let checkpoint = Checkpoint::open(&bytes[..], bytes.len() as u64).expect("sound");
    assert_eq!(checkpoint.about(), &json!({ "of": "a test" }), "as written");
    let _: &Value = checkpoint.about();
}
