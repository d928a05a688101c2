//! Settings for an error or a time: chosen before a picture, told, and compared with what came of it.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::{Map, Value, json};

use super::frozen::Frozen;
use super::options::{Cost, RenderOptions};
use crate::error::{Error, Place, Problem, Problems, Result};
use crate::render::{self, Progress, Rendered, Studio};
use crate::scene::{
    self, Library,
    description::{FuzzyBy, Sampler},
};
use crate::tradeoff::curve::Curve;
use crate::tradeoff::kept::Kept;
use crate::tradeoff::outcomes_kept;
use crate::tradeoff::pilot::Pilot;
use crate::tradeoff::presets::{self, Advice, Kind, Preset};
use crate::tradeoff::said;

/// What is to be expected of a picture.
#[derive(Clone, Debug)]
pub(super) struct Prediction {
    /// What was asked for.
    asked: Value,
    /// What settings were chosen by.
    by: String,
    /// Keys and values that were chosen.
    set: Vec<(String, String)>,
    spp: f64,
    /// Seconds of the processor that tracing takes, and by the clock that all takes but writing.
    cpu_s: f64,
    wall_s: f64,
    relmse: f64,
}

/// The part of the processors' time before a limit that samples are taken in: the last pass does not always fit.
const USED: f64 = 0.98;

/// The part of a budget that first looks may take.
const LOOK: f64 = 0.05;

/// What a first look may take in seconds where there is no budget.
const LOOK_S: f64 = 60.0;

/// Chooses settings where somebody is to: the scene then has them, as the options do. Time counts since `start`. Where that takes a
/// look at the scene, the studio then has its hierarchy.
pub(super) fn settle(
    options: &mut RenderOptions,
    frozen: Frozen,
    start: Instant,
    (studio, progress): (&mut Studio, &dyn Progress),
) -> Result<(Frozen, Option<Prediction>)> {
    let Some(cost) = options.cost.clone() else { return Ok((frozen, None)) };
    let Some(kind) = Kind::of(frozen.scene.render.integrator) else {
        let problem = Problem::at(
            Place::file(&frozen.path),
            "the integrator `view` has no noise to choose settings by",
        );
        return Err(problem.remedy("leave out --preset and --budget").into());
    };
    check_look(&cost, &frozen)?;
    let (frozen, prediction) = match &cost {
        Cost::Preset(preset) => by_preset(options, frozen, (*preset, start, kind), (studio, progress))?,
        Cost::Budget { time, runs: None } => {
            by_look(options, frozen, (*time, start, kind), (studio, progress))?
        }
        Cost::Budget { time, runs: Some(path) } => by_runs(options, frozen, (*time, start), path)?,
    };
    if let Cost::Budget { time, .. } = cost {
        options.limits.time = Some(time);
    }
    options.limits.is_estimated = true;
    tracing::info!(
        "{}: {}; relMSE about {:.2e} in {:.1} s, {:.1} CPU s of tracing",
        prediction.by,
        prediction.flags(),
        prediction.relmse,
        prediction.wall_s,
        prediction.cpu_s,
    );
    Ok((frozen, Some(prediction)))
}

/// Refuses to choose by a look where it tells no noise, and takes nearly as long as the picture: squares of a filtered picture are traced with as
/// much around them as windows reach.
fn check_look(cost: &Cost, frozen: &Frozen) -> Result<()> {
    let (what, instead) = match cost {
        Cost::Preset(_) => ("a preset", ""),
        Cost::Budget { runs: None, .. } => ("a budget without runs of the scene", "`--tradeoff`, "),
        Cost::Budget { runs: Some(_), .. } => return Ok(()),
    };
    if frozen.scene.render.glossy != FuzzyBy::TwoPass {
        return Ok(());
    }
    let problem = Problem::new(format!("{what} goes by noise, which a filtered picture hides"));
    Err(problem.remedy(format!("give {instead}`--spp` or `--time-limit`, or `glossy = \"lobe\"`")).into())
}

impl Prediction {
    /// Flags of `specula render` that set the same.
    fn flags(&self) -> String {
        let set: String = self.set.iter().map(|(key, value)| format!("-D {key}={value} ")).collect();
        format!("{set}--spp {:.0}", self.spp.max(1.0))
    }

