//! Scenes as commands take them: read and frozen, with what there is to tell of them.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{log, plan};
use crate::error::{Place, Problem, Result};
use crate::scene::{self, Built, Description, Loaded, Needs, Scene};
use crate::tradeoff;

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
    /// The scene of a file, with values replaced. Where it cannot be frozen, what was odd about the file is logged.
    pub(super) fn read(path: &Path, overrides: &[String]) -> Result<Self> {
        tracing::debug!("reading {}", path.display());
        let Loaded { description, mut warnings } = scene::load(path, overrides)?;
        let Built { scene, origins, files, warnings: more } =
            scene::build(&description).inspect_err(|_| log::warn(&warnings))?;
        warnings.extend(more);
        let hash = scene::fingerprint(&description, path.parent().unwrap_or(Path::new("")));
        Ok(Self { scene, path: path.to_owned(), warnings, hash, description, files, origins })
    }

    /// The same, with all that was odd logged.
    pub(super) fn told(path: &Path, overrides: &[String]) -> Result<Self> {
        Self::read(path, overrides).inspect(|frozen| log::warn(&frozen.warnings))
    }

    /// The same files with other values replaced: the scene is told settings where that is enough, and built anew where it is not.
    pub(super) fn turned(self, overrides: &[String]) -> Result<Self> {
        let description = scene::load(&self.path, overrides)?.description;
        if !tradeoff::is_built_alike(&self.description, &description) {
            return Self::read(&self.path, overrides);
        }
        let hash = scene::fingerprint(&description, self.path.parent().unwrap_or(Path::new("")));
        let Self { mut scene, path, warnings, files, origins, .. } = self;
        (scene.render, scene.film) = (description.render.clone(), description.film.clone());
        Ok(Self { scene, path, warnings, hash, description, files, origins })
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
