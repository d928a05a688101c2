//! Slices and crops that are merged are the picture of one go; parts that are not one picture are refused, and it is said which.

#[path = "support/desk.rs"]
mod desk;
#[path = "support/pictures.rs"]
mod pictures;
#[path = "support/room.rs"]
mod room;
#[path = "support/scene.rs"]
mod scene;

use desk::Desk;
use pictures::assert_values_close;
use room::{fuzzy_room, room};
use scene::{bits, scene_of};
use serde_json::{Value, json};
use specula::film::{Aov, Film, Layout, NonFinite, SampleId};
use specula::image::{Window, exr};
use specula::integrator::Counters;
use specula::render::{Outline, Part, Settings, Silent, Slice, order, outline, render};

const OUTPUTS: &str = "direct,indirect,albedo,normal,geometric_normal,depth,position,uv,variance,samples,object_id,material_id,cryptomatte";

fn settings(slice: Option<Slice>, crop: Option<Window>) -> Settings {
    Settings { layout: Layout::with(Aov::ALL), slice, crop, ..Settings::default() }
}

/// The film of all parts with these settings, added in their order, and their rays.
fn merged(scene: &specula::scene::Scene, parts: impl Iterator<Item = Settings>) -> (Film, Counters) {
    let mut counters = Counters::default();
    let parts: Vec<(Outline, Film)> = parts
        .map(|settings| {
            let rendered = render(scene, &settings, &Silent).expect("a part");
            let outline = outline(scene, &settings).expect("sound");
            assert_eq!(rendered.statistics.first, outline.samples.start, "which samples");
            counters += rendered.statistics.counters;
            (outline, rendered.film)
        })
        .collect();
    let outlines: Vec<&Outline> = parts.iter().map(|(outline, _)| outline).collect();
    let [width, height] = outlines[0].full;
    let mut film = Film::new([width, height], Window::whole(width, height), outlines[0].layout.clone());
    film = film.named(parts[0].1.names().clone());
    order(&outlines).into_iter().for_each(|part| film.add(&parts[part].1));
    (film, counters)
}

/// Asserts that two films agree to rounding, each channel relative to its greatest value.
fn assert_close(one: &Film, other: &Film, what: &str) {
    for &aov in one.layout().aovs() {
        let [one, other] = [one, other].map(|film| film.channels(aov).expect("kept"));
        // Sums of doubles in another order, then rounded to singles; variance is a difference of such sums.
        let tolerance = if aov == Aov::Variance { 1e-5 } else { 1e-6 };
        for (one, other) in one.iter().zip(&other) {
            assert_values_close(&format!("{what}: {}", aov.name()), one, other, (tolerance, None));
        }
    }
}

#[test]
fn slices_are_the_picture_within_rounding() {
    for (way, of) in [
        ("integrator = \"path\"\nspp = 64", 4),
        ("integrator = \"path\"\nspp = 40\nsampler = \"stratified\"", 5),
        ("integrator = \"path\"\nquery = \"single\"\nspp = 21\nsampler = \"blue_noise\"", 7),
        ("integrator = \"whitted\"\nspp = 48", 3),
        ("integrator = \"whitted\"\nquery = \"single\"\nspp = 7\nsampler = \"independent\"", 2),
        ("integrator = \"distribution\"\nspp = 6", 6),
        ("two-pass\nspp = 12", 3),
        ("two-pass\nintegrator = \"distribution\"\nspp = 7", 4),
    ] {
        let text = way.strip_prefix("two-pass").map_or_else(|| room(way), fuzzy_room);
        let scene = scene_of(&text);
        let whole = render(&scene, &settings(None, None), &Silent).expect("a picture");
        let parts = (0..of).map(|index| settings(Some(Slice { index, of }), None));
        let (film, counters) = merged(&scene, parts);
        assert_eq!(film.samples(), whole.film.samples(), "{way}");
        assert_eq!(counters, whole.statistics.counters, "{way}: rays");
        assert_close(&film, &whole.film, way);
    }
}

