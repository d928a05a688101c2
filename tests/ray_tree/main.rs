//! The ray tree against answers known in closed form: deficits of a glass sphere in a white furnace by depth, the series of
//! an ideal slab, parallel mirrors, Beer's law, media that nest; these with paths, too.

#[path = "../support/scene.rs"]
mod support;

mod pruning;
mod tree;

use glam::Vec3;
use specula::film::{Aov, Layout};
use specula::geometry::Ray;
use specula::render::{Settings, Silent, render as render_scene};
use specula::scene::Scene;
use support::scene_of;
use tree::{BALL_IN_FURNACE, at_angle, fresnel, mirrors, trace, whitted};

#[test]
fn a_glass_sphere_in_a_furnace_lacks_what_depth_cuts() {
    let scene = scene_of(BALL_IN_FURNACE);
    // Angle, then the deficit at 2, 3, 4, 6, 8, 16 and 32 interfaces.
    let table = [
        (0.0, [0.0384, 1.54e-3, 6.1e-5, 9.8e-8, 1.6e-10, 0.0, 0.0]),
        (60.0, [0.08123, 7.24e-3, 6.5e-4, 5.1e-6, 4.1e-8, 0.0, 0.0]),
        (75.0, [0.18902, 0.04783, 0.01210, 7.8e-4, 5.0e-5, 8e-10, 0.0]),
        (85.0, [0.23728, 0.14540, 0.08910, 0.03346, 0.01257, 2.5e-4, 1e-7]),
        (89.0, [0.08664, 0.07833, 0.07083, 0.05791, 0.04734, 0.02115, 4.2e-3]),
    ];
    for (angle, deficits) in table {
        for (interfaces, printed) in [2, 3, 4, 6, 8, 16, 32].into_iter().zip(deficits) {
            // Path edges are one more than interfaces.
            let (found, counters) = trace(&scene, whitted(interfaces + 1, 0.0), at_angle(angle), 0);
            let deficit = 1.0 - f64::from(found.color.g);
            let r = fresnel(angle, 1.5);
            let exact = (1.0 - r) * r.powi(interfaces.cast_signed() - 1);
            assert!(
                (exact - printed).abs() < 0.02 * printed + 1e-7,
                "{angle} {interfaces}: table {printed} {exact}"
            );
            // Origins are moved off the surface by a millionth of the radius, which turns the ray inside by as much at
            // each interface.
            let drift = 1e-6 * f64::from(interfaces);
            let turned = |by: f64| {
                let r = fresnel((angle.to_radians().sin() + by).asin().to_degrees(), 1.5);
                (1.0 - r) * r.powi(interfaces.cast_signed() - 1)
            };
            let tolerance = 1e-6 + 2e-4 * exact + (turned(drift) - turned(-drift)).abs();
            assert!((deficit - exact).abs() < tolerance, "{angle} {interfaces}: {deficit} for {exact}");
            if exact > 1e-25 {
                let cuts = (counters.cut_by_depth, counters.cut_by_attenuation);
                assert_eq!(cuts, (2, 0), "both ways on from the last interface, and nothing is too faint");
            }
        }
    }
}

/// What is missing at that many interfaces where a face reflects `r`.
fn deficit(r: f64, interfaces: u32) -> f64 {
    (1.0 - r) * r.powi(interfaces.cast_signed() - 1)
}

#[test]
fn the_deficit_of_the_whole_disc_is_the_tables() {
    let scene = scene_of(BALL_IN_FURNACE);
    // Interfaces, the mean, and half of its last digit.
    for (interfaces, printed, digit) in [
        (2, 0.07268, 5e-6),
        (3, 0.01149, 5e-6),
        (4, 0.003_501, 5e-7),
        (6, 0.000_810, 5e-7),
        (8, 0.000_308, 5e-7),
        (16, 3.3e-5, 5e-7),
        (32, 3.9e-6, 5e-8),
    ] {
        // Rings of equal area.
        let mean = |steps: u32, of: &dyn Fn(f64) -> f64| {
            let ring = |i: u32| ((f64::from(i) + 0.5) / f64::from(steps)).sqrt().asin().to_degrees();
            (0..steps).map(|i| of(ring(i))).sum::<f64>() / f64::from(steps)
        };
        let exact = mean(1_000_000, &|angle| deficit(fresnel(angle, 1.5), interfaces));
        assert!((exact - printed).abs() < 1.02 * digit, "{interfaces} interfaces: table {printed} {exact}");
        let found = mean(4000, &|angle| {
            1.0 - f64::from(trace(&scene, whitted(interfaces + 1, 0.0), at_angle(angle), 0).0.color.g)
        });
        let tolerance = 0.01 * exact + 1e-6;
        assert!((found - exact).abs() < tolerance, "{interfaces} interfaces: {found} for {exact}");
    }
}

