//! Scenes as commands take them: read and frozen, with what there is to tell of them.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{log, plan};
use crate::error::{Place, Problem, Result};
use crate::scene::{self, Built, Description, Loaded, Needs, Pruned, Scene, Wanted, needs, pruned};

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
    /// What tells its description from others.
    pub(super) hash: String,
    /// What its files say.
    pub(super) description: Description,
    /// Files that are named by files of the scene.
    pub(super) files: Vec<PathBuf>,
    /// Where each placement was described.
    pub(super) origins: Vec<Place>,
}

impl Frozen {
    /// The scene of a file, with values replaced. Where it cannot be frozen, what was odd about the file is logged.
    pub(super) fn read(path: &Path, overrides: &[String], wanted: Wanted) -> Result<Self> {
        tracing::debug!("reading {}", path.display());
        let Loaded { description, mut warnings } = scene::load(path, overrides)?;
        let built = scene::build_for(&description, &wanted).inspect_err(|_| log::warn(&warnings))?;
        let Built { scene, origins, files, warnings: more, pruned } = built;
        warnings.extend(more);
        let hash = scene::fingerprint(&description, path.parent().unwrap_or(Path::new("")));
        Ok(Self { scene, path: path.to_owned(), warnings, pruned, wanted, hash, description, files, origins })
    }

    /// The same, with all that was odd logged, and in a line what was left out.
    pub(super) fn told(path: &Path, overrides: &[String], wanted: Wanted) -> Result<Self> {
        Self::read(path, overrides, wanted).inspect(|frozen| {
            log::warn(&frozen.warnings);
            if let Some(summary) = pruned::summary(&frozen.pruned) {
                tracing::info!("without effect: {summary}; see `specula plan`");
            }
        })
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
