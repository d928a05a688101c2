//! What `farm` writes is run: by a shell that plays a node, by Slurm where its packages are, and by `openjd` where that is; the picture is
//! that of one run.

#![cfg(unix)]
#![expect(clippy::print_stdout, reason = "tests tell what they skip, and when tasks ran")]

#[path = "farm/cluster.rs"]
mod cluster;
#[path = "support/desk.rs"]
mod desk;
#[path = "support/pictures.rs"]
mod pictures;
#[path = "support/room.rs"]
mod room;
#[path = "support/running.rs"]
mod running;

use cluster::Cluster;
use desk::Desk;
use room::room;
use running::{signal, wait_for};
use serde_json::{Value, json};
use specula::image::exr;
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A name that a shell and templates could take for something else.
const ODD: &str = "it's \"odd\"; $(touch gone) `touch gone` {{Param.x}} # ü";

/// One that Slurm could, too.
const ODDER: &str = "it's \"odder\"; %A_%a %% \\ {{Param.x}} # ü";

/// A folder of such a name with a scene in it.
fn desk(name: &str) -> (Desk, PathBuf) {
    let desk = Desk::new();
    let folder = desk.path(name);
    fs::create_dir(&folder).expect("made");
    let mesh = "[[shapes]]\ntype = \"mesh\"\nfile = \"sub/a mesh.obj\"\nmaterial = \"wall\"\n";
    let scene = room("integrator = \"path\"\nspp = 48") + mesh;
    fs::write(folder.join("a room.toml"), scene).expect("written");
    fs::create_dir(folder.join("sub")).expect("made");
    fs::write(folder.join("sub/a mesh.obj"), "v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n").expect("written");
    (desk, folder)
}

/// The program in a folder.
fn specula(folder: &Path) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("specula"));
    command.current_dir(folder).stdin(Stdio::null());
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs a command that must succeed; its standard output.
fn done(command: &mut Command) -> String {
    let output = command.output().expect("run");
    assert!(output.status.success(), "{command:?}: {}{}", text(&output.stdout), text(&output.stderr));
    text(&output.stdout)
}

/// The document of `farm ENGINE a room.toml`.
fn farm(folder: &Path, engine: &str, flags: &[&str]) -> Value {
    let out = done(specula(folder).args(["farm", engine, "a room.toml", "-q", "--json"]).args(flags));
    serde_json::from_str(&out).expect("JSON")
}

/// A script run as Slurm would on a node, for a slice or for a job.
fn node(script: &Path, variables: &[(&str, &str)]) -> Command {
    let mut command = Command::new("sh");
    command.arg(script).current_dir("/").stdin(Stdio::null()).env("SLURM_CPUS_ON_NODE", "1");
    command.envs(variables.iter().copied()).env_remove("SLURM_RESTART_COUNT");
    if let Some((_, count)) = variables.iter().find(|(name, _)| *name == "SLURM_RESTART_COUNT") {
        command.env("SLURM_RESTART_COUNT", count);
    }
    command
}

fn paths(document: &Value, key: &str) -> Vec<PathBuf> {
    let paths = document[key].as_array().expect("a list").iter();
    paths.map(|path| path.as_str().expect("a path").into()).collect()
}

/// Asserts that pictures agree to rounding, each channel relative to its greatest value.
fn assert_same(wanted: &Path, found: &Path) {
    let [found, wanted] = [found, wanted].map(|path| exr::read(path).expect("a picture"));
    pictures::assert_close(&found, &wanted, (1e-5, None));
}

/// A folder with a command of this name that does what the script says.
fn command_of(desk: &Desk, name: &str, script: &str) -> PathBuf {
    use std::os::unix::fs::PermissionsExt as _;
    let bin = desk.path("bin");
    fs::create_dir_all(&bin).expect("made");
    fs::write(bin.join(name), script).expect("written");
    fs::set_permissions(bin.join(name), fs::Permissions::from_mode(0o755)).expect("may be run");
    bin
}

/// Damages the sums in a file.
fn flip(path: &Path) {
    let mut bytes = fs::read(path).expect("there");
    let at = bytes.len() - 100;
    bytes[at] ^= 1;
    fs::write(path, bytes).expect("written");
}

/// `PATH` with a folder before all others.
fn path_with(bin: &Path) -> std::ffi::OsString {
    let others = std::env::var_os("PATH").unwrap_or_default();
    std::env::join_paths(std::iter::once(bin.to_owned()).chain(std::env::split_paths(&others)))
        .expect("names")
}

