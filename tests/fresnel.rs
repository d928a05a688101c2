//! Laws of reflectance at smooth interfaces, against tables made in 40 digits, the textbook's forms in double precision
//! (Born and Wolf 1999, *Principles of Optics*, 1.5.2 and 14.2) and, where they are at hand, published spot values.

#![expect(clippy::cast_possible_truncation, reason = "tables in double precision are asked for in single")]

#[path = "support/data.rs"]
mod data;
#[path = "support/random.rs"]
mod random;

use random::Random;
use specula::bsdf::{Dielectric, FresnelModel, Glass, Metal, fresnel};
use specula::math::{Rgb, Vec3};

fn dielectric(cos: f64, eta: f64) -> f64 {
    f64::from(fresnel::dielectric(cos as f32, eta as f32).reflectance)
}

fn conductor(cos: f64, eta: f64, k: f64) -> f64 {
    f64::from(fresnel::conductor(cos as f32, eta as f32, k as f32))
}

/// The reflectance of glass by a model.
fn by(model: FresnelModel, cos: f64, eta: f64) -> f64 {
    f64::from(Glass::new(model, eta as f32).at(cos as f32).reflectance)
}

fn by_schlick(cos: f32, eta: f32) -> f32 {
    Glass::new(FresnelModel::Schlick, eta).at(cos).reflectance
}

/// The reflectance of a metal by a model.
fn metal_by(model: FresnelModel, cos: f64, eta: f64, k: f64) -> f64 {
    let metal = Metal::new(model, Rgb::gray(eta as f32), Rgb::gray(k as f32));
    f64::from(metal.at(cos as f32).g)
}

const MODELS: [FresnelModel; 4] =
    [FresnelModel::Exact, FresnelModel::Schlick, FresnelModel::F82, FresnelModel::Constant];

/// What glass and metal reflect by all models.
fn reflectances(cos: f32, eta: f32, k: f32) -> Vec<f32> {
    let glass = MODELS.map(|model| Glass::new(model, eta).at(cos).reflectance);
    let metal = MODELS.map(|model| Metal::new(model, Rgb::gray(eta), Rgb::gray(k)).at(cos).r);
    [glass, metal].concat()
}

fn cos_deg(angle: f64) -> f64 {
    angle.to_radians().cos()
}

/// The textbook's form, which cancels for eta near 1: good enough in double precision.
fn exact_dielectric(c: f64, eta: f64) -> f64 {
    let ct2 = 1.0 - (1.0 - c * c) / (eta * eta);
    if ct2 <= 0.0 {
        return 1.0;
    }
    let ct = ct2.sqrt();
    let (r_s, r_p) = ((c - eta * ct) / (c + eta * ct), (eta * c - ct) / (eta * c + ct));
    (r_s * r_s + r_p * r_p) / 2.0
}

/// |a / b|^2 of complex numbers.
fn ratio2(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] * a[0] + a[1] * a[1]) / (b[0] * b[0] + b[1] * b[1])
}

/// 1 - R by the complex form.
fn exact_loss(c: f64, eta: f64, k: f64) -> f64 {
    // n cos_t = sqrt(n^2 - sin^2), in the first quadrant.
    let (x, y) = (eta * eta - k * k - (1.0 - c * c), 2.0 * eta * k);
    let (a, b) = (((x.hypot(y) + x) / 2.0).max(0.0).sqrt(), ((x.hypot(y) - x) / 2.0).max(0.0).sqrt());
    let r_s = ratio2([c - a, -b], [c + a, b]);
    // r_p = (n^2 c - n cos_t) / (n^2 c + n cos_t).
    let (u, v) = ((eta * eta - k * k) * c, 2.0 * eta * k * c);
    let r_p = ratio2([u - a, v - b], [u + a, v + b]);
    1.0 - (r_s + r_p) / 2.0
}

const ANGLES: [f64; 7] = [0.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0];

