//! The filter beside rays at equal time and at equal error.

use crate::scenes::Shot;

/// Samples of the filter at which it is compared.
const AT: [u32; 2] = [4, 16];

/// The head of the table.
pub(crate) const HEAD: &str = "\n| scene | filter at | way | its error in the filter's time, over the filter's: mask | inside | silhouettes | contact \
    | its time to the filter's error, over the filter's: mask | inside | silhouettes | contact |\n|---|---|---|---|---|---|---|---|---|---|---|";

/// Lines of the table: at the time of the filter what lobe and jitter have for errors, and how long they take to its errors.
pub(crate) fn compare(scene: &str, found: &[(&str, Vec<Shot>)]) -> Vec<String> {
    let mut lines = Vec::new();
    for mine in found[0].1.iter().filter(|shot| AT.contains(&shot.spp)) {
        for (way, shots) in &found[1..3] {
            let errors = [0, 1, 2, 3].map(|class| at_equal_time(mine, shots, class));
            let times = [0, 1, 2, 3].map(|class| at_equal_error(mine, shots, class));
            let numbers = [errors, times].map(|numbers| numbers.map(Option::unwrap_or_default).join(" | "));
            lines.push(format!("| `{scene}` | {} | {way} | {} |", mine.spp, numbers.join(" | ")));
        }
    }
    lines
}

/// Logarithms of times and errors of those that have an error.
fn points(shots: &[Shot], class: usize) -> Option<Vec<[f64; 2]>> {
    let point = |shot: &Shot| Some([shot.seconds.ln(), shot.errors[class].filter(|x| *x > 0.0)?.ln()]);
    let points: Vec<_> = shots.iter().filter_map(point).collect();
    (points.len() > 1).then_some(points)
}

/// Beyond the times that were measured, marked, by the slope of the nearest two.
fn at_equal_time(mine: &Shot, shots: &[Shot], class: usize) -> Option<String> {
    let own = mine.errors[class].filter(|error| *error > 0.0)?;
    let (points, at) = (points(shots, class)?, mine.seconds.ln());
    let is_measured = points[0][0] <= at && at <= points[points.len() - 1][0];
    let mark = if is_measured { "" } else { "~" };
    Some(format!("{mark}{:.2}", line(&points, at).exp() / own))
}

/// Where the error is never measured, how long the longest took, and a guess by the last slope.
fn at_equal_error(mine: &Shot, shots: &[Shot], class: usize) -> Option<String> {
    let own = mine.errors[class].filter(|error| *error > 0.0)?;
    let points = points(shots, class)?;
    let least = points.iter().map(|point| point[1]).fold(f64::INFINITY, f64::min);
    let turned: Vec<_> = points.iter().map(|&[x, y]| [y, x]).collect();
    let ratio = line(&turned, own.ln()).exp() / mine.seconds;
    if own.ln() >= least {
        let greatest = points.iter().map(|point| point[1]).fold(f64::NEG_INFINITY, f64::max);
        let mark = if own.ln() <= greatest { "" } else { "~" };
        return Some(format!("{mark}{ratio:.1}"));
    }
    let longest = points[points.len() - 1][0].exp() / mine.seconds;
    let guess = if ratio < 1e4 {
        format!("{ratio:.0} by its last slope")
    } else {
        "never by its last slope".to_owned()
    };
    Some(format!("> {longest:.0} ({guess})"))
}

/// The height at x of a line through points, straight between neighbours and beyond the last two at either end.
fn line(points: &[[f64; 2]], x: f64) -> f64 {
    let rising = points[0][0] < points[points.len() - 1][0];
    let after = |point: &[f64; 2]| if rising { point[0] >= x } else { point[0] <= x };
    let i = points.iter().position(after).unwrap_or(points.len()).clamp(1, points.len() - 1);
    let ([x0, y0], [x1, y1]) = (points[i - 1], points[i]);
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}
