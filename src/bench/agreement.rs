//! Whose answers differ, how often, and whether they may.
//!
//! A ray is contested if contestants, or a witness beside them, answer it differently, or if one says "any hit" otherwise than
//! its own nearest hit does. Contested rays are traced by [`Brute`], which tests every primitive in double precision, and
//! each answer is judged by [`verdict`](super::verdict). A mistake that all contestants and the witness share is not found.

use super::query::{CHUNK, Chunk, Query, Tracer};
use super::verdict::{Verdict, is_at_boundary, judge};
use crate::accel::Brute;
use crate::geometry::{Hit, Ray, World};
use rayon::prelude::*;

/// How an answer differs from the truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Difference {
    /// Another primitive at the same distance, both met within rounding of an edge or rim.
    SharedEdge,
    /// Another primitive at the same distance, met in its middle: surfaces in the same place.
    IdTie,
    /// Within rounding of an end of the ray's range, or a hit within rounding of a boundary that the truth misses.
    Epsilon,
    /// A hit within rounding of an edge or rim that was passed over: light leaks.
    LostAtEdge,
    /// A hit that no ray within rounding would miss was passed over: wrong.
    Lost,
    /// Anything else: a hit where nothing is, or one that does not lie where it says: wrong.
    Other,
    /// Contested, but not judged, for too many were.
    Unjudged,
}

impl Difference {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::SharedEdge,
        Self::IdTie,
        Self::Epsilon,
        Self::LostAtEdge,
        Self::Lost,
        Self::Other,
        Self::Unjudged,
    ];

    /// Its name in tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::SharedEdge => "shared_edge",
            Self::IdTie => "id_tie",
            Self::Epsilon => "epsilon",
            Self::LostAtEdge => "lost_at_edge",
            Self::Lost => "lost",
            Self::Other => "other",
            Self::Unjudged => "unjudged",
        }
    }
}

/// How many answers differ, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    counts: [u64; Difference::ALL.len()],
    first_wrong: Option<u64>,
}

impl Tally {
    /// How many for this reason.
    #[must_use]
    pub fn of(&self, difference: Difference) -> u64 {
        self.counts[difference as usize]
    }

    /// How many in all.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// The first ray of the class, counted from 0, that was answered wrong.
    #[must_use]
    pub fn first_wrong(&self) -> Option<u64> {
        self.first_wrong
    }

    fn add(&mut self, difference: Option<Difference>, ray: usize) {
        let Some(difference) = difference else { return };
        self.counts[difference as usize] += 1;
        if matches!(difference, Difference::Lost | Difference::Other) {
            self.first_wrong = self.first_wrong.or(Some(ray as u64));
        }
    }
}

/// One who answers: a hierarchy asked in one kind of query. The first of a list is the witness.
pub(super) type Entry<'a> = (&'a dyn Tracer, Query);

/// What one entry answered to a chunk.
struct Answers {
    closest: Vec<Option<Hit>>,
    any: Vec<bool>,
}

/// Contested rays of a class that are judged: as many as take some ten seconds.
const MOST_TESTS: usize = 1 << 29;

/// Counts the differences of each entry but the first: of nearest hits, and of any hits. `stop` is asked now and then.
pub(super) fn tally<E>(
    world: &World,
    brute: &Brute,
    entries: &[Entry<'_>],
    chunks: &[Chunk],
    stop: &dyn Fn() -> Result<(), E>,
) -> Result<Vec<[Tally; 2]>, E> {
    let mut tallies = vec![[Tally::default(); 2]; entries.len() - 1];
    let mut left = (MOST_TESTS / world.primitive_count().max(1)).max(16);
    for (number, chunk) in chunks.iter().enumerate() {
        stop()?;
        let answers: Vec<Answers> = entries
            .par_iter()
            .map(|(tracer, query)| Answers {
                closest: tracer.closest(*query, chunk),
                any: tracer.any(*query, chunk),
            })
            .collect();
        let contested: Vec<usize> = (0..chunk.single.len()).filter(|&i| is_contested(&answers, i)).collect();
        let (judged, unjudged) = contested.split_at(contested.len().min(left));
        left -= judged.len();
        let found: Vec<Vec<[Option<Difference>; 2]>> =
            judged.par_iter().map(|&i| differences(world, brute, &chunk.single[i], &answers, i)).collect();
        let unknown = vec![[Some(Difference::Unjudged); 2]; tallies.len()];
        let rows = found.iter().chain(std::iter::repeat_n(&unknown, unjudged.len()));
        for (row, i) in rows.zip(&contested) {
            let ray = number * CHUNK + i;
            for (tally, [closest, any]) in tallies.iter_mut().zip(row) {
                tally[0].add(*closest, ray);
                tally[1].add(*any, ray);
            }
        }
    }
    Ok(tallies)
}

fn is_contested(answers: &[Answers], i: usize) -> bool {
    let first = answers[0].closest[i];
    answers
        .iter()
        .any(|a| a.any[i] != a.closest[i].is_some() || !is_same(first.as_ref(), a.closest[i].as_ref()))
}

/// Whether both name one primitive, and nearly one place.
fn is_same(a: Option<&Hit>, b: Option<&Hit>) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => {
            (a.placement, a.prim) == (b.placement, b.prim)
                && (a.t - b.t).abs() <= 1e-4 * a.t.abs().max(b.t.abs())
        }
        _ => false,
    }
}

