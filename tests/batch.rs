//! Many pictures: what is read once, what is left out, what fails alone, and frames that are the pictures of single renderings to the bit.

#[path = "support/desk.rs"]
mod desk;
#[path = "support/models.rs"]
mod models;
#[cfg(unix)]
#[path = "support/running.rs"]
mod running;

use desk::Desk;
use models::{desk, read, write};
use serde_json::Value;
use specula::image::exr;
use std::collections::BTreeMap;
use std::process::Command;
use std::time::Duration;

/// Runs the batch with these flags: status, summary and log.
fn batch(desk: &Desk, flags: &[&str]) -> (i32, Value, String) {
    let words: Vec<&str> = ["batch", "--json"].iter().chain(flags).copied().collect();
    let (status, out, said) = desk.run(&words);
    (status, serde_json::from_str(&out).unwrap_or(Value::Null), said)
}

/// How many pictures came to this.
fn count(summary: &Value, state: &str) -> u64 {
    summary["counts"][state].as_u64().unwrap_or_else(|| panic!("no `{state}` in {summary}"))
}

/// Why each picture was made or is due.
fn reasons(summary: &Value) -> Vec<String> {
    let pictures = summary["pictures"].as_array().expect("pictures");
    pictures.iter().map(|it| it["why"].as_str().unwrap_or("").to_owned()).collect()
}

#[test]
fn what_is_done_is_left_out_until_something_changes() {
    let desk = desk();
    let jobs = |spp: u32| {
        format!(
            "[defaults]\noverrides = {{ render.spp = {spp} }}\n[[jobs]]\nscene = 'model.toml'\n[[jobs]]\nname = 'small'\nscene = 'model.toml'\noverrides = {{ film.width = 8 }}\noutputs = ['{{name}}.exr']\naov = ['depth']\n"
        )
    };
    write(&desk, "batch.toml", &jobs(2));
    let (status, out, said) = desk.run(&["batch", "batch.toml", "--dry-run"]);
    assert!(status == 0 && out.contains("2 due") && out.contains("there is no `small.exr`"), "{out}{said}");
    assert!(!desk.names().iter().any(|name| name.ends_with(".exr")), "nothing rendered");
    let (status, summary, said) = batch(&desk, &["batch.toml"]);
    assert_eq!((status, count(&summary, "rendered")), (0, 2), "{said}");
    assert_eq!(exr::read(&desk.path("small.exr")).expect("readable").window.width(), 8, "an override");
    let before = ["model.exr", "model.png", "small.exr"].map(|name| read(&desk, name));
    let again = || {
        let (status, summary, said) = batch(&desk, &["batch.toml"]);
        assert_eq!(status, 0, "{said}");
        (count(&summary, "rendered"), count(&summary, "done_before"), reasons(&summary))
    };
    assert_eq!(again(), (0, 2, vec![String::new(), String::new()]), "all is there");
    let after = ["model.exr", "model.png", "small.exr"].map(|name| read(&desk, name));
    assert!(before == after, "untouched");

    // The same bytes at another time are the same file.
    let picture = read(&desk, "paint.png");
    std::fs::write(desk.path("paint.png"), &picture).expect("written");
    assert_eq!(again().0, 0, "written again");
    models::paint(&desk, "paint.png", [10, 200, 30]);
    let changed = vec!["`paint.png` has changed".to_owned(); 2];
    assert_eq!(again(), (2, 0, changed), "a texture of the scene");
    models::paint(&desk, "inner.png", [10, 200, 30]);
    assert_eq!(again().2, vec!["`inner.png` has changed".to_owned(); 2], "a texture that an MTL file names");
    std::fs::remove_file(desk.path("model.png")).expect("removed");
    assert_eq!(again(), (1, 1, vec!["there is no `model.png`".to_owned(), String::new()]), "a preview");
    write(&desk, "batch.toml", &jobs(3));
    assert_eq!(again().2, vec!["the scene or its overrides have changed".to_owned(); 2], "an override");
    write(&desk, "batch.toml", &jobs(3).replace("['depth']", "['depth', 'normal']"));
    let (rendered, _, why) = again();
    assert!(rendered == 1 && why[1].starts_with("it has other settings: `outputs` is"), "{why:?}");
    std::fs::write(desk.path("small.exr"), b"no picture").expect("written");
    assert_eq!(again().2[1], "`small.exr` cannot be read", "damaged");
    let (status, _, said) = desk.run(&["render", "model.toml", "-q", "--spp", "3", "-o", "small.exr"]);
    assert_eq!(status, 0, "{said}");
    assert_eq!(again().2[1], "`small.exr` does not say of what files it is", "by another command");
    let (_, summary, _) = batch(&desk, &["batch.toml", "--force"]);
    assert_eq!(reasons(&summary), ["all are asked for", "all are asked for"], "forced");
}

