//! What leaving out brings: whole pictures of shipped scenes as they are, with each capability switched on that they do not need, and
//! with all of them; and the memory of a mesh with and without attributes of its vertices.
//! `cargo bench --bench specialise -- [--record] [part of a scene's name]`; the record is what `specula plan` quotes.
//!
//! Contestants of a race are one scene, frozen for the same picture; `tests/specialise` shows that it is the same. The word `memory`
//! measures meshes of a million triangles instead, in processes of their own; the word `duplicates` renders a mesh that is placed several
//! times, as copies in their places and as instances, its building included.

#![expect(clippy::print_stdout, reason = "a bench prints its results")]

#[path = "support/mod.rs"]
mod support;

use specula::accel::Accel as _;
use specula::accel::embree::{BuildOptions, EmbreeAccel};
use specula::error::Result;
use specula::render::{Settings, Silent, render};
use specula::scene::description::Description;
use specula::scene::needs::capability::Capabilities;
use specula::scene::{self, Needs, Scene, Wanted};
use std::fs;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::Command;
use support::{Bench, Race};

/// Scenes of different needs, with samples per pixel that take a tenth of a second or two.
const SCENES: [(&str, &str, u32); 8] = [
    ("hello", "path", 12),
    ("glossy_row", "path", 10),
    ("ray_tree", "whitted", 3),
    ("frosted", "path", 12),
    ("textures", "path", 8),
    ("depth_of_field", "distribution", 6),
    ("motion", "whitted", 6),
    ("metals", "path", 10),
];

/// Pictures are as wide as this, and 9/16 as high.
const WIDTH: u32 = 128;

/// Passes that count.
const PASSES: usize = 7;

/// Heights along an edge of the field whose memory is measured: a million triangles.
const HEIGHTS: u32 = 708;

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).find(|word| !word.starts_with('-')) {
        Some("memory") => return memory(),
        Some("duplicates") => return duplicates(),
        Some("measure") => return measure(&words),
        _ => {}
    }
    let mut bench = Bench::new("specialise").with_passes(PASSES);
    // Under `cargo test --benches` it only shows that it runs.
    let scale = if words.iter().any(|word| word == "--bench") { 1 } else { 8 };
    for (name, integrator, spp) in SCENES {
        if bench.wants(name) {
            race(&mut bench, name, integrator, (spp / scale).max(1))?;
        }
    }
    bench.finish()?;
    Ok(())
}

fn described(name: &str, overrides: &[String]) -> Result<Description> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("toml");
    Ok(scene::load(&path, overrides)?.description)
}

fn race(bench: &mut Bench, name: &str, integrator: &str, spp: u32) -> Result<()> {
    let overrides = [
        format!("film.width={WIDTH}"),
        format!("film.height={}", WIDTH * 9 / 16),
        format!("render.spp={spp}"),
        format!("render.integrator={integrator}"),
    ];
    let description = described(name, &overrides)?;
    let frozen = |wanted: &Wanted| -> Result<Scene> { Ok(scene::build_for(&description, wanted)?.scene) };
    let plain = frozen(&Wanted::default())?;
    let mut contestants = vec![];
    for capability in Capabilities::forceable().iter().filter(|it| !plain.requires(*it)) {
        let forced = Capabilities::NONE.with(capability);
        contestants.push((capability.word(), frozen(&Wanted { forced, ..Wanted::default() })?));
    }
    contestants.push(("everything", frozen(&Wanted::default().unspecialised())?));
    let pixels = (WIDTH * (WIDTH * 9 / 16)) as usize;
    let pass = |scene: &Scene| {
        let settings = Settings { threads: NonZeroUsize::new(1), ..Settings::default() };
        render(scene, &settings, &Silent).expect("a picture").statistics.counters.rays()
    };
    let mut race = Race::new(name, pixels * spp as usize, "samples").with("as it is", move || pass(&plain));
    for (name, scene) in contestants {
        race = race.with(name, move || pass(&scene));
    }
    bench.run(race);
    Ok(())
}

/// Ways to keep a mesh, as keys of its shape and words for [`measure`].
const KEPT: [(&str, &str, &str); 4] = [
    ("positions and indices", "flat", "needed"),
    ("and normals", "smooth", "needed"),
    ("and surface parameters", "flat", "kept"),
    ("and both", "smooth", "kept"),
];

/// Memory of a mesh of a million triangles, with and without attributes, each in a process of its own.
fn memory() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let picture = image::GrayImage::from_fn(HEIGHTS, HEIGHTS, |x, y| {
        let wave = (x as f32 * 0.05).sin() * (y as f32 * 0.03).cos();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 27 to 227")]
        image::Luma([(127.0 + 100.0 * wave) as u8])
    });
    picture.save(folder.path().join("heights.png"))?;
    println!(
        "bytes per triangle: of arrays, of the hierarchy with the backend's copies, and resident beside an empty scene"
    );
    let run = |normals: &str, kept: &str| -> std::result::Result<[f64; 4], Box<dyn std::error::Error>> {
        let words = ["measure", normals, kept, &folder.path().display().to_string()].map(str::to_owned);
        let output = Command::new(std::env::current_exe()?).args(words).output()?;
        let text = String::from_utf8(output.stdout)?;
        let numbers: Vec<f64> =
            text.split_whitespace().map(str::parse).collect::<std::result::Result<_, _>>()?;
        numbers
            .try_into()
            .map_err(|_| format!("{text:?}: {}", String::from_utf8_lossy(&output.stderr)).into())
    };
    let [_, _, _, empty] = run("none", "needed")?;
    for (name, normals, kept) in KEPT {
        let [triangles, arrays, hierarchy, resident] = run(normals, kept)?;
        let per = |bytes: f64| bytes / triangles;
        println!("  {name:24} {:6.1} {:6.1} {:6.1}", per(arrays), per(hierarchy), per(resident - empty));
    }
    Ok(())
}

