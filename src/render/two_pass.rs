//! Pictures whose fuzzy reflections are filtered: a first pass of mirrors, then `post::filter`.
//!
//! Each sample of the pixels is a picture of its own, filtered by itself: no pixel of it is a mean, so that places, directions and
//! numbers of reflectors are what one ray saw, and nothing bleeds over edges; the film then takes means of filtered pictures, as it
//! does of samples. Means of equal reflectors, filtered once, would be cheaper by the number of samples and would have to give up the
//! pixels on edges, where samples differ. Within a picture all rays are moved on the film by the same distance, that of the sample's number in
//! a sequence, and go through the same point of the lens at the same moment: the filter takes pixels for equal areas, and differences of
//! neighbours for differentials, which they are only in a grid.
//!
//! A crop is traced with a margin as wide as the widest window may be, so that its pixels do not depend on it.

use crate::accel::Accel;
use crate::error::{Error, Problem, Result};
use crate::film::FilterSample;
use crate::film::{SampleId, Seen, Tile};
use crate::geometry::Ray;
use crate::image::Window;
use crate::integrator::{CameraRay, Counters, Features, FirstPass, Radiance, Reflection, Whitted, Worker};
use crate::math::Rgb;
use crate::post::{self, End, Filtered, Fuzzy, GBuffer, Mirror, Texel};
use crate::render::eye::Eye;
use crate::render::keeping::Running;
use crate::render::query::level;
use crate::render::samples::CameraSamples;
use crate::render::tiles::{Plan, outputs, tiles};
use crate::render::{Ended, Phase, Rendered, Settings, State, Statistics};
use crate::sampling::{Dim, Sampler, Vertex};
use crate::scene::Scene;
use crate::scene::description::{FuzzyBy, FuzzyFilter, Integrator};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Refuses what does not go together; `is_kept` if copies are to be kept or there is one to go on from.
pub(super) fn check(scene: &Scene, settings: &Settings, is_kept: bool) -> Result<()> {
    if scene.render.glossy != FuzzyBy::TwoPass {
        if settings.first_pass {
            let problem =
                Problem::new("the output `gbuffer` is of the first of two passes, and there is one only");
            return Err(problem.remedy("set `render.glossy` to `two-pass`").into());
        }
        return Ok(());
    }
    let integrator = scene.render.integrator;
    if !matches!(integrator, Integrator::Whitted | Integrator::Distribution) {
        let problem =
            Problem::new(format!("`glossy = \"two-pass\"` filters ray trees, not `{}`", integrator.word()));
        return Err(problem.remedy("use the integrator `whitted`, or `glossy = \"lobe\"`").into());
    }
    if settings.limits.error.is_some() {
        let problem = Problem::new("a target error goes by noise, which a filtered picture hides");
        return Err(problem.remedy("give `--spp` or `--time-limit`, or `glossy = \"lobe\"`").into());
    }
    if settings.first_pass && is_kept {
        let problem =
            Problem::new("the output `gbuffer` has all samples by themselves, which no checkpoint holds");
        return Err(problem.remedy("leave out the checkpoint, or the output").into());
    }
    Ok(())
}

/// The samples of the window, on the threads of the current pool, from where the plan goes on.
pub(super) fn render<A: Accel>(plan: &Plan<'_>, accel: &A, tree: &Whitted) -> Result<Rendered> {
    let eye = Eye::new(plan.scene, accel, plan.most);
    let fuzzy = filter_of(&plan.scene.render.fuzzy);
    let running = Running::new(plan.begin());
    let (ended, first_pass) = running.kept(plan.keeper, || samples(plan, (&eye, tree, &fuzzy), &running))?;
    let State { film, counters, spent, filtering, .. } = running.into_state();
    let statistics = Statistics {
        counters,
        first: plan.samples.start,
        samples: film.samples(),
        ended,
        render: spent,
        filter: filtering,
        hierarchy_bytes: accel.bytes(),
        ..Statistics::default()
    };
    Ok(Rendered { film, first_pass, statistics })
}