#[test]
fn files_are_read_once_for_all_jobs_and_frames() {
    let desk = desk();
    let jobs = "[defaults]\nscene = 'model.toml'\nframes = '1..4'\noutputs = ['{name}.####.exr']\n[[jobs]]\nname = 'a'\n[[jobs]]\nname = 'b'\noverrides = { render.spp = 1 }\n[[jobs]]\nname = 'c'\nscene = 'still.toml'\n";
    write(&desk, "batch.toml", jobs);
    for flags in [&["batch.toml"][..], &["batch.toml", "--force", "--jobs", "3", "-t", "3"]] {
        let (status, summary, said) = batch(&desk, flags);
        assert_eq!((status, count(&summary, "rendered")), (0, 12), "{said}");
        // A mesh, the picture that its materials name, and that of the scene.
        assert_eq!(summary["files"]["read"], 3, "{flags:?}: {summary}");
    }
    // No memory for files: they are read whenever a scene is built.
    let (_, summary, _) = batch(&desk, &["batch.toml", "--force", "--memory", "1"]);
    assert!(summary["files"]["read"].as_u64().expect("a number") > 12, "{summary}");
}

#[test]
fn frames_are_single_renderings_to_the_bit() {
    let desk = desk();
    for scene in ["model", "still"] {
        let file = format!("{scene}.toml");
        let words = ["render", &file, "-q", "--frames", "-1..3", "-o", "one.####.exr"];
        let (status, out, said) = desk.run(&words);
        assert_eq!((status, out.lines().count()), (0, 5), "{said}");
        let many = ["batch", &file, "-q", "--frames", "-1..3", "-o", "{name}_{frame}.exr"];
        let (status, _, said) = desk.run(&many);
        assert_eq!(status, 0, "{said}");
        let (status, _, said) = desk.run(&["render", &file, "-q", "-o", "file.exr"]);
        assert_eq!(status, 0, "{said}");
        let mut pictures = Vec::new();
        for frame in -1..=3 {
            let number = format!("--frames={frame}");
            let (status, _, said) = desk.run(&["render", &file, "-q", &number, "-o", "single.exr"]);
            assert_eq!(status, 0, "{said}");
            let single = desk.channels("single.exr");
            let name = if frame < 0 { "one.-0001.exr".to_owned() } else { format!("one.{frame:04}.exr") };
            assert!(desk.channels(&name) == single, "{scene} {frame}: one after the other");
            assert!(desk.channels(&format!("{scene}_{frame}.exr")) == single, "{scene} {frame}: a batch");
            let picture = exr::read(&desk.path("single.exr")).expect("readable");
            assert_eq!(picture.attribute("specula:frame"), Some(frame.to_string().as_str()), "number");
            let time: f64 =
                picture.attribute("specula:frame_time_s").expect("there").parse().expect("a number");
            assert!((time - f64::from(frame) / 10.0).abs() < 1e-12, "at {time} s");
            // Where nothing but the camera moves, one hierarchy does for all.
            let built = exr::read(&desk.path(&name)).expect("readable").attribute("specula:time_build_s")
                != Some("0");
            assert_eq!(built, frame == -1 || scene == "model", "{scene} {frame}: built anew");
            // The shutter by hand.
            let shutter = [0.0, 0.05].map(|at: f64| (at + f64::from(frame) / 10.0).to_string());
            let open = format!("camera.shutter_open_s={}", shutter[0]);
            let close = format!("camera.shutter_close_s={}", shutter[1]);
            let words = ["render", &file, "-q", "-D", &open, "-D", &close, "-o", "hand.exr"];
            assert_eq!(desk.run(&words).0, 0, "rendered");
            assert!(desk.channels("hand.exr") == single, "{scene} {frame}: the shutter by hand");
            if frame == 0 {
                assert!(desk.channels("file.exr") == single, "{scene}: frame 0 is what the file says");
            }
            pictures.push(single);
        }
        pictures.dedup();
        assert_eq!(pictures.len(), 5, "{scene}: frames differ");
    }
}

