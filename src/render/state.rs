//! Pictures under way: copies from which they go on, to the bit, as if nothing had happened.
//!
//! Sums of a film are continued, not added, and decisions depend on sums alone; so film, the passes so far and the pass under way are all
//! there is to keep. How far a tile is in that pass is told by the samples that its pixels have.

use crate::error::Result;
use crate::film::{Film, NonFinite, SampleId, read_numbers, write_numbers};
use crate::image::Window;
use crate::integrator::Counters;
use crate::render::course::Course;
use crate::render::schedule::Pass;
use crate::render::{Phase, archive};
use serde_json::{Value, json};
use std::io::{self, Read, Write};
use std::ops::Range;
use std::time::Duration;

/// A copy of a picture under way.
#[derive(Clone, Debug)]
pub struct State {
    pub(super) film: Film,
    pub(super) counters: Counters,
    pub(super) course: Course,
    /// The pass under way, and how many seconds it has taken.
    pub(super) pass: Option<(Pass, f64)>,
    /// How long tracing took, and filtering where pictures are filtered.
    pub(super) spent: Phase,
    /// How long filtering took alone.
    pub(super) filtering: Phase,
}

/// Somebody who keeps copies of pictures under way, lest all be lost.
pub trait Keeper: Sync {
    /// How long until all samples that have been taken are kept, at most.
    fn every(&self) -> Duration;

    /// Keeps a copy in place of the one before. Called from a thread of its own while samples are taken, and once more when somebody has
    /// asked to stop.
    fn keep(&self, state: &State) -> Result<()>;

    /// Is told that a copy could not be kept; samples are taken all the same. Not told of the last one: that one fails the rendering.
    fn missed(&self, error: crate::error::Error);
}

impl State {
    /// Samples taken so far.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.film.samples()
    }

    /// Writes it as a file of sums, `about` in its head as what it is of.
    pub fn write(&self, about: &Value, into: &mut dyn Write) -> io::Result<()> {
        let (shares, film) = (self.film.shares(), &self.film);
        let pass = self.pass.as_ref().map_or(&[][..], |(pass, _)| &pass.shares);
        let head = json!({
            "kind": "checkpoint",
            "about": about,
            "samples": film.samples(),
            "things": shares,
            "non_finite": non_finite_to_json(film.non_finite()),
            "counters": counters_to_json(&self.counters),
            "spent": phase_to_json(self.spent),
            "filtering": phase_to_json(self.filtering),
            "course": self.course.saved(),
            "pass": self.pass.as_ref().map(|(pass, seconds)| {
                json!({ "tiles": pass.shares.len(), "coherent": pass.coherent, "seconds": seconds })
            }),
        });
        let of_film = Film::bytes(film.window(), film.layout(), shares);
        let length = of_film.ok_or_else(|| io::Error::other("a picture of more bytes than there can be"))?
            + 12 * pass.len() as u64
            + self.course.bytes();
        archive::write(into, &head, length, |into| {
            film.write(into)?;
            #[expect(clippy::cast_possible_truncation, reason = "fewer tiles than pixels of a picture")]
            let share = |(tile, samples): &(usize, Range<u32>)| [*tile as u32, samples.start, samples.end];
            write_numbers(into, pass.iter().flat_map(share))?;
            self.course.write(into)
        })
    }
}

/// A file of a picture under way.
#[derive(Debug)]
pub struct Checkpoint<R> {
    archive: archive::Archive<R>,
}

impl<R: Read> Checkpoint<R> {
    /// What to do where one cannot be read.
    pub const REMEDY: &str = "remove it to begin anew, or name another file";

    /// Reads what a file of `length` bytes is of. Fails with what is wrong with it.
    pub fn open(from: R, length: u64) -> std::result::Result<Self, String> {
        let archive = archive::Archive::open(from, length)?;
        if archive.head["kind"] != "checkpoint" {
            return Err("not a checkpoint, but a part of a picture".to_owned());
        }
        Ok(Self { archive })
    }

    /// What it is of, as it was written.
    #[must_use]
    pub fn about(&self) -> &Value {
        &self.archive.head["about"]
    }

