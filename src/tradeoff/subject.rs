//! A scene that is rendered under other settings.

use crate::error::{Place, Problem, Result};
use crate::scene::description::Description;
use crate::scene::{self, Built, Library, Loaded, Needs, Scene, Wanted};
use crate::tradeoff::design::Axis;
use crate::tradeoff::knobs::{Facts, Knob};
use crate::trust::Trust;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene file that is read again and again, with other values each time. Meshes and pictures are read once, unless a value asks for
/// more than rendering them otherwise.
#[derive(Debug)]
pub struct Subject {
    path: PathBuf,
    overrides: Vec<String>,
    /// How far its files are trusted.
    trust: Trust,
    /// As the file says, with what is replaced for all points.
    base: Description,
    needs: Needs,
    /// What was built last, and what of.
    scene: Scene,
    built: Description,
    /// Files that files of the scene name.
    files: Vec<PathBuf>,
}

impl Subject {
    /// The scene of a file, trusted so far, with values replaced; and what was odd about it.
    ///
    /// Fails with all that is wrong with it.
    pub fn read(path: &Path, overrides: &[String], trust: &Trust) -> Result<(Self, Vec<Problem>)> {
        let Loaded { description, mut warnings, .. } = scene::load_within(path, overrides, trust)?;
        let wanted = Wanted::default();
        let built = scene::build_from(&description, &wanted, (trust, &Arc::default()))?;
        let Built { scene, files, warnings: more, .. } = built;
        warnings.extend(more);
        let needs = Needs::of(&scene, &wanted);
        let subject = Self {
            path: path.to_owned(),
            overrides: overrides.to_vec(),
            trust: trust.clone(),
            base: description.clone(),
            needs,
            scene,
            built: description,
            files,
        };
        Ok((subject, warnings))
    }

    /// The file, as the user named it.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What was replaced for all points.
    #[must_use]
    pub fn overrides(&self) -> &[String] {
        &self.overrides
    }

    /// What the file says, with what is replaced for all points.
    #[must_use]
    pub fn base(&self) -> &Description {
        &self.base
    }

    /// What knobs ask about. To be asked before the first point is.
    #[must_use]
    pub fn facts(&self) -> Facts<'_> {
        Facts { scene: &self.scene, needs: &self.needs }
    }

    /// What it is: the description and all its files.
    ///
    /// Fails if a file cannot be read.
    pub fn identity(&self) -> Result<Value> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        scene::identity_within(&self.base, folder, &self.files, (&self.trust, &Library::default()))
    }

    /// What the file says of a knob's key, as a file would say it; `None` where it is left to the renderer.
    #[must_use]
    pub fn said(&self, key: &str) -> Option<String> {
        said(&self.base.to_json(), key)
    }

    /// The axes of a sweep over some knobs: each with its own values, or the usual ones.
    #[must_use]
    pub fn axis(&self, knob: &Knob, values: &[String]) -> Axis {
        let values = if values.is_empty() { knob.usual(&self.facts()) } else { values.to_vec() };
        Axis { knob: knob.name.to_owned(), key: knob.key.to_owned(), values }
    }

    /// The description with more values replaced, each a key and a value.
    ///
    /// Fails with what is wrong with them.
    pub fn described(&self, settings: &[(String, String)]) -> Result<Description> {
        let more = settings.iter().map(|(key, value)| format!("{key}={value}"));
        let overrides: Vec<String> = self.overrides.iter().cloned().chain(more).collect();
        scene::load_within(&self.path, &overrides, &self.trust).map(|loaded| loaded.description)
    }

    /// The scene of a description that [`Subject::described`] gave, with that seed.
    ///
    /// Fails if its files cannot be read any more.
    pub fn scene(&mut self, wanted: &Description, seed: u64) -> Result<&Scene> {
        if !scene::retune(&mut self.scene, &self.built, wanted) {
            let from = (&self.trust, &Arc::default());
            self.scene = scene::build_from(wanted, &Wanted::default(), from)?.scene;
        }
        self.built = wanted.clone();
        self.scene.render.seed = seed;
        Ok(&self.scene)
    }

    /// Refuses what cannot be measured.
    ///
    /// Fails for pictures of another thing than light.
    pub fn check(&self) -> Result<()> {
        if self.base.render.integrator == scene::description::Integrator::View {
            let problem = Problem::at(Place::file(&self.path), "the integrator `view` shows no light");
            return Err(problem.remedy("choose another by -D render.integrator=NAME").into());
        }
        Ok(())
    }
}

