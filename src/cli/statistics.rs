//! What happened, for files: metadata of a picture, and statistics as JSON.

use std::time::Duration;

use serde_json::{Value, json};

use super::command::Rendering;
use super::frozen::Frozen;
use super::options::RenderOptions;
use crate::bench::machine;
use crate::film::{Film, SampleId, cryptomatte};
use crate::integrator::Counters;
use crate::math::lanes::Level;
use crate::render::{self, Estimate, Phase, Rendered};
use crate::scene::Scene;
use crate::scene::description::{FuzzyBy, Integrator, Knob, Render};
use crate::scene::needs::ChosenLights;

/// How long each part took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Times {
    /// Reading the scene and its files.
    pub(super) load: Phase,
    /// Writing the pictures.
    pub(super) write: Phase,
}

/// The metadata of a picture: what it shows and how it was made.
pub(super) fn attributes(frozen: &Frozen, rendered: &Rendered, load: Phase) -> Vec<(String, String)> {
    let scene = &frozen.scene;
    let settings = &scene.render;
    let statistics = &rendered.statistics;
    let [least, most] = rendered.film.samples_of_pixels();
    let mut entries = vec![
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("scene_hash", frozen.hash.clone()),
        ("integrator", settings.integrator.word().to_owned()),
        ("spp", most.to_string()),
        ("samples", range(rendered)),
        ("ended_by", statistics.ended.word().to_owned()),
        ("seed", settings.seed.to_string()),
        ("sampler", settings.sampler.word().to_owned()),
        ("filter", scene.film.filter.word().to_owned()),
        ("max_depth", settings.max_depth.to_string()),
        ("min_throughput", settings.min_throughput.to_string()),
        ("roulette", settings.roulette.to_string()),
        ("clamp_indirect", settings.clamp_indirect.to_string()),
        ("fresnel", settings.fresnel.word().to_owned()),
        ("glossy", settings.glossy.word().to_owned()),
        ("backend", statistics.backend.clone()),
        ("isa", statistics.isa.clone()),
        ("lanes", lanes(render::shading(scene))),
        ("threads", statistics.threads.to_string()),
        ("time_load_s", seconds(load.wall).to_string()),
        ("time_build_s", seconds(statistics.build.wall).to_string()),
        ("time_render_s", seconds(statistics.render.wall).to_string()),
        ("cpu_render_s", seconds(statistics.render.cpu).to_string()),
        ("non_finite_samples", rendered.film.non_finite().count().to_string()),
    ];
    if least < most {
        entries
            .extend([("samples_min", least.to_string()), ("samples_mean", mean(&rendered.film).to_string())]);
    }
    if let Some(Estimate { error, bound }) = statistics.estimate {
        entries
            .extend([("estimated_relmse", error.to_string()), ("estimated_relmse_bound", bound.to_string())]);
    }
    entries.extend(knobs(scene));
    entries.push(("query", render::query(scene).query.word().to_owned()));
    if settings.glossy == FuzzyBy::TwoPass {
        entries.push(("fuzzy", settings.fuzzy.to_json().to_string()));
        entries.push(("exposure_ev", scene.film.exposure_ev.to_string()));
        entries.push(("tone", scene.film.tone.word().to_owned()));
        entries.push(("filter_lanes", lanes(render::level())));
        entries.push(("cpu_filter_s", seconds(statistics.filter.cpu).to_string()));
    }
    if settings.clamp_indirect != Knob::Off {
        entries.push(("clamped_part", statistics.counters.clamped_part().to_string()));
    }
    if settings.integrator == Integrator::View {
        entries.push(("view", settings.view.word().to_owned()));
    }
    entries.extend(frame(frozen));
    entries.extend(peak_memory().map(|bytes| ("peak_memory_bytes", bytes.to_string())));
    entries.push(("plan", frozen.plan().to_string()));
    let entries = entries.into_iter().map(|(key, value)| (format!("specula:{key}"), value));
    entries.chain(names(&rendered.film)).collect()
}

/// Which frame of a sequence it is.
fn frame(frozen: &Frozen) -> impl Iterator<Item = (&'static str, String)> {
    let entries =
        |(frame, time_s): (i32, f64)| [("frame", frame.to_string()), ("frame_time_s", time_s.to_string())];
    frozen.frame.into_iter().flat_map(entries)
}

/// An instruction set of ours and how many lanes it has: `avx512 x 16`.
fn lanes(level: Level) -> String {
    format!("{} x {}", level.name(), level.width())
}

/// What paths alone, or ray trees alone, are told.
fn knobs(scene: &Scene) -> Vec<(&'static str, String)> {
    let settings = &scene.render;
    let (is_path, is_tree) = (settings.integrator == Integrator::Path, is_tree(settings));
    let of_paths = || {
        let choice = ChosenLights::of(scene).choice;
        vec![
            ("light_choice", choice.word().to_owned()),
            ("direct", settings.direct.word().to_owned()),
            ("path_splits", settings.path_splits.to_string()),
        ]
    };
    let of_trees = || {
        vec![
            ("light_samples", settings.light_samples().to_string()),
            ("glossy_samples", settings.glossy_samples().to_string()),
            ("split_depth", settings.split_depth.to_string()),
        ]
    };
    if is_path {
        of_paths()
    } else if is_tree {
        of_trees()
    } else {
        Vec::new()
    }
}

