//! Numbers, vectors over lanes, frames and transforms.
pub mod lanes;
