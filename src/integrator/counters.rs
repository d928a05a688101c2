//! How often what happened.

use std::ops::AddAssign;

/// Rays by kind, and what was cut off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Rays from the camera.
    pub camera: u64,
    /// Rays along mirror directions.
    pub reflected: u64,
    /// Rays through interfaces.
    pub refracted: u64,
    /// Rays drawn from glossy lobes.
    pub glossy: u64,
    /// Rays of paths from surface to surface.
    pub bounced: u64,
    /// Rays towards lights, each segment through glass counted.
    pub shadow: u64,
    /// Rays continued through surfaces that overlapping media hide.
    pub hidden: u64,
    /// Branches not followed because the path was long enough.
    pub cut_by_depth: u64,
    /// Branches not followed because they would have carried too little.
    pub cut_by_attenuation: u64,
}

impl Counters {
    /// All rays.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.camera + self.reflected + self.refracted + self.glossy + self.bounced + self.shadow + self.hidden
    }
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.reflected += other.reflected;
        self.refracted += other.refracted;
        self.glossy += other.glossy;
        self.bounced += other.bounced;
        self.shadow += other.shadow;
        self.hidden += other.hidden;
        self.cut_by_depth += other.cut_by_depth;
        self.cut_by_attenuation += other.cut_by_attenuation;
    }
}