/// No depth is enough at the rim: where a face reflects 1 - 1/D of the light, D interfaces leave 1/(e D) of it inside.
#[test]
fn the_worst_angle_loses_what_the_table_says() {
    let scene = scene_of(BALL_IN_FURNACE);
    for (interfaces, printed) in [(4, 0.1055), (8, 0.0491), (16, 0.0237), (32, 0.0117)] {
        let most = 1.0 - 1.0 / f64::from(interfaces);
        assert!((deficit(most, interfaces) - printed).abs() < 5e-5, "{interfaces}: table {printed}");
        // At each interface the lift of origins off the surface turns rays a little away from the rim, where faces reflect less: the worst
        // angle moves, and the more interfaces there are, the less is left inside.
        let lost = |i: u16| {
            let angle = (1e-3_f64).powf(f64::from(i) / 3000.0).acos().to_degrees();
            1.0 - f64::from(trace(&scene, whitted(interfaces + 1, 0.0), at_angle(angle), 0).0.color.g)
        };
        let worst = (0..3000).map(lost).fold(0.0, f64::max);
        // By how much, as a part of what the sine of the worst angle lacks.
        let (mut low, mut high) = (60.0, 90.0);
        for _ in 0..50 {
            let middle = (low + high) / 2.0;
            if fresnel(middle, 1.5) < most { low = middle } else { high = middle }
        }
        let drift = 1e-6 * f64::from(interfaces) / (1.0 - low.to_radians().sin());
        println!("{interfaces} interfaces: at most {worst:.5} for {printed}, drift {drift:.4}");
        let bound = (0.25 * drift + 1e-3) * printed;
        assert!((worst - printed).abs() < bound, "{interfaces}: at most {worst} for {printed}");
    }
}

#[test]
fn attenuation_prunes_less_than_its_bound() {
    let scene = scene_of(BALL_IN_FURNACE);
    for angle in [0.0, 45.0, 60.0, 75.0, 85.0] {
        for eps in [1e-1, 1e-2, 1e-3, 1e-4] {
            let (found, counters) = trace(&scene, whitted(4000, eps), at_angle(angle), 0);
            let deficit = 1.0 - f64::from(found.color.g);
            // What is left inside when the last way out is cut, and the outer reflection if that is cut too.
            let r = fresnel(angle, 1.5);
            let bound = f64::from(eps) / (1.0 - r) + if r < f64::from(eps) { r } else { 0.0 };
            assert!(deficit < bound + 1e-6 && deficit > -1e-6, "{angle} {eps}: {deficit} exceeds {bound}");
            assert_eq!(counters.cut_by_depth, 0, "depth is no limit here");
            assert!(counters.cut_by_attenuation >= 1, "something was cut");
        }
    }
}

#[test]
fn a_slab_sums_its_series() {
    for (angle, printed) in [
        (0.0, 0.076_923_076_92),
        (45.0, 0.095_673_208_54),
        (60.0, 0.163_767_537_3),
        (75.0, 0.403_907_952_2),
        (85.0, 0.759_920_362_2),
    ] {
        let (reflected, transmitted) = slab_fractions(angle, 0.0);
        assert!((reflected - printed).abs() < 2e-5, "{angle}: {reflected} for {printed}");
        assert!((reflected + transmitted - 1.0).abs() < 1e-5, "{angle}: nothing is lost");
    }
    for (factor, reflects, transmits) in
        [(0.9, 0.069_898_588_570_8, 0.830_516_349_189), (0.5, 0.049_219_687_875_2, 0.460_984_393_758_f64)]
    {
        let (reflected, transmitted) = slab_fractions(0.0, -f64::ln(factor));
        assert!((reflected - reflects).abs() < 1e-6, "A = {factor}: {reflected} for {reflects}");
        assert!((transmitted - transmits).abs() < 1e-6, "A = {factor}: {transmitted} for {transmits}");
    }
}

