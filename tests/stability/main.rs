//! Every kernel over grids of extremes, against references of 200 bits: each result within its stated bound, at every width of
//! this machine. The list is in `suite`; `benches/stability.rs` prints what was found, and counts over a thousand million
//! evaluations what the sample here looks for.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small numbers, and roundings meant"
)]

#[path = "../support/one_of_each.rs"]
mod one_of_each;
mod suite;

use specula::math::Vec3;
use specula::math::lanes::Level;
use suite::{axes, rows};

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

/// All that surfaces of all kinds can be asked, with directions from grazing to upright and the ends of numbers.
#[test]
fn every_kind_of_surface_is_finite() {
    let list = one_of_each::lobes();
    assert_eq!(one_of_each::missing(&list), [""; 0], "kinds that are not in the list");
    let directions = |axis: axes::Axis| -> Vec<Vec3<f32>> {
        axis.extremes.iter().map(|d| Vec3::new(d[0], d[1], d[2])).collect()
    };
    let numbers: Vec<f32> = axes::number().extremes.concat();
    let (above, around) = (directions(axes::above()), directions(axes::around()));
    for (name, bsdf) in list {
        for &wo in &above {
            for branch in bsdf.branches(wo).into_iter().flatten() {
                let told = branch.weight.is_finite() && branch.radiance_scale.is_finite();
                assert!(told && branch.wi.length2().is_finite(), "{name} {wo:?}: {branch:?}");
            }
            for &wi in &around {
                let (glossy, matt) = (bsdf.eval_glossy(wo, wi), bsdf.eval_diffuse(wo, wi));
                let told = glossy.is_finite() && matt.is_finite() && bsdf.pdf_glossy(wo, wi).is_finite();
                assert!(told, "{name} {wo:?} {wi:?}: {glossy:?} {matt:?}");
            }
            for u2 in numbers.iter().flat_map(|u| numbers.iter().map(|v| [*u, *v])) {
                for sample in bsdf.sample_glossy(wo, u2).into_iter().flatten().filter(|sample| sample.valid) {
                    let told = sample.weight.is_finite() && sample.pdf.is_finite() && sample.pdf > 0.0;
                    assert!(told && sample.wi.length2().is_finite(), "{name} {wo:?} {u2:?}: {sample:?}");
                }
            }
        }
    }
}