#[test]
fn the_scripts_make_the_picture_whatever_its_folder_is_called() {
    let (_desk, folder) = desk(ODD);
    let flags =
        ["--aov=albedo,variance", "-D", "materials.wall.reflectance=[0.5, 0.4, 0.3]", "--crop=3,2,30,20"];
    done(specula(&folder).args(["render", "a room.toml", "-q", "-o", "one.exr"]).args(flags));
    let further =
        ["-o", "all $@.exr", "-o", "all.png", "--stats", "all.json", "--slices=3", "--checkpoint-every=5s"];
    let document = farm(&folder, "slurm", &[&flags[..], &further].concat());
    assert_eq!(document["slices"], 3, "{document}");
    assert_eq!(document["to_render"], json!([0, 1, 2]), "{document}");
    let files = paths(&document, "files");
    let names: Vec<_> = files.iter().map(|path| path.file_name().expect("a name")).collect();
    assert_eq!(names, ["tasks.sbatch", "merge.sbatch", "submit.sh"], "{document}");
    let dir = folder.join("all $@.farm");
    assert!(files.iter().all(|path| path.parent() == Some(&dir)), "{document}");

    let tasks = fs::read_to_string(&files[0]).expect("there");
    for line in ["#SBATCH --array=0-2", "#SBATCH --requeue", "#SBATCH --open-mode=append"] {
        assert!(tasks.lines().any(|found| found == line), "{line} in {tasks}");
    }
    let last = tasks.lines().last().expect("lines");
    for word in [
        "--checkpoint-every=5s",
        "--aov=albedo --aov=variance",
        "'materials.wall.reflectance=[0.5, 0.4, 0.3]'",
    ] {
        assert!(last.contains(word), "{word} in {last}");
    }
    assert!(!tasks.contains("all.json") && !tasks.contains("--output=all"), "what is for the merge: {tasks}");

    for slice in ["0", "1", "2"] {
        let said = done(&mut node(&files[0], &[("SLURM_ARRAY_TASK_ID", slice)]));
        assert!(said.contains(&format!("slice {slice} of 3")), "{said}");
    }
    done(&mut node(&files[1], &[("SLURM_JOB_ID", "9")]));
    assert_eq!(fs::read_to_string(dir.join("merge-9.status")).expect("there"), "0\n", "status");
    assert_same(&folder.join("one.exr"), &folder.join("all $@.exr"));
    let stats: Value =
        serde_json::from_slice(&fs::read(folder.join("all.json")).expect("there")).expect("JSON");
    assert_eq!(stats["spp"], 48, "{stats}");
    assert!(folder.join("all.png").is_file() && !folder.join("gone").exists(), "nothing was run by a name");
    let left: Vec<_> =
        fs::read_dir(&dir).expect("there").map(|entry| entry.expect("an entry").file_name()).collect();
    assert_eq!(left.len(), 3 + 3 + 1, "scripts, parts and the status: {left:?}");
}

#[test]
fn tasks_trust_the_scene_as_far_as_was_said() {
    let (_desk, folder) = desk(ODD);
    let flags = ["-o", "a.exr", "--slices=2", "--sandbox", "--limits", "pixels=4e8,bytes=none"];
    let files = paths(&farm(&folder, "slurm", &flags), "files");
    let [tasks, merge] = [0, 1].map(|i| fs::read_to_string(&files[i]).expect("there"));
    let last = tasks.lines().last().expect("lines");
    for word in ["--sandbox", "--limits=pixels=4e8", "--limits=bytes=none"] {
        assert!(last.contains(word), "{word} in {last}");
    }
    // A part is no scene, but it may be as large as the picture.
    assert!(
        merge.contains("--limits=pixels=400000000,bytes=none") && !merge.contains("--sandbox"),
        "{merge}"
    );
    for slice in ["0", "1"] {
        done(&mut node(&files[0], &[("SLURM_ARRAY_TASK_ID", slice)]));
    }
    done(&mut node(&files[1], &[("SLURM_JOB_ID", "1")]));
    assert!(folder.join("a.exr").is_file(), "merged");
    let files = paths(&farm(&folder, "openjd", &flags), "files");
    let template = fs::read_to_string(&files[0]).expect("there");
    assert!(template.contains("\"--limits=pixels=400000000,bytes=none\""), "{template}");
}