/// What a slab of thickness 1 reflects and transmits; light that would leave at its sides is too faint to count.
fn slab_fractions(angle_deg: f64, absorption: f64) -> (f64, f64) {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let d = glam::DVec3::new(sin, -cos, 0.0).as_vec3();
    let lit_from = |height: &str| {
        format!(
            r#"
            [materials.glass]
            type = "dielectric"
            absorption = {absorption:?}
            [materials.light]
            type = "emission"
            radiance = 1.0
            [[shapes]]
            type = "box"
            min = [-500.0, -1.0, -500.0]
            max = [500.0, 0.0, 500.0]
            material = "glass"
            [[shapes]]
            type = "rectangle"
            center = [0.0, {height}, 0.0]
            edge_u = [1e6, 0.0, 0.0]
            edge_v = [0.0, 0.0, 1e6]
            material = "light"
            "#
        )
    };
    // A light above, facing down, shows what is reflected; one below, facing up, what is transmitted.
    let above = scene_of(&lit_from("100.0"));
    let below =
        scene_of(&lit_from("-100.0").replace("edge_v = [0.0, 0.0, 1e6]", "edge_v = [0.0, 0.0, -1e6]"));
    let ray = Ray::new(-d * 2.0, d);
    let seen = |scene: &Scene| f64::from(trace(scene, whitted(400, 1e-9), ray, 0).0.color.g);
    (seen(&above), seen(&below))
}

/// Two parallel mirrors that also shine, seen from between them straight on.
#[test]
fn parallel_mirrors_sum_a_geometric_series() {
    for (k, depth, lost) in [(0.8_f64, 5, 1.6384), (0.8, 10, 0.5369), (0.8, 20, 0.0576), (0.8, 50, 7.1e-5)] {
        let scene = scene_of(&mirrors(k));
        let ray = Ray::new(Vec3::new(0.01, 0.02, 0.0), Vec3::Z);
        let (found, counters) = trace(&scene, whitted(depth, 0.0), ray, 0);
        let deficit = 1.0 / (1.0 - k) - f64::from(found.color.g);
        let exact = k.powi(depth.cast_signed()) / (1.0 - k);
        assert!((exact - lost).abs() < 0.01 * lost, "table {lost} {exact}");
        assert!((deficit - exact).abs() < 2e-6 * 5.0, "{k} {depth}: {deficit} for {exact}");
        assert_eq!((counters.cut_by_depth, counters.cut_by_attenuation), (1, 0), "depth is the limit");
    }
}

#[test]
fn faint_reflections_end_where_their_share_does() {
    // The depth at which k^depth falls below one thousandth.
    for (k, depth) in [(0.8, 31), (0.9, 66), (0.99, 688)] {
        let scene = scene_of(&mirrors(k));
        let ray = Ray::new(Vec3::new(0.01, 0.02, 0.0), Vec3::Z);
        let (_, counters) = trace(&scene, whitted(4000, 1e-3), ray, 0);
        assert_eq!((counters.cut_by_depth, counters.cut_by_attenuation), (0, 1), "attenuation is the limit");
        assert_eq!(counters.reflected + 1, depth, "walls seen at reflectance {k}");
    }
}

const TOUCHING: &str = r#"
    [camera]
    from = [0.0, 0.0, 5.0]
    at = [0.0, 0.0, 0.0]
    [materials.glass]
    type = "dielectric"
    ior = 1.5
    priority = 2
    [materials.water]
    type = "dielectric"
    ior = 1.33
    absorption = [0.0, 0.5, 2.0]
    priority = 1
    [[shapes]]
    type = "box"
    min = [-9.0, -9.0, 0.0]
    max = [9.0, 9.0, 1.0]
    material = "glass"
    [[shapes]]
    type = "box"
    min = [-9.0, -9.0, -2.0]
    max = [9.0, 9.0, 0.25]
    material = "water"
    [[lights]]
    type = "environment"
    radiance = 1.0
"#;

