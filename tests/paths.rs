//! Paths bring home the light that there is, over lanes as one by one.

#[path = "support/scene.rs"]
mod scene;

use scene::{film, scene_in, scene_of};
use specula::image::Image;
use specula::math::Rgb;

use specula::scene::Scene;

fn picture(scene: &Scene) -> Image {
    film(scene).image()
}

fn mean(image: &Image) -> Rgb<f32> {
    let sum = image.pixels().iter().fold(Rgb::BLACK, |sum, pixel| sum + *pixel);
    sum.scale(1.0 / image.pixels().len() as f32)
}

/// A ball of a material that fills the picture, in light that is the same all around.
fn furnace(material: &str, query: &str, max_depth: u32) -> Scene {
    scene_of(&format!(
        r#"
        [camera]
        from = [0.0, 0.0, 3.0]
        at = [0.0, 0.0, 0.0]
        vfov_deg = 20.0
        [film]
        width = 16
        height = 16
        filter = "box"
        [render]
        integrator = "path"
        query = "{query}"
        spp = 256
        max_depth = {max_depth}
        [materials.m]
        {material}
        [[shapes]]
        type = "sphere"
        radius = 1.0
        material = "m"
        [[lights]]
        type = "environment"
        radiance = 1.0
        "#
    ))
}

#[test]
fn what_loses_nothing_is_not_seen_in_a_furnace() {
    let white = [
        "type = \"diffuse\"\nreflectance = 1.0",
        "type = \"oren_nayar\"\nreflectance = 1.0\nroughness = 0.7",
        "type = \"mirror\"\nreflectance = 1.0",
        "type = \"dielectric\"\nior = 1.5",
        "type = \"thin_dielectric\"\nior = 1.5",
        "type = \"glossy\"\nexponent = 20\nreflectance = 1.0",
        "type = \"glazed\"\nior = 1.5\nreflectance = 1.0",
    ];
    for query in ["single", "stream"] {
        for material in white {
            // One bounce is enough for what light does not enter.
            let shallow = if material.contains("dielectric") { 64 } else { 2 };
            for max_depth in [shallow, 64] {
                let Rgb { r, g, b } = mean(&picture(&furnace(material, query, max_depth)));
                let off = (r - 1.0).abs().max((g - 1.0).abs()).max((b - 1.0).abs());
                assert!(off < 4e-3, "{material}, {query}, {max_depth} edges: {r} {g} {b}");
            }
        }
    }
}

/// Everything: all lobes, media, mixes, motion, meshes with and without normals, every kind of light.
const ALL: &str = r#"
    [camera]
    from = [0.0, 1.6, 6.0]
    at = [0.0, 0.5, 0.0]
    vfov_deg = 40.0
    lens_radius = 0.02
    shutter_close_s = 1.0
    [film]
    width = 80
    height = 48
    filter = "box"
    [render]
    integrator = "path"
    spp = 16
    max_depth = 7
    [materials.floor]
    type = "glazed"
    reflectance = { checker = [0.7, 0.1], repeat = [8, 8] }
    [materials.a]
    type = "dielectric"
    absorption = [0.5, 0.1, 0.0]
    [materials.b]
    type = "dielectric"
    alpha = 0.3
    [materials.c]
    type = "conductor"
    metal = "Cu"
    alpha = [0.2, 0.05]
    [materials.d]
    type = "conductor"
    metal = "Au"
    [materials.e]
    type = "glossy"
    exponent = 30
    diffuse = [0.4, 0.1, 0.1]
    [materials.f]
    type = "schlick"
    color = [0.3, 0.6, 0.3]
    roughness = 0.3
    [materials.g]
    type = "oren_nayar"
    reflectance = 0.6
    roughness = 0.8
    [materials.h]
    type = "thin_dielectric"
    [materials.i]
    type = "mix"
    parts = [{ material = "c", weight = 0.4 }, { material = "g", weight = [0.6, 0.3, 0.6] }]
    [[shapes]]
    type = "rectangle"
    edge_u = [6.0, 0.0, 0.0]
    edge_v = [0.0, 0.0, -6.0]
    material = "floor"
    SHAPES
    [[lights]]
    type = "rectangle"
    center = [0.0, 4.0, 0.0]
    edge_u = [0.5, 0.0, 0.0]
    edge_v = [0.0, 0.0, 0.5]
    radiance = 9.0
    [[lights]]
    type = "sphere"
    center = [-3.0, 2.0, 1.0]
    radius = 0.3
    radiance = [4.0, 5.0, 6.0]
    [[lights]]
    type = "point"
    position = [2.0, 3.0, 3.0]
    intensity = 3.0
    [[lights]]
    type = "environment"
    radiance = 0.2
