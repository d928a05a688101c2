//! Which tiles get more samples.
//!
//! A tile of s_i at one sample, relMSE as in `noise.rs`, has the error s_i/n_i with n_i of them. The fewest samples for a mean error of T
//! are n_i in proportion to sqrt(s_i) (Lagrange; Cochran 1977, "Sampling techniques", section 5.5, Neyman's allocation). Sampling each tile
//! until its own error is T takes sum s_i/T samples, just as many as the same number everywhere: nothing would be won.
//!
//! Samples that were taken stay, so n_i is the larger of what there is and l sqrt(s_i), with l such that the mean is T; tiles that would
//! get more go on, by a third or a half of what they have, and then all is estimated again. A tile's own s_i may miss what
//! comes once in many samples: it is shared in with that of its neighbours, and no tile stays far behind the most sampled one.

/// A tile as it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    /// Its place in the grid of tiles.
    pub(super) at: [usize; 2],
    pub(super) pixels: f64,
    /// The mean error of its pixels.
    pub(super) error: f64,
    /// Samples of each pixel.
    pub(super) taken: u32,
}

/// No tile has fewer samples than this part of the most sampled one's.
const BEHIND: f64 = 1.0 / 16.0;

/// At least this part of the tiles goes on.
const FEWEST: usize = 32;

/// Which tiles of a grid of `columns` go on for the mean error to become `target`, those to which it matters most first: with how many
/// samples each is to have at last. `next` says how many a tile gets at once, and does not go beyond `most`.
pub(super) fn wanted(
    tiles: &[State],
    columns: usize,
    (target, most): (f64, u32),
    next: impl Fn(u32) -> u32,
) -> Vec<(usize, f64)> {
    let spread: Vec<f64> = (0..tiles.len()).map(|tile| shared(tiles, columns, tile).sqrt()).collect();
    let cap = f64::from(most);
    let of = |l: f64, tile: usize| f64::from(tiles[tile].taken).max((l * spread[tile]).min(cap));
    let pixels: f64 = tiles.iter().map(|tile| tile.pixels).sum();
    let mean = |l: f64| {
        let error = |(tile, state): (usize, &State)| {
            state.pixels * state.error * f64::from(state.taken) / of(l, tile)
        };
        tiles.iter().enumerate().map(error).sum::<f64>() / pixels
    };
    let l = least(mean, target, cap / spread.iter().copied().fold(f64::INFINITY, smaller));
    let highest = (0..tiles.len()).map(|tile| of(l, tile)).fold(0.0, f64::max);
    let goal = |tile: usize| of(l, tile).max(highest * BEHIND);
    let ratio = |tile: usize| goal(tile) / f64::from(tiles[tile].taken);
    let mut order: Vec<usize> = (0..tiles.len()).filter(|&tile| tiles[tile].taken < most).collect();
    order.sort_by(|&a, &b| ratio(b).total_cmp(&ratio(a)).then(a.cmp(&b)));
    let middle = |tile: usize| (f64::from(next(tiles[tile].taken)) / f64::from(tiles[tile].taken)).sqrt();
    let many = order.iter().filter(|&&tile| ratio(tile) >= middle(tile)).count();
    order.retain(|&tile| ratio(tile) >= middle(tile) || many < tiles.len().div_ceil(FEWEST));
    order.truncate(many.max(tiles.len().div_ceil(FEWEST)));
    order.into_iter().map(|tile| (tile, goal(tile))).collect()
}

/// The smaller one that is above 0.
fn smaller(a: f64, b: f64) -> f64 {
    if b > 0.0 { a.min(b) } else { a }
}

/// The least number from 0 to `end` for which a falling function is at most `target`; `end` if there is none.
fn least(falling: impl Fn(f64) -> f64, target: f64, end: f64) -> f64 {
    if !end.is_finite() {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, end);
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if falling(middle) > target { low = middle } else { high = middle }
    }
    high
}

/// What a tile's pixels vary by at one sample: half from its own, half from those around it and its own.
fn shared(tiles: &[State], columns: usize, tile: usize) -> f64 {
    let own = |state: &State| state.error * f64::from(state.taken);
    let [x, y] = tiles[tile].at;
    let (mut sum, mut pixels) = (0.0, 0.0);
    for row in y.saturating_sub(1)..=y + 1 {
        for column in x.saturating_sub(1)..=(x + 1).min(columns - 1) {
            if let Some(state) = tiles.get(row * columns + column) {
                sum += state.pixels * own(state);
                pixels += state.pixels;
            }
        }
    }
    0.5 * (own(&tiles[tile]) + sum / pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of tiles of that variance at one sample, with so many samples.
    fn row(variances: &[f64], taken: u32) -> Vec<State> {
        let state =
            |(x, &s): (usize, &f64)| State { at: [x, 0], pixels: 256.0, error: s / f64::from(taken), taken };
        variances.iter().enumerate().map(state).collect()
    }

    fn next(taken: u32) -> u32 {
        taken + taken / 2
    }

    #[test]
    fn samples_go_where_they_bring_most() {
        let mut variances = vec![0.1; 30];
        variances[10..20].fill(100.0);
        let found = wanted(&row(&variances, 32), 30, (0.1, 1 << 16), next);
        let mut tiles: Vec<_> = found.iter().map(|(tile, _)| *tile).collect();
        tiles.sort_unstable();
        assert_eq!(tiles, (9..21).collect::<Vec<_>>(), "the noisy ones and their neighbours");
        // 3 in all, of which calm ones have 20 times 0.1/32: the noisy ones have 100/n each.
        let goal = found.iter().find(|(tile, _)| *tile == 15).expect("there").1;
        assert!((300.0..440.0).contains(&goal), "{goal}");
    }

    #[test]
    fn nobody_stays_far_behind_and_nobody_goes_beyond_the_most() {
        let mut tiles = row(&[0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0], 32);
        tiles[3].taken = 1024;
        let found = wanted(&tiles, 7, (1e-4, 2048), next);
        assert!(found.iter().any(|(tile, _)| *tile == 0), "a calm one: {found:?}");
        assert!(found.iter().all(|(_, goal)| *goal <= 2048.0), "{found:?}");
        let done = row(&[1.0, 1.0], 64);
        assert_eq!(wanted(&done, 2, (1e-9, 64), next), [], "all have the most");
    }

    #[test]
    fn somebody_goes_on_even_for_a_little() {
        let found = wanted(&row(&[1.0; 64], 100), 64, (0.009_999, 1 << 16), next);
        assert_eq!(found.len(), 2, "the first of equals: {found:?}");
    }
}
