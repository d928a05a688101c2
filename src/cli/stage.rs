//! Where pictures are made one after the other: what one has read and built serves the next.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use serde_json::Value;

use super::cost::{self, Prediction};
use super::frozen::Frozen;
use super::kept::{self, Kept};
use super::options::RenderOptions;
use crate::error::{Error, Problem, Result};
use crate::render::{self, Keeper, Limits, Phase, Progress, Rendered, Settings, Studio};
use crate::scene::{self, Library, Loaded, Stamp};

/// Threads, files that were read, and the last scene.
#[derive(Debug)]
pub(super) struct Stage {
    library: Arc<Library>,
    studio: Studio,
    last: Option<Last>,
    /// Warnings that were given: frames of a sequence have the same.
    told: HashSet<String>,
}

/// The last scene, and the files that it is made of as they were then.
#[derive(Debug)]
struct Last {
    frozen: Frozen,
    files: Vec<(PathBuf, Stamp)>,
}

/// A picture to make.
#[derive(Clone, Copy, Debug)]
pub(super) struct Order<'a> {
    pub(super) options: &'a RenderOptions,
    pub(super) loaded: &'a Loaded,
    /// Since when a limit of time counts.
    pub(super) start: Instant,
    /// Whether a checkpoint that does not fit is given up; else it stops the picture.
    pub(super) is_lenient: bool,
}

/// A picture that was made.
#[derive(Debug)]
pub(super) struct Made<'a> {
    pub(super) rendered: Rendered,
    /// What it is of, where that is to be kept.
    pub(super) about: Value,
    pub(super) settings: Settings,
    /// Reading the scene and its files.
    pub(super) load: Phase,
    /// Copies of it, to be removed when it is written.
    pub(super) kept: Option<Kept<'a>>,
}

impl Stage {
    /// On the threads of this studio, with a library that others may use, too.
    pub(super) fn new(studio: Studio, library: Arc<Library>) -> Self {
        Self { library, studio, last: None, told: HashSet::new() }
    }

    /// Gets the scene of an order ready: what the picture is of, where that is to be kept, and how long it took.
    pub(super) fn load(&mut self, order: &Order<'_>) -> Result<(Value, Phase)> {
        let options = order.options;
        let (about, load) = Phase::of(|| {
            self.freeze(order)?;
            let is_kept = options.checkpoint.is_some() || !options.parts.is_empty();
            if is_kept { kept::about(options, self.frozen()?, &self.library) } else { Ok(Value::Null) }
        });
        Ok((about?, load))
    }

    /// Lets settings be chosen for the scene that was got ready, where somebody is to; the options then have them.
    pub(super) fn settle(
        &mut self,
        options: &mut RenderOptions,
        start: Instant,
        progress: &dyn Progress,
    ) -> Result<Option<Prediction>> {
        let Some(Last { frozen, files }) = self.last.take() else { return Err(gone()) };
        let (frozen, prediction) = cost::settle(options, frozen, start, (&mut self.studio, progress))?;
        self.last = Some(Last { frozen, files });
        Ok(prediction)
    }

