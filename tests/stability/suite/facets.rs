//! Microfacets: both distributions, rough metal, frosted glass; the same roughness in all directions and not.

use super::axes::{above, alpha, few_above, few_alpha, few_below, few_eta, number};
use super::big::{Big, big, dot, minus, unit};
use super::reference::{BECKMANN, GGX, Normals, U, half, reflectance, reflectance_off, slope2_of, spread};
use super::row::Row;
use specula::bsdf::microfacet::{Beckmann, Distribution, Ggx};
use specula::bsdf::{BsdfSample, Glass, Metal, RoughConductor, RoughDielectric};
use specula::math::lanes::{Compare, Lanes};
use specula::math::{Rgb, Vec3};

/// Metal that reflects everything: the facets alone.
#[inline(always)]
fn metal<F: Lanes>(facets: Distribution<F>) -> RoughConductor<F> {
    let (Distribution::Ggx(Ggx { alpha_x, .. }) | Distribution::Beckmann(Beckmann { alpha_x, .. })) = facets;
    RoughConductor { metal: Metal::Constant { r0: Rgb::gray(alpha_x.splat(1.0)) }, facets }
}

/// 1 where what is valid has length 1, weighs from 0 to `most` and is of positive, finite density.
#[inline(always)]
fn fair<F: Lanes>(sample: &BsdfSample<F>, most: F) -> [F; 3] {
    let (zero, one) = (most.splat(0.0), most.splat(1.0));
    let or_one = |x| F::select(sample.valid, x, one);
    let weight = sample.weight.r;
    let off = (weight / most - 1.0).max(0.0) + (-weight).max(0.0);
    let dense = sample.pdf * 0.0 + F::select(sample.pdf.gt(0.0), one, zero);
    [or_one(sample.wi.length()), or_one(off + 1.0), or_one(dense)]
}

/// By how much two numbers that are not negative differ, relative to the greater: within [-1, 1].
#[inline(always)]
fn apart<F: Lanes>(a: F, b: F) -> F {
    (a - b) / a.max(b).max(1e-37)
}

/// 1, and what the density and the weight of a sample differ by from those asked for, times `widths`.
#[inline(always)]
fn agreement<F: Lanes>(sample: &BsdfSample<F>, asked: F, value: F, widths: [F; 2]) -> [F; 2] {
    let zero = asked.splat(0.0);
    let weight = value * sample.wi.z.abs() / asked.max(1e-37);
    let known = F::select(asked.gt(0.0), apart(sample.weight.r, weight), zero);
    let both = [apart(sample.pdf, asked) * widths[0], known * widths[1]];
    both.map(|x| F::select(sample.valid, x, zero) + 1.0)
}

/// How much less differences count than lengths.
const fn leniency(normals: Normals) -> f32 {
    if normals.gaussian { 1.0 / 50.0 } else { 1.0 / 3.0 }
}

/// Rounding of a sampled direction turns the half vector, which is shorter than 2, and counts by the roughness.
#[inline(always)]
fn agreement_of_metal<F: Lanes>(
    lobe: RoughConductor<F>,
    (alpha, normals): ([F; 2], Normals),
    wo: Vec3<F>,
    u2: [F; 2],
) -> [F; 5] {
    let sample = lobe.sample(wo, u2);
    let width = (wo + sample.wi).length() * alpha[0].min(alpha[1]) * leniency(normals);
    let [a, b, c] = fair(&sample, width.splat(1.0));
    let [d, e] = agreement(&sample, lobe.pdf(wo, sample.wi), lobe.eval(wo, sample.wi).r, [width; 2]);
    [a, b, c, d, e]
}

