//! Meshes and pictures that have been read, kept for the scenes to come.
//!
//! What is kept is found again by the file, by what was made of it, and by whether the file, and those that it names, are still the same:
//! by size, time and number of the file, where hashing would read as much as was saved. Above a limit of bytes, what was not asked for
//! longest goes. Who holds a thing keeps it, whatever the library does.

use crate::error::{Error, Place, Result};
use crate::scene::description::Normals;
use crate::scene::identity;
use crate::texture::Space;
use crate::trust::{Excess, Limit, Trust};
use std::any::Any;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// Things read from files, shared by all who use it, from several threads at once.
#[derive(Debug, Default)]
pub struct Library {
    shelf: Mutex<Shelf>,
    /// Bytes that are kept at most.
    limit: AtomicU64,
    reads: AtomicU64,
    hashed: AtomicU64,
    shared: AtomicU64,
}

/// How often files were read, and how often that was saved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reads {
    /// Files that were read and made into something.
    pub read: u64,
    /// What was there already.
    pub shared: u64,
    /// Files that were read for digits of what they hold.
    pub hashed: u64,
}

/// What a file was made into: the same file may be on the shelf in several forms. Numbers by their bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Form {
    /// A mesh: normals, the angle of creases, and whether it is counted from its middle.
    Mesh(Normals, u32, bool),
    /// A picture on surfaces, and what its numbers stand for.
    Bitmap(Option<Space>),
    /// A sky: its factor, and how it is turned.
    Sky(u32, u32),
    /// Numbers for heights.
    Heights,
    /// Digits that stand for what the file holds.
    Digits,
}

#[derive(Debug, Default)]
struct Shelf {
    slots: HashMap<(PathBuf, Form), Arc<Slot>>,
    /// Counts requests, to know what was not asked for longest.
    clock: u64,
    /// Bytes of all that is kept.
    bytes: u64,
}

/// A place for a thing. Whoever reads the file holds `kept`, and others who want it wait.
#[derive(Debug, Default)]
struct Slot {
    kept: Mutex<Option<Kept>>,
    asked: AtomicU64,
}

#[derive(Debug)]
struct Kept {
    thing: Arc<dyn Any + Send + Sync>,
    bytes: u64,
    /// What it asks of limits.
    takes: (Limit, u64),
    /// The files that it was made of, as they were before they were read.
    of: Vec<(PathBuf, Stamp)>,
}

impl Kept {
    /// Refuses it to those who may not read its files, among them the one at `path` as they call it, or may not have so much.
    fn check(&self, path: &Path, trust: &Trust) -> Result<()> {
        let (limit, found) = self.takes;
        let too_much = |excess: Excess| Error::Refused(excess.at(Place::file(path)));
        trust.limits.check(limit, found).map_err(too_much)?;
        trust.check(path)?;
        self.of.iter().try_for_each(|(path, _)| trust.check(path))
    }
}

/// What tells a file from another one in its place; nothing of one that is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp(Option<(u64, Option<SystemTime>, Number)>);

/// Device, number, and when the file or what is said of it changed last.
#[cfg(unix)]
type Number = (u64, u64, i64, i64);
#[cfg(not(unix))]
type Number = ();

impl Stamp {
    /// Of a file as it is now.
    #[must_use]
    pub fn of(path: &Path) -> Self {
        Self(fs::metadata(path).ok().map(|about| (about.len(), about.modified().ok(), number(&about))))
    }
}

#[cfg(unix)]
fn number(about: &fs::Metadata) -> Number {
    use std::os::unix::fs::MetadataExt as _;
    (about.dev(), about.ino(), about.ctime(), about.ctime_nsec())
}

#[cfg(not(unix))]
fn number(_about: &fs::Metadata) -> Number {}

/// Something made of files.
#[derive(Debug)]
pub(super) struct Made<T> {
    pub(super) thing: T,
    /// Bytes of memory that it takes.
    pub(super) bytes: usize,
    /// What it asks of limits, which was allowed when it was made.
    pub(super) takes: (Limit, u64),
    /// Files besides the one asked for, as they were before they were read.
    pub(super) more: Vec<(PathBuf, Stamp)>,
}

impl Library {
    /// A library that keeps so many bytes at most; a larger thing is not kept.
    #[must_use]
    pub fn of_bytes(limit: u64) -> Self {
        Self { limit: limit.into(), ..Self::default() }
    }

    /// Keeps so many bytes at most from now on.
    pub fn limit_to(&self, bytes: u64) {
        self.limit.store(bytes, Ordering::Relaxed);
        self.make_room(&mut self.shelf());
    }

