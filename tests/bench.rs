//! The command `bench`: tables, JSON and page on a small scene; rays that go to a file and come back; what is refused.

#[path = "support/desk.rs"]
mod desk;
#[cfg(unix)]
#[path = "support/running.rs"]
mod running;

use desk::Desk;
use serde_json::Value;
use specula::bench::agreement::Difference;
use specula::bench::{Class, Contestant};
use std::fs;
#[cfg(unix)]
use std::time::Duration;

/// A ball and a box on a floor under two lamps, one of which has a size.
const SCENE: &str = "
[camera]
from = [0.0, 1.5, 4.0]
at = [0.0, 0.4, 0.0]
[film]
width = 32
height = 20
[materials.m]
type = 'diffuse'
[[shapes]]
type = 'box'
min = [-0.5, 0.0, -0.5]
max = [0.5, 1.0, 0.5]
material = 'm'
[[shapes]]
type = 'sphere'
center = [1.2, 0.5, 0.0]
radius = 0.5
material = 'm'
[[shapes]]
type = 'rectangle'
center = [0.0, 0.0, 0.0]
edge_u = [3.0, 0.0, 0.0]
edge_v = [0.0, 0.0, -3.0]
material = 'm'
[[lights]]
type = 'rectangle'
center = [0.0, 3.0, 0.0]
edge_u = [0.5, 0.0, 0.0]
edge_v = [0.0, 0.0, 0.5]
radiance = 5.0
[[lights]]
type = 'point'
position = [2.0, 3.0, 2.0]
intensity = 5.0
";

fn place() -> Desk {
    let desk = Desk::new();
    fs::write(desk.path("a.toml"), SCENE).expect("written");
    desk
}

/// The program on `a.toml` with few rays; its standard output.
fn bench(desk: &Desk, words: &[&str]) -> String {
    let words = [&["bench", "a.toml", "-q", "--passes", "1"], words].concat();
    let (status, stdout, stderr) = desk.run(&words);
    assert_eq!(status, 0, "{words:?}: {stderr}");
    stdout
}

fn json(desk: &Desk, words: &[&str]) -> Value {
    let text = bench(desk, &[&["--json"], words].concat());
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn list<'a>(value: &'a Value, pointer: &str) -> &'a Vec<Value> {
    value.pointer(pointer).and_then(Value::as_array).unwrap_or_else(|| panic!("{pointer} in {value:#}"))
}