#[test]
fn what_is_there_is_not_rendered_again_and_other_pictures_do_not_count() {
    let (_desk, folder) = desk(ODD);
    let flags = ["--slices=6", "-o", "a.exr", "--at-once=2"];
    let document = farm(&folder, "slurm", &flags);
    let (files, parts) = (paths(&document, "files"), paths(&document, "parts"));
    assert!(fs::read_to_string(&files[0]).expect("there").contains("--array=0-5%2\n"), "all");
    for slice in ["1", "2", "4"] {
        done(&mut node(&files[0], &[("SLURM_ARRAY_TASK_ID", slice)]));
    }
    fs::write(&parts[2], b"half").expect("written");
    flip(&parts[4]);
    assert_eq!(
        farm(&folder, "slurm", &flags)["to_render"],
        json!([0, 2, 3, 4, 5]),
        "one is no part, one has damaged sums"
    );
    assert!(fs::read_to_string(&files[0]).expect("there").contains("--array=0,2-5%2\n"), "some");
    assert!(parts[1].exists() && !parts[2].exists() && !parts[4].exists(), "nobody takes them for parts");
    let others: [&[&str]; 4] = [&["--seed=2"], &["--aov=depth"], &["--crop=0,0,9,9"], &["--max-depth=3"]];
    for more in others {
        let document = farm(&folder, "slurm", &[&flags[..], more].concat());
        assert_eq!(document["to_render"], json!([0, 1, 2, 3, 4, 5]), "{more:?}");
        assert!(paths(&document, "parts").iter().all(|part| !parts.contains(part)), "{more:?}: other files");
    }
    farm(&folder, "slurm", &flags);
    for slice in ["0", "2", "3", "4", "5"] {
        done(&mut node(&files[0], &[("SLURM_ARRAY_TASK_ID", slice)]));
    }
    assert_eq!(farm(&folder, "slurm", &flags)["files"].as_array().map(Vec::len), Some(2), "the merge alone");
    done(&mut node(&files[1], &[("SLURM_JOB_ID", "1")]));
    assert!(folder.join("a.exr").is_file(), "merged");
}

/// How long a slice shall take at least, so that it is met under way.
const LONG: [&str; 4] = ["-D", "film.width=160", "-D", "film.height=90"];

#[test]
fn a_task_that_is_asked_to_stop_goes_on_where_it_was() {
    let (_desk, folder) = desk(ODD);
    let flags = [
        &LONG[..],
        &["--spp=8192", "--slices=2", "-o", "a.exr", "--checkpoint-every=1s", "--log-level=info"],
    ]
    .concat();
    let document = farm(&folder, "slurm", &flags);
    let (files, parts) = (paths(&document, "files"), paths(&document, "parts"));
    let mut task = node(&files[0], &[("SLURM_ARRAY_TASK_ID", "0")]);
    let task = task.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("started");
    let dir = folder.join("a.farm");
    let is_kept = || checkpoints_of(&dir, 0) > 0;
    wait_for("a checkpoint", Duration::from_secs(60), is_kept);
    signal(&task, "-TERM");
    let output = task.wait_with_output().expect("ended");
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    assert!(is_kept() && !parts[0].exists(), "a checkpoint and no part");

    let again = [("SLURM_ARRAY_TASK_ID", "0"), ("SLURM_RESTART_COUNT", "1")];
    let output = node(&files[0], &again).output().expect("run");
    assert!(output.status.success(), "{}", text(&output.stderr));
    // The log of tasks is that of the command.
    assert!(text(&output.stderr).contains("going on from"), "{}", text(&output.stderr));
    assert!(!is_kept() && parts[0].is_file(), "a part and no checkpoint");
    let said = done(&mut node(&files[0], &again));
    assert!(said.contains("an earlier run has written it"), "{said}");
}

