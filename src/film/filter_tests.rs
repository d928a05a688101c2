//! What is sampled against what the shapes say.

use super::*;

const ALL: [(FilterShape, f32); 6] = [
    (FilterShape::Box, 0.5),
    (FilterShape::Tent, 1.0),
    (FilterShape::Gaussian, 1.5),
    (FilterShape::Gaussian, 3.0),
    (FilterShape::Mitchell, 2.0),
    (FilterShape::Mitchell, 1.25),
];

/// Integral of `g` times the shape over [`from`, `to`], by midpoints.
fn integral(shape: FilterShape, radius: f64, [from, to]: [f64; 2], g: impl Fn(f64, f64) -> f64) -> f64 {
    let steps = 100_000;
    let width = (to - from) / f64::from(steps);
    let term = |i| {
        let x = from + width * (f64::from(i) + 0.5);
        g(x, shape.eval(x, radius)) * width
    };
    (0..steps).map(term).sum()
}

/// Offsets along x and weights at evenly spread numbers.
fn spread(filter: &Filter, count: u16) -> impl Iterator<Item = (f64, f64)> + '_ {
    (0..count).map(move |i| {
        let sample = filter.sample([(f32::from(i) + 0.5) / f32::from(count), 0.5]);
        (f64::from(sample.offset[0]), f64::from(sample.weight))
    })
}

/// A permutation of 64-bit numbers with good bits: Steele, Lea, Flood, 2014, "Fast splittable pseudorandom number
/// generators", its finaliser.
fn random(index: u64) -> f32 {
    let mut z = index.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    f32::from(u16::try_from((z ^ (z >> 31)) >> 48).expect("sixteen bits")) / 65536.0
}

#[test]
fn offsets_stay_within_the_radius_and_rise_with_u() {
    for (shape, radius) in ALL {
        let filter = Filter::new(shape, radius);
        let mut last = f64::NEG_INFINITY;
        for (x, weight) in spread(&filter, 65521) {
            assert!(x >= last && x.abs() <= f64::from(radius), "{shape:?} {radius}: {x} after {last}");
            assert!(weight.is_finite(), "{shape:?} {radius}: weight {weight}");
            last = x;
        }
        for u in [0.0, 0.5, 1.0 - f32::EPSILON / 2.0] {
            let sample = filter.sample([u, u]);
            assert!(sample.offset.iter().all(|x| x.abs() <= radius), "{shape:?} at {u}: {sample:?}");
        }
    }
}

#[test]
fn a_box_is_exact() {
    let filter = Filter::new(FilterShape::Box, 0.5);
    let sample = filter.sample([0.25, 0.0]);
    assert_eq!(sample, FilterSample { offset: [-0.25, -0.5], weight: 1.0 }, "linear");
}

#[test]
fn weights_have_mean_one_and_moments_are_the_shapes() {
    for (shape, radius) in ALL {
        let filter = Filter::new(shape, radius);
        let far = f64::from(radius);
        let whole = integral(shape, far, [-far, far], |_, f| f);
        let (mut mean, mut second, mut count) = (0.0, 0.0, 0.0);
        // Along y the middle of the filter, positive in all shapes, adds a constant factor: divided out.
        let along_y = f64::from(filter.excess);
        for (x, weight) in spread(&filter, 65521) {
            mean += weight / along_y;
            second += weight / along_y * x * x;
            count += 1.0;
        }
        let wanted = integral(shape, far, [-far, far], |x, f| x * x * f) / whole;
        assert!((mean / count - 1.0).abs() < 1e-4, "{shape:?} {radius}: mean weight {}", mean / count);
        let absolute = integral(shape, far, [-far, far], |x, f| x * x * f.abs()) / whole;
        let error = (second / count - wanted).abs() / absolute;
        assert!(error < 1e-4, "{shape:?} {radius}: second moment {} for {wanted}", second / count);
    }
}

#[test]
fn intervals_have_the_probability_of_the_shape() {
    for (shape, radius) in ALL {
        let filter = Filter::new(shape, radius);
        let far = f64::from(radius);
        let whole = integral(shape, far, [-far, far], |_, f| f.abs());
        let samples: Vec<_> = spread(&filter, 65521).map(|(x, _)| x).collect();
        let mut worst: f64 = 0.0;
        for tenth in -19..20 {
            let x = far * f64::from(tenth) / 20.0;
            let below = real(samples.iter().filter(|&&s| s < x).count()) / real(samples.len());
            let wanted = integral(shape, far, [-far, x], |_, f| f.abs()) / whole;
            worst = worst.max((below - wanted).abs());
        }
        assert!(worst < 2e-5, "{shape:?} {radius}: off by {worst}");
    }
}

/// 400 cells, half a million samples. Cells expected to get fewer than 10 are left out. A correct sampler fails each of
/// the six with probability 1e-4: the quantile of chi-square is taken by Wilson, Hilferty, 1931, "The distribution of
/// chi-square".
#[test]
fn samples_pass_a_chi_square_test_in_the_plane() {
    const CELLS: u16 = 20;
    const NORMAL_QUANTILE: f64 = 3.719;
    let total = 500_000_u64;
    for (shape, radius) in ALL {
        let filter = Filter::new(shape, radius);
        let far = f64::from(radius);
        let edge = |i: u16| far * (2.0 * f64::from(i) / f64::from(CELLS) - 1.0);
        let line: Vec<_> =
            (0..CELLS).map(|i| integral(shape, far, [edge(i), edge(i + 1)], |_, f| f.abs())).collect();
        let whole: f64 = line.iter().sum();
        let mut counts = vec![0_u32; usize::from(CELLS) * usize::from(CELLS)];
        let cell = |x: f32| (0..CELLS).rev().find(|&i| f64::from(x) >= edge(i)).map_or(0, usize::from);
        for i in 0..total {
            let [x, y] = filter.sample([random(2 * i + 1), random(2 * i + 2)]).offset;
            counts[cell(y) * usize::from(CELLS) + cell(x)] += 1;
        }
        let (mut chi2, mut freedom) = (0.0, -1.0);
        for (i, &count) in counts.iter().enumerate() {
            let share = line[i % usize::from(CELLS)] * line[i / usize::from(CELLS)] / (whole * whole);
            let wanted = share * 500_000.0;
            if wanted >= 10.0 {
                chi2 += (f64::from(count) - wanted).powi(2) / wanted;
                freedom += 1.0;
            }
        }
        let spread = 2.0 / (9.0 * freedom);
        let limit = freedom * (1.0 - spread + NORMAL_QUANTILE * f64::sqrt(spread)).powi(3);
        assert!(chi2 < limit, "{shape:?} {radius}: chi-square {chi2} above {limit} for {freedom}");
    }
}