#[test]
fn frames_have_names_of_their_own() {
    let desk = desk();
    let refused = |words: &[&str], told: &str| {
        let words: Vec<&str> = ["render", "still.toml", "-q"].iter().chain(words).copied().collect();
        let (status, _, said) = desk.run(&words);
        assert!(status == 2 && said.contains(told), "{words:?}: {status}: {said}");
    };
    refused(&["--frames", "1..2", "-o", "a.exr"], "`a.exr` would be written for each of 2 frames");
    refused(&["--frames", "1..2", "-o", "#.exr", "--stats", "a.json"], "`a.json` would be written for each");
    refused(&["--frames", "1..2", "--checkpoint", "a.ckpt"], "`a.ckpt` would be written for each");
    refused(&["--frames", "1..2", "-o", "#/a.exr"], "there is no directory `2`");
    refused(&["--frames", "2..1"], "`--frames 2..1` is not a range of frames; write a number, A..B");
    std::fs::create_dir(desk.path("7")).expect("made");
    let words = ["render", "still.toml", "-q", "--frames", "7,9", "-o", "a#.png", "--stats", "s##.json"];
    let (status, out, said) = desk.run(&words);
    assert_eq!((status, out.as_str()), (0, "a7.png\ns07.json\na9.png\ns09.json\n"), "{said}");
    let stats: Value = serde_json::from_slice(&read(&desk, "s09.json")).expect("JSON");
    assert_eq!((&stats["frame"], &stats["frame_time_s"]), (&9.into(), &0.9.into()), "{stats}");
    let (status, out, said) =
        desk.run(&["render", "still.toml", "-q", "--frames", "7", "-o", "{frame}/a.exr"]);
    assert_eq!((status, out.as_str()), (0, "7/a.exr\n"), "{said}");
    let (status, out, said) = desk.run(&["render", "still.toml", "-q", "--frames", "7"]);
    assert_eq!((status, out.as_str()), (0, "still.0007.exr\nstill.0007.png\n"), "{said}");
}

/// How many frames were left out, by the log.
fn left_out(said: &str) -> usize {
    said.matches("it is there already: left out").count()
}

