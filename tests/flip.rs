//! FLIP against the numbers of its authors' implementation.
//!
//! The tables were made by the Python package `flip-evaluator` 1.7 (Andersson et al.) from pictures that formulas give,
//! and from pictures of other renderers where they are at hand. Errors are compared at single pixels, not only in the
//! mean: a mean forgives a shifted map.

#[path = "support/data.rs"]
mod data;

use data::data;
use specula::image::Image;
use specula::math::Rgb;
use specula::math::lanes::Level;
use specula::measure::flip::{self, Exposures, Viewing, Watch};
use specula::render::{Progress, Silent};
use std::sync::atomic::{AtomicU64, Ordering};

/// What means are held to against the formulas in double precision.
const EXACT_BOUND: f64 = 3e-6;

/// What means and pixels are held to against the authors' program. It computes in single precision, and the error of
/// features is a square root: where edges are equally strong, its rounding of 1e-8 is seen as 1e-4. (Of a picture of one
/// pixel the formulas give 0.5850741, that program 0.5851094.)
const BOUNDS: [f64; 2] = [4e-5, 2e-4];

/// What pixels of two instruction sets are held to: where the feature error is the root of a rounding error, both are off by
/// up to 3e-4. Their means are held to `EXACT_BOUND`.
const LANES_BOUND: f64 = 1e-3;

type Light = fn(u32, u32, u32) -> f64;

/// A picture of reference and a test, and what the authors' program says of them.
struct Case {
    name: &'static str,
    scene_light: bool,
    reference: Light,
    test: Light,
    size: [u32; 2],
    pixels_per_degree: Option<f64>,
    /// The mean by the formulas of the paper in double precision.
    exact: f64,
    mean: f64,
    greatest: f64,
    /// At the middle, the first pixel, the last one, and a third to the right and a quarter down.
    at: [f64; 4],
    /// First, last, how many.
    exposures: Option<(f64, f64, u32)>,
}

/// A number in [0, 1) for each pixel, channel and seed: multiply and shift, as of 32-bit integers.
fn unit(x: u32, y: u32, c: u32, seed: u32) -> f64 {
    let mut v = x
        .wrapping_mul(0x9E37_79B1)
        .wrapping_add(y.wrapping_mul(0x85EB_CA77))
        .wrapping_add(c.wrapping_mul(0xC2B2_AE3D))
        .wrapping_add(seed.wrapping_mul(0x27D4_EB2F));
    v ^= v >> 15;
    v = v.wrapping_mul(0x2C1B_3C6D);
    v ^= v >> 12;
    v = v.wrapping_mul(0x297A_2D39);
    v ^= v >> 15;
    f64::from(v >> 8) / f64::from(1 << 24)
}

fn ramp(x: u32, y: u32, c: u32) -> f64 {
    f64::from((x * 3 + y * 5 + c * 40) % 256) / 256.0
}

fn noisy<const SEED: u32>(x: u32, y: u32, c: u32) -> f64 {
    (ramp(x, y, c) + (unit(x, y, c, SEED) - 0.5) / 4.0).clamp(0.0, 1.0)
}

fn board<const MOVED: u32>(x: u32, y: u32, _c: u32) -> f64 {
    f64::from(((x + MOVED) / 8 + y / 8) % 2) * 0.75 + 0.125
}

fn colours<const STEP: u32>(x: u32, y: u32, c: u32) -> f64 {
    f64::from(u8::from((x / 16 + y / 16 + c * STEP).is_multiple_of(3)))
}

fn grey<const SEED: u32>(x: u32, y: u32, _c: u32) -> f64 {
    unit(x / 4, y / 4, 0, SEED)
}

fn dot<const ON: u32>(x: u32, y: u32, _c: u32) -> f64 {
    if (x, y) == (20, 11) { f64::from(ON) } else { 0.25 }
}

fn stops<const SEED: u32>(x: u32, y: u32, c: u32) -> f64 {
    f64::from((x / 8 + y / 6) % 12).exp2() / 64.0 * (0.5 + unit(x, y, c, SEED))
}

fn lamps<const SEED: u32>(x: u32, y: u32, c: u32) -> f64 {
    let lamp = if x % 37 < 3 && y % 29 < 3 { 200.0 } else { 0.0 };
    lamp + 0.0625 * f64::from(1 + c) + (unit(x, y, c, SEED) - 0.5) / 16.0
}

fn no_lamps(x: u32, y: u32, c: u32) -> f64 {
    let light = lamps::<1>(x, y, c);
    if light < 1.0 { light } else { 0.0 }
}