    /// Beside what came of it, `elapsed` since the start without writing.
    pub(super) fn beside(&self, rendered: &Rendered, elapsed: Duration) -> Value {
        let statistics = &rendered.statistics;
        let set: Map<String, Value> =
            self.set.iter().map(|(key, value)| (key.clone(), value.clone().into())).collect();
        json!({
            "asked": self.asked,
            "by": self.by,
            "set": set,
            "predicted": { "spp": self.spp, "cpu_s": self.cpu_s, "wall_s": self.wall_s, "relmse": self.relmse },
            "achieved": {
                "spp": rendered.film.samples_of_pixels()[0],
                "cpu_s": statistics.render.cpu.as_secs_f64(),
                "wall_s": elapsed.as_secs_f64(),
                "estimated_relmse": statistics.estimate.map(|it| it.error),
            },
        })
    }
}

/// Puts values before what flags say, so that these have the last word.
fn turn(options: &mut RenderOptions, frozen: Frozen, set: &[(String, String)]) -> Result<Frozen> {
    let chosen = set.iter().map(|(key, value)| format!("{key}={value}"));
    let overrides: Vec<String> = chosen.chain(options.overrides.iter().cloned()).collect();
    let frozen = frozen.turned(&overrides)?;
    options.overrides = overrides;
    Ok(frozen)
}

fn threads(options: &RenderOptions) -> f64 {
    f64::from(u32::try_from(super::threads::all(options.threads).get()).unwrap_or(u32::MAX))
}

/// The part of the picture that is rendered.
fn part(options: &RenderOptions, frozen: &Frozen) -> f64 {
    let film = &frozen.scene.film;
    let all = f64::from(film.width) * f64::from(film.height);
    options.crop.map_or(1.0, |crop| f64::from(crop.width()) * f64::from(crop.height()) / all)
}

fn plain() -> Advice {
    Advice { gain: 1.0, slope: -1.0, ..Advice::default() }
}

fn no_look() -> Error {
    Problem::new("no sample of the scene says how noisy it is")
        .remedy("set the number of samples by --spp")
        .into()
}

fn by_preset(
    options: &mut RenderOptions,
    frozen: Frozen,
    (preset, start, kind): (Preset, Instant, Kind),
    (studio, progress): (&mut Studio, &dyn Progress),
) -> Result<(Frozen, Prediction)> {
    let advice = presets::advice(kind, preset.target(), &|_| true).unwrap_or_else(plain);
    let mut frozen = turn(options, frozen, &advice.set)?;
    let (look, curve) = look(options, &mut frozen, &advice, (LOOK_S, studio, progress))?;
    let spp = rounded(curve.samples_for(preset.target().max(curve.bias2 * 2.0)).unwrap_or(1.0));
    let set = advice.set;
    let frozen = turn(options, frozen, &[("render.spp".to_owned(), spp.to_string())])?;
    let spp = f64::from(frozen.scene.render.spp());
    let cpu_s = curve.time(spp);
    let wall_s = start.elapsed().as_secs_f64() + cpu_s / threads(options);
    let by = format!("preset {}, after a look of {:.1} s", preset.word(), look.spent.wall.as_secs_f64());
    let asked = json!({ "preset": preset.word(), "relmse": preset.target() });
    Ok((frozen, Prediction { asked, by, set, spp, cpu_s, wall_s, relmse: curve.error(spp) }))
}

/// A first look, and what it says of more samples of what is rendered.
fn look(
    options: &RenderOptions,
    frozen: &mut Frozen,
    advice: &Advice,
    (most_s, studio, progress): (f64, &mut Studio, &dyn Progress),
) -> Result<(Pilot, Curve)> {
    let pilot = Pilot::of(&mut frozen.scene, studio, most_s, progress)?;
    let curve = pilot.curve(advice.slope, advice.bias2).ok_or_else(no_look)?;
    Ok((pilot, curve.larger(part(options, frozen))))
}

/// Whole packets where there are many: those are traced fastest. Fewer than two packets are not cut in two, so their error is not estimated
/// (see [`Limits`](render::Limits)).
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut at both ends")]
fn rounded(spp: f64) -> u32 {
    let spp = spp.ceil().clamp(1.0, 16_777_216.0) as u32;
    let unit = if spp > 16 {
        16
    } else if spp > 4 {
        4
    } else {
        1
    };
    spp.next_multiple_of(unit)
}

/// Whether settings suit a number of samples that is not known before: these samplers are made for a known one.
fn suits_budgets(set: &[(String, String)]) -> bool {
    let known = [Sampler::Stratified, Sampler::BlueNoise].map(Sampler::word);
    !set.iter().any(|(key, value)| key == "render.sampler" && known.contains(&value.as_str()))
}

/// No end of samples but time, where flags do not say.
fn endless() -> (String, String) {
    ("render.spp".to_owned(), render::MOST.to_string())
}