#[cfg(unix)]
#[test]
fn an_interrupted_sequence_goes_on_with_the_frames_that_are_left() {
    let desk = desk();
    let sequence = ["render", "still.toml", "--frames", "1..3", "--spp", "20000"];
    let (status, _, said) = desk.run(&[&sequence[..], &["-q", "-o", "whole.#.exr"]].concat());
    assert_eq!(status, 0, "{said}");
    let kept = ["-o", "a.#.exr", "-o", "a.#.png", "--checkpoint", "a.#.ckpt", "--checkpoint-every", "100ms"];
    let words = [&sequence[..], &kept, &["--resume", "-t", "1"]].concat();
    let mut child = running::spawn(&desk, &words);
    running::wait_for("the second frame", Duration::from_secs(120), || desk.path("a.2.ckpt").exists());
    child.kill().expect("killed");
    child.wait().expect("ended");
    assert!(desk.path("a.1.png").exists() && !desk.path("a.2.exr").exists(), "in the second frame");
    let (first, copy) = (read(&desk, "a.1.exr"), read(&desk, "a.2.ckpt"));

    let (status, out, said) = desk.run(&words);
    assert_eq!((status, left_out(&said)), (0, 1), "{said}");
    assert!(said.contains("going on from") && read(&desk, "a.1.exr") == first, "what is left: {said}");
    assert_eq!(out, "a.1.exr\na.1.png\na.2.exr\na.2.png\na.3.exr\na.3.png\n", "all are named");
    for frame in 1..=3 {
        let [one, whole] = ["a", "whole"].map(|name| desk.channels(&format!("{name}.{frame}.exr")));
        assert!(one == whole, "{frame}: to the bit");
    }
    assert!(!desk.names().iter().any(|name| name.ends_with(".ckpt")), "no checkpoint is left");

    // One that was left beside its picture goes, too; what is no checkpoint stays.
    std::fs::remove_file(desk.path("a.2.png")).expect("removed");
    std::fs::write(desk.path("a.1.ckpt"), copy).expect("written");
    std::fs::write(desk.path("a.3.ckpt"), "something else").expect("written");
    let (status, _, said) = desk.run(&words);
    assert_eq!((status, left_out(&said)), (0, 2), "a preview is gone: {said}");
    assert!(desk.path("a.2.png").exists() && read(&desk, "a.3.ckpt") == b"something else", "made again");
    assert!(!desk.path("a.1.ckpt").exists(), "a checkpoint that was left");
    std::fs::remove_file(desk.path("a.3.ckpt")).expect("removed");
    let words: Vec<&str> = words.iter().map(|&word| if word == "20000" { "2" } else { word }).collect();
    let said = || {
        let (status, _, said) = desk.run(&words);
        assert_eq!(status, 0, "{said}");
        left_out(&said)
    };
    assert_eq!((said(), said()), (0, 3), "other settings");
    models::paint(&desk, "inner.png", [10, 200, 30]);
    assert_eq!((said(), said()), (0, 3), "a file that a file names");
}

#[test]
fn parts_of_frames_that_are_there_are_left_out_if_they_are_sound() {
    let desk = desk();
    let run = |more: &[&str]| {
        let words = ["render", "still.toml", "--frames", "1..2", "-o", "a#.part", "--checkpoint", "a#.ckpt"];
        let (status, _, said) = desk.run(&[&words[..], &["--resume"], more].concat());
        assert_eq!(status, 0, "{said}");
        left_out(&said)
    };
    let slice = ["--slice", "0/2"];
    assert_eq!((run(&slice), run(&slice)), (0, 2), "again");
    let mut bytes = read(&desk, "a1.part");
    let at = bytes.len() - 100;
    bytes[at] ^= 1;
    std::fs::write(desk.path("a1.part"), bytes).expect("written");
    assert_eq!((run(&slice), run(&slice)), (1, 2), "damaged");
    for more in [&["--slice", "1/2"][..], &["--slice", "1/2", "--crop", "0,0,9,9"], &["--seed", "5"], &[]] {
        assert_eq!((run(more), run(more)), (0, 2), "{more:?}");
    }
}

#[test]
fn side_by_side_is_one_after_the_other_to_the_bit() {
    let desk = desk();
    let jobs = "[defaults]\nframes = '1..3'\noutputs = ['{name}.#.exr']\naov = ['depth', 'cryptomatte']\n[[jobs]]\nscene = 'model.toml'\n[[jobs]]\nscene = 'still.toml'\n[[jobs]]\nname = 'tree'\nscene = 'model.toml'\noverrides.render.integrator = 'whitted'\noverrides.render.backend = 'bvh2'\n";
    write(&desk, "batch.toml", jobs);
    let run = |flags: &[&str]| -> BTreeMap<String, Vec<(String, Vec<u32>)>> {
        let words: Vec<&str> = ["batch.toml", "--force"].iter().chain(flags).copied().collect();
        let (status, summary, said) = batch(&desk, &words);
        assert_eq!((status, count(&summary, "rendered")), (0, 9), "{flags:?}: {said}");
        let pictures = desk.names().into_iter().filter(|name| name.ends_with(".exr"));
        pictures.map(|name| (name.clone(), desk.channels(&name))).collect()
    };
    let one = run(&["-t", "1"]);
    assert_eq!(one.len(), 9, "pictures");
    for flags in
        [&["--jobs", "3", "-t", "2"][..], &["--jobs", "9", "-t", "9"], &["--jobs", "3", "--memory", "1M"]]
    {
        assert!(run(flags) == one, "{flags:?}");
    }
}