    /// How often files were read.
    #[must_use]
    pub fn reads(&self) -> Reads {
        let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        Reads { read: count(&self.reads), shared: count(&self.shared), hashed: count(&self.hashed) }
    }

    /// Bytes of all that is kept.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.shelf().bytes
    }

    /// 32 hexadecimal digits that stand for what a file holds, as [`identity`](super::identity()) has them.
    pub(super) fn digits(&self, path: &Path, trust: &Trust) -> Result<String> {
        let digits = self.thing(path, Form::Digits, trust, || {
            let (thing, length) = identity::digits(path, trust)?;
            let bytes = thing.len() + path.as_os_str().len() + 256;
            Ok(Made { bytes, takes: (Limit::Bytes, length), thing, more: vec![] })
        })?;
        Ok((*digits).clone())
    }

    /// What the file at `path` makes in that form: what is kept of it, if no file has changed, else what `read` makes.
    ///
    /// What several threads ask for at the same time is read once. Fails with [`Error::Refused`] where what is kept is more than those who ask
    /// may have, or of files that they may not read; `read` is to see to that itself.
    pub(super) fn thing<T: Any + Send + Sync>(
        &self,
        path: &Path,
        form: Form,
        trust: &Trust,
        read: impl FnOnce() -> Result<Made<T>>,
    ) -> Result<Arc<T>> {
        let key = (path.canonicalize().unwrap_or_else(|_| path.to_owned()), form);
        let slot = {
            let mut shelf = self.shelf();
            shelf.clock += 1;
            let slot = shelf.slots.entry(key.clone()).or_default().clone();
            slot.asked.store(shelf.clock, Ordering::Relaxed);
            slot
        };
        let mut kept = slot.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = &*kept
            && known.of.iter().all(|(path, stamp)| Stamp::of(path) == *stamp)
            && let Ok(thing) = known.thing.clone().downcast::<T>()
        {
            known.check(path, trust)?;
            if form != Form::Digits {
                self.shared.fetch_add(1, Ordering::Relaxed);
            }
            return Ok(thing);
        }
        let gone = kept.take().map_or(0, |old| old.bytes);
        let stamp = Stamp::of(path);
        let made = read();
        let counter = if form == Form::Digits { &self.hashed } else { &self.reads };
        counter.fetch_add(1, Ordering::Relaxed);
        let bytes = made.as_ref().map_or(0, |made| made.bytes as u64);
        let mut shelf = self.shelf();
        shelf.bytes = shelf.bytes.saturating_sub(gone);
        // It may have gone meanwhile, and another one may be in its place.
        let place = shelf.slots.entry(key.clone()).or_insert_with(|| slot.clone());
        let is_placed = Arc::ptr_eq(place, &slot);
        if made.is_err() || bytes > self.limit.load(Ordering::Relaxed) || !is_placed {
            if is_placed {
                shelf.slots.remove(&key);
            }
            return made.map(|made| Arc::new(made.thing));
        }
        made.map(|Made { thing, takes, more, .. }| {
            let thing = Arc::new(thing);
            let of = std::iter::once((path.to_owned(), stamp)).chain(more).collect();
            *kept = Some(Kept { thing: thing.clone(), bytes, takes, of });
            shelf.bytes += bytes;
            self.make_room(&mut shelf);
            thing
        })
    }

    fn shelf(&self) -> MutexGuard<'_, Shelf> {
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Gives up what was not asked for longest, until the rest is within the limit.
    fn make_room(&self, shelf: &mut Shelf) {
        let limit = self.limit.load(Ordering::Relaxed);
        if shelf.bytes <= limit {
            return;
        }
        let mut by_age: Vec<_> = shelf.slots.iter().map(|(key, slot)| (key.clone(), slot.clone())).collect();
        by_age.sort_by_key(|(_, slot)| slot.asked.load(Ordering::Relaxed));
        for (key, slot) in by_age {
            if shelf.bytes <= limit {
                return;
            }
            // One that is being read is wanted.
            let Ok(mut kept) = slot.kept.try_lock() else { continue };
            if let Some(old) = kept.take() {
                shelf.bytes = shelf.bytes.saturating_sub(old.bytes);
            }
            shelf.slots.remove(&key);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Problem;
    use crate::trust::{Limits, Sandbox};
    use std::thread;

    fn read(library: &Library, path: &Path, form: Form) -> Vec<u8> {
        let made = || {
            let thing = fs::read(path).map_err(|_| Problem::new("cannot read"))?;
            let takes = (Limit::Bytes, thing.len() as u64);
            let more = path.with_extension("more");
            Ok(Made { bytes: thing.len(), takes, thing, more: vec![(more.clone(), Stamp::of(&more))] })
        };
        let thing: Result<Arc<Vec<u8>>> = library.thing(path, form, &Trust::default(), made);
        thing.map(|thing| thing.to_vec()).unwrap_or_default()
    }

    #[test]
    fn files_are_read_once_until_they_change() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        fs::write(&path, b"one").expect("written");
        let library = Library::of_bytes(100);
        let reads = || (library.reads().read, library.reads().shared);
        assert_eq!(read(&library, &path, Form::Heights), b"one", "read");
        assert_eq!(read(&library, &folder.path().join("./a"), Form::Heights), b"one", "by another name");
        assert_eq!(reads(), (1, 1), "once");
        assert_eq!(read(&library, &path, Form::Sky(0, 0)), b"one", "in another form");
        assert_eq!(reads(), (2, 1), "each form");
        fs::write(&path, b"two").expect("written");
        assert_eq!(read(&library, &path, Form::Heights), b"two", "another file");
        fs::write(path.with_extension("more"), b"").expect("written");
        assert_eq!(read(&library, &path, Form::Heights), b"two", "a file that it names is there now");
        assert_eq!((reads(), library.bytes()), ((4, 1), 6), "again");
        fs::remove_file(&path).expect("removed");
        assert_eq!(read(&library, &path, Form::Heights), b"", "none");
        assert_eq!(library.bytes(), 3, "what is left is the other form");
    }

    #[test]
    fn a_file_that_was_replaced_while_others_were_read_is_read_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let [path, more] = ["a", "b"].map(|name| folder.path().join(name));
        let library = Library::of_bytes(100);
        let ask = |next: &str| {
            let made = || {
                let (stamp, thing) = (Stamp::of(&more), fs::read_to_string(&more).unwrap_or_default());
                fs::write(&more, next).expect("written");
                Ok(Made { bytes: 1, takes: (Limit::Bytes, 1), thing, more: vec![(more.clone(), stamp)] })
            };
            library.thing(&path, Form::Heights, &Trust::default(), made).expect("made").to_string()
        };
        assert_eq!(["one", "another"].map(ask), ["", "one"], "as it is now");
    }

    #[test]
    fn what_is_kept_is_for_those_who_may_have_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        fs::write(&path, b"three").expect("written");
        fs::write(path.with_extension("more"), b"much more").expect("written");
        let library = Library::of_bytes(100);
        assert_eq!(read(&library, &path, Form::Heights), b"three", "read");
        let ask = |trust: Trust| {
            let none = || Err(Problem::new("read again").into());
            library.thing::<Vec<u8>>(&path, Form::Heights, &trust, none).map(|thing| thing.len())
        };
        let of = |most| Trust { limits: Limits::default().with(Limit::Bytes, Some(most)), sandbox: None };
        assert_eq!(ask(of(9)).expect("there"), 5, "within limits");
        assert!(matches!(ask(of(8)), Err(Error::Refused(_))), "a file that it names has more");
        assert!(matches!(ask(of(4)), Err(Error::Refused(_))), "it has more");
        let inside = |folder: &Path| Trust { sandbox: Some(Sandbox::new(folder)), ..Trust::default() };
        assert_eq!(ask(inside(folder.path())).expect("there"), 5, "in the folder");
        assert!(matches!(ask(inside(&folder.path().join("b"))), Err(Error::Refused(_))), "outside");
    }

    #[test]
    fn what_was_not_asked_for_longest_goes_first() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        for (name, bytes) in [("a", 4), ("b", 4), ("c", 4), ("large", 11)] {
            fs::write(path(name), vec![0; bytes]).expect("written");
        }
        let library = Library::of_bytes(10);
        let ask = |name: &str| {
            let before = library.reads().read;
            read(&library, &path(name), Form::Heights);
            library.reads().read - before
        };
        assert_eq!(["a", "b", "a", "c"].map(ask), [1, 1, 0, 1], "b is the oldest when c comes");
        assert_eq!(["a", "c", "b"].map(ask), [0, 0, 1], "b went");
        assert_eq!(["large", "large"].map(ask), [1, 1], "too large to be kept");
        assert!(library.bytes() <= 10, "{}", library.bytes());
        library.limit_to(0);
        assert_eq!(library.bytes(), 0, "nothing");
    }

    #[test]
    fn threads_that_ask_together_read_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        fs::write(&path, vec![7; 1000]).expect("written");
        let library = Library::of_bytes(10_000);
        thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| assert_eq!(read(&library, &path, Form::Heights).len(), 1000, "whole"));
            }
        });
        assert_eq!(library.reads(), Reads { read: 1, shared: 7, hashed: 0 }, "once");
    }
}
