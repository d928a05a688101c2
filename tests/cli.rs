//! The program as its users meet it: words in, files, text and exit status out.

#[path = "support/desk.rs"]
mod desk;
#[path = "support/models.rs"]
mod models;
#[cfg(unix)]
#[path = "support/running.rs"]
mod running;

use std::fs;
use std::path::Path;

use desk::Desk;
use specula::image::{self, Window, exr};

/// A scene that takes a moment: one mirror ball, one lamp.
const BALL: &str = r#"
[film]
width = 24
height = 16
[render]
spp = 4
[materials.mirror]
type = "mirror"
[materials.wall]
type = "diffuse"
[[shapes]]
type = "sphere"
center = [0.0, 0.5, 0.0]
radius = 0.5
material = "mirror"
[[shapes]]
type = "rectangle"
center = [0.0, 0.0, 0.0]
edge_u = [4.0, 0.0, 0.0]
edge_v = [0.0, 0.0, -4.0]
material = "wall"
[[lights]]
type = "point"
position = [1.0, 3.0, 2.0]
intensity = 20.0
"#;

/// A directory with the scene in it.
fn place() -> Desk {
    let desk = Desk::new();
    fs::write(desk.path("ball.toml"), BALL).expect("written");
    desk
}

fn colours(place: &Desk, name: &str) -> image::Image {
    image::read(&place.path(name)).expect("a picture").image
}

#[test]
fn help_lists_the_commands_and_version_the_version() {
    let place = place();
    let (status, stdout, stderr) = place.run(&["--help"]);
    assert_eq!((status, stderr.as_str()), (0, ""), "help is a result");
    for command in
        ["render", "batch", "merge", "farm", "diff", "fuzzy", "bench", "schema", "completions", "man"]
    {
        assert!(stdout.contains(command), "{command} in {stdout}");
    }
    let (status, stdout, _) = place.run(&["render", "--help"]);
    let flags = [
        "--output",
        "--slice",
        "--frames",
        "--checkpoint",
        "--checkpoint-every",
        "--resume",
        "--spp",
        "--integrator",
        "--view",
        "--backend",
        "--sampler",
        "--glossy",
        "--width",
        "--height",
        "--max-depth",
        "--min-throughput",
        "--fresnel",
        "--light-samples",
        "--glossy-samples",
        "--crop",
        "--seed",
        "--threads",
        "--half",
        "--stats",
        "-D",
        "--quiet",
        "--log-format",
        "--log-level",
    ];
    assert_eq!(status, 0, "help");
    for flag in flags {
        assert!(stdout.contains(flag), "{flag} in {stdout}");
    }
    let version = concat!("specula ", env!("CARGO_PKG_VERSION"));
    let (status, stdout, _) = place.run(&["-V"]);
    assert_eq!((status, stdout.trim()), (0, version), "version");
    let (status, stdout, _) = place.run(&["--version"]);
    let lines: Vec<&str> = stdout.lines().collect();
    let lanes = format!("lanes {}", specula::render::lanes());
    assert_eq!((status, &lines[..2]), (0, &[version, &lanes][..]), "version: {stdout}");
    // Also what pictures depend on to the bit beside it.
    for backend in ["embree ", "bvh2 (obvhs ", "cwbvh (obvhs ", "brute"] {
        assert!(lines[2..].iter().any(|line| line.starts_with(backend)), "{backend} in {stdout}");
    }
}

