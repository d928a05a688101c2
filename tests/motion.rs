//! Motion blur against what is known of it: coverage ramps, sizes that stay, cameras that move the other way, moments outside
//! of the keys; and every wrong key with its message.

#[path = "support/scene.rs"]
mod support;

use glam::Vec3;
use specula::film::Aov;
use specula::geometry::{PlacementId, Pose};
use specula::image::Window;
use specula::render::{Settings, Silent, render};
use specula::scene::description::Backend;
use specula::scene::{self, Scene};
use std::fs;
use std::num::NonZeroUsize;
use support::scene_of;

/// The channels of a picture, each row by row.
fn picture(scene: &Scene, threads: usize, crop: Option<Window>) -> Vec<Vec<f32>> {
    let settings = Settings { threads: NonZeroUsize::new(threads), crop, ..Settings::default() };
    let rendered = render(scene, &settings, &Silent).expect("a picture");
    assert_eq!(rendered.film.non_finite().count(), 0, "samples that are not finite");
    let film = &rendered.film;
    let all = film.layout().aovs().iter().filter_map(|&aov: &Aov| film.channels(aov)).flatten();
    all.map(|values| values.iter().map(|value| value.to_owned()).collect()).collect()
}

/// The part of each pixel that shows a surface.
fn coverage(scene: &Scene) -> Vec<f64> {
    let channels = picture(scene, 2, None);
    channels[channels.len() - 1].iter().map(|&value| value.into()).collect()
}

const WIDTH: usize = 32;
const HEIGHT: usize = 8;

/// A plate whose right edge stands at the middle column at time 0. At a distance of 2 and with this angle of view a pixel is
/// 1/8 wide there.
fn plate(more_of_camera: &str, more_of_plate: &str, spp: u32, seed: u32) -> Scene {
    scene_of(&format!(
        r#"
        [camera]
        from = [0.0, 0.0, 2.0]
        at = [0.0, 0.0, 0.0]
        vfov_deg = 28.072486935852957
        {more_of_camera}
        [film]
        width = {WIDTH}
        height = {HEIGHT}
        filter = "box"
        [render]
        backend = "brute"
        spp = {spp}
        seed = {seed}
        [materials.gray]
        type = "diffuse"
        [[shapes]]
        type = "rectangle"
        center = [-8.0, 0.0, 0.0]
        edge_u = [8.0, 0.0, 0.0]
        edge_v = [0.0, 8.0, 0.0]
        material = "gray"
        {more_of_plate}
        "#
    ))
}

/// Keys of a translation along x.
fn slide(keys: &[(f64, f64)]) -> String {
    let keys: Vec<String> = keys
        .iter()
        .map(|(time, x)| {
            format!("{{ time_s = {time:?}, transform = [{{ translate = [{x:?}, 0.0, 0.0] }}] }}")
        })
        .collect();
    format!("keys = [{}]", keys.join(", "))
}

const OPEN: &str = "shutter_open_s = 0.0\nshutter_close_s = 1.0";

/// The coverage of column `x` by what lies left of an edge that goes from one column to another at constant speed.
fn ramp(x: usize, from: f64, to: f64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "few columns")]
    let left = x as f64;
    let steps = 20_000_u16;
    let at = |i: u16| from + (to - from) * (f64::from(i) + 0.5) / f64::from(steps);
    (0..steps).map(|i| (at(i) - left).clamp(0.0, 1.0)).sum::<f64>() / f64::from(steps)
}

/// Compares the columns of a picture with a ramp, each by the standard deviation of independent samples, which stratified ones
/// fall below.
fn check_ramp(mut scene: Scene, spp: u32, way: [f64; 2], name: &str) {
    for backend in Backend::ALL {
        scene.render.backend = *backend;
        check_coverage(&coverage(&scene), spp, way, &format!("{}, {name}", backend.word()));
    }
}

