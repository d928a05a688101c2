//! Laws of scattering: every part of every surface at every angle from one list, at every width that the machine has; `whole` has
//! those of whole surfaces, and that no kind is missing from the list.
//!
//! Chi-square tests are at a significance of 1 in 1000 for all of them together, shared out evenly among lobes, angles and widths
//! (Bonferroni); seeds are fixed. Integrals are midpoint sums in charts where the integrand is nearly constant.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small non-negative numbers")]

#[path = "../support/lobes.rs"]
mod lobes;
#[path = "../support/one_of_each.rs"]
mod one_of_each;
#[path = "../support/random.rs"]
mod random;
#[path = "../support/statistics.rs"]
mod statistics;
mod whole;
#[path = "../support/wide.rs"]
mod wide;

use lobes::{ANGLES, CELLS, Lobe, Part, lobes, viewers};
use random::{Random, from_angles};
use specula::bsdf::microfacet::Ggx;
use specula::bsdf::{
    Bsdf, Conductor, Dielectric, FresnelModel, Glass, Metal, Mirror, RoughConductor, fresnel,
};
use specula::math::lanes::Level;
use specula::math::{Rgb, Vec3};
use wide::{Told, told};

type V = Vec3<f32>;

/// Bound on the relative error of a density that the rounding of unit vectors by 1e-7 brings about. A half vector
/// loses more where its directions nearly cancel, and so do cosines with a facet that light grazes: the one within as the root of
/// what is left of it near total reflection.
fn rounding(lobe: &Lobe, wo: V, wi: V) -> f32 {
    let grazing = lobe.refracting(wo, wi).map_or(0.0, |[o, i]| 5e-7 / o + 5e-7 / (i * i));
    2e-5 + 1.5e-6 / (lobe.width * lobe.reach(wo, wi)) + grazing
}

/// Bound on the relative error of a weight. What a facet of glass reflects depends on its cosine, known only as well as the
/// directions, and steeply so near total reflection.
fn looseness(lobe: &Lobe, wo: V, wi: V) -> f32 {
    match lobe.refracting(wo, wi) {
        Some([_, within]) => 1e-3 + 1e-6 / (within * within),
        None if matches!(lobe.bsdf, Bsdf::RoughDielectric(_)) => 1e-3,
        None => 2e-5,
    }
}

/// What a lobe draws with that many pairs of numbers, at one width.
fn drawn(level: Level, lobe: &Lobe, wo: V, seed: u32, count: u32) -> Vec<Told<f32>> {
    let mut random = Random::new(seed);
    let questions: Vec<_> = (0..count).map(|_| (wo, random.pair())).collect();
    told(level, lobe, &questions)
}

#[test]
fn weights_are_value_times_cosine_over_density() {
    for level in Level::available() {
        for (lobe, wo) in lobes().iter().flat_map(|lobe| viewers().map(|wo| (lobe, wo))) {
            let name = format!("{} ({})", lobe.name, level.name());
            for Told { sample, pdf, f } in drawn(level, lobe, wo, 1, 4000) {
                if !sample.valid {
                    assert!(lobe.loses(), "{name}: nothing at {wo:?}");
                    continue;
                }
                let wi = sample.wi;
                let bound = rounding(lobe, wo, wi);
                // Mirroring at a half vector doubles what its length is off by.
                assert!((wi.length2() - 1.0).abs() < 2e-6, "{name}: {sample:?}");
                assert!((pdf - sample.pdf).abs() <= bound * pdf, "{name}: {pdf} for {sample:?}");
                for (f, weight) in [(f.r, sample.weight.r), (f.g, sample.weight.g)] {
                    let value = f * wi.z.abs() / pdf;
                    let off = (value - weight).abs();
                    assert!(off <= looseness(lobe, wo, wi) * weight, "{name}: {value} for {sample:?}");
                }
            }
        }
    }
}