/// Whether hits are split, as in ray trees alone.
fn is_tree(settings: &Render) -> bool {
    matches!(settings.integrator, Integrator::Whitted | Integrator::Distribution)
}

/// Which samples pixels have at most.
fn range(rendered: &Rendered) -> String {
    let (first, [_, most]) = (rendered.statistics.first, rendered.film.samples_of_pixels());
    format!("{first}..{}", first + most)
}

/// What numbers in a picture are called.
fn names(film: &Film) -> Vec<(String, String)> {
    let mut entries = Vec::new();
    for &aov in film.layout().aovs() {
        let names = film.names().of(aov);
        if let Some(layer) = aov.matte_layer() {
            entries.extend(cryptomatte::attributes(layer, names));
        } else if aov.is_of_ids() {
            // Numbers count from 1.
            entries.push((format!("specula:{}", aov.name()), json!(names).to_string()));
        }
    }
    entries
}

/// Everything counted and timed.
pub(super) fn report(options: &RenderOptions, frozen: &Frozen, rendered: &Rendered, times: Times) -> Value {
    let mut report = counted(options, frozen, rendered, times);
    if let Some((frame, time_s)) = frozen.frame {
        report["frame"] = frame.into();
        report["frame_time_s"] = time_s.into();
    }
    report
}

/// The same but for the frame.
fn counted(options: &RenderOptions, frozen: &Frozen, rendered: &Rendered, times: Times) -> Value {
    let scene = &frozen.scene;
    let settings = &scene.render;
    let is_tree = is_tree(settings);
    let statistics = &rendered.statistics;
    let counters = statistics.counters;
    let [least, most] = rendered.film.samples_of_pixels();
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": options.scene.display().to_string(),
        "scene_hash": frozen.hash,
        "outputs": options.outputs.iter().map(|o| o.path.display().to_string()).collect::<Vec<_>>(),
        "integrator": settings.integrator.word(),
        "fresnel": settings.fresnel.word(),
        "glossy": settings.glossy.word(),
        "direct": (settings.integrator == Integrator::Path).then(|| settings.direct.word()),
        "path_splits": (settings.integrator == Integrator::Path).then_some(settings.path_splits),
        "light_samples": is_tree.then(|| settings.light_samples()),
        "glossy_samples": is_tree.then(|| settings.glossy_samples()),
        "split_depth": is_tree.then_some(settings.split_depth),
        "backend": statistics.backend,
        "isa": statistics.isa,
        "lanes": lanes(render::shading(scene)),
        "filter_lanes": (settings.glossy == FuzzyBy::TwoPass).then(|| lanes(render::level())),
        "query": render::query(scene).query.word(),
        "threads": statistics.threads,
        "width": scene.film.width,
        "height": scene.film.height,
        "crop": rendered.film.window().corners(),
        "spp": most,
        "sample_range": [statistics.first, statistics.first + most],
        "samples_per_pixel": { "min": least, "mean": mean(&rendered.film), "max": most },
        "ended_by": statistics.ended.word(),
        "time_limit_s": options.limits.time.map(seconds),
        "target_error": options.limits.error,
        "estimated_error": statistics.estimate.map(|it| json!({ "relmse": it.error, "bound": it.bound })),
        "seed": settings.seed,
        "phases": {
            "load": phase(times.load),
            "build": phase(statistics.build),
            "render": phase(statistics.render),
            "filter": phase(statistics.filter),
            "write": phase(times.write),
        },
        "samples": statistics.samples,
        "samples_per_s": rate(statistics.samples, statistics.render.wall),
        "rays": rays(&counters),
        "rays_per_s": rate(counters.rays(), statistics.render.wall),
        "pruned": pruned(&counters),
        "clamped": clamped(scene, rendered),
        "peak_rss_bytes": peak_memory(),
        "bvh_bytes": statistics.hierarchy_bytes,
        "texture_bytes": scene.texture_bytes(),
        "non_finite": {
            "count": rendered.film.non_finite().count(),
            "first": rendered.film.non_finite().first().iter().map(|&s| sample(options, scene, s)).collect::<Vec<_>>(),
        },
        "plan": frozen.plan(),
    })
}

/// How many rays of each kind there were.
pub(super) fn rays(counters: &Counters) -> Value {
    json!({
        "camera": counters.camera,
        "reflected": counters.reflected,
        "refracted": counters.refracted,
        "glossy": counters.glossy,
        "bounced": counters.bounced,
        "shadow": counters.shadow,
        "hidden": counters.hidden,
        "total": counters.rays(),
    })
}

