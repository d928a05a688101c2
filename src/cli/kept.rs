//! Files from which pictures go on: checkpoints, and parts to be merged.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;
use std::time::Instant;

use serde_json::{Map, Value, json};

use super::frozen::Frozen;
use super::options::{Checkpoints, RenderOptions};
use crate::error::{Error, Place, Problem, Problems, Result};
use crate::image::{Window, atomic};
use crate::render::{self, Begin, Checkpoint, Keeper, State};
use crate::scene::needs::capability::Capability;
use crate::scene::{self, Library};

/// What a picture is of: all that its pixels depend on, but which samples of which pixels there are.
///
/// Files that a library has digits of are not read for it.
pub(super) fn about(options: &RenderOptions, frozen: &Frozen, library: &Library) -> Result<Value> {
    let Frozen { description, files, trust, .. } = frozen;
    let mut about = scene::identity_within(description, frozen.folder(), files, (trust, library))?;
    about["version"] = env!("CARGO_PKG_VERSION").into();
    about["scene_hash"] = frozen.hash.clone().into();
    for (name, value) in settings(options) {
        about[name] = value;
    }
    Ok(about)
}

/// What sums depend on, but the description.
pub(super) fn settings(options: &RenderOptions) -> Map<String, Value> {
    let mut settings = Map::new();
    let mut set = |name: &str, value: Value| settings.insert(name.to_owned(), value);
    set("outputs", options.layout.aovs().iter().map(|aov| aov.name()).collect());
    set("time_limit_s", options.limits.time.map(|time| time.as_secs_f64()).into());
    set("target_error", options.limits.error.into());
    // What is switched on, or kept without effect, moves the last bits.
    if !options.specialise.forced.is_empty() {
        set("forced", options.specialise.forced.iter().map(Capability::word).collect());
    }
    if options.specialise.keeps {
        set("pruning", false.into());
    }
    settings
}

/// Keeps copies in a file.
#[derive(Debug)]
pub(super) struct Kept<'a> {
    checkpoints: &'a Checkpoints,
    /// What they are of.
    about: Value,
}

impl<'a> Kept<'a> {
    /// In a file, of what `about` says and these options choose.
    pub(super) fn new(
        checkpoints: &'a Checkpoints,
        options: &RenderOptions,
        (scene, mut about): (&scene::Scene, Value),
    ) -> Result<Self> {
        about["crop"] = json!(options.crop.map(Window::corners));
        about["slice"] = options.slice.map(|slice| format!("{}/{}", slice.index, slice.of)).into();
        about["instruction_set"] = render::lanes().into();
        about["backend"] = render::backend(scene)?.into();
        Ok(Self { checkpoints, about })
    }

    /// What is there to go on from, if anything. Fails if it is of something else, or is not to be gone on from.
    pub(super) fn begin(&self) -> Result<Option<Begin<'static>>> {
        let path = &self.checkpoints.path;
        let place = Place::file(path);
        if !path.exists() {
            if self.checkpoints.resume {
                tracing::info!("there is no checkpoint `{}` yet: beginning anew", path.display());
            }
            return Ok(None);
        }
        if !self.checkpoints.resume {
            let problem = Problem::at(place, "there is a file already, which a checkpoint would replace");
            return Err(problem.remedy("give --resume to go on from it, or remove it").into());
        }
        let refused = |what: String| Problem::at(place.clone(), what).remedy(Checkpoint::<&[u8]>::REMEDY);
        let (file, length) = open(path)?;
        let checkpoint = Checkpoint::open(file, length).map_err(refused)?;
        let mut differences = scene::differences(checkpoint.about(), &self.about);
        if differences.len() > 1 {
            differences.retain(|told| !told.starts_with("`scene_hash`"));
        }
        let differences =
            differences.into_iter().map(|told| format!("a checkpoint of another picture: {told}"));
        Problems(differences.map(refused).collect()).into_result(())?;
        tracing::info!("going on from {} samples in `{}`", checkpoint.samples(), path.display());
        Ok(Some((checkpoint, place)))
    }

    /// Takes the file away, now that the picture is there.
    pub(super) fn remove(&self) {
        if let Err(error) = atomic::remove(&self.checkpoints.path) {
            tracing::warn!("{}", super::chain(&error));
        }
    }
}

impl Keeper for Kept<'_> {
    fn every(&self) -> std::time::Duration {
        self.checkpoints.every
    }

    fn keep(&self, state: &State) -> Result<()> {
        let begin = Instant::now();
        atomic::write(&self.checkpoints.path, |mut file| state.write(&self.about, &mut file))?;
        tracing::debug!(
            "kept {} samples in `{}`, {:.2} s",
            state.samples(),
            self.checkpoints.path.display(),
            begin.elapsed().as_secs_f64()
        );
        Ok(())
    }

    fn missed(&self, error: Error) {
        tracing::warn!("{}; rendering goes on without this checkpoint", super::chain(&error));
    }
}

/// Takes away the checkpoint of a picture that is done, if one was left.
pub(super) fn clear(checkpoints: &Checkpoints) {
    let path = &checkpoints.path;
    let is_one =
        path.is_file() && open(path).is_ok_and(|(file, length)| Checkpoint::open(file, length).is_ok());
    if is_one && let Err(error) = atomic::remove(path) {
        tracing::warn!("{}", super::chain(&error));
    }
}

/// A file to read, and its length.
pub(super) fn open(path: &Path) -> Result<(Box<dyn Read>, u64)> {
    let failed = |source| Error::Io { path: path.to_owned(), what: "cannot read", source };
    let file = File::open(path).map_err(failed)?;
    let about = file.metadata().map_err(failed)?;
    if !about.is_file() {
        return Err(Problem::at(Place::file(path), "not a file").remedy("name a file").into());
    }
    Ok((Box::new(BufReader::with_capacity(1 << 16, file)), about.len()))
}

/// The metadata of parts that tell how each was made, for those of the whole.
pub(super) fn told(attributes: &[(String, String)], statistics: &Value, scene: &scene::Scene) -> Value {
    json!({
        "attributes": attributes,
        "statistics": statistics,
        "exposure_ev": scene.film.exposure_ev,
        "tone": scene.film.tone.word(),
    })
}