#[test]
fn checkpoints_that_are_damaged_or_of_another_embree_stop_no_slice_for_good() {
    let (desk, folder) = desk(ODD);
    let own = [
        &LONG[..],
        &["--spp=1024", "--slices=2", "-o", "a.exr", "--checkpoint-every=200ms", "--log-level=info"],
    ]
    .concat();
    let first = [("SLURM_ARRAY_TASK_ID", "0")];
    let script = |flags: &[&str]| paths(&farm(&folder, "slurm", flags), "files").remove(0);
    let dir = folder.join("a.farm");
    let leave = |script: &Path| {
        let mut task =
            node(script, &first).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("started");
        wait_for("a checkpoint", Duration::from_secs(60), || checkpoints_of(&dir, 0) > 0);
        task.kill().expect("killed");
        task.wait().expect("ended");
    };
    leave(&script(&own));
    flip(&files_of(&dir, "part-", ".ckpt")[0]);
    let output = node(&dir.join("tasks.sbatch"), &first).output().expect("run");
    let said = text(&output.stderr);
    assert!(output.status.code() == Some(2) && said.contains("damaged"), "{said}");
    assert!(said.contains("remove it to begin anew"), "{said}");
    let tasks = script(&own);
    assert_eq!(checkpoints_of(&dir, 0), 0, "the same command again takes it away");
    leave(&tasks);

    // Stands for a machine with another Embree.
    let real = assert_cmd::cargo::cargo_bin("specula");
    let text_of = format!(
        "#!/bin/sh\nif [ \"$1\" = --version ]; then echo embree 9.9.9; exit; fi\nexec '{}' \"$@\"\n",
        real.display()
    );
    let program = format!("--program={}", command_of(&desk, "other", &text_of).join("other").display());
    let output = node(&script(&[&own[..], &[program.as_str()]].concat()), &first).output().expect("run");
    let said = text(&output.stderr);
    assert!(output.status.success() && said.contains("there is no checkpoint"), "{said}");
    assert_eq!(checkpoints_of(&dir, 0), 1, "that of the first machine is left alone");
    assert_eq!(files_of(&dir, "part-", "-0.part").len(), 1, "the part");
}

