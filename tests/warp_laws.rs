//! Laws of the warps: densities integrate to one, describe where samples fall, and are the Jacobian of the map;
//! inverses invert; corners are harmless; all widths agree.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small non-negative numbers")]

#[path = "support/statistics.rs"]
mod statistics;

use std::f64::consts::{PI, TAU};

use specula::math::Vec3;
use specula::math::lanes::{Isa, Kernel, Lanes, Level};
use specula::sampling::{Dim, Sampler, SamplerKind, Vertex, warp};

type V = Vec3<f32>;
type Inverse = Box<dyn Fn(V) -> [f32; 2]>;

/// A map from the square to directions.
struct Warp {
    name: String,
    map: Box<dyn Fn([f32; 2]) -> V>,
    /// Density by solid angle, zero outside.
    pdf: Box<dyn Fn(V) -> f32>,
    inverse: Option<Inverse>,
    /// Nearly all samples have 1 - cos below this.
    extent: f64,
}

fn warps() -> Vec<Warp> {
    let upper = |pdf: f32| move |w: V| if w.z >= 0.0 { pdf } else { 0.0 };
    let mut warps = vec![
        Warp {
            name: "cosine hemisphere".into(),
            map: Box::new(warp::cosine_hemisphere),
            pdf: Box::new(|w| warp::cosine_hemisphere_pdf(w.z)),
            inverse: Some(Box::new(warp::cosine_hemisphere_inverse)),
            extent: 1.0,
        },
        Warp {
            name: "uniform hemisphere".into(),
            map: Box::new(warp::uniform_hemisphere),
            pdf: Box::new(upper(warp::UNIFORM_HEMISPHERE_PDF)),
            inverse: Some(Box::new(|w| warp::cone_inverse(w, 1.0))),
            extent: 1.0,
        },
        Warp {
            name: "uniform sphere".into(),
            map: Box::new(warp::uniform_sphere),
            pdf: Box::new(|_| warp::UNIFORM_SPHERE_PDF),
            inverse: Some(Box::new(|w| warp::cone_inverse(w, 2.0))),
            extent: 2.0,
        },
    ];
    warps.extend([1.5_f32, 0.3, 1e-3, 1e-8, 1e-12].map(|extent| Warp {
        name: format!("cone of 1 - cos {extent}"),
        map: Box::new(move |u| warp::cone(u, extent)),
        pdf: Box::new(move |w| if warp::one_minus_cos(w) <= extent { warp::cone_pdf(extent) } else { 0.0 }),
        inverse: Some(Box::new(move |w| warp::cone_inverse(w, extent))),
        extent: f64::from(extent),
    }));
    warps.extend([0.0_f32, 1.0, 5.5, 100.0, 1e4, 1e6, 1e9].map(|e| Warp {
        name: format!("cosine to the power of {e}"),
        map: Box::new(move |u| warp::power_cosine(u, e)),
        pdf: Box::new(move |w| warp::power_cosine_pdf(w, e)),
        inverse: None,
        // exp(-18) of the samples are outside.
        extent: (18.0 / (f64::from(e) + 1.0)).min(1.0),
    }));
    warps
}

/// 1 - cos and azimuth in turns, in double precision.
fn polar(w: V) -> (f64, f64) {
    let [x, y, z] = [w.x, w.y, w.z].map(f64::from);
    let h = if z > 0.0 { (x * x + y * y) / (1.0 + z) } else { 1.0 - z };
    (h, (y.atan2(x) / TAU).rem_euclid(1.0))
}

fn direction(h: f64, turns: f64) -> V {
    let (sin, cos) = (turns * TAU).sin_cos();
    let r = (h * (2.0 - h)).sqrt();
    V::new((r * cos) as f32, (r * sin) as f32, (1.0 - h) as f32)
}

