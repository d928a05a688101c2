//! Who may take how much memory.

use std::fs;
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::bench::machine;
use crate::cli::options::RenderOptions;
use crate::error::{Error, Result};
use crate::geometry::Shape;
use crate::image::Window;
use crate::render::Rendered;
use crate::scene::{self, Library, Loaded, Scene};

/// What the library may keep where nothing is known of the memory: 2 GiB.
const UNKNOWN: u64 = 2 << 30;

/// Bytes that files may be kept in where nobody says.
pub(in crate::cli) fn half_of_free() -> u64 {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let host = machine::bytes(&read("/proc/meminfo"), "MemAvailable");
    let group = left_by_groups(Path::new("/sys/fs/cgroup"), &read("/proc/self/cgroup"));
    host.into_iter().chain(group).min().map_or(UNKNOWN, |bytes| bytes / 2)
}

/// Bytes that limits of control groups leave, of the group that Linux names and those above it (version 2, mounted at `root`); files that
/// are cached for nobody count as free, as they do for the host.
fn left_by_groups(root: &Path, named: &str) -> Option<u64> {
    let name = named.lines().find_map(|line| line.strip_prefix("0::"))?;
    let left = |group: &Path| {
        let read = |file: &str| fs::read_to_string(group.join(file)).ok();
        let number = |file: &str| read(file)?.trim().parse::<u64>().ok();
        let cached = read("memory.stat").and_then(|text| {
            let line = text.lines().find_map(|line| line.strip_prefix("inactive_file "))?;
            line.trim().parse::<u64>().ok()
        });
        let used = number("memory.current")?.saturating_sub(cached.unwrap_or(0));
        Some(number("memory.max")?.saturating_sub(used))
    };
    let own = root.join(name.trim_start_matches('/'));
    own.ancestors().take_while(|group| group.starts_with(root)).filter_map(left).min()
}

/// Lets pictures in while there is memory for them; one that finds nobody is let in whatever it takes. What they leave may be used to keep
/// files in, a quarter in any case.
#[derive(Debug)]
pub(super) struct Gate {
    limit: Option<u64>,
    used: Mutex<u64>,
    left: Condvar,
    library: Arc<Library>,
}

/// Memory that somebody may use, until this goes.
#[derive(Debug)]
pub(super) struct Pass<'a> {
    gate: &'a Gate,
    bytes: u64,
}

impl Gate {
    pub(super) fn new(limit: Option<u64>, library: Arc<Library>) -> Self {
        let gate = Self { limit, used: Mutex::new(0), left: Condvar::new(), library };
        gate.library.limit_to(limit.unwrap_or_else(half_of_free));
        gate
    }

    /// Waits until there are so many bytes, or nobody. Fails if it is asked to stop meanwhile.
    pub(super) fn pass(&self, bytes: u64, is_cancelled: impl Fn() -> bool) -> Result<Pass<'_>> {
        let mut used = self.used();
        while *used > 0 && self.limit.is_some_and(|limit| used.saturating_add(bytes) > limit) {
            if is_cancelled() {
                return Err(Error::Interrupted);
            }
            let waited = self.left.wait_timeout(used, Duration::from_millis(100));
            used = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        // Nothing is not nobody.
        let bytes = bytes.max(1);
        *used += bytes;
        self.share(*used);
        Ok(Pass { gate: self, bytes })
    }

    fn share(&self, used: u64) {
        if let Some(limit) = self.limit {
            self.library.limit_to(limit.saturating_sub(used).max(limit / 4));
        }
    }

    fn used(&self) -> MutexGuard<'_, u64> {
        self.used.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Pass<'_> {
    #[cfg(test)]
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Is for so many bytes from now on, if there are as many without waiting, or nobody else; whether it is.
    pub(super) fn resize(&mut self, bytes: u64) -> bool {
        let bytes = bytes.max(1);
        let mut used = self.gate.used();
        let others = used.saturating_sub(self.bytes);
        let all = others.saturating_add(bytes);
        if others > 0 && bytes > self.bytes && self.gate.limit.is_some_and(|limit| all > limit) {
            return false;
        }
        (*used, self.bytes) = (all, bytes);
        self.gate.share(*used);
        self.gate.left.notify_all();
        true
    }
}

impl Drop for Pass<'_> {
    fn drop(&mut self) {
        let mut used = self.gate.used();
        *used = used.saturating_sub(self.bytes);
        self.gate.share(*used);
        self.gate.left.notify_all();
    }
}

/// Bytes that a pixel takes, about: sums, and the picture while it is written.
const PIXEL: u64 = 160;

/// The same for each further output.
const OUTPUT: u64 = 60;

/// Bytes that the sums and the picture of these options take, about; twice where copies are kept.
pub(super) fn of_film(options: &RenderOptions, [width, height]: [u32; 2]) -> u64 {
    let window = options.crop.unwrap_or(Window::whole(width, height));
    let pixel = PIXEL + OUTPUT * options.layout.aovs().len() as u64;
    let copies = if options.checkpoint.is_some() { 2 } else { 1 };
    (window.area() as u64).saturating_mul(pixel * copies)
}

