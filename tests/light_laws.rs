//! Laws of lights: densities are those of the samples and cover the light, irradiance is what closed forms say.
//!
//! Estimates are judged by their own standard error: beyond four of them is wrong, which chance brings about once in
//! 16000 times; there are some forty estimates, and the seeds are fixed.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small non-negative numbers")]

#[path = "support/random.rs"]
mod random;
#[path = "support/statistics.rs"]
mod statistics;

use glam::{DVec3, Vec3 as Point3};
use random::Random;
use specula::geometry::{Disc, Sphere};
use specula::image::Image;
use specula::light::{
    Area, Directional, DiscArea, Emitter, Environment, EnvironmentMap, Light, MeshArea, Point, RectangleArea,
    Reference, SphereLight, Spot, spot_versines,
};
use specula::math::{Rgb, Vec3};
use std::f64::consts::PI;

const SAMPLES: u32 = 1 << 18;
const ORIGIN: Vec3<f32> = Vec3::new(0.0, 0.0, 0.0);
const UP: Vec3<f32> = Vec3::new(0.0, 1.0, 0.0);

/// A mean and its standard error.
#[derive(Clone, Copy, Debug)]
struct Estimate {
    mean: f64,
    error: f64,
}

impl Estimate {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
        for value in values {
            n += 1.0;
            let off: f64 = value - mean;
            mean += off / n;
            squares += off * (value - mean);
        }
        Self { mean, error: (squares / (n * (n - 1.0))).sqrt() }
    }

    fn agrees_with(self, expected: f64) -> bool {
        (self.mean - expected).abs() <= 4.0 * self.error + 2e-6 * expected.abs()
    }
}

fn at(x: f32, y: f32, z: f32) -> Reference<f32> {
    Reference { p: Vec3::new(x, y, z), n: UP }
}

fn pairs(seed: u32) -> impl Iterator<Item = [f32; 2]> {
    let mut random = Random::new(seed);
    (0..SAMPLES).map(move |_| random.pair())
}

/// Irradiance by sampling the light.
fn irradiance(light: &Light, at: Reference<f32>, seed: u32) -> Estimate {
    Estimate::of(pairs(seed).map(|u2| {
        let sample = light.sample(at, u2);
        let value = sample.li.r * sample.wi.dot(at.n) / sample.pdf;
        if sample.valid { f64::from(value) } else { 0.0 }
    }))
}

/// The solid angle in which the light stands above the horizon, by sampling it.
fn solid_angle(light: &Light, at: Reference<f32>, seed: u32) -> Estimate {
    Estimate::of(pairs(seed).map(|u2| {
        let sample = light.sample(at, u2);
        if sample.valid { 1.0 / f64::from(sample.pdf) } else { 0.0 }
    }))
}

/// A square of side 1 that shines downwards from a height.
fn square(height: f32) -> Light {
    let surface = RectangleArea::new(Point3::Y * height, Point3::X * 0.5, Point3::Z * 0.5);
    Light::Rectangle(Area { surface, radiance: Rgb::gray(2.0), two_sided: false })
}

fn disc() -> Light {
    let surface = DiscArea::new(Point3::Y, Point3::NEG_Y, 0.5);
    Light::Disc(Area { surface, radiance: Rgb::gray(2.0), two_sided: false })
}

fn sphere() -> Light {
    Light::Sphere(SphereLight {
        center: Vec3::new(0.0, 1.5, 0.0),
        radius: 0.5,
        radiance: Rgb::gray(2.0),
        two_sided: false,
    })
}

const SQUARE: [[Point3; 3]; 2] = {
    let [a, b] = [Point3::new(-0.5, 1.0, -0.5), Point3::new(0.5, 1.0, -0.5)];
    let [c, d] = [Point3::new(0.5, 1.0, 0.5), Point3::new(-0.5, 1.0, 0.5)];
    [[a, b, c], [a, c, d]]
};

/// The square at height 1 as unequal triangles, a degenerate one among them.
fn mesh() -> Light {
    let [[a, b, c], [_, _, d]] = SQUARE;
    let e = a.lerp(b, 0.3);
    let surface = MeshArea::new(vec![[a, e, c], [e, e, c], [e, b, c], [a, c, d]]).expect("has area");
    Light::Mesh(Area { surface, radiance: Rgb::gray(2.0), two_sided: false })
}

/// A picture of 16 x 8 pixels, a quarter of them black.
fn picture(seed: u32) -> Image {
    let mut random = Random::new(seed);
    let pixels =
        (0..128).map(|i| if i / 8 % 4 == 1 { Rgb::BLACK } else { Rgb::from(random.triple()).scale(5.0) });
    Image::from_pixels(16, 8, pixels.collect()).expect("as many as there should be")
}

fn map(image: Image, scale: f32, rotation: f32) -> Environment {
    Environment::Map(std::sync::Arc::new(EnvironmentMap::new(image, scale, rotation).expect("shines")))
}

