//! The command `tradeoff`: settings of a scene beside each other, error against time.

use std::io::Write as _;

use serde_json::{Value, json};

use super::args::TradeoffArgs;
use super::interrupt::Interrupt;
use super::options::{Against, TradeoffOptions, with_extension};
use super::progress::Meter;
use super::render::development;
use super::{log, options, output, threads};
use crate::bench::machine::{self, Machine};
use crate::error::{Error, Result};
use crate::image::{Image, atomic};
use crate::render::{self, Progress};
use crate::scene;
use crate::tradeoff::design::{Axis, Design};
use crate::tradeoff::kept::{KIND, Log, Run};
use crate::tradeoff::knobs::Knob;
use crate::tradeoff::recommend::recommend;
use crate::tradeoff::report::Shown;
use crate::tradeoff::runs::{Bench, Point, Sweep, Tally};
use crate::tradeoff::{Reference, Report, Subject, compared, outcomes};

/// Sweeps a scene and prints what came out.
pub(super) fn run(args: &TradeoffArgs) -> Result<()> {
    log::start(&args.log);
    let interrupt = Interrupt::listen();
    let options = TradeoffOptions::new(args)?;
    options::try_out(options.report.iter().chain(&options.csv))?;
    threads::limit(options.threads);
    let machine = Machine::here();
    if machine.build.debug_assertions {
        tracing::warn!("built with assertions for debugging: times mean nothing; build with `--release`");
    }
    let mut plan = Plan::new(options)?;
    interrupt.check()?;
    let meter = Meter::new(args.log.quiet, "samples", interrupt);
    let report = plan.carry_out(machine, &meter)?;
    meter.finish();
    let options = &plan.options;
    for (path, text) in
        [(&options.report, Report::page as fn(&Report) -> String), (&options.csv, Report::csv)]
    {
        if let Some(path) = path {
            let text = text(&report);
            atomic::write(path, |file| file.write_all(text.as_bytes()))?;
            tracing::info!("wrote {}", path.display());
        }
    }
    let text = if options.json { format!("{:#}\n", report.json()) } else { report.table() };
    output::print(text.as_bytes())
}

/// What is to be done.
struct Plan {
    options: TradeoffOptions,
    overrides: Vec<String>,
    subject: Subject,
    axes: Vec<Axis>,
    idle: Vec<(&'static str, &'static str)>,
    design: Design,
    sweep: Sweep,
    /// Of a reference that is rendered.
    reference: (Vec<(String, String)>, u32),
    size: [u32; 2],
}

/// Pictures are made smaller than this where nobody says how large they are to be: pixels cost time, and relMSE hardly goes with their number.
const USUAL: u32 = 320;

impl Plan {
    /// What is to be done with a scene that is known now.
    fn new(options: TradeoffOptions) -> Result<Self> {
        let mut overrides = options.overrides.clone();
        let film = scene::load_within(&options.scene, &overrides, &options.trust)?.description.film;
        let longest = film.width.max(film.height);
        let mut size = [film.width, film.height];
        if !options.is_sized && matches!(options.against, Against::Rendered(_)) && longest > USUAL {
            size = size.map(|n| (n * USUAL).div_ceil(longest));
            overrides.extend([format!("film.width={}", size[0]), format!("film.height={}", size[1])]);
            tracing::info!("pictures of {} x {}: --width and --height say otherwise", size[0], size[1]);
        }
        let (subject, warnings) = Subject::read(&options.scene, &overrides, &options.trust)?;
        log::warn(&warnings);
        subject.check()?;
        let (axes, idle) = chosen(&options, &subject);
        let design = match options.design {
            Design::Random { points, .. } => Design::Random { points, seed: subject.base().render.seed },
            other => other,
        };
        let sweep = Sweep::new(&subject, &axes, design, options.runs)?;
        let most = sweep.points().iter().map(|point| point.spp).max().unwrap_or(1);
        let spp = match options.against {
            Against::Rendered(Some(spp)) => spp,
            _ => most.saturating_mul(16).max(256),
        };
        let reference = (Reference::settings(&subject, &axes), spp);
        Ok(Self { options, overrides, subject, axes, idle, design, sweep, reference, size })
    }

