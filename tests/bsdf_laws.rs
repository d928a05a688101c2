//! Laws of scattering: every lobe at every angle from one list.
//!
//! Chi-square tests are at a significance of 1 in 1000 for all of them together, shared out evenly (Bonferroni); seeds are
//! fixed. Integrals are midpoint sums in charts where the integrand is nearly constant.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small non-negative numbers")]

#[path = "support/data.rs"]
mod data;
#[path = "support/lobes.rs"]
mod lobes;
#[path = "support/random.rs"]
mod random;
#[path = "support/statistics.rs"]
mod statistics;

use lobes::{ANGLES, Kind, Lobe, lobes, viewers};
use random::{Random, from_angles};
use specula::bsdf::microfacet::Ggx;
use specula::bsdf::{Bsdf, Coat, Conductor, Dielectric, Glazed, Glossy, Mirror, RoughConductor, fresnel};
use specula::math::{Frame, Rgb, Vec3};
use specula::sampling::warp;
use std::f64::consts::PI;

type V = Vec3<f32>;

/// Cells along each side of the chart, and points along each side of a cell.
const CELLS: u16 = 16;
const POINTS: u16 = 20;

/// The integral of `f` over the directions of each cell.
fn integrals(lobe: &Lobe, wo: V, f: impl Fn(V) -> f32) -> Vec<f64> {
    let n = CELLS * POINTS;
    let mut cells = vec![0.0; usize::from(CELLS * CELLS)];
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let at = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(n));
        if let Some((wi, solid_angle)) = lobe.chart.place(wo, at) {
            let cell = usize::from(i / POINTS * CELLS + j / POINTS);
            cells[cell] += f64::from(f(wi)) * solid_angle / f64::from(n).powi(2);
        }
    }
    cells
}

/// Bound on the relative error of a density that the rounding of unit vectors by 1e-7 brings about. A half vector
/// loses more where its directions nearly cancel.
fn rounding(lobe: &Lobe, wo: V, wi: V) -> f32 {
    let reach = if lobe.loses() { (wo + wi).length() } else { 1.0 };
    2e-5 + 1.5e-6 / (lobe.width * reach)
}

#[test]
fn weights_are_value_times_cosine_over_density() {
    for lobe in lobes() {
        for wo in viewers() {
            let mut random = Random::new(1);
            for _ in 0..4000 {
                let sample = lobe.sample(wo, random.pair());
                if !sample.valid {
                    assert!(lobe.loses(), "{}: nothing at {wo:?}", lobe.name);
                    continue;
                }
                let (wi, pdf) = (sample.wi, lobe.pdf(wo, sample.wi));
                let bound = rounding(&lobe, wo, wi);
                // Mirroring at a half vector doubles what its length is off by.
                assert!((wi.length2() - 1.0).abs() < 2e-6, "{}: {sample:?}", lobe.name);
                assert!((pdf - sample.pdf).abs() <= bound * pdf, "{}: {pdf} for {sample:?}", lobe.name);
                let f = lobe.eval(wo, wi);
                let (value, weight) = (f.r * wi.z / pdf, sample.weight.r);
                assert!((value - weight).abs() <= 2e-5 * weight, "{}: {value} for {sample:?}", lobe.name);
                let (value, weight) = (f.g * wi.z / pdf, sample.weight.g);
                assert!((value - weight).abs() <= 2e-5 * weight, "{}: {value} for {sample:?}", lobe.name);
            }
        }
    }
}

#[test]
fn samples_fall_as_their_density_says() {
    const N: u32 = 1 << 16;
    let lobes = lobes();
    let significance = 1e-3 / (lobes.len() * ANGLES.len()) as f64;
    for lobe in &lobes {
        for (angle, wo) in ANGLES.into_iter().zip(viewers()) {
            let mut expected = integrals(lobe, wo, |wi| lobe.pdf(wo, wi));
            let mass: f64 = expected.iter().sum();
            // One, or what is left above the surface. The sum errs where the density jumps: along one line of points.
            assert!(mass < 1.002, "{} at {angle} deg: integral {mass}", lobe.name);
            assert!(lobe.loses() || mass > 0.998, "{} at {angle} deg: integral {mass}", lobe.name);
            expected.push(1.0 - mass.min(1.0));
            let mut counts = vec![0.0; expected.len()];
            let mut random = Random::new(2);
            for _ in 0..N {
                let sample = lobe.sample(wo, random.pair());
                let [i, j] =
                    lobe.chart.find(wo, sample.wi).map(|x| ((x * f64::from(CELLS)) as usize).min(15));
                let cell = if sample.valid { i * usize::from(CELLS) + j } else { counts.len() - 1 };
                counts[cell] += 1.0;
            }
            let total: f64 = expected.iter().sum();
            for value in &mut expected {
                *value *= f64::from(N) / total;
            }
            let (statistic, cells) = statistics::chi_square(&counts, &expected);
            let tail = statistics::chi_square_tail(statistic, cells.max(2) - 1);
            assert!(
                tail > significance,
                "{} at {angle} deg: chi-square {statistic} in {cells} cells, tail {tail:e}",
                lobe.name
            );
        }
    }
}