/// What comes from air, glass, water of this absorption and thickness, and air, in white light from both sides: intensities of an incoherent
/// stack, by adding faces from the far side.
fn stack(sigma: f64, thickness: f64) -> f64 {
    let face = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
    let faces = [face(1.0, 1.5), face(1.5, 1.33), face(1.33, 1.0)];
    let a = (-sigma * thickness).exp();
    // What lies behind reflects `r` and transmits `t`; another face of reflectance f before it, and an absorber
    // between them that passes p, make a geometric series.
    let add = |f: f64, p: f64, (r, t): (f64, f64)| {
        let series = (1.0 - f) / (1.0 - f * p * p * r);
        (f + (1.0 - f) * p * p * r * series, p * t * series)
    };
    let last = (faces[2], 1.0 - faces[2]);
    let (r, t) = add(faces[0], 1.0, add(faces[1], a, last));
    r + t
}

#[test]
fn overlapping_media_show_the_faces_of_the_stronger_one() {
    let scene = scene_of(TOUCHING);
    let (found, counters) = trace(&scene, whitted(2000, 1e-9), Ray::new(Vec3::Z * 5.0, -Vec3::Z), 0);
    for (channel, sigma) in [(found.color.r, 0.0_f64), (found.color.g, 0.5), (found.color.b, 2.0)] {
        let exact = stack(sigma, 2.0);
        assert!((f64::from(channel) - exact).abs() < 2e-6, "{channel} for {exact}");
    }
    assert!(counters.hidden > 0, "the water's face within the glass is passed");
}

/// Light that goes straight through clear bodies to matt surfaces, straight on: intensity 1 at z = `light`, white walls at z = `wall`.
fn pool(bodies: &str, places: [f32; 2], sigma: f32) -> Scene {
    scene_of(&pool_text(bodies, places, sigma))
}

fn pool_text(bodies: &str, [wall, light]: [f32; 2], sigma: f32) -> String {
    format!(
        r#"
        [camera]
        from = [0.0, 0.0, 5.0]
        at = [0.0, 0.0, 0.0]
        [materials.glass]
        type = "dielectric"
        ior = 1.5
        priority = 2
        [materials.water]
        type = "dielectric"
        ior = 1.33
        absorption = {sigma:?}
        priority = 1
        [materials.white]
        type = "diffuse"
        reflectance = 1.0
        [[shapes]]
        type = "rectangle"
        center = [0.0, 0.0, {wall:?}]
        edge_u = [9.0, 0.0, 0.0]
        edge_v = [0.0, 9.0, 0.0]
        material = "white"
        [[lights]]
        type = "point"
        position = [0.0, 0.0, {light:?}]
        intensity = 1.0
        {bodies}
        "#
    )
}

fn body(material: &str, [low, high]: [f32; 2]) -> String {
    format!(
        "[[shapes]]\ntype = \"box\"\nmin = [-9.0, -9.0, {low:?}]\nmax = [9.0, 9.0, {high:?}]\nmaterial = \"{material}\"\n"
    )
}

#[test]
fn straight_light_is_absorbed_wherever_it_is_in_a_medium() {
    let sigma = 0.7_f32;
    let under_water = body("water", [-4.0, 0.0]);
    let with_slab = body("water", [-4.0, 0.0]) + &body("glass", [-2.0, -1.5]);
    let up = Ray::new(Vec3::Z * 0.5, Vec3::Z);
    let down = Ray::new(Vec3::Z * 5.0, -Vec3::Z);
    for (what, bodies, places, ray, length) in [
        ("from a light in the water", &under_water, [1.0, -2.0], up, 2.0),
        ("to the floor through a slab, and back", &with_slab, [-3.0, 1.0], down, 2.0 * 2.5),
    ] {
        let seen = |sigma| trace(&pool(bodies, places, sigma), whitted(8, 1e-9), ray, 0).0.color.g;
        let (clear, tinted) = (seen(0.0), seen(sigma));
        let expected = (-sigma * length).exp();
        assert!(clear > 1e-3, "{what}: {clear}");
        assert!((tinted / clear / expected - 1.0).abs() < 2e-3, "{what}: {} for {expected}", tinted / clear);
    }
}

