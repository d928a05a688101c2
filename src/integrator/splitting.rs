//! How many rays are sent where one would do.

/// At the first hits of a camera ray, several rays where one would be right already: the same answer on average, with
/// less noise than one ray and for less work than more camera rays. Later hits matter less and there are more of them:
/// one ray each.
///
/// Cook, Porter and Carpenter 1984 (Distributed Ray Tracing) send one of each kind and leave the rest to camera samples;
/// [`Splitting::NONE`] is that. Splitting of paths is older: Kahn and Marshall 1953 (Methods of Reducing Sample Size).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Splitting {
    /// Shadow rays to each light that has a size, at a hit that splits. 0 asks no such light there: glossy lobes find them by
    /// their own rays alone and diffuse ones not at all, which is for checks of either.
    pub lights: u32,
    /// Rays of each glossy lobe, at a hit that splits. 0 follows none: what only they find is missing, which is for checks
    /// of lights.
    pub glossy: u32,
    /// How many hits split, counted along each path from the camera.
    pub hits: u32,
}

impl Splitting {
    /// One ray of each kind everywhere.
    pub const NONE: Self = Self { lights: 1, glossy: 1, hits: 0 };

    /// The numbers of rays at the end of edge `depth` of a path, 1 being the camera ray.
    pub(super) fn at(&self, depth: u32) -> Counts {
        if depth > self.hits {
            return Counts { lights: 1, glossy: 1 };
        }
        Counts { lights: self.lights, glossy: self.glossy }
    }
}

/// Numbers of rays at one hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Counts {
    /// To each light that has a size.
    pub(super) lights: u32,
    /// Of each glossy lobe.
    pub(super) glossy: u32,
}

impl Counts {
    /// `lights` as a factor on densities.
    pub(super) fn light_factor(self) -> f32 {
        factor(self.lights)
    }

    /// `glossy` as a factor on densities.
    pub(super) fn glossy_factor(self) -> f32 {
        factor(self.glossy)
    }
}

#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^24 rays")]
fn factor(count: u32) -> f32 {
    count as f32
}
