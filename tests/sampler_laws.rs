//! Laws of the number sets, over all kinds of sampler: repeatable, stratified, uniform, uncorrelated. Their errors have laws of
//! their own, in `sampler_errors.rs`.
//!
//! Seeds are fixed. Each statistical test states its significance and how it corrects for the number of comparisons.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small non-negative numbers")]
#![expect(clippy::float_cmp, reason = "numbers repeat exactly")]

#[path = "support/samplers.rs"]
mod samplers;
#[path = "support/statistics.rs"]
mod statistics;

use samplers::kinds;
use specula::math::lanes::{IntLanes, Isa, Kernel, Lanes, Level, Wrapping};
use specula::sampling::sobol::sobol_2d_rev;
use specula::sampling::{AnySampler, Dim, Sampler, SamplerKind, Stratified, Vertex, hash};

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
    for kind in kinds(16) {
        let sampler = kind.start(7, [123, 45], 6_u32);
        let first = numbers(sampler, false);
        assert_eq!(first, numbers(sampler, true), "{kind:?}: backwards");
        assert_eq!(first, numbers(kind.start(7, [123, 45], 6_u32), false), "{kind:?}: another sampler");
        for (what, other) in [
            ("seed", kind.start(8, [123, 45], 6_u32)),
            ("x", kind.start(7, [124, 45], 6)),
            ("y", kind.start(7, [123, 46], 6)),
            ("index", kind.start(7, [123, 45], 7)),
        ] {
            let same = numbers(other, false).iter().zip(&first).filter(|(a, b)| a == b).count();
            assert!(same <= 2, "{kind:?}: another {what} shares {same} numbers");
        }
    }
}