/// What a description in JSON says of a key, as a file would say it; `None` where it is left to the renderer.
pub(crate) fn said(json: &Value, key: &str) -> Option<String> {
    match key.split('.').try_fold(json, |json, part| json.get(part))? {
        Value::Null => None,
        Value::String(word) => Some(word.clone()),
        other => Some(other.to_string()),
    }
}

/// What of a description may differ between points, in JSON: `render` and `film`, the seed left out. Points are the same if this is.
#[must_use]
pub fn settings_of(description: &Description) -> Value {
    let json = description.to_json();
    let mut settings = Map::new();
    for table in ["film", "render"] {
        let mut entries = json.get(table).cloned().unwrap_or_default();
        if let Some(entries) = entries.as_object_mut() {
            entries.shift_remove("seed");
        }
        settings.insert(table.to_owned(), entries);
    }
    Value::Object(settings)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "[film]\nwidth = 8\nheight = 4\n[materials.m]\ntype = 'dielectric'\n[[shapes]]\ntype = 'sphere'\n\
        radius = 1.0\nmaterial = 'm'\n[[lights]]\ntype = 'environment'\nradiance = 1.0\n";

    fn subject() -> (Subject, tempfile::TempDir) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.toml");
        std::fs::write(&path, SCENE).expect("written");
        (Subject::read(&path, &["render.spp=3".to_owned()], &Trust::default()).expect("a scene").0, folder)
    }

    fn set(key: &str, value: &str) -> Vec<(String, String)> {
        vec![(key.to_owned(), value.to_owned())]
    }

    #[test]
    fn settings_change_the_scene_and_what_building_looks_at_builds_it_anew() {
        let (mut subject, _folder) = subject();
        let world = Arc::as_ptr(&subject.scene.world);
        let deep = subject.described(&set("render.max_depth", "3")).expect("valid");
        let scene = subject.scene(&deep, 7).expect("a scene");
        assert_eq!((scene.render.max_depth, scene.render.seed, scene.render.spp()), (3, 7, 3), "set");
        assert_eq!(Arc::as_ptr(&scene.world), world, "not built again");
        let plain = subject.described(&set("render.fresnel", "constant")).expect("valid");
        let said = subject.base.render.max_depth;
        let world = subject.scene.world.clone();
        let scene = subject.scene(&plain, 0).expect("a scene");
        assert!(!Arc::ptr_eq(&scene.world, &world), "built anew: materials are others");
        assert_eq!(scene.render.max_depth, said, "as the file says");
    }

    #[test]
    fn what_a_file_says_is_told_in_its_words() {
        let (subject, _folder) = subject();
        assert_eq!(subject.said("render.spp").as_deref(), Some("3"), "replaced");
        assert_eq!(subject.said("render.fresnel").as_deref(), Some("exact"), "a default");
        assert_eq!(subject.said("render.light_choice"), None, "left to the renderer");
        assert!(subject.described(&set("render.fresnel", "none")).is_err(), "checked as a file is");
    }

    #[test]
    fn points_are_the_same_whatever_their_seed() {
        let (subject, _folder) = subject();
        let of = |key, value| settings_of(&subject.described(&set(key, value)).expect("valid"));
        assert_eq!(of("render.seed", "5"), settings_of(&subject.base), "seed");
        assert_eq!(of("render.max_depth", "16"), settings_of(&subject.base), "the default, written");
        assert_ne!(of("render.max_depth", "5"), settings_of(&subject.base), "another depth");
    }
}