#[test]
fn the_square_shines_as_its_form_factor_says() {
    let cases = [
        (square(1.0), at(0.0, 0.0, 0.0), 0.239_456_470_461),
        (square(0.5), at(0.0, 0.0, 0.0), 0.554_126_423_980),
        (square(1.0), at(1.0, 0.0, 0.0), 0.084_353_643_881),
        (mesh(), at(0.0, 0.0, 0.0), 0.239_456_470_461),
        (mesh(), at(0.0, 0.0, 1.0), 0.084_353_643_881),
        (disc(), at(0.0, 0.0, 0.0), 0.2),
        (sphere(), at(0.0, 0.0, 0.0), 1.0 / 9.0),
    ];
    for (i, (light, at, form_factor)) in cases.into_iter().enumerate() {
        let found = irradiance(&light, at, i as u32);
        assert!(found.agrees_with(2.0 * PI * form_factor), "case {i}: {found:?}, not 2 pi {form_factor}");
        assert!(found.error < 0.005 * found.mean, "case {i}: {found:?} shows nothing");
    }
}

/// Irradiance of a polygon of radiance 1, by its corners as seen from the reference point (Lambert 1760, Photometria).
fn lambert(corners: &[DVec3], n: DVec3) -> f64 {
    let mut above = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let [ha, hb] = [a.dot(n), b.dot(n)];
        if ha >= 0.0 {
            above.push(a);
        }
        if (ha < 0.0) != (hb < 0.0) {
            above.push(a + (b - a) * (ha / (ha - hb)));
        }
    }
    let edges = (0..above.len()).map(|i| (above[i], above[(i + 1) % above.len()]));
    let sum: f64 = edges
        .map(|(a, b)| {
            let across = a.cross(b);
            let angle = across.length().atan2(a.dot(b));
            if across.length() > 0.0 { angle * across.normalize().dot(n) } else { 0.0 }
        })
        .sum();
    (0.5 * sum).abs()
}

/// The solid angle of a triangle by its corners as seen from the reference point (van Oosterom and Strackee 1983).
fn solid_angle_of([a, b, c]: [DVec3; 3]) -> f64 {
    let [la, lb, lc] = [a, b, c].map(DVec3::length);
    let under = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot(b.cross(c)).abs().atan2(under)
}

/// A rectangle and its triangles, both as lights, and its corners.
fn panel(center: Point3, u: Point3, v: Point3) -> ([Light; 3], [Point3; 4]) {
    let corners = [center - u - v, center + u - v, center + u + v, center - u + v];
    let [a, b, c, d] = corners;
    let radiance = Rgb::WHITE;
    let rectangle = RectangleArea::new(center, u, v);
    // As a mesh that is no rectangle to the renderer, and as one that is asked by its triangles.
    let e = a.lerp(b, 0.4);
    let few = MeshArea::new(vec![[a, e, d], [e, c, d], [e, b, c]]).expect("has area");
    let row = |i: u16| {
        let [l, r] = [f32::from(i) / 8.0, f32::from(i + 1) / 8.0];
        let [p, q, s, t] = [a.lerp(b, l), a.lerp(b, r), d.lerp(c, r), d.lerp(c, l)];
        [[p, q, s], [p, s, t]]
    };
    let many = MeshArea::new((0..8).flat_map(row).collect()).expect("has area");
    let lights = [
        Light::Rectangle(Area { surface: rectangle, radiance, two_sided: false }),
        Light::Mesh(Area { surface: few, radiance, two_sided: false }),
        Light::Mesh(Area { surface: many, radiance, two_sided: false }),
    ];
    (lights, corners)
}

/// Reference points on the side on which a panel of half edges u and v about the origin shines, in units of its size: near and far, beside
/// it, close to its plane and in it, close to its middle, its edges and its corners.
const PLACES: [[f32; 3]; 14] = [
    [0.1, 0.2, 1.0],
    [0.3, -0.4, 0.1],
    [0.2, 0.1, 1e-3],
    [0.999, 0.3, 1e-2],
    [1.0, 0.5, 0.2],
    [1.0, 1.0, 1e-2],
    [1.001, -1.001, 1e-4],
    [2.0, 0.5, 0.1],
    [-2.0, -1.5, 0.01],
    [3.0, 2.0, 1e-4],
    [1.5, 0.0, 0.0],
    [0.0, 3.0, 3.0],
    [30.0, -10.0, 20.0],
    [400.0, 3.0, 1.0],
];

