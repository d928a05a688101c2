//! Where a shape is while the shutter is open.
//!
//! Backends follow maps at equal steps and straight lines between them ([`Motion`]). Here the steps are chosen: as few as
//! keep every point of the shape within [`DEVIATION`] of where its keys put it.

use crate::error::{Place, Problem};
use crate::geometry::Pose;
use crate::math::{Aabb, Motion, Transform};
use crate::scene::build::Shutter;
use crate::scene::track::Track;
use glam::{Affine3A, DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// How far straight lines may lead a point from its true way, in diagonals of the shape's box: a shape that turns in place
/// shrinks by as much at worst. Smaller takes more keys, which cost memory and time; larger shows as a shape that wobbles.
pub(super) const DEVIATION: f64 = 1e-3;

/// The deviation at which the picture would show another motion.
const HOPELESS: f64 = 0.1;

/// Numbers of equal steps that are tried. They have many divisors, so that keys which split the time the shutter is open evenly
/// fall on steps; the last is what backends take.
const STEPS: [u16; 23] =
    [1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 16, 20, 24, 30, 32, 40, 48, 60, 64, 80, 96, 120, 128];

/// Moments looked at, at most, to see whether steps are fine enough.
const MOST_MOMENTS: f64 = 8192.0;

/// Everything that carries a shape to its place, first to last.
#[derive(Clone, Debug, Default)]
pub(super) struct Way {
    links: Vec<Link>,
}

#[derive(Clone, Debug)]
enum Link {
    Still(DAffine3),
    Moving(Arc<Track>),
}

/// Where a shape is.
#[derive(Clone, Debug)]
pub(super) enum Placed {
    /// In one place all the time that the shutter is open.
    Still(Affine3A),
    /// On a way.
    Moving(Motion),
}

impl From<Placed> for Pose {
    fn from(placed: Placed) -> Self {
        match placed {
            Placed::Still(map) => Transform::new(map).into(),
            Placed::Moving(motion) => motion.into(),
        }
    }
}

impl Way {
    /// Goes on by a map that is the same at all times.
    pub(super) fn carry(&mut self, map: DAffine3) {
        match self.links.last_mut() {
            Some(Link::Still(last)) => *last = map * *last,
            _ => self.links.push(Link::Still(map)),
        }
    }

    /// Goes on by a map that changes.
    pub(super) fn follow(&mut self, track: Track) {
        self.links.push(Link::Moving(Arc::new(track)));
    }

    /// The map before anything moves: what sizes are taken from.
    pub(super) fn at_rest(&self) -> DAffine3 {
        self.still().unwrap_or_else(|| self.at(f64::NEG_INFINITY))
    }

    /// The map, if it is the same at all times.
    fn still(&self) -> Option<DAffine3> {
        match self.links[..] {
            [] => Some(DAffine3::IDENTITY),
            [Link::Still(map)] => Some(map),
            _ => None,
        }
    }

    fn at(&self, time_s: f64) -> DAffine3 {
        self.links.iter().fold(DAffine3::IDENTITY, |so_far, link| match link {
            Link::Still(map) => *map * so_far,
            Link::Moving(track) => track.at(time_s) * so_far,
        })
    }

    fn tracks(&self) -> impl Iterator<Item = &Track> {
        self.links
            .iter()
            .filter_map(|link| if let Link::Moving(track) = link { Some(&**track) } else { None })
    }

    /// Where a shape in the box `bounds` is while the shutter is open, and a warning where that is more than [`DEVIATION`] from
    /// the truth. `place` is where the shape is described.
    pub(super) fn during(
        &self,
        shutter: Shutter,
        bounds: Aabb,
        place: &Place,
    ) -> Result<(Placed, Option<Problem>), Problem> {
        if let Some(map) = self.still() {
            return Ok((Placed::Still(single(&map)), None));
        }
        if !shutter.is_open() {
            return self.resting(shutter.open_s, place).map(|placed| (placed, None));
        }
        let followed = Followed { way: self, shutter, corners: bounds.corners().map(glam::Vec3::as_dvec3) };
        let (keys, off) = followed.steps();
        let keys: Vec<Affine3A> = keys.iter().map(single).collect();
        if off.is_none() && keys.iter().all(|key| *key == keys[0]) {
            return self.resting(shutter.open_s, place).map(|placed| (placed, None));
        }
        let motion = Motion::new(&keys).filter(|_| off.is_none_or(|off| off <= HOPELESS));
        let motion = motion.ok_or_else(|| unfollowed(place))?;
        Ok((Placed::Moving(motion), off.map(|off| inexact(place, off))))
    }

    fn resting(&self, time_s: f64, place: &Place) -> Result<Placed, Problem> {
        let map = single(&self.at(time_s));
        if Transform::new(map).is_none() {
            let problem = Problem::at(place.clone(), "the keys flatten the shape or carry it infinitely far");
            return Err(problem.remedy("use factors other than zero"));
        }
        Ok(Placed::Still(map))
    }
}

fn unfollowed(place: &Place) -> Problem {
    let what = "the shape turns too fast, or is flattened, while the shutter is open";
    Problem::at(place.clone(), what).remedy("close the shutter sooner, or spread the keys over more time")
}

fn inexact(place: &Place, off: f64) -> Problem {
    let what = format!(
        "the shape moves so much while the shutter is open that it is off by up to {:.1} % of its size",
        off * 100.0
    );
    Problem::at(place.clone(), what).remedy("close the shutter sooner")
}

/// A way while the shutter is open, and the corners of what goes it.
struct Followed<'a> {
    way: &'a Way,
    shutter: Shutter,
    corners: [DVec3; 8],
}