#[test]
fn crops_are_the_picture_to_the_bit() {
    let scene = scene_of(&room("integrator = \"path\"\nspp = 16"));
    let whole = render(&scene, &settings(None, None), &Silent).expect("a picture").film;
    let crops = [[0, 0, 20, 21], [20, 0, 37, 9], [20, 9, 37, 21]];
    let crops = crops.map(|[x0, y0, x1, y1]| Window { x0, y0, x1, y1 });
    let (film, _) = merged(&scene, crops.iter().map(|&crop| settings(None, Some(crop))));
    assert!(bits(&film) == bits(&whole), "crops");
    let slices = |crop: &Window| [0, 1].map(|index| settings(Some(Slice { index, of: 2 }), Some(*crop)));
    let scene = scene_of(&room("integrator = \"path\"\nspp = 32"));
    let whole = render(&scene, &settings(None, None), &Silent).expect("a picture").film;
    assert_close(&merged(&scene, crops.iter().flat_map(slices)).0, &whole, "crops in slices");
}

fn desk(spp: u32) -> Desk {
    let desk = Desk::new();
    std::fs::write(desk.path("a.toml"), room(&format!("integrator = \"path\"\nspp = {spp}")))
        .expect("written");
    desk
}

/// Renders with these flags, which must succeed.
fn rendered(desk: &Desk, flags: &[&str]) {
    let words: Vec<&str> =
        ["render", "a.toml", "-q", "--aov", OUTPUTS].iter().chain(flags).copied().collect();
    let (status, _, said) = desk.run(&words);
    assert_eq!(status, 0, "{flags:?}: {said}");
}

/// Merges these parts, and what is said.
fn merge(desk: &Desk, parts: &[&str], more: &[&str]) -> (i32, String) {
    let words: Vec<&str> = ["merge"].iter().chain(parts).chain(more).copied().collect();
    let (status, _, said) = desk.run(&words);
    (status, said)
}

#[test]
fn the_program_makes_parts_and_merges_them_in_any_order() {
    let desk = desk(32);
    rendered(&desk, &["-o", "whole.exr", "-o", "whole.png", "--stats", "whole.json"]);
    rendered(&desk, &["--slice", "0/3"]);
    rendered(&desk, &["--slice", "1/3", "-o", "b.part", "--stats", "b.json"]);
    rendered(&desk, &["--slice", "2/3", "-o", "c.part", "-o", "c.exr"]);
    let stats: Value =
        serde_json::from_slice(&std::fs::read(desk.path("b.json")).expect("there")).expect("JSON");
    assert_eq!(stats["sample_range"], json!([8, 16]), "{stats}");
    let slice = exr::read(&desk.path("c.exr")).expect("readable");
    assert_eq!(slice.attribute("specula:samples"), Some("16..32"), "metadata");

    let (status, said) = merge(
        &desk,
        &["a.0of3.part", "b.part", "c.part"],
        &["-o", "m.exr", "-o", "m.png", "--stats", "m.json"],
    );
    assert_eq!(status, 0, "{said}");
    let (status, said) = merge(&desk, &["c.part", "a.0of3.part", "b.part"], &["-o", "n.exr"]);
    assert_eq!(status, 0, "{said}");
    let read = |name: &str| std::fs::read(desk.path(name)).expect("there");
    let sorted = |name: &str| {
        let mut picture = exr::read(&desk.path(name)).expect("readable");
        picture.attributes.sort();
        picture
    };
    assert!(sorted("m.exr") == sorted("n.exr"), "the order does not matter, to the bit");

    let [whole, joined] = ["whole.exr", "m.exr"].map(|name| exr::read(&desk.path(name)).expect("readable"));
    pictures::assert_close(&joined, &whole, (1e-5, None));
    let attribute = |name: &str| joined.attribute(name).unwrap_or("").to_owned();
    assert_eq!(attribute("specula:samples"), "0..32", "metadata");
    assert_eq!((attribute("specula:spp"), attribute("specula:parts")), ("32".into(), "3".into()), "metadata");
    assert_eq!(attribute("specula:non_finite_samples"), "0", "metadata");
    let mattes = |picture: &exr::Picture| {
        let mut mattes: Vec<_> =
            picture.attributes.iter().filter(|(key, _)| key.starts_with("cryptomatte/")).cloned().collect();
        mattes.sort();
        mattes
    };
    assert!(mattes(&whole) == mattes(&joined) && mattes(&whole).len() == 8, "names of mattes");
    let stats: Value = serde_json::from_slice(&read("m.json")).expect("JSON");
    assert_eq!(stats["samples"], 37 * 21 * 32, "{stats}");
    assert_eq!(stats["parts"][0]["samples"], json!([0, 8]), "{stats}");
    let single: Value = serde_json::from_slice(&read("whole.json")).expect("JSON");
    assert_tells_as_much(&stats, &single);
    let cpu = |name: &str| {
        let stats: Value = serde_json::from_slice(&read(name)).expect("JSON");
        stats["phases"]["render"]["cpu_s"].as_f64().expect("a number")
    };
    assert!(cpu("m.json") > cpu("b.json"), "times add up");
    let preview = |name: &str| image::open(desk.path(name)).expect("readable").to_rgb8();
    let differs =
        preview("whole.png").iter().zip(preview("m.png").iter()).filter(|(a, b)| a.abs_diff(**b) > 1).count();
    assert_eq!(differs, 0, "the preview");
}

