//! The command `merge`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::{Value, json};

use super::args::MergeArgs;
use super::interrupt::Interrupt;
use super::kept::open;
use super::options::{MergeOptions, Output};
use super::render::write_json;
use super::statistics::{self, mean};
use super::{both, log, options, output};
use crate::error::{Error, Place, Problem, Problems, Result};
use crate::film::{Film, SampleId};
use crate::image::tone::{Curve, Development};
use crate::image::{Format, Window, exr, png};
use crate::integrator::Counters;
use crate::render::{self, Gap, Outline, Part, PartFile, Phase};
use crate::scene;
use crate::scene::description::Tone;
use crate::trust::{Excess, Limit, Limits};

/// What to do about a part that cannot be taken.
const REMEDY: &str = "render it again, or leave it out";

/// Joins parts to a picture, and prints the names of the files that it writes.
pub(super) fn run(args: &MergeArgs) -> Result<()> {
    log::start(&args.log);
    let interrupt = Interrupt::listen();
    let options = MergeOptions::new(args)?;
    options::try_out(options.outputs.iter().map(|output| &output.path).chain(&options.stats))?;
    let (merged, merging) = Phase::of(|| merge(&options, &interrupt));
    let merged = merged?;
    tracing::info!(
        "{} samples of {} part{} in {:.1} s",
        merged.film.samples(),
        merged.told.len(),
        if merged.told.len() == 1 { "" } else { "s" },
        merging.wall.as_secs_f64(),
    );
    let dropped = merged.film.non_finite().count();
    if dropped > 0 {
        tracing::warn!("{dropped} samples were not finite and count as black");
    }
    let (written, writing) = Phase::of(|| merged.write(&options, &interrupt));
    if matches!(written, Err(Error::Interrupted)) {
        return written;
    }
    let told = options.stats.as_ref().map_or(Ok(()), |path| {
        write_json(path, &merged.report(&options, [("write", writing), ("merge", merging)]))
    });
    both(written, told)?;
    let paths = options.outputs.iter().map(|output| &output.path).chain(&options.stats);
    output::print(paths.map(|path| format!("{}\n", path.display())).collect::<String>().as_bytes())
}

/// A picture made of parts.
struct Merged {
    film: Film,
    counters: Counters,
    scene_hash: Value,
    /// How each part was made, and which it is, in the order in which they were added.
    told: Vec<(Value, Outline, PathBuf)>,
}

/// The sums of all parts, of which one at a time is in memory.
fn merge(options: &MergeOptions, interrupt: &Interrupt) -> Result<Merged> {
    let (outlines, about) = outlines(&options.parts, &options.limits)?;
    let outlines: Vec<&Outline> = outlines.iter().collect();
    let window = options.crop.unwrap_or_else(|| render::wanted(&outlines));
    check_window(&outlines, window, &options.parts)?;
    let gaps = render::gaps(&outlines, window);
    let problems = gaps.into_iter().map(|gap| problem(gap, &options.parts)).collect();
    Problems(problems).into_result(())?;

    let mut sums: Option<(Film, Counters)> = None;
    let (mut told, mut problems) = (Vec::new(), Problems::default());
    for index in render::order(&outlines) {
        interrupt.check()?;
        let path = &options.parts[index];
        let part = match file(path, &options.limits)
            .and_then(|file| file.read().map_err(|what| unreadable(path, what)))
        {
            Ok(part) if part.outline == *outlines[index] && part.about == about => part,
            Ok(_) => {
                problems.push(unreadable(path, "it was replaced meanwhile".to_owned()));
                continue;
            }
            Err(problem) => {
                problems.push(problem);
                continue;
            }
        };
        let Part { outline, film, counters, told: how, .. } = part;
        let (all, counts) = sums.get_or_insert_with(|| {
            let empty = Film::new(outline.full, window, outline.layout.clone());
            (empty.named(film.names().clone()), Counters::default())
        });
        all.add(&film);
        *counts += counters;
        told.push((how, outline, path.clone()));
    }
    problems.into_result(())?;
    let (film, counters) = sums.ok_or_else(|| Problem::new("no part to merge").remedy("name some"))?;
    Ok(Merged { film, counters, scene_hash: about["scene_hash"].clone(), told })
}