/// The integral of a density over a cell in 1 - cos (which is area over 2 pi) and azimuth, by the midpoint rule.
fn integral(pdf: &dyn Fn(V) -> f32, h: [f64; 2], turns: [f64; 2], steps: [u32; 2]) -> f64 {
    let mut sum = 0.0;
    for i in 0..steps[0] {
        for j in 0..steps[1] {
            let at = |[low, high]: [f64; 2], k: u32, n: u32| {
                low + (high - low) * (f64::from(k) + 0.5) / f64::from(n)
            };
            sum += f64::from(pdf(direction(at(h, i, steps[0]), at(turns, j, steps[1]))));
        }
    }
    let area = (h[1] - h[0]) * (turns[1] - turns[0]) * TAU;
    sum * area / f64::from(steps[0]) / f64::from(steps[1])
}

#[test]
fn densities_integrate_to_one() {
    for Warp { name, pdf, extent, .. } in warps() {
        let within = integral(&pdf, [0.0, extent], [0.0, 1.0], [4000, 4]);
        let beyond = integral(&pdf, [extent, 2.0], [0.0, 1.0], [4000, 4]);
        let total = within + beyond;
        // 4e-6 for the midpoint rule with 18 / 4000 of a lobe's width, and the rounding of directions.
        assert!((total - 1.0).abs() < 2e-5, "{name}: {total}");
        assert!(within > 1.0 - 1e-4, "{name}: only {within} inside its extent");
    }
}

fn random_pairs(n: u32, seed: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..n).map(move |i| SamplerKind::Independent.start(seed, [0, 0], i).get_2d(Dim::Film, Vertex::ROOT))
}

// Significance 1e-4 for all warps together (Bonferroni).
#[test]
fn samples_fall_where_the_density_says() {
    const N: u32 = 1 << 18;
    const BINS: [usize; 2] = [24, 32];
    let warps = warps();
    let tests = warps.len() as f64;
    for Warp { name, map, pdf, extent, .. } in warps {
        let edge = |i: usize, n: usize| i as f64 / n as f64;
        let mut expected = Vec::new();
        for i in 0..BINS[0] {
            for j in 0..BINS[1] {
                let h = [edge(i, BINS[0]) * extent, edge(i + 1, BINS[0]) * extent];
                let turns = [edge(j, BINS[1]), edge(j + 1, BINS[1])];
                expected.push(integral(&pdf, h, turns, [64, 2]) * f64::from(N));
            }
        }
        let beyond = f64::from(N) - expected.iter().sum::<f64>();
        expected.push(beyond.max(0.0));
        let mut counts = vec![0.0; expected.len()];
        for w in random_pairs(N, 1).map(&map) {
            let (h, turns) = polar(w);
            let i = (h / extent * BINS[0] as f64) as usize;
            let j = ((turns * BINS[1] as f64) as usize).min(BINS[1] - 1);
            // The rim of a cone may round to the outside.
            let outside = h > extent * (1.0 + 1e-6);
            counts[if outside { BINS[0] * BINS[1] } else { i.min(BINS[0] - 1) * BINS[1] + j }] += 1.0;
        }
        let (statistic, cells) = statistics::chi_square(&counts, &expected);
        let tail = statistics::chi_square_tail(statistic, cells - 1);
        assert!(tail * tests > 1e-4, "{name}: chi-square {statistic} of {cells} cells, tail {tail:e}");
    }
}