/// The same for both ways at a rough interface. The facet that refracts is known by wo + eta wi, and by its cosines; of the one
/// within, the square counts, for what passes again where eta is small. Facets seen edge on are left out: whether they face up is
/// a matter of rounding.
#[inline(always)]
fn agreement_of_glass<F: Lanes>(
    lobe: RoughDielectric<F>,
    (alpha, normals): ([F; 2], Normals),
    wo: Vec3<F>,
    u2: [F; 2],
) -> [F; 10] {
    let [up, down] = lobe.sample(wo, u2);
    let (eta, sharpest) = (lobe.glass.eta(), alpha[0].min(alpha[1]) * leniency(normals));
    let (zero, one) = (eta.splat(0.0), eta.splat(1.0));
    let both = (wo + up.wi).length();
    let width = both * sharpest;
    let sum = wo + down.wi * eta;
    let length = sum.length().max(1e-20);
    let [o, i] = [wo.dot(sum) / length, down.wi.dot(sum) / length].map(Lanes::abs);
    let passing = length * sharpest * eta.min(eta.recip()).min(1.0) * o * i * i;
    let passing = F::select(sum.z.abs().gt(length * 1e-5), passing, zero);
    // Into a medium of low index the cosine within is a small difference; what passes is a difference from 1.
    let passing = passing * (eta * i).min(1.0).square();
    let passed = one - lobe.glass.at(o.min(1.0)).reflectance;
    // What is reflected near total reflection depends on the root of what rounding leaves of the cosine within.
    let inner = lobe.glass.at((both * 0.5).min(1.0)).cos_t;
    let steep = (eta * inner).min(1.0).square();
    let above = agreement(&up, lobe.pdf(wo, up.wi), lobe.eval(wo, up.wi).r, [width, width * steep]);
    let below =
        agreement(&down, lobe.pdf(wo, down.wi), lobe.eval(wo, down.wi).r, [passing, passing * passed]);
    let (mirrored, refracted) = (fair(&up, one), fair(&down, (eta * eta).recip()));
    let [a, b, c] = mirrored;
    let [d, e, f] = refracted;
    [a, b, c, d, e, f, above[0], above[1], below[0], below[1]]
}

/// The rounding of the half vector of two directions as they are: of each component, relatively.
fn sum_of(a: &[f64]) -> ([f64; 3], [f64; 3]) {
    let h = [a[0] + a[3], a[1] + a[4], a[2] + a[5]];
    (h, h.map(|x| 3.0 * U * x.abs()))
}

/// What D may be off by, relatively, and what masking may be.
fn facets_off(gaussian: bool, (h, off): ([f64; 3], [f64; 3]), alpha: [f64; 2]) -> f64 {
    let exponent = if gaussian { 8.0 * U * slope2_of(h, alpha) } else { 0.0 };
    3e-6 + spread(gaussian, h, off, alpha) + exponent
}

/// Where exponentials are lost below the least normal number, before they are divided by what else there is of D.
fn lost(gaussian: bool, h: [f64; 3], alpha: [f64; 2]) -> f64 {
    let length2 = h.iter().map(|x| x * x).sum::<f64>();
    if gaussian {
        1.2e-38 / (3.0 * alpha[0] * alpha[1]) * (length2 / (h[2] * h[2]).max(1e-300)).powi(2)
    } else {
        0.0
    }
}

/// The facet that refracts one direction into another, its cosines with both, and its unscaled length; `None` where there is none,
/// or where a rounding decides whether.
fn through(t: &[Big], eta: &Big) -> Option<(Vec<Big>, [Big; 2], Big)> {
    let sum: Vec<_> = (0..3).map(|i| &t[i] + eta * &t[3 + i]).collect();
    let length2 = dot(&sum, &sum);
    if length2 < big(1e-12) || !t[2].is_positive() || t[5].is_positive() {
        return None;
    }
    let h = unit(&sum);
    let h = if h[2].is_positive() { h } else { h.iter().map(|x| -x).collect() };
    let cosines = [dot(&t[..3], &h), -dot(&t[3..6], &h)];
    let within = (eta - 1.0) * (eta + 1.0) + cosines[0].square();
    let decided = h[2] > big(1e-5) && within > big(1e-4) && cosines.iter().all(|c| c.abs() > big(1e-4));
    decided.then_some((h, cosines, length2))
}

