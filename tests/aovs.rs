//! Outputs besides the picture: what camera rays see, and how far the picture is to be trusted.

#[path = "support/desk.rs"]
mod desk;
#[path = "support/scene.rs"]
mod scene;

use desk::Desk;
use scene::scene_of;
use specula::film::{Aov, Film, Layout};
use specula::image::{self, exr};
use specula::render::{Settings, Silent, render};

/// A white ball before a red wall, above a mirror.
fn still(render: &str) -> String {
    format!(
        r#"
        [camera]
        from = [0.0, 1.0, 4.0]
        at = [0.0, 1.0, 0.0]
        vfov_deg = 60.0
        [film]
        width = 32
        height = 32
        filter = "box"
        [render]
        {render}
        [materials.white]
        type = "diffuse"
        reflectance = 0.8
        [materials.red]
        type = "oren_nayar"
        reflectance = [0.6, 0.1, 0.05]
        [materials.mirror]
        type = "mirror"
        reflectance = [0.9, 0.8, 0.7]
        [[shapes]]
        type = "sphere"
        center = [0.0, 1.0, 0.0]
        radius = 0.5
        material = "white"
        [[shapes]]
        type = "rectangle"
        center = [0.0, 0.0, -2.0]
        edge_u = [1.4, 0.0, 0.0]
        edge_v = [0.0, 5.0, 0.0]
        material = "red"
        [[shapes]]
        type = "rectangle"
        center = [0.0, -0.5, 0.0]
        edge_u = [20.0, 0.0, 0.0]
        edge_v = [0.0, 0.0, -2.0]
        material = "mirror"
        [[lights]]
        type = "rectangle"
        center = [3.0, 5.0, 3.0]
        edge_u = [0.0, 0.5, -0.5]
        edge_v = [0.5, 0.0, -0.5]
        radiance = 20.0
        "#
    )
}

fn film(text: &str, aovs: &[Aov]) -> Film {
    let settings = Settings { layout: Layout::with(aovs.iter().copied()), ..Settings::default() };
    render(&scene_of(text), &settings, &Silent).expect("a picture").film
}

/// The channels of an output at a pixel.
fn at(film: &Film, aov: Aov, [x, y]: [usize; 2]) -> Vec<f32> {
    let channels = film.channels(aov).expect("kept");
    channels.iter().map(|values| values[y * 32 + x]).collect()
}

fn assert_near(found: &[f32], expected: &[f32], what: &str) {
    let near = found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-2);
    assert!(near, "{what}: {found:?} for {expected:?}");
}

#[test]
fn surfaces_are_what_and_where_they_are() {
    let features = [Aov::Albedo, Aov::Normal, Aov::GeometricNormal, Aov::Depth, Aov::Position];
    let mut first = None;
    for (integrator, query) in [
        ("path", "stream"),
        ("path", "single"),
        ("whitted", "stream"),
        ("whitted", "single"),
        ("view", "single"),
    ] {
        let settings = format!("integrator = \"{integrator}\"\nquery = \"{query}\"\nspp = 16");
        let film = film(&still(&settings), &features);
        // The middle of the ball.
        assert_near(&at(&film, Aov::Albedo, [16, 16]), &[0.8, 0.8, 0.8], "albedo of the ball");
        assert_near(&at(&film, Aov::Depth, [16, 16]), &[3.5], "depth of the ball");
        assert_near(&at(&film, Aov::Position, [16, 16]), &[0.05, 0.95, 0.5], "place of the ball");
        let normal = at(&film, Aov::Normal, [16, 16]);
        assert!(normal[2] > 0.97, "normal of the ball: {normal:?}");
        // The wall over the ball.
        assert_near(&at(&film, Aov::Albedo, [16, 4]), &[0.6, 0.1, 0.05], "albedo of the wall");
        assert_near(&at(&film, Aov::Normal, [16, 4]), &[0.0, 0.0, 1.0], "normal of the wall");
        // The mirror shows the wall, tinted; its place is its own.
        assert_near(&at(&film, Aov::Albedo, [16, 25]), &[0.54, 0.08, 0.035], "albedo in the mirror");
        assert_near(&at(&film, Aov::Normal, [16, 25]), &[0.0, 0.0, 1.0], "normal in the mirror");
        assert_near(&at(&film, Aov::GeometricNormal, [16, 25]), &[0.0, 1.0, 0.0], "normal of the mirror");
        let position = at(&film, Aov::Position, [16, 25]);
        assert!((position[1] + 0.5).abs() < 1e-3, "place of the mirror: {position:?}");
        // The sky beside the wall.
        assert_eq!(at(&film, Aov::Depth, [0, 2]), [0.0], "depth of nothing");
        assert_eq!(at(&film, Aov::Albedo, [0, 2]), [0.0; 3], "albedo of nothing");
        let all: Vec<_> = features.iter().map(|&aov| film.channels(aov)).collect();
        assert_eq!(first.get_or_insert_with(|| all.clone()), &all, "{integrator}, {query}: to the bit");
    }
}

