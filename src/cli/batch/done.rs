//! Whether a picture is done: by what its EXR files say that they are of.
//!
//! Their metadata hold the hash of the description, the settings that it does not have, the version, and digits of all files that the
//! picture was made of, also those that files name. Nothing is read for it but scene files, heads of pictures, and files that have not been
//! read since they changed.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::{Map, Value, json};

use crate::cli::frozen::{Frozen, at_frame, folder};
use crate::cli::kept;
use crate::cli::options::{Output, RenderOptions};
use crate::error::Result;
use crate::film::Precision;
use crate::image::{Format, Window, exr};
use crate::scene::{self, Library, Loaded};
use crate::trust::Trust;

const VERSION: &str = "specula:version";
const HASH: &str = "specula:scene_hash";
const SETTINGS: &str = "specula:settings";
const FILES: &str = "specula:files";

/// What a picture is of, but for its files.
#[derive(Debug)]
pub(super) struct Wanted {
    hash: String,
    settings: Value,
    /// Digits of the files that the description names.
    files: Map<String, Value>,
}

impl Wanted {
    /// What a picture with these options is to be of. Fails if a file cannot be read.
    pub(super) fn new(options: &RenderOptions, loaded: &Loaded, library: &Library) -> Result<Self> {
        let folder = folder(&options.scene);
        let (description, _) = at_frame(loaded.description.clone(), options.frame);
        Ok(Self {
            hash: scene::fingerprint(&description, folder),
            settings: settings(options),
            files: scene::digest_of_files(&description, folder, &[], (&options.trust, library))?,
        })
    }

    /// The metadata by which it is known again. Files are those of the scene as it was frozen: digits were taken before that.
    pub(super) fn notes(&self, frozen: &Frozen, library: &Library) -> Result<Vec<(String, String)>> {
        let from = (&frozen.trust, library);
        let more = scene::digest_of_files(&frozen.description, frozen.folder(), &frozen.files, from)?;
        let mut files = self.files.clone();
        for (name, digits) in more {
            files.entry(name).or_insert(digits);
        }
        let notes = [(SETTINGS, self.settings.to_string()), (FILES, Value::Object(files).to_string())];
        Ok(notes.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
    }

    /// Why a picture is to be made; nothing if it is there.
    pub(super) fn due(&self, options: &RenderOptions, library: &Library) -> Option<String> {
        let missing = options.outputs.iter().find(|output| !output.path.is_file());
        if let Some(Output { path, .. }) = missing {
            return Some(format!("there is no `{}`", path.display()));
        }
        let pictures = options.outputs.iter().filter(|output| output.format == Format::Exr);
        let pictures: Vec<&Path> = pictures.map(|output| output.path.as_path()).collect();
        if pictures.is_empty() {
            return Some("no output is an .exr, which would say what it is of".to_owned());
        }
        pictures
            .into_iter()
            .find_map(|path| self.differs(path, folder(&options.scene), (&options.trust, library)))
    }

    /// How the picture in a file is another one.
    fn differs(&self, path: &Path, folder: &Path, from: (&Trust, &Library)) -> Option<String> {
        let Ok(attributes) = exr::attributes(path) else {
            return Some(format!("`{}` cannot be read", path.display()));
        };
        let told =
            |name: &str| attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str());
        let json = |name: &str| told(name).and_then(|text| serde_json::from_str::<Value>(text).ok());
        let (Some(settings), Some(Value::Object(files))) = (json(SETTINGS), json(FILES)) else {
            return Some(format!("`{}` does not say of what files it is", path.display()));
        };
        if told(VERSION) != Some(env!("CARGO_PKG_VERSION")) {
            return Some(format!("it is by version {}", told(VERSION).unwrap_or("unknown")));
        }
        if let Some(difference) = scene::differences(&settings, &self.settings).into_iter().next() {
            return Some(format!("it has other settings: {difference}"));
        }
        let names: BTreeSet<&String> = files.keys().chain(self.files.keys()).collect();
        for name in names {
            let now = self.files.get(name).and_then(Value::as_str).map(str::to_owned);
            // What files of the scene name is known from the picture alone.
            let now = now.or_else(|| scene::digest_of_file(name, folder, from).ok());
            match (files.get(name).and_then(Value::as_str), now) {
                (Some(then), Some(now)) if then == now => {}
                (None, _) => return Some(format!("`{name}` is new")),
                _ => return Some(format!("`{name}` has changed")),
            }
        }
        (told(HASH) != Some(self.hash.as_str())).then(|| "the scene or its overrides have changed".to_owned())
    }
}

/// What pixels and channels depend on, but the description.
fn settings(options: &RenderOptions) -> Value {
    let mut settings = kept::settings(options);
    let more = [
        ("frame", json!(options.frame)),
        ("first_pass", json!(options.first_pass)),
        ("crop", json!(options.crop.map(Window::corners))),
        ("half", json!(options.precision == Precision::Half)),
    ];
    settings.extend(more.map(|(name, value)| (name.to_owned(), value)));
    settings.into()
}
