//! Materials in the ray tree: what a mix, a pane and frosted glass send to the camera, against answers known by other ways;
//! the knob for reflectance and who turns it.

#[path = "support/scene.rs"]
mod support;

use glam::Vec3;
use specula::accel::Brute;
use specula::bsdf::microfacet::{Distribution, Ggx};
use specula::bsdf::{FresnelModel, Glass, RoughDielectric};
use specula::geometry::Ray;
use specula::integrator::{CameraRay, Integrator, Splitting, Stage, Whitted, Worker};
use specula::material::Scattering;
use specula::sampling::SamplerKind;
use specula::scene::{self, Scene};
use support::scene_of;

/// The mean of what arrives along a ray, over `count` samples, and the greatest distance of one from it.
fn mean(scene: &Scene, ray: Ray, count: u32) -> (f64, f64) {
    let accel = Brute::new(scene.world.clone());
    let stage = Stage::new(scene, &accel, scene.render.spp());
    let whitted =
        Whitted { max_depth: 64, min_throughput: 1e-4, splitting: Splitting::NONE, polished: false };
    let mut worker = Worker::default();
    let found: Vec<f64> = (0..count)
        .map(|index| {
            let sampler = SamplerKind::OwenSobol.start(1, [0_u32, 0], index);
            f64::from(whitted.li(&stage, &CameraRay { ray, found: None }, &sampler, &mut worker).color.g)
        })
        .collect();
    let mean = found.iter().sum::<f64>() / f64::from(count);
    (mean, found.iter().map(|x| (x - mean).abs()).fold(0.0, f64::max))
}

/// A ray that meets the unit sphere at the origin at this angle from the normal.
fn at_angle(degrees: f32) -> Ray {
    Ray::new(Vec3::new(degrees.to_radians().sin(), 0.0, 3.0), -Vec3::Z)
}

/// A ball of the material `ball` in light of 1 from everywhere.
fn in_furnace(materials: &str) -> Scene {
    let rest =
        "[[shapes]]\ntype = 'sphere'\nmaterial = 'ball'\n[[lights]]\ntype = 'environment'\nradiance = 1.0\n";
    scene_of(&format!("{materials}\n{rest}"))
}

#[test]
fn lossless_materials_cannot_be_seen_in_a_furnace() {
    let mix = "[materials]
        matt = { type = 'diffuse', reflectance = 1.0 }
        fuzzy = { type = 'glossy', exponent = 3.0, reflectance = 1.0 }
        mirror = { type = 'mirror' }
        lambert = { type = 'oren_nayar', reflectance = 1.0, roughness = 0.0 }
        ball.type = 'mix'
        ball.parts = [
            { material = 'matt', weight = 0.25 },
            { material = 'fuzzy', weight = 0.25 },
            { material = 'mirror', weight = 0.25 },
            { material = 'lambert', weight = 0.25 },
        ]";
    let others = [
        ("pane", "materials.ball = { type = 'thin_dielectric', ior = 1.8 }"),
        ("clay", "materials.ball = { type = 'oren_nayar', reflectance = 1.0, roughness = 0.7 }"),
        (
            "rejecting",
            "materials.ball = { type = 'glossy', exponent = 2.0, reflectance = 1.0, below = 'rejection' }",
        ),
        ("Schlick's mirror", "materials.ball = { type = 'schlick', roughness = 0.0, color = 1.0 }"),
        ("smooth glass by Schlick", "materials.ball = { type = 'dielectric', fresnel = 'schlick' }"),
        ("smooth glass, constant", "materials.ball = { type = 'dielectric', fresnel = 'constant' }"),
        ("mix", mix),
    ];
    for (name, materials) in others {
        let scene = in_furnace(materials);
        for angle in [0.0, 40.0, 75.0] {
            let (found, _) = mean(&scene, at_angle(angle), 1 << 15);
            assert!((found - 1.0).abs() < 4e-3, "{name} at {angle} degrees: {found}");
        }
    }
}

