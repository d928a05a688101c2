//! Faults of disks, files and clocks: the exit status, what is told, and that nothing is half-written.

#![cfg(target_os = "linux")]

#[path = "support/desk.rs"]
mod desk;
#[path = "support/disk.rs"]
mod disk;
#[path = "support/models.rs"]
mod models;
#[path = "support/running.rs"]
mod running;

use desk::Desk;
use disk::Mounted;
use models::{desk, read, write};
use running::{signal, spawn, wait_for};
use serde_json::Value;
use specula::image::exr;
use std::fs::{self, File};
use std::io::Read as _;
use std::os::unix::fs::FileTypeExt as _;
use std::os::unix::net::UnixListener;
use std::process::Command;
use std::time::{Duration, Instant, SystemTime};

/// Runs the program, which must end with this status and say all this.
fn run(desk: &Desk, words: &[&str], status: i32, told: &[&str]) {
    let (found, _, said) = desk.run(words);
    assert_eq!(found, status, "{words:?}: {said}");
    for told in told {
        assert!(said.contains(told), "{words:?}: no `{told}` in {said}");
    }
}

/// Whatever is written goes to a disk that is full or read-only.
#[test]
fn disks_that_take_nothing_are_told_and_old_files_stay() {
    for (options, told) in [("size=40k", "No space left"), ("ro", "Read-only")] {
        let desk = desk();
        for index in 0..2 {
            let words =
                ["render", "still.toml", "--slice", &format!("{index}/2"), "-o", &format!("{index}.part")];
            run(&desk, &words, 0, &[]);
        }
        let Some(disk) = Mounted::new(&desk, options) else {
            println!("skipped: no file system may be mounted");
            return;
        };
        if options != "ro" {
            // All but a few bytes are taken.
            fs::write(disk.0.join("old.exr"), b"old").expect("written");
            let _ = fs::write(disk.0.join("filling"), vec![0; 1 << 16]);
        }
        let before = Desk::names_in(&disk.0);
        let render = ["render", "still.toml", "-o"];
        let merge = ["merge", "0.part", "1.part", "-o"];
        for target in ["disk/old.exr", "disk/new.exr", "disk/new.png", "disk/new.part"] {
            run(&desk, &[&render[..], &[target]].concat(), 1, &[told, target, "cannot write"]);
        }
        run(&desk, &[&render[..], &["a.exr"]].concat(), 0, &[]);
        run(&desk, &[&render[..], &["b.exr", "--stats", "disk/a.json"]].concat(), 1, &[told, "disk/a.json"]);
        for target in ["disk/old.exr", "disk/new.png"] {
            run(&desk, &[&merge[..], &[target]].concat(), 1, &[told, target]);
        }
        run(&desk, &["diff", "a.exr", "a.exr", "-o", "disk/d.exr"], 1, &[told, "disk/d.exr"]);
        run(&desk, &["man", "--dir", "disk"], 1, &[told, "disk/"]);
        let jobs = "[defaults]\nscene = 'still.toml'\n[[jobs]]\nname = 'one'\noutputs = ['disk/one.exr']\n[[jobs]]\nname = 'two'\noutputs = ['two.exr']\n";
        write(&desk, "batch.toml", jobs);
        run(
            &desk,
            &["batch", "batch.toml"],
            1,
            &[told, "one: disk/one.exr: cannot write", "1 of 2 pictures failed"],
        );
        assert!(desk.path("two.exr").exists(), "{options}: the other one");
        assert_eq!(Desk::names_in(&disk.0), before, "{options}: nothing half-written");
        if options != "ro" {
            assert_eq!(fs::read(disk.0.join("old.exr")).expect("there"), b"old", "untouched");
        }
    }
}

/// A limit on the size of files is a full disk for whoever may mount nothing.
#[test]
fn files_that_may_not_grow_are_told() {
    let desk = desk();
    let program = assert_cmd::cargo::cargo_bin("specula");
    // Blocks of 512 bytes or of a kilobyte. The signal is what would kill the program.
    let line = format!(
        "trap '' XFSZ; ulimit -f 1; exec '{}' render still.toml -o a.exr -o a.png",
        program.display()
    );
    let output = Command::new("sh").args(["-c", &line]).current_dir(desk.path(".")).output().expect("run");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() == Some(1) && said.contains("a.exr: cannot write: File too large"),
        "{said}"
    );
    assert!(
        !desk.names().iter().any(|name| name.contains(".exr") || name.contains(".tmp")),
        "{:?}",
        desk.names()
    );
}