fn check_coverage(found: &[f64], spp: u32, [from, to]: [f64; 2], name: &str) {
    let mut between = 0;
    for x in 0..WIDTH {
        let mean = (0..HEIGHT).map(|y| found[y * WIDTH + x]).sum::<f64>() / HEIGHT as f64;
        let exact = ramp(x, from, to);
        let sigma = (exact * (1.0 - exact) / (f64::from(spp) * HEIGHT as f64)).sqrt();
        assert!(
            (mean - exact).abs() <= 4.0 * sigma + 1e-4,
            "{name}, column {x}: {mean} for {exact}, sigma {sigma}"
        );
        between += usize::from(mean > 0.0 && mean < 1.0);
    }
    // Whole columns from start to end of the way.
    let width = (from - to).abs();
    assert!((between as f64 - width).abs() <= 1.0, "{name}: {between} columns for a way of {width}");
}

#[test]
fn an_edge_that_moves_leaves_a_ramp() {
    let spp = 256;
    // A way of v columns is v / 8 long.
    for (v, name) in [(8.0, "to the right"), (-5.0, "to the left"), (0.5, "within a pixel")] {
        let keys = slide(&[(0.0, 0.0), (1.0, v / 8.0)]);
        check_ramp(plate(OPEN, &keys, spp, 1), spp, [16.0, 16.0 + v], name);
    }
    let keys = slide(&[(-1.0, -1.0), (3.0, 3.0)]);
    let late = plate("shutter_open_s = 0.5\nshutter_close_s = 1.25", &keys, spp, 1);
    check_ramp(late, spp, [20.0, 26.0], "three quarters of a second of four");
    let camera = format!(
        "{OPEN}\nkeys = [{{ time_s = 0.0 }}, {{ time_s = 1.0, from = [-1.0, 0.0, 2.0], at = [-1.0, 0.0, 0.0] }}]"
    );
    check_ramp(plate(&camera, "", spp, 1), spp, [16.0, 24.0], "a camera that moves to the left");
}

#[test]
fn moments_are_stratified() {
    // Of 64 samples in strata of one each, the edge of a stratum at most is taken wrongly in each of two strata.
    let keys = slide(&[(0.0, -2.0), (0.4999, -2.0), (0.5001, 2.0), (1.0, 2.0)]);
    let scene = plate(OPEN, &keys, 64, 3);
    for (i, coverage) in coverage(&scene).into_iter().enumerate() {
        assert!(
            (coverage - 0.5).abs() <= 1.0 / 64.0 + 1e-6,
            "pixel {i} is covered half of the time: {coverage}"
        );
    }
}

#[test]
fn what_stands_still_is_the_same_to_the_bit() {
    let still = picture(&plate("", "", 9, 2), 2, None);
    let same = |scene: &Scene, name: &str| {
        assert!(!scene.is_moving(), "{name}: moves");
        assert!(
            scene.world.placements.iter().all(|placement| placement.pose == Pose::World),
            "{name}: instanced"
        );
        assert!(picture(scene, 2, None) == still, "{name}: another picture");
    };
    same(&plate(OPEN, "", 9, 2), "nothing moves");
    same(&plate(OPEN, &slide(&[(0.0, 0.0), (1.0, 0.0)]), 9, 2), "keys in one place");
    same(&plate(OPEN, &slide(&[(1.0, 0.0), (2.0, 5.0)]), 9, 2), "the shutter closes before the first key");
    same(&plate(OPEN, &slide(&[(-2.0, 5.0), (0.0, 0.0)]), 9, 2), "and opens after the last");
    same(&plate("", &slide(&[(-1.0, -3.0), (1.0, 3.0)]), 9, 2), "one moment");
    // A camera with keys goes by way of a quaternion, which rounds.
    let keys = "keys = [{ time_s = 0.0 }, { time_s = 1.0 }]";
    let camera = plate(&format!("{OPEN}\n{keys}"), "", 9, 2);
    assert!(!camera.is_moving(), "a camera whose keys are alike");
    let difference = worst(&picture(&camera, 2, None), &still);
    assert!(difference <= 1.0 / 9.0 + 1e-6, "one sample of a pixel at most: {difference}");
}

