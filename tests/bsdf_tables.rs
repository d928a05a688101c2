//! Scattering against tables: albedos by quadrature, published values of masking, the geometric series of a pane, coats that
//! lose nothing. Those of the Phong lobe's lower part are in `glossy_bias.rs`.

#![expect(clippy::cast_possible_truncation, reason = "tables in double precision are asked for in single")]

#[path = "support/data.rs"]
mod data;
#[path = "support/random.rs"]
mod random;

use random::{Random, from_angles};
use specula::bsdf::microfacet::{Beckmann, Distribution, Ggx};
use specula::bsdf::{
    BsdfSample, Coat, Dielectric, Diffuse, FresnelModel, Glass, Glazed, Metal, OrenNayar, Phong, PhongScale,
    RoughConductor, RoughDielectric, Schlick, ThinDielectric,
};
use specula::math::{Rgb, Vec3};
use specula::sampling::warp;
use std::f64::consts::PI;

type V = Vec3<f32>;

/// The angles from the normal at which masking is judged, in degrees.
fn viewers() -> [V; 5] {
    [0.0_f32, 30.0, 60.0, 80.0, 89.0].map(|angle| from_angles(angle.to_radians(), 0.7))
}

/// The viewer at a cosine.
fn at_cosine(mu: f64) -> V {
    from_angles((mu as f32).acos(), 0.4)
}

/// The mean of `f` over the unit square, by midpoints.
fn mean(n: u16, f: impl Fn([f32; 2]) -> f64) -> f64 {
    let at = |i: u16| (f32::from(i) + 0.5) / f32::from(n);
    let sum: f64 = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| f([at(i), at(j)])).sum();
    sum / f64::from(n).powi(2)
}

/// The red weight of a sample, nothing where there is none.
fn weight(sample: BsdfSample<f32>) -> f64 {
    if sample.valid { f64::from(sample.weight.r) } else { 0.0 }
}

fn ggx(alpha: f64) -> Distribution<f32> {
    Ggx::isotropic(alpha as f32).into()
}

fn beckmann(alpha: f64) -> Distribution<f32> {
    Beckmann::isotropic(alpha as f32).into()
}

/// What facets that reflect everything return once.
fn albedo(facets: Distribution<f32>, wo: V) -> f64 {
    let metal = Metal::Constant { r0: Rgb::WHITE };
    mean(500, |u2| weight(RoughConductor { metal, facets }.sample(wo, u2)))
}

/// Roughness; albedos at cosines of 1, 0.5 and 0.1 for GGX, then for Beckmann.
const ALBEDOS: [(f64, [f64; 3], [f64; 3]); 6] = [
    (0.1, [0.98830, 0.96921, 0.88345], [1.00000, 0.99985, 0.91291]),
    (0.2, [0.94766, 0.89523, 0.89127], [1.00000, 0.97236, 0.92707]),
    (0.3, [0.87736, 0.82171, 0.88880], [0.99971, 0.92329, 0.94146]),
    (0.5, [0.68785, 0.69825, 0.86011], [0.94300, 0.86936, 0.95503]),
    (0.8, [0.42700, 0.54013, 0.80050], [0.64190, 0.81830, 0.95771]),
    (1.0, [0.30685, 0.45069, 0.76021], [0.46159, 0.76657, 0.95280]),
];

#[test]
fn single_bounce_albedos_follow_the_table() {
    for (alpha, long_tailed, gaussian) in ALBEDOS {
        for (mu, [of_ggx, of_beckmann]) in
            [1.0, 0.5, 0.1].into_iter().zip((0..3).map(|i| [long_tailed[i], gaussian[i]]))
        {
            let wo = at_cosine(mu);
            // Midpoints beside the line where directions drop below the surface: some 2 in 500 of what is there.
            let found = albedo(ggx(alpha), wo);
            assert!((found - of_ggx).abs() < 3e-4, "GGX {alpha} at {mu}: {found}, not {of_ggx}");
            let found = albedo(beckmann(alpha), wo);
            assert!(
                (found - of_beckmann).abs() < 3e-4,
                "Beckmann {alpha} at {mu}: {found}, not {of_beckmann}"
            );
        }
    }
}

