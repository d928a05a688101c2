//! How far every kernel is from the truth over its extremes, and whether anything is ever not finite.
//!
//! The list is that of `tests/stability`. `cargo bench --bench stability` measures the errors at every width of this machine over the
//! grids and over random extremes, then counts results that are not finite among 10^9 evaluations, shared out evenly
//! over kernels and widths. `--record` writes `benches/record/stability.md`. Without cargo's `--bench` (as under
//! `cargo test`) the counts are a thousand times smaller.

#![expect(clippy::print_stdout, reason = "a bench prints its results")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small numbers, and roundings meant"
)]

#[path = "../tests/stability/suite/mod.rs"]
mod suite;

use specula::math::lanes::Level;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;
use suite::{Row, rows};

/// Evaluations by all kernels at all widths together.
const EVALUATIONS: usize = 1_000_000_000;

/// Points in a pool; every pass pairs its columns anew.
const POOL: usize = 1 << 14;

fn main() -> std::io::Result<()> {
    let has = |flag: &str| std::env::args().any(|word| word == flag);
    let evaluations = if has("--bench") { EVALUATIONS } else { EVALUATIONS / 1000 };
    let mut text = errors();
    text += &finite(evaluations);
    println!("{text}");
    if has("--record") {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/record/stability.md");
        std::fs::write(file, text)?;
    }
    Ok(())
}

fn errors() -> String {
    let levels = Level::available();
    let names: Vec<_> = levels.iter().map(|level| level.name()).collect();
    let mut text = format!(
        "# How far kernels are from the truth\n\nReferences of 200 bits, for the floats as they are; all extremes of the list in \
         `tests/stability` combined,\nand as many random ones, at the widths {}. Errors of vectors are relative to their length. A small \
         part of the bound\nbeside a large relative error: the bound allows for what the rounding of the arguments of a difference makes \
         of it,\nor the truth is next to nothing. `cargo bench --bench stability -- --record` renews this file.\n\n| kernel | evaluations | worst relative | worst ulp | part of the bound | \
         where | bound |\n|---|---|---|---|---|---|---|\n",
        names.join(", ")
    );
    for row in rows() {
        let mut worst = row.worst(&row.grid(), &levels);
        worst.merge(row.worst(&row.random(3, 4096), &levels));
        let at: Vec<_> = worst.at.iter().map(|x| format!("{x:.7e}")).collect();
        let _ = writeln!(
            text,
            "| {} | {} | {:.1e} | {:.3e} | {:.2} | {} ({}) | {} |",
            row.name,
            worst.evaluations,
            worst.relative,
            worst.ulp,
            worst.of_bound,
            at.join(" "),
            worst.level,
            row.says
        );
    }
    text
}

/// Counts results that are not finite, at every width.
fn finite(evaluations: usize) -> String {
    let (rows, levels) = (rows(), Level::available());
    let share = evaluations.div_ceil(rows.len() * levels.len());
    let mut text = String::from("\n## Results that are not finite\n\n| kernel |");
    for level in &levels {
        let _ = write!(text, " {} |", level.name());
    }
    let _ = write!(text, " evaluations |\n|---|{}---|\n", "---|".repeat(levels.len()));
    let (start, mut total) = (Instant::now(), 0);
    for row in &rows {
        let counts: Vec<_> = levels.iter().map(|level| not_finite(row, *level, share)).collect();
        let done: usize = counts.iter().map(|(_, done)| done).sum();
        let found: Vec<_> = counts.iter().map(|(found, _)| found.to_string()).collect();
        let _ = writeln!(text, "| {} | {} | {done} |", row.name, found.join(" | "));
        total += done;
    }
    let _ = writeln!(text, "\n{total} evaluations in {:.0} s on one thread.", start.elapsed().as_secs_f64());
    text
}

/// How many of at least `share` evaluations gave something that is not finite.
fn not_finite(row: &Row, level: Level, share: usize) -> (usize, usize) {
    let (mut found, mut done) = (0, 0);
    let grid = row.grid();
    let pool = row.random(4, POOL);
    for (mut arguments, rounds) in [(grid, 1), (pool, usize::MAX)] {
        let mut results = row.room(&arguments);
        let n = arguments[0].len();
        for _ in 0..rounds {
            (row.run)(level, &arguments, &mut results);
            found += (0..n).filter(|&i| results.iter().any(|column| !column[i].is_finite())).count();
            done += n;
            if done >= share {
                break;
            }
            row.shift(&mut arguments);
        }
    }
    (found, done)
}
