//! Contestants in turn, pass after pass, so that what disturbs the machine disturbs them alike.
//!
//! What is compared are ratios within a pass; absolute rates are of one machine on one day.

/// A median, and how far values lie about it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Half of the values are not above it.
    pub median: f64,
    /// Half the distance between the quartiles.
    pub half_iqr: f64,
}

impl Spread {
    /// Of these values; zero of none.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        let Some(last) = values.len().checked_sub(1) else { return Self::default() };
        let at = |part: usize| values[last * part / 4];
        Self { median: at(2), half_iqr: (at(3) - at(1)) * 0.5 }
    }
}

/// Runs contestants `0..count` once each to warm up, then in `passes` passes that count, there and back again so that none
/// always runs first. What `run` said of each contestant, pass by pass; stops at its first error.
pub fn interleave<T, E>(
    count: usize,
    passes: usize,
    mut run: impl FnMut(usize) -> Result<T, E>,
) -> Result<Vec<Vec<T>>, E> {
    let mut found: Vec<Vec<T>> = (0..count).map(|_| Vec::with_capacity(passes)).collect();
    for pass in 0..=passes {
        for turn in 0..count {
            let turn = if pass % 2 == 0 { turn } else { count - 1 - turn };
            let said = run(turn)?;
            if pass > 0 {
                found[turn].push(said);
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_go_there_and_back_and_the_first_does_not_count() {
        let mut order = Vec::new();
        let found = interleave(3, 2, |turn| {
            order.push(turn);
            Ok::<_, ()>(order.len())
        });
        assert_eq!(order, [0, 1, 2, 2, 1, 0, 0, 1, 2], "turns");
        assert_eq!(found, Ok(vec![vec![6, 7], vec![5, 8], vec![4, 9]]), "counted");
    }

    #[test]
    fn an_error_ends_the_race() {
        let mut runs = 0;
        let found = interleave(2, 9, |turn| {
            runs += 1;
            if turn == 1 { Err("tripped") } else { Ok(()) }
        });
        assert_eq!((found, runs), (Err("tripped"), 2), "at once");
    }

    #[test]
    fn spreads_are_half_the_distance_of_quartiles() {
        let spread = Spread::of([9.0, 1.0, 5.0, 2.0, 7.0]);
        assert_eq!((spread.median, spread.half_iqr), (5.0, 2.5), "of five");
        assert_eq!(Spread::of([]), Spread::default(), "of none");
        assert_eq!(Spread::of([3.0]), Spread { median: 3.0, half_iqr: 0.0 }, "of one");
    }
}
