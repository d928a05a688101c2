//! The command `plan`: what a scene contains and requires, without rendering it.

use std::fmt::Write as _;

use glam::DVec3;
use serde_json::{Value, json};

use super::args::PlanArgs;
use super::frozen::Frozen;
use super::{log, options, output};
use crate::error::{Problem, Result};
use crate::integrator::Path;
use crate::render::{self, Chosen};
use crate::scene::description::{Integrator, LightChoice};
use crate::scene::needs::capability::Capability;
use crate::scene::needs::measured::Measured;
use crate::scene::needs::{self, ChosenLights, Need, Needs, length};
use crate::scene::{Pruned, Scene};

/// Prints the plan of a scene.
pub(super) fn run(args: &PlanArgs) -> Result<()> {
    log::start(&args.log);
    let backend = args.backend.as_ref().map(|word| format!("render.backend={word}"));
    let overrides: Vec<String> = args.overrides.iter().cloned().chain(backend).collect();
    let (wanted, trust) = options::planned(args)?;
    let frozen = Frozen::read(&args.scene, &overrides, wanted, &trust)?;
    let mut warnings = frozen.all_warnings();
    warnings.extend(needs::warnings_of_triangles(&frozen.scene, &frozen.origins));
    let needs = frozen.needs();
    let text = if args.json {
        format!("{:#}\n", to_json(&frozen, &needs, &warnings))
    } else {
        to_text(&frozen, &needs, &warnings)
    };
    output::print(text.as_bytes())
}

/// Where rays come from, seen from the scene.
fn camera_distance(scene: &Scene, needs: &Needs) -> f32 {
    (scene.camera.eye(0.0) - needs.bounds.center()).length()
}

/// What of a backend the scene makes use of.
fn backend_use(scene: &Scene, needs: &Needs) -> Vec<String> {
    let has = |capability| needs.uses(capability);
    let kinds: Vec<&str> =
        Capability::GEOMETRIES.into_iter().filter(|&kind| has(kind)).map(Capability::name).collect();
    let kinds = if kinds.is_empty() { "nothing to hit".to_owned() } else { kinds.join(", ") };
    let levels = if has(Capability::Instances) || has(Capability::MovingPoses) { 2 } else { 1 };
    let is_moving = has(Capability::MovingPoses) || has(Capability::MovingVertices);
    vec![
        format!("{}: {kinds}", scene.render.backend.word()),
        format!("{levels} level{} of hierarchy", if levels == 1 { "" } else { "s" }),
        if is_moving { "motion: rays carry a moment" } else { "one moment" }.to_owned(),
        if has(Capability::CutOuts) { "filter functions" } else { "no filter functions" }.to_owned(),
        if has(Capability::Masks) { "masks" } else { "no masks" }.to_owned(),
        if has(Capability::RobustTraversal) { "watertight" } else { "fast tests of triangles" }.to_owned(),
    ]
}

/// How kernels are chosen: none is made for a scene.
fn kernels() -> String {
    let level = Path::followed_with(render::level());
    format!("{}: all capabilities are compiled in, chunks run what is needed", level.name())
}

