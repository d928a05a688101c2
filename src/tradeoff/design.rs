//! At which points knobs are compared.

use crate::sampling::hash;
use std::collections::BTreeSet;

/// How points are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    /// Each knob by itself, all others as the scene says; each of these at all numbers of samples, if those are turned too.
    OneAtATime,
    /// Every combination.
    Grid,
    /// So many different combinations by chance, the same for the same seed.
    Random {
        /// How many, at most those that there are.
        points: usize,
        /// What chance follows from.
        seed: u64,
    },
}

/// Values of a knob that are compared, by the knob's name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// The knob's name.
    pub knob: String,
    /// The key of the scene file that it sets.
    pub key: String,
    /// Its values.
    pub values: Vec<String>,
}

/// What is set at a point: the number of a value for each axis, `None` as the scene says.
pub type Choice = Vec<Option<usize>>;

/// The name of the knob that curves are drawn over.
pub const SAMPLES: &str = "spp";

/// Most combinations: more is a slip of the hand.
pub const MOST: usize = 1 << 16;

impl Design {
    /// The points, each once. The scene as it is comes first, where the design has it.
    ///
    /// # Errors
    /// How many combinations there are, where they are more than [`MOST`].
    pub fn points(self, axes: &[Axis]) -> Result<Vec<Choice>, usize> {
        let points = match self {
            Self::OneAtATime => one_at_a_time(axes),
            Self::Grid => {
                let count = combinations(axes);
                if count > MOST {
                    return Err(count);
                }
                (0..count).map(|number| combination(axes, number)).collect()
            }
            Self::Random { points, seed } => random(axes, points, seed),
        };
        if points.len() > MOST { Err(points.len()) } else { Ok(points) }
    }

    /// As typed.
    #[must_use]
    pub fn word(self) -> String {
        match self {
            Self::OneAtATime => "one-at-a-time".to_owned(),
            Self::Grid => "grid".to_owned(),
            Self::Random { points, seed } => format!("random:{points} of seed {seed}"),
        }
    }
}

fn one_at_a_time(axes: &[Axis]) -> Vec<Choice> {
    let samples = axes.iter().position(|axis| axis.knob == SAMPLES);
    let over_samples: Vec<Option<usize>> = match samples {
        Some(axis) => (0..axes[axis].values.len()).map(Some).collect(),
        None => vec![None],
    };
    let plain = vec![None; axes.len()];
    let mut points = vec![plain.clone()];
    for (number, axis) in axes.iter().enumerate().filter(|(number, _)| Some(*number) != samples) {
        points.extend((0..axis.values.len()).map(|value| {
            let mut point = plain.clone();
            point[number] = Some(value);
            point
        }));
    }
    let at = |point: &Choice, count: Option<usize>| {
        let mut point = point.clone();
        if let Some(axis) = samples {
            point[axis] = count;
        }
        point
    };
    points.iter().flat_map(|point| over_samples.iter().map(move |&count| at(point, count))).collect()
}

/// How many combinations there are; at most the greatest number that there is.
fn combinations(axes: &[Axis]) -> usize {
    axes.iter().map(|axis| axis.values.len()).fold(1, usize::saturating_mul)
}

/// A combination by its number: the last axis counts fastest.
fn combination(axes: &[Axis], mut number: usize) -> Choice {
    let mut point = vec![None; axes.len()];
    for (axis, value) in axes.iter().zip(&mut point).rev() {
        *value = Some(number % axis.values.len());
        number /= axis.values.len();
    }
    point
}

/// Different combinations, drawn one after the other; in order of their numbers.
#[expect(clippy::cast_possible_truncation, reason = "a remainder by a number of that type")]
fn random(axes: &[Axis], points: usize, seed: u64) -> Vec<Choice> {
    let count = combinations(axes);
    if points >= count {
        return (0..count).map(|number| combination(axes, number)).collect();
    }
    let mut chosen = BTreeSet::new();
    let halves = [seed as u32, (seed >> 32) as u32];
    for draw in 0_u32.. {
        if chosen.len() == points {
            break;
        }
        let word = |half: u32| {
            u64::from(hash::combine(hash::combine(hash::mix(halves[0]), halves[1]), 2 * draw + half))
        };
        let number = (word(0) << 32) | word(1);
        chosen.insert((number % count as u64) as usize);
    }
    chosen.into_iter().map(|number| combination(axes, number)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(knob: &str, values: usize) -> Axis {
        let values = (0..values).map(|value| value.to_string()).collect();
        Axis { knob: knob.to_owned(), key: format!("render.{knob}"), values }
    }

    fn count(design: Design, axes: &[Axis]) -> usize {
        let points = design.points(axes).expect("few");
        let different: BTreeSet<_> = points.iter().collect();
        assert_eq!(different.len(), points.len(), "{design:?}: each once");
        points.len()
    }

    #[test]
    fn designs_have_as_many_points_as_they_should() {
        let axes = [axis(SAMPLES, 3), axis("a", 4), axis("b", 2)];
        assert_eq!(count(Design::OneAtATime, &axes), (1 + 4 + 2) * 3, "each value at each number of samples");
        assert_eq!(count(Design::OneAtATime, &axes[1..]), 1 + 4 + 2, "the scene and each value");
        assert_eq!(count(Design::OneAtATime, &axes[..1]), 3, "samples alone");
        assert_eq!(count(Design::OneAtATime, &[]), 1, "the scene alone");
        assert_eq!(count(Design::Grid, &axes), 24, "all");
        let random = |points, seed| Design::Random { points, seed };
        assert_eq!(count(random(7, 1), &axes), 7, "some");
        assert_eq!(count(random(70, 1), &axes), 24, "no more than there are");
        assert_eq!(random(7, 1).points(&axes), random(7, 1).points(&axes), "repeated");
        assert_ne!(random(7, 1).points(&axes), random(7, 2).points(&axes), "by seed");
    }

    #[test]
    fn one_at_a_time_turns_one() {
        let axes = [axis("a", 4), axis(SAMPLES, 3), axis("b", 2)];
        for point in Design::OneAtATime.points(&axes).expect("few") {
            assert!(point[0].is_none() || point[2].is_none(), "{point:?}");
            assert!(point[1].is_some(), "at a number of samples: {point:?}");
        }
    }

    #[test]
    fn too_many_are_refused_and_random_draws_from_them_all_the_same() {
        let axes: Vec<Axis> = (0..20).map(|_| axis("a", 9)).collect();
        assert!(Design::Grid.points(&axes).is_err(), "a grid");
        let points = Design::Random { points: 50, seed: 3 }.points(&axes).expect("few");
        assert_eq!(points.len(), 50, "drawn");
        let values: BTreeSet<_> = points.iter().map(|point| point[0]).collect();
        assert!(values.len() > 4, "spread over the first axis: {values:?}");
    }
}