    /// Samples that had been taken.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.archive.head["samples"].as_u64().unwrap_or(0)
    }

    /// Looks whether all is as it was written, without keeping it. Fails with what is wrong with it.
    pub fn check(self) -> std::result::Result<(), String> {
        self.archive.check()
    }

    /// Reads what there is. Whoever asks has made sure that it is of the same picture.
    pub(super) fn state(
        self,
        (mut film, course): (Film, Course),
        tiles: &[Window],
        samples: &Range<u32>,
    ) -> std::result::Result<State, String> {
        let length = self.archive.length;
        self.archive.arrays(|head, from| {
            let odd = || "not what a checkpoint of this picture looks like".to_owned();
            let things = things(&head["things"]).ok_or_else(odd)?;
            let pass = &head["pass"];
            let shares = usize::try_from(pass["tiles"].as_u64().unwrap_or(0)).map_err(|_| odd())?;
            let of_film = Film::bytes(film.window(), film.layout(), things).ok_or_else(odd)?;
            let rest = length.checked_sub(of_film).ok_or_else(odd)?;
            if shares > tiles.len() || 12 * shares as u64 > rest {
                return Err(odd());
            }
            let failed = |error: io::Error| error.to_string();
            film.read(things, from).map_err(failed)?;
            // Where samples go on is told by these.
            if film.samples_of_pixels()[1] as usize > samples.len() {
                return Err(odd());
            }
            let shares: Vec<u32> = read_numbers(from, 3 * shares).map_err(failed)?;
            let share = |&[tile, start, end]: &[u32; 3]| {
                let is_sound = (tile as usize) < tiles.len() && samples.start <= start && start < end;
                (is_sound && end <= samples.end).then_some((tile as usize, start..end))
            };
            let shares: Option<Vec<_>> = shares.as_chunks().0.iter().map(share).collect();
            let course = course.restored(&head["course"], from).map_err(failed)?;
            let (coherent, seconds) = (pass["coherent"] == true, pass["seconds"].as_f64());
            let pass = Pass { shares: shares.ok_or_else(odd)?, coherent };
            Ok(State {
                film: film.dropped(non_finite_of_json(&head["non_finite"]).ok_or_else(odd)?),
                counters: counters_of_json(&head["counters"]).ok_or_else(odd)?,
                course,
                pass: seconds.map(|seconds| (pass, seconds)),
                spent: phase_of_json(&head["spent"]).ok_or_else(odd)?,
                filtering: phase_of_json(&head["filtering"]).ok_or_else(odd)?,
            })
        })
    }
}

/// Numbers of objects and materials.
pub(super) fn things(json: &Value) -> Option<[u64; 2]> {
    Some([json[0].as_u64()?, json[1].as_u64()?])
}

pub(super) fn non_finite_to_json(non_finite: &NonFinite) -> Value {
    let first: Vec<_> = non_finite.first().iter().map(|it| [it.y, it.x, it.index]).collect();
    json!({ "count": non_finite.count(), "first": first })
}

pub(super) fn non_finite_of_json(json: &Value) -> Option<NonFinite> {
    let sample = |json: &Value| {
        let number = |i: usize| u32::try_from(json[i].as_u64()?).ok();
        Some(SampleId { y: number(0)?, x: number(1)?, index: number(2)? })
    };
    let first: Option<Vec<_>> = json["first"].as_array()?.iter().map(sample).collect();
    Some(NonFinite::of(json["count"].as_u64()?, first?))
}

/// Sums by their bits: decimals might change them.
pub(super) fn counters_to_json(counters: &Counters) -> Value {
    let (counts, sums) = counters.to_arrays();
    json!({ "counts": counts, "sums_bits": sums.map(f64::to_bits) })
}

pub(super) fn counters_of_json(json: &Value) -> Option<Counters> {
    let (mut counts, mut sums) = Counters::default().to_arrays();
    for (i, count) in counts.iter_mut().enumerate() {
        *count = json["counts"][i].as_u64()?;
    }
    for (i, sum) in sums.iter_mut().enumerate() {
        *sum = f64::from_bits(json["sums_bits"][i].as_u64()?);
    }
    Some(Counters::of_arrays(counts, sums))
}

pub(super) fn phase_to_json(phase: Phase) -> Value {
    json!({ "wall_s": phase.wall.as_secs_f64(), "cpu_s": phase.cpu.as_secs_f64() })
}

pub(super) fn phase_of_json(json: &Value) -> Option<Phase> {
    let time = |name: &str| Duration::try_from_secs_f64(json[name].as_f64()?).ok();
    Some(Phase { wall: time("wall_s")?, cpu: time("cpu_s")? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Layout;
    use crate::render::Limits;
    use std::time::Instant;

    /// A film of a pixel that says to have so many samples.
    fn film(count: u32) -> Film {
        let mut film = Film::new([1, 1], Window::whole(1, 1), Layout::default());
        let mut bytes: Vec<u8> = Vec::new();
        film.write(&mut bytes).expect("into memory");
        bytes[..4].copy_from_slice(&count.to_le_bytes());
        film.read([0; 2], &mut &bytes[..]).expect("what was written");
        film
    }

    #[test]
    fn more_samples_than_there_are_to_take_are_refused() {
        let (tiles, samples) = ([Window::whole(1, 1)], 8..24);
        let course = || Course::new(&Limits::default(), Instant::now(), (&tiles, &samples));
        for (count, is_sound) in [(0, true), (16, true), (17, false), (u32::MAX, false)] {
            let (counters, spent, filtering) = Default::default();
            let state = State { film: film(count), counters, course: course(), pass: None, spent, filtering };
            let mut bytes: Vec<u8> = Vec::new();
            state.write(&json!("a picture"), &mut bytes).expect("into memory");
            let checkpoint = Checkpoint::open(&bytes[..], bytes.len() as u64).expect("sealed");
            let told = checkpoint.state((film(0), course()), &tiles, &samples).err();
            assert_eq!(told.is_none(), is_sound, "{count}: {told:?}");
        }
    }
}
