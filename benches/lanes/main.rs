//! What a lane costs: each function, and a whole shading pass, at every width this machine has.
//!
//! The functions run over arrays that stay in the first cache; the first contestant is the standard library's function,
//! one number at a time. The shading pass is that of `shading.rs`; its first contestant is the width-1 implementation.

mod functions;
mod shading;
#[path = "../support/mod.rs"]
mod support;

use specula::math::lanes::{Isa, Level, Portable};

use functions::{Apply, Function};
use shading::{Bounce, Paths};
use support::{Bench, Race};

/// Numbers in an array of the function races, and how often a pass goes over them.
const NUMBERS: usize = 2048;
const REPEATS: usize = 400;

/// Paths of the shading race, and how often a pass goes over them.
const PATHS: usize = 4096;
const BOUNCES: usize = 40;

fn main() -> std::io::Result<()> {
    let mut bench = Bench::new("lanes");
    let levels = Level::available();
    for function in Function::ALL {
        if bench.wants(function.name()) {
            bench.run(function_race(function, &levels));
        }
    }
    if bench.wants("shading") {
        bench.run(shading_race(&levels));
    }
    bench.finish()
}

fn function_race(function: Function, levels: &[Level]) -> Race<'static> {
    let a: Vec<f32> = (0..NUMBERS).map(|i| function.argument(i, NUMBERS)).collect();
    let mut race = Race::new(function.name(), NUMBERS * REPEATS, "numbers");
    let (x, mut y) = (a.clone(), vec![0.0; NUMBERS]);
    race = race.with("standard library", move || {
        for _ in 0..REPEATS {
            for (x, y) in std::hint::black_box(&x).iter().zip(&mut y) {
                *y = function.standard(*x);
            }
        }
        u64::from(y[0].to_bits())
    });
    for &level in levels {
        let (x, mut y) = (a.clone(), vec![0.0; NUMBERS]);
        race = race.with(level.name(), move || {
            for _ in 0..REPEATS {
                level.run(Apply { function, x: std::hint::black_box(&x), y: &mut y });
            }
            u64::from(y[0].to_bits())
        });
    }
    race
}

fn shading_race(levels: &[Level]) -> Race<'static> {
    let mut race = Race::new("shading", PATHS * BOUNCES, "paths");
    for &level in levels {
        let mut pass = Pass::new();
        race = race.with(level.name(), move || pass.bounces(|bounce| level.run(bounce)));
    }
    let mut pass = Pass::new();
    race.with("portable of 16", move || pass.bounces(|bounce| Portable::<16>.run(bounce)))
}

/// What one contestant of the shading race works on.
struct Pass {
    from: Paths,
    to: Paths,
    albedo: Vec<f32>,
}

impl Pass {
    fn new() -> Self {
        let from = shading::paths(PATHS);
        let albedo = (0..256_u16).map(|i| 0.3 + f32::from(i) / 512.0).collect();
        Self { to: from.clone(), from, albedo }
    }

    fn bounces(&mut self, mut run: impl FnMut(Bounce<'_>) -> usize) -> u64 {
        let mut survivors = 0;
        for _ in 0..BOUNCES {
            survivors += run(Bounce { from: &self.from, to: &mut self.to, albedo: &self.albedo });
        }
        survivors as u64
    }
}