/// Builds the scene of a height field and prints triangles, bytes of arrays, bytes of the hierarchy, and bytes resident.
fn measure(words: &[String]) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let [_, normals, kept, folder] = words else { return Err("words are missing".into()) };
    let field = format!(
        "[[shapes]]\ntype = \"height_field\"\nfile = \"heights.png\"\nnormals = \"{normals}\"\nmaterial = \"clay\"\n"
    );
    let field = if normals == "none" { String::new() } else { field };
    let path = PathBuf::from(folder).join(format!("{normals}_{kept}.toml"));
    fs::write(&path, format!("[materials.clay]\ntype = \"diffuse\"\n{field}"))?;
    let description = scene::load(&path, &[])?.description;
    let wanted = if kept == "kept" { Wanted::anything() } else { Wanted::default() };
    let scene = scene::build_for(&description, &wanted)?.scene;
    let accel = EmbreeAccel::build(&scene.world, &BuildOptions::default())?;
    let needs = Needs::of(&scene, &wanted);
    let status = fs::read_to_string("/proc/self/status")?;
    let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap_or("0 kB");
    let kibibytes: usize = resident.trim().trim_end_matches(" kB").parse()?;
    println!("{} {} {} {}", needs.primitives, needs.mesh_bytes, accel.bytes(), kibibytes * 1024);
    Ok(())
}

/// Placements of a ball of triangles: how many, and how far apart in its diameters.
const HEAPS: [(u16, f64); 4] = [(2, 1.5), (8, 1.5), (64, 1.5), (64, 0.3)];

/// A ball of triangles, placed several times: copies in their places, as shapes that name the same file become, against instances.
fn duplicates() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let mut bench = Bench::new("duplicates").with_passes(PASSES);
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("ball.obj"), ball(160, 320))?;
    for (count, apart) in HEAPS {
        let frozen = |is_instance: bool| -> std::result::Result<Scene, Box<dyn std::error::Error>> {
            let path = folder.path().join(format!("{count}_{apart}_{is_instance}.toml"));
            fs::write(&path, heap(count, apart, is_instance))?;
            Ok(scene::build_for(&scene::load(&path, &[])?.description, &Wanted::default())?.scene)
        };
        let statistics = |scene: &Scene| {
            let settings = Settings { threads: NonZeroUsize::new(1), ..Settings::default() };
            render(scene, &settings, &Silent).expect("a picture").statistics
        };
        let mut race = Race::new(
            format!("duplicates: {count} placed {apart} diameters apart"),
            160 * 90 * 16,
            "samples",
        );
        for (name, is_instance) in [("copies", false), ("instances", true)] {
            let scene = frozen(is_instance)?;
            let found = statistics(&scene);
            let part = found.build.cpu.as_secs_f64() / found.render.cpu.as_secs_f64();
            let bytes = found.hierarchy_bytes + Needs::of(&scene, &Wanted::default()).mesh_bytes;
            let figures = vec![("bytes", Some(bytes as f64)), ("build_over_tracing", Some(part))];
            race = race.with(name, move || statistics(&scene).counters.rays()).knowing(figures);
        }
        bench.run(race);
    }
    bench.finish()?;
    Ok(())
}

/// A ball of so many rings of so many quads, as OBJ.
fn ball(rings: u32, around: u32) -> String {
    let mut text = String::new();
    for ring in 0..=rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for step in 0..around {
            let turn = std::f64::consts::TAU * f64::from(step) / f64::from(around);
            let (x, y, z) = (polar.sin() * turn.cos(), polar.cos(), polar.sin() * turn.sin());
            text += &format!("v {x:.6} {y:.6} {z:.6}\n");
        }
    }
    for (ring, step) in (0..rings).flat_map(|ring| (0..around).map(move |step| (ring, step))) {
        let at = |ring: u32, step: u32| ring * around + step % around + 1;
        let [a, b, c, d] = [at(ring, step), at(ring, step + 1), at(ring + 1, step + 1), at(ring + 1, step)];
        text += &format!("f {a} {b} {c} {d}\n");
    }
    text
}

/// Balls in a square under a white sky.
fn heap(count: u16, apart: f64, is_instance: bool) -> String {
    let side = f64::from(count).sqrt().ceil();
    let far = side * apart * 2.0;
    let mut text = format!(
        "[camera]\nfrom = [0.0, {}, {}]\nat = [0.0, 0.0, 0.0]\n[film]\nwidth = 160\nheight = 90\n[render]\n\
         integrator = \"path\"\nspp = 16\nmax_depth = 4\n[materials.clay]\ntype = \"diffuse\"\n[[lights]]\n\
         type = \"environment\"\nradiance = 1.0\n",
        far * 0.6 + 2.0,
        far + 3.0
    );
    let mesh = "type = \"mesh\"\nfile = \"ball.obj\"\nmaterial = \"clay\"\n";
    if is_instance {
        text += &format!("[[shapes]]\nname = \"ball\"\nhidden = true\n{mesh}");
    }
    for i in 0..count {
        let i = f64::from(i);
        let [x, z] = [i % side, (i / side).floor()].map(|k| (k - (side - 1.0) * 0.5) * apart * 2.0);
        let form = if is_instance { "type = \"instance\"\nof = \"ball\"\n" } else { mesh };
        text += &format!("[[shapes]]\n{form}transform = [{{ translate = [{x:?}, 0.0, {z:?}] }}]\n");
    }
    text
}
