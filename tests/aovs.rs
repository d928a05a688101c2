//! Outputs besides the picture: what camera rays see, and how far the picture is to be trusted.

#[path = "support/desk.rs"]
mod desk;
#[path = "support/scene.rs"]
mod scene;

use desk::Desk;
use scene::scene_of;
use specula::film::{Aov, Film, Layout};
use specula::image;
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