fn worst(a: &[Vec<f32>], b: &[Vec<f32>]) -> f32 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// A few things that move in all ways, under a sky that is the same from everywhere.
const BUSY: &str = r#"
    [camera]
    from = [0.0, 1.0, 4.0]
    at = [0.0, 0.3, 0.0]
    CAMERA
    shutter_open_s = 1.0
    shutter_close_s = 1.5
    [film]
    width = 43
    height = 30
    [render]
    backend = "brute"
    spp = 5
    [materials.gray]
    type = "diffuse"
    reflectance = [0.7, 0.5, 0.2]
    [materials.metal]
    type = "conductor"
    metal = "Cu"
    alpha = 0.3
    [[shapes]]
    name = "spun"
    type = "box"
    min = [-0.5, -0.1, -0.1]
    max = [0.5, 0.1, 0.1]
    material = "gray"
    transform = [{ rotate_deg = 90.0, axis = [0.0, 0.0, 1.0] }]
    keys = [
        { time_s = 1.0, transform = [{ rotate_deg = 0.0, axis = [0.0, 0.0, 1.0] }] },
        { time_s = 2.0, transform = [{ rotate_deg = 720.0, axis = [0.0, 0.0, 1.0] }] },
    ]
    [[shapes]]
    type = "instance"
    of = "spun"
    material = "metal"
    transform = [{ scale = 0.5 }, { translate = [1.0, 0.0, 0.0] }]
    keys = [
        { time_s = 0.0, transform = [{ translate = [0.0, -2.0, 0.0] }] },
        { time_s = 2.0, transform = [{ translate = [0.0, 2.0, 0.0] }] },
    ]
    [[shapes]]
    type = "sphere"
    center = [-1.0, 0.2, 0.3]
    radius = 0.4
    material = "metal"
    SPHERE
    [[lights]]
    type = "environment"
    radiance = [1.0, 0.9, 0.8]
    [[lights]]
    type = "rectangle"
    center = [0.0, 3.0, 1.0]
    edge_u = [0.5, 0.0, 0.0]
    edge_v = [0.0, 0.0, 0.5]
    radiance = 5.0
"#;

fn busy(camera: &str, sphere: &str) -> Scene {
    scene_of(&BUSY.replace("CAMERA", camera).replace("SPHERE", sphere))
}

#[test]
fn threads_and_crops_do_not_change_a_bit() {
    let camera = "keys = [{ time_s = 1.0 }, { time_s = 1.25, at = [0.3, 0.3, 0.0] }, { time_s = 2.0, vfov_deg = 40.0 }]";
    let scene = busy(camera, "");
    assert!(scene.is_moving() && scene.camera.is_moving(), "everything moves");
    let whole = picture(&scene, 1, None);
    assert!(picture(&scene, 3, None) == whole, "three threads");
    let window = Window { x0: 11, y0: 5, x1: 30, y1: 22 };
    let part = picture(&scene, 2, Some(window));
    for (part, whole) in part.iter().zip(&whole) {
        for (row, values) in part.chunks_exact(19).enumerate() {
            let start = (5 + row) * 43 + 11;
            assert!(values == &whole[start..start + 19], "row {row} of a crop");
        }
    }
}

/// Backends differ in rounding, which moves a sample in a few hundred over an edge.
#[test]
fn backends_see_the_same_motion() {
    let camera = "keys = [{ time_s = 1.0 }, { time_s = 2.0, from = [1.0, 1.0, 4.0] }]";
    let sphere = "keys = [{ time_s = 1.0 }, { time_s = 1.5, transform = [{ scale = [1.0, 2.0, 1.0] }] }]";
    let mut scene = busy(camera, sphere);
    let brute = picture(&scene, 2, None);
    for backend in Backend::ALL {
        scene.render.backend = *backend;
        let other = picture(&scene, 2, None);
        let pairs = || brute.iter().flatten().zip(other.iter().flatten());
        let apart = pairs().filter(|(a, b)| (*a - *b).abs() > 1e-3 * (1.0 + a.abs())).count();
        let part = apart as f64 / pairs().count() as f64;
        println!("{}: {:.2} % of values differ", backend.word(), part * 100.0);
        assert!(part < 0.02, "{}: {apart} values differ", backend.word());
    }
}

