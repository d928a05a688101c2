//! Scenes as commands take them: read and frozen, with what there is to tell of them.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{log, plan};
use crate::error::{Place, Problem, Result};
use crate::scene::{self, Built, Description, Loaded, Needs, Scene};
use crate::trust::Trust;

/// A scene, and what is known of it beside.
#[derive(Debug)]
pub(super) struct Frozen {
    pub(super) scene: Scene,
    /// As the user named it.
    pub(super) path: PathBuf,
    /// What was odd about its files, but not wrong.
    pub(super) warnings: Vec<Problem>,
    /// What tells its description from others.
    pub(super) hash: String,
    /// What its files say.
    pub(super) description: Description,
    /// Files that are named by files of the scene.
    pub(super) files: Vec<PathBuf>,
    /// Where each placement was described.
    origins: Vec<Place>,
}

impl Frozen {
    /// The scene of a file, trusted so far, with values replaced. Where it cannot be frozen, what was odd about the file is logged.
    pub(super) fn read(path: &Path, overrides: &[String], trust: &Trust) -> Result<Self> {
        tracing::debug!("reading {}", path.display());
        let Loaded { description, mut warnings } = scene::load_within(path, overrides, trust)?;
        let Built { scene, origins, files, warnings: more } =
            scene::build_within(&description, trust).inspect_err(|_| log::warn(&warnings))?;
        warnings.extend(more);
        let hash = scene::fingerprint(&description, path.parent().unwrap_or(Path::new("")));
        Ok(Self { scene, path: path.to_owned(), warnings, hash, description, files, origins })
    }

    /// The same, with all that was odd logged.
    pub(super) fn told(path: &Path, overrides: &[String], trust: &Trust) -> Result<Self> {
        Self::read(path, overrides, trust).inspect(|frozen| log::warn(&frozen.warnings))
    }

    /// What it requires.
    pub(super) fn needs(&self) -> Needs {
        Needs::of(&self.scene, &self.origins)
    }

    /// What the command `plan` says of it.
    pub(super) fn plan(&self) -> Value {
        plan::to_json(self, &self.needs())
    }
}
