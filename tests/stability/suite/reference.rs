//! The textbook's formulas of surfaces in 200 bits, and what rounding makes of their arguments.

use super::big::{Big, big, dot, erf, pi, unit};

/// A distribution of the normals of facets; roughnesses along both tangents.
#[derive(Clone, Copy)]
pub(crate) struct Normals {
    /// Area of normals per solid angle.
    pub(crate) d: fn(&[Big], &[Big]) -> Big,
    /// Smith's auxiliary function.
    pub(crate) lambda: fn(&[Big], &[Big]) -> Big,
    /// Whether slopes are Gaussian.
    pub(crate) gaussian: bool,
}

/// Walter et al. 2007, eqs. 33 and 34, for two roughnesses.
pub(crate) const GGX: Normals = Normals { d: ggx_d, lambda: ggx_lambda, gaussian: false };

/// Walter et al. 2007, eqs. 25 and 26, for two roughnesses; the masking in full, not its rational approximation.
pub(crate) const BECKMANN: Normals = Normals { d: beckmann_d, lambda: beckmann_lambda, gaussian: true };

fn slope2(h: &[Big], alpha: &[Big]) -> Big {
    ((&h[0] / &alpha[0]).square() + (&h[1] / &alpha[1]).square()) / h[2].square()
}

fn ggx_d(h: &[Big], alpha: &[Big]) -> Big {
    if !h[2].is_positive() {
        return big(0.0);
    }
    let spread = (slope2(h, alpha) + 1.0).square();
    big(1.0) / (pi() * &alpha[0] * &alpha[1] * h[2].square().square() * spread)
}

fn beckmann_d(h: &[Big], alpha: &[Big]) -> Big {
    let cos4 = h[2].square().square();
    if !h[2].is_positive() || slope2(h, alpha) > big(1e6) {
        return big(0.0);
    }
    (-slope2(h, alpha)).exp() / (pi() * &alpha[0] * &alpha[1] * cos4)
}

/// The tangent of a direction, as the surface stretched to roughness 1 has it.
fn stretched_tan2(w: &[Big], alpha: &[Big]) -> Big {
    ((&w[0] * &alpha[0]).square() + (&w[1] * &alpha[1]).square()) / w[2].square()
}

fn ggx_lambda(w: &[Big], alpha: &[Big]) -> Big {
    ((stretched_tan2(w, alpha) + 1.0).sqrt() - 1.0) / 2.0
}

fn beckmann_lambda(w: &[Big], alpha: &[Big]) -> Big {
    let tan = stretched_tan2(w, alpha).sqrt();
    if !tan.is_positive() || tan < big(0.15) {
        // Beyond six standard deviations: 1e-18.
        return big(0.0);
    }
    let a = big(1.0) / tan;
    (-a.square()).exp() / (&a * pi().sqrt() * 2.0) - (big(1.0) - erf(&a)) / 2.0
}

impl Normals {
    pub(crate) fn g1(&self, w: &[Big], alpha: &[Big]) -> Big {
        big(1.0) / ((self.lambda)(w, alpha) + 1.0)
    }

    /// D G2 / (4 cos cos), and the density of directions mirrored at visible normals, where the directions do not both graze.
    pub(crate) fn mirrored(&self, wo: &[Big], wi: &[Big], alpha: &[Big]) -> Option<[Big; 2]> {
        let (h, _) = half(wo, wi)?;
        let (o, i) = ((self.lambda)(wo, alpha), (self.lambda)(wi, alpha));
        let d = (self.d)(&h, alpha);
        let value = &d / ((&o + i + 1.0) * &wo[2] * &wi[2] * 4.0);
        Some([value, d / ((o + 1.0) * &wo[2] * 4.0)])
    }
}

/// The half vector of two directions and its cosine with them, where they do not both graze.
pub(crate) fn half(wo: &[Big], wi: &[Big]) -> Option<(Vec<Big>, Big)> {
    let sum: Vec<_> = (0..3).map(|i| &wo[i] + &wi[i]).collect();
    let lit = wo[2].is_positive() && wi[2].is_positive() && dot(&sum, &sum) > big(1.1e-12);
    lit.then(|| {
        // Of unit vectors.
        (unit(&sum), dot(&sum, &sum).sqrt() / 2.0)
    })
}

/// Fresnel's equations for indices 1 and eta: reflectance and the cosine of the refracted direction; `None` under total
/// reflection.
pub(crate) fn dielectric(c: &Big, eta: &Big) -> Option<[Big; 2]> {
    let sin2 = (big(1.0) - c.square()) / eta.square();
    let cos2 = big(1.0) - sin2;
    if !cos2.is_positive() && *eta != big(1.0) {
        return None;
    }
    let t = if *eta == big(1.0) { c.clone() } else { cos2.sqrt() };
    if *eta == big(1.0) {
        return Some([big(0.0), t]);
    }
    let s = (c - eta * &t) / (c + eta * &t);
    let p = (eta * c - &t) / (eta * c + &t);
    Some([(s.square() + p.square()) / 2.0, t])
}