#[test]
fn a_turning_shape_keeps_its_size_and_instances_follow() {
    let scene = busy("", "");
    let size = Vec3::new(1.0, 0.2, 0.2).length();
    let pose = |index: u32| &scene.world.placements[PlacementId(index).index()].pose;
    let at = |pose: &Pose, time: f32, p: Vec3| pose.at(time).expect("a map").point(p);
    let moving: Vec<&Pose> = (0..u32::try_from(scene.world.placements.len()).expect("few"))
        .map(pose)
        .filter(|pose| matches!(pose, Pose::Moving(_)))
        .collect();
    let [own, instance] = moving[..] else { panic!("{} poses move", moving.len()) };
    let p = Vec3::new(0.5, 0.1, -0.1);
    for i in 0..=1000_u16 {
        let time = f32::from(i) / 1000.0;
        // From 1 to 1.5 seconds: one of two turns, after a quarter of one; the instance rises by one metre from zero.
        let (sin, cos) = (std::f32::consts::TAU * (time + 0.25)).sin_cos();
        let turned = Vec3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z);
        let found = at(own, time, p);
        assert!(found.distance(turned) < 1e-3 * size + 1e-6, "{time}: {found} for {turned}");
        let found = at(instance, time, p);
        let exact = turned * 0.5 + Vec3::new(1.0, time, 0.0);
        assert!(found.distance(exact) < 1e-3 * size * 0.5 + 1e-6, "{time}: {found} for {exact}");
    }
}

/// Everything but the camera moves, or the camera alone the other way: the pictures are the same but for rounding, which moves
/// a few samples over edges. The noise of independent seeds is what a wrong picture would exceed and this one stays far below.
#[test]
fn a_camera_that_moves_is_a_world_that_moves_the_other_way() {
    let text = |camera: &str, shape: &str, seed: u32| {
        scene_of(&format!(
            r#"
            [camera]
            from = [0.0, 0.6, 3.0]
            at = [0.0, 0.0, 0.0]
            shutter_close_s = 0.5
            {camera}
            [film]
            width = 48
            height = 32
            [render]
            backend = "brute"
            spp = 64
            seed = {seed}
            [materials.gray]
            type = "diffuse"
            [[shapes]]
            type = "box"
            min = [-0.5, -0.5, -0.5]
            max = [0.5, 0.5, 0.5]
            material = "gray"
            transform = [{{ rotate_deg = 30.0, axis = [0.0, 1.0, 0.0] }}]
            {shape}
            [[lights]]
            type = "environment"
            radiance = [1.0, 0.5, 0.25]
            "#
        ))
    };
    let camera =
        "keys = [{ time_s = 0.0 }, { time_s = 0.5, from = [0.75, 0.35, 2.5], at = [0.75, -0.25, -0.5] }]";
    let shape =
        "keys = [{ time_s = 0.0 }, { time_s = 0.5, transform = [{ translate = [-0.75, 0.25, 0.5] }] }]";
    let [a, b, other] =
        [text(camera, "", 1), text("", shape, 1), text("", shape, 2)].map(|scene| picture(&scene, 2, None));
    let rmse = |a: &[Vec<f32>], b: &[Vec<f32>]| {
        let squares: Vec<f64> =
            a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| f64::from(a - b).powi(2)).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let (difference, noise) = (rmse(&a, &b), rmse(&b, &other) / 2.0_f64.sqrt());
    println!("difference {difference:.2e}, noise {noise:.2e}");
    assert!(noise > 0.0 && difference < 0.2 * noise, "difference {difference}, noise {noise}");
    let still = picture(&text("", "", 1), 2, None);
    assert!(rmse(&a, &still) > 10.0 * noise, "the motion shows");
}

