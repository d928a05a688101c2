//! How much a smooth interface reflects.
//!
//! Unpolarised light; each interface on its own. All forms are arranged so that nothing cancels where reflectance is
//! small: near-matched indices keep seven digits where the textbook's form keeps none.

use crate::math::Rgb;
use crate::math::lanes::Lanes;

/// What happens at a dielectric interface.
#[derive(Clone, Copy, Debug)]
pub struct Interface<F: Lanes> {
    /// Reflected fraction of the power, in [0, 1]; exactly 1 under total internal reflection.
    pub reflectance: F,
    /// Cosine of the refracted direction with the normal, not negative; 0 under total internal reflection.
    pub cos_t: F,
    /// Total internal reflection: nothing is transmitted.
    pub total: F::Mask,
}

/// Where light goes at a dielectric interface, without how much of it.
#[derive(Clone, Copy, Debug)]
pub struct Bend<F: Lanes> {
    /// Cosine of the refracted direction with the normal, not negative; 0 under total internal reflection.
    pub cos_t: F,
    /// Total internal reflection: nothing is transmitted.
    pub total: F::Mask,
    /// eta^2 - 1.
    d: F,
    /// eta times the cosine within.
    g: F,
}

/// Refraction of the cosine `cos_i` in [0, 1], `eta` = n_t / n_i > 0.
///
/// With d = eta^2 - 1, g = sqrt(d + cos_i^2) = eta cos_t. The same g gives reflectance and direction, and decides total
/// reflection for both.
#[inline(always)]
pub fn bend<F: Lanes>(cos_i: F, eta: F) -> Bend<F> {
    let c = cos_i.clamp(0.0, 1.0);
    let d = (eta - 1.0) * (eta + 1.0);
    let g2 = c.mul_add(c, d);
    let matched = d.eq(0.0);
    let total = g2.le(0.0) & !matched;
    // Between equal media light goes straight on, though the square of a grazing cosine underflows.
    let g = F::select(matched, c, g2.max(0.0).sqrt());
    Bend { cos_t: F::select(total, eta.splat(0.0), (g / eta).min(1.0)), total, d, g }
}

/// The exact answer for a dielectric: `cos_i` in [0, 1] on the side of `eta`'s denominator, `eta` = n_t / n_i > 0.
///
/// r_s = -d / (cos_i + g)^2 and r_p = r_s (cos_i g - sin_i^2) / (cos_i g + sin_i^2) with d and g as in [`bend`]: Fresnel's
/// equations (Born and Wolf 1999, Principles of Optics, 1.5.2) without a difference of nearly equal numbers.
#[inline(always)]
pub fn dielectric<F: Lanes>(cos_i: F, eta: F) -> Interface<F> {
    let one = eta.splat(1.0);
    let zero = eta.splat(0.0);
    let c = cos_i.clamp(0.0, 1.0);
    let Bend { cos_t, total, d, g } = bend(c, eta);
    let s2 = (one - c) * (c + 1.0);
    let sum = c + g;
    let r_s = -d / (sum * sum);
    let r_p = r_s * (c * g - s2) / (c * g + s2);
    let r = (r_s * r_s + r_p * r_p) * 0.5;
    let r = F::select(d.eq(0.0), zero, F::select(total, one, r.min(1.0)));
    Interface { reflectance: r, cos_t, total }
}

/// The exact reflectance of a conductor with the complex index `eta + i k`, relative to the outer medium, in [0, 1].
///
/// 1 - R is computed first, from sums of positive terms only (Born and Wolf 1999, 14.2, rearranged), so that good
/// mirrors keep their losses. `k` up to 1e6; not for `eta` near 1 with `k` near 0, where only the absolute error is small.
#[inline(always)]
pub fn conductor<F: Lanes>(cos_i: F, eta: F, k: F) -> F {
    let one = eta.splat(1.0);
    let c = cos_i.clamp(0.0, 1.0);
    let s2 = (one - c) * (c + 1.0);
    // eta^2 - k^2 - sin^2 without 1 - 1: steep directions have a small sine, grazing ones meet eta^2 near 1.
    let c2 = c * c;
    let steep = (eta - k) * (eta + k) - s2;
    let grazing = (eta - 1.0) * (eta + 1.0) + (c2 - k * k);
    let t0 = F::select(c2.gt(0.5), steep, grazing);
    let im = eta * k * 2.0;
    let ab = t0.mul_add(t0, im * im).sqrt();
    let large = ((ab + t0.abs()) * 0.5).sqrt();
    let a = F::select(t0.ge(0.0), large, im * 0.5 / large.max(1e-30));
    let t1 = c.mul_add(c, ab);
    let t2 = a * c * 2.0;
    let f_s = t2 * 2.0 / (t1 + t2).max(1e-30);
    let t3 = ab.mul_add(c * c, s2 * s2);
    let t4 = t2 * s2;
    let q = t4 * 2.0 / (t3 + t4).max(1e-30);
    let lost = (f_s + f_s + q * (one - f_s)) * 0.5;
    (one - lost).clamp(0.0, 1.0)
}

