//! Outcomes shown: as a table for people ([`Report::table`]), as JSON for programs ([`Report::json`]), and as one page with
//! plots ([`Report::page`]).

pub(crate) mod json;
pub(crate) mod page;
pub(crate) mod plot;
pub(crate) mod table;

use super::machine::Machine;
use super::outcome::{Agreement, Outcome, Rate};
use super::query::{Mode, Query};
use super::track::Settings;

/// What was raced, where, and what came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Where, at the start.
    pub machine: Machine,
    /// Programs that wanted to run, averaged over the minute before the end.
    pub load_after: Option<f64>,
    /// What was asked for.
    pub settings: Settings,
    /// What came out, scene by scene.
    pub outcomes: Vec<Outcome>,
}

/// What every number means, under every table.
const NOTES: [&str; 4] = [
    "Rates are medians over passes, each after an untimed one, +- half the distance of the quartiles; on one thread in million rays per second of CPU, on \
     more in million rays per second by the clock, with the factor over one thread.",
    "`closest` asks for the nearest hit, `any` whether there is one. bvh2 and cwbvh trace packets and streams ray by ray; \
     hints of coherence are for Embree.",
    "Answers: of contested rays the truth is found by testing every primitive. shared_edge, id_tie and epsilon are within \
     rounding; lost_at_edge leaks within rounding of an edge; lost and other are wrong, the first of them named by its class \
     and its number from 0.",
    "Ratios of one run compare; rates of different runs or machines do not.",
];

/// A way of asking: a hierarchy in a kind of query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Way {
    building: usize,
    query: Query,
}

/// The ways of an outcome, in the order of its rates.
fn ways(outcome: &Outcome) -> Vec<Way> {
    let mut ways = Vec::new();
    for &Rate { building, query, .. } in &outcome.rates {
        let way = Way { building, query };
        if !ways.contains(&way) {
            ways.push(way);
        }
    }
    ways
}

/// The numbers of threads, fewest first.
fn threads(outcome: &Outcome) -> Vec<usize> {
    let mut threads: Vec<usize> = outcome.rates.iter().map(|rate| rate.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    threads
}

fn rate(outcome: &Outcome, way: Way, mode: Mode, field: usize, threads: usize) -> Option<&Rate> {
    outcome.rates.iter().find(|rate| {
        (rate.building, rate.query, rate.mode, rate.field, rate.threads)
            == (way.building, way.query, mode, field, threads)
    })
}

/// The agreements of a way, over all classes.
fn agreements(outcome: &Outcome, way: Way, mode: Mode) -> impl Iterator<Item = &Agreement> {
    outcome
        .agreements
        .iter()
        .filter(move |it| (it.building, it.query, it.mode) == (way.building, way.query, mode))
}

/// The name of a way.
fn name(outcome: &Outcome, way: Way) -> String {
    format!("{} {}", outcome.buildings[way.building].contestant.name(), way.query)
}