/// Schlick's own masking G(v) = v / (r - r v + v) with his distribution: what the table in the literature is of, and the reason
/// why Smith's takes its place here.
#[test]
fn schlicks_masking_follows_the_table_and_makes_light() {
    // Roughness; albedos of the glossy part at cosines of 1, 0.5 and 0.1; those of all parts in their shares, where printed.
    let table = [
        (0.01_f64, [0.98862, 0.96832, 1.00905], None),
        (0.05, [0.93246, 0.86457, 1.03125], Some([0.987, 0.974, 1.006])),
        (0.1, [0.85721, 0.77650, 0.94061], Some([0.949, 0.920, 0.979])),
        (0.25, [0.66147, 0.60772, 0.68710], Some([0.746, 0.706, 0.765])),
        (0.5, [0.45069, 0.43527, 0.45312], Some([0.451, 0.435, 0.453])),
        (1.0, [0.25, 0.25, 0.25], Some([1.0, 1.0, 1.0])),
    ];
    let seen = |r: f64, v: f64| v / (r - r * v + v);
    for (r, row, blend) in table {
        let facets = ggx(r.sqrt());
        for (k, (mu, expected)) in [1.0, 0.5, 0.1].into_iter().zip(row).enumerate() {
            let wo = at_cosine(mu);
            let found = mean(500, |u2| {
                let h = facets.sample_visible(wo, u2);
                let wi = h * (wo.dot(h) * 2.0) - wo;
                let below = wi.z <= 0.0 || wo.dot(h) <= 0.0;
                if below { 0.0 } else { seen(r, mu) * seen(r, f64::from(wi.z)) / f64::from(facets.g1(wo)) }
            });
            assert!((found - expected).abs() < 4e-4, "r = {r} at {mu}: {found}, not {expected}");
            // Matt and mirror have the rest and lose nothing: a + c = 1 - b.
            let glossy = 4.0 * r * (1.0 - r);
            let whole = 1.0 - glossy + glossy * found;
            let printed = blend.map_or(whole, |blend| blend[k]);
            assert!(
                (whole - printed).abs() < 6e-4 + 4e-4 * glossy,
                "r = {r} at {mu}: {whole}, not {printed}"
            );
        }
    }
}

#[test]
fn schlicks_parts_add_up() {
    // alpha^2 = r: the albedos of GGX at 0.1, 0.5 and 0.8.
    for (alpha, row) in [ALBEDOS[0], ALBEDOS[3], ALBEDOS[4]].map(|(alpha, row, _)| (alpha, row)) {
        let r = alpha * alpha;
        let glossy = 4.0 * r * (1.0 - r);
        let surface = Schlick::new(Rgb::WHITE, r as f32, 1.0_f32);
        for (mu, once) in [1.0, 0.5, 0.1].into_iter().zip(row) {
            let wo = at_cosine(mu);
            let lobe = mean(300, |u2| weight(surface.sample(wo, u2)));
            let base = mean(100, |u2| {
                let wi = warp::cosine_hemisphere(u2);
                f64::from(surface.diffuse(wo, wi).r) * PI
            });
            let branch = surface.branch(wo);
            let mirror = if branch.valid { f64::from(branch.weight.r) } else { 0.0 };
            let expected = 1.0 - glossy + glossy * once;
            let found = lobe + base + mirror;
            assert!((found - expected).abs() < 5e-4, "r = {r} at {mu}: {found}, not {expected}");
            assert!((base > 0.0) == (r > 0.5) && (mirror > 0.0) == (r < 0.5), "r = {r}: {base} and {mirror}");
        }
    }
    for (r, kind) in [(0.0, "a mirror"), (1.0, "matt")] {
        let surface = Schlick::new(Rgb::WHITE, r, 1.0_f32);
        assert!(surface.eval(at_cosine(0.5), at_cosine(0.7)).is_black(), "{r} is nothing but {kind}");
    }
}

