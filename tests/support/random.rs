//! Random numbers for tests: hashes of a count, the same every time.

#![allow(dead_code, reason = "each test program uses a part")]

use specula::math::Vec3;
use specula::sampling::pcg::pcg3d;

/// Numbers in [0, 1) by seed and count.
pub(crate) struct Random {
    seed: u32,
    count: u32,
}

impl Random {
    /// A sequence per seed.
    pub(crate) fn new(seed: u32) -> Self {
        Self { seed, count: 0 }
    }

    /// Three at once.
    pub(crate) fn triple(&mut self) -> [f32; 3] {
        self.count += 1;
        pcg3d([self.count, self.seed, 0x51ec]).map(|bits| (bits >> 8) as f32 / 16_777_216.0)
    }

    /// Two at once.
    pub(crate) fn pair(&mut self) -> [f32; 2] {
        let [u, v, _] = self.triple();
        [u, v]
    }

    /// One.
    pub(crate) fn unit(&mut self) -> f32 {
        self.triple()[0]
    }

    /// Between `low` and `high`, uniform in the logarithm.
    pub(crate) fn logarithmic(&mut self, low: f32, high: f32) -> f32 {
        low * (high / low).powf(self.unit())
    }

    /// A unit vector of the upper hemisphere, uniform, grazing ones among them.
    pub(crate) fn upper(&mut self) -> Vec3<f32> {
        let [u, v] = self.pair();
        from_angles(u.acos(), v * std::f32::consts::TAU)
    }

    /// A unit vector, uniform.
    pub(crate) fn direction(&mut self) -> Vec3<f32> {
        let [u, v] = self.pair();
        from_angles((2.0 * u - 1.0).acos(), v * std::f32::consts::TAU)
    }
}

/// The unit vector at an angle from +z and one about it.
pub(crate) fn from_angles(theta: f32, phi: f32) -> Vec3<f32> {
    Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}
