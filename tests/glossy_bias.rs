//! The lower part of a Phong lobe: how much of it there is, and what each way with it does to the lobe's total and shape, in the
//! lobe's own numbers and in pictures.
#[path = "support/estimates.rs"]
mod estimates;
#[path = "support/random.rs"]
mod random;
#[path = "support/scene.rs"]
mod support;

use estimates::{Estimate, LIMIT};
use glam::DVec3;
use random::{Random, from_angles};
use specula::bsdf::{Below, BsdfSample, Glossy, Phong, PhongScale};
use specula::film::Aov;
use specula::math::{Frame, Rgb, Vec3};
use specula::render::{Settings, Silent, render};
use specula::sampling::warp;
use std::f64::consts::TAU;
use support::scene_of;

type V = Vec3<f32>;

/// The angles of [`BELOW`], in degrees.
const ANGLES: [f32; 8] = [15.0, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 89.0];

/// Exponent, and the fraction of raw samples below the surface at each of the angles.
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

/// A viewer at an angle in degrees.
fn viewer(angle: f32) -> V {
    from_angles(angle.to_radians(), 0.3)
}

fn lobe(exponent: f32, below: Below) -> Glossy<f32> {
    Glossy { reflectance: Rgb::gray(0.8), exponent, below }
}

#[test]
fn the_lobe_dips_below_the_surface_as_the_table_says() {
    const N: u32 = 1 << 17;
    for (exponent, row) in BELOW {
        for (angle, fraction) in ANGLES.into_iter().zip(row) {
            let wo = viewer(angle);
            let about = Frame::about(Vec3::new(-wo.x, -wo.y, wo.z));
            let turned = lobe(exponent, Below::ThroughR);
            let (mut below, mut random) = (0, Random::new(6));
            for _ in 0..N {
                let u2 = random.pair();
                let raw = about.to_world(warp::power_cosine(u2, exponent));
                below += u32::from(raw.z < 0.0);
                // What the fix makes of it: always above, always the same weight, whatever the direction.
                let sample = turned.sample(wo, u2);
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

/// Integrals over the hemisphere about the mirror direction, of the functions that `f` evaluates together.
///
/// In double precision, by midpoints of the angle about r and of cos^(e+1), along which every lobe of that exponent varies
/// slowly, `n` of each; nothing of the lobe's code takes part but what `f` asks.
fn integrals<const K: usize>(n: u32, exponent: f32, wo: V, f: impl Fn(V) -> [f64; K]) -> [f64; K] {
    let exponent = f64::from(exponent);
    let r = DVec3::new(-f64::from(wo.x), -f64::from(wo.y), f64::from(wo.z)).normalize();
    let (x, y) = r.any_orthonormal_pair();
    let mut sums = [0.0; K];
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        let ln_cos = at(i).ln() / (exponent + 1.0);
        let sin = (-(2.0 * ln_cos).exp_m1()).sqrt();
        let (sin_phi, cos_phi) = (TAU * at(j)).sin_cos();
        let w = (x * cos_phi + y * sin_phi) * sin + r * ln_cos.exp();
        let density = (exponent + 1.0) / TAU * (exponent * ln_cos).exp();
        for (sum, value) in sums.iter_mut().zip(f(w.as_vec3().into())) {
            *sum += value / (density * f64::from(n).powi(2));
        }
    }
    sums
}

#[test]
fn turned_and_cut_densities_integrate_to_one_and_values_to_the_reflectance() {
    for (exponent, row) in BELOW {
        for (angle, below) in ANGLES.into_iter().zip(row) {
            let wo = viewer(angle);
            let kinds =
                [Below::ThroughR, Below::Rejection, Below::Discard].map(|below| lobe(exponent, below));
            let found = integrals(300, exponent, wo, |wi| {
                let [turned, cut, raw] = kinds.map(|kind| f64::from(kind.pdf(wo, wi)));
                [turned, cut, raw, f64::from(kinds[0].eval(wo, wi).r * wi.z)]
            });
            for (what, found, expected) in [
                ("turned", found[0], 1.0),
                ("cut", found[1], 1.0),
                ("black below", found[2], 1.0 - below),
                ("reflected", found[3], 0.8),
            ] {
                let off = (found - expected).abs();
                assert!(off < 6e-4, "{what}, e = {exponent} at {angle} deg: {found}, not {expected}");
            }
        }
    }
}

/// Exponent and angle; distance of the turned lobe from the one cut off and brought back to 1, and from the one weighted by
/// the cosine; mean cosines of the three.
type Residual = (f32, f32, [f64; 2], [f64; 3]);

const RESIDUALS: [Residual; 12] = [
    (1.0, 30.0, [0.062, 0.206], [0.630, 0.629, 0.741]),
    (1.0, 60.0, [0.167, 0.163], [0.609, 0.541, 0.693]),
    (1.0, 85.0, [0.073, 0.221], [0.478, 0.445, 0.610]),
    (5.0, 60.0, [0.092, 0.175], [0.535, 0.497, 0.622]),
    (5.0, 75.0, [0.170, 0.153], [0.450, 0.383, 0.524]),
    (20.0, 75.0, [0.101, 0.177], [0.326, 0.293, 0.385]),
    (20.0, 85.0, [0.163, 0.174], [0.238, 0.202, 0.296]),
    (100.0, 75.0, [0.004, 0.144], [0.259, 0.258, 0.292]),
    (100.0, 85.0, [0.146, 0.170], [0.140, 0.119, 0.167]),
    (1000.0, 85.0, [0.003, 0.141], [0.088, 0.087, 0.098]),
    (1000.0, 89.0, [0.172, 0.166], [0.039, 0.033, 0.048]),
    (10000.0, 89.0, [0.039, 0.181], [0.019, 0.018, 0.023]),
];

/// Half of the last printed digit, and what midpoints lose along the edges of the lobes.
const LAST_DIGIT: f64 = 5e-4 + 1e-4;

#[test]
fn turning_bends_the_lobe_as_much_as_the_table_says() {
    for (exponent, angle, distances, cosines) in RESIDUALS {
        let wo = viewer(angle);
        let kinds = [Below::ThroughR, Below::Rejection].map(|below| lobe(exponent, below));
        let reciprocal = Phong { reflectance: Rgb::WHITE, exponent, scale: PhongScale::Modified };
        // The lobe weighted by the cosine: a BRDF of the shape cos^e.
        let weighted = |wi: V| f64::from(reciprocal.eval(wo, wi).r * wi.z.max(0.0));
        let [total] = integrals(800, exponent, wo, |wi| [weighted(wi)]);
        let found = integrals(800, exponent, wo, |wi| {
            let [turned, cut] = kinds.map(|kind| f64::from(kind.pdf(wo, wi)));
            let (by_cosine, cos) = (weighted(wi) / total, f64::from(wi.z));
            let apart = [(turned - cut).abs() / 2.0, (turned - by_cosine).abs() / 2.0];
            [apart[0], apart[1], turned * cos, cut * cos, by_cosine * cos]
        });
        let [turned, cut, by_cosine] = cosines;
        let named = [
            ("distance from the cut lobe", distances[0]),
            ("distance from the lobe by the cosine", distances[1]),
            ("mean cosine, turned", turned),
            ("mean cosine, cut", cut),
            ("mean cosine, by the cosine", by_cosine),
        ];
        for ((what, expected), found) in named.into_iter().zip(found) {
            let off = (found - expected).abs();
            assert!(off < LAST_DIGIT, "{what}, e = {exponent} at {angle} deg: {found}, not {expected}");
        }
    }
}

/// The mean cosine of samples that weigh alike.
fn counted(mut sample: impl FnMut([f32; 2]) -> BsdfSample<f32>) -> Estimate {
    let mut random = Random::new(11);
    Estimate::of((0..1 << 19).map(|_| {
        let sample = sample(random.pair());
        assert!(sample.valid, "no sample is lost: {sample:?}");
        f64::from(sample.wi.z)
    }))
}

#[test]
fn counted_mean_cosines_follow_the_table() {
    for (exponent, angle, _, [turned, cut, by_cosine]) in RESIDUALS {
        let wo = viewer(angle);
        for (below, expected) in [(Below::ThroughR, turned), (Below::Rejection, cut)] {
            let found = counted(|u2| lobe(exponent, below).sample(wo, u2));
            let bound = LAST_DIGIT + LIMIT * found.error;
            let off = (found.mean - expected).abs();
            assert!(off < bound, "{below:?}, e = {exponent} at {angle} deg: {found:?}, not {expected}");
        }
        // Samples of the reciprocal lobe weigh as much as its cosine.
        let reciprocal = Phong { reflectance: Rgb::WHITE, exponent, scale: PhongScale::Modified };
        let (mut random, mut sums) = (Random::new(12), [0.0; 2]);
        for sample in (0..1 << 19).map(|_| reciprocal.sample(wo, random.pair())).filter(|s| s.valid) {
            let weight = f64::from(sample.weight.r);
            sums = [sums[0] + weight, sums[1] + weight * f64::from(sample.wi.z)];
        }
        let found = sums[1] / sums[0];
        assert!((found - by_cosine).abs() < 2e-3, "e = {exponent} at {angle} deg: {found}, not {by_cosine}");
    }
}

/// Distance between the turned lobe and the cut one where a part `below` of the raw lobe lies below the surface.
///
/// Twice the density within the set whose twins are below, which holds as much as they do, against 1 / (1 - P) everywhere.
fn distance(below: f64) -> f64 {
    below * (1.0 - 2.0 * below) / (1.0 - below)
}

#[test]
fn the_distance_has_a_closed_form() {
    for (exponent, angle, [expected, _], _) in RESIDUALS {
        let row = BELOW.into_iter().find(|(e, _)| e.to_bits() == exponent.to_bits()).expect("a row").1;
        let column = ANGLES.iter().position(|a| a.to_bits() == angle.to_bits()).expect("a column");
        let found = distance(row[column]);
        assert!((found - expected).abs() < 6e-4, "e = {exponent} at {angle} deg: {found}, not {expected}");
    }
    let greatest = (0..=1000).map(|i| distance(f64::from(i) / 2000.0)).fold(0.0, f64::max);
    assert!((greatest - 0.1716).abs() < 1e-4, "3 - 2 sqrt 2 at 1 - 1 / sqrt 2: {greatest}");
}

#[test]
fn discarding_darkens_the_rim_as_computed() {
    // e = 1, reflectance 0.8: 0.4 (1 + cos) with what falls below black, 0.8 with it turned.
    for angle in [0.0_f32, 30.0, 60.0, 80.0, 89.0] {
        let wo = viewer(angle);
        let weights = |below, n: u32| {
            let mut random = Random::new(13);
            let samples = (0..n).map(move |_| lobe(1.0, below).sample(wo, random.pair()));
            samples.map(|sample| if sample.valid { f64::from(sample.weight.r) } else { 0.0 })
        };
        let dark = Estimate::of(weights(Below::Discard, 1 << 18));
        let expected = 0.4 * (1.0 + f64::from(angle.to_radians().cos()));
        assert!(dark.off(expected) < LIMIT, "at {angle} degrees: {dark:?}, not {expected}");
        for below in [Below::ThroughR, Below::Rejection] {
            let least = weights(below, 4000).fold(f64::INFINITY, f64::min);
            assert!((least - f64::from(0.8_f32)).abs() < 1e-12, "{below:?} at {angle}: a sample of {least}");
        }
    }
}

/// Pixels along each side of a picture of the ball.
const SIDE: u16 = 64;

/// Half the angle of view has this tangent: the ball of radius 1, seen from 4, nearly fills the picture.
const TANGENT: f64 = 0.28;

/// The green channel of a glossy ball, by rows.
fn ball(exponent: f32, reflectance: f32, below: &str, (spp, rest): (u32, &str)) -> Vec<f32> {
    let vfov_deg = 2.0 * TANGENT.atan().to_degrees();
    let scene = scene_of(&format!(
        "[camera]
        from = [0.0, 0.0, 4.0]
        at = [0.0, 0.0, 0.0]
        vfov_deg = {vfov_deg:?}
        [film]
        width = {SIDE}
        height = {SIDE}
        filter = 'box'
        [render]
        spp = {spp}
        backend = 'brute'
        [materials.ball]
        type = 'glossy'
        exponent = {exponent:?}
        reflectance = {reflectance:?}
        below = '{below}'
        [[shapes]]
        type = 'sphere'
        material = 'ball'
        [[lights]]
        type = 'environment'
        radiance = 1.0
        {rest}"
    ));
    let film = render(&scene, &Settings::default(), &Silent).expect("a picture").film;
    film.channels(Aov::Beauty).expect("colour").swap_remove(1)
}

/// The point of the ball seen at a place of the picture, in pixels from its upper left corner.
fn seen_at(x: f64, y: f64) -> Option<DVec3> {
    let on_film = |x: f64| (x / f64::from(SIDE) * 2.0 - 1.0) * TANGENT;
    let (o, d) = (DVec3::Z * 4.0, DVec3::new(on_film(x), -on_film(y), -1.0).normalize());
    let b = o.dot(d);
    let root = b * b - o.length_squared() + 1.0;
    (root >= 0.0).then(|| o + d * (-b - root.sqrt()))
}

/// The cosine at which the ball is seen at a point.
fn cosine(p: DVec3) -> f64 {
    p.dot((DVec3::Z * 4.0 - p).normalize())
}

/// For each pixel the cosines at which the ball is seen within it, on a grid; none where the ball ends.
fn cosines() -> Vec<Vec<Option<f64>>> {
    let within = |at: u16| (0..4_u8).map(move |i| f64::from(at) + (f64::from(i) + 0.5) / 4.0);
    let pixels = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            // The corners, too: a pixel is all of the ball or none of it only if they are.
            let corners = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| (f64::from(x + i), f64::from(y + j)));
            let inner = within(y).flat_map(|y| within(x).map(move |x| (x, y)));
            inner.chain(corners).map(|(x, y)| seen_at(x, y).map(cosine)).collect()
        })
        .collect()
}

