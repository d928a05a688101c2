//! The inverses of the circular functions.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use super::{Lanes, polynomial};

/// (asin x / x - 1) / x^2 in x^2, for |x| <= 1/2; leaves 5e-9 in asin x.
const ASIN: [f32; 5] = [0.166_667_52, 0.074_953_094, 0.045_469_154, 0.024_184_743, 0.042_158_388];

/// (atan x / x - 1) / x^2 in x^2, for |x| <= [`FAR`]; leaves 8e-10 in atan x.
const ATAN: [f32; 6] =
    [-0.333_333_16, 0.199_988_77, -0.142_605_9, 0.108_479_79, -0.076_448_806, 0.034_147_877];

/// A little above the tangent of 1/2: from there the sum with pi/4 reaches a coarser binade, so that its terms' errors are
/// small beside an ulp of it.
const FAR: f32 = 0.5464;

/// What the floats of pi / 2 and pi / 4 lack.
const FRAC_PI_2_LOW: f32 = -4.371_139e-8;
const FRAC_PI_4_LOW: f32 = -2.185_569_4e-8;

/// asin s = s + s^3 q(s^2), in two parts: s and the rest. Up to 1/2, s is |x|; above, asin |x| = pi/2 - 2 asin s with
/// s = sqrt((1 - |x|) / 2), which the mask says.
#[inline(always)]
fn reduced_asin<F: Lanes>(x: F) -> (F, F, F::Mask) {
    let magnitude = x.abs();
    let above = magnitude.gt(0.5);
    let square = F::select(above, magnitude.mul_add(x.splat(-0.5), x.splat(0.5)), x.square());
    let s = F::select(above, square.sqrt(), magnitude);
    (s, s * square * polynomial(square, ASIN), above)
}

#[inline(always)]
pub(in super::super) fn asin<F: Lanes>(x: F) -> F {
    let (s, rest, above) = reduced_asin(x);
    let complement = (s * -2.0 + FRAC_PI_2) - (rest * 2.0 - FRAC_PI_2_LOW);
    F::select(above, complement, s + rest).copysign(x)
}

/// 2 asin s near one, pi - 2 asin s near minus one, pi/2 - asin x between.
#[inline(always)]
pub(in super::super) fn acos<F: Lanes>(x: F) -> F {
    let (s, rest, above) = reduced_asin(x);
    let negative = x.lt(0.0);
    let (factor, flipped) = (F::select(above, x.splat(2.0), x.splat(1.0)), above & negative);
    let right_angles = F::select(above, F::select(flipped, x.splat(2.0), x.splat(0.0)), x.splat(1.0));
    // Between, the sign of asin x is that of x and it is subtracted; near one it is added, near minus one subtracted.
    let factor = F::select(above ^ negative, factor, -factor);
    let low = rest.mul_add(factor, right_angles * FRAC_PI_2_LOW);
    s.mul_add(factor, right_angles * FRAC_PI_2) + low
}

/// By the addition theorem atan(n / d) = pi/4 + atan((n - d) / (n + d)), used above [`FAR`], with one division for both
/// cases.
#[inline(always)]
pub(in super::super) fn atan2<F: Lanes>(y: F, x: F) -> F {
    let (width, height) = (x.abs(), y.abs());
    let steep = height.gt(width);
    let n = F::select(steep, width, height);
    let d = F::select(steep, height, width);
    let far = n.gt(d * FAR);
    let (n, d) = (F::select(far, n - d, n), F::select(far, n + d, d));
    // 0 / 0 is to be zero, but NaN to stay.
    let ratio = n / F::select(d.lt(f32::MIN_POSITIVE), x.splat(f32::MIN_POSITIVE), d);
    let square = ratio.square();
    let angle = (square * ratio).mul_add(polynomial(square, ATAN), ratio);
    in_octant(angle, far, steep, x).copysign(y)
}

/// `angle` plus pi/4 if `far`, then reflected at pi/4 if `steep` and at pi/2 if x is negative: in sum a multiple of pi/4 plus
/// or minus `angle`.
#[inline(always)]
fn in_octant<F: Lanes>(angle: F, far: F::Mask, steep: F::Mask, x: F) -> F {
    let left = x.splat(1.0).copysign(x).lt(0.0);
    let octants = F::select(far, x.splat(1.0), x.splat(0.0));
    let octants = F::select(steep, -octants + 2.0, octants);
    let octants = F::select(left, -octants + 4.0, octants);
    let angle = F::select(steep ^ left, -angle, angle);
    octants.mul_add(x.splat(FRAC_PI_4), octants.mul_add(x.splat(FRAC_PI_4_LOW), angle))
}
