//! Interfaces: Fresnel and Snell, from the textbook's formulas.

use super::axes::{cosine, eta, extinction, few_above, fraction};
use super::big::{Big, big, unit};
use super::row::Row;
use specula::bsdf::{Dielectric, FresnelModel, Glass, fresnel};
use specula::math::Vec3;

/// Fresnel's equations for indices 1 and eta; the cosine of the refracted direction, `None` under total reflection.
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

/// The same with a complex index: by real parts (Born and Wolf 1999, 14.2), without rearrangement.
fn conductor(c: &Big, eta: &Big, k: &Big) -> Option<Vec<Big>> {
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
    Some(vec![(rs + rp) / 2.0])
}

/// Relative rounding of r and t near the critical angle: the square of the cosine is a difference.
fn near_critical(c: f64, eta: f64) -> f64 {
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
            |t| conductor(&t[0], &t[1], &t[2]),
            "1e-6 absolute",
            |_, _| 1e-6
        ),
        kernel!(
            "Schlick",
            [cosine(), fraction()],
            |c, r| [fresnel::schlick(c, r)],
            |t| {
                let m = big(1.0) - &t[0];
                Some(vec![&t[1] + (big(1.0) - &t[1]) * m.square().square() * m])
            },
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
                    let m = big(1.0) - if t[1] < big(1.0) { &inner } else { &t[0] };
                    &r0 + (big(1.0) - &r0) * m.square().square() * m
                })])
            },
            "1e-6 absolute, and five times what rounding makes of a refracted cosine",
            |a, _| {
                let cos2 = ((a[1] - 1.0) * (a[1] + 1.0) + a[0] * a[0]).max(0.0) / (a[1] * a[1]);
                1e-6 + 10.0 * near_critical(a[0], a[1]) * cos2.sqrt()
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
        kernel!(
            "Snell: refracted direction",
            [few_above(), eta()],
            |x, y, z, e| {
                let b = Dielectric { glass: Glass::exact(e) }.branches(Vec3::new(x, y, z))[1];
                [b.wi.x, b.wi.y, b.wi.z]
            },
            |t| {
                let [_, cos] = dielectric(&t[2], &t[3])?;
                Some(unit(&[-&t[0] / &t[3], -&t[1] / &t[3], -cos]))
            },
            "5e-7, and the refracted cosine's",
            |a, _| {
                let critical = near_critical(a[2], a[3]);
                let cos = (((a[3] - 1.0) * (a[3] + 1.0) + a[2] * a[2]).max(0.0)).sqrt() / a[3];
                5e-7 + cos * 2.0 * critical
            }
        ),
    ]
}
