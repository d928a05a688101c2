//! Points, rendered: several times each with different seeds, one after the other, in passes over all points.

use super::design::{Axis, Choice, Design};
use super::kept::Run;
use super::moments::Measure;
use super::reference::Reference;
use super::subject::{Subject, settings_of};
use crate::error::{Problem, Result};
use crate::image::Image;
use crate::math::lanes::Level;
use crate::measure::flip::{Viewing, Watch};
use crate::measure::{Comparison, Pair};
use crate::render::{self, Progress, Rendered, Settings};
use crate::scene::{Description, Scene};
use std::num::NonZeroUsize;
use xxhash_rust::xxh3::xxh3_128;

/// A point of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Point {
    /// Digits that are the same for the same settings of the same scene.
    pub key: String,
    /// What is set there beside what the scene says: knob, key of the scene file, value.
    pub set: Vec<[String; 3]>,
    /// Samples per pixel.
    pub spp: u32,
}

impl Point {
    /// What is set, but the samples: points that differ in samples alone are of one curve. Empty where all is as the scene says.
    #[must_use]
    pub fn curve(&self) -> String {
        let others = self.set.iter().filter(|[knob, ..]| knob != super::design::SAMPLES);
        others.map(|[knob, _, value]| format!("{knob} = {value}")).collect::<Vec<_>>().join(", ")
    }

    /// What is set in words, samples first.
    #[must_use]
    pub fn name(&self) -> String {
        let curve = self.curve();
        let rest = if curve.is_empty() { String::new() } else { format!(", {curve}") };
        format!("{} spp{rest}", self.spp)
    }
}

/// What is to be rendered.
#[derive(Clone, Debug)]
pub struct Sweep {
    points: Vec<Point>,
    descriptions: Vec<Description>,
    /// How often each point is rendered.
    pub runs: u32,
}

