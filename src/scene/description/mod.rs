//! What a scene file says: plain data, each entry with its place.
//!
//! Every table of the scene file is declared here, once: names, types, units, ranges and defaults of its keys, and the
//! sentence that explains each. The decoder, the checks, the suggestions and the JSON Schema all come from these
//! declarations (the macros of `record.rs`). Lengths are metres, radiance is W/(sr m^2), angles are degrees. Places and what
//! carries shapes to them are double precision: far from the origin, small differences count.
//!
//! A description that came out of [`crate::scene::load()`] is valid key by key, its references resolve and the files it
//! names exist; whether those files can be read and whether a transform is invertible is found out later.

mod batch;
mod camera;
mod film;
mod frames;
mod fuzzy;
mod light;
mod material;
mod render;
mod shape;
mod texture;

use crate::error::Place;
use crate::scene::record::{Value, record};
use glam::DVec3;
use std::ops::Deref;
use std::path::PathBuf;

pub use crate::bsdf::{Below, FresnelModel as Fresnel, PhongScale};
pub use crate::texture::{Channel, Space, Wrap};
pub use batch::{Batch, Job, JobSettings, Overrides};
pub use camera::{Camera, CameraKey};
pub use film::{Film, Filter, Tone};
pub use frames::Frames;
pub use fuzzy::{
    FuzzyBy, FuzzyCorrection, FuzzyFilter, FuzzyRadius, FuzzyRejection, FuzzyWeighting, FuzzyWindow,
};
pub use light::{Light, Sky};
pub use material::{Distribution, Material, MixPart, Optics, Scattering};
pub use render::{
    Backend, BuildQuality, Direct, GlassShadows, Integrator, LightChoice, Query, Render, Sampler, View,
};
pub use shape::{Form, HeightNormals, Normals, Shape, ShapeKey, Step};
pub use texture::{Bump, Checker, ImageTexture, Lie, NormalMap, Roughness, ScalarTexture, Texture};

/// A value, and where it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Located<T> {
    /// The value.
    pub value: T,
    /// Where it stands; the table around it where it was left out.
    pub place: Place,
}

impl<T> Deref for Located<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

/// An entry of a table whose keys are names.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T> {
    /// Its name.
    pub name: String,
    /// Where the name was given.
    pub place: Place,
    /// The entry.
    pub value: T,
}

/// One number per axis; a single number in the file stands for all three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerAxis(pub DVec3);

/// A width along each tangent; a single number in the file stands for both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerTangent(pub [f32; 2]);

/// A number, or the word `off`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knob<T> {
    /// Not in use.
    Off,
    /// In use, with this value.
    At(T),
}

impl<T> Knob<T> {
    /// The value, if it is in use.
    #[must_use]
    pub fn value(self) -> Option<T> {
        if let Self::At(value) = self { Some(value) } else { None }
    }
}

impl<T: std::fmt::Display> std::fmt::Display for Knob<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Off => f.write_str("off"),
            Self::At(value) => value.fmt(f),
        }
    }
}

record! {
    /// A scene.
    pub struct Description {
        /// Other scene files, whose tables come first; `camera`, `film` and `render` of this file override theirs key by
        /// key, shapes and lights are added to theirs.
        include: Vec<Located<PathBuf>>, file(&["toml"]);
        /// From where and how the scene is seen.
        camera: Located<Camera>;
        /// The picture and how samples become pixels.
        film: Film;
        /// How light is followed; flags of the command line override these.
        render: Render;
        /// Materials by name.
        materials: Vec<Named<Material>>;
        /// Surfaces.
        shapes: Vec<Located<Shape>>;
        /// Lights; surfaces of an emitting material shine too.
        lights: Vec<Located<Light>>;
    }
}

impl Description {
    /// The same scene as one file without includes would say it, in JSON. Defaults are written out; names of files are
    /// as seen from the current directory.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        let mut json = Value::to_json(self);
        if let Some(object) = json.as_object_mut() {
            object.shift_remove("include");
        }
        json
    }
}
