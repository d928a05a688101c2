//! Scenes as commands take them: read and frozen, with what there is to tell of them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value;

use super::{log, plan};
use crate::error::{Place, Problem, Result};
use crate::scene::{self, Built, Description, Library, Loaded, Needs, Pruned, Scene, Wanted, needs, pruned};
use crate::trust::Trust;

/// A scene, and what is known of it beside.
#[derive(Debug)]
pub(super) struct Frozen {
    pub(super) scene: Scene,
    /// As the user named it.
    pub(super) path: PathBuf,
    /// What was odd about its files, but not wrong.
    pub(super) warnings: Vec<Problem>,
    /// What had no effect, and was left out.
    pub(super) pruned: Vec<Pruned>,
    /// What it was frozen for.
    pub(super) wanted: Wanted,
    /// How far its files are trusted.
    pub(super) trust: Trust,
    /// Pictures that its file names and that could not be read: among the warnings.
    pub(super) unread: Vec<Problem>,
    /// What tells its description from others.
    pub(super) hash: String,
    /// What its files say.
    pub(super) description: Description,
    /// Files that are named by files of the scene.
    pub(super) files: Vec<PathBuf>,
    /// All files that it is made of.
    pub(super) inputs: Vec<PathBuf>,
    /// The frame of a sequence, and when it begins in seconds.
    pub(super) frame: Option<(i32, f64)>,
    /// Where each placement was described.
    pub(super) origins: Vec<Place>,
}

impl Frozen {
    /// The scene of a file, trusted so far, with values replaced. Where it cannot be frozen, what was odd about the file is logged.
    pub(super) fn read(path: &Path, overrides: &[String], wanted: Wanted, trust: &Trust) -> Result<Self> {
        tracing::debug!("reading {}", path.display());
        let loaded = scene::load_within(path, overrides, trust)?;
        Self::of(loaded, path, (None, wanted), (trust, &Arc::default()))
    }

    /// The scene of a description, or a frame of it, whose files are trusted so far, with what a library has of them.
    pub(super) fn of(
        loaded: Loaded,
        path: &Path,
        (frame, wanted): (Option<i32>, Wanted),
        from: (&Trust, &Arc<Library>),
    ) -> Result<Self> {
        let Loaded { description, mut warnings, files: mut inputs } = loaded;
        let (description, frame) = at_frame(description, frame);
        let built = scene::build_from(&description, &wanted, from).inspect_err(|_| log::warn(&warnings))?;
        let Built { scene, origins, files, warnings: more, unread, pruned } = built;
        warnings.extend(more);
        inputs.extend(files.iter().cloned());
        let hash = scene::fingerprint(&description, folder(path));
        Ok(Self {
            scene,
            path: path.to_owned(),
            warnings,
            unread,
            pruned,
            wanted,
            trust: from.0.clone(),
            hash,
            description,
            files,
            inputs,
            frame,
            origins,
        })
    }

    /// Becomes another frame of the same scene, if nothing but the camera moves and the files are the same; else says that it cannot.
    pub(super) fn retake(&mut self, description: &Description, frame: Option<i32>) -> bool {
        let (description, frame) = at_frame(description.clone(), frame);
        if !scene::retake(&mut self.scene, &self.description, &description) {
            return false;
        }
        self.hash = scene::fingerprint(&description, self.folder());
        (self.description, self.frame) = (description, frame);
        true
    }

    /// The same, with all that was odd logged, and in a line what was left out.
    pub(super) fn told(path: &Path, overrides: &[String], wanted: Wanted, trust: &Trust) -> Result<Self> {
        Self::read(path, overrides, wanted, trust).inspect(|frozen| {
            log::warn(&frozen.warnings);
            if let Some(line) = frozen.without_effect() {
                tracing::info!("{line}");
            }
        })
    }

    /// A line about what was left out, if anything was.
    pub(super) fn without_effect(&self) -> Option<String> {
        let summary = pruned::summary(&self.pruned)?;
        Some(format!("without effect: {summary}; see `specula plan`"))
    }

    /// The same files with other values replaced: the scene is told settings where that is enough, and built anew where it is not.
    pub(super) fn turned(mut self, overrides: &[String]) -> Result<Self> {
        let loaded = scene::load_within(&self.path, overrides, &self.trust)?;
        let number = self.frame.map(|(number, _)| number);
        let (description, frame) = at_frame(loaded.description.clone(), number);
        if !scene::retune(&mut self.scene, &self.description, &description) {
            return Self::of(loaded, &self.path, (number, self.wanted), (&self.trust, &Arc::default()));
        }
        let hash = scene::fingerprint(&description, self.folder());
        Ok(Self { hash, description, frame, ..self })
    }

    /// The folder of its file.
    pub(super) fn folder(&self) -> &Path {
        folder(&self.path)
    }

    /// What it requires.
    pub(super) fn needs(&self) -> Needs {
        Needs::of(&self.scene, &self.wanted)
    }

    /// All that is odd about it, as far as that is seen at a glance.
    pub(super) fn all_warnings(&self) -> Vec<Problem> {
        self.warnings.iter().cloned().chain(needs::warnings(&self.scene, &self.origins)).collect()
    }

    /// What the command `plan` says of it, but for what takes a while to find.
    pub(super) fn plan(&self) -> Value {
        plan::to_json(self, &self.needs(), &self.all_warnings())
    }
}

/// The folder of a file; empty for the current directory.
pub(super) fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// The description at a frame, and when that begins.
pub(super) fn at_frame(
    mut description: Description,
    frame: Option<i32>,
) -> (Description, Option<(i32, f64)>) {
    let frame = frame.map(|frame| (frame, description.camera.frame_s(frame)));
    if let Some((frame, _)) = frame {
        description.camera.value = description.camera.value.at_frame(frame);
    }
    (description, frame)
}
