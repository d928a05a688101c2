//! How often what happened.

use std::ops::AddAssign;

/// Rays by kind, and what was cut off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    /// Paths that ended at random.
    pub cut_by_roulette: u64,
    /// Luminance of all samples that a limit on indirect light has taken away; 0 without one.
    pub clamped: f64,
    /// Luminance of all samples that it has left; 0 without one.
    pub unclamped: f64,
}

impl Counters {
    /// The part of all light that a limit on indirect light has taken away.
    #[must_use]
    pub fn clamped_part(&self) -> f64 {
        if self.clamped > 0.0 { self.clamped / (self.clamped + self.unclamped) } else { 0.0 }
    }

    /// All counts, and all sums.
    #[must_use]
    pub fn to_arrays(&self) -> ([u64; 10], [f64; 2]) {
        let &Self { camera, reflected, refracted, glossy, bounced, shadow, hidden, .. } = self;
        let &Self { cut_by_depth, cut_by_attenuation, cut_by_roulette, clamped, unclamped, .. } = self;
        let cuts = [cut_by_depth, cut_by_attenuation, cut_by_roulette];
        let mut counts = [camera, reflected, refracted, glossy, bounced, shadow, hidden, 0, 0, 0];
        counts[7..].copy_from_slice(&cuts);
        (counts, [clamped, unclamped])
    }

    /// What [`Counters::to_arrays`] gives.
    #[must_use]
    pub fn of_arrays(counts: [u64; 10], [clamped, unclamped]: [f64; 2]) -> Self {
        let [camera, reflected, refracted, glossy, bounced, shadow, hidden, ..] = counts;
        let [.., cut_by_depth, cut_by_attenuation, cut_by_roulette] = counts;
        Self {
            camera,
            reflected,
            refracted,
            glossy,
            bounced,
            shadow,
            hidden,
            cut_by_depth,
            cut_by_attenuation,
            cut_by_roulette,
            clamped,
            unclamped,
        }
    }

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
        self.cut_by_roulette += other.cut_by_roulette;
        self.clamped += other.clamped;
        self.unclamped += other.unclamped;
    }
}
