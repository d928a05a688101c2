//! Pictures for an error or a time: `render --preset` and `--budget`; what was predicted, and what came of it.

use crate::desk::Desk;
use crate::pictures::relmse;
use crate::room::corner;
use crate::{clock, place};
use serde_json::Value;
use specula::image;
use std::fs;

/// What the statistics say of a picture of `a.toml`, and what the log does.
fn rendered(desk: &Desk, words: &[&str]) -> (Value, String) {
    let all = [&["render", "a.toml", "-o", "a.exr", "--stats", "a.json"], words].concat();
    let (status, _, said) = desk.run(&all);
    assert_eq!(status, 0, "{words:?}: {said}");
    let text = fs::read_to_string(desk.path("a.json")).expect("written");
    (serde_json::from_str(&text).expect("JSON"), said)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The relMSE of a picture against a long one.
fn error(desk: &Desk, settings: &str) -> f64 {
    fs::write(desk.path("long.toml"), corner(settings)).expect("written");
    let words = ["render", "long.toml", "-q", "--spp", "4096", "--seed", "99", "-o", "long.exr"];
    assert_eq!(desk.run(&words).0, 0, "a long picture");
    let [test, reference] =
        ["a.exr", "long.exr"].map(|name| image::read(&desk.path(name)).expect("a picture"));
    relmse(test, reference)
}

#[test]
fn a_preset_reaches_its_error() {
    let _clock = clock();
    for settings in ["integrator = \"path\"", "integrator = \"whitted\""] {
        let desk = place(settings);
        let (stats, said) = rendered(&desk, &["--preset", "preview"]);
        let cost = &stats["cost"];
        let predicted = number(&cost["predicted"]["relmse"]);
        let found = error(&desk, settings);
        println!(
            "{settings}: {} samples, predicted {predicted:.2e}, found {found:.2e}",
            cost["predicted"]["spp"]
        );
        assert!(predicted <= 0.01 * 1.001, "{cost:#}");
        assert!(found < 0.015, "{settings}: found {found}, and 0.01 was asked for");
        assert!(
            (0.3..3.0).contains(&(found / predicted)),
            "{settings}: predicted {predicted}, found {found}"
        );
        assert!(
            (number(&cost["predicted"]["spp"]) - number(&cost["achieved"]["spp"])).abs() < 1e-9,
            "{cost:#}"
        );
        if number(&cost["achieved"]["spp"]) >= 32.0 {
            let estimated = number(&cost["achieved"]["estimated_relmse"]);
            assert!(
                (0.2..5.0).contains(&(estimated / found)),
                "{settings}: estimated {estimated}, found {found}"
            );
        } else {
            println!("skipped: {settings} has too few samples for an estimate");
        }
        assert!(said.contains("preset preview") && said.contains("--spp "), "{said}");
        // The same again by the flags that were told.
        let flags = said.lines().find(|line| line.contains("preset preview")).expect("told");
        let flags =
            flags.split_once(": ").and_then(|(_, rest)| rest.split_once(';')).expect("flags").0.to_owned();
        let before = image::read(&desk.path("a.exr")).expect("a picture").image;
        let words: Vec<&str> = flags.split_whitespace().collect();
        let (stats, _) = rendered(&desk, &words);
        assert!(stats["cost"].is_null(), "nobody chose: {stats:#}");
        assert_eq!(image::read(&desk.path("a.exr")).expect("a picture").image, before, "{flags}");
    }
}

#[test]
fn flags_have_the_last_word() {
    let desk = place("integrator = \"path\"");
    let (stats, _) =
        rendered(&desk, &["--preset", "draft", "--spp", "3", "-D", "render.sampler=independent"]);
    assert_eq!(
        (&stats["spp"], &stats["cost"]["predicted"]["spp"]),
        (&3.into(), &serde_json::json!(3.0)),
        "{stats:#}"
    );
    let text = fs::read(desk.path("a.exr")).expect("a picture");
    assert!(text.windows(11).any(|word| word == b"independent"), "the sampler of the flag");
}

#[test]
fn a_budget_is_spent_and_its_error_predicted() {
    let _clock = clock();
    let settings = "integrator = \"path\"";
    let desk = place(settings);
    let sweep = [
        "tradeoff",
        "a.toml",
        "-q",
        "--knob",
        "spp=4,16",
        "--knob",
        "max_depth=2,16",
        "--runs",
        "3",
        "--reference-spp",
        "256",
    ];
    assert_eq!(desk.run(&[&sweep[..], &["--keep", "a.runs"]].concat()).0, 0, "a sweep");
    for more in [&[][..], &["--tradeoff", "a.runs"][..]] {
        let (stats, said) = rendered(&desk, &[&["--budget", "1s"], more].concat());
        let cost = &stats["cost"];
        assert_eq!(stats["ended_by"], "time", "{stats:#}");
        assert_eq!(cost["asked"]["budget_s"], 1.0, "{cost:#}");
        assert!(number(&cost["predicted"]["wall_s"]) > 0.0 && said.contains("budget"), "{cost:#}, {said}");
        let estimated = number(&cost["achieved"]["estimated_relmse"]);
        assert!(estimated > 0.0 && estimated < 0.1, "{cost:#}");
        // Of as many samples as there came to be: a busy machine has time for fewer. Errors fall faster than a look at some pixels can know.
        let [predicted, achieved] = ["predicted", "achieved"].map(|what| number(&cost[what]["spp"]));
        let expected = number(&cost["predicted"]["relmse"]) * predicted / achieved;
        println!(
            "{:.2} s, {achieved} of {predicted:.0} samples: expected {expected:.2e}, estimated {estimated:.2e}",
            number(&cost["achieved"]["wall_s"])
        );
        assert!((0.02..3.0).contains(&(estimated / expected)), "{cost:#}");
        assert_ne!(cost["set"]["render.max_depth"], "2", "direct light alone is too little: {cost:#}");
    }
}

#[test]
fn a_filtered_picture_has_a_budget_by_its_runs() {
    let _clock = clock();
    let desk = place("integrator = \"whitted\"\nglossy = \"two-pass\"\nfuzzy.max_radius = 6");
    let sweep = ["tradeoff", "a.toml", "-q", "--knob", "spp=1,4", "--runs", "3", "--reference-spp", "16"];
    assert_eq!(desk.run(&[&sweep[..], &["--keep", "a.runs"]].concat()).0, 0, "a sweep");
    let (stats, said) = rendered(&desk, &["--budget", "1s", "--tradeoff", "a.runs"]);
    assert_eq!(stats["ended_by"], "time", "{stats:#}");
    assert!(said.contains("budget, by the runs in a.runs"), "{said}");
}

#[test]
fn what_does_not_go_together_is_refused() {
    let desk = place("integrator = \"path\"");
    let refused = |words: &[&str], parts: &[&str]| {
        let (status, _, said) = desk.run(&[&["render", "a.toml", "-q"], words].concat());
        assert_eq!(status, 2, "{words:?}: {said}");
        parts.iter().for_each(|part| assert!(said.contains(part), "{part} in {said}"));
    };
    refused(&["--preset", "finest"], &["--preset finest", "draft, preview, final, reference"]);
    refused(&["--budget", "soon"], &["--budget soon", "90s"]);
    refused(&["--preset", "draft", "--budget", "3s"], &["leave out one of them"]);
    refused(&["--budget", "3s", "--time-limit", "3s"], &["`--time-limit`"]);
    refused(&["--tradeoff", "a.toml"], &["`--tradeoff` without a budget"]);
    refused(&["--preset", "draft", "--slice", "0/2"], &["--slice", "the flags that it told"]);
    refused(&["--budget", "3s", "--checkpoint", "a.ckpt"], &["--checkpoint"]);
    refused(&["--preset", "draft", "--view", "depth"], &["no noise to choose settings by"]);
    let filtered = ["--integrator", "whitted", "--glossy", "two-pass"];
    let remedy = "`--spp` or `--time-limit`, or `glossy = \"lobe\"`";
    refused(&[&["--preset", "draft"], &filtered[..]].concat(), &["a preset goes by noise", remedy]);
    let parts = ["a budget without runs of the scene goes by noise", "`--tradeoff`", remedy];
    refused(&[&["--budget", "3s"], &filtered[..]].concat(), &parts);
    refused(&["--budget", "3s", "--tradeoff", "a.toml"], &["a.toml:1: not the head of a file of runs"]);
    let sweep = ["tradeoff", "a.toml", "-q", "--knob", "spp=1", "--runs", "2", "--reference-spp", "4"];
    assert_eq!(desk.run(&[&sweep[..], &["--keep", "a.runs"]].concat()).0, 0, "a sweep");
    let other = ["--budget", "3s", "--tradeoff", "a.runs", "-D", "materials.ball.exponent=3"];
    refused(&other, &["runs of another scene: `scene.materials", "20.0 there and 3.0 here"]);
    let other = ["--budget", "3s", "--tradeoff", "a.runs", "--integrator", "whitted"];
    let told = "a.runs: runs under other settings: `render.integrator` is \"path\" there and \"whitted\" here; set what";
    refused(&other, &[told]);
}
