//! Pass two: which pixels have windows, and the pass over them.

use super::field::Field;
use super::gather::{self, Aim, Patch, Total};
use super::gbuffer::{GBuffer, Mirror, Rgb3};
use super::half::{self, Corners};
use super::lobe::Lobe;
use super::pyramid::{Key, Pyramid};
use super::reach::reach;
use super::settings::{Correction, Fuzzy, Shape, Weighting};
use crate::image::Window;
use crate::math::lanes::{Isa, Kernel, Level};
use crate::sampling::pcg;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::f32::consts::TAU;

/// Windows below this radius, in pixels, hold nothing but their own pixel.
const SMALLEST: f32 = 0.5;

/// Radius in texels below which no window is brought, be it as long as it may.
const NARROWEST: f32 = 3.0;

/// How often a picture is halved at most.
const MOST_HALVED: f32 = 10.0;

/// Numbers beyond the last tap, so that lanes may be loaded anywhere.
const SLACK: usize = 16;

/// A part of a picture with its fuzzy reflections.
#[derive(Clone, Debug, PartialEq)]
pub struct Filtered {
    /// The pixels.
    pub window: Window,
    /// All light by row.
    pub colour: Vec<Rgb3>,
    /// Light that arrives at the reflector from the lobe, before its colour; black where there is none.
    pub reflected: Vec<Rgb3>,
}

/// Filters a part of a picture. `turn` tells the patterns of scattered taps of one picture from those of another.
///
/// Depends on picture, knobs and pixel alone, not on threads or on what part is asked for; widths of lanes agree to rounding.
///
/// # Panics
/// If the part reaches beyond the picture.
#[must_use]
pub fn filter(g: &GBuffer, window: Window, fuzzy: &Fuzzy, (level, turn): (Level, u32)) -> Filtered {
    let there = g.window;
    assert!(
        window.x0 >= there.x0 && window.y0 >= there.y0 && window.fits(there.x1, there.y1),
        "{window:?} beyond {there:?}"
    );
    let field = Field::of(g, fuzzy.correction == Correction::SolidAngle);
    let plans = Plans::of(g, window, fuzzy);
    let pyramid = Pyramid::of(g, &field, &plans.depths(g));
    let job = Job { g, fuzzy, field: &field, plans: &plans, pyramid: &pyramid, spiral: spiral(fuzzy), turn };
    let width = plans.window.width() as usize;
    let mut light = vec![[0.0; 3]; plans.window.area()];
    light.par_chunks_mut(width).zip(plans.window.y0..plans.window.y1).for_each(|(out, y)| {
        level.run(Row { job: &job, y, out });
    });
    job.finished(window, &light)
}

/// How a pixel gets its reflection.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Way {
    /// It has none.
    #[default]
    None,
    /// As it is.
    Sharp,
    /// From a window.
    Window,
    /// From pixels around that have windows.
    Between,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Plan {
    way: Way,
    /// Number of the lobe.
    lobe: u32,
    /// Half the width and height of the window, in pixels.
    radius: [f32; 2],
    /// How often the picture is halved.
    level: u32,
}

/// What is to be done for each pixel.
#[derive(Debug)]
struct Plans {
    /// The pixels asked for, and those that others are interpolated from.
    window: Window,
    pixels: Vec<Plan>,
    lobes: Vec<Lobe>,
}

impl Plans {
    fn of(g: &GBuffer, window: Window, fuzzy: &Fuzzy) -> Self {
        let margin = if fuzzy.speed.half.is_some() { 2 } else { 0 };
        let window = grown(window, margin, g.window);
        let (lobes, numbers) = lobes(g, window, fuzzy);
        let places = |y: u32| (window.x0..window.x1).map(move |x| [x, y]);
        let pixels: Vec<Plan> = (window.y0..window.y1)
            .into_par_iter()
            .flat_map_iter(places)
            .map(|at| plan(g, at, fuzzy, (&lobes, &numbers)))
            .collect();
        let mut plans = Self { window, pixels, lobes };
        if let Some(least) = fuzzy.speed.half {
            let is_between = |at: [u32; 2]| {
                let plan = plans.at(at);
                let is_wide = plan.radius[0].min(plan.radius[1]) >= least;
                plan.way == Way::Window && is_wide && !half::is_kept(at) && plans.corners(g, at).is_some()
            };
            let between: Vec<bool> =
                (window.y0..window.y1).into_par_iter().flat_map_iter(places).map(is_between).collect();
            let chosen = plans.pixels.iter_mut().zip(between).filter(|(_, between)| *between);
            chosen.for_each(|(plan, _)| plan.way = Way::Between);
        }
        plans
    }