#[test]
fn no_lobe_makes_light() {
    for lobe in lobes() {
        for (angle, wo) in ANGLES.into_iter().zip(viewers()) {
            let albedo: f64 = integrals(&lobe, wo, |wi| lobe.eval(wo, wi).r * wi.z.max(0.0)).iter().sum();
            assert!(albedo < 1.002, "{} at {angle} deg reflects {albedo}", lobe.name);
            // All here return everything but what falls below the surface.
            assert!(lobe.loses() || albedo > 0.998, "{} at {angle} deg reflects {albedo}", lobe.name);
            let mut random = Random::new(3);
            for _ in 0..1000 {
                let weight = lobe.sample(wo, random.pair()).weight;
                assert!(weight.max_channel() <= 1.0 + 1e-6, "{} at {angle} deg: {weight:?}", lobe.name);
            }
        }
    }
}

#[test]
fn reciprocal_lobes_are() {
    let glazed = Bsdf::Glazed(Coat::new(1.5).over(Rgb::new(0.9, 0.5, 0.1)));
    let mut random = Random::new(4);
    for _ in 0..20_000 {
        let (wo, wi) = (random.upper(), random.upper());
        let mut pairs = vec![("glazed".to_owned(), glazed.eval_diffuse(wo, wi), glazed.eval_diffuse(wi, wo))];
        for lobe in lobes().into_iter().filter(|lobe| !matches!(lobe.kind, Kind::Glossy(_))) {
            pairs.push((lobe.name.clone(), lobe.eval(wo, wi), lobe.eval(wi, wo)));
        }
        for (name, there, back) in pairs {
            let off = there - back;
            assert!(
                off.max_channel().abs() <= 2e-5 * there.max_channel(),
                "{name}: {wo:?} {wi:?}: {there:?} {back:?}"
            );
        }
    }
}

/// The density against the area that a small square of numbers is stretched to.
#[test]
fn densities_are_jacobians_of_the_warps() {
    const STEP: f32 = 1.0 / 256.0;
    for lobe in lobes().into_iter().filter(|lobe| lobe.width > 0.03) {
        let (mut judged, mut random) = (0, Random::new(5));
        for (wo, _) in viewers().into_iter().flat_map(|wo| (0..400).map(move |i| (wo, i))) {
            let [u, v] = random.pair().map(|x| 0.1 + 0.8 * x);
            let at = |du: f32, dv: f32| lobe.sample(wo, [u + du * STEP, v + dv * STEP]);
            let around = [at(1.0, 0.0), at(-1.0, 0.0), at(0.0, 1.0), at(0.0, -1.0)];
            let center = at(0.0, 0.0);
            // Of two directions that become one each has half of its density.
            let folds = |wi: V| match lobe.kind {
                Kind::Glossy(_) => {
                    let r = Vec3::new(-wo.x, -wo.y, wo.z);
                    if 2.0 * r.dot(wi) * wo.z < wi.z { 2.0_f32 } else { 1.0 }
                }
                _ => 1.0,
            };
            let fold = folds(center.wi);
            let whole = around.iter().all(|s| s.valid && (folds(s.wi) - fold).abs() < 0.5);
            // The concentric map has its creases along the diagonals.
            let crease = ((2.0 * u - 1.0).abs() - (2.0 * v - 1.0).abs()).abs() < 4.0 * STEP;
            if !whole || !center.valid || (crease && matches!(lobe.kind, Kind::Diffuse(_))) {
                continue;
            }
            let [along_u, along_v] = [around[0].wi - around[1].wi, around[2].wi - around[3].wi];
            let stretch = along_u.cross(along_v).length() / (4.0 * STEP * STEP);
            let product = center.pdf * stretch / fold;
            // Truncation: the step squared, times at most (10 / 1)^2 where the warp bends like the logarithm at 0.9.
            assert!((product - 1.0).abs() < 1e-2, "{} at {wo:?}, {u} {v}: {product}", lobe.name);
            judged += 1;
        }
        assert!(judged > 1000, "{}: only {judged} judged", lobe.name);
    }
}

