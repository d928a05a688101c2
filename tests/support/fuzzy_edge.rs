//! An edge in a fuzzy mirror, and what a lobe makes of it.

use crate::support::scene_of;
use specula::render::{Rendered, Settings, Silent, render};

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

/// A picture with its first pass.
pub(crate) fn rendered(text: &str, settings: Settings) -> Rendered {
    render(&scene_of(text), &settings, &Silent).expect("a picture")
}

/// A mirror that is looked at straight on from above, and above the eye, one metre from the mirror, a plane that shines from x = `edge` on; the
/// picture shows `size` pixels of `pitch` metres of that plane in both directions.
pub(crate) fn edge(render: &str, exponent: f32, (edge, pitch, size): (f64, f64, u32)) -> String {
    let vfov = 2.0 * (0.5 * f64::from(size) * pitch / 1.5).atan().to_degrees();
    format!(
        r#"
        [camera]
        from = [0, 0, 0.5]
        at = [0, 0, 0]
        vfov_deg = {vfov}
        [film]
        width = {size}
        height = {size}
        filter = "box"
        filter_radius = 1e-4
        [render]
        max_depth = 3
        {render}
        [materials]
        mirror = {{ type = "glossy", exponent = {exponent}, reflectance = 1 }}
        shine = {{ type = "emission", radiance = 1, two_sided = true }}
        black = {{ type = "diffuse", reflectance = 0 }}
        [[shapes]]
        type = "rectangle"
        edge_u = [20, 0, 0]
        edge_v = [0, 20, 0]
        material = "mirror"
        [[shapes]]
        type = "rectangle"
        center = [{bright}, 0, 1]
        edge_u = [20, 0, 0]
        edge_v = [0, 20, 0]
        material = "shine"
        [[shapes]]
        type = "rectangle"
        center = [{dark}, 0, 1]
        edge_u = [20, 0, 0]
        edge_v = [0, 20, 0]
        material = "black"
        "#,
        bright = edge + 20.0,
        dark = edge - 20.0,
    )
}