/// Where nothing can be made at all, not even by root. Nothing is rendered for it.
#[test]
fn places_without_files_are_told() {
    let desk = desk();
    for target in ["/proc/specula.exr", "/sys/specula.exr"] {
        let words = ["render", "still.toml", "-o", target, "--stats", "a.json"];
        run(&desk, &words, 1, &[target, "cannot write"]);
        assert!(!desk.path("a.json").exists(), "{target}: beforehand");
    }
    run(&desk, &["render", "still.toml", "-o", "/dev/null/a.exr"], 2, &["there is no directory `/dev/null`"]);
}

/// A socket is there, and nobody can open it.
#[test]
fn one_file_that_cannot_be_written_costs_no_other() {
    let desk = desk();
    let _socket = UnixListener::bind(desk.path("a.png")).expect("bound");
    let others = ["-o", "a.exr", "-o", "a.part", "--stats", "a.json"];
    let words = [&["render", "still.toml", "-o", "a.png"][..], &others].concat();
    run(&desk, &words, 1, &["a.png: cannot write"]);
    run(
        &desk,
        &["merge", "a.part", "-o", "a.png", "-o", "m.exr", "--stats", "m.json"],
        1,
        &["a.png: cannot"],
    );
    for name in ["a.exr", "a.part", "a.json", "m.exr", "m.json"] {
        assert!(desk.path(name).exists(), "{name}: {:?}", desk.names());
    }
    let about = fs::metadata(desk.path("a.png")).expect("there");
    assert!(about.file_type().is_socket(), "still there");
}

/// Pipes, by the name of one and by that of standard output.
#[test]
fn pipes_are_written_to() {
    let desk = desk();
    let made = Command::new("mkfifo").arg(desk.path("a.png")).status().expect("run");
    assert!(made.success(), "a pipe");
    // Open for both, so that nobody waits for anybody.
    let mut pipe = File::options().read(true).write(true).open(desk.path("a.png")).expect("opened");
    let words = ["render", "still.toml", "-q", "-o", "a.png", "--stats", "/dev/fd/1"];
    let (status, out, said) = desk.run(&words);
    assert_eq!(status, 0, "{said}");
    assert!(fs::metadata(desk.path("a.png")).expect("there").file_type().is_fifo(), "still a pipe");
    let mut bytes = vec![0; 1 << 16];
    let length = pipe.read(&mut bytes).expect("readable");
    assert!(
        image::load_from_memory(&bytes[..length]).is_ok_and(|picture| picture.width() == 16),
        "a picture"
    );
    let report = out.strip_suffix("a.png\n/dev/fd/1\n").expect("the names last");
    assert!(serde_json::from_str::<Value>(report).is_ok_and(|it| it["phases"].is_object()), "{out}");
}

