//! The two-pass filter: what it is exactly right about, what it must never do, and what making it quick costs.

use crate::edge::{ball_on_floor, by_rays, edge, of_lobe};
use crate::first_passes::{facing, odd};
use crate::scene::rendered;
use glam::Vec3;
use specula::image::Window;
use specula::math::lanes::Level;
use specula::post::{
    Correction, End, Filtered, Fuzzy, GBuffer, Lobe, Radius, Rejection, Shape, Speed, Weighting, filter,
    margin,
};
use specula::render::Settings;
use std::num::NonZeroUsize;

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

/// Exponent, distance of an edge, and what comes of it by the filter without correction and by the lobe: numbers of a quadrature in the plane.
const TABLE: [(f32, f64, f64, f64); 4] = [
    (20.0, 0.05, 0.417194, 0.410493),
    (20.0, 0.2, 0.203644, 0.184901),
    (100.0, 0.05, 0.310863, 0.308207),
    (100.0, 0.1, 0.162318, 0.158652),
];

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
        let first = rendered(&text, &Settings { first_pass: true, ..Settings::default() }).first_pass;
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
        let (found, deviation) = by_rays("", p - 3.0, (x0, pitch, size));
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
            let light = |b: Vec3| [f32::from(u8::from(b.x > x0 as f32)); 3];
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
    let light = |b: Vec3| [(3.0 * b.x).sin() + 1.0, f32::from(u8::from(b.y > 0.1)), 1.0];
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
    let light = |b: Vec3| [f32::from(u8::from(b.x > 0.05)); 3];
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

#[test]
fn a_part_with_one_of_several_lobes_is_as_in_the_whole() {
    // One reflector, of exponent 50 to the left and 300 to the right; its normals tremble by 23 degrees from column to column, which the one
    // lobe mixes and the other does not. Windows of both are looked at in smaller pictures.
    let mut g = facing(([120, 60], 200.0), (1.0, 2.0), 50.0, |_| [0.0; 3]);
    for (i, texel) in (0_u16..).zip(&mut g.texels) {
        let Some(mirror) = &mut texel.mirror else { continue };
        let column = i % 120;
        mirror.exponent = if column < 60 { 50.0 } else { 300.0 };
        mirror.normal = Vec3::new(if column % 2 == 0 { 0.2 } else { -0.2 }, 0.0, 0.98_f32.sqrt());
        mirror.normal = mirror.normal.normalize();
        mirror.radiance = [f32::from(i % 17), f32::from(i % 5), 1.0];
    }
    let window = Window { x0: 5, y0: 13, x1: 37, y1: 40 };
    for (name, speed) in ways() {
        let fuzzy = Fuzzy { correction: Correction::SolidAngle, speed, lost_mass: 0.01, ..WHOLE };
        let whole = filtered(&g, &fuzzy);
        let part = filter(&g, window, &fuzzy, (Level::best(), 0));
        let places = (13..40_usize).flat_map(|y| (5..37_usize).map(move |x| y * 120 + x));
        for (at, light) in places.zip(&part.reflected) {
            assert_eq!(whole.reflected[at].map(f32::to_bits), light.map(f32::to_bits), "{name} at {at}");
        }
    }
}

/// A part of a picture, without the rest.
fn cut(g: &GBuffer, window: Window) -> GBuffer {
    let places = (window.y0..window.y1).flat_map(|y| (window.x0..window.x1).map(move |x| (x, y)));
    GBuffer { window, texels: places.filter_map(|(x, y)| g.texel(x, y).copied()).collect(), ..*g }
}

