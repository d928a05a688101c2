//! Cutting ears off a polygon: corners whose triangle turns left and holds no other corner (Meisters 1975, Polygons
//! have ears).
//!
//! Only corners that do not turn left can be inside an ear (Toussaint 1991, Efficient triangulation of simple polygons):
//! they are kept in a grid. Corners wait in a queue; cutting one off sends its neighbours to the end of it, so that ears
//! are taken all around rather than from one corner. Where there is no ear, because the polygon crosses itself, what
//! counts as one is loosened step by step.

use super::grid::Grid;
use super::polygon::turn;
use glam::DVec2;
use std::collections::VecDeque;

/// How many corners may be looked at, for each corner of the polygon, before it is taken for one that crosses itself.
/// Less gives up on outlines with very many long thin notches, more makes a tangle of many corners slow.
const PATIENCE: usize = 4000;

/// The number of corners beyond which patience does not grow.
const PATIENT: usize = 250_000;

/// What counts as an ear, from strict to anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
enum Ear {
    /// Turns left, no other corner inside or on the rim.
    #[default]
    Clear,
    /// Turns left, no other corner inside.
    Touched,
    /// Has no area.
    Empty,
    /// Turns left.
    Convex,
    /// Any corner.
    Any,
}

impl Ear {
    fn looser(self) -> Self {
        match self {
            Self::Clear => Self::Touched,
            Self::Touched => Self::Empty,
            Self::Empty => Self::Convex,
            Self::Convex | Self::Any => Self::Any,
        }
    }
}

/// The corners that are left, in a ring.
#[derive(Debug, Default)]
pub(super) struct Ring {
    next: Vec<usize>,
    before: Vec<usize>,
    /// Corners to try, each with the number of its latest entry.
    queue: VecDeque<(usize, u32)>,
    /// The latest entry of each corner; older ones do not count.
    latest: Vec<u32>,
    left: usize,
    /// The corners that do not turn left.
    reflex: Grid,
}

impl Ring {
    /// Triangles of a polygon, as indices into its corners.
    pub(super) fn cut(&mut self, points: &[DVec2], mut triangle: impl FnMut([usize; 3])) {
        self.start(points);
        let (mut ear, mut seen) = (Ear::Clear, 0);
        let patience = PATIENCE * points.len().min(PATIENT);
        while self.left > 3 {
            let mut any = false;
            while let Some((i, entry)) = self.queue.pop_front() {
                let stands = self.latest[i] == entry;
                if !stands || !(self.is_spike(i, points) || self.is_ear(i, ear, points, &mut seen)) {
                    continue;
                }
                triangle([self.before[i], i, self.next[i]]);
                self.remove(i, points);
                if self.left == 3 {
                    break;
                }
                any = true;
                ear = if seen > patience { Ear::Any } else { Ear::Clear };
            }
            // A corner may become an ear when one that is not beside it is cut off.
            ear = if any { ear } else { ear.looser() };
            self.queue_all(points);
        }
        let last = self.queue.iter().find(|(i, entry)| self.latest[*i] == *entry);
        let &(i, _) = last.expect("three corners were queued");
        triangle([self.before[i], i, self.next[i]]);
    }

    fn start(&mut self, points: &[DVec2]) {
        let n = points.len();
        self.left = n;
        self.next.clear();
        self.next.extend((1..n).chain([0]));
        self.before.clear();
        self.before.extend([n - 1].into_iter().chain(0..n - 1));
        self.latest.clear();
        self.latest.resize(n, 0);
        self.queue.clear();
        self.queue_all(points);
        let turns_left = |i: &usize| {
            let [a, b, c] = self.corners(*i, points);
            turn(a, b, c) > 0.0
        };
        let reflex: Vec<usize> = (0..n).filter(|i| !turns_left(i)).collect();
        self.reflex.start(points, reflex.len());
        reflex.into_iter().for_each(|i| self.reflex.keep(i, true));
    }

    fn corners(&self, i: usize, points: &[DVec2]) -> [DVec2; 3] {
        [self.before[i], i, self.next[i]].map(|i| points[i])
    }

    /// Keeps a corner in the grid just if it does not turn left.
    fn sort_in(&mut self, i: usize, points: &[DVec2]) {
        let [a, b, c] = self.corners(i, points);
        self.reflex.keep(i, turn(a, b, c) <= 0.0);
    }

    /// Whether the outline comes back from a corner the way it went there: nothing is lost with the corner. What is left
    /// of an outline that touches itself ends in such corners; they go first, while it is clear what they are.
    fn is_spike(&self, i: usize, points: &[DVec2]) -> bool {
        let [a, b, c] = self.corners(i, points);
        a == c || a == b || b == c
    }

    fn push(&mut self, i: usize, points: &[DVec2]) {
        self.latest[i] += 1;
        let entry = (i, self.latest[i]);
        if self.is_spike(i, points) {
            self.queue.push_front(entry);
        } else {
            self.queue.push_back(entry);
        }
    }

    /// All corners that are left, in order.
    fn queue_all(&mut self, points: &[DVec2]) {
        let Some(start) = (0..self.latest.len()).find(|&i| self.latest[i] != u32::MAX) else { return };
        let mut i = start;
        loop {
            self.push(i, points);
            i = self.next[i];
            if i == start {
                break;
            }
        }
    }

    fn remove(&mut self, i: usize, points: &[DVec2]) {
        let (a, c) = (self.before[i], self.next[i]);
        (self.next[a], self.before[c]) = (c, a);
        self.latest[i] = u32::MAX;
        self.reflex.keep(i, false);
        self.left -= 1;
        for neighbour in [a, c] {
            self.sort_in(neighbour, points);
            self.push(neighbour, points);
        }
    }

    /// Whether a corner can be cut off; `seen` counts the corners that were looked at.
    fn is_ear(&self, i: usize, ear: Ear, points: &[DVec2], seen: &mut usize) -> bool {
        let [a, b, c] = self.corners(i, points);
        let area = turn(a, b, c);
        let margin = if ear == Ear::Clear { 0.0 } else { f64::MIN_POSITIVE };
        let opens_on = |p: DVec2| turn(a, b, p) > 0.0 && turn(b, c, p) > 0.0;
        let holds = |j: usize| {
            let p = points[j];
            // Corners may coincide, where an outline runs along itself to a hole or touches itself. Such a corner is in
            // the way only if the outline goes on from the tip into the ear.
            if p == b && j != i {
                return opens_on(points[self.before[j]]) || opens_on(points[self.next[j]]);
            }
            ![a, b, c].contains(&p)
                && turn(a, b, p) >= margin
                && turn(b, c, p) >= margin
                && turn(c, a, p) >= margin
        };
        *seen += 1;
        match ear {
            Ear::Clear | Ear::Touched => {
                area > 0.0
                    && !self.reflex.any([a.min(b).min(c), a.max(b).max(c)], |j| {
                        *seen += 1;
                        holds(j)
                    })
            }
            Ear::Empty => area == 0.0,
            Ear::Convex => area > 0.0,
            Ear::Any => true,
        }
    }
}