#[test]
fn panels_light_as_lambert_says_from_everywhere() {
    let mut random = Random::new(7);
    for (size, ratio) in [(1.0_f32, 1.0_f32), (1e-6, 1.0), (1e6, 0.5), (1.0, 0.01)] {
        for place in PLACES {
            // The panel turned at random about the origin; the receiver turned towards it, and away by up to a right angle.
            let z = Point3::from(random.direction());
            let x = z.any_orthonormal_vector();
            let y = z.cross(x);
            let ([u, v], center) = ([x * size, y * size * ratio], Point3::ZERO);
            let p = (x * place[0] + y * place[1] * ratio + z * place[2]) * size;
            let towards = (center - p).normalize();
            let n = (towards + Point3::from(random.direction()) * 0.9).normalize();
            let at = Reference { p: p.into(), n: n.into() };
            let (lights, corners) = panel(center, u, v);
            let seen = corners.map(|corner| corner.as_dvec3() - p.as_dvec3());
            let expected = lambert(&seen, n.as_dvec3());
            for (i, light) in lights.iter().enumerate() {
                let found = irradiance(light, at, 200 + i as u32);
                // A receiver next to a light that is drawn from by area learns little, and its error not at all.
                let is_sure = i < 2 && place[2] > 0.0;
                let rounding = 2e-4 * expected + 1e-7;
                let off = (found.mean - expected).abs();
                assert!(
                    !is_sure || off <= 4.5 * found.error + rounding,
                    "light {i} of {size} x {ratio} at {place:?}: {found:?}, not {expected}"
                );
                assert!(found.mean.is_finite(), "light {i} of {size} x {ratio} at {place:?}: {found:?}");
                let is_large = i < 2 && place[2] > 0.0 && place[0].abs() < 2.5;
                assert!(
                    !is_large || found.error <= 0.02 * expected.max(0.05),
                    "light {i} of {size} x {ratio} at {place:?}: {found:?} is noise"
                );
            }
        }
    }
}

#[test]
fn near_panels_are_drawn_from_by_solid_angle() {
    let [u, v] = [Point3::X, Point3::Z * 0.6];
    let (lights, [a, b, _, d]) = panel(Point3::Y, u, v);
    for place in [[0.1, 0.0, 0.2], [0.9, 0.9, 0.5], [-0.2, 0.99, -0.3], [2.0, 0.8, 0.5], [0.6, 0.9999, 0.0]] {
        let from = Point3::from(place);
        let at = Reference { p: from.into(), n: UP };
        for (i, light) in lights.iter().take(2).enumerate() {
            let (bins, mut counts) = (8_usize, vec![0.0; 64]);
            for u2 in pairs(300 + i as u32) {
                let p = Point3::from(light.sample(at, u2).p) - a;
                let [s, t] = [b - a, d - a].map(|edge| p.dot(edge) / edge.length_squared());
                let bin = |x: f32| ((x * 8.0) as usize).min(bins - 1);
                counts[bin(t) * bins + bin(s)] += 1.0;
            }
            let corner = |s: usize, t: usize| {
                let [s, t] = [s, t].map(|k| k as f64 / bins as f64);
                (a.as_dvec3() + (b - a).as_dvec3() * s + (d - a).as_dvec3() * t) - from.as_dvec3()
            };
            let cell = |(s, t): (usize, usize)| {
                let [p, q, r, w] = [corner(s, t), corner(s + 1, t), corner(s + 1, t + 1), corner(s, t + 1)];
                solid_angle_of([p, q, r]) + solid_angle_of([p, r, w])
            };
            let angles: Vec<f64> = (0..64).map(|k| cell((k % bins, k / bins))).collect();
            let total: f64 = angles.iter().sum();
            let expected: Vec<f64> = angles.iter().map(|angle| angle / total * f64::from(SAMPLES)).collect();
            let (statistic, cells) = statistics::chi_square(&counts, &expected);
            let tail = statistics::chi_square_tail(statistic, cells - 1);
            assert!(tail > 1e-4, "light {i} from {place:?}: chi-square {statistic} in {cells} cells");
            let sample = light.sample(at, [0.3, 0.7]);
            let off = f64::from(sample.pdf) * total - 1.0;
            assert!(off.abs() < 1e-4, "light {i} from {place:?}: density {} of {total} sr", sample.pdf);
        }
    }
}

#[test]
fn parts_of_a_mesh_are_drawn_from_by_themselves() {
    let ([_, _, many], corners) = panel(Point3::Y, Point3::X, Point3::Z);
    let (from, n) = (Point3::new(0.2, 0.5, 0.1), DVec3::Y);
    let at = Reference { p: from.into(), n: UP };
    let all = lambert(&corners.map(|corner| corner.as_dvec3() - from.as_dvec3()), n);
    let mut sum = 0.0;
    for part in 0..16 {
        let found = Estimate::of(pairs(400 + part).map(|u2| {
            let sample = many.sample_part(at, Some(part), u2);
            let emitter = Emitter { p: sample.p.into(), ng: Point3::NEG_Y, prim: part };
            let pdf = many.pdf_part(at, sample.wi, Some(&emitter));
            assert!(!sample.valid || (pdf / sample.pdf - 1.0).abs() < 2e-5, "{pdf} for {sample:?}");
            if sample.valid { f64::from(sample.wi.dot(at.n) / sample.pdf) } else { 0.0 }
        }));
        assert!(found.error < 1e-3 * all, "part {part}: {found:?}");
        sum += found.mean;
    }
    assert!((sum / all - 1.0).abs() < 2e-3, "{sum}, not {all}");
}

