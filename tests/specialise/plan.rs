//! The command `plan`: who asks for what, what that takes and what leaving it out saves, what has no effect, and what is odd.

use crate::desk::Desk;
use serde_json::Value;
use specula::image;
use specula::scene::needs::capability::Capability;
use std::fs;

/// A ball of glass behind a lens, a lobe of weight zero, a material too many, and a light that is off.
const SCENE: &str = r#"[camera]
from = [0.0, 1.0, 4.0]
at = [0.0, 0.5, 0.0]
lens_radius = 0.01
[film]
width = 24
height = 16
[render]
integrator = "path"
spp = 4
[materials.glass]
type = "dielectric"
[materials.wall]
type = "glossy"
reflectance = 0.0
diffuse = 0.6
[materials.spare]
type = "mirror"
[[shapes]]
type = "rectangle"
edge_u = [4.0, 0.0, 0.0]
edge_v = [0.0, 0.0, -4.0]
material = "wall"
[[shapes]]
type = "sphere"
center = [0.0, 0.5, 0.0]
radius = 0.5
material = "glass"
[[lights]]
type = "rectangle"
center = [0.0, 3.0, 0.0]
edge_u = [1.0, 0.0, 0.0]
edge_v = [0.0, 0.0, 1.0]
radiance = 4.0
[[lights]]
type = "point"
position = [0.0, 2.0, 0.0]
intensity = 0.0
"#;

fn desk() -> Desk {
    let desk = Desk::new();
    fs::write(desk.path("scene.toml"), SCENE).expect("written");
    desk
}

fn planned(desk: &Desk, words: &[&str]) -> Value {
    let (status, text, stderr) = desk.run(&[&["plan", "scene.toml", "--json"], words].concat());
    assert_eq!(status, 0, "{stderr}");
    serde_json::from_str(&text).expect("JSON")
}

fn capability(plan: &Value, capability: Capability) -> &Value {
    let all = plan["capabilities"].as_array().expect("a list");
    all.iter().find(|it| it["name"] == capability.name()).expect("every capability")
}

/// The line of the scene that begins a table for the n-th time.
fn line(table: &str, number: usize) -> usize {
    let lines = SCENE.lines().enumerate().filter(|(_, line)| *line == table);
    lines.map(|(i, _)| i + 1).nth(number).expect("there")
}

#[test]
fn every_capability_is_listed_with_who_asks_for_it() {
    let plan = planned(&desk(), &[]);
    assert_eq!(plan["capabilities"].as_array().map(Vec::len), Some(Capability::ALL.len()), "all");
    let places = [
        (Capability::Triangles, 2 + 2, line("[[shapes]]", 0)),
        (Capability::Spheres, 1, line("[[shapes]]", 1)),
        (Capability::Media, 1, line("[[shapes]]", 1)),
        (Capability::Refraction, 1, line("[[shapes]]", 1)),
        (Capability::AreaLights, 1, line("[[lights]]", 0)),
        (Capability::Lens, 1, line("[camera]", 0)),
    ];
    for (it, count, line) in places {
        let found = capability(&plan, it);
        assert_eq!((&found["needed"], &found["count"]), (&true.into(), &count.into()), "{found}");
        let place = found["first"].as_str().unwrap_or_default();
        assert!(place.starts_with(&format!("scene.toml:{line}:")), "{found} for line {line}");
    }
    for it in [
        Capability::PointLights,
        Capability::Mirrors,
        Capability::GlossyLobes,
        Capability::Absorption,
        Capability::SurfaceParameters,
        Capability::LightChoice,
        Capability::Aovs,
    ] {
        let found = capability(&plan, it);
        assert_eq!((&found["needed"], &found["first"]), (&false.into(), &Value::Null), "{found}");
    }
    // Two rectangles of four vertices.
    let bytes = &capability(&plan, Capability::SurfaceParameters)["bytes"];
    assert_eq!((&bytes["taken"], &bytes["saved"]), (&0.into(), &64.into()), "8 bytes per vertex: {bytes}");
    let bytes = &capability(&plan, Capability::ShadingNormals)["bytes"];
    assert_eq!((&bytes["taken"], &bytes["saved"]), (&0.into(), &96.into()), "12 bytes per vertex: {bytes}");
}