#[test]
fn a_task_that_runs_twice_at_once_gives_one_sound_part() {
    let (_desk, folder) = desk(ODD);
    let picture = [&LONG[..], &["--spp=256"]].concat();
    let flags = [&picture[..], &["--slices=2", "-o", "a.exr", "--checkpoint-every=10ms"]].concat();
    let document = farm(&folder, "slurm", &flags);
    let files = paths(&document, "files");
    let run = |slice: &str| -> Child {
        let mut task = node(&files[0], &[("SLURM_ARRAY_TASK_ID", slice)]);
        task.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("started")
    };
    let mut tasks = ["0", "0", "0", "1", "1"].map(run);
    let dir = folder.join("a.farm");
    wait_for("a checkpoint", Duration::from_secs(60), || checkpoints_of(&dir, 0) > 0);
    let states = tasks[..3].iter_mut().map(|task| task.try_wait().expect("known"));
    let running = states.filter(Option::is_none).count();
    assert!(running >= 2, "{running} at once");
    for task in tasks {
        let output = task.wait_with_output().expect("ended");
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    done(&mut node(&files[1], &[("SLURM_JOB_ID", "1")]));
    done(specula(&folder).args(["render", "a room.toml", "-q", "-o", "one.exr"]).args(&picture));
    assert_same(&folder.join("one.exr"), &folder.join("a.exr"));
}

#[test]
fn filtered_reflections_are_sliced_with_checkpoints() {
    let (_desk, folder) = desk(ODD);
    let flags = [
        "--integrator=whitted",
        "--glossy=two-pass",
        "--slices=2",
        "-o",
        "a.exr",
        "--checkpoint-every=5s",
        "--no-specialise",
    ];
    for engine in ["slurm", "openjd"] {
        let written = fs::read_to_string(&paths(&farm(&folder, engine, &flags), "files")[0]).expect("there");
        for word in ["--checkpoint=", "--resume", "--checkpoint-every=5s", "--no-specialise"] {
            assert!(written.contains(word), "{engine}: {word} in {written}");
        }
    }
    let files = paths(&farm(&folder, "slurm", &flags), "files");
    for slice in ["0", "1"] {
        done(&mut node(&files[0], &[("SLURM_ARRAY_TASK_ID", slice)]));
    }
    done(&mut node(&files[1], &[("SLURM_JOB_ID", "1")]));
    assert!(folder.join("a.exr").is_file(), "merged");
}

#[test]
fn what_cannot_be_farmed_out_is_refused_before_anything_is_written() {
    let (_desk, folder) = desk(ODD);
    let cases: [(&[&str], &[&str]); 15] = [
        (&["--time-limit=90s"], &["--time-limit", "known beforehand", "--spp"]),
        (&["--target-error=0.1"], &["--target-error", "--spp"]),
        (&["--slice=0/2"], &["--slice", "--slices"]),
        (&["--checkpoint=a.ckpt"], &["--checkpoint", "own"]),
        (&["--resume"], &["--resume", "leave it out"]),
        (&["--aov=gbuffer"], &["gbuffer", "first pass"]),
        (&["-o", "a.part"], &["a.part", ".exr or .png"]),
        (&["--display=localhost:14158"], &["--display", "leave it out"]),
        (&["--slices=0"], &["--slices", "from 1 to"]),
        (&["--slices=49"], &["48 samples", "49 slices"]),
        (&["--wait"], &["--wait", "--submit"]),
        (&["--spp=0", "--max-depth=x"], &["render.spp", "render.max_depth"]),
        (&["--crop=0,0,99,99"], &["crop", "37"]),
        (&["--checkpoint-every=never"], &["--checkpoint-every", "90s"]),
        (&["-D", "shapes.0.file=none.obj"], &["file"]),
    ];
    for engine in ["slurm", "openjd"] {
        for (flags, parts) in cases {
            let output =
                specula(&folder).args(["farm", engine, "a room.toml"]).args(flags).output().expect("run");
            let said = text(&output.stderr);
            assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{flags:?}: {said}");
            parts.iter().for_each(|part| assert!(said.contains(part), "{flags:?}: `{part}` in {said}"));
        }
    }
    let words = ["farm", "slurm", "a room.toml", "--sbatch-option=--array=0-9", "--at-once=0", "--slices=x"];
    let output = specula(&folder).args(words).output().expect("run");
    let told = text(&output.stderr).lines().filter(|line| line.starts_with("error: ")).count();
    assert_eq!((output.status.code(), told), (Some(2), 3), "all at once: {}", text(&output.stderr));
    let names: Vec<_> = fs::read_dir(&folder).expect("there").collect();
    assert_eq!(names.len(), 2, "only the scene: {names:?}");

    let output = specula(&folder)
        .args(["farm", "slurm", "a room.toml", "--dir", "a room.toml/x"])
        .output()
        .expect("run");
    assert_eq!(output.status.code(), Some(1), "a directory that cannot be: {}", text(&output.stderr));
    assert!(text(&output.stderr).contains("a room.toml/x"), "{}", text(&output.stderr));
}

#[test]
fn jobs_are_queued_with_the_merge_behind_the_tasks() {
    let (desk, folder) = desk(ODD);
    let told = desk.path("told");
    // Stands for Slurm: notes its words and gives numbers.
    let sbatch = format!(
        "#!/bin/sh\necho \"sbatch $(pwd)\" >>{0}\nprintf '<%s>\\n' \"$@\" >>{0}\n[ -f \"$REFUSE\" ] && grep -q dependency {0} && echo no >&2 && exit 1\necho \"$(grep -c '^sbatch' {0})4;east\"\n",
        told.display()
    );
    let bin = command_of(&desk, "sbatch", &sbatch);
    command_of(&desk, "scancel", &format!("#!/bin/sh\necho \"scancel $*\" >>{}\n", told.display()));
    let submit = |more: &[&str]| {
        let words = [
            "farm",
            "slurm",
            "a room.toml",
            "-o",
            "a.exr",
            "--submit",
            "--sbatch-option=--comment=it's \"two words\"",
        ];
        let mut command = specula(&folder);
        command.args(words).args(more).env("PATH", path_with(&bin));
        command
    };
    let out = done(&mut submit(&["-q"]));
    let dir = folder.join("a.farm");
    let names =
        ["tasks.sbatch", "merge.sbatch", "submit.sh"].map(|name| dir.join(name).display().to_string());
    let lines: Vec<_> = out.lines().collect();
    assert_eq!(lines, [&names[0], &names[1], &names[2], "tasks 14", "merge 24"], "printed");
    let noted = fs::read_to_string(&told).expect("there");
    let option = "<--comment=it's \"two words\">";
    let wanted = format!(
        "sbatch {0}\n<--parsable>\n{option}\n<tasks.sbatch>\nsbatch {0}\n<--parsable>\n{option}\n<--dependency=afterok:14>\n<--kill-on-invalid-dep=yes>\n<merge.sbatch>\n",
        dir.display()
    );
    assert_eq!(noted, wanted, "what Slurm was told");
    fs::remove_file(&told).expect("removed");
    let document: Value = serde_json::from_str(&done(&mut submit(&["-q", "--json"]))).expect("JSON");
    assert_eq!((&document["tasks"], &document["merge"]), (&json!("14"), &json!("24")), "{document}");

    // A merge that is not taken takes the tasks with it.
    fs::remove_file(&told).expect("removed");
    let output = submit(&[]).env("REFUSE", folder.join("a room.toml")).output().expect("run");
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("not queued: no"), "{}", text(&output.stderr));
    assert!(
        fs::read_to_string(&told).expect("there").ends_with("scancel --clusters=east 14\n"),
        "no task stays"
    );

    let output = submit(&[]).env("PATH", "/nowhere").output().expect("run");
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "without Slurm: {said}");
    assert!(said.contains("no `sbatch`") && said.contains("submit.sh"), "a remedy: {said}");
}