/// Shared out over a fine grid of normals.
#[test]
fn distributions_are_normalised_and_mask_what_they_must() {
    for (gaussian, [ax, ay]) in [false, true]
        .into_iter()
        .flat_map(|gaussian| [[0.1, 0.1], [0.1, 0.4], [0.5, 0.3], [1.0, 1.0]].map(|a| (gaussian, a)))
    {
        let facets: Distribution<f32> = if gaussian {
            Beckmann { alpha_x: ax, alpha_y: ay }.into()
        } else {
            Ggx { alpha_x: ax, alpha_y: ay }.into()
        };
        let views = viewers();
        let (mut area, mut seen, n) = (0.0, [0.0; 5], 1000_u16);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let x = (f32::from(i) + 0.5) / f32::from(n);
            let (theta, phi) =
                (std::f32::consts::FRAC_PI_2 * x * x, (f32::from(j) + 0.5) / f32::from(n) * 2.0);
            let h = from_angles(theta, phi * std::f32::consts::PI);
            let solid_angle = f64::from(theta.sin() * 2.0 * x) * PI * PI / f64::from(n).powi(2);
            let d = f64::from(facets.d(h)) * solid_angle;
            area += d * f64::from(h.z);
            for (sum, w) in seen.iter_mut().zip(views) {
                *sum += d * f64::from(w.dot(h).max(0.0) * facets.g1(w));
            }
            let z2 = f64::from(h.z).powi(2);
            let slope2 = (f64::from(h.x / ax).powi(2) + f64::from(h.y / ay).powi(2)) / z2;
            let spread = if gaussian { (-slope2).exp() } else { (1.0 + slope2).powi(-2) };
            let exact = spread / (PI * f64::from(ax) * f64::from(ay) * z2 * z2);
            // The exponent is known to a few units in its last place.
            let bound = 2e-6 * exact + if gaussian { 4e-7 * slope2 * exact } else { 0.0 };
            let off = (f64::from(facets.d(h)) - exact).abs();
            assert!(off < bound + 1e-30, "{ax} {ay} {h:?}: {}, not {exact}", facets.d(h));
        }
        assert!((area - 1.0).abs() < 1e-4, "{ax} {ay}: normals stand over an area of {area}");
        // What a direction sees of the microfacets is what it sees of the surface (Heitz 2014, eq. 14).
        for (sum, w) in seen.into_iter().zip(views) {
            assert!((sum / f64::from(w.z) - 1.0).abs() < 2e-4, "{ax} {ay}: {w:?} sees {sum}");
        }
    }
}

#[test]
fn published_values_of_facets_are_met() {
    let Some(rows) = data::rows("optics/microfacet_reference.csv") else { return };
    let mut seen = 0;
    for row in rows.iter().filter(|row| row[3] == "G1" || row[3] == "D") {
        let [alpha_x, alpha_y, theta, phi, expected] =
            [1, 2, 4, 5, 6].map(|i| row[i].parse::<f32>().expect("a number"));
        let facets: Distribution<f32> = match row[0].as_str() {
            "ggx" => Ggx { alpha_x, alpha_y }.into(),
            _ => Beckmann { alpha_x, alpha_y }.into(),
        };
        let w = from_angles(theta, phi);
        if w.z <= 1e-6 {
            continue;
        }
        let (found, bound) = match row[3].as_str() {
            // Beckmann's was made with a rational approximation that is within 0.4 %.
            "G1" => (facets.g1(w), if row[0] == "ggx" { 2e-6 } else { 4e-3 }),
            // Angles have nine digits, which the exponent multiplies.
            _ => (facets.d(w), expected * 1e-4 + 1e-6),
        };
        assert!((found - expected).abs() <= bound, "{row:?}: {found}");
        seen += 1;
    }
    assert!(seen >= 200, "only {seen} rows");
}

#[test]
fn modified_phong_darkens_with_the_angle() {
    let table = [
        (1.0_f32, [1.0, 0.881, 0.755, 0.609, 0.458, 0.363]),
        (20.0, [1.0, 0.866, 0.707, 0.5005, 0.271, 0.138]),
        (100.0, [1.0, 0.8660, 0.707, 0.5, 0.2589, 0.0976]),
    ];
    for (exponent, row) in table {
        let lobe = Phong { reflectance: Rgb::WHITE, exponent, scale: PhongScale::Modified };
        for (angle, expected) in [0.0_f32, 30.0, 45.0, 60.0, 75.0, 85.0].into_iter().zip(row) {
            let wo = from_angles(angle.to_radians(), 0.3);
            let found = mean(500, |u2| weight(lobe.sample(wo, u2)));
            assert!((found - expected).abs() < 1e-3, "e = {exponent} at {angle}: {found}, not {expected}");
        }
    }
}