fn by_look(
    options: &mut RenderOptions,
    frozen: Frozen,
    (time, start, kind): (Duration, Instant, Kind),
    (studio, progress): (&mut Studio, &dyn Progress),
) -> Result<(Frozen, Prediction)> {
    let look_s = LOOK * time.as_secs_f64() / 2.0;
    let left = |start: Instant| time.saturating_sub(start.elapsed()).as_secs_f64();
    // As the scene is, to see which error there is time for; then with what reaches that one soonest.
    let mut frozen = frozen;
    let (first, curve) = look(options, &mut frozen, &plain(), (look_s, studio, progress))?;
    let error = curve.error(curve.samples_in(left(start) * threads(options)).max(1.0));
    let advice = presets::advice(kind, error, &suits_budgets).unwrap_or_else(plain);
    let set = advice.set.clone();
    let mut frozen = turn(options, frozen, &[&[endless()], &set[..]].concat())?;
    let curve = if set.is_empty() {
        first.curve(advice.slope, advice.bias2).ok_or_else(no_look)?.larger(part(options, &frozen))
    } else {
        look(options, &mut frozen, &advice, (look_s, studio, progress))?.1
    };
    let cpu_s = USED * left(start) * threads(options);
    let spp = curve.samples_in(cpu_s).clamp(1.0, f64::from(frozen.scene.render.spp()));
    let by = "budget, after a look at some pixels".to_owned();
    let asked = json!({ "budget_s": time.as_secs_f64() });
    let (cpu_s, relmse) = (curve.time(spp), curve.error(spp));
    let wall_s = start.elapsed().as_secs_f64() + cpu_s / threads(options);
    Ok((frozen, Prediction { asked, by, set, spp, cpu_s, wall_s, relmse }))
}

/// Refuses runs of another scene, or under other settings than those that they turn; the table `film` is what runs are about. Gives what the
/// scene of the runs says of those that they turn, where this one says otherwise.
fn check(kept: &Kept, frozen: &Frozen, path: &Path) -> Result<Vec<(String, String)>> {
    let Frozen { description, files, trust, .. } = frozen;
    let here = scene::identity_within(description, frozen.folder(), files, (trust, &Library::default()))?;
    let mut both = [kept.head["about"].clone(), here];
    let [there, here] = both.each_mut().map(|about| {
        let scene = about["scene"].as_object_mut();
        let render = scene.and_then(|scene| {
            scene.shift_remove("film");
            scene.shift_remove("render")
        });
        json!({ "render": render })
    });
    let refused = |[there, here]: [&Value; 2], (what, remedy): (&str, &str)| {
        let problem =
            |told: String| Problem::at(Place::file(path), format!("runs {what}: {told}")).remedy(remedy);
        scene::differences(there, here).into_iter().map(problem).collect::<Vec<_>>()
    };
    let [scene_there, scene_here] = &both;
    let mut problems = refused(
        [scene_there, scene_here],
        ("of another scene", "name runs of this scene, or leave out --tradeoff"),
    );
    let turned = turned(kept);
    let [fixed_there, fixed_here] = [&there, &here].map(|json| fixed(json, &there, &turned));
    let remedy =
        "set what they were made with, by flags as `specula tradeoff` had them, or leave out --tradeoff";
    problems.extend(refused([&fixed_there, &fixed_here], ("under other settings", remedy)));
    Problems(problems).into_result(returned([&there, &here], &turned))
}

/// The keys that runs turn.
fn turned(kept: &Kept) -> BTreeSet<String> {
    kept.runs.iter().flat_map(|run| &run.set).map(|(key, _)| key.clone()).collect()
}

/// Settings that have to be those of the runs: all but number and seed of samples, and what they turn and `there` says.
fn fixed(json: &Value, there: &Value, turned: &BTreeSet<String>) -> Value {
    let mut json = json.clone();
    if let Some(render) = json["render"].as_object_mut() {
        render.retain(|key, _| {
            let path = format!("render.{key}");
            let is_free = ["spp", "seed"].contains(&key.as_str());
            let is_turned = turned.contains(&path) && said(there, &path).is_some();
            !is_free && !is_turned
        });
    }
    json
}

/// What is said `there` of keys that are turned, where it is something else here: points that leave such a key alone are of that.
fn returned([there, here]: [&Value; 2], turned: &BTreeSet<String>) -> Vec<(String, String)> {
    let keys = turned.iter().filter(|key| *key != "render.spp");
    let value = |key: &String| said(there, key).filter(|value| said(here, key).as_ref() != Some(value));
    keys.filter_map(|key| Some((key.clone(), value(key)?))).collect()
}

/// The same curve with more that is set, where it does not set that itself.
fn with(mut curve: Curve, more: &[(String, String)]) -> Curve {
    let is_new = |(key, _): &&(String, String)| !curve.set.iter().any(|(own, _)| own == key);
    curve.set = more.iter().filter(is_new).chain(&curve.set).cloned().collect();
    curve
}

