//! Which samples are taken next, and when it is enough.
//!
//! A picture without limits is one pass, or two of whole packets where its error is to be estimated. With a limit of time it is made in
//! passes over all tiles, so that all pixels have the same number of samples when time is over; no pass is begun that would not end in time
//! by the pace of the one before.
//!
//! How many samples there will be is not known beforehand, yet a picture that was ended at N samples is to be that of N samples, bit for
//! bit. Sums go on where they were left; what is left is how camera rays are traced, in packets of one pixel where all samples
//! are whole packets, else each for itself. So passes are whole packets where the limit leaves time for many of
//! them, after a trial of one sample that is thrown away; where it does not, they are any number of samples and camera rays are traced each
//! for itself. Then a picture of N samples, N a multiple of sixteen, may differ on edges from one made in one go.

use crate::render::{Ended, Limits};
use serde_json::{Value, json};
use std::ops::Range;
use std::time::{Duration, Instant};

/// Samples of some tiles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Pass {
    /// Numbers of tiles, and which samples of each of their pixels.
    pub(super) shares: Vec<(usize, Range<u32>)>,
    /// Whether camera rays may be traced in packets that hold one pixel's only.
    pub(super) coherent: bool,
}

/// Rays of the widest packet.
pub(super) const PACKET: u32 = 16;

/// The part of the time that a pass takes at most, if that is a sample or, of passes of packets, a packet.
pub(super) const PART: f64 = 1.0 / 32.0;

/// Passes for a picture.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    /// Since when time counts, and how long.
    clock: Option<(Instant, Duration)>,
    /// The first sample of a pixel.
    first: u32,
    /// The end of those that a pixel gets at most.
    most: u32,
    tiles: usize,
    /// The end of those that each pixel has.
    taken: u32,
    /// Whether passes are whole packets.
    packets: bool,
    /// Without a clock, where the first of two passes ends: both of whole packets, so that the picture is that of one.
    half: Option<u32>,
    /// Seconds that one sample of every pixel takes.
    pace: Option<f64>,
    ended: Ended,
}

impl Schedule {
    /// Of a picture of so many tiles, whose pixels get these samples at most; time counts since `start`.
    pub(super) fn new(limits: &Limits, start: Instant, (samples, tiles): (&Range<u32>, usize)) -> Self {
        Self {
            clock: limits.time.map(|time| (start, time)),
            first: samples.start,
            most: samples.end,
            tiles,
            taken: samples.start,
            packets: false,
            half: half(limits, samples),
            pace: None,
            ended: Ended::Samples,
        }
    }

    /// Seconds that are left, and how many there were in all; where time counts.
    pub(super) fn left(&self) -> Option<[f64; 2]> {
        let (start, limit) = self.clock?;
        Some([limit.saturating_sub(start.elapsed()), limit].map(|time| time.as_secs_f64()))
    }

    /// What ended the picture, once there is no pass left.
    pub(super) fn ended(&self) -> Ended {
        self.ended
    }

    /// What is to be known of it to go on.
    pub(super) fn saved(&self) -> Value {
        let elapsed = self.clock.map(|(start, _)| start.elapsed().as_secs_f64());
        json!({ "taken": self.taken, "packets": self.packets, "pace": self.pace, "elapsed_s": elapsed })
    }

    /// Goes on where another one was; time that it took counts. `None` if that makes no sense.
    pub(super) fn restored(mut self, saved: &Value) -> Option<Self> {
        let taken = u32::try_from(saved["taken"].as_u64()?).ok()?;
        self.taken = (self.first..=self.most).contains(&taken).then_some(taken)?;
        self.packets = saved["packets"].as_bool()?;
        self.pace = saved["pace"].as_f64();
        if let Some((start, _)) = &mut self.clock {
            let elapsed = Duration::try_from_secs_f64(saved["elapsed_s"].as_f64()?).ok()?;
            *start = start.checked_sub(elapsed)?;
        }
        Some(self)
    }

