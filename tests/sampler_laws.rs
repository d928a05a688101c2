//! Laws of the number sets, over all kinds of sampler: repeatable, stratified, convergent, uncorrelated.
//!
//! Seeds are fixed. Each statistical test states its significance and how it corrects for the number of comparisons.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small non-negative numbers")]
#![expect(clippy::float_cmp, reason = "numbers repeat exactly")]

#[path = "support/statistics.rs"]
mod statistics;

use specula::math::lanes::{IntLanes, Isa, Kernel, Lanes, Level, Wrapping};
use specula::sampling::sobol::sobol_2d_rev;
use specula::sampling::{AnySampler, Dim, OwenSobol, Sampler, SamplerKind, Vertex, hash};

const KINDS: [SamplerKind; 3] =
    [SamplerKind::Independent, SamplerKind::OwenSobol, SamplerKind::OwenSobolBlocks { log2_spp: 4 }];

const DIMS: [Dim; 9] = [
    Dim::Film,
    Dim::Lens,
    Dim::Time,
    Dim::LightChoice,
    Dim::LightPoint(0),
    Dim::LightPoint(1),
    Dim::LobeChoice,
    Dim::LobeDirection,
    Dim::Roulette,
];

fn vertices() -> Vec<Vertex> {
    let first = Vertex::ROOT.child(0);
    vec![Vertex::ROOT, first, Vertex::ROOT.child(1), first.child(0), first.child(0).child(0)]
}

/// Every number of a sample, in the order of the lists or backwards.
fn numbers<S: Sampler<I = u32>>(sampler: S, backwards: bool) -> Vec<f32> {
    let mut purposes: Vec<_> = vertices().into_iter().flat_map(|v| DIMS.map(|d| (d, v))).collect();
    if backwards {
        purposes.reverse();
    }
    let mut numbers = Vec::new();
    for (dim, vertex) in purposes {
        let mut some = vec![sampler.get_1d(dim, vertex)];
        some.extend(sampler.get_2d(dim, vertex));
        some.extend(sampler.get_2d_split(dim, vertex, 1, 3));
        if backwards {
            some.reverse();
        }
        numbers.extend(some);
    }
    if backwards {
        numbers.reverse();
    }
    numbers
}

#[test]
fn asking_again_in_any_order_repeats() {
    for kind in KINDS {
        let sampler = kind.start(7, [123, 45], 6_u32);
        let first = numbers(sampler, false);
        assert_eq!(first, numbers(sampler, true), "{kind:?}: backwards");
        assert_eq!(first, numbers(kind.start(7, [123, 45], 6_u32), false), "{kind:?}: another sampler");
        for (what, other) in [
            ("seed", kind.start(8, [123, 45], 6_u32)),
            ("x", kind.start(7, [125, 45], 6)),
            ("y", kind.start(7, [123, 47], 6)),
            ("index", kind.start(7, [123, 45], 7)),
        ] {
            let same = numbers(other, false).iter().zip(&first).filter(|(a, b)| a == b).count();
            assert!(same <= 2, "{kind:?}: another {what} shares {same} numbers");
        }
    }
}

#[test]
fn numbers_stay_below_one() {
    for kind in KINDS {
        for index in 0..20_000 {
            for x in kind.start(1, [3, 4], index).get_2d(Dim::Film, Vertex::ROOT) {
                let steps = x * 16_777_216.0;
                assert!((0.0..1.0).contains(&x) && steps.fract() == 0.0, "{kind:?}: {x}");
            }
        }
    }
    assert!(u32::MAX.to_unit() < 1.0, "the greatest number");
}

/// Numbers of sixteen samples with pixel, index and vertex of their own.
struct Wide {
    kind: SamplerKind,
}