    /// The pixels with windows that a pixel may be interpolated from.
    fn corners(&self, g: &GBuffer, at: [u32; 2]) -> Option<Corners> {
        let mirror = g.texel(at[0], at[1])?.mirror.as_ref()?;
        let radius = |[x, y]: [u32; 2]| {
            let plan = self.window.contains(x, y).then(|| self.at([x, y]))?;
            (plan.way == Way::Window).then_some(plan.radius)
        };
        half::corners(g, at, (mirror, self.at(at).radius), radius)
    }

    fn at(&self, [x, y]: [u32; 2]) -> &Plan {
        let width = self.window.width() as usize;
        &self.pixels[(y - self.window.y0) as usize * width + (x - self.window.x0) as usize]
    }

    /// What is mixed in texels for a pixel: its reflector, but for normals that its own lobe keeps apart.
    fn key(&self, mirror: &Mirror, plan: &Plan) -> Key {
        Key::new(mirror.reflector, self.lobes[plan.lobe as usize].normals_apart())
    }

    /// How often what is mixed is halved at most; what is not halved is left out.
    fn depths(&self, g: &GBuffer) -> BTreeMap<Key, u32> {
        let mut depths = BTreeMap::new();
        for y in self.window.y0..self.window.y1 {
            for x in self.window.x0..self.window.x1 {
                let plan = self.at([x, y]);
                if let Some(mirror) =
                    g.texel(x, y).and_then(|texel| texel.mirror.as_ref()).filter(|_| plan.level > 0)
                {
                    let halvings = depths.entry(self.key(mirror, plan)).or_insert(0);
                    *halvings = plan.level.max(*halvings);
                }
            }
        }
        depths
    }
}

/// The lobes of a part of a picture, each once, and the number of each by the bits of its exponent.
fn lobes(g: &GBuffer, window: Window, fuzzy: &Fuzzy) -> (Vec<Lobe>, BTreeMap<u32, u32>) {
    let (mut lobes, mut numbers, mut last) = (Vec::new(), BTreeMap::new(), None);
    for y in window.y0..window.y1 {
        for x in window.x0..window.x1 {
            let Some(mirror) = g.texel(x, y).and_then(|texel| texel.mirror.as_ref()) else { continue };
            let bits = mirror.exponent.to_bits();
            if last.replace(bits) == Some(bits) {
                continue;
            }
            numbers.entry(bits).or_insert_with(|| {
                let more = if fuzzy.correction == Correction::Cosine { 3.0 } else { 0.0 };
                let lobe = Lobe::new(mirror.exponent + more, fuzzy.lost_mass, fuzzy.max_angle);
                lobes.push(if fuzzy.speed.table { lobe.tabulated() } else { lobe });
                u32::try_from(lobes.len() - 1).unwrap_or(0)
            });
        }
    }
    (lobes, numbers)
}

fn plan(
    g: &GBuffer,
    [x, y]: [u32; 2],
    fuzzy: &Fuzzy,
    (lobes, numbers): (&[Lobe], &BTreeMap<u32, u32>),
) -> Plan {
    let Some(mirror) = g.texel(x, y).and_then(|texel| texel.mirror.as_ref()) else { return Plan::default() };
    let lobe = numbers.get(&mirror.exponent.to_bits()).copied().unwrap_or(0);
    let radius = reach(g, [x, y], mirror, (&lobes[lobe as usize], fuzzy));
    let [short, long] = [radius[0].min(radius[1]), radius[0].max(radius[1])];
    let has_way = mirror.direction().is_some() && long.is_finite();
    if !has_way || (fuzzy.speed.skip && long < SMALLEST) {
        return Plan { way: Way::Sharp, lobe, ..Plan::default() };
    }
    Plan {
        way: Way::Window,
        lobe,
        radius,
        level: fuzzy.speed.pyramid.map_or(0, |target| halvings([short, long], target)),
    }
}