#[test]
fn wrong_words_end_with_status_2_and_say_what_to_do() {
    let place = place();
    let cases: [(&[&str], &[&str]); 25] = [
        (&[], &["Usage"]),
        (&["rendr", "ball.toml"], &["rendr", "render"]),
        (&["render"], &["<SCENE>"]),
        (&["render", "ball.toml", "--sppp", "3"], &["--sppp", "--spp"]),
        (&["render", "ball.toml", "--spp"], &["--spp"]),
        (&["render", "ball.toml", "--spp", "0"], &["render.spp", "1"]),
        (&["render", "ball.toml", "--spp", "-3"], &["render.spp"]),
        (&["render", "ball.toml", "--spp", "many"], &["render.spp", "many"]),
        (&["render", "ball.toml", "--integrator", "whited"], &["whited", "whitted"]),
        (&["render", "ball.toml", "--backend", "abacus"], &["abacus", "embree"]),
        (&["render", "ball.toml", "--min-throughput", "2"], &["min_throughput"]),
        (&["render", "ball.toml", "--roulette", "never"], &["render.roulette", "or `off`"]),
        (&["render", "ball.toml", "--clamp-indirect", "0"], &["render.clamp_indirect", "above 0"]),
        (&["render", "ball.toml", "--light-choice", "trees"], &["trees", "tree"]),
        (&["render", "ball.toml", "--width", "0"], &["film.width"]),
        (&["render", "ball.toml", "--crop", "1,2,3"], &["--crop", "x0,y0,x1,y1"]),
        (&["render", "ball.toml", "--crop", "0,0,25,16"], &["crop", "24"]),
        (&["render", "ball.toml", "-t", "0"], &["--threads", "1 to"]),
        (&["render", "ball.toml", "-o", "a.jpg"], &["a.jpg", ".exr or .png"]),
        (&["render", "ball.toml", "-o", "no/a.png"], &["no/a.png", "create it"]),
        (&["render", "ball.toml", "-D", "render.sp=3"], &["render.sp", "spp"]),
        (&["render", "ball.toml", "-D", "novalue"], &["novalue", "key=value"]),
        (&["render", "ball.toml", "--log-level", "loud"], &["loud", "warn"]),
        (&["render", "none.toml"], &["none.toml"]),
        (&["completions", "smash"], &["smash", "bash"]),
    ];
    for (words, parts) in cases {
        let (status, stdout, stderr) = place.run(words);
        assert_eq!(status, 2, "{words:?}: {stderr}");
        assert_eq!(stdout, "", "{words:?}");
        for part in parts {
            assert!(stderr.contains(part), "{words:?}: `{part}` in {stderr}");
        }
        assert!(!stderr.contains("panicked"), "{words:?}: {stderr}");
    }
    assert_eq!(place.names(), ["ball.toml"], "nothing was written");
}

#[test]
fn several_wrong_values_are_told_together() {
    let place = place();
    let words =
        ["render", "ball.toml", "--spp", "0", "--view", "x", "--seed", "y", "-D", "film.width=-1", "-t0"];
    let (status, _, stderr) = place.run(&words);
    assert_eq!(status, 2, "{stderr}");
    let told = stderr.lines().filter(|line| line.starts_with("error: ")).count();
    assert_eq!(told, 5, "{stderr}");
}

#[test]
fn a_picture_is_written_to_the_files_asked_for_and_they_are_named() {
    let place = place();
    let (status, stdout, stderr) = place.run(&["render", "ball.toml"]);
    assert_eq!(status, 0, "{stderr}");
    assert_eq!(stdout, "ball.exr\nball.png\n", "results");
    assert_eq!(place.names(), ["ball.exr", "ball.png", "ball.toml"], "files");
    let (status, stdout, stderr) = place.run(&["render", "ball.toml", "-q", "-o", "x.png", "-o", "y.EXR"]);
    assert_eq!((status, stdout.as_str(), stderr.as_str()), (0, "x.png\ny.EXR\n", ""), "quiet");
    assert_eq!(colours(&place, "y.EXR"), colours(&place, "ball.exr"), "the same picture");
    assert!(colours(&place, "y.EXR").pixels().iter().any(|pixel| pixel.g > 0.0), "something is seen");
}

