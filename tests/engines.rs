//! How much pictures depend on the way that rays are asked for: pixels that single rays, packets and streams give other values.
//!
//! Embree has kernels of their own for packets, which round otherwise; a sample beside an edge may then meet something else. Testing every
//! primitive (`brute`) has one kernel: what is left there is the rounding of shading over lanes, which is no difference where paths shade one lane
//! (`SPECULA_ISA=scalar`), and in trees the order in which the light of rays that wait for others is added. `cargo test --test engines -- --nocapture` prints the counts of
//! `benches/record/engines.md`.

#[path = "support/desk.rs"]
mod desk;

use desk::Desk;
use specula::image::{self, Image};
use std::path::Path;

const SIZE: [u32; 2] = [64, 36];

/// Scenes of few primitives: every one of them is tested by the control.
const SCENES: [&str; 5] = ["hello", "metals", "glossy_row", "soft_shadows", "motion_blur"];

const QUERIES: [&str; 3] = ["single", "packet", "stream"];

/// A picture of a scene.
fn picture(desk: &Desk, scene: &str, [integrator, backend, query]: [&str; 3], isa: &str) -> Image {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{scene}.toml"));
    let [width, height] = SIZE.map(|n| n.to_string());
    let mut command = desk.command();
    if !isa.is_empty() {
        command.env("SPECULA_ISA", isa);
    }
    let output = command
        .arg("render")
        .arg(file)
        .args(["-q", "-o", "a.exr", "--spp", "4", "--width", &width, "--height", &height])
        .args(["--max-depth", "6", "--integrator", integrator, "--backend", backend, "--query", query])
        .output()
        .expect("run");
    assert!(output.status.success(), "{scene}: {}", String::from_utf8_lossy(&output.stderr));
    image::read(&desk.path("a.exr")).expect("a picture").image
}

/// How many pixels differ in a bit, and how many by more than rounding.
fn apart(a: &Image, b: &Image) -> [usize; 2] {
    let pairs = || a.pixels().iter().zip(b.pixels());
    let bits = |x: &specula::math::Rgb<f32>| [x.r, x.g, x.b].map(f32::to_bits);
    let far = |a: f32, b: f32| (a - b).abs() > 1e-3 * a.abs().max(b.abs()).max(1e-3);
    [
        pairs().filter(|(a, b)| bits(a) != bits(b)).count(),
        pairs().filter(|(a, b)| far(a.r, b.r) || far(a.g, b.g) || far(a.b, b.b)).count(),
    ]
}

#[test]
fn engines_differ_by_what_embrees_kernels_and_rounding_do() {
    let desk = Desk::new();
    let pixels = (SIZE[0] * SIZE[1]) as usize * SCENES.len();
    println!("of {pixels} pixels differ from single rays, in a bit and by more than 1e-3 of their value");
    for integrator in ["whitted", "distribution", "path"] {
        for (backend, isa) in [("embree", ""), ("brute", ""), ("brute", "scalar")] {
            let mut counts = [[0; 2]; 2];
            for scene in SCENES {
                let [single, others @ ..] =
                    QUERIES.map(|query| picture(&desk, scene, [integrator, backend, query], isa));
                for (count, other) in counts.iter_mut().zip(&others) {
                    let [bits, far] = apart(&single, other);
                    *count = [count[0] + bits, count[1] + far];
                }
            }
            let [packets, streams] = counts;
            println!("{integrator:12} {backend:6} {isa:6} packets {packets:?} streams {streams:?}");
            for [bits, far] in counts {
                let is_tree = integrator != "path";
                // A few samples of paths fall on the other side of an edge.
                let most = if backend == "brute" && (is_tree || isa == "scalar") { 0 } else { pixels / 100 };
                assert!(far <= most, "{integrator}, {backend} {isa}: {far} of {pixels} pixels differ");
                let same = isa == "scalar" && !is_tree;
                assert!(!same || bits == 0, "{integrator}, {backend} {isa}: {bits} pixels differ in a bit");
            }
        }
    }
}
