//! Filtered reflections: the filter by itself, whole pictures, and the command `fuzzy`.

#[path = "../support/desk.rs"]
mod desk;
#[path = "../support/first_passes.rs"]
#[expect(dead_code, reason = "the bench uses the rest")]
mod first_passes;
#[path = "../support/masks.rs"]
#[expect(dead_code, reason = "the bench uses the rest")]
mod masks;
#[path = "../support/scene.rs"]
mod scene;

mod command;
mod edge;
mod filter;
mod pictures;