/// The command that is told of the first picture, which must succeed.
fn told(desk: &Desk, summary: &Value) -> String {
    let command = summary["pictures"][0]["command"].as_str().expect("a command");
    let program = assert_cmd::cargo::cargo_bin("specula");
    let path =
        format!("{}:{}", program.parent().expect("a folder").display(), std::env::var("PATH").expect("set"));
    let done =
        Command::new("sh").args(["-c", command]).current_dir(desk.path(".")).env("PATH", path).output();
    let done = done.expect("run");
    assert!(done.status.success(), "{command}: {}", String::from_utf8_lossy(&done.stderr));
    command.to_owned()
}

#[test]
fn files_of_overrides_are_seen_from_where_these_are_written() {
    let desk = desk();
    std::fs::create_dir(desk.path("sub")).expect("made");
    std::fs::rename(desk.path("model.obj"), desk.path("sub/other.obj")).expect("moved");
    std::fs::rename(desk.path("model.mtl"), desk.path("sub/model.mtl")).expect("moved");
    models::paint(&desk, "sub/inner.png", [50, 100, 200]);
    let jobs = "[[jobs]]\nname = 'a'\nscene = '../still.toml'\noverrides = { shapes.0.file = 'other.obj' }\noutputs = ['a.exr']\n";
    write(&desk, "sub/jobs.toml", jobs);
    let wall = "materials.wall.reflectance={ file = 'late.png' }";
    let words = ["sub/jobs.toml", "-D", wall, "-D", "render.spp=1"];
    let (status, summary, said) = batch(&desk, &words);
    assert!(status == 1 && said.contains("no such file `late.png`"), "{said}");
    models::paint(&desk, "late.png", [9, 9, 9]);
    let command = told(&desk, &summary);
    assert!(command.starts_with("cd sub && ") && desk.path("sub/a.exr").exists(), "{command}");
    let alone = desk.channels("sub/a.exr");
    let (status, _, said) = batch(&desk, &words);
    assert_eq!(status, 0, "{said}");
    assert!(desk.channels("sub/a.exr") == alone, "the same picture");
}

