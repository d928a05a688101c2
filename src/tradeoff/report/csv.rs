//! Outcomes as a table for other programs.

use super::Report;
use crate::tradeoff::Outcome;
use crate::tradeoff::design::SAMPLES;
use crate::tradeoff::student::Interval;
use std::fmt::Write as _;

impl Report {
    /// A line for each point, after a heading: a column for each knob, empty where it is as the scene says, then figures, each beside the half of
    /// its interval, empty where that is not known.
    #[must_use]
    pub fn csv(&self) -> String {
        let knobs: Vec<&str> =
            self.axes.iter().map(|axis| axis.knob.as_str()).filter(|knob| *knob != SAMPLES).collect();
        let figures = ["cpu_s", "build_cpu_s", "relmse", "bias2", "variance", "mse", "flip", "brightness"];
        let mut text = format!("{SAMPLES},runs");
        knobs.iter().for_each(|knob| _ = write!(text, ",{knob}"));
        figures.iter().for_each(|figure| _ = write!(text, ",{figure},{figure}_half"));
        text += ",rays,front\n";
        let front = self.front();
        for (i, it) in self.outcomes.iter().enumerate() {
            let _ = write!(text, "{},{}", it.point.spp, it.runs);
            for knob in &knobs {
                let value = it.point.set.iter().find(|[name, ..]| name == knob);
                let _ = write!(text, ",{}", value.map_or_else(String::new, |[_, _, value]| quoted(value)));
            }
            columns(it).into_iter().for_each(|interval| push(&mut text, interval));
            let _ = writeln!(text, ",{},{}", it.rays, front.contains(&i));
        }
        text
    }
}

/// In the order of the heading.
fn columns(it: &Outcome) -> [Option<Interval>; 8] {
    let moments = &it.moments;
    [
        Some(it.cpu_s),
        Some(it.build_cpu_s),
        Some(moments.error),
        moments.bias2,
        moments.variance,
        Some(it.mse),
        Some(it.flip),
        Some(it.brightness),
    ]
}

fn push(text: &mut String, interval: Option<Interval>) {
    let value = interval.map_or_else(String::new, |it| it.value.to_string());
    let half = interval.and_then(|it| it.half).map_or_else(String::new, |half| half.to_string());
    let _ = write!(text, ",{value},{half}");
}

/// As RFC 4180 has it.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_and_quotes_are_quoted() {
        assert_eq!(["a", "a,b", "a\"b"].map(quoted), ["a", "\"a,b\"", "\"a\"\"b\""], "quoted");
    }
}
