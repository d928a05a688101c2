//! Where polynomials vanish, in double precision.
//!
//! Polynomials over an interval are given by their Bernstein coefficients. A polynomial has no more roots in the interval
//! than its coefficients change sign, and as many up to an even number (Farouki 2012, The Bernstein polynomial basis: a
//! centennial retrospective): no change proves that there is no root, one that there is exactly one. Nothing is found by
//! sampling, so nothing can be stepped over.

use std::ops::ControlFlow;

/// Deepest halving of the unit interval. Two roots that are still not apart are taken for one that the polynomial
/// touches without crossing: less loses crossings that lie close together, more is below what doubles tell apart.
const DEEPEST: u32 = 48;

/// The roots of `a x^2 + 2 b x + c`, given `discriminant` = b^2 - a c: where the caller knows it as a difference of lengths
/// it is better than the one of squares. Values that are not finite stand for roots that are not there, in no order.
///
/// The larger root comes from a sum without cancellation, the other from the product of both (Press et al. 2007, Numerical
/// Recipes, section 5.6).
#[must_use]
pub fn quadratic(a: f64, b: f64, c: f64, discriminant: f64) -> [f64; 2] {
    if discriminant.is_nan() || discriminant < 0.0 {
        return [f64::NAN; 2];
    }
    let sum = -(b + discriminant.sqrt().copysign(b));
    if sum == 0.0 { [0.0 / a; 2] } else { [sum / a, c / sum] }
}

/// An interval in which a polynomial crosses zero once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Its left end.
    pub low: f64,
    /// Its right end.
    pub high: f64,
    /// Whether the polynomial is negative to the left of the root.
    pub rises: bool,
}

/// Calls `found` with an interval about each crossing of zero in [0, 1], from left to right, until it breaks.
/// `coefficients` are those of the Bernstein basis. Where the polynomial touches zero without crossing it, nothing is found.
pub fn crossings<const N: usize>(
    coefficients: [f64; N],
    found: &mut impl FnMut(Crossing) -> ControlFlow<()>,
) -> ControlFlow<()> {
    split(coefficients, [0.0, 1.0], DEEPEST, found)
}

fn split<const N: usize>(
    coefficients: [f64; N],
    [low, high]: [f64; 2],
    depth: u32,
    found: &mut impl FnMut(Crossing) -> ControlFlow<()>,
) -> ControlFlow<()> {
    // Zero counts as positive everywhere, so that a root on the seam of two halves belongs to one of them.
    let changes = coefficients.windows(2).filter(|pair| (pair[0] < 0.0) != (pair[1] < 0.0)).count();
    let crossing = Crossing { low, high, rises: coefficients[0] < 0.0 };
    match changes {
        0 => ControlFlow::Continue(()),
        1 => found(crossing),
        _ if depth == 0 && changes % 2 == 1 => found(crossing),
        _ if depth == 0 => ControlFlow::Continue(()),
        _ => {
            let [left, right] = halves(coefficients);
            let middle = 0.5 * (low + high);
            split(left, [low, middle], depth - 1, found)?;
            split(right, [middle, high], depth - 1, found)
        }
    }
}

/// The coefficients over both halves of the interval, by the scheme of de Casteljau.
fn halves<const N: usize>(mut coefficients: [f64; N]) -> [[f64; N]; 2] {
    let mut left = coefficients;
    for (level, corner) in left.iter_mut().enumerate().skip(1) {
        for i in 0..N - level {
            coefficients[i] = 0.5 * (coefficients[i] + coefficients[i + 1]);
        }
        *corner = coefficients[0];
    }
    [left, coefficients]
}

/// The crossing of zero in an interval, to the last bits: Newton's method, and halving where it would leave the interval or
/// does not get on (Press et al. 2007, Numerical Recipes, section 9.4). `f` gives value and slope; it may be a better
/// conditioned function of the same sign.
pub fn refine(crossing: Crossing, f: impl Fn(f64) -> [f64; 2]) -> f64 {
    /// Halving alone is done by then.
    const STEPS: u32 = 120;
    // Which way it crosses is not asked of `f`: at an end that is all but a root of its own, rounding would decide.
    let Crossing { mut low, mut high, rises } = crossing;
    let mut x = 0.5 * (low + high);
    let mut last_step = high - low;
    for _ in 0..STEPS {
        let [value, slope] = f(x);
        if value == 0.0 {
            return x;
        }
        if (value < 0.0) == rises {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let gets_on = newton > low && newton < high && (newton - x).abs() <= 0.5 * last_step;
        let next = if gets_on { newton } else { 0.5 * (low + high) };
        last_step = (next - x).abs();
        x = next;
        if last_step <= f64::EPSILON * x.abs() || last_step == 0.0 {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all<const N: usize>(coefficients: [f64; N]) -> Vec<Crossing> {
        let mut all = vec![];
        _ = crossings(coefficients, &mut |crossing| {
            all.push(crossing);
            ControlFlow::Continue(())
        });
        all
    }

    /// Bernstein coefficients of the product of `x - root`.
    fn product(roots: [f64; 4]) -> [f64; 5] {
        let mut power = [1.0, 0.0, 0.0, 0.0, 0.0];
        for root in roots {
            let mut next = [0.0; 5];
            for i in 0..5 {
                next[i] -= root * power[i];
                if i > 0 {
                    next[i] += power[i - 1];
                }
            }
            power = next;
        }
        let binomial = |n: u32, k: u32| (1..=k).map(|i| f64::from(n + 1 - i) / f64::from(i)).product::<f64>();
        std::array::from_fn(|j| {
            let j = u32::try_from(j).expect("small");
            (0..=j).map(|i| binomial(j, i) / binomial(4, i) * power[i as usize]).sum()
        })
    }

    #[test]
    fn every_crossing_is_found_once_in_order() {
        let roots = [0.1, 0.100_001, 0.75, 0.9];
        let found = all(product(roots));
        assert_eq!(found.len(), 4, "{found:?}");
        for (crossing, root) in found.iter().zip(roots) {
            let value = |x: f64| {
                let factors = roots.map(|r| x - r);
                let slope =
                    (0..4).map(|i| (0..4).filter(|&j| j != i).map(|j| factors[j]).product::<f64>()).sum();
                [factors.iter().product(), slope]
            };
            let x = refine(*crossing, value);
            assert!((x - root).abs() < 1e-12, "{x} for {root}");
        }
    }

    #[test]
    fn roots_on_seams_are_found_once_and_touches_not() {
        assert_eq!(all(product([0.5, 2.0, 3.0, 4.0])).len(), 1, "a root in the middle");
        assert_eq!(all(product([0.25, 0.75, -1.0, 2.0])).len(), 2, "two roots on seams");
        assert!(all(product([0.3, 0.3, -1.0, 2.0])).len() % 2 == 0, "a touch has two sides or none");
        assert!(all(product([-1.0, -2.0, 2.0, 3.0])).is_empty(), "none inside");
    }

    #[test]
    fn quadratics_keep_their_small_root() {
        // x^2 - 1e8 x + 1: the textbook formula gives 7.45e-9.
        let [large, small] = quadratic(1.0, -5e7, 1.0, 2.5e15 - 1.0);
        assert!((small - 1e-8).abs() < 1e-22, "{small:e}");
        assert!((large - 1e8).abs() < 1e-6, "{large}");
        let [x, y] = quadratic(0.0, 1.0, -4.0, 1.0);
        assert!(!x.is_finite() && (y - 2.0).abs() < 1e-15, "a line: {x} {y}");
        assert!(quadratic(1.0, 0.0, 1.0, -1.0).iter().all(|x| x.is_nan()), "none");
    }
}