    fn carry_out(&mut self, machine: Machine, progress: &dyn Progress) -> Result<Report> {
        let mut head = self.head(&machine)?;
        if let Some((path, true)) = &self.options.keep {
            let mut known = head.clone();
            known["reference"] = self.planned();
            Log::check(path, &known)?;
        }
        let pixels = u64::from(self.size[0]) * u64::from(self.size[1]);
        let reference = self.reference(&head, progress)?;
        head["reference"] = reference.about();
        let Self { options, subject, sweep, .. } = self;
        let (mut log, mut runs) = match &options.keep {
            Some((path, false)) => (Some(Log::begin(path, &head)?), Vec::new()),
            Some((path, true)) => {
                let (log, runs) = Log::resume(path, &head)?;
                (Some(log), runs)
            }
            None => (None, Vec::new()),
        };
        let tally = Tally::new(progress, sweep.samples(pixels, &runs));
        let bench = Bench { threads: options.threads, progress: &tally };
        let there = runs.clone();
        if !there.is_empty() {
            tracing::info!("going on from {} runs", there.len());
        }
        tracing::info!("{} points, {} runs each", sweep.points().len(), sweep.runs);
        let mut keep = |run: &Run| {
            runs.push(run.clone());
            log.as_mut().map_or(Ok(()), |log| log.add(run))
        };
        let done = sweep.run(subject, &reference, (&there, &bench), &mut keep);
        if let (Err(Error::Interrupted), Some((path, _))) = (&done, &options.keep) {
            tracing::info!("{} runs are in `{}`: --resume goes on from them", runs.len(), path.display());
        }
        done?;
        let outcomes = outcomes(sweep.points(), &runs, reference.floor());
        let recommendations = recommend(&outcomes, &options.targets);
        let mut report = Report {
            scene: options.scene.display().to_string(),
            overrides: self.overrides.clone(),
            settings: crate::tradeoff::settings_of(subject.base()),
            seed: subject.base().render.seed,
            size: self.size,
            design: self.design.word(),
            axes: self.axes.clone(),
            idle: self.idle.clone(),
            runs: options.runs,
            threads: options.threads.map(std::num::NonZero::get),
            reference,
            machine,
            load_after: machine::load(),
            outcomes,
            recommendations,
            pictures: Vec::new(),
            development: development(subject.scene(&subject.base().clone(), 0)?),
        };
        if options.report.is_some() {
            report.pictures = shown(&report, sweep, subject, &bench)?;
        }
        Ok(report)
    }

    /// What runs are of, before the reference is known.
    fn head(&self, machine: &Machine) -> Result<Value> {
        Ok(json!({
            "kind": KIND,
            "version": machine.build.version,
            "about": self.subject.identity()?,
            "width": self.size[0],
            "height": self.size[1],
            "machine": machine.name(),
            "instruction_set": render::lanes(),
            "threads": self.options.threads.map_or(machine.processors, std::num::NonZero::get),
            "reference": null,
        }))
    }

    /// What is known of the reference before it is rendered; nothing of one in a file.
    fn planned(&self) -> Value {
        let (settings, spp) = &self.reference;
        match self.options.against {
            Against::File(_) => Value::Null,
            Against::Rendered(_) => Reference::planned(settings, *spp),
        }
    }

    /// The picture to compare with: read, kept from an earlier sweep, or rendered.
    fn reference(&mut self, head: &Value, progress: &dyn Progress) -> Result<Reference> {
        let (settings, spp) = &self.reference;
        if let Against::File(path) = &self.options.against {
            let reference = Reference::read(path, self.size, self.options.trust.limits)?;
            if reference.variances.is_none() {
                tracing::warn!(
                    "{}: its noise is not known and counts as bias; `specula render --aov variance` writes it",
                    path.display()
                );
            }
            return Ok(reference);
        }
        let mut about = head.clone();
        about["settings"] = json!(settings);
        about["spp"] = json!(spp);
        let kept = self.options.keep.as_ref().map(|(path, _)| with_extension(path, REFERENCE));
        if let Some(path) = &kept
            && let Some(reference) =
                Reference::read_kept(path, &about, (self.size, self.options.trust.limits))?
        {
            tracing::info!("the reference is that in `{}`", path.display());
            return Ok(reference);
        }
        tracing::info!("rendering the reference, {spp} samples per pixel");
        let pixels = u64::from(self.size[0]) * u64::from(self.size[1]);
        let tally = Tally::new(progress, Reference::samples(*spp, pixels));
        let bench = Bench { threads: self.options.threads, progress: &tally };
        let reference = Reference::render(&mut self.subject, settings.clone(), *spp, &bench)?;
        if let Some(path) = &kept {
            reference.keep(path, &about)?;
        }
        Ok(reference)
    }
}

/// What the name of a file of runs ends with for that of their reference.
const REFERENCE: &str = "reference.exr";

/// What is turned, and what is not with the reason.
fn chosen(options: &TradeoffOptions, subject: &Subject) -> (Vec<Axis>, Vec<(&'static str, &'static str)>) {
    if !options.knobs.is_empty() {
        return (options.knobs.iter().map(|(knob, values)| subject.axis(knob, values)).collect(), Vec::new());
    }
    let (mut axes, mut idle) = (Vec::new(), Vec::new());
    for knob in Knob::ALL {
        match knob.idle(&subject.facts()) {
            Some(why) => idle.push((knob.name, why)),
            None => axes.push(subject.axis(knob, &[])),
        }
    }
    (axes, idle)
}

/// Most pictures of a page.
const PICTURES: usize = 12;

/// Pictures of the front, or of some of it, and of the scene as it is.
fn shown(report: &Report, sweep: &Sweep, subject: &mut Subject, bench: &Bench<'_>) -> Result<Vec<Shown>> {
    let front = report.front();
    let step = front.len().div_ceil(PICTURES).max(1);
    let mut chosen: Vec<usize> = front.into_iter().step_by(step).collect();
    let plain = report.outcomes.iter().position(|it| it.point.curve().is_empty());
    chosen.extend(plain.filter(|plain| !chosen.contains(plain)));
    let points: Vec<&Point> = chosen.into_iter().map(|i| &report.outcomes[i].point).collect();
    let of = |(point, picture): (&&Point, Image)| {
        let flip = compared(&picture, &report.reference.image)?.flip_map;
        Ok(Shown { name: point.name(), picture, flip })
    };
    points.iter().zip(sweep.pictures(subject, &points, bench)?).map(of).collect()
}