fn by_runs(
    options: &mut RenderOptions,
    frozen: Frozen,
    (time, start): (Duration, Instant),
    path: &Path,
) -> Result<(Frozen, Prediction)> {
    let kept = Kept::read(path)?;
    let returned = check(&kept, &frozen, path)?;
    let outcomes = outcomes_kept(&kept);
    let build_s = outcomes.first().map_or(0.0, |it| it.build_cpu_s.value);
    let size = ["width", "height"].map(|side| kept.head[side].as_f64().unwrap_or(1.0));
    let film = &frozen.scene.film;
    let all = f64::from(film.width) * f64::from(film.height) * part(options, &frozen);
    let times = all / (size[0] * size[1]);
    let left = time.saturating_sub(start.elapsed()).as_secs_f64();
    let cpu_s = USED * (left * threads(options) - build_s).max(0.0);
    let curves = Curve::all(&outcomes).into_iter().map(|curve| with(curve, &returned));
    let curves = curves.filter(|curve| suits_budgets(&curve.set));
    let curves = curves.map(|curve| curve.larger(times));
    let error = |curve: &Curve| curve.error(curve.samples_in(cpu_s).max(1.0));
    let Some(best) = curves.min_by(|a, b| error(a).total_cmp(&error(b))) else {
        let problem = Problem::at(Place::file(path), "no point in it has runs enough to tell its noise");
        return Err(problem.remedy("go on with it: specula tradeoff --resume").into());
    };
    let frozen = turn(options, frozen, &[&[endless()], &best.set[..]].concat())?;
    let spp = best.samples_in(cpu_s).clamp(1.0, f64::from(frozen.scene.render.spp()));
    let wall_s = start.elapsed().as_secs_f64() + (best.time(spp) + build_s) / threads(options);
    let prediction = Prediction {
        asked: json!({ "budget_s": time.as_secs_f64() }),
        by: format!("budget, by the runs in {}", path.display()),
        set: best.set.clone(),
        spp,
        cpu_s: best.time(spp),
        wall_s,
        relmse: best.error(spp),
    };
    Ok((frozen, prediction))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::student::Interval;

    #[test]
    fn many_samples_are_whole_packets() {
        let found = [0.2, 1.0, 3.4, 4.5, 11.0, 16.0, 16.5, 100.0, 1e12].map(rounded);
        assert_eq!(found, [1, 1, 4, 8, 12, 16, 32, 112, 16_777_216], "rounded up");
    }

    #[test]
    fn samplers_for_known_numbers_suit_no_budget() {
        let set = |value: &str| vec![("render.sampler".to_owned(), value.to_owned())];
        assert!(suits_budgets(&[]) && suits_budgets(&set("sobol")), "any number");
        assert!(!suits_budgets(&set("stratified")) && !suits_budgets(&set("blue_noise")), "a known number");
    }

    #[test]
    fn settings_count_unless_they_are_turned_and_those_are_as_in_the_runs() {
        let render = |depth: u32, query: Value, spp: u32, integrator: &str| json!({ "render": { "max_depth": depth, "query": query, "spp": spp, "seed": spp, "integrator": integrator } });
        let turned: BTreeSet<String> =
            ["render.max_depth", "render.query", "render.spp"].map(str::to_owned).into();
        let there = render(16, Value::Null, 4, "path");
        let differ = |here: &Value| {
            let both = [&there, here].map(|json| fixed(json, &there, &turned));
            scene::differences(&both[0], &both[1])
        };
        let turned_otherwise = render(6, Value::Null, 9, "path");
        assert_eq!(differ(&turned_otherwise), [""; 0], "number, seed and depth");
        let other = render(16, "single".into(), 4, "whitted");
        let told = [
            "`render.integrator` is \"path\" there and \"whitted\" here",
            "`render.query` is nothing there and \"single\" here",
        ];
        assert_eq!(differ(&other), told, "what is not turned, or could not be set as it was");
        let pair = |key: &str, value: &str| (key.to_owned(), value.to_owned());
        let returned = returned([&there, &turned_otherwise], &turned);
        assert_eq!(returned, [pair("render.max_depth", "16")], "the depth of points that leave it alone");
        let curve = |set: Vec<(String, String)>| {
            Curve::measured(String::new(), set, (Interval::default(), 0.0, 1.0), vec![[1.0, 1.0]])
        };
        assert_eq!(with(curve(Vec::new()), &returned).set, returned, "left alone");
        let own = vec![pair("render.max_depth", "4")];
        assert_eq!(with(curve(own.clone()), &returned).set, own, "set");
    }
}
