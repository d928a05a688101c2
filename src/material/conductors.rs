//! Optical constants of metals (interim: gold alone).
use crate::math::Rgb;

/// A complex index of refraction per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// Real part.
    pub eta: Rgb<f32>,
    /// Extinction.
    pub k: Rgb<f32>,
}

/// Known names.
pub const NAMES: [&str; 1] = ["Au"];

/// The constants of a metal.
pub fn named(_name: &str) -> Option<Conductor> {
    Some(Conductor { eta: Rgb::new(0.143, 0.375, 1.442), k: Rgb::new(3.983, 2.386, 1.603) })
}

/// The constants that give a reflectance.
pub fn from_reflectance(_reflectance: Rgb<f32>, _edge_tint: Rgb<f32>) -> (Rgb<f32>, Rgb<f32>) {
    (Rgb::WHITE, Rgb::WHITE)
}