/// Flags for slices that take about so many seconds each on one processor, and how many there are in all.
fn flags_for(folder: &Path, slices: u32, seconds: f64) -> Vec<String> {
    let pilot = 256;
    let begin = Instant::now();
    let words = ["render", "a room.toml", "-q", "-t1", "-o", "pilot.exr", &format!("--spp={pilot}")];
    done(specula(folder).args(words).args(LONG));
    let each = begin.elapsed().as_secs_f64() / f64::from(pilot);
    // Whole packets of 16 samples.
    let packets = (1..400).find(|&packets| f64::from(16 * packets) * each >= seconds).unwrap_or(400);
    let mut flags = LONG.map(str::to_owned).to_vec();
    flags.push(format!("--spp={}", 16 * packets * slices));
    flags
}

/// A farm under way: the program waits for the picture.
struct Farm {
    child: Child,
    tasks: String,
    begin: Instant,
}

impl Farm {
    /// Submits and waits.
    fn new(cluster: &Cluster, folder: &Path, flags: &[String]) -> Self {
        let mut command = cluster.command(assert_cmd::cargo::cargo_bin("specula"));
        command.current_dir(folder).args(["farm", "slurm", "a room.toml", "--submit", "--wait"]).args(flags);
        let begin = Instant::now();
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("started");
        let mut lines = BufReader::new(child.stdout.as_mut().expect("a pipe")).lines();
        let tasks = lines.find_map(|line| Some(line.expect("text").strip_prefix("tasks ")?.to_owned()));
        drop(lines);
        let Some(tasks) = tasks else {
            panic!("not submitted: {}", text(&child.wait_with_output().expect("ended").stderr));
        };
        Self { child, tasks, begin }
    }

    /// A task by its slice.
    fn task(&self, slice: u32) -> String {
        format!("{}_{slice}", self.tasks)
    }

    /// What `cluster` says of a task comes to hold.
    fn until(&self, cluster: &Cluster, slice: u32, (key, holds): (&str, &dyn Fn(&str) -> bool)) {
        let what = format!("{key} of slice {slice}");
        wait_for(&what, Duration::from_secs(90), || holds(&cluster.told(&self.task(slice), key)));
        println!("{:6.1} s: slice {slice}: {key}={}", self.seconds(), cluster.told(&self.task(slice), key));
    }

    /// Lets a task that was put back into the queue begin at once: Slurm holds it back for two minutes.
    fn release(&self, cluster: &Cluster, slice: u32) {
        self.until(cluster, slice, ("Restarts", &|count| count == "1"));
        self.until(cluster, slice, ("JobState", &|state| state == "PENDING"));
        println!("        eligible at {}", cluster.told(&self.task(slice), "EligibleTime"));
        let job = format!("JobId={}", self.task(slice));
        done(cluster.command("scontrol").args(["update", &job, "StartTime=now"]));
    }

    fn seconds(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    fn end(self) -> Output {
        let begin = self.begin;
        let output = self.child.wait_with_output().expect("ended");
        println!("{:6.1} s: ended: {}", begin.elapsed().as_secs_f64(), output.status);
        output
    }
}

/// Files of a directory whose names begin and end so.
fn files_of(dir: &Path, begin: &str, end: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(dir).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_wanted = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.starts_with(begin) && name.ends_with(end)
    };
    entries.filter(is_wanted).collect()
}

