//! From files to a frozen scene.
//!
//! [`load()`] reads what a user wrote into a [`Description`], plain data in which everything has a place; [`build()`]
//! reads the files it names and freezes a [`Scene`], which has no file names and does not change.

mod build;
pub mod description;
mod fingerprint;
mod frozen;
mod identity;
pub mod load;
pub mod needs;
mod record;
pub mod schema;
mod track;

pub use build::{Built, build, build_within};
pub use description::{Description, Direct, GlassShadows};
pub use fingerprint::fingerprint;
pub use frozen::Scene;
pub use identity::{differences, identity};
pub use load::{Loaded, load, load_within};
pub use needs::Needs;
pub use schema::schema;