/// A plate that turns from facing the viewer by [`TURN_DEG`], about an axis that its middle stays on, seen there.
fn turning_plate(render: &str, material: &str, lights: &str) -> [f64; 3] {
    let scene = scene_of(&format!(
        r#"
        [camera]
        from = [0.0, 0.0, 5.0]
        at = [0.0, 0.0, 0.0]
        vfov_deg = 0.02
        shutter_close_s = 1.0
        [film]
        width = 4
        height = 4
        filter = "box"
        [render]
        {render}
        spp = 1024
        max_depth = 3
        [materials.plate]
        {material}
        [[shapes]]
        type = "rectangle"
        edge_u = [1.0, 0.0, 0.0]
        edge_v = [0.0, 1.0, 0.0]
        material = "plate"
        keys = [
            {{ time_s = 0.0 }},
            {{ time_s = 1.0, transform = [{{ rotate_deg = {TURN_DEG:?}, axis = [0.0, 1.0, 0.0] }}] }},
        ]
        {lights}
        "#
    ));
    let channels = picture(&scene, 2, None);
    [0, 1, 2].map(|k| channels[k].iter().map(|&value| f64::from(value)).sum::<f64>() / 16.0)
}

const TURN_DEG: f64 = 40.0;

const WAYS: [&str; 4] = [
    "integrator = 'whitted'",
    "integrator = 'whitted'\nbackend = 'cwbvh'",
    "integrator = 'path'",
    "integrator = 'path'\nquery = 'single'",
];

/// The mirrored ray sweeps twice the angle, at constant speed: each lamp is seen for the part of the time that it fills of that.
#[test]
fn a_spinning_mirror_shows_each_lamp_for_its_share_of_the_angle() {
    let lamps = [
        ([10.0_f64, 30.0], "[1.0, 0.0, 0.0]"),
        ([30.0, 50.0], "[0.0, 2.0, 0.0]"),
        ([50.0, 75.0], "[0.0, 0.0, 3.0]"),
    ];
    let lights: String = lamps
        .iter()
        .map(|([from, to], radiance)| {
            let (sin, cos) = ((from + to) / 2.0).to_radians().sin_cos();
            let half = 3.0 * ((to - from) / 2.0).to_radians().tan();
            format!(
                "[[lights]]\ntype = 'rectangle'\ncenter = [{:?}, 0.0, {:?}]\nedge_u = [{:?}, 0.0, {:?}]\n\
                 edge_v = [0.0, -1.0, 0.0]\nradiance = {radiance}\n",
                3.0 * sin,
                3.0 * cos,
                half * cos,
                -half * sin
            )
        })
        .collect();
    for render in WAYS {
        let found = turning_plate(render, "type = 'mirror'\nreflectance = 0.5", &lights);
        for (found, (([from, to], _), radiance)) in found.into_iter().zip(lamps.iter().zip([1.0, 2.0, 3.0])) {
            let exact = 0.5 * radiance * (to - from) / (2.0 * TURN_DEG);
            assert!((found - exact).abs() < 2e-3 * radiance, "{render}, {from} to {to}: {found} for {exact}");
        }
    }
}

/// A matt plate in parallel light from the viewer's side: the mean of the cosine.
#[test]
fn a_spinning_plate_is_lit_by_the_mean_of_its_cosine() {
    let sun = "[[lights]]\ntype = 'directional'\ndirection = [0.0, 0.0, -1.0]\nirradiance = 3.0";
    let turn = TURN_DEG.to_radians();
    let exact = 0.6 / std::f64::consts::PI * 3.0 * turn.sin() / turn;
    for render in WAYS {
        let found = turning_plate(render, "type = 'diffuse'\nreflectance = 0.6", sun);
        for value in found {
            assert!((value / exact - 1.0).abs() < 3e-4, "{render}: {value} for {exact}");
        }
    }
}

