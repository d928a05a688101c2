//! Outcomes as one page that needs nothing else: recommendations, plots, pictures to be compared, every setting.

use super::plot::{self, Series};
use super::{NOTES, Report, Shown, interval, number, pictures, table};
use crate::bench::report::page::{facts, figure, page, pairs};
use crate::tradeoff::Outcome;
use crate::tradeoff::design::SAMPLES;
use crate::tradeoff::front::front;
use crate::tradeoff::student::Interval;
use crate::tradeoff::subject::said;
use maud::{Markup, html};
use serde_json::Value;

/// What pages of this kind add: a picture under another one, of which a part is cut away from the left.
const SLIDER: &str = ".pictures{display:flex;flex-wrap:wrap;gap:1.5em}.pictures figure{max-width:100%}\
    .pair{position:relative;width:30em;max-width:100%;--cut:50%}.pair img,.difference{display:block;width:100%;image-rendering:pixelated}\
    .difference{width:30em;max-width:100%}\
    .pair img.over{position:absolute;inset:0;clip-path:inset(0 0 0 var(--cut))}\
    .pair .edge{position:absolute;top:0;bottom:0;left:var(--cut);width:2px;margin-left:-1px;background:#fff;mix-blend-mode:difference;pointer-events:none}\
    .pair input{position:absolute;inset:0;width:100%;height:100%;margin:0;opacity:0;cursor:ew-resize}\
    .sides{display:flex;justify-content:space-between;font-size:13px}.front td{background:#eef6ff}\
    .advice{font-size:17px}code{background:#f3f3f3;padding:0 .2em}";

impl Report {
    /// The page.
    #[must_use]
    pub fn page(&self) -> String {
        let title = format!("What accuracy costs: {}", self.scene);
        let body = html! {
            h1 { (title) }
            p { (self.size[0]) " x " (self.size[1]) ", " (self.outcomes.len()) " points, " (self.runs) " runs each; " (self.against()) "." }
            @if !self.recommendations.is_empty() {
                h2 { "What to take" }
                ul.advice { @for it in &self.recommendations { li { (table::sentence(it)) } } }
            }
            h2 { "What nothing beats" }
            (figure("", &self.front_plot()))
            h2 { "Error over time, knob by knob" }
            div.plots { @for axis in self.knobs() { (figure(&axis, &self.knob_plot(&axis))) } }
            @if !self.pictures.is_empty() { (self.gallery()) }
            h2 { "All points" }
            div.wide { (self.rows()) }
            @for note in NOTES { p { (note) } }
            h2 { "Scene and settings" }
            (pairs(&self.asked()))
            h2 { "Machine and build" }
            (pairs(&facts(&self.machine, self.load_after)))
        };
        page(&title, SLIDER, &body)
    }

    /// Knobs that have a plot: all but samples, or samples where there is nothing else.
    fn knobs(&self) -> Vec<String> {
        let names: Vec<String> = self.axes.iter().map(|axis| axis.knob.clone()).collect();
        let others: Vec<String> = names.iter().filter(|name| *name != SAMPLES).cloned().collect();
        if others.is_empty() { names } else { others }
    }

    fn front_plot(&self) -> String {
        let at = |it: &Outcome| ([it.cpu_s.value, it.error()], it.moments.error.half);
        let all = self.outcomes.iter().map(|it| (at(it).0, None)).collect();
        let best = self.front().into_iter().map(|i| at(&self.outcomes[i])).collect();
        let series = [
            Series { name: "all points".to_owned(), points: all, is_joined: false, colour: None },
            Series { name: "the front".to_owned(), points: best, is_joined: true, colour: Some(0) },
        ];
        plot::over_time(["CPU s", "relMSE"], &series)
    }