#[test]
fn flags_of_render_are_planned_for() {
    let desk = desk();
    let plan = planned(&desk, &["--aov", "uv,depth", "--target-error", "0.01"]);
    assert_eq!(capability(&plan, Capability::Aovs)["count"], 2, "outputs beside the picture");
    // Three more sums of two numbers of 8 bytes for each pixel.
    assert_eq!(capability(&plan, Capability::Aovs)["bytes"]["taken"], 24 * 16 * 3 * 16, "sums");
    assert_eq!(capability(&plan, Capability::SurfaceParameters)["needed"], true, "an output shows them");
    assert_eq!(capability(&plan, Capability::AdaptiveSampling)["needed"], true, "samples go where noise is");
    let plan = planned(&desk, &["--no-specialise=cut-outs"]);
    let forced = capability(&plan, Capability::CutOuts);
    assert_eq!((&forced["needed"], &forced["forced"]), (&false.into(), &true.into()), "{forced}");
    assert_eq!(capability(&plan, Capability::Instances)["forced"], false, "nothing else");
    let uses = plan["backend"]["uses"].to_string();
    assert!(uses.contains("\"filter functions\""), "{uses}");
}

#[test]
fn what_has_no_effect_is_told_by_plan_and_in_a_line_by_render() {
    let desk = desk();
    let plan = planned(&desk, &[]);
    let told: Vec<(&str, &str)> = plan["without_effect"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|it| (it["kind"].as_str().unwrap_or_default(), it["what"].as_str().unwrap_or_default()))
        .collect();
    assert_eq!(
        told,
        [
            ("lobe of weight zero", "`wall`: its fuzzy mirror reflects nothing"),
            ("unreferenced material", "`spare`"),
            ("light without power", "never asked")
        ],
        "{plan:#}"
    );
    let (status, _, stderr) = desk.run(&["render", "scene.toml", "-o", "a.exr", "--stats", "a.json"]);
    assert_eq!(status, 0, "{stderr}");
    let lines: Vec<&str> = stderr.lines().filter(|line| line.starts_with("without effect: ")).collect();
    let summary = "1 light without power, 1 lobe of weight zero, 1 unreferenced material";
    assert_eq!(lines, [format!("without effect: {summary}; see `specula plan`")], "{stderr}");
    let stats: Value =
        serde_json::from_str(&fs::read_to_string(desk.path("a.json")).expect("statistics")).expect("JSON");
    assert_eq!(stats["plan"]["without_effect"], plan["without_effect"], "statistics have it, too");
}

#[test]
fn what_is_switched_on_by_name_changes_no_bit() {
    let desk = desk();
    let picture = |name: &str, words: &[&str]| {
        let (status, _, stderr) = desk.run(&[&["render", "scene.toml", "-q", "-o", name], words].concat());
        assert_eq!(status, 0, "{stderr}");
        image::read(&desk.path(name)).expect("a picture").image
    };
    let some = picture("some.exr", &["--no-specialise=mixes,media,pruning"]);
    assert!(some == picture("own.exr", &[]), "another picture");
    let (status, _, stderr) = desk.run(&["render", "scene.toml", "--no-specialise=lense"]);
    assert_eq!(status, 2, "{stderr}");
    assert!(stderr.contains("`lense` is nothing to switch on") && stderr.contains("lens"), "{stderr}");
}

#[test]
fn oddities_have_places_numbers_and_remedies() {
    let desk = desk();
    let (_, text, _) = desk.run(&["plan", "scene.toml"]);
    assert!(!text.contains("\nwarnings\n"), "nothing is odd: {text}");
    fs::write(
        desk.path("slivers.obj"),
        "v 0 0 0\nv 1 0 0\nv 0.5 0.0001 0\nv 0 0 0.0000002\nv 1 0 0.0000002\nv 0 1 0.0000002\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 4 5 6\nf 1 7 8\n",
    )
    .expect("written");
    let odd = format!(
        "{}[materials.air]\ntype = \"dielectric\"\nior = 1.0001\n[materials.keen]\ntype = \"glossy\"\nexponent = 1e8\n\
         [[shapes]]\ntype = \"sphere\"\nmaterial = \"air\"\n[[shapes]]\ntype = \"sphere\"\ncenter = [1.0, 0.0, 0.0]\nmaterial = \"keen\"\n\
         [[shapes]]\ntype = \"mesh\"\nfile = \"slivers.obj\"\nmaterial = \"wall\"\n",
        SCENE
    );
    fs::write(desk.path("scene.toml"), odd).expect("written");
    let plan = planned(&desk, &[]);
    let warnings: Vec<&str> =
        plan["warnings"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    for part in [
        "`air` has an index of 1.0001",
        "`keen` has an exponent of 1e8",
        "triangles is a needle",
        "nearly coincide with others, 0.2 um to 0.2 um apart",
    ] {
        let found = warnings.iter().find(|warning| warning.contains(part));
        let found = found.unwrap_or_else(|| panic!("{part} in {warnings:#?}"));
        assert!(found.starts_with("scene.toml:") && found.contains("; "), "a place and a remedy: {found}");
    }
    let (_, _, stderr) = desk.run(&["render", "scene.toml", "-q", "-o", "a.exr", "--spp", "1"]);
    assert!(!stderr.contains("needle"), "only `plan` looks at triangles: {stderr}");
}
