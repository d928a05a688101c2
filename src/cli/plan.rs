//! The command `plan`: what a scene contains and requires, without rendering it.

use std::fmt::Write as _;

use glam::DVec3;
use serde_json::{Value, json};

use super::args::PlanArgs;
use super::frozen::Frozen;
use super::options::Trusted;
use super::{log, output};
use crate::error::{Problem, Result};
use crate::integrator::ChosenLights;
use crate::render::{self, Chosen};
use crate::scene::Scene;
use crate::scene::description::{Integrator, LightChoice};
use crate::scene::needs::capability::Capability;
use crate::scene::needs::{Need, Needs, length};

/// Prints the plan of a scene.
pub(super) fn run(args: &PlanArgs) -> Result<()> {
    log::start(&args.log);
    let backend = args.backend.as_ref().map(|word| format!("render.backend={word}"));
    let overrides: Vec<String> = args.overrides.iter().cloned().chain(backend).collect();
    let trust = Trusted::alone(&args.trust)?.of(&args.scene);
    let frozen = Frozen::read(&args.scene, &overrides, &trust)?;
    let text = if args.json { format!("{:#}\n", frozen.plan()) } else { to_text(&frozen, &frozen.needs()) };
    output::print(text.as_bytes())
}

/// All that is odd about a scene.
fn warnings<'a>(frozen: &'a Frozen, needs: &'a Needs) -> impl Iterator<Item = &'a Problem> {
    frozen.warnings.iter().chain(&needs.warnings)
}

/// Where rays come from, seen from the scene.
fn camera_distance(scene: &Scene, needs: &Needs) -> f32 {
    (scene.camera.eye(0.0) - needs.bounds.center()).length()
}

/// What of a backend the scene makes use of.
fn backend_use(scene: &Scene, needs: &Needs) -> Vec<String> {
    let has = |capability| needs.count(capability) > 0;
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
    ]
}

fn to_text(frozen: &Frozen, needs: &Needs) -> String {
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
    let (required, left_out): (Vec<&Need>, Vec<&Need>) =
        needs.capabilities.iter().partition(|need| need.count > 0);
    text += &table(&required, &left_out);
    let mut warnings = warnings(frozen, needs).peekable();
    if warnings.peek().is_some() {
        text += "\nwarnings\n";
        warnings.for_each(|warning| _ = writeln!(text, "  {warning}"));
    }
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

/// What is required, and what is left out.
fn table(required: &[&Need], left_out: &[&Need]) -> String {
    let origin = |need: &Need| need.first.as_ref().map_or_else(|| "-".to_owned(), ToString::to_string);
    let width = required.iter().map(|need| origin(need).chars().count()).max().unwrap_or(0).max(14);
    let mut text = format!("\n{:<22}{:>10}  {:<width$}  takes\n", "required", "count", "first asked by");
    for need in required {
        let Need { capability, count, .. } = need;
        let (origin, takes) = (origin(need), capability.takes());
        let _ = writeln!(text, "  {:<20}{count:>10}  {origin:<width$}  {takes}", capability.name());
    }
    text += "\nleft out\n";
    for Need { capability, .. } in left_out {
        let _ = writeln!(text, "  {:<20}{}", capability.name(), capability.spares());
    }
    text
}

/// The plan of a scene that requires so much, for programs.
pub(super) fn to_json(frozen: &Frozen, needs: &Needs) -> Value {
    let scene = &frozen.scene;
    let capability = |need: &Need| {
        let what = if need.count > 0 { need.capability.takes() } else { need.capability.spares() };
        json!({
            "name": need.capability.name(),
            "needed": need.count > 0,
            "count": need.count,
            "first": need.first.as_ref().map(ToString::to_string),
            "means": what,
        })
    };
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
        "capabilities": needs.capabilities.iter().map(capability).collect::<Vec<_>>(),
        "warnings": warnings(frozen, needs).map(ToString::to_string).collect::<Vec<_>>(),
    })
}

/// A number of things.
fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