/// The area of the image of a small square over its area is one over the density.
#[test]
fn densities_are_the_jacobian_of_the_map() {
    const STEP: f32 = 1.0 / 256.0;
    for Warp { name, map, pdf, .. } in warps() {
        let mut checked = 0;
        for i in 1..32 {
            for j in 1..32 {
                // Off the diagonals, where the disc has its seams.
                let [u, v] = [(i as f32 + 0.35) / 32.0, (j as f32 + 0.15) / 32.0];
                if (u - v).abs() < 2.0 * STEP || (u + v - 1.0).abs() < 2.0 * STEP || v > 0.95 {
                    continue;
                }
                let d = |a: [f32; 2], b: [f32; 2]| {
                    let (a, b) = (map(a), map(b));
                    [a.x - b.x, a.y - b.y, a.z - b.z].map(|x| f64::from(x) / f64::from(2.0 * STEP))
                };
                // Richardson's extrapolation of central differences: what is left is of fourth order.
                let fine = |f: &dyn Fn(f32) -> [f64; 3]| {
                    let (one, half) = (f(STEP), f(STEP / 2.0).map(|x| x * 2.0));
                    [0, 1, 2].map(|k| (4.0 * half[k] - one[k]) / 3.0)
                };
                let du = fine(&|h| d([u + h, v], [u - h, v]));
                let dv = fine(&|h| d([u, v + h], [u, v - h]));
                let cross = [
                    du[1] * dv[2] - du[2] * dv[1],
                    du[2] * dv[0] - du[0] * dv[2],
                    du[0] * dv[1] - du[1] * dv[0],
                ];
                let jacobian = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
                let product = jacobian * f64::from(pdf(map([u, v])));
                assert!((product - 1.0).abs() < 3e-3, "{name} at ({u}, {v}): {product}");
                checked += 1;
            }
        }
        assert!(checked > 800, "{name}: {checked} places");
    }
}

const EDGES: [f32; 7] =
    [0.0, 1.0 / 16_777_216.0, 0.25, 0.5 - f32::EPSILON / 8.0, 0.5, 0.75, 1.0 - 1.0 / 16_777_216.0];

#[test]
fn corners_and_centres_give_finite_unit_vectors_of_positive_density() {
    for Warp { name, map, pdf, extent, .. } in warps() {
        for u in EDGES {
            for v in EDGES {
                let w = map([u, v]);
                let length2 = [w.x, w.y, w.z].map(|x| f64::from(x).powi(2)).iter().sum::<f64>();
                assert!((length2 - 1.0).abs() < 5e-7, "{name} at ({u}, {v}): squared length {length2}");
                let p = pdf(w);
                // The last step of a cone's rim may round past it; exponents near 1e9 reach densities of 2e-8 there.
                let at_rim = (polar(w).0 / extent - 1.0).abs() < 1e-6;
                assert!(p.is_finite() && (p > 0.0 || at_rim), "{name} at ({u}, {v}): density {p}");
                assert!(w.z >= 0.0 || name.contains("sphere") || extent > 1.0, "{name}: {w:?} is below");
            }
        }
    }
}

#[test]
fn inverses_invert() {
    for Warp { name, map, inverse, .. } in warps() {
        let Some(inverse) = inverse else { continue };
        for [u, v] in random_pairs(20_000, 2) {
            let [u2, v2] = inverse(map([u, v]));
            // Near the rim of a hemisphere and near the pole opposite, the sine has lost half of the digits or more.
            let rim = 1.0 - (2.0 * u - 1.0).abs().max((2.0 * v - 1.0).abs());
            let tolerance = 4e-7 + 4e-7 / rim.max(1e-4);
            let error = (u - u2).abs().max((v - v2).abs());
            assert!(error < tolerance, "{name} at ({u}, {v}): {u2}, {v2}");
        }
    }
}

#[test]
fn points_of_the_disc_are_uniform_and_invert() {
    const N: u32 = 1 << 18;
    let mut counts = vec![0.0; 16 * 24];
    for u in random_pairs(N, 3) {
        let [x, y] = warp::disc(u);
        let (r2, turns) =
            (f64::from(x).powi(2) + f64::from(y).powi(2), f64::from(y).atan2(f64::from(x)) / TAU);
        assert!(r2 < 1.0, "({x}, {y}) is outside");
        counts[(r2 * 16.0) as usize * 24 + ((turns + 0.5) * 24.0).min(23.0) as usize] += 1.0;
        let back = warp::disc_inverse([x, y]);
        assert!((0..2).all(|k| (back[k] - u[k]).abs() < 3e-7), "{u:?} comes back as {back:?}");
    }
    let expected = vec![f64::from(N) / counts.len() as f64; counts.len()];
    let (statistic, cells) = statistics::chi_square(&counts, &expected);
    let tail = statistics::chi_square_tail(statistic, cells - 1);
    assert!(tail > 1e-4, "chi-square {statistic}, tail {tail:e}");
    assert!((f64::from(warp::DISC_PDF) * PI - 1.0).abs() < 1e-7, "density");
}

