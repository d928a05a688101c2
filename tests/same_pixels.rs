//! Pixels depend on scene, pixel and sample index alone: bit for bit the same on one thread and on several, in tiles of a
//! crop and in the whole picture, with a backend asked once or twice.

#[path = "support/scene.rs"]
mod support;

use specula::image::Window;
use specula::render::{Settings, Silent, render};
use specula::scene::Scene;
use std::num::NonZeroUsize;
use support::scene_of;

/// Every kind of light and material that random numbers decide about.
const SCENE: &str = r#"
    [film]
    width = 75
    height = 52
    [render]
    spp = 5
    max_depth = 8
    [materials.glass]
    type = "dielectric"
    [materials.copper]
    type = "conductor"
    metal = "Cu"
    alpha = 0.2
    [materials.satin]
    type = "glossy"
    exponent = 30
    diffuse = [0.4, 0.1, 0.1]
    [materials.floor]
    type = "glazed"
    reflectance = { checker = [0.7, 0.1], repeat = [8, 8] }
    [[shapes]]
    type = "rectangle"
    edge_u = [4.0, 0.0, 0.0]
    edge_v = [0.0, 0.0, -4.0]
    material = "floor"
    [[shapes]]
    type = "sphere"
    center = [-0.9, 0.5, 0.3]
    radius = 0.5
    material = "copper"
    [[shapes]]
    type = "sphere"
    center = [0.1, 0.5, 1.2]
    radius = 0.5
    material = "glass"
    [[shapes]]
    type = "box"
    min = [0.8, 0.0, -0.5]
    max = [1.5, 0.9, 0.2]
    material = "satin"
    [[lights]]
    type = "rectangle"
    center = [0.0, 3.0, 0.0]
    edge_u = [0.5, 0.0, 0.0]
    edge_v = [0.0, 0.0, 0.5]
    radiance = 9.0
    [[lights]]
    type = "sphere"
    center = [-2.0, 2.0, 1.0]
    radius = 0.3
    radiance = [4.0, 5.0, 6.0]
    [[lights]]
    type = "environment"
    radiance = 0.2
"#;

fn bits(scene: &Scene, threads: usize, crop: Option<Window>) -> Vec<Vec<u32>> {
    let settings = Settings { threads: NonZeroUsize::new(threads), crop, ..Settings::default() };
    let rendered = render(scene, &settings, &Silent).expect("a picture");
    assert_eq!(rendered.film.non_finite().count(), 0, "samples that are not finite");
    support::bits(&rendered.film)
}

/// Renders the whole on one thread and on several, and in crops that are joined.
fn assert_the_same(name: &str, scene: &Scene) {
    let whole = bits(scene, 1, None);
    assert_eq!(bits(scene, 1, None), whole, "{name}: a second time");
    assert_eq!(bits(scene, 2, None), whole, "{name}: two threads");
    assert_eq!(bits(scene, 5, None), whole, "{name}: five threads");
    let (width, height) = (75, 52);
    let mut joined = vec![vec![0_u32; width * height]; whole.len()];
    for (x0, x1) in [(0, 23), (23, 24), (24, 75)] {
        for (y0, y1) in [(0, 31), (31, 52)] {
            let part = bits(scene, 2, Some(Window { x0, y0, x1, y1 }));
            for (joined, part) in joined.iter_mut().zip(part) {
                let columns = (x1 - x0) as usize;
                for (row, values) in part.chunks_exact(columns).enumerate() {
                    let at = (y0 as usize + row) * width + x0 as usize;
                    joined[at..at + columns].copy_from_slice(values);
                }
            }
        }
    }
    assert!(joined == whole, "{name}: crops joined differ from the whole");
}

#[test]
fn threads_and_crops_do_not_change_a_bit() {
    for sampler in ["sobol", "independent", "stratified", "blue_noise"] {
        let scene = scene_of(&SCENE.replace("spp = 5", &format!("spp = 5\n    sampler = \"{sampler}\"")));
        assert_the_same(sampler, &scene);
    }
}

#[test]
fn no_way_to_trace_rays_lets_a_bit_change() {
    for integrator in ["path", "whitted", "distribution"] {
        for (query, spp) in [("single", 3), ("packet", 3), ("packet", 16), ("stream", 3), ("stream", 16)] {
            let settings = format!("spp = {spp}\n    integrator = \"{integrator}\"\n    query = \"{query}\"");
            let scene = scene_of(&SCENE.replace("spp = 5", &settings));
            assert_the_same(&format!("{integrator}, {query}, {spp}"), &scene);
        }
    }
}

#[test]
fn seeds_and_samplers_do_change_it() {
    let whole = bits(&scene_of(SCENE), 2, None);
    let other = bits(&scene_of(&SCENE.replace("spp = 5", "spp = 5\n    seed = 4294967296")), 2, None);
    assert!(other != whole, "the upper half of a seed counts");
}

#[test]
fn the_cost_of_a_sample_is_its_rays_however_they_are_traced() {
    let of = |query: &str| {
        let keys = format!(
            "[render]\n    integrator = \"view\"\n    view = \"cost\"\n    glass_shadows = \"opaque\"\n    query = \"{query}\""
        );
        let scene = scene_of(&SCENE.replace("[render]", &keys));
        let film = render(&scene, &Settings::default(), &Silent).expect("a picture").film;
        film.image().pixels().iter().map(|pixel| f64::from(pixel.g)).sum::<f64>()
    };
    let (single, stream) = (of("single"), of("stream"));
    assert!(single > 0.0 && (stream / single - 1.0).abs() < 1e-4, "{stream} for {single}");
}
