//! What a scene does not need is left out: it is told, and the picture stays.

#[path = "../support/desk.rs"]
mod desk;
#[path = "../support/pictures.rs"]
mod pictures;
#[path = "../support/scene.rs"]
mod support;

mod forced;
mod plan;
mod pruning;
