//! Single rays, packets and streams: samples per second of whole pictures, and whether the way that is taken where nobody says
//! is the fastest.
//!
//! One thread. `cargo bench --bench engines -- [--record] [part of a race's name]`. `SPECULA_ISA=avx2` and so on limits the
//! instruction sets of shading and of Embree; the record is then `engines_avx2.csv`.

#![expect(clippy::print_stdout, reason = "a bench prints its tables")]

#[path = "../tests/support/peers.rs"]
mod peers;
#[path = "support/places.rs"]
mod places;
#[path = "support/mod.rs"]
mod support;
#[path = "support/terrain.rs"]
mod terrain;

use specula::accel::embree::EmbreeAccel;
use specula::render::{Chosen, Settings, Silent, query, render_on};
use specula::scene::Scene;
use specula::scene::description::Query;
use std::cell::RefCell;
use std::num::NonZeroUsize;
use support::{Bench, Race};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// How little slower than the fastest the way that is chosen may be.
const CLOSE: f64 = 0.97;

fn main() -> Result<()> {
    let mut bench = Bench::new("engines");
    let (mut good, mut count) = (0, 0);
    for (name, place) in CASES {
        if !bench.wants(name) {
            continue;
        }
        let Some(scene) = place()? else { continue };
        let Chosen { query: chosen, .. } = query(&scene);
        let accel = EmbreeAccel::build(&scene.world, &places::embree()).expect("Embree builds");
        let samples = scene.film.width as usize * scene.film.height as usize * scene.render.spp() as usize;
        let scene = RefCell::new(scene);
        let pass = |query| {
            scene.borrow_mut().render.query = Some(query);
            let settings = Settings { threads: NonZeroUsize::new(1), ..Settings::default() };
            render_on(&scene.borrow(), &settings, &accel, &Silent).expect("a picture").statistics.samples
        };
        let mut race = Race::new(name, samples, "samples");
        for &query in Query::ALL {
            race = race.with(query.word(), move || pass(query));
        }
        let speeds = bench.run(race);
        let best = speeds.iter().copied().fold(0.0, f64::max);
        let own = Query::ALL.iter().position(|&query| query == chosen).map_or(0.0, |i| speeds[i]);
        println!("  taken: {}, {:.3} of the fastest", chosen.word(), own / best);
        count += 1;
        good += usize::from(own >= CLOSE * best);
    }
    println!("\nthe way taken is within 3 % of the fastest in {good} of {count} cases");
    bench.finish()?;
    Ok(())
}

/// Pictures by name; `None` where a file is absent.
type Case = (&'static str, fn() -> Result<Option<Scene>>);

const CASES: [Case; 10] = [
    ("paths: closed box", || places::peer("cornell", PATHS, 64)),
    ("paths: glossy balls", || places::peer("glossyrow", PATHS, 96)),
    ("paths: landscape of 1 M triangles", || places::landscape(708, FIVE, 64).map(Some)),
    ("paths: furnished room", || places::interior(FIVE, 64)),
    ("paths: shapes", || file("shapes", &["render.integrator=path", "render.max_depth=6"])),
    ("tree: hello", || file("hello", &[])),
    ("distribution: soft shadows", || file("soft_shadows", &[])),
    ("tree: glossy row", || file("glossy_row", &[])),
    ("tree: mirrors", || file("mirrors", &[])),
    ("tree: landscape of 1 M triangles", || places::landscape(708, "spp = 16\nmax_depth = 4", 96).map(Some)),
];

/// Of scenes that bring their own depth.
const PATHS: &str = "integrator = \"path\"\nspp = 16";

const FIVE: &str = "integrator = \"path\"\nspp = 16\nmax_depth = 5";

/// A scene of this repository, small.
fn file(name: &str, keys: &[&str]) -> Result<Option<Scene>> {
    let size = ["film.width=96", "film.height=54", "render.spp=16"];
    places::of_file(name, &[&size, keys].concat()).map(Some)
}