#[test]
fn the_lectures_ball_is_even_with_the_fix_and_dark_at_the_rim_without() {
    for (below, angle, expected) in [
        ("through_r", 0.0, 0.8),
        ("through_r", 60.0, 0.8),
        ("through_r", 85.0, 0.8),
        ("rejection", 85.0, 0.8),
        ("discard", 0.0, 0.8),
        ("discard", 60.0, 0.6),
        ("discard", 85.0, 0.435),
    ] {
        let ball = "materials.ball = { type = 'glossy', exponent = 1.0, reflectance = 0.8, below = ";
        let scene = in_furnace(&format!("{ball}'{below}' }}"));
        let (found, _) = mean(&scene, at_angle(angle), 8192);
        assert!((found - expected).abs() < 3e-3, "{below} at {angle} degrees: {found}, not {expected}");
    }
}

#[test]
fn frosted_balls_lose_what_bounces_between_facets() {
    // As measured, at the middle and half way to the rim: GGX's tails reflect totally from within, Beckmann has none.
    for (distribution, alpha, row) in [
        ("ggx", 0.01, [1.0, 1.0]),
        ("ggx", 0.2, [0.941, 0.856]),
        ("beckmann", 0.2, [0.997, 0.980]),
        ("ggx", 0.5, [0.704, 0.569]),
    ] {
        let ball = format!("type = 'dielectric', alpha = {alpha}, distribution = '{distribution}'");
        let scene = in_furnace(&format!("materials.ball = {{ {ball} }}"));
        for (angle, expected) in [0.0, 45.0].into_iter().zip(row) {
            let (found, _) = mean(&scene, at_angle(angle), 4096);
            assert!((found - expected).abs() < 0.01, "{distribution} {alpha} at {angle} degrees: {found}");
        }
    }
}

/// Looking straight down on a frosted sheet of water with light below it.
fn over_water(light: &str) -> Scene {
    scene_of(&format!(
        "[materials.water]
        type = 'dielectric'
        ior = 1.33
        alpha = 0.3
        absorption = 0.1
        [[shapes]]
        type = 'rectangle'
        edge_u = [50.0, 0.0, 0.0]
        edge_v = [0.0, 50.0, 0.0]
        material = 'water'
        [[lights]]
        {light}"
    ))
}

/// The transmission of that sheet, from a viewer towards the light.
fn through_water(wo: Vec3, wi: Vec3) -> f64 {
    let facets = Distribution::Ggx(Ggx::isotropic(0.3_f32));
    let value = RoughDielectric { glass: Glass::exact(1.33), facets }.eval(wo.into(), wi.into());
    f64::from(value.r)
}

#[test]
fn a_point_of_light_below_frosted_water_is_seen_through_it() {
    let scene = over_water("type = 'point'\nposition = [0.5, 0.0, -2.0]\nintensity = 3.0");
    let slant = Vec3::new(0.3, 0.0, 1.0).normalize();
    let (found, off) = mean(&scene, Ray::new(slant * 2.0, -slant), 16);
    let way = Vec3::new(0.5, 0.0, -2.0);
    let wi = way.normalize();
    let expected = through_water(slant, wi) * f64::from(-wi.z) * 3.0 / f64::from(way.length_squared())
        * f64::from(-0.1 * way.length()).exp();
    assert!((found - expected).abs() < 1e-4 * expected && off < 1e-6, "{found}, not {expected}");
}