fn half_dark(x: u32, y: u32, c: u32) -> f64 {
    if x < y { unit(x, y, c, 2) * 4.0 } else { 0.0 }
}

fn half_dim(x: u32, y: u32, c: u32) -> f64 {
    (if x < y { unit(x, y, c, 1) * 4.0 } else { 0.0 }) + 0.001
}

#[expect(clippy::too_many_lines, reason = "a table")]
fn cases() -> [Case; 14] {
    let displayed = |name, reference: Light, test: Light, size, [exact, mean, greatest]: [f64; 3], at| Case {
        name,
        scene_light: false,
        reference,
        test,
        size,
        pixels_per_degree: None,
        exact,
        mean,
        greatest,
        at,
        exposures: None,
    };
    let exposed = |name, reference: Light, test: Light, size, numbers: [f64; 3], at, exposures| Case {
        scene_light: true,
        exposures: Some(exposures),
        ..displayed(name, reference, test, size, numbers, at)
    };
    let seen_from = |pixels_per_degree, case| Case { pixels_per_degree: Some(pixels_per_degree), ..case };
    [
        displayed(
            "ramp and noise",
            ramp,
            noisy::<1>,
            [150, 90],
            [0.122_361_4, 0.122_361_4, 0.384_629_8],
            [0.110_286_7, 0.308_143_0, 0.260_255_4, 0.064_122_4],
        ),
        displayed(
            "board moved",
            board::<0>,
            board::<1>,
            [70, 40],
            [0.219_784_3, 0.219_793_7, 0.604_430_1],
            [0.000_000_0, 0.000_000_0, 0.000_000_0, 0.432_284_1],
        ),
        displayed(
            "colours exchanged",
            colours::<1>,
            colours::<2>,
            [64, 48],
            [0.854_242_8, 0.854_243_3, 1.000_000_0],
            [0.981_989_9, 0.000_000_0, 1.000_000_0, 0.992_556_0],
        ),
        displayed(
            "grey",
            grey::<1>,
            grey::<2>,
            [131, 65],
            [0.483_583_9, 0.483_584_3, 0.972_279_0],
            [0.602_652_6, 0.327_473_8, 0.268_919_4, 0.337_079_4],
        ),
        displayed(
            "one dot",
            dot::<0>,
            dot::<1>,
            [40, 24],
            [0.004_659_5, 0.004_659_9, 0.412_260_3],
            [0.312_707_9, 0.000_000_0, 0.000_000_0, 0.000_000_0],
        ),
        displayed(
            "one pixel",
            dot::<0>,
            ramp,
            [1, 1],
            [0.585_074_1, 0.585_109_4, 0.585_109_4],
            [0.585_109_4, 0.585_109_4, 0.585_109_4, 0.585_109_4],
        ),
        displayed(
            "three by two",
            ramp,
            noisy::<2>,
            [3, 2],
            [0.272_484_7, 0.272_484_7, 0.416_208_1],
            [0.228_663_9, 0.233_328_5, 0.384_364_8, 0.253_495_9],
        ),
        seen_from(
            20.0,
            displayed(
                "ramp and noise, near",
                ramp,
                noisy::<1>,
                [150, 90],
                [0.317_626_5, 0.317_626_5, 0.674_564_5],
                [0.443_640_4, 0.294_127_9, 0.322_394_8, 0.293_750_8],
            ),
        ),
        seen_from(
            180.0,
            displayed(
                "ramp and noise, far",
                ramp,
                noisy::<1>,
                [150, 90],
                [0.063_172_0, 0.063_172_0, 0.216_827_2],
                [0.055_995_0, 0.155_769_2, 0.167_409_4, 0.049_410_8],
            ),
        ),
        exposed(
            "stops",
            stops::<1>,
            stops::<2>,
            [150, 90],
            [0.186_768_8, 0.186_768_8, 0.503_287_0],
            [0.135_855_0, 0.108_400_7, 0.239_438_3, 0.233_500_8],
            (-4.456_274_0, 1.823_424_3, 7),
        ),
        exposed(
            "lamps",
            lamps::<1>,
            lamps::<2>,
            [90, 70],
            [0.134_805_3, 0.134_805_3, 0.369_747_3],
            [0.054_523_8, 0.004_678_4, 0.207_709_7, 0.193_103_9],
            (-6.561_583_0, 4.184_855_9, 11),
        ),
        exposed(
            "lamps against none",
            lamps::<1>,
            no_lamps,
            [90, 70],
            [0.056_174_6, 0.056_176_2, 0.992_479_4],
            [0.000_026_5, 0.991_317_9, 0.000_000_0, 0.000_000_0],
            (-6.561_583_0, 4.184_855_9, 11),
        ),
        exposed(
            "half dark",
            half_dim,
            half_dark,
            [60, 64],
            [0.212_009_8, 0.212_009_8, 0.762_566_3],
            [0.363_645_7, 0.300_062_3, 0.491_539_2, 0.047_972_3],
            (-0.892_865_7, 1.854_461_7, 3),
        ),
        seen_from(
            30.0,
            exposed(
                "stops, near",
                stops::<1>,
                stops::<2>,
                [150, 90],
                [0.351_185_2, 0.351_185_2, 0.805_863_9],
                [0.560_271_9, 0.067_615_2, 0.285_686_2, 0.452_511_0],
                (-4.456_274_0, 1.823_424_3, 7),
            ),
        ),
    ]
}