#[test]
fn flags_override_the_scene_and_the_metadata_tell() {
    let place = place();
    let flags = "--spp 2 --width 10 --height 6 --seed 5 --backend brute --sampler independent --max-depth 3 \
                 --min-throughput 0.5 --fresnel schlick --light-samples 3 --glossy-samples 2 --stats a.json \
                 -D materials.wall.reflectance=0.25";
    let words: Vec<&str> = "render ball.toml -q -o a.exr".split(' ').chain(flags.split(' ')).collect();
    let (status, _, stderr) = place.run(&words);
    assert_eq!(status, 0, "{stderr}");
    let picture = exr::read(&place.path("a.exr")).expect("a picture");
    assert_eq!(picture.full, [10, 6], "size");
    let wanted = [
        ("specula:spp", "2"),
        ("specula:seed", "5"),
        ("specula:backend", "brute"),
        ("specula:sampler", "independent"),
        ("specula:max_depth", "3"),
        ("specula:min_throughput", "0.5"),
        ("specula:fresnel", "schlick"),
        ("specula:glossy", "lobe"),
        ("specula:light_samples", "3"),
        ("specula:glossy_samples", "2"),
        ("specula:split_depth", "1"),
        ("specula:query", "single"),
        ("specula:integrator", "whitted"),
        ("specula:samples", "0..2"),
        ("specula:non_finite_samples", "0"),
        ("specula:version", env!("CARGO_PKG_VERSION")),
    ];
    for (key, value) in wanted {
        assert_eq!(picture.attribute(key), Some(value), "{key}");
    }
    let hash = picture.attribute("specula:scene_hash").expect("a hash");
    assert!(hash.len() == 32 && hash.chars().all(|c| c.is_ascii_hexdigit()), "{hash}");
    let plan: serde_json::Value =
        serde_json::from_str(picture.attribute("specula:plan").expect("a plan")).expect("JSON");
    let backend = plan.pointer("/backend/name").and_then(serde_json::Value::as_str);
    assert_eq!((backend, plan["spp"].as_u64()), (Some("brute"), Some(2)), "{plan}");
    let text = fs::read_to_string(place.path("a.json")).expect("statistics");
    let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    for (key, value) in [("fresnel", "schlick"), ("glossy", "lobe"), ("query", "single")] {
        assert_eq!(stats[key], value, "{key} in {text}");
    }
    for (key, value) in [("light_samples", 3), ("glossy_samples", 2), ("split_depth", 1)] {
        assert_eq!(stats[key], value, "{key} in {text}");
    }
    assert!(stats["direct"].is_null(), "trees have no strategies: {text}");
}

#[test]
fn knobs_of_the_tree_are_warned_of_where_paths_are_followed() {
    let place = place();
    let text = BALL.replace("spp = 4", "spp = 4\nglossy_samples = 3");
    fs::write(place.path("knob.toml"), &text).expect("written");
    let words = ["render", "knob.toml", "-o", "a.exr", "--light-samples", "4", "-D", "render.split_depth=2"];
    let (status, _, stderr) = place.run(&[&words[..], &["--integrator", "path"]].concat());
    assert_eq!(status, 0, "{stderr}");
    for told in [
        "knob.toml:7:18: `glossy_samples` is of the ray tree: the integrator `path` does not use it; leave it out",
        "command line: in `render.light_samples=4`: `light_samples` is of the ray tree",
        "command line: in `render.split_depth=2`: `split_depth` is of the ray tree",
    ] {
        assert!(stderr.contains(told), "{told} in {stderr}");
    }
    let picture = exr::read(&place.path("a.exr")).expect("a picture");
    assert_eq!(picture.attribute("specula:direct"), Some("both"), "strategies of paths");
    assert_eq!(picture.attribute("specula:light_samples"), None, "what was not used");
    for integrator in ["whitted", "distribution"] {
        let (status, _, stderr) = place.run(&[&words[..], &["--integrator", integrator]].concat());
        assert!(status == 0 && !stderr.contains("of the ray tree"), "{integrator}: {stderr}");
    }
    let (_, planned, _) = place.run(&["plan", "knob.toml", "-D", "render.integrator=path"]);
    assert!(planned.contains("`glossy_samples` is of the ray tree"), "the plan tells, too: {planned}");
}

#[test]
fn the_plan_says_how_rays_are_asked_for_and_why() {
    let place = place();
    for (words, line) in [
        (&[][..], "query      stream: camera and shadow rays are faster in packets\n"),
        (&["--backend", "bvh2"], "query      single: this backend has single rays only\n"),
        (&["-D", "render.integrator=path"], "query      stream: paths are followed many at a time\n"),
        (&["-D", "render.query=packet"], "query      packet: as asked for\n"),
    ] {
        let (status, planned, stderr) = place.run(&[&["plan", "ball.toml"], words].concat());
        assert!(status == 0 && planned.contains(line), "{line} in {planned}{stderr}");
    }
}