#[test]
fn nothing_beyond_the_margin_is_read() {
    // Windows end far within the lobe, so that all of them counts to their ends.
    let g = facing(([400, 48], 300.0), (1.0, 1.0), 5.0, |b| [(40.0 * b.x).sin() + 1.0, b.y + 2.0, 1.0]);
    let all = Window { x0: 159, y0: 15, x1: 225, y1: 18 };
    let is_as_in_the_whole = |fuzzy: &Fuzzy, margin: u32| {
        let whole = filter(&g, all, fuzzy, (Level::best(), 0)).reflected;
        // Texels of 32 pixels begin with these pixels, or end before them.
        [159, 160, 177, 191, 192, 223, 224_u32].into_iter().all(|x| {
            let window = Window { x0: x, x1: x + 1, ..all };
            let around = Window { x0: x - margin, y0: 0, x1: x + 1 + margin, y1: 48 };
            let part = filter(&cut(&g, around), window, fuzzy, (Level::best(), 0)).reflected;
            let column = whole.iter().skip((x - all.x0) as usize).step_by(all.width() as usize);
            column.zip(&part).all(|(a, b)| a.map(f32::to_bits) == b.map(f32::to_bits))
        })
    };
    for pyramid in [None, Some(2.0), Some(3.0), Some(8.0)] {
        for (taps, half) in [(None, None), (Some(20), None), (None, Some(4.0)), (Some(300), Some(4.0))] {
            for max_radius in [7.5, 24.0, 96.0] {
                let speed = Speed { pyramid, taps, half, ..Speed::PLAIN };
                let correction = Correction::SolidAngle;
                let fuzzy = Fuzzy { max_radius, speed, correction, lost_mass: 0.01, ..WHOLE };
                assert!(is_as_in_the_whole(&fuzzy, margin(&fuzzy)), "{max_radius} {speed:?}");
            }
        }
    }
    // A third of the radius is needed there, a quarter is not enough.
    let speed = Speed { pyramid: Some(3.0), ..Speed::PLAIN };
    let fuzzy = Fuzzy { max_radius: 96.0, speed, lost_mass: 0.01, ..WHOLE };
    assert!(
        !is_as_in_the_whole(&fuzzy, 96 + 24 + 4),
        "windows do not reach as far as this test takes them to"
    );
}

#[test]
fn pictures_do_not_depend_on_threads_or_crops() {
    for more in ["", "fuzzy.half = 4", "fuzzy.taps = 60", "fuzzy.pyramid = \"off\"", "fuzzy.pyramid = 3"] {
        let text = ball_on_floor(&format!("glossy = \"two-pass\"\nfuzzy.max_radius = 24\n{more}"));
        let threads = |n| Settings { threads: NonZeroUsize::new(n), ..Settings::default() };
        let whole = rendered(&text, &threads(1)).film;
        assert!(whole == rendered(&text, &threads(3)).film, "threads, {more}");
        let crop = Window { x0: 37, y0: 9, x1: 60, y1: 31 };
        let part = rendered(&text, &Settings { crop: Some(crop), ..Settings::default() }).film;
        let bits =
            |values: Vec<[f32; 3]>| -> Vec<_> { values.into_iter().map(|v| v.map(f32::to_bits)).collect() };
        assert_eq!(bits(whole.values(crop)), bits(part.values(crop)), "crop, {more}");
    }
}