/// How many branches were not followed, and why.
pub(super) fn pruned(counters: &Counters) -> Value {
    json!({
        "by_depth": counters.cut_by_depth,
        "by_attenuation": counters.cut_by_attenuation,
        "by_roulette": counters.cut_by_roulette,
    })
}

/// How many samples a pixel has on average.
#[expect(clippy::cast_precision_loss, reason = "a mean")]
pub(super) fn mean(film: &Film) -> f64 {
    film.samples() as f64 / film.window().area() as f64
}

/// What a limit on indirect light took away, if there was one: the mean luminance of a sample, and the part of all light.
fn clamped(scene: &Scene, rendered: &Rendered) -> Option<Value> {
    let limit = scene.render.clamp_indirect.value()?;
    let statistics = &rendered.statistics;
    Some(clamped_by(f64::from(limit), &statistics.counters, statistics.samples))
}

/// What that limit took away of so many samples.
#[expect(clippy::cast_precision_loss, reason = "a mean")]
pub(super) fn clamped_by(limit: f64, counters: &Counters, samples: u64) -> Value {
    let luminance = counters.clamped / samples.max(1) as f64;
    json!({ "limit": limit, "luminance": luminance, "part": counters.clamped_part() })
}

/// How many samples pixels have, in words.
pub(super) fn per_pixel(rendered: &Rendered) -> String {
    let [least, most] = rendered.film.samples_of_pixels();
    let samples = |n: u32| if n == 1 { "1 sample".to_owned() } else { format!("{n} samples") };
    if least == most {
        return samples(most);
    }
    format!("{least} to {}, {:.1} on average,", samples(most), mean(&rendered.film))
}

fn sample(options: &RenderOptions, scene: &Scene, sample: SampleId) -> Value {
    let command = replay(&Rendering::of(options), replayed_spp(options, scene), sample);
    json!({ "pixel": [sample.x, sample.y], "index": sample.index, "command": command })
}

/// How many samples there were to be at most, where the scene does not say.
pub(super) fn replayed_spp(options: &RenderOptions, scene: &Scene) -> Option<u32> {
    (scene.render.spp.is_none() && !options.limits.is_none()).then_some(render::MOST)
}

/// The command that renders that sample's pixel of a picture again, and nothing else; with `spp` samples, where it is not for the scene to
/// say.
pub(super) fn replay(of: &Rendering<'_>, spp: Option<u32>, sample: SampleId) -> String {
    let SampleId { x, y, .. } = sample;
    let spp = spp.map(|spp| format!("--spp={spp}"));
    let pixel = ["--crop".to_owned(), format!("{x},{y},{},{}", x + 1, y + 1)];
    of.command(spp.into_iter().chain(pixel).chain(["-o".to_owned(), "pixel.exr".to_owned()]))
}

pub(super) fn phase(phase: Phase) -> Value {
    json!({ "wall_s": seconds(phase.wall), "cpu_s": seconds(phase.cpu) })
}

/// Seconds to the microsecond.
pub(super) fn seconds(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e6).round() / 1e6
}

/// How many a second; none in no time.
#[expect(clippy::cast_precision_loss, reason = "a rate")]
pub(super) fn rate(count: u64, time: Duration) -> Option<f64> {
    (!time.is_zero()).then(|| count as f64 / time.as_secs_f64())
}

/// The most memory that was resident at any time, in bytes, where the system tells.
fn peak_memory() -> Option<u64> {
    machine::bytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmHWM")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trust::Trust;
    use std::path::Path;

    #[test]
    fn a_replay_command_repeats_the_overrides_and_crops_to_the_pixel() {
        let options = RenderOptions {
            overrides: vec!["render.spp=4".to_owned(), "a.b='x y'".to_owned()],
            frame: Some(-2),
            ..RenderOptions::of(Path::new("my scenes/a.toml"), Trust::default())
        };
        let pixel = SampleId { y: 5, x: 3, index: 1 };
        let command = replay(&Rendering::of(&options), None, pixel);
        let wanted = r"specula render 'my scenes/a.toml' -D render.spp=4 -D 'a.b='\''x y'\''' --frames=-2 --crop 3,5,4,6 -o pixel.exr";
        assert_eq!(command, wanted, "quoted for a shell");
        let elsewhere = Rendering { folder: Path::new("a b"), ..Rendering::of(&options) };
        assert_eq!(replay(&elsewhere, None, pixel), format!("cd 'a b' && {wanted}"), "in another folder");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn peak_memory_covers_what_was_touched() {
        let before = peak_memory().expect("told");
        let touched = vec![1_u8; 64 << 20];
        assert!(touched.iter().map(|&x| u64::from(x)).sum::<u64>() == 64 << 20, "touched");
        assert!(peak_memory().expect("told") >= before.max(64 << 20), "{before}");
    }

    #[test]
    fn rates_need_time() {
        assert_eq!(rate(5, Duration::ZERO), None, "no time");
        assert_eq!(rate(5, Duration::from_secs(2)), Some(2.5), "two seconds");
    }
}