/// Value and density of transmission (Walter et al. 2007, eqs. 17, 20 and 21).
fn transmitted(normals: Normals, t: &[Big], alpha: &[Big], eta: &Big) -> Option<[Big; 2]> {
    let (h, [o, i], length2) = through(t, eta)?;
    if !o.is_positive() || !i.is_positive() {
        return Some([big(0.0), big(0.0)]);
    }
    let below = [-&t[3], -&t[4], -&t[5]];
    let [seen_o, seen_i] = [normals.g1(&t[..3], alpha), normals.g1(&below, alpha)];
    let shared = (normals.d)(&h, alpha) * &seen_o * &o * &i / (&t[2] * length2);
    let value = (big(1.0) - reflectance(&o, eta)) * &shared * seen_i / &below[2];
    Some([value, shared * eta.square()])
}

/// What rounding makes of both, relatively, reflectance included: the sum wo + eta wi may cancel, the cosines with it may be small.
fn transmitted_off(gaussian: bool, a: &[f64], alpha: [f64; 2], eta: f64) -> f64 {
    let h = [0, 1, 2].map(|k| a[k] + eta * a[3 + k]);
    let off = [0, 1, 2]
        .map(|k| 2.0 * U * ((a[k] + a[3 + k]).abs() + ((eta - 1.0) * a[3 + k]).abs()) + 3.0 * U * h[k].abs());
    let length = h.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-30);
    let turned = off.iter().map(|x| x * x).sum::<f64>().sqrt() / length;
    let [o, i] = [0, 3].map(|at| ((0..3).map(|k| a[at + k] * h[k]).sum::<f64>() / length).abs());
    let known = turned + 5.0 * U;
    let d = (eta - 1.0) * (eta + 1.0);
    let g = (d + o * o).max(0.0).sqrt();
    let passes = 4.0 * o * g * (1.0 / (o + g).powi(2) + eta * eta / (eta * eta * o + g).powi(2)) / 2.0;
    let dark = (reflectance_off(o, eta, known) + 2.0 * U) / passes.max(1e-30);
    facets_off(gaussian, (h, off), alpha) + known / o.max(1e-30) + known / i.max(1e-30) + 2.0 * turned + dark
}

/// First-order errors as they grow: `e^x - 1`.
fn grown(x: f64) -> f64 {
    x.min(60.0).exp_m1()
}

