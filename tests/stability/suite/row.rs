//! One kernel of the suite, and how it is measured.

#![allow(dead_code, reason = "the test and the bench each use a part")]

use super::axes::Axis;
use super::big::Big;
use super::random::Random;
use specula::math::lanes::Level;

/// The arguments or results of many evaluations, one column each; whole packets of sixteen.
pub(crate) type Columns = Vec<Vec<f32>>;

/// A kernel.
pub(crate) struct Row {
    pub(crate) name: &'static str,
    /// How many numbers it gives: the components of one vector, if more than one.
    pub(crate) results: usize,
    pub(crate) axes: Vec<Axis>,
    /// All evaluations at that width.
    pub(crate) run: fn(Level, &Columns, &mut Columns),
    /// The truth for the arguments as they are. `None` where there is none.
    pub(crate) truth: fn(&[Big]) -> Option<Vec<Big>>,
    /// How far from it the result may be, by arguments and by the magnitude of the truth.
    pub(crate) bound: fn(&[f64], f64) -> f64,
    /// The bound in words.
    pub(crate) says: &'static str,
}

/// The largest error found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Worst {
    /// Relative to the truth (the length of a vector), where that is well above the least normal float.
    pub(crate) relative: f64,
    /// In units of the last place of the truth.
    pub(crate) ulp: f64,
    /// Relative to the bound.
    pub(crate) of_bound: f64,
    /// Where the largest part of the bound was used up.
    pub(crate) at: Vec<f32>,
    pub(crate) level: &'static str,
    pub(crate) evaluations: usize,
}