#[test]
fn samples_fall_as_their_density_says() {
    const N: u32 = 1 << 16;
    let (lobes, levels) = (lobes(), Level::available());
    let significance = 1e-3 / (lobes.len() * ANGLES.len() * levels.len()) as f64;
    let (mut judged, mut skipped) = (0, Vec::new());
    for lobe in &lobes {
        for (angle, wo) in ANGLES.into_iter().zip(viewers()) {
            // Half vectors of the sharpest lobes are not known to a cell at grazing.
            if rounding(lobe, wo, Vec3::new(-wo.x, -wo.y, wo.z)) > 0.1 && lobe.width < 1e-3 {
                skipped.push(format!("{} at {angle} deg", lobe.name));
                continue;
            }
            judged += 1;
            let mut expected = lobe.integrals(wo, |wi| lobe.pdf(wo, wi));
            let mass: f64 = expected.iter().sum();
            // One, or what is left above the surface. The sum errs where the density jumps: along one line of points.
            assert!(mass < 1.002, "{} at {angle} deg: integral {mass}", lobe.name);
            assert!(lobe.loses() || mass > 0.998, "{} at {angle} deg: integral {mass}", lobe.name);
            expected.push(1.0 - mass.min(1.0));
            let total: f64 = expected.iter().sum();
            for value in &mut expected {
                *value *= f64::from(N) / total;
            }
            // Other numbers at every width.
            for (level, seed) in levels.iter().zip(2..) {
                let mut counts = vec![0.0; expected.len()];
                for Told { sample, .. } in drawn(*level, lobe, wo, seed, N) {
                    let [i, j] =
                        lobe.chart.find(wo, sample.wi).map(|x| ((x * f64::from(CELLS)) as usize).min(15));
                    let cell = if sample.valid { i * usize::from(CELLS) + j } else { counts.len() - 1 };
                    counts[cell] += 1.0;
                }
                let (statistic, cells) = statistics::chi_square(&counts, &expected);
                let tail = statistics::chi_square_tail(statistic, cells.max(2) - 1);
                assert!(
                    tail > significance,
                    "{} at {angle} deg, {}: chi-square {statistic} in {cells} cells, tail {tail:e}",
                    lobe.name,
                    level.name()
                );
            }
        }
    }
    assert_eq!(
        skipped,
        ["jitter 1e9, reflection at 80 deg", "jitter 1e9, reflection at 89 deg"],
        "all others are judged"
    );
    assert_eq!(judged + skipped.len(), lobes.len() * ANGLES.len(), "each at each angle");
}

#[test]
fn weights_have_bounds_and_albedos_are_those_known() {
    let mut exact = 0;
    for lobe in lobes() {
        for (angle, wo) in ANGLES.into_iter().zip(viewers()) {
            if let Some(known) = lobe.returns() {
                let off = (lobe.albedo(wo) - f64::from(known)).abs();
                assert!(off < 0.002, "{} at {angle} deg: an albedo off by {off}", lobe.name);
                exact += 1;
            }
            let most = lobe.greatest_weight() * (1.0 + 1e-6);
            for (level, Told { sample, .. }) in Level::available()
                .into_iter()
                .flat_map(|level| drawn(level, &lobe, wo, 3, 1000).into_iter().map(move |told| (level, told)))
                .filter(|(_, told)| told.sample.valid)
            {
                let weight = sample.weight.max_channel();
                assert!(weight <= most, "{} at {angle} deg, {}: {sample:?}", lobe.name, level.name());
            }
        }
    }
    // Matt surfaces and bases, and glossy lobes that lose nothing.
    assert!(exact >= 20 * ANGLES.len(), "only {exact} albedos are known");
}

#[test]
fn reciprocal_lobes_are() {
    let mut random = Random::new(4);
    let pairs: Vec<_> = (0..20_000).map(|_| [random.upper(), random.upper()]).collect();
    let turned: Vec<_> = pairs.iter().map(|[wo, wi]| [*wi, *wo]).collect();
    let check = |name: &str, bound: f32, [wo, wi]: [V; 2], [there, back]: [Rgb<f32>; 2]| {
        let off = (there - back).max_channel().abs();
        assert!(off <= bound * there.max_channel(), "{name}: {wo:?} {wi:?}: {there:?} {back:?}");
    };
    for lobe in lobes().iter().filter(|lobe| lobe.is_reciprocal()) {
        for level in Level::available() {
            let [there, back] = [&pairs, &turned].map(|pairs| told(level, lobe, pairs));
            for ((pair, there), back) in pairs.iter().zip(there).zip(back) {
                let name = format!("{} ({})", lobe.name, level.name());
                check(&name, looseness(lobe, pair[0], pair[1]), *pair, [there.f, back.f]);
            }
        }
    }
}

/// The density against the area that a small square of numbers is stretched to.
#[test]
fn densities_are_jacobians_of_the_warps() {
    let lobes = lobes();
    let wide: Vec<_> = lobes.iter().filter(|lobe| lobe.width > 0.03).collect();
    assert!(wide.len() * 3 > lobes.len() * 2, "most are wide enough to be moved within: {}", wide.len());
    for lobe in wide.into_iter().filter(|lobe| lobe.is_warp()) {
        for level in Level::available() {
            judge_jacobian(level, lobe);
        }
    }
}