/// The reflected part.
pub(crate) fn reflectance(c: &Big, eta: &Big) -> Big {
    dielectric(&c.min(&big(1.0)), eta).map_or(big(1.0), |[r, _]| r)
}

/// The same with a complex index: by real parts (Born and Wolf 1999, 14.2), without rearrangement.
pub(crate) fn conductor(c: &Big, eta: &Big, k: &Big) -> Option<Big> {
    let s2 = big(1.0) - c.square();
    let t0 = eta.square() - k.square() - &s2;
    let ab = (t0.square() + eta.square() * k.square() * 4.0).sqrt();
    // Grazing between equal media, which has no limit.
    if &ab + c.square() < big(1e-30) {
        return None;
    }
    let a = ((&ab + &t0) / 2.0).sqrt();
    let rs = (&ab + c.square() - c * &a * 2.0) / (&ab + c.square() + c * &a * 2.0);
    let (far, near) = (&ab * c.square() + s2.square(), c * &a * &s2 * 2.0);
    let rp = &rs * (&far - &near) / (&far + &near);
    Some((rs + rp) / 2.0)
}

/// Schlick 1994, eq. 15.
pub(crate) fn schlick(c: &Big, r0: &Big) -> Big {
    let m = big(1.0) - c;
    r0 + (big(1.0) - r0) * m.square().square() * m
}

/// cos^e, 1 for e = 0.
pub(crate) fn power(cos: &Big, exponent: &Big) -> Big {
    if *exponent == big(0.0) { big(1.0) } else { (cos.ln() * exponent).exp() }
}

// What rounding makes of it, in double precision.

/// Half a unit in the last place of 1.
pub(crate) const U: f64 = 6e-8;

/// How far D at the direction of `h`, of any length, may be off relatively where its components are off by as much as `off`:
/// the derivatives of its logarithm, and the second ones, for components next to nothing.
pub(crate) fn spread(gaussian: bool, h: [f64; 3], off: [f64; 3], alpha: [f64; 2]) -> f64 {
    let [x, y] = [0, 1].map(|k| h[k] / alpha[k]);
    let [dx, dy] = [0, 1].map(|k| off[k] / alpha[k]);
    let z2 = (h[2] * h[2]).max(1e-300);
    let across = x.abs() * dx + y.abs() * dy;
    let length2 = h.iter().map(|x| x * x).sum::<f64>();
    let scaled = 4.0 * off.iter().zip(h).map(|(d, x)| d * x.abs()).sum::<f64>() / length2;
    if gaussian {
        let slope2 = (x * x + y * y) / z2;
        (2.0 * across + dx * dx + dy * dy) / z2
            + (2.0 * slope2 + 4.0) * off[2] / h[2].abs().max(1e-150)
            + scaled
    } else {
        let e = x * x + y * y + z2;
        (4.0 * (across + h[2].abs() * off[2]) + 2.0 * (dx * dx + dy * dy + off[2] * off[2])) / e + scaled
    }
}

/// The square of a slope in standard deviations times root two, of the direction of `h`.
pub(crate) fn slope2_of(h: [f64; 3], alpha: [f64; 2]) -> f64 {
    ((h[0] / alpha[0]).powi(2) + (h[1] / alpha[1]).powi(2)) / (h[2] * h[2]).max(1e-300)
}

/// By how much a reflectance may be off, absolutely, where the cosine is off by `off`: the squared cosine within is a
/// difference, of which the root counts near total reflection.
pub(crate) fn reflectance_off(c: f64, eta: f64, off: f64) -> f64 {
    let c = c.clamp(0.0, 1.0);
    let d = (eta - 1.0) * (eta + 1.0);
    let g2 = d + c * c;
    let known = U * (d.abs() + c * c) + 2.0 * c * off;
    if g2 <= -2.0 * known {
        return 0.0;
    }
    if g2 <= 100.0 * known {
        // R = 1 - 4 g (...) / c: both parts of what is not reflected, of which that of the lower index is the larger.
        let g = (g2.max(0.0) + known).sqrt();
        return (8.0 * g / c.max(1e-30) * (1.0 + 1.0 / (eta * eta))).min(1.0);
    }
    // r_s = -d / (c + g)^2, and r_p over it: what changes with c and with g.
    let (g, s2) = (g2.sqrt(), 1.0 - c * c);
    let r_s = d / (c + g).powi(2);
    let of_s = 2.0 * (off + known / (2.0 * g)) / (c + g);
    let of_p = 4.0 * (g * off + c * known / g) * s2 / (c * g + s2).powi(2);
    r_s * r_s * (2.0 * (of_s + of_p) + 1e-6)
}
