//! What presets are chosen by: curves of settings over scenes that ship, measured as `specula tradeoff` does.
//!
//! `cargo bench --bench presets -- [--record] [part of a scene's name]`. With `--record` all of it is written to `src/tradeoff/presets.json`, from
//! which the program takes its presets. Scenes are rendered small; seconds are of one thread's processor, and only ratios within a scene count. What
//! presets take from the record that is compiled in is printed at the end.
//!
//! How much is rendered follows from what is to be known. Settings are taken for an error where their bias^2 is at most a quarter of it to the end of its
//! interval: 2.5e-3 for `preview`, 2.5e-4 for `final`. Of K runs half of that interval is about t sqrt(2 / (K (K - 1))) V / sqrt(n): t is Student's of
//! K - 1 degrees, V the variance at the most samples, and n the number of pixels that carry the noise. Eight runs make it 2.36 x 0.19 V / sqrt(n) = 0.45 V /
//! sqrt(n) (three runs: 2.5); with what fewer samples say and the noise of the reference it came out as 0.02 to 0.19 V, so n is from 6 to 500 of 3600. The
//! noisiest scene, `depth_of_field`, has V = 2e-2 and 2e-3 of half an interval, so `draft` and `preview` are decided in all scenes. That takes 6 settings x
//! 8 runs x (2 + 8 + 32) + 512 = 2528 samples of 3600 pixels of 11 scenes, 100 million in all: 280 seconds of the processor. For `final` it would have to be
//! an eighth: twice the runs of four times the samples, some 35 minutes. So scenes keep their own settings there, and for `reference`.

#![expect(clippy::print_stdout, reason = "a report for whoever runs it")]

use serde_json::{Value, json};
use specula::bench::machine::Machine;
use specula::render::Silent;
use specula::tradeoff::curve::Curve;
use specula::tradeoff::design::Design;
use specula::tradeoff::kept::Run;
use specula::tradeoff::knobs::Knob;
use specula::tradeoff::presets::{self, Kind, Preset};
use specula::tradeoff::runs::{Bench, Sweep, Tally};
use specula::tradeoff::{Reference, Subject, outcomes, settings_of};
use specula::trust::Trust;
use std::num::NonZeroUsize;
use std::path::Path;

/// Scenes that are measured; others are kept for finding out whether predictions hold.
const TREES: [&str; 7] =
    ["hello", "glossy_row", "metals", "ray_tree", "soft_shadows", "depth_of_field", "frosted"];
const PATHS: [&str; 4] = ["hello", "glossy_row", "metals", "soft_shadows"];

/// Knobs that are turned, all combinations of them.
const OF_TREES: [(&str, &[&str]); 3] = [
    ("spp", &["2", "8", "32"]),
    ("sampler", &["sobol", "blue_noise", "stratified"]),
    ("min_throughput", &["1e-3", "1e-2"]),
];
const OF_PATHS: [(&str, &[&str]); 3] = [
    ("spp", &["2", "8", "32"]),
    ("sampler", &["sobol", "blue_noise", "stratified"]),
    ("clamp_indirect", &["off", "10"]),
];