#[test]
fn tables_tell_builds_rates_and_answers() {
    let desk = place();
    let text = bench(&desk, &["--quick", "--rays", "64", "-t", "2"]);
    for part in [
        "a.toml: 17 primitives",
        "rays: primary 64 (",
        "closest hits, 1 thread, Mrays per CPU s",
        "any hits, 2 threads, Mrays/s",
        "embree-medium-robust packet8 incoherent",
        "cwbvh-medium single",
        "brute single",
        "any hits, answers",
        "lost_at_edge",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    assert_eq!(desk.names(), ["a.toml"], "no file that was not asked for");
}

#[test]
fn json_holds_everything_that_was_raced() {
    let desk = place();
    let document = json(&desk, &["--rays", "32", "-t", "2", "-D", "film.width=16"]);
    for key in
        ["processor", "processors", "cores", "mhz", "caches", "system", "isa", "load_before", "load_after"]
    {
        assert!(document["machine"].get(key).is_some(), "machine {key} in {document:#}");
    }
    for key in ["version", "commit", "rustc", "target", "opt_level", "rustflags", "debug_assertions"] {
        assert!(document["build"].get(key).is_some(), "build {key} in {document:#}");
    }
    assert_eq!(document["settings"]["passes"], 1, "settings");
    let scene = &document["scenes"][0];
    let classes: Vec<&Value> = list(scene, "/classes").iter().map(|it| &it["class"]).collect();
    assert_eq!(classes, Class::ALL.map(Class::word), "classes");
    let names: Vec<_> =
        list(scene, "/builds").iter().map(|it| it["contestant"].as_str().map(str::to_owned)).collect();
    assert_eq!(names, Contestant::all().iter().map(|it| Some(it.name())).collect::<Vec<_>>(), "every build");
    for build in list(scene, "/builds") {
        let threads: Vec<&Value> = list(build, "/times").iter().map(|time| &time["threads"]).collect();
        assert_eq!(threads, [1, 2], "{build:#}");
        let is_brute = build["contestant"] == "brute";
        assert!(build["bytes"].as_u64() > Some(0) || is_brute, "{build:#}");
        let first = build.pointer("/times/0/wall_s/0").and_then(Value::as_f64);
        assert!(first > Some(0.0), "{build:#}");
        assert!(build["isa"].is_string() && build["library"].is_string(), "{build:#}");
    }
    let ways: usize = Contestant::all().iter().map(|it| it.queries().len()).sum();
    // Closest and any; on one thread and on two.
    assert_eq!(list(scene, "/rates").len(), ways * Class::ALL.len() * 2 * 2, "rates");
    assert_eq!(list(scene, "/agreement").len(), ways * Class::ALL.len() * 2, "answers");
    for rate in list(scene, "/rates") {
        for key in ["rays_per_cpu_s", "rays_per_s", "ns_per_ray", "ratio"] {
            assert!(rate[key][0].as_f64() > Some(0.0) && rate[key][1].is_number(), "{key} in {rate:#}");
        }
        assert_eq!(rate["scaling"].is_array(), rate["threads"] == 2, "{rate:#}");
        assert_eq!(rate["coherent"].is_null(), rate["query"] == "single", "{rate:#}");
    }
    for entry in list(scene, "/agreement") {
        let of = |word: &str| entry[word].as_u64().unwrap_or_else(|| panic!("{word} in {entry:#}"));
        let sum: u64 = Difference::ALL.map(|difference| of(difference.word())).iter().sum();
        assert_eq!(of("differ"), sum, "{entry:#}");
        assert_eq!([of("lost"), of("other"), of("unjudged")], [0; 3], "{entry:#}");
        assert!(entry["first_wrong"].is_null(), "{entry:#}");
    }
}

#[test]
fn the_page_needs_nothing_else() {
    let desk = place();
    let words = [
        "--quick", "--rays", "32", "-t", "1", "--report", "a.html", "--class", "primary", "--class",
        "diffuse2",
    ];
    let document = json(&desk, &words);
    let page = fs::read_to_string(desk.path("a.html")).expect("written");
    assert!(page.starts_with("<!DOCTYPE html>"), "a page");
    for outside in ["<script", "<link", "src=", "href=", "url(", "@import"] {
        assert!(!page.contains(outside), "{outside}");
    }
    // For each of two classes: builds against rates, and bars of both modes.
    assert_eq!(page.matches("<svg").count(), 2 * 3, "plots");
    for part in
        ["a.toml", "diffuse2", "quality = medium, robust = true", "preset = medium, padding = 1", "rustc"]
    {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("no plot:"), "plots are drawn");
    // Of each mode either who differs, by reason, or that nobody does.
    let differs = |mode: &str| {
        let of_mode = |entry: &&Value| entry["hits"] == mode && entry["differ"].as_u64() > Some(0);
        list(&document, "/scenes/0/agreement").iter().any(|entry| of_mode(&entry))
    };
    let tables = ["closest", "any"].into_iter().filter(|mode| differs(mode)).count();
    let told = ["<th>lost_at_edge</th>", "<p>None.</p>"].map(|part| page.matches(part).count());
    assert_eq!(told, [tables, 2 - tables], "tables of answers");
}

/// The box twice in one place: whoever meets both at once may name either, and the page has a column for each reason.
#[test]
fn the_page_tells_whose_answers_differ() {
    let desk = place();
    let twice = SCENE.replace("[[lights]]\ntype = 'rectangle'", "[[shapes]]\ntype = 'box'\nmin = [-0.5, 0.0, -0.5]\nmax = [0.5, 1.0, 0.5]\nmaterial = 'm'\n[[lights]]\ntype = 'rectangle'");
    fs::write(desk.path("a.toml"), twice).expect("written");
    let words = [
        "--rays",
        "256",
        "-t",
        "1",
        "--report",
        "a.html",
        "--class",
        "primary",
        "--backend",
        "brute",
        "--backend",
        "embree",
    ];
    let document = json(&desk, &words);
    let ties: u64 =
        list(&document, "/scenes/0/agreement").iter().filter_map(|it| it["id_tie"].as_u64()).sum();
    let page = fs::read_to_string(desk.path("a.html")).expect("written");
    assert!(ties > 0 && page.contains("<th>lost_at_edge</th>"), "{ties} ties");
}

#[cfg(unix)]
#[test]
fn an_interrupted_race_ends_with_status_130() {
    let desk = place();
    let words =
        ["bench", "a.toml", "-q", "--rays", "65536", "--passes", "500", "-t", "1", "--record", "a.rays"];
    let mut child = running::spawn(&desk, &[&words[..], &["--report", "a.html"]].concat());
    // Once rays are recorded the race begins.
    running::wait_for("rays", Duration::from_secs(60), || desk.path("a.rays").exists());
    std::thread::sleep(Duration::from_millis(200));
    assert!(child.try_wait().expect("known").is_none(), "the race is on");
    running::signal(&child, "-INT");
    let output = child.wait_with_output().expect("ended");
    assert_eq!((output.status.code(), output.stdout.len()), (Some(130), 0), "interrupted, without a table");
    assert_eq!(desk.names(), ["a.rays", "a.toml"], "no page, nothing half-written");
}

#[test]
fn filters_choose_what_races() {
    let desk = place();
    let words = [
        "--backend",
        "cwbvh-fast",
        "--backend",
        "bvh2",
        "--class",
        "shadow",
        "--query",
        "stream",
        "-t",
        "1",
        "--rays",
        "16",
    ];
    let document = json(&desk, &words);
    let scene = &document["scenes"][0];
    let asked: Vec<&str> = list(scene, "/rates").iter().filter_map(|it| it["contestant"].as_str()).collect();
    let presets =
        ["fastest", "very_fast", "fast", "medium", "slow", "very_slow"].map(|word| format!("bvh2-{word}"));
    // In turn for each of both modes, coherent and not.
    let names: Vec<&str> = presets.iter().map(String::as_str).chain(["cwbvh-fast"]).collect();
    let wanted: Vec<&str> =
        [&names[..], &names[..]].concat().into_iter().flat_map(|name| [name; 2]).collect();
    assert_eq!(asked, wanted, "who races");
    for rate in list(scene, "/rates") {
        assert_eq!((&rate["query"], &rate["class"]), (&"stream".into(), &"shadow".into()), "{rate:#}");
    }
}

#[test]
fn replayed_rays_are_answered_as_recorded_ones() {
    let desk = place();
    let quick = ["--quick", "-t", "1"];
    let recorded = json(&desk, &[&quick[..], &["--rays", "256", "--record", "a.rays"]].concat());
    let replayed = json(&desk, &[&quick[..], &["--replay", "a.rays"]].concat());
    for part in ["/scenes/0/classes", "/scenes/0/agreement"] {
        assert_eq!(recorded.pointer(part), replayed.pointer(part), "{part}");
    }
    assert_eq!(replayed["scenes"][0]["replayed"], "a.rays", "told");
    // Rays do not depend on what races: they are for others, too.
    let other = ["--backend", "brute", "-t", "1", "--rays", "256", "--record", "b.rays"];
    bench(&desk, &other);
    assert_eq!(
        fs::read(desk.path("a.rays")).expect("there"),
        fs::read(desk.path("b.rays")).expect("there"),
        "bytes"
    );
    let classes = json(&desk, &["--quick", "-t", "1", "--replay", "a.rays", "--class", "random"]);
    assert_eq!(list(&classes, "/scenes/0/classes").len(), 1, "one class of the file");
}

#[test]
fn rays_of_another_scene_are_warned_of() {
    let desk = place();
    bench(&desk, &["--quick", "-t", "1", "--rays", "16", "--record", "a.rays"]);
    let disc = "[[shapes]]\ntype = 'disc'\ncenter = [0.0, 2.0, 0.0]\nnormal = [0.0, 1.0, 0.0]\nradius = 0.1\nmaterial = 'm'\n";
    fs::write(desk.path("b.toml"), format!("{SCENE}{disc}")).expect("written");
    let (status, _, stderr) =
        desk.run(&["bench", "b.toml", "-q", "--quick", "-t1", "--passes=1", "--replay", "a.rays"]);
    assert_eq!(status, 0, "{stderr}");
    assert!(stderr.contains("recorded in a scene of 17 primitives, and this one has 18"), "{stderr}");
}

#[test]
fn rays_know_where_they_are_counted_from() {
    let desk = place();
    let far = ["-D", "camera.from=[1000.0, 1.5, 0.0]", "-D", "camera.at=[999.0, 1.5, 0.0]"];
    bench(&desk, &[&["--quick", "-t", "1", "--rays", "16", "--record", "a.rays"][..], &far].concat());
    let head = fs::read(desk.path("a.rays")).expect("there");
    let number = |at: usize| f64::from_le_bytes(head[at..at + 8].try_into().expect("eight bytes"));
    // The nearest metres to the camera; halves go away from zero.
    assert_eq!(format!("{:?}", [20, 28, 36].map(number)), "[1000.0, 2.0, 0.0]", "in the head");
    let replay = ["bench", "a.toml", "-q", "--quick", "-t1", "--passes=1", "--replay", "a.rays"];
    let (status, _, stderr) = desk.run(&[&replay[..], &far].concat());
    assert_eq!(status, 0, "the same camera: {stderr}");
    let (status, stdout, stderr) = desk.run(&replay);
    assert_eq!((status, stdout.as_str()), (2, ""), "another one: {stderr}");
    let told = "a.rays: its rays are counted from (1000, 2, 0), and this scene from (0, 0, 0)";
    assert!(stderr.contains(told) && stderr.contains("; give the camera of the recording"), "{stderr}");
}

#[test]
fn what_is_wrong_is_told_with_status_2() {
    let desk = place();
    bench(&desk, &["--quick", "-t", "1", "--rays", "16", "--record", "whole.rays"]);
    let whole = fs::read(desk.path("whole.rays")).expect("there");
    let damaged = [
        ("short.rays", whole[..whole.len() - 5].to_vec()),
        ("long.rays", [&whole[..], b"xy"].concat()),
        ("magic.rays", [b"SPECTRAL", &whole[8..]].concat()),
        ("nan.rays", [&whole[..whole.len() - 4], &f32::NAN.to_le_bytes()].concat()),
        ("empty.rays", Vec::new()),
    ];
    for (name, bytes) in &damaged {
        fs::write(desk.path(name), bytes).expect("written");
    }
    let (len, end) = (whole.len(), |by: usize| format!("byte {}: ", whole.len() - by));
    let before = desk.names();
    let cases: [(&[&str], &[&str]); 16] = [
        (&["bench"], &["<SCENE>"]),
        (&["bench", "none.toml"], &["none.toml"]),
        (&["bench", "a.toml", "none.toml", "nil.toml"], &["none.toml", "nil.toml"]),
        (&["bench", "a.toml", "-D", "film.widht=3"], &["film.widht", "width"]),
        (&["bench", "a.toml", "--backend", "embre"], &["--backend embre", "`embree`"]),
        (&["bench", "a.toml", "--class", "diffuse5"], &["--class diffuse5", "did you mean"]),
        (&["bench", "a.toml", "--rays", "0", "--passes", "x"], &["--rays 0", "--passes x"]),
        (&["bench", "a.toml", "-t", "0"], &["--threads 0"]),
        (&["bench", "a.toml", "--report", "no/a.html"], &["no/a.html", "create it"]),
        (&["bench", "a.toml", "a.toml", "--record", "b.rays"], &["--record", "one scene"]),
        (&["bench", "a.toml", "--replay", "none.rays"], &["none.rays", "no such file"]),
        (&["bench", "a.toml", "--replay", "short.rays"], &["short.rays", &end(5), "ends within"]),
        (&["bench", "a.toml", "--replay", "long.rays"], &["long.rays", &end(0), "2 bytes follow"]),
        (&["bench", "a.toml", "--replay", "magic.rays"], &["magic.rays: byte 0: ", "SPECRAYS"]),
        (&["bench", "a.toml", "--replay", "nan.rays"], &["nan.rays", &end(4), "moment"]),
        (&["bench", "a.toml", "--replay", "empty.rays"], &["empty.rays: byte 0: ", "ends within"]),
    ];
    assert!(len > 1000, "something to damage");
    for (words, parts) in cases {
        let (status, stdout, stderr) = desk.run(words);
        assert_eq!((status, stdout.as_str()), (2, ""), "{words:?}: {stderr}");
        for part in parts {
            assert!(stderr.contains(part), "{words:?}: `{part}` in {stderr}");
        }
        assert!(!stderr.contains("panicked"), "{words:?}: {stderr}");
    }
    assert_eq!(desk.names(), before, "nothing was written");
}
