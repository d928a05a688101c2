//! Rectangles and triangles as they are seen from a point, drawn from uniformly by solid angle; any width.
//!
//! Everything is counted from the point. Sizes and distances should be about one, so that products of three neither over- nor
//! underflow: callers scale by the size of the shape.

use crate::math::Vec3;
use crate::math::lanes::{Compare, Lanes, MaskLanes};

/// A rectangle seen from a point.
///
/// Urena, Fajardo and King 2013, *An Area-Preserving Parametrization for Spherical Rectangles*. Their angles are sums of
/// arcs that cancel where the rectangle looks small; here the map starts from its value at one edge and adds what changes from there,
/// which keeps it exact to the angle between neighbouring numbers over the angle that the rectangle fills.
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle<F> {
    x: [F; 2],
    y: [F; 2],
    z: F,
    /// From the point to the corners at the lower end of x.
    left: [F; 2],
    solid_angle: F,
}

impl<F: Lanes> SphericalRectangle<F> {
    /// From its ends along x and along y, and its distance along z.
    #[inline(always)]
    pub fn new(x: [F; 2], y: [F; 2], z: F) -> Self {
        let z = z.abs();
        let ([x0, x1], [y0, y1]) = (x, y);
        let z2 = z * z;
        let ([xx0, xx1], [yy0, yy1]) = ([x0 * x0, x1 * x1], [y0 * y0, y1 * y1]);
        let [r00, r01] = [(xx0 + yy0 + z2).sqrt(), (xx0 + yy1 + z2).sqrt()];
        let [r10, r11] = [(xx1 + yy0 + z2).sqrt(), (xx1 + yy1 + z2).sqrt()];
        // As two triangles that share a diagonal (van Oosterom and Strackee 1983, The Solid Angle of a Plane Triangle, equation 8),
        // whose half angles add up: relatively exact where they are small.
        let volume = z * (x1 - x0) * (y1 - y0);
        let (xm, ym) = (x0 * x1, y0 * y1);
        let diagonal = xm + ym + z2;
        let right = r00 * r10 * r11 + (xm + yy0 + z2) * r11 + (xx1 + ym + z2) * r00 + diagonal * r10;
        let upper = r00 * r01 * r11 + (xx0 + ym + z2) * r11 + (xm + yy1 + z2) * r00 + diagonal * r01;
        let small = (volume * (right + upper)).atan2(right * upper - volume * volume) * 2.0;
        let is_small = small.ge(0.0) & small.lt(0.5);
        let mut solid_angle = small;
        if !is_small.all() {
            // As arcs at the corners, two to an edge: exact to rounding of the whole.
            let edge = [edge(z, x, y1, [r01, r11]), edge(z, x, y0, [r00, r10])];
            solid_angle = F::select(is_small, small, edge[0] - edge[1]);
        }
        Self { x, y, z, left: [r00, r01], solid_angle }
    }

    /// In sr, from 0 to 2 pi.
    #[inline(always)]
    pub fn solid_angle(&self) -> F {
        self.solid_angle
    }

    /// Where on the rectangle a pair of numbers leads: x and y. The density is 1 over the solid angle.
    #[inline(always)]
    pub fn sample(&self, [u, v]: [F; 2]) -> [F; 2] {
        let Self { x: [x0, x1], y: [y0, y1], z, left: [r00, r01], solid_angle } = *self;
        let (z2, xx0) = (z * z, x0 * x0);
        let b0 = (y0 * y0 + z2).sqrt();
        // Urena's angle at the lower end of x, its sine and cosine times a common factor.
        let plain = y0 * r01 - y1 * r00;
        let alike = (y0 * y1).gt(0.0);
        let sum = F::select(alike, y0 * r01 + y1 * r00, z.splat(1.0));
        let without_difference = -(xx0 + z2) * (y1 - y0) * (y0 + y1) / sum;
        let k = z * F::select(alike, without_difference, plain);
        let (sin_k, cos_k) = (x0 * k, -(xx0 * y0 * y1 + z2 * r00 * r01));
        let first = z * r00 * k / b0;
        // What is added to the angle.
        let (s, c) = (u * solid_angle * 0.5).sin_cos();
        let (sin, versed) = (s * c * 2.0, s * s * 2.0);
        let over = first + y0 / b0 * (cos_k * versed + sin_k * sin);
        let under = sin_k * (-versed + 1.0) + cos_k * sin;
        let narrow = z / b0 * under.abs();
        let root = ((over.abs() - narrow) * (over.abs() + narrow)).max(1e-35).sqrt();
        let x = (z * under.abs() / root).flip_sign(over).flip_sign(under);
        let x = Compare::<F>::min(Compare::<F>::max(x, x0), x1);
        let d2 = x * x + z2;
        let (h0, h1) = (y0 / (d2 + y0 * y0).sqrt(), y1 / (d2 + y1 * y1).sqrt());
        let h = h0 + v * (h1 - h0);
        let y = h * (d2 / ((-h + 1.0) * (h + 1.0)).max(1e-12)).sqrt();
        [x, Compare::<F>::min(Compare::<F>::max(y, y0), y1)]
    }

