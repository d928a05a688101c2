//! More samples where they bring most, until the picture is as good as asked for.
//!
//! All tiles begin with two passes of a packet; from then on the error of each is known (`noise.rs`), and tiles go on that the
//! picture needs (`allocation.rs`), until the bound of the whole error is below the target. Numbers of samples are powers of two and those half
//! way between them: Sobol points are best there, and early samples are never more than twice the later ones nor less than
//! half. All decisions are made between passes, from sums that are the same on any number of threads.

use crate::film::{Film, read_numbers, write_numbers};
use crate::image::Window;
use crate::render::Ended;
use crate::render::allocation::{State, wanted};
use crate::render::noise::{Noise, Values};
use crate::render::schedule::{PACKET, Pass};
use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};
use std::io::{self, Read, Write};

/// A picture whose tiles get samples by their noise.
#[derive(Clone, Debug)]
pub(super) struct Adaptive {
    target: f64,
    /// How many samples a pixel gets at most.
    most: u32,
    /// Tiles in a row.
    columns: usize,
    tiles: Vec<Tile>,
    ended: Ended,
    /// Samples that are expected in all.
    expected: f64,
}

/// A tile, and what is known of it.
#[derive(Clone, Debug)]
struct Tile {
    window: Window,
    /// Samples of each pixel.
    taken: u32,
    /// The first of them, and what pixels were by those alone.
    early: u32,
    before: Values,
    noise: Option<Noise>,
}

impl Adaptive {
    /// Nothing taken yet; tiles are by rows.
    pub(super) fn new(windows: &[Window], (target, most): (f64, u32)) -> Self {
        let top = windows.first().map_or(0, |window| window.y0);
        let tile = |&window: &Window| Tile { window, taken: 0, early: 0, before: Vec::new(), noise: None };
        Self {
            target,
            most,
            columns: windows.iter().take_while(|window| window.y0 == top).count(),
            tiles: windows.iter().map(tile).collect(),
            ended: Ended::Samples,
            expected: 0.0,
        }
    }

    /// What ended the picture, once there is no pass left.
    pub(super) fn ended(&self) -> Ended {
        self.ended
    }

    /// Whether there are samples.
    pub(super) fn has_begun(&self) -> bool {
        self.tiles.iter().any(|tile| tile.taken > 0)
    }

    /// Samples of all pixels that are expected in all.
    pub(super) fn expected(&self) -> f64 {
        self.expected
    }

    /// The error of the picture, where it is known.
    pub(super) fn noise(&self) -> Option<Noise> {
        let mut noise = Noise::default();
        for tile in &self.tiles {
            noise += tile.noise?;
        }
        Some(noise)
    }

    /// The next pass; `None` when it is enough. `room` is for how many samples, all pixels counted, there is time: all in all, and at once.
    pub(super) fn next(&mut self, room: Option<[f64; 2]>) -> Option<Pass> {
        let coherent = self.most.is_multiple_of(PACKET);
        let Some(noise) = self.noise() else {
            let shares: Vec<_> = (0..self.tiles.len()).filter_map(|tile| self.share(tile)).collect();
            self.expected = self.pixels() * f64::from(2 * PACKET.min(self.most));
            return (!shares.is_empty()).then_some(Pass { shares, coherent });
        };
        if noise.bound() <= self.target {
            self.ended = Ended::Error;
            return None;
        }
        let target = (self.target / noise.factor(), self.most);
        let order = wanted(&self.states(), self.columns, target, |taken| step(taken, self.most));
        self.expected = self.expected_of(&order);
        let mut shares = Vec::new();
        let [left, mut at_once] = room.unwrap_or([f64::INFINITY; 2]);
        at_once = at_once.min(left);
        for (tile, _) in order {
            let Some(share) = self.share(tile) else { continue };
            let samples = f64::from(share.1.end - share.1.start) * area(&self.tiles[tile]);
            if samples > if shares.is_empty() { left } else { at_once } {
                self.ended = if shares.is_empty() { Ended::Time } else { self.ended };
                break;
            }
            at_once -= samples;
            shares.push(share);
        }
        (!shares.is_empty()).then_some(Pass { shares, coherent })
    }

    /// Notes what a pass has brought.
    pub(super) fn passed(&mut self, pass: &Pass, film: &Film) {
        let tiles = &self.tiles;
        let found: Vec<_> = pass
            .shares
            .par_iter()
            .map(|(index, samples)| {
                let tile = &tiles[*index];
                let now = film.values(tile.window);
                let noise =
                    (tile.early > 0).then(|| Noise::of(&now, &tile.before, [tile.early, samples.end]));
                (now, noise)
            })
            .collect();
        for ((index, samples), (now, noise)) in pass.shares.iter().zip(found) {
            let tile = &mut self.tiles[*index];
            tile.taken = samples.end;
            tile.noise = noise.or(tile.noise);
            if tile.early == 0 || tile.taken.is_power_of_two() {
                tile.early = tile.taken;
                tile.before = now;
            }
        }
    }