#[test]
fn a_light_below_frosted_water_is_met_by_both_ways_alike() {
    let scene = over_water(
        "type = 'rectangle'\ncenter = [0.5, 0.0, -2.0]\nedge_u = [0.7, 0.0, 0.0]\nedge_v = [0.0, 0.5, 0.0]\nradiance = 3.0",
    );
    let slant = Vec3::new(0.3, 0.0, 1.0).normalize();
    let (found, _) = mean(&scene, Ray::new(slant * 2.0, -slant), 1 << 14);
    let n = 400_u16;
    let at = |i: u16| (f32::from(i) + 0.5) / f32::from(n) * 2.0 - 1.0;
    let sum: f64 = (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .map(|(i, j)| {
            let way = Vec3::new(0.5 + 0.7 * at(i), 0.5 * at(j), -2.0);
            let wi = way.normalize();
            let geometry = wi.z * wi.z / way.length_squared() * (-0.1 * way.length()).exp();
            through_water(slant, wi) * f64::from(geometry)
        })
        .sum();
    let expected = 3.0 * sum * 4.0 * 0.7 * 0.5 / f64::from(n).powi(2);
    assert!((found / expected - 1.0).abs() < 0.01, "{found}, not {expected}");
}

#[test]
fn light_goes_straight_through_panes_to_matt_surfaces() {
    let floor = |pane: &str| {
        let text = format!(
            "[materials]
            floor = {{ type = 'diffuse', reflectance = 0.5 }}
            pane = {{ type = 'thin_dielectric', transmittance = 0.8 }}
            [[shapes]]
            type = 'rectangle'
            edge_u = [9.0, 0.0, 0.0]
            edge_v = [0.0, 9.0, 0.0]
            material = 'floor'
            [[lights]]
            type = 'point'
            position = [0.0, 0.0, 3.0]
            intensity = 10.0
            {pane}"
        );
        mean(&scene_of(&text), Ray::new(Vec3::new(0.0, 0.0, 1.0), -Vec3::Z), 1).0
    };
    let pane = "[[shapes]]\ntype = 'rectangle'\ncenter = [0, 0, 2]\nedge_u = [4, 0, 0]\nedge_v = [0, 4, 0]\n\
                material = 'pane'";
    let (open, glazed) = (floor(""), floor(pane));
    // R = 0.04 at both faces, A = 0.8 once across.
    let expected = 0.96 * 0.96 * 0.8 / (1.0 - (0.04_f64 * 0.8).powi(2));
    assert!((glazed / open - expected).abs() < 1e-5, "{glazed} of {open}, not {expected}");
}

/// How the ball of a scene reflects.
fn model_of(text: &str) -> FresnelModel {
    let scene = in_furnace(text);
    let glass = |scattering: &Scattering| match scattering {
        Scattering::Dielectric { fresnel, .. } => Some(*fresnel),
        _ => None,
    };
    scene.materials.iter().find_map(|material| glass(&material.scattering)).expect("a ball of glass")
}

#[test]
fn a_material_has_the_last_word_on_its_reflectance() {
    let ball = "[materials.ball]\ntype = 'dielectric'\n";
    let own = format!("{ball}fresnel = 'f82'\n");
    assert_eq!(model_of(ball), FresnelModel::Exact, "nobody says anything");
    assert_eq!(
        model_of(&format!("[render]\nfresnel = 'constant'\n{ball}")),
        FresnelModel::Constant,
        "the rendering"
    );
    assert_eq!(model_of(&own), FresnelModel::F82, "the material");
    assert_eq!(model_of(&format!("[render]\nfresnel = 'constant'\n{own}")), FresnelModel::F82, "both");
}

/// What is odd about a scene, one line each.
fn warnings(text: &str) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).expect("a scene file");
    let loaded = scene::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
    let built = scene::build(&loaded.description).unwrap_or_else(|error| panic!("{error}"));
    built.warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn schlick_is_warned_of_where_it_is_far_off() {
    let told = warnings("render.fresnel = 'schlick'\nmaterials.gem = { type = 'dielectric', ior = 2.4 }\n");
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("scene.toml:2:") && told[0].contains("index of 2.4"), "{told:?}");
    for fine in [
        "materials.gem = { type = 'dielectric', ior = 2.4 }",
        "render.fresnel = 'schlick'\nmaterials.glass = { type = 'glazed', ior = 1.5 }",
        "render.fresnel = 'schlick'\nmaterials.gem = { type = 'dielectric', ior = 2.4, fresnel = 'exact' }",
        "render.fresnel = 'f82'\nmaterials.gem = { type = 'thin_dielectric', ior = 2.4 }",
    ] {
        assert_eq!(warnings(fine), Vec::<String>::new(), "{fine}");
    }
}