/// [`conductor`] per channel.
#[inline(always)]
pub fn conductor_rgb<F: Lanes>(cos_i: F, eta: Rgb<F>, k: Rgb<F>) -> Rgb<F> {
    Rgb::new(conductor(cos_i, eta.r, k.r), conductor(cos_i, eta.g, k.g), conductor(cos_i, eta.b, k.b))
}

/// Reflectance at normal incidence of a dielectric.
#[inline(always)]
pub fn normal_incidence<F: Lanes>(eta: F) -> F {
    ((eta - 1.0) / (eta + 1.0)).square()
}

/// Schlick's approximation from the reflectance at normal incidence (Schlick 1994, An Inexpensive BRDF Model, eq. 15).
#[inline(always)]
pub fn schlick<F: Lanes>(cos_i: F, r0: F) -> F {
    let one = r0.splat(1.0);
    let m = one - cos_i.clamp(0.0, 1.0);
    (one - r0).mul_add(m.pow5(), r0)
}

/// [`schlick`] per channel.
#[inline(always)]
pub fn schlick_rgb<F: Lanes>(cos_i: F, r0: Rgb<F>) -> Rgb<F> {
    let m5 = (-cos_i.clamp(0.0, 1.0) + 1.0).pow5();
    r0 + (Rgb::gray(m5.splat(1.0)) - r0) * m5
}

/// The cosine, besides 0 and 1, at which [`schlick_edge`] is exact.
pub const EDGE_COSINE: f32 = 1.0 / 7.0;

/// The coefficient with which [`schlick_edge`] meets the reflectance `known` at [`EDGE_COSINE`].
#[inline(always)]
pub fn edge_term<F: Lanes>(r0: F, known: F) -> F {
    // c (1 - c)^6 at c = 1/7.
    const SHAPE: f32 = 46_656.0 / 823_543.0;
    (schlick(r0.splat(EDGE_COSINE), r0) - known) * (1.0 / SHAPE)
}

/// Schlick's approximation less `edge` c (1 - c)^6, within [0, 1] (Lazányi and Szirmay-Kalos 2005, Fresnel Term
/// Approximations for Metals, with the coefficient taken from the reflectance near 82 degrees).
#[inline(always)]
pub fn schlick_edge<F: Lanes>(cos_i: F, r0: F, edge: F) -> F {
    let c = cos_i.clamp(0.0, 1.0);
    let m = -c + 1.0;
    let m5 = m.pow5();
    ((-r0 + 1.0).mul_add(m5, r0) - edge * c * m5 * m).clamp(0.0, 1.0)
}

/// Mean reflectance over the hemisphere, weighted by the cosine, of a dielectric seen from the side of the lower index
/// `1` into `n` >= 1, in double precision (closed form: Walsh 1926, The Reflection Factor of a Polished Glass Surface;
/// by quadrature near 1, where that cancels).
#[must_use]
pub fn average_outside(n: f64) -> f64 {
    if n < 1.05 {
        return average_by_quadrature(n);
    }
    let (n2, n4) = (n * n, n.powi(4));
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n * n2 * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
}

/// By the factors that do not cancel near 1.
fn average_by_quadrature(n: f64) -> f64 {
    let d = (n - 1.0) * (n + 1.0);
    cosine_average(|c| {
        let g = (d + c * c).sqrt();
        let s2 = (1.0 - c) * (1.0 + c);
        let r_s = -d / (c + g).powi(2);
        let r_p = r_s * (c * g - s2) / (c * g + s2);
        (r_s * r_s + r_p * r_p) * 0.5
    })
}

/// The mean of `f` over the hemisphere, weighted by the cosine that it is a function of: midpoints, refined towards grazing,
/// where near-matched interfaces reflect.
pub(super) fn cosine_average(f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 4096;
    let at = |i: u32| {
        let x = (f64::from(i) + 0.5) / f64::from(STEPS);
        f(x * x * x) * 2.0 * x * x * x * 3.0 * x * x
    };
    (0..STEPS).map(at).sum::<f64>() / f64::from(STEPS)
}
