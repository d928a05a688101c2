//! The two-pass filter: what it is exactly right about, what it must never do, and what making it quick costs.

#[path = "support/first_passes.rs"]
#[expect(dead_code, reason = "the bench uses the rest")]
mod first_passes;
#[path = "support/scene.rs"]
mod support;

use first_passes::{facing, odd};
use specula::film::{Aov, Layout};
use specula::image::Window;
use specula::math::lanes::Level;
use specula::post::{
    Correction, Filtered, Fuzzy, GBuffer, Radius, Rejection, Shape, Speed, Weighting, filter,
};
use specula::render::{Rendered, Settings, Silent, render};
use std::num::NonZeroUsize;
use support::scene_of;

/// Of all of the lobe, as it is.
const WHOLE: Fuzzy = Fuzzy {
    weighting: Weighting::Phong,
    lost_mass: 1e-6,
    max_angle: 1.5,
    max_radius: 1e4,
    radius: Radius::Cone,
    shape: Shape::Round,
    correction: Correction::None,
    speed: Speed::PLAIN,
};

/// All ways to be quick, each by itself, and together.
fn ways() -> Vec<(&'static str, Speed)> {
    let plain = Speed::PLAIN;
    vec![
        ("plain", plain),
        ("by angle", Speed { rejection: Rejection::Angle, ..plain }),
        ("unskipped", Speed { skip: false, ..plain }),
        ("table", Speed { table: true, ..plain }),
        ("taps", Speed { taps: Some(200), ..plain }),
        ("pyramid", Speed { pyramid: Some(8.0), ..plain }),
        ("half", Speed { half: Some(8.0), ..plain }),
        ("all", Speed { table: true, taps: Some(300), pyramid: Some(8.0), half: Some(8.0), ..plain }),
    ]
}

fn filtered(g: &GBuffer, fuzzy: &Fuzzy) -> Filtered {
    filter(g, g.window, fuzzy, (Level::best(), 0))
}

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
fn of_lobe(p: f64, x: f64) -> f64 {
    beyond(x, 0.5 * (p + 2.0))
}

/// Exponent, distance of an edge, and what comes of it by the filter without correction and by the lobe: numbers of a quadrature in the plane.
const TABLE: [(f32, f64, f64, f64); 4] = [
    (20.0, 0.05, 0.417194, 0.410493),
    (20.0, 0.2, 0.203644, 0.184901),
    (100.0, 0.05, 0.310863, 0.308207),
    (100.0, 0.1, 0.162318, 0.158652),
];

/// A picture with its first pass.
fn rendered(text: &str, settings: Settings) -> Rendered {
    render(&scene_of(text), &settings, &Silent).expect("a picture")
}

