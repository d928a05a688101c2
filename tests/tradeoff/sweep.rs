//! The command `tradeoff`: a small sweep from end to end, gone on with after it was stopped; what is refused; and that noise falls as it must.

use crate::desk::Desk;
use crate::place;
use serde_json::Value;
use specula::render::Silent;
use specula::tradeoff::design::Design;
use specula::tradeoff::runs::{Bench, Sweep, Tally};
use specula::tradeoff::{Reference, Subject, outcomes};
use specula::trust::Trust;
use std::fs;

/// Few points, few samples.
const SMALL: [&str; 10] = [
    "--knob",
    "spp=2,8",
    "--knob",
    "max_depth=2,6",
    "--runs",
    "3",
    "--reference-spp",
    "64",
    "--target",
    "1e-1,1e-9",
];

/// The program on `a.toml`: its standard output.
fn sweep(desk: &Desk, words: &[&str]) -> String {
    let words = [&["tradeoff", "a.toml", "-q"], words].concat();
    let (status, stdout, stderr) = desk.run(&words);
    assert_eq!(status, 0, "{words:?}: {stderr}");
    stdout
}

fn json(desk: &Desk, words: &[&str]) -> Value {
    let text = sweep(desk, &[&SMALL[..], &["--json"], words].concat());
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn points(document: &Value) -> &Vec<Value> {
    document["points"].as_array().unwrap_or_else(|| panic!("points in {document:#}"))
}

/// The point where these are set.
fn point<'a>(document: &'a Value, set: &Value) -> &'a Value {
    let found = points(document).iter().find(|it| it["set"] == *set);
    found.unwrap_or_else(|| panic!("{set} in {document:#}"))
}

fn value(point: &Value, figure: &str) -> f64 {
    point[figure][0].as_f64().unwrap_or_else(|| panic!("{figure} in {point:#}"))
}

#[test]
fn a_sweep_tells_bias_from_noise() {
    let desk = place("integrator = \"path\"\nmax_depth = 5");
    let document = json(&desk, &["--csv", "a.csv", "--report", "a.html"]);
    // As the scene says, two and six edges; each at two numbers of samples.
    assert_eq!(points(&document).len(), 6, "{document:#}");
    assert_eq!(document["reference"]["settings"]["render.max_depth"], "6", "the deepest of all");
    let shallow = point(&document, &serde_json::json!({ "render.spp": "8", "render.max_depth": "2" }));
    let deep = point(&document, &serde_json::json!({ "render.spp": "8", "render.max_depth": "6" }));
    let bias = [shallow, deep].map(|it| value(it, "bias2"));
    assert!(bias[0] > 0.02 && bias[1].abs() < bias[0] * 0.3, "direct light alone is too little: {bias:?}");
    assert!(value(shallow, "brightness") < -0.1, "and darker: {shallow:#}");
    for it in points(&document) {
        let sum = value(it, "bias2") + value(it, "variance");
        let error = value(it, "relmse");
        assert!((sum - error).abs() <= 0.05 * error, "error is bias and variance: {it:#}");
        assert!(it["relmse"][1].as_f64().is_some_and(|half| half > 0.0), "with an interval: {it:#}");
        assert!(value(it, "cpu_s") > 0.0 && it["runs"] == 3, "{it:#}");
    }
    let front = document["front"].as_array().expect("a list");
    assert!(!front.is_empty() && front.len() <= 6, "{front:?}");
    let advice = &document["recommendations"];
    assert!(advice[0]["best"]["spp"].as_u64().is_some_and(|spp| spp >= 1), "{advice:#}");
    assert!(advice[0]["sentence"].as_str().is_some_and(|text| text.contains("for relMSE 0.1")), "{advice:#}");

    let csv = fs::read_to_string(desk.path("a.csv")).expect("written");
    assert_eq!(csv.lines().count(), 7, "{csv}");
    assert!(csv.starts_with("spp,runs,max_depth,cpu_s,cpu_s_half,"), "{csv}");
    let page = fs::read_to_string(desk.path("a.html")).expect("written");
    for part in
        ["<svg", "data:image/png;base64,", "type=\"range\"", "as the scene says", "max_depth", "opt-level"]
    {
        assert!(page.contains(part), "{part} in the page");
    }
    let links = page.matches("http").count() - page.matches("http://www.w3.org/2000/svg").count();
    assert_eq!(links, 0, "the page needs nothing else");
    assert_eq!(desk.names(), ["a.csv", "a.html", "a.toml"], "no file that was not asked for");
}