#[expect(clippy::cast_possible_truncation, reason = "pictures are single precision")]
fn picture(light: Light, [width, height]: [u32; 2]) -> Image {
    let mut picture = Image::new(width, height);
    for y in 0..height {
        for x in 0..width {
            let [r, g, b] = [0, 1, 2].map(|c| light(x, y, c) as f32);
            picture.set_pixel(x, y, Rgb::new(r, g, b));
        }
    }
    picture
}

fn watch(level: Level) -> Watch<'static> {
    Watch { level, progress: &Silent }
}

/// The error of each pixel.
fn errors(case: &Case, level: Level) -> Vec<f64> {
    let (test, reference) = (picture(case.test, case.size), picture(case.reference, case.size));
    let viewing = case
        .pixels_per_degree
        .map_or_else(Viewing::default, |pixels_per_degree| Viewing { pixels_per_degree });
    let errors = if case.scene_light {
        let exposures = Exposures::of(&reference).expect("some light");
        flip::exposed([&test, &reference], viewing, &exposures, watch(level))
    } else {
        flip::displayed([&test, &reference], viewing, watch(level))
    };
    errors.expect("nobody interrupts").into_iter().map(f64::from).collect()
}

#[expect(clippy::cast_precision_loss, reason = "few pixels")]
fn mean(errors: &[f64]) -> f64 {
    errors.iter().sum::<f64>() / errors.len() as f64
}

#[test]
fn errors_are_those_of_the_authors() {
    for case in cases() {
        let errors = errors(&case, Level::best());
        let near = |what: &str, found: f64, wanted: f64, bound: f64| {
            assert!((found - wanted).abs() < bound, "{}: {what} {found} instead of {wanted}", case.name);
        };
        println!("{}: off by {:.1e}", case.name, mean(&errors) - case.exact);
        near("exact mean", mean(&errors), case.exact, EXACT_BOUND);
        near("mean", mean(&errors), case.mean, BOUNDS[0]);
        near("greatest", errors.iter().copied().fold(0.0, f64::max), case.greatest, BOUNDS[1]);
        let [width, height] = case.size;
        let places = [(width / 2, height / 2), (0, 0), (width - 1, height - 1), (width / 3, height / 4)];
        for ((x, y), wanted) in places.into_iter().zip(case.at) {
            near(&format!("({x}, {y})"), errors[(y * width + x) as usize], wanted, BOUNDS[1]);
        }
    }
}

#[test]
fn exposures_are_those_of_the_authors() {
    for case in cases() {
        let Some((start, stop, count)) = case.exposures else { continue };
        let found = Exposures::of(&picture(case.reference, case.size)).expect("some light");
        assert!((found.start - start).abs() < 1e-5, "{}: {found:?} instead of {start}", case.name);
        assert!((found.stop - stop).abs() < 1e-5, "{}: {found:?} instead of {stop}", case.name);
        assert_eq!(found.count, count, "{}: {found:?}", case.name);
    }
}

/// Pictures by other renderers, and the authors' mean of the second against the first.
const PAIRS: [(&str, &str, f64); 4] = [
    ("peer-scenes/cornell/reference.exr", "peer-scenes/cornell/witness.exr", 0.034_754_0),
    ("peer-scenes/glossyrow/reference.exr", "peer-scenes/glossyrow/witness.exr", 0.010_393_5),
    (
        "scenes/mitsuba-tests/bsdf_spheres/refs/test_roughplastic_nonlinear_ref_rgb.exr",
        "scenes/mitsuba-tests/bsdf_spheres/refs/test_roughplastic_linear_ref_rgb.exr",
        0.293_962_1,
    ),
    (
        "scenes/mitsuba-tests/bsdf_spheres/refs/test_roughdielectric_ref_rgb.exr",
        "scenes/mitsuba-tests/bsdf_spheres/refs/test_normalmap_ref_rgb.exr",
        0.665_313_3,
    ),
];