/// The rows of one distribution: its name, type, and reference.
macro_rules! of_facets {
    ($name:literal, $Facets:ident, $normals:ident) => {
        vec![
            kernel!(
                concat!($name, ": density of normals"),
                [above(), alpha(), alpha()],
                |x, y, z, ax, ay| [$Facets { alpha_x: ax, alpha_y: ay }.d(Vec3::new(x, y, z))],
                |t| Some(vec![($normals.d)(&t[..3], &t[3..5])]),
                "1.5e-6, and 8 roundings of the exponent",
                |a, d| {
                    let (h, alpha) = ([a[0], a[1], a[2]], [a[3], a[4]]);
                    let exponent = if $normals.gaussian { 8.0 * U * slope2_of(h, alpha) } else { 0.0 };
                    d * grown(1.5e-6 + exponent) + lost($normals.gaussian, h, alpha)
                }
            ),
            kernel!(
                concat!($name, ": masking"),
                [above(), alpha(), alpha()],
                |x, y, z, ax, ay| {
                    let facets = Distribution::$Facets($Facets { alpha_x: ax, alpha_y: ay });
                    [facets.g1(Vec3::new(x, y, z))]
                },
                |t| t[2].is_positive().then(|| vec![$normals.g1(&t[..3], &t[3..5])]),
                "1e-6",
                |_, g| 1e-6 * g
            ),
            kernel!(
                concat!($name, ": masking of both"),
                [few_above(), few_above(), alpha(), few_alpha()],
                |x, y, z, a, b, c, ax, ay| {
                    let facets = Distribution::$Facets($Facets { alpha_x: ax, alpha_y: ay });
                    let (wo, wi) = (Vec3::new(x, y, z), Vec3::new(a, b, c));
                    [facets.g2(wo, wi)]
                },
                |t| {
                    let lit = t[2].is_positive() && t[5].is_positive();
                    let [o, i] = [&t[..3], &t[3..6]].map(|w| if lit { ($normals.lambda)(w, &t[6..8]) } else { big(0.0) });
                    lit.then(|| vec![big(1.0) / (o + i + 1.0)])
                },
                "1e-6",
                |_, g| 1e-6 * g
            ),
            kernel!(
                concat!($name, ": fraction seen of what is sampled"),
                [few_above(), few_above(), alpha(), few_alpha()],
                |x, y, z, a, b, c, ax, ay| {
                    let facets = Distribution::$Facets($Facets { alpha_x: ax, alpha_y: ay });
                    let (wo, wi) = (Vec3::new(x, y, z), Vec3::new(a, b, c));
                    [facets.g2_over_g1(wo, wi)]
                },
                |t| {
                    let lit = t[2].is_positive() && t[5].is_positive();
                    let [o, i] = [&t[..3], &t[3..6]].map(|w| if lit { ($normals.lambda)(w, &t[6..8]) } else { big(0.0) });
                    lit.then(|| vec![(&o + 1.0) / (o + i + 1.0)])
                },
                "1e-6",
                |_, g| 1e-6 * g
            ),
            kernel!(
                concat!($name, ": visible normal, of length 1 and facing the viewer"),
                [above(), number(), number(), alpha(), few_alpha()],
                |x, y, z, u, v, ax, ay| {
                    let (wo, facets) = (Vec3::new(x, y, z), $Facets { alpha_x: ax, alpha_y: ay });
                    let h = facets.sample_visible(wo, [u, v]);
                    [h.length(), Compare::<f32>::min(wo.dot(h), 0.0) + 1.0, Compare::<f32>::min(h.z, 0.0) + 1.0]
                },
                |_| Some(vec![big(1.0); 3]),
                "5e-7, over the length of a sum of two unit vectors that is stretched by the roughnesses, relative to the greater of them; for \
                 Gaussian slopes 1e-3, the root of what their distribution is off by",
                |a, _| {
                    let wide = a[5].max(a[6]);
                    let length = cap_length(a, [a[5], a[6]]) / wide;
                    if $normals.gaussian { 1e-3 } else { 5e-7 / length.clamp(1e-7, 1.0) }
                }
            ),
            kernel!(
                concat!($name, " conductor: density"),
                [few_above(), few_above(), alpha(), few_alpha()],
                |x, y, z, a, b, c, ax, ay| {
                    let metal = metal(Distribution::$Facets($Facets { alpha_x: ax, alpha_y: ay }));
                    [metal.pdf(Vec3::new(x, y, z), Vec3::new(a, b, c))]
                },
                |t| {
                    let [_, pdf] = $normals.mirrored(&t[..3], &t[3..6], &t[6..8])?;
                    (pdf < big(1e37)).then(|| vec![pdf])
                },
                "3e-6, and what 3 roundings of each component of the half vector make of D",
                |a, p| {
                    let (sum, alpha) = (sum_of(a), [a[6], a[7]]);
                    let scale = 1.0 / (a[2] + (a[0] * a[6]).hypot(a[1] * a[7])).max(1e-30);
                    p * grown(facets_off($normals.gaussian, sum, alpha)) + lost($normals.gaussian, sum.0, alpha) * scale
                }
            ),
            kernel!(
                concat!($name, " conductor: value"),
                [few_above(), few_above(), alpha(), few_alpha()],
                |x, y, z, a, b, c, ax, ay| {
                    let metal = metal(Distribution::$Facets($Facets { alpha_x: ax, alpha_y: ay }));
                    [metal.eval(Vec3::new(x, y, z), Vec3::new(a, b, c)).r]
                },
                |t| {
                    let [value, _] = $normals.mirrored(&t[..3], &t[3..6], &t[6..8])?;
                    (value < big(1e37)).then(|| vec![value])
                },
                "3e-6, and what 3 roundings of each component of the half vector make of D",
                |a, f| {
                    let (sum, alpha) = (sum_of(a), [a[6], a[7]]);
                    let of = |k: usize| a[k + 2] + (a[k] * a[6]).hypot(a[k + 1] * a[7]);
                    let scale = 1.0 / (of(0) * a[5] + of(3) * a[2]).max(1e-35);
                    f * grown(facets_off($normals.gaussian, sum, alpha)) + lost($normals.gaussian, sum.0, alpha) * scale
                }
            ),
            kernel!(
                concat!($name, " conductor: what is sampled, against what it should be and against what is asked for"),
                [above(), number(), number(), alpha(), few_alpha()],
                |x, y, z, u, v, ax, ay| {
                    let facets = Distribution::$Facets($Facets { alpha_x: ax, alpha_y: ay });
                    agreement_of_metal(metal(facets), ([ax, ay], $normals), Vec3::new(x, y, z), [u, v])
                },
                |_| Some(vec![big(1.0); 5]),
                "1e-6 of lengths, weights and validity, 3e-6 of the width for density and weight; 5e-5 for Gaussian slopes s up to 4.3, \
                 where a turned facet counts 2 s (1 + s^2) times",
                |_, _| 1e-6
            ),
            kernel!(
                concat!($name, " glass: reflection"),
                [few_above(), few_above(), few_alpha(), few_alpha(), few_eta()],
                |x, y, z, a, b, c, ax, ay, e| {
                    let facets = Distribution::$Facets($Facets { alpha_x: ax, alpha_y: ay });
                    let lobe = RoughDielectric { glass: Glass::exact(e), facets };
                    [lobe.eval(Vec3::new(x, y, z), Vec3::new(a, b, c)).r]
                },
                |t| {
                    let [value, _] = $normals.mirrored(&t[..3], &t[3..6], &t[6..8])?;
                    let (_, cos) = half(&t[..3], &t[3..6])?;
                    (value < big(1e37)).then(|| vec![value * reflectance(&cos, &t[8])])
                },
                "as for metal, times what 5 roundings of the cosine with the facet make of its reflectance",
                |a, f| {
                    let (sum, alpha) = (sum_of(a), [a[6], a[7]]);
                    let cos = sum.0.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0;
                    let r = reflectance_of(cos, a[8]);
                    let of = |k: usize| a[k + 2] + (a[k] * a[6]).hypot(a[k + 1] * a[7]);
                    let scale = 1.0 / (of(0) * a[5] + of(3) * a[2]).max(1e-35);
                    f * (grown(facets_off($normals.gaussian, sum, alpha)) + reflectance_off(cos, a[8], 5.0 * U) / r.max(1e-30))
                        + lost($normals.gaussian, sum.0, alpha) * scale
                }
            ),
            kernel!(
                concat!($name, " glass: density of transmission"),
                [few_above(), few_below(), few_alpha(), few_alpha(), few_eta()],
                |x, y, z, a, b, c, ax, ay, e| {
                    let facets = Distribution::$Facets($Facets { alpha_x: ax, alpha_y: ay });
                    let lobe = RoughDielectric { glass: Glass::exact(e), facets };
                    [lobe.pdf(Vec3::new(x, y, z), Vec3::new(a, b, c))]
                },
                |t| {
                    let [_, pdf] = transmitted($normals, t, &t[6..8], &t[8])?;
                    (pdf < big(1e36)).then(|| vec![pdf])
                },
                "3e-6, and what rounding wo + eta wi makes of D and of the cosines with it",
                |a, p| through_bound($normals.gaussian, a, p)
            ),
            kernel!(
                concat!($name, " glass: transmission"),
                [few_above(), few_below(), few_alpha(), few_alpha(), few_eta()],
                |x, y, z, a, b, c, ax, ay, e| {
                    let facets = Distribution::$Facets($Facets { alpha_x: ax, alpha_y: ay });
                    let lobe = RoughDielectric { glass: Glass::exact(e), facets };
                    [lobe.eval(Vec3::new(x, y, z), Vec3::new(a, b, c)).r]
                },
                |t| {
                    let [value, _] = transmitted($normals, t, &t[6..8], &t[8])?;
                    (value < big(1e36)).then(|| vec![value])
                },
                "3e-6, and what rounding wo + eta wi makes of D, of the cosines with it and of what passes",
                |a, f| through_bound($normals.gaussian, a, f)
            ),
            kernel!(
                concat!($name, " glass: what is sampled, against what it should be and against what is asked for"),
                [above(), number(), number(), few_alpha(), few_alpha(), few_eta()],
                |x, y, z, u, v, ax, ay, e| {
                    let facets = Distribution::$Facets($Facets { alpha_x: ax, alpha_y: ay });
                    let lobe = RoughDielectric { glass: Glass::exact(e), facets };
                    agreement_of_glass(lobe, ([ax, ay], $normals), Vec3::new(x, y, z), [u, v])
                },
                |_| Some(vec![big(1.0); 10]),
                "1e-6 of lengths, weights and validity, 3e-6 of the width for density and weight; 5e-5 for Gaussian slopes s up to 4.3, \
                 where a turned facet counts 2 s (1 + s^2) times",
                |_, _| 1e-6
            ),
        ]
    };
}

