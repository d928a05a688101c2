//! Races of ways of doing the same thing by their CPU time, printed and recorded.
//!
//! The contestants of a [`Race`] run in turn (`specula::bench::race`), in one process. Compared are ratios within a pass, to the
//! first contestant of the race; reported are the median over the passes and the spread. Absolute rates are of this machine
//! on that day.
//!
//! Arguments: `--record` also writes `benches/record/<bench>.csv` (see `record.rs`); a word restricts the races to those whose name
//! contains it; without cargo's `--bench` (as under `cargo test`) each contestant runs once, only to show that it does.

#![expect(clippy::print_stdout, reason = "a bench prints its results")]

mod record;

use cpu_time::ProcessTime;
use specula::bench::race::{Spread, interleave};
use std::convert::Infallible;
use std::fmt::Write as _;
use std::hint::black_box;

/// Passes that count; one more warms up.
const PASSES: usize = 12;

/// What a bench was asked for, and what it found.
#[derive(Debug)]
pub(crate) struct Bench {
    name: &'static str,
    record: bool,
    filter: Option<String>,
    passes: usize,
    rows: Vec<Row>,
}

/// Contestants that do the same work.
pub(crate) struct Race<'a> {
    name: String,
    /// How many things one pass handles, and what they are called: rays, samples.
    items: usize,
    unit: &'static str,
    contestants: Vec<Contestant<'a>>,
}

/// One way of doing it.
struct Contestant<'a> {
    name: String,
    /// What is known of it besides its speed.
    figures: Vec<Figure>,
    /// One pass; what it returns is only looked at to keep it from being left out.
    pass: Box<dyn FnMut() -> u64 + 'a>,
}

/// What a number is called, and the number, if there is one.
pub(crate) type Figure = (&'static str, Option<f64>);

/// What was found of one contestant.
#[derive(Debug)]
struct Row {
    race: String,
    contestant: String,
    unit: &'static str,
    items_per_s: f64,
    /// Speed relative to the first contestant.
    ratio: f64,
    ratio_spread: f64,
    figures: Vec<Figure>,
}

impl Bench {
    /// Reads the command line.
    pub(crate) fn new(name: &'static str) -> Self {
        let words: Vec<String> = std::env::args().skip(1).collect();
        let has = |flag: &str| words.iter().any(|word| word == flag);
        let filter = words.iter().find(|word| !word.starts_with('-')).cloned();
        let passes = if has("--bench") { PASSES } else { 1 };
        Self { name, record: has("--record"), filter, passes, rows: Vec::new() }
    }

    /// The same with another number of passes that count.
    #[allow(dead_code, reason = "only benches of many contestants")]
    pub(crate) fn with_passes(self, passes: usize) -> Self {
        Self { passes: self.passes.min(passes), ..self }
    }

    /// Whether a race is wanted: asked before costly preparations.
    pub(crate) fn wants(&self, race: &str) -> bool {
        self.filter.as_ref().is_none_or(|word| race.contains(word))
    }

    /// Runs a race and prints its table. Speeds relative to the first contestant; none if the race is not wanted.
    pub(crate) fn run(&mut self, mut race: Race<'_>) -> Vec<f64> {
        let mut speeds = Vec::new();
        if !self.wants(&race.name) {
            return speeds;
        }
        let Ok(seconds) = interleave(race.contestants.len(), self.passes, |turn| {
            // Everybody follows a pass of his own: where that was another's, what is in the caches tells of him.
            black_box((race.contestants[turn].pass)());
            let start = ProcessTime::now();
            black_box((race.contestants[turn].pass)());
            Ok::<_, Infallible>(start.elapsed().as_secs_f64())
        });
        println!("\n{} ({} {})", race.name, race.items, race.unit);
        for (Contestant { name, figures, .. }, times) in race.contestants.into_iter().zip(&seconds) {
            let ratios = seconds[0].iter().zip(times).map(|(first, own)| first / own);
            let Spread { median: ratio, half_iqr: ratio_spread } = Spread::of(ratios);
            let items_per_s = race.items as f64 / Spread::of(times.iter().copied()).median;
            print!("  {name:32} {:9.3} M/s   x {ratio:.3} +- {ratio_spread:.3}", items_per_s * 1e-6);
            for (what, figure) in figures.iter().filter_map(|(what, figure)| Some((what, (*figure)?))) {
                print!("   {what} {figure:.2e}");
            }
            println!();
            let (race, contestant, unit) = (race.name.clone(), name, race.unit);
            self.rows.push(Row { race, contestant, unit, items_per_s, ratio, ratio_spread, figures });
            speeds.push(ratio);
        }
        speeds
    }

    /// Writes the record, if asked for.
    pub(crate) fn finish(self) -> std::io::Result<()> {
        if !self.record {
            return Ok(());
        }
        if self.filter.is_some() {
            return Err(std::io::Error::other("a record is of all races: leave out the name of one"));
        }
        let mut text = String::from("race,contestant,unit,items_per_cpu_s,ratio,ratio_spread");
        // Of all rows alike.
        for (what, _) in self.rows.iter().take(1).flat_map(|row| &row.figures) {
            let _ = write!(text, ",{what}");
        }
        text.push('\n');
        for row in &self.rows {
            let Row { race, contestant, unit, items_per_s, ratio, ratio_spread, figures } = row;
            let _ = write!(text, "{race},{contestant},{unit},{items_per_s:.0},{ratio:.4},{ratio_spread:.4}");
            for (_, figure) in figures {
                let _ =
                    write!(text, ",{}", figure.map_or_else(String::new, |figure| format!("{figure:.3e}")));
            }
            text.push('\n');
        }
        record::record(self.name, self.passes, &text)
    }
}

impl<'a> Race<'a> {
    /// A race without contestants; names hold no commas.
    pub(crate) fn new(name: impl Into<String>, items: usize, unit: &'static str) -> Self {
        Self { name: name.into(), items, unit, contestants: Vec::new() }
    }

    /// Adds a contestant; the first is what the others are compared with.
    pub(crate) fn with(mut self, name: impl Into<String>, pass: impl FnMut() -> u64 + 'a) -> Self {
        self.contestants.push(Contestant { name: name.into(), figures: Vec::new(), pass: Box::new(pass) });
        self
    }

    /// Says what else is known of the contestant added last: the same of all of a bench.
    #[allow(dead_code, reason = "only benches that know more than speeds")]
    pub(crate) fn knowing(mut self, figures: Vec<Figure>) -> Self {
        self.contestants.last_mut().expect("a contestant").figures = figures;
        self
    }
}
