//! Laws of the errors that the number sets leave, over all kinds of sampler: how they fall with the number of samples, and how
//! they are spread over the picture.
//!
//! Seeds are fixed. The tables of `benches/record/samplers.md` are printed by
//! `cargo test --release --test sampler_errors -- --ignored --nocapture`.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small non-negative numbers")]

#[path = "support/samplers.rs"]
mod samplers;
#[path = "support/statistics.rs"]
mod statistics;

use samplers::{kinds, word};
use specula::sampling::sobol::sobol_2d_rev;
use specula::sampling::{Dim, Sampler, SamplerKind, Vertex};

const TRIALS: u32 = 1000;
const SIZES: [u32; 5] = [16, 64, 256, 1024, 4096];

/// A root mean square error over [`TRIALS`], and its relative standard error.
#[derive(Clone, Copy, Debug)]
struct Rms {
    value: f64,
    relative: f64,
}

/// The error of the mean of `f` over the first `n` points of a set; `points` gives point `i` of the set of a trial.
fn rms(n: u32, points: impl Fn(u32, u32) -> [f64; 2], f: fn(f64, f64) -> f64, exact: f64) -> Rms {
    let (mut m2, mut m4) = (0.0, 0.0);
    for trial in 0..TRIALS {
        let sum: f64 = (0..n).map(|i| points(trial, i)).map(|[x, y]| f(x, y)).sum();
        let error2 = (sum / f64::from(n) - exact).powi(2);
        m2 += error2 / f64::from(TRIALS);
        m4 += error2 * error2 / f64::from(TRIALS);
    }
    Rms { value: m2.sqrt(), relative: 0.5 * ((m4 / (m2 * m2) - 1.0) / f64::from(TRIALS)).sqrt() }
}

/// Points of a sampler, one pixel for each trial, far from the others.
fn of_kind(kind: SamplerKind) -> impl Fn(u32, u32) -> [f64; 2] {
    move |trial, i| {
        let u = kind.start(1, [trial * 257, trial], i).get_2d(Dim::LightPoint(0), Vertex::ROOT);
        // Numbers stand for cells of 2^-24: their centres keep the truncation out of the errors.
        u.map(|x| f64::from(x) + 0.5 / 16_777_216.0)
    }
}