fn through_bound(gaussian: bool, a: &[f64], f: f64) -> f64 {
    let (alpha, eta) = ([a[6], a[7]], a[8]);
    let h = [0, 1, 2].map(|k| a[k] + eta * a[3 + k]);
    let length2 = h.iter().map(|x| x * x).sum::<f64>().max(1e-14);
    let of = |k: usize| a[k + 2].abs() + (a[k] * a[6]).hypot(a[k + 1] * a[7]);
    let scale = (1.0 + eta * eta) / length2 / (of(0) * of(3)).max(1e-35);
    f * grown(transmitted_off(gaussian, a, alpha, eta)) + lost(gaussian, h, alpha) * scale
}

/// The reflectance, by the form that does not cancel.
fn reflectance_of(c: f64, eta: f64) -> f64 {
    let c = c.clamp(0.0, 1.0);
    let d = (eta - 1.0) * (eta + 1.0);
    let g = (d + c * c).max(0.0).sqrt();
    let s2 = 1.0 - c * c;
    let s = -d / (c + g).powi(2).max(1e-300);
    let p = s * (c * g - s2) / (c * g + s2);
    ((s * s + p * p) / 2.0).min(1.0)
}

/// The visible normal of GGX as a sum of two vectors of a stretched hemisphere (Dupuy and Benyoub 2023, listing 3).
fn cap(t: &[Big]) -> Option<Vec<Big>> {
    let w = unit(&[&t[0] * &t[5], &t[1] * &t[6], t[2].clone()]);
    let z = (big(1.0) - &t[4]) * (&w[2] + 1.0) - &w[2];
    let sin = (big(1.0) - z.square()).sqrt();
    let [s, c] = t[3].sin_cos_turns();
    let sum = minus(&[&sin * c, &sin * s, z], &w.iter().map(|x| -x).collect::<Vec<_>>());
    (dot(&sum, &sum) > big(1e-12) && sum[2] > big(1e-30)).then(|| unit(&sum))
}