    /// How many samples of a pixel there will have been at the end of the pass, and, as far as is known, of the picture.
    pub(super) fn forecast(&self, pass: &Pass) -> u32 {
        let of_pass = pass.shares.first().map_or(0, |(_, samples)| samples.end);
        let Some((_, limit)) = self.clock else { return self.most - self.first };
        let Some(pace) = self.pace else { return self.most };
        whole(limit.as_secs_f64() / pace).clamp(of_pass.min(self.most), self.most)
    }

    /// The next pass; `None` when it is enough. A pass that begins at sample 0 begins anew: what there was is thrown away.
    pub(super) fn next(&mut self) -> Option<Pass> {
        let Some([left, limit]) = self.left() else {
            let end = self.half.filter(|half| self.taken < *half).unwrap_or(self.most);
            return (self.taken < self.most).then(|| self.all(end, true));
        };
        let Some(pace) = self.pace else { return Some(self.all(1, false)) };
        if self.taken == 1 && !self.packets && self.is_trial(pace, limit, left) {
            self.packets = true;
            self.taken = 0;
        }
        if self.taken >= self.most {
            return None;
        }
        let fits = whole((left / pace).min(limit * PART / pace));
        // One sample, or one packet where there are packets, is taken whatever part of the time it needs, if it ends in time.
        let step = match (self.packets, left / pace) {
            (false, left) => fits.max(u32::from(left >= 1.0)),
            (true, left) if left >= f64::from(PACKET) => (fits / PACKET * PACKET).max(PACKET),
            (true, _) => 0,
        };
        if step == 0 && self.taken > 0 {
            self.ended = Ended::Time;
            return None;
        }
        let mut end = self.taken.saturating_add(step.max(1)).min(self.most);
        // Not a multiple of packets, if that can be had: then it is as it would be in one go.
        if !self.packets && end.is_multiple_of(PACKET) && end < self.most && step > 1 {
            end -= 1;
        }
        Some(self.all(end, self.packets))
    }

    /// Whether the one sample so far was to find out the pace: there is time for many packets.
    fn is_trial(&self, pace: f64, limit: f64, left: f64) -> bool {
        let packet = pace * f64::from(PACKET);
        self.most.is_multiple_of(PACKET) && packet <= limit * PART && 2.0 * packet <= left
    }

    /// Notes how long a pass took.
    pub(super) fn passed(&mut self, pass: &Pass, seconds: f64) {
        let Some((_, samples)) = pass.shares.first() else { return };
        self.pace = Some((seconds / f64::from(samples.end - samples.start)).max(1e-9));
        self.taken = samples.end;
    }

    /// Samples of all tiles, up to `end`.
    fn all(&self, end: u32, coherent: bool) -> Pass {
        Pass { shares: (0..self.tiles).map(|tile| (tile, self.taken..end)).collect(), coherent }
    }
}

/// Where a picture is cut in two, for its noise to be estimated.
fn half(limits: &Limits, samples: &Range<u32>) -> Option<u32> {
    let is_cut = limits.is_estimated && samples.start == 0 && samples.end >= 2 * PACKET;
    let half = (samples.end / 2).next_multiple_of(PACKET);
    (is_cut && samples.end.is_multiple_of(PACKET) && half < samples.end).then_some(half)
}

