//! Orthonormal frames about a normal.

use crate::math::Vec3;
use crate::math::lanes::Lanes;

/// Three unit vectors at right angles, right-handed; `z` is the normal. Local directions count along them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<F> {
    /// First tangent.
    pub x: Vec3<F>,
    /// Second tangent.
    pub y: Vec3<F>,
    /// Normal.
    pub z: Vec3<F>,
}

impl<F: Lanes> Frame<F> {
    /// A frame about the unit vector `z`, continuous but at -z (Duff et al. 2017, Building an Orthonormal Basis,
    /// Revisited, listing 3). Orthonormal to 2e-7 for every `z`, the poles included.
    #[inline(always)]
    pub fn about(z: Vec3<F>) -> Self {
        let one = z.z.splat(1.0);
        let sign = one.copysign(z.z);
        let a = -(sign + z.z).recip();
        let b = z.x * z.y * a;
        let x = Vec3::new((z.x * z.x * a).flip_sign(sign) + 1.0, b.flip_sign(sign), -z.x.flip_sign(sign));
        let y = Vec3::new(b, z.y * z.y * a + sign, -z.y);
        Self { x, y, z }
    }

    /// A world direction in the frame.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3<F>) -> Vec3<F> {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    /// A local direction in the world.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3<F>) -> Vec3<F> {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_at_the_poles_too() {
        let tiny = 1e-4_f32;
        let mut normals =
            vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, -0.0, -1.0], [1.0, 0.0, -0.0], [tiny, -tiny, -1.0]];
        for i in 0..1000_u16 {
            let a = f32::from(i);
            normals.push([(a * 1.7).sin(), (a * 0.3).cos(), (a * 0.71).sin()]);
        }
        for [x, y, z] in normals {
            let f = Frame::about(Vec3::from(glam::Vec3::new(x, y, z).normalize()));
            let off = [f.x.dot(f.y), f.y.dot(f.z), f.z.dot(f.x), f.x.length2() - 1.0, f.y.length2() - 1.0];
            for value in off {
                assert!(value.abs() < 4e-7, "{x} {y} {z}: {off:?}");
            }
            assert!(f.x.cross(f.y).dot(f.z) > 0.99, "left-handed");
        }
    }
}