/// Textures and meshes that go, or are damaged, while a batch goes on.
#[test]
fn vanished_and_damaged_files_stop_their_pictures_alone() {
    let desk = desk();
    let jobs = "[[jobs]]\nscene = 'model.toml'\noutputs = ['model.exr']\n[[jobs]]\nscene = 'plain.toml'\noutputs = ['plain.exr']\n";
    write(&desk, "batch.toml", jobs);
    let plain = models::scene("").replace("{ file = \"paint.png\" }", "0.5");
    write(
        &desk,
        "plain.toml",
        &plain.replace("type = \"mesh\"\nfile = \"model.obj\"", "type = \"disc\"\nmaterial = \"glass\""),
    );
    run(&desk, &["batch", "batch.toml"], 0, &[]);
    let (old, picture) = (read(&desk, "model.exr"), read(&desk, "paint.png"));
    let failed = |told: &[&str]| {
        fs::remove_file(desk.path("plain.exr")).expect("removed");
        run(
            &desk,
            &["batch", "batch.toml"],
            1,
            &[told, &["model: try it again by `specula render"]].concat(),
        );
        assert!(desk.path("plain.exr").exists(), "the other one");
        assert_eq!(read(&desk, "model.exr"), old, "untouched");
        assert!(!desk.names().iter().any(|name| name.ends_with(".tmp")), "{:?}", desk.names());
    };
    fs::remove_file(desk.path("paint.png")).expect("removed");
    failed(&["model.toml:", "no such file `paint.png`"]);
    run(&desk, &["render", "model.toml", "-o", "gray.exr"], 0, &["no such file `paint.png`", "made gray"]);
    fs::create_dir(desk.path("paint.png")).expect("made");
    failed(&["`paint.png` is a directory"]);
    fs::remove_dir(desk.path("paint.png")).expect("removed");
    for length in [0, 7, 40, picture.len() - 13] {
        fs::write(desk.path("paint.png"), &picture[..length]).expect("written");
        failed(&["model.toml:", "paint.png"]);
    }
    fs::write(desk.path("paint.png"), &picture).expect("written");
    let mesh = read(&desk, "model.obj");
    fs::write(desk.path("model.obj"), &mesh[..mesh.len() - 12]).expect("written");
    failed(&["model.obj"]);
    fs::write(desk.path("model.obj"), &mesh).expect("written");
    // What is whole again is what was rendered: there is nothing to do.
    let (status, out, said) = desk.run(&["batch", "batch.toml"]);
    assert!(status == 0 && out.contains("2 done before"), "{out}{said}");
    // A picture that an MTL file names is replaced by gray, as anywhere, and that is another picture.
    fs::remove_file(desk.path("inner.png")).expect("removed");
    let (status, out, said) = desk.run(&["batch", "batch.toml"]);
    assert!(
        status == 0 && out.contains("`inner.png` has changed") && said.contains("made gray"),
        "{out}{said}"
    );
}

/// A texture that goes while pictures are made, after the first that shows it.
#[test]
fn what_vanishes_meanwhile_is_missed_by_who_comes_later() {
    let desk = desk();
    let jobs = "[defaults]\nscene = 'model.toml'\nframes = '1..200'\noutputs = ['{name}.###.exr']\n[[jobs]]\nname = 'a'\n";
    write(&desk, "batch.toml", jobs);
    let child = spawn(&desk, &["batch", "batch.toml", "--json", "--memory", "1", "-D", "render.spp=200"]);
    wait_for("a picture", Duration::from_secs(60), || desk.path("a.003.exr").exists());
    fs::remove_file(desk.path("paint.png")).expect("removed");
    let output = child.wait_with_output().expect("ended");
    let summary: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let (made, failed) = (&summary["counts"]["rendered"], &summary["counts"]["failed"]);
    let [made, failed] = [made, failed].map(|count| count.as_u64().expect("a number"));
    assert!(
        output.status.code() == Some(1) && made + failed == 200 && made >= 3 && failed > 0,
        "{made}, {failed}"
    );
    let pictures = desk.names().into_iter().filter(|name| name.ends_with(".exr")).count();
    assert_eq!(pictures as u64, made, "whole or absent");
    let damaged = |name: &String| name.ends_with(".exr") && exr::read(&desk.path(name)).is_err();
    assert!(
        !desk.names().iter().any(damaged) && !desk.names().iter().any(|name| name.ends_with(".tmp")),
        "whole"
    );
}

/// Checkpoints cut at every length are refused by the program's own way of reading; the program itself is run at some.
#[test]
fn truncated_checkpoints_stop_with_2_and_stay() {
    let desk = desk();
    let words =
        ["render", "still.toml", "-o", "a.exr", "--checkpoint", "a.ckpt", "--checkpoint-every", "50ms"];
    let long = [&words[..], &["--spp", "100000", "-t", "1"]].concat();
    let child = spawn(&desk, &long);
    wait_for("a checkpoint", Duration::from_secs(60), || desk.path("a.ckpt").exists());
    signal(&child, "-TERM");
    assert_eq!(child.wait_with_output().expect("ended").status.code(), Some(130), "left");
    let bytes = read(&desk, "a.ckpt");
    for length in 0..bytes.len() {
        let opened = specula::render::Checkpoint::open(&bytes[..length], length as u64);
        assert!(opened.is_err(), "{length} of {} bytes", bytes.len());
    }
    let before = desk.names();
    let step = bytes.len() / 12;
    for length in (0..bytes.len()).step_by(step).chain([7, 8, 27, 28, bytes.len() - 1]) {
        fs::write(desk.path("a.ckpt"), &bytes[..length]).expect("written");
        run(&desk, &[&long[..], &["--resume"]].concat(), 2, &["a.ckpt: ", "; "]);
        assert_eq!(read(&desk, "a.ckpt").len(), length, "as it was");
        assert_eq!(desk.names(), before, "no picture");
    }
    fs::remove_file(desk.path("a.ckpt")).expect("removed");
    fs::create_dir(desk.path("a.ckpt")).expect("made");
    run(&desk, &[&long[..], &["--resume"]].concat(), 2, &["a.ckpt"]);
}