/// Statistics of a merged picture have all that those of one go have, but for what is not known of parts.
fn assert_tells_as_much(merged: &Value, single: &Value) {
    for (key, value) in single.as_object().expect("statistics") {
        let is_told = |merged: &Value| merged.is_null() == value.is_null();
        assert!(merged.get(key).is_some_and(is_told), "{key}: {value}: {merged:#}");
    }
    for key in
        ["rays", "pruned", "samples", "sample_range", "spp", "seed", "bvh_bytes", "backend", "isa", "lanes"]
    {
        assert_eq!(merged[key], single[key], "{key}");
    }
    for phase in single["phases"].as_object().expect("phases").keys() {
        assert!(merged["phases"][phase]["wall_s"].is_number(), "{phase}: {merged:#}");
    }
    assert_ne!(merged["phases"]["write"]["wall_s"], 0.0, "writing the pictures takes time");
    assert_eq!(merged["plan"], single["plan"], "the plan");
    let parts = merged["parts"].as_array().expect("parts");
    let of_parts = |key: &str| parts.iter().filter_map(|part| part[key].as_u64()).collect::<Vec<_>>();
    assert_eq!(merged["peak_rss_bytes"].as_u64(), of_parts("peak_rss_bytes").into_iter().max(), "memory");
    assert_eq!(merged["rays"]["total"].as_u64(), Some(of_parts("rays").into_iter().sum()), "rays");
    let time = |of: &Value| of["wall_s"].as_f64().expect("a time");
    let sum: f64 = parts.iter().map(|part| time(&part["render"])).sum();
    assert!((time(&merged["phases"]["render"]) - sum).abs() < 1e-5, "times");
    let rate = merged["samples_per_s"].as_f64().expect("a rate");
    assert!((rate * sum / merged["samples"].as_f64().expect("samples") - 1.0).abs() < 1e-3, "rate {rate}");
}

#[test]
fn slices_of_filtered_reflections_are_the_picture_and_name_their_samples() {
    let desk = Desk::new();
    std::fs::write(desk.path("a.toml"), fuzzy_room("spp = 10")).expect("written");
    let frame = "--frames=7";
    rendered(&desk, &[frame, "-o", "whole.exr", "--stats", "whole.json"]);
    for index in 0..3 {
        let [slice, part, exr, stats] = ["/3", ".part", ".exr", ".json"].map(|end| format!("{index}{end}"));
        rendered(&desk, &[frame, "--slice", &slice, "-o", &part, "-o", &exr, "--stats", &stats]);
    }
    let stats = |name: &str| -> Value {
        serde_json::from_slice(&std::fs::read(desk.path(name)).expect("there")).expect("JSON")
    };
    let picture = |name: &str| exr::read(&desk.path(name)).expect("readable");
    for (index, [from, to]) in [[0, 3], [3, 6], [6, 10]].into_iter().enumerate() {
        assert_eq!(stats(&format!("{index}.json"))["sample_range"], json!([from, to]), "statistics");
        let told = format!("{from}..{to}");
        assert_eq!(picture(&format!("{index}.exr")).attribute("specula:samples"), Some(&*told), "metadata");
    }
    let (status, said) = merge(&desk, &["2.part", "0.part", "1.part"], &["-o", "m.exr", "--stats", "m.json"]);
    assert_eq!(status, 0, "{said}");
    let [whole, joined] = ["whole.exr", "m.exr"].map(picture);
    assert_eq!(joined.attribute("specula:samples"), Some("0..10"), "metadata");
    pictures::assert_close(&joined, &whole, (1e-5, None));
    assert_tells_as_much(&stats("m.json"), &stats("whole.json"));
    for key in ["frame", "frame_time_s"] {
        assert_eq!(stats("m.json")[key], stats("whole.json")[key], "{key}");
    }
    assert!(stats("m.json")["phases"]["filter"]["cpu_s"].as_f64().expect("a number") > 0.0, "filtering");
}

