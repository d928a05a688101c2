//! Films of other samples of the same picture, added.

use super::sums::Film;

impl Film {
    /// Adds the sums of a film of later samples, or of other pixels. Within rounding the same as if all samples had been added to
    /// one film; to the bit, where no pixel has samples in both.
    ///
    /// # Panics
    /// If the other film reaches beyond this one or has another layout.
    pub fn add(&mut self, later: &Self) {
        assert_eq!(self.layout(), later.layout(), "layout of a film");
        let values = self.layout().len();
        let rows: Vec<_> = self.rows(later.window()).collect();
        let (sums, more) = (&mut self.sums, &later.sums);
        for (here, there, width) in rows {
            for (count, more) in sums.counts[here..here + width].iter_mut().zip(&more.counts[there..]) {
                *count = count.saturating_add(*more);
            }
            sum(&mut sums.weights[here..here + width], &more.weights[there..]);
            let row = here * values..(here + width) * values;
            sum(&mut sums.plain[row.clone()], &more.plain[there * values..]);
            sum(&mut sums.weighted[row], &more.weighted[there * values..]);
            if !sums.squares.is_empty() {
                for (squares, more) in sums.squares[here..here + width].iter_mut().zip(&more.squares[there..])
                {
                    *squares += *more;
                }
            }
            if !sums.shares.is_empty() {
                for (shares, more) in sums.shares[here..here + width].iter_mut().zip(&more.shares[there..]) {
                    shares.merge(more);
                }
            }
        }
        sums.non_finite.merge(&more.non_finite);
    }
}

fn sum(sums: &mut [f64], more: &[f64]) {
    sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Aov, Layout, SampleId, Seen, Tile};
    use crate::image::Window;

    /// Samples of a film of 3 by 2 pixels, those of which `wanted` says yes.
    fn film(wanted: impl Fn(u32) -> bool) -> Film {
        let window = Window { x0: 1, y0: 1, x1: 4, y1: 3 };
        let layout = Layout::with([Aov::Variance, Aov::ObjectId, Aov::CryptoMaterial]);
        let mut tile = Tile::new(window, layout.clone());
        for y in 1..3 {
            for x in 1..4 {
                for index in (0..16).filter(|&index| wanted(index)) {
                    let at = SampleId { y, x, index };
                    let value = (x * 7 + y * 3 + index * index % 11) as f32 * 0.37;
                    let weight = 0.5 + index as f32 / 15.0;
                    let red = if index == 5 && x == 2 { f32::NAN } else { value };
                    let seen = Seen {
                        object: index % 3,
                        material: (x + index) % 4,
                        depth: 3.0 - (index % 7) as f32,
                    };
                    tile.see(at, weight, seen);
                    tile.add(at, weight, &[red, 0.3 * value, 1.0 / value, (index % 2) as f32]);
                }
            }
        }
        let mut film = Film::new([5, 4], window, layout);
        film.put(&tile);
        film
    }

    #[test]
    fn slices_add_up_to_all_samples() {
        let (whole, mut parts) = (film(|_| true), film(|index| index < 7));
        parts.add(&film(|index| index >= 7));
        assert_eq!(parts.samples(), whole.samples(), "samples");
        assert_eq!(parts.non_finite(), whole.non_finite(), "what was dropped");
        for &aov in whole.layout().aovs() {
            let (one, other) = (whole.channels(aov).expect("kept"), parts.channels(aov).expect("kept"));
            for (one, other) in one.iter().flatten().zip(other.iter().flatten()) {
                assert!((one - other).abs() <= 1e-6 * one.abs(), "{}: {one}, {other}", aov.name());
            }
        }
    }

    #[test]
    fn nothing_added_changes_nothing() {
        let mut film = film(|_| true);
        let before = film.clone();
        film.add(&Film::new(film.full(), film.window(), film.layout().clone()));
        assert_eq!(film, before, "the same");
    }
}