#[test]
fn extremes_are_finite() {
    let ends = [0.0, 2.0_f32.powi(-24), 0.5, 1.0 - f32::EPSILON / 2.0];
    for lobe in lobes() {
        for theta in [0.0_f32, 1e-6, 45.0, 89.999] {
            for phi in [0.0_f32, 1.0, 4.0] {
                let wo = from_angles(theta.to_radians(), phi);
                for u2 in ends.into_iter().flat_map(|u| ends.into_iter().map(move |v| [u, v])) {
                    let sample = lobe.sample(wo, u2);
                    let unit = (sample.wi.length2() - 1.0).abs() < 1e-5;
                    assert!(unit && sample.weight.is_finite(), "{} {theta} {u2:?}: {sample:?}", lobe.name);
                    let fair = sample.pdf >= 0.0 && sample.pdf.is_finite();
                    assert!(!sample.valid || fair, "{} {theta} {u2:?}: {sample:?}", lobe.name);
                    let (f, pdf) = (lobe.eval(wo, sample.wi), lobe.pdf(wo, sample.wi));
                    assert!(
                        f.is_finite() && f.r >= 0.0 && pdf.is_finite() && pdf >= 0.0,
                        "{}: {f:?}",
                        lobe.name
                    );
                }
                // Below the surface, and away from the lobe.
                for wi in [Vec3::new(0.0, 0.0, -1.0), -wo, Vec3::new(1.0, 0.0, 0.0), from_angles(0.3, phi)] {
                    let (f, pdf) = (lobe.eval(wo, wi), lobe.pdf(wo, wi));
                    assert!(f.is_finite() && pdf.is_finite(), "{}: {wi:?} {f:?} {pdf}", lobe.name);
                    let none = f.r.to_bits() == 0 && pdf.to_bits() == 0;
                    assert!(wi.z > 0.0 || none, "{}: {wi:?} below: {f:?} {pdf}", lobe.name);
                }
            }
        }
    }
}

/// Exponent, and the fraction of raw samples below the surface at 15, 30, 45, 60, 75, 80, 85, 89 degrees.
const BELOW: [(f32, [f64; 8]); 10] = [
    (0.0, [0.0833, 0.1667, 0.25, 0.3333, 0.4167, 0.4444, 0.4722, 0.4944]),
    (1.0, [0.01704, 0.06699, 0.1464, 0.25, 0.3706, 0.4132, 0.4564, 0.4913]),
    (2.0, [0.003756, 0.02883, 0.09085, 0.1955, 0.3371, 0.39, 0.4446, 0.4889]),
    (5.0, [4.82e-5, 0.002712, 0.02491, 0.1035, 0.268, 0.3404, 0.4187, 0.4836]),
    (10.0, [4.2e-8, 6.5e-5, 0.003436, 0.04093, 0.1966, 0.2852, 0.3885, 0.4774]),
    (20.0, [0.0, 4.7e-8, 8.1e-5, 0.00756, 0.1165, 0.2141, 0.3463, 0.4685]),
    (50.0, [0.0, 0.0, 1.6e-9, 6.9e-5, 0.03065, 0.1068, 0.2674, 0.4506]),
    (100.0, [0.0, 0.0, 0.0, 3.8e-8, 0.00415, 0.0397, 0.1907, 0.4305]),
    (1000.0, [0.0, 0.0, 0.0, 0.0, 4e-17, 1.6e-8, 0.00287, 0.2904]),
    (10000.0, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2e-18, 0.0405]),
];

