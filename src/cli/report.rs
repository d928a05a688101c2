//! A comparison in words: a table, JSON, metadata, and what a check says to it.

use serde_json::{Value, json};

use super::options::DiffOptions;
use crate::image::{Range, Window};
use crate::measure::{Comparison, Metric, Pair};

/// Two pictures, how they were compared, and what came out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Report<'a> {
    pub(super) options: &'a DiffOptions,
    pub(super) pair: &'a Pair,
    pub(super) comparison: &'a Comparison,
}

impl Report<'_> {
    /// For people: one line for each number.
    pub(super) fn table(&self) -> String {
        let [test, reference] = self.names();
        let Window { x0, y0, x1, y1 } = self.pair.window();
        let [width, height] = self.pair.full();
        let mut text = format!("{test} against {reference}, {width} by {height} pixels\n");
        if self.pair.window() != Window::whole(width, height) {
            text += &format!("crop        {x0},{y0},{x1},{y1}\n");
        }
        for (name, value) in self.numbers() {
            text += &format!("{name:<11} {}\n", value.map_or_else(|| "none".to_owned(), number));
        }
        if let Some(largest) = self.comparison.errors.map(|errors| errors.largest) {
            let [x, y] = largest.pixel;
            text += &format!("largest     {} at {x},{y}\n", number(largest.error));
        }
        let [bad_test, bad_reference] = self.pair.non_finite();
        text + &format!("non-finite  {bad_test} pixels in {test}, {bad_reference} in {reference}\n")
    }

    /// For programs.
    pub(super) fn json(&self) -> Value {
        let [test, reference] = self.names();
        let Window { x0, y0, x1, y1 } = self.pair.window();
        let [width, height] = self.pair.full();
        let [bad_test, bad_reference] = self.pair.non_finite();
        let errors = self.comparison.errors;
        let mut document = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "a": test,
            "b": reference,
            "width": width,
            "height": height,
            "crop": [x0, y0, x1, y1],
            "pixels": errors.map_or(0, |errors| errors.pixels),
        });
        for (name, value) in self.numbers() {
            document[name] = json!(value);
        }
        document["largest"] = errors.map_or(
            Value::Null,
            |errors| json!({ "error": errors.largest.error, "pixel": errors.largest.pixel }),
        );
        document["non_finite"] = json!({ "a": bad_test, "b": bad_reference });
        document["viewing"] = json!({
            "pixels_per_degree": self.options.viewing.pixels_per_degree,
            "range": match self.pair.range() {
                Range::Scene => "scene",
                Range::Display => "display",
            },
            "exposures": self.comparison.exposures.map(|exposures| {
                json!({ "start": exposures.start, "stop": exposures.stop, "count": exposures.count })
            }),
        });
        if let Some(limit) = self.options.max_error {
            let metric = self.options.metric.word();
            let passed = self.findings().is_empty();
            document["check"] = json!({ "metric": metric, "max_error": limit, "passed": passed });
        }
        document
    }

    /// The metadata of a picture of the difference.
    pub(super) fn attributes(&self) -> Vec<(String, String)> {
        let [test, reference] = self.names();
        let texts = [
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("test", test),
            ("reference", reference),
            ("pixels_per_degree", self.options.viewing.pixels_per_degree.to_string()),
        ];
        let numbers = self.numbers().into_iter();
        let numbers = numbers.filter_map(|(name, value)| value.map(|value| (name, value.to_string())));
        texts.into_iter().chain(numbers).map(|(key, value)| (format!("specula:{key}"), value)).collect()
    }

    /// Why the check says no; nothing if it says yes, or if none was asked for.
    pub(super) fn findings(&self) -> Vec<String> {
        let Some(limit) = self.options.max_error else { return Vec::new() };
        let metric = self.options.metric;
        let mut findings: Vec<String> = self
            .names()
            .into_iter()
            .zip(self.pair.non_finite())
            .filter(|(_, count)| *count > 0)
            .map(|(name, count)| {
                let (pixels, are) = if count == 1 { ("pixel", "is") } else { ("pixels", "are") };
                format!("{count} {pixels} of `{name}` {are} not finite")
            })
            .collect();
        if let Some(value) = self.comparison.value(metric).filter(|value| *value > limit) {
            findings.push(format!("{} of {value} is above {limit}", metric.word()));
        }
        findings
    }

    /// Every error by name; none where no pixel counts.
    fn numbers(&self) -> [(&'static str, Option<f64>); 6] {
        let value = |metric: Metric| (metric.word(), self.comparison.value(metric));
        let errors = self.comparison.errors;
        [
            value(Metric::Mse),
            value(Metric::Rmse),
            value(Metric::RelMse),
            ("mae", errors.map(|errors| errors.mae)),
            ("bias", errors.map(|errors| errors.bias)),
            value(Metric::Flip),
        ]
    }

    fn names(&self) -> [String; 2] {
        [&self.options.test, &self.options.reference].map(|path| path.display().to_string())
    }
}

/// Six digits, as decimals where that is short.
fn number(x: f64) -> String {
    let magnitude = x.abs();
    if magnitude == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&magnitude) {
        return format!("{x:.5e}");
    }
    format!("{x:.*}", whole(5.0 - magnitude.log10().floor()))
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 8")]
fn whole(digits: f64) -> usize {
    digits as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_digits() {
        let texts = [0.0, 1.0, -0.012_345_678, 123_456.7, 12_345_678.0, 2.784_643_44e-5].map(number);
        assert_eq!(texts, ["0", "1.00000", "-0.0123457", "123457", "1.23457e7", "2.78464e-5"], "shown");
    }
}
