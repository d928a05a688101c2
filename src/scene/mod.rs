//! From files to a frozen scene.
//!
//! [`load()`] reads what a user wrote into a [`Description`], plain data in which everything has a place; [`build()`]
//! reads the files it names and freezes a [`Scene`], which has no file names and does not change.

mod build;
pub mod description;
mod fingerprint;
mod frozen;
mod identity;
mod library;
pub mod load;
pub mod needs;
pub mod pruned;
mod record;
pub mod schema;
mod track;
mod wanted;

pub use build::{Built, build, build_for, build_from, build_within, retake, retune};
pub use description::{Description, Direct, GlassShadows};
pub(crate) use fingerprint::digits;
pub use fingerprint::fingerprint;
pub use frozen::Scene;
pub use identity::{differences, digest_of_file, digest_of_files, files, identity, identity_within};
pub use library::{Library, Reads, Stamp};
pub use load::{Loaded, is_scene, load, load_batch, load_from, load_within};
pub use needs::Needs;
pub use pruned::Pruned;
pub use schema::{schema, schema_of_batch};
pub use wanted::Wanted;
