//! Distribution ray tracing against what is known: form factors and penumbrae of area lights, one answer however many rays
//! are sent, one answer whichever strategy finds it. Significance: see `support/estimates.rs`.

#[path = "support/estimates.rs"]
mod estimates;
#[path = "support/scene.rs"]
mod support;

use estimates::{Estimate, LIMIT};
use glam::{DVec3, Vec3};
use specula::accel::Brute;
use specula::geometry::Ray;
use specula::integrator::{CameraRay, Integrator, Splitting, Stage, Whitted, Worker};
use specula::render::Settings;
use specula::sampling::SamplerKind;
use specula::scene::{self, Scene};
use std::f64::consts::{PI, TAU};
use std::num::NonZeroUsize;
use support::{bits, rendered, scene_of};

/// The tree that stops at direct light, and at what one glossy ray meets.
const fn tree(splitting: Splitting) -> Whitted {
    Whitted { max_depth: 2, min_throughput: 0.0, splitting, polished: false }
}

const fn split(lights: u32, glossy: u32) -> Splitting {
    Splitting { lights, glossy, hits: 1 }
}

/// What arrives along `ray`: the mean of `spp` samples in each of `pixels`, which are independent.
fn measure(scene: &Scene, tree: Whitted, ray: Ray, kind: SamplerKind, [pixels, spp]: [u32; 2]) -> Estimate {
    let accel = Brute::new(scene.world.clone());
    let stage = Stage::new(scene, &accel, scene.render.spp());
    let mut worker = Worker::default();
    Estimate::of((0..pixels).map(|pixel| {
        let mut sample = |index| {
            let sampler = kind.start(7, [pixel, 0], index);
            f64::from(tree.li(&stage, &CameraRay { ray, found: None }, &sampler, &mut worker).color.g)
        };
        (0..spp).map(&mut sample).sum::<f64>() / f64::from(spp)
    }))
}

/// A ray to the floor at (x, 0, 0) that comes from the side, below whatever hangs over it.
fn to_floor(x: f32) -> Ray {
    let from = Vec3::new(x, 0.25, 5.0);
    Ray::new(from, (Vec3::X * x - from).normalize())
}

/// A white floor, and whatever `above` describes: the radiance of a point of it is the form factor of a light of radiance 1.
fn over_floor(above: &str) -> Scene {
    let floor = r#"
        [materials.white]
        type = "diffuse"
        reflectance = 1.0
        [[shapes]]
        type = "rectangle"
        edge_u = [9.0, 0.0, 0.0]
        edge_v = [0.0, 0.0, -9.0]
        material = "white"
    "#;
    scene_of(&format!("{floor}{above}"))
}

/// A square light of radiance 1 that hangs at `height` and shines down.
fn square(half: f64, height: f64) -> String {
    let [u, v] = ["[H, 0.0, 0.0]", "[0.0, 0.0, H]"].map(|edge| edge.replace('H', &format!("{half:?}")));
    format!(
        "[[lights]]\ntype = \"rectangle\"\ncenter = [0.0, {height:?}, 0.0]\nedge_u = {u}\nedge_v = {v}\nradiance = 1.0\n"
    )
}

#[test]
fn soft_light_is_the_form_factor_of_the_light() {
    let disc = "[[lights]]\ntype = \"disc\"\ncenter = [0, 1, 0]\nnormal = [0, -1, 0]\nradius = 0.5\nradiance = 1.0\n";
    let sphere = "[[lights]]\ntype = \"sphere\"\ncenter = [0, 1.5, 0]\nradius = 0.5\nradiance = 1.0\n";
    for (name, light, x, truth) in [
        ("square at 1", square(0.5, 1.0), 0.0, 0.239_456_470_461),
        ("square at 0.5", square(0.5, 0.5), 0.0, 0.554_126_423_980),
        ("square aside", square(0.5, 1.0), 1.0, 0.084_353_664_388_1),
        ("disc", disc.to_owned(), 0.0, 0.2),
        ("sphere", sphere.to_owned(), 0.0, 1.0 / 9.0),
    ] {
        let scene = over_floor(&light);
        for (count, kind, size) in [
            (1, SamplerKind::Independent, [200_000, 1]),
            (5, SamplerKind::Independent, [40_000, 1]),
            (4, SamplerKind::OwenSobol, [2000, 16]),
        ] {
            let found = measure(&scene, tree(split(count, 1)), to_floor(x), kind, size);
            assert!(
                found.off(truth) < LIMIT,
                "{name}, {count} rays, {kind:?}: {found:?} for {truth}, {:.1} standard errors",
                found.off(truth)
            );
            assert!(
                found.error < 3e-3 * truth,
                "{name}, {count} rays, {kind:?}: too noisy to tell, {found:?}"
            );
        }
    }
}

