//! From the unit square to discs, hemispheres, cones, triangles and lobes, any width; each with its density beside it.
//!
//! Directions are unit, in a local frame with the axis along z. Densities name their measure. All maps accept every pair in
//! [0, 1)^2, the corners included, and give finite values of positive density.
//!
//! Round shapes start from the concentric disc, which keeps neighbours together, and so the stratification of the numbers.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

use crate::math::Vec3;
use crate::math::lanes::{Compare, Lanes};

/// Density of [`disc`] by area, on the unit disc.
pub const DISC_PDF: f32 = FRAC_1_PI;
/// Density of [`uniform_hemisphere`] by solid angle.
pub const UNIFORM_HEMISPHERE_PDF: f32 = 1.0 / TAU;
/// Density of [`uniform_sphere`] by solid angle.
pub const UNIFORM_SPHERE_PDF: f32 = 0.5 / TAU;

/// The square [0, 1)^2 to (-1, 1)^2. Numbers stand for the centres of cells of 2^-24, exactly: neither a corner nor
/// the centre itself is hit by a random number.
#[inline(always)]
fn centred<F: Lanes>(u: F) -> F {
    u * 2.0 + (1.0 / 16_777_216.0 - 1.0)
}

/// A point of the unit disc, uniform by area; never on the rim.
///
/// Shirley and Chiu 1997, *A Low Distortion Map Between Disk and Square*.
#[inline(always)]
pub fn disc<F: Lanes>([u, v]: [F; 2]) -> [F; 2] {
    let [x, y, _] = disc_with_radius(centred(u), centred(v));
    [x, y]
}

/// The point of the disc and its distance from the centre, which is exact.
#[inline(always)]
fn disc_with_radius<F: Lanes>(a: F, b: F) -> [F; 3] {
    let along_x = Compare::<F>::gt(a.abs(), b.abs());
    let r = F::select(along_x, a, b);
    let side = F::select(along_x, b, a);
    let safe_r = F::select(r.eq(0.0), r.splat(1.0), r);
    // At most an eighth of a turn to either side of the axis.
    let (sin, cos) = (side / safe_r * 0.125).sin_cos_turns();
    [r * F::select(along_x, cos, sin), r * F::select(along_x, sin, cos), r.abs()]
}

/// The pair that [`disc`] maps to (x, y), for a point of the unit disc.
#[inline(always)]
pub fn disc_inverse<F: Lanes>([x, y]: [F; 2]) -> [F; 2] {
    let along_x = Compare::<F>::gt(x.abs(), y.abs());
    let (main, other) = (F::select(along_x, x, y), F::select(along_x, y, x));
    let r = (x * x + y * y).sqrt().copysign(main);
    let safe_main = F::select(main.eq(0.0), r.splat(1.0), main);
    let side = r * (other / safe_main).atan() * (1.0 / FRAC_PI_4);
    let to_unit = |a: F| (a * 0.5 + 0.5).clamp(0.0, ONE_MINUS_EPSILON);
    [to_unit(F::select(along_x, r, side)), to_unit(F::select(along_x, side, r))]
}

/// The greatest number below 1.
const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// A direction of the upper hemisphere, with density proportional to the cosine; z > 0.
#[inline(always)]
pub fn cosine_hemisphere<F: Lanes>([u, v]: [F; 2]) -> Vec3<F> {
    let [x, y, r] = disc_with_radius(centred(u), centred(v));
    // In factors: near the horizon 1 - r^2 would cancel.
    let z = ((-r + 1.0) * (r + 1.0)).sqrt();
    Vec3::new(x, y, z)
}