/// All that is wrong with a scene.
fn problems(text: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).expect("a scene file");
    match scene::load(&path, &[]).and_then(|loaded| scene::build(&loaded.description)) {
        Ok(_) => String::new(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn faulty_mixes_are_told() {
    let with = |parts: &str| {
        problems(&format!(
            "[materials]
            matt = {{ type = 'diffuse' }}
            lamp = {{ type = 'emission', radiance = 1 }}
            bright = {{ type = 'diffuse', emission = 1 }}
            ice = {{ type = 'dielectric' }}
            along = {{ type = 'conductor', metal = 'Ag', alpha = [0.1, 0.4] }}
            across = {{ type = 'conductor', metal = 'Au', alpha = [0.1, 0.4], rotate_deg = 90 }}
            other = {{ type = 'mix', parts = [{{ material = 'matt' }}] }}
            mix = {{ type = 'mix', parts = [{parts}] }}"
        ))
    };
    for good in [
        "{ material = 'matt' }, { material = 'ice' }",
        "{ material = 'across', weight = 0.5 }, { material = 'across', weight = 0.2 }",
        "{ material = 'along', weight = 0 }, { material = 'across' }, { material = 'ice', weight = 0 }",
    ] {
        assert_eq!(with(good), "", "{good}: a good one");
    }
    for (parts, told) in [
        ("", "`parts` is empty"),
        ("{ material = 'mat' }", "unknown material `mat`"),
        ("{ material = 'other' }", "`other` is a mix itself"),
        ("{ material = 'lamp' }", "`lamp` is a light"),
        ("{ material = 'bright' }", "`bright` shines"),
        ("{ material = 'ice' }, { material = 'ice' }", "the surface of two bodies"),
        (
            "{ material = 'along', weight = 0.5 }, { material = 'across', weight = 0.5 }",
            "brushed in different directions; give all of them the same `rotate_deg`",
        ),
        (
            "{ material = 'matt', weight = 0.7 }, { material = 'ice', weight = [0.2, 0.3, 0.4] }",
            "more than 1",
        ),
        (&["{ material = 'matt', weight = 0.1 }"; 5].join(","), "too many entries"),
    ] {
        let found = with(parts);
        assert!(found.contains(told), "{parts}: {found}");
    }
}

#[test]
fn brushed_metal_stretches_highlights_across_the_grain() {
    // Seen from the front, a ball turned on a lathe about y: the tangent runs sideways at its front.
    let lit = |alpha: &str, rotate: f32, light: [f32; 3]| {
        let [x, y, z] = light;
        let scene = scene_of(&format!(
            "[materials.ball]
            type = 'conductor'
            metal = 'Ag'
            alpha = {alpha}
            rotate_deg = {rotate}
            [[shapes]]
            type = 'sphere'
            material = 'ball'
            [[lights]]
            type = 'directional'
            direction = [{x}, {y}, {z}]
            irradiance = 1.0"
        ));
        mean(&scene, at_angle(0.0), 1).0
    };
    let (side, top) = ([-0.4, 0.0, -1.0], [0.0, -0.4, -1.0]);
    let [wide, narrow] = [lit("[0.4, 0.05]", 0.0, side), lit("[0.4, 0.05]", 0.0, top)];
    assert!(wide > 50.0 * narrow, "rough along the tangent: {wide} from the side, {narrow} from the top");
    let [turned, other] = [lit("[0.4, 0.05]", 90.0, top), lit("[0.4, 0.05]", 90.0, side)];
    assert!(
        (turned / wide - 1.0).abs() < 1e-3 && other < 0.02 * wide,
        "a quarter turn: {turned} and {other}"
    );
    let even = [lit("0.2", 30.0, side), lit("0.2", 0.0, top)];
    assert!((even[0] / even[1] - 1.0).abs() < 1e-3, "one width has no grain: {even:?}");
}

#[test]
fn what_a_mix_leaves_of_its_parts_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    image::GrayImage::from_pixel(2, 2, image::Luma([255]))
        .save(folder.path().join("a.png"))
        .expect("a picture");
    for key in ["bump", "normal_map", "opacity"] {
        let text = format!(
            "[materials]\nmatt = {{ type = 'diffuse', {key} = {{ file = 'a.png' }} }}\n\
             mix = {{ type = 'mix', parts = [{{ material = 'matt' }}] }}\n"
        );
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).expect("a scene file");
        let loaded = scene::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        let built = scene::build(&loaded.description).unwrap_or_else(|error| panic!("{error}"));
        let [warning] = &built.warnings[..] else { panic!("{key}: {:?}", built.warnings) };
        let warning = warning.to_string();
        assert!(
            warning.contains("scene.toml:3:45: ")
                && warning.contains("holes of `matt` are not those of the mix"),
            "{key}: {warning}"
        );
    }
}
