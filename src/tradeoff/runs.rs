//! Points, rendered: several times each with different seeds, one after the other, in passes over all points.

use super::design::{Axis, Choice, Design};
use super::kept::Run;
use super::moments::{Measure, Own};
use super::reference::Reference;
use super::subject::{Subject, settings_of};
use crate::error::{Problem, Result};
use crate::image::Image;
use crate::math::lanes::Level;
use crate::measure::flip::{Viewing, Watch};
use crate::measure::{Comparison, Pair};
use crate::render::{self, Kept, Phase, Progress, Rendered, Settings, Studio};
use crate::scene::{self, Description, Scene};
use std::num::NonZeroUsize;

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
            let key = scene::digits(&settings_of(&description));
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

    /// Samples of all runs but those that are there, and of those that are rendered again.
    #[must_use]
    pub fn samples(&self, pixels: u64, there: &[Run]) -> u64 {
        let pictures = |point: &Point| {
            self.missing(there, point).count() + usize::from(self.lacks_partner(there, point).is_some())
        };
        self.points.iter().map(|point| pixels * u64::from(point.spp) * pictures(point) as u64).sum()
    }

    /// The runs of a point that are to be rendered.
    fn missing(&self, there: &[Run], point: &Point) -> impl Iterator<Item = u32> {
        (0..self.runs).filter(move |&number| !has(there, point, number))
    }

    /// A run that is there and whose picture is needed again: the one run that is missing would have none to be compared with, and no two of those that
    /// are there have been compared.
    fn lacks_partner<'a>(&self, there: &'a [Run], point: &Point) -> Option<&'a Run> {
        let mut own = there.iter().filter(|run| run.point == point.key);
        let is_paired = |run: &Run| run.products.iter().any(|&(number, _)| has(there, point, number));
        let is_alone = self.missing(there, point).count() == 1 && !own.clone().any(is_paired);
        own.next().filter(|_| is_alone)
    }

    /// The first pictures of points again.
    ///
    /// Fails as rendering does.
    pub fn pictures(
        &self,
        subject: &mut Subject,
        points: &[&Point],
        bench: &Bench<'_>,
    ) -> Result<Vec<Image>> {
        let mut easel = Easel::new(bench)?;
        let seed = subject.base().render.seed;
        let mut picture = |point: &&Point| -> Result<Image> {
            let Some(at) = self.points.iter().position(|it| it.key == point.key) else {
                return Err(Problem::new("there is no such point").into());
            };
            Ok(easel.render(subject.scene(&self.descriptions[at], seed)?)?.film.image())
        };
        points.iter().map(&mut picture).collect()
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
        let measure = against.measure();
        let is_missing = |&at: &usize| self.missing(there, &self.points[at]).next().is_some();
        let points: Vec<usize> = (0..self.points.len()).filter(is_missing).collect();
        let mut easel = Easel::new(bench)?;
        if let Some(&first) = points.first() {
            // What a program does for the first time takes longer: pages are mapped, code is read.
            let seed = subject.base().render.seed;
            easel.warm(subject.scene(&self.descriptions[first], seed)?)?;
        }
        for block in points.chunks(self.block(&against.image)) {
            let mut pictures: Vec<Vec<(u32, Image)>> = vec![Vec::new(); block.len()];
            for (&at, own) in block.iter().zip(&mut pictures) {
                if let Some(run) = self.lacks_partner(there, &self.points[at]) {
                    let scene = subject.scene(&self.descriptions[at], run.seed)?;
                    own.push((run.number, easel.render(scene)?.film.image()));
                }
            }
            for number in 0..self.runs {
                for turn in 0..block.len() {
                    // There and back again, so that none always runs after the same one.
                    let turn = if number % 2 == 0 { turn } else { block.len() - 1 - turn };
                    let at = block[turn];
                    if has(there, &self.points[at], number) {
                        continue;
                    }
                    let seed = subject.base().render.seed.wrapping_add(u64::from(number));
                    let rendered = easel.render(subject.scene(&self.descriptions[at], seed)?)?;
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
        let comparison = compared(&picture, &against.image)?;
        let (Some(errors), Some(flip)) = (comparison.errors, comparison.flip) else {
            return Err(Problem::new("no pixel is finite in picture and reference").into());
        };
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
            own: Own::of(&errors, measure.mean()),
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

/// A picture against the reference.
///
/// Fails if it is of another size.
pub fn compared(picture: &Image, reference: &Image) -> Result<Comparison> {
    let pair = Pair::new(picture.clone().into(), reference.clone().into(), ["picture", "reference"])?;
    let level = Level::from_env().unwrap_or_else(|_| Level::best());
    Comparison::of(&pair, Viewing::default(), Watch { level, progress: &render::Silent })
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

/// Where pictures are rendered in turn: on the same threads, and on the hierarchy of the last one while that would be built again.
#[derive(Debug)]
pub(super) struct Easel<'a> {
    progress: &'a Tally<'a>,
    studio: Studio,
    /// How long building the hierarchy took.
    build: Phase,
}

impl<'a> Easel<'a> {
    /// Fails if there are no threads to be had.
    pub(super) fn new(bench: &Bench<'a>) -> Result<Self> {
        let studio = Studio::new(bench.threads)?;
        Ok(Self { progress: bench.progress, studio, build: Phase::default() })
    }

    /// A picture of all samples; its statistics have the time of the hierarchy that it was rendered on, whenever that was built.
    pub(super) fn render(&mut self, scene: &Scene) -> Result<Rendered> {
        let rendered = self.studio.render(scene, &Settings::default(), self.progress, Kept::default());
        self.progress.ended(
            u64::from(scene.render.spp()) * u64::from(scene.film.width) * u64::from(scene.film.height),
        );
        let mut rendered = rendered?;
        if rendered.statistics.build != Phase::default() {
            self.build = rendered.statistics.build;
        }
        rendered.statistics.build = self.build;
        Ok(rendered)
    }

    /// A picture of one sample that nobody looks at.
    fn warm(&mut self, scene: &Scene) -> Result<()> {
        let slice = render::Slice { index: 0, of: scene.render.spp() };
        let settings = Settings { slice: Some(slice), ..Settings::default() };
        self.studio.render(scene, &settings, &render::Silent, Kept::default())?;
        // Its hierarchy was built for the first time, too.
        self.studio.clear();
        Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::render::Silent;
    use crate::tradeoff::knobs::Knob;
    use crate::tradeoff::outcomes;
    use crate::trust::Trust;

    const SCENE: &str = "[film]\nwidth = 8\nheight = 4\n[render]\nintegrator = 'path'\nsampler = 'independent'\n[materials.m]\n\
        type = 'diffuse'\n[[shapes]]\ntype = 'sphere'\nradius = 1.0\nmaterial = 'm'\n[[lights]]\ntype = 'environment'\n\
        radiance = 1.0\n";

    fn subject(folder: &tempfile::TempDir) -> Subject {
        let path = folder.path().join("a.toml");
        std::fs::write(&path, SCENE).expect("written");
        Subject::read(&path, &[], &Trust::default()).expect("a scene").0
    }

    /// Renders what is missing; stops after so many runs.
    fn swept(subject: &mut Subject, axes: &[Axis], there: &[Run], most: usize) -> (Sweep, Vec<Run>) {
        let sweep = Sweep::new(subject, axes, Design::OneAtATime, 2).expect("points");
        let tally = Tally::new(&Silent, 0);
        let bench = Bench { threads: NonZeroUsize::new(1), progress: &tally };
        let reference = Reference::render(subject, Vec::new(), 64, &bench).expect("a picture");
        let mut runs = there.to_vec();
        let mut keep = |run: &Run| {
            if runs.len() == most {
                return Err(Error::Interrupted);
            }
            runs.push(run.clone());
            Ok(())
        };
        let done = sweep.run(subject, &reference, (there, &bench), &mut keep);
        assert_eq!(done.is_ok(), runs.len() == 2 * sweep.points().len(), "{done:?}");
        (sweep, runs)
    }

    #[test]
    fn a_point_whose_one_run_was_kept_still_has_a_pair() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut subject = subject(&folder);
        let axes = [subject.axis(Knob::of("spp").expect("a knob"), &["1".to_owned(), "4".to_owned()])];
        let (sweep, whole) = swept(&mut subject, &axes, &[], usize::MAX);
        // In the second pass: one point has both of its runs, the other one.
        let (_, begun) = swept(&mut subject, &axes, &[], 3);
        assert_eq!(sweep.samples(32, &begun), 2 * 32, "one run, and its partner once more");
        let (_, resumed) = swept(&mut subject, &axes, &begun, usize::MAX);
        let variances = |runs: &[Run]| {
            let found = outcomes(sweep.points(), runs, [0.0; 2]);
            found.iter().map(|it| it.moments.variance.expect("a pair").value.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(variances(&resumed), variances(&whole), "as if it had not been stopped");
    }

    #[test]
    fn runs_share_a_hierarchy_and_know_its_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut subject = subject(&folder);
        let values = ["embree", "bvh2"].map(str::to_owned);
        let axes = [subject.axis(Knob::of("backend").expect("a knob"), &values)];
        let (sweep, runs) = swept(&mut subject, &axes, &[], usize::MAX);
        // There and back again: the last one of a pass is the first of the next.
        let of = |at: usize| {
            let own = runs.iter().filter(|run| run.point == sweep.points()[at].key);
            own.map(|run| run.build_cpu_s).collect::<Vec<_>>()
        };
        let (embree, bvh2) = (of(0), of(1));
        assert!(embree.iter().chain(&bvh2).all(|&seconds| seconds > 0.0), "{embree:?}, {bvh2:?}");
        assert_eq!(bvh2[0].to_bits(), bvh2[1].to_bits(), "one hierarchy");
        let found = outcomes(sweep.points(), &runs, [0.0; 2]);
        assert!(found[0].build_cpu_s.half.is_some(), "built twice: {:?}", found[0].build_cpu_s);
        assert_eq!(found[1].build_cpu_s.half, None, "measured once");
    }
}
