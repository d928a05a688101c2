//! Fuzzy mirrors: value, density and sample of each.

use super::axes::{above, exponent, few_above, nearby, number, whole_exponent};
use super::big::{Big, along, big, dot, erf, minus, pi, unit};
use super::reference::{U, half, power};
use super::row::Row;
use specula::bsdf::{Below, BsdfSample, Glossy, Jitter, Phong, PhongScale};
use specula::math::lanes::{Compare, Lanes};
use specula::math::{Rgb, Vec3};

/// A direction above the surface near the mirror direction of another: what narrow lobes have to tell apart.
macro_rules! near_mirror {
    ($x:ident, $y:ident, $z:ident, $a:ident, $b:ident, $c:ident) => {
        Vec3::new($a - $x, $b - $y, Lanes::abs($c + $z)).normalize()
    };
}

/// The mirror direction of the viewer, and a light near it as `near_mirror` has it.
fn mirror_and_light(t: &[Big]) -> [Vec<Big>; 2] {
    let mirror = vec![-&t[0], -&t[1], t[2].clone()];
    [mirror, unit(&[&t[3] - &t[0], &t[4] - &t[1], (&t[5] + &t[2]).abs()])]
}

/// (e + 1) / (2 pi) cos^e about the mirror direction, with the cosine by the chord; `None` where a rounding decides whether the
/// light counts as above it, or above the surface.
fn raw(t: &[Big]) -> Option<Big> {
    let [mirror, wi] = mirror_and_light(t);
    let chord = minus(&mirror, &wi);
    let cos = dot(&mirror, &wi);
    if cos.abs() < big(1e-6) || !wi[2].is_positive() {
        return None;
    }
    if !cos.is_positive() {
        return Some(big(0.0));
    }
    Some((&t[6] + 1.0) / (pi() * 2.0) * power(&(big(1.0) - dot(&chord, &chord) / 2.0), &t[6]))
}

/// What rounding both directions makes of the power of their cosine, as a part of `p` and absolutely.
fn raw_off(a: &[f64], p: f64) -> f64 {
    // Of the chord, to which 2e-7 are added.
    let offset = a[3].hypot(a[4]).hypot(a[5]);
    let chord = if offset < 0.1 { 1.2 * offset } else { 2.0_f64.sqrt().min(2.0 * offset) } + 1e-7;
    let cos = (1.0 - 0.5 * chord * chord).max(0.01);
    // The power is lost below the least normal number, before the factor e + 1.
    p * (3e-6 + a[6] * chord * 4e-7 / cos + 4e-7 * p.max(1e-300).ln().abs()) + 1.2e-38 * (a[6] + 1.0)
}

/// How much of the lobe lies below the surface: 1/2 less half of the integral of cos^e from 0 to the asin of the cosine, over that
/// to pi/2. By parts: a finite sum for whole exponents; for great ones the lobe is Gaussian but for 1 / e.
fn below(cos: &Big, exponent: &Big) -> Option<Big> {
    let (s, c) = (cos.clone(), (big(1.0) - cos.square()).sqrt());
    if *exponent > big(1e6) {
        let angle = pi() / 2.0 - cos.acos();
        return Some((big(1.0) - erf(&(angle * (exponent / 2.0).sqrt()))) / 2.0);
    }
    let whole = exponent.to_f64().round() as u32;
    if big(f64::from(whole)) != *exponent || *exponent > big(1e3) {
        return None;
    }
    let odd = whole % 2;
    let (mut part, mut all) =
        if odd == 1 { (s.clone(), big(1.0)) } else { (pi() / 2.0 - cos.acos(), pi() / 2.0) };
    let mut power = if odd == 1 { c.square() } else { c.clone() };
    for n in (2 + odd..=whole).step_by(2) {
        let n = f64::from(n);
        part = &power * &s / n + part * (n - 1.0) / n;
        all = all * (n - 1.0) / n;
        power = power * c.square();
    }
    Some((big(1.0) - part / all) / 2.0)
}