"#;

fn all() -> String {
    let mut shapes = String::new();
    for (i, material) in ["a", "b", "c", "d", "e", "f", "g", "h", "i"].into_iter().enumerate() {
        let x = i as f32 * 0.62 - 2.48;
        shapes += &match i % 3 {
            0 => format!(
                "[[shapes]]\ntype = \"sphere\"\ncenter = [{x:?}, 0.3, 0.0]\nradius = 0.28\nmaterial = \"{material}\"\n"
            ),
            1 => format!(
                "[[shapes]]\ntype = \"box\"\nmin = [{:?}, 0.01, -0.25]\nmax = [{:?}, 0.5, 0.25]\nmaterial = \"{material}\"\n",
                x - 0.25,
                x + 0.25
            ),
            _ => format!(
                "[[shapes]]\ntype = \"torus\"\ncenter = [{x:?}, 0.3, 0.0]\naxis = [0.3, 0.2, 1.0]\nmajor_radius = 0.2\nminor_radius = 0.08\nmaterial = \"{material}\"\n"
            ),
        };
    }
    ALL.replace("SHAPES", &shapes)
}

#[test]
fn packets_and_streams_bring_home_what_single_rays_do() {
    for integrator in ["path", "whitted", "distribution", "view"] {
        let with = |query: &str| {
            let settings = format!("integrator = \"{integrator}\"\n    query = \"{query}\"");
            picture(&scene_of(&all().replace("integrator = \"path\"", &settings)))
        };
        let single = with("single");
        for query in ["packet", "stream"] {
            compare(&format!("{integrator}, {query}"), &single, &with(query));
        }
    }
}

/// A ray that meets an edge or a path that chooses within rounding goes elsewhere: few pixels, and no bias.
#[expect(clippy::print_stdout, reason = "tells how much differs")]
fn compare(what: &str, single: &Image, other: &Image) {
    let differences = single.pixels().iter().zip(other.pixels()).map(|(a, b)| {
        let largest = a.max_channel().max(b.max_channel()).max(1e-3);
        ((a.r - b.r).abs().max((a.g - b.g).abs()).max((a.b - b.b).abs())) / largest
    });
    let (mut changed, mut apart, mut most) = (0, 0, 0.0_f32);
    for difference in differences {
        changed += usize::from(difference > 0.0);
        apart += usize::from(difference > 1e-3);
        most = most.max(difference);
    }
    let count = single.pixels().len();
    println!(
        "{what}: {changed} of {count} pixels differ, {apart} by more than a thousandth, the most by {most}"
    );
    assert!(apart * 50 < count, "{what}: {apart} of {count} pixels differ");
    let (a, b) = (mean(single), mean(other));
    assert!(
        (a.r - b.r).abs() < 2e-3 * a.r && (a.b - b.b).abs() < 2e-3 * a.b,
        "{what}: means {a:?} and {b:?}"
    );
}

