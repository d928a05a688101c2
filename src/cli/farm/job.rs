//! What is farmed out, whatever the engine.

use std::path::{Path, PathBuf};

use serde_json::json;
use xxhash_rust::xxh3::xxh3_64;

use crate::cli::frozen::Frozen;
use crate::cli::kept;
use crate::cli::options::{FarmOptions, trust_words};
use crate::error::Result;
use crate::image::Window;
use crate::render::{self, Checkpoint, Outline, PartFile, Settings, Slice};
use crate::scene::Library;
use crate::trust::Trust;

/// A picture in slices.
#[derive(Debug)]
pub(super) struct Job<'a> {
    pub(super) options: &'a FarmOptions,
    /// How many slices.
    pub(super) slices: u32,
    /// Those whose parts are not there yet, in their order.
    pub(super) missing: Vec<u32>,
    /// Files of parts and checkpoints that are damaged: nothing can be made of them, and they would stand in the way of new ones.
    pub(super) damaged: Vec<PathBuf>,
    /// What tells its scene from others.
    pub(super) scene_hash: String,
    /// What tells its parts from those of other pictures.
    digest: String,
}

/// How many slices, where nobody says.
const SLICES: u32 = 8;

impl<'a> Job<'a> {
    /// The picture of these options. Reads the scene with all that it names, so that what cannot be rendered or cut is known
    /// before anything is queued.
    pub(super) fn new(options: &'a FarmOptions) -> Result<Self> {
        let picture = &options.picture;
        let frozen = Frozen::told(&picture.scene, &picture.overrides, picture.wanted(), &picture.trust)?;
        picture.spare(&frozen.inputs)?;
        let scene = &frozen.scene;
        let of = options.slices.unwrap_or_else(|| SLICES.min(scene.render.spp()));
        let settings = |index: u32| Settings {
            crop: options.picture.crop,
            layout: options.picture.layout.clone(),
            slice: Some(Slice { index, of }),
            ..Settings::default()
        };
        let about = kept::about(&options.picture, &frozen, &Library::default())?;
        let corners = options.picture.crop.map(Window::corners);
        let digest = xxh3_64(json!([about, corners, of]).to_string().as_bytes());
        let mut job = Self {
            options,
            slices: of,
            missing: Vec::new(),
            damaged: Vec::new(),
            scene_hash: frozen.hash.clone(),
            digest: format!("{:08x}", digest >> 32),
        };
        for slice in 0..of {
            let outline = render::outline(scene, &settings(slice))?;
            if !job.is_there(slice, &outline, &about) {
                job.missing.push(slice);
            }
        }
        job.look_at_checkpoints();
        Ok(job)
    }

    /// Whether a part is there and sound: `merge` refuses what is not.
    fn is_there(&mut self, slice: u32, outline: &Outline, about: &serde_json::Value) -> bool {
        let path = self.part(slice);
        let Ok((file, length)) = kept::open(&path) else { return false };
        let looked = PartFile::open(file, length).and_then(|part| {
            let is_wanted = part.outline() == outline && part.about() == about;
            if is_wanted { part.check().map(|()| true) } else { Ok(false) }
        });
        looked.unwrap_or_else(|what| {
            tracing::warn!("{}: {what}; slice {slice} is rendered again", path.display());
            self.damaged.push(path);
            false
        })
    }

    /// Finds checkpoints of missing slices that are damaged: tasks would be refused to go on from them.
    fn look_at_checkpoints(&mut self) {
        let entries = std::fs::read_dir(&self.options.dir).into_iter().flatten().flatten();
        for path in entries.map(|entry| entry.path()) {
            if let Some(slice) = self.slice_of(&path)
                && let Ok((file, length)) = kept::open(&path)
                && let Err(what) = Checkpoint::open(file, length).and_then(Checkpoint::check)
            {
                tracing::warn!("{}: {what}; slice {slice} is begun anew", path.display());
                self.damaged.push(path);
            }
        }
    }

    /// Of which missing slice a file is a checkpoint, if it is one.
    fn slice_of(&self, path: &Path) -> Option<u32> {
        let name = path.file_name()?.to_str()?;
        let (slice, rest) = name.strip_prefix(&self.stem())?.split_once(".part.")?;
        let slice = slice.parse().ok().filter(|slice| self.missing.contains(slice))?;
        rest.ends_with(".ckpt").then_some(slice)
    }

    /// The word for the merge that says what parts may ask for, where that is not as usual.
    pub(super) fn limits(&self) -> Option<String> {
        let limits = self.options.picture.trust.limits;
        trust_words(&Trust { limits, sandbox: None }).pop()
    }

    /// The names of the parts, up to the number of the slice.
    pub(super) fn stem(&self) -> String {
        format!("part-{}-", self.digest)
    }

    /// The file of a part.
    pub(super) fn part(&self, slice: u32) -> PathBuf {
        self.options.dir.join(format!("{}{slice}.part", self.stem()))
    }

    /// A name for lists of jobs: that of the scene, without what may mean something to an engine.
    pub(super) fn name(&self) -> String {
        let stem = self.options.scene.file_stem().unwrap_or_default().to_string_lossy();
        let plain = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
        let name: String = stem.chars().map(plain).take(64).collect();
        if name.is_empty() { "specula".to_owned() } else { name }
    }

    /// The slices to render, as both engines write lists of numbers: `0-3,6`.
    pub(super) fn range(&self) -> String {
        ranges(&self.missing)
    }
}

/// Ascending numbers as ranges.
fn ranges(numbers: &[u32]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let run = |run: &[u32]| match *run {
        [only] => only.to_string(),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    };
    runs.map(run).collect::<Vec<_>>().join(",")
}

/// Lines of a POSIX shell that name the checkpoint of `$part` as `$checkpoint`: one for each version, instruction set and Embree that
/// `$program` tells, since checkpoints go on with the same ones only, and an engine may send a task elsewhere.
pub(super) const CHECKPOINT: &str = r#"kind=$("$program" --version | cksum)
checkpoint=$part.${kind%% *}.ckpt"#;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_become_ranges() {
        assert_eq!(ranges(&[0, 1, 2, 3]), "0-3", "all");
        assert_eq!(ranges(&[0, 2, 3, 5]), "0,2-3,5", "gaps");
        assert_eq!(ranges(&[]), "", "none");
    }
}