#[test]
fn unreadable_parts_are_named() {
    let desk = desk();
    for index in 0..2 {
        let part = format!("{index}.part");
        run(&desk, &["render", "still.toml", "--slice", &format!("{index}/2"), "-o", &part], 0, &[]);
    }
    let bytes = read(&desk, "1.part");
    write(&desk, "m.exr", "old");
    fs::create_dir(desk.path("folder.part")).expect("made");
    let before = desk.names();
    // Its first page cannot be read, be it by root.
    let refused = ["folder.part", "gone.part", "/proc/self/mem", "still.toml", "/dev/null"];
    for part in refused {
        run(&desk, &["merge", "0.part", part, "-o", "m.exr"], 2, &[part]);
    }
    run(
        &desk,
        &["merge", "0.part", "gone.part", "folder.part", "-o", "m.exr"],
        2,
        &["gone.part", "folder.part"],
    );
    for length in (0..bytes.len()).step_by(bytes.len() / 16).chain([bytes.len() - 1]) {
        fs::write(desk.path("1.part"), &bytes[..length]).expect("written");
        run(&desk, &["merge", "0.part", "1.part", "-o", "m.exr"], 2, &["1.part: "]);
    }
    assert_eq!(desk.names(), before, "nothing half-written");
    assert_eq!(read(&desk, "m.exr"), b"old", "untouched");
}

/// A clock of the world that jumps by a day whenever somebody looks, forwards and back; the one that only runs is left alone.
const JUMPING: &str = r#"
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
static long jump(void) {
    static long count;
    count++;
    return (count % 2 ? 86400 : -86400) * (count % 7);
}
int clock_gettime(clockid_t id, struct timespec *t) {
    int status = syscall(SYS_clock_gettime, id, t);
    if (status == 0 && (id == CLOCK_REALTIME || id == CLOCK_REALTIME_COARSE)) t->tv_sec += jump();
    return status;
}
int gettimeofday(struct timeval *t, void *zone) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    t->tv_sec = now.tv_sec;
    t->tv_usec = now.tv_nsec / 1000;
    return 0;
}
time_t time(time_t *t) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (t) *t = now.tv_sec;
    return now.tv_sec;
}
"#;

#[test]
fn clocks_that_jump_change_nothing() {
    let desk = desk();
    write(&desk, "jump.c", JUMPING);
    let mut compile = Command::new("cc");
    compile.args(["-shared", "-fPIC", "-o", "jump.so", "jump.c"]).current_dir(desk.path("."));
    if !compile.status().is_ok_and(|status| status.success()) {
        println!("skipped: there is no compiler for C");
        return;
    }
    let jumping = |words: &[&str]| {
        let output =
            desk.command().env("LD_PRELOAD", desk.path("jump.so")).args(words).output().expect("run");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{words:?}: {said}");
        said
    };
    // The clock does jump.
    let date = |preload: bool| {
        let mut date = Command::new("date");
        if preload {
            date.env("LD_PRELOAD", desk.path("jump.so"));
        }
        let output = date.arg("+%s").output().expect("run");
        String::from_utf8_lossy(&output.stdout).trim().parse::<i64>().expect("seconds")
    };
    assert!((date(true) - date(false)).abs() > 40_000, "a jump");
    let stats = |name: &str| serde_json::from_slice::<Value>(&read(&desk, name)).expect("JSON");
    let words = ["render", "still.toml", "--spp", "20000", "--time-limit", "1h"];
    run(&desk, &[&words[..], &["-o", "a.exr"]].concat(), 0, &[]);
    let keeping = ["--checkpoint", "c", "--checkpoint-every", "50ms", "--log-level", "debug"];
    let said = jumping(&[&words[..], &["-o", "b.exr", "--stats", "b.json"], &keeping].concat());
    assert!(said.contains("samples in `c`"), "a checkpoint: {said}");
    assert_eq!(stats("b.json")["ended_by"], "samples", "a day is not over");
    assert!(desk.channels("a.exr") == desk.channels("b.exr"), "the same picture");
    let begin = Instant::now();
    jumping(&[
        "render",
        "still.toml",
        "-q",
        "--spp",
        "16777216",
        "-o",
        "c.exr",
        "--time-limit",
        "300ms",
        "--stats",
        "c.json",
    ]);
    assert_eq!(stats("c.json")["ended_by"], "time", "a third of a second is, whatever the clock says");
    assert!(begin.elapsed() < Duration::from_secs(120), "not a day");
    // Files from the future and from long ago are what they hold.
    jumping(&["batch", "still.toml", "-q"]);
    let day = Duration::from_secs(86_400);
    let picture = File::options().write(true).open(desk.path("paint.png")).expect("there");
    for time in [SystemTime::now() + 1000 * day, SystemTime::UNIX_EPOCH + day] {
        picture.set_modified(time).expect("set");
        let (_, out, _) = desk.run(&["batch", "still.toml"]);
        assert!(out.contains("1 done before"), "{out}");
    }
    models::paint(&desk, "paint.png", [1, 2, 3]);
    picture.set_modified(SystemTime::UNIX_EPOCH + day).expect("set");
    let (_, out, _) = desk.run(&["batch", "still.toml"]);
    assert!(out.contains("`paint.png` has changed"), "{out}");
}

