//! What stands behind flags, read: numbers, times, ranges.

use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::time::Duration;

use crate::error::{Place, Problem, Problems};
use crate::image::Window;
use crate::scene::description::Frames;

/// Most threads that make any sense on any machine; more is a slip of the hand.
pub(super) const MOST_THREADS: usize = 4096;

pub(super) fn frames(text: &str, problems: &mut Problems) -> Option<Frames> {
    given(Frames::parse(text), ("frames", text), "a range of frames", || Frames::SYNTAX.to_owned(), problems)
}

/// The pixels between these corners, if there are any.
pub(in crate::cli) fn window([x0, y0, x1, y1]: [u32; 4]) -> Option<Window> {
    Some(Window { x0, y0, x1, y1 }).filter(|window| !window.is_empty())
}

pub(super) fn crop(text: &str, problems: &mut Problems) -> Option<Window> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let window = numbers.and_then(|numbers| window(numbers.try_into().ok()?));
    let remedy = || "give x0,y0,x1,y1 with x0 < x1 and y0 < y1, counted from 0 at the top left".to_owned();
    given(window, ("crop", text), "a rectangle of pixels", remedy, problems)
}

pub(super) fn threads(text: &str, problems: &mut Problems) -> Option<NonZeroUsize> {
    whole("threads", text, 1..=MOST_THREADS, problems).and_then(NonZeroUsize::new)
}

/// A whole number in a range.
pub(super) fn whole(
    flag: &str,
    text: &str,
    range: RangeInclusive<usize>,
    problems: &mut Problems,
) -> Option<usize> {
    let number = text.trim().parse().ok().filter(|n| range.contains(n));
    let remedy = || format!("give a whole number from {} to {}", range.start(), range.end());
    given(number, (flag, text), "a number in range", remedy, problems)
}

/// A time with its unit, seconds where there is none.
pub(super) fn time(flag: &str, text: &str, problems: &mut Problems) -> Option<Duration> {
    let seconds = with_unit(text, &[("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)]);
    let time = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    let remedy = || "give a number above 0 in seconds, or with its unit: 90s, 2m, 1.5h".to_owned();
    given(time, (flag, text), "a time", remedy, problems)
}

/// A number above 0 times the first of these units that stands behind it, if one does.
pub(super) fn with_unit(text: &str, units: &[(&str, f64)]) -> Option<f64> {
    let text = text.trim();
    let found = |&(unit, factor): &(&str, f64)| text.strip_suffix(unit).map(|rest| (rest, factor));
    let (number, factor) = units.iter().find_map(found).unwrap_or((text, 1.0));
    number.trim().parse().ok().filter(|x: &f64| *x > 0.0).map(|number| number * factor)
}

pub(super) fn target_error(flag: &str, text: &str, problems: &mut Problems) -> Option<f64> {
    let number = text.trim().parse().ok().filter(|x: &f64| x.is_finite() && *x > 0.0);
    let remedy = || "give a relMSE above 0, such as 0.001".to_owned();
    given(number, (flag, text), "an error", remedy, problems)
}

/// What the text behind a flag was read as; it is a problem that it is not `what` if it could not be.
pub(super) fn given<T>(
    read: Option<T>,
    (flag, text): (&str, &str),
    what: &str,
    remedy: impl FnOnce() -> String,
    problems: &mut Problems,
) -> Option<T> {
    if read.is_none() {
        problems.push(on_command_line(format!("`--{flag} {text}` is not {what}")).remedy(remedy()));
    }
    read
}

pub(super) fn on_command_line(what: String) -> Problem {
    Problem::at(Place::file("command line"), what)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        let parse = |text| time("time-limit", text, &mut Problems::default());
        for (text, seconds) in
            [("90", 90.0), ("90s", 90.0), ("0.5 m", 30.0), ("1.5h", 5400.0), ("250ms", 0.25), (" 90s ", 90.0)]
        {
            assert_eq!(parse(text), Some(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in ["", "s", "0", "-3", "1d", "1m30s", "nan", "inf", "1e300h"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }

    #[test]
    fn crops_are_four_numbers() {
        let parse = |text| crop(text, &mut Problems::default());
        assert_eq!(parse("1,2, 3,4"), Some(Window { x0: 1, y0: 2, x1: 3, y1: 4 }), "with a space");
        for text in ["", "1,2,3", "1,2,3,4,5", "-1,0,3,3", "0,0,1.5,2", "2,0,1,1", "0,0,99999999999,1"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