/// How far numbers are moved.
const STEP: f32 = 1.0 / 512.0;

fn judge_jacobian(level: Level, lobe: &Lobe) {
    let mut random = Random::new(5);
    let numbers: Vec<_> = (0..400).map(|_| random.pair().map(|x| 0.1 + 0.8 * x)).collect();
    let mut judged = 0;
    for wo in viewers() {
        let steps = [[0.0, 0.0], [STEP, 0.0], [-STEP, 0.0], [0.0, STEP], [0.0, -STEP]];
        let questions: Vec<_> =
            numbers.iter().flat_map(|[u, v]| steps.map(|[du, dv]| (wo, [u + du, v + dv]))).collect();
        let found = told(level, lobe, &questions);
        for ([u, v], five) in numbers.iter().zip(found.chunks_exact(5)) {
            let (center, around) = (five[0].sample, [1, 2, 3, 4].map(|k| five[k].sample));
            // Of two directions that become one each has half of its density.
            let folds = |wi: V| lobe.folds(wo, wi);
            let fold = folds(center.wi);
            let whole = around.iter().all(|s| s.valid && (folds(s.wi) - fold).abs() < 0.5);
            // The concentric map has its creases along the diagonals.
            let crease = ((2.0 * u - 1.0).abs() - (2.0 * v - 1.0).abs()).abs() < 4.0 * STEP;
            let concentric = lobe.part == Part::Matt;
            // Beside total reflection the warp bends like a root.
            let bent = lobe.refracting(wo, center.wi).is_some_and(|cosines| cosines[1] < 0.4);
            if !whole || !center.valid || (crease && concentric) || bent {
                continue;
            }
            let [along_u, along_v] = [around[0].wi - around[1].wi, around[2].wi - around[3].wi];
            let stretch = along_u.cross(along_v).length() / (4.0 * STEP * STEP);
            let product = center.pdf * stretch / fold;
            // Truncation: the step squared, times at most (10 / 1)^2 where the warp bends like the logarithm at 0.9; twice
            // that with refraction after it.
            let bound = if lobe.refracting(wo, center.wi).is_some() { 2e-2 } else { 1e-2 };
            assert!(
                (product - 1.0).abs() < bound,
                "{} ({}) at {wo:?}, {u} {v}: {product}",
                lobe.name,
                level.name()
            );
            judged += 1;
        }
    }
    assert!(judged > 500, "{} ({}): only {judged} judged", lobe.name, level.name());
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
                    let meant = lobe.part == Part::Below;
                    assert!(wi.z > 0.0 || none || meant, "{}: {wi:?} below: {f:?} {pdf}", lobe.name);
                }
            }
        }
    }
}

#[test]
fn specular_branches_obey_snell_and_lose_nothing() {
    let mut random = Random::new(7);
    for i in 0..100_000_u32 {
        let wo = random.upper();
        let eta = if i % 3 == 0 { random.logarithmic(1e-3, 1e3) } else { random.logarithmic(0.4, 2.5) };
        let glass = Dielectric { glass: Glass::exact(eta) };
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
            let [_, back] = Dielectric { glass: Glass::exact(1.0 / eta) }.branches(-wi);
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
        let exact = Metal::new(FresnelModel::Exact, eta, k);
        let metal = Bsdf::Conductor(Conductor { metal: exact });
        let [[Some(flat), None], [Some(gold), None]] = [mirror, metal].map(|b| b.branches(wo)) else {
            panic!("one branch each");
        };
        assert!(flat.weight == Rgb::new(0.9, 0.5, 0.1) && flat.valid && gold.valid, "{flat:?} {gold:?}");
        assert!(gold.weight == fresnel::conductor_rgb(wo.z, eta, k), "{gold:?}");
        assert!(gold.wi == Vec3::new(-wo.x, -wo.y, wo.z) && flat.wi == gold.wi, "{gold:?}");
        // The narrowest rough metal is as good as polished.
        let rough = RoughConductor { metal: exact, facets: Ggx::isotropic(1e-4).into() };
        let sample = rough.sample(wo, [0.3, 0.5]);
        let off = sample.weight - gold.weight;
        assert!(
            (sample.wi - gold.wi).length() < 5e-4 && off.max_channel().abs() < 2e-3,
            "{sample:?} {gold:?}"
        );
    }
}