#[test]
fn numbers_stay_below_one() {
    for kind in kinds(16) {
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
    for kind in kinds(16) {
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

/// The kinds that are nets, for 2^m samples.
fn nets(m: u32) -> [SamplerKind; 2] {
    [SamplerKind::OwenSobol, SamplerKind::BlueNoise { spp: 1 << m }]
}

#[test]
fn scrambled_points_are_nets() {
    for vertex in vertices() {
        for dim in DIMS {
            for (m, block) in [0, 1, 4, 7, 10].into_iter().flat_map(|m| [(m, 0), (m, 3)]) {
                for kind in nets(m) {
                    let points: Vec<_> = (0..1_u32 << m)
                        .map(|i| kind.start(3, [7, 9], (block << m) + i).get_2d(dim, vertex))
                        .map(fractions)
                        .collect();
                    assert_net(&points, &format!("{kind:?}"));
                }
            }
        }
    }
}

#[test]
fn the_first_samples_are_a_net_too() {
    for kind in nets(10) {
        for m in 0..10 {
            let points: Vec<_> = (0..1_u32 << m)
                .map(|i| fractions(kind.start(3, [7, 9], i).get_2d(Dim::Lens, Vertex::ROOT)))
                .collect();
            assert_net(&points, &format!("{kind:?}"));
        }
    }
}

#[test]
fn split_samples_are_nets_together() {
    for kind in nets(6) {
        let points: Vec<_> = (0..64_u32)
            .flat_map(|i| (0..8).map(move |j| (i, j)))
            .map(|(i, j)| kind.start(3, [7, 9], i).get_2d_split(Dim::LobeDirection, Vertex::ROOT, j, 8))
            .map(fractions)
            .collect();
        assert_net(&points, &format!("{kind:?}, 64 samples split in 8"));
    }
}

/// Fails unless each of `n` numbers has one of `cells` equal cells for itself. Edges of cells are rounded down to numbers.
fn assert_apart(numbers: impl IntoIterator<Item = f32>, cells: u32, what: &str) {
    let mut seen = vec![false; cells as usize];
    for x in numbers {
        let cell = (f64::from(x) + 0.999 / 16_777_216.0) * f64::from(cells);
        assert!(!std::mem::replace(&mut seen[cell as usize], true), "{what}: {x} is second in {cell}");
    }
}

#[test]
fn one_number_is_stratified_too() {
    for dim in DIMS {
        for n in [1_u32, 8, 256, 2048] {
            for kind in kinds(n).into_iter().filter(|kind| *kind != SamplerKind::Independent) {
                let numbers = (0..n).map(|i| kind.start(3, [7, 9], i).get_1d(dim, Vertex::ROOT));
                assert_apart(numbers, n, &format!("{kind:?}, {dim:?}"));
            }
        }
    }
}

/// Fails unless all cells of the grid have points, and all strata of each axis: exactly one each if the grid has as many
/// cells as there are points.
fn assert_strata(points: &[[f32; 2]], what: &str) {
    let n = points.len() as u32;
    let root = n.isqrt();
    // A divisor, if there is one that keeps cells from being slim.
    let columns = (root.div_ceil(2)..=root).rev().find(|c| n.is_multiple_of(*c)).unwrap_or(root);
    let rows = n / columns;
    let cells = columns * rows;
    // Edges of cells are rounded down to numbers.
    let at = |x: f32, cells: u32| ((f64::from(x) + 0.999 / 16_777_216.0) * f64::from(cells)) as u32;
    for (name, cell) in [
        ("x", &(|[x, _]: [f32; 2]| at(x, cells)) as &dyn Fn([f32; 2]) -> u32),
        ("y", &|[_, y]| at(y, cells)),
        ("grid", &|[x, y]| at(x, columns) + columns * at(y, rows)),
    ] {
        let mut found: Vec<_> = points.iter().map(|u| cell(*u)).collect();
        found.sort_unstable();
        found.dedup();
        assert!(found.into_iter().eq(0..cells), "{what}: {name} of {columns} x {rows}");
    }
}

#[test]
fn any_number_of_samples_is_stratified() {
    for n in (1..40).chain([64, 97, 100, 255, 256, 1000, 4096]) {
        for set in [0, 2] {
            let kind = SamplerKind::Stratified { spp: n };
            let start = move |i| kind.start(3, [7, 9], set * n + i);
            let points: Vec<_> = (0..n).map(|i| start(i).get_2d(Dim::Lens, Vertex::ROOT)).collect();
            assert_strata(&points, &format!("set {set} of {n}"));
            let numbers = (0..n).map(|i| start(i).get_1d(Dim::Time, Vertex::ROOT));
            assert_apart(numbers, n, &format!("set {set} of {n}: one number"));
        }
    }
}

#[test]
fn split_samples_are_strata_together() {
    for (n, k) in [(16, 4), (10, 3), (7, 1), (1, 12)] {
        let points: Vec<_> = (0..n)
            .flat_map(|i| (0..k).map(move |j| (i, j)))
            .map(|(i, j)| {
                Stratified::start(3, [7_u32, 9], i, n).get_2d_split(Dim::LobeDirection, Vertex::ROOT, j, k)
            })
            .collect();
        assert_strata(&points, &format!("{n} samples split in {k}"));
    }
}

/// What makes the errors of neighbours cancel.
#[test]
fn aligned_blocks_of_pixels_share_a_net() {
    for (m, log2_edge) in [(0, 5), (2, 1), (3, 2), (4, 3)] {
        let kind = SamplerKind::BlueNoise { spp: 1 << m };
        for dim in DIMS {
            let edge = 1 << log2_edge;
            let pixels = (0..edge * edge).map(|p| [3 * edge + p % edge, 1000 * edge + p / edge]);
            let points: Vec<_> = pixels
                .flat_map(|p| (0..1_u32 << m).map(move |i| kind.start(3, p, i)))
                .map(|s| fractions(s.get_2d(dim, Vertex::ROOT.child(1))))
                .collect();
            assert_net(&points, &format!("{edge} x {edge} pixels, {dim:?}"));
        }
    }
}

/// Where a set is so large that few levels of the tree are left, no pixel repeats another.
#[test]
fn large_sets_do_not_repeat() {
    let kind = SamplerKind::BlueNoise { spp: 1 << 24 };
    let pixels = (0..64_u32).flat_map(|y| (0..64_u32).map(move |x| [x, y]));
    let mut all: Vec<_> =
        pixels.map(|p| kind.start(3, p, 5).get_2d(Dim::Film, Vertex::ROOT).map(f32::to_bits)).collect();
    all.sort_unstable();
    all.dedup();
    assert!(all.len() > 4090, "{} of 4096 pixels differ", all.len());
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
    for kind in kinds(11) {
        // Within a tree, pixels are meant to depend on each other.
        let distance = if matches!(kind, SamplerKind::BlueNoise { .. }) { 256 } else { 1 };
        for index in [0, 5] {
            let samplers: Vec<_> = (0..128_u32 * 128)
                .map(|p| kind.start(2, [p % 128 * distance, p / 128 * distance], index))
                .collect();
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
    for kind in &kinds(11)[..3] {
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

/// Within a pixel, two purposes are paired at random, though not like independent numbers where every prefix is stratified:
/// partners in a pair of samples are then opposite in both, which doubles the variance of the coarsest interaction and no
/// more.
#[test]
fn padding_costs_at_most_a_factor_of_two() {
    let n = 256;
    for kind in kinds(n) {
        let (mut coarse, mut fine) = (0.0, 0.0);
        for pixel in 0..2000 {
            let (mut signs, mut products) = (0.0, 0.0);
            for i in 0..n {
                let sampler = kind.start(5, [pixel * 256, 1], i);
                let a = f64::from(sampler.get_2d(Dim::LightPoint(0), Vertex::ROOT)[0]) - 0.5;
                let b = f64::from(sampler.get_2d(Dim::LobeDirection, Vertex::ROOT)[1]) - 0.5;
                signs += (a * b).signum() / f64::from(n);
                products += 12.0 * a * b / f64::from(n);
            }
            coarse += signs * signs * f64::from(n) / 2000.0;
            fine += products * products * f64::from(n) / 2000.0;
        }
        println!("{kind:?}: variance relative to independent numbers {coarse:.3} coarse, {fine:.3} product");
        let nested = matches!(kind, SamplerKind::OwenSobol | SamplerKind::BlueNoise { .. });
        let expected = if nested { 2.0 } else { 1.0 };
        // Standard error of a variance from 2000 trials: 3.2 %; four of them.
        assert!((coarse / expected - 1.0).abs() < 0.13, "{kind:?}, coarse interaction: {coarse}");
        assert!(fine < expected * 1.13 && fine > 0.5, "{kind:?}, product: {fine}");
    }
}