#[test]
fn knobs_of_paths_are_told() {
    let place = place();
    let words = ["render", "ball.toml", "-q", "-o", "a.exr", "--stats", "a.json", "--integrator", "path"];
    let knobs = ["--roulette", "off", "--clamp-indirect", "0.01", "--light-choice", "uniform"];
    let (status, _, stderr) = place.run(&[&words[..], &knobs].concat());
    assert_eq!(status, 0, "{stderr}");
    let picture = exr::read(&place.path("a.exr")).expect("a picture");
    let wanted = [
        ("specula:roulette", "off"),
        ("specula:clamp_indirect", "0.01"),
        ("specula:light_choice", "uniform"),
    ];
    for (key, value) in wanted {
        assert_eq!(picture.attribute(key), Some(value), "{key}");
    }
    let text = fs::read_to_string(place.path("a.json")).expect("statistics");
    let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let part = stats["clamped"]["part"].as_f64().expect("a part");
    assert!((0.0..1.0).contains(&part), "{part}");
    let told = picture.attribute("specula:clamped_part").and_then(|text| text.parse::<f64>().ok());
    assert_eq!(told, Some(part), "the same in both");
    assert_eq!(stats["pruned"]["by_roulette"], 0, "none died");
}

#[test]
fn a_view_is_chosen_by_its_name_alone() {
    let place = place();
    let (status, _, stderr) = place.run(&["render", "ball.toml", "-q", "-o", "a.exr", "--view", "depth"]);
    assert_eq!(status, 0, "{stderr}");
    let picture = exr::read(&place.path("a.exr")).expect("a picture");
    assert_eq!(picture.attribute("specula:integrator"), Some("view"), "integrator");
    assert_eq!(picture.attribute("specula:view"), Some("depth"), "view");
}

#[test]
fn a_crop_is_the_same_pixels_on_any_number_of_threads() {
    let place = place();
    let window = Window { x0: 3, y0: 2, x1: 20, y1: 9 };
    let (status, _, stderr) = place.run(&["render", "ball.toml", "-q", "-o", "whole.exr", "-t", "3"]);
    assert_eq!(status, 0, "{stderr}");
    let words =
        ["render", "ball.toml", "-q", "-o", "crop.exr", "-o", "crop.png", "--crop", "3,2,20,9", "-t", "1"];
    let (status, _, stderr) = place.run(&words);
    assert_eq!(status, 0, "{stderr}");
    let crop = image::read(&place.path("crop.exr")).expect("a picture");
    assert_eq!((crop.window, crop.full), (window, [24, 16]), "windows");
    let whole = colours(&place, "whole.exr");
    for y in 0..window.height() {
        for x in 0..window.width() {
            assert_eq!(crop.image.pixel(x, y), whole.pixel(x + window.x0, y + window.y0), "at {x}, {y}");
        }
    }
}

#[test]
fn halves_are_stored_as_halves() {
    let place = place();
    let (status, _, stderr) = place.run(&["render", "ball.toml", "-q", "-o", "a.exr", "--half"]);
    assert_eq!(status, 0, "{stderr}");
    let channels = exr::channels(&place.path("a.exr")).expect("an EXR file");
    let kinds: Vec<_> = channels.iter().map(|c| (c.name.as_str(), c.bits, c.is_float)).collect();
    assert_eq!(kinds, [("A", 16, true), ("B", 16, true), ("G", 16, true), ("R", 16, true)], "channels");
}

#[test]
fn statistics_are_json_with_times_and_rays() {
    let place = place();
    let words = ["render", "ball.toml", "-q", "-o", "a.png", "--stats", "stats.json", "-t", "2"];
    let (status, stdout, stderr) = place.run(&words);
    assert_eq!((status, stdout.as_str()), (0, "a.png\nstats.json\n"), "{stderr}");
    let text = fs::read_to_string(place.path("stats.json")).expect("there");
    let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let at = |pointer: &str| stats.pointer(pointer).unwrap_or_else(|| panic!("{pointer} in {text}"));
    assert_eq!(at("/samples"), 24 * 16 * 4, "samples");
    assert_eq!(at("/rays/camera"), 24 * 16 * 4, "camera rays");
    assert!(at("/rays/reflected").as_u64() > Some(0) && at("/rays/shadow").as_u64() > Some(0), "{text}");
    let kinds = ["camera", "reflected", "refracted", "glossy", "shadow", "hidden"];
    let sum: u64 = kinds.iter().map(|kind| at(&format!("/rays/{kind}")).as_u64().expect("a count")).sum();
    assert_eq!(at("/rays/total").as_u64(), Some(sum), "all rays");
    for phase in ["load", "build", "render", "write"] {
        for clock in ["wall_s", "cpu_s"] {
            let time = at(&format!("/phases/{phase}/{clock}")).as_f64().expect("a time");
            assert!((0.0..600.0).contains(&time), "{phase} {clock}: {time}");
        }
    }
    assert!(at("/rays_per_s").as_f64() > Some(0.0) && at("/samples_per_s").as_f64() > Some(0.0), "{text}");
    assert!(at("/peak_rss_bytes").as_u64() > Some(1 << 20) && at("/bvh_bytes").as_u64() > Some(0), "{text}");
    assert_eq!((at("/threads"), at("/non_finite/count")), (&2.into(), &0.into()), "threads, non-finite");
    assert!(at("/pruned/by_depth").is_u64() && at("/pruned/by_attenuation").is_u64(), "{text}");
    assert_eq!(at("/scene_hash").as_str().map(str::len), Some(32), "{text}");
    let (status, planned, stderr) = place.run(&["plan", "ball.toml", "--json"]);
    assert_eq!(status, 0, "{stderr}");
    assert_eq!(*at("/plan"), serde_json::from_str::<serde_json::Value>(&planned).expect("JSON"), "the plan");
}