/// A bound, in words and in numbers.
type Bound = (&'static str, fn(&[f64], f64) -> f64);

impl Row {
    pub(crate) fn new(
        name: &'static str,
        axes: Vec<Axis>,
        run: fn(Level, &Columns, &mut Columns),
        truth: fn(&[Big]) -> Option<Vec<Big>>,
        (says, bound): Bound,
    ) -> Self {
        let mut row = Self { name, results: 0, axes, run, truth, bound, says };
        let grid = row.grid();
        let point =
            |i: usize| grid.iter().map(|column| super::big::big(f64::from(column[i]))).collect::<Vec<_>>();
        let some = (0..grid[0].len()).find_map(|i| truth(&point(i)));
        row.results = some.expect("a truth somewhere on the grid").len();
        row
    }

    /// Every combination of extremes, as columns, the last one repeated to fill a packet.
    pub(crate) fn grid(&self) -> Columns {
        let mut points = vec![Vec::new()];
        for axis in &self.axes {
            let with = |point: &Vec<f32>| {
                let point = point.clone();
                axis.extremes.iter().map(move |x| [point.clone(), x.clone()].concat())
            };
            points = points.iter().flat_map(with).collect();
        }
        columns(points)
    }

    /// Random points among the extremes, a multiple of sixteen of them.
    pub(crate) fn random(&self, seed: u32, count: usize) -> Columns {
        let mut random = Random::new(seed);
        columns(
            (0..count)
                .map(|_| self.axes.iter().flat_map(|axis| (axis.random)(&mut random)).collect())
                .collect(),
        )
    }

    /// Room for the results.
    pub(crate) fn room(&self, arguments: &Columns) -> Columns {
        vec![vec![0.0; arguments[0].len()]; self.results]
    }

    /// The largest errors over these arguments at these widths.
    pub(crate) fn worst(&self, arguments: &Columns, levels: &[Level]) -> Worst {
        let found: Vec<_> =
            levels.iter().map(|level| (level.name(), self.results_at(*level, arguments))).collect();
        let mut worst = Worst::default();
        for i in 0..arguments[0].len() {
            let point: Vec<f32> = arguments.iter().map(|column| column[i]).collect();
            let exact: Vec<Big> = point.iter().map(|x| super::big::big(f64::from(*x))).collect();
            let Some(truth) = (self.truth)(&exact) else { continue };
            let truth: Vec<f64> = truth.iter().map(Big::to_f64).collect();
            for (level, results) in &found {
                let got: Vec<f64> = results.iter().map(|column| f64::from(column[i])).collect();
                worst.add(self, &point, &truth, &got, level);
            }
        }
        worst
    }

    /// Pairs the arguments anew: the columns of each axis move on, by steps of their own that have no common factor with
    /// the number of points.
    pub(crate) fn shift(&self, arguments: &mut Columns) {
        const STEPS: [usize; 9] = [1, 3, 7, 31, 127, 507, 1009, 2003, 4001];
        let mut first = 0;
        for (axis, step) in self.axes.iter().zip(STEPS) {
            let width = axis.extremes[0].len();
            for column in &mut arguments[first..first + width] {
                let by = step % column.len();
                column.rotate_left(by);
            }
            first += width;
        }
    }

    fn results_at(&self, level: Level, arguments: &Columns) -> Columns {
        let mut results = self.room(arguments);
        (self.run)(level, arguments, &mut results);
        results
    }
}

impl Worst {
    /// The worse of both.
    pub(crate) fn merge(&mut self, other: Self) {
        self.relative = self.relative.max(other.relative);
        self.ulp = self.ulp.max(other.ulp);
        self.evaluations += other.evaluations;
        if other.of_bound > self.of_bound {
            (self.of_bound, self.at, self.level) = (other.of_bound, other.at, other.level);
        }
    }

    fn add(&mut self, row: &Row, point: &[f32], truth: &[f64], got: &[f64], level: &'static str) {
        let size = truth
            .iter()
            .map(|x| x * x)
            .sum::<f64>()
            .sqrt()
            .max(truth.iter().fold(0.0, |m, x| x.abs().max(m)));
        let off = truth.iter().zip(got).map(|(t, g)| (t - g).abs());
        // NaN counts as infinitely far.
        let error = off.fold(0.0, |most: f64, x| if x.is_nan() { f64::INFINITY } else { most.max(x) });
        let arguments: Vec<f64> = point.iter().map(|x| f64::from(*x)).collect();
        // Functions of lanes flush what is below the normal numbers.
        let allowed = (row.bound)(&arguments, size) + 1.3e-38;
        self.evaluations += 1;
        if size >= 1e-30 {
            self.relative = self.relative.max(error / size);
            self.ulp = self.ulp.max(error / ulp(size));
        }
        if error / allowed > self.of_bound || self.at.is_empty() {
            (self.of_bound, self.at, self.level) = (error / allowed, point.to_vec(), level);
        }
    }
}

/// The distance of neighbouring floats at `x`.
fn ulp(x: f64) -> f64 {
    2.0_f64.powi(x.abs().log2().floor().max(-126.0) as i32 - 23)
}

fn columns(mut points: Vec<Vec<f32>>) -> Columns {
    let last = points.last().expect("some extremes").clone();
    points.resize(points.len().next_multiple_of(16), last);
    (0..points[0].len()).map(|k| points.iter().map(|point| point[k]).collect()).collect()
}

/// A kernel over lanes: name, axes, arguments and results in floats, arguments and truth in 200 bits, bound in words and in
/// numbers. The truth is an `Option`, the results an array.
macro_rules! kernel {
    (@row $name:expr, [$($axis:expr),*], $run:expr, $truth:expr, $says:literal, $bound:expr) => {{
        let truth: fn(&[$crate::suite::big::Big]) -> Option<Vec<$crate::suite::big::Big>> = $truth;
        $crate::suite::row::Row::new($name, vec![$($axis),*], $run, truth, ($says, $bound))
    }};
    // One number at a time, whatever the width.
    (scalar $name:expr, [$($axis:expr),*], |$a:ident| $body:expr, $truth:expr, $says:literal, $bound:expr) => {
        kernel!(@row $name, [$($axis),*], |_, arguments, results| {
            for i in 0..arguments[0].len() {
                let point: Vec<f32> = arguments.iter().map(|column| column[i]).collect();
                let $a: &[f32] = &point;
                let out = $body;
                for (column, x) in results.iter_mut().zip(out) {
                    column[i] = x;
                }
            }
        }, $truth, $says, $bound)
    };
    ($name:expr, [$($axis:expr),*], |$($x:ident),*| $body:expr, $truth:expr, $says:literal, $bound:expr) => {{
        struct Packets<'a>(&'a $crate::suite::row::Columns, &'a mut $crate::suite::row::Columns);
        impl<S: specula::math::lanes::Isa> specula::math::lanes::Kernel<S> for Packets<'_> {
            type Output = ();
            #[inline(always)]
            fn run(self, isa: S) {
                let Packets(arguments, results) = self;
                for at in (0..arguments[0].len()).step_by(S::WIDTH) {
                    let mut column = 0;
                    $(
                        let $x = isa.load(&arguments[column][at..]);
                        column += 1;
                    )*
                    debug_assert_eq!(column, arguments.len(), "{}: one name for each argument", $name);
                    let out = $body;
                    let mut k = 0;
                    while k < out.len() {
                        specula::math::lanes::Lanes::store(out[k], &mut results[k][at..]);
                        k += 1;
                    }
                }
            }
        }
        kernel!(@row $name, [$($axis),*], |level, arguments, results| level.run(Packets(arguments, results)),
            $truth, $says, $bound)
    }};
}
