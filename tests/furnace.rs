//! White furnaces: in light of radiance 1 from everywhere a surface shows its directional albedo, 1 where nothing is lost.
//!
//! By all integrators, engines and samplers, in three kinds of light: the same all around, which is never asked; a white picture of
//! the sky, which is asked; and a glowing box, whose sides are asked for points. What lobes lose is known by integrating their
//! values over the hemisphere, without drawing any direction.

#[path = "support/scene.rs"]
mod scene;
#[path = "support/shots.rs"]
mod shots;
#[path = "support/statistics.rs"]
mod statistics;

use scene::scene_of;
use shots::Shot;
use specula::geometry::PlacementId;
use specula::image::{Window, exr};
use specula::math::Vec3;
use specula::scene::Scene;
use std::f64::consts::TAU;
use std::path::Path;

/// A plate of a material.
struct Plate {
    name: &'static str,
    /// Tables of materials; the plate is made of `m`.
    materials: &'static str,
    /// Whether it sends back all light that falls on it.
    keeps: bool,
}

const PLATES: [Plate; 18] = [
    Plate { name: "diffuse", materials: "[materials.m]\ntype = \"diffuse\"\nreflectance = 1.0", keeps: true },
    Plate {
        name: "oren_nayar",
        materials: "[materials.m]\ntype = \"oren_nayar\"\nreflectance = 1.0\nroughness = 0.7",
        keeps: true,
    },
    Plate { name: "mirror", materials: "[materials.m]\ntype = \"mirror\"", keeps: true },
    Plate { name: "gold", materials: "[materials.m]\ntype = \"conductor\"\nmetal = \"Au\"", keeps: false },
    Plate {
        name: "white metal, ggx",
        materials: "[materials.m]\ntype = \"conductor\"\nreflectance = 1.0\nalpha = 0.5",
        keeps: false,
    },
    Plate {
        name: "white metal, beckmann",
        materials: "[materials.m]\ntype = \"conductor\"\nreflectance = 1.0\nalpha = 0.3\ndistribution = \"beckmann\"",
        keeps: false,
    },
    Plate {
        name: "rough copper",
        materials: "[materials.m]\ntype = \"conductor\"\nmetal = \"Cu\"\nalpha = 0.3",
        keeps: false,
    },
    Plate {
        name: "thin glass",
        materials: "[materials.m]\ntype = \"thin_dielectric\"\nior = 1.5",
        keeps: true,
    },
    Plate {
        name: "glossy, through_r",
        materials: "[materials.m]\ntype = \"glossy\"\nexponent = 8\nreflectance = 0.7\ndiffuse = 0.3",
        keeps: true,
    },
    Plate {
        name: "glossy, rejection",
        materials: "[materials.m]\ntype = \"glossy\"\nexponent = 8\nreflectance = 0.7\ndiffuse = 0.3\nbelow = \"rejection\"",
        keeps: true,
    },
    Plate {
        name: "glossy, discard",
        materials: "[materials.m]\ntype = \"glossy\"\nexponent = 8\nreflectance = 0.7\ndiffuse = 0.3\nbelow = \"discard\"",
        keeps: false,
    },
    Plate {
        name: "phong, modified",
        materials: "[materials.m]\ntype = \"phong\"\nexponent = 8\nreflectance = 0.7\ndiffuse = 0.3\nscale = \"modified\"",
        keeps: false,
    },
    Plate {
        name: "phong, max_cosine",
        materials: "[materials.m]\ntype = \"phong\"\nexponent = 8\nreflectance = 0.7\ndiffuse = 0.3",
        keeps: false,
    },
    Plate {
        name: "jitter",
        materials: "[materials.m]\ntype = \"jitter\"\nexponent = 40\nreflectance = 0.7\ndiffuse = 0.3",
        keeps: false,
    },
    Plate {
        name: "glazed, white",
        materials: "[materials.m]\ntype = \"glazed\"\nreflectance = 1.0",
        keeps: true,
    },
    Plate {
        name: "glazed, gray",
        materials: "[materials.m]\ntype = \"glazed\"\nreflectance = 0.5",
        keeps: false,
    },
    Plate {
        name: "schlick",
        materials: "[materials.m]\ntype = \"schlick\"\ncolor = 0.8\nroughness = 0.6",
        keeps: false,
    },
    Plate {
        name: "mix",
        materials: "[materials.a]\ntype = \"diffuse\"\nreflectance = 1.0\n[materials.b]\ntype = \"conductor\"\nreflectance = 1.0\n\
                    alpha = 0.4\n[materials.m]\ntype = \"mix\"\nparts = [{ material = \"a\", weight = 0.3 }, \
                    { material = \"b\", weight = 0.7 }]",
        keeps: false,
    },
];

