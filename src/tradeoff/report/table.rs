//! Outcomes as text.

use super::{NOTES, Report, interval, number};
use crate::bench::report::table::{Grid, place};
use crate::tradeoff::recommend::{Best, Recommendation};
use crate::tradeoff::student::Interval;
use crate::tradeoff::{Origin, Outcome};
use std::fmt::Write as _;

impl Report {
    /// For people: points, and what to take.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = place(&self.machine);
        let [width, height] = self.size;
        let _ = writeln!(
            text,
            "\n{}: {width} x {height}, {} points, {} runs each",
            self.scene,
            self.outcomes.len(),
            self.runs
        );
        let _ = writeln!(text, "{}", self.against());
        for (knob, why) in &self.idle {
            let _ = writeln!(text, "not turned: {knob} ({why})");
        }
        let _ = write!(text, "\n{}", self.points());
        if !self.recommendations.is_empty() {
            text.push('\n');
        }
        self.recommendations.iter().for_each(|it| _ = writeln!(text, "{}", sentence(it)));
        text.push('\n');
        NOTES.iter().for_each(|note| _ = writeln!(text, "{note}"));
        text
    }

    /// What points are compared with, in a sentence.
    pub(super) fn against(&self) -> String {
        let [floor, _] = self.reference.floor();
        let noise = match &self.reference.variances {
            Some(_) => format!("whose own noise is {} relMSE", number(floor)),
            None => "whose own noise is not known and counts as bias".to_owned(),
        };
        match &self.reference.origin {
            Origin::File(path) => format!("reference {}, {noise}", path.display()),
            Origin::Rendered { settings, spp } => {
                let settings: String =
                    settings.iter().map(|(key, value)| format!(", {key} = {value}")).collect();
                format!("reference of {spp} samples per pixel{settings}, {noise}")
            }
        }
    }

    fn points(&self) -> String {
        let heading = ["settings", "spp", "CPU s", "relMSE", "bias^2", "variance", "FLIP", "brightness", ""];
        let mut grid = Grid::new(heading);
        let front = self.front();
        grid.0.extend(self.outcomes.iter().enumerate().map(|(i, it)| row(it, front.contains(&i))));
        grid.text()
    }
}

fn row(it: &Outcome, is_front: bool) -> Vec<String> {
    let curve = it.point.curve();
    let known = |it: Option<Interval>| it.map_or_else(|| "-".to_owned(), interval);
    vec![
        if curve.is_empty() { "as the scene says".to_owned() } else { curve },
        it.point.spp.to_string(),
        interval(it.cpu_s),
        interval(it.moments.error),
        known(it.moments.bias2),
        known(it.moments.variance),
        number(it.flip.value),
        format!("{:+.2} %", 100.0 * it.brightness.value),
        if is_front { "*" } else { "" }.to_owned(),
    ]
}

/// What to take, in a sentence.
pub(super) fn sentence(it: &Recommendation) -> String {
    let target = number(it.target);
    match &it.best {
        Some(best) => format!(
            "for relMSE {target}: {}, {} CPU s{}",
            settings(best),
            number(best.cpu_s),
            if best.is_far { " (far from what was measured: a guess)" } else { "" }
        ),
        None => format!("for relMSE {target}: nothing; {}", why_nothing(it)),
    }
}

fn why_nothing(it: &Recommendation) -> String {
    match it.least_bias2 {
        None => "no two pictures of a point were compared, which would tell its noise".to_owned(),
        Some(least) if least >= it.target => format!("the least bias^2 of all settings is {}", number(least)),
        Some(_) => "it takes more samples than a picture may have".to_owned(),
    }
}

/// Settings as flags of `specula render`.
fn settings(best: &Best) -> String {
    let mut text = format!("--spp {}", best.spp);
    best.set.iter().for_each(|(key, value)| _ = write!(text, " -D {key}={value}"));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_nothing_is_to_be_taken_the_reason_is_told() {
        let why = |least_bias2| sentence(&Recommendation { target: 1e-3, best: None, least_bias2 });
        assert_eq!(
            [None, Some(2e-3), Some(0.0)].map(|least| why(least)
                .split_once("; ")
                .expect("a reason")
                .1
                .to_owned()),
            [
                "no two pictures of a point were compared, which would tell its noise",
                "the least bias^2 of all settings is 2.00e-3",
                "it takes more samples than a picture may have",
            ],
            "reasons"
        );
    }

    #[test]
    fn guesses_are_told_on_both_sides() {
        let best =
            Best { name: String::new(), set: Vec::new(), spp: 1, cpu_s: 0.1, error: 1e-3, is_far: true };
        let told = sentence(&Recommendation { target: 1e-3, best: Some(best), least_bias2: Some(0.0) });
        assert!(told.ends_with("(far from what was measured: a guess)"), "{told}");
    }
}