impl Sweep {
    /// The points of a design, each once, whatever it is called.
    ///
    /// Fails with all that is wrong with values of knobs, and where there are too many points.
    pub fn new(subject: &Subject, axes: &[Axis], design: Design, runs: u32) -> Result<Self> {
        let choices = design.points(axes).map_err(|count| {
            let problem = Problem::new(format!("{count} points are too many for a sweep"));
            problem.remedy("turn fewer knobs, or take --design random:N")
        })?;
        let mut sweep = Self { points: Vec::new(), descriptions: Vec::new(), runs };
        let mut seen = std::collections::BTreeSet::new();
        for choice in &choices {
            let set = set(axes, choice);
            let settings: Vec<_> = set.iter().map(|[_, key, value]| (key.clone(), value.clone())).collect();
            let description = subject.described(&settings)?;
            let key = digits(&description);
            if seen.insert(key.clone()) {
                sweep.points.push(Point { key, set, spp: description.render.spp() });
                sweep.descriptions.push(description);
            }
        }
        Ok(sweep)
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Samples of all runs but those that are there.
    #[must_use]
    pub fn samples(&self, pixels: u64, there: &[Run]) -> u64 {
        let missing = self.points.iter().flat_map(|point| (0..self.runs).map(move |number| (point, number)));
        let missing = missing.filter(|(point, number)| !has(there, point, *number));
        missing.map(|(point, _)| pixels * u64::from(point.spp)).sum()
    }

    /// The first picture of a point again.
    ///
    /// Fails as rendering does.
    pub fn picture(&self, subject: &mut Subject, point: &Point, bench: &Bench<'_>) -> Result<Image> {
        let Some(at) = self.points.iter().position(|it| it.key == point.key) else {
            return Err(Problem::new("there is no such point").into());
        };
        let seed = subject.base().render.seed;
        Ok(bench.render(subject.scene(&self.descriptions[at], seed)?)?.film.image())
    }

    /// Renders what is missing; `keep` is handed each run as soon as it is done.
    ///
    /// Fails as rendering does, if somebody asks to stop, and if `keep` does.
    pub fn run(
        &self,
        subject: &mut Subject,
        against: &Reference,
        (there, bench): (&[Run], &Bench<'_>),
        keep: &mut dyn FnMut(&Run) -> Result<()>,
    ) -> Result<()> {
        let measure = Measure::new(&against.image);
        let missing = |&at: &usize| (0..self.runs).any(|number| !has(there, &self.points[at], number));
        let points: Vec<usize> = (0..self.points.len()).filter(missing).collect();
        if let Some(&first) = points.first() {
            // What a program does for the first time takes longer: pages are mapped, code is read.
            let seed = subject.base().render.seed;
            bench.warm(subject.scene(&self.descriptions[first], seed)?)?;
        }
        for block in points.chunks(self.block(&against.image)) {
            let mut pictures: Vec<Vec<(u32, Image)>> = vec![Vec::new(); block.len()];
            for number in 0..self.runs {
                for turn in 0..block.len() {
                    // There and back again, so that none always runs after the same one.
                    let turn = if number % 2 == 0 { turn } else { block.len() - 1 - turn };
                    let at = block[turn];
                    if has(there, &self.points[at], number) {
                        continue;
                    }
                    let seed = subject.base().render.seed.wrapping_add(u64::from(number));
                    let rendered = bench.render(subject.scene(&self.descriptions[at], seed)?)?;
                    let (run, picture) =
                        self.measured((at, number, seed), &rendered, (&measure, against), &pictures[turn])?;
                    pictures[turn].push((number, picture));
                    keep(&run)?;
                }
            }
        }
        Ok(())
    }

    /// How many points have their pictures in memory at a time.
    fn block(&self, picture: &Image) -> usize {
        let bytes = 12 * picture.pixels().len() * self.runs.max(1) as usize;
        (PICTURES_BYTES / bytes.max(1)).max(1)
    }

    fn measured(
        &self,
        (at, number, seed): (usize, u32, u64),
        rendered: &Rendered,
        (measure, against): (&Measure, &Reference),
        others: &[(u32, Image)],
    ) -> Result<(Run, Image)> {
        let picture = rendered.film.image();
        let pair = Pair::new(picture.clone().into(), against.image.clone().into(), ["picture", "reference"])?;
        let watch =
            Watch { level: Level::from_env().unwrap_or_else(|_| Level::best()), progress: &render::Silent };
        let flip = Comparison::of(&pair, Viewing::default(), watch)?.flip.unwrap_or(0.0);
        let point = &self.points[at];
        let statistics = &rendered.statistics;
        #[expect(clippy::cast_precision_loss, reason = "a count to be averaged")]
        let rays = statistics.counters.rays() as f64;
        let run = Run {
            point: point.key.clone(),
            set: point.set.iter().map(|[_, key, value]| (key.clone(), value.clone())).collect(),
            spp: point.spp,
            number,
            seed,
            cpu_s: statistics.render.cpu.as_secs_f64(),
            build_cpu_s: statistics.build.cpu.as_secs_f64(),
            wall_s: statistics.render.wall.as_secs_f64(),
            own: measure.own(&picture),
            flip,
            rays,
            products: others
                .iter()
                .map(|(number, other)| (*number, measure.product(&picture, other)))
                .collect(),
        };
        Ok((run, picture))
    }
}

/// Bytes of pictures that are held for products.
const PICTURES_BYTES: usize = 1 << 30;

fn has(runs: &[Run], point: &Point, number: u32) -> bool {
    runs.iter().any(|run| run.number == number && run.point == point.key)
}

/// What a choice sets.
fn set(axes: &[Axis], choice: &Choice) -> Vec<[String; 3]> {
    let chosen = axes.iter().zip(choice).filter_map(|(axis, value)| Some((axis, (*value)?)));
    chosen.map(|(axis, value)| [axis.knob.clone(), axis.key.clone(), axis.values[value].clone()]).collect()
}

/// What tells settings from others.
fn digits(description: &Description) -> String {
    format!("{:032x}", xxh3_128(settings_of(description).to_string().as_bytes()))
}

/// How pictures are rendered, and who watches.
#[derive(Clone, Copy)]
pub struct Bench<'a> {
    /// Threads; all processors if absent.
    pub threads: Option<NonZeroUsize>,
    /// Told samples of all pictures together; may stop it.
    pub progress: &'a Tally<'a>,
}

impl std::fmt::Debug for Bench<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bench").field("threads", &self.threads).finish_non_exhaustive()
    }
}

impl Bench<'_> {
    /// A picture of all samples.
    pub(super) fn render(&self, scene: &Scene) -> Result<Rendered> {
        let settings = Settings { threads: self.threads, ..Settings::default() };
        let rendered = render::render(scene, &settings, self.progress);
        self.progress.ended(
            u64::from(scene.render.spp()) * u64::from(scene.film.width) * u64::from(scene.film.height),
        );
        rendered
    }

    /// A picture of one sample that nobody looks at.
    fn warm(&self, scene: &Scene) -> Result<()> {
        let slice = render::Slice { index: 0, of: scene.render.spp() };
        let settings = Settings { threads: self.threads, slice: Some(slice), ..Settings::default() };
        render::render(scene, &settings, &render::Silent).map(drop)
    }
}

/// Samples of several pictures, told as those of one.
pub struct Tally<'a> {
    to: &'a dyn Progress,
    /// Of pictures that are done.
    done: std::sync::atomic::AtomicU64,
    total: u64,
}

impl std::fmt::Debug for Tally<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tally").field("total", &self.total).finish_non_exhaustive()
    }
}

impl<'a> Tally<'a> {
    /// Of pictures of so many samples in all.
    pub fn new(to: &'a dyn Progress, total: u64) -> Self {
        Self { to, done: 0.into(), total }
    }

    fn ended(&self, samples: u64) {
        self.done.fetch_add(samples, std::sync::atomic::Ordering::Relaxed);
    }
}

impl Progress for Tally<'_> {
    fn advance(&self, done: u64, _total: u64) {
        let before = self.done.load(std::sync::atomic::Ordering::Relaxed);
        self.to.advance((before + done).min(self.total), self.total);
    }

    fn is_cancelled(&self) -> bool {
        self.to.is_cancelled()
    }
}