#[test]
fn parts_that_are_not_one_picture_are_refused_by_name() {
    let desk = desk(32);
    for index in 0..4 {
        rendered(&desk, &["--slice", &format!("{index}/4"), "-o", &format!("{index}.part")]);
    }
    rendered(&desk, &["--slice", "3/4", "-o", "seed.part", "--seed", "5"]);
    rendered(&desk, &["--slice", "1/2", "-o", "half.part"]);
    rendered(&desk, &["--crop", "0,0,37,20", "-o", "crop.part"]);
    std::fs::write(desk.path("short.part"), &std::fs::read(desk.path("3.part")).expect("there")[..5000])
        .expect("written");
    let mut bytes = std::fs::read(desk.path("3.part")).expect("there");
    let at = bytes.len() - 1000;
    bytes[at] ^= 4;
    std::fs::write(desk.path("flipped.part"), bytes).expect("written");
    std::fs::write(desk.path("picture.part"), "not one").expect("written");
    std::fs::write(desk.path("m.exr"), "old").expect("written");
    let before = desk.names();
    let refused = |parts: &[&str], told: &[&str]| {
        let (status, said) = merge(&desk, parts, &["-o", "m.exr"]);
        assert_eq!(status, 2, "{parts:?}: {said}");
        assert!(told.iter().all(|told| said.contains(told)), "{parts:?}: {said}");
        assert_eq!(desk.names(), before, "{parts:?}: nothing half-written");
        assert_eq!(std::fs::read(desk.path("m.exr")).expect("there"), b"old", "{parts:?}: untouched");
    };
    refused(&["0.part", "1.part", "3.part"], &["samples 16..24", "0,0,37,21"]);
    refused(&["0.part", "1.part", "2.part"], &["samples 24..32"]);
    refused(&["0.part", "1.part", "2.part", "2.part", "3.part"], &["2.part: it has the samples 16..24"]);
    refused(&["0.part", "1.part", "half.part", "3.part"], &["3.part", "24..32", "half.part"]);
    refused(
        &["0.part", "1.part", "2.part", "seed.part"],
        &["seed.part: of another picture than `0.part`: `scene.render.seed` is 5 here and 0 there"],
    );
    refused(
        &["0.part", "none.part", "short.part", "picture.part"],
        &["none.part: cannot read", "short.part: not as long", "picture.part: not a checkpoint or part"],
    );
    refused(&["0.part", "1.part", "2.part", "flipped.part"], &["flipped.part: damaged"]);
    refused(&["crop.part", "0.part"], &["37,20", "samples 0..8"]);
    let (status, said) = merge(&desk, &["crop.part"], &["-o", "m.exr", "--crop", "0,0,37,21"]);
    assert!(status == 2 && said.contains("samples 0..32 of the pixels 0,20,37,21"), "{status}: {said}");
    let (status, said) = merge(&desk, &["0.part"], &["-o", "0.part"]);
    assert_eq!(status, 2, "{said}");
    for slice in ["3/3", "-1/2", "1", "a/b", "0/0"] {
        let (status, _, said) = desk.run(&["render", "a.toml", "--slice", slice]);
        assert!(status == 2 && said.contains("--slice"), "{slice}: {status}: {said}");
    }
    let (status, _, said) = desk.run(&["render", "a.toml", "--slice", "0/33"]);
    assert!(status == 2 && said.contains("cannot be cut into 33"), "{status}: {said}");
    let (status, _, said) = desk.run(&["render", "a.toml", "--slice", "0/2", "--time-limit", "1s"]);
    assert!(status == 2 && said.contains("not known beforehand"), "{status}: {said}");
}

