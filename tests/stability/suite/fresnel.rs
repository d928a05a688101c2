//! Interfaces: Fresnel and Snell, from the textbook's formulas.

use super::axes::{cosine, eta, extinction, fraction, mirroring};
use super::big::{Big, big};
use super::reference::{conductor, dielectric, schlick};
use super::row::Row;
use specula::bsdf::{FresnelModel, Glass, Metal, fresnel};
use specula::math::Rgb;

/// Relative rounding of r and t near the critical angle: the square of the cosine is a difference.
pub(crate) fn near_critical(c: f64, eta: f64) -> f64 {
    let g2 = (eta - 1.0) * (eta + 1.0) + c * c;
    let parts = ((eta - 1.0) * (eta + 1.0)).abs() + c * c;
    if g2 <= 0.0 { 0.0 } else { 6e-8 * parts / g2 }
}

#[expect(clippy::too_many_lines, reason = "a list")]
pub(crate) fn rows() -> Vec<Row> {
    vec![
        kernel!(
            "dielectric: reflectance",
            [cosine(), eta()],
            |c, e| [fresnel::dielectric(c, e).reflectance],
            |t| Some(vec![dielectric(&t[0], &t[1]).map_or(big(1.0), |[r, _]| r)]),
            "1e-6, and 4 sqrt(what rounding makes of 1 - sin^2) below 1e-3 of total reflection",
            |a, r| {
                let critical = near_critical(a[0], a[1]);
                r * (1e-6 + 6.0 * critical) + if critical > 1e-4 { 4.0 * critical.sqrt() * r } else { 0.0 }
            }
        ),
        kernel!(
            "dielectric: refracted cosine",
            [cosine(), eta()],
            |c, e| [fresnel::dielectric(c, e).cos_t],
            |t| Some(vec![dielectric(&t[0], &t[1]).map_or(big(0.0), |[_, cos]| cos)]),
            "3e-7, and what rounding makes of 1 - sin^2",
            |a, cos| cos * (3e-7 + 2.0 * near_critical(a[0], a[1]))
        ),
        kernel!(
            "conductor: reflectance",
            [cosine(), eta(), extinction()],
            |c, e, k| [fresnel::conductor(c, e, k)],
            |t| conductor(&t[0], &t[1], &t[2]).map(|r| vec![r]),
            "1e-6 absolute",
            |_, _| 1e-6
        ),
        kernel!(
            "conductor: what is not reflected, of metals of extinction 1 and more",
            [cosine(), eta(), mirroring()],
            |c, e, k| [-fresnel::conductor(c, e, k) + 1.0],
            |t| conductor(&t[0], &t[1], &t[2]).map(|r| vec![big(1.0) - r]),
            "2e-6 of itself, a rounding of 1, and 4 of eta^2 - k^2 over what its difference from 1 leaves",
            |a, lost| {
                let [eta, k] = [a[1], a[2]];
                // a of n^2 = (a + i b)^2 comes from t0, a difference, unless k outweighs eta.
                let s2 = 1.0 - a[0] * a[0];
                let t0 = (eta - k) * (eta + k) - s2;
                let ab = t0.hypot(2.0 * eta * k);
                lost * (2e-6 + 4.0 * 6e-8 * (eta * eta + k * k + s2) / ab) + 6e-8
            }
        ),
        kernel!(
            "models of metals: Schlick, with edge term, constant",
            [cosine(), eta(), extinction()],
            |c, e, k| {
                let of = |model| Metal::new(model, Rgb::gray(e), Rgb::gray(k)).at(c).r;
                [of(FresnelModel::Schlick), of(FresnelModel::F82), of(FresnelModel::Constant)]
            },
            |t| {
                let one = big(1.0);
                let seventh = big(f64::from(fresnel::EDGE_COSINE));
                let (r0, known) = (conductor(&one, &t[1], &t[2])?, conductor(&seventh, &t[1], &t[2])?);
                let m = |c: &Big| &one - c;
                let shape = |c: &Big| c * m(c).square().square() * m(c).square();
                let edge = (schlick(&seventh, &r0) - known) / shape(&seventh);
                let f82 = schlick(&t[0], &r0) - edge * shape(&t[0]);
                Some(vec![schlick(&t[0], &r0), f82.max(&big(0.0)).min(&one), r0])
            },
            "4e-6 absolute: the conductor's 1e-6 twice, and what of it the edge term magnifies 1 time at most",
            |_, _| 4e-6
        ),
        kernel!(
            "Schlick",
            [cosine(), fraction()],
            |c, r| [fresnel::schlick(c, r)],
            |t| Some(vec![schlick(&t[0], &t[1])]),
            "5e-7",
            |_, r| 5e-7 * r
        ),
        kernel!(
            "Schlick for a dielectric",
            [cosine(), eta()],
            |c, e| [Glass::new(FresnelModel::Schlick, e).at(c).reflectance],
            |t| {
                if t[1] == big(1.0) {
                    return Some(vec![big(0.0)]);
                }
                let r0 = ((&t[1] - 1.0) / (&t[1] + 1.0)).square();
                Some(vec![dielectric(&t[0], &t[1]).map_or(big(1.0), |[_, inner]| {
                    schlick(if t[1] < big(1.0) { &inner } else { &t[0] }, &r0)
                })])
            },
            "1e-6 absolute, and five times what rounding makes of a refracted cosine",
            |a, _| {
                let cos2 = ((a[1] - 1.0) * (a[1] + 1.0) + a[0] * a[0]).max(0.0) / (a[1] * a[1]);
                1e-6 + 10.0 * near_critical(a[0], a[1]) * cos2.sqrt()
            }
        ),
        kernel!(
            "models of glass: with edge term, constant",
            [cosine(), eta()],
            |c, e| {
                let of = |model| Glass::new(model, e).at(c).reflectance;
                [of(FresnelModel::F82), of(FresnelModel::Constant)]
            },
            |t| {
                let (zero, one) = (big(0.0), big(1.0));
                if t[1] == one {
                    return Some(vec![zero.clone(), zero]);
                }
                let r0 = ((&t[1] - 1.0) / (&t[1] + 1.0)).square();
                let Some([_, inner]) = dielectric(&t[0], &t[1]) else { return Some(vec![one.clone(), one]) };
                let (c, up) = if t[1] < one { (inner, &one / &t[1]) } else { (t[0].clone(), t[1].clone()) };
                let seventh = big(f64::from(fresnel::EDGE_COSINE));
                let [known, _] = dielectric(&seventh, &up)?;
                let shape = |c: &Big| {
                    let m = big(1.0) - c;
                    c * m.square().square() * m.square()
                };
                let edge = (schlick(&seventh, &r0) - known) / shape(&seventh);
                let f82 = schlick(&c, &r0) - edge * shape(&c);
                Some(vec![f82.max(&zero).min(&one), r0])
            },
            "4e-6 absolute, and ten times what rounding makes of a refracted cosine",
            |a, _| {
                let cos2 = ((a[1] - 1.0) * (a[1] + 1.0) + a[0] * a[0]).max(0.0) / (a[1] * a[1]);
                4e-6 + 20.0 * near_critical(a[0], a[1]) * cos2.sqrt()
            }
        ),
        kernel!(
            "normal incidence",
            [eta()],
            |e| [fresnel::normal_incidence(e)],
            |t| Some(vec![((&t[0] - 1.0) / (&t[0] + 1.0)).square()]),
            "5e-7",
            |_, r| 5e-7 * r
        ),
    ]
}