/// A mirror that is looked at straight on from above, and above the eye, one metre from the mirror, a plane that shines from x = `edge` on; the
/// picture shows `size` pixels of `pitch` metres of that plane in both directions.
fn edge(render: &str, exponent: f32, (edge, pitch, size): (f64, f64, u32)) -> String {
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

/// Pixels from the middle one to the edge of a row of the table, and how many of them, an odd number, hold the lobe.
fn grid(p: f32, x0: f64) -> (f64, u32) {
    // Sixty pixels for the width of the lobe, and the edge between two of them.
    let sigma = 1.0 / (f64::from(p) + 1.0).sqrt();
    let pitch = x0 / ((60.0 * x0 / sigma).floor() + 0.5);
    let reach = if p < 50.0 { 1.7 } else { 0.6 };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hundred")]
    let half = ((reach + x0) / pitch) as u32 + 2;
    (pitch, 2 * half + 1)
}

#[test]
fn the_filter_is_the_lobe_of_three_less() {
    for (p, x0, by_area, by_lobe) in TABLE {
        assert!((of_lobe(f64::from(p), x0) - by_lobe).abs() < 1e-6, "the lobe of {p} at {x0}");
        assert!((of_lobe(f64::from(p) - 3.0, x0) - by_area).abs() < 1e-6, "that of three less");
        let (pitch, size) = grid(p, x0);
        let text = edge("glossy = \"two-pass\"\nspp = 1\nfuzzy.max_radius = 0", p, (x0, pitch, size));
        let first = rendered(&text, Settings { first_pass: true, ..Settings::default() }).first_pass;
        let middle = size / 2;
        let window = Window { x0: middle, y0: middle, x1: middle + 1, y1: middle + 1 };
        for (correction, wanted) in
            [(Correction::None, by_area), (Correction::Cosine, by_lobe), (Correction::SolidAngle, by_lobe)]
        {
            // The paper's radius is short of lobes as wide as these.
            let fuzzy = Fuzzy { correction, radius: Radius::Differential, ..WHOLE };
            let found = filter(&first[0], window, &fuzzy, (Level::best(), 0)).reflected[0][0];
            println!("p {p} x0 {x0} {correction:?}: {found:.6}, wanted {wanted:.6}");
            // Of the table's digits the last is lost: to pixels, which are off by the square of their part of the lobe where
            // the edge is between them.
            assert!(
                (f64::from(found) - wanted).abs() < 1e-5,
                "{p} {x0} {correction:?}: {found}, not {wanted}"
            );
        }
    }
}

#[test]
fn the_lobe_by_rays_agrees() {
    for (p, x0, by_area, _) in TABLE {
        let (pitch, size) = grid(p, x0);
        let middle = size / 2;
        let crop = Window { x0: middle, y0: middle, x1: middle + 1, y1: middle + 1 };
        let text = edge("spp = 65536\nsampler = \"independent\"", p - 3.0, (x0, pitch, size));
        let layout = Layout::with([Aov::Variance]);
        let film = rendered(&text, Settings { crop: Some(crop), layout, ..Settings::default() }).film;
        let of = |aov| f64::from(film.channels(aov).expect("kept")[0][0]);
        let (found, deviation) = (of(Aov::Beauty), of(Aov::Variance).sqrt());
        println!("p {} x0 {x0}: {found:.5} +- {deviation:.5}, the filter {by_area:.5}", p - 3.0);
        // Once in 4000 by chance for four rows.
        assert!((found - by_area).abs() < 4.0 * deviation, "{p} {x0}: {found} +- {deviation}, not {by_area}");
    }
}

#[test]
fn coarse_pixels_are_off_by_half_a_pixel_at_most() {
    // sigma is the width of the lobe in the plane, h that of a pixel.
    let p = 100.0_f32;
    let sigma = 1.0 / (f64::from(p) + 1.0).sqrt();
    for pixels in [1.0, 2.0, 5.0, 10.0, 20.0] {
        let h = sigma / pixels;
        let mut worst = 0.0_f64;
        for offset in 0..10_u8 {
            let x0 = 0.33 * sigma + h * f64::from(offset) / 10.0;
            #[expect(clippy::cast_possible_truncation, reason = "positions")]
            let light = |b: glam::Vec3| [f32::from(u8::from(b.x > x0 as f32)); 3];
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "sizes")]
            let (scale, size) = ((1.5 / h) as f32, 2 * ((0.7 / h) as u32) + 1);
            let g = facing(([size; 2], scale), (0.5, 1.0), p, light);
            let window = Window { x0: size / 2, y0: size / 2, x1: size / 2 + 1, y1: size / 2 + 1 };
            let fuzzy = Fuzzy { correction: Correction::Cosine, ..WHOLE };
            let found = filter(&g, window, &fuzzy, (Level::best(), 0)).reflected[0][0];
            worst = worst.max((f64::from(found) - of_lobe(f64::from(p), x0)).abs());
        }
        println!("sigma/h {pixels}: {worst:.4}, bound {:.4}", 0.2 / pixels);
        assert!(worst < 0.21 / pixels, "{pixels}: {worst}");
        assert!(
            worst > 0.02 / pixels,
            "{pixels}: {worst} is better than can be, so the edge is not where it should be"
        );
    }
}

#[test]
fn a_constant_picture_stays_constant() {
    let g = odd([64, 48], (0.7, 0.7));
    for (name, speed) in ways() {
        for radius in [Radius::Cone, Radius::Differential] {
            for correction in [Correction::None, Correction::Cosine, Correction::SolidAngle] {
                for shape in [Shape::Round, Shape::Rectangle] {
                    let fuzzy = Fuzzy { radius, correction, shape, speed, lost_mass: 0.01, ..WHOLE };
                    let found = filtered(&g, &fuzzy);
                    for (light, texel) in
                        found.reflected.iter().flatten().zip(g.texels.iter().flat_map(|t| [t; 3]))
                    {
                        let wanted = if texel.mirror.is_some() { 0.7 } else { 0.0 };
                        assert!((light - wanted).abs() < 2e-6, "{name} {fuzzy:?}: {light}, not {wanted}");
                    }
                }
            }
        }
    }
}

