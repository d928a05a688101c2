//! What is farmed out, whatever the engine.

use std::path::PathBuf;

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
            scene_hash: frozen.hash.clone(),
            digest: format!("{:08x}", digest >> 32),
        };
        for slice in 0..of {
            let outline = render::outline(scene, &settings(slice))?;
            if !job.is_there(slice, &outline, &about) {
                job.missing.push(slice);
            }
        }
        Ok(job)
    }

    /// Whether a part is there, by what its head says; `merge` looks at the rest.
    fn is_there(&self, slice: u32, outline: &Outline, about: &serde_json::Value) -> bool {
        let Ok((file, length)) = kept::open(&self.part(slice)) else { return false };
        PartFile::open(file, length).is_ok_and(|part| part.outline() == outline && part.about() == about)
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

/// Lines of a POSIX shell that name the checkpoint of `$part` as `$checkpoint`: one for each kind of processor, since checkpoints go on with
/// the same instruction set only, and an engine may send a task elsewhere.
pub(super) const CHECKPOINT: &str = r#"kind=$({ echo "${SPECULA_ISA:-}"; grep -m 1 '^flags' /proc/cpuinfo; } | cksum)
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
