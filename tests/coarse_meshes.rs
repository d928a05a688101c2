//! Coarse meshes with smooth normals: no black facets where light grazes them, no black rims, no light through walls.

use specula::film::Aov;
use specula::render::{Settings, Silent, render};
use specula::scene;
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

/// A ball of ten by seven facets as an OBJ file.
fn write_ball(folder: &Path) {
    const AROUND: usize = 10;
    const DOWN: usize = 7;
    let at = |i: usize, j: usize| 1 + j * AROUND + i % AROUND;
    let mut text = String::new();
    for j in 0..=DOWN {
        for i in 0..AROUND {
            let [theta, phi] = [PI * j as f64 / DOWN as f64, 2.0 * PI * i as f64 / AROUND as f64];
            let (r, y) = theta.sin_cos();
            // All points of a pole are one.
            let r = if j % DOWN == 0 { 0.0 } else { r };
            let _ = writeln!(text, "v {:.9} {y:.9} {:.9}", r * phi.cos(), r * phi.sin());
        }
    }
    for (j, i) in (0..DOWN).flat_map(|j| (0..AROUND).map(move |i| (j, i))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        let [top, bottom] = [at(0, 0), at(0, DOWN)];
        match j {
            0 => _ = writeln!(text, "f {top} {c} {d}"),
            j if j + 1 == DOWN => _ = writeln!(text, "f {a} {b} {bottom}"),
            _ => _ = writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}"),
        }
    }
    std::fs::write(folder.join("ball.obj"), text).expect("a mesh");
}

/// The ways of following light, each of which leaves surfaces by itself.
const WAYS: [&str; 3] = [
    "integrator = 'whitted'\nbackend = 'bvh2'\nspp = 16\nmax_depth = 24",
    "integrator = 'path'\nquery = 'single'\nbackend = 'bvh2'\nspp = 16\nmax_depth = 24",
    "integrator = 'path'\nbackend = 'bvh2'\nspp = 16\nmax_depth = 24",
];

/// The ball in front of a camera, a mesh or a true sphere, of a material, under lights.
fn picture(way: &str, form: &str, material: &str, rest: &str) -> Vec<f64> {
    let folder = tempfile::tempdir().expect("a folder for a scene");
    write_ball(folder.path());
    let path = folder.path().join("scene.toml");
    let text = format!(
        "[film]\nwidth = 72\nheight = 72\nfilter = 'box'\n[render]\nmin_throughput = 1e-4\n{way}\n\
         [camera]\nfrom = [0.0, 0.5, 6.0]\nat = [0.0, 0.0, 0.0]\nvfov_deg = 17.0\n[materials.m]\n{material}\n\
         [[shapes]]\n{form}\nmaterial = 'm'\n{rest}\n"
    );
    std::fs::write(&path, text).expect("a scene file");
    let loaded = scene::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
    let scene = scene::build(&loaded.description).unwrap_or_else(|error| panic!("{error}")).scene;
    let rendered = render(&scene, &Settings::default(), &Silent).expect("a picture");
    assert_eq!(rendered.film.non_finite().count(), 0, "samples that are not finite");
    let channels = rendered.film.channels(Aov::Beauty).expect("it is kept");
    channels[0].iter().map(|&x| f64::from(x)).collect()
}

const COARSE: &str = "type = 'mesh'\nfile = 'ball.obj'\nnormals = 'smooth'";
const TRUE: &str = "type = 'sphere'";

/// Lit from the side, so that the edge of the shadow runs across what is seen.
const GRAZING: &str = "[[lights]]\ntype = 'directional'\ndirection = [-1.0, -0.3, 0.1]\nirradiance = 3.0";
const FURNACE: &str = "[[lights]]\ntype = 'environment'\nradiance = 1.0";

/// Pixels within the silhouettes of both balls.
fn inside() -> impl Iterator<Item = usize> {
    let within = |i: &usize| {
        let [x, y] = [i % 72, i / 72].map(|x| x as f64 - 35.5);
        x.hypot(y) < 31.0
    };
    (0..72 * 72).filter(within)
}

#[test]
fn facets_across_the_edge_of_a_shadow_are_lit_as_the_smooth_surface_is() {
    for (name, material, bound) in [
        ("diffuse", "type = 'diffuse'\nreflectance = 0.8", 0.03),
        ("oren_nayar", "type = 'oren_nayar'\nreflectance = 0.8", 0.03),
        ("glazed", "type = 'glazed'\nreflectance = 0.8", 0.03),
        ("glossy", "type = 'glossy'\nexponent = 3\nreflectance = 0.8", 0.05),
    ] {
        for way in WAYS {
            let [coarse, smooth] = [COARSE, TRUE].map(|form| picture(way, form, material, GRAZING));
            let n = inside().count() as f64;
            let rmse = (inside().map(|i| (coarse[i] - smooth[i]).powi(2)).sum::<f64>() / n).sqrt();
            let black = inside().filter(|&i| smooth[i] > 0.05 && coarse[i] == 0.0).count();
            println!("{name}, {way:?}: RMSE {rmse:.4} against a sphere, {black} of {n} lit pixels black");
            assert!(rmse < bound, "{name}, {way:?}: RMSE {rmse} against a sphere");
            assert!(black == 0, "{name}, {way:?}: {black} pixels are black");
        }
    }
}