const SIZE: [u32; 2] = [80, 45];
const RUNS: u32 = 8;
const REFERENCE: u32 = 512;

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Fallible<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let is_bench = words.iter().any(|word| word == "--bench");
    let is_kept = words.iter().any(|word| word == "--record");
    let wanted = words.iter().find(|word| !word.starts_with("--"));
    if is_kept && (wanted.is_some() || !is_bench) {
        return Err("a record is of all scenes: run it by `cargo bench`, without the name of one".into());
    }
    let wants = |name: &str| wanted.is_none_or(|part| name.contains(part.as_str()));
    let mut scenes = Vec::new();
    let kinds: [(Kind, &[&str], &[_]); 2] =
        [(Kind::Tree, &TREES, &OF_TREES), (Kind::Path, &PATHS, &OF_PATHS)];
    for (kind, names, knobs) in kinds {
        for name in names.iter().filter(|name| wants(name)) {
            // Under `cargo test --benches` it only shows that it runs.
            if !is_bench && !scenes.is_empty() {
                continue;
            }
            let curves = measured(name, kind, knobs, if is_bench { 1 } else { 16 })?;
            for curve in &curves {
                let name = if curve.name.is_empty() { "as the scene says" } else { &curve.name };
                println!(
                    "  {name}: bias^2 {:.2e} +-{:.1e}, {:.4} CPU s a sample, {:?}",
                    curve.found_bias2.value,
                    curve.found_bias2.half.unwrap_or(f64::INFINITY),
                    curve.pace_s,
                    curve.noise()
                );
            }
            scenes.push(json!({
                "scene": name,
                "kind": kind.word(),
                "curves": curves.iter().map(presets::curve_to_json).collect::<Vec<_>>(),
            }));
        }
    }
    if is_kept {
        write(scenes)?;
    }
    for kind in [Kind::Tree, Kind::Path] {
        for preset in Preset::ALL {
            if let Some(it) = presets::advice(kind, preset.target(), &|_| true) {
                let (what, set) = (format!("{} {}", kind.word(), preset.word()), it.set);
                println!(
                    "{what}: {set:?}, {:.2} of the time, slope {:.2}, {} scenes",
                    it.gain, it.slope, it.scenes
                );
            }
        }
    }
    Ok(())
}

/// The curves of a scene, named by what differs from what it says.
fn measured(name: &str, kind: Kind, knobs: &[(&str, &[&str])], coarser: u32) -> Fallible<Vec<Curve>> {
    println!("{} {name}", kind.word());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("toml");
    let mut overrides =
        vec![format!("film.width={}", SIZE[0] / coarser), format!("film.height={}", SIZE[1] / coarser)];
    if kind == Kind::Path {
        overrides.extend(["render.integrator=path".to_owned(), "render.max_depth=8".to_owned()]);
    }
    let (mut subject, _) = Subject::read(&path, &overrides, &Trust::default())?;
    let axes: Vec<_> = knobs
        .iter()
        .filter_map(|(knob, values)| {
            let values: Vec<String> = values.iter().map(|value| (*value).to_owned()).collect();
            Knob::of(knob).map(|knob| subject.axis(knob, &values))
        })
        .collect();
    let sweep = Sweep::new(&subject, &axes, Design::Grid, RUNS)?;
    let tally = Tally::new(&Silent, 0);
    let bench = Bench { threads: NonZeroUsize::new(1), progress: &tally };
    let settings = Reference::settings(&subject, &axes);
    let reference = Reference::render(&mut subject, settings, REFERENCE / coarser, &bench)?;
    let mut runs: Vec<Run> = Vec::new();
    let mut keep = |run: &Run| {
        runs.push(run.clone());
        Ok(())
    };
    sweep.run(&mut subject, &reference, (&[], &bench), &mut keep)?;
    let curves = Curve::all(&outcomes(sweep.points(), &runs, reference.floor()));
    let said = settings_of(subject.base());
    let is_said = |entry: &(String, String)| {
        subject.described(std::slice::from_ref(entry)).is_ok_and(|it| settings_of(&it) == said)
    };
    Ok(curves.into_iter().map(|curve| differing(curve, &is_said)).collect())
}

fn differing(mut curve: Curve, is_said: &dyn Fn(&(String, String)) -> bool) -> Curve {
    curve.set.retain(|entry| !is_said(entry));
    curve.name =
        curve.set.iter().map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ");
    curve
}

fn write(scenes: Vec<Value>) -> Fallible<()> {
    let machine = Machine::here();
    let record = json!({
        "about": "made by `cargo bench --bench presets -- --record`; read by presets.rs",
        "version": machine.build.version,
        "machine": machine.name(),
        "size": SIZE,
        "runs": RUNS,
        "reference_spp": REFERENCE,
        "scenes": scenes,
    });
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/tradeoff/presets.json");
    std::fs::write(&path, format!("{record:#}\n"))?;
    println!("wrote {}", path.display());
    Ok(())
}
