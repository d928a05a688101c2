//! The noise of a picture whose tiles all have the same samples, from what it was with some of them.
//!
//! Where time counts, how many samples there will be is not known before it is over, so the picture is copied whenever its samples have doubled;
//! the last copy that is early enough serves (`noise.rs` says how). Without a limit of time there are two passes, and the copy after the first
//! one serves. A picture that is gone on with has lost its copies and begins to make them anew.

use crate::film::Film;
use crate::render::noise::{Noise, Values};
use crate::render::schedule::Pass;
use std::ops::Range;

/// Pictures with fewer samples.
#[derive(Clone, Debug, Default)]
pub(super) struct Halves {
    /// Samples of each pixel, and its radiance; the later one last.
    copies: Vec<(u32, Values)>,
    /// Samples that there are now.
    taken: u32,
}

/// The part of all samples that a copy has at most, to be compared with the picture: what is left is too little to go by otherwise.
const EARLY: f64 = 0.75;

impl Halves {
    /// Notes that a pass has been taken.
    pub(super) fn passed(&mut self, pass: &Pass, film: &Film) {
        let Some((_, Range { start, end })) = pass.shares.first() else { return };
        if *start == 0 {
            self.copies.clear();
        }
        self.taken = *end;
        if self.copies.last().is_none_or(|(before, _)| self.taken >= before.saturating_mul(2)) {
            self.copies.push((self.taken, film.values(film.window())));
            // The picture itself is no copy to compare it with.
            let many = self.copies.len().saturating_sub(2);
            self.copies.drain(..many);
        }
    }

    /// That of the picture; `None` where there is nothing to compare it with.
    pub(super) fn noise(&self, film: &Film) -> Option<Noise> {
        let (early, before) = self.early()?;
        Some(Noise::of(&film.values(film.window()), before, [*early, self.taken]))
    }

    /// The last copy that is early enough.
    fn early(&self) -> Option<&(u32, Values)> {
        let is_early = |taken: u32| f64::from(taken) <= EARLY * f64::from(self.taken);
        self.copies.iter().rev().find(|(taken, _)| is_early(*taken))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Layout;
    use crate::image::Window;

    #[test]
    fn the_copy_is_neither_too_early_nor_too_late() {
        let film = Film::new([1, 1], Window::whole(1, 1), Layout::default());
        let mut halves = Halves::default();
        let early = |halves: &Halves| halves.early().map(|(taken, _)| *taken);
        let mut taken = 0;
        for (end, wanted) in
            [(1, None), (4, Some(1)), (5, Some(1)), (6, Some(4)), (9, Some(4)), (12, Some(9)), (40, Some(9))]
        {
            halves.passed(&Pass { shares: vec![(0, taken..end)], coherent: false }, &film);
            taken = end;
            assert_eq!(early(&halves), wanted, "with {end} samples");
        }
        halves.passed(&Pass { shares: vec![(0, 0..16)], coherent: true }, &film);
        assert_eq!(early(&halves), None, "begun anew");
        assert!(halves.noise(&film).is_none(), "nothing to compare with");
    }
}
