//! Lobes: value, density and sample of each.

use super::axes::{above, alpha, coat, exponent, few_above, fraction, nearby, number};
use super::big::{Big, big, dot, minus, pi, unit};
use super::fresnel::dielectric;
use super::row::Row;
use super::warps::power;
use specula::bsdf::microfacet::{Distribution, Ggx};
use specula::bsdf::{Diffuse, FresnelModel, Glass, Glazed, Glossy, Metal, Mirror, RoughConductor};
use specula::math::lanes::{Compare, Lanes, Select};
use specula::math::{Rgb, Vec3};

/// GGX's density of normals (Walter et al. 2007, eq. 33) as printed, by the tangent, of the direction of `h`.
fn ggx_d(h: &[Big], ax: &Big, ay: &Big) -> Big {
    if !h[2].is_positive() {
        return big(0.0);
    }
    let e = (&h[0] / ax).square() + (&h[1] / ay).square() + h[2].square();
    big(1.0) / (pi() * ax * ay * e.square())
}

fn lambda(w: &[Big], ax: &Big, ay: &Big) -> Big {
    let tan2 = ((&w[0] * ax).square() + (&w[1] * ay).square()) / w[2].square();
    ((tan2 + 1.0).sqrt() - 1.0) / 2.0
}

#[inline(always)]
fn ggx<F: Lanes>(alpha: F) -> Distribution<F> {
    Distribution::Ggx(Ggx::isotropic(alpha))
}

#[inline(always)]
fn rough<F: Lanes>(eta: F, k: F, alpha: F) -> RoughConductor<F> {
    let metal = Metal::new(FresnelModel::Exact, Rgb::gray(eta), Rgb::gray(k));
    RoughConductor { metal, facets: ggx(alpha) }
}

/// A direction above the surface near the mirror direction of another: what narrow lobes have to tell apart.
macro_rules! near_mirror {
    ($x:ident, $y:ident, $z:ident, $a:ident, $b:ident, $c:ident) => {
        Vec3::new($a - $x, $b - $y, Lanes::abs($c + $z)).normalize()
    };
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
            "GGX: density of normals",
            [above(), alpha(), alpha()],
            |x, y, z, ax, ay| [Ggx { alpha_x: ax, alpha_y: ay }.d(Vec3::new(x, y, z))],
            |t| Some(vec![ggx_d(&t[..3], &t[3], &t[4])]),
            "1.5e-6",
            |_, d| 1.5e-6 * d
        ),
        kernel!(
            "GGX: masking",
            [above(), alpha(), alpha()],
            |x, y, z, ax, ay| [Distribution::Ggx(Ggx { alpha_x: ax, alpha_y: ay }).g1(Vec3::new(x, y, z))],
            |t| {
                let seen = t[2].is_positive();
                seen.then(|| vec![big(1.0) / (lambda(&t[..3], &t[3], &t[4]) + 1.0)])
            },
            "1e-6",
            |_, g| 1e-6 * g
        ),
        kernel!(
            "GGX: masking of both",
            [few_above(), few_above(), alpha()],
            |x, y, z, a, b, c, r| [ggx(r).g2(Vec3::new(x, y, z), Vec3::new(a, b, c))],
            |t| {
                if !t[2].is_positive() || !t[5].is_positive() {
                    return None;
                }
                let [o, i] = [&t[..3], &t[3..6]].map(|w| lambda(w, &t[6], &t[6]));
                Some(vec![big(1.0) / (o + i + 1.0)])
            },
            "1e-6",
            |_, g| 1e-6 * g
        ),
        kernel!(
            "GGX: visible normal, its length",
            [above(), number(), number(), alpha()],
            |x, y, z, u, v, r| [Ggx::isotropic(r).sample_visible(Vec3::new(x, y, z), [u, v]).length()],
            |_| Some(vec![big(1.0)]),
            "3e-7",
            |_, _| 3e-7
        ),
        kernel!(
            "rough conductor: density",
            [few_above(), few_above(), alpha()],
            |x, y, z, a, b, c, r| {
                let (wo, wi) = (Vec3::new(x, y, z), Vec3::new(a, b, c));
                let one = Lanes::splat(r, 1.0);
                let metal = rough(one, one, r);
                [metal.pdf(wo, wi)]
            },
            |t| {
                let (h, l_o, _) = half(t)?;
                let pdf = ggx_d(&h, &t[6], &t[6]) / ((l_o + 1.0) * &t[2] * 4.0);
                (pdf < big(3e38)).then(|| vec![pdf])
            },
            "2e-6, and what rounding makes of half vectors that cancel",
            |a, p| p * (3e-6 + cancelled(a))
        ),
        kernel!(
            "rough conductor: value",
            [few_above(), few_above(), alpha()],
            |x, y, z, a, b, c, r| {
                let (wo, wi) = (Vec3::new(x, y, z), Vec3::new(a, b, c));
                let (eta, k) = (Lanes::splat(r, 1.0), Lanes::splat(r, 1e6));
                let metal = rough(eta, k, r);
                [metal.eval(wo, wi).r]
            },
            |t| {
                let (h, l_o, l_i) = half(t)?;
                let value = ggx_d(&h, &t[6], &t[6]) / ((l_o + l_i + 1.0) * &t[2] * &t[5] * 4.0);
                (value < big(1e37)).then(|| vec![value])
            },
            "3e-6, and what rounding makes of half vectors that cancel; a metal that reflects all but 1e-6",
            |a, f| { f * (4e-6 + cancelled(a)) }
        ),
        kernel!(
            "rough conductor: fraction seen of what is sampled",
            [few_above(), few_above(), alpha()],
            |x, y, z, a, b, c, r| [ggx(r).g2_over_g1(Vec3::new(x, y, z), Vec3::new(a, b, c))],
            |t| {
                let (_, l_o, l_i) = half(t)?;
                Some(vec![(&l_o + 1.0) / (l_o + l_i + 1.0)])
            },
            "1e-6",
            |_, g| 1e-6 * g
        ),
        kernel!(
            "rough conductor: sampled direction of length 1, weight and validity as promised",
            [above(), number(), number(), alpha()],
            |x, y, z, u, v, r| {
                let one = Lanes::splat(r, 1.0);
                let metal = rough(one, r, r);
                let sample = metal.sample(Vec3::new(x, y, z), [u, v]);
                // What is not valid may be anything.
                let or_one = |x| Select::select(sample.valid, x, one);
                let weight = Compare::<f32>::max(or_one(sample.weight.r), 1.0);
                [or_one(sample.wi.length()), weight, or_one(sample.pdf * 0.0 + 1.0)]
            },
            |_| Some(vec![big(1.0); 3]),
            "1e-6",
            |_, _| 1e-6
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
            "mirror direction",
            [above()],
            |x, y, z| {
                let one = Lanes::splat(x, 1.0);
                let w = Mirror { reflectance: Rgb::gray(one) }.branch(Vec3::new(x, y, z)).wi;
                [w.x, w.y, w.z]
            },
            |t| Some(vec![-&t[0], -&t[1], t[2].clone()]),
            "exact",
            |_, _| 0.0
        ),
        kernel!(
            "glossy: density near the mirror direction",
            [few_above(), nearby(), exponent()],
            |x, y, z, a, b, c, e| {
                let lobe = Glossy::new(Rgb::gray(e), e);
                [lobe.pdf(Vec3::new(x, y, z), near_mirror!(x, y, z, a, b, c))]
            },
            |t| glossy_pdf(t),
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
    ]
}