/// Form factor of the rectangle [x0, x1] x [z0, z1] at a height above a horizontal receiver at the origin (Lambert 1760,
/// Photometria): half the sum over edges of the angle they subtend times the cosine of their plane's normal, over pi.
fn rectangle_form_factor([x0, x1]: [f64; 2], [z0, z1]: [f64; 2], height: f64) -> f64 {
    let corners = [[x0, z0], [x1, z0], [x1, z1], [x0, z1]].map(|[x, z]| DVec3::new(x, height, z));
    let edges = (0..4).map(|k| {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        let across = a.cross(b);
        across.length().atan2(a.dot(b)) * across.normalize().y
    });
    edges.sum::<f64>().abs() / TAU
}

/// Everything at x < 0 and `height` is in the way.
fn half_plane(height: f64) -> String {
    format!(
        r#"
        [materials.black]
        type = "diffuse"
        reflectance = 0.0
        [[shapes]]
        type = "rectangle"
        center = [-500.0, {height:?}, 0.0]
        edge_u = [500.0, 0.0, 0.0]
        edge_v = [0.0, 0.0, 500.0]
        material = "black"
        "#
    )
}

#[test]
fn a_penumbra_holds_what_is_seen_of_the_light() {
    assert!(
        (rectangle_form_factor([-0.5, 0.5], [-0.5, 0.5], 1.0) - 0.239_456_470_461).abs() < 1e-11,
        "Lambert"
    );
    let near = over_floor(&format!("{}{}", square(0.5, 2.0), half_plane(1.0)));
    for (x, count) in [(-0.45, 1), (-0.3, 4), (-0.1, 1), (0.0, 4), (0.2, 1), (0.4, 4), (0.6, 1)] {
        // The edge cuts the light, twice as high, where it is as far on the other side.
        let from = (-f64::from(x)).max(-0.5);
        let shifted = [from, 0.5].map(|edge| edge - f64::from(x));
        let truth = rectangle_form_factor(shifted, [-0.5, 0.5], 2.0);
        let found = measure(
            &near,
            tree(split(count, 1)),
            to_floor(x),
            SamplerKind::Independent,
            [400_000 / count, 1],
        );
        assert!(found.off(truth) < LIMIT, "at {x}: {found:?} for {truth}");
        assert!(found.error < 8e-3 * truth, "at {x}: too noisy to tell, {found:?}");
    }
    let dark = measure(&near, tree(split(4, 1)), to_floor(-0.51), SamplerKind::Independent, [10_000, 1]);
    assert!(dark.mean == 0.0, "the umbra is black: {dark:?}");
}

#[test]
fn far_away_a_penumbra_is_linear_and_as_noisy_as_coins() {
    let far = over_floor(&format!("{}{}", square(0.5, 200.0), half_plane(100.0)));
    let whole = 1.0 / (PI * 200.0_f64.powi(2));
    for x in [-0.4_f32, -0.2, 0.0, 0.1, 0.3] {
        let seen = 0.5 + f64::from(x);
        for count in [1, 4] {
            let found =
                measure(&far, tree(split(count, 1)), to_floor(x), SamplerKind::Independent, [100_000, 1]);
            // Weights vary by 1e-4 over the light.
            let off = (found.mean / whole - seen).abs() - 1e-4;
            assert!(off < LIMIT * found.error / whole, "at {x}, {count} rays: {found:?} for {seen}");
            let coins = seen * (1.0 - seen) / f64::from(count);
            let variance = found.variance / (whole * whole);
            // The variance of 1e5 coins is itself known to some 0.3 % at most of these places.
            assert!((variance / coins - 1.0).abs() < 0.03, "at {x}, {count} rays: {variance} for {coins}");
        }
    }
}

