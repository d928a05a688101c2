//! How long a picture of a million triangles takes to its first ray, and how much memory: the program itself is run on a
//! landscape in an OBJ file, and its own statistics are read. Medians of several runs; seconds by the clock and of CPU.
//!
//! `cargo bench --bench first_ray` measures, `-- --record` also writes `benches/record/first_ray.csv`; without cargo's `--bench`
//! a small landscape runs once, only to show that it does.

#![expect(clippy::print_stdout, reason = "a bench prints its results")]

#[path = "support/terrain.rs"]
mod terrain;

use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

const SCENE: &str = r#"
    [camera]
    from = [0.0, 1.1, 2.2]
    at = [0.0, 0.2, 0.0]
    vfov_deg = 45.0
    [render]
    spp = 1
    [materials.rock]
    type = "diffuse"
    [[shapes]]
    type = "mesh"
    file = "terrain.obj"
    material = "rock"
    [[lights]]
    type = "directional"
    direction = [1.0, -0.6, -0.4]
    irradiance = 3.0
    [[lights]]
    type = "environment"
    radiance = [0.3, 0.4, 0.6]
"#;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let has = |flag: &str| words.iter().any(|word| word == flag);
    let (cells, runs) = if has("--bench") { (708, 7) } else { (40, 1) };
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("scene.toml"), SCENE).expect("a scene");
    std::fs::write(folder.path().join("terrain.obj"), obj(cells)).expect("a landscape");
    let reports: Vec<Value> = (0..runs).map(|_| run(folder.path())).collect();
    let table = table(2 * u64::from(cells) * u64::from(cells), &reports);
    print!("{table}");
    if has("--record") {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/record/first_ray.csv");
        std::fs::write(path, table).expect("a record");
    }
}

fn obj(cells: u32) -> String {
    let mesh = terrain::terrain(cells);
    let mut text = String::new();
    for p in mesh.positions().iter() {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z).expect("memory");
    }
    for t in mesh.triangles().iter() {
        let [a, b, c] = t.map(|i| i + 1);
        writeln!(text, "f {a} {b} {c}").expect("memory");
    }
    text
}

/// The statistics of one run.
fn run(folder: &Path) -> Value {
    let stats = folder.join("stats.json");
    let status = Command::new(env!("CARGO_BIN_EXE_specula"))
        .current_dir(folder)
        .args(["render", "scene.toml", "-q", "-o", "terrain.png", "--stats"])
        .arg(&stats)
        .stdout(Stdio::null())
        .status()
        .expect("the program");
    assert!(status.success(), "the program failed");
    serde_json::from_slice(&std::fs::read(stats).expect("statistics")).expect("JSON")
}

fn table(triangles: u64, reports: &[Value]) -> String {
    let median = |path: &str| {
        let mut values: Vec<f64> = reports
            .iter()
            .map(|report| report.pointer(path).and_then(Value::as_f64).expect("a number"))
            .collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let mut text =
        format!("# {triangles} triangles, 1280 x 720, 1 sample per pixel, median of {}\n", reports.len());
    text += "phase,wall_s,cpu_s,share_of_wall\n";
    let phases = ["load", "build", "render", "write"];
    let wall = |phase: &str| median(&format!("/phases/{phase}/wall_s"));
    let all: f64 = phases.iter().map(|phase| wall(phase)).sum();
    for phase in phases {
        let cpu = median(&format!("/phases/{phase}/cpu_s"));
        writeln!(text, "{phase},{:.3},{cpu:.3},{:.3}", wall(phase), wall(phase) / all).expect("memory");
    }
    let first_ray = wall("load") + wall("build");
    writeln!(text, "time to first ray,{first_ray:.3},,").expect("memory");
    #[expect(clippy::cast_precision_loss, reason = "a count of triangles")]
    let per_triangle = |bytes: f64| bytes / triangles as f64;
    let (peak, bvh) = (median("/peak_rss_bytes"), median("/bvh_bytes"));
    writeln!(text, "peak resident bytes,{peak},,\nper triangle,{:.1},,", per_triangle(peak)).expect("memory");
    writeln!(text, "hierarchy bytes,{bvh},,\nper triangle,{:.1},,", per_triangle(bvh)).expect("memory");
    text
}