#[test]
fn two_triangles_are_a_rectangle_if_they_make_one_up() {
    let [a, b, c, d] = [[0.0, 1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 1.0, 1.0], [0.0, 1.0, 1.0]].map(Point3::from);
    let whole = RectangleArea::of_triangles(&[[a, b, c], [d, a, c]]).expect("a rectangle");
    let area = Area { surface: whole, radiance: Rgb::WHITE, two_sided: false };
    let power = Light::Rectangle(area).power(1.0);
    assert!((power - 2.0 * std::f32::consts::PI).abs() < 1e-5, "{power}");
    // Its normal is theirs: downwards, as (b - a) x (c - a).
    let light = Light::Rectangle(Area { surface: whole, radiance: Rgb::WHITE, two_sided: false });
    assert!(light.sample(at(1.0, 0.0, 0.5), [0.2, 0.8]).valid, "shines downwards");
    let skewed = d + Point3::X * 0.1;
    for (what, triangles) in [
        ("opposite sides", vec![[a, b, c], [d, c, a]]),
        ("no right angle", vec![[a, b, c], [skewed, a, c]]),
        ("apart", vec![[a, b, c], [d, a, c + Point3::X]]),
        ("one", vec![[a, b, c]]),
        ("twice the same", vec![[a, b, c], [a, b, c]]),
        ("folded", vec![[a, b, c], [d + Point3::Y * 0.5, a, c]]),
    ] {
        assert!(RectangleArea::of_triangles(&triangles).is_none(), "{what}");
    }
}

#[test]
fn a_sphere_on_the_horizon_shines_with_its_upper_half_only() {
    // Half of sin^2 of the half angle times the mean of the cosine in the plane of symmetry, by quadrature.
    let light = Light::Sphere(SphereLight {
        center: Vec3::new(2.0, 0.0, 0.0),
        radius: 1.0,
        radiance: Rgb::WHITE,
        two_sided: false,
    });
    let (steps, half_angle) = (1000, PI / 6.0);
    let mut expected = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            // Angle from the axis, and around it from the horizon.
            let theta = half_angle * (f64::from(i) + 0.5) / f64::from(steps);
            let phi = PI * (f64::from(j) + 0.5) / f64::from(steps);
            expected += theta.sin().powi(2) * phi.sin() * half_angle * PI / f64::from(steps).powi(2);
        }
    }
    let found = irradiance(&light, at(0.0, 0.0, 0.0), 20);
    assert!(found.agrees_with(expected), "{found:?}, not {expected}");
}

/// In the middle as beside it: a white sky above any surface.
#[test]
fn a_sphere_that_shines_inwards_is_a_sky() {
    let center = Vec3::new(0.0, 1.0, 0.0);
    let light = Light::Sphere(SphereLight { center, radius: 3.0, radiance: Rgb::WHITE, two_sided: true });
    for from in [at(0.0, 1.0, 0.0), at(0.5, 0.2, -1.0), at(0.0, -1.9, 0.0)] {
        let found = irradiance(&light, from, 20);
        assert!(found.agrees_with(PI), "{found:?}, not pi");
        for u2 in pairs(80).take(200) {
            let sample = light.sample(from, u2);
            let (p, wi) = (Point3::from(sample.p), Point3::from(sample.wi));
            assert!((p.distance(Point3::Y) - 3.0).abs() < 1e-5, "{p} is on the sphere");
            assert!((p - Point3::from(from.p)).normalize().distance(wi) < 1e-5, "{p} lies along {wi}");
            let emitter = Emitter { p, ng: (p - Point3::Y) / 3.0, prim: 0 };
            assert!((light.pdf(from, sample.wi, Some(&emitter)) / sample.pdf - 1.0).abs() < 1e-6, "density");
        }
    }
}

#[test]
fn densities_cover_the_solid_angle() {
    // Rectangle: van Oosterom and Strackee 1983; disc and sphere: caps.
    let pyramid = 4.0 * (0.25 / 1.5_f64.sqrt()).atan();
    let cap = |cos: f64| 2.0 * PI * (1.0 - cos);
    let cases = [
        (square(1.0), pyramid),
        (mesh(), pyramid),
        (disc(), cap(1.0 / 1.25_f64.sqrt())),
        (sphere(), cap(8.0_f64.sqrt() / 3.0)),
        (Light::Environment(map(picture(1), 1.0, 0.4)), 2.0 * PI),
    ];
    for (i, (light, expected)) in cases.into_iter().enumerate() {
        let found = solid_angle(&light, at(0.0, 0.0, 0.0), 40 + i as u32);
        assert!(found.agrees_with(expected), "case {i}: {found:?}, not {expected}");
        assert!(found.error < 0.02 * expected, "case {i}: {found:?} shows nothing");
    }
}

/// What a ray from the sample's reference point meets: the light's own sample point.
fn emitter(light: &Light, p: Vec3<f32>) -> Emitter {
    let (p, prim) = (Point3::from(p), if p.x > p.z { 0 } else { 3 });
    // The mesh's first row of triangles splits where x = -0.2 + 0.7 (z + 0.5).
    let prim = if prim == 0 && p.x > -0.2 + 0.7 * (p.z + 0.5) { 2 } else { prim };
    let ng = match light {
        Light::Sphere(sphere) => (p - Point3::from(sphere.center)).normalize(),
        _ => Point3::NEG_Y,
    };
    Emitter { p, ng, prim }
}