#[test]
fn without_fuzzy_mirrors_it_is_the_tree() {
    // One place on the film for all pixels: without a filter both are in their middle.
    let text = ball_on_floor("glossy = \"two-pass\"\nfuzzy.max_radius = 24")
        .replace("\"glossy\", exponent = 200", "\"mirror\"")
        .replace("\"phong\", exponent = 60", "\"mirror\"")
        .replace(", diffuse = 0.1", "")
        .replace("filter = \"mitchell\"", "filter = \"box\"\nfilter_radius = 1e-6");
    let two = rendered(&text, &Settings::default()).film;
    let one = rendered(&text.replace("glossy = \"two-pass\"", ""), &Settings::default()).film;
    let (two, one) = (two.values(two.window()), one.values(one.window()));
    let differ =
        two.iter().flatten().zip(one.iter().flatten()).filter(|(a, b)| (**a - **b).abs() > 1e-4).count();
    assert!(differ < 30, "{differ} numbers differ beyond edges");
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
    let light = |b: Vec3| [if fields(b.x) == fields(b.y + 0.13) { 1.0 } else { 0.1 }, 0.5, b.x.abs()];
    let lobe = Lobe::new(300.0, 0.01, 1.5);
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

/// The middle pixel by the filter, in the first channel.
fn middle(g: &GBuffer, fuzzy: &Fuzzy) -> f64 {
    let (x, y) = (g.full[0] / 2, g.full[1] / 2);
    let window = Window { x0: x, y0: y, x1: x + 1, y1: y + 1 };
    f64::from(filter(g, window, fuzzy, (Level::best(), 0)).reflected[0][0])
}

#[test]
fn faces_of_one_reflector_do_not_mix() {
    // Two faces of a box, say: the same number, light of their own, and rays that end beside each other all the same. Exponent, and the sine of half the angle
    // between the faces: 90 degrees of which the lobe has 48, and 30 of which it has 24.
    for (p, half) in [(50.0, f32::sqrt(0.5)), (200.0, 0.26)] {
        // The edge is within a texel of any smaller picture.
        let light = |b: Vec3| [if b.x < 0.0 { 1.0 } else { 5.0 }; 3];
        let flat = facing(([122, 60], 200.0), (1.0, 1.0), p, light);
        let mut g = flat.clone();
        for mirror in g.texels.iter_mut().filter_map(|texel| texel.mirror.as_mut()) {
            let side = if mirror.radiance[0] < 2.0 { -half } else { half };
            mirror.normal = Vec3::new(side, 0.0, (1.0 - side * side).sqrt());
        }
        for (name, speed) in ways() {
            for correction in [Correction::None, Correction::SolidAngle] {
                let fuzzy = Fuzzy { speed, correction, lost_mass: 0.01, ..WHOLE };
                let mixed = filtered(&flat, &fuzzy).reflected;
                let mixed = mixed.iter().filter(|light| (1.2..4.8).contains(&light[0])).count();
                assert!(mixed > 300, "{name}: {mixed} pixels of a flat mirror show both sides");
                for (light, texel) in filtered(&g, &fuzzy).reflected.iter().zip(&g.texels) {
                    let own = texel.mirror.expect("a mirror").radiance[0];
                    assert!((light[0] - own).abs() < 1e-5, "{p} {name} {correction:?}: {light:?}, not {own}");
                }
            }
        }
        // A little turn is none: what is curved is one face.
        for mirror in g.texels.iter_mut().filter_map(|texel| texel.mirror.as_mut()) {
            mirror.normal = Vec3::new(0.05 * mirror.normal.x, 0.0, 1.0).normalize();
        }
        for (name, speed) in ways() {
            let fuzzy = Fuzzy { speed, lost_mass: 0.01, ..WHOLE };
            let both = [&g, &flat].map(|g| filtered(g, &fuzzy).reflected);
            assert_eq!(both[0], both[1], "{name}: weights do not depend on normals");
        }
    }
}

/// The mean of the light of pixels by cos^p, over those within the lobe whose offsets from the middle one are `inside`.
fn by_hand(g: &GBuffer, lobe: &Lobe, inside: impl Fn(f32, f32) -> bool) -> f64 {
    let [width, height] = g.full;
    let of = |x: u32, y: u32| g.texel(x, y).and_then(|texel| texel.mirror).expect("a mirror");
    let own = of(width / 2, height / 2);
    let w = own.direction().expect("a way").as_dvec3();
    let (mut sum, mut weights) = (0.0, 0.0);
    for y in 0..height {
        for x in 0..width {
            let other = of(x, y);
            let End::At(b) = other.end else { continue };
            let cos = (b - own.a).as_dvec3().normalize().dot(w);
            let (dx, dy) = (x as f32 - (width / 2) as f32, y as f32 - (height / 2) as f32);
            if inside(dx, dy) && cos >= 1.0 - f64::from(lobe.t_max) {
                let weight = cos.powf(f64::from(lobe.exponent));
                sum += weight * f64::from(other.radiance[0]);
                weights += weight;
            }
        }
    }
    sum / weights
}

#[test]
fn outlines_of_windows_differ_where_they_cut_the_lobe_only() {
    let p = 100.0;
    // Light beyond a circle of 6.4 pixels about the middle, which is where windows end below.
    let scale = 60.0;
    let light = |b: Vec3| [f32::from(u8::from(b.truncate().length() > 2.0 * 6.4 / scale)); 3];
    let g = facing(([101, 101], scale), (1.0, 1.0), p, light);
    let of = |shape, max_radius| Fuzzy {
        shape,
        max_radius,
        lost_mass: 1e-3,
        radius: Radius::Differential,
        ..WHOLE
    };
    let lobe = Lobe::new(p, 1e-3, 1.5);
    let all = by_hand(&g, &lobe, |_, _| true);
    for shape in [Shape::Round, Shape::Rectangle] {
        let found = middle(&g, &of(shape, 1e4));
        // A pixel on the rim of the lobe counts or not.
        assert!((found - all).abs() < 5e-5, "{shape:?}: {found}, not {all}: the lobe decides");
    }
    let (disc, square) = (
        by_hand(&g, &lobe, |x, y| x * x + y * y <= 6.4 * 6.4),
        by_hand(&g, &lobe, |x, y| x.abs() <= 6.4 && y.abs() <= 6.4),
    );
    println!("all {all:.4}, disc {disc:.4}, square {square:.4}");
    assert!(disc < 1e-9 && square > 0.02 && all > 1.5 * square, "{disc} {square} {all}");
    for (shape, wanted) in [(Shape::Round, disc), (Shape::Rectangle, square)] {
        let found = middle(&g, &of(shape, 6.4));
        assert!((found - wanted).abs() < 1e-5, "{shape:?}: {found}, not {wanted}");
    }
}

#[test]
fn rays_that_end_nowhere_count_by_direction() {
    // A sky that is bright beyond a plane through the mirror, which stands off the mirrored ray by these tangents.
    for p in [40.0_f32, 100.0] {
        for offset in [-0.1, 0.0, 0.05, 0.15] {
            // Sixty pixels for the width of the lobe or about, and the edge between two of them.
            let sigma = 1.0 / (f64::from(p) + 1.0).sqrt();
            let pitch = if offset == 0.0 {
                sigma / 60.0
            } else {
                f64::abs(offset) / ((60.0 * f64::abs(offset) / sigma).floor() + 0.5)
            };
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "sizes")]
            let (scale, half) = (pitch.recip() as f32, (5.2 * sigma / pitch) as u32);
            let size = 2 * half + 1;
            let mut g = facing(([size, size], scale), (1.0, 1.0), p, |_| [0.0; 3]);
            for mirror in g.texels.iter_mut().filter_map(|texel| texel.mirror.as_mut()) {
                // By what the pixel would see of the sky in the mirror; on the edge itself one half.
                let d = (mirror.a.with_z(1.0)).normalize();
                mirror.end = End::Away(d);
                let beyond = f64::from(d.x / d.z) - offset;
                mirror.radiance =
                    [if beyond.abs() < 1e-6 { 0.5 } else { f32::from(u8::from(beyond > 0.0)) }; 3];
                mirror.hit = 0;
            }
            for (correction, exponent) in
                [(Correction::SolidAngle, p), (Correction::Cosine, p), (Correction::None, p - 3.0)]
            {
                let found =
                    middle(&g, &Fuzzy { correction, radius: Radius::Differential, lost_mass: 1e-4, ..WHOLE });
                let wanted = of_lobe(f64::from(exponent), offset);
                println!("p {p} edge {offset} {correction:?}: {found:.5}, wanted {wanted:.5}");
                // Of the lobe 1e-4 is given away.
                assert!((found - wanted).abs() < 2e-4, "{p} {offset} {correction:?}: {found}, not {wanted}");
            }
        }
    }
}
