//! Whole pictures of the three ways to fuzzy reflections: against each other, and against what their lobes make of simple scenes.

use crate::edge::{by_rays, edge, mirror, of_lobe};
use crate::masks::{Class, classes};
use crate::scene::{bits, rendered, scene_in};
use glam::DVec3;
use specula::image::Window;
use specula::math::lanes::Level;
use specula::post::{End, Fuzzy, GBuffer, Mirror, Speed, filter};
use specula::render::{Rendered, Settings, Silent, render};
use std::path::Path;

/// The flat floor of `scenes/fuzzy_plane.toml` with light of its own, small, and with a second light, whose highlight is on the floor.
fn floor(keys: &[&str], settings: &Settings) -> Rendered {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fuzzy_plane.toml");
    let text = std::fs::read_to_string(path).expect("the scene");
    let lamp = "\n[[lights]]\ntype = \"point\"\nposition = [0.3, 0.6, -1.5]\nintensity = 0.4\n";
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text + lamp).expect("a scene file");
    let own = ["film.width=64", "film.height=40", "materials.floor.diffuse=0.15"];
    render(&scene_in(&path, &[&own[..], keys].concat()), settings, &Silent).expect("a picture")
}

#[test]
fn a_whole_picture_is_that_of_rays_in_the_lobe() {
    let two = floor(
        &["render.glossy=two-pass", "render.spp=16"],
        &Settings { first_pass: true, ..Settings::default() },
    );
    let rays = floor(&["render.glossy=lobe", "render.spp=512"], &Settings::default());
    let window = two.film.window();
    let (found, wanted) = (two.film.values(window), rays.film.values(window));
    let inside: Vec<usize> = (0..)
        .zip(classes(&two.first_pass))
        .filter(|(_, class)| *class == Class::Inside)
        .map(|(at, _)| at)
        .collect();
    assert!(inside.len() > 300, "{} pixels", inside.len());
    let sum = |picture: &[[f32; 3]], some: &[usize]| {
        some.iter().flat_map(|&at| picture[at]).map(f64::from).sum::<f64>()
    };
    let ratio = sum(&found, &inside) / sum(&wanted, &inside);
    println!("{} pixels: {ratio:.5} of the light", inside.len());
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    // By parts of the floor, too: nothing makes up for anything else.
    for part in inside.chunks(inside.len().div_ceil(5)) {
        let ratio = sum(&found, part) / sum(&wanted, part);
        println!("rows from {}: {ratio:.5}", part[0] / 64);
        assert!((ratio - 1.0).abs() < 0.02, "{ratio} from row {}", part[0] / 64);
    }
    // All parts of the picture are there: light of the floor itself, a highlight, and a reflection.
    let rest: Vec<f32> = inside.iter().map(|&at| two.first_pass[0].texels[at].rest[1]).collect();
    let mut sorted = rest.clone();
    sorted.sort_by(f32::total_cmp);
    let (median, most) = (sorted[sorted.len() / 2], sorted[sorted.len() - 1]);
    let all = sum(&found, &inside) / (3 * inside.len()) as f64;
    println!("all {all:.3}, of itself {median:.3}, highlight {most:.3}");
    assert!(f64::from(median) > 0.1 * all && most > 2.0 * median, "{median} {most} of {all}");
    assert!(f64::from(rest.iter().sum::<f32>()) < 0.8 * all * rest.len() as f64, "no reflection");
}