#[test]
fn the_ball_in_white_light_is_exactly_even_with_the_fix() {
    for below in ["through_r", "rejection"] {
        let picture = ball(1.0, 0.8, below, (100, ""));
        let (mut inside, mut outside) = (0, 0);
        for (value, seen) in picture.into_iter().zip(cosines()) {
            if seen.iter().all(Option::is_some) {
                assert!(value.to_bits() == 0.8_f32.to_bits(), "{below}: a pixel of {value}");
                inside += 1;
            } else if seen.iter().all(Option::is_none) {
                assert!(value.to_bits() == 1.0_f32.to_bits(), "{below}: beside it a pixel of {value}");
                outside += 1;
            }
        }
        assert!(inside > 2000 && outside > 600, "{below}: {inside} of the ball and {outside} beside it");
    }
}

#[test]
fn the_ball_in_white_light_is_dark_at_the_rim_without_the_fix() {
    let picture = ball(1.0, 0.8, "discard", (100, ""));
    let (mut sum, mut expected_sum, mut count) = (0.0, 0.0, 0.0);
    for (value, seen) in picture.into_iter().zip(cosines()) {
        let Some(cosines) = seen[..16].iter().copied().collect::<Option<Vec<_>>>() else { continue };
        let expected = cosines.iter().map(|cos| 0.4 * (1.0 + cos)).sum::<f64>() / 16.0;
        // A hundred coins; those of a stratified set are fairer.
        let below = 1.0 - expected / 0.8;
        let bound = LIMIT * 0.8 * (below * (1.0 - below) / 100.0).sqrt() + 1e-6;
        assert!((f64::from(value) - expected).abs() < bound, "a pixel of {value}, not {expected}");
        (sum, expected_sum, count) = (sum + f64::from(value), expected_sum + expected, count + 1.0);
    }
    let off = (sum - expected_sum) / count;
    assert!(count > 2000.0 && off.abs() < 5e-4, "{count} pixels are {off} too bright");
}

