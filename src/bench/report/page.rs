//! Outcomes as one page that needs nothing else: tables, plots, every setting.

use super::plot::{self, Bar, Point};
use super::{NOTES, Report, Way, agreements, name, rate, threads, ways};
use crate::bench::agreement::Difference;
use crate::bench::machine::Machine;
use crate::bench::outcome::{Building, Outcome, Rate};
use crate::bench::query::{Mode, Query};
use crate::bench::race::Spread;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// How pages look.
const STYLE: &str = "body{font:15px/1.45 sans-serif;margin:2em auto;max-width:75em;padding:0 1em;color:#222;background:#fff}\
    h1,h2,h3{line-height:1.2}table{border-collapse:collapse;margin:.6em 0;font-size:13px}\
    td,th{padding:.15em .7em;text-align:right;border-bottom:1px solid #ddd;white-space:nowrap}\
    td:first-child,th:first-child{text-align:left}.wide{overflow-x:auto}svg{max-width:100%;height:auto}\
    .plots{display:flex;flex-wrap:wrap;gap:1em}figure{margin:0}figcaption{font-weight:bold}\
    summary{cursor:pointer;font-weight:bold;margin:.6em 0}";

impl Report {
    /// The page.
    #[must_use]
    pub fn page(&self) -> String {
        let scenes: Vec<&str> = self.outcomes.iter().map(|it| it.scene.as_str()).collect();
        let body = html! {
            h1 { "BVH backends beside each other" }
            @for note in NOTES { p { (note) } }
            h2 { "Machine, build and settings" }
            (pairs(&self.facts()))
            @for outcome in &self.outcomes { (scene(outcome)) }
        };
        page(&format!("BVH backends: {}", scenes.join(", ")), "", &body)
    }

    /// Everything that figures depend on.
    fn facts(&self) -> Vec<(&'static str, String)> {
        let settings = &self.settings;
        let list = |words: Vec<String>| words.join(", ");
        let mut facts = facts(&self.machine, self.load_after);
        facts.extend([
            ("passes that count, after one to warm up", settings.passes.to_string()),
            ("rays wanted per class", settings.rays.to_string()),
            ("threads", settings.threads.to_string()),
            ("classes", list(settings.classes.iter().map(|class| class.word().to_owned()).collect())),
            ("queries", list(settings.queries.iter().map(Query::to_string).collect())),
        ]);
        facts
    }
}

/// A page that needs nothing else, with more style than that of all pages.
pub(crate) fn page(title: &str, more_style: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(more_style)) }
            }
            body { (body) }
        }
    };
    page.into_string()
}

/// What is known of a machine and a build, and the load after figures were taken.
pub(crate) fn facts(machine: &Machine, load_after: Option<f64>) -> Vec<(&'static str, String)> {
    let Machine { processors, cores, mhz, max_mhz, caches, load, memory, system, isa, build, .. } = machine;
    let number = |x: &Option<f64>| x.map_or_else(unknown, |x| format!("{x:.0}"));
    let loads = [*load, load_after].map(|load| load.map_or_else(unknown, |load| format!("{load:.2}")));
    vec![
        ("processor", machine.processor.clone()),
        ("processors", processors.to_string()),
        ("cores", cores.map_or_else(unknown, |cores| cores.to_string())),
        ("clock now / highest, MHz", format!("{} / {}", number(mhz), number(max_mhz))),
        ("caches", caches.join(", ")),
        ("memory, MB", memory.map_or_else(unknown, |bytes| (bytes / 1_000_000).to_string())),
        ("system", system.clone()),
        ("load before / after", loads.join(" / ")),
        ("instruction set of our own kernels", (*isa).to_owned()),
        ("specula", build.version.to_owned()),
        ("commit", build.commit.map_or_else(unknown, str::to_owned)),
        ("compiler", build.rustc.to_owned()),
        ("target, opt-level", format!("{}, {}", build.target, build.opt_level)),
        ("flags beyond the package's", build.rustflags.to_owned()),
        ("assertions for debugging", build.debug_assertions.to_string()),
    ]
}

fn unknown() -> String {
    "unknown".to_owned()
}

/// A table of names and values.
pub(crate) fn pairs(pairs: &[(&str, String)]) -> Markup {
    html! { table { @for (key, value) in pairs { tr { td { (key) } td { (value) } } } } }
}

fn scene(outcome: &Outcome) -> Markup {
    html! {
        h2 { (outcome.scene) }
        p {
            (outcome.primitives) " primitives."
            @if let Some(file) = &outcome.replayed { " Rays of " (file) "." }
        }
        div.wide { (fields(outcome)) }
        h3 { "Builds" }
        div.wide { (builds(outcome)) }
        h3 { "Speed against build time" }
        div.plots { @for field in 0..outcome.fields.len() { (trade(outcome, field)) } }
        @for mode in Mode::ALL {
            h3 { "Rates, " (mode.word()) " hits, one thread" }
            div.plots { @for field in 0..outcome.fields.len() { (race(outcome, mode, field)) } }
            @for threads in threads(outcome) {
                details {
                    summary { "All rates, " (mode.word()) " hits, " (threads) @if threads == 1 { " thread" } @else { " threads" } }
                    div.wide { (rates(outcome, mode, threads)) }
                }
            }
        }
        h3 { "Answers that differ from the truth" }
        @for mode in Mode::ALL {
            details open { summary { (mode.word()) " hits" } div.wide { (differing(outcome, mode)) } }
        }
    }
}

fn fields(outcome: &Outcome) -> Markup {
    html! {
        table {
            tr { th { "class" } th { "rays" } th { "hit" } }
            @for field in &outcome.fields { tr { td { (field.class) } td { (field.rays) } td { (field.hits) } } }
        }
    }
}