impl<S: Isa> Kernel<S> for Wide {
    type Output = Vec<[f32; 5]>;
    #[inline(always)]
    fn run(self, isa: S) -> Self::Output {
        let mut out = Vec::new();
        for start in (0..16).step_by(S::WIDTH) {
            let lane: S::I = Wrapping::<u32>::wrapping_add(isa.iota(), start as u32);
            let sampler = self.kind.start(11, [lane, lane ^ 5], Wrapping::<u32>::wrapping_mul(lane, 3));
            let one = sampler.get_1d(Dim::Time, Vertex::ROOT.child(3));
            let two = sampler.get_2d(Dim::Lens, Vertex::ROOT);
            let vertices = hash::combine(lane.splat(Vertex::ROOT.id()), lane);
            let deep = sampler.at_vertices(vertices).get_2d_split(Dim::LobeDirection, Vertex::ROOT, 2, 4);
            for i in 0..S::WIDTH {
                out.push([one, two[0], two[1], deep[0], deep[1]].map(|x| x.extract(i)));
            }
        }
        out
    }
}

#[test]
fn every_width_draws_the_same_numbers() {
    for kind in KINDS {
        let expected: Vec<_> = (0..16_u32)
            .map(|lane| {
                let sampler = kind.start(11, [lane, lane ^ 5], lane * 3);
                let one = sampler.get_1d(Dim::Time, Vertex::ROOT.child(3));
                let two = sampler.get_2d(Dim::Lens, Vertex::ROOT);
                let deep = sampler.get_2d_split(Dim::LobeDirection, Vertex::ROOT.child(lane), 2, 4);
                [one, two[0], two[1], deep[0], deep[1]]
            })
            .collect();
        for level in Level::available() {
            assert_eq!(level.run(Wide { kind }), expected, "{kind:?} at {}", level.name());
        }
    }
}

/// Fails unless 2^m points have exactly one in each interval of 2^-a by 2^-(m-a), for all a.
fn assert_net(points: &[[u32; 2]], what: &str) {
    let m = points.len().ilog2();
    for a in 0..=m {
        let mut seen = vec![false; points.len()];
        for [x, y] in points {
            let top = |x: u32, bits: u32| if bits == 0 { 0 } else { x >> (32 - bits) };
            let cell = (top(*x, a) << (m - a) | top(*y, m - a)) as usize;
            assert!(!seen[cell], "{what}: two of {} points in interval {cell} of shape {a}", points.len());
            seen[cell] = true;
        }
    }
}

/// Numbers as fractions of 2^32.
fn fractions(u: [f32; 2]) -> [u32; 2] {
    u.map(|x| (f64::from(x) * 4_294_967_296.0) as u32)
}

#[test]
fn sobol_points_are_nets() {
    for m in 0..=12 {
        for block in [0, 1, 5, (1_u32 << 20) - 1] {
            let points: Vec<_> =
                (0..1_u32 << m).map(|i| sobol_2d_rev((block << m) + i).map(u32::reverse_bits)).collect();
            assert_net(&points, "plain");
        }
    }
}

#[test]
fn scrambled_points_are_nets() {
    for vertex in vertices() {
        for dim in DIMS {
            for m in [0, 1, 4, 7, 10] {
                for block in [0, 3] {
                    let points: Vec<_> = (0..1_u32 << m)
                        .map(|i| OwenSobol::start(3, [7, 9], (block << m) + i).get_2d(dim, vertex))
                        .map(fractions)
                        .collect();
                    assert_net(&points, "scrambled");
                }
            }
        }
    }
}

#[test]
fn split_samples_are_nets_together() {
    let points: Vec<_> = (0..64_u32)
        .flat_map(|i| (0..8).map(move |j| (i, j)))
        .map(|(i, j)| OwenSobol::start(3, [7, 9], i).get_2d_split(Dim::LobeDirection, Vertex::ROOT, j, 8))
        .map(fractions)
        .collect();
    assert_net(&points, "64 samples split in 8");
}

#[test]
fn one_number_is_stratified_too() {
    for dim in DIMS {
        for m in [0_u32, 3, 8, 11] {
            let n = 1_u32 << m;
            let mut cells: Vec<_> = (0..n)
                .map(|i| OwenSobol::start(3, [7, 9], i).get_1d(dim, Vertex::ROOT))
                .map(|x| (x * n as f32) as u32)
                .collect();
            cells.sort_unstable();
            assert!(cells.into_iter().eq(0..n), "{dim:?} with {n} samples");
        }
    }
}