#[test]
fn the_lobe_dips_below_the_surface_as_the_table_says() {
    const N: u32 = 1 << 17;
    for (exponent, row) in BELOW {
        for (angle, fraction) in [15.0_f32, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 89.0].into_iter().zip(row) {
            let wo = from_angles(angle.to_radians(), 0.3);
            let about = Frame::about(Vec3::new(-wo.x, -wo.y, wo.z));
            let lobe = Glossy { reflectance: Rgb::gray(0.8), exponent };
            let (mut below, mut random) = (0, Random::new(6));
            for _ in 0..N {
                let u2 = random.pair();
                let raw = about.to_world(warp::power_cosine(u2, exponent));
                below += u32::from(raw.z < 0.0);
                // What the fix makes of it: always above, always the same weight, whatever the direction.
                let sample = lobe.sample(wo, u2);
                assert!(sample.valid && sample.wi.z > 0.0, "{exponent} at {angle} deg: {sample:?}");
                assert!(sample.weight.r.to_bits() == 0.8_f32.to_bits(), "{exponent}: {sample:?}");
                let kept = (sample.wi - raw).length() < 1e-6;
                assert!(kept == (raw.z >= 0.0), "{exponent} at {angle} deg: {raw:?} became {sample:?}");
            }
            let expected = f64::from(N) * fraction;
            // Four and a half standard deviations, for 80 of them; the table has four digits.
            let bound = 4.5 * (expected * (1.0 - fraction)).sqrt() + 1e-3 * expected + 3.0;
            assert!(
                (f64::from(below) - expected).abs() <= bound,
                "{exponent} at {angle} deg: {below}, not {expected}"
            );
        }
    }
}

#[test]
fn ggx_is_normalised_and_masks_what_it_must() {
    for [ax, ay] in [[0.1, 0.1], [0.1, 0.4], [0.5, 0.3], [1.0, 1.0]] {
        let ggx = Ggx { alpha_x: ax, alpha_y: ay };
        let views = viewers();
        let (mut area, mut seen, n) = (0.0, [0.0; 5], 1000_u16);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let x = (f32::from(i) + 0.5) / f32::from(n);
            let (theta, phi) =
                (std::f32::consts::FRAC_PI_2 * x * x, (f32::from(j) + 0.5) / f32::from(n) * 2.0);
            let h = from_angles(theta, phi * std::f32::consts::PI);
            let solid_angle = f64::from(theta.sin() * 2.0 * x) * PI * PI / f64::from(n).powi(2);
            let d = f64::from(ggx.d(h)) * solid_angle;
            area += d * f64::from(h.z);
            for (sum, w) in seen.iter_mut().zip(views) {
                *sum += d * f64::from(w.dot(h).max(0.0) * ggx.g1(w));
            }
            let slopes = (f64::from(h.x / ax)).powi(2) + f64::from(h.y / ay).powi(2) + f64::from(h.z).powi(2);
            let exact = 1.0 / (PI * f64::from(ax) * f64::from(ay) * slopes * slopes);
            assert!((f64::from(ggx.d(h)) / exact - 1.0).abs() < 2e-6, "{ax} {ay} {h:?}: {}", ggx.d(h));
        }
        assert!((area - 1.0).abs() < 1e-4, "{ax} {ay}: normals stand over an area of {area}");
        // What a direction sees of the microfacets is what it sees of the surface (Heitz 2014, eq. 14).
        for (sum, w) in seen.into_iter().zip(views) {
            assert!((sum / f64::from(w.z) - 1.0).abs() < 2e-4, "{ax} {ay}: {w:?} sees {sum}");
        }
    }
}

#[test]
fn published_masking_is_met() {
    let Some(rows) = data::rows("optics/microfacet_reference.csv") else { return };
    let mut seen = 0;
    for row in rows.iter().filter(|row| row[0] == "ggx" && row[3] == "G1") {
        let [ax, ay, theta, phi, expected] =
            [1, 2, 4, 5, 6].map(|i| row[i].parse::<f32>().expect("a number"));
        let w = from_angles(theta, phi);
        if w.z > 1e-6 {
            let found = Ggx { alpha_x: ax, alpha_y: ay }.g1(w);
            assert!((found - expected).abs() < 2e-6, "{row:?}: {found}");
            seen += 1;
        }
    }
    assert!(seen >= 70, "only {seen} rows");
}