#[test]
fn three_hundred_parts_are_merged() {
    let desk = Desk::new();
    let scene = scene_of(&room("integrator = \"whitted\"\nspp = 300"));
    let mut names = Vec::new();
    for index in 0..300 {
        let settings = settings(Some(Slice { index, of: 300 }), None);
        let rendered = render(&scene, &settings, &Silent).expect("a part");
        // Two parts dropped a sample each.
        let dropped = [7, 250].contains(&index).then_some(SampleId { y: 2, x: 3, index });
        let lost: Vec<Value> = dropped
            .iter()
            .map(|_| json!({ "pixel": [3, 2], "index": index, "command": format!("see {index}") }))
            .collect();
        let part = Part {
            outline: outline(&scene, &settings).expect("sound"),
            film: rendered.film.dropped(NonFinite::of(lost.len() as u64, dropped)),
            counters: rendered.statistics.counters,
            about: json!({ "scene": "the same" }),
            told: json!({
                "attributes": [["specula:time_render_s", "0.5"]],
                "statistics": { "peak_rss_bytes": 1000 + index, "non_finite": { "first": lost } },
            }),
        };
        let mut bytes = Vec::new();
        part.write(&mut bytes).expect("written");
        names.push(format!("{index}.part"));
        std::fs::write(desk.path(&names[index as usize]), bytes).expect("written");
    }
    let parts: Vec<&str> = names.iter().rev().map(String::as_str).collect();
    let (status, said) = merge(&desk, &parts, &["-o", "m.exr", "--stats", "m.json"]);
    assert_eq!(status, 0, "{said}");
    let stats = std::fs::read(desk.path("m.json")).expect("there");
    let stats: Value = serde_json::from_slice(&stats).expect("JSON");
    assert_eq!(stats["peak_rss_bytes"], 1299, "the most of memory");
    let sample = |index: u32| json!({ "pixel": [3, 2], "index": index, "command": format!("see {index}") });
    assert_eq!(
        stats["non_finite"],
        json!({ "count": 2, "first": [sample(7), sample(250)] }),
        "with commands"
    );
    let picture = exr::read(&desk.path("m.exr")).expect("readable");
    assert_eq!(picture.attribute("specula:time_render_s"), Some("150"), "times add up");
    let whole = render(&scene, &settings(None, None), &Silent).expect("a picture").film;
    let red = picture.channel("R").expect("there").to_f32();
    let beauty = whole.channels(Aov::Beauty).expect("kept");
    assert_values_close("the picture", &red, &beauty[0], (1e-6, Some(0.0)));
    let (status, said) = merge(&desk, &[&parts[..100], &parts[101..]].concat(), &["-o", "n.exr"]);
    assert!(status == 2 && said.contains("samples 199..200"), "{status}: {said}");
}

#[test]
fn parts_of_one_description_that_do_not_fit_together_are_refused_by_name() {
    let desk = Desk::new();
    let scene = scene_of(&room("integrator = \"whitted\"\nspp = 4"));
    let write = |name: &str, index: u32, layout: Layout, change: fn(&mut Outline)| {
        let settings = Settings { layout, slice: Some(Slice { index, of: 2 }), ..Settings::default() };
        let rendered = render(&scene, &settings, &Silent).expect("a part");
        let mut told = outline(&scene, &settings).expect("sound");
        change(&mut told);
        let part = Part {
            outline: told,
            film: rendered.film,
            counters: rendered.statistics.counters,
            about: json!({ "scene": "the same" }),
            told: json!({}),
        };
        let mut bytes = Vec::new();
        part.write(&mut bytes).expect("written");
        std::fs::write(desk.path(name), bytes).expect("written");
    };
    write("0.part", 0, Layout::default(), |_| {});
    write("1.part", 1, Layout::default(), |_| {});
    write("outputs.part", 1, Layout::with([Aov::Depth]), |_| {});
    write("width.part", 1, Layout::default(), |outline| outline.full[0] += 1);
    write("spp.part", 1, Layout::default(), |outline| outline.spp = 8);
    write("limit.part", 1, Layout::default(), |outline| outline.has_limit = true);
    for (name, told) in [
        ("outputs.part", "`outputs` is ["),
        ("width.part", "`width` is 38 here and 37 there"),
        ("spp.part", "`spp` is 8 here and 4 there"),
        ("limit.part", "`has_limit` is true here and false there"),
    ] {
        let (status, said) = merge(&desk, &["0.part", name], &["-o", "m.exr"]);
        let told = format!("{name}: of another picture than `0.part`: {told}");
        assert!(status == 2 && said.contains(&told), "{name}: {status}: {said}");
        assert!(!desk.path("m.exr").exists(), "{name}: nothing is written");
    }
    let (status, said) = merge(&desk, &["0.part", "1.part"], &["-o", "m.exr"]);
    assert_eq!(status, 0, "{said}");
}