/// Which parts there are, and of what. Fails with all that cannot be read or are of something else.
fn outlines(paths: &[PathBuf], limits: &Limits) -> Result<(Vec<Outline>, Value)> {
    let mut problems = Problems::default();
    let mut first: Option<(Value, PathBuf)> = None;
    let mut outlines = Vec::new();
    for path in paths {
        let file = match file(path, limits) {
            Ok(file) => file,
            Err(problem) => {
                problems.push(problem);
                continue;
            }
        };
        outlines.push(file.outline().clone());
        let Some((about, of)) = &first else {
            first = Some((file.about().clone(), path.clone()));
            continue;
        };
        let mut differences = scene::differences(file.about(), about);
        if differences.len() > 1 {
            differences.retain(|told| !told.starts_with("`scene_hash`"));
        }
        if differences.is_empty() {
            differences = scene::differences(&common(file.outline()), &common(&outlines[0]));
        }
        for told in differences {
            let told = told.strip_suffix(" here").unwrap_or(&told).replace(" there and ", " here and ");
            let what = format!("of another picture than `{}`: {told} there", of.display());
            problems.push(Problem::at(Place::file(path), what).remedy("merge parts of one picture"));
        }
    }
    let about = first.map(|(about, _)| about).unwrap_or_default();
    problems.into_result((outlines, about))
}

/// What the outlines of all parts of a picture have in common.
fn common(outline: &Outline) -> Value {
    json!({
        "width": outline.full[0],
        "height": outline.full[1],
        "outputs": outline.layout.aovs().iter().map(|aov| aov.name()).collect::<Vec<_>>(),
        "spp": outline.spp,
        "has_limit": outline.has_limit,
    })
}

/// A file of a part, which asks for no more than is allowed.
fn file(path: &Path, limits: &Limits) -> std::result::Result<PartFile<Box<dyn std::io::Read>>, Problem> {
    let too_much = |excess: Excess| excess.at(Place::file(path));
    let (file, length) = open(path).map_err(|error| match error {
        Error::Input(problems) if !problems.0.is_empty() => problems.0[0].clone(),
        Error::Io { source, .. } => unreadable(path, format!("cannot read: {source}")),
        other => unreadable(path, other.to_string()),
    })?;
    limits.check(Limit::Bytes, length).map_err(too_much)?;
    let file = PartFile::open(file, length).map_err(|what| unreadable(path, what))?;
    limits.check(Limit::Pixels, file.outline().window.area() as u64).map_err(too_much)?;
    Ok(file)
}

fn unreadable(path: &Path, what: String) -> Problem {
    Problem::at(Place::file(path), what).remedy(REMEDY)
}

/// Refuses parts that reach beyond what is wanted.
fn check_window(outlines: &[&Outline], window: Window, paths: &[PathBuf]) -> Result<()> {
    let mut problems = Problems::default();
    let [width, height] = outlines[0].full;
    if window.is_empty() || !window.fits(width, height) {
        let what = format!("the crop {} is not a part of the picture", corners(window));
        problems.push(Problem::new(what).remedy(format!("stay within 0,0,{width},{height}")));
    }
    for (outline, path) in outlines.iter().zip(paths) {
        let Window { x0, y0, x1, y1 } = outline.window;
        if x0 < window.x0 || y0 < window.y0 || x1 > window.x1 || y1 > window.y1 {
            let what = format!("its pixels {} are not within {}", corners(outline.window), corners(window));
            problems.push(Problem::at(Place::file(path), what).remedy("give another --crop"));
        }
    }
    problems.into_result(())
}

fn corners(window: Window) -> String {
    window.corners().map(|corner| corner.to_string()).join(",")
}

fn problem(gap: Gap, paths: &[PathBuf]) -> Problem {
    match gap {
        Gap::Missing { samples, window } => Problem::new(format!(
            "no part has the samples {}..{} of the pixels {}",
            samples.start,
            samples.end,
            corners(window)
        ))
        .remedy("name the part that has them; for a part of the picture alone, give --crop"),
        Gap::Doubled { samples, window, parts: [one, other] } => Problem::at(
            Place::file(&paths[other]),
            format!(
                "it has the samples {}..{} of the pixels {}, which `{}` has too",
                samples.start,
                samples.end,
                corners(window),
                paths[one].display()
            ),
        )
        .remedy("leave one of them out"),
    }
}