/// Surface parameters run from 0 to 1 along the edges of a rectangle.
#[test]
fn surface_parameters_are_those_of_the_first_surface() {
    let text = |render: &str, edges: &str| {
        format!(
            "[camera]\nfrom = [0.0, 0.0, 10.0]\nat = [0.0, 0.0, 0.0]\nvfov_deg = 11.421186\n\
             [film]\nwidth = 32\nheight = 32\nfilter = \"box\"\n[render]\n{render}\n\
             [materials.m]\ntype = \"mirror\"\n[[shapes]]\ntype = \"rectangle\"\nmaterial = \"m\"\n{edges}\n\
             [[lights]]\ntype = \"environment\"\nradiance = 1.0\n"
        )
    };
    // Of the whole picture, turned by a quarter, and of its left half.
    let edges = [
        ("edge_u = [1.0, 0.0, 0.0]\nedge_v = [0.0, 1.0, 0.0]", 32),
        ("edge_u = [0.0, 1.0, 0.0]\nedge_v = [-1.0, 0.0, 0.0]", 32),
        ("center = [-0.5, 0.0, 0.0]\nedge_u = [0.5, 0.0, 0.0]\nedge_v = [0.0, 1.0, 0.0]", 16),
    ];
    for (integrator, query) in
        [("path", "stream"), ("path", "single"), ("whitted", "stream"), ("view", "single")]
    {
        for (i, (edges, width)) in edges.into_iter().enumerate() {
            let render = format!("integrator = \"{integrator}\"\nquery = \"{query}\"\nspp = 16");
            let film = film(&text(&render, edges), &[Aov::Uv]);
            for (x, y) in [(0, 0), (3, 9), (15, 16), (31, 31), (20, 5)] {
                let [right, up] = [(x as f32 + 0.5) / 32.0, 1.0 - (y as f32 + 0.5) / 32.0];
                let expected = match i {
                    0 => [right, up],
                    1 => [up, 1.0 - right],
                    _ if x < width => [2.0 * right, up],
                    _ => [0.0; 2],
                };
                let found = at(&film, Aov::Uv, [x, y]);
                // Sixteen stratified samples of a pixel have their mean within a quarter of its width.
                let near = found
                    .iter()
                    .zip(expected)
                    .all(|(found, expected)| (found - expected).abs() < 0.25 / 16.0);
                assert!(near, "{integrator}, {query}, {edges}: {found:?} for {expected:?} at {x}, {y}");
            }
        }
    }
}

#[test]
fn a_pixel_on_an_edge_has_the_mean_place_of_what_it_hits() {
    let text = still("integrator = \"whitted\"\nspp = 64");
    let film = film(&text, &[Aov::Depth, Aov::Position]);
    let (alpha, depth) = (film.channels(Aov::Alpha).expect("kept"), film.channels(Aov::Depth).expect("kept"));
    let partly: Vec<_> = (0..32 * 32).filter(|&i| alpha[0][i] > 0.1 && alpha[0][i] < 0.9).collect();
    assert!(!partly.is_empty(), "there are such pixels");
    for i in partly {
        assert!(
            depth[0][i] > 5.9 && depth[0][i] < 12.0,
            "the wall, not a mixture with nothing: {}",
            depth[0][i]
        );
    }
}

#[test]
fn variance_is_that_of_the_pixel() {
    // Many pictures with other seeds: how far the pixel strays, beside what each picture says of it.
    const RUNS: u32 = 200;
    for filter in ["box", "mitchell"] {
        let text = |seed: u32| {
            let settings =
                format!("integrator = \"path\"\nsampler = \"independent\"\nspp = 16\nseed = {seed}");
            still(&settings).replace("\"box\"", &format!("\"{filter}\"")).replace("= 32", "= 8")
        };
        let films: Vec<Film> = (0..RUNS).map(|seed| film(&text(seed), &[Aov::Variance])).collect();
        let runs = f64::from(RUNS);
        let (mut told, mut true_sum) = (0.0, 0.0);
        for pixel in 0..64 {
            let value = |film: &Film| f64::from(film.channels(Aov::Beauty).expect("kept")[0][pixel]);
            let mean = films.iter().map(value).sum::<f64>() / runs;
            true_sum += films.iter().map(|film| (value(film) - mean).powi(2)).sum::<f64>() / (runs - 1.0);
            let says = |film: &Film| f64::from(film.channels(Aov::Variance).expect("kept")[0][pixel]);
            told += films.iter().map(says).sum::<f64>() / runs;
        }
        println!("{filter}: told {told:.4e}, true {true_sum:.4e}");
        assert!(true_sum > 0.0 && (told / true_sum - 1.0).abs() < 0.1, "{filter}: {told} for {true_sum}");
    }
}