#[cfg(unix)]
#[test]
fn what_became_of_all_is_told_though_no_worker_can_start() {
    let desk = desk();
    // No thread has so much room.
    let output = desk
        .command()
        .args(["batch", "model.toml", "still.toml", "--json"])
        .env("RUST_MIN_STACK", (1_u64 << 47).to_string())
        .output()
        .expect("run");
    let summary: Value = serde_json::from_slice(&output.stdout).expect("a summary");
    assert_eq!(count(&summary, "not_begun"), 2, "{summary}");
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_job_that_fails_is_told_at_the_end_with_its_command_and_stops_no_other() {
    let desk = desk();
    std::fs::create_dir(desk.path("sub")).expect("made");
    write(&desk, "model.toml", &models::scene(models::KEYS).replace("paint.png", "gone.png"));
    write(&desk, "broken.toml", "[camera]\nfom = [0, 0, 0]\n");
    let jobs = "[[jobs]]\nname = 'first one'\nscene = '../model.toml'\nframes = 3\noutputs = ['a#.exr']\n[[jobs]]\nscene = '../still.toml'\n[[jobs]]\nscene = '../broken.toml'\n[[jobs]]\nname = 'x'\nscene = '../still.toml'\noverrides.render.sp = 1\n[[jobs]]\nname = 'last'\nscene = '../still.toml'\n";
    write(&desk, "sub/jobs.toml", jobs);
    let (status, summary, said) = batch(&desk, &["sub/jobs.toml"]);
    assert_eq!(status, 1, "{said}");
    assert_eq!((count(&summary, "rendered"), count(&summary, "failed")), (2, 3), "{said}");
    assert!(desk.path("sub/last.exr").exists(), "the others go on");
    for told in [
        "first one frame 3: sub/../model.toml:",
        "no such file `sub/../gone.png`",
        "broken: sub/../broken.toml:2:1: unknown key `fom`; did you mean `from`?",
        "sub/jobs.toml:13:23: in `render.sp=1`: unknown key `sp`; did you mean `spp`?",
        "try it again by `cd sub && specula render ../model.toml --frames=3 -o a3.exr`",
        "3 of 5 pictures failed",
    ] {
        assert!(said.contains(told), "{told} in {said}");
    }
    // The command that is told does it.
    models::paint(&desk, "gone.png", [9, 9, 9]);
    let command = told(&desk, &summary);
    assert!(desk.path("sub/a3.exr").exists(), "{command}");
    write(&desk, "sub/jobs.toml", &jobs[..jobs.find("[[jobs]]\nscene = '../broken").expect("there")]);
    let (status, summary, said) = batch(&desk, &["sub/jobs.toml"]);
    assert_eq!((status, count(&summary, "rendered"), count(&summary, "done_before")), (0, 1, 1), "{said}");
}

#[test]
fn jobs_do_not_overwrite_what_their_scenes_read() {
    let desk = desk();
    let jobs = "[defaults]\nscene = 'still.toml'\n[[jobs]]\nname = 'paint'\n[[jobs]]\nname = 'inner'\noutputs = ['{name}.png', 'a.exr']\n[[jobs]]\nname = 'fine'\n";
    write(&desk, "batch.toml", jobs);
    let files = || ["paint.png", "inner.png"].map(|name| read(&desk, name));
    let before = files();
    let (status, summary, said) = batch(&desk, &["batch.toml"]);
    assert_eq!((status, count(&summary, "failed"), count(&summary, "rendered")), (1, 2, 1), "{said}");
    for name in ["paint", "inner"] {
        let told = format!("{name}: `{name}.png` is read and would be overwritten; name another file");
        assert!(said.contains(&told), "{told} in {said}");
    }
    assert!(files() == before, "untouched");
    assert!(!desk.path("paint.exr").exists() && !desk.path("a.exr").exists(), "{:?}", desk.names());
}

/// A socket is there, and nobody can open it.
#[cfg(unix)]
#[test]
fn an_older_preview_does_not_pass_for_that_of_a_picture() {
    let desk = desk();
    write(&desk, "batch.toml", "[[jobs]]\nscene = 'still.toml'\noutputs = ['a.png', 'a.exr']\n");
    let socket = std::os::unix::net::UnixListener::bind(desk.path("a.png")).expect("bound");
    let (status, summary, said) = batch(&desk, &["batch.toml"]);
    assert_eq!((status, count(&summary, "failed")), (1, 1), "{said}");
    assert!(desk.path("a.exr").exists(), "the other file: {said}");
    drop(socket);
    std::fs::remove_file(desk.path("a.png")).expect("removed");
    write(&desk, "a.png", "old");
    let (status, summary, said) = batch(&desk, &["batch.toml"]);
    assert_eq!((status, count(&summary, "rendered")), (0, 1), "{said}");
    assert_ne!(read(&desk, "a.png"), b"old", "replaced");
}

#[test]
fn a_wrong_batch_file_is_told_all_at_once_and_nothing_is_rendered() {
    let desk = desk();
    let jobs = "[[jobs]]\nscene = 'still.toml'\noutputs = ['a.exr', 'no/a.exr', 'b.jpg']\n[[jobs]]\nscene = 'still.toml'\nframes = '1..2'\noutputs = ['b.exr']\n[[jobs]]\nscene = 'model.toml'\noutputs = ['a.exr']\naov = ['detph']\ncrop = [4, 4, 4, 8]\n";
    write(&desk, "batch.toml", jobs);
    let before = desk.names();
    let (status, _, said) = batch(&desk, &["batch.toml"]);
    assert_eq!(status, 2, "{said}");
    for told in [
        "batch.toml:3:21: cannot write `no/a.exr`: there is no directory `no`",
        "batch.toml:3:33: ",
        "batch.toml:7:12: `b.exr` would be written for each of 2 frames",
        "batch.toml:11:8: there is no output `detph`; did you mean `depth`?",
        "batch.toml:12:8: `crop` has no pixel",
    ] {
        assert!(said.contains(told), "{told} in {said}");
    }
    write(
        &desk,
        "batch.toml",
        &jobs[jobs.find("[[jobs]]\nscene = 'model").expect("there")..]
            .replace("['detph']\ncrop = [4, 4, 4, 8]", "[]")
            .repeat(2),
    );
    let (status, _, said) = batch(&desk, &["batch.toml"]);
    assert!(status == 2 && said.contains("batch.toml:7:12: `a.exr` would be written twice"), "{said}");
    let first = "[[jobs]]\nscene = 'still.toml'\naov = ['depth', 'gbuffer']\noutputs = ['a.png']\n";
    write(&desk, "batch.toml", first);
    let (status, _, said) = batch(&desk, &["batch.toml", "--checkpoint-every", "1s"]);
    assert!(
        status == 2 && said.contains("batch.toml:3:8: the output `gbuffer` without an EXR file"),
        "{said}"
    );
    assert!(said.contains("batch.toml:3:8: `--checkpoint-every` beside the output `gbuffer`"), "{said}");
    write(&desk, "batch.toml", "[[jobs]]\nframes = 1\nscene = 'still.toml'\njob = 1\n");
    let (status, _, said) = batch(&desk, &["batch.toml", "none.toml"]);
    assert!(status == 2 && said.contains("batch.toml:4:1: unknown key `job`"), "{said}");
    assert!(said.contains("none.toml: no such file"), "{said}");
    for (flags, told) in [
        (&["--jobs", "0"][..], "`--jobs 0` is not a number in range; give a whole number from 1 to"),
        (&["--memory", "much"], "`--memory much` is not a size"),
        (&["--frames", "a"], "`--frames a` is not a range"),
    ] {
        let (status, _, said) = batch(&desk, &[&["still.toml"], flags].concat());
        assert!(status == 2 && said.contains(told), "{said}");
    }
    assert_eq!(desk.names(), before, "nothing rendered");
    let (status, out, _) = desk.run(&["schema", "batch"]);
    let schema: Value = serde_json::from_str(&out).expect("JSON");
    assert!(status == 0 && schema["properties"]["jobs"].is_object(), "{out}");
}

#[test]
fn waiting_for_memory_is_no_part_of_a_time_limit() {
    let desk = desk();
    let jobs = "[defaults]\ntime_limit_s = 1.5\noverrides = { render.spp = 65536 }\noutputs = ['{name}.exr']\n[[jobs]]\nscene = 'still.toml'\n[[jobs]]\nscene = 'model.toml'\n";
    write(&desk, "batch.toml", jobs);
    // One alone is let in at a time.
    let (status, _, said) = batch(&desk, &["batch.toml", "--jobs", "2", "-t", "2", "--memory", "1"]);
    assert_eq!(status, 0, "{said}");
    for name in ["still.exr", "model.exr"] {
        let picture = exr::read(&desk.path(name)).expect("readable");
        assert_eq!(picture.attribute("specula:ended_by"), Some("time"), "{name}");
        let time = picture.attribute("specula:time_render_s").expect("there");
        assert!(time.parse::<f64>().expect("a number") > 0.3, "{name}: {time} s of 1.5");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_batch_keeps_checkpoints_and_goes_on_to_the_same_picture() {
    let desk = desk();
    let jobs = "[[jobs]]\nscene = 'still.toml'\noverrides = { render.spp = 20000 }\noutputs = ['a.png', 'a.exr']\n[[jobs]]\nscene = 'model.toml'\noutputs = ['b.exr']\n";
    write(&desk, "batch.toml", jobs);
    let (status, _, said) = desk.run(&["batch", "batch.toml", "-q"]);
    assert_eq!(status, 0, "{said}");
    let whole = desk.channels("a.exr");
    let words = ["batch", "batch.toml", "-q", "--force", "--checkpoint-every", "100ms", "-t", "1"];
    for signal in ["-INT", "-TERM"] {
        for name in ["a.exr", "a.png", "b.exr"] {
            std::fs::remove_file(desk.path(name)).expect("removed");
        }
        let child = running::spawn(&desk, &words);
        running::wait_for("a checkpoint", Duration::from_secs(60), || desk.path("a.png.ckpt").exists());
        running::signal(&child, signal);
        let output = child.wait_with_output().expect("ended");
        assert_eq!(output.status.code(), Some(130), "{}", String::from_utf8_lossy(&output.stderr));
        let out = String::from_utf8_lossy(&output.stdout);
        assert!(out.contains("1 interrupted, 1 not begun"), "{out}");
        assert!(!desk.names().iter().any(|name| name.ends_with(".exr") || name.ends_with(".tmp")), "absent");
        let (status, out, said) = desk.run(&[&words[..1], &words[1..2], &words[4..]].concat());
        assert!(status == 0 && said.contains("going on from"), "{out}{said}");
        assert!(desk.channels("a.exr") == whole, "{signal}: the same picture");
        assert!(!desk.path("a.png.ckpt").exists() && desk.path("a.png").exists(), "{signal}: whole");
    }
    // A checkpoint of something else is told, and given up.
    std::fs::write(desk.path("b.exr.ckpt"), b"nothing").expect("written");
    std::fs::remove_file(desk.path("b.exr")).expect("removed");
    let (status, _, said) = desk.run(&["batch", "batch.toml", "--checkpoint-every", "1h"]);
    assert!(status == 0 && said.contains("b.exr.ckpt") && said.contains("beginning anew"), "{said}");
}

#[cfg(unix)]
#[test]
fn a_checkpoint_with_damaged_sums_is_told_and_given_up() {
    let desk = desk();
    let scene = ["batch", "still.toml", "-q", "-D", "render.spp=20000"];
    let (status, _, said) = desk.run(&[&scene[..], &["-o", "whole.exr"]].concat());
    assert_eq!(status, 0, "{said}");
    let words = [&scene[..], &["-o", "a.exr", "--checkpoint-every", "100ms", "-t", "1"]].concat();
    let mut child = running::spawn(&desk, &words);
    running::wait_for("a checkpoint", Duration::from_secs(60), || desk.path("a.exr.ckpt").exists());
    child.kill().expect("killed");
    child.wait().expect("ended");
    let mut bytes = read(&desk, "a.exr.ckpt");
    let at = bytes.len() - 100;
    bytes[at] ^= 1;
    std::fs::write(desk.path("a.exr.ckpt"), bytes).expect("written");
    let (status, _, said) = desk.run(&words);
    assert!(status == 0 && said.contains("a.exr.ckpt: damaged"), "{said}");
    assert!(said.contains("beginning anew"), "{said}");
    assert!(desk.channels("a.exr") == desk.channels("whole.exr"), "the picture");
    assert!(!desk.path("a.exr.ckpt").exists(), "the checkpoint is gone");
}

#[test]
fn scene_files_are_jobs_of_their_own() {
    let desk = desk();
    let (status, out, said) = desk.run(&["batch", "model.toml", "still.toml", "-D", "render.spp=1"]);
    assert_eq!(status, 0, "{said}");
    assert!(out.contains("2 rendered; 3 files read") && out.contains("there is no `still.png`"), "{out}");
    for name in ["model.exr", "model.png", "still.exr", "still.png"] {
        assert!(desk.path(name).exists(), "{name}");
    }
    assert_eq!(
        exr::read(&desk.path("still.exr")).expect("readable").attribute("specula:spp"),
        Some("1"),
        "-D"
    );
}