#[test]
fn nothing_is_lost_in_a_furnace() {
    for (name, material, least, mean_off) in [
        ("diffuse", "type = 'diffuse'\nreflectance = 1.0", 0.95, 0.01),
        ("mirror", "type = 'mirror'", 0.999, 1e-4),
        ("glass", "type = 'dielectric'", 0.9, 0.01),
        ("rough metal", "type = 'conductor'\nreflectance = 1.0\nalpha = 0.1", 0.9, 0.02),
        ("glossy", "type = 'glossy'\nexponent = 30\nreflectance = 1.0", 0.9, 0.02),
        ("rough glass", "type = 'dielectric'\nalpha = 0.1", 0.75, 0.01),
    ] {
        let [coarse, smooth] = [COARSE, TRUE].map(|form| picture(WAYS[0], form, material, FURNACE));
        let n = inside().count() as f64;
        let mean = |values: &[f64]| inside().map(|i| values[i]).sum::<f64>() / n;
        let lowest = inside().map(|i| coarse[i]).fold(f64::INFINITY, f64::min);
        let (coarse, smooth) = (mean(&coarse), mean(&smooth));
        println!("{name}: {coarse:.4} on average, {smooth:.4} of a sphere, {lowest:.3} at least");
        assert!(lowest >= least, "{name}: a pixel is {lowest}");
        assert!((coarse - smooth).abs() <= mean_off, "{name}: {coarse} against {smooth} of a sphere");
    }
}

/// Bright light on all sides of a closed room.
const OUTSIDE: &str = "[[lights]]\ntype = 'environment'\nradiance = 1e6\n\
    [[lights]]\ntype = 'directional'\ndirection = [-1.0, -0.3, 0.1]\nirradiance = 1e6\n\
    [[lights]]\ntype = 'sphere'\ncenter = [0.0, 14.0, 0.0]\nradius = 1.0\nradiance = 1e6\n";

#[test]
fn a_closed_room_is_black() {
    // The balls' smooth surfaces reach through the walls they nearly touch; the second room is a coarse ball itself.
    let walls = [
        "type = 'box'\nmin = [-1.001, -1.001, -1.001]\nmax = [1.001, 1.001, 7.0]",
        "type = 'mesh'\nfile = 'ball.obj'\nnormals = 'smooth'\ntransform = [{ scale = 8.0 }]",
    ];
    for room in walls {
        for material in [
            "type = 'diffuse'\nreflectance = 1.0",
            "type = 'mirror'",
            "type = 'dielectric'",
            "type = 'dielectric'\nalpha = 0.3",
            "type = 'glossy'\nexponent = 3\nreflectance = 0.5\ndiffuse = 0.5",
        ] {
            let wall = format!("[[shapes]]\n{room}\nmaterial = 'wall'\n[materials.wall]\ntype = 'glossy'\n");
            let wall = format!("{wall}exponent = 10\nreflectance = 0.5\ndiffuse = 0.5\n{OUTSIDE}");
            for way in WAYS {
                // The oracle, lest rays slip through the walls' own edges.
                let way = &way.replace("bvh2", "brute").replace("spp = 16", "spp = 2");
                let lit = picture(way, COARSE, material, &wall).into_iter().filter(|x| *x > 0.0).count();
                assert_eq!(lit, 0, "{room}, {material}, {way:?}: pixels that light has leaked to");
            }
        }
    }
}

#[test]
fn the_test_of_leaks_can_fail() {
    let lit = picture(WAYS[0], COARSE, "type = 'diffuse'", OUTSIDE).into_iter().filter(|x| *x > 0.0).count();
    assert!(lit > 1000, "without a room {lit} pixels are lit");
}

/// Pixels by themselves are noisy; their mean is not.
#[test]
fn paths_lose_nothing_in_a_furnace_either() {
    for (name, material, bound) in [
        ("diffuse", "type = 'diffuse'\nreflectance = 1.0", 2e-3),
        ("glass", "type = 'dielectric'", 2e-3),
        ("rough metal", "type = 'conductor'\nreflectance = 1.0\nalpha = 0.1", 5e-3),
        ("glossy", "type = 'glossy'\nexponent = 30\nreflectance = 1.0", 5e-3),
    ] {
        for way in &WAYS[1..] {
            let mean = [COARSE, TRUE].map(|form| {
                let values = picture(way, form, material, FURNACE);
                inside().map(|i| values[i]).sum::<f64>() / inside().count() as f64
            });
            println!("{name}, {way:?}: {mean:?} of a coarse ball and of a sphere");
            assert!((mean[0] - mean[1]).abs() < bound, "{name}, {way:?}: {mean:?}");
        }
    }
}