#[test]
fn samples_are_counted_and_light_shines_white_at_most() {
    let film = film(&still("integrator = \"path\"\nspp = 7"), &[Aov::Samples, Aov::Variance]);
    assert_eq!(at(&film, Aov::Samples, [3, 5]), [7.0], "samples");
    assert!(film.channels(Aov::Albedo).is_none(), "what is not asked for is not kept");
}

#[test]
fn the_command_line_asks_for_outputs_by_name() {
    let desk = Desk::new();
    std::fs::write(desk.path("a.toml"), still("spp = 2")).expect("a scene");
    let (status, _, said) =
        desk.run(&["render", "a.toml", "-q", "-o", "a.exr", "--aov", "depth,albedo,variance"]);
    assert_eq!(status, 0, "{said}");
    let bytes = std::fs::read(desk.path("a.exr")).expect("written");
    for name in ["Z", "albedo.R", "albedo.G", "variance.B"] {
        let named = bytes.windows(name.len() + 1).any(|w| w == [name.as_bytes(), b"\0"].concat());
        assert!(named, "a channel {name}");
    }
    let picture = image::read(&desk.path("a.exr")).expect("readable");
    assert_eq!(picture.full, [32, 32], "size");
    let (status, _, said) = desk.run(&["render", "a.toml", "-o", "b.exr", "--aov", "depht"]);
    assert!(status == 2 && said.contains("depht") && said.contains("depth"), "{status}: {said}");
    assert!(!desk.path("b.exr").exists(), "nothing was written");
}

/// The channels of an output as bits.
fn bits(film: &Film, aov: Aov) -> Vec<Vec<u32>> {
    let channels = film.channels(aov).expect("kept");
    channels.iter().map(|values| values.iter().map(|value| value.to_bits()).collect()).collect()
}

fn mean(film: &Film, aov: Aov) -> f64 {
    let channels = film.channels(aov).expect("kept");
    channels.iter().flatten().map(|&value| f64::from(value)).sum::<f64>() / (3.0 * 1024.0)
}

#[test]
fn direct_and_indirect_light_make_the_picture() {
    let outputs = [Aov::Direct, Aov::Indirect];
    for (integrator, query) in [
        ("path", "stream"),
        ("path", "single"),
        ("path", "packet"),
        ("whitted", "stream"),
        ("distribution", "single"),
    ] {
        let settings = |depth: u32| {
            format!("integrator = \"{integrator}\"\nquery = \"{query}\"\nmax_depth = {depth}\nspp = 16")
        };
        let name = format!("{integrator}, {query}");
        let deep = film(&still(&settings(6)), &outputs);
        let plain = film(&still(&settings(6)), &[]);
        assert_eq!(bits(&deep, Aov::Beauty), bits(&plain, Aov::Beauty), "{name}: nothing else changes");
        let parts = [Aov::Beauty, Aov::Direct, Aov::Indirect].map(|aov| deep.channels(aov).expect("kept"));
        for (channel, sums) in parts[0].iter().enumerate() {
            for (pixel, &sum) in sums.iter().enumerate() {
                let (direct, indirect) = (parts[1][channel][pixel], parts[2][channel][pixel]);
                let error = (direct + indirect - sum).abs();
                assert!(error <= 1e-5 * (sum + direct), "{name}, {pixel}: {direct} + {indirect} = {sum}");
            }
        }
        // What comes by two edges does not depend on longer ways.
        let shorter = film(&still(&settings(3)), &outputs);
        assert_eq!(bits(&deep, Aov::Direct), bits(&shorter, Aov::Direct), "{name}: direct");
        assert!(
            mean(&deep, Aov::Indirect) > 0.02 * mean(&deep, Aov::Beauty),
            "{name}: the mirror shows the wall"
        );
        // It is what a picture of two edges shows: the same samples in a tree; paths take the last edge by another way.
        let direct = film(&still(&settings(2)), &outputs);
        assert!(mean(&direct, Aov::Indirect).abs() < 1e-12, "{name}: none by two edges");
        assert_eq!(bits(&direct, Aov::Direct), bits(&direct, Aov::Beauty), "{name}: all by two edges");
        if integrator == "path" {
            let [a, b] = [&deep, &direct].map(|film| mean(film, Aov::Direct));
            assert!((a / b - 1.0).abs() < 0.02, "{name}: {a} for {b}");
        } else {
            assert_eq!(bits(&deep, Aov::Direct), bits(&direct, Aov::Beauty), "{name}: two edges");
        }
    }
}