fn to_text(frozen: &Frozen, needs: &Needs, warnings: &[Problem]) -> String {
    let scene = &frozen.scene;
    let mut text = String::new();
    let mut line = |key: &str, value: &str| _ = writeln!(text, "{key:<11}{value}");
    line("scene", &frozen.path.display().to_string());
    let size = needs.bounds.size().to_array().map(length);
    let center = needs.bounds.center().as_dvec3() + scene.origin;
    if !needs.bounds.is_empty() {
        line("extent", &format!("{} about ({}, {}, {})", size.join(" x "), center.x, center.y, center.z));
        line("camera", &format!("{} from the middle", length(camera_distance(scene, needs))));
    }
    if let Some(moved) = moved(scene) {
        line("origin", &moved);
    }
    let contents = [
        counted(needs.placements, "placement"),
        counted(needs.shapes, "shape"),
        counted(needs.primitives, "primitive"),
        counted(needs.materials, "material"),
        counted(needs.lights, "light"),
    ];
    line("contents", &contents.join(", "));
    if needs.mesh_bytes > 0 {
        line("meshes", &format!("{} bytes", needs.mesh_bytes));
    }
    if needs.textures > 0 {
        line("textures", &format!("{}, {} bytes", counted(needs.textures, "image"), needs.texture_bytes));
    }
    let film = &scene.film;
    line(
        "picture",
        &format!(
            "{} x {}, {} per pixel",
            film.width,
            film.height,
            counted(scene.render.spp() as usize, "sample")
        ),
    );
    line("backend", &backend_use(scene, needs).join("; "));
    let Chosen { query, why } = render::query(scene);
    line("query", &format!("{}: {why}", query.word()));
    if let Some(lights) = lights(scene) {
        line("lights", &lights);
    }
    line("kernels", &kernels());
    let (required, left_out): (Vec<&Need>, Vec<&Need>) =
        needs.capabilities.iter().partition(|need| need.is_used());
    text += &table(&required);
    text += &left_out_table(&left_out);
    text += &section("without effect", &frozen.pruned);
    text + &section("warnings", warnings)
}

/// Lines under a title; nothing where there are none.
fn section(title: &str, lines: &[impl std::fmt::Display]) -> String {
    let mut text = String::new();
    if !lines.is_empty() {
        let _ = writeln!(text, "\n{title}");
    }
    lines.iter().for_each(|line| _ = writeln!(text, "  {line}"));
    text
}

/// How paths choose the light that they ask, where there is a choice.
fn lights(scene: &Scene) -> Option<String> {
    let ChosenLights { choice, emitters } = ChosenLights::of(scene);
    let is_asked = scene.render.integrator == Integrator::Path && emitters > 1;
    let why = match choice {
        LightChoice::Tree => "chosen by distance, direction and intensity",
        LightChoice::Power => "chosen by power",
        LightChoice::Uniform => "all alike",
    };
    is_asked.then(|| format!("{}: {emitters} emitters, {why}", choice.word()))
}

/// Where coordinates are counted from, if not from the origin of the scene's files.
fn moved(scene: &Scene) -> Option<String> {
    let origin = scene.origin;
    (origin != DVec3::ZERO).then(|| {
        let [x, y, z] = origin.to_array();
        format!("({x}, {y}, {z}): the camera is too far out for single precision, all is counted from there")
    })
}

/// What is required.
fn table(required: &[&Need]) -> String {
    let origin = |need: &Need| match &need.first {
        _ if need.forced => "forced".to_owned(),
        Some(place) => place.to_string(),
        None => "-".to_owned(),
    };
    let width = required.iter().map(|need| origin(need).chars().count()).max().unwrap_or(0).max(14);
    let mut text =
        format!("\n{:<20}{:>10}{:>14}  {:<width$}  takes\n", "required", "count", "memory", "first asked by");
    for need in required {
        let Need { capability, count, bytes, .. } = need;
        let (origin, takes) = (origin(need), capability.takes());
        let memory = memory(bytes.taken, bytes.per_path);
        let _ =
            writeln!(text, "  {:<18}{count:>10}{memory:>14}  {origin:<width$}  {takes}", capability.name());
    }
    text
}

/// What is left out, and what that saves.
fn left_out_table(left_out: &[&Need]) -> String {
    let mut text = format!("\n{:<20}{:>14}{:>14}  instead\n", "left out", "saves memory", "and time");
    for Need { capability, bytes, time, .. } in left_out {
        let memory = memory(bytes.saved, bytes.per_path);
        let time = match time {
            Some(time) => format!("{:.1} %", saving(time)),
            None => "not measured".to_owned(),
        };
        let _ = writeln!(text, "  {:<18}{memory:>14}{time:>14}  {}", capability.name(), capability.spares());
    }
    text
}