/// How each entry but the first differs from the truth about a ray.
fn differences(
    world: &World,
    brute: &Brute,
    ray: &Ray,
    answers: &[Answers],
    i: usize,
) -> Vec<[Option<Difference>; 2]> {
    use crate::accel::Accel as _;
    let oracle = brute.intersect(ray);
    let classify = |found: Option<&Hit>| {
        let verdict = judge(world, brute, ray, oracle.as_ref(), found);
        match (verdict, found) {
            (Verdict::Same, _) => None,
            (Verdict::Tie, Some(hit)) if !is_at_boundary(world, ray, hit) => Some(Difference::IdTie),
            (Verdict::Tie, _) => Some(Difference::SharedEdge),
            (Verdict::Extra | Verdict::Range, _) => Some(Difference::Epsilon),
            (Verdict::Edge | Verdict::Rim, _) => Some(Difference::LostAtEdge),
            (Verdict::Wrong, _) if oracle.is_some_and(|hit| found.is_none_or(|found| found.t > hit.t)) => {
                Some(Difference::Lost)
            }
            (Verdict::Wrong, _) => Some(Difference::Other),
        }
    };
    // Most entries give one of few answers.
    let mut known: Vec<(Option<Hit>, Option<Difference>)> = Vec::new();
    let mut classified = |found: Option<Hit>| match known.iter().find(|(hit, _)| *hit == found) {
        Some((_, difference)) => *difference,
        None => {
            let difference = classify(found.as_ref());
            known.push((found, difference));
            difference
        }
    };
    let rows = answers[1..].iter().map(|a| {
        let closest = classified(a.closest[i]);
        let any = match (a.any[i], oracle.is_some(), a.closest[i]) {
            (yes, truth, _) if yes == truth => None,
            // The hit that it means is not told: its own nearest one speaks for it.
            (true, _, Some(hit)) => classified(Some(hit)),
            (true, _, None) => Some(Difference::Other),
            (false, ..) => classified(None),
        };
        [closest, any]
    });
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Accel, Bvh2Accel};
    use crate::geometry::{Mesh, Shape};
    use crate::math::Aabb;
    use glam::Vec3;
    use std::sync::Arc;

    /// Loses what lies at x > 0, and sees what is not there at y > 2.
    struct Liar(Brute);

    impl Accel for Liar {
        fn intersect(&self, ray: &Ray) -> Option<Hit> {
            let honest = self.0.intersect(ray);
            if ray.o.y > 2.0 {
                return self.0.intersect(&Ray::new(Vec3::new(-0.5, 0.5, ray.o.z), ray.d));
            }
            honest.filter(|_| ray.o.x <= 0.0)
        }

        fn occluded(&self, ray: &Ray) -> bool {
            self.intersect(ray).is_some()
        }

        fn bounds(&self) -> Aabb {
            self.0.bounds()
        }

        fn bytes(&self) -> usize {
            0
        }
    }

    fn square() -> Arc<World> {
        let corners = vec![
            Vec3::new(-1.0, -1.0, 0.0),
            Vec3::new(1.0, -1.0, 0.0),
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::new(-1.0, 1.0, 0.0),
        ];
        let mut world = World::default();
        let mesh = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).expect("a square");
        let shape = world.add_shape(Shape::Mesh(mesh));
        world.place(shape, None);
        Arc::new(world)
    }

    fn tally_of(liar: &Liar, world: &Arc<World>, origins: &[[f32; 2]]) -> [Tally; 2] {
        let rays: Vec<Ray> = origins.iter().map(|&[x, y]| Ray::new(Vec3::new(x, y, 3.0), -Vec3::Z)).collect();
        let brute = Brute::new(world.clone());
        let witness = Bvh2Accel::build(world, &crate::accel::bvh::Options::default());
        let entries: [Entry<'_>; 2] = [(&witness, Query::Single), (liar, Query::ALL[3])];
        let chunks = [Chunk::new(&rays)];
        tally(world, &brute, &entries, &chunks, &|| Ok::<(), ()>(())).expect("not stopped")[0]
    }

    #[test]
    fn lost_and_invented_hits_are_wrong_and_others_are_not() {
        let world = square();
        let liar = Liar(Brute::new(world.clone()));
        let [closest, any] = tally_of(&liar, &world, &[[-0.5, 0.2], [-0.2, 0.5]]);
        assert_eq!((closest.total(), any.total()), (0, 0), "honest where nothing is to be lost");
        let [closest, any] = tally_of(&liar, &world, &[[0.5, 0.2], [0.2, 0.5], [0.3, 3.0]]);
        assert_eq!((closest.of(Difference::Lost), closest.of(Difference::Other)), (2, 1), "{closest:?}");
        assert_eq!((closest.first_wrong(), any.first_wrong()), (Some(0), Some(0)), "the first ray");
        assert_eq!((any.of(Difference::Lost), any.of(Difference::Other)), (2, 1), "{any:?}");
        // On the diagonal half way, and on the rim: whoever misses there does so within rounding.
        let [closest, _] = tally_of(&liar, &world, &[[1.0, 0.25]]);
        assert_eq!((closest.of(Difference::LostAtEdge), closest.total()), (1, 1), "{closest:?}");
    }
}