/// How often the picture is halved for a window, for a radius of `target` texels or a little more.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "limited to a few")]
fn halvings([short, long]: [f32; 2], target: f32) -> u32 {
    let by_area = ((short * long).sqrt() / target.max(1.0)).log2();
    let by_width = (short / NARROWEST).log2();
    by_area.min(by_width).clamp(0.0, MOST_HALVED) as u32
}

/// How many pixels beyond a pixel on each side, at most, what is filtered for it reads.
///
/// A window reaches as far as its radius; in a smaller picture half a texel farther, by a tap that may lie on the border of its texel, all of which counts. A
/// pixel between filtered ones has theirs, two pixels off, and areas are told by neighbours.
#[must_use]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of pixels")]
pub fn margin(fuzzy: &Fuzzy) -> u32 {
    // As `halvings` has it.
    let texel = fuzzy.speed.pyramid.map_or(0.0, |target| fuzzy.max_radius / target.max(NARROWEST));
    (fuzzy.max_radius + 1.5 * texel).ceil() as u32 + 4
}

/// A window with a margin, as far as there are pixels.
fn grown(window: Window, margin: u32, most: Window) -> Window {
    Window {
        x0: window.x0.saturating_sub(margin).max(most.x0),
        y0: window.y0.saturating_sub(margin).max(most.y0),
        x1: window.x1.saturating_add(margin).min(most.x1),
        y1: window.y1.saturating_add(margin).min(most.y1),
    }
}

/// Places of equal area in the unit disc, along a spiral by the golden angle; none if all pixels count.
fn spiral(fuzzy: &Fuzzy) -> [Vec<f32>; 2] {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let count = fuzzy.speed.taps.unwrap_or(0);
    let place = |k: u32| {
        let (k, count) = (f64::from(k), f64::from(count));
        let (sin, cos) = (k * GOLDEN_ANGLE).sin_cos();
        let radius = ((k + 0.5) / count).sqrt();
        [radius * cos, radius * sin]
    };
    #[expect(clippy::cast_possible_truncation, reason = "places of a disc")]
    let axis =
        |i: usize| (0..count).map(|k| place(k)[i] as f32).chain(std::iter::repeat_n(0.0, SLACK)).collect();
    [axis(0), axis(1)]
}

/// All that a row needs.
struct Job<'a> {
    g: &'a GBuffer,
    fuzzy: &'a Fuzzy,
    field: &'a Field,
    plans: &'a Plans,
    pyramid: &'a Pyramid,
    spiral: [Vec<f32>; 2],
    turn: u32,
}

/// The windows of a row of pixels.
struct Row<'a> {
    job: &'a Job<'a>,
    y: u32,
    out: &'a mut [Rgb3],
}

impl<S: Isa> Kernel<S> for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, isa: S) {
        let Self { job, y, out } = self;
        for (out, x) in out.iter_mut().zip(job.plans.window.x0..) {
            let plan = job.plans.at([x, y]);
            let Some(mirror) = job.g.texel(x, y).and_then(|texel| texel.mirror.as_ref()) else { continue };
            *out = match plan.way {
                Way::None | Way::Between => continue,
                Way::Sharp => mirror.radiance,
                Way::Window => job.window(isa, [x, y], mirror, plan).mean().unwrap_or(mirror.radiance),
            };
        }
    }
}