    /// Bytes of [`Adaptive::write`].
    pub(super) fn bytes(&self) -> u64 {
        let values: usize = self.tiles.iter().map(|tile| tile.before.len()).sum();
        (36 * self.tiles.len() + 12 * values) as u64
    }

    /// Writes what is known of the tiles: three `u32` of each, samples, how many of them are early, and whether the noise is known (1 or
    /// 0); then three `f64` of each, the noise; then three `f32` for each pixel of those with early samples, what it was by those.
    pub(super) fn write(&self, into: &mut dyn Write) -> io::Result<()> {
        let head = |tile: &Tile| [tile.taken, tile.early, u32::from(tile.noise.is_some())];
        let noise = |tile: &Tile| {
            let Noise { pixels, sum, squares } = tile.noise.unwrap_or_default();
            [pixels, sum, squares]
        };
        write_numbers(into, self.tiles.iter().flat_map(head))?;
        write_numbers(into, self.tiles.iter().flat_map(noise))?;
        write_numbers(into, self.tiles.iter().flat_map(|tile| tile.before.iter().flatten().copied()))
    }

    /// Goes on with what another one has written.
    pub(super) fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let heads: Vec<u32> = read_numbers(from, 3 * self.tiles.len())?;
        let noises: Vec<f64> = read_numbers(from, 3 * self.tiles.len())?;
        let known = heads.as_chunks().0.iter().zip(noises.as_chunks().0);
        for (tile, (&[taken, early, is_known], &[pixels, sum, squares])) in self.tiles.iter_mut().zip(known) {
            if early > taken || taken > self.most {
                return Err(io::ErrorKind::InvalidData.into());
            }
            (tile.taken, tile.early) = (taken, early);
            tile.noise = (is_known == 1).then_some(Noise { pixels, sum, squares });
            let values = if early > 0 { 3 * tile.window.area() } else { 0 };
            tile.before = read_numbers(from, values)?.as_chunks().0.to_vec();
        }
        Ok(())
    }

    /// The samples that a tile gets next.
    fn share(&self, tile: usize) -> Option<(usize, std::ops::Range<u32>)> {
        let taken = self.tiles[tile].taken;
        (taken < self.most).then(|| (tile, taken..step(taken, self.most)))
    }

    fn states(&self) -> Vec<State> {
        let state = |(index, tile): (usize, &Tile)| State {
            at: [index % self.columns, index / self.columns],
            pixels: area(tile),
            error: tile.noise.map_or(0.0, |noise| noise.mean()),
            taken: tile.taken,
        };
        self.tiles.iter().enumerate().map(state).collect()
    }

    fn pixels(&self) -> f64 {
        self.tiles.iter().map(area).sum()
    }

    fn expected_of(&self, order: &[(usize, f64)]) -> f64 {
        let taken = |tile: &Tile| area(tile) * f64::from(tile.taken);
        let more = |&(tile, goal): &(usize, f64)| {
            area(&self.tiles[tile]) * (goal - f64::from(self.tiles[tile].taken)).max(0.0)
        };
        self.tiles.iter().map(taken).sum::<f64>() + order.iter().map(more).sum::<f64>()
    }
}

/// Pixels of a tile.
#[expect(clippy::cast_precision_loss, reason = "few pixels")]
fn area(tile: &Tile) -> f64 {
    tile.window.area() as f64
}

/// How many samples a tile has after its next pass.
fn step(taken: u32, most: u32) -> u32 {
    let next = match taken {
        0 => PACKET.min((most / 2).max(1)),
        _ if taken < 2 * PACKET => 2 * taken,
        _ if taken.is_power_of_two() => taken + taken / 2,
        _ => taken + taken / 3,
    };
    // The last step takes in the one before it where it would be too short to tell anything.
    if next.is_power_of_two() && most < next + next / 2 { most } else { next.min(most) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_powers_of_two_and_half_way() {
        let steps = |most| {
            let mut steps = vec![step(0, most)];
            while *steps.last().expect("one") < most {
                steps.push(step(steps[steps.len() - 1], most));
            }
            steps
        };
        assert_eq!(steps(200), [16, 32, 48, 64, 96, 128, 192, 200], "many");
        assert_eq!(steps(130), [16, 32, 48, 64, 96, 130], "no step of two");
        assert_eq!(steps(17), [8, 17], "not half as many more");
        assert_eq!(steps(7), [3, 6, 7], "few");
        assert_eq!(steps(1), [1], "one");
    }
}