const IDS: [Aov; 4] = [Aov::ObjectId, Aov::MaterialId, Aov::CryptoObject, Aov::CryptoMaterial];

/// The same still, its ball with a name, and a second one of the same material behind glass.
fn named(filter: &str, render: &str) -> String {
    let text = still(render).replace("filter = \"box\"", &format!("filter = \"{filter}\""));
    let ball = "type = \"sphere\"\n        center = [0.0, 1.0, 0.0]";
    assert!(text.contains(ball), "the ball");
    text.replace(ball, &format!("name = \"ball\"\n        {ball}"))
}

#[test]
fn numbers_of_things_are_of_the_nearest() {
    let film = film(&named("box", "integrator = \"path\"\nspp = 16"), &IDS);
    let names = film.names();
    assert_eq!(names.objects, ["ball", "shape_1", "shape_2", "light_0"], "objects");
    assert_eq!(names.materials[..3], ["white", "red", "mirror"], "materials");
    assert_eq!(at(&film, Aov::ObjectId, [16, 16]), [1.0], "the ball");
    assert_eq!(at(&film, Aov::MaterialId, [16, 16]), [1.0], "white");
    assert_eq!(at(&film, Aov::ObjectId, [16, 25]), [3.0], "the mirror, not what it shows");
    assert_eq!(at(&film, Aov::ObjectId, [0, 2]), [0.0], "nothing");
    // Where the ball's edge is before the wall, its number wins, however little it covers.
    let mattes = film.channels(Aov::CryptoObject).expect("kept");
    let ids = film.channels(Aov::ObjectId).expect("kept").remove(0);
    let ball = specula::film::cryptomatte::hash("ball");
    let covers = |pixel: usize| (0..6).any(|rank| mattes[2 * rank][pixel].to_bits() == ball.to_bits());
    for (pixel, id) in ids.iter().enumerate() {
        assert_eq!(id.to_bits() == 1.0_f32.to_bits(), covers(pixel), "pixel {pixel}");
    }
}

#[test]
fn mattes_cut_out_what_alone_has_that_coverage() {
    for filter in ["box", "mitchell"] {
        for (integrator, query) in [("path", "stream"), ("whitted", "single")] {
            let settings = format!("integrator = \"{integrator}\"\nquery = \"{query}\"\nspp = 48");
            let film = film(&named(filter, &settings), &IDS);
            let alone = named(filter, &settings);
            let (head, rest) = alone.split_once("[[shapes]]").expect("shapes");
            let (ball, _) = rest.split_once("[[shapes]]").expect("more shapes");
            let alone = self::film(&format!("{head}[[shapes]]{ball}"), &[]);
            let alpha = alone.channels(Aov::Alpha).expect("kept").remove(0);
            let whole = film.channels(Aov::Alpha).expect("kept").remove(0);
            for (layer, name) in [(Aov::CryptoObject, "ball"), (Aov::CryptoMaterial, "white")] {
                let mattes = film.channels(layer).expect("kept");
                let hash = specula::film::cryptomatte::hash(name).to_bits();
                for pixel in 0..1024 {
                    let ranks: Vec<_> =
                        (0..6).map(|i| (mattes[2 * i][pixel], mattes[2 * i + 1][pixel])).collect();
                    let matte: f32 =
                        ranks.iter().filter(|(id, _)| id.to_bits() == hash).map(|(_, part)| part).sum();
                    let sum: f32 = ranks.iter().map(|(_, part)| part).sum();
                    assert!(ranks.is_sorted_by(|a, b| a.1 >= b.1), "{filter}: {ranks:?}");
                    // What a negative part of a filter makes of an edge is cut, which the others pay for.
                    let tolerance = if filter == "box" { 1e-5 } else { 0.06 };
                    assert!(
                        (matte - alpha[pixel]).abs() <= tolerance,
                        "{filter}, {pixel}: {matte} for {}",
                        alpha[pixel]
                    );
                    assert!((sum - whole[pixel]).abs() <= tolerance, "{filter}, {pixel}: {sum} in all");
                    assert!(
                        whole[pixel] < 1.0 || (sum - 1.0).abs() < 1e-5,
                        "{filter}, {pixel}: {sum}, covered"
                    );
                }
            }
        }
    }
}

