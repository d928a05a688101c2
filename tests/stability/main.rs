//! Every kernel over grids of extremes, against references of 200 bits: each result within its stated bound, at every width of
//! this machine. The list is in `suite`; `benches/stability.rs` prints what was found, and counts over a thousand million
//! evaluations what the sample here looks for.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small numbers, and roundings meant"
)]

mod suite;

use specula::math::lanes::Level;
use suite::rows;

#[test]
fn every_kernel_stays_within_its_bound() {
    let levels = Level::available();
    let mut failures = Vec::new();
    for row in rows() {
        let grid = row.grid();
        let worst = row.worst(&grid, &levels);
        let text = format!(
            "{}: {:.2} of the bound ({}) at {:?}, {}; worst relative {:.2e}, {:.1} ulp",
            row.name, worst.of_bound, row.says, worst.at, worst.level, worst.relative, worst.ulp
        );
        println!("{text}");
        assert!(worst.evaluations > 0, "{}: there is a truth somewhere", row.name);
        if worst.of_bound > 1.0 {
            failures.push(text);
        }
    }
    assert!(failures.is_empty(), "{} kernels:\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn random_extremes_stay_within_the_bounds_too() {
    let levels = Level::available();
    let mut failures = Vec::new();
    for row in rows() {
        let worst = row.worst(&row.random(1, 2048), &levels);
        if worst.of_bound > 1.0 {
            failures.push(format!("{}: {worst:?}", row.name));
        }
    }
    assert!(failures.is_empty(), "{} kernels:\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn everything_is_finite() {
    let mut failures = Vec::new();
    for row in rows() {
        for arguments in [row.grid(), row.random(2, 1 << 14)] {
            for level in Level::available() {
                let mut results = row.room(&arguments);
                (row.run)(level, &arguments, &mut results);
                let at =
                    (0..arguments[0].len()).find(|&i| results.iter().any(|column| !column[i].is_finite()));
                if let Some(i) = at {
                    let point: Vec<f32> = arguments.iter().map(|column| column[i]).collect();
                    failures.push(format!("{} at {point:?}, {}", row.name, level.name()));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{} kernels:\n{}", failures.len(), failures.join("\n"));
}
