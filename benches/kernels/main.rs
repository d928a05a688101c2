//! What the parts of a path cost by width: every lobe's answer, every sampler's pairs; and the film, which adds samples one by one
//! or in runs.
//!
//! `cargo bench --bench kernels -- [--record] [part of a race's name]`. The first contestant of lobes and samplers is one lane.

mod film;
mod lobes;
#[path = "../../tests/support/one_of_each.rs"]
mod one_of_each;
mod samplers;
#[path = "../support/mod.rs"]
mod support;

use support::Bench;

fn main() -> std::io::Result<()> {
    let mut bench = Bench::new("kernels");
    let questions = lobes::Questions::new();
    for (name, lobe) in one_of_each::lobes() {
        bench.run(lobes::race(name, lobe, &questions));
    }
    for (name, kind) in samplers::KINDS {
        bench.run(samplers::race(name, kind));
    }
    for spp in [4, 64] {
        bench.run(film::race(spp));
    }
    bench.finish()
}