    /// Makes a picture of the scene that was got ready for it.
    pub(super) fn make<'a>(
        &mut self,
        order: &Order<'a>,
        (about, load): (Value, Phase),
        progress: &dyn Progress,
    ) -> Result<Made<'a>> {
        let options = order.options;
        if progress.is_cancelled() {
            return Err(Error::Interrupted);
        }
        let Some(Last { frozen, .. }) = &self.last else { return Err(gone()) };
        let of = || (&frozen.scene, about.clone());
        let kept = options.checkpoint.as_ref().map(|it| Kept::new(it, options, of())).transpose()?;
        let begin = kept.as_ref().map_or(Ok(None), |kept| match kept.begin() {
            Err(error) if order.is_lenient => {
                tracing::warn!("{}; beginning anew", super::chain(&error));
                Ok(None)
            }
            begin => begin,
        })?;
        let settings = settings(options, order.start);
        let keeper = kept.as_ref().map(|kept| -> &dyn Keeper { kept });
        let may_begin_anew = order.is_lenient && begin.is_some();
        let mut attempt = |begin| {
            let kept_copies = render::Kept { begin, keeper };
            self.studio.render(&frozen.scene, &settings, progress, kept_copies)
        };
        let rendered = match attempt(begin) {
            // The sums of a checkpoint are read no sooner than here; nothing has been traced yet.
            Err(error @ Error::Input(_)) if may_begin_anew => {
                tracing::warn!("{}; beginning anew", super::chain(&error));
                attempt(None)
            }
            rendered => rendered,
        }?;
        Ok(Made { rendered, about, settings, load, kept })
    }

    /// What it has read of files.
    pub(super) fn library(&self) -> &Library {
        &self.library
    }

    /// The scene of the last picture.
    pub(super) fn frozen(&self) -> Result<&Frozen> {
        self.last.as_ref().map(|last| &last.frozen).ok_or_else(gone)
    }

    /// Whether the scene that is here is that of a file.
    pub(super) fn has(&self, path: &Path) -> bool {
        self.last.as_ref().is_some_and(|last| last.frozen.path == path)
    }

    /// Gives up the last scene.
    pub(super) fn clear(&mut self) {
        self.clear_hierarchy();
        self.last = None;
    }

    /// Gives up the hierarchy of the last scene.
    pub(super) fn clear_hierarchy(&mut self) {
        self.studio.clear();
    }

    /// Gets the scene of an order: the last one, seen otherwise, if that is enough.
    fn freeze(&mut self, order: &Order<'_>) -> Result<()> {
        let (options, loaded) = (order.options, order.loaded);
        let serves = self.last.as_mut().is_some_and(|Last { frozen, files }| {
            frozen.path == options.scene
                && frozen.wanted == options.wanted()
                && frozen.trust == options.trust
                && files.iter().all(|(path, stamp)| Stamp::of(path) == *stamp)
                && frozen.retake(&loaded.description, options.frame)
        });
        if !serves {
            self.clear();
            let of = (options.frame, options.wanted());
            let stamped = |path: PathBuf| (path.clone(), Stamp::of(&path));
            let own = scene::files(&loaded.description, &[]).into_iter();
            let mut files: Vec<_> = own.map(stamped).collect();
            let from = (&options.trust, &self.library);
            let frozen = Frozen::of(loaded.clone(), &options.scene, of, from)?;
            files.extend(frozen.files.iter().cloned().map(stamped));
            self.tell(&frozen.warnings);
            if let Some(line) = frozen.without_effect().filter(|line| self.told.insert(line.clone())) {
                tracing::info!("{line}");
            }
            self.last = Some(Last { frozen, files });
        }
        Ok(())
    }

    /// Logs warnings that are new.
    fn tell(&mut self, warnings: &[Problem]) {
        for warning in warnings.iter().map(ToString::to_string) {
            if !self.told.contains(&warning) {
                tracing::warn!("{warning}");
                self.told.insert(warning);
            }
        }
    }
}

fn gone() -> Error {
    Problem::new("there is no scene").into()
}

/// What the scene does not say. The limit of time began at `start`.
fn settings(options: &RenderOptions, start: Instant) -> Settings {
    Settings {
        threads: options.threads,
        crop: options.crop,
        layout: options.layout.clone(),
        first_pass: options.first_pass,
        slice: options.slice,
        limits: Limits {
            time: options.limits.time.map(|time| time.saturating_sub(start.elapsed())),
            ..options.limits
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Args, Command};
    use clap::Parser as _;
    use std::num::NonZeroUsize;

    #[test]
    fn files_are_hashed_once_for_what_is_kept_of_all_frames() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        image::RgbImage::new(2, 2).save(path("paint.png")).expect("written");
        std::fs::write(path("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
        let scene = "[materials.m]\ntype = 'diffuse'\nreflectance = { file = 'paint.png' }\n[[shapes]]\ntype = 'mesh'\nfile = 'a.obj'\nmaterial = 'm'\n[[shapes]]\ntype = 'sphere'\nmaterial = 'm'\n[[lights]]\ntype = 'environment'\nradiance = 1\n";
        std::fs::write(path("a.toml"), scene).expect("written");
        let words = ["specula", "render", "--frames=1..3"].map(std::ffi::OsString::from).into_iter();
        let flags = [("-o", "a.#.part"), ("--checkpoint", "a.#.ckpt")];
        let flags = flags.iter().flat_map(|(flag, name)| [std::ffi::OsString::from(flag), path(name).into()]);
        let words = words.chain(flags).chain([path("a.toml").into_os_string()]);
        let Command::Render(args) = Args::try_parse_from(words).expect("parsed").command else {
            panic!("another command")
        };
        let options = RenderOptions::new(&args).expect("valid");
        let loaded = scene::load(&options.scene, &options.overrides).expect("a scene");
        let studio = Studio::new(Some(NonZeroUsize::MIN)).expect("a thread");
        let mut stage = Stage::new(studio, Library::of_bytes(1 << 20).into());
        for picture in options.pictures() {
            let order =
                Order { options: &picture, loaded: &loaded, start: Instant::now(), is_lenient: false };
            let (about, _) = stage.load(&order).expect("sound");
            assert_eq!(about["files"].as_object().map(serde_json::Map::len), Some(2), "{about}");
            assert_eq!(stage.library().reads().hashed, 2, "frame {:?}", picture.frame);
        }
    }
}