#[test]
fn the_density_of_a_sample_is_that_of_its_direction() {
    for (i, light) in [square(1.0), disc(), sphere(), mesh()].into_iter().enumerate() {
        for (reference, u2) in [at(0.0, 0.0, 0.0), at(0.7, -0.3, 0.2), at(-3.0, 0.9, 1.0)]
            .into_iter()
            .flat_map(|r| pairs(60).take(20_000).map(move |u2| (r, u2)))
        {
            let sample = light.sample(reference, u2);
            if !sample.valid {
                continue;
            }
            assert!((sample.wi.length2() - 1.0).abs() < 5e-7, "light {i}: {sample:?}");
            let off = (sample.p - reference.p).normalize() - sample.wi;
            assert!(off.length() < 2e-6, "light {i}: the direction leads to the point: {sample:?}");
            let pdf = light.pdf(reference, sample.wi, Some(&emitter(&light, sample.p)));
            assert!((pdf / sample.pdf - 1.0).abs() < 2e-5, "light {i}: {pdf} for {sample:?}");
            assert!(light.pdf(reference, sample.wi, None).to_bits() == 0, "light {i}: met nowhere");
        }
    }
}

#[test]
fn samples_lie_on_their_light() {
    for u2 in pairs(70).take(50_000).chain(corners()) {
        let p = square(1.0).sample(at(0.0, 0.0, 0.0), u2).p;
        assert!(p.x.abs() <= 0.5 && p.z.abs() <= 0.5 && (p.y - 1.0).abs() < 1e-6, "square: {p:?}");
        let p = Point3::from(disc().sample(at(0.0, 0.0, 0.0), u2).p);
        let disc = Disc { center: Point3::Y, normal: Point3::NEG_Y, radius: 0.5 };
        assert!((disc.project(p) - p).length() < 1e-6 && (p - Point3::Y).length() < 0.500_001, "disc: {p:?}");
        let p = Point3::from(sphere().sample(at(0.0, 0.0, 0.0), u2).p);
        let sphere = Sphere { center: Point3::Y * 1.5, radius: 0.5 };
        // Near the rim the crossing is where the chord vanishes: the root of rounding.
        assert!((sphere.project(p).0 - p).length() < 1e-3, "sphere: {p:?}");
        assert!(p.y <= 1.5 - 0.25 + 1.0 * 0.1, "sphere: the near side: {p:?}");
    }
}

fn corners() -> impl Iterator<Item = [f32; 2]> {
    let ends = [0.0, 0.5, 1.0 - f32::EPSILON / 2.0];
    ends.into_iter().flat_map(move |u| ends.into_iter().map(move |v| [u, v]))
}

#[test]
fn lights_are_dark_from_behind_and_finite_everywhere() {
    let sun = Directional { direction: -UP, irradiance: Rgb::WHITE };
    let [versine_outer, versine_inner] = spot_versines(0.5, 0.0);
    let position = Vec3::new(0.0, 1.0, 0.0);
    let spot = Spot { position, axis: -UP, intensity: Rgb::WHITE, versine_outer, versine_inner };
    let lights = [
        square(1.0),
        disc(),
        sphere(),
        mesh(),
        Light::Point(Point { position, intensity: Rgb::WHITE }),
        Light::Spot(spot),
        Light::Directional(sun),
    ];
    for (i, light) in lights.iter().enumerate() {
        for u2 in pairs(80).take(1000).chain(corners()) {
            // Above a light that shines downwards, and with the light below the horizon.
            let above = at(0.1, 4.0, 0.0);
            let turned = Reference { p: ORIGIN, n: -UP };
            let inside = at(0.0, 1.5, 0.0);
            assert!(!light.sample(turned, u2).valid, "light {i} shines from below the horizon");
            assert!(i > 3 || !light.sample(above, u2).valid, "light {i} shines backwards or up");
            assert!(i != 2 || !light.sample(inside, u2).valid, "a sphere is dark inside");
            for reference in
                [at(0.0, 0.0, 0.0), at(0.0, 1.0, 0.0), at(1e6, -1e6, 0.0), at(0.0, 1.0 - 1e-6, 0.0)]
            {
                let sample = light.sample(reference, u2);
                let finite =
                    sample.pdf.is_finite() && sample.li.is_finite() && sample.wi.length2().is_finite();
                assert!(!sample.valid || (finite && sample.pdf > 0.0), "light {i}: {sample:?}");
            }
        }
    }
}