impl Job<'_> {
    /// The sums over the window of a pixel.
    #[inline(always)]
    fn window<S: Isa>(&self, isa: S, [x, y]: [u32; 2], mirror: &Mirror, plan: &Plan) -> Total {
        let Some(w) = mirror.direction() else { return Total::default() };
        let aim = Aim {
            a: mirror.a.to_array(),
            w: w.to_array(),
            n: mirror.normal.to_array(),
            id: mirror.reflector,
            lobe: &self.plans.lobes[plan.lobe as usize],
            rejection: self.fuzzy.speed.rejection,
        };
        let mut total = Total::default();
        for field in self.pyramid.fields(self.plans.key(mirror, plan), plan.level) {
            self.add(isa, (field, &aim, &self.patch([x, y], plan, plan.level)), [x, y], &mut total);
        }
        // Whole pixels, too, where no texel is of nothing but this face.
        if total.mean().is_none() {
            self.add(isa, (self.field, &aim, &self.patch([x, y], plan, 0)), [x, y], &mut total);
        }
        total
    }

    /// The window of a pixel in a picture that was halved `level` times.
    fn patch(&self, [x, y]: [u32; 2], plan: &Plan, level: u32) -> Patch {
        let texel = 0.5_f32.powi(level.cast_signed());
        // A texel that is cut by the outline counts; what of it lies outside of the lobe is told by its middle.
        let margin = if level > 0 { 0.5 } else { 0.0 };
        Patch {
            middle: [(x as f32 + 0.5) * texel, (y as f32 + 0.5) * texel],
            radius: [plan.radius[0] * texel + margin, plan.radius[1] * texel + margin],
            round: self.fuzzy.shape == Shape::Round,
        }
    }

    #[inline(always)]
    fn add<S: Isa>(
        &self,
        isa: S,
        (field, aim, patch): (&Field, &Aim<'_>, &Patch),
        [x, y]: [u32; 2],
        total: &mut Total,
    ) {
        let taps = self.fuzzy.speed.taps.unwrap_or(u32::MAX);
        let area = std::f32::consts::PI * patch.radius[0] * patch.radius[1];
        if taps as f32 >= area {
            gather::patch(isa, field, aim, patch, total);
            return;
        }
        let [random, _] = pcg::pcg2d([x ^ self.turn.wrapping_mul(0x9e37_79b9), y]);
        let (sin, cos) = ((random >> 8) as f32 * (TAU / 16_777_216.0)).sin_cos();
        let [u, v] = &self.spiral;
        gather::scattered(isa, (field, aim, patch), ([u, v], taps as usize), [cos, sin], total);
    }

    /// The part of the picture, from the light of all pixels with a window or none.
    fn finished(&self, window: Window, light: &[Rgb3]) -> Filtered {
        let whole = self.plans.window;
        let of = |[x, y]: [u32; 2]| {
            light[(y - whole.y0) as usize * whole.width() as usize + (x - whole.x0) as usize]
        };
        let mut filtered = Filtered { window, colour: Vec::new(), reflected: Vec::new() };
        for y in window.y0..window.y1 {
            for x in window.x0..window.x1 {
                let reflected = match self.plans.at([x, y]).way {
                    Way::Between => self.between([x, y], of),
                    _ => of([x, y]),
                };
                filtered.reflected.push(reflected);
                filtered.colour.push(self.composed([x, y], reflected));
            }
        }
        filtered
    }

    /// Light between the pixels around that have windows, given theirs.
    fn between(&self, at: [u32; 2], of: impl Fn([u32; 2]) -> Rgb3) -> Rgb3 {
        let mut sum = [0.0; 3];
        let corners = self.plans.corners(self.g, at).into_iter().flatten();
        for (at, weight) in corners.filter(|(_, weight)| *weight > 0.0) {
            sum.iter_mut().zip(of(at)).for_each(|(sum, light)| *sum += weight * light);
        }
        sum
    }

    /// All light of a pixel whose reflector is lit like this.
    fn composed(&self, [x, y]: [u32; 2], reflected: Rgb3) -> Rgb3 {
        let Some(texel) = self.g.texel(x, y) else { return [0.0; 3] };
        let Some(mirror) = &texel.mirror else { return texel.rest };
        let strength = match self.fuzzy.weighting {
            Weighting::Phong => 1.0,
            Weighting::Shininess => mirror.strength,
        };
        [0, 1, 2].map(|i| texel.rest[i] + strength * mirror.factor[i] * reflected[i])
    }
}