/// Takes samples until all are there or the time is over: what ended the picture, and the first passes, if they are kept. Copies taken
/// meanwhile have whole samples of all pixels.
fn samples<A: Accel>(
    plan: &Plan<'_>,
    (eye, tree, fuzzy): (&Eye<'_, A>, &Whitted, &Fuzzy),
    running: &Running,
) -> Result<(Ended, Vec<GBuffer>)> {
    let total = plan.samples.len() as u64 * plan.window.area() as u64;
    let (there, done) = {
        let running = running.locked();
        let film = &running.state.film;
        (film.taken(plan.window), AtomicU64::new(film.samples()))
    };
    let (mut first_pass, mut pace, mut shown) = (Vec::new(), 0.0, None::<Instant>);
    for index in plan.samples.start + there..plan.samples.end {
        let left = running.locked().state.course.left();
        if index > plan.samples.start && left.is_some_and(|left| pace >= left) {
            return Ok((Ended::Time, first_pass));
        }
        let begin = Instant::now();
        let pass = Pass { plan, eye, tree, fuzzy, index, film: film_sample(plan, index) };
        let (g, counters) = pass.first((&done, total))?;
        let (filtered, filtering) = Phase::of(|| post::filter(&g, plan.window, fuzzy, (level(), index)));
        let mut tile = running.locked().state.film.part(plan.window);
        pass.add(&mut tile, (&g, &filtered));
        let mut running = running.locked();
        running.state.film.put(&tile);
        running.state.counters += counters;
        running.state.filtering += filtering;
        let is_due = |every: Duration| shown.is_none_or(|shown| shown.elapsed() >= every);
        if plan.progress.looks_every().is_some_and(is_due) {
            shown = Some(Instant::now());
            let film = &running.state.film;
            tiles(plan.window).into_iter().for_each(|part| plan.progress.show(&film.part(part)));
        }
        drop(running);
        if plan.first_pass {
            first_pass.push(part(&g, plan.window));
        }
        pace = begin.elapsed().as_secs_f64();
    }
    Ok((Ended::Samples, first_pass))
}

/// The place on the film of a sample of all pixels.
fn film_sample(plan: &Plan<'_>, index: u32) -> FilterSample<f32> {
    plan.filter.sample(plan.start([0_u32, 0], index).get_2d(Dim::Film, Vertex::ROOT))
}

/// A sample of all pixels.
struct Pass<'a, A> {
    plan: &'a Plan<'a>,
    eye: &'a Eye<'a, A>,
    tree: &'a Whitted,
    fuzzy: &'a Fuzzy,
    index: u32,
    film: FilterSample<f32>,
}

impl<A: Accel> Pass<'_, A> {
    /// Mirrors, as far around as windows may reach.
    fn first(&self, (done, total): (&AtomicU64, u64)) -> Result<(GBuffer, Counters)> {
        let plan = self.plan;
        let window = around(plan, self.fuzzy);
        let row = |worker: &mut Worker, y: u32| {
            if plan.progress.is_cancelled() {
                return Err(Error::Interrupted);
            }
            let texels: Vec<Texel> = (window.x0..window.x1).map(|x| self.texel([x, y], worker)).collect();
            if (plan.window.y0..plan.window.y1).contains(&y) {
                let width = u64::from(plan.window.width());
                plan.progress.advance(done.fetch_add(width, Ordering::Relaxed) + width, total);
            }
            Ok((texels, std::mem::take(&mut worker.counters)))
        };
        let rows: Result<Vec<_>> =
            (window.y0..window.y1).into_par_iter().map_init(Worker::default, row).collect();
        let (mut texels, mut counters) = (Vec::with_capacity(window.area()), Counters::default());
        for (row, counted) in rows? {
            texels.extend(row);
            counters += counted;
        }
        let full = [plan.scene.film.width, plan.scene.film.height];
        let scale = plan.scene.camera.pixel_angle(full).recip();
        Ok((GBuffer { full, window, scale, weight: self.film.weight, texels }, counters))
    }

    /// What the camera ray of a pixel finds.
    fn texel(&self, pixel: [u32; 2], worker: &mut Worker) -> Texel {
        let sampler = self.plan.start(pixel, self.index);
        let camera = self.camera(pixel);
        let stage = self.eye.stage(camera.ray.time);
        let FirstPass { rest, reflection } = self.tree.first_pass(&stage, &camera, &sampler, worker);
        let strength = self.plan.scene.render.fuzzy.strength;
        Texel {
            rest: channels(rest.color),
            direct: channels(rest.direct),
            alpha: rest.alpha,
            mirror: reflection.map(|it| mirror(&it, strength)),
        }
    }

    /// The ray of a pixel, on the lens and in time where those of all others are.
    fn camera(&self, pixel: [u32; 2]) -> CameraRay {
        let sampler = self.plan.start([0_u32, 0], self.index);
        let CameraSamples { o, d, time, .. } = self.plan.camera_samples_at(pixel, self.film, &sampler);
        CameraRay { ray: Ray::new(o.into(), d.into()).at_time(time), found: None }
    }

    /// Adds the sample of each pixel.
    fn add(&self, tile: &mut Tile, (g, filtered): (&GBuffer, &Filtered)) {
        let (plan, mut values, mut colours) = (self.plan, Vec::new(), filtered.colour.iter());
        for y in plan.window.y0..plan.window.y1 {
            for x in plan.window.x0..plan.window.x1 {
                let (Some(texel), Some(&[r, g, b])) = (g.texel(x, y), colours.next()) else { continue };
                let direct = Rgb::new(texel.direct[0], texel.direct[1], texel.direct[2]);
                let radiance = Radiance { color: Rgb::new(r, g, b), direct, alpha: texel.alpha };
                let id = SampleId { x, y, index: self.index };
                let features = plan.layout.has_features().then(|| {
                    let camera = self.camera([x, y]);
                    Features::of(&self.eye.stage(camera.ray.time), &camera, plan.layout.has_colours())
                });
                let features = features.flatten();
                values.clear();
                outputs(&plan.layout, radiance, features.as_ref(), &mut values);
                tile.add(id, self.film.weight, &values);
                if let Some(it) = features {
                    let (object, material) = (it.object.0, it.material.0);
                    tile.see(id, self.film.weight, Seen { object, material, depth: it.depth });
                }
            }
        }
    }
}