/// How many checkpoints of a slice there are.
fn checkpoints_of(dir: &Path, slice: u32) -> usize {
    let part = format!("-{slice}.part");
    files_of(dir, "part-", ".ckpt").iter().filter(|path| path.to_string_lossy().contains(&part)).count()
}

#[test]
fn slurm_renders_the_picture_though_a_node_dies_under_it() {
    let Some(cluster) = Cluster::up(2) else { return };
    let (desk, folder) = desk(ODDER);
    let mut flags = flags_for(&folder, 4, 6.0);
    done(specula(&folder).args(["render", "a room.toml", "-q", "-o", "one.exr"]).args(&flags));
    flags.extend(["--slices=4", "-o", "a.exr", "-o", "a.png", "--checkpoint-every=1s"].map(str::to_owned));
    let farm = Farm::new(&cluster, &folder, &flags);
    let dir = folder.join("a.farm");
    let running = |state: &str| state == "RUNNING";
    [0, 1].into_iter().for_each(|slice| farm.until(&cluster, slice, ("JobState", &running)));
    let on = |node: &str| {
        let found = [0, 1].into_iter().find(|&slice| cluster.told(&farm.task(slice), "NodeList") == node);
        found.unwrap_or_else(|| panic!("nothing runs on {node}"))
    };
    let (kept, lost) = (on("n1"), on("n2"));
    let checkpoints = |slice: u32| checkpoints_of(&dir, slice);
    wait_for("checkpoints", Duration::from_secs(60), || checkpoints(kept) > 0 && checkpoints(lost) > 0);
    let parts = |slice: u32| files_of(&dir, "part-", &format!("-{slice}.part")).len();
    assert_eq!((parts(kept), parts(lost)), (0, 0), "both are under way");

    // One is asked to stop, as by somebody who needs its node; the other's node is gone without a word.
    done(cluster.command("scontrol").args(["requeue", &farm.task(kept)]));
    println!("{:6.1} s: slice {kept}: requeued", farm.seconds());
    cluster.kill("n2");
    println!("{:6.1} s: slice {lost}: killed with its node", farm.seconds());
    farm.release(&cluster, kept);
    farm.release(&cluster, lost);
    let tasks = farm.tasks.clone();
    let output = farm.end();
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).ends_with("a.png\n"), "the pictures are named");
    assert_same(&folder.join("one.exr"), &folder.join("a.exr"));
    assert!(folder.join("a.png").is_file(), "both pictures");
    for slice in [kept, lost] {
        let log = fs::read_to_string(dir.join(format!("task-{tasks}_{slice}.log"))).expect("a log");
        assert!(log.contains("restart 0") && log.contains("restart 1"), "both runs: {log}");
        let going_on = log.lines().find(|line| line.starts_with("going on from"));
        println!("slice {slice}: {}", going_on.unwrap_or("began anew"));
        assert!(going_on.is_some(), "from its checkpoint: {log}");
    }
    a_failed_slice_is_told_and_the_others_are_kept(&cluster, &folder, &desk.path("b.farm"));
}

/// One slice fails; the rest of the picture is there when it is asked for again.
fn a_failed_slice_is_told_and_the_others_are_kept(cluster: &Cluster, folder: &Path, dir: &Path) {
    use std::os::unix::fs::PermissionsExt as _;
    let program = folder.join("fails once");
    let real = assert_cmd::cargo::cargo_bin("specula");
    let script = format!(
        "#!/bin/sh\ncase \"$*\" in *--slice=1/*) echo broken >&2; exit 7 ;; esac\nexec '{}' \"$@\"\n",
        real.display()
    );
    fs::write(&program, script).expect("written");
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).expect("may be run");
    let to = format!("--dir={}", dir.display());
    let flags = ["--slices=3", "-o", "b.exr", &to, "--program=./fails once"].map(str::to_owned);
    let output = Farm::new(cluster, folder, &flags).end();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("a task has failed") || said.contains("cancelled"), "why: {said}");
    assert!(said.contains("_1.log") && !folder.join("b.exr").exists(), "which: {said}");
    assert!(
        files_of(dir, "task-", "_1.log")
            .iter()
            .any(|log| fs::read(log).is_ok_and(|text| text.ends_with(b"broken\n"))),
        "its log"
    );
    let flags = &flags[..4];
    let document = farm(folder, "slurm", &flags.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(document["to_render"], json!([1]), "{document}");
    let output = Farm::new(cluster, folder, flags).end();
    assert!(output.status.success(), "{}", text(&output.stderr));
    done(specula(folder).args(["render", "a room.toml", "-q", "-o", "c.exr"]));
    assert_same(&folder.join("c.exr"), &folder.join("b.exr"));
}

