//! Matt surfaces: value, density and sample of each.

use super::axes::{above, coat, few_above, fraction, number};
use super::big::{Big, big, pi};
use super::reference::{GGX, U, dielectric, half, schlick, spread};
use super::row::Row;
use specula::bsdf::{BsdfSample, Diffuse, Glass, Glazed, OrenNayar, Schlick};
use specula::math::lanes::{Compare, Lanes, Select};
use specula::math::{Rgb, Vec3};

/// Fujii's variant of Oren and Nayar's model with the bounces between slopes, as printed (Portsmouth, Kutz and Hill 2025, EON,
/// sections 2 and 3).
fn eon(t: &[Big]) -> Vec<Big> {
    let (o, i, rho, r) = (&t[2], &t[5], &t[6], &t[7]);
    if !o.is_positive() || !i.is_positive() {
        return vec![big(0.0)];
    }
    let one = big(1.0);
    let af = &one / (r * (big(0.5) - big(2.0) / (pi() * 3.0)) + &one);
    let s = &t[0] * &t[3] + &t[1] * &t[4];
    let over = if s.is_positive() { o.max(i) } else { one.clone() };
    let single = rho * &af / pi() * (r * s / over + &one);
    let albedo = |cos: &Big| {
        let sin = (&one - cos.square()).sqrt();
        let g = &sin * (cos.acos() - &sin * cos)
            + ((&sin / cos) * (&one - sin.square() * &sin) - &sin) * 2.0 / 3.0;
        &af * (r * g / pi() + &one)
    };
    let mean = &af * (r * (big(2.0) / 3.0 - big(28.0) / (pi() * 15.0)) + &one);
    if *r == big(0.0) {
        return vec![single];
    }
    let bounced = rho.square() * &mean / (&one - rho * (&one - &mean));
    let again = (&one - albedo(o)) * (&one - albedo(i)) / (&one - &mean);
    vec![single + bounced / pi() * again]
}

/// The shares of Schlick's surface: the base, and the glossy part.
fn shares(r: &Big) -> [Big; 2] {
    let rest = (big(1.0) - r * 2.0).square();
    [if *r < big(0.5) { big(0.0) } else { rest }, r * (big(1.0) - r) * 4.0]
}

/// His roughnesses along both tangents, as wide as they may be.
fn widths(r: &Big, p: &Big) -> [Big; 2] {
    [r / p, r * p].map(|square| square.sqrt().min(&big(1.0)).max(&big(1e-4)))
}