#[test]
fn files_have_mattes_as_floats_and_say_which_name_is_which() {
    let desk = Desk::new();
    std::fs::write(desk.path("a.toml"), named("mitchell", "spp = 4")).expect("a scene");
    let words = ["render", "a.toml", "-q", "--half", "-o", "a.exr", "--aov", "cryptomatte,object_id,direct"];
    let (status, _, said) = desk.run(&words);
    assert_eq!(status, 0, "{said}");
    let picture = exr::read(&desk.path("a.exr")).expect("readable");
    for name in ["CryptoObject00.R", "CryptoObject02.A", "CryptoMaterial01.B"] {
        assert!(matches!(picture.channel(name), Some(exr::Samples::Float(_))), "{name}");
    }
    assert!(matches!(picture.channel("object_id"), Some(exr::Samples::Uint(_))), "numbers");
    assert!(matches!(picture.channel("direct.G"), Some(exr::Samples::Half(_))), "light");
    let entry = |end: &str, with: &str| {
        let found = picture.attributes.iter().find(|(key, value)| key.ends_with(end) && value.contains(with));
        found.map(|(_, value)| value.clone()).expect("metadata")
    };
    assert_eq!(entry("/name", "Object"), "CryptoObject", "layer");
    let hash = format!("\"ball\":\"{:08x}\"", specula::film::cryptomatte::hash("ball").to_bits());
    assert!(entry("/manifest", "ball").contains(&hash), "{hash}");
    assert_eq!(entry("object_id", ""), r#"["ball","shape_1","shape_2","light_0"]"#, "names of numbers");
}

/// A pane of polished glass before a red wall, seen straight on.
const PANE: &str = r#"
    [camera]
    from = [0.0, 0.0, 4.0]
    at = [0.0, 0.0, 0.0]
    vfov_deg = 20.0
    [film]
    width = 32
    height = 32
    filter = "box"
    [render]
    integrator = "path"
    spp = 1
    [materials.glass]
    type = "dielectric"
    [materials.red]
    type = "diffuse"
    reflectance = [0.6, 0.1, 0.05]
    [[shapes]]
    type = "box"
    min = [-3.0, -3.0, 0.0]
    max = [3.0, 3.0, 0.1]
    transform = [{ rotate_deg = 20.0, axis = [0, 1, 0] }]
    material = "glass"
    [[shapes]]
    type = "rectangle"
    center = [0.0, 0.0, -2.0]
    edge_u = [9.0, 0.0, 0.0]
    edge_v = [0.0, 9.0, 0.0]
    material = "red"
"#;

#[test]
fn polished_surfaces_are_followed_unless_the_film_says_otherwise() {
    let features = [Aov::Albedo, Aov::Normal, Aov::Depth, Aov::MaterialId];
    let through = film(PANE, &features);
    let middle = [16, 16];
    // Two surfaces that pass 96 % each.
    let albedo = at(&through, Aov::Albedo, middle);
    assert!((0.50..0.58).contains(&albedo[0]) && albedo[1] < 0.1, "the wall behind the pane: {albedo:?}");
    assert_near(&at(&through, Aov::Normal, middle), &[0.0, 0.0, 1.0], "of the wall");
    let depth = at(&through, Aov::Depth, middle);
    assert!((3.8..4.0).contains(&depth[0]), "of the pane: {depth:?}");
    let first = film(&PANE.replace("[film]", "[film]\n    follow_polished = false"), &features);
    let normal = at(&first, Aov::Normal, middle);
    let turned = 20.0_f32.to_radians();
    assert_near(&normal, &[turned.sin(), 0.0, turned.cos()], "of the pane");
    assert_near(&at(&first, Aov::Albedo, middle), &[1.0; 3], "glass keeps nothing");
    for aov in [Aov::Depth, Aov::MaterialId, Aov::Beauty] {
        assert_eq!(bits(&first, aov), bits(&through, aov), "{aov:?}: nothing else changes");
    }
    let mirror = still("integrator = \"whitted\"").replace("[film]", "[film]\n    follow_polished = false");
    let mirror = film(&mirror, &features);
    assert_near(&at(&mirror, Aov::Normal, [16, 25]), &[0.0, 1.0, 0.0], "of the mirror itself");
    assert_near(&at(&mirror, Aov::Albedo, [16, 25]), &[0.9, 0.8, 0.7], "what it sends back");
}