#[test]
fn specular_branches_obey_snell_and_lose_nothing() {
    let mut random = Random::new(7);
    for i in 0..100_000_u32 {
        let wo = random.upper();
        let eta = if i % 3 == 0 { random.logarithmic(1e-3, 1e3) } else { random.logarithmic(0.4, 2.5) };
        let glass = Dielectric { eta };
        let [reflected, refracted] = glass.branches(wo);
        let part = |valid: bool, weight: f32| if valid { weight } else { 0.0 };
        let sum = part(reflected.valid, reflected.weight.r) + part(refracted.valid, refracted.weight.r);
        assert!((sum - 1.0).abs() < 1.2e-7, "{eta} {wo:?}: {reflected:?} {refracted:?}");
        assert!(!reflected.transmission && refracted.transmission, "order");
        assert!(
            (reflected.wi + wo - Vec3::new(0.0, 0.0, 2.0 * wo.z)).length() < 1e-7,
            "{wo:?} {reflected:?}"
        );
        if !refracted.valid {
            assert!(eta < 1.0, "total reflection into a denser medium: {eta} {wo:?}");
            continue;
        }
        let wi = refracted.wi;
        let off = (wi.x * eta + wo.x).hypot(wi.y * eta + wo.y);
        // The squared cosine within is known to 1e-7 / eta^2 (a tangent of 1e-7 / eta), and the vector is scaled to unit.
        assert!(wi.z <= 0.0 && off < 4e-7 * eta.max(eta.recip()), "{eta} {wo:?}: {wi:?}");
        assert!((wi.length2() - 1.0).abs() < 1e-6, "{eta} {wo:?}: {wi:?}");
        // The way back, where the critical angle is not within rounding.
        if eta > 1.01 && eta < 3.0 && wo.z > 0.05 {
            let [_, back] = Dielectric { eta: 1.0 / eta }.branches(-wi);
            assert!(back.valid && (back.wi + wo).length() < 1e-5 / wo.z, "{eta} {wo:?}: back {back:?}");
            let bound = 3e-6 * (1.0 + eta * eta) * eta / wo.z;
            assert!((back.weight.r - refracted.weight.r).abs() < bound, "{eta} {wo:?}: back {back:?}");
            let scale = back.radiance_scale * refracted.radiance_scale;
            assert!((scale - 1.0).abs() < 1e-6, "radiance per squared index is kept: {scale}");
            assert!((refracted.radiance_scale * eta * eta - 1.0).abs() < 1e-6, "and grows with that index");
        }
    }
}

#[test]
fn mirrors_reflect_by_their_reflectance() {
    let (eta, k) = (Rgb::new(0.143, 0.375, 1.442), Rgb::new(3.983, 2.386, 1.603));
    for wo in viewers() {
        let mirror = Bsdf::Mirror(Mirror { reflectance: Rgb::new(0.9, 0.5, 0.1) });
        let metal = Bsdf::Conductor(Conductor { eta, k });
        let [[Some(flat), None], [Some(gold), None]] = [mirror, metal].map(|b| b.branches(wo)) else {
            panic!("one branch each");
        };
        assert!(flat.weight == Rgb::new(0.9, 0.5, 0.1) && flat.valid && gold.valid, "{flat:?} {gold:?}");
        assert!(gold.weight == fresnel::conductor_rgb(wo.z, eta, k), "{gold:?}");
        assert!(gold.wi == Vec3::new(-wo.x, -wo.y, wo.z) && flat.wi == gold.wi, "{gold:?}");
        // The narrowest rough metal is as good as polished.
        let rough = RoughConductor { eta, k, ggx: Ggx::isotropic(1e-4) };
        let sample = rough.sample(wo, [0.3, 0.5]);
        let off = sample.weight - gold.weight;
        assert!(
            (sample.wi - gold.wi).length() < 5e-4 && off.max_channel().abs() < 2e-3,
            "{sample:?} {gold:?}"
        );
    }
}

#[test]
fn a_glaze_over_white_loses_nothing() {
    for ior in [1.0_f32, 1.0001, 1.1, 1.5, 2.4] {
        let glazed: Glazed<f32> = Coat::new(ior).over(Rgb::new(1.0, 0.5, 0.0));
        for wo in viewers() {
            let (mut white, mut gray, n) = (0.0, 0.0, 400_u16);
            for (i, j) in (0..n).flat_map(|i| (0..8_u16).map(move |j| (i, j))) {
                let x = (f32::from(i) + 0.5) / f32::from(n);
                let (cos, phi) = (x * x * x, f32::from(j));
                let f = glazed.diffuse(wo, from_angles(cos.acos(), phi));
                let solid_angle = 3.0 * x * x * cos * std::f32::consts::TAU / (f32::from(n) * 8.0);
                white += f64::from(f.r * solid_angle);
                gray += f64::from(f.g * solid_angle);
                assert!(f.b.to_bits() == 0, "black stays black: {f:?}");
            }
            let coat = f64::from(glazed.branch(wo).weight.r);
            assert!((coat + white - 1.0).abs() < 1e-4, "{ior} {wo:?}: {coat} and {white}");
            assert!(gray < 0.5 * white + 1e-6, "{ior} {wo:?}: bounces within darken: {gray} beside {white}");
        }
    }
}