#[test]
fn rays_of_a_sample_share_lens_and_moment() {
    let text = edge("glossy = \"two-pass\"\nspp = 4\nfuzzy.max_radius = 0", 50.0, (0.1, 0.01, 21));
    let passes = |text: &str| {
        let passes = rendered(text, &Settings { first_pass: true, ..Settings::default() }).first_pass;
        assert_eq!(passes.len(), 4, "one for each sample");
        passes
    };
    let at = |g: &GBuffer, x, y| g.texel(x, y).and_then(|texel| texel.mirror).expect("a mirror").a;
    // Out of focus, the mirror is seen in a grid all the same: from another place in each sample.
    let lens = passes(&text.replace("vfov_deg", "lens_radius = 0.05\nfocus_distance = 0.3\nvfov_deg"));
    for g in &lens {
        let corner = at(g, 0, 0);
        let (right, down) = (at(g, 1, 0) - corner, at(g, 0, 1) - corner);
        for (x, y) in (0..21_u16).flat_map(|y| (0..21).map(move |x: u16| (x, y))) {
            let wanted = corner + right * f32::from(x) + down * f32::from(y);
            let off = at(g, x.into(), y.into()).distance(wanted);
            // Rounding on the large mirror grows with the distance from the pixels that tell the grid: 0.004 of a pixel seven pixels off.
            assert!(off < 0.05 * right.length(), "{x} {y}: off by {off} of {}", right.length());
        }
    }
    let apart = lens.iter().map(|g| at(g, 0, 0).distance(at(&lens[0], 0, 0))).fold(0.0, f32::max);
    assert!(apart > 3e-3, "one place on the lens for all samples: {apart}");
    // The mirror rises by 0.2 metres while the shutter is open.
    let key =
        |s: f32| format!("{{ time_s = {s:?}, transform = [{{ translate = [0.0, 0.0, {:?}] }}] }}", 0.2 * s);
    let keys = format!("material = \"mirror\"\nkeys = [{}, {}]", key(0.0), key(1.0));
    let moving = text.replace("material = \"mirror\"", &keys);
    let moving = moving.replace("vfov_deg", "shutter_open_s = 0.0\nshutter_close_s = 1.0\nvfov_deg");
    let heights: Vec<f32> = passes(&moving)
        .iter()
        .map(|g| {
            let height = at(g, 0, 0).z;
            let mirrors = g.texels.iter().filter_map(|texel| texel.mirror);
            assert!(
                mirrors.clone().count() == 441 && mirrors.clone().all(|it| (it.a.z - height).abs() < 1e-5),
                "one moment"
            );
            height
        })
        .collect();
    let (low, high) = heights.iter().fold((1.0_f32, 0.0_f32), |(low, high), &z| (low.min(z), high.max(z)));
    assert!(high - low > 0.02, "one moment for all samples: {heights:?}");
}

/// What trembling normals of density cos^m send of the half plane beyond x, in a plane straight ahead at unit distance: along each azimuth the
/// normals that are turned by half the angle or more, of those whose mirrored rays stay above the surface.
fn of_normals(m: f64, x: f64) -> f64 {
    const STEPS: u32 = 20_000;
    let h = std::f64::consts::PI / f64::from(STEPS);
    let least = std::f64::consts::FRAC_PI_4.cos().powf(m + 1.0);
    let along = |i: u32| {
        let azimuth = -std::f64::consts::FRAC_PI_2 + (f64::from(i) + 0.5) * h;
        (0.5 * (x / azimuth.cos()).atan()).cos().powf(m + 1.0) - least
    };
    (0..STEPS).map(along).sum::<f64>() * h / std::f64::consts::TAU
}

#[test]
fn glossy_materials_tremble_as_wide_as_their_lobes() {
    for (p, x0) in [(20.0_f32, 0.2), (100.0, 0.05), (100.0, 0.1), (1000.0, 0.02)] {
        let (found, deviation) = by_rays("glossy = \"jitter\"", p, (x0, 0.01, 9));
        let exact = of_normals(4.0 * f64::from(p) + 3.0, x0);
        let lobe = of_lobe(f64::from(p), x0);
        println!("p {p} x0 {x0}: {found:.5} +- {deviation:.5}, normals {exact:.5}, lobe {lobe:.5}");
        // Once in 4000 by chance for four rows.
        assert!((found - exact).abs() < 4.0 * deviation, "{p} {x0}: {found} +- {deviation}, not {exact}");
        assert!(
            (exact - lobe).abs() < 0.06 / f64::from(p).sqrt(),
            "{p} {x0}: as sharp as the lobe, {exact} and {lobe}"
        );
        assert!((of_normals(f64::from(p), x0) - exact).abs() > 20.0 * deviation, "angles double");
    }
}

#[test]
fn lobes_of_phong_do_not_tremble() {
    let of = |glossy: &str| {
        let text = edge(&format!("spp = 4\nglossy = \"{glossy}\""), 50.0, (0.1, 0.01, 9));
        let text = text.replace("type = \"glossy\"", "type = \"phong\"");
        bits(&rendered(&text, &Settings::default()).film)
    };
    assert_eq!(of("jitter"), of("lobe"), "another picture");
}