#[test]
fn a_pane_sums_its_series() {
    let pane = |a: f32| ThinDielectric { glass: Glass::exact(1.5), transmittance: Rgb::new(a, 1.0, 0.0) };
    let table = [
        (0.0_f32, 0.076_923_076_92),
        (45.0, 0.095_673_208_54),
        (60.0, 0.163_767_537_3),
        (75.0, 0.403_907_952_2),
        (85.0, 0.759_920_362_2),
    ];
    for (angle, expected) in table {
        let [reflected, through] = pane(1.0).fractions(angle.to_radians().cos());
        assert!((f64::from(reflected.r) - expected).abs() < 1e-6, "at {angle}: {reflected:?}");
        assert!((reflected.r + through.r - 1.0).abs() < 3e-7, "at {angle}: {reflected:?} and {through:?}");
        // Black glass shows its first face alone.
        let first = Glass::exact(1.5).at(angle.to_radians().cos()).reflectance;
        assert!(through.b.to_bits() == 0 && (reflected.b - first).abs() < 1e-7, "at {angle}: {reflected:?}");
    }
    for (a, reflects, transmits) in
        [(0.9, 0.069_898_588_57, 0.830_516_349_2), (0.5, 0.049_219_687_88, 0.460_984_393_8)]
    {
        let [reflected, through] = pane(a).fractions(1.0);
        assert!((f64::from(reflected.r) - reflects).abs() < 1e-7, "A = {a}: {reflected:?}");
        assert!((f64::from(through.r) - transmits).abs() < 2e-7, "A = {a}: {through:?}");
    }
    let [reflected, through] = pane(1.0).branches(Vec3::new(1.0, 0.0, 1e-7));
    assert!(reflected.weight.is_finite() && through.weight.is_finite(), "grazing: {reflected:?} {through:?}");
    assert!((through.wi + Vec3::new(1.0, 0.0, 1e-7)).length() < 1e-9, "straight on: {through:?}");
}

#[test]
fn frosted_glass_keeps_radiance_per_squared_index() {
    let mut random = Random::new(9);
    let mut judged = 0;
    for i in 0..40_000_u32 {
        let (wo, below) = (random.upper(), -random.upper());
        let eta = [1.5_f32, 1.33, 0.7][i as usize % 3];
        let facets = if i % 2 == 0 { ggx(0.5) } else { beckmann(0.4) };
        // A facet that light grazes passes an amount known no better than the square of its cosine.
        let h = (wo + below * eta).normalize();
        if wo.dot(h).abs().min(below.dot(h).abs()) < 0.05 {
            continue;
        }
        let there = RoughDielectric { glass: Glass::exact(eta), facets }.eval(wo, below).r * eta * eta;
        // The way back is seen from the other side, in a frame turned over.
        let back = RoughDielectric { glass: Glass::exact(1.0 / eta), facets }.eval(-below, -wo).r;
        let off = (there - back).abs();
        assert!(off <= 2e-3 * there.max(back) + 1e-6, "into {eta}, {wo:?} {below:?}: {there}, back {back}");
        judged += u32::from(there > 1e-3);
    }
    assert!(judged > 4000, "only {judged} pairs see each other");
}

#[test]
fn the_smoothest_frost_is_clear() {
    for (eta, wo) in [1.5_f32, 1.0 / 1.5].into_iter().flat_map(|eta| viewers().map(|wo| (eta, wo))) {
        let clear = Dielectric { glass: Glass::exact(eta) }.branches(wo);
        for facets in [ggx(1e-4), beckmann(1e-4)] {
            let frost = RoughDielectric { glass: Glass::exact(eta), facets }.sample(wo, [0.3, 0.5]);
            for (branch, sample) in clear.iter().zip(frost) {
                assert_eq!(branch.valid, sample.valid, "{eta} {wo:?}: {branch:?} {sample:?}");
                if branch.valid {
                    let off = sample.weight.r - branch.weight.r * branch.radiance_scale;
                    let turned = (sample.wi - branch.wi).length();
                    assert!(turned < 5e-4 / wo.z.min(0.3) && off.abs() < 0.02, "{eta} {wo:?}: {sample:?}");
                }
            }
        }
    }
}