/// A direction of the lobe about the mirror direction in the frame of Duff et al. 2017 (Building an Orthonormal Basis, Revisited),
/// and the one half a turn about it away.
fn drawn(t: &[Big]) -> [Vec<Big>; 2] {
    let (x, y, z) = (-&t[0], -&t[1], t[2].clone());
    let a = big(-1.0) / (&z + 1.0);
    let b = &x * &y * &a;
    let first = [x.square() * &a + 1.0, b.clone(), -&x];
    let second = [b, y.square() * &a + 1.0, -&y];
    let q = (big(1.0) - &t[4]).ln() / (&t[5] + 1.0);
    let (cos, sin) = (q.exp(), (big(1.0) - (&q * 2.0).exp()).sqrt());
    let [s, c] = t[3].sin_cos_turns();
    let axis: Vec<Big> = [x, y, z].iter().map(|x| x * &cos).collect();
    [sin.clone(), -sin].map(|sin| along(&along(&axis, &(&sin * &c), &first), &(&sin * &s), &second))
}

#[expect(clippy::too_many_lines, reason = "a list")]
pub(crate) fn rows() -> Vec<Row> {
    vec![
        kernel!(
            "glossy: density near the mirror direction",
            [few_above(), nearby(), exponent()],
            |x, y, z, a, b, c, e| {
                let lobe = Glossy::new(Rgb::gray(e), e);
                [lobe.pdf(Vec3::new(x, y, z), near_mirror!(x, y, z, a, b, c))]
            },
            glossy_pdf,
            "3e-6, and what rounding the directions makes of the angle",
            |a, p| {
                // Of the chord, to which 2e-7 are added.
                let offset = a[3].hypot(a[4]).hypot(a[5]);
                let chord = if offset < 0.1 { 1.2 * offset } else { 2.0_f64.sqrt().min(2.0 * offset) } + 1e-7;
                let cos = (1.0 - 0.5 * chord * chord).max(0.01);
                // The power is lost below the least normal number, before the factor e + 1.
                p * (3e-6 + a[6] * chord * 4e-7 / cos + 4e-7 * p.max(1e-300).ln().abs())
                    + 1.2e-38 * (a[6] + 1.0)
            }
        ),
        kernel!(
            "glossy, lost below: density near the mirror direction",
            [few_above(), nearby(), exponent()],
            |x, y, z, a, b, c, e| {
                let lobe = Glossy { reflectance: Rgb::gray(e), exponent: e, below: Below::Discard };
                [lobe.pdf(Vec3::new(x, y, z), near_mirror!(x, y, z, a, b, c))]
            },
            |t| raw(t).map(|p| vec![p]),
            "3e-6, and what rounding the directions makes of the angle",
            raw_off
        ),
        kernel!(
            "glossy, drawn again below: density near the mirror direction",
            [few_above(), nearby(), whole_exponent()],
            |x, y, z, a, b, c, e| {
                let lobe = Glossy { reflectance: Rgb::gray(e), exponent: e, below: Below::Rejection };
                [lobe.pdf(Vec3::new(x, y, z), near_mirror!(x, y, z, a, b, c))]
            },
            |t| Some(vec![raw(t)? / (big(1.0) - below(&t[2], &t[6])?)]),
            "6e-5, since the part below is known within 3e-5 and at most a half, and what rounding makes of the angle",
            |a, p| 6e-5 * p + 2.0 * raw_off(a, p)
        ),
        kernel!(
            "glossy: value times cosine near the mirror direction",
            [few_above(), nearby(), exponent()],
            |x, y, z, a, b, c, e| {
                let lobe = Glossy::new(Rgb::gray(e * 0.0 + 0.5), e);
                let wi = near_mirror!(x, y, z, a, b, c);
                [lobe.eval(Vec3::new(x, y, z), wi).r * wi.z]
            },
            |t| {
                let known = mirror_and_light(t)[1][2] > big(1e-29);
                if known { glossy_pdf(t).map(|p| vec![&p[0] / 2.0]) } else { None }
            },
            "as its density; from a cosine of 1e-30 on",
            raw_off
        ),
        kernel!(
            "glossy: sampled direction above and of length 1",
            [above(), number(), number(), exponent()],
            |x, y, z, u, v, e| {
                let lobe = Glossy::new(Rgb::gray(e), e);
                let sample = lobe.sample(Vec3::new(x, y, z), [u, v]);
                [sample.wi.length(), Compare::<f32>::min(sample.wi.z, 0.0) + 1.0]
            },
            |t| t[2].is_positive().then(|| vec![big(1.0); 2]),
            "1e-6",
            |_, _| 1e-6
        ),
        kernel!(
            "glossy: sampled direction",
            [above(), number(), number(), exponent()],
            |x, y, z, u, v, e| {
                let wi = Glossy::new(Rgb::gray(e), e).sample(Vec3::new(x, y, z), [u, v]).wi;
                [wi.x, wi.y, wi.z]
            },
            |t| {
                let [w, turned] = drawn(t);
                if w[2].abs() < big(1e-6) {
                    return None;
                }
                Some(if w[2].is_positive() { w } else { turned })
            },
            "5e-7; the cosine at e = 0 has the logarithm's 3e-6",
            |a, _| 5e-7 + 3e-6 / (a[5] + 1.0)
        ),
        kernel!(
            "glossy, lost or drawn again: sampled directions",
            [above(), number(), number(), exponent()],
            |x, y, z, u, v, e| cut_samples(Vec3::new(x, y, z), [u, v], e),
            |_| Some(vec![big(1.0); 4]),
            "1e-6: length 1, above the surface where valid; drawn again always valid",
            |_, _| 1e-6
        ),
        kernel!(
            "modified Phong: density and value near the mirror direction",
            [few_above(), nearby(), exponent()],
            |x, y, z, a, b, c, e| {
                let lobe =
                    Phong { reflectance: Rgb::gray(e * 0.0 + 1.0), exponent: e, scale: PhongScale::Modified };
                let (wo, wi) = (Vec3::new(x, y, z), near_mirror!(x, y, z, a, b, c));
                [lobe.pdf(wo, wi), lobe.eval(wo, wi).r]
            },
            |t| raw(t).map(|p| vec![p.clone(), p * (&t[6] + 2.0) / (&t[6] + 1.0)]),
            "3e-6, and what rounding the directions makes of the angle",
            raw_off
        ),
        kernel!(
            "max-cosine Phong: value times the greater cosine",
            [few_above(), nearby(), exponent()],
            |x, y, z, a, b, c, e| {
                let lobe = Phong {
                    reflectance: Rgb::gray(e * 0.0 + 1.0),
                    exponent: e,
                    scale: PhongScale::MaxCosine,
                };
                let (wo, wi) = (Vec3::new(x, y, z), near_mirror!(x, y, z, a, b, c));
                [lobe.eval(wo, wi).r * Compare::<_>::max(wo.z, wi.z)]
            },
            |t| {
                let excess = (big(f64::from(1.091_f32)) - &t[6] * f64::from(0.09_f32)).max(&big(1.0));
                let greater = mirror_and_light(t)[1][2].max(&t[2]);
                let known = greater > big(1e-29);
                if known { raw(t).map(|p| vec![p * (&t[6] + 2.0) / (&t[6] + 1.0) / excess]) } else { None }
            },
            "3e-6, and what rounding the directions makes of the angle",
            raw_off
        ),
        kernel!(
            "Phong: sampled direction",
            [above(), number(), number(), exponent()],
            |x, y, z, u, v, e| {
                let lobe = Phong { reflectance: Rgb::gray(e), exponent: e, scale: PhongScale::MaxCosine };
                let wi = lobe.sample(Vec3::new(x, y, z), [u, v]).wi;
                [wi.x, wi.y, wi.z]
            },
            |t| {
                let [w, _] = drawn(t);
                Some(w)
            },
            "5e-7; the cosine at e = 0 has the logarithm's 3e-6",
            |a, _| 5e-7 + 3e-6 / (a[5] + 1.0)
        ),
        kernel!(
            "jitter: density",
            [few_above(), few_above(), exponent()],
            |x, y, z, a, b, c, m| {
                let lobe = Jitter { reflectance: Rgb::gray(m), exponent: m };
                [lobe.pdf(Vec3::new(x, y, z), Vec3::new(a, b, c))]
            },
            |t| {
                let (h, cos) = half(&t[..3], &t[3..6])?;
                let sin2 = dot(&h[..2], &h[..2]);
                let upright = if h[2] > big(0.5) { (big(1.0) - sin2).sqrt() } else { h[2].clone() };
                let pdf = (&t[6] + 1.0) * power(&upright, &t[6]) / (pi() * 8.0 * cos);
                // Functions of lanes take denormals for zero.
                (pdf < big(1e37) && upright > big(1.2e-38)).then(|| vec![pdf])
            },
            "3e-6, half of that per unit of the logarithm of the power, and 2 roundings over the cosine with the normal",
            |a, p| {
                let sum = [a[0] + a[3], a[1] + a[4], a[2] + a[5]];
                let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
                let ln = a[6] * ((sum[2] / length).max(1e-30)).ln();
                p * (3e-6 + 1.5e-6 * ln.abs() + 8.0 * U / length) + 1.2e-38 * (a[6] + 1.0) / length
            }
        ),
        kernel!(
            "jitter: value times cosine",
            [few_above(), few_above(), exponent()],
            |x, y, z, a, b, c, m| {
                let lobe = Jitter { reflectance: Rgb::gray(m * 0.0 + 1.0), exponent: m };
                let (wo, wi) = (Vec3::new(x, y, z), Vec3::new(a, b, c));
                [lobe.eval(wo, wi).r * wi.z / Compare::<f32>::max(lobe.pdf(wo, wi), 1e-30)]
            },
            |t| {
                // Its density times the reflectance: what is found is their quotient.
                let (h, cos) = half(&t[..3], &t[3..6])?;
                let pdf = (&t[6] + 1.0) * power(&h[2], &t[6]) / (pi() * 8.0 * cos);
                (pdf > big(1e-28) && t[5] > big(1e-29)).then(|| vec![big(1.0)])
            },
            "3e-7",
            |_, _| 3e-7
        ),
        kernel!(
            "jitter: what is sampled is of length 1 and has the density asked for, by its width",
            [above(), number(), number(), exponent()],
            |x, y, z, u, v, m| jitter_sample(Vec3::new(x, y, z), [u, v], m),
            |_| Some(vec![big(1.0); 2]),
            "1e-5: rounding turns the half vector, which counts by the width and twice by standard deviations, of which there are 6",
            |_, _| 1e-5
        ),
    ]
}