/// The command of the package openjd-cli, where the path has it.
fn openjd() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path).map(|folder| folder.join("openjd")).find(|file| file.is_file());
    if found.is_none() {
        println!("skipped: there is no `openjd` (package openjd-cli)");
    }
    found
}

#[test]
fn the_template_makes_the_picture() {
    let (_desk, folder) = desk(ODD);
    let flags = ["--aov=albedo", "-D", "render.seed=3"];
    let further =
        ["-o", "all $@.exr", "-o", "all.png", "--stats=all.json", "--half", "--slices=3", "--dir=d i r"];
    let document = farm(&folder, "openjd", &[&flags[..], &further].concat());
    let [template, parameters] = &paths(&document, "files")[..] else { panic!("{document}") };
    let parameters = format!("file://{}", parameters.display());
    let read: Value = serde_json::from_slice(&fs::read(template).expect("there")).expect("JSON");
    assert_eq!(read["specificationVersion"], "jobtemplate-2023-09", "{read}");
    let space = &read["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0];
    assert_eq!((&space["range"], &space["type"]), (&json!("0-2"), &json!("INT")), "{read}");
    assert_eq!(read["steps"][1]["dependencies"], json!([{ "dependsOn": "Render" }]), "{read}");
    let steps = read["steps"].to_string();
    assert!(
        !steps.contains("touch") && !steps.contains("render.seed"),
        "what was typed is in no step: {steps}"
    );

    let Some(openjd) = openjd() else { return };
    done(Command::new(&openjd).arg("check").arg(template));
    done(Command::new(&openjd).arg("run").arg(template).args(["-p", &parameters]));
    done(specula(&folder).args(["render", "a room.toml", "-q", "--half", "-o", "one.exr"]).args(flags));
    // Halves, but for the rounding of single values.
    let [found, wanted] =
        ["all $@.exr", "one.exr"].map(|name| exr::read(&folder.join(name)).expect("a picture"));
    pictures::assert_close(&found, &wanted, (1.0 / 1024.0, Some(1e-3)));
    assert!(folder.join("all.png").is_file() && folder.join("all.json").is_file(), "all that was asked for");
    assert!(!folder.join("gone").exists(), "nothing was run by a name");

    // What is there is not rendered again; with --submit the picture is there at once.
    let mut command = specula(&folder);
    command.args([
        "farm",
        "openjd",
        "a room.toml",
        "-q",
        "-o",
        "b.exr",
        "--dir=d i r",
        "--slices=3",
        "--submit",
    ]);
    let bin = openjd.parent().expect("a folder");
    let out = done(command.args(flags).env("PATH", path_with(bin)));
    assert!(out.ends_with("b.exr\n"), "told: {out}");
    assert!(folder.join("b.exr").is_file(), "merged");
    let output = command.env("PATH", "/nowhere").output().expect("run");
    assert_eq!(output.status.code(), Some(1), "without openjd: {}", text(&output.stderr));
    assert!(text(&output.stderr).contains("pip install openjd-cli"), "{}", text(&output.stderr));
}

#[test]
fn a_template_that_is_run_is_asked_to_stop() {
    let (desk, folder) = desk(ODD);
    // Stands for `openjd`: notes that it began, and that it was asked to stop.
    let script = format!(
        "#!/bin/sh\ntrap 'echo stopped >>{0}; exit 1' INT TERM\necho begun >>{0}\nwhile :; do sleep 0.1; done\n",
        desk.path("told").display()
    );
    let bin = command_of(&desk, "openjd", &script);
    let mut command = specula(&folder);
    command.args(["farm", "openjd", "a room.toml", "-q", "-o", "a.exr", "--submit"]);
    command.env("PATH", path_with(&bin)).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().expect("started");
    let told = || fs::read_to_string(desk.path("told")).unwrap_or_default();
    wait_for("openjd", Duration::from_secs(60), || told() == "begun\n");
    signal(&child, "-TERM");
    let output = child.wait_with_output().expect("ended");
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    assert_eq!(told(), "begun\nstopped\n", "it was asked, too");
}
