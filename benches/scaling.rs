//! How cost grows: with triangles, with pixels, and how rates grow with threads.
//!
//! Paths on Embree, rays asked for as where nobody says. `cargo bench --bench scaling -- [--record]` also writes `scaling.csv` and
//! `scaling.svg` of `benches/record`; with `threads`, `pixels` or `triangles` only that part is shown; without cargo's `--bench` small pictures are made once, only to show that it runs. Costs are
//! CPU time of one thread, the cases in turn. Speed by threads is by the clock and wants a machine that does nothing else: what others
//! used meanwhile is told beside it.

#![expect(clippy::print_stdout, reason = "a bench prints its tables")]

#[path = "support/loglog.rs"]
mod loglog;
#[path = "../tests/support/peers.rs"]
mod peers;
#[path = "support/places.rs"]
mod places;
#[path = "support/record.rs"]
mod record;
#[path = "support/terrain.rs"]
mod terrain;

use cpu_time::ProcessTime;
use loglog::{Curve, Panel};
use specula::accel::Accel;
use specula::accel::embree::EmbreeAccel;
use specula::bench::machine::Machine;
use specula::bench::race::{Spread, interleave};
use specula::render::{Settings, Silent, render_on};
use specula::scene::Scene;
use std::fmt::Write as _;
use std::num::NonZeroUsize;
use std::time::Instant;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Passes that count; one more warms up.
const PASSES: usize = 9;

/// One number of the record.
struct Row {
    against: &'static str,
    at: f64,
    what: &'static str,
    value: Spread,
}

/// What was found, printed as it comes.
#[derive(Default)]
struct Found(Vec<Row>);