/// Lengths of valid directions, and whether they lie above; with directions that are drawn again all are valid.
#[inline(always)]
fn cut_samples<F: Lanes>(wo: Vec3<F>, u2: [F; 2], e: F) -> [F; 4] {
    let (zero, one) = (e.splat(0.0), e.splat(1.0));
    let of = |below| Glossy { reflectance: Rgb::gray(one), exponent: e, below }.sample(wo, u2);
    let fine = |s: BsdfSample<F>| {
        [F::select(s.valid, s.wi.length(), one), F::select(s.valid & s.wi.z.le(0.0), zero, one)]
    };
    let [lost, again] = [Below::Discard, Below::Rejection].map(of);
    let [a, b] = fine(lost);
    let [c, d] = fine(again);
    [a, b, c, d]
}

#[inline(always)]
fn jitter_sample<F: Lanes>(wo: Vec3<F>, u2: [F; 2], m: F) -> [F; 2] {
    let one = m.splat(1.0);
    let lobe = Jitter { reflectance: Rgb::gray(one), exponent: m };
    let BsdfSample { wi, pdf, valid, .. } = lobe.sample(wo, u2);
    let asked = lobe.pdf(wo, wi);
    let width = (wo + wi).length() * (m + 1.0).rsqrt();
    let apart = (pdf - asked) / pdf.max(asked).max(1e-37) * width;
    [wi.length(), apart + 1.0].map(|x| F::select(valid, x, one))
}

/// The lobe's density, by the chord to the mirror direction; `None` where a rounding decides about the fold.
fn glossy_pdf(t: &[Big]) -> Option<Vec<Big>> {
    let [mirror, wi] = mirror_and_light(t);
    let twin = dot(&mirror, &wi) * &t[2] * 2.0 - &wi[2];
    if twin.abs() < big(1e-6) {
        return None;
    }
    let value = raw(t)?;
    Some(vec![if twin.is_positive() { value } else { value * 2.0 }])
}