#[test]
fn two_sides_shine_alike() {
    let surface = RectangleArea::new(Point3::Y, Point3::X * 0.5, Point3::Z * 0.5);
    let light = Light::Rectangle(Area { surface, radiance: Rgb::gray(2.0), two_sided: true });
    for (reference, seed) in
        [(at(0.0, 0.0, 0.0), 90), (Reference { p: Vec3::new(0.0, 2.0, 0.0), n: -UP }, 91)]
    {
        let found = irradiance(&light, reference, seed);
        assert!(found.agrees_with(2.0 * PI * 0.239_456_470_461), "{found:?}");
    }
    let (one, both) = (square(1.0).power(1.0), light.power(1.0));
    assert!(
        (one - 2.0 * std::f32::consts::PI).abs() < 1e-5 && (both - 2.0 * one).abs() < 1e-5,
        "{one} {both}"
    );
}

/// The power of a light at the origin as the sum over directions of what it sends to a sphere of radius 2.
fn power_by_sampling(light: &Light) -> Estimate {
    let mut random = Random::new(100);
    Estimate::of((0..SAMPLES).map(move |_| {
        let d = random.direction();
        let sample = light.sample(Reference { p: d * 2.0, n: -d }, [0.5, 0.5]);
        let facing = -sample.wi.dot(d);
        if sample.valid { f64::from(sample.li.r * facing) * 16.0 * PI } else { 0.0 }
    }))
}

#[test]
fn points_and_spots_have_the_power_they_say() {
    let point = Light::Point(Point { position: ORIGIN, intensity: Rgb::gray(3.0) });
    for (angle, softness) in [(0.5, 0.0), (0.5, 0.3), (1.2, 1.0), (3.0, 0.5)] {
        let [versine_outer, versine_inner] = spot_versines(angle, softness);
        let axis = Vec3::new(0.6, 0.0, 0.8);
        let spot = Light::Spot(Spot {
            position: ORIGIN,
            axis,
            intensity: Rgb::gray(3.0),
            versine_outer,
            versine_inner,
        });
        for light in [&spot, &point] {
            let found = power_by_sampling(light);
            let expected = f64::from(light.power(1.0));
            assert!(found.agrees_with(expected), "{angle} {softness}: {found:?}, not {expected}");
        }
        let mut last = f32::INFINITY;
        for i in 0..=1000_u16 {
            let off = std::f32::consts::PI * f32::from(i) / 1000.0;
            let d = Vec3::new(0.6 * off.cos() - 0.8 * off.sin(), 0.0, 0.8 * off.cos() + 0.6 * off.sin());
            let sample = spot.sample(Reference { p: d, n: -d }, [0.0, 0.0]);
            let value = if sample.valid { sample.li.r } else { 0.0 };
            assert!(value <= last + 1e-5, "{angle} {softness}: brighter at {off}");
            assert!(off > angle * (1.0 - softness) - 1e-3 || (value - 3.0).abs() < 1e-4, "not full at {off}");
            assert!(off < angle + 1e-3 || value.to_bits() == 0, "light at {off}, beyond {angle}");
            last = value;
        }
    }
}

#[test]
fn the_density_of_a_picture_integrates_to_one() {
    for (rotation, seed) in [(0.0, 1), (1.1, 2), (-4.0, 3)] {
        let light = Light::Environment(map(picture(seed), 0.3, rotation));
        let (columns, rows) = (2048_u16, 512_u16);
        let mut sum = 0.0;
        for j in 0..rows {
            let theta = std::f32::consts::PI * (f32::from(j) + 0.5) / f32::from(rows);
            for i in 0..columns {
                let phi = std::f32::consts::TAU * (f32::from(i) + 0.5) / f32::from(columns);
                let d = Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
                sum += f64::from(light.pdf(at(0.0, 0.0, 0.0), d, None) * theta.sin());
            }
        }
        let total = sum * 2.0 * PI * PI / f64::from(columns) / f64::from(rows);
        // The grid is four thousand times finer than the picture, but not aligned with its columns.
        assert!((total - 1.0).abs() < 1e-3, "rotation {rotation}: {total}");
    }
}