/// No ray meets a light without a size, so that nothing else shows its highlight.
#[test]
fn highlights_of_points_are_seen_through_glass() {
    let metal = "type = \"conductor\"\n        metal = \"Ag\"\n        alpha = 0.3";
    let seen = |bodies: &str| {
        let text = pool_text(bodies, [-1.0, 3.0], 0.0);
        let scene = scene_of(&text.replace("type = \"diffuse\"\n        reflectance = 1.0", metal));
        trace(&scene, whitted(8, 1e-9), Ray::new(Vec3::Z * 5.0, -Vec3::Z), 0).0.color.g
    };
    let (clear, behind) = (seen(""), seen(&body("glass", [0.0, 1.0])));
    // There by two faces, and back by those and what goes to and fro between them.
    let (face, there_and_back) = (0.04_f32, behind / clear);
    let expected = (1.0 - face).powi(2) * (1.0 - face) / (1.0 + face);
    assert!(clear > 0.01 && (there_and_back / expected - 1.0).abs() < 0.01, "{clear}, {behind}: {expected}");
}

#[test]
fn straight_light_passes_hidden_faces_unseen() {
    let bodies = body("glass", [0.0, 1.0]) + &body("water", [-2.0, 0.25]);
    let scene = pool(&bodies, [2.0, -3.0], 0.0);
    let (found, _) = trace(&scene, whitted(8, 1e-9), Ray::new(Vec3::Z * 1.5, Vec3::Z), 0);
    let passed = |ior: f32| 1.0 - ((ior - 1.0) / (ior + 1.0)).powi(2);
    let expected = passed(1.33) * passed(1.5).powi(2) / (25.0 * std::f32::consts::PI);
    assert!((found.color.g / expected - 1.0).abs() < 1e-4, "{} for {expected}", found.color.g);
}

/// Paths choose one way on at each face. Whichever body is the stronger one where both are, the water is as thick as it is alone or all of it.
#[test]
fn paths_meet_the_faces_of_the_stronger_medium() {
    for query in ["single", "stream"] {
        for (priorities, thickness) in
            [(["priority = 2", "priority = 1"], 2.0), (["priority = 1", "priority = 2"], 2.25)]
        {
            let [glass, water] = priorities;
            let text = TOUCHING.replace("priority = 2", "GLASS").replace("priority = 1", "WATER");
            let text = text.replace("GLASS", glass).replace("WATER", water);
            // Straight on: at a hundredth of a degree reflectance differs by 1e-8.
            let text = text.replace("at = [0.0, 0.0, 0.0]", "at = [0.0, 0.0, 0.0]\n    vfov_deg = 0.01");
            let film = "    [film]\n    width = 16\n    height = 16\n    filter = \"box\"\n";
            let render = format!(
                "    [render]\n    integrator = \"path\"\n    query = \"{query}\"\n    sampler = \"independent\"\n    spp = 1024\n    max_depth = 64\n"
            );
            let settings = Settings { layout: Layout::with([Aov::Variance]), ..Settings::default() };
            let rendered = render_scene(&scene_of(&(film.to_owned() + &render + &text)), &settings, &Silent);
            let rendered = rendered.expect("a picture");
            let [mean, variance] =
                [Aov::Beauty, Aov::Variance].map(|aov| rendered.film.channels(aov).expect("kept"));
            for (channel, sigma) in [0.0, 0.5, 2.0].into_iter().enumerate() {
                let sum = |values: &[f32]| values.iter().map(|&x| f64::from(x)).sum::<f64>();
                let (found, deviation) =
                    (sum(&mean[channel]) / 256.0, sum(&variance[channel]).sqrt() / 256.0);
                let exact = stack(sigma, thickness);
                let name = format!("{query}, {priorities:?}, absorption {sigma}");
                println!(
                    "{name}: {found} for {exact}, {:.1} deviations",
                    (found - exact).abs() / deviation.max(1e-9)
                );
                // Of twelve numbers one is beyond four deviations once in 1300 cases; 2e-6 is what rounding leaves where nothing is absorbed.
                assert!(
                    (found - exact).abs() < 4.0 * deviation + 2e-6,
                    "{name}: {found} for {exact} +- {deviation}"
                );
                // The other order would be noticed.
                let other = stack(sigma, 4.25 - thickness);
                assert!(
                    sigma == 0.0 || (exact - other).abs() > 10.0 * deviation,
                    "{name}: {other} +- {deviation}"
                );
            }
            let counters = rendered.statistics.counters;
            assert!(counters.hidden > 0, "{query}, {priorities:?}: faces within the stronger one are passed");
        }
    }
}