#[test]
fn numbers_never_bleed_and_all_stays_finite() {
    let g = odd([64, 48], (1.0, 1000.0));
    for (name, speed) in ways() {
        for weighting in [Weighting::Phong, Weighting::Shininess] {
            for correction in [Correction::None, Correction::SolidAngle] {
                let fuzzy = Fuzzy { weighting, correction, speed, lost_mass: 0.01, ..WHOLE };
                let found = filtered(&g, &fuzzy);
                for ((light, colour), texel) in found.reflected.iter().zip(&found.colour).zip(&g.texels) {
                    assert!(light.iter().chain(colour).all(|x| x.is_finite()), "{name}: {light:?}");
                    let Some(mirror) = &texel.mirror else { continue };
                    let wanted = if mirror.reflector == 1 { 1.0 } else { 1000.0 };
                    assert!((light[0] / wanted - 1.0).abs() < 3e-6, "{name}: {light:?}, not {wanted}");
                    let strength = if weighting == Weighting::Phong { 1.0 } else { mirror.strength };
                    assert!(
                        (colour[0] - strength * light[0]).abs() < 1e-3,
                        "{name}: strength {strength}, {colour:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn numbers_that_are_none_stay_where_they_are() {
    let mut g = facing(([33, 33], 60.0), (1.0, 2.0), 50.0, |_| [1.0; 3]);
    for (at, spoilt) in [(5, f32::NAN), (200, f32::INFINITY), (700, f32::NAN)] {
        let mirror = g.texels[at].mirror.as_mut().expect("a mirror");
        if at == 700 {
            mirror.a.x = spoilt;
            mirror.normal.y = spoilt;
            mirror.exponent = spoilt;
            mirror.s = spoilt;
        } else {
            mirror.radiance[1] = spoilt;
        }
    }
    for (name, speed) in ways() {
        let found = filtered(&g, &Fuzzy { correction: Correction::SolidAngle, speed, ..WHOLE });
        let bad = found
            .reflected
            .iter()
            .enumerate()
            .filter(|(_, light)| light.iter().any(|x| (x - 1.0).abs() > 1e-5));
        let bad: Vec<_> = bad.map(|(at, _)| at).collect();
        assert!(bad.iter().all(|at| [5, 200, 700].contains(at)), "{name}: {bad:?}");
    }
}

#[test]
fn widths_agree_to_rounding() {
    let light = |b: glam::Vec3| [(3.0 * b.x).sin() + 1.0, f32::from(u8::from(b.y > 0.1)), 1.0];
    let g = facing(([70, 50], 90.0), (0.7, 1.3), 120.0, light);
    for (name, speed) in ways() {
        let fuzzy =
            Fuzzy { correction: Correction::SolidAngle, radius: Radius::Differential, speed, ..WHOLE };
        let pictures: Vec<_> = Level::available()
            .into_iter()
            .map(|level| (level, filter(&g, g.window, &fuzzy, (level, 3))))
            .collect();
        for (level, picture) in &pictures[1..] {
            let both = picture.reflected.iter().flatten().zip(pictures[0].1.reflected.iter().flatten());
            let worst = both.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            // A tap on the rim of the lobe, or on the border of two pixels, may fall to either side.
            let bound = if speed.taps.is_some() { 3e-2 } else { 3e-5 };
            assert!(worst < bound, "{name} {level:?}: {worst}");
        }
    }
}

#[test]
fn both_radii_are_the_same_where_all_is_flat() {
    // The rectangle is only as wide as the window, so that both let all of the lobe in, or neither.
    let light = |b: glam::Vec3| [f32::from(u8::from(b.x > 0.05)); 3];
    let g = facing(([121, 121], 100.0), (1.0, 1.0), 200.0, light);
    let of = |radius| {
        let window = Window { x0: 40, y0: 40, x1: 80, y1: 80 };
        filter(&g, window, &Fuzzy { radius, lost_mass: 0.01, ..WHOLE }, (Level::best(), 0))
    };
    let (cone, ours) = (of(Radius::Cone), of(Radius::Differential));
    for (a, b) in cone.reflected.iter().flatten().zip(ours.reflected.iter().flatten()) {
        assert!((a - b).abs() < 2e-3, "{a} {b}");
    }
}

#[test]
fn a_part_of_a_picture_is_as_in_the_whole() {
    let g = odd([90, 64], (0.3, 0.9));
    let mut g = g;
    for (i, texel) in g.texels.iter_mut().enumerate() {
        if let Some(mirror) = &mut texel.mirror {
            mirror.radiance = [(i % 17) as f32, (i % 5) as f32, 1.0];
        }
    }
    for (name, speed) in ways() {
        let fuzzy = Fuzzy { correction: Correction::SolidAngle, speed, lost_mass: 0.01, ..WHOLE };
        let whole = filtered(&g, &fuzzy);
        let window = Window { x0: 21, y0: 13, x1: 57, y1: 40 };
        let part = filter(&g, window, &fuzzy, (Level::best(), 0));
        let rows = (13..40_usize).flat_map(|y| (21..57_usize).map(move |x| y * 90 + x));
        for (at, light) in rows.zip(&part.reflected) {
            assert_eq!(whole.reflected[at].map(f32::to_bits), light.map(f32::to_bits), "{name} at {at}");
        }
    }
}

/// Balls and a floor, small.
const DESK: &str = r#"
    [camera]
    from = [0, 0.8, 3]
    at = [0, 0.3, 0]
    vfov_deg = 40
    [film]
    width = 64
    height = 48
    [render]
    spp = 2
    max_depth = 4
    glossy = "two-pass"
    fuzzy.max_radius = 24
    [materials]
    floor = { type = "glossy", exponent = 200, reflectance = 0.6, diffuse = 0.1 }
    ball = { type = "glossy", exponent = 50, reflectance = [0.8, 0.6, 0.3] }
    wall = { type = "diffuse", reflectance = { checker = [0.8, 0.1], repeat = [12, 6] } }
    [[shapes]]
    type = "rectangle"
    edge_u = [4, 0, 0]
    edge_v = [0, 0, -4]
    material = "floor"
    [[shapes]]
    type = "rectangle"
    center = [0, 1, -2]
    edge_u = [4, 0, 0]
    edge_v = [0, 1, 0]
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
    radiance = 0.3
"#;

#[test]
fn pictures_do_not_depend_on_threads_or_crops() {
    for more in ["", "fuzzy.half = 4", "fuzzy.taps = 60", "fuzzy.pyramid = \"off\"", "fuzzy.pyramid = 3"] {
        let text = DESK.replace("[materials]", &format!("{more}\n[materials]"));
        let threads = |n| Settings { threads: NonZeroUsize::new(n), ..Settings::default() };
        let whole = rendered(&text, threads(1)).film;
        assert!(whole == rendered(&text, threads(3)).film, "threads, {more}");
        let crop = Window { x0: 37, y0: 9, x1: 60, y1: 31 };
        let part = rendered(&text, Settings { crop: Some(crop), ..Settings::default() }).film;
        let bits =
            |values: Vec<[f32; 3]>| -> Vec<_> { values.into_iter().map(|v| v.map(f32::to_bits)).collect() };
        assert_eq!(bits(whole.values(crop)), bits(part.values(crop)), "crop, {more}");
    }
}

#[test]
fn without_fuzzy_mirrors_it_is_the_tree() {
    let text = DESK
        .replace("\"glossy\"", "\"mirror\"")
        .replace(", exponent = 200", "")
        .replace(", exponent = 50", "");
    let text = text.replace(", diffuse = 0.1", "");
    // One place on the film for all pixels: without a filter both are in their middle.
    let text = text.replace("height = 48", "height = 48\nfilter = \"box\"\nfilter_radius = 1e-6");
    let two = rendered(&text, Settings::default()).film;
    let one = rendered(&text.replace("glossy = \"two-pass\"", ""), Settings::default()).film;
    let (two, one) = (two.values(two.window()), one.values(one.window()));
    let differ =
        two.iter().flatten().zip(one.iter().flatten()).filter(|(a, b)| (**a - **b).abs() > 1e-4).count();
    assert!(differ < 30, "{differ} numbers differ beyond edges");
}

#[test]
fn a_reflection_meets_what_it_touches() {
    // Where mirrored rays are short, what the filter makes of them is what they saw.
    let text = r#"
        [camera]
        from = [0, 0.6, 3]
        at = [0, 0.1, 0]
        vfov_deg = 20
        [film]
        width = 120
        height = 90
        filter = "box"
        [render]
        spp = 1
        max_depth = 3
        glossy = "two-pass"
        [materials]
        floor = { type = "glossy", exponent = 300, reflectance = 1 }
        box = { type = "diffuse", reflectance = { checker = [0.9, 0.1], repeat = [31, 31] } }
        [[shapes]]
        type = "rectangle"
        edge_u = [4, 0, 0]
        edge_v = [0, 0, -4]
        material = "floor"
        [[shapes]]
        type = "rectangle"
        center = [0, 0.3, 0]
        edge_u = [0.4, 0, 0]
        edge_v = [0, 0.3, 0]
        material = "box"
        [[lights]]
        type = "point"
        position = [1, 2, 2]
        intensity = 20
        [[lights]]
        type = "environment"
        radiance = 0.2
    "#;
    let first = rendered(text, Settings { first_pass: true, ..Settings::default() }).first_pass;
    let fuzzy =
        Fuzzy { radius: Radius::Differential, correction: Correction::SolidAngle, lost_mass: 0.01, ..WHOLE };
    let mut near = 0;
    for speed in [Speed::PLAIN, Speed::default()] {
        let found = filtered(&first[0], &Fuzzy { speed, ..fuzzy });
        for (texel, light) in first[0].texels.iter().zip(&found.reflected) {
            let Some(mirror) = texel.mirror.filter(|mirror| mirror.length() < 0.004) else { continue };
            near += 1;
            for (a, b) in light.iter().zip(mirror.radiance) {
                assert!((a - b).abs() < 1e-6, "{light:?} at {:?}", mirror.a);
            }
        }
    }
    assert!(near > 40, "only {near} pixels near the contact");
}

/// The mean over pixels of (a - b)^2 / (b^2 + 0.01).
fn relative_error(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let terms = a.iter().flatten().zip(b.iter().flatten()).map(|(&a, &b)| {
        let (a, b) = (f64::from(a), f64::from(b));
        (a - b).powi(2) / (b * b + 0.01)
    });
    terms.sum::<f64>() / (3 * a.len()) as f64
}

#[test]
fn being_quick_costs_little() {
    // A checkered plane under windows of 64 pixels.
    let fields = |x: f32| (x * 4.0).rem_euclid(2.0) < 1.0;
    let light = |b: glam::Vec3| [if fields(b.x) == fields(b.y + 0.13) { 1.0 } else { 0.1 }, 0.5, b.x.abs()];
    let lobe = specula::post::Lobe::new(300.0, 0.01, 1.5);
    let scale = 64.0 / (lobe.angle() * 0.5).tan();
    let g = facing(([200, 160], scale), (1.0, 1.0), 300.0, light);
    let fuzzy = Fuzzy { lost_mass: 0.01, correction: Correction::SolidAngle, ..WHOLE };
    let plain = filtered(&g, &fuzzy);
    let bounds = [
        ("by angle", 1e-8),
        ("unskipped", 1e-20),
        ("table", 1e-8),
        ("taps", 2e-2),
        ("pyramid", 1e-4),
        ("half", 1e-4),
    ];
    for (name, speed) in ways() {
        let error = relative_error(&filtered(&g, &Fuzzy { speed, ..fuzzy }).reflected, &plain.reflected);
        println!("{name}: {error:.3e}");
        if let Some((_, bound)) = bounds.iter().find(|(of, _)| *of == name) {
            assert!(error < *bound, "{name}: {error} of {bound}");
        }
    }
    let sharp = g.texels.iter().map(|texel| texel.mirror.expect("a mirror").radiance).collect::<Vec<_>>();
    assert!(relative_error(&sharp, &plain.reflected) > 0.1, "nothing was blurred");
}