#[test]
fn samples_of_a_picture_are_its_directions() {
    let environment = map(picture(5), 0.7, 0.9);
    let light = Light::Environment(environment.clone());
    let bins = [12, 32];
    let (mut counts, mut expected) = (vec![0.0; 384], vec![0.0; 384]);
    let cell = |d: Vec3<f32>| {
        let v = d.y.clamp(-1.0, 1.0).acos() / std::f32::consts::PI * bins[0] as f32;
        let u = (d.z.atan2(d.x) / std::f32::consts::TAU + 0.5) * bins[1] as f32;
        (v as usize).min(bins[0] - 1) * bins[1] + (u as usize).min(bins[1] - 1)
    };
    let mut differing = 0;
    for (u2, n) in pairs(110).flat_map(|u2| [(u2, UP), (u2, -UP)]) {
        let at = Reference { p: ORIGIN, n };
        let sample = light.sample(at, u2);
        if !sample.valid {
            continue;
        }
        counts[cell(sample.wi)] += 1.0;
        let radiance = environment.radiance(sample.wi.into());
        let off = (radiance.r - sample.li.r).abs() + (radiance.b - sample.li.b).abs();
        assert!(off < 1e-4, "{radiance:?} for {sample:?}");
        differing += u32::from((light.pdf(at, sample.wi, None) / sample.pdf - 1.0).abs() > 1e-4);
    }
    // Directions within rounding of the edge of a pixel may fall to either side.
    assert!(differing <= SAMPLES / 20_000, "{differing} densities differ");
    // By midpoints, 100 x 100 in each cell.
    for (j, i) in (0..1200_u16).flat_map(|j| (0..3200_u16).map(move |i| (j, i))) {
        let (sin, cos) = (std::f32::consts::PI * (f32::from(j) + 0.5) / 1200.0).sin_cos();
        let phi = std::f32::consts::TAU * ((f32::from(i) + 0.5) / 3200.0 - 0.5);
        let d = Vec3::new(sin * phi.cos(), cos, sin * phi.sin());
        let pdf = f64::from(light.pdf(at(0.0, 0.0, 0.0), d, None) * sin);
        expected[usize::from(j / 100) * bins[1] + usize::from(i / 100)] += pdf * 2.0 * PI * PI / 3.84e6;
    }
    let total: f64 = expected.iter().sum();
    assert!((total - 1.0).abs() < 2e-3, "{total}");
    for value in &mut expected {
        *value *= f64::from(SAMPLES) / total;
    }
    let (statistic, cells) = statistics::chi_square(&counts, &expected);
    let tail = statistics::chi_square_tail(statistic, cells - 1);
    assert!(tail > 1e-4, "chi-square {statistic} in {cells} cells, tail {tail:e}");
}

#[test]
fn the_density_of_a_picture_is_its_light() {
    // Light that changes along rows, with black columns and a bright one at the seam; across rows the sine would change with it.
    let mut random = Random::new(140);
    let mut row: Vec<_> = (0..48).map(|_| Rgb::from(random.triple())).collect();
    (row[0], row[17], row[18], row[19]) = (Rgb::gray(300.0), Rgb::BLACK, Rgb::BLACK, Rgb::BLACK);
    let image = Image::from_pixels(48, 24, row.repeat(24)).expect("fits");
    let environment = map(image, 0.5, 0.7);
    let light = Light::Environment(environment.clone());
    let mut ratios = Vec::new();
    for _ in 0..50_000 {
        let d = random.direction();
        let luminance = environment.radiance(d.into()).luminance();
        if d.y.abs() < 0.97 && luminance > 1e-6 {
            ratios.push(light.pdf(at(0.0, 0.0, 0.0), d, None) / luminance);
        }
    }
    assert!(ratios.len() > 40_000, "only {} directions", ratios.len());
    let mean = ratios.iter().sum::<f32>() / ratios.len() as f32;
    for ratio in ratios {
        // What a chord of the sine lacks, (pi / 24)^2 / 8, and the unit of 2^-24 that every cell has besides its share.
        assert!((ratio / mean - 1.0).abs() < 0.004, "{ratio}, not {mean}");
    }
}

#[test]
fn pairs_in_order_are_drawn_as_places_in_order() {
    let light = Light::Environment(map(picture(9), 1.0, 0.0));
    let draw = |u2| {
        // Both hemispheres, so that all directions count.
        let [up, down] = [UP, -UP].map(|n| light.sample(Reference { p: ORIGIN, n }, u2));
        let wi = if up.valid { up.wi } else { down.wi };
        // From where columns of cells begin: half a pixel before the seam, of sixteen in the half of the circle.
        let longitude = wi.x.atan2(-wi.z) + std::f32::consts::PI * (1.0 + 1.0 / 16.0);
        [longitude.rem_euclid(std::f32::consts::TAU), wi.y.acos()]
    };
    let last = 1.0 - f32::EPSILON;
    for fixed in [0.003, 0.2, 0.51, 0.77, 0.998] {
        let (mut column, mut row) = ([0.0; 2], [0.0; 2]);
        for i in 0..=4096_u16 {
            let u = (f32::from(i) / 4096.0).min(last);
            let (across, down) = (draw([u, fixed]), draw([fixed, u]));
            assert!(across[0] > column[0] - 1e-5, "across at {u}, {fixed}: {across:?} after {column:?}");
            assert!(down[1] > row[1] - 1e-3, "down at {fixed}, {u}: {down:?} after {row:?}");
            (column, row) = (across, down);
        }
    }
}

#[test]
fn a_picture_of_one_value_is_a_constant() {
    let value = Rgb::new(0.5, 1.0, 2.0);
    let even = map(Image::from_pixels(10, 5, vec![value; 50]).expect("fits"), 2.0, 0.3);
    let constant = Environment::Constant(value.scale(2.0));
    let mut random = Random::new(120);
    for _ in 0..10_000 {
        let d = random.direction();
        let off = even.radiance(d.into()) - constant.radiance(d.into());
        assert!(off.max_channel().abs() < 1e-6, "{d:?}: {off:?}");
    }
    let [even, constant] = [even, constant].map(Light::Environment);
    assert!((even.power(3.0) / constant.power(3.0) - 1.0).abs() < 1e-5, "{}", even.power(3.0));
    for (light, seed) in [(&even, 121), (&constant, 122)] {
        let tilted = Reference { p: ORIGIN, n: Vec3::new(0.48, -0.6, 0.64) };
        let found = irradiance(light, tilted, seed);
        assert!(found.agrees_with(PI), "{found:?}");
    }
}