impl Merged {
    /// Writes all pictures, one that fails beside the others.
    fn write(&self, options: &MergeOptions, interrupt: &Interrupt) -> Result<()> {
        let mut written = Ok(());
        for Output { path, format } in &options.outputs {
            if interrupt.is_asked() {
                return both(Err(Error::Interrupted), written);
            }
            let this = match format {
                Format::Exr => {
                    let picture = self.film.picture(options.precision, self.attributes());
                    exr::write(path, picture).map(|warnings| log::warn(&warnings))
                }
                Format::Png => png::write(path, &self.film.image(), self.development()),
            };
            written = both(written, this);
        }
        written
    }

    /// What the parts tell of some metadata.
    fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a str> {
        self.told.iter().filter_map(move |(told, _, _)| {
            let attributes = told["attributes"].as_array()?;
            attributes.iter().find(|entry| entry[0] == name)?[1].as_str()
        })
    }

    /// The metadata: those of the first part, with times added up, and what is true of the whole.
    fn attributes(&self) -> Vec<(String, String)> {
        let first = self.told.first().and_then(|(told, _, _)| told["attributes"].as_array());
        let mut attributes = Vec::new();
        for entry in first.into_iter().flatten() {
            let (Some(key), Some(value)) = (entry[0].as_str(), entry[1].as_str()) else { continue };
            if let Some(value) = self.attribute(key, value) {
                attributes.push((key.to_owned(), value));
            }
        }
        let [least, most] = self.film.samples_of_pixels();
        let mut more = vec![("parts", self.told.len().to_string())];
        if least < most {
            more.extend([("samples_min", least.to_string()), ("samples_mean", mean(&self.film).to_string())]);
        }
        attributes.extend(more.into_iter().map(|(key, value)| (format!("specula:{key}"), value)));
        attributes
    }

    /// What some metadata of the first part is of the whole.
    fn attribute(&self, key: &str, value: &str) -> Option<String> {
        let [_, most] = self.film.samples_of_pixels();
        let numbers = || self.all(key).filter_map(|text| text.parse::<f64>().ok());
        Some(match key.strip_prefix("specula:").unwrap_or(key) {
            "spp" => most.to_string(),
            "samples" => format!("0..{most}"),
            "time_load_s" | "time_build_s" | "time_render_s" | "cpu_render_s" | "cpu_filter_s" => {
                ((numbers().sum::<f64>() * 1e6).round() / 1e6).to_string()
            }
            "threads" | "peak_memory_bytes" => numbers().fold(0.0, f64::max).to_string(),
            "non_finite_samples" => self.film.non_finite().count().to_string(),
            "clamped_part" => self.counters.clamped_part().to_string(),
            "backend" | "isa" | "lanes" | "filter_lanes" | "ended_by" | "query" => distinct(self.all(key)),
            // Of one part alone.
            "samples_min" | "samples_mean" | "estimated_relmse" | "estimated_relmse_bound" => return None,
            _ => value.to_owned(),
        })
    }

    /// How the scene wants to be shown.
    fn development(&self) -> Development {
        let Some((told, _, _)) = self.told.first() else { return Development::default() };
        #[expect(clippy::cast_possible_truncation, reason = "it was single precision")]
        let exposure_ev = told["exposure_ev"].as_f64().unwrap_or(0.0) as f32;
        let is_clip = told["tone"] == Tone::Clip.word();
        Development { exposure_ev, curve: if is_clip { Curve::Clip } else { Curve::Filmic } }
    }

    /// What parts tell of themselves.
    fn told(&self) -> impl Iterator<Item = &Value> {
        self.told.iter().map(|(told, _, _)| &told["statistics"])
    }