impl Followed<'_> {
    fn at(&self, moment: f64) -> DAffine3 {
        self.way.at(self.shutter.at(moment))
    }

    /// The maps at as few steps as keep within [`DEVIATION`]; else at as many as there can be, and how far off that is, in
    /// diagonals.
    fn steps(&self) -> (Vec<DAffine3>, Option<f64>) {
        let size = self.size();
        // What has no extent is seen nowhere.
        let allowed = if size > 0.0 && size.is_finite() { DEVIATION * size } else { f64::INFINITY };
        let fine =
            STEPS.iter().map(|&steps| self.keys(steps)).find(|keys| self.deviation(keys, allowed) <= allowed);
        let finest = || self.keys(STEPS[STEPS.len() - 1]);
        fine.map_or_else(
            || {
                let keys = finest();
                let off = self.deviation(&keys, f64::INFINITY) / size;
                (keys, Some(off))
            },
            |keys| (keys, None),
        )
    }

    /// The longest diagonal of the shape's box, in the world, at the ends of the way.
    fn size(&self) -> f64 {
        let diagonals = |map: DAffine3| {
            let [a, b, c, d, e, f, g, h] = self.corners.map(|p| map.transform_point3(p));
            [(a, h), (b, g), (c, f), (d, e)].map(|(p, q)| p.distance(q)).into_iter().fold(0.0, f64::max)
        };
        diagonals(self.at(0.0)).max(diagonals(self.at(1.0)))
    }

    /// The maps at equal steps.
    fn keys(&self, steps: u16) -> Vec<DAffine3> {
        (0..=steps).map(|i| self.at(f64::from(i) / f64::from(steps))).collect()
    }

    /// How far straight lines between keys are from the true way; no more is looked for where it is more than `enough`.
    ///
    /// What is off at a moment is the length of an affine function of the point, so it is greatest at a corner of the box.
    fn deviation(&self, keys: &[DAffine3], enough: f64) -> f64 {
        let mut most = 0.0;
        for moment in self.moments(keys.len() - 1) {
            #[expect(clippy::cast_precision_loss, reason = "few keys")]
            let at = moment * (keys.len() - 1) as f64;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a step of few")]
            let first = (at as usize).min(keys.len() - 2);
            #[expect(clippy::cast_precision_loss, reason = "few keys")]
            let part = at - first as f64;
            let (map, a, b) = (self.at(moment), &keys[first], &keys[first + 1]);
            for p in self.corners {
                let straight = a.transform_point3(p).lerp(b.transform_point3(p), part);
                most = f64::max(most, straight.distance(map.transform_point3(p)));
            }
            if most > enough {
                break;
            }
        }
        most
    }

    /// Moments between equal steps, and those of the keys: so dense that the shape turns by little from one to the next.
    fn moments(&self, steps: usize) -> impl Iterator<Item = f64> {
        #[expect(clippy::cast_precision_loss, reason = "few steps")]
        let steps = steps as f64;
        let turn: f64 =
            self.way.tracks().map(|track| track.turn(self.shutter.open_s, self.shutter.close_s)).sum();
        let per_step = (3.0 + (turn / steps / (PI / 8.0)).ceil()).min((MOST_MOMENTS / steps).ceil());
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "limited above")]
        let (steps, per_step) = (steps as u32, per_step as u32 | 1);
        let between = move |step: u32| {
            let part = move |i: u32| f64::from(i) / f64::from(per_step + 1);
            (1..=per_step).map(move |i| (f64::from(step) + part(i)) / f64::from(steps))
        };
        let keys = self.way.tracks().flat_map(|track| self.shutter.moments(track.times()));
        keys.chain((0..steps).flat_map(between))
    }
}