impl Found {
    fn note(&mut self, (against, at): (&'static str, f64), what: &'static str, value: Spread) {
        println!("{against:22} {at:10}  {what:34} {:12.4} +- {:.4}", value.median, value.half_iqr);
        self.0.push(Row { against, at, what, value });
    }

    fn curve(&self, against: &str, what: &str, label: &str) -> Curve {
        let rows = self.0.iter().filter(|row| row.against == against && row.what == what);
        Curve { label: label.to_owned(), points: rows.map(|row| [row.at, row.value.median]).collect() }
    }

    fn table(&self) -> String {
        let mut table = String::from("against,at,what,value,spread\n");
        for Row { against, at, what, value: Spread { median, half_iqr } } in &self.0 {
            writeln!(table, "{against},{at},{what},{median:.5},{half_iqr:.5}").expect("memory");
        }
        table
    }
}

/// A scene ready for rays.
struct Case {
    at: f64,
    scene: Scene,
    accel: EmbreeAccel,
}

impl Case {
    fn new(at: f64, scene: Scene) -> Result<Self> {
        let accel = EmbreeAccel::build(&scene.world, &places::embree())?;
        Ok(Self { at, scene, accel })
    }
}

/// What a picture took.
struct Took {
    samples: f64,
    rays: f64,
    cpu_s: f64,
    wall_s: f64,
    /// Processors that other programs kept busy, on average.
    others: Option<f64>,
}

/// Makes a picture with so many threads, all of the machine's if absent.
fn take(case: &Case, threads: Option<NonZeroUsize>) -> specula::error::Result<Took> {
    let (busy, wall, cpu) = (busy_s(), Instant::now(), ProcessTime::now());
    let rendered =
        render_on(&case.scene, &Settings { threads, ..Settings::default() }, &case.accel, &Silent)?;
    let (wall_s, cpu_s) = (wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
    let others = busy.zip(busy_s()).map(|(from, to)| ((to - from - cpu_s) / wall_s).max(0.0));
    let statistics = rendered.statistics;
    let [samples, rays] = [statistics.samples, statistics.counters.rays()].map(|count| count as f64);
    Ok(Took { samples, rays, cpu_s, wall_s, others })
}

/// Seconds in which the machine's processors worked, all programs together and what other machines took of them; where the system
/// tells, in hundredths (`proc_stat(5)`).
fn busy_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/stat").ok()?;
    let counts: Vec<f64> = text.lines().next()?.split_whitespace().skip(1).flat_map(str::parse).collect();
    let [user, nice, system, _idle, _wait, interrupt, softly, stolen, ..] = counts[..] else { return None };
    Some((user + nice + system + interrupt + softly + stolen) * 0.01)
}

/// Costs of one thread, all cases in turn.
fn costs(against: &'static str, cases: &[Case], passes: usize, found: &mut Found) -> Result<()> {
    let took = interleave(cases.len(), passes, |turn| take(&cases[turn], NonZeroUsize::new(1)))?;
    for (Case { at, .. }, took) in cases.iter().zip(&took) {
        let of = |value: fn(&Took) -> f64| Spread::of(took.iter().map(value));
        found.note((against, *at), "CPU ns per sample", of(|took| took.cpu_s / took.samples * 1e9));
        found.note((against, *at), "CPU ns per ray", of(|took| took.cpu_s / took.rays * 1e9));
        found.note((against, *at), "CPU s of the picture", of(|took| took.cpu_s));
        found.note((against, *at), "rays per sample", of(|took| took.rays / took.samples));
    }
    Ok(())
}

/// Of the landscape.
const PATHS: &str = "integrator = \"path\"\nspp = 16\nmax_depth = 5";

fn by_triangles((is_bench, passes): (bool, usize), found: &mut Found) -> Result<()> {
    let against = "triangles";
    let (cells, size): (&[u32], _) =
        if is_bench { (&[22, 71, 224, 707, 2236], 128) } else { (&[10, 20], 16) };
    let mut cases = Vec::new();
    for &cells in cells {
        let at = 2.0 * f64::from(cells).powi(2);
        let mut case = Case::new(at, places::landscape(cells, PATHS, size)?)?;
        let mut times = Vec::new();
        for _ in 0..passes {
            let (wall, cpu) = (Instant::now(), ProcessTime::now());
            case.accel = EmbreeAccel::build(&case.scene.world, &places::embree())?;
            times.push((cpu.elapsed().as_secs_f64(), wall.elapsed().as_secs_f64()));
        }
        found.note((against, at), "CPU s of the build", Spread::of(times.iter().map(|(cpu, _)| *cpu)));
        found.note((against, at), "wall s of the build", Spread::of(times.iter().map(|(_, wall)| *wall)));
        let bytes = case.accel.bytes() as f64 / at;
        found.note((against, at), "bytes of hierarchy per triangle", Spread { median: bytes, half_iqr: 0.0 });
        cases.push(case);
    }
    costs(against, &cases, passes, found)
}

/// The closed box that other renderers know; a landscape of a hundred thousand triangles where it is absent.
fn place(spp: u32, size: u32) -> Result<Scene> {
    let render = format!("integrator = \"path\"\nspp = {spp}");
    match places::peer("cornell", &render, size)? {
        Some(scene) => Ok(scene),
        None => places::landscape(224, &format!("{render}\nmax_depth = 5"), size),
    }
}

fn by_pixels((is_bench, passes): (bool, usize), found: &mut Found) -> Result<()> {
    let sides: &[u32] = if is_bench { &[64, 128, 256, 512, 1024] } else { &[8, 16] };
    let case = |&side: &u32| Case::new(f64::from(side).powi(2), place(4, side)?);
    let cases = sides.iter().map(case).collect::<Result<Vec<_>>>()?;
    costs("pixels", &cases, passes, found)
}

fn by_threads((is_bench, passes): (bool, usize), found: &mut Found) -> Result<()> {
    // Seconds of work, beside which a tile that comes last is nothing.
    let (size, spp) = if is_bench { (512, 32) } else { (16, 1) };
    let long = format!("integrator = \"path\"\nspp = {}\nmax_depth = 5", 4 * spp);
    let all = Machine::here().processors;
    for (against, scene) in [
        ("threads in a box", place(spp, size)?),
        ("threads in a landscape", places::landscape(707, &long, size / 2)?),
    ] {
        let case = Case::new(all as f64, scene)?;
        let took = interleave(2, passes, |turn| take(&case, NonZeroUsize::new([1, all][turn])))?;
        let rate = |took: &Took| took.rays / took.wall_s;
        let pairs: Vec<_> = took[0].iter().zip(&took[1]).collect();
        let gains = || pairs.iter().map(|(one, all)| rate(all) / rate(one));
        let disturbed =
            pairs.iter().map(|(one, all)| one.others.unwrap_or(0.0).max(all.others.unwrap_or(0.0)));
        let quietest = disturbed.zip(gains()).min_by(|a, b| a.0.total_cmp(&b.0));
        let alone = |median| Spread { median, half_iqr: 0.0 };
        let at = (against, case.at);
        found.note(at, "speed by the clock; median", Spread::of(gains()));
        found.note(at, "speed by the clock; best pair", alone(gains().fold(0.0, f64::max)));
        if let Some((others, gain)) = quietest {
            found.note(at, "speed by the clock; quietest pair", alone(gain));
            found.note(at, "processors others used meanwhile", alone(others));
        }
        found.note(at, "processors kept busy", Spread::of(took[1].iter().map(|all| all.cpu_s / all.wall_s)));
        let per_ray = pairs.iter().map(|(one, all)| (all.cpu_s / all.rays) / (one.cpu_s / one.rays));
        found.note(at, "CPU per ray over that of one thread", Spread::of(per_ray));
        found.note(
            at,
            "Mrays/s by the clock; one thread",
            Spread::of(pairs.iter().map(|(one, _)| rate(one) * 1e-6)),
        );
        found.note(
            at,
            "Mrays/s by the clock; all",
            Spread::of(pairs.iter().map(|(_, all)| rate(all) * 1e-6)),
        );
    }
    Ok(())
}

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let has = |flag: &str| words.iter().any(|word| word == flag);
    let kind @ (_, passes) = if has("--bench") { (true, PASSES) } else { (false, 1) };
    let wants = |part: &str| words.iter().all(|word| word.starts_with('-') || part.contains(word));
    let mut found = Found::default();
    if wants("threads") {
        by_threads(kind, &mut found)?;
    }
    if wants("pixels") {
        by_pixels(kind, &mut found)?;
    }
    if wants("triangles") {
        by_triangles(kind, &mut found)?;
    }
    if words.iter().any(|word| !word.starts_with('-')) {
        return Ok(()); // records are of the whole
    }
    let panel = |title: &str, axes, against, curves: &[[&str; 2]]| Panel {
        title: title.to_owned(),
        axes,
        curves: curves.iter().map(|[what, label]| found.curve(against, what, label)).collect(),
    };
    let panels = [
        panel(
            "Paths over a landscape",
            ["triangles", "CPU ns"],
            "triangles",
            &[["CPU ns per sample", "per sample"], ["CPU ns per ray", "per ray"]],
        ),
        panel(
            "Build",
            ["triangles", "s"],
            "triangles",
            &[["CPU s of the build", "CPU"], ["wall s of the build", "clock"]],
        ),
        panel(
            "Pictures of four samples a pixel",
            ["pixels", "CPU s"],
            "pixels",
            &[["CPU s of the picture", "picture"]],
        ),
    ];
    for curve in panels.iter().flat_map(|panel| &panel.curves) {
        println!("slope of {}: {:.3}", curve.label, curve.slope());
    }
    if has("--record") {
        record::record("scaling", passes, &found.table())?;
        std::fs::write(record::place("scaling.svg"), loglog::svg(&panels)?)?;
    }
    Ok(())
}