/// The half vector of two directions and what Smith's function is for each, where they do not both graze.
fn half(t: &[Big]) -> Option<(Vec<Big>, Big, Big)> {
    let sum: Vec<_> = (0..3).map(|i| &t[i] + &t[3 + i]).collect();
    let lit = t[2].is_positive() && t[5].is_positive() && dot(&sum, &sum) > big(1.1e-12);
    lit.then(|| (unit(&sum), lambda(&t[..3], &t[6], &t[6]), lambda(&t[3..6], &t[6], &t[6])))
}

/// What rounding the sum of two directions makes of a lobe about its direction, relatively.
fn cancelled(a: &[f64]) -> f64 {
    let rounded = (a[0].abs() + a[3].abs() + a[1].abs() + a[4].abs()) * 6e-8;
    let across = (a[0] + a[3]).hypot(a[1] + a[4]);
    4.0 * rounded / (across + (a[2] + a[5]) * a[6])
}

/// The lobe's density, by the chord to the mirror direction; `None` where a rounding decides about the fold.
fn glossy_pdf(t: &[Big]) -> Option<Vec<Big>> {
    let mirror = [-&t[0], -&t[1], t[2].clone()];
    let wi = unit(&[&t[3] - &t[0], &t[4] - &t[1], (&t[5] + &t[2]).abs()]);
    let chord = minus(&mirror, &wi);
    let cos = dot(&mirror, &wi);
    let twin = &cos * &t[2] * 2.0 - &wi[2];
    if twin.abs() < big(1e-6) || cos.abs() < big(1e-6) || !wi[2].is_positive() {
        return None;
    }
    if !cos.is_positive() {
        return Some(vec![big(0.0)]);
    }
    let value = (&t[6] + 1.0) / (pi() * 2.0) * power(&(big(1.0) - dot(&chord, &chord) / 2.0), &t[6]);
    Some(vec![if twin.is_positive() { value } else { value * 2.0 }])
}
