//! Vectors of three components over lanes: what shading computes with. Scalar geometry uses `glam`.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub};

use super::lanes::{Isa, Lanes, Select};

/// A vector, point or normal; one per lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<F> {
    /// First component.
    pub x: F,
    /// Second component.
    pub y: F,
    /// Third component.
    pub z: F,
}

impl<F> Vec3<F> {
    /// The vector (x, y, z).
    #[inline(always)]
    pub const fn new(x: F, y: F, z: F) -> Self {
        Self { x, y, z }
    }
}

impl<F: Lanes> Vec3<F> {
    /// `v` in all lanes of the kind of `like`.
    #[inline(always)]
    pub fn splat(like: F, v: Vec3<f32>) -> Self {
        Self::new(like.splat(v.x), like.splat(v.y), like.splat(v.z))
    }
    /// The vectors whose components are in the rows, one per lane.
    #[inline(always)]
    pub fn load<const N: usize>(isa: F::Isa, rows: &[[f32; N]; 3]) -> Self {
        Self::new(isa.load(&rows[0]), isa.load(&rows[1]), isa.load(&rows[2]))
    }
    /// Writes the components to the rows.
    #[inline(always)]
    pub fn store<const N: usize>(self, rows: &mut [[f32; N]; 3]) {
        self.x.store(&mut rows[0]);
        self.y.store(&mut rows[1]);
        self.z.store(&mut rows[2]);
    }
    /// The scalar product.
    #[inline(always)]
    pub fn dot(self, b: Self) -> F {
        self.x.mul_add(b.x, self.y.mul_add(b.y, self.z * b.z))
    }
    /// The vector product, right-handed.
    #[inline(always)]
    pub fn cross(self, b: Self) -> Self {
        Self::new(self.y * b.z - self.z * b.y, self.z * b.x - self.x * b.z, self.x * b.y - self.y * b.x)
    }
    /// The squared length.
    #[inline(always)]
    pub fn length2(self) -> F {
        self.dot(self)
    }
    /// The length.
    #[inline(always)]
    pub fn length(self) -> F {
        self.length2().sqrt()
    }
    /// The unit vector of the same direction; not finite for the zero vector. Squares must not over- or underflow.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * self.length2().rsqrt()
    }
    /// The unit vector of the same direction; `other` where there is none, or where squares over- or underflow.
    #[inline(always)]
    pub fn normalize_or(self, other: Self) -> Self {
        let inverse = self.length().recip();
        let exists = inverse.is_finite() & inverse.gt(0.0);
        Self::select(exists, self * F::select(exists, inverse, inverse.splat(1.0)), other)
    }
    /// The magnitude of each component.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }
    /// `self` times one number for all lanes.
    #[inline(always)]
    pub fn scale(self, s: f32) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
    /// `self + t * d`.
    #[inline(always)]
    pub fn mul_add(self, t: F, d: Self) -> Self {
        Self::new(t.mul_add(d.x, self.x), t.mul_add(d.y, self.y), t.mul_add(d.z, self.z))
    }
    /// `self` mirrored at the plane with unit normal `n`: 2 (self . n) n - self.
    #[inline(always)]
    pub fn reflect(self, n: Self) -> Self {
        n * (self.dot(n) * 2.0) - self
    }
    /// Lane `i`. Slow; for tests and rare cases.
    #[inline(always)]
    pub fn extract(self, i: usize) -> Vec3<f32> {
        Vec3::new(self.x.extract(i), self.y.extract(i), self.z.extract(i))
    }
}

impl<F: Lanes> Select for Vec3<F> {
    type Mask = F::Mask;
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self::new(F::select(mask, yes.x, no.x), F::select(mask, yes.y, no.y), F::select(mask, yes.z, no.z))
    }
}

impl<F: Lanes> Neg for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<F: Lanes> Add for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.x + b.x, self.y + b.y, self.z + b.z)
    }
}

impl<F: Lanes> Sub for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}

impl<F: Lanes> Mul<F> for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: F) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl<F: Lanes> Div<F> for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    #[expect(clippy::suspicious_arithmetic_impl, reason = "one division instead of three")]
    fn div(self, s: F) -> Self {
        self * s.recip()
    }
}

impl<F: Lanes> AddAssign for Vec3<F> {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

impl<F: Lanes> MulAssign<F> for Vec3<F> {
    #[inline(always)]
    fn mul_assign(&mut self, s: F) {
        *self = *self * s;
    }
}

impl From<glam::Vec3> for Vec3<f32> {
    #[inline(always)]
    fn from(v: glam::Vec3) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl From<Vec3<f32>> for glam::Vec3 {
    #[inline(always)]
    fn from(v: Vec3<f32>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_follow_the_axes() {
        let (x, y) = (Vec3::new(1.0_f32, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0));
        assert_eq!(x.cross(y), Vec3::new(0.0, 0.0, 1.0), "right-handed");
        assert!(x.dot(y) == 0.0, "orthogonal");
        let v = Vec3::new(3.0_f32, 4.0, 12.0);
        assert!((v.length() - 13.0).abs() < 1e-5, "length {}", v.length());
        assert!((v.normalize().length2() - 1.0).abs() < 1e-6, "unit");
    }

    #[test]
    fn reflection_keeps_the_normal_part() {
        let (v, n) = (Vec3::new(1.0_f32, 2.0, 3.0), Vec3::new(0.0, 0.0, 1.0));
        assert_eq!(v.reflect(n), Vec3::new(-1.0, -2.0, 3.0), "tangential part is negated");
    }
}
