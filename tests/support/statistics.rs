//! Chi-square tests and simple statistics for the laws.

#![allow(dead_code, reason = "each test program uses a part")]

/// Pearson's chi-square of counts against expectations; neighbours are pooled until five are expected.
/// Gives the statistic and the number of cells left. The expectations must be made independently of the counts.
pub(crate) fn chi_square(counts: &[f64], expected: &[f64]) -> (f64, usize) {
    assert_eq!(counts.len(), expected.len(), "one expectation for each count");
    let mut pools = vec![(0.0, 0.0)];
    for (&count, &expectation) in counts.iter().zip(expected) {
        if pools.last().is_some_and(|&(_, pooled)| pooled >= 5.0) {
            pools.push((0.0, 0.0));
        }
        let last = pools.last_mut().expect("never empty");
        *last = (last.0 + count, last.1 + expectation);
    }
    if pools.len() > 1 && pools.last().is_some_and(|&(_, pooled)| pooled < 5.0) {
        let (count, expectation) = pools.pop().expect("two at least");
        let last = pools.last_mut().expect("one left");
        *last = (last.0 + count, last.1 + expectation);
    }
    (pools.iter().map(|(c, e)| (c - e).powi(2) / e).sum(), pools.len())
}

/// The probability that a chi-square variable with that many degrees of freedom is at least `statistic`.
pub(crate) fn chi_square_tail(statistic: f64, degrees: usize) -> f64 {
    upper_gamma(degrees as f64 / 2.0, statistic / 2.0)
}

/// Regularised upper incomplete gamma function Q(a, x): series below a + 1, Lentz's continued fraction above
/// (Abramowitz and Stegun 1964, 6.5.29 and 6.5.31).
fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for n in 1..10_000 {
            term *= x / (a + f64::from(n));
            sum += term;
            if term < sum * 1e-16 {
                break;
            }
        }
        return 1.0 - front * sum;
    }
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut h = d;
    for n in 1..10_000 {
        let n = f64::from(n);
        let an = n * (a - n);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * h
}

/// ln Gamma(x) for x > 0: Stirling's series after shifting x above 10 (Abramowitz and Stegun 1964, 6.1.41).
fn ln_gamma(mut x: f64) -> f64 {
    let mut shift = 0.0;
    while x < 10.0 {
        shift -= x.ln();
        x += 1.0;
    }
    let r = 1.0 / (x * x);
    let series = (1.0 / 12.0 + r * (-1.0 / 360.0 + r * (1.0 / 1260.0 - r / 1680.0))) / x;
    shift + (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series
}

/// Slope of the least-squares line through the points.
pub(crate) fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mx, my) = points.iter().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / n, sy + y / n));
    let covariance: f64 = points.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    covariance / points.iter().map(|(x, _)| (x - mx).powi(2)).sum::<f64>()
}

#[test]
fn tails_are_those_of_the_tables() {
    // Abramowitz and Stegun 1964, table 26.8.
    for (statistic, degrees, tail) in
        [(3.841_46, 1, 0.05), (18.3070, 10, 0.05), (29.5883, 10, 0.001), (124.342, 100, 0.05)]
    {
        let p = chi_square_tail(statistic, degrees);
        assert!((p / tail - 1.0).abs() < 1e-4, "{statistic} with {degrees} degrees: {p}, not {tail}");
    }
}