/// The definition, digit by digit: whether a digit flips is drawn from 64 bits of hash for each setting of those
/// before it. Slow, and what the hash in the library approximates.
fn nested_scrambling(trial: u32, i: u32) -> [f64; 2] {
    let mix = |x: u64| {
        let x = (x ^ (x >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
        let x = (x ^ (x >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
        x ^ (x >> 32)
    };
    let scramble = |x_rev: u32, seed: u64| {
        let mut value = 0.5 / 1_073_741_824.0;
        for digit in 0..30 {
            let before = u64::from(x_rev) & ((1 << digit) - 1);
            let flip = mix(mix(mix(seed).wrapping_add(before)).wrapping_add(digit)) >> 17;
            let bit = (u64::from(x_rev) >> digit ^ flip) & 1;
            value += bit as f64 * 0.5_f64.powi(digit as i32 + 1);
        }
        value
    };
    let [x, y] = sobol_2d_rev(i);
    [scramble(x, u64::from(trial) * 2 + 1000), scramble(y, u64::from(trial) * 2 + 1001)]
}

fn smooth(x: f64, y: f64) -> f64 {
    (x + y).exp()
}

fn quarter_disc(x: f64, y: f64) -> f64 {
    f64::from(u8::from(x * x + y * y < 0.5))
}

/// Slope of the logarithm of the error, divided by `scale(N)`, in log N.
fn slope(errors: &[Rms], scale: fn(f64) -> f64) -> f64 {
    let points: Vec<_> = SIZES
        .map(f64::from)
        .into_iter()
        .zip(errors)
        .map(|(n, e)| (n.ln(), (e.value / scale(n)).ln()))
        .collect();
    statistics::slope(&points)
}

/// Fails if two errors differ by more than 3.3 standard errors: a significance of 0.001, and of 0.016 for the 16
/// comparisons of this file together.
fn assert_agree(a: Rms, b: Rms, what: &str) {
    let ratio = a.value / b.value;
    let tolerance = 3.3 * a.relative.hypot(b.relative);
    assert!((ratio - 1.0).abs() < tolerance, "{what}: {a:?} is {ratio:.3} of {b:?}");
}

const EXACT_SMOOTH: f64 = 2.952_492_442_012_559_3;
const EXACT_DISC: f64 = std::f64::consts::PI / 8.0;

#[test]
fn independent_errors_are_those_of_the_variance() {
    let second_moment = ((2.0_f64.exp() - 1.0) / 2.0).powi(2);
    for (name, f, exact, variance) in [
        ("smooth", smooth as fn(f64, f64) -> f64, EXACT_SMOOTH, second_moment - EXACT_SMOOTH.powi(2)),
        ("edge", quarter_disc, EXACT_DISC, EXACT_DISC * (1.0 - EXACT_DISC)),
    ] {
        let errors = SIZES.map(|n| rms(n, of_kind(SamplerKind::Independent), f, exact));
        println!("independent, {name}: {errors:?}");
        for (n, error) in SIZES.into_iter().zip(errors) {
            let expected = Rms { value: (variance / f64::from(n)).sqrt(), relative: 0.0 };
            assert_agree(error, expected, &format!("{name}, {n} samples"));
        }
        let slope = slope(&errors, |_| 1.0);
        assert!((slope + 0.5).abs() < 0.03, "{name}: slope {slope}");
    }
}

#[test]
fn scrambled_errors_are_those_of_nested_scrambling() {
    for (name, f, exact) in
        [("smooth", smooth as fn(f64, f64) -> f64, EXACT_SMOOTH), ("edge", quarter_disc, EXACT_DISC)]
    {
        for n in [16, 256, 1024] {
            let hashed = rms(n, of_kind(SamplerKind::OwenSobol), f, exact);
            let defined = rms(n, nested_scrambling, f, exact);
            println!("{name}, {n} samples: {hashed:?} against {defined:?}");
            assert_agree(hashed, defined, &format!("{name}, {n} samples"));
        }
    }
}

/// An integrand of two variables, and its integral.
#[derive(Clone, Copy)]
struct Integrand {
    name: &'static str,
    f: fn(f64, f64) -> f64,
    exact: f64,
}

const SMOOTH: Integrand = Integrand { name: "smooth", f: smooth, exact: EXACT_SMOOTH };
const EDGE: Integrand = Integrand { name: "edge", f: quarter_disc, exact: EXACT_DISC };

impl Integrand {
    fn error(&self, kind: SamplerKind, n: u32) -> Rms {
        rms(n, of_kind(kind), self.f, self.exact)
    }
}

/// The errors of every kind for each of [`SIZES`]; kinds in the order of [`kinds`].
fn errors(integrand: Integrand) -> [Vec<Rms>; 4] {
    [0, 1, 2, 3].map(|kind| SIZES.map(|n| integrand.error(kinds(n)[kind], n)).to_vec())
}

/// Random numbers: N^-1/2. Strata: cells have an area of 1/N, within which a smooth integrand varies by N^-1/2, and whose errors
/// are independent: N^-1. Owen 1997: the variance of scrambled nets for smooth integrands of d variables falls as
/// N^-3 (log N)^(d-1). Across an edge in the plane, about N^1/2 of the N cells are cut, each adding a variance of the
/// order of N^-2: N^-3/4 for both.
#[test]
fn errors_fall_as_theory_says() {
    // Smooth, with what is divided by and the tolerance; edge.
    type Law = (f64, fn(f64) -> f64, f64, f64);
    let net: Law = (-1.5, |n| n.ln().sqrt(), 0.06, -0.75);
    // Strata of each axis leave an error of N^-3/2 besides, which few samples still show.
    let laws: [Law; 4] = [(-0.5, |_| 1.0, 0.03, -0.5), (-1.0, |_| 1.0, 0.08, -0.75), net, net];
    let (all_smooth, all_edge) = (errors(SMOOTH), errors(EDGE));
    for (kind, (smooth, scale, tolerance, edge)) in laws.into_iter().enumerate() {
        let name = word(kinds(1)[kind]);
        let slopes = [slope(&all_smooth[kind], scale), slope(&all_edge[kind], |_| 1.0)];
        println!("{name}: slopes {:.3} smooth, {:.3} edge", slopes[0], slopes[1]);
        // Each slope has a standard error of 0.006; the rest is room for terms of higher order.
        assert!((slopes[0] - smooth).abs() < tolerance, "{name}, smooth: slope {}", slopes[0]);
        assert!((slopes[1] - edge).abs() < 0.04, "{name}, edge: slope {}", slopes[1]);
    }
    for nets in &all_smooth[2..] {
        assert!(
            nets[4].value < 1e-3 * (1.488_f64 / 4096.0).sqrt(),
            "1000 times less than independent numbers"
        );
    }
}

/// Products lose nothing against squares, the error times N being the same; numbers of samples that leave a rest, such as primes,
/// lose a factor of less than four.
#[test]
fn strata_serve_any_number_of_samples() {
    let scaled = |n: u32| f64::from(n) * SMOOTH.error(SamplerKind::Stratified { spp: n }, n).value;
    let square = scaled(64);
    let products = [60, 63, 65, 72, 80, 100, 120, 128].map(|n| (n, 1.4));
    let rests = [37, 53, 59, 62, 67, 97, 109].map(|n| (n, 4.0));
    for (n, bound) in products.into_iter().chain(rests) {
        let ratio = scaled(n) / square;
        println!("{n} samples: {ratio:.3} of the error of a square, times N");
        assert!(ratio < bound, "{n} samples: {ratio} of the error of a square, times N");
    }
}

/// Pixels along the edge of the pictures of [`error_image`].
const EDGE_PIXELS: u32 = 128;

/// Pictures per measurement: the pixels of a tree share the first digits of their scrambling.
const PICTURES: u32 = 24;

/// What every pixel is off by.
fn error_image(seed: u32, kind: SamplerKind, spp: u32, integrand: Integrand) -> Vec<f64> {
    let points = |x: u32, y: u32, i: u32| {
        let u = kind.start(seed, [x, y], i).get_2d(Dim::LightPoint(0), Vertex::ROOT);
        u.map(|x| f64::from(x) + 0.5 / 16_777_216.0)
    };
    let pixel = |x, y| {
        let sum: f64 = (0..spp).map(|i| points(x, y, i)).map(|[a, b]| (integrand.f)(a, b)).sum();
        sum / f64::from(spp) - integrand.exact
    };
    // Across the borders of four trees.
    (0..EDGE_PIXELS * EDGE_PIXELS).map(|p| pixel(p % EDGE_PIXELS + 192, p / EDGE_PIXELS + 192)).collect()
}

/// The picture after a Gaussian of that standard deviation in pixels; wraps around.
fn blurred(image: &[f64], sigma: f64) -> Vec<f64> {
    let reach = (4.0 * sigma).ceil() as i32;
    let weights: Vec<_> = (-reach..=reach).map(|d| (-0.5 * (f64::from(d) / sigma).powi(2)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let edge = EDGE_PIXELS as i32;
    let pass = |image: &[f64], dx: i32, dy: i32| -> Vec<f64> {
        let at = |x: i32, y: i32| image[(y.rem_euclid(edge) * edge + x.rem_euclid(edge)) as usize];
        let taps = |x, y| {
            let terms = weights.iter().zip(-reach..).map(|(w, d)| w * at(x + d * dx, y + d * dy));
            terms.sum::<f64>() / total
        };
        (0..edge * edge).map(|p| taps(p % edge, p / edge)).collect()
    };
    pass(&pass(image, 1, 0), 0, 1)
}

/// Errors per pixel, and after blurs by one and by two pixels, of all pictures together.
fn arranged(kind: SamplerKind, spp: u32, integrand: Integrand) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for seed in 0..PICTURES {
        let image = error_image(seed, kind, spp, integrand);
        let square = |image: &[f64]| image.iter().map(|x| x * x).sum::<f64>();
        sums[0] += square(&image);
        sums[1] += square(&blurred(&image, 1.0));
        sums[2] += square(&blurred(&image, 2.0));
    }
    sums.map(|sum| (sum / f64::from(PICTURES * EDGE_PIXELS * EDGE_PIXELS)).sqrt())
}

/// The errors of blue noise over those of independent scramblings.
fn arrangement(spp: u32, integrand: Integrand) -> [f64; 3] {
    let blue = arranged(SamplerKind::BlueNoise { spp }, spp, integrand);
    let white = arranged(SamplerKind::OwenSobol, spp, integrand);
    [0, 1, 2].map(|i| blue[i] / white[i])
}

/// Low frequencies are what a blur leaves: less of the error than with independent scramblings, and as much per pixel.
#[test]
fn errors_of_neighbours_cancel_under_blue_noise() {
    for integrand in [SMOOTH, EDGE] {
        for spp in [1, 2, 4, 8, 16] {
            let [pixel, one, two] = arrangement(spp, integrand);
            println!("{}, {spp} spp: {pixel:.3} per pixel, {one:.3} and {two:.3} blurred", integrand.name);
            // 96 trees with scramblings of their own.
            assert!((pixel - 1.0).abs() < 0.05, "{}, {spp} spp: {pixel} per pixel", integrand.name);
            assert!(one < 0.8, "{}, {spp} spp: {one} after a blur by one pixel", integrand.name);
            assert!(two < 0.65, "{}, {spp} spp: {two} after a blur by two pixels", integrand.name);
        }
    }
}

/// Rows and columns are treated alike: a pixel is as unlike its right neighbour as its lower one.
#[test]
fn blue_noise_has_no_direction() {
    let image = error_image(0, SamplerKind::BlueNoise { spp: 1 }, 1, SMOOTH);
    let edge = EDGE_PIXELS as usize;
    let correlation = |step: usize| {
        let pairs = (0..edge * (edge - 1)).filter(|p| p % edge != edge - 1);
        pairs.map(|p| image[p] * image[p + step]).sum::<f64>() / image.iter().map(|x| x * x).sum::<f64>()
    };
    let [right, below, diagonal] = [correlation(1), correlation(edge), correlation(edge + 1)];
    println!("correlation with the pixel to the right {right:.4}, below {below:.4}, across {diagonal:.4}");
    // Standard error 0.008.
    assert!((right - below).abs() < 0.04, "{right} to the right, {below} below");
    assert!(right < -0.05 && below < -0.05, "neighbours are unlike: {right}, {below}");
}

#[test]
#[ignore = "prints the tables of benches/record/samplers.md"]
fn tables() {
    for integrand in [SMOOTH, EDGE] {
        println!(
            "\n| {} | {} | slope |\n|---|{}---|",
            integrand.name,
            SIZES.map(|n| n.to_string()).join(" | "),
            "---|".repeat(5)
        );
        for (kind, errors) in kinds(1).into_iter().zip(errors(integrand)) {
            let cells: Vec<_> = errors.iter().map(|e| format!("{:.2e}", e.value)).collect();
            println!("| {} | {} | {:.2} |", word(kind), cells.join(" | "), slope(&errors, |_| 1.0));
        }
    }
    for integrand in [SMOOTH, EDGE] {
        println!("\n| {} | per pixel | blur 1 px | blur 2 px |\n|---|---|---|---|", integrand.name);
        for spp in [1, 2, 4, 8, 16] {
            let [pixel, one, two] = arrangement(spp, integrand);
            println!("| {spp} spp | {pixel:.3} | {one:.3} | {two:.3} |");
        }
    }
}