#[expect(clippy::too_many_lines, reason = "a list")]
pub(crate) fn rows() -> Vec<Row> {
    vec![
        kernel!(
            "diffuse: value and density",
            [above(), fraction()],
            |x, y, z, r| {
                let w = Vec3::new(x, y, z);
                let lobe = Diffuse { reflectance: Rgb::gray(r) };
                [lobe.eval(w, w).r, lobe.pdf(w, w)]
            },
            |t| {
                let value = if t[2].is_positive() { &t[3] / pi() } else { big(0.0) };
                Some(vec![value, &t[2] / pi()])
            },
            "2e-7",
            |_, f| 2e-7 * f
        ),
        kernel!(
            "Oren-Nayar: value",
            [few_above(), few_above(), fraction(), fraction()],
            |x, y, z, a, b, c, rho, r| {
                let lobe = OrenNayar { reflectance: Rgb::gray(rho), roughness: r };
                [lobe.eval(Vec3::new(x, y, z), Vec3::new(a, b, c)).g]
            },
            |t| {
                let value = eon(t);
                (t[2].max(&t[5]) > big(1e-29)).then_some(value)
            },
            "1e-6 of the smooth lobe, and 3 roundings of the product of the directions along the surface over the greater cosine, from 1e-29 on",
            |a, f| {
                let terms = (a[0] * a[3]).abs() + (a[1] * a[4]).abs();
                1e-6 * a[6] + 5e-7 * f + a[6] * a[7] * 3.0 * U * terms / a[2].max(a[5]).max(1e-30)
            }
        ),
        kernel!(
            "Oren-Nayar: weight and density of what is sampled",
            [few_above(), number(), number(), fraction(), fraction()],
            |x, y, z, u, v, rho, r| {
                let lobe = OrenNayar { reflectance: Rgb::gray(rho), roughness: r };
                let wo = Vec3::new(x, y, z);
                let BsdfSample { wi, weight, pdf, valid } = lobe.sample(wo, [u, v]);
                let value = lobe.eval(wo, wi).r * std::f32::consts::PI - weight.r;
                [
                    Select::select(valid, value / Compare::<f32>::max(weight.r, 1e-30) + 1.0, x * 0.0 + 1.0),
                    Select::select(valid, pdf / lobe.pdf(wo, wi), x * 0.0 + 1.0),
                ]
            },
            |_| Some(vec![big(1.0); 2]),
            "3e-7",
            |_, _| 3e-7
        ),
        kernel!(
            "glazed: value",
            [few_above(), few_above(), coat(), fraction()],
            |x, y, z, a, b, c, e, r| {
                let lobe = Glazed { glass: Glass::exact(e), inside: Rgb::gray(r) };
                [lobe.diffuse(Vec3::new(x, y, z), Vec3::new(a, b, c)).r]
            },
            |t| {
                let through = |cos: &Big| dielectric(cos, &t[6]).map_or(big(0.0), |[r, _]| big(1.0) - r);
                let lit = t[2].is_positive() && t[5].is_positive();
                lit.then(|| vec![&t[7] / pi() * through(&t[2]) * through(&t[5])])
            },
            "3e-7 absolute",
            |_, _| 3e-7
        ),
        kernel!(
            "Schlick's surface: the glossy part",
            [few_above(), few_above(), fraction(), fraction(), isotropy()],
            |x, y, z, a, b, c, color, r, p| {
                let surface = Schlick::new(Rgb::gray(color), r, p);
                [surface.eval(Vec3::new(x, y, z), Vec3::new(a, b, c)).r]
            },
            |t| {
                let [facets, _] = GGX.mirrored(&t[..3], &t[3..6], &widths(&t[7], &t[8]))?;
                let (_, cos) = half(&t[..3], &t[3..6])?;
                let tint = schlick(&cos.min(&big(1.0)), &t[6]);
                let value = &facets * &tint * &shares(&t[7])[1];
                (facets < big(1e37) && tint > big(1e-20)).then(|| vec![value])
            },
            "5e-6, and what 3 roundings of each component of the half vector make of D; 2 of each roughness count fourfold",
            |a, f| {
                let h = [0, 1, 2].map(|k| a[k] + a[3 + k]);
                let alpha = [a[7] / a[8], a[7] * a[8]].map(|x| x.sqrt().clamp(1e-4, 1.0));
                let off = h.map(|x| 3.0 * U * x.abs());
                // The whitening: (1 - cos)^5 of a cosine that is known to 4 roundings.
                let m = 1.0 - (h.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0).min(1.0);
                let tint = a[6] + (1.0 - a[6]) * m.powi(5);
                f * (5e-6 + spread(false, h, off, alpha) + 20.0 * U * (m + 4.0 * U).powi(4) / tint.max(1e-30))
            }
        ),
        kernel!(
            "Schlick's surface: the base",
            [few_above(), few_above(), fraction(), fraction()],
            |x, y, z, a, b, c, color, r| {
                let surface = Schlick::new(Rgb::gray(color), r, x * 0.0 + 1.0);
                [surface.diffuse(Vec3::new(x, y, z), Vec3::new(a, b, c)).r]
            },
            |t| {
                let (_, cos) = half(&t[..3], &t[3..6])?;
                Some(vec![schlick(&cos.min(&big(1.0)), &t[6]) * &shares(&t[7])[0] / pi()])
            },
            "1e-6 of the share",
            |a, _| 1e-6 * (1.0 - 2.0 * a[7]).powi(2)
        ),
        kernel!(
            "Schlick's surface: what is sampled is of length 1, has the density asked for, by its width, and weighs at most its share",
            [above(), number(), number(), fraction(), isotropy()],
            |x, y, z, u, v, r, p| {
                let surface = Schlick::new(Rgb::gray(x * 0.0 + 0.5), r, p);
                schlick_sample(surface, Vec3::new(x, y, z), [u, v], r)
            },
            |_| Some(vec![big(1.0); 3]),
            "3e-6",
            |_, _| 3e-6
        ),
    ]
}

#[inline(always)]
fn schlick_sample<F: Lanes>(surface: Schlick<F>, wo: Vec3<F>, u2: [F; 2], r: F) -> [F; 3] {
    let BsdfSample { wi, weight, pdf, valid } = surface.sample(wo, u2);
    let (zero, one) = (r.splat(0.0), r.splat(1.0));
    // The sharper roughness, at the least isotropy.
    let width = (wo + wi).length() * (r * 0.01).sqrt().clamp(1e-4, 1.0);
    let asked = surface.pdf(wo, wi);
    let apart = (pdf - asked) / pdf.max(asked).max(1e-37) * width;
    let over = (weight.r - r * (one - r) * 4.0).max(0.0) + (-weight.r).max(0.0);
    [wi.length(), apart + 1.0, over + 1.0].map(|x| F::select(valid, x, zero + 1.0))
}

/// From brushed to the same in all directions.
fn isotropy() -> super::axes::Axis {
    super::axes::of(&[0.01, 0.5, 1.0], |random| vec![random.logarithmic(0.01, 1.0)])
}
