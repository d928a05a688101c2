//! Outcomes as text.

use super::{NOTES, Report, agreements, name, rate, threads, ways};
use crate::bench::agreement::Difference;
use crate::bench::machine::Machine;
use crate::bench::outcome::{Outcome, Rate};
use crate::bench::query::Mode;
use std::fmt::Write as _;

/// Rows of words; the first is the heading. The first column is flush left.
pub(crate) struct Grid(pub(crate) Vec<Vec<String>>);

impl Grid {
    pub(crate) fn new<S: Into<String>>(heading: impl IntoIterator<Item = S>) -> Self {
        Self(vec![heading.into_iter().map(Into::into).collect()])
    }

    pub(crate) fn text(&self) -> String {
        let columns = self.0.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            let cells = self.0.iter().filter_map(move |row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let mut text = String::new();
        for row in &self.0 {
            for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
                let _ = if column == 0 {
                    write!(text, "{cell:<width$}")
                } else {
                    write!(text, "  {cell:>width$}")
                };
            }
            text.truncate(text.trim_end().len());
            text.push('\n');
        }
        text
    }
}

impl Report {
    /// For people: builds, rates and differing answers of each scene.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = place(&self.machine);
        for outcome in &self.outcomes {
            text += &scene(outcome);
        }
        text.push('\n');
        NOTES.iter().for_each(|note| _ = writeln!(text, "{note}"));
        text
    }
}

/// Where figures are from, in two lines.
pub(crate) fn place(machine: &Machine) -> String {
    let build = machine.build;
    let mut text = format!("{}, {}", machine.name(), machine.system);
    if let Some(load) = machine.load {
        let _ = write!(text, ", load {load:.2}");
    }
    let commit = build.commit.map_or_else(String::new, |commit| format!(" ({commit})"));
    let _ =
        writeln!(text, "\nspecula {}{commit}, {}, opt-level {}", build.version, build.rustc, build.opt_level);
    text
}

fn scene(outcome: &Outcome) -> String {
    let mut text = format!("\n{}: {} primitives", outcome.scene, outcome.primitives);
    if let Some(file) = &outcome.replayed {
        let _ = write!(text, ", rays of {file}");
    }
    text.push('\n');
    let fields =
        outcome.fields.iter().map(|field| format!("{} {} ({} hit)", field.class, field.rays, field.hits));
    let _ = writeln!(text, "rays: {}", fields.collect::<Vec<_>>().join(", "));
    let _ = write!(text, "\n{}", builds(outcome));
    for mode in Mode::ALL {
        for threads in threads(outcome) {
            let on = if threads == 1 {
                "1 thread, Mrays per CPU s".to_owned()
            } else {
                format!("{threads} threads, Mrays/s")
            };
            let _ =
                write!(text, "\n{}", rates(outcome, mode, threads, &format!("{} hits, {on}", mode.word())));
        }
    }
    for mode in Mode::ALL {
        let _ = write!(text, "\n{}", differing(outcome, mode));
    }
    text
}

fn builds(outcome: &Outcome) -> String {
    let counts = outcome.buildings.first().map_or_else(Vec::new, |building| building.times.clone());
    let mut heading = vec!["build".to_owned()];
    for time in counts {
        let on = if time.threads == 1 { "1 thread".to_owned() } else { format!("{} threads", time.threads) };
        heading.extend([format!("{on} CPU s"), format!("{on} wall s")]);
    }
    heading.extend(["MB", "bytes/primitive", "isa", "library"].map(str::to_owned));
    let mut grid = Grid::new(heading);
    for building in &outcome.buildings {
        let mut row = vec![building.contestant.name()];
        for time in &building.times {
            row.extend([time.cpu_s, time.wall_s].map(|s| format!("{:.4} ±{:.4}", s.median, s.half_iqr)));
        }
        #[expect(clippy::cast_precision_loss, reason = "three digits are shown")]
        let (bytes, primitives) = (building.bytes as f64, outcome.primitives.max(1) as f64);
        row.extend([format!("{:.2}", bytes * 1e-6), format!("{:.1}", bytes / primitives)]);
        row.extend([building.isa.clone(), building.version.clone()]);
        grid.0.push(row);
    }
    grid.text()
}

fn rates(outcome: &Outcome, mode: Mode, threads: usize, title: &str) -> String {
    let mut grid =
        Grid::new(std::iter::once(title).chain(outcome.fields.iter().map(|field| field.class.as_str())));
    for way in ways(outcome) {
        let mut row = vec![name(outcome, way)];
        row.extend(
            (0..outcome.fields.len())
                .map(|field| rate(outcome, way, mode, field, threads).map_or_else(String::new, cell)),
        );
        grid.0.push(row);
    }
    grid.text()
}

fn cell(rate: &Rate) -> String {
    match rate.scaling {
        None => format!("{:.3} ±{:.3}", rate.per_cpu_s.median * 1e-6, rate.per_cpu_s.half_iqr * 1e-6),
        Some(scaling) => format!("{:.3} x{:.2}", rate.per_s.median * 1e-6, scaling.median),
    }
}

/// Only ways that differ at all.
fn differing(outcome: &Outcome, mode: Mode) -> String {
    let title = format!("{} hits, answers", mode.word());
    let heading = [title.as_str(), "rays"].into_iter().chain(Difference::ALL.map(Difference::word));
    let mut grid = Grid::new(heading.chain(["first wrong"]));
    let rays: usize = outcome.fields.iter().map(|field| field.rays).sum();
    let all = ways(outcome);
    for &way in &all {
        let of = |difference| agreements(outcome, way, mode).map(|it| it.tally.of(difference)).sum::<u64>();
        let counts = Difference::ALL.map(of);
        let first = agreements(outcome, way, mode).find_map(|it| Some((it.field, it.tally.first_wrong()?)));
        let first = first.map(|(field, ray)| format!("{} {ray}", outcome.fields[field].class));
        if counts.iter().any(|&count| count > 0) {
            let counts = counts.iter().map(u64::to_string);
            let row = [name(outcome, way), rays.to_string()].into_iter().chain(counts).chain(first);
            grid.0.push(row.collect());
        }
    }
    let agreeing = all.len() + 1 - grid.0.len();
    format!("{}{agreeing} of {} ways of asking answer as the truth does\n", grid.text(), all.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cells() {
        let mut grid = Grid::new(["a", "b"]);
        grid.0.push(vec!["long".to_owned(), "1 ±2".to_owned()]);
        assert_eq!(grid.text(), "a        b\nlong  1 ±2\n", "aligned");
    }
}
