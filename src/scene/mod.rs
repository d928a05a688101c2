//! From files to a frozen scene.

pub mod description;
mod record;