/// A map rounded to single precision.
pub(super) fn single(map: &DAffine3) -> Affine3A {
    Affine3A { matrix3: map.matrix3.as_mat3().into(), translation: map.translation.as_vec3().into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::description::{Located, ShapeKey, Step};
    use glam::Vec3;

    const BOX: Aabb = Aabb { min: Vec3::new(-1.0, -0.5, -0.2), max: Vec3::new(1.0, 0.5, 0.4) };

    fn located<T>(value: T) -> Located<T> {
        Located { value, place: Place::file("a.toml") }
    }

    fn way(keys: &[(f64, &[Step])]) -> Way {
        let key = |&(time_s, steps): &(f64, &[Step])| {
            located(ShapeKey { time_s, transform: steps.iter().cloned().map(located).collect() })
        };
        let keys: Vec<_> = keys.iter().map(key).collect();
        let mut way = Way::default();
        way.carry(DAffine3::from_translation(DVec3::new(0.3, 0.1, -0.2)));
        way.follow(Track::new(&keys).expect("a track"));
        way
    }

    fn during(way: &Way, open_s: f64, close_s: f64) -> Result<(Placed, Option<Problem>), Problem> {
        way.during(Shutter { open_s, close_s }, BOX, &Place::file("a.toml"))
    }

    fn turn(degrees: f64) -> [Step; 2] {
        let axis = DVec3::new(0.2, 1.0, 0.3);
        [Step::Rotate { rotate_deg: degrees, axis }, Step::Translate { translate: DVec3::X * degrees * 0.01 }]
    }

    /// How far the motion is from the way, by single precision, in diagonals.
    fn off(way: &Way, motion: &Motion, [open_s, close_s]: [f64; 2]) -> f64 {
        let size = BOX.size().as_dvec3().length();
        (0..=5000_u16)
            .map(|i| f64::from(i) / 5000.0)
            .flat_map(|moment| BOX.corners().map(|p| (moment, p)))
            .map(|(moment, p)| {
                let exact = way.at(open_s + (close_s - open_s) * moment).transform_point3(p.as_dvec3());
                #[expect(clippy::cast_possible_truncation, reason = "a moment")]
                let found = motion.at(moment as f32).point(p).as_dvec3();
                found.distance(exact) / size
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn turns_stay_within_the_bound_with_few_steps() {
        for degrees in [5.0, 45.0, 180.0, 360.0, 720.0] {
            let (none, all) = (turn(0.0), turn(degrees));
            let way = way(&[(0.0, &none), (1.0, &all)]);
            let (Placed::Moving(motion), None) = during(&way, 0.0, 1.0).expect("a way") else {
                panic!("{degrees}: not followed");
            };
            let found = off(&way, &motion, [0.0, 1.0]);
            assert!(found <= DEVIATION * 1.01, "{degrees}: off by {found}");
            let half = Followed {
                way: &way,
                shutter: Shutter { open_s: 0.0, close_s: 1.0 },
                corners: BOX.corners().map(Vec3::as_dvec3),
            };
            let steps = u16::try_from(motion.keys().len() - 1).expect("few");
            let coarser = half.deviation(&half.keys((steps / 2).max(1)), f64::INFINITY) / half.size();
            assert!(steps == 1 || coarser > DEVIATION, "{degrees}: {steps} steps are more than needed");
        }
    }

    #[test]
    fn straight_ways_take_a_step_for_each_key() {
        let at = |x: f64| [Step::Translate { translate: DVec3::X * x }];
        let [a, b, c] = [0.0, 20.0, -300.0].map(at);
        let way = way(&[(0.0, &a), (0.5, &b), (1.0, &c)]);
        let keys = |open_s, close_s| match during(&way, open_s, close_s).expect("a way") {
            (Placed::Moving(motion), None) => motion.keys().len(),
            (Placed::Still(_), None) => 1,
            (placed, warning) => panic!("{placed:?} {warning:?}"),
        };
        assert_eq!(keys(0.0, 0.5), 2, "one straight line");
        assert_eq!(keys(0.0, 1.0), 3, "two");
        assert_eq!(keys(0.25, 1.0), 4, "two, of which one is twice as long");
        for (open_s, close_s) in [(0.3, 0.3), (-2.0, -1.0), (1.0, 9.0)] {
            assert_eq!(keys(open_s, close_s), 1, "nothing moves from {open_s} to {close_s}");
        }
    }

    #[test]
    fn what_is_too_fast_is_told() {
        let spun = |turns: f64| {
            let (none, all) = (turn(0.0), turn(360.0 * turns));
            during(&way(&[(0.0, &none), (1.0, &all)]), 0.0, 1.0)
                .map(|(_, warning)| warning.map(|w| w.to_string()))
        };
        let warning = spun(8.0).expect("followed").expect("a warning");
        assert!(warning.starts_with("a.toml: the shape moves so much while"), "{warning}");
        let error = spun(100.0).expect_err("not followed").to_string();
        assert!(error.starts_with("a.toml: the shape turns too fast"), "{error}");
    }
}