#[test]
fn dielectrics_follow_the_table() {
    let table = [
        (
            1.33,
            [
                0.0200593122,
                0.0211124579,
                0.0275213836,
                0.0591255993,
                0.2114266041,
                0.5827282449,
                0.8960465052,
            ],
        ),
        (1.5, [0.04, 0.0415226260, 0.0502399110, 0.0891867128, 0.2530605630, 0.6127996453, 0.9041849498]),
        (
            2.4,
            [
                0.1695501730,
                0.1710603257,
                0.1788169988,
                0.2093512608,
                0.3297739349,
                0.6221969146,
                0.9000445175,
            ],
        ),
        (2.0 / 3.0, [0.04, 0.0551901673, 1.0, 1.0, 1.0, 1.0, 1.0]),
    ];
    for (eta, row) in table {
        for (angle, expected) in ANGLES.into_iter().zip(row) {
            let found = dielectric(cos_deg(angle), eta);
            assert!((found - expected).abs() <= 4e-7, "eta {eta}, {angle} deg: {found}, not {expected}");
            let textbook = exact_dielectric(cos_deg(angle), eta);
            assert!((textbook - expected).abs() < 1e-10, "the oracle: eta {eta}, {angle} deg: {textbook}");
        }
    }
    let brewster = dielectric(cos_deg(56.309_932_474), 1.5);
    assert!((brewster - 0.073_964_497_04).abs() < 1e-7, "Brewster's angle: {brewster}");
    // Near the critical angle 1e-7 in the cosine is 2e-6 in the reflectance.
    let inside = dielectric(cos_deg(41.0), 2.0 / 3.0);
    assert!((inside - 0.379_751_266).abs() < 2e-6, "from within at 41 degrees: {inside}");
}

#[test]
fn conductors_follow_the_table() {
    let table = [
        (0.2, 3.0, [0.9233716475, 0.9229376537, 0.9184110847, 0.9252231385, 0.9635985618, 0.9921263214]),
        (
            0.14282,
            3.97472,
            [0.9666004784, 0.9663375292, 0.9621341507, 0.9592240417, 0.9761054657, 0.9946394814],
        ),
        (1.0972, 6.7943, [0.9131975079, 0.9124702113, 0.8976910367, 0.8661994708, 0.8711457198, 0.962473565]),
        (1.0, 1.0, [0.2, 0.2058847194, 0.3075653821, 0.5023596979, 0.7786504589, 0.949701985]),
        (2.0, 1000.0, [0.9999920001, 0.9999919172, 0.9999900001, 0.9999835104, 0.9999537648, 0.9997715382]),
    ];
    for (eta, k, row) in table {
        for (angle, expected) in [0.0, 30.0, 60.0, 75.0, 85.0, 89.0].into_iter().zip(row) {
            let found = conductor(cos_deg(angle), eta, k);
            assert!((found - expected).abs() <= 3e-7, "{eta} + {k} i, {angle} deg: {found}, not {expected}");
            let loss = exact_loss(cos_deg(angle), eta, k);
            assert!((1.0 - loss - expected).abs() < 1e-9, "the oracle: {eta} + {k} i, {angle} deg: {loss}");
        }
        let normal = ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k);
        assert!((conductor(1.0, eta, k) - normal).abs() <= 1.2e-7, "{eta} + {k} i at normal incidence");
        assert!((conductor(0.0, eta, k) - 1.0).abs() < 1e-7, "{eta} + {k} i grazing");
    }
}

#[test]
fn a_conductor_without_extinction_is_a_dielectric() {
    for eta in [1.33, 1.5, 2.4, 2.0 / 3.0, 0.2] {
        for i in 0..=1000 {
            let c = f64::from(i) / 1000.0;
            let (metal, glass) = (conductor(c, eta, 0.0), dielectric(c, eta));
            // Both take the root of what is left of the cosine beyond the critical one.
            let left = (c * c + eta * eta - 1.0).abs().sqrt().max(3e-4);
            let bound = 1e-6 + 2e-7 / left;
            assert!((metal - glass).abs() <= bound, "eta {eta}, cosine {c}: {metal}, not {glass}");
        }
    }
}

#[test]
fn means_over_the_hemisphere_follow_the_table() {
    let table = [
        (1.1, 0.0251573573529, 0.194344923432),
        (1.33, 0.0659308492994, 0.471949148793),
        (1.5, 0.0917779593424, 0.596345759708),
        (2.0, 0.16059663707, 0.790149159267),
        (2.4, 0.21018130201, 0.862878698266),
    ];
    for (n, outside, inside) in table {
        let found = [fresnel::average_outside(n), FresnelModel::Exact.average_inside(n)];
        assert!((found[0] - outside).abs() < 3e-12, "{n} from outside: {}", found[0]);
        assert!((found[1] - inside).abs() < 3e-12, "{n} from inside: {}", found[1]);
    }
    // Where the closed form gives way to quadrature, and down to no interface at all.
    for n in [1.0, 1.0 + 1e-9, 1.0001, 1.003, 1.01, 1.02, 1.049_999, 1.050_001, 1.2] {
        let expected = mean(|c| if n > 1.0 { stable_dielectric(c, n) } else { 0.0 });
        let found = fresnel::average_outside(n);
        assert!((found - expected).abs() <= 3e-8 * expected, "{n} from outside: {found}, not {expected}");
        // From inside the same light is lost: beyond the critical angle all of it.
        assert!((0.0..1.0).contains(&FresnelModel::Exact.average_inside(n)), "{n} from inside");
    }
}