#[test]
fn means_of_rendered_pictures_are_those_of_the_authors() {
    for (reference, name, wanted) in PAIRS {
        let [Some(test), Some(reference)] = [name, reference].map(data) else { continue };
        let [test, reference] =
            [test, reference].map(|path| specula::image::read(&path).expect("read").image);
        let exposures = Exposures::of(&reference).expect("some light");
        let errors = flip::exposed([&test, &reference], Viewing::default(), &exposures, watch(Level::best()));
        let errors: Vec<f64> = errors.expect("nobody interrupts").into_iter().map(f64::from).collect();
        assert!((mean(&errors) - wanted).abs() < BOUNDS[0], "{name}: {} instead of {wanted}", mean(&errors));
    }
}

#[test]
fn all_instruction_sets_see_the_same() {
    for case in cases() {
        let wanted = errors(&case, Level::best());
        for level in Level::available() {
            let found = errors(&case, level);
            let off = found.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < LANES_BOUND, "{} at {}: off by {off}", case.name, level.name());
            let off = (mean(&found) - mean(&wanted)).abs();
            assert!(off < EXACT_BOUND, "{} at {}: mean off by {off}", case.name, level.name());
        }
    }
}

#[test]
fn pictures_of_displays_may_be_exchanged() {
    for case in cases().into_iter().filter(|case| !case.scene_light) {
        let there = errors(&case, Level::best());
        let back = errors(&Case { reference: case.test, test: case.reference, ..case }, Level::best());
        assert_eq!(there, back, "symmetric");
    }
}

#[test]
fn more_noise_is_a_greater_error_and_distance_hides_it() {
    let reference = picture(ramp, [96, 64]);
    let error = |amplitude: f32, pixels_per_degree: f64| {
        let mut test = reference.clone();
        let noise = picture(|x, y, c| unit(x, y, c, 9) - 0.5, [96, 64]);
        for (light, noise) in test.pixels_mut().iter_mut().zip(noise.pixels()) {
            *light += noise.scale(amplitude);
        }
        let errors =
            flip::displayed([&test, &reference], Viewing { pixels_per_degree }, watch(Level::best()));
        mean(&errors.expect("nobody interrupts").into_iter().map(f64::from).collect::<Vec<_>>())
    };
    let by_amplitude = [0.0, 0.01, 0.03, 0.1, 0.3].map(|amplitude| error(amplitude, 67.0));
    assert!(by_amplitude.is_sorted_by(|a, b| a < b) && by_amplitude[0].abs() < 1e-12, "{by_amplitude:?}");
    let by_distance = [200.0, 100.0, 50.0, 20.0, 8.0].map(|ppd| error(0.1, ppd));
    assert!(by_distance.is_sorted_by(|a, b| a < b), "{by_distance:?}");
}

#[test]
fn constant_pictures_differ_by_their_colours_alone() {
    // Without edges the error is that of colour: black and white are 100 units of lightness apart, whose power 0.7 is 25.1
    // of the 41.28 that green and blue are apart, beyond the break at 0.4.
    let size = [200, 70];
    let [black, white] = [picture(|_, _, _| 0.0, size), picture(|_, _, _| 1.0, size)];
    let errors = flip::displayed([&black, &white], Viewing::default(), watch(Level::best()));
    let part = 100.0_f64.powf(0.7) / 41.276_098;
    let wanted = 0.95 + 0.05 * (part - 0.4) / 0.6;
    for error in errors.expect("nobody interrupts") {
        assert!((f64::from(error) - wanted).abs() < 1e-5, "{error} instead of {wanted}");
    }
}

#[test]
fn whoever_watches_is_told_all_pixels_and_may_stop_it() {
    struct Count(AtomicU64, bool);
    impl Progress for Count {
        fn advance(&self, done: u64, _total: u64) {
            self.0.fetch_max(done, Ordering::Relaxed);
        }
        fn is_cancelled(&self) -> bool {
            self.1
        }
    }
    let image = picture(ramp, [300, 100]);
    let run = |count: &Count| {
        let watch = Watch { level: Level::best(), progress: count };
        flip::displayed([&image, &image], Viewing::default(), watch)
    };
    let count = Count(AtomicU64::new(0), false);
    assert!(run(&count).is_ok(), "done");
    assert_eq!(count.0.into_inner(), 30_000, "told");
    let stopped = run(&Count(AtomicU64::new(0), true));
    assert!(matches!(stopped, Err(specula::error::Error::Interrupted)), "stopped");
}