/// Light of one bounce is what the ray tree finds, too.
#[test]
fn paths_and_trees_agree_where_both_have_all_of_the_light() {
    let scene = |integrator: &str, depth: u32| {
        scene_of(&format!(
            r#"
            [camera]
            from = [0.0, 1.5, 4.0]
            at = [0.0, 0.3, 0.0]
            vfov_deg = 35.0
            [film]
            width = 32
            height = 24
            filter = "box"
            [render]
            integrator = "{integrator}"
            spp = 256
            max_depth = {depth}
            [materials.matt]
            type = "oren_nayar"
            reflectance = [0.7, 0.5, 0.3]
            roughness = 0.4
            [materials.metal]
            type = "conductor"
            metal = "Ag"
            alpha = 0.3
            [[shapes]]
            type = "disc"
            normal = [0.0, 1.0, 0.0]
            radius = 4.0
            material = "matt"
            [[shapes]]
            type = "sphere"
            center = [0.0, 0.6, 0.0]
            radius = 0.6
            material = "metal"
            [[lights]]
            type = "disc"
            center = [1.0, 3.0, 1.0]
            normal = [-0.3, -1.0, -0.3]
            radius = 0.8
            radiance = 5.0
            [[lights]]
            type = "sphere"
            center = [-2.0, 2.0, 1.0]
            radius = 0.4
            radiance = [3.0, 5.0, 9.0]
            [[lights]]
            type = "environment"
            radiance = [0.6, 0.4, 0.2]
            "#
        ))
    };
    let (tree, paths) = (picture(&scene("whitted", 2)), picture(&scene("path", 2)));
    let (a, b) = (mean(&tree), mean(&paths));
    for (tree, paths) in [(a.r, b.r), (a.g, b.g), (a.b, b.b)] {
        assert!((tree - paths).abs() < 4e-3 * tree, "trees bring {tree}, paths {paths}");
    }
}

/// Points of large triangles are known to a part of their size, and rays start as far off: they must not end behind a lamp for that.
#[test]
fn a_lamp_over_a_large_floor_lights_it() {
    let scene = |integrator: &str, edge: f32| {
        scene_of(&format!(
            r#"
            [camera]
            from = [0.0, 1.5, 4.0]
            at = [0.0, 0.0, 0.0]
            vfov_deg = 35.0
            [film]
            width = 16
            height = 12
            filter = "box"
            [render]
            integrator = "{integrator}"
            spp = 256
            max_depth = 2
            [materials.matt]
            type = "diffuse"
            reflectance = 0.5
            [materials.lamp]
            type = "emission"
            radiance = 5.0
            [[shapes]]
            type = "rectangle"
            edge_u = [0.0, 0.0, {edge:?}]
            edge_v = [{edge:?}, 0.0, 0.0]
            material = "matt"
            [[shapes]]
            type = "rectangle"
            center = [0.0, 2.0, 0.0]
            edge_u = [1.0, 0.0, 0.0]
            edge_v = [0.0, 0.0, 1.0]
            material = "lamp"
            "#
        ))
    };
    let expected = mean(&picture(&scene("whitted", 20.0))).g;
    assert!(expected > 0.1, "{expected}");
    for integrator in ["path", "whitted"] {
        for edge in [20.0, 2e3, 2e4] {
            let found = mean(&picture(&scene(integrator, edge))).g;
            assert!(
                (found - expected).abs() < 0.01 * expected,
                "{integrator}, floor of {edge} m: {found}, not {expected}"
            );
        }
    }
}

/// A few samples of what `benches/record/extremes.md` tells of a hundred million.
#[test]
fn extremes_give_numbers() {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/extremes.toml");
    for integrator in ["path", "whitted", "distribution"] {
        for query in ["single", "stream"] {
            let settings = [
                format!("render.integrator={integrator}"),
                format!("render.query={query}"),
                "render.spp=16".to_owned(),
                "film.width=64".to_owned(),
                "film.height=36".to_owned(),
            ];
            let image = picture(&scene_in(&file, &settings));
            let Rgb { r, .. } = mean(&image);
            assert!(r > 0.1 && r < 1.0, "{integrator}, {query}: a mean of {r}");
        }
    }
}
