//! Single rays, packets and streams: samples per second of whole pictures, and whether the way that is taken where nobody says
//! is the fastest.
//!
//! One thread. `cargo bench --bench engines -- [--record] [part of a race's name]`. `SPECULA_ISA=avx2` and so on limits the
//! instruction set of shading.

#![expect(clippy::print_stdout, reason = "a bench prints its tables")]

#[path = "../tests/support/peers.rs"]
mod peers;
#[path = "support/pictures.rs"]
mod pictures;
#[path = "support/places.rs"]
mod places;
#[path = "support/mod.rs"]
mod support;
#[path = "support/terrain.rs"]
mod terrain;

use pictures::rendered;
use specula::error::Result;
use specula::render::{Chosen, query};
use specula::scene::Scene;
use specula::scene::description::Query;
use support::{Bench, Race};

/// How little slower than the fastest the way that is chosen may be.
const CLOSE: f64 = 0.97;

fn main() -> Result<()> {
    let mut bench = Bench::new("engines");
    let mut good = 0;
    let mut count = 0;
    for (name, place) in cases() {
        if !bench.wants(&name) {
            continue;
        }
        let Some(mut scene) = place()? else { continue };
        let Chosen { query: chosen, .. } = query(&scene);
        let scenes = Query::ALL.map(|query| {
            scene.render.query = Some(query);
            (query, scene_with(&scene, query))
        });
        let samples = scene.film.width as usize * scene.film.height as usize * scene.render.spp as usize;
        let mut race = Race::new(name.clone(), samples, "samples");
        for (query, pass) in &scenes {
            race = race.with(query.word(), pass);
        }
        let ratios = bench.run(race);
        let best = ratios.iter().copied().fold(0.0, f64::max);
        let own = scenes.iter().position(|(query, _)| *query == chosen).map_or(0.0, |i| ratios[i]);
        println!("  taken: {}, {:.3} of the fastest", chosen.word(), own / best);
        count += 1;
        good += usize::from(own >= CLOSE * best);
    }
    println!("\nthe way taken is within 3 % of the fastest in {good} of {count} cases");
    bench.finish()?;
    Ok(())
}