#[test]
fn pictures_are_the_right_way_round() {
    let spot = |x: u32, y: u32, rotation: f32| {
        let mut image = Image::new(32, 16);
        image.set_pixel(x, y, Rgb::WHITE);
        map(image, 1.0, rotation)
    };
    let quarter = std::f32::consts::FRAC_PI_2;
    // The pixels beside the direction's own share of a column and row.
    let east = Point3::new(1.0, 0.05, 0.05).normalize();
    let value = spot(24, 7, 0.0).radiance(east).g;
    assert!(value > 0.4, "columns grow towards +X: {value}");
    assert!(spot(24, 7, 0.0).radiance(-east).g.to_bits() == 0, "and nowhere else");
    let ahead = Point3::new(0.05, 0.05, -1.0).normalize();
    let value = spot(16, 7, 0.0).radiance(ahead).g;
    assert!(value > 0.4, "the middle is -Z: {value}");
    let value = spot(24, 7, quarter).radiance(ahead).g;
    assert!(value > 0.4, "a quarter turn brings +X to -Z: {value}");
    let above = Point3::new(0.0, 1.0, -0.02).normalize();
    let value = spot(16, 0, 0.0).radiance(above).g;
    assert!(value > 0.4, "the top row is the zenith: {value}");
}

#[test]
fn poles_and_seam_are_finite() {
    let environment = map(picture(7), 1.0, 0.0);
    let light = Light::Environment(environment.clone());
    let tiny = [0.0, -0.0, 1e-45, -1e-45, 1e-20, -1e-20, 1e-7, -1e-7];
    for (x, z) in tiny.into_iter().flat_map(|x| tiny.into_iter().map(move |z| (x, z))) {
        for d in [[x, 1.0, z], [x, -1.0, z], [x, 0.0, 1.0], [x, 0.0, -1.0], [1.0, x, z]].map(Point3::from) {
            let (radiance, pdf) = (environment.radiance(d), light.pdf(at(0.0, 0.0, 0.0), d.into(), None));
            assert!(radiance.is_finite() && radiance.r >= 0.0, "{d}: {radiance:?}");
            assert!(pdf.is_finite() && pdf >= 0.0, "{d}: {pdf}");
        }
    }
    for u2 in corners() {
        let sample = light.sample(at(0.0, 0.0, 0.0), u2);
        assert!(!sample.valid || (sample.pdf > 0.0 && sample.pdf.is_finite()), "{u2:?}: {sample:?}");
        assert!(sample.wi.length2().is_finite() && sample.li.is_finite(), "{u2:?}: {sample:?}");
    }
}

#[test]
fn a_sun_of_one_pixel_is_drawn_as_it_shines() {
    // In the middle, at both sides of the seam, beside it, and at both poles.
    for (i, [x, y]) in [[9, 4], [0, 3], [31, 9], [30, 6], [5, 0], [17, 15]].into_iter().enumerate() {
        let mut image = Image::new(32, 16);
        image.set_pixel(x, y, Rgb::new(300.0, 200.0, 100.0));
        let environment = map(image, 1.0, 0.4);
        // All of its light, by midpoints.
        let (columns, rows) = (640_u16, 640_u16);
        let mut expected = 0.0;
        for j in 0..rows {
            let (sin, cos) = (std::f32::consts::PI * (f32::from(j) + 0.5) / f32::from(rows)).sin_cos();
            for k in 0..columns {
                let phi = std::f32::consts::TAU * (f32::from(k) + 0.5) / f32::from(columns);
                let radiance = environment.radiance(Point3::new(sin * phi.cos(), cos, sin * phi.sin()));
                expected += f64::from(radiance.g * sin) * 2.0 * PI * PI / 640.0 / 640.0;
            }
        }
        let light = Light::Environment(environment);
        let found = Estimate::of(pairs(500 + i as u32).map(|u2| {
            // Both hemispheres, so that all directions count.
            let [up, down] = [UP, -UP].map(|n| light.sample(Reference { p: ORIGIN, n }, u2));
            let sample = if up.valid { up } else { down };
            let off = light.pdf(at(0.0, 0.0, 0.0), sample.wi, None) / sample.pdf - 1.0;
            assert!(sample.li.g < 0.5 || off.abs() < 1e-3, "pixel {x} {y}: density of {sample:?}: {off}");
            if sample.valid { f64::from(sample.li.g / sample.pdf) } else { 0.0 }
        }));
        assert!((found.mean / expected - 1.0).abs() < 2e-3, "pixel {x} {y}: {found:?}, not {expected}");
        let spread = found.error * f64::from(SAMPLES).sqrt() / found.mean;
        let most = if y == 0 || y == 15 { 0.8 } else { 0.25 };
        assert!(spread < most, "pixel {x} {y}: a sample is off by {spread}");
    }
}