/// What lobes of an exponent send of the far side of a plane, by the tangent that the mirrored ray is off it, from -1 to 1.
struct Profile(Vec<f64>);

impl Profile {
    const STEPS: u32 = 1000;

    fn of(p: f64) -> Self {
        Self(
            (0..=Self::STEPS + 1)
                .map(|i| of_lobe(p, 2.0 * f64::from(i) / f64::from(Self::STEPS) - 1.0))
                .collect(),
        )
    }

    fn at(&self, tangent: f64) -> f64 {
        let x = (0.5 * tangent.clamp(-1.0, 1.0) + 0.5) * f64::from(Self::STEPS);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
        let i = x as usize;
        self.0[i] + (x - x.floor()) * (self.0[i + 1] - self.0[i])
    }
}

/// The tangent of the angle between a mirrored ray and a plane through where it is mirrored, with that unit normal.
fn off_plane(mirror: &Mirror, normal: DVec3) -> f64 {
    let sin = mirror.direction().expect("a way").as_dvec3().dot(normal);
    sin / (1.0 - sin * sin).sqrt()
}

#[test]
fn a_sky_is_blurred_by_direction() {
    // A sky that is bright on the side of +x and dark on the other, in a mirror that is looked at straight on.
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("sky.hdr");
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4096\n".to_vec();
    for column in (0..4096).chain(0..4096) {
        bytes.extend(if column < 2048 { [0, 0, 0, 0] } else { [128, 128, 128, 129] });
    }
    std::fs::write(&file, bytes).expect("a picture");
    let text = mirror("glossy = \"two-pass\"\nspp = 1\nfuzzy.max_radius = 0", 100.0, 90.0, 160);
    let text = format!("{text}[[lights]]\ntype = \"environment\"\nfile = {file:?}\n");
    let first = rendered(&text, &Settings { first_pass: true, ..Settings::default() }).first_pass;
    let g = &first[0];
    assert!(
        g.texels.iter().all(|texel| texel.mirror.is_some_and(|m| matches!(m.end, End::Away(_)))),
        "all escape"
    );
    let window = Window { x0: 40, y0: 40, x1: 120, y1: 120 };
    let fuzzy = Fuzzy { lost_mass: 1e-3, speed: Speed::PLAIN, ..Fuzzy::default() };
    let found = filter(g, window, &fuzzy, (Level::best(), 0)).reflected;
    let places = (40..120).flat_map(|y| (40..120).map(move |x| (x, y)));
    let profile = Profile::of(100.0);
    let (mut worst, mut grey) = (0.0, 0);
    for ((x, y), light) in places.zip(found) {
        let mirror = g.texel(x, y).and_then(|texel| texel.mirror).expect("a mirror");
        let wanted = profile.at(-off_plane(&mirror, DVec3::X));
        worst = f64::max(worst, (f64::from(light[0]) - wanted).abs());
        grey += usize::from((0.1..0.9).contains(&wanted));
    }
    println!("{worst:.5} at worst, {grey} pixels are grey");
    // Eight pixels for the width of the lobe, the edge between two of them.
    assert!(worst < 3e-3 && grey > 1000, "{worst}, {grey}");
}

/// A fuzzy floor on which a wall stands, bright to the left and dark to the right.
const WALL: &str = r#"
    [camera]
    from = [0, 0.8, 3]
    at = [0, 0.0, 0.6]
    vfov_deg = 30
    [film]
    width = 240
    height = 200
    filter = "box"
    filter_radius = 1e-4
    [render]
    spp = 1
    max_depth = 3
    glossy = "two-pass"
    fuzzy.max_radius = 0
    [materials]
    floor = { type = "glossy", exponent = 300, reflectance = 1 }
    bright = { type = "emission", radiance = 1, two_sided = true }
    dark = { type = "diffuse", reflectance = 0 }
    [[shapes]]
    type = "rectangle"
    edge_u = [40, 0, 0]
    edge_v = [0, 0, -40]
    material = "floor"
    [[shapes]]
    type = "rectangle"
    center = [-10, 10, 0]
    edge_u = [10, 0, 0]
    edge_v = [0, 10, 0]
    material = "bright"
    [[shapes]]
    type = "rectangle"
    center = [10, 10, 0]
    edge_u = [10, 0, 0]
    edge_v = [0, 10, 0]
    material = "dark"
