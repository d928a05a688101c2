//! The passes of a picture: the same for all tiles, or more where they bring most.

use crate::film::Film;
use crate::image::Window;
use crate::render::adaptive::Adaptive;
use crate::render::halves::Halves;
use crate::render::schedule::{PACKET, PART, Pass, Schedule};
use crate::render::{Ended, Estimate, Limits};
use serde_json::{Value, json};
use std::io::{self, Read, Write};
use std::ops::Range;
use std::time::Instant;

/// What is taken next, and when it is enough.
#[derive(Clone, Debug)]
pub(super) struct Course {
    pixels: f64,
    /// All tiles alike; with a target for the error, and little time, for the first sample, which shows the pace.
    even: Schedule,
    /// With a target for the error.
    adaptive: Option<Adaptive>,
    /// Where the error is to be known though it ends nothing: what the picture was before.
    halves: Option<Halves>,
    /// Seconds that a sample of a pixel takes.
    pace: Option<f64>,
}

impl Course {
    /// Of a picture in tiles, whose pixels get these samples at most; time counts since `start`.
    pub(super) fn new(limits: &Limits, start: Instant, (tiles, samples): (&[Window], &Range<u32>)) -> Self {
        let adaptive = limits.error.map(|target| Adaptive::new(tiles, (target, samples.end)));
        Self {
            pixels: tiles.iter().map(|tile| f64::from(tile.width()) * f64::from(tile.height())).sum(),
            even: Schedule::new(limits, start, (samples, tiles.len())),
            adaptive,
            halves: limits.is_estimated.then(Halves::default),
            pace: None,
        }
    }

    /// What is to be known of it to go on, besides the arrays of [`Course::write`].
    pub(super) fn saved(&self) -> Value {
        json!({ "even": self.even.saved(), "pace": self.pace, "adaptive": self.adaptive.is_some() })
    }

    /// Bytes of the arrays.
    pub(super) fn bytes(&self) -> u64 {
        self.adaptive.as_ref().map_or(0, Adaptive::bytes)
    }

    /// Writes what is known of tiles.
    pub(super) fn write(&self, into: &mut dyn Write) -> io::Result<()> {
        self.adaptive.as_ref().map_or(Ok(()), |adaptive| adaptive.write(into))
    }

    /// Goes on where another one of the same picture was. Fails where that makes no sense.
    pub(super) fn restored(self, saved: &Value, from: &mut dyn Read) -> io::Result<Self> {
        let even = self.even.restored(&saved["even"]).ok_or(io::ErrorKind::InvalidData)?;
        let goes_on = saved["adaptive"] == true;
        let adaptive = match self.adaptive.filter(|_| goes_on) {
            Some(mut adaptive) => {
                adaptive.read(from)?;
                Some(adaptive)
            }
            // Where time is too short, the error is given up; never the other way round.
            None if goes_on => return Err(io::ErrorKind::InvalidData.into()),
            None => None,
        };
        Ok(Self { even, adaptive, pace: saved["pace"].as_f64(), ..self })
    }

    /// Seconds that are left, where time counts; those of all runs have been taken off.
    pub(super) fn left(&self) -> Option<f64> {
        self.even.left().map(|[left, _]| left)
    }

    /// The next pass; `None` when it is enough. A pass that begins at sample 0 begins anew: what there was is thrown away.
    pub(super) fn next(&mut self) -> Option<Pass> {
        let Some(adaptive) = &mut self.adaptive else { return self.even.next() };
        let Some([left, limit]) = self.even.left() else { return adaptive.next(None) };
        let Some(pace) = self.pace else { return self.even.next() };
        // Two packets before anything is known of the error, and something to do with the knowledge.
        if !adaptive.has_begun() && 3.0 * f64::from(PACKET) * pace * self.pixels > left {
            self.adaptive = None;
            return self.even.next();
        }
        adaptive.next(Some([left / pace, limit * PART / pace]))
    }

    /// Notes what a pass has brought, and how long it took.
    pub(super) fn passed(&mut self, pass: &Pass, seconds: f64, (tiles, film): (&[Window], &Film)) {
        let samples = |(tile, samples): &(usize, Range<u32>)| {
            let window = tiles[*tile];
            f64::from(window.width()) * f64::from(window.height()) * f64::from(samples.end - samples.start)
        };
        let has_clock = self.even.left().is_some();
        let is_trial = has_clock && self.pace.is_none();
        self.pace = Some((seconds / pass.shares.iter().map(samples).sum::<f64>()).max(1e-12));
        match &mut self.adaptive {
            Some(adaptive) if !is_trial => adaptive.passed(pass, film),
            _ => self.even.passed(pass, seconds),
        }
        if let (None, Some(halves)) = (&self.adaptive, &mut self.halves) {
            halves.passed(pass, film);
        }
    }

    /// Samples of all pixels that are expected in all, as far as is known before a pass.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive number of samples"
    )]
    pub(super) fn forecast(&self, pass: &Pass) -> u64 {
        match &self.adaptive {
            Some(adaptive) if adaptive.expected() > 0.0 => adaptive.expected() as u64,
            _ => (self.pixels * f64::from(self.even.forecast(pass))) as u64,
        }
    }

    /// What ended the picture, once there is no pass left.
    pub(super) fn ended(&self) -> Ended {
        self.adaptive.as_ref().map_or(self.even.ended(), Adaptive::ended)
    }

    /// The error of the picture, where it is known.
    pub(super) fn estimate(&self, film: &Film) -> Option<Estimate> {
        let noise = match (&self.adaptive, &self.halves) {
            (Some(adaptive), _) => adaptive.noise()?,
            (None, halves) => halves.as_ref()?.noise(film)?,
        };
        Some(Estimate { error: noise.mean(), bound: noise.bound() })
    }
}
