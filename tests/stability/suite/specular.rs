//! The ways on at smooth interfaces: where they lead, and with how much.

use super::axes::{above, coat, cosine, eta, extinction, few_above, fraction};
use super::big::{big, unit};
use super::fresnel::near_critical;
use super::reference::{conductor, dielectric, reflectance, reflectance_off, schlick};
use super::row::Row;
use specula::bsdf::{
    Branch, Conductor, Dielectric, FresnelModel, Glass, Glazed, Metal, Mirror, Schlick, ThinDielectric,
};
use specula::math::lanes::Lanes;
use specula::math::{Rgb, Vec3};

/// A number that is there only where the way is.
#[inline(always)]
fn there<F: Lanes>(branch: &Branch<F>, x: F) -> F {
    F::select(branch.valid, x, x.splat(0.0))
}

/// The direction of the greatest difference from `w`, by components.
#[inline(always)]
fn off<F: Lanes>(branch: &Branch<F>, w: Vec3<F>) -> F {
    let d = branch.wi - w;
    d.x.abs().max(d.y.abs()).max(d.z.abs())
}

#[expect(clippy::too_many_lines, reason = "a list")]
pub(crate) fn rows() -> Vec<Row> {
    vec![
        kernel!(
            "mirror directions of mirror, metal, glass, pane, coat and Schlick's surface",
            [above(), coat()],
            |x, y, z, e| {
                let wo = Vec3::new(x, y, z);
                let (gray, glass) = (Rgb::gray(x * 0.0 + 1.0), Glass::exact(e));
                let metal = Metal::new(FresnelModel::Exact, Rgb::gray(e), gray);
                let [a, b, c, d] = [
                    Mirror { reflectance: gray }.branch(wo),
                    Conductor { metal }.branch(wo),
                    Dielectric { glass }.branches(wo)[0],
                    ThinDielectric { glass, transmittance: gray }.branches(wo)[0],
                ];
                let coated = Glazed { glass, inside: gray }.branch(wo);
                let blend = Schlick::new(gray, x * 0.0 + 0.1, x * 0.0 + 1.0).branch(wo);
                let mirrored = Vec3::new(-x, -y, z);
                let scales = a.radiance_scale + b.radiance_scale + c.radiance_scale + d.radiance_scale;
                [
                    off(&a, mirrored) + off(&b, mirrored) + off(&c, mirrored) + 1.0,
                    off(&d, mirrored) + off(&coated, mirrored) + off(&blend, mirrored) + 1.0,
                    off(&ThinDielectric { glass, transmittance: gray }.branches(wo)[1], -wo) + 1.0,
                    scales * 0.25,
                ]
            },
            |_| Some(vec![big(1.0); 4]),
            "exact: signs change, nothing else",
            |_, _| 0.0
        ),
        kernel!(
            "mirror: fraction reflected",
            [above(), fraction()],
            |x, y, z, r| {
                let branch = Mirror { reflectance: Rgb::gray(r) }.branch(Vec3::new(x, y, z));
                [there(&branch, branch.weight.r)]
            },
            |t| Some(vec![if t[2].is_positive() { t[3].clone() } else { big(0.0) }]),
            "exact",
            |_, _| 0.0
        ),
        kernel!(
            "conductor: fraction reflected",
            [few_above(), eta(), extinction()],
            |x, y, z, e, k| {
                let metal = Metal::new(FresnelModel::Exact, Rgb::gray(e), Rgb::gray(k));
                let branch = Conductor { metal }.branch(Vec3::new(x, y, z));
                [there(&branch, branch.weight.g)]
            },
            |t| conductor(&t[2], &t[3], &t[4]).map(|r| vec![r]),
            "1e-6 absolute",
            |_, _| 1e-6
        ),
        kernel!(
            "dielectric: fractions reflected and refracted",
            [few_above(), eta()],
            |x, y, z, e| {
                let [up, down] = Dielectric { glass: Glass::exact(e) }.branches(Vec3::new(x, y, z));
                [there(&up, up.weight.r), there(&down, down.weight.r)]
            },
            |t| {
                let r = reflectance(&t[2], &t[3]);
                Some(vec![r.clone(), big(1.0) - r])
            },
            "a rounding of 1, and what the rounding of the cosine within makes of the reflectance",
            |a, _| 2e-7 + reflectance_off(a[2], a[3], 0.0)
        ),
        kernel!(
            "dielectric: growth of radiance",
            [few_above(), eta()],
            |x, y, z, e| [
                Dielectric { glass: Glass::exact(e) }.branches(Vec3::new(x, y, z))[1].radiance_scale
            ],
            |t| Some(vec![big(1.0) / t[3].square()]),
            "2e-7: a quotient and a square",
            |_, s| 2e-7 * s
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
        kernel!(
            "thin dielectric: fractions reflected and transmitted",
            [cosine(), eta(), fraction()],
            |c, e, a| {
                let pane = ThinDielectric { glass: Glass::exact(e), transmittance: Rgb::gray(a) };
                let [reflected, transmitted] = pane.fractions(c);
                [reflected.r, transmitted.b]
            },
            |t| {
                let Some([r, cos]) = dielectric(&t[0], &t[1]) else { return Some(vec![big(1.0), big(0.0)]) };
                if !cos.is_positive() && t[2] < big(1.0) {
                    return None;
                }
                // What is left after the slanted way; nothing after one of 1e6 times the thickness or more.
                let ln = t[2].ln() / cos.max(&big(1e-30));
                let a = if t[2] == big(1.0) {
                    big(1.0)
                } else if ln < big(-1e4) {
                    big(0.0)
                } else {
                    ln.exp()
                };
                let left = big(1.0) - (&r * &a).square();
                if !left.is_positive() {
                    return Some(vec![big(1.0), big(0.0)]);
                }
                let passed = (big(1.0) - &r).square();
                Some(vec![&r + &passed * a.square() * &r / &left, passed * a / left])
            },
            "4e-7 absolute, twice the reflectance's error, and what the slant's makes of the transmittance: at most 1/e of it",
            |a, _| 4e-7
                + 2.0 * reflectance_off(a[0], a[1], 0.0)
                + 0.4 * (4e-7 + 2.0 * near_critical(a[0], a[1]).min(1.0))
        ),
        kernel!(
            "glazed: fraction reflected by the coat",
            [few_above(), coat()],
            |x, y, z, e| {
                let lobe = Glazed { glass: Glass::exact(e), inside: Rgb::gray(e) };
                let branch = lobe.branch(Vec3::new(x, y, z));
                [there(&branch, branch.weight.r)]
            },
            |t| Some(vec![reflectance(&t[2], &t[3])]),
            "1e-6 of itself",
            |_, r| 1e-6 * r
        ),
        kernel!(
            "Schlick's surface: the mirror",
            [few_above(), fraction(), fraction()],
            |x, y, z, color, r| {
                let branch = Schlick::new(Rgb::gray(color), r, x * 0.0 + 1.0).branch(Vec3::new(x, y, z));
                [there(&branch, branch.weight.r)]
            },
            |t| {
                let share = (big(1.0) - &t[4] * 2.0).square();
                let share = if t[4] < big(0.5) { share } else { big(0.0) };
                Some(vec![share * schlick(&t[2], &t[3])])
            },
            "1e-6 of itself",
            |_, f| 1e-6 * f
        ),
    ]
}
