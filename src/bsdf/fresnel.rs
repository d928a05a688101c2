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

/// The exact answer for a dielectric: `cos_i` in [0, 1] on the side of `eta`'s denominator, `eta` = n_t / n_i > 0.
///
/// With d = eta^2 - 1 and g = sqrt(d + cos_i^2) = eta cos_t, r_s = -d / (cos_i + g)^2 and
/// r_p = r_s (cos_i g - sin_i^2) / (cos_i g + sin_i^2): Fresnel's equations (Born and Wolf 1999, Principles of Optics,
/// 1.5.2) without a difference of nearly equal numbers. The same g decides total reflection and the direction.
#[inline(always)]
pub fn dielectric<F: Lanes>(cos_i: F, eta: F) -> Interface<F> {
    let one = eta.splat(1.0);
    let zero = eta.splat(0.0);
    let c = cos_i.clamp(0.0, 1.0);
    let d = (eta - 1.0) * (eta + 1.0);
    let g2 = c.mul_add(c, d);
    let matched = d.eq(0.0);
    let total = g2.le(0.0) & !matched;
    // Between equal media light goes straight on, though the square of a grazing cosine underflows.
    let g = F::select(matched, c, g2.max(0.0).sqrt());
    let s2 = (one - c) * (c + 1.0);
    let sum = c + g;
    let r_s = -d / (sum * sum);
    let r_p = r_s * (c * g - s2) / (c * g + s2);
    let r = (r_s * r_s + r_p * r_p) * 0.5;
    let r = F::select(matched, zero, F::select(total, one, r.min(1.0)));
    Interface { reflectance: r, cos_t: F::select(total, zero, (g / eta).min(1.0)), total }
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

/// Schlick's approximation for a dielectric: the cosine on the side of the lower index, 1 under total reflection.
///
/// Within 0.07 of [`dielectric`] for 1.3 <= eta <= 2.2 or its inverse; wrong outside, worst near 1.
#[inline(always)]
pub fn schlick_dielectric<F: Lanes>(cos_i: F, eta: F) -> F {
    let exact = dielectric(cos_i, eta);
    let c = F::select(eta.lt(1.0), exact.cos_t, cos_i);
    F::select(exact.total, eta.splat(1.0), schlick(c, normal_incidence(eta)))
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

/// [`average_outside`] seen from within the denser medium.
#[must_use]
pub fn average_inside(n: f64) -> f64 {
    1.0 - (1.0 - average_outside(n)) / (n * n)
}

/// Midpoints in the cosine, refined towards grazing, where near-matched interfaces reflect.
fn average_by_quadrature(n: f64) -> f64 {
    const STEPS: u32 = 4096;
    let d = (n - 1.0) * (n + 1.0);
    let sum: f64 = (0..STEPS)
        .map(|i| {
            let x = (f64::from(i) + 0.5) / f64::from(STEPS);
            let c = x * x * x;
            let g = (d + c * c).sqrt();
            let s2 = (1.0 - c) * (1.0 + c);
            let r_s = -d / (c + g).powi(2);
            let r_p = r_s * (c * g - s2) / (c * g + s2);
            (r_s * r_s + r_p * r_p) * 0.5 * 2.0 * c * 3.0 * x * x
        })
        .sum();
    sum / f64::from(STEPS)
}
