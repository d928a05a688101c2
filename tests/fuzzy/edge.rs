//! Scenes with fuzzy mirrors: an edge, and what a lobe makes of it; a ball on a floor.

use crate::scene::rendered;
use specula::film::{Aov, Layout};
use specula::image::Window;
use specula::render::Settings;

/// The integral of (1 + x^2)^-k from `from` on over that of all x, by Simpson's rule in the angle whose tangent is x.
fn beyond(from: f64, k: f64) -> f64 {
    let integral = |low: f64, high: f64| {
        const STEPS: u32 = 4000;
        let h = (high - low) / f64::from(STEPS);
        let f = |i: u32| {
            // dx = dJ / cos^2 J, and 1 + x^2 = 1 / cos^2 J.
            let weight = if i == 0 || i == STEPS {
                1.0
            } else if i % 2 == 1 {
                4.0
            } else {
                2.0
            };
            weight * (low + f64::from(i) * h).cos().max(0.0).powf(2.0 * k - 2.0)
        };
        (0..=STEPS).map(f).sum::<f64>() * h / 3.0
    };
    let right = std::f64::consts::FRAC_PI_2;
    integral(from.atan(), right) / integral(-right, right)
}

/// What a lobe of exponent p sends of the half plane beyond x, in a plane straight ahead at unit distance: along y the integral of
/// cos^(p + 3) is (1 + x^2)^-(p + 2)/2 times a number.
pub(crate) fn of_lobe(p: f64, x: f64) -> f64 {
    beyond(x, 0.5 * (p + 2.0))
}

/// A mirror that is looked at straight on from above, half a metre away; the picture is a square of `size` pixels.
pub(crate) fn mirror(render: &str, exponent: f32, vfov_deg: f64, size: u32) -> String {
    format!(
        r#"
        [camera]
        from = [0, 0, 0.5]
        at = [0, 0, 0]
        vfov_deg = {vfov_deg}
        [film]
        width = {size}
        height = {size}
        filter = "box"
        filter_radius = 1e-4
        [render]
        max_depth = 3
        {render}
        [materials.mirror]
        type = "glossy"
        exponent = {exponent}
        reflectance = 1
        [[shapes]]
        type = "rectangle"
        edge_u = [20, 0, 0]
        edge_v = [0, 20, 0]
        material = "mirror"
        "#
    )
}

/// That mirror, and above the eye, one metre from the mirror, a plane that shines from x = `edge` on; the picture shows `size` pixels of
/// `pitch` metres of that plane in both directions.
pub(crate) fn edge(render: &str, exponent: f32, (edge, pitch, size): (f64, f64, u32)) -> String {
    let vfov_deg = 2.0 * (0.5 * f64::from(size) * pitch / 1.5).atan().to_degrees();
    let plane = |x: f64, material: &str| {
        format!(
            "[[shapes]]\ntype = \"rectangle\"\ncenter = [{x}, 0, 1]\nedge_u = [20, 0, 0]\nedge_v = [0, 20, 0]\nmaterial = \"{material}\"\n"
        )
    };
    let materials = "[materials.shine]\ntype = \"emission\"\nradiance = 1\ntwo_sided = true\n\
                     [materials.black]\ntype = \"diffuse\"\nreflectance = 0\n";
    let planes = plane(edge + 20.0, "shine") + &plane(edge - 20.0, "black");
    mirror(render, exponent, vfov_deg, size) + materials + &planes
}

/// The middle pixel of such a picture by 65 536 independent rays: the mean, and its standard deviation.
pub(crate) fn by_rays(render: &str, exponent: f32, (edge_at, pitch, size): (f64, f64, u32)) -> (f64, f64) {
    let render = format!("spp = 65536\nsampler = \"independent\"\n{render}");
    let text = edge(&render, exponent, (edge_at, pitch, size));
    let middle = size / 2;
    let crop = Some(Window { x0: middle, y0: middle, x1: middle + 1, y1: middle + 1 });
    let layout = Layout::with([Aov::Variance]);
    let film = rendered(&text, &Settings { crop, layout, ..Settings::default() }).film;
    let of = |aov| f64::from(film.channels(aov).expect("kept")[0][0]);
    (of(Aov::Beauty), of(Aov::Variance).sqrt())
}

/// A ball on a floor, with and without diffuse light of their own; a wall that ends, so that rays escape; lights of all kinds.
pub(crate) fn ball_on_floor(render: &str) -> String {
    format!(
        r#"
        [camera]
        from = [0, 0.8, 3]
        at = [0, 0.3, 0]
        vfov_deg = 40
        [film]
        width = 60
        height = 44
        filter = "mitchell"
        [render]
        spp = 3
        max_depth = 4
        {render}
        [materials]
        floor = {{ type = "glossy", exponent = 200, reflectance = 0.6, diffuse = 0.1 }}
        ball = {{ type = "phong", exponent = 60, reflectance = [0.8, 0.6, 0.3] }}
        wall = {{ type = "diffuse", reflectance = {{ checker = [0.8, 0.1], repeat = [12, 6] }} }}
        [[shapes]]
        type = "rectangle"
        edge_u = [4, 0, 0]
        edge_v = [0, 0, -4]
        material = "floor"
        [[shapes]]
        type = "rectangle"
        center = [0, 0.5, -2]
        edge_u = [1, 0, 0]
        edge_v = [0, 0.5, 0]
        material = "wall"
        [[shapes]]
        type = "sphere"
        center = [0.2, 0.4, 0]
        radius = 0.4
        material = "ball"
        [[lights]]
        type = "rectangle"
        center = [0, 2.5, 2]
        edge_u = [0.5, 0, 0]
        edge_v = [0, 0, 0.5]
        radiance = 8
        [[lights]]
        type = "environment"
        radiance = 0.6
        [[lights]]
        type = "point"
        position = [1, 2, 2]
        intensity = 9
        "#
    )
}