/// That sum, scaled per axis.
fn cap_length(a: &[f64], scale: [f64; 2]) -> f64 {
    let w = [a[0] * a[5], a[1] * a[6], a[2]];
    let length = w.iter().map(|x| x * x).sum::<f64>().sqrt();
    let cos = w[2] / length;
    let z = (1.0 - a[4]) * (1.0 + cos) - cos;
    let (sin, turn) = ((1.0 - z * z).max(0.0).sqrt(), a[3] * std::f64::consts::TAU);
    let [x, y] = [sin * turn.cos() + w[0] / length, sin * turn.sin() + w[1] / length];
    (x * scale[0]).hypot(y * scale[1]).hypot(z + cos)
}

pub(crate) fn rows() -> Vec<Row> {
    let mut rows = of_facets!("GGX", Ggx, GGX);
    rows.extend(of_facets!("Beckmann", Beckmann, BECKMANN));
    rows.push(kernel!(
        "GGX: visible normal, where the surface is stretched to roughness 1",
        [above(), number(), number(), alpha(), few_alpha()],
        |x, y, z, u, v, ax, ay| {
            let h = Ggx { alpha_x: ax, alpha_y: ay }.sample_visible(Vec3::new(x, y, z), [u, v]);
            let w = Vec3::new(h.x / ax, h.y / ay, h.z).normalize();
            [w.x, w.y, w.z]
        },
        cap,
        "5e-7, over the length of the sum of two unit vectors",
        |a, _| 5e-7 / cap_length(a, [1.0; 2]).clamp(1e-7, 1.0)
    ));
    rows
}