fn builds(outcome: &Outcome) -> Markup {
    html! {
        table {
            tr { th { "contestant" } th { "threads" } th { "builds" } th { "CPU s" } th { "wall s" } th { "bytes" } th { "isa" } th { "library" } th { "settings" } }
            @for building in &outcome.buildings {
                @for time in &building.times {
                    tr {
                        td { (building.contestant.name()) }
                        td { (time.threads) }
                        td { (time.builds) }
                        td { (spread(time.cpu_s, 4)) }
                        td { (spread(time.wall_s, 4)) }
                        td { (building.bytes) }
                        td { (building.isa) }
                        td { (building.version) }
                        td { (settings(building)) }
                    }
                }
            }
        }
    }
}

fn settings(building: &Building) -> String {
    let settings = building.contestant.settings();
    settings.iter().map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ")
}

fn spread(Spread { median, half_iqr }: Spread, digits: usize) -> String {
    format!("{median:.digits$} ± {half_iqr:.digits$}")
}

/// Which backend, for colours.
fn family(outcome: &Outcome, building: usize) -> usize {
    use crate::scene::description::Backend;
    Backend::ALL
        .iter()
        .position(|backend| *backend == outcome.buildings[building].contestant.backend())
        .unwrap_or(0)
}

/// What is asked of rays of a class in a renderer: shadow rays want any hit.
fn natural(outcome: &Outcome, field: usize) -> Mode {
    if outcome.fields[field].class == "shadow" { Mode::Any } else { Mode::Closest }
}

/// Million rays per second of CPU on one thread.
fn mrays(rate: &Rate) -> Spread {
    Spread { median: rate.per_cpu_s.median * 1e-6, half_iqr: rate.per_cpu_s.half_iqr * 1e-6 }
}

/// Each build in its fastest kind of query: time of the build against rate.
fn trade(outcome: &Outcome, field: usize) -> Markup {
    let mode = natural(outcome, field);
    let point = |(building, it): (usize, &Building)| {
        let own = ways(outcome).into_iter().filter(|way| way.building == building);
        let rates = own.filter_map(|way| rate(outcome, way, mode, field, 1));
        let fastest = rates.map(|rate| mrays(rate).median).fold(0.0, f64::max);
        let seconds = it.times.first().map_or(0.0, |time| time.cpu_s.median);
        Point { label: it.contestant.name(), at: [seconds, fastest], family: family(outcome, building) }
    };
    let points: Vec<Point> = outcome.buildings.iter().enumerate().map(point).collect();
    let title = format!("{}, {} hits, fastest query", outcome.fields[field].class, mode.word());
    figure(&title, &plot::scatter(["build, CPU s on one thread", "Mrays per CPU s"], &points))
}

/// All ways.
fn race(outcome: &Outcome, mode: Mode, field: usize) -> Markup {
    let bar = |way: Way| {
        let value = mrays(rate(outcome, way, mode, field, 1)?);
        Some(Bar { label: name(outcome, way), value, family: family(outcome, way.building) })
    };
    let bars: Vec<Bar> = ways(outcome).into_iter().filter_map(bar).collect();
    let title = format!("{}, {} hits", outcome.fields[field].class, mode.word());
    figure(&title, &plot::bars("Mrays per CPU s", &bars))
}

/// A plot with its title.
pub(crate) fn figure(title: &str, svg: &str) -> Markup {
    html! { figure { figcaption { (title) } (PreEscaped(svg)) } }
}

fn rates(outcome: &Outcome, mode: Mode, threads: usize) -> Markup {
    let rows = ways(outcome).into_iter().flat_map(|way| {
        (0..outcome.fields.len())
            .filter_map(move |field| Some((way, field, rate(outcome, way, mode, field, threads)?)))
    });
    html! {
        table {
            tr {
                th { "contestant, query" } th { "class" } th { "Mrays per CPU s" } th { "ns of CPU per ray" } th { "Mrays/s by the clock" }
                th { "relative to the first" } @if threads > 1 { th { "factor over one thread" } }
            }
            @for (way, field, rate) in rows {
                tr {
                    td { (name(outcome, way)) }
                    td { (outcome.fields[field].class) }
                    td { (spread(mrays(rate), 3)) }
                    td { (spread(rate.ns, 1)) }
                    td { (format!("{:.3} ± {:.3}", rate.per_s.median * 1e-6, rate.per_s.half_iqr * 1e-6)) }
                    td { (spread(rate.ratio, 3)) }
                    @if let Some(scaling) = rate.scaling { td { (spread(scaling, 2)) } }
                }
            }
        }
    }
}

/// A row for each way and class that differ at all.
fn differing(outcome: &Outcome, mode: Mode) -> Markup {
    let rows: Vec<_> = ways(outcome)
        .into_iter()
        .flat_map(|way| agreements(outcome, way, mode).map(move |it| (way, it)))
        .filter(|(_, it)| it.tally.total() > 0)
        .collect();
    html! {
        @if rows.is_empty() { p { "None." } } @else {
            table {
                tr { th { "contestant, query" } th { "class" } th { "rays" } @for difference in Difference::ALL { th { (difference.word()) } } th { "first wrong" } }
                @for (way, it) in &rows {
                    tr {
                        td { (name(outcome, *way)) }
                        td { (outcome.fields[it.field].class) }
                        td { (outcome.fields[it.field].rays) }
                        @for difference in Difference::ALL { td { (it.tally.of(difference)) } }
                        td { @if let Some(ray) = it.tally.first_wrong() { (ray) } }
                    }
                }
            }
        }
    }
}