    /// A series for each value of a knob: all of its points where the design varies nothing else, else those that nothing at that value
    /// beats.
    fn knob_plot(&self, knob: &str) -> String {
        let Some(axis) = self.axes.iter().find(|axis| axis.knob == knob) else { return String::new() };
        let values = axis.values.iter().map(|value| Some(value.as_str()));
        let said = said(&self.settings, &axis.key).unwrap_or_else(|| "left to the renderer".to_owned());
        let mut series = Vec::new();
        for (colour, value) in values.chain([None]).enumerate() {
            let mut own = self.at(knob, value);
            let all: Vec<[f64; 2]> = own.iter().map(|it| [it.cpu_s.value, it.error()]).collect();
            let is_alone =
                own.iter().all(|it| it.point.set.iter().all(|[name, ..]| name == knob || name == SAMPLES));
            if !is_alone {
                own = front(&all).into_iter().map(|i| own[i]).collect();
            }
            own.sort_by_key(|it| it.point.spp);
            let points = own.iter().map(|it| ([it.cpu_s.value, it.error()], it.moments.error.half)).collect();
            let name = value.map_or_else(|| format!("as the scene says: {said}"), str::to_owned);
            if !own.is_empty() {
                series.push(Series { name, points, is_joined: true, colour: Some(colour) });
            }
        }
        plot::over_time(["CPU s", "relMSE"], &series)
    }

    fn gallery(&self) -> Markup {
        let reference = pictures::developed(&self.reference.image, self.development);
        html! {
            h2 { "Pictures beside the reference" }
            p { "Left of the edge the point's picture, right of it the reference; drag it. Below, what an eye would notice: black is nothing, pale yellow the most." }
            div.pictures { @for shown in &self.pictures { (self.slider(shown, &reference)) } }
        }
    }

    fn slider(&self, shown: &Shown, reference: &str) -> Markup {
        let picture = pictures::developed(&shown.picture, self.development);
        let difference = pictures::coloured(self.size, &shown.flip);
        html! {
            figure {
                figcaption { (shown.name) }
                div.pair {
                    img src=(picture) alt={ "picture: " (shown.name) };
                    img.over src=(reference) alt="reference";
                    div.edge {}
                    input type="range" min="0" max="100" value="50" step="0.1" aria-label="where the reference begins"
                        oninput="this.parentNode.style.setProperty('--cut',this.value+'%')";
                }
                div.sides { span { "picture" } span { "reference" } }
                img.difference src=(difference) alt={ "difference: " (shown.name) };
            }
        }
    }

    fn rows(&self) -> Markup {
        let front = self.front();
        let known = |it: Option<Interval>| it.map_or_else(|| "-".to_owned(), interval);
        html! {
            table {
                tr {
                    th { "settings" } th { "spp" } th { "runs" } th { "CPU s" } th { "build, CPU s" } th { "relMSE" } th { "bias²" } th { "variance" }
                    th { "MSE" } th { "FLIP" } th { "brightness" } th { "rays" } th { "1 / (relMSE x CPU s)" }
                }
                @for (i, it) in self.outcomes.iter().enumerate() {
                    tr.front[front.contains(&i)] {
                        td { @if it.point.curve().is_empty() { "as the scene says" } @else { (it.point.curve()) } }
                        td { (it.point.spp) }
                        td { (it.runs) }
                        td { (interval(it.cpu_s)) }
                        td { (interval(it.build_cpu_s)) }
                        td { (interval(it.moments.error)) }
                        td { (known(it.moments.bias2)) }
                        td { (known(it.moments.variance)) }
                        td { (interval(it.mse)) }
                        td { (interval(it.flip)) }
                        td { (format!("{:+.3} %", 100.0 * it.brightness.value)) }
                        td { (number(it.rays)) }
                        td { (it.efficiency().map_or_else(|| "-".to_owned(), number)) }
                    }
                }
            }
        }
    }

    /// Everything that was asked for, and everything that the scene says of how it is rendered.
    fn asked(&self) -> Vec<(&str, String)> {
        let mut asked = vec![
            ("scene", self.scene.clone()),
            ("replaced for all points", self.overrides.join(" ")),
            ("picture", format!("{} x {}", self.size[0], self.size[1])),
            ("design", self.design.clone()),
            ("runs of each point", self.runs.to_string()),
            ("seed of the first run", self.seed.to_string()),
            ("threads", self.threads.map_or_else(|| "all processors".to_owned(), |n| n.to_string())),
            ("reference", self.against()),
        ];
        asked.extend(self.axes.iter().map(|axis| (axis.knob.as_str(), axis.values.join(", "))));
        asked.extend(self.idle.iter().map(|(knob, why)| (*knob, format!("not turned: {why}"))));
        for table in ["film", "render"] {
            let entries = self.settings.get(table).and_then(Value::as_object);
            asked.extend(entries.into_iter().flatten().map(|(key, value)| (key.as_str(), value.to_string())));
        }
        asked
    }
}
