//! Normals from pictures, in tangent space.

use crate::math::Vec3;
use crate::math::lanes::Lanes;
use crate::texture::{Mapped, Spot};

/// A relief: where the normal leans to, seen from the surface.
///
/// Red, green and blue from 0 to 1 stand for -1 to 1 along u, along v and along the normal of the smooth surface. What is
/// between texels is interpolated and brought to length 1 afterwards.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMap {
    /// The picture and how it lies.
    pub map: Mapped,
    /// What the lean is multiplied by.
    pub strength: f32,
    /// Whether green counts against v.
    pub flip_y: bool,
}

impl NormalMap {
    /// The normal at a spot: a unit vector whose x is along u, y along v; z where the picture says nothing sensible.
    #[inline(always)]
    pub fn at<F: Lanes>(&self, spot: impl Into<Spot<F>>) -> Vec3<F> {
        let [r, g, b, _] = self.map.at(spot.into()).map(|c| c * 2.0 - 1.0);
        let along_v = if self.flip_y { -self.strength } else { self.strength };
        let up = Vec3::new(r.splat(0.0), r.splat(0.0), r.splat(1.0));
        Vec3::new(r * self.strength, g * along_v, b).normalize_or(up)
    }
}