"#;

#[test]
fn reflections_blur_from_where_they_touch() {
    // The edge of the wall is upright, so that the lobe is cut by the plane through it and where the ray is mirrored: what comes of it
    // is known, and how wide, by the length of the ray.
    let g = &rendered(WALL, &Settings { first_pass: true, ..Settings::default() }).first_pass[0];
    let fuzzy = Fuzzy { lost_mass: 1e-3, ..Fuzzy::default() };
    let profile = Profile::of(300.0);
    let wide = {
        // The mean distance from the edge of what is blurred, for a ray of unit length, is the integral of both tails.
        const STEPS: u32 = 400;
        let h = 0.4 / f64::from(STEPS);
        (0..STEPS).map(|i| 2.0 * h * profile.at((f64::from(i) + 0.5) * h)).sum::<f64>()
    };
    for speed in [Speed::PLAIN, Speed::default()] {
        let found = filter(g, g.window, &Fuzzy { speed, ..fuzzy }, (Level::best(), 0)).reflected;
        let (mut rows, mut widths, mut worst) = (0, vec![(0.0, 0.0)], 0.0_f64);
        for (row, light) in g.texels.chunks(240).zip(found.chunks(240)) {
            // From the far end of the floor, where rays are short, towards the eye.
            if !row.iter().all(|texel| {
                texel.mirror.is_some_and(|mirror| matches!(mirror.end, End::At(b) if b.z.abs() < 1e-3))
            }) {
                continue;
            }
            rows += 1;
            let mirrors: Vec<Mirror> = row.iter().filter_map(|texel| texel.mirror).collect();
            let r = f64::from(mirrors[120].length());
            let (mut width, mut error) = (0.0, 0.0);
            for ((mirror, light), next) in mirrors.iter().zip(light).zip(&mirrors[1..]) {
                let to_edge = DVec3::new(-f64::from(mirror.a.x), 0.0, -f64::from(mirror.a.z));
                let wanted = profile.at(off_plane(mirror, to_edge.cross(DVec3::Y).normalize()));
                error += (f64::from(light[0]) - wanted).powi(2) / 240.0;
                let End::At(b) = mirror.end else { continue };
                let End::At(next) = next.end else { continue };
                width += f64::from((light[0] - mirror.radiance[0]).abs() * (next - b).x);
            }
            widths.push((r, width));
            let error = error.sqrt();
            worst = worst.max(error);
            let pixel =
                f64::from((mirrors[121].a - mirrors[120].a).x) * (1.0 + r / f64::from(mirrors[120].s));
            if rows % 10 == 1 {
                println!(
                    "r {r:.4}: width {width:.5}, wanted {:.5}, pixel {pixel:.5}, error {error:.5}",
                    wide * r
                );
            }
            // What is narrower than pixels is nothing, or as wide as they are.
            assert!(
                (width - wide * r).abs() < 0.05 * wide * r + 0.3 * pixel,
                "r {r}: {width}, not {}",
                wide * r
            );
        }
        assert!(rows > 80, "{rows} rows");
        let grows = widths.windows(2).filter(|pair| pair[1].1 > pair[0].1).count();
        println!("{grows} of {rows} rows are wider than the one before, off by {worst:.5} at most");
        assert!(worst < 0.01, "{speed:?}: off by {worst}");
        assert!(grows * 10 > rows * 9, "{grows} of {rows}");
        assert!(
            widths[1].1 < 0.03 * widths[rows].1,
            "it begins at nothing: {:?} of {:?}",
            widths[1],
            widths[rows]
        );
    }
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
    let first = rendered(text, &Settings { first_pass: true, ..Settings::default() }).first_pass;
    let mut near = 0;
    for speed in [Speed::PLAIN, Speed::default()] {
        let found =
            filter(&first[0], first[0].window, &Fuzzy { speed, ..Fuzzy::default() }, (Level::best(), 0));
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