/// Rounded down.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut at both ends")]
fn whole(x: f64) -> u32 {
    x.clamp(0.0, f64::from(u32::MAX)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The passes of a picture where a sample of all pixels takes `pace` seconds and `limit` seconds are given, on a clock of its own:
    /// the start moves back as time goes by.
    fn passes(limit: f64, pace: impl Fn(u32) -> f64, most: u32) -> (Vec<Pass>, f64, Ended) {
        let limits = Limits { time: Some(Duration::from_secs_f64(limit)), ..Limits::default() };
        let start = Instant::now();
        let mut schedule = Schedule::new(&limits, start, (&(0..most), 3));
        let (mut all, mut clock) = (Vec::new(), 0.0);
        while let Some(pass) = schedule.next() {
            let samples = pass.shares[0].1.clone();
            let seconds: f64 = samples.clone().map(&pace).sum();
            clock += seconds;
            schedule.passed(&pass, seconds);
            // No less than has passed, whatever the true clock says.
            schedule.clock = Some((start - Duration::from_secs_f64(clock), Duration::from_secs_f64(limit)));
            assert_eq!(pass.shares.len(), 3, "all tiles");
            all.push(pass);
        }
        (all, clock, schedule.ended())
    }

    fn samples(pass: &Pass) -> Range<u32> {
        pass.shares[0].1.clone()
    }

    #[test]
    fn without_a_limit_there_is_one_pass() {
        let mut schedule = Schedule::new(&Limits::default(), Instant::now(), (&(0..7), 2));
        let pass = schedule.next().expect("a pass");
        assert_eq!(pass.shares, [(0, 0..7), (1, 0..7)], "all at once");
        schedule.passed(&pass, 1.0);
        assert_eq!((schedule.next(), schedule.ended()), (None, Ended::Samples), "that was all");
    }

    #[test]
    fn a_picture_whose_noise_is_wanted_is_cut_at_whole_packets() {
        let limits = Limits { is_estimated: true, ..Limits::default() };
        let cuts = |most| {
            let mut schedule = Schedule::new(&limits, Instant::now(), (&(0..most), 2));
            let mut cuts = Vec::new();
            while let Some(pass) = schedule.next() {
                schedule.passed(&pass, 1.0);
                cuts.push(samples(&pass));
            }
            cuts
        };
        assert_eq!(cuts(96), [0..48, 48..96], "in two");
        assert_eq!(cuts(48), [0..32, 32..48], "about");
        let whole = |n: u32| std::iter::once(0..n).collect::<Vec<_>>();
        assert_eq!((cuts(40), cuts(16)), (whole(40), whole(16)), "not through packets");
    }

    #[test]
    fn passes_follow_one_another_and_end_in_time() {
        // A thousandth of a minute, and two seconds: with packets and without.
        for pace in [0.06, 2.0, 7.0] {
            let (all, clock, ended) = passes(60.0, |_| pace, 1 << 16);
            assert_eq!(ended, Ended::Time, "{pace}");
            assert!((52.0..60.1).contains(&clock), "{pace}: {clock}");
            let begin = usize::from(pace < 0.1);
            assert_eq!(samples(&all[0]), 0..1, "{pace}: the first shows the pace");
            assert_eq!(samples(&all[begin]).start, 0, "{pace}: a trial is thrown away");
            for pair in all[begin..].windows(2) {
                assert_eq!(samples(&pair[0]).end, samples(&pair[1]).start, "{pace}: no gap");
            }
            let packets = |pass: &Pass| samples(pass).end.is_multiple_of(PACKET);
            assert!(all[begin..].iter().all(|pass| pass.coherent == (begin == 1)), "{pace}: one way");
            assert!(begin == 0 || all[1..].iter().all(packets), "{pace}: whole packets");
        }
    }

    #[test]
    fn a_pace_that_doubles_overruns_by_a_pass_at_most() {
        let (_, clock, _) = passes(60.0, |index| if index < 400 { 0.03 } else { 0.12 }, 1 << 16);
        assert!((55.0..60.0 * (1.0 + 4.0 * PART)).contains(&clock), "{clock}");
    }

    #[test]
    fn what_is_done_before_time_is_over_has_all_samples() {
        let (all, _, ended) = passes(60.0, |_| 1e-3, 48);
        assert_eq!(ended, Ended::Samples, "all");
        assert_eq!(samples(all.last().expect("a pass")).end, 48, "samples");
        let (all, _, ended) = passes(60.0, |_| 1e-3, 1);
        assert_eq!((all.len(), ended), (1, Ended::Samples), "one sample");
    }

    #[test]
    fn one_sample_is_taken_in_any_case() {
        let (all, _, ended) = passes(0.0, |_| 5.0, 64);
        assert_eq!((all.len(), ended), (1, Ended::Time), "one");
    }
}