    /// The same as fractions of the edges, from -1 to 1.
    #[inline(always)]
    pub fn sample_within(&self, u2: [F; 2]) -> [F; 2] {
        let [x, y] = self.sample(u2);
        [within(x, self.x), within(y, self.y)]
    }
}

#[inline(always)]
fn within<F: Lanes>(x: F, [x0, x1]: [F; 2]) -> F {
    ((x - x0 + (x - x1)) / (x1 - x0)).clamp(-1.0, 1.0)
}

/// The arcs at both ends of an edge along x, their difference.
#[inline(always)]
fn edge<F: Lanes>(z: F, [x0, x1]: [F; 2], y: F, [r0, r1]: [F; 2]) -> F {
    (z * y * (x1 * r0 - x0 * r1)).atan2(z * z * r0 * r1 + x0 * x1 * y * y)
}

/// A triangle seen from a point.
///
/// Arvo 1995, *Stratified Sampling of Spherical Triangles*, without inverse functions: points of a great circle that make triangles of
/// a given solid angle with a given edge solve a linear equation (as in Peters 2021, *BRDF Importance Sampling for Polygonal
/// Lights*), and no angle of the triangle is ever formed.
#[derive(Clone, Copy, Debug)]
pub struct SphericalTriangle<F> {
    /// Unit vectors to the corners.
    corners: [Vec3<F>; 3],
    inverse_lengths: [F; 3],
    /// The volume that the unit vectors span, and what the tangent of half the solid angle divides it by, in two parts.
    g: [F; 3],
    solid_angle: F,
}

impl<F: Lanes> SphericalTriangle<F> {
    /// From the ways to its corners and the volume that they span, of either sign.
    #[inline(always)]
    pub fn new(ways: [Vec3<F>; 3], volume: F) -> Self {
        let [a, b, c] = ways;
        let inverse_lengths =
            [a.length2().max(1e-35).rsqrt(), b.length2().max(1e-35).rsqrt(), c.length2().max(1e-35).rsqrt()];
        let [ia, ib, ic] = inverse_lengths;
        let corners = [a * ia, b * ib, c * ic];
        let [a, b, c] = corners;
        let g = [volume.abs() * ia * ib * ic, (a + b).dot(c), a.dot(b) + 1.0];
        let solid_angle = g[0].atan2(g[1] + g[2]) * 2.0;
        Self { corners, inverse_lengths, g, solid_angle }
    }

    /// In sr, from 0 to 2 pi.
    #[inline(always)]
    pub fn solid_angle(&self) -> F {
        self.solid_angle
    }

    /// Barycentric coordinates of the point that a pair of numbers leads to; they are not negative and add up to 1. The density is 1 over the
    /// solid angle.
    #[inline(always)]
    pub fn sample(&self, [u, v]: [F; 2]) -> [F; 3] {
        let Self { corners: [a, b, c], inverse_lengths, g: [g0, g1, g2], solid_angle } = *self;
        // The corner of the part of the triangle that has u of its solid angle: between a and c, on the other side of b.
        let (s, cos) = (u * solid_angle * 0.5).sin_cos();
        let (ka, kc) = (g0 * cos - g1 * s, g2 * s);
        let r = a * ka + c * kc;
        let twice = a.dot(r) * 2.0 / r.length2().max(1e-35);
        let d = r * twice - a;
        let [da, dc] = [ka * twice - 1.0, kc * twice];
        // Between b and there, by the cosine of the angle from b.
        let cos_d = b.dot(d);
        let cos = -(v * (b - d).length2() * 0.5) + 1.0;
        // One more than the cosines, without cancellation where b and d are nearly opposite.
        let above = (b + d).length2() * 0.5;
        let t = (v * ((-v + 1.0) * 2.0 + v * above) / above.max(1e-35)).sqrt();
        let [ia, ib, ic] = inverse_lengths;
        let [wa, wb, wc] =
            [(da * t * ia).max(0.0), ((cos - t * cos_d) * ib).max(0.0), (dc * t * ic).max(0.0)];
        let scale = (wa + wb + wc).max(1e-35).recip();
        [wa * scale, wb * scale, wc * scale]
    }
}
