//! Outcomes for programs.

use super::Report;
use crate::accel::Coherence;
use crate::bench::agreement::Difference;
use crate::bench::machine::{Build, Machine};
use crate::bench::outcome::{Agreement, BuildTime, Building, Field, Outcome, Rate};
use crate::bench::query::Query;
use crate::bench::race::Spread;
use crate::bench::rays::Class;
use serde_json::{Map, Value, json};

impl Report {
    /// One document. Rates are in rays per second, times in seconds; a spread is `[median, half the distance of the
    /// quartiles]`.
    #[must_use]
    pub fn json(&self) -> Value {
        let settings = &self.settings;
        json!({
            "version": self.machine.build.version,
            "machine": machine(&self.machine, self.load_after),
            "build": build(&self.machine.build),
            "settings": {
                "passes": settings.passes,
                "warm_up_passes": 1,
                "rays_per_class": settings.rays,
                "threads": settings.threads,
                "contestants": settings.contestants.iter().map(|it| it.name()).collect::<Vec<_>>(),
                "queries": settings.queries.iter().map(Query::to_string).collect::<Vec<_>>(),
                "classes": settings.classes.iter().map(|class| Class::word(*class)).collect::<Vec<_>>(),
            },
            "scenes": self.outcomes.iter().map(scene).collect::<Vec<_>>(),
        })
    }
}

/// Where figures are from, and the load after they were taken.
pub(crate) fn machine(machine: &Machine, load_after: Option<f64>) -> Value {
    json!({
        "processor": machine.processor,
        "processors": machine.processors,
        "cores": machine.cores,
        "mhz": machine.mhz,
        "max_mhz": machine.max_mhz,
        "caches": machine.caches,
        "memory_bytes": machine.memory,
        "system": machine.system,
        "isa": machine.isa,
        "load_before": machine.load,
        "load_after": load_after,
    })
}

/// How the program was built.
pub(crate) fn build(build: &Build) -> Value {
    json!({
        "version": build.version,
        "commit": build.commit,
        "rustc": build.rustc,
        "target": build.target,
        "opt_level": build.opt_level,
        "rustflags": build.rustflags,
        "debug_assertions": build.debug_assertions,
    })
}

fn scene(outcome: &Outcome) -> Value {
    json!({
        "scene": outcome.scene,
        "primitives": outcome.primitives,
        "replayed": outcome.replayed,
        "classes": outcome.fields.iter().map(field).collect::<Vec<_>>(),
        "builds": outcome.buildings.iter().map(building).collect::<Vec<_>>(),
        "rates": outcome.rates.iter().map(|it| rate(outcome, it)).collect::<Vec<_>>(),
        "agreement": outcome.agreements.iter().map(|it| agreement(outcome, it)).collect::<Vec<_>>(),
    })
}

fn field(field: &Field) -> Value {
    json!({ "class": field.class, "rays": field.rays, "hits": field.hits })
}

fn building(building: &Building) -> Value {
    let settings = building.contestant.settings();
    let settings: Map<String, Value> =
        settings.into_iter().map(|(key, value)| (key.to_owned(), value.into())).collect();
    json!({
        "contestant": building.contestant.name(),
        "backend": building.contestant.backend().word(),
        "settings": settings,
        "library": building.version,
        "isa": building.isa,
        "bytes": building.bytes,
        "times": building.times.iter().map(time).collect::<Vec<_>>(),
    })
}

fn time(time: &BuildTime) -> Value {
    json!({
        "threads": time.threads,
        "builds": time.builds,
        "cpu_s": spread(time.cpu_s),
        "wall_s": spread(time.wall_s),
    })
}

/// Who and what: the same keys for rates and answers.
fn way(outcome: &Outcome, building: usize, query: Query, field: usize) -> Value {
    json!({
        "class": outcome.fields[field].class,
        "contestant": outcome.buildings[building].contestant.name(),
        "query": query.word(),
        "coherent": query.coherence().map(|hint| hint == Coherence::Coherent),
    })
}

fn rate(outcome: &Outcome, rate: &Rate) -> Value {
    let mut entry = way(outcome, rate.building, rate.query, rate.field);
    entry["hits"] = rate.mode.word().into();
    entry["threads"] = rate.threads.into();
    entry["rays_per_cpu_s"] = spread(rate.per_cpu_s);
    entry["rays_per_s"] = spread(rate.per_s);
    entry["ns_per_ray"] = spread(rate.ns);
    entry["ratio"] = spread(rate.ratio);
    entry["scaling"] = rate.scaling.map_or(Value::Null, spread);
    entry
}

fn agreement(outcome: &Outcome, agreement: &Agreement) -> Value {
    let mut entry = way(outcome, agreement.building, agreement.query, agreement.field);
    entry["hits"] = agreement.mode.word().into();
    entry["rays"] = outcome.fields[agreement.field].rays.into();
    entry["differ"] = agreement.tally.total().into();
    entry["first_wrong"] = agreement.tally.first_wrong().into();
    for difference in Difference::ALL {
        entry[difference.word()] = agreement.tally.of(difference).into();
    }
    entry
}

fn spread(spread: Spread) -> Value {
    json!([spread.median, spread.half_iqr])
}