#[test]
fn frost_between_equal_media_is_not_there() {
    for (facets, wo) in
        [ggx(0.3), beckmann(0.3)].into_iter().flat_map(|facets| viewers().map(|wo| (facets, wo)))
    {
        for numbers in [[0.3, 0.5], [0.01, 0.9], [0.99, 0.1]] {
            let lobe = RoughDielectric { glass: Glass::exact(1.0), facets };
            let [up, down] = lobe.sample(wo, numbers);
            assert!(!up.valid && down.valid, "{wo:?}: {up:?} {down:?}");
            assert!((down.weight.r - 1.0).abs() < 1e-6 && (down.wi + wo).length() < 1e-6, "{wo:?}: {down:?}");
            // Nothing else is met: whoever asks for another direction finds nothing.
            assert!(down.pdf > 1e6 && lobe.eval(wo, -from_angles(0.3, 0.1)).is_black(), "{wo:?}: {down:?}");
        }
    }
}

#[test]
fn frost_loses_little_where_it_is_fine() {
    // Reflected and transmitted power together, as measured: what is lost bounces between facets. From within, the tails of
    // GGX reflect totally, downwards.
    let total = |alpha: f64, eta: f32, wo: V| {
        let lobe = RoughDielectric { glass: Glass::exact(eta), facets: ggx(alpha) };
        let scale = f64::from(eta * eta);
        mean(200, |u2| {
            let [up, down] = lobe.sample(wo, u2).map(weight);
            up + down * scale
        })
    };
    let measured =
        [(0.01, [0.9999, 0.9999]), (0.1, [0.9978, 0.9884]), (0.3, [0.9787, 0.8914]), (1.0, [0.8217, 0.4325])];
    for (alpha, [inwards, outwards]) in measured {
        let [into, out] = [total(alpha, 1.5, at_cosine(0.8)), total(alpha, 1.0 / 1.5, at_cosine(0.95))];
        assert!((into - inwards).abs() < 1e-3 && into < 1.0 + 1e-6, "alpha {alpha} into glass: {into}");
        assert!((out - outwards).abs() < 1e-3 && out < 1.0 + 1e-6, "alpha {alpha} out of glass: {out}");
    }
}

#[test]
fn rough_clay_throws_light_back() {
    let reflectance = Rgb::gray(0.8_f32);
    let wo = from_angles(1.2, 0.0);
    let away = from_angles(1.2, std::f32::consts::PI);
    let flat = Diffuse { reflectance }.eval(wo, wo).r;
    let smooth = OrenNayar { reflectance, roughness: 0.0 };
    assert!((smooth.eval(wo, away).r - flat).abs() < 1e-7, "without roughness it is Lambert's");
    let clay = OrenNayar { reflectance, roughness: 0.8 };
    let (back, on) = (clay.eval(wo, wo).r, clay.eval(wo, away).r);
    assert!(back > 1.5 * flat && on < 0.8 * flat, "back {back}, on {on}, beside {flat}");
}

#[test]
fn a_glaze_over_white_loses_nothing() {
    use FresnelModel::{Constant, Exact, F82, Schlick};
    for (model, ior) in [Exact, Schlick, F82, Constant]
        .into_iter()
        .flat_map(|model| [1.0_f32, 1.0001, 1.1, 1.5, 2.4].map(|ior| (model, ior)))
    {
        let glazed: Glazed<f32> = Coat::new(model, ior).over(Rgb::new(1.0, 0.5, 0.0));
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
            assert!((coat + white - 1.0).abs() < 1e-4, "{model:?} {ior} {wo:?}: {coat} and {white}");
            assert!(
                gray < 0.5 * white + 1e-6,
                "{model:?} {ior} {wo:?}: bounces within darken: {gray} beside {white}"
            );
        }
    }
}