#[test]
fn the_table_tells_what_is_not_turned_and_what_to_take() {
    let desk = place("integrator = \"whitted\"");
    let words = [
        "--runs",
        "2",
        "--width",
        "9",
        "--height",
        "5",
        "--reference-spp",
        "16",
        "-D",
        "render.split_depth=1",
    ];
    let text = sweep(&desk, &words);
    for part in [
        "a.toml: 9 x 5, ",
        "not turned: roulette (a knob of the integrator `path`)",
        "not turned: split_depth (no hit sends more than one ray of a kind)",
        "not turned: filter (each filter is another picture, and none is wrong)",
        "glossy = two-pass",
        "as the scene says",
        "for relMSE 0.0100: ",
        "*",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn a_sweep_goes_on_where_it_was_left() {
    let desk = place("integrator = \"path\"");
    let whole = json(&desk, &["--keep", "a.jsonl"]);
    let text = fs::read_to_string(desk.path("a.jsonl")).expect("kept");
    assert_eq!(text.lines().count(), 1 + 6 * 3, "a head and each run");
    let again = json(&desk, &["--resume", "a.jsonl"]);
    assert_eq!(fs::read_to_string(desk.path("a.jsonl")).expect("kept"), text, "nothing was missing");
    assert_eq!(points(&again), points(&whole), "the same figures");

    // As if it had been killed in the eleventh run.
    let cut: String = text.lines().take(1 + 10).map(|line| format!("{line}\n")).collect();
    fs::write(desk.path("a.jsonl"), format!("{cut}{{\"point\":\"")).expect("written");
    let resumed = json(&desk, &["--resume", "a.jsonl"]);
    let now = fs::read_to_string(desk.path("a.jsonl")).expect("kept");
    assert!(now.starts_with(&cut) && now.lines().count() == 1 + 6 * 3, "the rest was added: {now}");
    for (a, b) in points(&whole).iter().zip(points(&resumed)) {
        let [a_error, b_error] = [a, b].map(|it| value(it, "relmse"));
        assert!((a_error / b_error - 1.0).abs() < 1e-9, "the same pictures: {a:#}, {b:#}");
        assert_eq!((&a["set"], &b["runs"]), (&b["set"], &3.into()), "{b:#}");
    }
    // More values: what is there is not rendered again.
    let words = [
        "tradeoff",
        "a.toml",
        "-q",
        "--knob",
        "spp=2,8,16",
        "--knob",
        "max_depth=2,6",
        "--runs",
        "3",
        "--reference-spp",
    ];
    let (status, _, said) = desk.run(&[&words[..], &["64", "--resume", "a.jsonl"]].concat());
    assert_eq!(status, 0, "{said}");
    let more = fs::read_to_string(desk.path("a.jsonl")).expect("kept");
    assert!(more.starts_with(&now) && more.lines().count() == 1 + 9 * 3, "{more}");
}

#[test]
fn another_reference_is_refused_before_it_is_rendered() {
    let desk = place("integrator = \"path\"");
    let small = ["--runs", "2", "--width", "9", "--height", "5"];
    sweep(&desk, &[&small[..], &["--knob", "spp=2", "--keep", "a.jsonl"]].concat());
    let files = || desk.names().into_iter().map(|name| (fs::read(desk.path(&name)).expect("a file"), name));
    let before: Vec<_> = files().collect();
    // Sixteen times the most samples, at least 256.
    let more = ["tradeoff", "a.toml", "-q", "--knob", "spp=2,32", "--resume", "a.jsonl"];
    let (status, _, said) = desk.run(&[&more[..], &small[..]].concat());
    assert!(status == 2 && said.contains("`reference.spp` is 256 there and 512 here"), "{status}: {said}");
    assert!(files().eq(before), "no file has changed, the reference least of all");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let desk = place("integrator = \"path\"");
    let refused = |words: &[&str], parts: &[&str]| {
        let (status, stdout, said) = desk.run(&[&["tradeoff", "a.toml", "-q"], words].concat());
        assert_eq!((status, stdout.as_str()), (2, ""), "{words:?}: {said}");
        parts.iter().for_each(|part| assert!(said.contains(part), "{part} in {said}"));
    };
    refused(&["--knob", "max_deep"], &["there is no knob `max_deep`", "max_depth"]);
    refused(&["--knob", "max_depth=0"], &["max_depth", "from 1 to"]);
    refused(&["--knob", "sampler=sobel"], &["sobel", "sobol"]);
    refused(&["--design", "spiral"], &["--design spiral", "random:N"]);
    refused(&["--runs", "1"], &["--runs 1", "from 2 to"]);
    refused(&["--reference", "gone.exr"], &["gone.exr", "no such file"]);
    refused(&["-D", "render.integrator=view"], &["shows no light"]);
    refused(&["--report", "nowhere/a.html", "--csv", "a.toml"], &["nowhere", "overwritten"]);
    let grid: Vec<String> = (1..300).map(|i| i.to_string()).collect();
    let [spp, depth] = ["spp", "max_depth"].map(|knob| format!("{knob}={}", grid.join(",")));
    refused(
        &["--design", "grid", "--knob", &spp, "--knob", &depth],
        &["89401 points are too many", "random:N"],
    );

    let (status, _, said) =
        desk.run(&["render", "a.toml", "-q", "--spp", "1", "--width", "8", "-o", "small.exr"]);
    assert_eq!(status, 0, "{said}");
    refused(&["--reference", "small.exr"], &["8 by 21", "37 by 21"]);
    let small = [&SMALL[..], &["--knob", "query=single"]].concat();
    sweep(&desk, &[&small[..], &["--keep", "a.jsonl"]].concat());
    refused(&[&small[..], &["--keep", "a.jsonl"]].concat(), &["there is a file already", "--resume"]);
    refused(
        &[&small[..], &["--resume", "a.jsonl", "-D", "render.seed=5"]].concat(),
        &["`about.scene.render.seed` is 0 there and 5 here"],
    );
    refused(&[&small[..], &["--resume", "a.toml"]].concat(), &["overwritten"]);
}

#[test]
fn a_reference_from_a_file_has_its_noise_taken_out() {
    let desk = place("integrator = \"path\"");
    for (name, more) in [("plain.exr", &[][..]), ("known.exr", &["--aov", "variance"][..])] {
        let words = [
            "render",
            "a.toml",
            "-q",
            "--spp",
            "64",
            "-D",
            "render.sampler=independent",
            "--seed",
            "77",
            "-o",
            name,
        ];
        let (status, _, said) = desk.run(&[&words[..], more].concat());
        assert_eq!(status, 0, "{said}");
    }
    let of = |name: &str| {
        let words = [
            "--knob",
            "spp=16",
            "--runs",
            "4",
            "--reference",
            name,
            "--json",
            "-D",
            "render.sampler=independent",
        ];
        let text = sweep(&desk, &words);
        let document: Value = serde_json::from_str(&text).expect("JSON");
        (document["reference"]["noise"].clone(), points(&document)[0].clone())
    };
    let (unknown, plain) = of("plain.exr");
    let (noise, known) = of("known.exr");
    assert!(unknown.is_null() && noise[0].as_f64().is_some_and(|noise| noise > 0.0), "{noise}");
    let [plain_bias, bias] = [&plain, &known].map(|it| value(it, "bias2"));
    assert!(
        plain_bias > 3.0 * bias.abs(),
        "noise of the reference counts as bias unless it is known: {plain_bias}, {bias}"
    );
}

#[test]
fn variance_of_independent_samples_falls_as_one_over_their_number() {
    let desk = place("integrator = \"path\"\nsampler = \"independent\"\nroulette = \"off\"");
    let (mut subject, _) = Subject::read(&desk.path("a.toml"), &[], &Trust::default()).expect("a scene");
    let values = ["4", "16", "64"].map(str::to_owned);
    let axes = [subject.axis(specula::tradeoff::knobs::Knob::of("spp").expect("a knob"), &values)];
    let sweep = Sweep::new(&subject, &axes, Design::OneAtATime, 8).expect("points");
    let tally = Tally::new(&Silent, 1);
    let bench = Bench { threads: None, progress: &tally };
    let reference = Reference::render(&mut subject, Vec::new(), 2048, &bench).expect("a picture");
    let mut runs = Vec::new();
    let mut keep = |run: &specula::tradeoff::kept::Run| {
        runs.push(run.clone());
        Ok(())
    };
    sweep.run(&mut subject, &reference, (&[], &bench), &mut keep).expect("pictures");
    let found = outcomes(sweep.points(), &runs, reference.floor());
    let scaled: Vec<(f64, f64)> = found
        .iter()
        .map(|it| {
            let (spp, variance) = (f64::from(it.point.spp), it.moments.variance.expect("pairs"));
            (variance.value * spp, variance.half.expect("eight runs") * spp)
        })
        .collect();
    println!("variance times samples: {scaled:?}");
    // Twice the interval of 95 % and a tenth: one in ten thousand by chance, three such pairs.
    for (i, a) in scaled.iter().enumerate() {
        for b in &scaled[..i] {
            let doubt = 2.0 * a.1.hypot(b.1) + 0.1 * b.0;
            assert!((a.0 - b.0).abs() < doubt && doubt < b.0, "{scaled:?}");
        }
    }
    for it in &found {
        let bias = it.moments.bias2.expect("pairs");
        assert!(
            bias.value.abs() < 2.0 * bias.half.expect("eight runs") + 1e-6,
            "no bias: {bias:?} of {}",
            it.point.name()
        );
    }
}