/// A glass box that the camera leaves while the shutter is open is around it for that part of the time only.
#[test]
fn media_around_the_camera_change_on_its_way() {
    let scene = |from: f64, to: f64| {
        scene_of(&format!(
            r#"
            [camera]
            from = [0.0, 0.0, {from:?}]
            at = [0.0, 0.0, -10.0]
            vfov_deg = 1.0
            shutter_close_s = 1.0
            keys = [{{ time_s = 0.0 }}, {{ time_s = 1.0, from = [0.0, 0.0, {to:?}] }}]
            [film]
            width = 4
            height = 4
            filter = "box"
            [render]
            backend = "brute"
            spp = 256
            [materials.ink]
            type = "dielectric"
            ior = 1.0
            absorption = 100.0
            [[shapes]]
            type = "box"
            min = [-1.0, -1.0, 1.0]
            max = [1.0, 1.0, 3.0]
            material = "ink"
            [[lights]]
            type = "environment"
            radiance = 1.0
            "#
        ))
    };
    for (from, to, free, name) in [
        (2.0, -2.0, 0.75, "out of the ink"),
        (-2.0, 2.0, 0.75, "into the ink"),
        (1.5, 2.5, 0.0, "within"),
        (0.5, -0.5, 1.0, "beyond"),
    ] {
        let channels = picture(&scene(from, to), 2, None);
        let mean = channels[0].iter().map(|&value| f64::from(value)).sum::<f64>() / 16.0;
        // Within a hundredth of a metre of its face some light gets through.
        assert!((mean - free).abs() < 0.01, "{name}: {mean} for {free}");
    }
}

fn problems(text: &str) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    fs::write(&path, text).expect("a scene");
    let told = |shown: String| {
        shown
            .lines()
            .map(|line| line.replace(&format!("{}/", folder.path().display()), ""))
            .collect::<Vec<_>>()
    };
    match scene::load(&path, &[]) {
        Err(error) => told(error.to_string()),
        Ok(loaded) => match scene::build(&loaded.description) {
            Err(error) => told(error.to_string()),
            Ok(built) => {
                built.warnings.iter().flat_map(|warning| told(format!("warning: {warning}"))).collect()
            }
        },
    }
}

const SPHERE: &str = "[materials.m]\ntype = 'mirror'\n[[shapes]]\ntype = 'sphere'\nmaterial = 'm'\n";

#[test]
fn wrong_keys_of_a_camera_are_told() {
    let camera = "[camera]\nfrom = [0, 0, 5]\nat = [0, 0, 0]\n";
    for (keys, wanted) in [
        (
            "shutter_open_s = 2\nshutter_close_s = 1.5",
            &[
                "scene.toml:5:19: `shutter_close_s` is 1.5, before the shutter opens at 2; give a later moment, or the same one for a picture of one moment",
            ][..],
        ),
        (
            "keys = [{ time_s = 1 }]",
            &["scene.toml:4:8: `keys` has one entry only; give two or more; what stands still needs none"],
        ),
        (
            "keys = [{ time_s = 1 }, { time_s = 1, vfov_deg = 180 }]",
            &["scene.toml:4:50: `vfov_deg` is 180; it must be a number above 0 and below 180 degrees"],
        ),
        (
            "keys = [{ time_s = 1 }, { time_s = inf }, { tim_s = 3 }]",
            &[
                "scene.toml:4:36: `time_s` is inf; it must be a number in s",
                "scene.toml:4:43: missing key `time_s`; give a number in s",
                "scene.toml:4:45: unknown key `tim_s`; did you mean `time_s`?",
            ],
        ),
        (
            "keys = [{ time_s = 1 },\n{ time_s = 1, from = [0, 0, 0] },\n{ time_s = 0.5, up = [0, 0, 1] },\n{ time_s = 2, from = [0, 0, -5] },\n{ time_s = 3 }]",
            &[
                "scene.toml:5:1: `at` is where the camera stands; give another point to look at",
                "scene.toml:5:12: `time_s` is 1, not after 1 of the key before; put the keys in the order of time",
                "scene.toml:6:12: `time_s` is 0.5, not after 1 of the key before; put the keys in the order of time",
                "scene.toml:6:22: `up` points along the view; give another direction",
                "scene.toml:8:1: the camera is turned by half a turn from the key before, and which way round is not said; add a key in between",
            ],
        ),
    ] {
        assert_eq!(problems(&format!("{camera}{keys}\n{SPHERE}")), wanted, "{keys}");
    }
}

