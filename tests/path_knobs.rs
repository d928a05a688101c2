//! Knobs of the path tracer that may change noise, or take light away where they say so: roulette, the limit on indirect light, the
//! choice of lights.

#[path = "support/scene.rs"]
mod scene;

use specula::image::{Image, Window};
use specula::render::{Rendered, Settings, Slice};

fn rendered(text: &str) -> Rendered {
    scene::rendered(text, &Settings::default())
}

/// Luminance, all pixels together.
fn sum(image: &Image) -> f64 {
    image.pixels().iter().map(|pixel| f64::from(pixel.luminance())).sum()
}

/// Mean and standard error of the luminance of pictures with different seeds.
fn estimate(text: &str, seeds: u32) -> (f64, f64) {
    let of = |seed: u32| {
        let image = rendered(&text.replace("SEED", &seed.to_string())).film.image();
        sum(&image) / image.pixels().len() as f64
    };
    let values: Vec<_> = (1..=seeds).map(of).collect();
    let n = f64::from(seeds);
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// That two settings have the same mean, within four standard errors that are a hundredth of it at most.
fn same_mean(what: &str, texts: [&str; 2]) -> [(f64, f64); 2] {
    let [a, b] = texts.map(|text| estimate(text, 10));
    let error = a.1.hypot(b.1);
    assert!(error < 0.01 * a.0, "{what}: {a:?} and {b:?} are too noisy to tell");
    assert!((a.0 - b.0).abs() < 4.0 * error, "{what}: {a:?} and {b:?}");
    [a, b]
}

/// A closed room with balls of coloured and clear glass, a rough one, a glossy one and a lamp.
const ROOM: &str = r#"
    [camera]
    from = [0.0, 1.0, 2.6]
    at = [0.0, 0.7, 0.0]
    vfov_deg = 60.0
    [film]
    width = 24
    height = 18
    filter = "box"
    [render]
    integrator = "path"
    spp = 128
    max_depth = 24
    seed = SEED
    KEYS
    [materials.wall]
    type = "diffuse"
    reflectance = [0.7, 0.5, 0.4]
    [materials.glass]
    type = "dielectric"
    ior = 1.8
    absorption = [0.5, 0.2, 1.0]
    [materials.frosted]
    type = "dielectric"
    ior = 1.5
    alpha = 0.2
    [materials.glossy]
    type = "glossy"
    exponent = 30
    diffuse = [0.2, 0.4, 0.1]
    [[shapes]]
    type = "box"
    min = [-2.0, 0.0, -2.0]
    max = [2.0, 3.0, 3.0]
    material = "wall"
    [[shapes]]
    type = "sphere"
    center = [-0.7, 0.5, 0.0]
    radius = 0.5
    material = "glass"
    [[shapes]]
    type = "sphere"
    center = [0.4, 0.4, 0.5]
    radius = 0.4
    material = "frosted"
    [[shapes]]
    type = "sphere"
    center = [0.6, 0.5, -0.6]
    radius = 0.5
    material = "glossy"
    [[lights]]
    type = "rectangle"
    center = [0.0, 2.9, 0.0]
    edge_u = [0.7, 0.0, 0.0]
    edge_v = [0.0, 0.0, 0.7]
    radiance = 4.0
"#;

fn room(keys: &str) -> String {
    ROOM.replace("KEYS", keys)
}

#[test]
fn roulette_changes_no_mean() {
    for query in ["single", "stream"] {
        let of = |roulette: &str| room(&format!("query = \"{query}\"\n    roulette = {roulette}"));
        same_mean(query, [&of("\"off\""), &of("2")]);
    }
    let of = |roulette: &str| rendered(&room(&format!("roulette = {roulette}")).replace("SEED", "1"));
    let counters = [of("\"off\""), of("2")].map(|rendered| rendered.statistics.counters);
    assert_eq!(counters[0].cut_by_roulette, 0, "no roulette, nobody dies");
    assert!(counters[1].cut_by_roulette > 10_000, "{:?}", counters[1]);
    assert!(counters[1].bounced * 2 < counters[0].bounced, "{counters:?}");
}

/// Lanes without a path have no medium to ask for the index of.
#[test]
fn roulette_from_the_first_edge_asks_nothing_of_empty_lanes() {
    for spp in [1, 3] {
        let text = room("roulette = 1").replace("SEED", "5").replace("spp = 128", &format!("spp = {spp}"));
        let settings = Settings { crop: Some(Window { x0: 0, y0: 0, x1: 5, y1: 5 }), ..Settings::default() };
        assert_eq!(scene::rendered(&text, &settings).film.samples(), 25 * spp, "all of them");
    }
}

/// Paths inside of glass carry less radiance times its square: they are not taken for faint.
#[test]
fn roulette_spares_glass() {
    let text = |ior: f32| {
        format!(
            r#"
            [camera]
            from = [0.0, 0.0, 3.0]
            at = [0.0, 0.0, 0.0]
            vfov_deg = 30.0
            [film]
            width = 16
            height = 16
            filter = "box"
            [render]
            integrator = "path"
            spp = 64
            max_depth = 64
            roulette = 1
            [materials.glass]
            type = "dielectric"
            ior = {ior}
            [[shapes]]
            type = "sphere"
            radius = 0.7
            material = "glass"
            [[lights]]
            type = "environment"
            radiance = 1.0
            "#
        )
    };
    for ior in [1.5, 2.4] {
        let counters = rendered(&text(ior)).statistics.counters;
        assert!(counters.cut_by_roulette * 10_000 < counters.bounced, "{ior}: {counters:?}");
    }
}

#[test]
fn roulette_is_the_same_one_by_one() {
    let of = |query: &str| {
        let keys = format!("query = \"{query}\"\n    roulette = 2");
        sum(&rendered(&room(&keys).replace("SEED", "3")).film.image())
    };
    let (single, stream) = (of("single"), of("stream"));
    // Paths that choose within rounding go elsewhere.
    assert!((single / stream - 1.0).abs() < 3e-3, "{single} and {stream}");
}

/// All depths, direct light alone, and by each strategy: one question beside several ways on.
#[test]
fn splitting_changes_no_mean() {
    for keys in [
        "max_depth = 24",
        "max_depth = 2",
        "max_depth = 3\n    direct = \"light\"",
        "max_depth = 3\n    direct = \"bsdf\"",
    ] {
        let of = |spp: u32, splits: u32| {
            let keys = format!("{keys}\n    path_splits = {splits}");
            room(&keys)
                .replace("spp = 128", &format!("spp = {spp}"))
                .replace("edge_u = [0.7", "edge_u = [1.6")
                .replace("    max_depth = 24\n    seed", "    seed")
        };
        same_mean(keys, [&of(128, 1), &of(48, 3)]);
    }
}

/// Each camera ray is traced once, and lights are asked once where it ends.
#[test]
fn splitting_saves_camera_rays() {
    let of =
        |keys: &str| rendered(&room(keys).replace("SEED", "2").replace("max_depth = 24", "max_depth = 2"));
    let [one, four] = ["path_splits = 1", "path_splits = 4"].map(|keys| of(keys).statistics.counters);
    assert_eq!(one.camera, four.camera, "a ray a sample");
    assert!(four.shadow < one.shadow + one.shadow / 20, "{one:?}, {four:?}");
}

#[test]
fn splitting_is_the_same_one_by_one_and_in_slices() {
    let of = |query: &str, slice: Option<Slice>| {
        let keys = format!("query = \"{query}\"\n    path_splits = 5\n    sampler = \"blue_noise\"");
        let settings = Settings { slice, ..Settings::default() };
        let text = room(&keys).replace("SEED", "3").replace("spp = 128", "spp = 24");
        sum(&scene::rendered(&text, &settings).film.image())
    };
    let (single, stream) = (of("single", None), of("stream", None));
    assert!((single / stream - 1.0).abs() < 3e-3, "{single} and {stream}");
    let slices: f64 = (0..3).map(|index| of("stream", Some(Slice { index, of: 3 }))).sum();
    assert!((slices / 3.0 / stream - 1.0).abs() < 1e-5, "{slices} and {stream}");
}

#[test]
fn a_limit_on_indirect_light_tells_what_it_took() {
    let of = |keys: &str| rendered(&room(keys).replace("SEED", "1"));
    let free = of("");
    assert!(free.statistics.counters.clamped.to_bits() == 0, "nothing was asked for");
    let high = of("clamp_indirect = 1e9");
    assert_eq!(high.film.image().pixels(), free.film.image().pixels(), "a limit that nothing reaches");
    assert!(high.statistics.counters.clamped_part().to_bits() == 0, "took nothing");
    for limit in ["2.0", "0.05"] {
        let limited = of(&format!("clamp_indirect = {limit}"));
        let counters = limited.statistics.counters;
        // The box filter weighs all samples alike.
        let [all, left] = [&free, &limited].map(|rendered| sum(&rendered.film.image()) * 128.0);
        assert!(counters.clamped > 0.001 * all, "limit {limit}: {counters:?}");
        assert!(
            ((all - left) / counters.clamped - 1.0).abs() < 2e-3,
            "limit {limit}: {all}, {left}, {counters:?}"
        );
        let part = counters.clamped_part();
        assert!((part / ((all - left) / all) - 1.0).abs() < 2e-3, "limit {limit}: {part}");
    }
    // Light of one bounce is not indirect.
    let direct = ["max_depth = 2", "max_depth = 2\n    clamp_indirect = 1e-6"].map(|keys| {
        let text = room(keys).replacen("max_depth = 24", "", 1).replace("SEED", "1");
        rendered(&text).film.image()
    });
    assert_eq!(direct[0].pixels(), direct[1].pixels(), "direct light");
}

/// A floor with balls under many lamps of all kinds, a large one of triangles among them, and a sun.
fn lamps(keys: &str) -> String {
    let mut text = ROOM.split("[[shapes]]").next().expect("a head").replace("KEYS", keys);
    text = text.replace("max_depth = 24", "max_depth = 3");
    text += r#"
    [materials.lamp]
    type = "diffuse"
    reflectance = 0.3
    emission = [2.0, 1.0, 0.5]
    [[shapes]]
    type = "rectangle"
    edge_u = [5.0, 0.0, 0.0]
    edge_v = [0.0, 0.0, -5.0]
    material = "wall"
    [[shapes]]
    type = "sphere"
    center = [0.5, 0.5, 0.2]
    radius = 0.5
    material = "glossy"
    [[shapes]]
    type = "box"
    min = [-1.2, 0.3, -0.6]
    max = [-0.7, 0.9, -0.4]
    material = "lamp"
    [[lights]]
    type = "directional"
    direction = [0.3, -1.0, 0.2]
    irradiance = 0.1
    "#;
    for i in 0..40_u16 {
        let (x, z) = (f32::from(i % 8) * 0.9 - 3.1, f32::from(i / 8) * 1.1 - 2.6);
        let radiance = 0.5 + f32::from(i % 7);
        text += &match i % 4 {
            0 => format!(
                "[[lights]]\ntype = \"sphere\"\ncenter = [{x:?}, 1.3, {z:?}]\nradius = 0.1\nradiance = {radiance:?}\n"
            ),
            1 => format!(
                "[[lights]]\ntype = \"rectangle\"\ncenter = [{x:?}, 1.2, {z:?}]\nedge_u = [0.2, 0.0, 0.0]\nedge_v = [0.0, 0.05, 0.1]\nradiance = {radiance:?}\n"
            ),
            2 => format!(
                "[[lights]]\ntype = \"disc\"\ncenter = [{x:?}, 1.4, {z:?}]\nnormal = [0.2, -1.0, 0.1]\nradius = 0.15\nradiance = {radiance:?}\n"
            ),
            _ => format!(
                "[[lights]]\ntype = \"spot\"\nposition = [{x:?}, 1.6, {z:?}]\nat = [0.0, 0.0, 0.0]\nangle_deg = 40.0\nintensity = {:?}\n",
                radiance * 0.1
            ),
        };
    }
    text
}

#[test]
fn all_choices_of_lights_have_one_mean() {
    let of = |choice: &str| lamps(&format!("light_choice = \"{choice}\""));
    let [power, tree] = same_mean("power and tree", [&of("power"), &of("tree")]);
    same_mean("tree and uniform", [&of("tree"), &of("uniform")]);
    same_mean("one by one", [&of("tree"), &lamps("light_choice = \"tree\"\n    query = \"single\"")]);
    assert!(tree.1 < power.1, "the tree has less noise: {tree:?} and {power:?}");
}