/// The pixels that those of the window may need.
fn around(plan: &Plan<'_>, fuzzy: &Fuzzy) -> Window {
    let margin = post::margin(fuzzy);
    let Window { x0, y0, x1, y1 } = plan.window;
    Window {
        x0: x0.saturating_sub(margin),
        y0: y0.saturating_sub(margin),
        x1: x1.saturating_add(margin).min(plan.scene.film.width),
        y1: y1.saturating_add(margin).min(plan.scene.film.height),
    }
}

/// A part of a picture.
fn part(g: &GBuffer, window: Window) -> GBuffer {
    let rows = (window.y0..window.y1).flat_map(|y| (window.x0..window.x1).map(move |x| (x, y)));
    let texels = rows.map(|(x, y)| g.texel(x, y).copied().unwrap_or_default()).collect();
    GBuffer { window, texels, ..*g }
}

fn mirror(it: &Reflection, strength: f32) -> Mirror {
    Mirror {
        radiance: channels(it.radiance),
        factor: channels(it.lobe.weight),
        a: it.a,
        normal: it.normal,
        end: it.end.map_or(End::Away(it.d), |(_, b)| End::At(b)),
        s: it.s,
        reflector: it.reflector.0.saturating_add(1),
        exponent: it.lobe.exponent,
        strength,
        hit: it.end.map_or(0, |(object, _)| object.0.saturating_add(1)),
    }
}

fn channels(Rgb { r, g, b }: Rgb<f32>) -> [f32; 3] {
    [r, g, b]
}

/// The filter that a scene asks for.
#[must_use]
pub fn filter_of(described: &FuzzyFilter) -> Fuzzy {
    use crate::scene::description as said;
    Fuzzy {
        weighting: match described.weighting {
            said::FuzzyWeighting::Phong => post::Weighting::Phong,
            said::FuzzyWeighting::Shininess => post::Weighting::Shininess,
        },
        lost_mass: described.lost_mass,
        max_angle: described.max_angle_deg.to_radians(),
        max_radius: described.max_radius,
        radius: match described.radius {
            said::FuzzyRadius::Differential => post::Radius::Differential,
            said::FuzzyRadius::Cone => post::Radius::Cone,
        },
        shape: match described.window {
            said::FuzzyWindow::Round => post::Shape::Round,
            said::FuzzyWindow::Rectangle => post::Shape::Rectangle,
        },
        correction: match described.correction {
            said::FuzzyCorrection::SolidAngle => post::Correction::SolidAngle,
            said::FuzzyCorrection::Cosine => post::Correction::Cosine,
            said::FuzzyCorrection::None => post::Correction::None,
        },
        speed: post::Speed {
            skip: described.skip,
            rejection: match described.rejection {
                said::FuzzyRejection::Cosine => post::Rejection::Cosine,
                said::FuzzyRejection::Angle => post::Rejection::Angle,
            },
            table: described.table,
            taps: described.taps.value(),
            pyramid: described.pyramid.value(),
            half: described.half.value(),
        },
    }
}