/// Bytes that a scene takes that has not been read yet, by its files: rather more than less. In memory a triangle is 50 bytes, twice that
/// where it is carried to its place, and 100 in a hierarchy.
pub(super) fn of_files(loaded: &Loaded) -> u64 {
    let bytes = |path: &Path| {
        let size = fs::metadata(path).map_or(0, |about| about.len());
        let extension = path.extension().and_then(|it| it.to_str()).unwrap_or("").to_ascii_lowercase();
        let pixels = || image::image_dimensions(path).ok().map(|(w, h)| u64::from(w) * u64::from(h));
        match extension.as_str() {
            "obj" => size * 4,
            "ply" => size * 9,
            "png" | "jpg" | "jpeg" => pixels().map_or(size * 4, |pixels| pixels * 6),
            "hdr" => pixels().map_or(size * 4, |pixels| pixels * 24),
            _ => size * 4,
        }
    };
    scene::files(&loaded.description, &[]).iter().map(|path| bytes(path)).fold(0, u64::saturating_add)
}

/// Bytes that a scene took: shapes, pictures on them, and the hierarchy.
pub(super) fn of_scene(scene: &Scene, rendered: &Rendered) -> u64 {
    let shape = |shape: &Shape| if let Shape::Mesh(mesh) = shape { mesh.bytes() } else { 0 };
    let shapes: usize = scene.world.shapes.iter().map(shape).sum();
    // Meshes as they were read are kept beside those that were carried to their place.
    (2 * shapes + scene.texture_bytes() + rendered.statistics.hierarchy_bytes) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::thread;

    #[test]
    fn no_more_pass_than_fit_and_who_is_too_large_goes_alone() {
        let gate = Gate::new(Some(10), Arc::default());
        let (now, most) = (AtomicU64::new(0), AtomicU64::new(0));
        thread::scope(|scope| {
            for bytes in [4, 4, 4, 25, 3, 10, 0, 6] {
                let (gate, now, most) = (&gate, &now, &most);
                scope.spawn(move || {
                    let pass = gate.pass(bytes, || false).expect("a pass");
                    let all = now.fetch_add(bytes, Ordering::SeqCst) + bytes;
                    most.fetch_max(if bytes > 10 { all - 15 } else { all }, Ordering::SeqCst);
                    thread::sleep(Duration::from_millis(5));
                    now.fetch_sub(bytes, Ordering::SeqCst);
                    drop(pass);
                });
            }
        });
        assert!(most.into_inner() <= 10, "never more than the limit, or one alone");
        assert_eq!(*gate.used(), 0, "all gone");
        let first = gate.pass(8, || false).expect("a pass");
        assert!(matches!(gate.pass(8, || true), Err(Error::Interrupted)), "who waits can be stopped");
        drop(first);
        assert!(gate.pass(8, || true).is_ok(), "who does not wait is not asked");
    }

    #[test]
    fn control_groups_leave_what_the_tightest_one_does() {
        let root = tempfile::tempdir().expect("a folder");
        let own = root.path().join("a/b");
        fs::create_dir_all(&own).expect("made");
        let write = |group: &Path, [max, current]: [&str; 2]| {
            fs::write(group.join("memory.max"), max).expect("written");
            fs::write(group.join("memory.current"), current).expect("written");
        };
        let left = || left_by_groups(root.path(), "1:name=x:/\n0::/a/b\n");
        assert_eq!(left(), None, "nothing is told");
        write(&own, ["max\n", "5\n"]);
        assert_eq!(left(), None, "no limit");
        write(&own, ["1000\n", "400\n"]);
        assert_eq!(left(), Some(600), "the own one");
        write(&root.path().join("a"), ["700\n", "500\n"]);
        assert_eq!(left(), Some(200), "that above it");
        fs::write(root.path().join("a/memory.stat"), "anon 1\ninactive_file 300\n").expect("written");
        assert_eq!(left(), Some(500), "less what is cached");
        assert_eq!(left_by_groups(root.path(), "4:memory:/a/b\n"), None, "not version 2");
    }

    #[test]
    fn a_pass_grows_while_there_is_room_or_nobody_else() {
        let gate = Gate::new(Some(10), Arc::default());
        let mut one = gate.pass(4, || true).expect("a pass");
        assert!(one.resize(30) && *gate.used() == 30, "alone, whatever it takes");
        assert!(one.resize(4) && *gate.used() == 4, "less again");
        let mut other = gate.pass(5, || true).expect("a pass");
        assert!(other.resize(6) && *gate.used() == 10, "as much as there is");
        assert!(!other.resize(7) && !one.resize(5) && *gate.used() == 10, "not more");
        assert!(other.resize(1) && one.resize(9) && *gate.used() == 10, "what another one gave back");
        drop((one, other));
        assert_eq!(*gate.used(), 0, "all gone");
    }
}