#[test]
fn pixels_of_a_block_share_a_net() {
    let kind = SamplerKind::OwenSobolBlocks { log2_spp: 4 };
    let pixel = |x, y| {
        let numbers = move |i: u32| kind.start(3, [x, y], i).get_2d(Dim::Lens, Vertex::ROOT);
        (0..16).map(move |i| fractions(numbers(i)))
    };
    let mut all = Vec::new();
    for [x, y] in [[6, 8], [7, 8], [6, 9], [7, 9]] {
        assert_net(&pixel(x, y).collect::<Vec<_>>(), "one pixel");
        all.extend(pixel(x, y));
    }
    assert_net(&all, "four pixels");
    let mut indices: Vec<_> = (0..1024_u32)
        .flat_map(|i| [[0, 0], [1, 0], [0, 1], [1, 1]].map(|p| kind.start(0, p, i)))
        .map(|s| fractions(s.get_2d(Dim::Lens, Vertex::ROOT)))
        .collect();
    indices.sort_unstable();
    indices.dedup();
    assert!(
        indices.len() > 4090,
        "beyond the set too, no point of a block recurs: {} of 4096",
        indices.len()
    );
}

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

/// Points of a sampler, one pixel for each trial.
fn of_kind(kind: SamplerKind) -> impl Fn(u32, u32) -> [f64; 2] {
    move |trial, i| {
        let u = kind.start(1, [trial, 0], i).get_2d(Dim::LightPoint(0), Vertex::ROOT);
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

/// Owen 1997: the variance for smooth integrands of d variables falls as N^-3 (log N)^(d-1). Across an edge in the plane,
/// about N^1/2 of the N cells are cut, each adding a variance of the order of N^-2: N^-3/4.
#[test]
fn scrambled_errors_fall_as_theory_says() {
    let smooth = SIZES.map(|n| rms(n, of_kind(SamplerKind::OwenSobol), smooth, EXACT_SMOOTH));
    let edge = SIZES.map(|n| rms(n, of_kind(SamplerKind::OwenSobol), quarter_disc, EXACT_DISC));
    println!("Owen-Sobol, smooth: {smooth:?}\nedge: {edge:?}");
    // Each slope has a standard error of 0.006; the rest is room for terms of higher order.
    let slope_smooth = slope(&smooth, |n| n.ln().sqrt());
    assert!((slope_smooth + 1.5).abs() < 0.06, "smooth: slope {slope_smooth}");
    let slope_edge = slope(&edge, |_| 1.0);
    assert!((slope_edge + 0.75).abs() < 0.04, "edge: slope {slope_edge}");
    assert!(smooth[4].value < 1e-3 * (1.488_f64 / 4096.0).sqrt(), "1000 times less than independent numbers");
}

/// The eight bins of a number, and the probability of chi-square for the joint counts of two series.
fn independence(a: &[f32], b: &[f32]) -> f64 {
    const BINS: usize = 8;
    let mut counts = vec![0.0; BINS * BINS];
    for (x, y) in a.iter().zip(b) {
        counts[(x * BINS as f32) as usize * BINS + (y * BINS as f32) as usize] += 1.0;
    }
    let expected = vec![a.len() as f64 / counts.len() as f64; counts.len()];
    let (statistic, cells) = statistics::chi_square(&counts, &expected);
    statistics::chi_square_tail(statistic, cells - 1)
}

/// All series two by two; the smallest tail, times the number of pairs (Bonferroni), must exceed the significance.
fn assert_independent(series: &[(String, Vec<f32>)], what: &str) {
    let mut worst = (1.0, String::new());
    let mut pairs = 0.0;
    for (i, (name, a)) in series.iter().enumerate() {
        for (other, b) in &series[i + 1..] {
            let tail = independence(a, b);
            pairs += 1.0;
            if tail < worst.0 {
                worst = (tail, format!("{name} and {other}"));
            }
        }
    }
    assert!(worst.0 * pairs > 1e-3, "{what}: tail {:e} of {} among {pairs}", worst.0, worst.1);
}

/// One series for each coordinate of each purpose; element n is drawn from the n-th sampler.
fn series(samplers: &[AnySampler<u32>]) -> Vec<(String, Vec<f32>)> {
    let mut all = Vec::new();
    for vertex in vertices() {
        for dim in DIMS {
            let one: Vec<_> = samplers.iter().map(|s| s.get_1d(dim, vertex)).collect();
            let two: Vec<_> = samplers.iter().map(|s| s.get_2d(dim, vertex)).collect();
            all.push((format!("1d {dim:?} {vertex:?}"), one));
            all.push((format!("x {dim:?} {vertex:?}"), two.iter().map(|u| u[0]).collect()));
            all.push((format!("y {dim:?} {vertex:?}"), two.iter().map(|u| u[1]).collect()));
        }
    }
    all
}

#[test]
fn purposes_are_independent_from_pixel_to_pixel() {
    for kind in [SamplerKind::Independent, SamplerKind::OwenSobol] {
        for index in [0, 5] {
            let samplers: Vec<_> =
                (0..128_u32 * 128).map(|p| kind.start(2, [p % 128, p / 128], index)).collect();
            assert_independent(&series(&samplers), &format!("{kind:?}, sample {index}"));
        }
    }
}

#[test]
fn purposes_are_independent_from_sample_to_sample() {
    let samplers: Vec<_> = (0..1 << 14).map(|i| SamplerKind::Independent.start(2, [17, 4], i)).collect();
    assert_independent(&series(&samplers), "independent");
}

#[test]
fn neighbours_are_independent() {
    for kind in [SamplerKind::Independent, SamplerKind::OwenSobol] {
        for dim in [Dim::Film, Dim::LobeDirection] {
            let mut all = Vec::new();
            for (name, seed, dx, dy, index) in [
                ("itself", 0, 0, 0, 0),
                ("right", 0, 1, 0, 0),
                ("below", 0, 0, 1, 0),
                ("diagonal", 0, 1, 1, 0),
                ("far", 0, 256, 0, 0),
                ("seed", 1, 0, 0, 0),
            ] {
                // Every other pixel in both directions, so that no pixel is its own neighbour's.
                let pixels = (0..128_u32 * 128).map(|p| [p % 128 * 2 + dx, p / 128 * 2 + dy]);
                let numbers: Vec<_> =
                    pixels.map(|p| kind.start(seed, p, index).get_2d(dim, Vertex::ROOT)).collect();
                all.push((format!("x {name}"), numbers.iter().map(|u| u[0]).collect()));
                all.push((format!("y {name}"), numbers.iter().map(|u| u[1]).collect()));
            }
            assert_independent(&all, &format!("{kind:?} {dim:?}"));
        }
    }
}

/// Within a pixel, two purposes are paired at random, though not like independent numbers: partners in a pair of
/// samples are opposite in both, which doubles the variance of the coarsest interaction and no more.
#[test]
fn padding_costs_at_most_a_factor_of_two() {
    let n = 256;
    let (mut coarse, mut fine) = (0.0, 0.0);
    for pixel in 0..2000 {
        let (mut signs, mut products) = (0.0, 0.0);
        for i in 0..n {
            let sampler = OwenSobol::start(5, [pixel, 1], i);
            let a = f64::from(sampler.get_2d(Dim::LightPoint(0), Vertex::ROOT)[0]) - 0.5;
            let b = f64::from(sampler.get_2d(Dim::LobeDirection, Vertex::ROOT)[1]) - 0.5;
            signs += (a * b).signum() / f64::from(n);
            products += 12.0 * a * b / f64::from(n);
        }
        coarse += signs * signs * f64::from(n) / 2000.0;
        fine += products * products * f64::from(n) / 2000.0;
    }
    println!("variance relative to independent numbers: {coarse:.3} coarse, {fine:.3} product");
    // Standard error of a variance from 2000 trials: 3.2 %; four of them.
    assert!((coarse / 2.0 - 1.0).abs() < 0.13, "coarse interaction: {coarse}");
    assert!(fine < 2.0 * 1.13 && fine > 0.5, "product: {fine}");
}