#[test]
fn points_of_a_triangle_are_uniform_and_invert() {
    const N: u32 = 1 << 18;
    // Congruent triangles: 12 rows along b0, alternating upwards and downwards.
    let mut counts = vec![0.0; 12 * 12 * 2];
    for u in random_pairs(N, 4) {
        let b = warp::triangle(u);
        assert!(b.iter().all(|x| (0.0..=1.0).contains(x)), "{b:?}");
        assert!((b.iter().sum::<f32>() - 1.0).abs() < 2e-7, "{b:?} add up to one");
        let [i, j] = [b[0], b[1]].map(|x| x * 12.0);
        let down = i.fract() + j.fract() > 1.0;
        counts[(i as usize * 12 + j as usize) * 2 + usize::from(down)] += 1.0;
        let back = warp::triangle_inverse(b);
        assert!((0..2).all(|k| (back[k] - u[k]).abs() < 3e-7), "{u:?} comes back as {back:?}");
    }
    let inside: Vec<_> = (0..288).filter(|k| k / 24 + k / 2 % 12 + k % 2 < 12).map(|k| counts[k]).collect();
    assert_eq!(inside.len(), 144, "small triangles");
    assert!((inside.iter().sum::<f64>() - f64::from(N)).abs() < 5.0, "all but edges are inside");
    let (statistic, cells) = statistics::chi_square(&inside, &vec![f64::from(N) / 144.0; 144]);
    let tail = statistics::chi_square_tail(statistic, cells - 1);
    assert!(tail > 1e-4, "chi-square {statistic}, tail {tail:e}");
}

#[test]
fn lobes_have_the_moment_of_their_exponent() {
    for e in [0.0_f32, 0.5, 1.0, 20.0, 1e3] {
        let n = 1_u32 << 16;
        let numbers = |i| SamplerKind::OwenSobol.start(0, [5, 5], i).get_2d(Dim::Lens, Vertex::ROOT);
        let mean = (0..n).map(|i| f64::from(warp::power_cosine(numbers(i), e).z)).sum::<f64>() / f64::from(n);
        let exact = (f64::from(e) + 1.0) / (f64::from(e) + 2.0);
        assert!((mean - exact).abs() < 2e-6, "exponent {e}: mean cosine {mean}, not {exact}");
    }
}

/// The sine of narrow shapes against double precision: relative, not absolute.
#[test]
fn narrow_shapes_keep_their_precision() {
    for [u, v] in random_pairs(20_000, 6) {
        for e in [1.0, 1e2, 1e4, 1e6, 1e8, 1e9] {
            let w = warp::power_cosine([u, v], e as f32);
            let ln_cos = (-f64::from(v)).ln_1p() / (e + 1.0);
            let expected = (-(2.0 * ln_cos).exp_m1()).sqrt();
            let sin = f64::from(w.x).hypot(f64::from(w.y));
            assert!(
                (sin - expected).abs() <= 6e-7 * expected,
                "exponent {e}, v {v}: sine {sin}, not {expected}"
            );
            let exact_pdf = (e + 1.0) / TAU * (e * ln_cos).exp();
            let pdf = f64::from(warp::power_cosine_pdf(w, e as f32));
            // A relative error of the sine of 1e-7 is one of 2e-7 in e ln cos, of which there are at most 17.
            assert!(
                (pdf / exact_pdf - 1.0).abs() < 1.2e-5,
                "exponent {e}, v {v}: density {pdf}, not {exact_pdf}"
            );
        }
        for extent in [1.0, 1e-3, 1e-6, 1e-12] {
            let w = warp::cone([u, v], extent as f32);
            let [a, b] = [u, v].map(|x| (2.0 * f64::from(x) - 1.0 + 0.5_f64.powi(24)).abs());
            let h = a.max(b).powi(2) * extent;
            let (sin, expected) = (f64::from(w.x).hypot(f64::from(w.y)), (h * (2.0 - h)).sqrt());
            assert!((sin - expected).abs() <= 4e-7 * expected, "extent {extent}: sine {sin}, not {expected}");
        }
    }
    for sin in [1.0_f64, 0.5, 1e-3, 1e-6, 1e-15] {
        let expected = 2.0 * (sin.asin() / 2.0).sin().powi(2);
        let found = f64::from(warp::one_minus_cos_of_sin2((sin * sin) as f32));
        assert!((found / expected - 1.0).abs() < 3e-7, "sine {sin}: {found}, not {expected}");
    }
}