    /// Everything counted and timed: what the first part tells, but for sums of times and rays, the most of memory, each word once. Rates are
    /// those of a part on average: when which part was made is not known.
    fn report(&self, options: &MergeOptions, times: [(&str, Phase); 2]) -> Value {
        let words = |key: &str| {
            let words = distinct(self.told().filter_map(|it| it[key].as_str()));
            (!words.is_empty()).then_some(words)
        };
        let most = |key: &str| self.told().filter_map(|it| it[key].as_u64()).max();
        let phases = self.phases(times);
        let rendering = phases["render"]["wall_s"].as_f64().unwrap_or(0.0);
        let rendering = Duration::try_from_secs_f64(rendering).unwrap_or_default();
        let [least, most_samples] = self.film.samples_of_pixels();
        let samples = self.film.samples();
        let mut report = self.told().next().and_then(Value::as_object).cloned().unwrap_or_default();
        let limit = report.get("clamped").and_then(|clamped| clamped["limit"].as_f64());
        let own = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "scene_hash": self.scene_hash,
            "outputs": options.outputs.iter().map(|o| o.path.display().to_string()).collect::<Vec<_>>(),
            "parts": self.told.iter().map(part).collect::<Vec<_>>(),
            "backend": words("backend"),
            "isa": words("isa"),
            "lanes": words("lanes"),
            "filter_lanes": words("filter_lanes"),
            "query": words("query"),
            "threads": most("threads"),
            "width": self.film.full()[0],
            "height": self.film.full()[1],
            "crop": self.film.window().corners(),
            "spp": most_samples,
            "sample_range": [0, most_samples],
            "samples_per_pixel": { "min": least, "mean": mean(&self.film), "max": most_samples },
            "ended_by": words("ended_by"),
            // Of one part alone.
            "estimated_error": null,
            "phases": phases,
            "samples": samples,
            "samples_per_s": statistics::rate(samples, rendering),
            "rays": statistics::rays(&self.counters),
            "rays_per_s": statistics::rate(self.counters.rays(), rendering),
            "pruned": statistics::pruned(&self.counters),
            "clamped": limit.map(|limit| statistics::clamped_by(limit, &self.counters, samples)),
            "peak_rss_bytes": most("peak_rss_bytes"),
            "bvh_bytes": most("bvh_bytes"),
            "texture_bytes": most("texture_bytes"),
            "non_finite": {
                "count": self.film.non_finite().count(),
                "first": self.film.non_finite().first().iter().map(|&s| self.dropped(s)).collect::<Vec<_>>(),
            },
        });
        report.extend(own.as_object().cloned().unwrap_or_default());
        report.into()
    }

    /// Times of all parts added up, and those of the merge.
    fn phases(&self, own: [(&str, Phase); 2]) -> Value {
        let time = |name: &str, clock: &str| {
            let sum: f64 = self.told().filter_map(|it| it["phases"][name][clock].as_f64()).sum();
            (sum * 1e6).round() / 1e6
        };
        let phase = |name: &str| json!({ "wall_s": time(name, "wall_s"), "cpu_s": time(name, "cpu_s") });
        let of_parts = ["load", "build", "render", "filter"].map(|name| (name.to_owned(), phase(name)));
        let own = own.map(|(name, time)| (name.to_owned(), statistics::phase(time)));
        of_parts.into_iter().chain(own).collect()
    }

    /// A sample that was dropped, with the command that its part tells to see it again.
    fn dropped(&self, SampleId { y, x, index }: SampleId) -> Value {
        let (pixel, index) = (json!([x, y]), json!(index));
        let all = self.told().filter_map(|it| it["non_finite"]["first"].as_array()).flatten();
        let same = all.into_iter().find(|it| it["pixel"] == pixel && it["index"] == index);
        json!({ "pixel": pixel, "index": index, "command": same.map(|it| &it["command"]) })
    }
}

/// A part: which it is, and how it was made.
fn part((told, outline, path): &(Value, Outline, PathBuf)) -> Value {
    let its = &told["statistics"];
    json!({
        "file": path.display().to_string(),
        "crop": outline.window.corners(),
        "samples": [outline.samples.start, outline.samples.end],
        "backend": its["backend"],
        "isa": its["isa"],
        "lanes": its["lanes"],
        "threads": its["threads"],
        "render": its["phases"]["render"],
        "rays": its["rays"]["total"],
        "peak_rss_bytes": its["peak_rss_bytes"],
    })
}

/// Each word once.
fn distinct<'a>(words: impl Iterator<Item = &'a str>) -> String {
    let mut unique: Vec<&str> = words.collect();
    unique.sort_unstable();
    unique.dedup();
    unique.join(", ")
}