#[test]
fn wrong_keys_of_a_shape_are_told() {
    for (keys, wanted) in [
        (
            "keys = [{ time_s = 1 }]",
            &["scene.toml:6:8: `keys` has one entry only; give two or more; what stands still needs none"][..],
        ),
        (
            "keys = { time_s = 1 }",
            &["scene.toml:6:8: `keys` is a table; it must be an array, each entry a table"],
        ),
        (
            "keys = [{ time_s = 2 }, { time_s = 1, transform = [{ fit = 1 }] }]",
            &[
                "scene.toml:6:36: `time_s` is 1, not after 2 of the key before; put the keys in the order of time",
                "scene.toml:6:51: `fit` cannot be in a key; put it into the shape's own `transform`, which comes before the keys",
            ],
        ),
        (
            "keys = [{ time_s = 0, transform = [{ scale = 0 }] }, { time_s = 1, transform = [{ scale = [1, -1, 1] }] },\n\
             { time_s = 2, transform = [{ scale = 1 }] },\n\
             { time_s = 3, transform = [{ scale = -1 }, { translate = [1, 0, 0] }] },\n\
             { time_s = 4, transform = [{ translate = [1, 0, 0] }, { matrix = [0,-1,0,0, -1,0,0,0, 0,0,1,0, 0,0,0,1] }] },\n\
             { time_s = 5, transform = [{ translate = [1, 0, 0] }, { matrix = [0,1,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1] }] }]",
            &[
                "scene.toml:6:46: `scale` is zero; give factors other than zero",
                "scene.toml:7:27: a factor of `scale` has another sign than at the key before, and the shape would be flat in between; give both the same sign; mirror by the shape's own `transform`",
                "scene.toml:8:27: this key and the one before mirror the shape differently, and it would be flat in between; mirror by the shape's own `transform`",
                "scene.toml:9:27: this key is half a turn from the one before, and which way round is not said; add a key in between, or turn both by `rotate_deg` about the same axis",
                "scene.toml:10:27: this key is half a turn from the one before, and which way round is not said; add a key in between, or turn both by `rotate_deg` about the same axis",
            ],
        ),
    ] {
        assert_eq!(problems(&format!("{SPHERE}{keys}\n")), wanted, "{keys}");
    }
}

#[test]
fn what_only_building_finds_is_told() {
    let open = "[camera]\nshutter_close_s = 1\n";
    let turns = |degrees: &str| {
        format!(
            "keys = [{{ time_s = 0 }}, {{ time_s = 1, transform = [{{ rotate_deg = {degrees}, axis = [0, 1, 0] }}] }}]\n"
        )
    };
    let found = problems(&format!("{open}{SPHERE}{}", turns("360000")));
    let wanted = "scene.toml:5:1: the shape turns too fast, or is flattened, while the shutter is open; close the shutter sooner, or spread the keys over more time";
    assert_eq!(found, [wanted], "a thousand turns");
    let found = problems(&format!("{open}{SPHERE}{}", turns("3600")));
    let start =
        "warning: scene.toml:5:1: the shape moves so much while the shutter is open that it is off by up to ";
    assert!(found.len() == 1 && found[0].starts_with(start), "ten turns: {found:?}");
    let lamp = SPHERE.replace("'mirror'", "'emission'\nradiance = 1");
    let found = problems(&format!("{open}{lamp}{}", turns("90")));
    let wanted = "scene.toml:6:1: a shape that emits light moves while the shutter is open; let it stand still, close the shutter, or take its emission away and light it by a light";
    assert_eq!(found, [wanted], "a moving lamp");
    assert_eq!(problems(&format!("{lamp}{}", turns("90"))), [""; 0], "a lamp at one moment");
}
