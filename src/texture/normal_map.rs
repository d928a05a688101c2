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
        let spot = spot.into();
        let [r, g, b, _] = self.map.at(spot).map(|c| c * 2.0 - 1.0);
        let [along_x, along_y] = self.map.turned(spot.uv);
        let along_v = if self.flip_y { -self.strength } else { self.strength };
        let up = Vec3::new(r.splat(0.0), r.splat(0.0), r.splat(1.0));
        Vec3::new(r * along_x * self.strength, g * along_y * along_v, b).normalize_or(up)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Pixels, Raster};
    use crate::texture::{Bitmap, Space, Wrap};
    use glam::Vec2;
    use std::sync::Arc;

    #[test]
    fn where_the_picture_is_mirrored_so_are_its_normals() {
        let pixels = Pixels::Floats { values: vec![[0.8, 0.6, 0.9, 1.0]], half: false };
        let raster = Raster {
            width: 1,
            height: 1,
            pixels,
            encoded: false,
            has_alpha: false,
            warnings: vec![],
            as_colour: vec![],
        };
        let bitmap = Arc::new(Bitmap::new(&raster, Space::Linear));
        let at = |wrap, uv: [f32; 2]| {
            let map =
                Mapped { bitmap: bitmap.clone(), wrap, repeat: Vec2::new(2.0, 1.0), offset: Vec2::ZERO };
            let n = NormalMap { map, strength: 1.0, flip_y: false }.at(uv);
            [n.x > 0.0, n.y > 0.0]
        };
        for (uv, mirrored) in [
            ([0.1, 0.2], [true, true]),
            ([0.6, 0.2], [false, true]),
            ([-0.1, 1.2], [false, false]),
            ([1.1, -1.5], [true, true]),
        ] {
            assert_eq!(at(Wrap::Mirror, uv), mirrored, "{uv:?}");
            assert_eq!(at(Wrap::Repeat, uv), [true, true], "{uv:?}");
        }
    }
}