/// A fuzzy floor that reflects a square light, a ball and the sky.
const FUZZY: &str = r#"
    [materials.satin]
    type = "glossy"
    exponent = 60
    reflectance = 0.6
    diffuse = 0.3
    [materials.red]
    type = "glossy"
    exponent = 10
    diffuse = 0.5
    [[shapes]]
    type = "rectangle"
    edge_u = [9.0, 0.0, 0.0]
    edge_v = [0.0, 0.0, -9.0]
    material = "satin"
    [[shapes]]
    type = "sphere"
    center = [0.35, 0.9, -1.0]
    radius = 0.5
    material = "red"
    [[lights]]
    type = "rectangle"
    center = [-0.5, 1.2, -1.4]
    edge_u = [0.0, 0.3, 0.0]
    edge_v = [0.3, 0.0, 0.0]
    radiance = 5.0
    [[lights]]
    type = "point"
    position = [1.0, 2.0, 1.0]
    intensity = 1.0
    [[lights]]
    type = "environment"
    radiance = 0.4
"#;

#[test]
fn splitting_changes_the_noise_and_nothing_else() {
    let scene = scene_of(FUZZY);
    let ray = Ray::new(Vec3::new(0.0, 1.5, 2.0), Vec3::new(0.0, -1.5, -2.0).normalize());
    let tree = |splitting| Whitted { max_depth: 4, min_throughput: 0.0, splitting, polished: false };
    let found = |splitting, size| measure(&scene, tree(splitting), ray, SamplerKind::Independent, size);
    let single = found(Splitting::NONE, [200_000, 1]);
    assert!(single.error < 3e-3 * single.mean, "too noisy to tell, {single:?}");
    for (lights, glossy, hits) in [(8, 8, 1), (8, 1, 1), (1, 8, 1), (3, 2, 2), (2, 5, 9)] {
        let several = found(Splitting { lights, glossy, hits }, [40_000, 1]);
        let apart = several.apart(&single);
        assert!(apart < LIMIT, "{lights}, {glossy}, {hits}: {several:?} for {single:?}, {apart:.1} apart");
    }
    let all = found(split(8, 8), [100_000, 1]);
    let ratio = single.variance / all.variance;
    assert!((7.0..9.0).contains(&ratio), "eight of all of them have an eighth of the variance: {ratio}");
    // Splitting an independent sample is no better than so many samples; of a stratified set it is stratified itself.
    let spread =
        |splitting, spp| measure(&scene, tree(splitting), ray, SamplerKind::OwenSobol, [4000, spp]).variance;
    let (whole, parts) = (spread(Splitting::NONE, 64), spread(split(8, 8), 8));
    assert!(parts < 1.5 * whole, "eight samples split into eight are as good as 64: {parts} for {whole}");
    assert!(8.0 * parts < spread(Splitting::NONE, 8), "and better than eight by more than their number");
}