#[test]
fn a_failed_run_leaves_the_old_output_untouched() {
    let place = place();
    fs::write(place.path("a.exr"), "old").expect("written");
    fs::write(place.path("bad.toml"), BALL.replace("\"mirror\"\n[", "\"miror\"\n[")).expect("written");
    for words in [
        ["render", "bad.toml", "-o", "a.exr", "-q"],
        ["render", "ball.toml", "-o", "a.exr", "--crop=0,0,99,99"],
        ["render", "ball.toml", "-o", "a.exr", "--spp=0"],
    ] {
        let (status, stdout, stderr) = place.run(&words);
        assert_eq!((status, stdout.as_str()), (2, ""), "{words:?}: {stderr}");
        assert_eq!(fs::read(place.path("a.exr")).expect("there"), b"old", "{words:?}");
    }
    assert_eq!(place.names(), ["a.exr", "bad.toml", "ball.toml"], "nothing else is left");
}

#[cfg(target_os = "linux")]
#[test]
fn a_place_that_cannot_be_written_is_a_failure_while_running() {
    // /proc is a directory in which not even root can create a file.
    let place = place();
    let (status, stdout, stderr) = place.run(&["render", "ball.toml", "-q", "-o", "/proc/a.exr"]);
    assert_eq!((status, stdout.as_str()), (1, ""), "{stderr}");
    assert!(stderr.contains("error: /proc/a.exr: cannot write: "), "{stderr}");
}

#[test]
fn logs_can_be_json() {
    let place = place();
    let words = ["render", "ball.toml", "-o", "a.png", "--log-format", "json"];
    let (status, _, stderr) = place.run(&words);
    assert_eq!(status, 0, "{stderr}");
    let failed = place.run(&["render", "ball.toml", "--spp", "0", "--log-format", "json"]);
    assert_eq!(failed.0, 2, "{}", failed.2);
    for (text, level) in [(stderr, "INFO"), (failed.2, "ERROR")] {
        let line = text.lines().next().expect("a line");
        let entry: serde_json::Value = serde_json::from_str(line).expect("JSON");
        assert_eq!(entry["level"], level, "{line}");
        assert!(entry["fields"]["message"].is_string(), "{line}");
    }
}

#[test]
fn log_levels_choose_what_is_told() {
    let place = place();
    let told = |words: &[&str]| {
        let words = [&["render", "ball.toml", "-o", "a.png"], words].concat();
        place.run(&words).2
    };
    assert!(told(&[]).contains("samples in"), "a summary");
    assert_eq!(told(&["--log-level", "warn"]), "", "no summary");
    assert!(told(&["-q", "--log-level", "info"]).contains("samples in"), "the level wins over -q");
    let empty = told(&["-D", "shapes=[]", "-q"]);
    assert!(empty.starts_with("warning: ") && empty.contains("empty"), "{empty}");
    assert_eq!(told(&["-D", "shapes=[]", "--log-level", "error"]), "", "no warnings");
}

#[test]
fn completions_are_there_for_common_shells() {
    let place = place();
    for (shell, part) in
        [("bash", "complete -F"), ("zsh", "#compdef specula"), ("fish", "complete -c specula")]
    {
        let (status, stdout, stderr) = place.run(&["completions", shell]);
        assert_eq!((status, stderr.as_str()), (0, ""), "{shell}");
        assert!(stdout.contains(part) && stdout.contains("min-throughput"), "{shell}: {stdout}");
        assert!(stdout.contains("whitted"), "{shell} completes values");
    }
}