/// Density of [`cosine_hemisphere`] by solid angle; zero below the horizon.
#[inline(always)]
pub fn cosine_hemisphere_pdf<F: Lanes>(cos_theta: F) -> F {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// The pair that [`cosine_hemisphere`] maps to `w`, for z >= 0.
#[inline(always)]
pub fn cosine_hemisphere_inverse<F: Lanes>(w: Vec3<F>) -> [F; 2] {
    disc_inverse([w.x, w.y])
}

/// A direction of the upper hemisphere, uniform by solid angle; z > 0.
#[inline(always)]
pub fn uniform_hemisphere<F: Lanes>(u: [F; 2]) -> Vec3<F> {
    cone(u, u[0].splat(1.0))
}

/// A direction of the sphere, uniform by solid angle.
#[inline(always)]
pub fn uniform_sphere<F: Lanes>([u, v]: [F; 2]) -> Vec3<F> {
    let [x, y, r] = disc_with_radius(centred(u), centred(v));
    // As a cone of 1 - cos = 2, but in factors: 2 - 2 r^2 would cancel at the far pole.
    let scale = ((-r + 1.0) * (r + 1.0)).sqrt() * 2.0;
    Vec3::new(x * scale, y * scale, -(r * r * 2.0) + 1.0)
}

/// A direction within a cone about z, uniform by solid angle. The cone is given by 1 - cos of its half angle, in (0, 2]:
/// see [`one_minus_cos_of_sin2`]; narrow cones lose no precision.
///
/// 1 - cos is uniform over a cone (Archimedes), as r^2 is over a disc.
#[inline(always)]
pub fn cone<F: Lanes>([u, v]: [F; 2], one_minus_cos_max: F) -> Vec3<F> {
    let [x, y, r] = disc_with_radius(centred(u), centred(v));
    let h = r * r * one_minus_cos_max;
    // sin = sqrt(h (2 - h)), of which the disc has the factor r already.
    let scale = (one_minus_cos_max * (-h + 2.0)).sqrt();
    Vec3::new(x * scale, y * scale, -h + 1.0)
}

/// Density of [`cone`] by solid angle, inside.
#[inline(always)]
pub fn cone_pdf<F: Lanes>(one_minus_cos_max: F) -> F {
    (one_minus_cos_max * TAU).recip()
}

/// The pair that [`cone`] maps to `w`, for `w` inside.
#[inline(always)]
pub fn cone_inverse<F: Lanes>(w: Vec3<F>, one_minus_cos_max: F) -> [F; 2] {
    let scale = (one_minus_cos_max * (-one_minus_cos(w) + 2.0)).sqrt();
    // Zero only opposite the axis, where the azimuth is lost and any point of the rim will do.
    let safe_scale = F::select(scale.eq(0.0), scale.splat(1.0), scale);
    disc_inverse([w.x / safe_scale, w.y / safe_scale])
}

/// 1 - cos of the angle between the unit vector `w` and z, without cancellation near z.
#[inline(always)]
pub fn one_minus_cos<F: Lanes>(w: Vec3<F>) -> F {
    let upper = w.z.gt(0.0);
    let sin2 = w.x * w.x + w.y * w.y;
    F::select(upper, sin2 / (w.z.max(0.0) + 1.0), -w.z + 1.0)
}

/// 1 - cos of an angle of at most a quarter turn with this squared sine, in [0, 1]; without cancellation at small angles.
/// A sphere of radius R seen from a distance d > R fills a cone with sin^2 = (R/d)^2.
#[inline(always)]
pub fn one_minus_cos_of_sin2<F: Lanes>(sin2: F) -> F {
    sin2 / ((-sin2 + 1.0).max(0.0).sqrt() + 1.0)
}

/// Barycentric coordinates of a point of a triangle, uniform by area: density 1 / area; they are not negative and add up
/// to 1.
///
/// Heitz 2019, *A Low-Distortion Map Between Triangle and Square*: the square is folded along its diagonal.
#[inline(always)]
pub fn triangle<F: Lanes>([u, v]: [F; 2]) -> [F; 3] {
    let above = Compare::<F>::gt(v, u);
    let half_small = F::select(above, u, v) * 0.5;
    let large = F::select(above, v, u);
    let rest = large - half_small;
    [F::select(above, half_small, rest), F::select(above, rest, half_small), -large + 1.0]
}

/// The pair that [`triangle`] maps to these barycentric coordinates.
#[inline(always)]
pub fn triangle_inverse<F: Lanes>([b0, b1, _]: [F; 3]) -> [F; 2] {
    let above = Compare::<F>::gt(b1, b0);
    let large = (b0 + b1).min(ONE_MINUS_EPSILON);
    [F::select(above, b0 * 2.0, large), F::select(above, large, b1 * 2.0)]
}

/// A direction about z with density proportional to cos^e, e >= 0: the first number turns it, the second bends it.
/// z > 0 but for exponents near zero, where it may round to 0.
///
/// Phong's lobe as sampled by Shaffer after Suffern: cos = (1 - v)^(1 / (e + 1)). The sine is taken from
/// the logarithm of the cosine: from the cosine itself nothing would be left of it beyond e = 1e6.
#[inline(always)]
pub fn power_cosine<F: Lanes>([u, v]: [F; 2], exponent: F) -> Vec3<F> {
    let ln_cos = (-v).ln_1p() / (exponent + 1.0);
    let sin_theta = (-(ln_cos * 2.0).exp_m1()).sqrt();
    let (sin_phi, cos_phi) = u.sin_cos_turns();
    Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, ln_cos.exp())
}

/// Density of [`power_cosine`] by solid angle: (e + 1) / (2 pi) cos^e above the horizon, zero below it.
#[inline(always)]
pub fn power_cosine_pdf<F: Lanes>(w: Vec3<F>, exponent: F) -> F {
    let pdf = (exponent + 1.0) * (1.0 / TAU) * power_of_cosine(w, exponent);
    F::select(w.z.ge(0.0), pdf, pdf.splat(0.0))
}

/// cos^e of the angle between the unit vector `w` and z: by the chord near z, so that it is as precise as `w` is for every e;
/// by z itself near the horizon. 0^0 is 1; only for z >= 0.
#[inline(always)]
pub fn power_of_cosine<F: Lanes>(w: Vec3<F>, exponent: F) -> F {
    let near = w.z.gt(0.5);
    let below_one = -one_minus_cos(w);
    let cos = F::select(near, below_one + 1.0, w.z);
    // What the sum has rounded away, over the cosine: the next term of the logarithm.
    let rest = F::select(near, (below_one - (cos - 1.0)) / cos, cos.splat(0.0));
    // The logarithm of the smallest denormal number: keeps 0 times infinity out of e = 0 at the horizon.
    ((cos.ln() + rest).max(-104.0) * exponent).exp()
}