#[test]
fn light_rays_lobe_rays_and_both_agree() {
    let ray = Ray::new(Vec3::Y * 0.5, -Vec3::Y);
    for exponent in [1.0, 100.0, 1e4] {
        for size in [0.01, 1.0] {
            let floor = format!(
                r#"
                [materials.satin]
                type = "glossy"
                exponent = {exponent:?}
                reflectance = 1.0
                [[shapes]]
                type = "disc"
                material = "satin"
                [[lights]]
                type = "rectangle"
                center = [0.003, 1.0, 0.002]
                edge_u = [{half:?}, 0.0, 0.0]
                edge_v = [0.0, 0.0, {half:?}]
                radiance = 1.0
                "#,
                half = size / 2.0
            );
            let (scene, truth) = (scene_of(&floor), seen_in_lobe(exponent, size));
            let mut errors = Vec::new();
            for (lights, glossy) in [(16, 0), (0, 16), (8, 8), (12, 4), (1, 1)] {
                let found =
                    measure(&scene, tree(split(lights, glossy)), ray, SamplerKind::Independent, [60_000, 1]);
                let off = found.off(truth);
                assert!(
                    off < LIMIT,
                    "e = {exponent}, size {size}, {lights} and {glossy} rays: {found:?} for {truth}, {off:.1} off"
                );
                errors.push(found.error / truth);
            }
            let [lights, lobe, both, ..] = errors[..] else { panic!("five of them") };
            // Half as many rays of the better kind have twice its variance, and weighing adds at most 1/min(n) - 1/sum(n) of the
            // square of the truth to it (Veach and Guibas 1995, theorem 1; a fifth more for other weights and chance).
            let bound = 2.0 * lights.min(lobe).powi(2) + (1.0 / 8.0 - 1.0 / 16.0) / 60_000.0;
            assert!(
                both < 1.1 * bound.sqrt(),
                "e = {exponent}, size {size}: together {both}, apart {lights} and {lobe}"
            );
        }
    }
}

/// What cos^e about the vertical holds of a square of that size at height 1, by the midpoint rule.
fn seen_in_lobe(exponent: f64, size: f64) -> f64 {
    let steps = 1000_u16;
    let cell = size / f64::from(steps);
    let at = |i: u16, center: f64| center + cell * (f64::from(i) + 0.5) - size / 2.0;
    let mut sum = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            let to_light = DVec3::new(at(i, 0.003), 1.0, at(j, 0.002));
            let distance2 = to_light.length_squared();
            let cos = distance2.sqrt().recip();
            sum += (exponent + 1.0) / TAU * cos.powf(exponent) * cos / distance2 * cell * cell;
        }
    }
    sum
}

#[test]
fn the_integrators_are_one_tree_with_other_numbers() {
    let picture = |render: &str, threads| {
        let head = "[film]\nwidth = 40\nheight = 30\n[camera]\nlens_radius = 0.1\n[render]\nspp = 2\nbackend = 'brute'\n";
        let settings = Settings { threads: NonZeroUsize::new(threads), ..Settings::default() };
        bits(&rendered(&format!("{head}{render}\n{FUZZY}"), &settings).film)
    };
    let two = picture("integrator = 'distribution'", 1);
    assert!(picture("integrator = 'distribution'", 3) == two, "threads change nothing");
    assert!(
        picture("light_samples = 2\nglossy_samples = 2", 1) == two,
        "whitted with two of each is the same"
    );
    let one = picture("integrator = 'whitted'", 1);
    assert!(one != two, "numbers count");
    assert!(picture("integrator = 'distribution'\nsplit_depth = 0", 1) == one, "no hit is split");
    let ones = "integrator = 'distribution'\nlight_samples = 1\nglossy_samples = 1";
    assert!(picture(ones, 1) == one, "split into one");
}

#[test]
fn wrong_numbers_of_rays_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    let text = "[render]\nlight_samples = 0\nglossy_samples = 1.5\nsplit_depth = 65\n";
    std::fs::write(&path, text).expect("a scene");
    let error = scene::load(&path, &[]).expect_err("wrong").to_string();
    for (place, what) in [
        ("2:17", "`light_samples` is 0; it must be an integer from 1 to 65536"),
        ("3:18", "`glossy_samples` is 1.5, a float; it must be an integer from 1 to 65536"),
        ("4:15", "`split_depth` is 65; it must be an integer from 0 to 64"),
    ] {
        let line = format!("scene.toml:{place}: {what}");
        assert!(error.contains(&line), "{line} is not in\n{error}");
    }
}