#[test]
fn manual_pages_go_to_standard_output_or_a_directory() {
    let place = place();
    let (status, stdout, _) = place.run(&["man"]);
    assert!(status == 0 && stdout.contains(".TH specula 1"), "{stdout}");
    fs::create_dir(place.path("man")).expect("created");
    let (status, stdout, stderr) = place.run(&["man", "--dir", "man"]);
    assert_eq!(status, 0, "{stderr}");
    let names: Vec<_> = stdout.lines().collect();
    let wanted = [
        "",
        "-render",
        "-plan",
        "-batch",
        "-merge",
        "-farm",
        "-farm-slurm",
        "-farm-openjd",
        "-diff",
        "-fuzzy",
        "-bench",
        "-tradeoff",
        "-schema",
        "-completions",
        "-man",
    ]
    .map(|sub| format!("specula{sub}"));
    assert_eq!(names, wanted.map(|name| format!("man/{name}.1")), "pages");
    let page = fs::read_to_string(place.path("man/specula-render.1")).expect("there");
    assert!(page.contains("min\\-throughput") && page.contains(".TH specula-render 1"), "{page}");
    assert_eq!(place.run(&["man", "--dir", "nowhere"]).0, 2, "no directory");
}

#[test]
fn the_schema_is_json() {
    let (status, stdout, _) = place().run(&["schema"]);
    let schema: serde_json::Value = serde_json::from_str(&stdout).expect("JSON");
    assert_eq!(status, 0, "status");
    assert!(schema["properties"]["render"].is_object(), "{stdout}");
}

/// A reader that takes a little and goes away, as `head` does.
#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_error() {
    use std::process::{Command, Stdio};
    let program = assert_cmd::cargo::cargo_bin("specula");
    for words in ["schema", "--help", "man"] {
        let mut child = Command::new(&program)
            .arg(words)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("started");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("ended");
        assert_eq!(output.status.code(), Some(0), "{words}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{words}");
    }
}

/// Ctrl-C ends a rendering of a quarter of an hour with status 130 and without files.
#[cfg(unix)]
#[test]
fn an_interrupt_ends_with_130_and_no_files() {
    use std::io::{BufRead as _, BufReader};
    use std::time::{Duration, Instant};
    let place = place();
    let words = ["render", "ball.toml", "-o", "a.exr", "--spp", "100000", "--width", "640"];
    let mut child = running::spawn(&place, &[&words[..], &["--log-level", "debug"]].concat());
    // Its first line says that it listens to signals and has begun.
    let mut stderr = BufReader::new(child.stderr.take().expect("piped"));
    let mut line = String::new();
    stderr.read_line(&mut line).expect("a line");
    assert!(line.contains("reading ball.toml"), "{line}");
    std::thread::sleep(Duration::from_millis(300));
    let asked = Instant::now();
    running::signal(&child, "-INT");
    let status = child.wait().expect("ended");
    assert_eq!(status.code(), Some(130), "status");
    assert!(asked.elapsed() < Duration::from_secs(60), "after {:?}", asked.elapsed());
    assert_eq!(place.names(), ["ball.toml"], "no files");
}

#[test]
fn scenes_are_found_relative_to_where_the_program_runs() {
    let place = place();
    fs::create_dir(place.path("sub")).expect("created");
    fs::rename(place.path("ball.toml"), place.path("sub/ball.toml")).expect("moved");
    let (status, stdout, stderr) =
        place.run(&["render", &Path::new("sub/ball.toml").display().to_string(), "-q"]);
    assert_eq!((status, stdout.as_str()), (0, "ball.exr\nball.png\n"), "{stderr}");
}