/// The time that leaving something out saves, in parts in a hundred of that with it.
fn saving(time: &Measured) -> f64 {
    100.0 * (1.0 - time.ratio.recip())
}

/// Bytes for people; of paths, those of each.
#[expect(clippy::cast_precision_loss, reason = "for people")]
fn memory(bytes: usize, per_path: usize) -> String {
    let fixed = match bytes {
        0 => None,
        few if few < 10_000 => Some(format!("{few} B")),
        some if some < 10_000_000 => Some(format!("{:.0} kB", some as f64 * 1e-3)),
        many => Some(format!("{:.0} MB", many as f64 * 1e-6)),
    };
    match (fixed, per_path) {
        (Some(fixed), 0) => fixed,
        (None, 0) => "-".to_owned(),
        (Some(fixed), path) => format!("{fixed}+{path}/path"),
        (None, path) => format!("{path} B/path"),
    }
}

/// The plan of a scene that requires so much, for programs.
pub(super) fn to_json(frozen: &Frozen, needs: &Needs, warnings: &[Problem]) -> Value {
    let scene = &frozen.scene;
    let lights = ChosenLights::of(scene);
    let bounds = (!needs.bounds.is_empty())
        .then(|| [needs.bounds.min, needs.bounds.max].map(|p| (p.as_dvec3() + scene.origin).to_array()))
        .map(|[min, max]| json!({ "min": min, "max": max }));
    json!({
        "scene": frozen.path.display().to_string(),
        "bounds_m": bounds,
        "origin_m": scene.origin.to_array(),
        "camera_distance_m": camera_distance(scene, needs),
        "placements": needs.placements,
        "shapes": needs.shapes,
        "primitives": needs.primitives,
        "materials": needs.materials,
        "lights": needs.lights,
        "mesh_bytes": needs.mesh_bytes,
        "textures": needs.textures,
        "texture_bytes": needs.texture_bytes,
        "width": scene.film.width,
        "height": scene.film.height,
        "spp": scene.render.spp(),
        "integrator": scene.render.integrator.word(),
        "backend": { "name": scene.render.backend.word(), "uses": backend_use(scene, needs) },
        "light_choice": { "name": lights.choice.word(), "emitters": lights.emitters },
        "query": { "name": render::query(scene).query.word(), "why": render::query(scene).why },
        "kernels": kernels(),
        "capabilities": needs.capabilities.iter().map(capability).collect::<Vec<_>>(),
        "without_effect": frozen.pruned.iter().map(without_effect).collect::<Vec<_>>(),
        "warnings": warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}

fn capability(need: &Need) -> Value {
    let Need { capability, count, first, forced, bytes, time } = need;
    let means = if need.is_used() { capability.takes() } else { capability.spares() };
    let time = time.map(|time| {
        let [least, most] = time.range.map(|ratio| Measured { ratio, ..time });
        json!({
            "saves_percent": saving(&time),
            "least_percent": saving(&least),
            "most_percent": saving(&most),
            "scenes": time.scenes,
        })
    });
    json!({
        "name": capability.name(),
        "needed": *count > 0,
        "forced": forced,
        "count": count,
        "first": first.as_ref().map(ToString::to_string),
        "means": means,
        "left_out_by_not_being": capability.level().word(),
        "can_be_forced": capability.is_forceable(),
        "bytes": { "taken": bytes.taken, "saved": bytes.saved, "per_path": bytes.per_path },
        "time": time,
    })
}

fn without_effect(pruned: &Pruned) -> Value {
    let [kind, _] = pruned.kind.words();
    json!({
        "kind": kind,
        "what": pruned.what,
        "place": pruned.place.as_ref().map(ToString::to_string),
        "bytes": pruned.bytes,
    })
}

/// A number of things.
fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