/// By the factors that do not cancel, for indices that the textbook's form cannot tell from 1.
fn stable_dielectric(c: f64, n: f64) -> f64 {
    let d = (n - 1.0) * (n + 1.0);
    let (g, s2) = ((d + c * c).sqrt(), (1.0 - c) * (1.0 + c));
    let r_s = d / (c + g).powi(2);
    let r_p = r_s * (c * g - s2) / (c * g + s2);
    (r_s * r_s + r_p * r_p) / 2.0
}

/// The mean over the hemisphere, weighted by the cosine: Simpson's rule in t with c = t^4, for what happens at grazing.
fn mean(f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: u32 = 100_000;
    let at = |i: u32| {
        let t = f64::from(i) / f64::from(STEPS);
        f(t.powi(4)) * 8.0 * t.powi(7)
    };
    let weight = |i: u32| match i {
        0 | STEPS => 1.0,
        _ if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    (0..=STEPS).map(|i| weight(i) * at(i)).sum::<f64>() / (3.0 * f64::from(STEPS))
}

/// Index; greatest error and its angle; least error and its angle; mean reflectance, exact and by Schlick.
type Errors = (f64, (f64, f64), (f64, f64), (f64, f64));

#[test]
fn schlick_errs_as_the_table_says() {
    // Angles are known to the degree, errors to the digits given; where no error is below zero no angle is given.
    let table: [Errors; 8] = [
        (1.01, (0.550, 86.0), (0.0, 0.0), (0.00315, 0.04764)),
        (1.1, (0.210, 83.0), (-0.0002, 0.0), (0.02516, 0.04978)),
        (1.2, (0.113, 83.0), (-0.0022, 47.0), (0.04428, 0.05549)),
        (1.33, (0.0599, 84.0), (-0.0092, 57.0), (0.06593, 0.06672)),
        (1.5, (0.0357, 85.0), (-0.0196, 62.0), (0.09178, 0.08571)),
        (2.0, (0.0444, 85.0), (-0.0231, 62.0), (0.16060, 0.15344)),
        (2.4, (0.0740, 84.0), (-0.0140, 58.0), (0.21018, 0.20910)),
        (4.0, (0.201, 84.0), (0.0, 0.0), (0.36664, 0.39048)),
    ];
    for (eta, most, least, means) in table {
        let schlick = |c: f64| by(FresnelModel::Schlick, c, eta);
        let errors = (0..=9000).map(|i| {
            let angle = f64::from(i) / 100.0;
            (schlick(cos_deg(angle)) - exact_dielectric(cos_deg(angle), eta), angle)
        });
        let found_most = errors.clone().max_by(|a, b| a.0.total_cmp(&b.0)).expect("many");
        let found_least = errors.min_by(|a, b| a.0.total_cmp(&b.0)).expect("many");
        for (found, expected) in [(found_most, most), (found_least, least)] {
            let digit = if expected.0.abs() >= 0.1 { 5e-4 } else { 5e-5 };
            assert!((found.0 - expected.0).abs() <= digit * 1.01, "eta {eta}: {found:?}, not {expected:?}");
            let known = expected.1 > 0.0;
            assert!(!known || (found.1 - expected.1).abs() <= 0.6, "eta {eta}: {found:?}, not {expected:?}");
        }
        let found = (mean(|c| exact_dielectric(c, eta)), mean(schlick));
        assert!((found.0 - means.0).abs() <= 5.1e-6, "eta {eta}: mean {}", found.0);
        assert!((found.1 - means.1).abs() <= 5.1e-6, "eta {eta}: Schlick's mean {}", found.1);
        let r0 = f64::from(fresnel::normal_incidence(eta as f32));
        assert!(
            (found.1 - (r0 + (1.0 - r0) / 21.0)).abs() < 1e-6,
            "eta {eta}: Schlick's mean in closed form"
        );
    }
}

#[test]
fn schlick_overrates_metals_at_grazing() {
    for (eta, k, expected) in [(1.1, 6.79, 0.102), (2.95, 2.93, 0.176), (3.2, 3.3, 0.198)] {
        let r0 = conductor(1.0, eta, k) as f32;
        let error = |i: u32| {
            let c = cos_deg(f64::from(i) / 10.0);
            f64::from(fresnel::schlick(c as f32, r0)) - (1.0 - exact_loss(c, eta, k))
        };
        let most = (0..=900).map(error).fold(0.0, f64::max);
        assert!((most - expected).abs() <= 1.01e-3, "{eta} + {k} i: {most}, not {expected}");
    }
}

/// Greatest errors over all angles of Schlick's form and of that with the edge term, found by the same formulas in double
/// precision.
#[test]
fn the_edge_term_takes_most_of_the_error_away() {
    let worst = |error: &dyn Fn(f64) -> f64| {
        (0..=9000).map(|i| error(cos_deg(f64::from(i) / 100.0)).abs()).fold(0.0, f64::max)
    };
    let glass = [
        (1.01, 0.5497, 0.2504),
        (1.1, 0.2105, 0.0222),
        (1.33, 0.0599, 0.0199),
        (1.5, 0.0357, 0.0276),
        (2.0, 0.0444, 0.0332),
        (2.4, 0.0740, 0.0299),
        (4.0, 0.2009, 0.0401),
    ];
    for (eta, plain, with_edge) in glass {
        for (model, expected) in [(FresnelModel::Schlick, plain), (FresnelModel::F82, with_edge)] {
            let found = worst(&|c| by(model, c, eta) - exact_dielectric(c, eta));
            assert!((found - expected).abs() < 2e-4, "{model:?}, glass of {eta}: {found}, not {expected}");
        }
    }
    let metals = [
        (1.1, 6.79, 0.1021, 0.0094),
        (2.95, 2.93, 0.1759, 0.0187),
        (3.2, 3.3, 0.1983, 0.0240),
        (0.143, 3.983, 0.0164, 0.0039),
        (1.442, 1.603, 0.0293, 0.0286),
    ];
    for (eta, k, plain, with_edge) in metals {
        for (model, expected) in [(FresnelModel::Schlick, plain), (FresnelModel::F82, with_edge)] {
            let found = worst(&|c| metal_by(model, c, eta, k) - (1.0 - exact_loss(c, eta, k)));
            assert!((found - expected).abs() < 2e-4, "{model:?}, {eta} + {k} i: {found}, not {expected}");
        }
        let known = 1.0 / 7.0;
        let off = metal_by(FresnelModel::F82, known, eta, k) - (1.0 - exact_loss(known, eta, k));
        assert!(off.abs() < 1e-6, "{eta} + {k} i: off by {off} where it is exact");
    }
}

/// The table in the documentation of `FresnelModel`'s file, digit by digit: greatest errors over all angles.
#[test]
fn errors_are_those_that_the_documentation_states() {
    let lines = include_str!("../src/bsdf/reflectance.rs").lines();
    let rows = lines.filter_map(|line| line.strip_prefix("//! | ")).map(|row| row.split('|').map(str::trim));
    let rows: Vec<Vec<&str>> = rows.map(Iterator::collect).filter(|row: &Vec<_>| row.len() == 8).collect();
    let worst = |error: &dyn Fn(f64) -> f64| {
        (0..=9000).map(|i| error(cos_deg(f64::from(i) / 100.0)).abs()).fold(0.0, f64::max)
    };
    let mut checked = 0;
    let mut check = |name: &str, model: FresnelModel, printed: &str, found: f64| {
        let stated: f64 = printed.parse().unwrap_or_else(|_| panic!("{name}: {printed}"));
        // Half of the last digit, and what the grid of angles misses.
        let digits = printed.split('.').nth(1).map_or(0, str::len);
        let half = 0.5 * 0.1_f64.powi(i32::try_from(digits).expect("few"));
        assert!((found - stated).abs() <= half + 2e-5, "{name}, {model:?}: {found}, stated {printed}");
        checked += 1;
    };
    for row in rows.iter().filter(|row| row[0].parse::<f64>().is_ok()) {
        let [index, plain, edge, _, metal, plain_of_metal, edge_of_metal, _] = row[..] else {
            panic!("{row:?}")
        };
        let eta: f64 = index.parse().expect("an index");
        for (model, printed) in [(FresnelModel::Schlick, plain), (FresnelModel::F82, edge)] {
            check(index, model, printed, worst(&|c| by(model, c, eta) - exact_dielectric(c, eta)));
        }
        let numbers =
            metal.rsplit('(').next().unwrap_or(metal).trim_end_matches(" i)").trim_end_matches(" i");
        let (eta, k) = numbers.split_once(" + ").unwrap_or_else(|| panic!("{metal}"));
        let [eta, k] = [eta, k].map(|text| text.parse::<f64>().unwrap_or_else(|_| panic!("{metal}")));
        for (model, printed) in [(FresnelModel::Schlick, plain_of_metal), (FresnelModel::F82, edge_of_metal)]
        {
            let error = |c| metal_by(model, c, eta, k) - (1.0 - exact_loss(c, eta, k));
            check(metal, model, printed, worst(&error));
        }
    }
    assert_eq!(checked, 20, "five indices and five metals by two models");
}

#[test]
fn models_meet_at_normal_incidence_and_where_nothing_passes() {
    for model in MODELS {
        for eta in [1.2, 1.5, 2.4, 1.0 / 1.2, 1.0 / 2.4] {
            let straight = by(model, 1.0, eta) - exact_dielectric(1.0, eta);
            assert!(straight.abs() < 2e-7, "{model:?} {eta}: off by {straight} straight on");
            let total = Glass::new(model, eta as f32).at(0.3);
            assert_eq!(total.total, eta < 0.95, "{model:?} {eta}: total reflection");
            assert!(
                !total.total || total.reflectance.to_bits() == 1.0_f32.to_bits(),
                "{model:?} {eta}: {total:?}"
            );
        }
        assert!(by(model, 0.2, 1.0).to_bits() == 0, "{model:?}: no interface reflects nothing");
        let straight = metal_by(model, 1.0, 0.2, 3.0) - (1.0 - exact_loss(1.0, 0.2, 3.0));
        assert!(straight.abs() < 2e-7, "{model:?}: metal off by {straight} straight on");
    }
}

#[test]
fn schlick_keeps_to_the_side_of_the_lower_index() {
    for eta in [1.3_f32, 1.5, 2.0, 2.2] {
        for i in 0..=1000_u16 {
            let c = f32::from(i) / 1000.0;
            let (outside, inside) = (fresnel::dielectric(c, eta), fresnel::dielectric(c, 1.0 / eta));
            let error = by_schlick(c, eta) - outside.reflectance;
            assert!(error.abs() < 0.07, "into {eta}, cosine {c}: {error}");
            let error = by_schlick(c, 1.0 / eta) - inside.reflectance;
            assert!(error.abs() < 0.07, "out of {eta}, cosine {c}: {error}");
        }
    }
}

#[test]
fn near_matched_indices_keep_their_digits() {
    // Measured: 7e-7 for each; the textbook's form reaches 0.14.
    for exponent in 1..=6 {
        for sign in [1.0_f32, -1.0] {
            let eta = 1.0 + sign * 10.0_f32.powi(-exponent);
            let wide = f64::from(eta);
            let worst = (0..20_000_u16).map(|i| 0.05 + 0.95 * f32::from(i) / 19_999.0).map(|c| {
                let c64 = f64::from(c);
                let d = (wide - 1.0) * (wide + 1.0);
                if d + c64 * c64 <= 0.0 {
                    return 0.0;
                }
                let exact = stable_dielectric(c64, wide);
                let error = (f64::from(fresnel::dielectric(c, eta).reflectance) - exact).abs() / exact;
                // From within, what is left of the cosine is small near the critical angle, and known that much less.
                let left = if d < 0.0 { 5e-7 * d.abs() / (d + c64 * c64) } else { 0.0 };
                error / (2.8e-6 + left)
            });
            let worst = worst.fold(0.0, f64::max);
            assert!(worst <= 1.0, "eta {eta}: {worst} times the bound");
        }
    }
}

#[test]
fn good_mirrors_keep_their_losses() {
    for (eta, k, measured) in [(0.2, 3.0, 4.4e-5), (2.0, 1000.0, 3.7e-3), (50.0, 50.0, 9e-7)] {
        let worst = (0..100_000_u32).map(|i| 0.001 + 0.999 * i as f32 / 99_999.0).map(|c| {
            let exact = exact_loss(f64::from(c), f64::from(eta as f32), f64::from(k as f32));
            ((1.0 - conductor(f64::from(c), eta, k)) - exact).abs() / exact
        });
        let worst = worst.fold(0.0, f64::max);
        assert!(worst <= 4.0 * measured, "{eta} + {k} i: relative error of the loss {worst:e}");
    }
}

#[test]
fn both_sides_reflect_alike() {
    let mut random = Random::new(1);
    for _ in 0..100_000 {
        let [u, v, _] = random.triple();
        // Nearer to grazing the critical angle of the way back is within rounding.
        let (c, eta) = (u.max(0.02), 1.0 + 3.0 * v);
        let there = fresnel::dielectric(c, eta);
        let back = fresnel::dielectric(there.cos_t, 1.0 / eta);
        // Near the critical angle 1 - R is 2 g (1 + eta^2) / cos_t with g = c / eta, the root of what 1e-7 is lost of.
        let bound = 1e-6 + 2.4e-7 * (1.0 + eta * eta) * eta / (c * there.cos_t);
        let difference = (there.reflectance - back.reflectance).abs();
        assert!(difference <= bound, "eta {eta}, cosine {c}: {there:?}, back {back:?}");
        let difference = (back.cos_t * back.cos_t - c * c).abs();
        assert!(back.total || difference <= 1e-6 * eta * eta, "eta {eta}, cosine {c}: back {}", back.cos_t);
    }
}

#[test]
fn reflectance_is_a_fraction_whatever_is_asked() {
    let mut random = Random::new(2);
    let ends = [0.0, 1e-45, f32::MIN_POSITIVE, 1e-20, 1.0 - f32::EPSILON / 2.0, 1.0];
    for i in 0..1_000_000_usize {
        let c = if i % 4 == 0 { ends[i / 4 % ends.len()] } else { random.unit() };
        let eta = match i % 7 {
            0 => 1.0,
            1 => 1.0 + f32::EPSILON,
            2 => 1.0 - f32::EPSILON / 2.0,
            _ => random.logarithmic(1e-3, 1e3),
        };
        let k = if i % 5 == 0 { 0.0 } else { random.logarithmic(1e-6, 1e6) };
        let at = fresnel::dielectric(c, eta);
        let fraction = 0.0..=1.0;
        assert!(fraction.contains(&at.reflectance) && fraction.contains(&at.cos_t), "{c} {eta}: {at:?}");
        assert!(!at.total || at.reflectance.to_bits() == 1.0_f32.to_bits(), "{c} {eta}: {at:?}");
        for r in reflectances(c, eta, k) {
            assert!(fraction.contains(&r), "{c} {eta} {k}: {r}");
        }
    }
}

#[test]
fn no_interface_changes_nothing() {
    let mut random = Random::new(3);
    for i in 0..10_000 {
        let mut wo = random.upper();
        if i % 10 == 0 {
            wo = Vec3::new(1.0, 0.0, f32::MIN_POSITIVE * 4.0);
        }
        let [reflected, refracted] = Dielectric { glass: Glass::exact(1.0) }.branches(wo);
        let at = fresnel::dielectric(wo.z, 1.0);
        assert!(at.reflectance.to_bits() == 0 && !reflected.valid, "{wo:?}: {at:?}");
        assert!(
            refracted.valid && (refracted.wi + wo).length() < 2e-7,
            "{wo:?} leaves as {:?}",
            refracted.wi
        );
        assert!(refracted.weight.r.to_bits() == 1.0_f32.to_bits(), "{wo:?}: {:?}", refracted.weight);
    }
}

#[test]
fn published_spot_values_are_met() {
    let Some(rows) = data::rows("optics/fresnel_reference.csv") else { return };
    let mut seen = 0;
    for row in rows {
        let number = |i: usize| row[i].parse::<f64>().expect("a number");
        let (angle, eta, expected) = (number(1), number(3) / number(2), number(4));
        let found = dielectric(cos_deg(angle), eta);
        assert!((found - expected).abs() < 2e-7, "{row:?}: {found}");
        if let Ok(theta_t) = row[7].parse::<f64>() {
            let cos_t = f64::from(fresnel::dielectric(cos_deg(angle) as f32, eta as f32).cos_t);
            assert!((cos_t - cos_deg(theta_t)).abs() < 2e-7, "{row:?}: cosine within {cos_t}");
        }
        seen += 1;
    }
    assert!(seen >= 6, "only {seen} rows");
}