/// All warps of the same pairs, and their densities and inverses, component by component.
struct Wide;

impl<S: Isa> Kernel<S> for Wide {
    type Output = Vec<[f32; 37]>;
    #[inline(always)]
    fn run(self, isa: S) -> Self::Output {
        let pairs: Vec<_> = random_pairs(1024, 9).collect();
        let mut out = Vec::new();
        for some in pairs.chunks_exact(S::WIDTH) {
            let u = [isa.per_lane(|i| some[i][0]), isa.per_lane(|i| some[i][1])];
            let [x, y] = warp::disc(u);
            let [b0, b1, b2] = warp::triangle(u);
            let hemisphere = warp::cosine_hemisphere(u);
            let (upper, sphere) = (warp::uniform_hemisphere(u), warp::uniform_sphere(u));
            let (narrow, narrower) = (isa.splat(0.01), isa.splat(1e-8));
            let (cone, needle) = (warp::cone(u, narrow), warp::cone(u, narrower));
            let (lobe, sharp) =
                (warp::power_cosine(u, isa.splat(50.0)), warp::power_cosine(u, isa.splat(1e6)));
            let [disc_u, disc_v] = warp::disc_inverse([x, y]);
            let [up_u, up_v] = warp::cosine_hemisphere_inverse(hemisphere);
            let [cone_u, cone_v] = warp::cone_inverse(cone, narrow);
            let [three_u, three_v] = warp::triangle_inverse([b0, b1, b2]);
            // Densities over their greatest.
            let densities = [
                warp::cosine_hemisphere_pdf(hemisphere.z),
                warp::cone_pdf(narrow) * 0.01,
                warp::power_cosine_pdf(lobe, isa.splat(50.0)) * (1.0 / 8.0),
            ];
            // What is narrow, as wide as the others.
            let widened = |w: Vec3<S::F>, by: f32| Vec3::new(w.x * by, w.y * by, w.z);
            let vectors =
                [hemisphere, upper, sphere, cone, widened(needle, 7e3), lobe, widened(sharp, 700.0)];
            for i in 0..S::WIDTH {
                let mut row = [0.0; 37];
                let numbers =
                    [x, y, b0, b1, b2, disc_u, disc_v, up_u, up_v, cone_u, cone_v, three_u, three_v];
                let parts = vectors.iter().flat_map(|w| [w.x, w.y, w.z]);
                for (to, from) in row.iter_mut().zip(numbers.into_iter().chain(densities).chain(parts)) {
                    *to = from.extract(i);
                }
                out.push(row);
            }
        }
        out
    }
}

#[test]
fn every_width_agrees_to_rounding() {
    let expected = Level::named("scalar").expect("always there").run(Wide);
    for level in Level::available() {
        let found = level.run(Wide);
        assert_eq!(found.len(), expected.len(), "{}", level.name());
        for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((a - b).abs() <= 1e-6 * b.abs().max(1.0), "{}: {a} is not {b}", level.name());
        }
    }
}
