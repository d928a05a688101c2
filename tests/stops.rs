//! What ends a picture: time, or the number of samples. It is the picture of the samples that it has, to the bit.

#[path = "support/desk.rs"]
mod desk;
#[path = "support/room.rs"]
mod room;
#[path = "support/scene.rs"]
mod scene;

use desk::Desk;
use room::room;
use scene::bits;
use specula::film::{Aov, Layout};
use specula::image::exr;
use specula::render::{Ended, Limits, Rendered, Settings};
use std::time::Duration;

fn rendered(text: &str, limits: Limits) -> Rendered {
    let layout = Layout::with([Aov::Variance, Aov::Samples, Aov::Depth]);
    scene::rendered(text, &Settings { layout, limits, ..Settings::default() })
}

fn seconds(seconds: f64) -> Limits {
    Limits { time: Some(Duration::from_secs_f64(seconds)), ..Limits::default() }
}

const WAYS: [(&str, &str); 5] = [
    ("path", "single"),
    ("path", "packet"),
    ("path", "stream"),
    ("whitted", "single"),
    ("distribution", "stream"),
];

#[test]
fn a_picture_that_time_ended_is_that_of_its_samples() {
    for (integrator, query) in WAYS {
        // Of Embree's packets those that are coherent may meet edges elsewhere, and how packets come depends on the pace.
        let settings = format!("integrator = \"{integrator}\"\nquery = \"{query}\"\nbackend = \"bvh2\"");
        let stopped = rendered(&room(&settings), seconds(0.25));
        assert_eq!(stopped.statistics.ended, Ended::Time, "{settings}");
        let [least, most] = stopped.film.samples_of_pixels();
        assert!(least == most && most > 0, "{settings}: all pixels have the same: {least}, {most}");
        println!("{integrator}, {query}: {most} samples");
        let whole = rendered(&room(&format!("{settings}\nspp = {most}")), Limits::default());
        assert_eq!(whole.statistics.ended, Ended::Samples, "{settings}");
        assert!(bits(&stopped.film) == bits(&whole.film), "{settings}: {most} samples");
        assert_eq!(stopped.statistics.counters, whole.statistics.counters, "{settings}: rays");
    }
}

/// What the program says of a picture.
fn told(desk: &Desk, name: &str) -> serde_json::Value {
    let text = std::fs::read_to_string(desk.path(name)).expect("written");
    serde_json::from_str(&text).expect("JSON")
}

/// All samples would take ten times as long and more, so that a limit that is not kept shows. Judged is the time of the processor, to which
/// a busy machine adds nothing, and which the program spends on the picture alone.
#[test]
fn time_ends_a_picture_in_time() {
    const THREADS: f64 = 2.0;
    const LIMIT: f64 = 0.5;
    for (integrator, query, more) in [
        ("path", "stream", ""),
        ("path", "single", ""),
        ("whitted", "stream", ""),
        ("whitted", "single", "glossy = \"two-pass\""),
    ] {
        let settings = format!("integrator = \"{integrator}\"\nquery = \"{query}\"\n{more}");
        let text =
            room(&settings).replace("width = 37", "width = 240").replace("height = 21", "height = 160");
        let desk = Desk::new();
        std::fs::write(desk.path("a.toml"), text).expect("a scene");
        let words = ["render", "a.toml", "-q", "-t", "2", "-o", "a.exr", "--stats", "a.json"];
        let (status, _, said) = desk.run(&[&words[..], &["--time-limit", "500ms"]].concat());
        assert_eq!(status, 0, "{said}");
        let stats = told(&desk, "a.json");
        assert_eq!(stats["ended_by"], "time", "{settings}");
        let most = stats["samples_per_pixel"]["max"].as_f64().expect("a number");
        let spent = stats["phases"]["render"]["cpu_s"].as_f64().expect("a number");
        println!("{integrator}, {query}, {more}: {most} samples in {spent:.2} CPU s, of {}", LIMIT * THREADS);
        assert!(spent < 1.25 * LIMIT * THREADS, "{settings}: {spent} CPU s");
        assert!(
            f64::from(1 << 16) / most * spent > 10.0 * LIMIT * THREADS,
            "{settings}: all samples take much longer"
        );
    }
}

#[test]
fn time_that_is_not_needed_changes_nothing() {
    for sampler in ["sobol", "stratified", "blue_noise"] {
        for spp in [5, 32] {
            let text = room(&format!("integrator = \"path\"\nsampler = \"{sampler}\"\nspp = {spp}"));
            let (limited, plain) = (rendered(&text, seconds(3600.0)), rendered(&text, Limits::default()));
            assert_eq!(limited.statistics.ended, Ended::Samples, "{sampler}, {spp}");
            assert!(bits(&limited.film) == bits(&plain.film), "{sampler}, {spp}");
        }
    }
}

#[test]
fn one_sample_is_taken_however_little_time_there_is() {
    let stopped = rendered(&room("integrator = \"whitted\""), seconds(1e-9));
    assert_eq!(stopped.statistics.ended, Ended::Time, "no time");
    assert_eq!(stopped.film.samples_of_pixels(), [1, 1], "one each");
    let whole = rendered(&room("integrator = \"whitted\"\nspp = 1"), Limits::default());
    assert!(bits(&stopped.film) == bits(&whole.film), "the first");
}

#[test]
fn the_program_tells_what_ended_the_picture() {
    let desk = Desk::new();
    std::fs::write(desk.path("a.toml"), room("integrator = \"path\"")).expect("a scene");
    let words = ["render", "a.toml", "-o", "a.exr", "--stats", "a.json", "--time-limit", "300ms"];
    let (status, _, said) = desk.run(&words);
    assert_eq!(status, 0, "{said}");
    assert!(said.contains("the time was over"), "{said}");
    let stats = told(&desk, "a.json");
    assert_eq!(stats["ended_by"], "time", "{stats}");
    assert_eq!(stats["time_limit_s"], 0.3, "{stats}");
    let spp = stats["spp"].as_u64().expect("a number");
    assert_eq!(stats["samples_per_pixel"]["min"].as_u64(), Some(spp), "{stats}");
    assert_eq!(stats["samples"].as_u64(), Some(spp * 37 * 21), "{stats}");
    let picture = exr::read(&desk.path("a.exr")).expect("readable");
    assert_eq!(picture.attribute("specula:spp"), Some(spp.to_string().as_str()), "samples taken");
    assert_eq!(picture.attribute("specula:samples"), Some(format!("0..{spp}").as_str()), "which");
    assert_eq!(picture.attribute("specula:ended_by"), Some("time"), "why");
    let (status, _, said) = desk.run(&["render", "a.toml", "-o", "a.exr", "--spp", "3", "--stats", "b.json"]);
    assert_eq!(status, 0, "{said}");
    let stats = told(&desk, "b.json");
    assert_eq!((&stats["ended_by"], &stats["spp"]), (&"samples".into(), &3.into()), "{stats}");
    for wrong in ["0", "-1", "fast", "3d"] {
        let (status, _, said) = desk.run(&["render", "a.toml", "-o", "c.exr", "--time-limit", wrong]);
        assert!(status == 2 && said.contains("--time-limit") && said.contains("90s"), "{status}: {said}");
    }
}
