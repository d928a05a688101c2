//! Outcomes for programs.

use super::Report;
use crate::bench::report::json::{build, machine};
use crate::tradeoff::recommend::Recommendation;
use crate::tradeoff::student::Interval;
use crate::tradeoff::{Origin, Outcome};
use serde_json::{Map, Value, json};

impl Report {
    /// One document. Times are seconds, errors relMSE where no other name is given; an interval is `[value, half]`, the half null where it is
    /// not known.
    #[must_use]
    pub fn json(&self) -> Value {
        let front = self.front();
        let points = self.outcomes.iter().enumerate().map(|(i, it)| point(it, front.contains(&i)));
        let axes =
            self.axes.iter().map(|axis| json!({ "knob": axis.knob, "key": axis.key, "values": axis.values }));
        json!({
            "version": self.machine.build.version,
            "machine": machine(&self.machine, self.load_after),
            "build": build(&self.machine.build),
            "scene": self.scene,
            "overrides": self.overrides,
            "width": self.size[0],
            "height": self.size[1],
            "settings": self.settings,
            "seed": self.seed,
            "design": self.design,
            "runs": self.runs,
            "threads": self.threads,
            "knobs": axes.collect::<Vec<_>>(),
            "not_turned": self.idle.iter().map(|(knob, why)| json!({ "knob": knob, "why": why })).collect::<Vec<_>>(),
            "reference": self.reference_json(),
            "points": points.collect::<Vec<_>>(),
            "front": front,
            "recommendations": self.recommendations.iter().map(recommendation).collect::<Vec<_>>(),
        })
    }

    fn reference_json(&self) -> Value {
        let [noise, doubt] = self.reference.floor();
        let noise = self.reference.variances.as_ref().map(|_| json!([noise, 1.96 * doubt]));
        match &self.reference.origin {
            Origin::File(path) => json!({ "file": path.display().to_string(), "noise": noise }),
            Origin::Rendered { settings, spp } => {
                json!({ "settings": pairs(settings), "spp": spp, "noise": noise })
            }
        }
    }
}

fn point(it: &Outcome, is_front: bool) -> Value {
    let set: Map<String, Value> =
        it.point.set.iter().map(|[_, key, value]| (key.clone(), value.clone().into())).collect();
    json!({
        "name": it.point.name(),
        "set": set,
        "spp": it.point.spp,
        "runs": it.runs,
        "cpu_s": interval(it.cpu_s),
        "build_cpu_s": interval(it.build_cpu_s),
        "relmse": interval(it.moments.error),
        "bias2": it.moments.bias2.map(interval),
        "variance": it.moments.variance.map(interval),
        "mse": interval(it.mse),
        "flip": interval(it.flip),
        "brightness": interval(it.brightness),
        "efficiency": it.efficiency(),
        "rays": it.rays,
        "front": is_front,
    })
}

fn recommendation(it: &Recommendation) -> Value {
    json!({
        "relmse": it.target,
        "sentence": super::table::sentence(it),
        "best": it.best.as_ref().map(|best| json!({
            "set": pairs(&best.set),
            "spp": best.spp,
            "cpu_s": best.cpu_s,
            "relmse": best.error,
            "is_far": best.is_far,
        })),
        "least_bias2": it.least_bias2,
    })
}

fn interval(it: Interval) -> Value {
    json!([it.value, it.half])
}

fn pairs(pairs: &[(String, String)]) -> Value {
    Value::Object(pairs.iter().map(|(key, value)| (key.clone(), value.clone().into())).collect())
}
