//! How far it is: a bar on a terminal, a line every few seconds elsewhere.

use std::io::{self, IsTerminal as _};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::interrupt::Interrupt;
use crate::display;
use crate::film::Tile;
use crate::render::Progress;

/// Between lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Between changes of the bar.
const BAR_EVERY: Duration = Duration::from_millis(100);

/// Shows progress, and passes on that somebody asked to stop.
#[derive(Debug)]
pub(super) struct Meter {
    start: Instant,
    /// What is counted, and how many steps one of it has.
    unit: (&'static str, u64),
    display: Display,
    /// When it was shown last.
    last: Mutex<Instant>,
    interrupt: Interrupt,
}

#[derive(Debug)]
enum Display {
    None,
    Bar(ProgressBar),
    Lines,
}

impl Meter {
    /// Starts the clock; `unit` is what is counted. `quiet` shows nothing.
    pub(super) fn new(quiet: bool, unit: &'static str, interrupt: Interrupt) -> Self {
        Self::in_steps(quiet, (unit, 1), interrupt)
    }

    /// The same, told in so many steps of each unit.
    pub(super) fn in_steps(quiet: bool, unit: (&'static str, u64), interrupt: Interrupt) -> Self {
        let display = if quiet {
            Display::None
        } else if io::stderr().is_terminal() {
            Display::Bar(bar())
        } else {
            Display::Lines
        };
        Self { start: Instant::now(), unit, display, last: Mutex::new(Instant::now()), interrupt }
    }

    /// Takes the bar away.
    pub(super) fn finish(&self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Meter {
    fn drop(&mut self) {
        self.finish();
    }
}

impl Progress for Meter {
    fn advance(&self, done: u64, total: u64) {
        let every = match &self.display {
            Display::None => return,
            Display::Bar(_) => BAR_EVERY,
            Display::Lines => LINE_EVERY,
        };
        // A thread that finds another one at it leaves it to that one.
        let Ok(mut last) = self.last.try_lock() else { return };
        if last.elapsed() < every {
            return;
        }
        *last = Instant::now();
        let pace = pace([done, total], self.unit, self.start.elapsed());
        if let Display::Bar(bar) = &self.display {
            bar.set_length(total);
            bar.set_message(pace);
            bar.set_position(done);
        } else {
            tracing::info!("{:3} %, {pace}", percent(done, total));
        }
    }

    fn is_cancelled(&self) -> bool {
        self.interrupt.is_asked()
    }
}

/// A meter, and a viewer in which the picture is shown meanwhile.
#[derive(Debug)]
pub(super) struct Shown<'a> {
    pub(super) meter: &'a Meter,
    pub(super) display: Option<&'a display::Display>,
}

impl Progress for Shown<'_> {
    fn advance(&self, done: u64, total: u64) {
        self.meter.advance(done, total);
    }

    fn is_cancelled(&self) -> bool {
        self.meter.is_cancelled()
    }

    fn looks_every(&self) -> Option<Duration> {
        self.display.map(|_| display::EVERY)
    }

    fn show(&self, part: &Tile) {
        if let Some(display) = self.display {
            display.show(part);
        }
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(1);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %, {msg}") {
        bar.set_style(style);
    }
    bar
}

fn percent(done: u64, total: u64) -> u64 {
    (done.saturating_mul(100)).checked_div(total).unwrap_or(100)
}

/// Rate and remaining time, such as `1.25 Msamples/s, 1:05 left`.
#[expect(clippy::cast_precision_loss, reason = "three digits are shown")]
fn pace([done, total]: [u64; 2], (unit, steps): (&str, u64), elapsed: Duration) -> String {
    let rate = done as f64 / elapsed.as_secs_f64().max(1e-9);
    if done == 0 {
        return "starting".to_owned();
    }
    let left = Duration::try_from_secs_f64(total.saturating_sub(done) as f64 / rate).unwrap_or(Duration::MAX);
    let counted =
        if steps > 1 { format!("{} of {} {unit}, ", done / steps, total / steps) } else { String::new() };
    format!("{counted}{}{unit}/s, {} left", metric(rate / steps as f64), clock(left))
}

/// Three digits and a prefix.
pub(super) fn metric(x: f64) -> String {
    let (x, prefix) = match x {
        x if x >= 1e9 => (x / 1e9, "G"),
        x if x >= 1e6 => (x / 1e6, "M"),
        x if x >= 1e3 => (x / 1e3, "k"),
        x => (x, ""),
    };
    let digits = if x >= 100.0 {
        0
    } else if x >= 10.0 {
        1
    } else {
        2
    };
    format!("{x:.digits$} {prefix}")
}

/// `1:05`, or `2:01:05` from an hour on; rounded up, so that 0:00 is the end.
fn clock(time: Duration) -> String {
    let seconds = time.as_secs().saturating_add(u64::from(time.subsec_nanos() > 0));
    let (hours, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    if hours > 0 { format!("{hours}:{minutes:02}:{seconds:02}") } else { format!("{minutes}:{seconds:02}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pace_is_rate_and_remaining_time() {
        let text = pace([2_500_000, 10_000_000], ("samples", 1), Duration::from_secs(2));
        assert_eq!(text, "1.25 Msamples/s, 0:06 left", "a quarter in two seconds");
        assert_eq!(pace([0, 10], ("samples", 1), Duration::ZERO), "starting", "nothing known");
        let pictures = pace([2500, 10_000], ("pictures", 1000), Duration::from_secs(10));
        assert_eq!(pictures, "2 of 10 pictures, 0.25 pictures/s, 0:30 left", "two and a half");
        assert_eq!(pace([10, 10], ("pixels", 1), Duration::from_secs(1)), "10.0 pixels/s, 0:00 left", "done");
    }

    #[test]
    fn times_are_written_as_clocks() {
        assert_eq!(clock(Duration::from_millis(64_100)), "1:05", "rounded up");
        assert_eq!(clock(Duration::from_secs(7265)), "2:01:05", "hours");
        assert_eq!(clock(Duration::ZERO), "0:00", "none");
    }

    #[test]
    fn rates_have_three_digits_and_a_prefix() {
        let texts = [0.5, 12.34, 999.0, 1234.0, 56.78e6, 123.4e9].map(metric);
        assert_eq!(texts, ["0.50 ", "12.3 ", "999 ", "1.23 k", "56.8 M", "123 G"], "prefixes");
    }

    #[test]
    fn a_cancelled_meter_says_so() {
        let meter = Meter::new(true, "samples", Interrupt::default());
        assert!(!meter.is_cancelled(), "nobody asked");
        assert_eq!((percent(1, 3), percent(0, 0)), (33, 100), "percent");
    }
}
