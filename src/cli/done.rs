//! Whether a picture is done: by what its EXR files and parts say that they are of.
//!
//! Metadata and heads hold the hash of the description, the settings that it does not have, the version, and digits of all files that the
//! picture was made of, also those that files name. Nothing is read for it but scene files, heads of pictures, parts, and files that have
//! not been read since they changed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::frozen::{Frozen, at_frame, folder};
use super::kept;
use super::options::RenderOptions;
use crate::error::Result;
use crate::film::Precision;
use crate::image::{Format, Window, exr};
use crate::render::{Outline, PartFile};
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
        let pictures = options.outputs.iter().map(|output| &output.path);
        let missing = pictures.chain(&options.parts).chain(&options.stats).find(|path| !path.is_file());
        if let Some(path) = missing {
            return Some(format!("there is no `{}`", path.display()));
        }
        let pictures = options.outputs.iter().filter(|output| output.format == Format::Exr);
        let pictures: Vec<&PathBuf> = pictures.map(|output| &output.path).collect();
        if pictures.is_empty() && options.parts.is_empty() {
            return Some("no output is an .exr, which would say what it is of".to_owned());
        }
        let from = (folder(&options.scene), (&options.trust, library));
        let differs = |path: &Path, told: Told, settings: &Value| match told {
            Ok(told) => self.differs(&told, settings, from),
            Err(what) => Some(format!("`{}` {what}", path.display())),
        };
        let sums = Value::Object(kept::settings(options));
        let of_parts = || options.parts.iter().find_map(|path| differs(path, of_part(path, options), &sums));
        pictures.iter().find_map(|path| differs(path, of_picture(path), &self.settings)).or_else(of_parts)
    }

    /// How a picture that a file tells of is another one than that with these settings.
    fn differs(
        &self,
        told: &Label,
        settings: &Value,
        (folder, from): (&Path, (&Trust, &Library)),
    ) -> Option<String> {
        if told.version.as_deref() != Some(env!("CARGO_PKG_VERSION")) {
            return Some(format!("it is by version {}", told.version.as_deref().unwrap_or("unknown")));
        }
        if let Some(difference) = scene::differences(&told.settings, settings).into_iter().next() {
            return Some(format!("it has other settings: {difference}"));
        }
        let names: BTreeSet<&String> = told.files.keys().chain(self.files.keys()).collect();
        for name in names {
            let now = self.files.get(name).and_then(Value::as_str).map(str::to_owned);
            // What files of the scene name is known from the picture alone.
            let now = now.or_else(|| scene::digest_of_file(name, folder, from).ok());
            match (told.files.get(name).and_then(Value::as_str), now) {
                (Some(then), Some(now)) if then == now => {}
                (None, _) => return Some(format!("`{name}` is new")),
                _ => return Some(format!("`{name}` has changed")),
            }
        }
        (told.hash.as_ref() != Some(&self.hash)).then(|| "the scene or its overrides have changed".to_owned())
    }
}

/// What a file tells of its picture, or what is wrong with it.
type Told = std::result::Result<Label, String>;

/// What a file says that its picture is of.
#[derive(Debug)]
struct Label {
    version: Option<String>,
    hash: Option<String>,
    settings: Value,
    files: Map<String, Value>,
}

/// Of an EXR file, by its metadata.
fn of_picture(path: &Path) -> Told {
    let attributes = exr::attributes(path).map_err(|_| "cannot be read".to_owned())?;
    let told = |name: &str| attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.clone());
    let json = |name: &str| told(name).and_then(|text| serde_json::from_str::<Value>(&text).ok());
    let (Some(settings), Some(Value::Object(files))) = (json(SETTINGS), json(FILES)) else {
        return Err("does not say of what files it is".to_owned());
    };
    Ok(Label { version: told(VERSION), hash: told(HASH), settings, files })
}

/// Of a part with the pixels and samples that are asked for, by its head. The rest must be sound: nothing but `merge` looks at it.
fn of_part(path: &Path, options: &RenderOptions) -> Told {
    let (file, length) = kept::open(path).map_err(|_| "cannot be read".to_owned())?;
    let part = PartFile::open(file, length).map_err(|what| format!("cannot be read: {what}"))?;
    let Outline { full: [width, height], window, ref samples, spp, .. } = *part.outline();
    let wanted = options.slice.map_or(0..spp, |slice| slice.samples(spp));
    if window != options.crop.unwrap_or(Window::whole(width, height)) || *samples != wanted {
        return Err("has other pixels or samples".to_owned());
    }
    let mut about = part.about().as_object().cloned().unwrap_or_default();
    part.check().map_err(|what| format!("cannot be read: {what}"))?;
    let text = |value: Option<Value>| value.and_then(|value| value.as_str().map(str::to_owned));
    let (version, hash) = (text(about.remove("version")), text(about.remove("scene_hash")));
    let Some(Value::Object(files)) = about.remove("files") else {
        return Err("does not say of what files it is".to_owned());
    };
    about.remove("scene");
    Ok(Label { version, hash, settings: about.into(), files })
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
    if let Some(slice) = options.slice {
        settings.insert("slice".to_owned(), format!("{}/{}", slice.index, slice.of).into());
    }
    settings.into()
}
