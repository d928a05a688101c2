//! CPU seconds of pass two for a megapixel.

use crate::first_passes::parallel;
use specula::image::Window;
use specula::math::lanes::Level;
use specula::post::{Filtered, Fuzzy, GBuffer, Lobe, Rejection, Speed, filter};
use specula::render::Phase;

/// Exponent of the lobe: 10 degrees hold all but a hundredth.
const EXPONENT: f32 = 300.0;

/// Radii of windows in pixels; at the first there is nothing but pixels by themselves.
const RADII: [f32; 5] = [0.4, 4.0, 16.0, 64.0, 160.0];

/// Passes, of which the median counts.
const PASSES: usize = 3;

/// Pixels of windows that are looked at for a time, about: more are told from a part of the picture.
const BUDGET: f64 = 5e8;

/// A filter, and how many pixels of a window of this area it looks at.
type Contestant = (&'static str, Speed, fn(f64) -> f64);

fn contestants() -> Vec<Contestant> {
    let plain = Speed::PLAIN;
    let pyramid = Speed { pyramid: Some(12.0), ..plain };
    let all = |area: f64| area;
    let few = |area: f64| area.min(400.0);
    vec![
        ("plain", plain, all),
        ("skip off", Speed { skip: false, ..plain }, all),
        ("by angle", Speed { rejection: Rejection::Angle, ..plain }, all),
        ("table", Speed { table: true, ..plain }, all),
        ("200 taps", Speed { taps: Some(200), ..plain }, |area| area.min(2000.0)),
        ("1000 taps", Speed { taps: Some(1000), ..plain }, |area| area.min(10_000.0)),
        ("pyramid 8", Speed { pyramid: Some(8.0), ..plain }, few),
        ("pyramid 12", pyramid, few),
        ("pyramid 16", Speed { pyramid: Some(16.0), ..plain }, few),
        ("half", Speed { half: Some(8.0), ..plain }, all),
        ("pyramid 8, half", Speed { half: Some(8.0), pyramid: Some(8.0), ..plain }, few),
        ("pyramid 12, half", Speed { half: Some(8.0), ..pyramid }, few),
        ("pyramid 12, half, table", Speed { half: Some(8.0), table: true, ..pyramid }, few),
    ]
}

/// Prints the table, or what of it is of one radius.
pub(crate) fn table(is_bench: bool, only: &str) {
    let size = if is_bench { 1024 } else { 64 };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    println!("radius px | way | CPU s per megapixel | added relMSE\n---|---|---|---");
    one.install(|| {
        for radius in if is_bench { &RADII[..] } else { &RADII[1..2] } {
            if !only.is_empty() && only.parse() != Ok(*radius) {
                continue;
            }
            let g = picture(size, *radius);
            for (name, time, error) in measured(&g, *radius) {
                println!("{radius} | {name} | {time:.3} | {error:.2e}");
            }
        }
    });
    if is_bench && only.is_empty() {
        beside(size);
    }
}

/// What lanes gain in CPU time, and threads by the clock.
fn beside(size: u32) {
    println!(
        "\nradius px | way | lanes: CPU s of one lane over {} | threads: wall s of one over two",
        Level::best().name()
    );
    println!("---|---|---|---");
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let [one, two] = [pool(1), pool(2)];
    for radius in [4.0, 16.0, 64.0] {
        let g = picture(size, radius);
        for (name, speed, looked) in
            contestants().into_iter().filter(|(name, ..)| ["plain", "pyramid 8, half"].contains(name))
        {
            let area = looked(std::f64::consts::PI * f64::from(radius).powi(2));
            let window = rows(&g, 10.0 * area);
            let time = |level: Level, pool: &rayon::ThreadPool| {
                let fuzzy = Fuzzy { speed, ..Fuzzy::default() };
                pool.install(|| Phase::of(|| filter(&g, window, &fuzzy, (level, 0))).1)
            };
            let mut ratios = [Vec::new(), Vec::new()];
            for _ in 0..PASSES {
                let (wide, narrow) = (time(Level::best(), &one), time(Level::available()[0], &one));
                ratios[0].push(narrow.cpu.as_secs_f64() / wide.cpu.as_secs_f64());
                ratios[1].push(wide.wall.as_secs_f64() / time(Level::best(), &two).wall.as_secs_f64());
            }
            let [lanes, threads] = ratios.map(|mut ratios| {
                ratios.sort_by(f64::total_cmp);
                ratios[PASSES / 2]
            });
            println!("{radius} | {name} | {lanes:.2} | {threads:.2}");
        }
    }
}

/// As many rows of the middle as take no more than a while, if that many pixels are looked at for each.
fn rows(g: &GBuffer, looked: f64) -> Window {
    let part = (BUDGET / (g.window.area() as f64 * looked)).min(1.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rows of a picture")]
    let rows = (part * f64::from(g.window.height())).ceil() as u32;
    let middle = g.window.height() / 2;
    Window { y0: middle - rows / 2, y1: middle - rows / 2 + rows, ..g.window }
}

/// A checkered plane and a slope under windows of that radius.
fn picture(size: u32, radius: f32) -> GBuffer {
    let fields = |x: f32| (x * 4.0).rem_euclid(2.0) < 1.0;
    let light = |b: glam::Vec3| [if fields(b.x) == fields(b.y + 0.13) { 1.0 } else { 0.1 }, 0.5, b.x.abs()];
    let pitch = Lobe::new(EXPONENT, 0.01, 1.5).angle().tan() / radius;
    parallel(([size, size], pitch), EXPONENT, light)
}

/// Name, time and error of each.
fn measured(g: &GBuffer, radius: f32) -> Vec<(&'static str, f64, f64)> {
    let contestants = contestants();
    let pixels = g.window.area() as f64;
    let area = std::f64::consts::PI * f64::from(radius).powi(2);
    let of = |speed: Speed, window: Window| -> (Filtered, f64) {
        let fuzzy = Fuzzy { speed, ..Fuzzy::default() };
        let (found, time) = Phase::of(|| filter(g, window, &fuzzy, (Level::best(), 0)));
        (found, time.cpu.as_secs_f64())
    };
    let mut times = vec![Vec::new(); contestants.len()];
    let mut errors = vec![0.0; contestants.len()];
    let (plain, _) = of(Speed::PLAIN, rows(g, area));
    for _ in 0..PASSES {
        for (i, &(_, speed, looked)) in contestants.iter().enumerate() {
            let window = rows(g, looked(area));
            // What is done for the whole picture, whatever part is asked for.
            let row = Window { y1: window.y0 + 1, ..window };
            let part = pixels / window.area() as f64;
            let fixed = if part > 1.0 { of(speed, row).1 } else { 0.0 };
            let (found, time) = of(speed, window);
            times[i].push((time - fixed).max(0.0) * part + fixed);
            errors[i] = relative_error(&found, &plain);
        }
    }
    let megapixel = 1e6 / pixels;
    let named = contestants.iter().zip(&mut times).zip(errors);
    named
        .map(|(((name, ..), times), error)| {
            times.sort_by(f64::total_cmp);
            (*name, times[times.len() / 2] * megapixel, error)
        })
        .collect()
}

/// relMSE over the pixels that both have.
fn relative_error(a: &Filtered, b: &Filtered) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for y in a.window.y0.max(b.window.y0)..a.window.y1.min(b.window.y1) {
        for x in 0..a.window.width() {
            let of = |it: &Filtered| it.reflected[((y - it.window.y0) * it.window.width() + x) as usize];
            for (a, b) in of(a).into_iter().zip(of(b)) {
                let (a, b) = (f64::from(a), f64::from(b));
                sum += (a - b).powi(2) / (b * b + 0.01);
                count += 1.0;
            }
        }
    }
    sum / count
}