#[test]
fn nothing_that_is_read_is_overwritten_and_nothing_is_written_twice() {
    let place = place();
    let cases: [(&[&str], &[&str]); 8] = [
        (&["render", "ball.toml", "--stats", "ball.toml"], &["`ball.toml` is read and would be overwritten"]),
        (&["render", "ball.toml", "--stats", "./ball.toml"], &["`./ball.toml` is read and would"]),
        (&["render", "ball.toml", "-o", "a.exr", "-o", "./a.exr"], &["`./a.exr` would be written twice"]),
        (
            &["render", "ball.toml", "-o", "a.exr", "--stats", "./a.exr"],
            &["`./a.exr` would be written twice"],
        ),
        (&["bench", "ball.toml", "--report", "ball.toml"], &["`ball.toml` is read and would be overwritten"]),
        (&["bench", "ball.toml", "--record", "./ball.toml"], &["`./ball.toml` is read and would"]),
        (&["bench", "ball.toml", "--report", "a", "--record", "./a"], &["`a` would be written twice"]),
        (
            &["bench", "ball.toml", "--replay", "ball.toml", "--report", "ball.toml"],
            &["`ball.toml` is read and would be overwritten"],
        ),
    ];
    for (words, parts) in cases {
        let (status, stdout, stderr) = place.run(words);
        assert_eq!((status, stdout.as_str()), (2, ""), "{words:?}: {stderr}");
        for part in parts {
            assert!(stderr.contains(part), "{words:?}: `{part}` in {stderr}");
        }
        assert_eq!(fs::read(place.path("ball.toml")).expect("there"), BALL.as_bytes(), "{words:?}");
    }
    assert_eq!(place.names(), ["ball.toml"], "nothing was written");
}

/// Whatever the scene is made of, also what its files name, and by names that nobody gave.
#[test]
fn files_of_the_scene_are_not_overwritten() {
    let desk = models::desk();
    models::write(&desk, "paint.toml", &models::scene(""));
    models::write(&desk, "outer.toml", "include = [\"still.toml\"]\n");
    let all =
        || desk.names().iter().map(|name| (name.clone(), models::read(&desk, name))).collect::<Vec<_>>();
    let before = all();
    let numbered = "materials.wall.reflectance={ file = 'paint.2.png' }";
    let cases: [(&[&str], &str); 9] = [
        (&["render", "paint.toml"], "paint.png"),
        (&["render", "still.toml", "-o", "./paint.png"], "./paint.png"),
        (&["render", "still.toml", "-o", "a.exr", "--stats", "model.obj"], "model.obj"),
        (&["render", "still.toml", "-o", "a.exr", "--stats", "model.mtl"], "model.mtl"),
        (&["render", "still.toml", "-o", "a.exr", "-o", "inner.png"], "inner.png"),
        (&["render", "outer.toml", "-o", "a.exr", "--checkpoint", "still.toml", "--resume"], "still.toml"),
        (&["render", "still.toml", "-D", numbered, "--frames", "1..2", "-o", "paint.#.png"], "paint.2.png"),
        (&["farm", "slurm", "paint.toml"], "paint.png"),
        (&["farm", "openjd", "still.toml", "-o", "inner.png"], "inner.png"),
    ];
    for (words, name) in cases {
        let (status, stdout, stderr) = desk.run(words);
        assert_eq!((status, stdout.as_str()), (2, ""), "{words:?}: {stderr}");
        let told = format!("error: `{name}` is read and would be overwritten; name another file to write");
        assert!(stderr.contains(&told), "{words:?}: {stderr}");
        assert!(all() == before, "{words:?}: {:?}", desk.names());
    }
}

#[test]
fn pictures_tell_what_they_were_shaded_with() {
    let place = place();
    for level in specula::math::lanes::Level::available() {
        // Portable arrays are for what is not shading.
        let wide = match level.name() {
            "portable" => "scalar x 1".to_owned(),
            name => format!("{name} x {}", level.width()),
        };
        for (flags, expected) in [
            (&["--integrator", "path"][..], wide.as_str()),
            (&["--integrator", "path", "--query", "single"], "scalar x 1"),
            (&["--integrator", "whitted", "--backend", "bvh2"], "scalar x 1"),
        ] {
            let mut command = place.command();
            command.args(["render", "ball.toml", "-q", "-o", "a.exr", "--stats", "a.json"]).args(flags);
            let output = command.env("SPECULA_ISA", level.name()).output().expect("run");
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            let picture = exr::read(&place.path("a.exr")).expect("a picture");
            assert_eq!(picture.attribute("specula:lanes"), Some(expected), "{wide}, {flags:?}");
            let stats = fs::read(place.path("a.json")).expect("written");
            let stats: serde_json::Value = serde_json::from_slice(&stats).expect("JSON");
            assert_eq!(stats["lanes"], expected, "{wide}, {flags:?}");
            assert!(picture.attribute("specula:isa").is_some_and(|isa| isa == stats["isa"]), "the backend's");
        }
    }
}