/// Kinds of light of radiance 1 from everywhere.
fn lights(folder: &Path) -> [(&'static str, String); 3] {
    let sky = folder.join("white.exr");
    let channel =
        |name: &str| exr::Channel { name: name.to_owned(), samples: exr::Samples::Float(vec![1.0; 32]) };
    let (full, window) = ([8, 4], Window::whole(8, 4));
    let channels = ["R", "G", "B"].map(channel).into();
    let white = exr::Picture { full, window, channels, attributes: Vec::new(), warnings: Vec::new() };
    exr::write(&sky, white).expect("written");
    [
        ("all around", "[[lights]]\ntype = \"environment\"\nradiance = 1.0\n".to_owned()),
        ("a picture", format!("[[lights]]\ntype = \"environment\"\nfile = {sky:?}\n")),
        (
            "a box",
            "[materials.glow]\ntype = \"emission\"\nradiance = 1.0\ntwo_sided = true\n[[shapes]]\ntype = \"box\"\n\
             min = [-6.0, -5.0, -6.0]\nmax = [6.0, 7.0, 6.0]\nmaterial = \"glow\"\n"
                .to_owned(),
        ),
    ]
}

/// Engines and samplers, and all integrators with them.
fn ways() -> Vec<[&'static str; 3]> {
    let mut ways = Vec::new();
    for integrator in ["path", "whitted", "distribution"] {
        for query in ["single", "packet", "stream"] {
            ways.push([integrator, query, "independent"]);
        }
        for sampler in ["stratified", "sobol", "blue_noise"] {
            ways.push([integrator, "stream", sampler]);
        }
    }
    ways
}

/// A plate at the origin, seen from 4 m away at an angle to its normal, so narrowly that the angle is the same all over.
fn seen(
    angle: f64,
    materials: &str,
    light: &str,
    [integrator, query, sampler]: [&str; 3],
    spp: u32,
) -> Scene {
    let (sin, cos) = angle.to_radians().sin_cos();
    scene_of(&format!(
        r#"
        [camera]
        from = [{:?}, {:?}, 0.0]
        at = [0.0, 0.0, 0.0]
        up = [0.0, 0.0, 1.0]
        vfov_deg = 0.01
        [film]
        width = 8
        height = 8
        filter = "box"
        [render]
        integrator = "{integrator}"
        query = "{query}"
        sampler = "{sampler}"
        spp = {spp}
        max_depth = 2
        min_throughput = 0.0
        [[shapes]]
        type = "rectangle"
        edge_u = [0.0, 0.0, 0.5]
        edge_v = [0.5, 0.0, 0.0]
        material = "m"
        {light}
        {materials}
        "#,
        4.0 * sin,
        4.0 * cos
    ))
}

/// What the plate sends towards a viewer of light of radiance 1 from everywhere: branches as they are, lobes integrated with
/// midpoints in the cosine, for some values grow as its inverse, and the azimuth.
fn albedo(scene: &Scene, angle: f64) -> f64 {
    const STEPS: u32 = 1200;
    let id = scene.only_material_of(PlacementId(0)).expect("the plate comes first");
    let mix = scene.materials[id.index()].bsdf([0.5_f32; 2], 1.0).expect("not black");
    #[expect(clippy::cast_possible_truncation, reason = "a direction")]
    let wo = Vec3::new(angle.to_radians().sin() as f32, 0.0, angle.to_radians().cos() as f32);
    let mut sum = 0.0;
    for part in mix.parts() {
        for branch in part.bsdf.branches(wo).into_iter().flatten().filter(|branch| branch.valid) {
            sum += f64::from(part.weight.g * branch.weight.g);
        }
    }
    let steps = f64::from(STEPS);
    let mut lobes = 0.0;
    for i in 0..STEPS {
        let (cos, half) = ((f64::from(i) + 0.5) / steps, STEPS / 2);
        let sin = (1.0 - cos * cos).sqrt();
        // The two halves are alike.
        for j in 0..half {
            let (y, x) = (TAU / 2.0 * (f64::from(j) + 0.5) / f64::from(half)).sin_cos();
            #[expect(clippy::cast_possible_truncation, reason = "a direction")]
            let wi = Vec3::new((sin * x) as f32, (sin * y) as f32, cos as f32);
            for part in mix.parts() {
                let value = part.bsdf.eval_diffuse(wo, wi) + part.bsdf.eval_glossy(wo, wi);
                lobes += f64::from(part.weight.g * value.g) * cos;
            }
        }
    }
    sum + lobes / (steps * f64::from(STEPS / 2)) * TAU
}

#[test]
fn plates_show_their_albedo() {
    const SPP: u32 = 64;
    let folder = tempfile::tempdir().expect("a folder");
    let mut failed = Vec::new();
    let mut worst = 0.0_f64;
    for Plate { name, materials, keeps } in &PLATES {
        for angle in [20.0, 70.0] {
            let mut expected = None;
            for (light, text) in lights(folder.path()) {
                for way in ways() {
                    let scene = seen(angle, materials, &text, way, SPP);
                    let expected = *expected.get_or_insert_with(|| albedo(&scene, angle));
                    let [found, error] = Shot::of(&scene).mean_of(1);
                    // Integrals by midpoints are exact to 1e-4 for these lobes.
                    let deviations = (found - expected).abs() / error.hypot(1e-4);
                    worst = worst.max(deviations);
                    // 1944 numbers: beyond 5 once in 900 runs.
                    if deviations > 5.0 {
                        failed.push(format!(
                            "{name} at {angle} in {light}, {way:?}: {found} +- {error}, not {expected}"
                        ));
                    }
                }
            }
            let expected = expected.expect("computed");
            println!("{name} at {angle} degrees: {expected:.5}");
            assert!(expected < 1.0 + 2e-4, "{name} at {angle} makes light: {expected}");
            // What lobes lose straight on may be too little to tell.
            assert!(!keeps || expected > 1.0 - 2e-4, "{name} at {angle} loses light: {expected}");
            assert!(*keeps || angle < 45.0 || expected < 1.0 - 2e-3, "{name} at {angle}: {expected}");
        }
    }
    println!("the worst is {worst:.2} deviations off");
    assert!(failed.is_empty(), "{} fail: {failed:#?}", failed.len());
}

/// A clear ball: what enters it comes out again.
fn ball(
    material: &str,
    light: &str,
    [integrator, query, sampler]: [&str; 3],
    (spp, seed): (u32, u32),
) -> Scene {
    scene_of(&format!(
        r#"
        [camera]
        from = [0.0, 0.0, 4.0]
        at = [0.0, 0.0, 0.0]
        vfov_deg = 12.0
        [film]
        width = 8
        height = 8
        filter = "box"
        [render]
        integrator = "{integrator}"
        query = "{query}"
        sampler = "{sampler}"
        spp = {spp}
        seed = {seed}
        max_depth = 64
        min_throughput = 1e-4
        [materials.m]
        {material}
        [[shapes]]
        type = "sphere"
        radius = 0.5
        material = "m"
        {light}
        "#
    ))
}

#[test]
fn polished_glass_is_not_seen() {
    let folder = tempfile::tempdir().expect("a folder");
    for material in ["type = \"dielectric\"\nior = 1.5", "type = \"thin_dielectric\"\nior = 1.5"] {
        for (light, text) in lights(folder.path()) {
            for way in ways() {
                let [found, error] = Shot::of(&ball(material, &text, way, (64, 1))).mean_of(1);
                // Trees leave out branches that carry less than 1e-4: at most a few hundred of them.
                let cut = if way[0] == "path" { 0.0 } else { 2e-3 };
                assert!(
                    (found - 1.0).abs() < 5.0 * error + cut + 1e-4,
                    "{material}, {light}, {way:?}: {found} +- {error}"
                );
            }
        }
    }
}

/// Nobody knows the number, but it is the same for all.
#[test]
fn frosted_glass_loses_the_same_in_all_ways() {
    let folder = tempfile::tempdir().expect("a folder");
    for (material, least) in [
        ("type = \"dielectric\"\nior = 1.5\nalpha = 0.3", 0.7),
        ("type = \"dielectric\"\nior = 1.5\nalpha = [0.4, 0.1]\ndistribution = \"beckmann\"", 0.8),
        ("type = \"conductor\"\nreflectance = 1.0\nalpha = [0.6, 0.2]\nrotate_deg = 30.0", 0.7),
    ] {
        let all = lights(folder.path());
        let way = ["path", "single", "independent"];
        let reference = Shot::of(&ball(material, &all[0].1, way, (4096, 2))).mean_of(1);
        println!("{material}: {} +- {}", reference[0], reference[1]);
        assert!(reference[0] > least && reference[0] < 1.0, "{material}: {reference:?}");
        for (light, text) in all {
            for way in ways() {
                // Trees grow by two at every hit.
                let spp = if way[0] == "path" { 256 } else { 16 };
                let [found, error] = Shot::of(&ball(material, &text, way, (spp, 1))).mean_of(1);
                let cut = if way[0] == "path" { 0.0 } else { 2e-3 };
                let off = (found - reference[0]).abs();
                assert!(
                    off < 5.0 * error.hypot(reference[1]) + cut + 1e-4,
                    "{material}, {light}, {way:?}: {found} +- {error}, not {reference:?}"
                );
            }
        }
    }
}

/// A mesh whose triangles are wound the wrong way round shines on the side that its normals point to, whoever finds its light.
#[test]
fn meshes_shine_on_the_side_of_their_normals() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lamp.obj");
    let corners = "v -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\nvn 0 -1 0\n";
    // Counter-clockwise seen from above.
    std::fs::write(&file, format!("{corners}f 4//1 3//1 2//1 1//1\n")).expect("written");
    let scene = |light: &str, settings: &str, seed: u32| {
        scene_of(&format!(
            r#"
            [camera]
            from = [0.0, 1.0, 4.0]
            at = [0.0, 0.0, 0.0]
            vfov_deg = 10.0
            [film]
            width = 8
            height = 8
            filter = "box"
            [render]
            {settings}
            sampler = "independent"
            spp = 256
            seed = {seed}
            max_depth = 2
            [materials.floor]
            type = "diffuse"
            reflectance = 0.8
            [[shapes]]
            type = "rectangle"
            edge_u = [9.0, 0.0, 0.0]
            edge_v = [0.0, 0.0, -9.0]
            material = "floor"
            {light}
            "#
        ))
    };
    let plain = "[[lights]]\ntype = \"rectangle\"\ncenter = [0.0, 2.0, 0.0]\nedge_u = [1.0, 0.0, 0.0]\nedge_v = [0.0, 0.0, 1.0]\n\
                 radiance = 1.0\n";
    let reference = Shot::of(&scene(plain, "integrator = \"path\"", 1)).mean_of(1);
    let lamp = format!("[[lights]]\ntype = \"mesh\"\nfile = {file:?}\nradiance = 1.0\n");
    let shape = format!(
        "[materials.lamp]\ntype = \"diffuse\"\nreflectance = 0.0\nemission = 1.0\n[[shapes]]\ntype = \"mesh\"\nfile = {file:?}\n\
         material = \"lamp\"\n"
    );
    for light in [&lamp, &shape] {
        for settings in [
            "integrator = \"path\"",
            "integrator = \"path\"\ndirect = \"light\"",
            "integrator = \"path\"\ndirect = \"bsdf\"",
            "integrator = \"whitted\"",
        ] {
            let [found, error] = Shot::of(&scene(light, settings, 2)).mean_of(1);
            let off = (found - reference[0]).abs();
            assert!(
                off < 4.5 * error.hypot(reference[1]),
                "{light}{settings}: {found} +- {error}, not {reference:?}"
            );
        }
    }
}