/// Memory in use, in bytes.
fn resident(id: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

/// Sixty frames in which a mesh of 20 000 triangles moves: its hierarchy is built for each.
#[test]
fn memory_does_not_grow_with_frames() {
    let desk = desk();
    let side = 100;
    let mut mesh = String::new();
    for j in 0..=side {
        for i in 0..=side {
            let at = |n: i32| f64::from(n) / 50.0 - 1.0;
            mesh += &format!("v {} {:.4} {}\n", at(i), 0.1 * (f64::from(i * j) * 0.01).sin(), at(j));
        }
    }
    for j in 0..side {
        for i in 0..side {
            let corner = j * (side + 1) + i + 1;
            mesh += &format!("f {} {} {} {}\n", corner, corner + 1, corner + side + 2, corner + side + 1);
        }
    }
    write(&desk, "grid.obj", &mesh);
    let moving = format!("type = \"mesh\"\nmaterial = \"glass\"\n{}\nfile = \"grid.obj\"", models::KEYS);
    write(&desk, "grid.toml", &models::scene("").replace("type = \"mesh\"\nfile = \"model.obj\"", &moving));
    let mut child = spawn(&desk, &["batch", "grid.toml", "-q", "--frames", "1..60", "-o", "#.exr"]);
    let (mut early, mut late) = (0, 0);
    while child.try_wait().expect("asked").is_none() {
        let now = resident(child.id()).unwrap_or(0);
        let done = desk.names().iter().filter(|name| name.ends_with(".exr")).count();
        match done {
            5..=20 => early = early.max(now),
            40.. => late = late.max(now),
            _ => {}
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(child.wait().expect("ended").success(), "rendered");
    println!("{} and {} MiB", early >> 20, late >> 20);
    // The mesh and its hierarchy are 3 MiB or more: forty of them would be 120.
    assert!(
        early > 0 && late > 0 && late <= early + (16 << 20),
        "{early} bytes of twenty frames, {late} of sixty"
    );
}

/// Jobs that are hardly any work.
#[test]
fn a_thousand_jobs_are_rendered_once() {
    let desk = desk();
    let mut jobs = "[defaults]\nscene = 'still.toml'\noutputs = ['{name}.exr']\noverrides = { film.width = 2, film.height = 2 }\n".to_owned();
    for i in 0..1000 {
        jobs += &format!("[[jobs]]\nname = 'j{i}'\noverrides = {{ render.spp = 1, render.seed = {i} }}\n");
    }
    write(&desk, "batch.toml", &jobs);
    let (status, out, said) = desk.run(&["batch", "batch.toml", "--jobs", "2", "-q"]);
    assert!(status == 0 && out.contains("1000 rendered; 3 files read"), "{said}");
    let (status, out, said) = desk.run(&["batch", "batch.toml", "-q"]);
    assert!(status == 0 && out.contains("1000 done before"), "{said}");
}