/// A black plane behind and beyond the ball, so wide that half of all directions, those with `normal` behind them, end there.
fn half_dark(normal: DVec3) -> String {
    let [center, u, v] = {
        let (u, v) = normal.any_orthonormal_pair();
        [normal * -1.5, u * 1e5, v * 1e5].map(|p| format!("[{:?}, {:?}, {:?}]", p.x, p.y, p.z))
    };
    format!(
        "[materials.black]
        type = 'diffuse'
        reflectance = 0.0
        [[shapes]]
        type = 'rectangle'
        center = {center}
        edge_u = {u}
        edge_v = {v}
        material = 'black'"
    )
}

#[test]
fn in_uneven_light_pictures_differ_by_the_distance_of_the_lobes_at_most() {
    const SPP: u32 = 512;
    let below_one = |cos: f64| (1.0 - cos) / 2.0;
    let below_three = |cos: f64| 0.75 * (2.0 / 3.0 - cos + cos.powi(3) / 3.0);
    for (exponent, below) in [(1.0, below_one as fn(f64) -> f64), (3.0, below_three)] {
        for (x, y) in [(56.5, 32.5), (44.5, 11.5)] {
            // Light where the turned lobe of this point is doubled, so that there the bound is reached.
            let n = seen_at(x, y).expect("on the ball");
            let r = 2.0 * cosine(n) * n - (DVec3::Z * 4.0 - n).normalize();
            let lit = (n - 2.0 * cosine(n) * r).normalize();
            let dark = half_dark(lit);
            let [turned, cut] =
                ["through_r", "rejection"].map(|kind| ball(exponent, 1.0, kind, (SPP, &dark)));
            let (mut greatest, mut expected_there) = (0.0_f64, 0.0);
            for (i, seen) in cosines().into_iter().enumerate() {
                let Some(cosines) = seen.into_iter().collect::<Option<Vec<_>>>() else { continue };
                let bound = cosines.iter().map(|&cos| distance(below(cos))).fold(0.0, f64::max);
                let found = f64::from(turned[i] - cut[i]);
                // Samples above are the same in both pictures: what is left is the noise of those below.
                let noise = 3.0 * (below(cosines[0]) / f64::from(SPP)).sqrt() + 3.0 / f64::from(SPP);
                assert!(found.abs() < bound + noise, "e = {exponent}, pixel {i}: {found} of {bound}");
                greatest = greatest.max(found.abs());
                if i == index(y) * usize::from(SIDE) + index(x) {
                    expected_there = bound;
                    assert!((found - bound).abs() < noise, "e = {exponent}, there: {found}, not {bound}");
                }
            }
            assert!(
                expected_there > 0.08 && greatest > 0.08,
                "too small to tell: {expected_there}, {greatest}"
            );
        }
    }
}

/// The pixel that a coordinate of the picture, not below zero, lies in.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in a small picture")]
fn index(at: f64) -> usize {
    at as usize
}
